// Circular tests and diagonals as measurement sets whose readings lie on paths (path.hpp).
// Does not live here: the files of these tests (laser/standards).
#pragma once

#include "base/result.hpp"
#include "laser/circle_test.hpp"
#include "laser/measurement_set.hpp"
#include "laser/standards/diagonals.hpp"

namespace ecs::model {

/// Every reading at its place on the circle, in column `path`; approach 1 is counter-clockwise. A centre that is not
/// given is at 0, with a note.
[[nodiscard]] laser::MeasurementSet set_of_circle(const laser::CircleTest& test);

/// Every reading at its place on the diagonal, in column `path`. The corner of the volume with the least coordinates
/// is at `# from_x_mm: ` …, else at 0, with a note. Refuses step diagonals, whose steps leave the line.
[[nodiscard]] Result<laser::MeasurementSet> set_of_diagonals(const laser::DiagonalTest& test);

}  // namespace ecs::model
