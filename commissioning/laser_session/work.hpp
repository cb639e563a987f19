// Everything that follows from the choices: files read, lines without what was left out, curves of the components
// before and after slope removal and smoothing, the map. Worked out beside the screen, each time from the beginning but
// for the files, which are read again only where they changed.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/laser_session/lines.hpp"
#include "commissioning/laser_session/map.hpp"
#include "commissioning/plot/figure.hpp"
#include "commissioning/session/task_runner.hpp"
#include "laser/analysis/curve.hpp"
#include "laser/analysis/iso230.hpp"
#include "laser/analysis/process.hpp"

namespace ecs::commissioning {

/// One line without the readings that are left out.
struct LaserLineResult {
  LaserLineChoice choice;  ///< what it was computed with
  laser::MeasurementSet chosen;
  laser::Group group;  ///< in `chosen`
  std::optional<laser::Curve> curve;
  std::optional<laser::Iso230> iso;
  PlotPanel panel;                  ///< readings and means
  std::vector<PlotPoint> left_out;  ///< position and error of the readings left out
  std::string problem;              ///< why there is no curve
};

[[nodiscard]] bool left_out(const LaserLineChoice& choice, const laser::MeasurementSet& set, std::size_t reading);
[[nodiscard]] std::size_t count_left_out(const LaserLineChoice& choice, const laser::MeasurementSet& set);
[[nodiscard]] LaserLineResult line_result(const LaserLine& line, const LaserLineChoice& choice);

/// One component before and after, values in um, or um/m for a rotation or squareness.
struct LaserCurve {
  Component component = Component::EXX;
  std::vector<std::size_t> lines;  ///< places in the list of lines: one, or two for a rotation from parallel lines
  laser::SlopeMethod slope = laser::SlopeMethod::none;
  laser::SlopeMethod recommended = laser::SlopeMethod::none;
  double removed_per_m = 0.0;
  double band_before = 0.0;  ///< range of the readings; of the curve where it comes from two lines
  double band_after = 0.0;   ///< the same, slope removed and smoothed (of the curve where it is smoothed)
  std::optional<laser::Smoothed> smoothed;
  PlotPanel before, after;
  bool unchanged = false;             ///< no slope taken, nothing smoothed: `after` is `before`
  std::vector<PlotPoint> left_out;    ///< of the one line, as measured; none where it comes from two lines
  std::size_t left_out_of_lines = 0;  ///< readings left out of all its lines
  std::string problem;
  /// It failed, or smoothing took form of the curve away as well.
  [[nodiscard]] bool doubtful() const {
    return !problem.empty() || (smoothed && smoothed->taken == laser::Taken::signal);
  }
};
struct LaserWork {
  LaserChoices choices;  ///< what it was worked out from
  std::vector<LaserFile> files;
  std::vector<LaserLine> lines;
  std::vector<LaserLineResult> results;  ///< as many as lines
  std::vector<LaserCurve> curves;  ///< of the components that the map takes; of every line as long as there is no map
  LaserMapWork map;
};
using LaserWorkPtr = std::shared_ptr<const LaserWork>;

/// @param before  what was worked out last; null: nothing yet
[[nodiscard]] LaserWorkPtr worked_out(const LaserChoices& choices, const LaserWorkPtr& before, JobControl& control);

}  // namespace ecs::commissioning
