// The rows of the unit as a whole: what a parameter is called, means and may hold. Those of an axis live in
// field_table_axis.cpp; how rows are set, printed and judged in fields.cpp.
#include "params/field_table.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "core/chain.hpp"
#include "params/field_rows.hpp"

namespace ecs::params {
namespace {

bool put_chain(UnitParameters& parameters, std::string_view text) {
  if (text.size() >= parameters.configuration.size() || !ecs::chain_of(text)) return false;
  parameters.configuration.fill('\0');
  std::copy(text.begin(), text.end(), parameters.configuration.begin());
  return true;
}

std::string axes_text(const UnitParameters& parameters) {
  std::string letters;
  for (const Axis a : kAllAxes)
    if (parameters.axis_present[index_of(a)]) letters += letter_of(a);
  return letters;
}

bool put_axes(UnitParameters& parameters, std::string_view text) {
  PerAxis<bool> present{};
  for (const char letter : text) {
    const auto axis = axis_of(letter);
    if (!axis || present[index_of(*axis)]) return false;
    present[index_of(*axis)] = true;
  }
  if (text.empty()) return false;
  parameters.axis_present = present;
  return true;
}

constexpr std::array<Plane, 6> kPlanes{{{Axis::X, Axis::Y},
                                        {Axis::X, Axis::Z},
                                        {Axis::Y, Axis::Z},
                                        {Axis::Y, Axis::X},
                                        {Axis::Z, Axis::X},
                                        {Axis::Z, Axis::Y}}};

Field plane_field() {
  Field field = row({"compensation.plane", Group::compensation,
                     "Which two axes a planar scope corrects; the order of the letters does not matter. Other scopes "
                     "ignore it.",
                     "compensation required (linear, planar or volumetric)"},
                    FieldType::choice);
  for (const Plane plane : kPlanes) field.choices.push_back({letter_of(plane.first), letter_of(plane.second)});
  field.most = static_cast<double>(kPlanes.size() - 1);
  field.get = [](const UnitParameters& p) {
    const auto found = std::find(kPlanes.begin(), kPlanes.end(), p.plane);
    return found == kPlanes.end() ? -1.0 : static_cast<double>(found - kPlanes.begin());
  };
  field.put = [](UnitParameters& p, double place) { p.plane = kPlanes[static_cast<std::size_t>(place)]; };
  return field;
}

void add_configuration(std::vector<Field>& table) {
  Field chain = row({"configuration.chain", Group::configuration,
                     "How the machine is built: letters after T carry the tool, letters before it the workpiece, both "
                     "from the base outward. TXYZ = moving column mill, XYTZ = compound table; a lathe is XTYZ without "
                     "axis X. Walk from the bed to the tool and to the table and write down what you meet.",
                     "axis configuration"},
                    FieldType::text);
  chain.accepts = "one T and different letters of XYZ, such as \"TXYZ\"";
  chain.get_text = [](const UnitParameters& p) { return std::string(configuration_of(p)); };
  chain.put_text = put_chain;
  table.push_back(chain);
  Field axes = row({"configuration.axes", Group::configuration,
                    "The axes that the machine has and the unit is wired to: one axis module for each letter.",
                    "number of machine axes; axes names (X,Y,Z)"},
                   FieldType::text);
  axes.accepts = "one to three different letters of XYZ";
  axes.get_text = axes_text;
  axes.put_text = put_axes;
  table.push_back(axes);
  table.push_back(choice(
      {"configuration.measurement_system", Group::configuration,
       "In which system the control shows positions; the unit itself always reckons in mm.",
       "machine measurement system (imperial or metric)"},
      {"metric", "imperial"}, [](auto& p) -> auto& { return p.measurement_system; }));
}

void add_squareness(std::vector<Field>& table) {
  const Range range{-10'000.0, 10'000.0};
  const auto words = [](std::string_view code, std::string_view pair) {
    return Words{
        fmt::format("compensation.squareness.{}_um_per_m", code), Group::compensation,
        fmt::format("Squareness error of {} in the signs of ISO 230-1 (the error, not the compensation), from a "
                    "square, diagonals or a ball bar.",
                    pair),
        "squareness offsets"};
  };
  table.push_back(number(
      words("C0Y", "Y to X"), "um/m", range, [](auto& p) -> auto& { return p.C0Y_um_per_m; }));
  table.push_back(number(
      words("B0Z", "Z to X"), "um/m", range, [](auto& p) -> auto& { return p.B0Z_um_per_m; }));
  table.push_back(number(
      words("A0Z", "Z to Y"), "um/m", range, [](auto& p) -> auto& { return p.A0Z_um_per_m; }));
}

void add_compensation(std::vector<Field>& table) {
  const Group group = Group::compensation;
  table.push_back(integer(
      {"compensation.memory_modules", group,
       "Axis memory modules in the rack; each holds 32,000 error values. One is enough for most "
       "machines.",
       "number of axis memory modules required"},
      {1.0, static_cast<double>(kMostModules)}, [](auto& p) -> auto& { return p.memory_modules; }));
  table.push_back(choice(
      {"compensation.scope", group,
       "How far the unit corrects: linear = the positioning error of each axis, planar = everything "
       "in one plane (two axes), volumetric = everything (three axes).",
       "compensation required (linear, planar or volumetric)"},
      {"linear", "planar", "volumetric"}, [](auto& p) -> auto& { return p.scope; }));
  table.push_back(plane_field());
  table.push_back(choice(
      {"compensation.interpolation", group,
       "Between two values of the map: nearest steps half an increment before the next one as the "
       "original unit does, linear joins them by a straight line.",
       ""},
      {"nearest", "linear"}, [](auto& p) -> auto& { return p.interpolation; }));
  table.push_back(choice(
      {"compensation.convention", group,
       "Signs and terms of the error model: iso for every chain; as_printed = the thesis equations "
       "as printed, only for maps made with them, and squareness then in the printed signs too.",
       ""},
      {"iso", "as_printed"}, [](auto& p) -> auto& { return p.convention; }));
  table.push_back(number(
      {"compensation.loop_period_us", group,
       "Fixed time of one compensation loop; take the servo update time of the control.",
       "compensation loop iteration time"},
      "us", {100.0, 20'000.0}, [](auto& p) -> auto& { return p.loop_period_us; }));
  table.push_back(number(
      {"compensation.angular_scale", group,
       "Factor on every angular term: 1 when the map holds um/m, 4.8481 when it holds arc seconds, "
       "0 switches angular correction off.",
       "angular scaling factor"},
      "", {-10.0, 10.0}, [](auto& p) -> auto& { return p.angular_scale; }));
  for (const Axis a : kAllAxes) {
    const auto i = index_of(a);
    table.push_back(number(
        {fmt::format("compensation.tool_offset_mm.{}", static_cast<char>(letter_of(a) - 'X' + 'x')), group,
         fmt::format("Distance along {} from the point where the curves were measured to the tool "
                     "point; 0 if the optics stood at the tool point.",
                     letter_of(a)),
         ""},
        "mm", {-10'000.0, 10'000.0}, [i](auto& p) -> auto& { return p.tool_offset_mm[i]; }));
  }
  add_squareness(table);  // a table of its own, so it follows what stands in [compensation]
}

}  // namespace

std::vector<Field> field_table() {
  std::vector<Field> table;
  add_configuration(table);
  add_compensation(table);
  for (const Axis axis : kAllAxes) {
    for (Field& field : axis_fields(axis)) table.push_back(std::move(field));
  }
  return table;
}

}  // namespace ecs::params
