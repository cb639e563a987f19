#include "app/screens/memory/screen.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/utility/unit_view.hpp"

namespace ecs::app {
MemoryScreen::MemoryScreen(std::shared_ptr<UnitConnection> unit) : unit_(std::move(unit)) {
  const auto page = [this](Page to) { return [this, to] { page_ = to; }; };
  const auto undo = [this] { propose_undo(); };
  const auto save = [this](DumpScope scope) { return [this, scope] { ask_to_save(scope); }; };
  keys_ = {{"g", "go to", [this] { begin_placing(); }},
           {"/ m", "find, next"},
           {"/", "", [this] { ask_for_bytes("find:", [this](const std::string& typed) { return seek(typed); }); }},
           {"m", "", [this] { seek_on(); }},
           {"n p", "field"},
           {"n", "", [this] { to_named(true); }},
           {"p", "", [this] { to_named(false); }},
           {"w u", "write, undo"},
           {"w", "", [this] { ask_to_write_here(); }},
           {"u Ctrl-Z", "", undo},
           {"c d", "compare, next"},
           {"c", "", [this] { choose_comparison(); }},
           {"d", "", [this] { to_next_difference(); }},
           {"s S o", "save all, the active map, open"},
           {"s", "", save(DumpScope::all)},
           {"S", "", save(DumpScope::active)},
           {"o", "", [this] { choose_dump(); }},
           {"a r", "read the region, read again"},
           {"a", "", [this] { read_region(); }},
           {"r", "", [this] { read_again(); }},
           {"Tab 1 2 3", "bytes, differences, written"},
           {"Tab", "", [this] { page_ = static_cast<Page>((static_cast<int>(page_) + 1) % 3); }},
           {"1", "", page(Page::bytes)},
           {"2", "", page(Page::differences)},
           {"3", "", page(Page::written)}};
}

std::string MemoryScreen::help() const {
  return "The unit's memory, or a dump of it: bytes as hexadecimal digits and characters, the name and value of the "
         "field under the cursor, and the same bytes as plain numbers. Pages are read when they come into view; .. "
         "marks unread bytes. [45] is the cursor, 45* differs from the compared file. Protected regions are read-only. "
         "Writing needs integration mode, asks for confirmation and is read back. Press u to restore the old bytes.";
}

Step MemoryScreen::leave() {
  if (working_on().empty()) return back();
  cancel();
  return stay();
}

void MemoryScreen::on_other_key(const Key& key) {
  if (page_ != Page::bytes)
    on_list_key(key);
  else
    on_move_key(key);
}

void MemoryScreen::on_move_key(const Key& key) {
  using Name = Key::Name;
  const auto row = static_cast<long long>(rows_.per_row);
  const std::pair<Name, long long> moves[] = {{Name::left, -1},
                                              {Name::right, 1},
                                              {Name::up, -row},
                                              {Name::down, row},
                                              {Name::wheel_up, -3 * row},
                                              {Name::wheel_down, 3 * row},
                                              {Name::page_up, -row * rows_.rows},
                                              {Name::page_down, row * rows_.rows}};
  for (const auto& [name, bytes] : moves)
    if (key.name == name) return move(bytes);
  const MemoryRegion* region = memory_.region_of(cursor_);
  if (region == nullptr) return;
  if (key.name == Name::home) go(region->first);
  if (key.name == Name::end) go(region->last());
  if (key.name == Name::mouse)
    if (const auto at = byte_at(rows_area_, rows_, *region, {key.row, key.column})) go(*at);
}

void MemoryScreen::on_list_key(const Key& key) {
  const bool differences = page_ == Page::differences;
  const int count = static_cast<int>(differences ? differences_.size() : written_.size());
  ListPlace& place = differences ? difference_ : write_;
  if (const auto clicked = place.clicked(key); clicked && *clicked < count) place.selected = *clicked;
  if (place.on_key(key, count) || key.name != Key::Name::enter || count == 0) return;
  const auto chosen = static_cast<std::size_t>(std::clamp(place.selected, 0, count - 1));
  go(differences ? differences_[chosen].first : written_[chosen].address);
  page_ = Page::bytes;
}

void MemoryScreen::to_named(bool forward) {
  const auto to = forward ? names_.next(cursor_) : names_.previous(cursor_);
  if (to) return go(*to);
  message_.say(forward ? "no name after this place" : "no name before this place", Tone::warning);
}

// --- a place typed: an address, or a part of a name
void MemoryScreen::begin_placing() {
  placing_ = true;
  text_.set("");
  target_ = {};
}

std::vector<MemoryScreen::Target> MemoryScreen::targets() const {
  const std::string part = lower(trimmed(text_.text()));
  std::vector<Target> found;
  const auto address = hexadecimal(part.starts_with("0x") ? part.substr(2) : part);
  if (address && memory_.region_of(*address))
    found.push_back({*address, fmt::format("{}  the address", hex_address(*address))});
  const auto add = [&](Address at, const std::string& name, const std::string& detail) {
    if (lower(name).find(part) != std::string::npos)
      found.push_back({at, fmt::format("{}  {:<34} {}", hex_address(at), name, detail)});
  };
  for (const MemoryRegion& region : memory_.regions())
    add(region.first, region.name, fmt::format("{} bytes{}", region.size, region.writable ? "" : ", protected"));
  for (const NamedStretch& stretch : names_.all()) add(stretch.first, stretch.name, stretch.value);
  return found;
}

void MemoryScreen::on_edit_key(const Key& key) {
  refused_place_.clear();
  const auto found = targets();
  const int count = static_cast<int>(found.size());
  if (key.name == Key::Name::up || key.name == Key::Name::down) {
    (void)target_.on_key(key, count);
  } else if (key.name == Key::Name::escape) {
    placing_ = false;
  } else if (key.name == Key::Name::enter) {
    if (found.empty()) {
      refused_place_ = fmt::format("no such address or name: \"{}\"", trimmed(text_.text()));
      return;
    }
    placing_ = false;
    go(found[static_cast<std::size_t>(std::clamp(target_.selected, 0, count - 1))].address);
  } else if (text_.on_key(key)) {
    target_ = {};
  }
}

CellPosition MemoryScreen::cursor(const Area& area) const {
  if (prompt_.choosing()) return prompt_.cursor(area.between_margins(), 0);
  const Area bottom = last_rows(area.between_margins(), 2);
  if (placing_) return {bottom.row, bottom.column + kPlaceColumn + text_.cursor_column(bottom.columns - kPlaceColumn)};
  return prompt_.cursor(bottom, 1);
}

// --- files and bytes asked for
void MemoryScreen::choose_dump() {
  prompt_.choose("Open a dump of a unit's memory, or a memory image", {{FileKind::memory}, false, "back to the unit"},
                 [this](const std::string& path) { open(path); });
}

void MemoryScreen::choose_comparison() {
  prompt_.choose("Compare with a dump of a unit's memory", {{FileKind::memory}, false, "end comparison"},
                 [this](const std::string& path) {
                   if (!path.empty()) return compare_with(path);
                   other_.reset();
                   compare_again();
                 });
}

void MemoryScreen::ask_for_bytes(const std::string& label, std::function<std::string(const std::string&)> take) {
  prompt_.ask(label, Prompt::Kind::text, "", std::move(take), std::string(kPatternHint));
}

void MemoryScreen::ask_to_write_here() {
  if (lets_write())
    ask_for_bytes(fmt::format("write at {}:", hex_address(cursor_)),
                  [this](const std::string& typed) { return propose(typed); });
}

void MemoryScreen::ask_to_save(DumpScope scope) {
  if (is_file()) return message_.say("this is a file already", Tone::warning);
  ask_where_to_save(scope == DumpScope::all ? "save all memory to:" : "save the active map to:",
                    file_name_now("unit", ".ecsdump"), [this, scope](const std::string& path) { save(path, scope); });
}

}  // namespace ecs::app
