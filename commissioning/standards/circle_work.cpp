#include "commissioning/standards/circle_work.hpp"

#include <fmt/format.h>

#include "base/file_kind.hpp"
#include "laser/standards/circle.hpp"

namespace ecs::commissioning {
namespace {

Result<std::array<std::vector<double>, 2>> pitches_of(const params::Machine& machine, const laser::CircleTest& test) {
  std::array<std::vector<double>, 2> pitches_mm;
  for (std::size_t i = 0; i < test.plane.size(); ++i) {
    const auto& axis = machine.axes[index_of(test.plane[i])];
    if (!axis)
      return problem(ProblemKind::usage, fmt::format("{}: the plane is {}, and the machine has no {}", test.source,
                                                     laser::plane_name(test.plane), letter_of(test.plane[i])));
    for (const auto& pitch_mm : {axis->screw_pitch_mm, axis->scale_pitch_mm})
      if (pitch_mm) pitches_mm[i].push_back(*pitch_mm);
  }
  return pitches_mm;
}

}  // namespace

Result<CircleWork> circle_work(const std::filesystem::path& file, const params::Machine* machine) {
  ECS_TRY(text, read_file_of(FileKind::circle_test, file));
  ECS_TRY(test, laser::parse_circle_test(text, file.string()));
  std::array<std::vector<double>, 2> pitches_mm;
  if (machine != nullptr) {
    ECS_TRY(known, pitches_of(*machine, test));
    pitches_mm = std::move(known);
  }
  ECS_TRY(diagnosis,
          model::diagnose_circle(test, pitches_mm,
                                 machine == nullptr ? model::PitchSource::nowhere : model::PitchSource::machine_file));
  laser::CircleValues values = laser::circle_values_of(test);
  return CircleWork{file, std::move(test), std::move(values), std::move(diagnosis)};
}

}  // namespace ecs::commissioning
