// The link as fields: what kind, which port, how fast, which unit; and back to the text that --link takes.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "commissioning/link/choice.hpp"

namespace ecs::commissioning {

enum class LinkKind { serial, network, emulator };

/// One row of the form.
struct LinkField {
  std::string name;  ///< "port"
  std::string value;
  std::vector<std::string> choices;  ///< to step through; empty: typed only
  std::string help;
};

class LinkForm {
 public:
  LinkForm() = default;
  /// The fields that make this link; those of other kinds as usual.
  explicit LinkForm(const LinkChoice& choice);

  [[nodiscard]] LinkKind kind() const { return kind_; }
  /// @param ports  serial ports of this computer
  [[nodiscard]] std::vector<LinkField> fields(const std::vector<std::string>& ports) const;
  /// @param row  of fields()
  void set(int row, const std::string& value);
  /// The next or the previous choice of a field that has choices.
  void step(int row, int by, const std::vector<std::string>& ports);

  /// As --link takes it; may be wrong, parsed_link() tells.
  [[nodiscard]] std::string text() const;

 private:
  LinkKind kind_ = LinkKind::serial;
  std::string device_ = "/dev/ttyUSB0";
  std::string baud_ = "115200";
  std::string format_ = "8N1";
  std::string token_;
  std::string unit_ = "1";
  std::string host_ = "192.168.0.10";
  std::string port_ = "502";
  std::string machine_;  ///< empty: the sample
};

}  // namespace ecs::commissioning
