// The work of the memory screen: pages read as they are needed, what is sought, compared, written and taken back,
// dumps.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/screens/memory/screen.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/utility/unit_view.hpp"

namespace ecs::app {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kBeforeNextRead = 1s;
constexpr std::uint32_t kPagesSeen = 2;   ///< in one piece of work, so that a cancel and a jump are soon felt
constexpr std::uint32_t kPagesLong = 16;  ///< the same for long reading

std::string name_of_file(const std::string& path) { return std::filesystem::path(path).filename().string(); }

}  // namespace

std::string MemoryScreen::compared_file() const { return name_of_file(other_file_); }

std::string MemoryScreen::source() const {
  if (is_file()) return fmt::format("file {}{}", name_of_file(file_), file_detail_);
  if (serial_number_.empty()) return "unit: no answer yet";
  return fmt::format("unit {}", serial_number_);
}

bool MemoryScreen::look() {
  bool changed = !working_on().empty();
  changed = pages_.advance() || changed;
  changed = task_.advance() || changed;
  changed = follow_unit() || changed;
  if (search_) step_search();
  if (!pages_.running() && !task_.running()) start_needed(rows_.shown());
  return changed;
}

bool MemoryScreen::follow_unit() {
  if (is_file()) return false;
  const WatchedUnit now = unit_->snapshot();
  if (!now.open) {
    if (now.problem.empty() || now.lent || read_failed_) return false;
    message_.say(now.problem, Tone::bad);
    return read_failed_ = true;
  }
  if (!now.identity || now.opened_at == opened_at_) return false;
  const std::string& serial = now.identity->serial_number;
  const bool same = serial == serial_number_ && !memory_.regions().empty();
  opened_at_ = now.opened_at;
  if (same) {
    memory_.forget();
    message_.say("the link was reopened: reading memory again", Tone::warning);
    read_failed_ = false;
    return true;
  }
  memory_ = MemoryBytes::of_unit(now.identity->memory_modules);
  names_ = {};
  serial_number_ = serial;
  if (written_in_ != serial) written_.clear();
  if (read_failed_) message_.clear();
  read_failed_ = false;
  go(cursor_);
  return true;
}

// --- where
void MemoryScreen::go(Address address) {
  if (memory_.regions().empty()) {
    cursor_ = address;
    return;
  }
  const MemoryRegion* nearest = &memory_.regions().front();
  for (const MemoryRegion& region : memory_.regions())
    if (region.first <= address) nearest = &region;
  cursor_ = std::clamp(address, nearest->first, nearest->last());
}

void MemoryScreen::move(long long bytes) {
  const MemoryRegion* region = memory_.region_of(cursor_);
  if (region == nullptr) return;
  const long long to = static_cast<long long>(cursor_) + bytes;
  const MemoryRegion* next = nullptr;
  for (const MemoryRegion& other : memory_.regions()) {
    if (bytes > 0 && other.first > region->last() && (next == nullptr || other.first < next->first)) next = &other;
    if (bytes < 0 && other.last() < region->first && (next == nullptr || other.first > next->first)) next = &other;
  }
  const bool beyond = to < region->first || to > region->last();
  const bool at_edge = cursor_ == (bytes > 0 ? region->last() : region->first);
  if (beyond && next != nullptr && (at_edge || std::abs(bytes) <= 32))
    cursor_ = bytes > 0 ? next->first : next->last();
  else
    cursor_ = static_cast<Address>(std::clamp<long long>(to, region->first, region->last()));
}

// --- reading
Stretch MemoryScreen::needed(const Stretch& shown) const {
  const auto unread = [this](Address first, std::uint32_t bytes, std::uint32_t pages) {
    return memory_.unread(first, first + bytes, pages);
  };
  if (const Stretch seen = unread(shown.first, shown.bytes, kPagesSeen); seen.bytes > 0) return seen;
  for (const Stretch& part : MemoryNames::structure(memory_))
    if (const Stretch names = unread(part.first, part.bytes, kPagesSeen); names.bytes > 0) return names;
  if (search_)
    if (const MemoryRegion* region = memory_.region_of(search_->at))
      if (const Stretch path = memory_.unread(search_->at, region->last() + 1, kPagesLong); path.bytes > 0) return path;
  if (filling_)
    if (const MemoryRegion* region = memory_.region_of(*filling_))
      if (const Stretch rest = unread(region->first, region->size, kPagesLong); rest.bytes > 0) return rest;
  return unread(shown.first + shown.bytes, kPageBytes, 1);
}

void MemoryScreen::start_needed(const Stretch& shown) {
  if (is_file() || memory_.regions().empty() || Clock::now() < not_before_) return;
  if (const WatchedUnit now = unit_->snapshot(); !now.open) return;
  const Stretch stretch = needed(shown);
  if (stretch.bytes > 0) read(stretch);
  if (stretch.bytes == 0 && filling_) filling_.reset();
}

void MemoryScreen::read(const Stretch& stretch) {
  const auto work = [unit = unit_, stretch](JobControl& control) {
    return unit->with_link(control,
                           [&](UnitLink& link) { return link.client().read_memory(stretch.first, stretch.bytes); });
  };
  pages_.start("reading pages", work, [this, stretch](const Result<std::vector<std::uint8_t>>& bytes) {
    if (!pages_.cancelled()) landed(stretch, bytes);
  });
}

void MemoryScreen::landed(const Stretch& stretch, const Result<std::vector<std::uint8_t>>& bytes) {
  if (is_file()) return;
  if (!bytes) {
    not_before_ = Clock::now() + kBeforeNextRead;
    message_.say(bytes.error());
    read_failed_ = true;
    return;
  }
  if (read_failed_) message_.clear();
  read_failed_ = false;
  const auto structure = MemoryNames::structure(memory_);
  memory_.put(stretch.first, *bytes);
  const bool names = std::any_of(structure.begin(), structure.end(), [&](const Stretch& part) {
    return stretch.first < part.first + part.bytes && part.first < stretch.first + stretch.bytes;
  });
  if (const MemoryRegion* region = memory_.region_of(stretch.first)) {
    const bool whole = memory_.part_known(*region) >= 1.0;
    if (names || whole) decode_again();
    if (whole && filling_ == region->first) {
      filling_.reset();
      message_.say(fmt::format("{} read: {} bytes", region->name, region->size));
    }
  }
  compare_again();
}

void MemoryScreen::read_again() {
  const Stretch shown = rows_.shown();
  if (is_file()) return message_.say("this is a file: it does not change", Tone::warning);
  if (pages_.running() || task_.running()) return message_.say("still reading", Tone::warning);
  if (memory_.regions().empty() || !memory_.region_of(shown.first)) return;
  const Address from = memory_.region_of(shown.first)->first;
  const std::uint32_t page = (shown.first - from) / kPageBytes;
  const MemoryRegion& region = *memory_.region_of(shown.first);
  const std::uint32_t end = std::min(region.size, ((shown.first - from + shown.bytes) / kPageBytes + 1) * kPageBytes);
  read({from + page * kPageBytes, end - page * kPageBytes});
  message_.say("read again");
}

void MemoryScreen::read_region() {
  const MemoryRegion* region = memory_.region_of(cursor_);
  if (region == nullptr) return;
  if (memory_.part_known(*region) >= 1.0)
    return message_.say(fmt::format("all of {} is already read", region->name), Tone::warning);
  filling_ = region->first;
  part_begun_ = memory_.part_known(*region);
  begun_ = Clock::now();
}

// --- finding
std::string MemoryScreen::seek(const std::string& typed) {
  auto pattern = pattern_in(typed);
  if (!pattern) return pattern.error().message;
  sought_ = Search{std::move(*pattern), typed, cursor_, cursor_};
  begin_search(cursor_);
  return {};
}

void MemoryScreen::seek_on() {
  if (!sought_) return message_.say("no search yet: press / to search", Tone::warning);
  if (const MemoryRegion* region = memory_.region_of(cursor_)) begin_search(std::min(cursor_ + 1, region->last()));
}

void MemoryScreen::begin_search(Address from) {
  search_ = sought_;
  search_->from = search_->at = from;
  begun_ = Clock::now();
  step_search();
}

void MemoryScreen::step_search() {
  const SearchStep step = find_pattern(memory_, search_->pattern, search_->from);
  if (step.kind == SearchStep::Kind::unread) {
    search_->at = step.address;
    return;
  }
  const MemoryRegion* region = memory_.region_of(search_->from);
  if (step.kind == SearchStep::Kind::found) {
    go(step.address);
    message_.say(fmt::format("{} found at {}; press m for the next", search_->typed, hex_address(step.address)));
  } else {
    message_.say(fmt::format("{} is not in {} from {} to its end; press g for another region", search_->typed,
                             region == nullptr ? std::string("memory") : region->name, hex_address(search_->from)),
                 Tone::warning);
  }
  search_.reset();
}

// --- comparing
void MemoryScreen::decode_again() {
  names_ = MemoryNames(memory_);
  if (const auto active = names_.active_image(); active && !std::exchange(opened_at_active_, true))
    if (cursor_ == kBankA.first) go(*active);
  compare_again();
}

void MemoryScreen::compare_again() {
  differences_ = other_ ? difference_rows(memory_, names_, *other_, other_names_) : std::vector<DifferenceRow>();
}

void MemoryScreen::compare_with(const std::string& path) {
  if (!gives_way()) return;
  const auto work = [path](JobControl&) { return read_dump(path); };
  task_.start("reading " + path, work, [this, path](const Result<MemoryDump>& dump) {
    if (!dump) return message_.say(dump.error());
    other_ = MemoryBytes::of_dump(*dump);
    other_names_ = MemoryNames(*other_);
    other_file_ = path;
    compare_again();
    message_.say(differences_.empty()
                     ? fmt::format("no difference from {} in the bytes read", path)
                     : fmt::format("compared with {}: press d for the next difference, 2 for the list", path));
    for (const std::string& damage : dump->damage) message_.say(damage, Tone::bad);
  });
}

void MemoryScreen::to_next_difference() {
  if (!other_) return message_.say("no comparison yet: press c to choose a file", Tone::warning);
  const auto next = next_difference(memory_, *other_, cursor_);
  if (!next) return message_.say(fmt::format("no difference from {} in the bytes read", other_file_));
  go(*next);
}

// --- long work
bool MemoryScreen::gives_way() {
  if (task_.running())
    message_.say(fmt::format("still {}: press Esc to cancel", task_.label()), Tone::warning);
  else {
    filling_.reset();
    search_.reset();
    pages_.cancel();
  }
  return !task_.running();
}

std::string MemoryScreen::working_on() const {
  if (task_.running()) return task_.label();
  if (search_) return "looking for " + search_->typed;
  const MemoryRegion* region = filling_ ? memory_.region_of(*filling_) : nullptr;
  return region == nullptr ? "" : "reading " + region->name;
}

double MemoryScreen::part() const {
  if (task_.running()) return task_.part();
  const MemoryRegion* region = memory_.region_of(search_ ? search_->at : filling_.value_or(0));
  if (region == nullptr) return 0.0;
  if (search_) return static_cast<double>(search_->at - region->first) / static_cast<double>(region->size);
  return memory_.part_known(*region);
}

double MemoryScreen::seconds_left() const {
  if (task_.running()) return task_.seconds_left();
  if (search_) return -1.0;
  const double done = part() - part_begun_;
  const double spent_s = std::chrono::duration<double>(Clock::now() - begun_).count();
  return done > 0.01 ? spent_s * (1.0 - part()) / done : -1.0;
}

void MemoryScreen::cancel() {
  if (working_on().empty()) return;
  message_.say(fmt::format("cancelled: {}", working_on()), Tone::warning);
  search_.reset();
  filling_.reset();
  pages_.cancel();
  task_.cancel();
}

namespace {

std::string time_now() { return fmt::format("{:%H:%M:%S}", fmt::localtime(std::time(nullptr))); }

}  // namespace

// --- writing
bool MemoryScreen::lets_write() {
  Result<void> may = may_write(memory_, cursor_, 1);
  if (is_file())
    may = problem(ProblemKind::refused, "this is a file: press o and enter an empty name to return to the unit");
  const auto sample = unit_->newest();
  if (may && !sample) may = problem(ProblemKind::refused, "the unit does not answer: writing is not possible now");
  if (may) may = may_write_in(sample->mode);
  if (!may) message_.say(may.error());
  return may.has_value();
}

std::string MemoryScreen::propose(const std::string& typed) {
  const auto bytes = pattern_in(typed);
  if (!bytes) return bytes.error().message;
  if (const auto may = may_write(memory_, cursor_, bytes->size()); !may) return may.error().message;
  const ByteView before = memory_.known(cursor_, static_cast<std::uint32_t>(bytes->size()));
  if (before.size() < bytes->size()) return "The present bytes are not read yet. Wait, then press Enter again.";
  if (std::equal(before.begin(), before.end(), bytes->begin())) return "The memory already contains these bytes.";
  const auto place = names_.at(memory_, cursor_);
  ask_to_write({cursor_,
                {before.begin(), before.end()},
                *bytes,
                fmt::format("{}{}{}", memory_.region_of(cursor_)->name, place ? ", " : "", place ? place->name : ""),
                "",
                false},
               false);
  return {};
}

void MemoryScreen::propose_undo() {
  const auto last = std::find_if(written_.rbegin(), written_.rend(), [](const auto& w) { return !w.taken_back; });
  if (last == written_.rend()) return message_.say("no write to undo", Tone::warning);
  ByteWrite back = *last;
  go(back.address);
  if (!lets_write()) return;
  std::swap(back.before, back.after);
  ask_to_write(std::move(back), true);
}

void MemoryScreen::ask_to_write(ByteWrite write, bool undo) {
  const WatchedUnit now = unit_->snapshot();
  Question question;
  question.title =
      fmt::format("{} {} byte{} of unit {}{}?", undo ? "Write the old bytes back:" : "Write", write.after.size(),
                  write.after.size() == 1 ? "" : "s", serial_number_, now.emulator ? " (EMULATOR)" : "");
  question.detail = fmt::format("at {}, {}\nnow {}\nnew {}", hex_address(write.address), write.where,
                                short_hex(write.before), short_hex(write.after));
  question.yes = "write";
  question.no = "do not write";
  asking_.ask(
      std::move(question), [this, write = std::move(write), undo] { this->write(write, undo); },
      [this] { message_.say("not written", Tone::plain); });
}

void MemoryScreen::write(const ByteWrite& write, bool undo) {
  if (!gives_way()) return;
  const auto work = [unit = unit_, serial = serial_number_, write](JobControl& control) {
    return unit->with_link(control, [&](UnitLink& link) { return write_checked(link.client(), serial, write); });
  };
  task_.start("writing", work, [this, write, undo](const Result<void>& done) { landed_write(write, undo, done); });
}

void MemoryScreen::landed_write(const ByteWrite& write, bool undo, const Result<void>& done) {
  if (!done) {
    memory_.forget();
    if (!undo && done.error().kind == ProblemKind::link) {  // some of it may have been written
      written_.push_back(write);
      written_.back().when = time_now();
      written_.back().where += ", NOT CONFIRMED";
      written_in_ = serial_number_;
    }
    return message_.say(done.error());
  }
  const Address at = write.address;
  note_on_unit(*unit_, {"memory", "write", hex_address(at), hex_of(write.after, ""), "--yes"});
  memory_.put(at, write.after);
  if (undo) {
    for (auto old = written_.rbegin(); old != written_.rend(); ++old)
      if (!old->taken_back && old->address == at && old->before == write.after) {
        old->taken_back = true;
        break;
      }
  } else {
    written_.push_back(write);
    written_.back().when = time_now();
    written_in_ = serial_number_;
  }
  decode_again();
  const std::string count = write.after.size() == 1 ? "1 byte" : fmt::format("{} bytes", write.after.size());
  message_.say(fmt::format("{} {} at {}, read back the same (before: {}){}", count, undo ? "written back" : "written",
                           hex_address(at), short_hex(write.before), undo ? "" : "; press u to undo"));
}

// --- files
void MemoryScreen::open(const std::string& path) {
  if (path.empty() || path == "unit") {
    if (!is_file()) return message_.say("this is the unit", Tone::warning);
    file_.clear();
    memory_ = {};
    names_ = {};
    serial_number_.clear();
    opened_at_ = {};
    compare_again();
    return message_.say("the unit's memory");
  }
  if (!gives_way()) return;
  const auto work = [path](JobControl&) { return read_dump(path); };
  task_.start("reading " + path, work, [this, path](const Result<MemoryDump>& dump) {
    if (!dump) return message_.say(dump.error());
    show_dump(path, *dump);
  });
}

void MemoryScreen::show_dump(const std::string& path, const MemoryDump& dump) {
  file_ = path;
  file_detail_.clear();
  if (!dump.serial_number.empty()) file_detail_ += ", unit " + dump.serial_number;
  if (!dump.taken.empty()) file_detail_ += ", taken " + dump.taken;
  memory_ = MemoryBytes::of_dump(dump);
  decode_again();
  go(cursor_);
  message_.say(fmt::format("{} opened: to read or write the unit, press o and enter an empty name", path));
  for (const std::string& damage : dump.damage) message_.say(damage, Tone::bad);
}

void MemoryScreen::save(const std::string& path, DumpScope scope) {
  if (!gives_way()) return;
  const auto work = [unit = unit_, path, scope](JobControl& control) -> Result<MemoryDump> {
    auto dump = unit->with_link(
        control, [&](UnitLink& link) { return take_dump(link.client(), link.name(), scope, progress_into(control)); });
    if (!dump) return dump;
    ECS_DO(write_file(path, to_bytes(*dump)));
    return dump;
  };
  task_.start("saving the dump", work, [this, path, scope](const Result<MemoryDump>& dump) {
    if (!dump) return message_.say(dump.error());
    std::vector<std::string> words{"memory", "dump", "-o", path_word(path)};
    if (scope == DumpScope::active) words.emplace_back("--active");
    note_on_unit(*unit_, std::move(words));
    std::size_t bytes = 0;
    for (const DumpRegion& region : dump->regions) {
      memory_.put(region.address, region.bytes);
      bytes += region.bytes.size();
    }
    decode_again();
    compare_again();
    message_.say(fmt::format("{} bytes with the unit's status written to {}", bytes, path));
  });
}

}  // namespace ecs::app
