// A table whose cells are values at the places of an even grid, cells along one axis and rows along another.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "core/axis.hpp"

namespace ecs::laser {

/// The places along one axis. Each is a number, or a name under which the file states it ("xmin"), or several names
/// separated by bars of which the file states one ("xspacing|spacing").
struct MatrixAxis {
  Axis axis = Axis::X;
  std::string first_mm;
  std::string last_mm;  ///< empty: `step_mm` is given
  std::string step_mm;
  std::string count;  ///< empty: as many as there are
};

struct MatrixLayout {
  std::array<MatrixAxis, 2> axes{};  ///< along the cells of a row, along the rows
  std::string section;  ///< how the line begins above the part that is read, up to the next line with '['; empty: all
  std::string line_prefix;  ///< taken off every line
  std::string absent;       ///< a cell that holds no value
  char delimiter = ',';
};

/// "x=xmin+xspacing*xnum,y=ymin..ymax": AXIS=FIRST+STEP or FIRST..LAST, and *COUNT where the file states it; the axis
/// along the cells of a row first.
[[nodiscard]] Result<std::array<MatrixAxis, 2>> matrix_axes(std::string_view text);

}  // namespace ecs::laser
