#include "app/screens/files/prompt.hpp"

#include <algorithm>
#include <utility>

namespace ecs::app {

void Prompt::begin(std::string label, Kind kind, const std::string& text, Take take, std::string hint) {
  chooser_.reset();
  label_ = std::move(label);
  kind_ = kind;
  line_.set(text);
  help_ = std::move(hint);
  hint_.clear();
  refused_ = false;
  take_ = std::move(take);
}

void Prompt::begin_choosing(std::string label, FileWish wish, TakeFiles take) {
  begin(std::move(label), Kind::path, "", nullptr, {});
  take_files_ = std::move(take);
  chooser_ =
      std::make_unique<FileChooser>(folder_.empty() ? std::filesystem::current_path() : folder_, std::move(wish));
}

/// Ends the prompt unless the text is refused; what takes it may begin another one.
void Prompt::give(const std::string& text) {
  const Take take = std::exchange(take_, nullptr);
  const std::string refusal = take(text);
  if (refusal.empty()) return;
  hint_ = refusal;
  refused_ = true;
  take_ = take;
}

void Prompt::on_chooser_key(const Key& key) {
  const FileChooser::Answer answer = chooser_->on_key(key);
  if (answer == FileChooser::Answer::open) return;
  folder_ = chooser_->folder();
  const std::unique_ptr<FileChooser> chooser = std::move(chooser_);
  const TakeFiles take = std::exchange(take_files_, nullptr);
  if (answer == FileChooser::Answer::chosen) take(chooser->taken());
}

bool Prompt::on_key(const Key& key) {
  if (!active()) return false;
  if (chooser_) {
    on_chooser_key(key);
    return true;
  }
  hint_.clear();
  refused_ = false;
  if (key.name == Key::Name::escape) {
    take_ = nullptr;
  } else if (key.name == Key::Name::enter) {
    if (const std::string text = line_.text(); text.empty())
      take_ = nullptr;
    else
      give(text);
  } else if (key.name == Key::Name::tab && kind_ == Kind::path) {
    const PathCompletion completion = completed_path(line_.text());
    line_.set(completion.completed);
    for (const std::string& choice : completion.choices) hint_ += (hint_.empty() ? "" : "  ") + choice;
  } else {
    (void)line_.on_key(key);
  }
  return true;
}

int Prompt::columns(const Area& area) const {
  const int room = area.columns - width_of(label_) - 2;
  return std::max(8, kind_ == Kind::number ? std::min(16, room) : room);
}

void Prompt::draw(Canvas& canvas, const Area& area, int row) const {
  if (!active()) return;
  if (chooser_) {
    canvas.fill(area);
    canvas.text(area, 0, 0, label_, Tone::strong);
    chooser_->draw(canvas, area.below(1));
    return;
  }
  canvas.fill({area.row + row, area.column, 1, area.columns});
  const int begin = canvas.text(area, row, 0, label_ + " ", Tone::strong);
  line_.draw(canvas, area, row, begin, columns(area), true);
  const std::string ways = "Enter takes it, Esc leaves it";
  const Tone tone = refused_ ? Tone::bad : Tone::faint;
  const int beside = begin + columns(area) + 2;
  if (kind_ == Kind::number && !refused_) {
    canvas.paragraph({area.row + row, area.column + beside, 1, std::max(0, area.columns - beside)}, 0, ways, tone);
    return;
  }
  const std::string help = (kind_ == Kind::path ? "Tab completes the path; "
                            : help_.empty()     ? ""
                                                : help_ + "; ") +
                           ways;
  const int rows = refused_ ? std::min(2, row) : std::min(1, row);  // above the line
  canvas.fill({area.row + row - rows, area.column, rows, area.columns});
  canvas.paragraph(area.below(row - rows).top(rows), 0, hint_.empty() ? help : hint_, tone);
}

CellPosition Prompt::cursor(const Area& area, int row) const {
  if (!active()) return {-1, -1};
  if (chooser_) return chooser_->cursor(area.below(1));
  return {area.row + row, area.column + width_of(label_) + 1 + line_.cursor_column(columns(area))};
}

std::vector<KeyHelp> Prompt::keys() const {
  if (!chooser_) {
    std::vector<KeyHelp> keys{{"Enter", "take it"}, {"Esc", "leave it"}};
    if (kind_ == Kind::path) keys.insert(keys.begin() + 1, {"Tab", "complete"});
    return keys;
  }
  std::vector<KeyHelp> keys;
  for (const auto& [name, does] : chooser_->keys()) keys.push_back({name, does});
  return keys;
}

}  // namespace ecs::app
