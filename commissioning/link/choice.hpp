// Which link is used: --link, else the stored one, else the bundled emulator; where the pieces of the emulator lie. The
// same as fields: what kind, which port, how fast, which unit.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/result.hpp"
#include "protocol/line/link_address.hpp"

namespace ecs::commissioning {

/// The bundled emulator with this machine; the program starts and stops it.
struct EmulatorLink {
  std::filesystem::path machine;
};

struct LinkChoice {
  std::variant<protocol::LinkAddress, EmulatorLink> link;
  std::string origin;      ///< "--link", "configuration", "default"
  std::string arm_code{};  ///< that the unit shows; empty: that of $ECS_ARM_CODE, of an emulator its own
  bool shares = false;     ///< an emulator that is started for it may be used by other programs of this user
  [[nodiscard]] bool is_emulator() const { return std::holds_alternative<EmulatorLink>(link); }
};

/// `rtu:…`, `tcp:…`, `emulator` (sample machine) or `emulator:machine.toml`; a usage problem for anything else.
[[nodiscard]] Result<LinkChoice> parsed_link(std::string_view text, std::string origin);

/// The link of --link, else of the configuration file, else the emulator with the sample machine.
/// @param option  --link as given; empty: not given
[[nodiscard]] Result<LinkChoice> chosen_link(const std::string& option);

/// As --link takes it.
[[nodiscard]] std::string to_text(const LinkChoice& choice);

/// $XDG_CONFIG_HOME/ecs/config.toml, else $HOME/.config/ecs/config.toml; its key `link` is the stored link.
[[nodiscard]] std::filesystem::path configuration_file();
[[nodiscard]] Result<std::optional<std::string>> stored_link();
/// Replaces the key `link` and keeps the file's other keys.
[[nodiscard]] Result<void> store_link(const std::string& link);

/// A file of samples/: in $ECS_SAMPLES, in the share folder beside the installed program, in the source tree.
[[nodiscard]] std::optional<std::filesystem::path> sample_file(const std::filesystem::path& inside);
/// samples/mill/machine.toml.
[[nodiscard]] std::optional<std::filesystem::path> sample_machine();
/// `ecs-emulator`: $ECS_EMULATOR, beside this program, in the build tree, on PATH.
[[nodiscard]] std::optional<std::filesystem::path> emulator_program();

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
