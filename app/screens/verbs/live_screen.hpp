// A verb that talks with whoever runs it: what comes next in the upper row, what it said below as it says it, a line to
// type into.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::app {

/// Whether a verb ("laser capture") is run by this screen rather than below its form.
[[nodiscard]] bool runs_live(const std::string& verb);

class LiveScreen final : public Screen {
 public:
  /// @param words  the command line; it is run at once
  LiveScreen(std::string name, const std::vector<std::string>& words);
  ~LiveScreen() override;

  [[nodiscard]] std::string title() const override { return name_; }
  void draw(Canvas& canvas, const Area& area) const override;
  /// Enter sends the line; Esc asks the verb to leave, and goes back once it has ended.
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override;
  [[nodiscard]] bool typing() const override { return task_.running(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;

 private:
  struct Wire;
  struct Answer {
    std::vector<std::string> lines;
    int exit_code = 0;
  };
  [[nodiscard]] std::string next() const;

  std::string name_;
  std::shared_ptr<Wire> wire_;
  std::vector<std::string> said_;
  TextLine line_;
  ScrollPlace scroll_;
  std::optional<Answer> answer_;
  TaskRunner task_;
};

}  // namespace ecs::app
