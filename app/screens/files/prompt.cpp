#include "app/screens/files/prompt.hpp"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/screens/files/keyed_screen.hpp"
#include "base/file.hpp"
#include "commissioning/link/choice.hpp"
#include "commissioning/link/emulator_process.hpp"
#include "commissioning/session/remembered.hpp"

namespace ecs::app {
namespace {

namespace fs = std::filesystem;
constexpr const char* kFolder = "Folder ";
constexpr std::size_t kMostRecent = 4;       ///< rows of files used last
constexpr std::size_t kRecentLookedAt = 12;  ///< files used last that are looked into to find those

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

/// The machine of the emulator that this program runs, and what comes with it: somebody who begins has no files of
/// their own. Nothing beside a real unit: its machine is another one.
std::vector<std::string> files_of_the_emulator() {
  std::vector<std::string> files;
  const auto machine = emulated_machine();
  if (!machine) return files;
  const fs::path folder = machine->parent_path();
  for (const fs::path& path : {*machine, folder / "parameters.toml", folder / "model.toml"})
    if (disc::is_file(path)) files.push_back(disc::absolute(path).string());
  return files;
}

bool holds(const std::vector<std::pair<std::string, FileLook>>& files, const std::string& path) {
  return std::any_of(files.begin(), files.end(), [&](const auto& file) { return file.first == path; });
}

/// Of this program; "/" where it has none.
fs::path samples_folder() {
  const auto machine = sample_machine();
  return machine ? fs::weakly_canonical(machine->parent_path().parent_path()) : fs::path("/");
}

/// With its folder: "before/EXX.csv".
std::string short_name(const fs::path& path) {
  return path.parent_path().filename().string() + "/" + path.filename().string();
}

fs::path home() {
  const char* folder = std::getenv("HOME");
  return folder == nullptr ? fs::path("/") : fs::path(folder);
}

}  // namespace

bool FileWish::has(FileKind kind) const {
  return kinds.empty() || std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

FileChooser::FileChooser(const fs::path& folder, FileWish wish) : wish_(std::move(wish)) { go(folder); }

void FileChooser::refuse(const std::string& why) {
  taken_.clear();
  hint_ = why;
  refused_ = true;
}

void FileChooser::go(const fs::path& folder) {
  std::error_code fault;
  folder_ = fs::weakly_canonical(fs::absolute(folder, fault), fault);
  entries_ = entries_of(folder_);
  marked_.clear();
  typed_ = TextLine();
  hint_.clear();
  place_ = {};
  moved_ = false;
  if (looking_.running()) {
    looking_.cancel();
    look_again_ = true;
    return;
  }
  look_again_ = false;
  const auto look = [folder = folder_, entries = entries_, wish = wish_](JobControl& control) {
    Looked looked;
    for (const FolderEntry& entry : entries) {
      if (control.cancelled) break;
      if (!entry.folder) looked.entries.emplace(entry.name, looked_at(folder / entry.name));
    }
    auto recent = recent_files();
    recent.resize(std::min(recent.size(), kRecentLookedAt));
    for (const std::string& path : recent) {
      if (control.cancelled || looked.recent.size() == kMostRecent) break;
      if (fs::path(path).parent_path() == folder) continue;
      if (FileLook file = looked_at(path); wish.has(file.kind)) {
        file.what += ", used last";
        looked.recent.emplace_back(path, std::move(file));
      }
    }
    if (!wish.kinds.empty() && !wish.many)
      for (const std::string& path : files_of_the_emulator())
        if (FileLook file = looked_at(path);
            wish.has(file.kind) && !holds(looked.recent, path) && fs::path(path).parent_path() != folder) {
          file.what += ", of the bundled emulator";
          looked.recent.emplace_back(path, std::move(file));
        }
    return looked;
  };
  looking_.start("looking", look, [this](Looked looked) { take(std::move(looked)); });
}

void FileChooser::take(Looked looked) {
  if (look_again_) {
    const std::string typed = typed_.text();
    const ListPlace place = place_;
    go(folder_);
    typed_.set(typed);
    place_ = place;
    return;
  }
  recent_ = std::move(looked.recent);
  for (FolderEntry& entry : entries_)
    if (const auto found = looked.entries.find(entry.name); found != looked.entries.end()) {
      entry.look = found->second;
      entry.looked_at = true;
    }
  if (!moved_ && !typing() && !wish_.many) put_wished_first();
}

/// Of one file alone: those of the kinds wished for first, the cursor on the first of them in this folder.
void FileChooser::put_wished_first() {
  if (wish_.kinds.empty() || !wish_.none.empty()) return;
  std::stable_sort(entries_.begin(), entries_.end(),
                   [this](const FolderEntry& a, const FolderEntry& b) { return wished(a) && !wished(b); });
  const auto all = rows();
  const auto first_of = [&](auto&& is) { return std::find_if(all.begin(), all.end(), is); };
  auto first = first_of([this](const Row& row) { return row.kind == RowKind::entry && wished(entries_[row.at]); });
  if (first == all.end()) first = first_of([](const Row& row) { return row.kind == RowKind::recent; });
  place_.selected = first == all.end() ? 0 : static_cast<int>(first - all.begin());
}

bool FileChooser::wished(const FolderEntry& entry) const {
  return entry.looked_at && entry.look.kind != FileKind::other && wish_.has(entry.look.kind);
}

/// A map is opened alone.
bool FileChooser::is_one_of_all(const FolderEntry& entry) const {
  return wished(entry) && entry.look.kind != FileKind::map;
}

std::size_t FileChooser::readable() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(entries_, [this](const FolderEntry& entry) { return is_one_of_all(entry); }));
}

std::vector<FileChooser::Row> FileChooser::rows() const {
  const std::string typed = typed_.text();
  std::vector<Row> rows;
  if (typed.empty() && !wish_.none.empty()) rows.push_back({RowKind::none, 0});
  if (typed.empty()) rows.push_back({RowKind::up, 0});
  if (typed.empty() && wish_.many && readable() > 1) rows.push_back({RowKind::all, 0});
  if (typed.empty())
    for (std::size_t k = 0; k < recent_.size(); ++k) rows.push_back({RowKind::recent, k});
  for (std::size_t k = 0; k < entries_.size(); ++k)
    if (entries_[k].name.starts_with(typed)) rows.push_back({RowKind::entry, k});
  if (typed.empty() && !folder_.string().starts_with(samples_folder().string())) rows.push_back({RowKind::samples, 0});
  return rows;
}

/// What the names of the files used last need, at most this many.
int FileChooser::recent_columns(int most) const {
  int columns = 12;
  for (const auto& [path, look] : recent_) columns = std::max(columns, width_of(short_name(path)) + 1);
  return std::min(columns, most);
}

ListRow FileChooser::picture_of_row(const Row& row, int columns) const {
  if (row.kind == RowKind::none) return {fmt::format("    [{}]", wish_.none), Tone::strong};
  if (row.kind == RowKind::up) return {"    ..", Tone::plain};
  if (row.kind == RowKind::samples) return {"    [samples: machines, plans, measurements, models]", Tone::strong};
  if (row.kind == RowKind::all) return {fmt::format("    [all {} measurement files here]", readable()), Tone::strong};
  const int names = std::clamp(columns * 2 / 5, 12, 40);
  if (row.kind == RowKind::recent) {
    const auto& [path, look] = recent_[row.at];
    const char* marked = marked_.contains(path) ? "[x] " : (wish_.many ? "[ ] " : "    ");
    return {fmt::format("{}{} {}", marked, in_columns(short_name(path), recent_columns(names)), look.what),
            Tone::strong};
  }
  const FolderEntry& entry = entries_[row.at];
  const char* mark = marked_.contains(entry.name) ? "[x] " : (entry.folder || !wish_.many ? "    " : "[ ] ");
  const std::string name = in_columns(entry.name + (entry.folder ? "/" : ""), names);
  const std::string what = entry.folder ? "" : (entry.looked_at ? entry.look.what : "...");
  return {fmt::format("{}{} {}", mark, name, what), entry.folder || wished(entry) ? Tone::plain : Tone::faint};
}

/// The end of the path, where the whole of it would leave no room to type.
std::string FileChooser::folder_shown(int columns) const {
  std::u32string shown = code_points(folder_.string() + (folder_ == folder_.root_path() ? "" : "/"));
  const int room = std::max(10, columns - width_of(kFolder) - 20);
  if (width_of(utf8_of(shown)) <= room) return utf8_of(shown);
  while (width_of(utf8_of(shown)) > room - 3) shown.erase(0, 1);
  return "..." + utf8_of(shown);
}

void FileChooser::draw(Canvas& canvas, const Area& area) const {
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
    hint = wished(entries_[all[selected].at]) ? "" : entries_[all[selected].at].look.why_not;
  if (hint.empty() && selected < all.size() && all[selected].kind == RowKind::recent)
    hint = recent_[all[selected].at].first;
  if (hint.empty() && marked_.empty())
    hint = wish_.many ? "Space marks files, Enter selects them or opens a folder. Or type a path: Tab completes it."
                      : "Enter selects the file or opens the folder. Or type a path: Tab completes it.";
  if (hint.empty())
    hint = fmt::format("{} marked: Enter selects {}", marked_.size(), marked_.size() == 1 ? "it" : "them");
  const Area text{list.row + list.rows, area.column, below, area.columns};
  canvas.paragraph(text, 0, hint, refused_ ? Tone::bad : Tone::faint);
}

CellPosition FileChooser::cursor(const Area& area) const {
  const int at = width_of(kFolder) + width_of(folder_shown(area.columns));
  return {area.row, area.column + at + typed_.cursor_column(std::max(1, area.columns - at))};
}

void FileChooser::mark(const Row& row) {
  if (row.kind == RowKind::all) {
    for (const FolderEntry& entry : entries_)
      if (is_one_of_all(entry)) marked_.insert(entry.name);
    return;
  }
  if (row.kind != RowKind::recent && (row.kind != RowKind::entry || entries_[row.at].folder)) return;
  const std::string& name = row.kind == RowKind::recent ? recent_[row.at].first : entries_[row.at].name;
  if (!marked_.erase(name)) marked_.insert(name);
}

FileChooser::Answer FileChooser::enter() {
  const auto all = rows();
  if (typing() && (typed_.text().find('/') != std::string::npos || all.empty())) return enter_typed();
  const auto selected = static_cast<std::size_t>(place_.selected);
  if (selected >= all.size()) return Answer::open;
  const Row row = all[selected];
  const bool on_folder = row.kind == RowKind::entry && entries_[row.at].folder;
  if (row.kind == RowKind::up && marked_.empty()) {
    go(folder_.parent_path());
    return Answer::open;
  }
  if (row.kind == RowKind::samples && marked_.empty()) {
    go(samples_folder());
    return Answer::open;
  }
  if (on_folder && (marked_.empty() || typing())) {
    go(folder_ / entries_[row.at].name);
    return Answer::open;
  }
  if (row.kind == RowKind::none) {
    taken_ = {""};
    return Answer::chosen;
  }
  if (row.kind == RowKind::recent && marked_.empty()) {
    taken_ = {recent_[row.at].first};
    return taken_now();
  }
  const auto marked = marked_;  // Enter marks for this choice only: it may be refused
  if (row.kind == RowKind::all) mark(row);
  if (row.kind == RowKind::entry && !on_folder && (marked_.empty() || typing())) marked_.insert(entries_[row.at].name);
  for (const auto& [path, look] : recent_)
    if (marked_.contains(path)) taken_.push_back(path);
  for (const FolderEntry& entry : entries_)
    if (marked_.contains(entry.name)) taken_.push_back((folder_ / entry.name).string());
  marked_ = marked;
  return taken_now();
}

FileChooser::Answer FileChooser::taken_now() {
  for (auto path = taken_.rbegin(); path != taken_.rend(); ++path) remember_file(*path);
  return taken_.empty() ? Answer::open : Answer::chosen;
}

FileChooser::Answer FileChooser::enter_typed() {
  const std::string typed = typed_.text();
  fs::path path = typed.starts_with("~") ? home() / typed.substr(typed.size() > 1 ? 2 : 1) : folder_ / typed;
  if (!disc::exists(path) && disc::exists(typed)) path = disc::absolute(typed);  // as a shell takes it
  if (disc::is_folder(path)) {
    go(path);
  } else if (disc::exists(path)) {
    taken_ = {path.string()};
    return taken_now();
  } else {
    refuse(fmt::format("there is no {}", path.string()));
  }
  return Answer::open;
}

void FileChooser::complete() {
  const std::string typed = typed_.text();
  if (typed.empty()) {
    const auto all = rows();
    const auto selected = static_cast<std::size_t>(place_.selected);
    if (selected < all.size() && all[selected].kind == RowKind::entry) typed_.set(entries_[all[selected].at].name);
    return;
  }
  const bool whole = typed.starts_with("/") || typed.starts_with("~");
  const std::string begin =
      typed.starts_with("~") ? home().string() + typed.substr(1) : (whole ? typed : (folder_ / typed).string());
  const PathCompletion found = completed_path(begin);
  hint_ = fmt::format("{}", fmt::join(found.choices, "  "));
  if (found.completed.ends_with("/") && disc::is_folder(found.completed)) {
    go(found.completed);
    return;
  }
  const std::string prefix = folder_.string() + "/";
  typed_.set(!whole && found.completed.starts_with(prefix) ? found.completed.substr(prefix.size()) : found.completed);
}

FileChooser::Answer FileChooser::on_key(const Key& key) {
  hint_.clear();
  refused_ = false;
  const auto all = rows();
  if (key.name == Key::Name::escape) {
    if (!typing()) return Answer::given_up;
    typed_ = TextLine();
    place_ = {};
    return Answer::open;
  }
  if (place_.on_key(key, static_cast<int>(all.size()))) {
    moved_ = true;
    return Answer::open;
  }
  if (key.name == Key::Name::enter) return enter();
  const auto selected = static_cast<std::size_t>(place_.selected);
  if (key.name == Key::Name::tab) {
    complete();
    place_ = {};
  } else if (is_letter(key, U' ') && !typing() && wish_.many) {
    if (selected < all.size()) mark(all[selected]);
    (void)place_.on_key({Key::Name::down}, static_cast<int>(all.size()));
  } else if (!typing() && (key.name == Key::Name::backspace || key.name == Key::Name::left)) {
    go(folder_.parent_path());
  } else if (!typing() && key.name == Key::Name::right && selected < all.size() &&
             all[selected].kind == RowKind::entry && entries_[all[selected].at].folder) {
    go(folder_ / entries_[all[selected].at].name);
  } else if (typed_.on_key(key)) {
    place_ = {};
  }
  return Answer::open;
}

std::vector<std::pair<std::string, std::string>> FileChooser::keys() const {
  if (!wish_.many)
    return {{"Enter", "select or open"}, {"Backspace", "folder above"}, {"Tab", "complete"}, {"Esc", "back"}};
  return {{"Space", "mark"},
          {"Enter", "select or open"},
          {"Backspace", "folder above"},
          {"Tab", "complete"},
          {"Esc", "back"}};
}

void Prompt::begin(std::string label, Kind kind, const std::string& text, Take take, std::string hint) {
  chooser_.reset();
  label_ = std::move(label);
  kind_ = kind;
  line_.propose(text);
  help_ = std::move(hint);
  hint_.clear();
  refused_ = false;
  take_ = std::move(take);
  may_be_empty_ = false;
  complete_ = nullptr;
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
  std::unique_ptr<FileChooser> chooser = std::move(chooser_);
  const TakeFiles take = std::exchange(take_files_, nullptr);
  const std::string refusal = answer == FileChooser::Answer::chosen ? take(chooser->taken()) : "";
  if (refusal.empty()) return;
  chooser->refuse(refusal);
  chooser_ = std::move(chooser);
  take_files_ = take;
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
    if (const std::string text = line_.text(); text.empty() && !may_be_empty_)
      take_ = nullptr;
    else
      give(text);
  } else if (key.name == Key::Name::tab && complete_) {
    line_.set(complete_(line_.text()));
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
  const std::string ways = "Enter accepts, Esc cancels";
  const Tone tone = refused_ ? Tone::bad : Tone::faint;
  const int beside = begin + columns(area) + 2;
  if (kind_ == Kind::number && !refused_) {
    canvas.paragraph({area.row + row, area.column + beside, 1, std::max(0, area.columns - beside)}, 0, ways, tone);
    return;
  }
  const std::string completes = kind_ == Kind::path ? "Tab completes the path" : "";
  std::string help = help_;
  for (const std::string& part : {completes, help_.empty() || completes.empty() ? ways : std::string()})
    if (!part.empty()) help += (help.empty() ? "" : "; ") + part;
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
    std::vector<KeyHelp> keys{{"Enter", "accept"}, {"Esc", "cancel"}};
    if (kind_ == Kind::path) keys.insert(keys.begin() + 1, {"Tab", "complete"});
    return keys;
  }
  std::vector<KeyHelp> keys;
  for (const auto& [name, does] : chooser_->keys()) keys.push_back({name, does});
  return keys;
}

void KeyedScreen::ask_where_to_save(const std::string& label, const std::string& proposed,
                                    std::function<void(const std::string&)> save) {
  prompt_.ask(label, Prompt::Kind::path, proposed, [this, save = std::move(save)](const std::string& path) {
    if (!disc::exists(path)) return save(path);
    asking_.ask(
        {"Overwrite " + path + "?", "The file exists. Its contents will be overwritten.", "overwrite", "keep it"},
        [save, path] { save(path); });
  });
}

}  // namespace ecs::app
