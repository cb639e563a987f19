#include "model/fit/model_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "laser/csv_columns.hpp"
#include "laser/import/time.hpp"
#include "laser/map/csv.hpp"
#include "laser/measurement_set.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/regression/regressors.hpp"

namespace ecs::model {
namespace {

const std::vector<std::string> kModelKeys{"name",  "effect",  "candidate", "map",
                                          "known", "history", "origin",    "compensated_readings"};
const std::vector<std::string> kEffectKeys{"id",         "axis",   "sense",  "approach",    "code", "ball",
                                           "line",       "run",    "sensor", "sensor2",     "name", "formula",
                                           "parameters", "fitted", "curve",  "undetermined"};

constexpr double kMostReadings = 1e9;

std::vector<std::string> effect_names() {
  std::vector<std::string> names;
  for (const EffectDefinition& definition : effect_library()) names.emplace_back(definition.id);
  return names;
}

/// A word that must be one of a few; nothing and a problem where it is none.
template <class Of>
auto named(TomlReader& reader, const toml::table& table, std::string_view key, std::string_view expected, const Of& of)
    -> decltype(of(std::string_view())) {
  const auto word = reader.word(table, key);
  if (!word) return std::nullopt;
  auto value = of(std::string_view(*word));
  if (!value) reader.complain(*table.get(key), fmt::format("{}: expected {}, got \"{}\"", key, expected, *word));
  return value;
}

std::optional<std::vector<double>> numbers(TomlReader& reader, const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  std::vector<double> values;
  const toml::array* array = node->as_array();
  bool good = array != nullptr;
  if (good)
    for (const toml::node& each : *array) {
      const auto value = each.value<double>();
      good = good && each.is_number() && value && std::isfinite(*value);
      if (good) values.push_back(*value);
    }
  if (good) return values;
  reader.complain(*node, fmt::format("{}: expected a list of numbers", key));
  return std::nullopt;
}

/// Two lists of equal length, the first ascending.
std::optional<FittedCurve> curve_in(TomlReader& reader, const toml::table& table, std::string_view places,
                                    std::string_view what) {
  const auto p = numbers(reader, table, places);
  const auto value = numbers(reader, table, "value");
  if (!p || !value) {
    if (!table.contains(places) || !table.contains("value"))
      reader.complain(table, fmt::format("{}: expected the lists {} and value", what, places));
    return std::nullopt;
  }
  if (p->empty() || p->size() != value->size() || std::ranges::adjacent_find(*p, std::greater_equal<>()) != p->end()) {
    reader.complain(table, fmt::format("{}: expected {} ascending and as many values; found {} and {}", what, places,
                                       p->size(), value->size()));
    return std::nullopt;
  }
  return FittedCurve{*p, *value};
}

void take_numbers(TomlReader& reader, const toml::table& effect, std::string_view key,
                  std::map<std::string, double>& into, const std::vector<std::string>& known) {
  const toml::table* table = reader.child(effect, key);
  if (table == nullptr) return;
  reader.only(*table, known, key);
  for (const auto& [name, node] : *table) {
    if (std::ranges::find(known, std::string(name.str())) == known.end()) continue;
    if (const auto value = reader.number(*table, name.str())) into[std::string(name.str())] = *value;
  }
}

bool is_column_name(const std::string& word) {
  static const std::set<std::string> kColumns{
      "x_mm",         "y_mm",         "z_mm",        "p_mm",     "a_deg",
      "b_deg",        "c_deg",        "p_deg",       "approach", "run",
      "compensated",  "time_s",       "feed_mm_min", "load_kg",  "travel_since_reversal_mm",
      "pressure_hPa", "humidity_pct", "pi",          "_pi",      "_e"};
  return kColumns.contains(word) || laser::is_sensor_column(word);
}

/// Names in formulas that are neither functions nor columns: parameters to be fitted.
std::vector<UserParameter> parameters_in(const std::vector<UserFormula>& formulas) {
  std::vector<UserParameter> parameters;
  for (const UserFormula& formula : formulas) {
    const std::string& text = formula.text;
    for (std::size_t i = 0; i < text.size();) {
      const auto is_letter = [&](std::size_t at) {
        return std::isalpha(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_';
      };
      if (!is_letter(i)) {
        const bool number = std::isdigit(static_cast<unsigned char>(text[i])) != 0;
        ++i;
        while (number && i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) != 0 || text[i] == '.'))
          ++i;
        continue;
      }
      std::size_t end = i;
      while (end < text.size() && (is_letter(end) || std::isdigit(static_cast<unsigned char>(text[end])) != 0)) ++end;
      const std::string word = text.substr(i, end - i);
      std::size_t next = end;
      while (next < text.size() && text[next] == ' ') ++next;
      const bool function = next < text.size() && text[next] == '(';
      const bool known = std::ranges::any_of(parameters, [&](const UserParameter& p) { return p.name == word; });
      if (!function && !known && !is_column_name(word)) parameters.push_back({word, {}, {}, {}, {}, {}});
      i = end;
    }
  }
  return parameters;
}

/// As formulas name it: a letter or '_', then letters, digits and '_'.
bool is_formula_name(std::string_view name) {
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  return !name.empty() && letter(name.front()) && std::ranges::all_of(name, [&](char c) {
    return letter(c) || std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
}

void check_parameter_name(TomlReader& reader, const toml::node& at, const std::string& name,
                          const EffectInstance& effect) {
  if (!is_formula_name(name))
    reader.complain(
        at, fmt::format("parameters: expected a name as in the formula, of letters, digits and _, got \"{}\"", name));
  if (std::ranges::any_of(effect.user, [&](const UserParameter& one) { return one.name == name; }))
    reader.complain(at, fmt::format("parameters: expected every name once, got \"{}\" twice", name));
}

void take_user_parameter(TomlReader& reader, const toml::table& table, const std::string& name,
                         EffectInstance& effect) {
  check_parameter_name(reader, *table.get(name), name, effect);
  UserParameter parameter;
  parameter.name = name;
  if (const toml::table* facts = table.get_as<toml::table>(name)) {
    reader.only(*facts, {"unit", "value", "start", "least", "greatest"}, fmt::format("parameter {}", name));
    parameter.unit = reader.word(*facts, "unit").value_or("");
    parameter.value = reader.number(*facts, "value");
    parameter.start = reader.number(*facts, "start");
    parameter.least = reader.number(*facts, "least");
    parameter.greatest = reader.number(*facts, "greatest");
    if (parameter.least && parameter.greatest && *parameter.least >= *parameter.greatest)
      reader.complain(*facts, fmt::format("parameter {}: expected least below greatest", name));
  } else {
    parameter.value = reader.number(table, name);
  }
  effect.user.push_back(parameter);
}

void take_user(TomlReader& reader, const toml::table& table, EffectInstance& effect) {
  if (effect.name.empty()) reader.complain(table, "user effect: expected a name");
  if (const toml::table* formulas = table.get_as<toml::table>("formula")) {
    for (const auto& [key, node] : *formulas) {
      const auto sense = sense_named(key.str());
      const auto text = reader.word(*formulas, key.str());
      if (!sense)
        reader.complain(node, fmt::format("formula: expected a sense EX EY EZ EA EB EC, got \"{}\"", key.str()));
      if (sense && text) effect.formulas.push_back({*sense, *text});
    }
  } else if (const auto text = reader.word(table, "formula")) {
    if (effect.sense)
      effect.formulas.push_back({*effect.sense, *text});
    else
      reader.complain(table, "user effect: expected sense = \"EX\" with a single formula, or formula = { EX = \"…\" }");
  } else if (!table.contains("formula")) {
    reader.complain(table, "user effect: expected formula = { EX = \"…\", … }");
  }
  effect.sense = std::nullopt;  // every formula has its own
  std::ranges::sort(effect.formulas, [](const UserFormula& a, const UserFormula& b) { return a.sense < b.sense; });
  if (const toml::table* parameters = table.get_as<toml::table>("parameters")) {
    for (const auto& [key, node] : *parameters)
      take_user_parameter(reader, *parameters, std::string(key.str()), effect);
  } else if (const toml::array* names = table.get_as<toml::array>("parameters")) {
    for (const toml::node& each : *names) {
      if (const auto* name = each.as_string()) {
        check_parameter_name(reader, each, name->get(), effect);
        effect.user.push_back({name->get(), {}, {}, {}, {}, {}});
      } else {
        reader.complain(each, "parameters: expected names in quotes");
      }
    }
  } else {
    effect.user = parameters_in(effect.formulas);
  }
  std::vector<std::string> known;
  for (const UserParameter& parameter : effect.user) known.push_back(parameter.name);
  take_numbers(reader, table, "fitted", effect.fitted, known);
}

/// Names of the effects beside which the values fitted are not determined.
void take_undetermined(TomlReader& reader, const toml::table& table, EffectInstance& effect) {
  if (!table.contains("undetermined")) return;
  const toml::array* names = table.get_as<toml::array>("undetermined");
  effect.undetermined.emplace();
  if (names == nullptr || !std::ranges::all_of(*names, [](const auto& one) { return one.is_string(); }))
    return reader.complain(*table.get("undetermined"), "undetermined: expected a list of names in quotes");
  for (const toml::node& one : *names) effect.undetermined->push_back(one.as_string()->get());
}

constexpr std::string_view kLocationCodes = "a location error of the axis, such as XOC or AOC of C";

/// The component of `code`; of a set-up its rotation, of a location error its letter.
void take_code(TomlReader& reader, const toml::table& table, EffectInstance& effect) {
  const auto word = reader.word(table, "code");
  if (!word || set_code(effect, *word)) return;
  const Place place = effect.definition().place;
  reader.complain(*table.get("code"),
                  fmt::format("code: expected {}, got \"{}\"",
                              place == Place::set_up     ? "EA, EB or EC"
                              : place == Place::location ? kLocationCodes
                                                         : "one of the 21 components, such as ECX or C0Y",
                              *word));
}

/// What an effect must have besides its id, and what follows from what it has.
void complete(TomlReader& reader, const toml::table& table, EffectInstance& effect) {
  const EffectDefinition& definition = effect.definition();
  const auto want = [&](bool given, std::string_view what) {
    if (!given) reader.complain(table, fmt::format("{}: expected {}", definition.id, what));
  };
  want(!table.contains("ball") || definition.place == Place::artefact,
       "no key ball, which is of ball_on_table and ball_in_spindle");
  want(!table.contains("line") || definition.traits.of_lines, "no key line, which is of offset and scale");
  want(!table.contains("run") || definition.traits.of_lines, "no key run, which is of offset and scale");
  const auto take_number = [&](const char* key, int& taken) {
    const auto number = reader.number(table, key);
    want(!number || (*number >= 1.0 && *number == std::floor(*number)),
         fmt::format("{} = 1, 2 …, in the order of the readings", key));
    if (number) taken = static_cast<int>(*number);
  };
  if (definition.traits.of_lines) {
    take_number("line", effect.line);
    take_number("run", effect.from_run);
  } else {
    take_number("ball", effect.ball);
  }
  const bool rotation = effect.code && is_angular(*effect.code);
  if (definition.place == Place::rotation) want(rotation, "code = one of EAX … ECZ");
  if (definition.place == Place::known_component) want(rotation, "code = the known angular component, EAX … ECZ");
  if ((definition.place == Place::rotation || definition.place == Place::known_component) && rotation)
    effect.axis = moving_axis(*effect.code);
  if (definition.place == Place::squareness) {
    want(effect.code && is_squareness(*effect.code), "code = C0Y, B0Z or A0Z");
    if (effect.code) effect.axis = *effect.code == Component::C0Y ? Axis::Y : Axis::Z;
  }
  if (definition.has_lever()) effect.sense = std::nullopt;
  if (definition.place == Place::set_up) {
    want(table.contains("code"), "code = EA, EB or EC");
    effect.axis = std::nullopt;
    effect.rotary = false;
    return;
  }
  if (definition.place == Place::location)
    return want(table.contains("code") && effect.axis && effect.sense, fmt::format("code = {}", kLocationCodes));
  if (definition.place == Place::artefact) {
    effect.axis = std::nullopt;
    effect.sense = std::nullopt;
    effect.rotary = true;
    return;
  }
  const bool needs_axis =
      definition.place != Place::sense && definition.place != Place::squareness && definition.place != Place::map;
  if (needs_axis) want(effect.axis.has_value(), "axis = \"X\", \"Y\" or \"Z\", of a rotary axis \"A\", \"B\" or \"C\"");
  want(!effect.rotary || definition.traits.on_rotary_axes, "a linear axis: it does not apply to a rotary one");
  if (definition.has_lever() || definition.place == Place::map) return;
  if (effect.axis && !effect.sense)
    effect.sense = static_cast<Sense>(index_of(*effect.axis) + (effect.rotary ? kAxes : 0));
  want(effect.sense.has_value(), "sense = \"EX\" … \"EC\"");
  if (!needs_axis && !effect.axis && effect.sense) effect.axis = direction_of(*effect.sense);
  if (definition.has_need(Need::sensor)) want(!effect.sensor.empty(), "sensor = the column of a sensor, t_…_degC");
  if (definition.has_need(Need::two_sensors))
    want(!effect.sensor.empty() && !effect.sensor2.empty() && effect.sensor != effect.sensor2,
         "sensor and sensor2 = the columns of two sensors, t_…_degC");
}

/// A column of a sensor; "" where none is given.
std::string sensor_in(TomlReader& reader, const toml::table& table, std::string_view key) {
  std::string column = reader.word(table, key).value_or("");
  if (!column.empty() && !laser::is_sensor_column(column))
    reader.complain(*table.get(key), fmt::format("{}: expected a column t_…_degC, got \"{}\"", key, column));
  return column;
}

std::optional<EffectInstance> effect_in(TomlReader& reader, const toml::table& table) {
  EffectInstance effect;
  reader.only(table, kEffectKeys, "effect");
  if (!table.contains("id"))
    reader.complain(table, fmt::format("effect: expected an id, one of {}", fmt::join(effect_names(), ", ")));
  const auto word = reader.word(table, "id");
  if (!word) return std::nullopt;
  const EffectId id = effect_named(*word);
  if (!id) {
    const std::string like = nearest_word(*word, effect_names());
    reader.complain(*table.get("id"),
                    fmt::format("id: no effect \"{}\"; {}", *word,
                                like.empty() ? fmt::format("expected one of {}", fmt::join(effect_names(), ", "))
                                             : fmt::format("did you mean \"{}\"?", like)));
    return std::nullopt;
  }
  effect.id = id;
  if (const auto axis = named(reader, table, "axis", "\"X\", \"Y\", \"Z\", \"A\", \"B\" or \"C\"", laser::axis_named)) {
    effect.axis = axis->axis;
    effect.rotary = axis->rotary;
  }
  effect.sense =
      named(reader, table, "sense", "EX, EY, EZ, EA, EB or EC", [](std::string_view w) { return sense_named(w); });
  take_code(reader, table, effect);
  effect.approach = named(reader, table, "approach", "both, forward or reverse", [](std::string_view w) {
                      return approach_mode_named(w);
                    }).value_or(ApproachMode::both);
  effect.sensor = sensor_in(reader, table, "sensor");
  effect.sensor2 = sensor_in(reader, table, "sensor2");
  effect.name = reader.word(table, "name").value_or("");
  take_undetermined(reader, table, effect);
  if (effect.is_user()) {
    take_user(reader, table, effect);
    return effect;
  }
  if (table.contains("formula"))
    reader.complain(*table.get("formula"), "formula: only effects with id = \"user\" have one");
  std::vector<std::string> known;
  for (const ParameterDefinition& parameter : effect.definition().parameters)
    known.push_back(shown_name(parameter.name, effect));
  for (const auto& [key, values] : {std::pair{"parameters", &effect.parameters}, std::pair{"fitted", &effect.fitted}}) {
    std::map<std::string, double> shown;
    take_numbers(reader, table, key, shown, known);
    for (const auto& [name, value] : shown) values->emplace(library_name(name, effect), value);
    const auto lag = values->find(std::string(kLag));
    if (effect.traits().has_lag && lag != values->end() && !(lag->second >= 0.0))
      reader.complain(*table.get(key), fmt::format("{}: expected 0 or more, got {}", kLag, lag->second));
  }
  std::erase_if(effect.fitted, [&](const auto& one) { return is_left_out(effect, one.first, one.second); });
  hold_optional(effect);
  if (const toml::table* curve = reader.child(table, "curve")) {
    const std::string places = shown_name("p_mm", effect);
    reader.only(*curve, {places, "value"}, "curve");
    if (auto points = curve_in(reader, *curve, places, "curve")) effect.curve = std::move(*points);
  }
  const auto period = effect.parameters.find("period_mm");
  if (period != effect.parameters.end() && period->second <= 0.0)
    reader.complain(*table.get("parameters"),
                    fmt::format("{}: expected a period above 0", shown_name("period_mm", effect)));
  complete(reader, table, effect);
  return effect;
}

void take_map(TomlReader& reader, const toml::table& root, const std::filesystem::path& folder, Model& model) {
  const toml::table* table = reader.child(root, "map");
  if (table == nullptr) return;
  reader.only(*table, {"file", "taken_out"}, "map");
  const auto file = reader.word(*table, "file");
  if (!file) {
    if (!table->contains("file")) reader.complain(*table, "map: expected file = \"map.csv\"");
    return;
  }
  model.map_file = *file;
  if (const toml::node* taken_out = table->get("taken_out")) {
    const auto value = taken_out->value_exact<bool>();
    if (!value) reader.complain(*taken_out, "taken_out: expected true or false");
    model.map_taken_out = value.value_or(false);
  }
  auto map = laser::read_map_csv(folder / *file);
  if (map)
    model.map = std::move(*map);
  else
    reader.add(map.error());
}

void take_known(TomlReader& reader, const toml::table& root, Model& model) {
  for (const toml::table* table : reader.children(root, "known")) {
    reader.only(*table, {"code", "p_mm", "value"}, "known");
    const auto code = named(reader, *table, "code", "one of the 18 curves, such as ECX",
                            [](std::string_view w) -> std::optional<Component> {
                              const auto component = component_of(w);
                              return component && !is_squareness(*component) ? component : std::nullopt;
                            });
    if (!table->contains("code")) reader.complain(*table, "known: expected code = a component, such as ECX");
    const auto curve = curve_in(reader, *table, "p_mm", "known");
    if (code && curve) model.known.push_back({*code, curve->p_mm, curve->value});
  }
}

/// Numbers of a table that has all of these keys and no others.
template <std::size_t kCount>
std::optional<std::array<double, kCount>> all_numbers(TomlReader& reader, const toml::table& table,
                                                      const std::array<const char*, kCount>& keys,
                                                      std::string_view what) {
  reader.only(table, {keys.begin(), keys.end()}, what);
  std::array<double, kCount> values{};
  bool whole = true;
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto value = reader.number(table, keys[i]);
    if (!table.contains(keys[i])) reader.complain(table, fmt::format("{}: expected {}", what, keys[i]));
    whole = whole && value;
    values[i] = value.value_or(0.0);
  }
  return whole ? std::optional(values) : std::nullopt;
}

void take_origin(TomlReader& reader, const toml::table& root, Model& model) {
  const toml::table* table = reader.child(root, "origin");
  if (table == nullptr) return;
  reader.only(*table, {"time_s", "date", "temperatures", "air"}, "origin");
  Origin origin;
  origin.time_s = reader.number(*table, "time_s");
  origin.date = reader.word(*table, "date").value_or("");
  const auto date_s = laser::seconds_in(origin.date);
  if (!origin.date.empty() && (!date_s || laser::date_time_text(*date_s).empty()))
    reader.complain(*table->get("date"),
                    fmt::format("date: expected a date and time such as 2026-01-31 08:00:00, got \"{}\"", origin.date));
  if (!origin.date.empty() && !table->contains("time_s"))
    reader.complain(*table, "origin: expected time_s with date, the time_s of the reading at that date");
  if (const toml::table* sensors = reader.child(*table, "temperatures"))
    for (const auto& [name, node] : *sensors) {
      const std::string column(name.str());
      if (!laser::is_sensor_column(column))
        reader.complain(node, fmt::format("temperatures: expected a column t_…_degC, got \"{}\"", column));
      else if (const auto degC = reader.number(*sensors, column))
        origin.sensors_degC[column] = *degC;
    }
  if (const toml::table* air = reader.child(*table, "air"))
    if (const auto of = all_numbers<3>(reader, *air, {"t_air_degC", "pressure_hPa", "humidity_pct"}, "air"))
      origin.air = Origin::Air{(*of)[0], (*of)[1], (*of)[2]};
  model.origin = std::move(origin);
}

int count_of_readings(TomlReader& reader, const toml::table& table, std::string_view key) {
  const double count = reader.number(table, key).value_or(0.0);
  if (count >= 0.0 && count <= kMostReadings && count == std::floor(count)) return static_cast<int>(count);
  reader.complain(*table.get(key), fmt::format("{}: expected a whole number of readings, got {}", key, count));
  return 0;
}

void take_history(TomlReader& reader, const toml::table& root, Model& model) {
  for (const toml::table* table : reader.children(root, "history")) {
    LadderStep step;
    reader.only(*table,
                {"effect", "data", "rms_before_um", "rms_um", "peak_um", "noise_um", "held_out_rms_um", "outliers"},
                "history");
    step.effect = reader.word(*table, "effect").value_or("");
    step.data = reader.word(*table, "data").value_or("");
    step.rms_before_um = reader.number(*table, "rms_before_um").value_or(0.0);
    step.rms_um = reader.number(*table, "rms_um").value_or(0.0);
    step.peak_um = reader.number(*table, "peak_um").value_or(0.0);
    step.noise_um = reader.number(*table, "noise_um").value_or(0.0);
    step.held_out_rms_um = reader.number(*table, "held_out_rms_um");
    step.outliers = count_of_readings(reader, *table, "outliers");
    model.history.push_back(step);
  }
}

/// The comment "# or servo_lag:X:EX" below [[effect]]: what the data could not tell the effect from. A comment, so
/// that older readers take the file.
void take_alternatives(std::string_view text, Model& model) {
  constexpr std::string_view kBegin = "# or ";
  std::size_t effects = 0;
  bool below_head = false;
  for (const std::string_view line : lines_of(text)) {
    const std::string_view words = trimmed(line);
    if (below_head && words.starts_with(kBegin) && effects <= model.effects.size())
      model.effects[effects - 1].tied_with = std::string(words.substr(kBegin.size()));
    below_head = words == "[[effect]]";
    if (below_head) ++effects;
  }
}

bool counts_time(const EffectInstance& effect) {
  return (effect.traits().from_origin && effect.definition().has_need(Need::time)) ||
         std::ranges::any_of(effect.formulas, [](const UserFormula& formula) {
           return formula.text.find("time_s") != std::string::npos;
         });
}

/// What of its origin the effects of a model count from; nothing where none does.
std::optional<Origin> counting_origin(const Model& model) {
  if (!model.origin || !counts_from_origin(model)) return std::nullopt;
  Origin origin = *model.origin;
  if (std::ranges::none_of(model.effects, counts_time)) {
    origin.time_s.reset();
    origin.date.clear();
  }
  return origin;
}

/// Reading = error of the machine + compensation: the compensation of the whole map goes.
void take_map_out(Observations& data) {
  const Observations& motions = data.motions();
  Eigen::MatrixXd compensation = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(motions.size()), 1);
  const EffectInstance whole_map;
  for (std::size_t k = 0; k < motions.size(); ++k)
    if (motions.compensated[k] && (motions.aside.empty() || !motions.aside[k]))
      compensation(static_cast<Eigen::Index>(k)) = map_compensation({motions, k, whole_map});
  const Eigen::VectorXd of_readings = Regressors(data).readings_from(std::move(compensation)).col(0);
  data.of_map.assign(of_readings.begin(), of_readings.end());
  for (std::size_t k = 0; k < data.size(); ++k) data.reading[k] -= data.of_map[k];
  const auto with_map = std::ranges::count(data.compensated, true);
  const auto& header = data.map->header;
  if (with_map > 0 && (data.rotary || !data.through_chain.empty() || !header.thermal.empty() || !header.rotary.empty()))
    data.not_followed =
        "readings with compensation (compensated = 1) and without it cannot be joined here: only the tables of X, Y "
        "and Z can be subtracted from readings. Give those with compensation alone, or those without";
  if (with_map > 0)
    data.notes.push_back(fmt::format(
        "{} of the {} readings were taken with compensation (compensated = 1). The map was subtracted from them: the "
        "model describes the machine without compensation, and where both kinds still differ, the map is at fault, or "
        "the squareness, which is not subtracted",
        with_map, data.size()));
}

}  // namespace

bool counts_from_origin(const Model& model) {
  return std::ranges::any_of(
      model.effects, [](const EffectInstance& effect) { return effect.traits().from_origin || counts_time(effect); });
}

Observations all_observations_of(const laser::MeasurementSet& set, const Model& model,
                                 const std::optional<params::Machine>& machine) {
  Observations data = observations_of(set, KnownTables{model.map, model.known, counting_origin(model)}, machine);
  const bool is_mixed = std::ranges::adjacent_find(data.compensated, std::not_equal_to()) != data.compensated.end();
  if (model.map && (is_mixed || model.map_taken_out)) take_map_out(data);
  return data;
}

Observations as_measured(Observations data) {
  for (std::size_t k = 0; k < data.size(); ++k) data.reading[k] += data.of_map_in(k);
  data.of_map.clear();
  return data;
}

void take_compensation(Model& model, const Observations& data) {
  model.map_taken_out = !data.of_map.empty();
  model.compensated_readings = model.map_taken_out ? 0 : static_cast<int>(std::ranges::count(data.compensated, true));
}

Observations observations_of(const laser::MeasurementSet& set, const Model& model,
                             const std::optional<params::Machine>& machine) {
  return counted_once(all_observations_of(set, model, machine), set);
}

Result<Model> parse_model(std::string_view text, const std::string& name, const std::filesystem::path& folder) {
  TomlReader reader(name);
  ECS_TRY(root, reader.parsed(text));
  Model model;
  reader.only(root, kModelKeys, "model");
  model.name = reader.word(root, "name").value_or("");
  for (const toml::table* table : reader.children(root, "effect"))
    if (auto effect = effect_in(reader, *table)) model.effects.push_back(std::move(*effect));
  for (const toml::table* table : reader.children(root, "candidate"))
    if (auto effect = effect_in(reader, *table)) model.candidates.push_back(std::move(*effect));
  take_map(reader, root, folder, model);
  take_known(reader, root, model);
  take_origin(reader, root, model);
  take_history(reader, root, model);
  model.compensated_readings = count_of_readings(reader, root, "compensated_readings");
  if (!reader.clean()) return tl::unexpected(reader.all());
  take_alternatives(text, model);
  return model;
}

Result<Model> read_model(const std::filesystem::path& path) {
  ECS_TRY(text, read_file_of(FileKind::model, path));
  return parse_model(text, path.string(), path.parent_path());
}

}  // namespace ecs::model
