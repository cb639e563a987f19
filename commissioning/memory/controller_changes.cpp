// What a memory controller writes: bytes into the unit and back, dumps into files.
#include <algorithm>
#include <ctime>
#include <filesystem>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "base/file.hpp"
#include "base/json.hpp"
#include "commissioning/link/unit_commands.hpp"
#include "commissioning/memory/controller.hpp"
#include "commissioning/memory/space.hpp"

namespace ecs::commissioning {
namespace {

std::string time_now() { return fmt::format("{:%H:%M:%S}", fmt::localtime(std::time(nullptr))); }

}  // namespace

// --- writing
bool MemoryController::lets_write() {
  Result<void> may = may_write(memory_, cursor_, 1);
  if (is_file()) may = problem(ProblemKind::refused, "this is a file: o with an empty name goes back to the unit");
  const auto sample = unit_->newest();
  if (may && !sample) may = problem(ProblemKind::refused, "the unit does not answer: nothing can be written now");
  if (may) may = may_write_in(sample->mode);
  if (!may) message_.say(may.error());
  return may.has_value();
}

void MemoryController::propose(const std::string& typed) {
  const auto bytes = pattern_in(typed);
  if (!bytes) return message_.say(bytes.error());
  if (const auto may = may_write(memory_, cursor_, bytes->size()); !may) return message_.say(may.error());
  const ByteView before = memory_.known(cursor_, static_cast<std::uint32_t>(bytes->size()));
  if (before.size() < bytes->size())
    return message_.say("What is there now is not read yet. Wait, then press w again.", Tone::warning);
  if (std::equal(before.begin(), before.end(), bytes->begin()))
    return message_.say("The memory holds these bytes already.", Tone::warning);
  const auto place = names_.at(memory_, cursor_);
  ask_to_write({cursor_,
                {before.begin(), before.end()},
                *bytes,
                fmt::format("{}{}{}", memory_.region_of(cursor_)->name, place ? ", " : "", place ? place->name : ""),
                "",
                false},
               false);
}

void MemoryController::propose_undo() {
  const auto last = std::find_if(written_.rbegin(), written_.rend(), [](const auto& w) { return !w.taken_back; });
  if (last == written_.rend()) return message_.say("nothing was written that could be taken back", Tone::warning);
  ByteWrite back = *last;
  go(back.address);
  if (!lets_write()) return;
  std::swap(back.before, back.after);
  ask_to_write(std::move(back), true);
}

void MemoryController::ask_to_write(ByteWrite write, bool undo) {
  const WatchedUnit now = unit_->snapshot();
  Question question;
  question.title =
      fmt::format("{} {} byte{} of unit {}{}?", undo ? "Write the old bytes back:" : "Write", write.after.size(),
                  write.after.size() == 1 ? "" : "s", serial_number_, now.emulator ? " (EMULATOR)" : "");
  question.detail = fmt::format("at {}, {}\nnow {}\nnew {}", hex_address(write.address), write.where,
                                short_hex(write.before), short_hex(write.after));
  question.yes = "write";
  question.no = "leave as it is";
  ask(std::move(question), [this, write = std::move(write), undo] { this->write(write, undo); });
}

void MemoryController::write(const ByteWrite& write, bool undo) {
  if (!gives_way()) return;
  const auto work = [unit = unit_, serial = serial_number_, write](JobControl& control) {
    return unit->with_link(control, [&](UnitLink& link) { return write_checked(link.client(), serial, write); });
  };
  task_.start("writing", work, [this, write, undo](const Result<void>& done) { landed_write(write, undo, done); });
}

void MemoryController::landed_write(const ByteWrite& write, bool undo, const Result<void>& done) {
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
  std::string digits;
  for (const std::uint8_t byte : write.after) digits += fmt::format("{:02X}", byte);
  note_on_unit(*unit_, {"memory", "write", fmt::format("0x{:06X}", at), digits, "--yes"});
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
  compare_again();
  const std::string count = write.after.size() == 1 ? "1 byte" : fmt::format("{} bytes", write.after.size());
  message_.say(fmt::format("{} {} at {}, read back the same (before: {}){}", count, undo ? "written back" : "written",
                           hex_address(at), short_hex(write.before), undo ? "" : "; u takes it back"));
}

void MemoryController::ask(Question question, std::function<void()> on_yes) {
  asking_.ask(std::move(question), std::move(on_yes), [this] { message_.say("left as it is", Tone::plain); });
}

// --- files
void MemoryController::open(const std::string& path) {
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

void MemoryController::show_dump(const std::string& path, const MemoryDump& dump) {
  file_ = path;
  file_detail_.clear();
  if (!dump.serial_number.empty()) file_detail_ += ", unit " + dump.serial_number;
  if (!dump.taken.empty()) file_detail_ += ", taken " + dump.taken;
  memory_ = MemoryBytes::of_dump(dump);
  decode_again();
  compare_again();
  go(cursor_);
  message_.say(fmt::format("{} opened: writing and reading again need the unit, o with an empty name", path));
  for (const std::string& damage : dump.damage) message_.say(damage, Tone::bad);
}

void MemoryController::save(const std::string& path, DumpScope scope) {
  if (path.empty()) return message_.say("expected a file name, got none", Tone::bad);
  if (is_file()) return message_.say("this is a file already", Tone::warning);
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return save_now(path, scope);
  ask({fmt::format("Replace {}?", path), "The file exists: what is in it is lost.", "replace", "keep it"},
      [this, path, scope] { save_now(path, scope); });
}

void MemoryController::save_now(const std::string& path, DumpScope scope) {
  if (!gives_way()) return;
  const auto work = [unit = unit_, path, scope](JobControl& control) -> Result<MemoryDump> {
    auto dump = unit->with_link(
        control, [&](UnitLink& link) { return take_dump(link.client(), link.name(), scope, progress_into(control)); });
    if (!dump) return dump;
    ECS_DO(write_file(path, to_bytes(*dump)));
    return dump;
  };
  task_.start("taking the dump", work, [this, path, scope](const Result<MemoryDump>& dump) {
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

}  // namespace ecs::commissioning
