// Logbook answers as text and JSON.
#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/json.hpp"
#include "commissioning/session/commands.hpp"
#include "modules/logbook/replay.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::size_t kMostFilesShown = 40;

Json object_in(const std::string& text) {
  Json object = json_in(text);
  return object.is_object() ? object : Json();
}

std::string field_line(std::string_view name, const std::string& value) {
  return value.empty() ? "" : fmt::format("{:<12} {}\n", name, value);
}

std::string instrument_text(const Json& instrument) {
  if (!instrument.is_object()) return {};
  std::string text = text_at(instrument, "name");
  for (const auto& [key, words] :
       {std::pair("serial_number", "serial number"), std::pair("calibration_certificate", "certificate"),
        std::pair("valid_until", "valid until")})
    if (const std::string value = text_at(instrument, key); !value.empty())
      text += fmt::format(", {} {}", words, value);
  if (instrument.contains("calibrated") && instrument["calibrated"] == false) text += " (NOT VALID THEN)";
  return text;
}

std::string files_text(const std::vector<LogFile>& files) {
  std::string text;
  for (std::size_t k = 0; k < files.size() && k < kMostFilesShown; ++k)
    text += fmt::format("  {:<7} {} {:>9} {}{}\n", files[k].role, files[k].sha256.substr(0, 16), files[k].bytes,
                        files[k].name, files[k].kept ? "" : " (not kept)");
  if (files.size() > kMostFilesShown) text += fmt::format("  … and {} more\n", files.size() - kMostFilesShown);
  return text.empty() ? "" : "files        first 16 digits of the hash, bytes, name\n" + text;
}

std::string number_text(const std::optional<double>& value) { return value ? fmt::format("{:.2f}", *value) : "-"; }

Cell curve_cell(const ComparedCurve& one) {
  return record_cell(
      "{component:<5} {unit:<5} {largest_from:>12} {largest_to:>12} {largest_change:>15} {change_rms:>12}\n",
      "component"_is(one.component), "unit"_is(one.unit),
      "largest_from"_is(one.largest[0], number_text(one.largest[0])),
      "largest_to"_is(one.largest[1], number_text(one.largest[1])),
      "largest_change"_is(one.largest_change, number_text(one.largest_change)),
      "change_rms"_is(one.change_rms, number_text(one.change_rms)));
}

Cell cause_cell(const ComparedCause& one) {
  const auto side = [](const std::optional<std::string>& parameters) {
    return Cell{parameters ? Json(*parameters) : Json(nullptr),
                parameters ? (parameters->empty() ? "named" : *parameters) : "not named"};
  };
  return record_cell("{name}\n  from: {from}\n  to:   {to}\n", "name"_is(one.name), "from"_is(side(one.parameters[0])),
                     "to"_is(side(one.parameters[1])));
}

Json volume_json(const std::optional<ComparedVolume>& volume) {
  if (!volume) return nullptr;
  return object_of(
      "before"_is(object_of("largest_um"_is(volume->before_largest_um), "rms_um"_is(volume->before_rms_um))),
      "after"_is(object_of("largest_um"_is(volume->after_largest_um), "rms_um"_is(volume->after_rms_um))));
}

std::string volume_text(const std::array<LoggedState, 2>& states) {
  if (!states[0].volume && !states[1].volume) return {};
  std::string text =
      fmt::format("\n{:<34} {:>12} {:>12}\n", "error vector in the volume [um]", states[0].date, states[1].date);
  const auto row = [&](const char* name, std::optional<double> ComparedVolume::*member) {
    const auto of = [&](const LoggedState& state) {
      return number_text(state.volume ? (*state.volume).*member : std::nullopt);
    };
    text += fmt::format("{:<34} {:>12} {:>12}\n", name, of(states[0]), of(states[1]));
  };
  row("largest, not compensated", &ComparedVolume::before_largest_um);
  row("rms, not compensated", &ComparedVolume::before_rms_um);
  row("largest, compensated", &ComparedVolume::after_largest_um);
  row("rms, compensated", &ComparedVolume::after_rms_um);
  return text;
}

Json number_of(const std::optional<LogbookEntry>& entry) { return entry ? Json(entry->number) : Json(nullptr); }

Json state_json(const LoggedState& state) {
  return object_of("date"_is(state.date), "map_entry"_is(number_of(state.map)),
                   "diagnosis_entry"_is(number_of(state.diagnosis)), "volume"_is(volume_json(state.volume)));
}

std::string state_text(const char* word, const LoggedState& state) {
  std::string text = fmt::format("{} {}:", word, state.date);
  text += state.map ? fmt::format(" map of entry {} ({})", state.map->number, state.map->time) : " no map";
  if (state.diagnosis)
    text += fmt::format(", {} of entry {} ({})", state.diagnosis->kind, state.diagnosis->number, state.diagnosis->time);
  return text + "\n";
}

}  // namespace

std::string log_list_head() {
  return fmt::format("{:>6}  {:<20}  {:<18}  {:<12}  {:<8}  {}\n", "number", "time", "kind", "operator", "hash",
                     "what");
}

void name_users_of_inputs(std::vector<LogbookEntry>& entries) {
  const LogbookEntry* user = nullptr;
  for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
    if (!entry->summary.ends_with(kInputOfNext)) {
      user = &*entry;
    } else if (user != nullptr) {
      entry->summary.resize(entry->summary.size() - kInputOfNext.size());
      entry->summary +=
          fmt::format(", input of entry {} ({})", user->number, user->summary.substr(0, user->summary.find("; ")));
    }
  }
}

Cell log_entry_cell(const LogbookEntry& entry) {
  return record_cell("{number:>6}  {time:<20}  {kind:<18}  {operator:<12}  {hash:<8}  {summary}\n",
                     "number"_is(entry.number), "time"_is(entry.time), "kind"_is(entry.kind),
                     "hash"_is(entry.hash, entry.hash.substr(0, 8)), "previous"_is(entry.previous),
                     "operator"_is(entry.operator_name), "summary"_is(entry.summary),
                     "machine"_is(text_or_null(entry.machine)), "serial_number"_is(text_or_null(entry.serial_number)),
                     "instrument"_is(object_in(entry.instrument)));
}

Cell whole_entry_cell(const LogbookEntry& entry, const std::string& what) {
  Cell cell = log_entry_cell(entry);
  const Json content = object_in(entry.content);
  cell.json["content"] = content;
  std::string text = fmt::format("entry {}: {}\n", entry.number, entry.kind);
  text += field_line("time", entry.time) + field_line("machine", in_words({entry.machine, entry.serial_number})) +
          field_line("operator", entry.operator_name) +
          field_line("instrument", instrument_text(object_in(entry.instrument))) + field_line("what", what);
  std::vector<std::string> words = words_of(entry);
  if (!words.empty()) words.insert(words.begin(), "ecs");
  text += field_line("command", shell_command(words)) + field_line("folder", folder_of(entry));
  for (const auto& [key, name] : {std::pair("program", "program"), std::pair("commit_sequence", "commit no."),
                                  std::pair("block_check", "checksum"), std::pair("image_sha256", "image_sha256"),
                                  std::pair("problem", "problem")})
    if (content.is_object() && content.contains(key))
      text += field_line(name, content[key].is_string() ? content[key].get<std::string>() : content[key].dump());
  text += files_text(files_of(entry));
  text += field_line("previous", entry.previous) + field_line("hash", entry.hash);
  cell.text = text;
  return cell;
}

namespace {

std::string fault_text(const LogVerdict& verdict) {
  if (!verdict.first) return verdict.why + "\n";
  const std::string before = verdict.entries == 0 ? std::string()
                             : verdict.entries == 1
                                 ? std::string(". The entry before it is intact")
                                 : fmt::format(". The {} entries before it are intact", verdict.entries);
  return fmt::format("entry {}: {}{}\n", *verdict.first, verdict.why, before);
}

}  // namespace

Cell verdict_cell(const LogVerdict& verdict, const std::string& path, const std::string& expected) {
  std::string text =
      verdict.whole()
          ? fmt::format("{} entries: each agrees with its hash and with the entry before it; the last hash is {}\n",
                        verdict.entries, verdict.last_hash)
          : fault_text(verdict);
  if (verdict.whole() && expected.empty())
    text +=
        "To detect entries missing at the end, give --hash with the last hash that a report or certificate states.\n";
  return record_cell("{text}", "log"_is(path), "whole"_is(verdict.whole()), "entries"_is(verdict.entries),
                     "last_hash"_is(text_or_null(verdict.last_hash)),
                     "first"_is(verdict.first ? Json(*verdict.first) : Json(nullptr)),
                     "why"_is(text_or_null(verdict.why)), "text"_shown(text));
}

Cell replay_cell(const Replay& replay) {
  return record_cell(
      "The active image was sent in entry {activation}\n{derived}{raw}{notes}image derived again: {map_sha256}\nimage "
      "that is active: "
      "{active_sha256}\n{same}\n",
      "map_sha256"_is(replay.map_sha256), "active_sha256"_is(replay.active_sha256),
      "same"_is(replay.same, "the same, bit for bit", "NOT THE SAME"), "activation"_is(replay.activation),
      "derived"_is(list_cell(replay.derived,
                             [](const DerivedFile& one) {
                               return record_cell("entry {entry}: {name}, repeated with `ecs {verb}`: {same}\n",
                                                  "entry"_is(one.entry), "name"_is(one.name), "verb"_is(one.verb),
                                                  "sha256"_is(one.sha256),
                                                  "same"_is(one.same, "the same content", "DIFFERENT"));
                             })),
      "raw"_is(list_cell(replay.raw,
                         [](const RawFile& one) {
                           return record_cell("source: {name}\n", "name"_is(one.name), "sha256"_is(one.sha256));
                         })),
      "notes"_is(lines_cell(replay.notes, "note: ")));
}

Cell comparison_of_log_cell(const LogComparison& comparison) {
  const auto& states = comparison.states;
  const std::string head = fmt::format(
      "\nlargest value of each curve at each date, and change between the curves\n{:<5} {:<5} {:>12} {:>12} {:>15} "
      "{:>12}\n",
      "curve", "unit", states[0].date.substr(0, 10), states[1].date.substr(0, 10), "largest change", "change rms");
  Cell curves = list_cell(comparison.curves, curve_cell, comparison.curves.empty() ? "" : head);
  Cell causes = list_cell(comparison.causes, cause_cell, comparison.causes.empty() ? "" : "\ncauses\n");
  return record_cell("{states}{curves}{causes}{volume}{notes}", "from"_is(state_json(states[0])),
                     "to"_is(state_json(states[1])), "curves"_is(std::move(curves)), "causes"_is(std::move(causes)),
                     "notes"_is(lines_cell(comparison.notes, "note: ")),
                     "states"_shown(state_text("from", states[0]) + state_text("to  ", states[1])),
                     "volume"_shown(volume_text(states)));
}

}  // namespace ecs::commissioning
