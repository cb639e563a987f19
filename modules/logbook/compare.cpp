#include "modules/logbook/compare.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "base/json_values.hpp"
#include "base/text.hpp"
#include "laser/map/csv.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {
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

std::string parameters_text(const Json& cause) {
  const auto found = cause.find("parameters");
  std::string text;
  const auto add = [&text](const std::string& name, const Json& value) {
    if (value.is_number()) text += fmt::format("{}{} {:.4g}", text.empty() ? "" : ", ", name, value.get<double>());
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
  const Json content = Json::parse(entry.content, nullptr, false);
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
    for (auto& [name, parameters] : causes_in(*states[day].diagnosis)) {
      auto found = std::find_if(causes.begin(), causes.end(), [&](const ComparedCause& c) { return c.name == name; });
      if (found == causes.end()) found = causes.insert(causes.end(), ComparedCause{name, {}});
      found->parameters[day] = parameters;
    }
  }
  return causes;
}

std::optional<ComparedVolume> volume_of(const LoggedMap& one, const RunVerb& run, std::vector<std::string>& notes,
                                        const std::string& date) {
  if (one.parameters_toml.empty()) {
    notes.push_back(fmt::format("{}: no parameters beside the map: no volume", date));
    return std::nullopt;
  }
  KeptFiles kept("/");
  kept.put("map.csv", one.csv);
  kept.put("parameters.toml", one.parameters_toml);
  const auto said = run({"volume", "map.csv", "--params", "parameters.toml", "--points", "2000", "--draws", "20"});
  const Json answer = said ? Json::parse(*said, nullptr, false) : Json();
  if (!answer.is_object()) {
    notes.push_back(fmt::format("{}: no volume: {}", date, said ? "no answer" : said.error().message));
    return std::nullopt;
  }
  const Json before = answer.value("before", Json()), after = answer.value("after", Json());
  return ComparedVolume{number_at(before, "largest_um"), number_at(before, "rms_um"), number_at(after, "largest_um"),
                        number_at(after, "rms_um")};
}

Result<LoggedState> state_on(const Logbook& book, const std::string& date) {
  if (!is_iso_date(date))
    return problem(ProblemKind::usage, fmt::format("{}: expected a date such as 2026-03-12", date));
  LoggedState state;
  state.date = date;
  const std::string until = until_of(date);
  for (const char* kind : {"diagnosis", "investigation"}) {
    ECS_TRY(found, book.last_of(kind, until));
    if (found && (!state.diagnosis || found->number > state.diagnosis->number)) state.diagnosis = std::move(found);
  }
  ECS_TRY(map, book.last_of("map", until));
  state.map = std::move(map);
  return state;
}

}  // namespace

Result<LogComparison> compared(const Logbook& book, const std::string& from, const std::string& to,
                               const RunVerb& run) {
  LogComparison comparison;
  std::array<std::optional<LoggedMap>, 2> maps;
  for (std::size_t day = 0; day < 2; ++day) {
    ECS_TRY(state, state_on(book, day == 0 ? from : to));
    if (state.map) maps[day] = map_in(book, *state.map);
    if (maps[day])
      state.volume = volume_of(*maps[day], run, comparison.notes, state.date);
    else
      comparison.notes.push_back(fmt::format("{}: no map had been built by then: no curves", state.date));
    if (!state.diagnosis) comparison.notes.push_back(fmt::format("{}: nothing had been diagnosed by then", state.date));
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
