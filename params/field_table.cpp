// The rows of the field table: what a parameter is called, means and may hold; those of the unit as a whole, then those
// of one axis (transducer, output, measurement line, datum). How rows are set, printed and judged: fields.cpp.
#include <algorithm>
#include <array>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/terms.hpp"
#include "params/fields.hpp"

namespace ecs::params {
namespace {

/// What a row says about itself, apart from its type and its place in UnitParameters.
struct Words {
  std::string key;
  Group group;
  std::string help;
  std::string thesis_name = {};
};

struct Range {
  double least;
  double most;
  bool zero_allowed = true;
};

Field row(Words words, FieldType type) {
  Field field;
  field.key = std::move(words.key);
  field.group = words.group;
  field.type = type;
  field.help = std::move(words.help);
  field.thesis_name = std::move(words.thesis_name);
  return field;
}

/// `member` gives the place in a UnitParameters, const or not: [](auto& p) -> auto& { return p.loop_period_us; }.
template <class Member>
void stored_in(Field& field, Member member) {
  field.get = [member](const UnitParameters& p) { return static_cast<double>(member(p)); };
  field.put = [member](UnitParameters& p, double value) {
    using Value = std::remove_reference_t<decltype(member(p))>;
    member(p) = static_cast<Value>(value);
  };
}

template <class Member>
Field number(Words words, std::string unit, Range range, Member member) {
  Field field = row(std::move(words), FieldType::number);
  field.unit = std::move(unit);
  field.least = range.least;
  field.most = range.most;
  field.zero_allowed = range.zero_allowed;
  stored_in(field, member);
  return field;
}

template <class Member>
Field integer(Words words, Range range, Member member) {
  Field field = number(std::move(words), "", range, member);
  field.type = FieldType::integer;
  return field;
}

template <class Member>
Field truth(Words words, Member member) {
  Field field = row(std::move(words), FieldType::truth);
  field.most = 1.0;
  stored_in(field, member);
  return field;
}

/// @param choices  in the order of the enumeration
template <class Member>
Field choice(Words words, std::vector<std::string> choices, Member member) {
  Field field = row(std::move(words), FieldType::choice);
  field.most = static_cast<double>(choices.size() - 1);
  field.choices = std::move(choices);
  stored_in(field, member);
  return field;
}

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
    const auto found = std::ranges::find(kPlanes, p.plane);
    return found == kPlanes.end() ? -1.0 : static_cast<double>(found - kPlanes.begin());
  };
  field.put = [](UnitParameters& p, double place) { p.plane = kPlanes[static_cast<std::size_t>(place)]; };
  return field;
}

void add_configuration(std::vector<Field>& table) {
  Field chain = row(
      {"configuration.chain", Group::configuration,
       "How the machine is built: letters before T are the axes that carry the workpiece, letters after T those that "
       "carry the tool, each group from the bed outward. TXYZ: moving-column mill. XYTZ: compound table. TZX: lathe. "
       "The chain may name an axis that the machine does not have: leave it out of configuration.axes. A lathe whose "
       "cross slide is called Y has the chain XTYZ and the axes YZ.",
       "axis configuration"},
      FieldType::text);
  chain.accepts = "the letter T and one to three of X, Y, Z, each once, such as \"TXYZ\"";
  chain.get_text = [](const UnitParameters& p) { return std::string(configuration_of(p)); };
  chain.put_text = put_chain;
  table.push_back(chain);
  Field axes = row({"configuration.axes", Group::configuration,
                    "The machine axes that are wired to the unit: one axis module for each letter.",
                    "number of machine axes; axes names (X,Y,Z)"},
                   FieldType::text);
  axes.accepts = "one to three of X, Y, Z, each once";
  axes.get_text = axes_text;
  axes.put_text = put_axes;
  table.push_back(axes);
  table.push_back(choice(
      {"configuration.measurement_system", Group::configuration,
       "The system in which the control shows positions; the unit always calculates in mm.",
       "machine measurement system (imperial or metric)"},
      {"metric", "imperial"}, [](auto& p) -> auto& { return p.measurement_system; }));
}

void add_squareness(std::vector<Field>& table) {
  const Range range{-10'000.0, 10'000.0};
  const auto words = [](std::string_view code, std::string_view pair) {
    return Words{
        fmt::format("compensation.squareness.{}_um_per_m", code), Group::compensation,
        fmt::format("Squareness error of {} with the signs of ISO 230-1 (the error, not the compensation), from a "
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

/// What changes while the unit compensates.
void add_tools(std::vector<Field>& table) {
  const Group group = Group::compensation;
  const std::size_t before = table.size();
  table.push_back(number(
      {"compensation.tool_rate_um_per_s", group,
       "Fastest change of the output after another tool was selected, so that no axis steps.", ""},
      "um/s", {0.1, 10'000.0}, [](auto& p) -> auto& { return p.tool_rate_um_per_s; }));
  table.push_back(number(
      {"compensation.load_range_kg", group,
       "Largest load on the machine, from which the unit computes how wrong its output may be while the load is "
       "unknown. With 0, an unknown load is not monitored.",
       ""},
      "kg", {0.0, 1e6}, [](auto& p) -> auto& { return p.load_range_kg; }));
  table.push_back(number(
      {"compensation.unknown_input_limit_um", group,
       "The unit opens its relays if an unknown tool or load could make its output wrong by more than this.", ""},
      "um", {0.1, 10'000.0}, [](auto& p) -> auto& { return p.unknown_input_limit_um; }));
  for (const Axis a : kAllAxes) {
    const auto i = index_of(a);
    table.push_back(number(
        {fmt::format("compensation.tool_range_mm.{}", small_letter_of(a)), group,
         fmt::format("Largest tool offset along {} in the unit's table of tools. Set it to 0 along every axis if no "
                     "tool is selected while the unit compensates.",
                     letter_of(a)),
         ""},
        "mm", {0.0, 10'000.0}, [i](auto& p) -> auto& { return p.tool_range_mm[i]; }));
  }
  for (std::size_t k = before; k < table.size(); ++k) table[k].may_be_absent = true;
}

void add_compensation(std::vector<Field>& table) {
  const Group group = Group::compensation;
  table.push_back(integer(
      {"compensation.memory_modules", group,
       "Axis memory modules that parameters and map may use, at most those in the rack; each stores 32,000 error "
       "values. One "
       "is enough for most machines.",
       "number of axis memory modules required"},
      {1.0, static_cast<double>(kMostModules)}, [](auto& p) -> auto& { return p.memory_modules; }));
  table.push_back(choice(
      {"compensation.scope", group,
       "Errors that the unit corrects: linear = the positioning error of each axis, planar = all errors in one plane "
       "(two axes), volumetric = all errors (three axes).",
       "compensation required (linear, planar or volumetric)"},
      {"linear", "planar", "volumetric"}, [](auto& p) -> auto& { return p.scope; }));
  table.push_back(plane_field());
  table.push_back(choice(
      {"compensation.interpolation", group,
       "nearest: the output changes halfway between two values of the map, as in the original unit; linear: it follows "
       "the straight line between them.",
       ""},
      {"nearest", "linear"}, [](auto& p) -> auto& { return p.interpolation; }));
  table.push_back(choice(
      {"compensation.convention", group,
       "Signs and terms of the error model: iso for every chain. as_printed = the equations as the thesis prints them, "
       "only for maps that were made with them; squareness then has the printed signs too.",
       ""},
      {"iso", "as_printed"}, [](auto& p) -> auto& { return p.convention; }));
  table.push_back(number(
      {"compensation.loop_period_us", group,
       "Fixed time of one compensation loop; use the servo update time of the control.",
       "compensation loop iteration time"},
      "us", {100.0, 20'000.0}, [](auto& p) -> auto& { return p.loop_period_us; }));
  table.push_back(number(
      {"compensation.angular_scale", group,
       "Factor on every angular term: 1 for a map in um/m, 4.8481 for a map in arc seconds, 0 switches angular "
       "correction off.",
       "angular scaling factor"},
      "", {-10.0, 10.0}, [](auto& p) -> auto& { return p.angular_scale; }));
  for (const Axis a : kAllAxes) {
    const auto i = index_of(a);
    table.push_back(number(
        {fmt::format("compensation.tool_offset_mm.{}", small_letter_of(a)), group,
         fmt::format("Distance along {} from the point where the curves were measured to the tool point; 0 if the "
                     "optics were at the tool point.",
                     letter_of(a)),
         ""},
        "mm", {-10'000.0, 10'000.0}, [i](auto& p) -> auto& { return p.tool_offset_mm[i]; }));
  }
  add_tools(table);
  add_squareness(table);  // a table of its own, so it follows what stands in [compensation]
}

/// A field of one axis with its key under "axis.X.".
void push(std::vector<Field>& table, Axis axis, Field field) {
  field.key = fmt::format("axis.{}.{}", letter_of(axis), field.key);
  field.axis = axis;
  table.push_back(std::move(field));
}

void add_axis_configuration(std::vector<Field>& table, Axis axis) {
  const auto i = index_of(axis);
  push(table, axis,
       choice(
           {"transducer", Group::configuration, "Position transducer of the axis; determines the axis module.",
            "type of position transducer (encoder or resolver)"},
           {"encoder", "resolver"}, [i](auto& p) -> auto& { return p.axes[i].transducer; }));
  push(table, axis,
       number(
           {"position_scale_um_per_count", Group::configuration,
            "Travel per position count; negative if the transducer counts in the opposite direction. Move a known "
            "distance and compare the monitor with the control.",
            "position feedback scaling factor"},
           "um/count",
           {-1000.0, 1000.0, false}, [i](auto& p) -> auto& { return p.axes[i].position_scale_um_per_count; }));
}

void add_axis_compensation(std::vector<Field>& table, Axis axis) {
  const auto i = index_of(axis);
  const Group group = Group::compensation;
  push(table, axis,
       number(
           {"deadband_um", group,
            "Travel that is regarded as a move in a new direction before the unit changes between the forward and the "
            "reverse table; a few position counts, more than the vibration of the axis at rest.",
            "minimum distance to qualify as move (encoder deadband)"},
           "um", {0.0, 10'000.0}, [i](auto& p) -> auto& { return p.axes[i].deadband_um; }));
  push(
      table, axis,
      number(
          {"output_scale_counts_per_um", group,
           "D/A counts that move the axis by one um. Output a known value with the relay closed and measure how far "
           "the axis moves.",
           "compensation output value scaling factor"},
          "counts/um", {0.0, 32'767.0, false}, [i](auto& p) -> auto& { return p.axes[i].output_scale_counts_per_um; }));
  push(table, axis,
       integer(
           {"compensation_polarity", group,
            "1: the values of the map (compensation = -error) are added; -1 if the drive input is inverted. With the "
            "wrong polarity errors double.",
            "compensation polarity"},
           {-1.0, 1.0, false}, [i](auto& p) -> auto& { return p.axes[i].compensation_polarity; }));
  push(table, axis,
       number(
           {"output_limit_um", group,
            "Largest compensation output; beyond it the value is limited and flagged. Set it slightly above the "
            "largest error in the map.",
            ""},
           "um", {0.0, 10'000.0}, [i](auto& p) -> auto& { return p.axes[i].output_limit_um; }));
  push(table, axis,
       number(
           {"output_slew_um_per_s", group,
            "Fastest change of the compensation: slow enough not to jerk the axis at a reversal, fast enough to "
            "follow the map at the highest feed.",
            ""},
           "um/s", {0.0, 10'000'000.0, false}, [i](auto& p) -> auto& { return p.axes[i].output_slew_um_per_s; }));
  push(table, axis,
       number(
           {"position_loop_gain_per_s", group,
            "Gain of the control's position loop (Kv), feed divided by following error: 1 m/min per mm is 16.7. The "
            "unit uses it to distinguish its own motion from that of the control, so that an axis at rest does not "
            "appear to reverse.",
            ""},
           "1/s", {1.0, 1'000.0}, [i](auto& p) -> auto& { return p.axes[i].position_loop_gain_per_s; }));
  for (const Axis lever : kAllAxes) {
    if (lever == axis) continue;
    const auto l = index_of(lever);
    push(table, axis,
         number(
             {fmt::format("measurement_line_mm.{}", small_letter_of(lever)), group,
              fmt::format("Position of {} while the curves of {} were measured; lever arms are measured from there.",
                          letter_of(lever), letter_of(axis)),
              ""},
             "mm", {-100'000.0, 100'000.0}, [ i, l ](auto& p) -> auto& { return p.measurement_lines_mm[i][l]; }));
  }
}

Field approach_direction_field(std::size_t i) {
  Field field = choice(
      {"datum.approach_direction", Group::datuming,
       "Direction in which the axis runs onto the reference switch: forward = increasing coordinate.",
       "reference switch approach direction"},
      {"forward", "reverse"}, [i](auto& p) -> auto& { return p.axes[i].datum.approach_direction; });
  field.get = [i](const UnitParameters& p) {
    const Approach approach = p.axes[i].datum.approach_direction;
    return approach == Approach::forward ? 0.0 : approach == Approach::reverse ? 1.0 : -1.0;
  };
  field.put = [i](UnitParameters& p, double place) {
    p.axes[i].datum.approach_direction = place < 0.5 ? Approach::forward : Approach::reverse;
  };
  return field;
}

void add_axis_datum(std::vector<Field>& table, Axis axis) {
  const auto i = index_of(axis);
  const Group group = Group::datuming;
  push(table, axis,
       choice(
           {"datum.kind", group,
            "How the control finds its reference: fanuc uses the first marker after leaving the switch in the same "
            "direction, allen_bradley the first after backing off it, siemens the first while still on it.",
            "datum type (e.g. Fanuc, Allen Bradley, Siemens)"},
           {"fanuc", "allen_bradley", "siemens"}, [i](auto& p) -> auto& { return p.axes[i].datum.kind; }));
  push(table, axis,
       integer(
           {"datum.switch_polarity", group,
            "1: a closed reference switch reads as active; -1: an open one does. Watch the monitor while pressing the "
            "switch manually.",
            "reference switch polarity"},
           {-1.0, 1.0, false}, [i](auto& p) -> auto& { return p.axes[i].datum.switch_polarity; }));
  push(table, axis,
       truth(
           {"datum.switch_initially_active", group, "State of the switch when the routine may begin.",
            "reference switch initial state"},
           [i](auto& p) -> auto& { return p.axes[i].datum.switch_initially_active; }));
  push(table, axis,
       truth(
           {"datum.switch_finally_active", group,
            "State of the switch when the marker is found: false for fanuc and allen_bradley, true for siemens.",
            "reference switch final state"},
           [i](auto& p) -> auto& { return p.axes[i].datum.switch_finally_active; }));
  push(table, axis,
       number(
           {"datum.approach_speed_mm_min", group,
            "Speed onto the switch, from a recorded datum sequence; the unit refuses to datum when the axis is "
            "faster than 1.5 times this on the switch.",
            "reference switch approach speed"},
           "mm/min", {0.0, 60'000.0, false}, [i](auto& p) -> auto& { return p.axes[i].datum.approach_speed_mm_min; }));
  push(table, axis, approach_direction_field(i));
  push(table, axis,
       number(
           {"datum.null_offset_mm", group, "Distance from the marker to the reference position, as set in the control.",
            "null offset value"},
           "mm", {-1000.0, 1000.0}, [i](auto& p) -> auto& { return p.axes[i].datum.null_offset_mm; }));
  push(table, axis,
       number(
           {"datum.reference_position_mm", group,
            "Machine coordinate of the reference position, as the control shows it after datuming.", ""},
           "mm", {-100'000.0, 100'000.0}, [i](auto& p) -> auto& { return p.axes[i].datum.reference_position_mm; }));
}

/// The rows of one axis, keys under "axis.X.".
std::vector<Field> axis_fields(Axis axis) {
  std::vector<Field> table;
  add_axis_configuration(table, axis);
  add_axis_compensation(table, axis);
  add_axis_datum(table, axis);
  return table;
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
