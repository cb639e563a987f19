#include "modules/logbook/replay.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/session/commands.hpp"
#include "core/memory_image.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/image.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {
namespace {

/// Verbs whose answer depends on their words and files alone.
constexpr const char* kRepeatable[] = {"laser import", "laser process", "laser prepare", "laser normalise", "map build",
                                       "params new",   "params set",    "model new",     "model fit",       "model add",
                                       "model undo",   "model remove",  "model decide"};

bool is_repeatable(const std::vector<std::string>& words) {
  return words.size() >= 2 && std::any_of(std::begin(kRepeatable), std::end(kRepeatable), [&](const char* verb) {
           return fmt::format("{} {}", words[0], words[1]) == verb;
         });
}

/// The input of the activation that is a map, or one that is a parameter file.
template <class Reads>
const LogFile* input_that(const Logbook& book, const std::vector<LogFile>& files, const Reads& reads) {
  for (const LogFile& file : files) {
    if (file.role != "input" || !file.kept) continue;
    const auto content = book.original(file.sha256);
    if (content && reads(*content, file.name)) return &file;
  }
  return nullptr;
}

bool reads_as_map(const std::string& content, const std::string& name) {
  const auto map = laser::parse_map_csv(content, name);
  return map && (!map->tables.empty() || !map->header.declared_zero.empty());
}

bool reads_as_parameters(const std::string& content, const std::string& name) {
  return name.ends_with(".toml") && params::parse_parameters(content, name).has_value();
}

Result<std::string> image_text(const std::string& csv, const UnitParameters& parameters, const std::string& like) {
  ECS_TRY(map, laser::parse_map_csv(csv, "the map derived again"));
  ECS_TRY(image, laser::image_of(map, parameters));
  const std::vector<std::uint8_t> active(like.begin(), like.end());
  std::vector<std::uint8_t> bytes = std::move(image.bytes);
  if (const auto identity = ImageView(active).identity()) {
    ECS_TRY(addressed, laser::with_identity(std::move(bytes), *identity));
    bytes = std::move(addressed);
  }
  return std::string(bytes.begin(), bytes.end());
}

/// What became active, and from which files.
struct Activation {
  LogbookEntry entry;
  std::string image;
  laser::ImageContent content;
  std::optional<LogFile> map, parameters;
};

Result<Activation> read_activation(const Logbook& book, const LogbookEntry& entry) {
  const std::vector<LogFile> files = files_of(entry);
  const auto image = std::find_if(files.begin(), files.end(), [](const LogFile& f) { return f.role == "image"; });
  if (image == files.end()) return problem(ProblemKind::refused, "entry {} names no image", entry.number);
  ECS_TRY(bytes, book.original(image->sha256));
  ECS_TRY(content, laser::content_of(std::vector<std::uint8_t>(bytes.begin(), bytes.end())));
  Activation found{entry, std::move(bytes), std::move(content), {}, {}};
  if (const LogFile* map = input_that(book, files, reads_as_map)) found.map = *map;
  if (const LogFile* parameters = input_that(book, files, reads_as_parameters)) found.parameters = *parameters;
  return found;
}

bool has_map(const Activation& one) {
  return !one.content.map.tables.empty() || !one.content.map.header.declared_zero.empty();
}

/// Where the files that were sent are not known (a screen, a batch, parameters sent beside their map): the newest map
/// before it whose image has the tables of this one.
Result<std::optional<LogFile>> map_before(const Logbook& book, const Activation& one) {
  ECS_TRY(entries, book.entries());
  for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
    if (entry->number >= one.entry.number) continue;
    for (const LogFile& file : files_of(*entry)) {
      if (!file.kept || file.role == "image" || !file.name.ends_with(".csv")) continue;
      const auto csv = book.original(file.sha256);
      if (!csv || !reads_as_map(*csv, file.name)) continue;
      const auto image = image_text(*csv, one.content.parameters, one.image);
      if (image && *image == one.image) return std::optional(file);
    }
  }
  return std::optional<LogFile>();
}

}  // namespace

void KeptFiles::put(const std::string& name, std::string content) { files_[place_of(name)] = std::move(content); }

const std::string* KeptFiles::find(const std::string& name) const {
  const auto found = files_.find(place_of(name));
  return found == files_.end() ? nullptr : &found->second;
}

Result<std::string> KeptFiles::content(const std::filesystem::path& path) {
  if (const std::string* found = find(path.string())) return *found;
  return problem_at(path.string(), 0, 0, "the logbook's entry contains no such file");
}

void KeptFiles::was_written(const std::filesystem::path& path, std::string_view content) {
  put(path.string(), std::string(content));
}

std::string KeptFiles::place_of(const std::filesystem::path& path) const {
  return (path.is_absolute() ? path : folder_ / path).lexically_normal().string();
}

Result<void> Derivation::know_entries() {
  if (entries_) return {};
  ECS_TRY(entries, book_.entries());
  entries_ = std::move(entries);
  return {};
}

Result<std::string> Derivation::file(const std::string& sha256, const std::string& name, std::int64_t before) {
  if (const auto found = done_.find(sha256); found != done_.end()) return found->second;
  ECS_DO(know_entries());
  for (auto entry = entries_->rbegin(); entry != entries_->rend(); ++entry) {
    if (entry->number >= before || !is_repeatable(words_of(*entry))) continue;
    const auto files = files_of(*entry);
    if (std::none_of(files.begin(), files.end(),
                     [&](const LogFile& file) { return file.role == "output" && file.sha256 == sha256; }))
      continue;
    return made_again(*entry, sha256);
  }
  auto content = book_.original(sha256);
  if (!content) return content;
  raw.push_back({name, sha256});
  done_[sha256] = *content;
  return content;
}

Result<std::string> Derivation::made_again(const LogbookEntry& entry, const std::string& sha256) {
  const std::vector<LogFile> files = files_of(entry);
  const std::vector<std::string> words = words_of(entry);
  KeptFiles kept(folder_of(entry));
  {
    const Unwatched book_alone;
    for (const LogFile& one : files) {
      if (one.role != "input") continue;
      auto content = file(one.sha256, one.name, entry.number);
      if (!content) return content;
      kept.put(one.name, std::move(*content));
    }
  }
  const auto answer = run_(words);
  const std::string verb = shell_command(words);
  std::string wanted;
  for (const LogFile& one : files) {
    if (one.role != "output") continue;
    const std::string* content = answer ? kept.find(one.name) : nullptr;
    if (content == nullptr) {
      const std::string why = answer ? "it did not write " + one.name : to_text(answer.error());
      return problem(ProblemKind::refused, "entry {} cannot be repeated: `ecs {}`: {}", entry.number, verb, why);
    }
    derived.push_back({entry.number, verb, one.name, one.sha256, sha256_hex(*content) == one.sha256});
    done_[one.sha256] = *content;
    if (one.sha256 == sha256) wanted = *content;
  }
  return wanted;
}

Result<Replay> replayed(const Logbook& book, const RunVerb& run, const std::string& active) {
  ECS_TRY(activations, book.activations());
  std::optional<Activation> last;
  for (auto entry = activations.rbegin(); entry != activations.rend() && !last; ++entry) {
    ECS_TRY(one, read_activation(book, *entry));
    if (!has_map(one))
      return problem(ProblemKind::refused, "entry {}: the active image contains parameters but no map", entry->number);
    last = std::move(one);
  }
  if (!last)
    return tl::unexpected(Problem{ProblemKind::refused,
                                  "no map became active while this logbook was kept: there is nothing to replay",
                                  book.path().string(),
                                  0,
                                  0,
                                  {}});
  if (!last->map) {
    ECS_TRY(found, map_before(book, *last));
    last->map = std::move(found);
  }
  if (!last->map)
    return problem(ProblemKind::refused,
                   "entry {}: no map in this logbook gives the image that became active: it was made elsewhere",
                   last->entry.number);
  Replay replay;
  replay.activation = last->entry.number;
  Derivation derivation(book, run);
  ECS_TRY(csv, derivation.file(last->map->sha256, last->map->name, last->entry.number));
  UnitParameters parameters = last->content.parameters;
  if (last->parameters) {
    ECS_TRY(text, derivation.file(last->parameters->sha256, last->parameters->name, last->entry.number));
    ECS_TRY(read, params::parse_parameters(text, last->parameters->name));
    parameters = read.parameters;
  } else {
    replay.notes.emplace_back("the parameters are those of the active image: the logbook does not state their file");
  }
  ECS_TRY(image, image_text(csv, parameters, last->image));
  replay.map_sha256 = sha256_hex(image);
  replay.active_sha256 = sha256_hex(active.empty() ? last->image : active);
  replay.same = replay.map_sha256 == replay.active_sha256;
  replay.derived = std::move(derivation.derived);
  replay.raw = std::move(derivation.raw);
  if (std::none_of(replay.derived.begin(), replay.derived.end(),
                   [&](const DerivedFile& one) { return one.sha256 == last->map->sha256; }))
    replay.notes.push_back(
        fmt::format("{} was not made while this logbook was kept: it is used as sent", last->map->name));
  return replay;
}

namespace {

constexpr std::size_t kLongestDay = 10;  // "2026-05-04"

/// The last moment that counts.
std::string until_of(std::string date) {
  if (date.size() <= kLongestDay) return date + "T23:59:59Z";
  std::replace(date.begin(), date.end(), ' ', 'T');
  return date;
}

/// A map with the parameters beside it.
struct LoggedMap {
  laser::ErrorMap map;
  std::string csv, parameters_toml;
  std::optional<UnitParameters> parameters;
};

std::optional<LoggedMap> map_in(const Logbook& book, const LogbookEntry& entry) {
  LoggedMap found;
  const auto files = files_of(entry);
  for (const LogFile& file : files) {
    if (file.role != "output" || !file.kept) continue;
    const auto content = book.original(file.sha256);
    if (!content) continue;
    if (auto map = laser::parse_map_csv(*content, file.name); file.name.ends_with(".csv") && map) {
      found.map = std::move(*map);
      found.csv = *content;
    }
  }
  if (found.csv.empty()) return std::nullopt;
  for (const char* role : {"output", "input"})  // squareness that was measured stands in those that were written
    for (const LogFile& file : files) {
      if (found.parameters || file.role != role || !file.kept || !file.name.ends_with(".toml")) continue;
      const auto content = book.original(file.sha256);
      const auto read = content ? params::parse_parameters(*content, file.name) : tl::unexpected(content.error());
      if (!read) continue;
      found.parameters = read->parameters;
      found.parameters_toml = *content;
    }
  return found;
}

std::optional<double> largest_error(const LoggedMap& one, Component component) {
  if (is_squareness(component))
    return one.parameters ? std::optional(std::abs(squareness_um_per_m(*one.parameters, component))) : std::nullopt;
  const bool has = std::any_of(one.map.tables.begin(), one.map.tables.end(),
                               [&](const laser::MapTable& table) { return table.component == component; });
  return has ? std::optional(laser::largest_in(one.map.tables, component)) : std::nullopt;
}

struct Change {
  double largest = 0.0;
  double square = 0.0;
  std::size_t places = 0;
};

/// At the points of the first table that the second reaches.
void add_change(Change& change, const laser::MapTable& a, const laser::MapTable& b) {
  for (std::size_t k = 0; k < a.position_mm.size(); ++k) {
    const double at = a.position_mm[k];
    if (b.position_mm.empty() || at < b.position_mm.front() || at > b.position_mm.back()) continue;
    const double difference = a.compensation[k] - laser::compensation_at(b, at);
    change.largest = std::max(change.largest, std::abs(difference));
    change.square += difference * difference;
    ++change.places;
  }
}

Change change_of(const LoggedMap& from, const LoggedMap& to, Component component) {
  Change change;
  if (is_squareness(component)) {
    if (!from.parameters || !to.parameters) return change;
    change.largest =
        std::abs(squareness_um_per_m(*to.parameters, component) - squareness_um_per_m(*from.parameters, component));
    change.square = change.largest * change.largest;
    change.places = 1;
    return change;
  }
  for (const Approach approach : {Approach::forward, Approach::reverse}) {
    const laser::MapTable* a = laser::table_of(to.map, component, approach);
    const laser::MapTable* b = laser::table_of(from.map, component, approach);
    if (a != nullptr && b != nullptr) add_change(change, *a, *b);
  }
  return change;
}

std::vector<ComparedCurve> curves_of(const std::optional<LoggedMap>& from, const std::optional<LoggedMap>& to) {
  std::vector<ComparedCurve> curves;
  for (std::size_t k = 0; k < kComponents; ++k) {
    const auto component = static_cast<Component>(k);
    ComparedCurve one{std::string(name_of(component)), std::string(unit_of(component)), {}, {}, {}};
    one.largest = {from ? largest_error(*from, component) : std::nullopt,
                   to ? largest_error(*to, component) : std::nullopt};
    if (!one.largest[0] && !one.largest[1]) continue;
    if (is_squareness(component) && one.largest[0].value_or(0.0) == 0.0 && one.largest[1].value_or(0.0) == 0.0)
      continue;
    if (one.largest[0] && one.largest[1])
      if (const Change change = change_of(*from, *to, component); change.places > 0) {
        one.largest_change = change.largest;
        one.change_rms = std::sqrt(change.square / static_cast<double>(change.places));
      }
    curves.push_back(std::move(one));
  }
  std::stable_sort(curves.begin(), curves.end(), [](const ComparedCurve& a, const ComparedCurve& b) {
    return a.largest_change.value_or(-1.0) > b.largest_change.value_or(-1.0);
  });
  return curves;
}

/// "150 um/m" of um_per_m, "amplitude 3 um" of amplitude_um.
std::string size_text(const std::string& name, double value) {
  constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"um_per_m", "um/m"}, {"um", "um"}, {"mm", "mm"}, {"rad", "rad"}, {"deg", "deg"}, {"s", "s"}};
  for (const auto& [ending, unit] : kUnits) {
    if (name == ending) return fmt::format("{:.4g} {}", value, unit);
    if (name.ends_with(fmt::format("_{}", ending)))
      return fmt::format("{} {:.4g} {}", name.substr(0, name.size() - ending.size() - 1), value, unit);
  }
  return fmt::format("{} {:.4g}", name, value);
}

std::string parameters_text(const Json& cause) {
  const auto found = cause.find("parameters");
  std::string text;
  const auto add = [&text](const std::string& name, const Json& value) {
    if (value.is_number()) text += (text.empty() ? "" : ", ") + size_text(name, value.get<double>());
  };
  if (found == cause.end()) return text;
  if (found->is_object())
    for (const auto& [name, value] : found->items()) add(name, value);
  if (found->is_array())
    for (const Json& one : *found)
      if (one.is_object() && one.contains("name") && one.contains("value"))
        add(one["name"].get<std::string>(), one["value"]);
  return text;
}

/// By name: what a diagnosis named, or an investigation found.
std::vector<std::pair<std::string, std::string>> causes_in(const LogbookEntry& entry) {
  std::vector<std::pair<std::string, std::string>> causes;
  const Json content = json_in(entry.content);
  if (!content.is_object() || !content.contains("answer") || !content["answer"].is_object()) return causes;
  const Json& answer = content["answer"];
  for (const char* list : {"candidates", "causes"}) {
    const auto found = answer.find(list);
    if (found == answer.end() || !found->is_array()) continue;
    for (const Json& one : *found) {
      if (!one.is_object() || !one.contains("name") || !one["name"].is_string()) continue;
      if (one.contains("named") && one["named"] != true) continue;
      causes.emplace_back(one["name"].get<std::string>(), parameters_text(one));
    }
  }
  return causes;
}

std::vector<ComparedCause> causes_of(const std::array<LoggedState, 2>& states) {
  std::vector<ComparedCause> causes;
  for (std::size_t day = 0; day < states.size(); ++day) {
    if (!states[day].diagnosis) continue;
    for (const auto& one : causes_in(*states[day].diagnosis)) {
      auto found = std::ranges::find(causes, one.first, &ComparedCause::name);
      if (found == causes.end()) found = causes.insert(causes.end(), ComparedCause{one.first, {}});
      found->parameters[day] = one.second;
    }
  }
  return causes;
}

std::optional<ComparedVolume> volume_of(const LoggedMap& one, const RunVerb& run, std::vector<std::string>& notes,
                                        const std::string& date) {
  if (one.parameters_toml.empty()) {
    notes.push_back(fmt::format("{}: no parameters with the map: no volume", date));
    return std::nullopt;
  }
  KeptFiles kept("/");
  kept.put("map.csv", one.csv);
  kept.put("parameters.toml", one.parameters_toml);
  const auto said = run({"volume", "map.csv", "--params", "parameters.toml", "--points", "2000", "--draws", "20"});
  const Json answer = said ? json_in(*said) : Json();
  if (!answer.is_object()) {
    notes.push_back(fmt::format("{}: no volume: {}", date, said ? "no answer" : to_text(said.error())));
    return std::nullopt;
  }
  const Json before = answer.value("before", Json()), after = answer.value("after", Json());
  return ComparedVolume{number_at(before, "largest_um"), number_at(before, "rms_um"), number_at(after, "largest_um"),
                        number_at(after, "rms_um")};
}

/// `model compare` names no cause; its entries in older logbooks have the kind of a diagnosis.
bool is_comparison(const LogbookEntry& entry) {
  const Json content = json_in(entry.content);
  return content.is_object() && content.value("verb", Json()) == "model compare";
}

/// The last diagnosis or investigation up to a moment.
Result<std::optional<LogbookEntry>> last_diagnosis(const Logbook& book, const std::string& until) {
  ECS_TRY(entries, book.entries(true));
  for (auto one = entries.rbegin(); one != entries.rend(); ++one) {
    if (one->time > until || (one->kind != "diagnosis" && one->kind != "investigation")) continue;
    ECS_TRY(whole, book.entry(one->number));
    if (!is_comparison(whole)) return std::optional(std::move(whole));
  }
  return std::optional<LogbookEntry>();
}

Result<LoggedState> state_on(const Logbook& book, const std::string& date) {
  if (!is_iso_date(date)) return problem(ProblemKind::usage, "{}: expected a date such as 2026-03-12", date);
  LoggedState state;
  state.date = date;
  const std::string until = until_of(date);
  ECS_TRY(diagnosis, last_diagnosis(book, until));
  state.diagnosis = std::move(diagnosis);
  ECS_TRY(map, book.last_of("map", until));
  state.map = std::move(map);
  return state;
}

}  // namespace

Result<LogComparison> compared(const Logbook& book, const std::string& from, const std::string& to,
                               const RunVerb& run) {
  LogComparison comparison;
  if (is_iso_date(from) && is_iso_date(to) && to < from)
    return problem(ProblemKind::usage, "expected the earlier day first, found {0} before {1}: exchange them", from, to);
  std::array<std::optional<LoggedMap>, 2> maps;
  for (std::size_t day = 0; day < 2; ++day) {
    ECS_TRY(state, state_on(book, day == 0 ? from : to));
    if (state.map) maps[day] = map_in(book, *state.map);
    if (maps[day])
      state.volume = volume_of(*maps[day], run, comparison.notes, state.date);
    else
      comparison.notes.push_back(fmt::format("{}: no map had been built by then: no curves", state.date));
    if (!state.diagnosis) comparison.notes.push_back(fmt::format("{}: no diagnosis had been made by then", state.date));
    comparison.states[day] = std::move(state);
  }
  if (comparison.states[0].map && comparison.states[1].map &&
      comparison.states[0].map->number == comparison.states[1].map->number)
    comparison.notes.emplace_back("no other map was built between the two: the curves are those of one map");
  comparison.curves = curves_of(maps[0], maps[1]);
  comparison.causes = causes_of(comparison.states);
  return comparison;
}

}  // namespace ecs::commissioning
