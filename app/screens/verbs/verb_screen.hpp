// A verb as a form: its options as fields with their help, Enter runs it, the answer scrolls below.
#pragma once

#include <string>
#include <vector>

#include "app/cli/catalogue.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::app {

class VerbScreen final : public Screen {
 public:
  /// The connection's link is filled in where the verb takes one; the connection lends the line while it runs.
  VerbScreen(VerbEntry verb, std::shared_ptr<UnitConnection> connection);
  ~VerbScreen() override;

  [[nodiscard]] std::string title() const override { return verb_.name(); }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override;
  [[nodiscard]] bool typing() const override { return !reading_; }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;

 private:
  struct Answer {
    std::vector<std::string> lines;
    int exit_code = 0;
  };
  [[nodiscard]] int field_rows(const Area& area) const;
  [[nodiscard]] int name_columns() const;
  [[nodiscard]] std::string lacking() const;
  [[nodiscard]] bool uses_line() const;
  void draw_fields(Canvas& canvas, const Area& area) const;
  void draw_answer(Canvas& canvas, const Area& area) const;
  [[nodiscard]] const std::vector<std::string>& answer_lines(int columns) const;
  [[nodiscard]] bool on_answer_key(const Key& key);
  [[nodiscard]] Step on_field_key(const Key& key);
  [[nodiscard]] std::vector<std::string> words() const;
  [[nodiscard]] Step run();
  void take(Answer answer);
  void complete();
  void next_choice(int by);

  VerbEntry verb_;
  std::shared_ptr<UnitConnection> connection_;
  std::vector<TextLine> values_;
  ListPlace field_;
  mutable int fields_row_ = 0;   ///< of the canvas, as drawn last
  mutable int seen_fields_ = 0;  ///< rows of them
  bool reading_ = false;         ///< the keys scroll the answer
  ScrollPlace scroll_;
  mutable int answer_rows_ = 10;  ///< that are seen of it
  mutable int lines_for_ = -1;    ///< columns for which `lines_` were made
  mutable std::vector<std::string> lines_;
  std::string hint_;
  bool refused_ = false;  ///< the hint says why
  std::optional<Answer> answer_;
  TaskRunner task_;
};

}  // namespace ecs::app
