#include "core/rotary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/words.hpp"

namespace ecs {
namespace {

constexpr double kTurn_deg = 360.0, kTurn = 0x1p64, kPartsOfCell = 0x1p32;
constexpr double kFurthestPivot_mm = 1e6;

Vector3 sum(const Vector3& a, const Vector3& b, double factor = 1.0) noexcept {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}
double dot(const Vector3& a, const Vector3& b) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool sound(const RotaryAxis& axis) noexcept {
  const auto small = [](double value, double most) { return std::abs(value) <= most; };
  const auto all_small = [&](const auto& values, double most) {
    return std::all_of(values.begin(), values.end(), [&](double value) { return small(value, most); });
  };
  return axis.letter >= 'A' && axis.letter <= 'C' && axis.deg_per_count != 0.0 &&
         std::abs(axis.deg_per_count) < kTurn_deg / 2.0 && axis.deadband_deg >= 0.0 && axis.deadband_deg < kTurn_deg &&
         std::abs(axis.deadband_deg / axis.deg_per_count) < 1e15 && all_small(axis.direction, 1.1) &&
         small(dot(axis.direction, axis.direction) - 1.0, 1e-9) && all_small(axis.pivot_mm, kFurthestPivot_mm) &&
         all_small(axis.location, 1e6) && small(axis.zero_deg, 10.0 * kTurn_deg);
}

bool sound(const RotaryBending& bending) noexcept {
  const auto small = [](double value) { return std::abs(value) <= 1e6; };
  return std::all_of(bending.of_machine.begin(), bending.of_machine.end(), small) &&
         std::all_of(bending.of_tool.begin(), bending.of_tool.end(), small);
}

/// The axes in their places.
struct Places {
  PerRotary<const RotaryAxis*> axis{};
  RotaryWorking::Arrangement arrangement = RotaryWorking::Arrangement::none;
};

/// Each side of the T from the base outward: linear axes, then rotary ones.
RotaryFault place(const RotarySetup& machine, const UnitParameters& parameters, Places& places) noexcept {
  std::array<char, 9> linear{};
  std::size_t letters = 0, rotary = 0, on_tables = 0;
  bool tool_side = false, after_rotary = false;
  for (const char letter : machine.configuration) {
    if (letter == '\0') break;
    const bool turns = letter >= 'A' && letter <= 'C';
    if (!turns) linear[letters++] = letter;
    if (letter == 'T') {
      tool_side = true;
      after_rotary = false;
    } else if (turns) {
      const auto named = [&](const RotaryAxis& axis) { return axis.letter == letter; };
      const auto found = std::find_if(machine.axes.begin(), machine.axes.end(), named);
      if (found == machine.axes.end() || rotary == kRotaryInputs) return RotaryFault::other_chain;
      places.axis[rotary++] = &*found;
      on_tables += tool_side ? 0 : 1;
      after_rotary = true;
    } else if (after_rotary) {
      return RotaryFault::turned_linear;
    }
  }
  const auto wired = std::count_if(machine.axes.begin(), machine.axes.end(),
                                   [](const RotaryAxis& axis) { return axis.letter != '\0'; });
  if (linear.data() != configuration_of(parameters) || rotary == 0 || static_cast<std::size_t>(wired) != rotary ||
      (rotary == 2 && places.axis[0] == places.axis[1]))
    return RotaryFault::other_chain;
  using enum RotaryWorking::Arrangement;
  places.arrangement = on_tables == rotary ? tables : on_tables == 0 ? heads : table_and_head;
  if (places.arrangement == heads && rotary == 1) std::swap(places.axis[0], places.axis[1]);
  return RotaryFault::none;
}

/// Cells in a turn of which each value of the table begins one; 0: no number fits.
std::uint32_t cells_for(const RotaryCurves& table) noexcept {
  if (table.count == 0) return RotaryAxisWorking::kFewestCells;
  for (std::uint32_t cells = RotaryAxisWorking::kFewestCells; cells <= RotaryAxisWorking::kMostCells; ++cells) {
    const double each = cells * table.increment_deg / kTurn_deg;
    if (each > 0.5 && std::abs(each - std::round(each)) < 1e-6) return cells;
  }
  return 0;
}

RotaryFault fault_of(const RotaryCurves& table) noexcept {
  // the cells begin at the start, also those of curves that are zero
  if (!(std::abs(table.start_deg) <= 10.0 * kTurn_deg) ||
      !(table.increment_deg > 0.0 && table.increment_deg <= kTurn_deg))
    return RotaryFault::bad_table;
  if (table.count == 0) return RotaryFault::none;
  const auto sound_resolution = [](double each) { return each > 0.0 && each <= 1000.0; };
  const bool sound = table.increment_deg * (table.count - 1) < kTurn_deg - 1e-6 &&
                     table.values[0].size() == std::size_t{12} * table.count &&
                     table.values[1].size() == table.values[0].size() &&
                     std::all_of(table.resolution.begin(), table.resolution.end(), sound_resolution);
  if (!sound) return RotaryFault::bad_table;
  return cells_for(table) > 0 ? RotaryFault::none : RotaryFault::uneven_table;
}

/// Cells in a turn, and between two values.
struct Grid {
  std::uint32_t cells = 0;
  std::uint32_t each = 0;
};

/// The curves where a cell begins. @param side  0 reverse, 1 forward
std::array<double, 6> curves_at(const RotaryCurves& table, std::size_t side, std::uint32_t cell,
                                const Grid& grid) noexcept {
  std::array<double, 6> curves{};
  if (table.count == 0) return curves;
  std::uint32_t below = cell / grid.each, above = below + 1;
  const double part = static_cast<double>(cell % grid.each) / grid.each;
  if (above >= table.count) {
    const std::uint32_t last = (table.count - 1) * grid.each;
    const bool closed = table.count * grid.each == grid.cells;
    if (!closed) below = cell - last <= (grid.cells - last) / 2 ? table.count - 1 : 0;
    above = closed ? 0 : below;
  }
  for (std::size_t s = 0; s < 6; ++s) {
    const auto value = [&](std::uint32_t k) {
      return static_cast<std::int16_t>(load_big<std::uint16_t>(table.values[side], 2 * (s * table.count + k))) *
             table.resolution[s];
    };
    curves[s] = value(below) + (value(above) - value(below)) * part;
  }
  return curves;
}

/// How the values of an axis become those of its cells.
struct CellRule {
  const RotaryAxis* axis = nullptr;
  double angular = 1e-3;  ///< um/m to um per mm of an arm
  double sine = 1.0;      ///< sense in which Q turns
  Vector3 moved_mm{};     ///< from the pivot to the point from which the common arm counts
};

std::array<double, 8> values_of_cell(const RotaryCurves& table, std::size_t side, std::uint32_t k, const Grid& grid,
                                     const CellRule& rule) noexcept {
  std::array<double, 6> curves = curves_at(table, side, k, grid);
  for (std::size_t s = 0; s < 6; ++s) curves[s] -= rule.axis->location[s];
  for (std::size_t s = 3; s < 6; ++s) curves[s] *= rule.angular;
  const double angle = (table.start_deg / kTurn_deg + static_cast<double>(k) / grid.cells) * 2.0 * std::numbers::pi;
  std::array<double, 8> cell{};
  for (std::size_t d = 0; d < kAxes; ++d) {
    const std::size_t i = (d + 1) % kAxes, j = (d + 2) % kAxes;
    cell[2 * d] = curves[d] + curves[3 + i] * rule.moved_mm[j] - curves[3 + j] * rule.moved_mm[i];
    cell[2 * d + 1] = curves[3 + d];
  }
  cell[6] = std::cos(angle);
  cell[7] = rule.sine * std::sin(angle);
  return cell;
}

void place_axis(const RotarySetup& machine, const CellRule& rule, RotaryAxisWorking& working) noexcept {
  const RotaryAxis& axis = *rule.axis;
  const RotaryCurves& table = machine.tables[static_cast<std::size_t>(&axis - machine.axes.data())];
  const std::uint32_t cells = cells_for(table);
  const Grid grid{cells, static_cast<std::uint32_t>(std::lround(cells * table.increment_deg / kTurn_deg))};
  working.letter = axis.letter;
  working.turn_per_count = static_cast<std::uint64_t>(std::llround(axis.deg_per_count / kTurn_deg * kTurn));
  working.deadband_counts = static_cast<std::int64_t>(axis.deadband_deg / std::abs(axis.deg_per_count) + 1e-3);
  working.start = turn_of(table.start_deg);
  working.cells = cells;
  const std::size_t rising = axis.deg_per_count > 0.0 ? 1 : 0;
  for (std::size_t side = 0; side < 2; ++side)
    for (std::uint32_t k = 0; k < cells; ++k) {
      RotaryCell& cell = working.cell[k][side == 1 ? rising : 1 - rising];
      const auto next = values_of_cell(table, side, (k + 1) % cells, grid, rule);
      cell.value = values_of_cell(table, side, k, grid, rule);
      for (std::size_t v = 0; v < next.size(); ++v) cell.slope[v] = (next[v] - cell.value[v]) / kPartsOfCell;
    }
}

/// A place without an axis: no error, angle 0.
void leave_free(RotaryAxisWorking& working) noexcept {
  working.letter = '\0';
  working.turn_per_count = working.start = 0;
  working.cells = 1;
  for (RotaryCell& cell : working.cell[0]) {
    cell = {};
    cell.value[6] = 1.0;
  }
}

/// Sets the direction of the inner axis, and the way of the tick. @pre arrangement and bending are set @return its
/// sense
double set_direction(const Vector3& direction, RotaryWorking& working) noexcept {
  std::size_t along = RotaryWorking::kOblique;
  double sense = 1.0;
  for (std::size_t d = 0; d < kAxes; ++d) {
    if (std::abs(direction[d]) < 1.0 - 1e-15) continue;
    along = d;
    sense = direction[d] > 0.0 ? 1.0 : -1.0;
  }
  working.inner_axis = sum({}, direction, sense);
  constexpr std::array<double, 6> kNone{};
  const std::uint32_t bends =
      (working.bending.of_machine != kNone ? 1U : 0U) + (working.bending.of_tool != kNone ? 2U : 0U);
  working.way = static_cast<std::uint32_t>(along);
  if (working.arrangement == RotaryWorking::Arrangement::heads) working.way += 4 + 4 * bends;
  if (working.arrangement == RotaryWorking::Arrangement::table_and_head) working.way = bends == 0 ? 20 : 21;
  return sense;
}

}  // namespace

std::string_view text_of(RotaryFault fault) noexcept {
  return WordTable<RotaryFault, 9>{
      {"can be compensated", "have another configuration than the parameters",
       "move a linear axis: expected the linear axes of each side nearer to the base",
       "need the scope volumetric, the convention iso and linear interpolation",
       "need a tool range along X, Y and Z, because a head turns the tool offset",
       "have an axis or bending of impossible numbers", "have a table of impossible numbers",
       "have a table whose increment does not divide a turn: expected a multiple of 0.1 deg",
       "have bending, but no head that tilts"}}
      .of(fault);
}

std::uint64_t turn_of(double deg) noexcept {
  const double turns = deg / kTurn_deg;
  const double part = turns - std::floor(turns);
  return part < 1.0 ? static_cast<std::uint64_t>(part * kTurn) : 0;
}

RotaryFault own_fault_of(const RotarySetup& machine) noexcept {
  if (!sound(machine.bending)) return RotaryFault::bad_axis;
  for (std::size_t i = 0; i < kRotaryInputs; ++i) {
    if (machine.axes[i].letter == '\0') continue;
    if (!sound(machine.axes[i])) return RotaryFault::bad_axis;
    if (const RotaryFault fault = fault_of(machine.tables[i]); fault != RotaryFault::none) return fault;
  }
  return RotaryFault::none;
}

RotaryFault compile_rotary_axes(const RotarySetup& machine, const UnitParameters& parameters,
                                RotaryWorking& working) noexcept {
  working.arrangement = RotaryWorking::Arrangement::none;
  Places places;
  if (const RotaryFault fault = place(machine, parameters, places); fault != RotaryFault::none) return fault;
  if (parameters.scope != Scope::volumetric || parameters.convention != Convention::iso ||
      parameters.interpolation != Interpolation::linear)
    return RotaryFault::part_of_model;
  const Vector3& range_mm = parameters.tool_range_mm;
  if (places.arrangement != RotaryWorking::Arrangement::tables && !(range_mm[0] * range_mm[1] * range_mm[2] > 0.0))
    return RotaryFault::no_tool_range;
  if (const RotaryFault fault = own_fault_of(machine); fault != RotaryFault::none) return fault;
  if (places.arrangement == RotaryWorking::Arrangement::tables && machine.bending != RotaryBending{})
    return RotaryFault::no_head;
  const RotaryAxis& inner = places.axis[0] != nullptr ? *places.axis[0] : *places.axis[1];
  const RotaryAxis& other = places.axis[1] != nullptr ? *places.axis[1] : inner;
  const bool both_sides = places.arrangement == RotaryWorking::Arrangement::table_and_head;
  working.arrangement = places.arrangement;
  working.bending = machine.bending;
  working.um_per_mm.fill(parameters.angular_scale * 1e-3);
  CellRule rule{&inner, working.um_per_mm[0], set_direction(inner.direction, working), {}};
  if (places.arrangement == RotaryWorking::Arrangement::tables) rule.sine = -rule.sine;
  const auto fill = [&](std::size_t place) {
    if (places.axis[place] != nullptr)
      place_axis(machine, rule, working.axes[place]);
    else
      leave_free(working.axes[place]);
  };
  fill(0);
  rule = {&other, working.um_per_mm[0], 1.0, both_sides ? Vector3{} : sum(inner.pivot_mm, other.pivot_mm, -1.0)};
  fill(1);
  working.turned_from_mm = other.pivot_mm;
  working.turned_about = other.direction;
  working.arm_from_mm = both_sides ? other.pivot_mm : inner.pivot_mm;
  working.table_arm_mm = sum(other.pivot_mm, inner.pivot_mm, -1.0);
  set_rotary_tool(working, parameters.tool_offset_mm);
  return RotaryFault::none;
}

namespace {

/// Compensation of bending. @param factor  of its sizes
void add_bending(const std::array<double, 6>& sizes, double factor, TurnedLanes& lanes) noexcept {
  for (std::size_t d = 0; d < kAxes; ++d) {
    lanes[0][d] -= factor * sizes[kAxes + d];
    lanes[1][d] += factor * sizes[kAxes + d];
    lanes[2][d] -= factor * sizes[d];
  }
}

}  // namespace

void set_rotary_tool(RotaryWorking& working, const Vector3& tool_offset_mm) noexcept {
  const auto lanes = [](const Vector3& v) { return Lanes{v[0], v[1], v[2], 0.0}; };
  if (!working.turns_tool()) {
    working.arm_mm = {lanes(sum(tool_offset_mm, working.arm_from_mm, -1.0))};
    return;
  }
  const bool is_apart = working.arrangement == RotaryWorking::Arrangement::table_and_head;
  working.machine_bend_um = working.tool_bend_um = {};
  add_bending(working.bending.of_machine, 1.0, is_apart ? working.tool_bend_um : working.machine_bend_um);
  add_bending(working.bending.of_tool, std::sqrt(dot(tool_offset_mm, tool_offset_mm)) * 1e-3, working.tool_bend_um);
  const Vector3& n = working.turned_about;
  const Vector3 v = sum(tool_offset_mm, working.turned_from_mm, -1.0);
  const Vector3 along = sum({}, n, dot(n, v));
  working.arm_mm = {lanes(sum(along, sum(working.turned_from_mm, working.arm_from_mm, -1.0))),
                    lanes(sum(v, along, -1.0)),
                    lanes({n[1] * v[2] - n[2] * v[1], n[2] * v[0] - n[0] * v[2], n[0] * v[1] - n[1] * v[0]})};
}

}  // namespace ecs
