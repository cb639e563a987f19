#include "app/screens/laser/chooser.hpp"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ecs::app {
namespace {

namespace fs = std::filesystem;
constexpr const char* kFolder = "Folder ";
constexpr std::uintmax_t kMostLookedAt = 16U << 20;  ///< bytes; larger files are read when they are chosen

std::vector<FolderEntry> entries_of(const fs::path& folder) {
  std::vector<FolderEntry> entries;
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, fault)) {
    FolderEntry made;
    made.name = entry.path().filename().string();
    if (made.name.starts_with(".")) continue;
    std::error_code other;
    made.folder = entry.is_directory(other);
    if (made.folder || entry.is_regular_file(other)) entries.push_back(std::move(made));
  }
  std::sort(entries.begin(), entries.end(), [](const FolderEntry& a, const FolderEntry& b) {
    return a.folder != b.folder ? a.folder : a.name < b.name;
  });
  return entries;
}

FolderEntry looked_at(const fs::path& path) {
  FolderEntry entry;
  entry.name = path.filename().string();
  std::error_code fault;
  if (fs::file_size(path, fault) > kMostLookedAt) {
    entry.what = "large: read when it is chosen";
    return entry;
  }
  const LaserFile file = read_laser_file({path.string(), {}});
  entry.readable = file.set != nullptr || file.wants_answers || file.is_map;
  entry.why_not = file.problem;
  if (file.set || file.is_map)
    entry.what = fmt::format("{}  {}", file.summary, file.format);
  else if (!file.format.empty())
    entry.what = file.format + ": no readings";
  else
    entry.what = file.wants_answers ? "does not say enough: take it, then Enter answers" : "not read";
  return entry;
}

fs::path home() {
  const char* folder = std::getenv("HOME");
  return folder == nullptr ? fs::path("/") : fs::path(folder);
}

}  // namespace

LaserChooser::LaserChooser(const fs::path& folder) { go(folder); }

void LaserChooser::go(const fs::path& folder) {
  std::error_code fault;
  folder_ = fs::weakly_canonical(fs::absolute(folder, fault), fault);
  entries_ = entries_of(folder_);
  marked_.clear();
  typed_ = TextLine();
  hint_.clear();
  place_ = {};
  if (looking_.running()) {
    looking_.cancel();
    look_again_ = true;
    return;
  }
  look_again_ = false;
  const auto look = [folder = folder_, entries = entries_](JobControl& control) {
    Looked looked;
    for (const FolderEntry& entry : entries) {
      if (control.cancelled) break;
      if (!entry.folder) looked.emplace(entry.name, looked_at(folder / entry.name));
    }
    return looked;
  };
  looking_.start("looking", look, [this](Looked looked) { take(std::move(looked)); });
}

void LaserChooser::take(Looked looked) {
  if (look_again_) {
    const std::string typed = typed_.text();
    const ListPlace place = place_;
    go(folder_);
    typed_.set(typed);
    place_ = place;
    return;
  }
  for (FolderEntry& entry : entries_)
    if (const auto found = looked.find(entry.name); found != looked.end()) entry = found->second;
}

std::size_t LaserChooser::readable() const {
  return static_cast<std::size_t>(
      std::count_if(entries_.begin(), entries_.end(), [](const FolderEntry& e) { return e.readable; }));
}

std::vector<LaserChooser::Row> LaserChooser::rows() const {
  const std::string typed = typed_.text();
  std::vector<Row> rows;
  if (typed.empty()) rows.push_back({RowKind::up, 0});
  if (typed.empty() && readable() > 1) rows.push_back({RowKind::all, 0});
  for (std::size_t k = 0; k < entries_.size(); ++k)
    if (entries_[k].name.starts_with(typed)) rows.push_back({RowKind::entry, k});
  return rows;
}

ListRow LaserChooser::picture_of_row(const Row& row, int columns) const {
  if (row.kind == RowKind::up) return {"    ..", Tone::plain};
  if (row.kind == RowKind::all) return {fmt::format("    [all {} measurement files here]", readable()), Tone::strong};
  const FolderEntry& entry = entries_[row.entry];
  const char* mark = marked_.contains(entry.name) ? "[x] " : (entry.folder ? "    " : "[ ] ");
  const int names = std::clamp(columns * 2 / 5, 12, 40);
  const std::string name = in_columns(entry.name + (entry.folder ? "/" : ""), names);
  std::string what = entry.folder ? "" : entry.what;
  if (what.empty() && !entry.folder) what = "...";
  return {fmt::format("{}{} {}", mark, name, what), entry.folder || entry.readable ? Tone::plain : Tone::faint};
}

/// The end of the path, where the whole of it would leave no room to type.
std::string LaserChooser::folder_shown(int columns) const {
  std::u32string shown = code_points(folder_.string() + (folder_ == folder_.root_path() ? "" : "/"));
  const int room = std::max(10, columns - width_of(kFolder) - 20);
  if (width_of(utf8_of(shown)) <= room) return utf8_of(shown);
  while (width_of(utf8_of(shown)) > room - 3) shown.erase(0, 1);
  return "..." + utf8_of(shown);
}

void LaserChooser::draw(Canvas& canvas, const Area& area) const {
  int at = canvas.text(area, 0, 0, kFolder, Tone::faint);
  at += canvas.text(area, 0, at, folder_shown(area.columns), Tone::strong);
  typed_.draw(canvas, area, 0, at, std::max(1, area.columns - at), true);
  const auto all = rows();
  std::vector<ListRow> pictures;
  for (const Row& row : all) pictures.push_back(picture_of_row(row, area.columns));
  const int below = std::min(3, area.rows / 4);
  const Area list{area.row + 1, area.column, std::max(0, area.rows - 1 - below), area.columns};
  draw_list(canvas, list, pictures, place_);
  std::string hint = hint_;
  const auto selected = static_cast<std::size_t>(place_.selected);
  if (hint.empty() && selected < all.size() && all[selected].kind == RowKind::entry)
    hint = entries_[all[selected].entry].why_not;
  if (hint.empty() && marked_.empty())
    hint = "Space marks files, Enter takes them or opens a folder; or type a path, Tab completes it.";
  if (hint.empty()) hint = fmt::format("{} marked: Enter takes them", marked_.size());
  const Area text{list.row + list.rows, area.column, below, area.columns};
  canvas.paragraph(text, 0, hint, Tone::faint);
}

CellPosition LaserChooser::cursor(const Area& area) const {
  const int at = width_of(kFolder) + width_of(folder_shown(area.columns));
  return {area.row, area.column + at + typed_.cursor_column(std::max(1, area.columns - at))};
}

void LaserChooser::mark(const Row& row) {
  if (row.kind == RowKind::all) {
    for (const FolderEntry& entry : entries_)
      if (entry.readable) marked_.insert(entry.name);
    return;
  }
  if (row.kind != RowKind::entry || entries_[row.entry].folder) return;
  const std::string& name = entries_[row.entry].name;
  if (!marked_.erase(name)) marked_.insert(name);
}

LaserChooser::Answer LaserChooser::enter() {
  const auto all = rows();
  if (typing() && (typed_.text().find('/') != std::string::npos || all.empty())) return enter_typed();
  const auto selected = static_cast<std::size_t>(place_.selected);
  if (selected >= all.size()) return Answer::open;
  const Row row = all[selected];
  const bool on_folder = row.kind == RowKind::entry && entries_[row.entry].folder;
  if (row.kind == RowKind::up && marked_.empty()) {
    go(folder_.parent_path());
    return Answer::open;
  }
  if (on_folder && (marked_.empty() || typing())) {
    go(folder_ / entries_[row.entry].name);
    return Answer::open;
  }
  if (row.kind == RowKind::all) mark(row);
  if (row.kind == RowKind::entry && !on_folder && (marked_.empty() || typing()))
    marked_.insert(entries_[row.entry].name);
  for (const FolderEntry& entry : entries_)
    if (marked_.contains(entry.name)) taken_.push_back((folder_ / entry.name).string());
  return taken_.empty() ? Answer::open : Answer::chosen;
}

LaserChooser::Answer LaserChooser::enter_typed() {
  const std::string typed = typed_.text();
  const fs::path path = typed.starts_with("~") ? home() / typed.substr(typed.size() > 1 ? 2 : 1) : folder_ / typed;
  std::error_code fault;
  if (fs::is_directory(path, fault)) {
    go(path);
  } else if (fs::exists(path, fault)) {
    taken_ = {path.string()};
    return Answer::chosen;
  } else {
    hint_ = fmt::format("there is no {}", path.string());
  }
  return Answer::open;
}

void LaserChooser::complete() {
  const std::string typed = typed_.text();
  if (typed.empty()) {
    const auto all = rows();
    const auto selected = static_cast<std::size_t>(place_.selected);
    if (selected < all.size() && all[selected].kind == RowKind::entry) typed_.set(entries_[all[selected].entry].name);
    return;
  }
  const bool whole = typed.starts_with("/") || typed.starts_with("~");
  const std::string begin =
      typed.starts_with("~") ? home().string() + typed.substr(1) : (whole ? typed : (folder_ / typed).string());
  const PathCompletion found = completed_path(begin);
  hint_ = fmt::format("{}", fmt::join(found.choices, "  "));
  std::error_code fault;
  if (found.completed.ends_with("/") && fs::is_directory(found.completed, fault)) {
    go(found.completed);
    return;
  }
  const std::string prefix = folder_.string() + "/";
  typed_.set(!whole && found.completed.starts_with(prefix) ? found.completed.substr(prefix.size()) : found.completed);
}

LaserChooser::Answer LaserChooser::on_key(const Key& key) {
  hint_.clear();
  const auto all = rows();
  if (key.name == Key::Name::escape) {
    if (!typing()) return Answer::given_up;
    typed_ = TextLine();
    place_ = {};
    return Answer::open;
  }
  if (place_.on_key(key, static_cast<int>(all.size()))) return Answer::open;
  if (key.name == Key::Name::enter) return enter();
  const auto selected = static_cast<std::size_t>(place_.selected);
  if (key.name == Key::Name::tab) {
    complete();
    place_ = {};
  } else if (is_letter(key, U' ') && !typing()) {
    if (selected < all.size()) mark(all[selected]);
    (void)place_.on_key({Key::Name::down}, static_cast<int>(all.size()));
  } else if (!typing() && (key.name == Key::Name::backspace || key.name == Key::Name::left)) {
    go(folder_.parent_path());
  } else if (!typing() && key.name == Key::Name::right && selected < all.size() &&
             all[selected].kind == RowKind::entry && entries_[all[selected].entry].folder) {
    go(folder_ / entries_[all[selected].entry].name);
  } else if (typed_.on_key(key)) {
    place_ = {};
  }
  return Answer::open;
}

std::vector<std::pair<std::string, std::string>> LaserChooser::keys() const {
  return {{"Space", "mark"},
          {"Enter", "take or open"},
          {"Backspace", "folder above"},
          {"Tab", "complete"},
          {"Esc", "back"}};
}

}  // namespace ecs::app
