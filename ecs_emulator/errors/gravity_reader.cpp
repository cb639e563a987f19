// [gravity], [ram.Z], [bed.X], [table.X] of the errors file.
#include <fmt/format.h>

#include "ecs_emulator/errors/reader.hpp"

namespace ecs::emulator {
namespace {

bool across(ErrorsReading& reading, const char* name, Axis axis, const toml::table& table) {
  if (axis != reading.parts.gravity.axis) return true;
  reading.reader.complain(
      table, fmt::format("{}.{}: expected an axis across gravity, which acts along it", name, letter_of(axis)));
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
  if (!right) {
    const toml::node* node = table.get("supports_mm");
    reader.complain(node != nullptr ? *node : table, "supports_mm: expected two coordinates, ascending");
  }
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
      const toml::node* node = table->get("direction");
      reader.complain(node != nullptr ? *node : *table,
                      fmt::format("direction: expected the way things fall, such as \"-Y\", got \"{}\"", word));
      return;
    }
  } else {
    for (const char* name : {"ram", "bed", "table"})
      if (const toml::node* node = reading.file.get(name)) {
        const toml::table* tables = node->as_table();
        const toml::node& place = tables != nullptr && !tables->empty() ? tables->begin()->second : *node;
        reader.complain(place, fmt::format("{}: expected a table [gravity] with direction = \"-Y\" or the like", name));
      }
    return;
  }
  for_each_axis(reading, "ram", [&](Axis a, const toml::table& t) { ram(reading, a, t); });
  for_each_axis(reading, "bed", [&](Axis a, const toml::table& t) { bed(reading, a, t); });
  for_each_axis(reading, "table", [&](Axis a, const toml::table& t) { load_table(reading, a, t); });
}

}  // namespace ecs::emulator
