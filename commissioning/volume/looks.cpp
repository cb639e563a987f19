// Looks at a volume besides its sizes: one place, a plane, what falls between the places. Does not live here: the
// evaluation itself (volume/volume.hpp), the error at the angles of rotary axes (volume/joint_volume.hpp).
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "commissioning/volume/work.hpp"
#include "volume/joint_volume.hpp"

namespace ecs::commissioning {

char rotary_letter(std::size_t rotary) { return kinematics::letter_of(static_cast<kinematics::Joint>(kAxes + rotary)); }

namespace {

/// X, Y, Z and behind them the angles of the rotary axes in the order A, B, C; without those: their reference.
Result<std::pair<Vector3, kinematics::Angles>> place_in(const std::string& text,
                                                        const std::optional<volume::RotaryAxes>& rotary) {
  if (!rotary || std::count(text.begin(), text.end(), ',') < static_cast<std::ptrdiff_t>(kAxes)) {
    ECS_TRY(place, coordinates_in(text, "--at"));
    return std::pair{place, rotary ? reference_angles(*rotary) : kinematics::Angles{}};
  }
  std::vector<std::string> names{"X", "Y", "Z"};
  std::vector<double> numbers;
  for (const std::string_view word : split(text, ','))
    if (const auto number = number_in(word)) numbers.push_back(*number);
  for (std::size_t r = 0; r < kAxes; ++r)
    if (rotary->travel_deg[r]) names.emplace_back(1, rotary_letter(r));
  if (numbers.size() != names.size() || split(text, ',').size() != names.size())
    return problem(ProblemKind::usage, "--at: expected {} numbers {} in mm and deg, got \"{}\"", names.size(),
                   fmt::join(names, ","), text);
  std::pair<Vector3, kinematics::Angles> place{{numbers[0], numbers[1], numbers[2]}, {}};
  std::size_t next = kAxes;
  for (std::size_t r = 0; r < kAxes; ++r) {
    const auto& travel = rotary->travel_deg[r];
    if (!travel) continue;
    place.second[r] = numbers[next++];
    if (place.second[r] < (*travel)[0] || place.second[r] > (*travel)[1])
      return problem(ProblemKind::usage, "--at: expected {} within {} … {} deg, got {}", rotary_letter(r), (*travel)[0],
                     (*travel)[1], place.second[r]);
  }
  return place;
}

}  // namespace

Result<Vector3> coordinates_in(const std::string& text, std::string_view option) {
  const auto words = split(text, ',');
  Vector3 place{};
  for (std::size_t a = 0; a < kAxes && words.size() == kAxes; ++a) {
    const auto number = number_in(words[a]);
    if (!number) break;
    place[a] = *number;
    if (a + 1 == kAxes) return place;
  }
  return problem(ProblemKind::usage, "{}: expected three numbers X,Y,Z in mm, such as -100,0,-250, got \"{}\"", option,
                 text);
}

Result<void> look_at(const std::string& text, const volume::CompensatedMachine& expected, VolumeWork& work) {
  volume::CompensatedMachine machine = work.prepared.machine;
  ECS_TRY(asked, place_in(text, machine.rotary));
  const auto& [place, angles_deg] = asked;
  for (const Axis axis : kAllAxes)
    if (const auto& travel = machine.travel_mm[index_of(axis)];
        travel && (place[index_of(axis)] < (*travel)[0] || place[index_of(axis)] > (*travel)[1]))
      return problem(ProblemKind::usage, "--at: expected {} within {} … {} mm, got {}", letter_of(axis), (*travel)[0],
                     (*travel)[1], place[index_of(axis)]);
  if (machine.rotary) machine.rotary->angles_deg = angles_deg;
  const volume::Grid grid = volume::grid_at(machine.travel_mm, place, volume::reference_of(machine.parameters));
  ECS_TRY(errors, errors_over(machine, grid));
  PlaceAnswer answer;
  answer.position_mm = grid.at({});
  answer.angles_deg = angles_deg;
  for (std::size_t side = 0; side < volume::kSides.size(); ++side) {
    answer.before_um[side] = errors.before.at(grid, side, {});
    answer.after_um[side] = errors.after.at(grid, side, {});
  }
  if (machine.rotary) {
    ECS_TRY(here, volume::JointVolume::over(machine, grid));
    answer.orientation_um_per_m = here.orientation_at(angles_deg);
  }
  const std::size_t forward = volume::kSides.size() - 1;
  const volume::Covariance covariance =
      expected.rotary
          ? covariance_at(expected, work.budget, work.rotary_budget, answer.position_mm, angles_deg, forward)
          : covariance_at(expected, work.budget, answer.position_mm, forward);
  for (std::size_t d = 0; d < kAxes; ++d) answer.standard_uncertainty_um[d] = std::sqrt(covariance[d][d]);
  work.at = answer;
  return {};
}

Result<void> cut(const std::string& plane, VolumeWork& work) {
  constexpr std::size_t kColumns = 9, kRows = 5;
  const volume::CompensatedMachine& machine = work.prepared.machine;
  const bool longest = plane == kLongestPlane;
  if (longest && work.answer.grid.axes() < 2) return {};
  const auto named = [&](std::size_t k) {
    if (longest) return std::optional(static_cast<Axis>(longest_plane(machine)[k]));
    return plane.size() == 2 ? axis_of(plane[k]) : std::nullopt;
  };
  const auto across = named(0), up = named(1);
  const auto exists = [&](const std::optional<Axis>& axis) {
    return axis && machine.travel_mm[index_of(*axis)].has_value();
  };
  if (!exists(across) || !exists(up) || across == up) {
    std::string axes;
    for (const Axis axis : kAllAxes)
      if (exists(axis)) axes += letter_of(axis);
    return problem(ProblemKind::usage, "--slice: expected two axes of the machine, which has {}; got \"{}\"", axes,
                   plane);
  }
  ECS_TRY(slice, slice_of(machine, work.answer.before.all.at_mm, index_of(*across), index_of(*up), kColumns, kRows));
  work.slice = std::move(slice);
  return {};
}

Result<void> look_between(VolumeWork& work) {
  const volume::CompensatedMachine& machine = work.prepared.machine;
  if (machine.rotary)
    return problem(ProblemKind::usage, "--between: for linear axes only; the machine file has rotary axes");
  ECS_TRY(before, largest_between(machine, work.answer.before.all, &volume::BeforeAfter::before));
  ECS_TRY(after, largest_between(machine, work.answer.after.all, &volume::BeforeAfter::after));
  work.between = {before, after};
  return {};
}

std::array<std::size_t, 2> longest_plane(const volume::CompensatedMachine& machine) {
  const auto length = [&](std::size_t a) {
    const auto& travel = machine.travel_mm[a];
    return travel ? (*travel)[1] - (*travel)[0] : 0.0;
  };
  std::array<std::size_t, kAxes> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return length(a) > length(b); });
  return {std::min(order[0], order[1]), std::max(order[0], order[1])};
}

Vector3 mean_error(const volume::Grid& grid, const volume::VolumeError& error, const volume::GridIndex& index) {
  const Vector3 a = error.at(grid, 0, index), b = error.at(grid, 1, index);
  return {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
}

Result<VolumeSlice> slice_of(const volume::CompensatedMachine& machine, const Vector3& through_mm, std::size_t across,
                             std::size_t up, std::size_t columns, std::size_t rows) {
  VolumeSlice slice;
  slice.across = across;
  slice.up = up;
  const Vector3 reference_mm = volume::reference_of(machine.parameters);
  slice.grid = volume::grid_at(machine.travel_mm, through_mm, reference_mm);
  slice.grid.mm[across] = volume::even_grid(machine.travel_mm, columns, reference_mm).mm[across];
  slice.grid.mm[up] = volume::even_grid(machine.travel_mm, rows, reference_mm).mm[up];
  ECS_TRY(errors, errors_over(machine, slice.grid));
  slice.errors = std::move(errors);
  return slice;
}

}  // namespace ecs::commissioning
