#include "app/screens/memory/screen.hpp"

#include <algorithm>
#include <charconv>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/ui/widgets.hpp"
#include "base/json.hpp"
#include "base/text.hpp"

namespace ecs::app {
namespace {

std::optional<Address> hexadecimal(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with("0x") || text.starts_with("0X")) text.remove_prefix(2);
  Address value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string dump_name() { return fmt::format("unit-{:%Y%m%d-%H%M%S}.ecsdump", fmt::localtime(std::time(nullptr))); }

}  // namespace

void MemoryScreen::begin_typing(Typing what, const std::string& text) {
  typing_ = what;
  text_.set(text);
  target_ = {};
  choices_.clear();
  controller_.message().clear();
}

void MemoryScreen::choose_dump() {
  files_.choose("Open a dump of a unit's memory, or a memory image", {{FileKind::memory}, false, "back to the unit"},
                [this](const std::string& path) { controller_.open(path); });
}

void MemoryScreen::choose_comparison() {
  files_.choose("Compare with a dump of a unit's memory", {{FileKind::memory}, false, "compare no more"},
                [this](const std::string& path) {
                  if (path.empty())
                    controller_.end_comparison();
                  else
                    controller_.compare_with(path);
                });
}

std::string MemoryScreen::prompt() const {
  switch (typing_) {
    case Typing::place:
      return "go to";
    case Typing::sought:
      return "find";
    case Typing::bytes:
      return fmt::format("write at {}", hex_address(controller_.cursor()));
    case Typing::file_to_save:
      return scope_ == DumpScope::all ? "save all memory to" : "save the active map to";
    default:
      return "";
  }
}

std::string MemoryScreen::hint() const {
  switch (typing_) {
    case Typing::place:
      return "an address in hexadecimal, or a part of a name; up and down choose, Enter goes";
    case Typing::sought:
    case Typing::bytes:
      return std::string(kPatternHint);
    case Typing::file_to_save:
      return "up and down: all memory or only the active map; Enter begins";
    default:
      return "";
  }
}

std::vector<MemoryScreen::Target> MemoryScreen::targets() const {
  const std::string part = lower(trimmed(text_.text()));
  std::vector<Target> found;
  const auto address = hexadecimal(part);
  if (address && controller_.memory().region_of(*address))
    found.push_back({*address, fmt::format("{}  the address", hex_address(*address))});
  const auto add = [&](Address at, const std::string& name, const std::string& detail) {
    if (lower(name).find(part) != std::string::npos)
      found.push_back({at, fmt::format("{}  {:<34} {}", hex_address(at), name, detail)});
  };
  for (const MemoryRegion& region : controller_.memory().regions())
    add(region.first, region.name, fmt::format("{} bytes{}", region.size, region.writable ? "" : ", protected"));
  for (const NamedStretch& stretch : controller_.names().all()) add(stretch.first, stretch.name, stretch.value);
  return found;
}

void MemoryScreen::typed() {
  const Typing what = typing_;
  const std::string text(trimmed(text_.text()));
  typing_ = Typing::nothing;
  if (what == Typing::place) {
    const auto found = targets();
    if (found.empty())
      controller_.message().say(fmt::format("no memory and no name like \"{}\"", text), Tone::bad);
    else
      controller_.go(
          found[static_cast<std::size_t>(std::clamp(target_.selected, 0, static_cast<int>(found.size()) - 1))].address);
  }
  if (what == Typing::sought) controller_.seek(text);
  if (what == Typing::bytes) controller_.propose(text);
  if (what == Typing::file_to_save) controller_.save(text, scope_);
}

void MemoryScreen::on_typing_key(const Key& key) {
  const bool file = typing_ == Typing::file_to_save;
  if (key.name == Key::Name::escape) {
    typing_ = Typing::nothing;
  } else if (key.name == Key::Name::enter) {
    typed();
  } else if (key.name == Key::Name::tab && file) {
    const PathCompletion completion = completed_path(text_.text());
    text_.set(completion.completed);
    choices_.clear();
    for (const std::string& choice : completion.choices) choices_ += (choices_.empty() ? "" : "  ") + choice;
  } else if (typing_ == Typing::file_to_save && (key.name == Key::Name::up || key.name == Key::Name::down)) {
    scope_ = scope_ == DumpScope::all ? DumpScope::active : DumpScope::all;
  } else if (typing_ == Typing::place && (key.name == Key::Name::up || key.name == Key::Name::down)) {
    (void)target_.on_key(key, static_cast<int>(targets().size()));
  } else if (text_.on_key(key)) {
    target_ = {};
    choices_.clear();
  }
}

bool MemoryScreen::on_move_key(const Key& key) {
  const auto row = static_cast<long long>(rows_.per_row);
  const MemoryRegion* region = controller_.memory().region_of(controller_.cursor());
  switch (key.name) {
    case Key::Name::left:
      controller_.move(-1);
      return true;
    case Key::Name::right:
      controller_.move(1);
      return true;
    case Key::Name::up:
      controller_.move(-row);
      return true;
    case Key::Name::down:
      controller_.move(row);
      return true;
    case Key::Name::wheel_up:
      controller_.move(-3 * row);
      return true;
    case Key::Name::wheel_down:
      controller_.move(3 * row);
      return true;
    case Key::Name::page_up:
      controller_.move(-row * rows_.rows);
      return true;
    case Key::Name::page_down:
      controller_.move(row * rows_.rows);
      return true;
    case Key::Name::home:
      if (region != nullptr) controller_.go(region->first);
      return true;
    case Key::Name::end:
      if (region != nullptr) controller_.go(region->last());
      return true;
    case Key::Name::mouse:
      if (region != nullptr)
        if (const auto at = byte_at(rows_area_, rows_, *region, {key.row, key.column})) controller_.go(*at);
      return true;
    default:
      return false;
  }
}

void MemoryScreen::on_list_key(const Key& key) {
  const auto& rows = controller_.differences();
  const auto& written = controller_.written();
  const bool differences = page_ == Page::differences;
  const int count = static_cast<int>(differences ? rows.size() : written.size());
  ListPlace& place = differences ? difference_ : write_;
  if (const auto clicked = place.clicked(key); clicked && *clicked < count) place.selected = *clicked;
  if (place.on_key(key, count) || key.name != Key::Name::enter || count == 0) return;
  const auto chosen = static_cast<std::size_t>(std::clamp(place.selected, 0, count - 1));
  controller_.go(differences ? rows[chosen].first : written[chosen].address);
  page_ = Page::bytes;
}

void MemoryScreen::to_named(bool forward) {
  const auto to =
      forward ? controller_.names().next(controller_.cursor()) : controller_.names().previous(controller_.cursor());
  if (to)
    controller_.go(*to);
  else
    controller_.message().say(forward ? "no name after this place" : "no name before this place", Tone::warning);
}

std::vector<KeyRow> MemoryScreen::key_table() {
  const auto page = [this](Page to) { return [this, to] { page_ = to; }; };
  const auto write = [this] {
    if (controller_.lets_write()) begin_typing(Typing::bytes);
  };
  const auto undo = [this] { controller_.propose_undo(); };
  return {{"g", "go to", [this] { begin_typing(Typing::place); }},
          {"/ m", "find, next"},
          {"/", "", [this] { begin_typing(Typing::sought); }},
          {"m", "", [this] { controller_.seek_on(); }},
          {"n p", "field"},
          {"n", "", [this] { to_named(true); }},
          {"p", "", [this] { to_named(false); }},
          {"w u", "write, undo"},
          {"w", "", write},
          {"u Ctrl-Z", "", undo},
          {"c d", "compare, next"},
          {"c", "", [this] { choose_comparison(); }},
          {"d", "", [this] { controller_.to_next_difference(); }},
          {"s o", "save, open"},
          {"s", "", [this] { begin_typing(Typing::file_to_save, dump_name()); }},
          {"o", "", [this] { choose_dump(); }},
          {"a r", "read the region, read again"},
          {"a", "", [this] { controller_.read_region(); }},
          {"r", "", [this] { controller_.read_again(rows_.shown()); }},
          {"Tab 1 2 3", "bytes, differences, written"},
          {"Tab", "", [this] { page_ = static_cast<Page>((static_cast<int>(page_) + 1) % 3); }},
          {"1", "", page(Page::bytes)},
          {"2", "", page(Page::differences)},
          {"3", "", page(Page::written)}};
}

Step MemoryScreen::on_key(const Key& key) {
  if (answers(controller_.asking(), key) || files_.on_key(key)) return stay();
  if (typing()) {
    on_typing_key(key);
    return stay();
  }
  if (key.name == Key::Name::escape || is_letter(key, U'q')) {
    if (controller_.working_on().empty()) return back();
    controller_.cancel();
    return stay();
  }
  if (key.name == Key::Name::resized) return stay();
  controller_.message().clear();
  if (act_on(keys_, key)) return stay();
  if (page_ != Page::bytes)
    on_list_key(key);
  else
    (void)on_move_key(key);
  return stay();
}

std::vector<KeyHelp> MemoryScreen::keys() const {
  if (files_.active()) return files_.keys();
  if (typing()) return {{"Enter", "done"}, {"Esc", "leave it"}};
  return helps_of(keys_);
}

std::string MemoryScreen::help() const {
  return "The unit's memory, or a dump of one: bytes as hexadecimal digits and characters, what is under the cursor by "
         "name with its value, and the same bytes as plain numbers. Pages are read when they come into view; .. is not "
         "read yet. [45] is the cursor, 45* differs from the file compared. Protected regions can be read only. "
         "Writing needs integration mode, asks first, is read back, and u writes the old bytes back.";
}

CellPosition MemoryScreen::cursor(const Area& area) const {
  if (files_.active()) return files_.cursor(area.between_margins(), 0);
  if (!typing()) return {-1, -1};
  const int begin = width_of(prompt()) + 3;
  return {area.row + area.rows - 2, area.column + begin + text_.cursor_column(std::max(1, area.columns - begin - 1))};
}

}  // namespace ecs::app
