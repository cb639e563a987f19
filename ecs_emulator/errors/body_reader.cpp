// Bodies of the errors file: [temperature], [air], [column], [material], [spindle], [screw.X], [sensor.name];
// [gravity], [ram.Z], [bed.X], [table.X].
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "ecs_emulator/errors/reader.hpp"

namespace ecs::emulator {
namespace {

bool is_name(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

void read_temperatures(ErrorsReading& reading) {
  const toml::table* table = reading.reader.child(reading.file, "temperature");
  if (table == nullptr) return;
  for (const auto& [key, node] : *table) reading.parts.variables.temperatures.emplace(std::string(key.str()), 20.0);
  for (const auto& [key, node] : *table)
    if (auto formula = formula_in(reading, *table, key.str()))
      reading.parts.temperatures.push_back({std::string(key.str()), std::move(*formula)});
}

void read_air(ErrorsReading& reading) {
  TomlReader& reader = reading.reader;
  const toml::table* table = reader.child(reading.file, "air");
  if (table == nullptr) return;
  DaySettings day;
  constexpr Sign any = Sign::any, not_negative = Sign::not_negative;
  numbers_into(reader, *table, "air",
               {{"mean_degC", &day.mean_degC, any, 60.0},
                {"swing_degC", &day.swing_degC, not_negative, 40.0},
                {"warmest_h", &day.warmest_h, not_negative, 24.0},
                {"start_h", &day.start_h, not_negative, 24.0},
                {"wander_degC", &day.wander_degC, not_negative, 40.0},
                {"pressure_hPa", &day.pressure_hPa, Sign::positive, 1200.0},
                {"pressure_wander_hPa", &day.pressure_wander_hPa, not_negative, 200.0},
                {"humidity_pct", &day.humidity_pct, not_negative, 100.0},
                {"humidity_wander_pct", &day.humidity_wander_pct, not_negative, 100.0}});
  if (day.mean_degC < -40.0) reader.complain(*table->get("mean_degC"), "mean_degC: expected -40 or more");
  reading.parts.heat.air = day;
}

void read_body(ErrorsReading& reading, const char* name, BodySettings& body) {
  TomlReader& reader = reading.reader;
  const toml::table* table = reader.child(reading.file, name);
  if (table == nullptr) return;
  numbers_into(reader, *table, name, {{"lag_s", &body.lag_s, Sign::positive}}, {"start_degC"});
  body.start_degC = reader.number(*table, "start_degC");
}

std::vector<std::array<double, 2>> steps_in(TomlReader& reader, const toml::node& node) {
  std::vector<std::array<double, 2>> steps;
  const toml::array* rows = node.as_array();
  if (rows == nullptr) {
    reader.complain(node, "steps: expected [[time_s, rpm], …]");
    return steps;
  }
  for (const toml::node& row : *rows) {
    const toml::array* cells = row.as_array();
    const bool two = cells != nullptr && cells->size() == 2;
    const auto time_s = two ? (*cells)[0].value<double>() : std::nullopt;
    const auto rpm = two ? (*cells)[1].value<double>() : std::nullopt;
    if (!time_s || !rpm || *time_s < 0.0 || *rpm < 0.0 || (!steps.empty() && *time_s <= steps.back()[0])) {
      reader.complain(row, "steps: expected [time_s, rpm], both 0 or more, times ascending");
      return {};
    }
    steps.push_back({*time_s, *rpm});
  }
  return steps;
}

void read_spindle(ErrorsReading& reading) {
  TomlReader& reader = reading.reader;
  const toml::table* table = reader.child(reading.file, "spindle");
  if (table == nullptr) return;
  SpindleSettings spindle;
  const auto letter = reader.word(*table, "axis").value_or("Z");
  if (const auto axis = letter.size() == 1 ? axis_of(letter[0]) : std::nullopt)
    spindle.axis = *axis;
  else
    reader.complain(*table->get("axis"), "axis: expected X, Y or Z, got \"{}\"", letter);
  numbers_into(reader, *table, "spindle",
               {{"lag_s", &spindle.lag_s, Sign::positive},
                required("degC_per_1000_rpm", spindle.degC_per_1000_rpm, Sign::not_negative),
                {"growth_um_per_degC", &spindle.growth_um_per_degC},
                {"tilt_um_per_m_degC", &spindle.tilt_um_per_m_degC}},
               {"axis", "tilt", "steps"});
  if (const auto word = reader.word(*table, "tilt")) {
    spindle.tilt = sense_named(*word);
    if (!spindle.tilt || !is_rotation(*spindle.tilt))
      reader.complain(*table->get("tilt"), "tilt: expected EA, EB or EC, got \"{}\"", *word);
  }
  if (table->contains("tilt_um_per_m_degC") != table->contains("tilt"))
    reader.complain(*table, "spindle: expected both of tilt and tilt_um_per_m_degC, or none");
  if (const toml::node* node = table->get("steps")) spindle.steps = steps_in(reader, *node);
  demand(reading, *table, "spindle", spindle.axis);
  reading.parts.heat.spindle = spindle;
}

void read_screw(ErrorsReading& reading, Axis axis, const toml::table& table) {
  TomlReader& reader = reading.reader;
  ScrewSettings screw;
  screw.axis = axis;
  constexpr Sign not_negative = Sign::not_negative, positive = Sign::positive;
  numbers_into(reader, table, "screw",
               {required("fixed_bearing_mm", screw.fixed_bearing_mm, Sign::any),
                {"expansion_um_per_m_degC", &screw.expansion_um_per_m_degC, not_negative},
                required("friction_N", screw.friction_N, not_negative),
                {"friction_N_per_m_min", &screw.friction_N_per_m_min, not_negative},
                required("heat_capacity_J_per_m_degC", screw.heat_capacity_J_per_m_degC, positive),
                {"loss_s", &screw.loss_s, positive},
                {"diffusivity_mm2_s", &screw.diffusivity_mm2_s, not_negative},
                {"cell_mm", &screw.cell_mm, positive}},
               {"feedback"});
  if (screw.diffusivity_mm2_s > kMostDiffusion_per_s * screw.cell_mm * screw.cell_mm)
    reader.complain(table, "cell_mm: expected at least {:.1f} with this diffusivity_mm2_s, got {}",
                    std::sqrt(screw.diffusivity_mm2_s / kMostDiffusion_per_s), screw.cell_mm);
  if (const auto word = reader.word(table, "feedback")) {
    screw.positions = *word == "screw";
    if (*word != "screw" && *word != "scale")
      reader.complain(*table.get("feedback"), "feedback: expected screw or scale, got \"{}\"", *word);
  }
  demand(reading, table, fmt::format("screw.{}", letter_of(axis)), axis);
  reading.parts.heat.screws.push_back(screw);
}

/// What `of` names; complains where this file does not describe it.
void body_into(ErrorsReading& reading, const toml::table& table, SensorSettings& sensor) {
  using Of = SensorSettings::Of;
  const std::string of = reading.reader.word(table, "of").value_or("");
  const auto& screws = reading.parts.heat.screws;
  const auto axis = of.size() == 7 && of.starts_with("screw_") ? axis_of(of.back()) : std::nullopt;
  const bool screw = axis && std::any_of(screws.begin(), screws.end(), [&](const auto& s) { return s.axis == *axis; });
  const auto complain_of = [&](std::string message) {
    reading.reader.complain(place_of(table, "of"), std::move(message));
  };
  if (of == "air") {
    sensor.of = Of::air;
  } else if (of == "material") {
    sensor.of = Of::material;
  } else if (of == "column") {
    sensor.of = Of::column;
  } else if (of == "spindle") {
    sensor.of = Of::spindle;
    if (!reading.parts.heat.spindle) complain_of("of: this file has no table [spindle]");
  } else if (axis) {
    sensor.of = Of::screw;
    sensor.axis = *axis;
    if (!screw) complain_of(fmt::format("of: this file has no table [screw.{}]", letter_of(*axis)));
  } else {
    complain_of(fmt::format("of: expected air, material, column, spindle or screw_X, got \"{}\"", of));
  }
}

void read_sensor(ErrorsReading& reading, std::string_view name, const toml::table& table) {
  TomlReader& reader = reading.reader;
  SensorSettings sensor;
  sensor.name = std::string(name);
  if (!is_name(name)) reader.complain(table, "sensor: expected a name of letters, digits and _, got \"{}\"", name);
  if (!reading.parts.variables.temperatures.emplace(sensor.name, 20.0).second)
    reader.complain(table, "sensor: \"{}\" is already a sensor of [temperature]", name);
  body_into(reading, table, sensor);
  if (sensor.of == SensorSettings::Of::screw)
    required_into(reader, table, "at_mm", Sign::any, sensor.at_mm);
  else if (const toml::node* node = table.get("at_mm"))
    reader.complain(*node, "at_mm: only a sensor of a screw has a position along it");
  numbers_into(reader, table, "sensor",
               {{"lag_s", &sensor.lag_s, Sign::not_negative},
                {"offset_degC", &sensor.offset_degC},
                {"noise_degC", &sensor.noise_degC, Sign::not_negative},
                {"resolution_degC", &sensor.resolution_degC, Sign::not_negative}},
               {"of", "at_mm"});
  reading.parts.heat.sensors.push_back(sensor);
}

bool across(ErrorsReading& reading, const char* name, Axis axis, const toml::table& table) {
  if (axis != reading.parts.gravity.axis) return true;
  reading.reader.complain(table, "{}.{}: expected an axis across gravity, which acts along it", name, letter_of(axis));
  return false;
}

void ram(ErrorsReading& reading, Axis axis, const toml::table& table) {
  TomlReader& reader = reading.reader;
  Ram ram;
  ram.axis = axis;
  numbers_into(reader, table, "ram",
               {{"retracted_mm", &ram.retracted_mm},
                {"overhang_mm", &ram.overhang_mm, Sign::not_negative},
                required("stiffness_N_m2", ram.beam.stiffness_N_m2, Sign::positive),
                required("mass_kg_m", ram.beam.mass_kg_m, Sign::not_negative),
                {"tip_kg", &ram.beam.tip_kg, Sign::not_negative}},
               {"extends"});
  sign_into(reader, table, "extends", ram.extends);
  if (!across(reading, "ram", axis, table)) return;
  demand(reading, table, fmt::format("ram.{}", letter_of(axis)), axis, Demand::Side::tool);
  reading.parts.gravity.rams.push_back(ram);
}

void bed(ErrorsReading& reading, Axis axis, const toml::table& table) {
  TomlReader& reader = reading.reader;
  reader.only(table, {"supports_mm", "stiffness_N_m2", "carriage_kg", "centre_mm"}, "bed");
  Bed bed;
  bed.axis = axis;
  const toml::array* supports = table["supports_mm"].as_array();
  const auto low_mm = supports != nullptr && supports->size() == 2 ? (*supports)[0].value<double>() : std::nullopt;
  const auto high_mm = supports != nullptr && supports->size() == 2 ? (*supports)[1].value<double>() : std::nullopt;
  const bool right = low_mm && high_mm && *low_mm < *high_mm;
  if (!right) reader.complain(place_of(table, "supports_mm"), "supports_mm: expected two coordinates, ascending");
  required_into(reader, table, "stiffness_N_m2", Sign::positive, bed.stiffness_N_m2);
  required_into(reader, table, "carriage_kg", Sign::not_negative, bed.carriage_kg);
  if (right) bed.supports_mm = {*low_mm, *high_mm};
  bed.centre_mm = 0.5 * (bed.supports_mm[0] + bed.supports_mm[1]);
  number_into(reader, table, "centre_mm", Sign::any, bed.centre_mm);
  if (!across(reading, "bed", axis, table) || !right) return;
  demand(reading, table, fmt::format("bed.{}", letter_of(axis)), axis, Demand::Side::any, bed.supports_mm);
  reading.parts.gravity.beds.push_back(bed);
}

void load_table(ErrorsReading& reading, Axis axis, const toml::table& table) {
  TomlReader& reader = reading.reader;
  Table springs;
  springs.axis = axis;
  numbers_into(reader, table, "table",
               {required("stiffness_N_um", springs.stiffness_N_um, Sign::positive),
                required("base_mm", springs.base_mm, Sign::positive),
                required("load_at_mm", springs.load_at_mm, Sign::any),
                {"saddle_mm", &springs.saddle_mm}});
  if (!across(reading, "table", axis, table)) return;
  demand(reading, table, fmt::format("table.{}", letter_of(axis)), axis, Demand::Side::workpiece);
  reading.parts.gravity.tables.push_back(springs);
}

}  // namespace

void read_heat(ErrorsReading& reading) {
  read_air(reading);
  read_body(reading, "column", reading.parts.heat.column);
  read_body(reading, "material", reading.parts.heat.material);
  read_spindle(reading);
  for_each_axis(reading, "screw", [&](Axis a, const toml::table& t) { read_screw(reading, a, t); });
  read_temperatures(reading);
  if (const toml::table* sensors = reading.reader.child(reading.file, "sensor"))
    for (const auto& [key, node] : *sensors)
      if (const toml::table* table = reading.reader.child(*sensors, key.str())) read_sensor(reading, key.str(), *table);
}

void read_gravity(ErrorsReading& reading) {
  TomlReader& reader = reading.reader;
  if (const toml::table* table = reader.child(reading.file, "gravity")) {
    reader.only(*table, {"direction"}, "gravity");
    const auto word = reader.word(*table, "direction").value_or("");
    const auto axis = word.size() == 2 ? axis_of(word[1]) : std::nullopt;
    if (axis && (word[0] == '-' || word[0] == '+')) {
      reading.parts.gravity.axis = *axis;
      reading.parts.gravity.sign = word[0] == '-' ? -1 : 1;
    } else {
      reader.complain(place_of(*table, "direction"),
                      "direction: expected the direction of gravity, such as \"-Y\", got \"{}\"", word);
      return;
    }
  } else {
    for (const char* name : {"ram", "bed", "table"})
      if (const toml::node* node = reading.file.get(name)) {
        const toml::table* tables = node->as_table();
        const toml::node& place = tables != nullptr && !tables->empty() ? tables->begin()->second : *node;
        reader.complain(place, "{}: expected a table [gravity] with direction = \"-Y\" or the like", name);
      }
    return;
  }
  for_each_axis(reading, "ram", [&](Axis a, const toml::table& t) { ram(reading, a, t); });
  for_each_axis(reading, "bed", [&](Axis a, const toml::table& t) { bed(reading, a, t); });
  for_each_axis(reading, "table", [&](Axis a, const toml::table& t) { load_table(reading, a, t); });
}

}  // namespace ecs::emulator
