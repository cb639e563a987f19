#include "app/ui/overlay.hpp"

#include <algorithm>

#include "app/ui/words.hpp"
#include "commissioning/session/event_log.hpp"

namespace ecs::app {

void Overlay::show_help(const Screen& screen, const std::string& seen) {
  *this = {};
  title_ = screen.title() + ": help";
  parts_ = {{"", screen.help()}, {"", ""}};
  const std::vector<KeyHelp> keys = screen.keys();
  for (const KeyHelp& key : keys) parts_.push_back({key.keys, key.does});
  if (std::none_of(keys.begin(), keys.end(), [](const KeyHelp& key) { return key.keys == "Esc"; }))
    parts_.push_back({"Esc", "back; on the first screen: leave"});
  parts_.push_back({"F2", "shows whole what ends in ... F2"});
  parts_.push_back({"F3", "finds any screen or command by its name, here too"});
  parts_.push_back({"F4", "copies the selected row, or the screen, to your clipboard (OSC 52)"});
  parts_.push_back({"F6", "COMMANDS: what was done here, as commands of ecs; a script of them"});
  parts_.push_back({"Ctrl-L, Ctrl-C", "draw everything anew; leave the program"});
  const std::vector<ExplainedWord> words = words_explained_in(seen + " " + screen.help());
  if (!words.empty()) parts_.push_back({"", ""});
  for (const ExplainedWord& word : words) parts_.push_back({word.word, word.meaning});
}

void Overlay::show_whole(const std::vector<std::string>& texts) {
  if (texts.empty()) return;
  *this = {};
  title_ = "whole text (LOG keeps it)";
  const auto known = logged();
  for (const std::string& text : texts) {
    if (!parts_.empty()) parts_.push_back({});
    parts_.push_back({"", text});
    if (std::none_of(known.begin(), known.end(), [&](const LogEntry& entry) { return entry.text == text; }))
      log_event(Tone::plain, text);
  }
}

std::vector<std::string> Overlay::lines(int columns) const {
  std::vector<std::string> lines;
  const int keys = columns >= 50 ? 15 : 9;
  for (const Part& part : parts_) {
    const int begin = part.key.empty() ? 0 : std::max(keys, width_of(part.key) + 1);
    bool first = true;
    for (const std::string& line : wrapped(part.text, columns - begin)) {
      lines.push_back(in_columns(first ? part.key : "", begin) + line);
      first = false;
    }
  }
  return lines;
}

void Overlay::draw(Canvas& canvas) const {
  const auto all = lines(canvas.columns() - 8);
  const int count = static_cast<int>(all.size());
  page_ = std::max(1, std::min(count, canvas.rows() - 4));
  const Area box{(canvas.rows() - page_ - 2) / 2, 2, page_ + 2, canvas.columns() - 4};
  canvas.fill(box);
  const std::string ways = count > page_ ? "up, down; Esc goes on" : "any key goes on";
  const std::string whole = title_ + "; " + ways;
  canvas.frame(box, width_of(whole) + 5 > box.columns ? ways : whole, Tone::plain);
  const Area inside = box.inside();
  draw_scrolled(canvas, {inside.row, inside.column + 1, inside.rows, inside.columns - 1}, all, scroll_);
  fits_ = count <= page_;
  end_ = scroll_.first + page_ >= count;
}

void Overlay::on_key(const Key& key) {
  if (key.name == Key::Name::resized) return;
  if (!fits_ && scroll_.on_key(key, page_)) return;
  if (!end_ && is_letter(key, U' '))
    scroll_.first += page_;
  else
    *this = {};
}

}  // namespace ecs::app
