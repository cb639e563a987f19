// A list that grows while the screens run, the newest row last and followed, the marked one whole below: MESSAGES,
// COMMANDS, LOGBOOK.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/screens/files/prompt.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::app {

/// What they have in common; each says its rows and its keys.
class ListScreen : public Screen {
 public:
  void draw(Canvas& canvas, const Area& area) const final {
    if (area.rows < 4 || area.columns < 10) return;
    const Area inside = area.between_margins();
    if (!page_.empty()) return draw_scrolled(canvas, area, sentences_wrapped(page_, inside.columns), scroll_);
    const auto list = rows();
    canvas.text(inside, 0, 0, heading(), Tone::strong);
    canvas.text(inside, 1, 0, below_heading(), Tone::faint);
    const int below = shows_whole_below() ? std::clamp(area.rows / 4, 1, 8) : 0;
    if (list.empty())
      canvas.paragraph(inside, 2, while_empty());
    else
      draw_list(canvas, {area.row + 2, area.column, std::max(1, area.rows - 4 - below), area.columns}, list, place_);
    if (!list.empty() && below > 0)
      canvas.paragraph({area.row + area.rows - 2 - below, inside.column, below, inside.columns}, 0, whole(marked()),
                       Tone::strong);
    canvas.paragraph({area.row + area.rows - 1, inside.column, 1, inside.columns}, 0, said_, tone_);
    prompt_.draw(canvas, inside, inside.rows - 1);
    draw_question(canvas, area, asking_);
  }

  [[nodiscard]] Step on_key(const Key& key) final {
    if (answers(asking_, key) || prompt_.on_key(key) || key.name == Key::Name::resized) return stay();
    if (!page_.empty()) {
      if (key.name == Key::Name::escape)
        page_.clear();
      else
        (void)scroll_.on_key(key);
      return stay();
    }
    if (key.name == Key::Name::escape || is_letter(key, U'q')) return back();
    said_.clear();
    if (const auto clicked = key.name == Key::Name::mouse ? place_.clicked(key) : std::nullopt)
      place_.selected = std::min(*clicked, last());
    else if (!place_.on_key(key, count()) && act_on(keys_, key))
      return stay();
    following_ = place_.selected >= last();
    return stay();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const final {
    if (const auto& asked = asking_.question()) return {{"y", asked->yes}, {"n", asked->no}};
    if (prompt_.active()) return prompt_.keys();
    if (!page_.empty()) return {{"up/down", "scroll"}, {"Esc", "the list"}};
    std::vector<KeyHelp> keys = helps_of(keys_);
    keys.push_back({"Esc", "back"});
    return keys;
  }

  [[nodiscard]] bool typing() const final { return prompt_.active(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const final {
    const Area inside = area.between_margins();
    return prompt_.cursor(inside, inside.rows - 1);
  }

 protected:
  [[nodiscard]] virtual std::vector<ListRow> rows() const = 0;
  [[nodiscard]] virtual std::string heading() const = 0;
  [[nodiscard]] virtual std::string below_heading() const = 0;
  [[nodiscard]] virtual std::string while_empty() const = 0;
  [[nodiscard]] virtual std::string whole(std::size_t row) const = 0;
  [[nodiscard]] virtual bool shows_whole_below() const { return true; }

  [[nodiscard]] int count() const { return static_cast<int>(rows().size()); }
  [[nodiscard]] int last() const { return std::max(0, count() - 1); }
  [[nodiscard]] std::size_t marked() const { return static_cast<std::size_t>(std::clamp(place_.selected, 0, last())); }
  void follow() {
    if (following_) place_.selected = last();
  }
  void say(std::string text, Tone tone) {
    said_ = std::move(text);
    tone_ = tone;
  }
  void show(const std::string& text) {
    page_ = owned_lines_of(text);
    scroll_ = {};
  }
  /// Asks for a file, and again before one is replaced. @param write  returns why not
  void save(const std::string& label, const std::string& proposed, const std::string& what,
            std::function<Result<void>(const std::string&)> write) {
    prompt_.ask(label, Prompt::Kind::path, proposed, [this, what, write](const std::string& typed) {
      const std::string path(trimmed(typed));
      const auto written = [this, what, write, path] {
        const auto done = write(path);
        say(done ? fmt::format("{} written to {}", what, path) : to_text(done.error()), done ? Tone::good : Tone::bad);
      };
      if (!disc::exists(path)) return written();
      asking_.ask({fmt::format("Replace {}?", path), "The file exists. Its contents will be overwritten.", "replace",
                   "keep it"},
                  written);
    });
  }

  std::vector<KeyRow> keys_;
  ListPlace place_;
  bool following_ = true;
  Prompt prompt_;
  Asking asking_;
  std::string said_;  ///< about the list itself; not logged
  Tone tone_ = Tone::good;

 private:
  std::vector<std::string> page_;  ///< shown in place of the list; empty: the list
  ScrollPlace scroll_;
};

}  // namespace ecs::app
