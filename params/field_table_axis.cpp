// The rows of one axis: transducer, output, measurement line, datum.
#include <fmt/format.h>

#include "params/field_rows.hpp"
#include "params/field_table.hpp"

namespace ecs::params {
namespace {

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
           {"transducer", Group::configuration, "What measures the position of the axis; decides the axis module.",
            "type of position transducer (encoder or resolver)"},
           {"encoder", "resolver"}, [i](auto& p) -> auto& { return p.axes[i].transducer; }));
  push(table, axis,
       number(
           {"position_scale_um_per_count", Group::configuration,
            "How far one position count is; negative if the transducer is wired the other way round. Move a known "
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
            "Travel that counts as a move in a new direction before the unit changes between the forward and the "
            "reverse table; a few position counts, more than the standing axis trembles.",
            "minimum distance to qualify as move (encoder deadband)"},
           "um", {0.0, 10'000.0}, [i](auto& p) -> auto& { return p.axes[i].deadband_um; }));
  push(
      table, axis,
      number(
          {"output_scale_counts_per_um", group,
           "D/A counts that move the axis by one um. Output a known value with the relay on and measure how far "
           "the axis moves.",
           "compensation output value scaling factor"},
          "counts/um", {0.0, 32'767.0, false}, [i](auto& p) -> auto& { return p.axes[i].output_scale_counts_per_um; }));
  push(table, axis,
       integer(
           {"compensation_polarity", group,
            "1: the values of the map (compensation = -error) are added; -1 if the drive input is inverted. With "
            "the wrong one errors double.",
            "compensation polarity"},
           {-1.0, 1.0, false}, [i](auto& p) -> auto& { return p.axes[i].compensation_polarity; }));
  push(table, axis,
       number(
           {"output_limit_um", group,
            "Largest compensation put out; beyond it the value is held and flagged. A little above the largest "
            "error in the map.",
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
            "Gain of the control's position loop (Kv), feed divided by following error: 1 m/min per mm is 16.7. By it "
            "the unit tells its own motion from the control's, so that a standing axis does not seem to turn.",
            ""},
           "1/s", {1.0, 1'000.0}, [i](auto& p) -> auto& { return p.axes[i].position_loop_gain_per_s; }));
  for (const Axis lever : kAllAxes) {
    if (lever == axis) continue;
    const auto l = index_of(lever);
    push(table, axis,
         number(
             {fmt::format("measurement_line_mm.{}", static_cast<char>(letter_of(lever) - 'X' + 'x')), group,
              fmt::format("Where {} stood while the curves of {} were measured; lever arms count from there.",
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
            "How the control finds its reference: fanuc takes the first marker after leaving the switch in the same "
            "direction, allen_bradley the first after backing off it, siemens the first while still on it.",
            "datum type (e.g. Fanuc, Allen Bradley, Siemens)"},
           {"fanuc", "allen_bradley", "siemens"}, [i](auto& p) -> auto& { return p.axes[i].datum.kind; }));
  push(table, axis,
       integer(
           {"datum.switch_polarity", group,
            "1: a closed reference switch reads as active; -1: an open one does. Watch the monitor while pressing "
            "the switch by hand.",
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
            "State of the switch when the marker is taken: false for fanuc and allen_bradley, true for siemens.",
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
           {"datum.null_offset_mm", group, "From the marker to the reference position, as set in the control.",
            "null offset value"},
           "mm", {-1000.0, 1000.0}, [i](auto& p) -> auto& { return p.axes[i].datum.null_offset_mm; }));
  push(table, axis,
       number(
           {"datum.reference_position_mm", group,
            "Machine coordinate of the reference position, as the control shows it after datuming.", ""},
           "mm", {-100'000.0, 100'000.0}, [i](auto& p) -> auto& { return p.axes[i].datum.reference_position_mm; }));
}

}  // namespace

std::vector<Field> axis_fields(Axis axis) {
  std::vector<Field> table;
  add_axis_configuration(table, axis);
  add_axis_compensation(table, axis);
  add_axis_datum(table, axis);
  return table;
}

}  // namespace ecs::params
