// LOG: what the screens said, newest last, with the whole text of one below.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/ui/screen.hpp"
#include "app/ui/talk.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/session/event_log.hpp"

namespace ecs::app {

class LogScreen final : public Screen {
 public:
  LogScreen();

  [[nodiscard]] std::string title() const override { return "LOG"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override;
  [[nodiscard]] bool typing() const override { return typing_ != Typing::nothing; }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;

 private:
  enum class Typing { nothing, sought, file };
  [[nodiscard]] std::vector<const LogEntry*> shown() const;
  void follow();
  void seek(int by);
  void save(const std::string& path);
  void on_typing_key(const Key& key);
  void draw_bottom(Canvas& canvas, const Area& area) const;
  [[nodiscard]] std::string prompt() const { return typing_ == Typing::sought ? "find: " : "save a copy to: "; }

  std::vector<LogEntry> entries_;
  std::filesystem::path file_;
  bool only_errors_ = false;
  bool following_ = true;
  ListPlace place_;
  Typing typing_ = Typing::nothing;
  TextLine text_;
  std::string sought_;
  std::string said_;  ///< about the log itself; not logged
  bool bad_ = false;
  std::optional<Question> question_;
};

}  // namespace ecs::app
