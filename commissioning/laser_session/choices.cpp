#include "commissioning/laser_session/choices.hpp"

#include <type_traits>
#include <utility>
#include <variant>

#include "base/json.hpp"
#include "base/text.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::commissioning {
namespace {

/// An answer as text, whatever its kind; empty: not given.
std::string text_of(const cli::Argument& answer) {
  return std::visit(
      [](const auto& value) -> std::string {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::string*>) return *value;
        if constexpr (std::is_same_v<Value, std::optional<double>*>) return *value ? shortest(**value) : "";
        if constexpr (std::is_same_v<Value, int*>) return *value > 0 ? std::to_string(*value) : "";
        if constexpr (std::is_same_v<Value, bool*>) return *value ? "yes" : "";
        return {};
      },
      answer.into);
}

/// The options of `laser import`, as they stand in these answers.
cli::Arguments options_of(ImportArguments& answers) { return cli::fields_of<ImportArguments>().arguments_for(answers); }
std::string name_of(const cli::Argument& option) { return option.name.substr(2); }

Json json_of(const LaserLineChoice& line) {
  Json runs = Json::array(), readings = Json::array();
  for (const auto& [run, reason] : line.runs) runs.push_back({run, reason});
  for (const auto& [place, reason] : line.readings) readings.push_back({place, reason});
  return {{"runs", runs}, {"readings", readings}};
}

Json json_of(const LaserComponentChoice& component) {
  Json object{{"smoothing_mm", component.smoothing_mm}, {"zero_reason", component.zero_reason}};
  if (component.slope) object["slope"] = laser::name_of(*component.slope);
  if (component.increment_mm) object["increment_mm"] = *component.increment_mm;
  return object;
}

Json json_of(const LaserHeaderChoice& h) {
  return {{"customer", h.customer}, {"machine", h.machine}, {"serial_number", h.serial_number},
          {"engineer", h.engineer}, {"date", h.date},       {"remarks", h.remarks}};
}

LaserLineChoice line_in(const Json& object) {
  LaserLineChoice line;
  for (const Json& one : object.at("runs")) line.runs.emplace(one.at(0).get<int>(), one.at(1).get<std::string>());
  for (const Json& one : object.at("readings"))
    line.readings.emplace(one.at(0).get<std::size_t>(), one.at(1).get<std::string>());
  return line;
}

LaserComponentChoice component_in(const Json& object) {
  LaserComponentChoice component;
  component.smoothing_mm = object.at("smoothing_mm").get<double>();
  component.zero_reason = object.at("zero_reason").get<std::string>();
  if (object.contains("slope")) component.slope = laser::slope_method_named(object["slope"].get<std::string>());
  if (object.contains("increment_mm")) component.increment_mm = object["increment_mm"].get<double>();
  return component;
}

LaserHeaderChoice header_in(const Json& h) {
  return {h.at("customer").get<std::string>(),      h.at("machine").get<std::string>(),
          h.at("serial_number").get<std::string>(), h.at("engineer").get<std::string>(),
          h.at("date").get<std::string>(),          h.at("remarks").get<std::string>()};
}

LaserChoices choices_of(const Json& object) {
  LaserChoices choices;
  for (const Json& one : object.at("files")) {
    LaserFileChoice file{one.at("path").get<std::string>(), {}};
    for (const auto& [name, value] : one.at("answers").items()) set_answer(file.answers, name, value);
    file.places = one.value("places", file.places);
    choices.files.push_back(std::move(file));
  }
  for (const auto& [key, line] : object.at("lines").items()) choices.lines[key] = line_in(line);
  for (const auto& [code, component] : object.at("components").items())
    choices.components[code] = component_in(component);
  choices.params_file = object.at("params").get<std::string>();
  choices.scope = object.at("scope").get<std::string>();
  choices.header = header_in(object.at("header"));
  choices.map_file = object.at("map").get<std::string>();
  choices.opened_map = object.value("opened_map", "");
  return choices;
}

}  // namespace

std::string choices_text(const LaserChoices& choices) {
  Json object{{"files", Json::array()},        {"lines", Json::object()},         {"components", Json::object()},
              {"params", choices.params_file}, {"scope", choices.scope},          {"header", json_of(choices.header)},
              {"map", choices.map_file},       {"opened_map", choices.opened_map}};
  for (const LaserFileChoice& file : choices.files)
    object["files"].push_back({{"path", file.path}, {"answers", given_answers(file.answers)}, {"places", file.places}});
  for (const auto& [key, line] : choices.lines)
    if (!(line == LaserLineChoice{})) object["lines"][key] = json_of(line);
  for (const auto& [code, component] : choices.components)
    if (!(component == LaserComponentChoice{})) object["components"][code] = json_of(component);
  return one_line(object);
}

std::optional<LaserChoices> choices_in(const std::string& text) {
  try {
    return choices_of(Json::parse(text));
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::map<std::string, std::string> given_answers(const ImportArguments& answers) {
  std::map<std::string, std::string> given;
  ImportArguments copy = answers;
  for (const cli::Argument& option : options_of(copy))
    if (std::string text = text_of(option); !text.empty()) given[name_of(option)] = std::move(text);
  return given;
}

std::vector<std::string> import_words(const ImportArguments& answers) {
  std::map<std::string, std::vector<std::string>> by_name;
  ImportArguments copy = answers;
  for (const cli::Argument& option : options_of(copy))
    if (std::string text = text_of(option); !text.empty())
      by_name[option.name] = option.is_flag() ? std::vector{option.name} : std::vector{option.name, std::move(text)};
  std::vector<std::string> words;
  for (const auto& [name, with_value] : by_name) words.insert(words.end(), with_value.begin(), with_value.end());
  return words;
}

void set_answer(ImportArguments& answers, const std::string& name, const std::string& value) {
  for (const cli::Argument& option : options_of(answers)) {
    if (name_of(option) != name) continue;
    if (auto* const* text = std::get_if<std::string*>(&option.into)) **text = value;
    if (auto* const* number = std::get_if<std::optional<double>*>(&option.into)) **number = number_in(value);
    if (auto* const* count = std::get_if<int*>(&option.into)) **count = static_cast<int>(integer_in(value).value_or(0));
    if (auto* const* flag = std::get_if<bool*>(&option.into)) **flag = value == "yes";
  }
}

const std::vector<AnswerField>& answer_fields() {
  static const std::vector<AnswerField> fields{
      {"axis", "the axis that was moved, where the file does not say", {"", "X", "Y", "Z"}},
      {"sense",
       "what was measured: EX EY EZ um along, EA EB EC um/m about an axis",
       {"", "EX", "EY", "EZ", "EA", "EB", "EC"}},
      {"parked", "where the other axes stood [mm], as in y=-1400,z=0", {}},
      {"columns", "a table: which column is what, as in x_mm=1,reading=3*0.001,run=2,approach=4", {}},
      {"skip", "lines before the table", {}, AnswerField::Kind::number},
      {"rows", "rows of the table to take; empty: all", {}, AnswerField::Kind::number},
      {"delimiter", "between the columns: one character, or blank, tab, comma, semicolon", {}},
      {"decimal", "decimal sign of the table", {"", "point", "comma"}},
      {"values", "what the readings of the table are", {"", "error", "actual", "compensation"}},
      {"target-unit", "unit of the targets where it is not the usual one: mm, in", {}},
      {"reading-unit", "unit of the readings where it is not the usual one: um, mil, arcsec", {}},
      {"channel", "of a log that holds several channels", {}},
      {"channels", "of a log: several channels joined by time, as in x_mm=ENC[mm],reading=AI1[um]", {}},
      {"join", "how channels meet in time; empty: linear", {"", "linear", "nearest", "previous"}},
      {"max-gap",
       "the greatest gap [s] over which channels are joined; empty: 5 usual intervals",
       {},
       AnswerField::Kind::number},
      {"at-rest", "only rows whose position stays within this [mm]", {}, AnswerField::Kind::number},
      {"average", "readings at rest become one, their mean", {"", "yes"}},
      {"environment", "air and temperatures over time: a .pos, or a table with headings", {}, AnswerField::Kind::path},
      {"environment-every",
       "seconds between the rows of the environment, where it has no time",
       {},
       AnswerField::Kind::number},
      {"keep-set-up", "shift and rotation of measured positions stay in the errors", {"", "yes"}},
      {"encoding",
       "code page of the texts; by itself if empty",
       {"", "UTF-8", "Windows-1252", "GBK", "ISO-8859-1", "Shift-JIS", "UTF-16"}},
      {"accept-truncated", "take what is left of a file that ends too early", {"", "yes"}},
      {"table-holds-errors", "a .REN table holds errors, not compensation", {"", "yes"}},
      {"profile", "import answers saved under this name, or a path", {}}};
  return fields;
}

}  // namespace ecs::commissioning
