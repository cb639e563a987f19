#include "volume/rotary_uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.hpp"
#include "volume/curve_covariance.hpp"
#include "volume/joint_volume.hpp"

namespace ecs::volume {
namespace {

using kinematics::Angles;
using kinematics::Joint;

constexpr std::size_t kMostDrawnTogether = 14'000;  ///< places times settings of every draw
constexpr std::size_t kLinearTogether = 400;        ///< at which linear propagation is compared with the draws
constexpr double kTurnOfAxis_deg = 360.0;
constexpr std::size_t kPointsOfTurn = 72;  ///< of a drawn table of one and two waves: straight between them

/// One and two waves a turn, of mean square 1 together; a constant is a location error.
using TurnShapes = std::array<double, 4>;
TurnShapes turn_shapes(double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180.0, size = std::sqrt(0.5);
  return {size * std::cos(angle), size * std::sin(angle), size * std::cos(2.0 * angle), size * std::sin(2.0 * angle)};
}

/// An angle of an axis, and the side from which it was reached.
struct Turned {
  double deg = 0.0;
  std::size_t side = 1;
};

double covariance_of(const MotionUncertainty& u, const Turned& a, const Turned& b) {
  double sum = 0.0;
  if (u.unmeasured > 0.0) {
    const TurnShapes at_a = turn_shapes(a.deg), at_b = turn_shapes(b.deg);
    for (std::size_t i = 0; i < at_a.size(); ++i) sum += u.unmeasured * u.unmeasured * at_a[i] * at_b[i];
  }
  if (u.table[a.side] == nullptr || u.table[a.side] != u.table[b.side]) return sum;
  const TableWeights at_a = weights_in(*u.table[a.side], a.deg), at_b = weights_in(*u.table[b.side], b.deg);
  const std::vector<double>& value = u.value[a.side];
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      if (at_a.value[i] == at_b.value[j])
        sum += at_a.weight[i] * at_b.weight[j] * value[at_a.value[i]] * value[at_a.value[i]];
  return sum;
}

Vector3 gain_at(const kinematics::Gain& gain, const Vector3& position_mm) {
  Vector3 sum = gain.at_0;
  for (std::size_t l = 0; l < kAxes; ++l)
    for (std::size_t d = 0; d < kAxes; ++d) sum[d] += gain.slope[l][d] * position_mm[l];
  return sum;
}

Vector3 less(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

kinematics::JointMachine joints_of(const CompensatedMachine& machine) {
  kinematics::JointMachine joints = machine.rotary->machine;
  joints.lines_mm = machine.errors.kinematics.lines_mm;
  joints.tool_offset_mm = machine.errors.kinematics.tool_offset_mm;
  joints.curves = machine.errors.curves;
  return joints;
}

Vector3 gain_of(const kinematics::MachinePose& pose, std::size_t component, const Vector3& position_mm) {
  if (component < kCurves)
    return gain_at(pose.gain[component / kSenseNames.size()][component % kSenseNames.size()], position_mm);
  return gain_at(pose.squareness[component - kCurves], position_mm);
}

/// A grid with the settings of the rotary axes, at most this many together.
struct Settings {
  Grid grid;
  std::vector<Angles> angles;
};
Settings settings_with(const CompensatedMachine& machine, std::size_t places) {
  std::size_t axes = 0;
  for (std::size_t a = 0; a < kAxes; ++a)
    axes += static_cast<std::size_t>(machine.travel_mm[a].has_value()) +
            static_cast<std::size_t>(machine.rotary->travel_deg[a].has_value());
  const double root = std::pow(static_cast<double>(places), 1.0 / static_cast<double>(axes));
  Settings out;
  out.angles = settings_over(*machine.rotary, static_cast<std::size_t>(root + 1e-9));
  out.grid = grid_over(machine.travel_mm, std::max<std::size_t>(1, places / out.angles.size()),
                       reference_of(machine.parameters));
  return out;
}

double vectors(const Settings& all) {
  return static_cast<double>(kSides.size() * all.grid.places() * all.angles.size());
}

template <class Each>
void for_each_place(const Grid& grid, const Each& each) {
  for (std::size_t side = 0; side < kSides.size(); ++side) {
    GridIndex index{};
    for (index[0] = 0; index[0] < grid.mm[0].size(); ++index[0])
      for (index[1] = 0; index[1] < grid.mm[1].size(); ++index[1])
        for (index[2] = 0; index[2] < grid.mm[2].size(); ++index[2]) each(side, index);
  }
}

}  // namespace

RotaryBudget rotary_budget_of(const RotaryAxes& rotary, const UncertaintySettings& settings) {
  RotaryBudget budget;
  budget.ties = rotary.errors.ties;
  for (const kinematics::ChainJoint& one : rotary.machine.chain) {
    if (!is_rotary(one.joint)) continue;
    const std::size_t r = index_of(one.joint) - kAxes;
    for (std::size_t s = 0; s < kSenseNames.size(); ++s) {
      const auto sense = static_cast<Sense>(s);
      budget.location[r][s] = rotary.errors.location_u[r][s].value_or(settings.declared_zero);
      const bool along_itself = !is_rotation(sense) && direction_of(sense) == direction_of(one.joint);
      if (along_itself && !rotary.errors.location_u[r][s]) budget.location[r][s] = 0.0;  // ZOC is no error of its own
      MotionUncertainty motion{one.joint, sense, {}, {}, 0.0};
      bool given = false;
      for (std::size_t side = 0; side < kSides.size(); ++side) {
        const RotaryTable* table = table_of(rotary.errors, one.joint, sense, kSides[side]);
        motion.table[side] = table;
        if (table == nullptr) continue;
        given = true;
        motion.value[side] = table->u;
        if (settings.repeatability || table->u.empty())
          motion.value[side].assign(table->p_deg.size(), settings.repeatability.value_or(roughness_of(table->error)));
      }
      if (!given) motion.unmeasured = settings.declared_zero;
      budget.motions.push_back(std::move(motion));
    }
  }
  const auto stated = budget.location;
  for (const LocationTie& tie : budget.ties) {
    double& own = budget.location[tie.other[0]][tie.other[1]];
    const double of_tie = tie.by * stated[tie.of[0]][tie.of[1]];
    own = std::sqrt(std::max(0.0, own * own - of_tie * of_tie));
  }
  return budget;
}

Covariance covariance_at(const CompensatedMachine& machine, const UncertaintyBudget& budget, const RotaryBudget& rotary,
                         const Vector3& position_mm, const Angles& angles_deg, std::size_t side) {
  const kinematics::JointMachine joints = joints_of(machine);
  const Vector3 reference_mm = reference_of(machine.parameters);
  const Angles zero = reference_angles(*machine.rotary);
  const kinematics::MachinePose here = pose_at(joints, angles_deg), there = pose_at(joints, zero);
  const auto linear = gains_at(machine.errors.kinematics, reference_mm);  // from there errors of linear axes count
  Covariance sum{};
  // of the linear axes: E = G(here) δ(p) − [ R(here) g + G(there) − R(there) g ] δ(reference)
  const auto at_reference = [&](std::size_t c) {
    const Vector3 turned = along_axes(here.along, linear[c]), straight = along_axes(there.along, linear[c]);
    const Vector3 gain = gain_of(there, c, reference_mm);
    return Vector3{turned[0] + gain[0] - straight[0], turned[1] + gain[1] - straight[1],
                   turned[2] + gain[2] - straight[2]};
  };
  for (const CurveUncertainty& u : budget.curves) {
    if (is_certain(u)) continue;
    const std::size_t c = index_of(u.component);
    const Stop stop{position_mm[index_of(moving_axis(u.component))], side};
    add_difference(sum, gain_of(here, c, position_mm), at_reference(c),
                   difference_of(CurveCovariance(machine, u), stop));
  }
  for (std::size_t c = kCurves; c < kComponents; ++c) {
    const Vector3 gain = less(gain_of(here, c, position_mm), at_reference(c));
    add_product(sum, gain, gain, budget.squareness_um_per_m[c] * budget.squareness_um_per_m[c]);
  }
  const auto of_location = [&](std::size_t r, std::size_t s) {
    return less(gain_at(here.gain[kAxes + r][s], position_mm), gain_at(there.gain[kAxes + r][s], reference_mm));
  };
  for (std::size_t r = 0; r < kAxes; ++r)
    for (std::size_t s = 0; s < kSenseNames.size(); ++s) {
      Vector3 gain = of_location(r, s);
      for (const LocationTie& tie : rotary.ties)
        if (tie.of == std::array{r, s}) {
          const Vector3 other = of_location(tie.other[0], tie.other[1]);
          for (std::size_t d = 0; d < kAxes; ++d) gain[d] += tie.by * other[d];
        }
      add_product(sum, gain, gain, rotary.location[r][s] * rotary.location[r][s]);
    }
  for (const MotionUncertainty& u : rotary.motions) {
    const std::size_t j = index_of(u.joint), s = static_cast<std::size_t>(u.sense);
    const Vector3 g = gain_at(here.gain[j][s], position_mm), h = gain_at(there.gain[j][s], reference_mm);
    const Turned at{angles_deg[j - kAxes], side};
    const std::array<Turned, 2> from{Turned{zero[j - kAxes], 0}, Turned{zero[j - kAxes], 1}};
    DifferenceCovariance of{covariance_of(u, at, at)};
    for (const Turned& one : from) {
      of.with_reference += 0.5 * covariance_of(u, at, one);
      for (const Turned& other : from) of.of_reference += 0.25 * covariance_of(u, one, other);
    }
    add_difference(sum, g, h, of);
  }
  return sum;
}

RotaryDraws::RotaryDraws(const RotaryBudget& budget, std::uint64_t seed) : budget_(budget), generator_(seed) {}

RotaryErrors RotaryDraws::next() {
  NormalDraws normal;
  RotaryErrors drawn;
  for (std::size_t r = 0; r < kAxes; ++r)
    for (std::size_t s = 0; s < kSenseNames.size(); ++s)
      drawn.location[r][s] = budget_.location[r][s] * normal(generator_);
  const auto alone = drawn.location;
  for (const LocationTie& tie : budget_.ties)
    drawn.location[tie.other[0]][tie.other[1]] += tie.by * alone[tie.of[0]][tie.of[1]];
  for (const MotionUncertainty& u : budget_.motions) {
    if (u.unmeasured > 0.0) {
      TurnShapes size{};
      for (double& one : size) one = u.unmeasured * normal(generator_);
      RotaryTable table{u.joint, u.sense, Approach::unknown, {}, {}, {}};
      for (std::size_t i = 0; i < kPointsOfTurn; ++i) {
        const double angle_deg = kTurnOfAxis_deg * static_cast<double>(i) / static_cast<double>(kPointsOfTurn);
        const TurnShapes shapes = turn_shapes(angle_deg);
        table.p_deg.push_back(angle_deg);
        table.error.push_back(0.0);
        for (std::size_t k = 0; k < shapes.size(); ++k) table.error.back() += size[k] * shapes[k];
      }
      drawn.tables.push_back(std::move(table));
    }
    for (std::size_t side = 0; side < kSides.size(); ++side) {
      const RotaryTable* given = u.table[side];
      if (given == nullptr || (side == 1 && given == u.table[0])) continue;
      RotaryTable table = *given;
      for (std::size_t i = 0; i < table.error.size(); ++i) table.error[i] = u.value[side][i] * normal(generator_);
      drawn.tables.push_back(std::move(table));
    }
  }
  return drawn;
}

double linear_rms_um(const CompensatedMachine& machine, const UncertaintyBudget& budget, const RotaryBudget& rotary) {
  const Settings few = settings_with(machine, kLinearTogether);
  double sum = 0.0;
  for (const Angles& angles : few.angles)
    for_each_place(few.grid, [&](std::size_t side, const GridIndex& index) {
      const Covariance c = covariance_at(machine, budget, rotary, few.grid.at(index), angles, side);
      sum += c[0][0] + c[1][1] + c[2][2];
    });
  return std::sqrt(sum / vectors(few));
}

Result<VolumeUncertainty> uncertainty_of(const CompensatedMachine& machine, const UncertaintyBudget& budget,
                                         const RotaryBudget& rotary, const UncertaintySettings& settings,
                                         std::size_t places) {
  VolumeUncertainty out;
  const Settings few = settings_with(machine, kLinearTogether);
  out.linear_rms_um = linear_rms_um(machine, budget, rotary);

  const Settings all = settings_with(machine, std::min(places, kMostDrawnTogether));
  ECS_TRY(known, JointVolume::over(machine, all.grid));
  std::vector<Field> left;  // what is expected after compensation, by setting
  for (const Angles& angles : all.angles) left.push_back(*known.at(angles).after.field);

  double drawn = 0.0;
  std::vector<double> largest, rms;
  MapDraws maps(machine, budget, settings.seed);
  RotaryDraws turns(rotary, settings.seed + 1);
  for (std::size_t k = 0; k < settings.draws; ++k) {
    maps.next();
    const RotaryErrors errors = turns.next();
    const JointVolume on_few = JointVolume::of(machine, few.grid, maps.components_over(few.grid), errors);
    double squares = 0.0;
    for (const Angles& angles : few.angles) {
      const Field field = on_few.errors(angles);
      for_each_place(few.grid,
                     [&](std::size_t side, const GridIndex& index) { squares += square_of(field.at(side, index)); });
    }
    drawn += squares / vectors(few) / static_cast<double>(settings.draws);
    const JointVolume over = JointVolume::of(machine, all.grid, maps.components_over(all.grid), errors);
    double most = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < all.angles.size(); ++i) {
      Field field = over.errors(all.angles[i]);
      field.add(left[i]);
      for_each_place(all.grid, [&](std::size_t side, const GridIndex& index) {
        const double square = square_of(field.at(side, index));
        most = std::max(most, square);
        sum += square;
      });
    }
    largest.push_back(std::sqrt(most));
    rms.push_back(std::sqrt(sum / vectors(all)));
  }
  out.drawn_rms_um = std::sqrt(drawn);
  set_bounds(out, largest, rms);
  return out;
}

}  // namespace ecs::volume
