// A screen whose keys are a table, with a line to type into, a question and a message over its picture.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/screens/files/prompt.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::app {

/// The last rows of an area.
[[nodiscard]] inline Area last_rows(const Area& area, int rows) {
  return {area.row + area.rows - rows, area.column, rows, area.columns};
}

class KeyedScreen : public Screen {
 public:
  [[nodiscard]] bool advance() final {
    const bool looked = prompt_.advance();
    return look() || looked;
  }
  [[nodiscard]] bool typing() const final { return prompt_.active() || edits(); }
  void draw(Canvas& canvas, const Area& area) const override {
    const Area inside = area.between_margins();
    draw_inside(canvas, inside);
    prompt_.draw(canvas, inside, prompt_row(inside));
    draw_question(canvas, inside, asking_);
  }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    const Area inside = area.between_margins();
    return prompt_.cursor(inside, prompt_row(inside));
  }
  [[nodiscard]] Step on_key(const Key& key) final {
    if (answers(asking_, key) || prompt_.on_key(key) || key.name == Key::Name::resized) return stay();
    if (edits()) {
      on_edit_key(key);
      return stay();
    }
    message_.clear();
    if (key.name == Key::Name::escape || is_letter(key, U'q')) {
      ++leaving_;
      return leave();
    }
    leaving_ = 0;
    if (!act_on(keys_, key)) on_other_key(key);
    return stay();
  }
  [[nodiscard]] std::vector<KeyHelp> keys() const final {
    if (const auto& asked = asking_.question()) return {{"y", asked->yes}, {"n", asked->no}};
    if (prompt_.active()) return prompt_.keys();
    if (edits()) return {{"Enter", "accept"}, {"Esc", "cancel"}};
    return helps_of(keys_);
  }

 protected:
  virtual void draw_inside(Canvas& /*canvas*/, const Area& /*inside*/) const {}
  /// Takes what has come meanwhile. @return whether anything changed
  [[nodiscard]] virtual bool look() = 0;
  /// A key that no row of the table has.
  virtual void on_other_key(const Key& /*key*/) {}
  /// Text is typed into the picture itself: every key goes there.
  [[nodiscard]] virtual bool edits() const { return false; }
  virtual void on_edit_key(const Key& /*key*/) {}
  [[nodiscard]] virtual int prompt_row(const Area& inside) const { return prompt_.choosing() ? 0 : inside.rows - 1; }
  /// Back; what is under way is given up first.
  [[nodiscard]] virtual Step leave() { return back(); }
  /// Asks for a file, and again before one is overwritten.
  void ask_where_to_save(const std::string& label, const std::string& proposed,
                         std::function<void(const std::string&)> save);

  std::vector<KeyRow> keys_;
  Prompt prompt_;
  Asking asking_;
  Message message_;
  int leaving_ = 0;  ///< how often in a row Esc was pressed
};

}  // namespace ecs::app
