// Parts of models, fits and diagnoses as text of 80 columns: values with sigmas, tests, shapes, the ladder. Measured
// lines of a data set, and how their points look: shared by pictures in files and on the terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "commissioning/plot/figure.hpp"
#include "core/axis.hpp"
#include "model/data/observations.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/model_file.hpp"

namespace ecs::commissioning {

/// Readings of one sense along one axis with the others parked at one place, or those along one path.
struct MeasuredLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Vector3 parked_mm{};
  bool rotary = false;            ///< the axes are A, B, C
  std::string path{};             ///< "circle XY"; "": along the axis
  std::vector<std::size_t> rows;  ///< canonical order of the observations
};
/// By sense, axis and parked place; then the paths.
[[nodiscard]] std::vector<MeasuredLine> measured_lines(const model::Observations& data);
/// "EX along X at Y -700"
[[nodiscard]] std::string title_of(const MeasuredLine& line);

/// Where each reading lies: the coordinate of the axis [mm, machine coordinates, or deg], on a path the place along it.
[[nodiscard]] std::vector<double> places_along(const model::Observations& data, Axis axis);
/// "X position [mm]", "angle_deg"
[[nodiscard]] std::string label_along(const model::Observations& data, const MeasuredLine& line);

/// Points without a line, by approach (1, -1, 0 unknown).
[[nodiscard]] Mark reading_mark(int approach);
/// Lines, by approach.
[[nodiscard]] Mark line_mark(int approach);

/// A number of about `digits` significant digits, never in a form that people must decode.
[[nodiscard]] std::string few_digits(double value, int digits = 3);

/// To a thousandth, without needless zeros.
[[nodiscard]] std::string position_text(double mm);

/// "8.0003 +- 0.0012 mm", digits as far as the sigma goes; "12.5 um (held)", "3.1 um (undetermined)".
[[nodiscard]] std::string value_text(const model::ParameterEstimate& parameter);

/// "period_mm 8.0003 +- 0.0012 mm, amplitude_um 6.51 +- 0.05 um"; without those that are nothing.
[[nodiscard]] std::string parameters_text(const std::vector<model::ParameterEstimate>& parameters);

/// "rms [um]", of other readings "rms um/m", "[um,um/m]": a heading of nine columns at most.
[[nodiscard]] std::string rms_heading(std::string_view unit);
/// Unit of the readings that the effects of a model act on, as Observations::reading_unit().
[[nodiscard]] std::string_view unit_of_model(const model::Model& model);

/// "0.52 um from repeats"
[[nodiscard]] std::string noise_text(const model::PureError& noise);

/// "forward", "reverse", "no approach"
[[nodiscard]] std::string_view direction_text(int approach);

/// One point of a shape, such as the mean residual of a bin.
struct ShapePoint {
  double at = 0.0;
  double um = 0.0;
};
/// A bar to either side of zero for each point, at most `most_lines` of them (neighbours are averaged).
/// @param unit  of the readings
[[nodiscard]] std::string shape_text(const std::string& variable, const std::vector<ShapePoint>& points,
                                     std::string_view unit, std::size_t most_lines = 12);

/// "3, 17, 250 and 12 more"
[[nodiscard]] std::string rows_text(const std::vector<int>& rows, std::size_t most = 20);

/// The ladder: step, effect, rms, peak, noise floor, held-out rms; the file of each step where they differ.
[[nodiscard]] Cell ladder_cell(const model::Model& model);

/// Paragraphs "note: …".
[[nodiscard]] std::string notes_text(const std::vector<std::string>& notes);

/// A variable with a smaller share of the residual variance gets no picture of its own.
inline constexpr double kWorthAShape = 0.1;

/// Pictures of variables in one answer.
inline constexpr std::size_t kMostShapes = 2;

}  // namespace ecs::commissioning
