// The files of a case in the formats of docs/laser.md, docs/design.md and docs/model.md, and what is true of it.
#include "bench/foreign/case_files.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/json.hpp"
#include "base/text.hpp"

namespace foreign {
namespace {

using ecs::Json;
using ecs::shortest;

double tidy(double value) { return std::round(value * 1e6) / 1e6; }

std::string data_csv(const Case& drawn) {
  const Setup& setup = drawn.setup;
  std::string text = fmt::format("# machine: {}\n", setup.machine.name);
  text += "axis,x_mm,y_mm,z_mm,sense,reading,approach,run,time_s";
  if (setup.feed) text += ",feed_mm_min";
  if (setup.load) text += ",load_kg";
  if (setup.travel) text += ",travel_since_reversal_mm";
  if (setup.air) text += ",pressure_hPa,humidity_pct";
  for (const std::string& sensor : setup.sensors) text += "," + sensor;
  text += "\n";
  for (std::size_t i = 0; i < setup.readings.size(); ++i) {
    const Reading& r = setup.readings[i];
    text += fmt::format("{},{},{},{},{},{},{},{},{}", r.axis, shortest(tidy(r.at_mm[0])), shortest(tidy(r.at_mm[1])),
                        shortest(tidy(r.at_mm[2])), r.sense, shortest(tidy(drawn.readings_um[i])), r.approach, r.run,
                        shortest(tidy(r.time_s)));
    if (setup.feed) text += "," + shortest(tidy(r.feed_mm_min));
    if (setup.load) text += "," + shortest(tidy(r.load_kg));
    if (setup.travel) text += "," + shortest(tidy(r.travel_mm));
    if (setup.air) text += "," + shortest(tidy(r.pressure_hPa)) + "," + shortest(tidy(r.humidity_pct));
    for (const double value : r.sensors_degC) text += "," + shortest(tidy(value));
    text += "\n";
  }
  return text;
}

// Always with a decimal point, as TOML tells numbers from integers.
std::string toml_number(double value) {
  const std::string text = shortest(tidy(value));
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string machine_toml(const Machine& machine) {
  std::string text = fmt::format("name = \"{}\"\nconfiguration = \"{}\"\n", machine.name, machine.configuration);
  for (std::size_t k = 0; k < 3; ++k) {
    const AxisFacts& axis = machine.axes[k];
    text += fmt::format("[axis.{}]\ntravel_mm = [{}, {}]\ndatum_mm = {}\n", axis_of(k), toml_number(axis.low_mm),
                        toml_number(axis.high_mm), toml_number(axis.datum_mm));
    text += fmt::format("transducer = \"encoder\"\nresolution_um = {}\n", toml_number(axis.resolution_um));
    if (axis.screw_pitch_mm) text += fmt::format("screw_pitch_mm = {}\n", toml_number(*axis.screw_pitch_mm));
    if (axis.scale_pitch_mm) text += fmt::format("scale_pitch_mm = {}\n", toml_number(*axis.scale_pitch_mm));
    text += fmt::format("expansion_um_per_m_degC = {}\n", toml_number(axis.expansion_um_per_m_degC));
    if (!axis.measurement_line_mm) continue;
    std::string line;
    for (std::size_t other = 0; other < 3; ++other)
      if (other != k)
        line += fmt::format("{}{} = {}", line.empty() ? "" : ", ", static_cast<char>('x' + static_cast<char>(other)),
                            toml_number((*axis.measurement_line_mm)[other]));
    text += fmt::format("measurement_line_mm = {{ {} }}\n", line);
  }
  return text;
}

std::string list_of(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + toml_number(value);
  return "[" + text + "]";
}

std::string model_toml(const Case& drawn) {
  std::string text;
  for (const Term& term : drawn.base) {
    text += fmt::format("[[effect]]\nid = \"{}\"\naxis = \"{}\"\n", term.id, term.axis);
    if (!term.sense.empty()) text += fmt::format("sense = \"{}\"\n", term.sense);
    if (!term.given) continue;
    for (const auto& [name, value] : parameters_of(drawn.setup, term))
      text += fmt::format("parameters = {{ {} = {} }}\n", name, toml_number(value));
  }
  if (!drawn.setup.map.empty()) text += "[map]\nfile = \"map.csv\"\n";
  if (const auto& known = drawn.setup.known)
    text += fmt::format("[[known]]\ncode = \"{}\"\np_mm = {}\nvalue = {}\n", known->code, list_of(known->p_mm),
                        list_of(known->value));
  return text;
}

std::string map_csv(const std::vector<MapTable>& tables) {
  std::string text = "axis,sense,approach,p_mm,value_um\n";
  for (const MapTable& table : tables)
    for (std::size_t k = 0; k < table.p_mm.size(); ++k)
      text += fmt::format("{},{},{},{},{}\n", table.axis, table.sense, table.approach, shortest(tidy(table.p_mm[k])),
                          shortest(tidy(table.value_um[k])));
  return text;
}

Json parameters_json(const Case& drawn, std::size_t index) {
  const Term& term = drawn.hidden[index];
  const std::map<std::string, double> sigmas = parameter_sigmas(drawn, index);
  Json parameters = Json::object();
  for (const auto& [name, value] : parameters_of(drawn.setup, term)) {
    const auto sigma = sigmas.find(name);
    parameters[name] = {{"value", value},
                        {"sigma", sigma == sigmas.end() ? Json() : ecs::number_or_null(sigma->second)}};
  }
  return parameters;
}

// Between which targets a step lies.
Json step_interval(const Setup& setup, const Term& term) {
  double low = -1e300;
  double high = 1e300;
  for (const Reading& reading : setup.readings) {
    const double at = reading.at_mm[index_of(term.axis)];
    if (at <= term.nonlinear) low = std::max(low, at);
    if (at > term.nonlinear) high = std::min(high, at);
  }
  const double datum = setup.machine.axes[index_of(term.axis)].datum_mm;
  return Json::array({low - datum, high - datum});
}

Json hidden_json(const Case& drawn, std::size_t index) {
  const Term& term = drawn.hidden[index];
  Json hidden = {{"name", name_of(term)}, {"effect", term.id}};
  hidden["axis"] = std::string(1, term.axis);
  hidden["sense"] = ecs::text_or_null(term.sense);
  hidden["code"] = ecs::text_or_null(term.code);
  hidden["approach"] = term.approach == 0 ? "both" : term.approach > 0 ? "forward" : "reverse";
  hidden["sensor"] = ecs::text_or_null(term.sensor);
  hidden["sensor2"] = ecs::text_or_null(term.sensor2);
  hidden["snr"] = drawn.snr[index];
  hidden["parameters"] = parameters_json(drawn, index);
  if (term.id == "step") hidden["interval_mm"] = step_interval(drawn.setup, term);
  return hidden;
}

std::vector<std::string> expected_verdicts(const Case& drawn) {
  if (drawn.row == "blank") return {"adequate"};
  if (!drawn.structure.empty()) return {"unexplained_structure"};
  return {"missing_effect", "partly_explained"};
}

Json truth_json(const Case& drawn) {
  Json truth = {{"row", drawn.row}, {"seed", drawn.seed}, {"verdicts", expected_verdicts(drawn)}};
  truth["hidden"] = Json::array();
  for (std::size_t k = 0; k < drawn.hidden.size(); ++k) truth["hidden"].push_back(hidden_json(drawn, k));
  truth["structure"] = ecs::text_or_null(drawn.structure);
  truth["free_base"] = ecs::text_or_null(drawn.free_base);
  truth["snr"] = drawn.snr;
  truth["required_rivals"] = drawn.required;
  truth["allowed_rivals"] = drawn.allowed;
  truth["noise"] = {{"law", drawn.noise.law},
                    {"sigma_um", drawn.noise.sigma_um},
                    {"correlation", drawn.noise.correlation},
                    {"step_um", drawn.noise.step_um}};
  truth["oracle_right"] = drawn.oracle_right;
  truth["oracle_p"] = drawn.oracle_p;
  truth["base"] = Json::array();
  for (const Term& term : drawn.base) {
    Json base = {{"name", name_of(term)}};
    for (const auto& [name, value] : parameters_of(drawn.setup, term)) base[name] = value;
    truth["base"].push_back(base);
  }
  truth["runs"] = drawn.setup.readings.back().run;
  truth["readings"] = drawn.setup.readings.size();
  return truth;
}

}  // namespace

ecs::Result<void> write_case(const std::filesystem::path& folder, const Case& drawn) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  std::vector<std::pair<const char*, std::string>> files = {{"data.csv", data_csv(drawn)},
                                                            {"machine.toml", machine_toml(drawn.setup.machine)},
                                                            {"model.toml", model_toml(drawn)},
                                                            {"truth.json", truth_json(drawn).dump(1) + "\n"}};
  if (!drawn.setup.map.empty()) files.emplace_back("map.csv", map_csv(drawn.setup.map));
  for (const auto& [name, text] : files)
    if (auto written = ecs::write_file(folder / name, text); !written) return written;
  return {};
}

}  // namespace foreign
