// Everything that follows from the choices: files read, lines without what was left out, curves of the components
// before and after slope removal and smoothing, the map. Worked out beside the screen, each time from the beginning but
// for the files, which are read again only where they changed. The map's files on disc.
// Does not live here: how a recipe becomes a map (commissioning/maps/findings.hpp).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/laser_session/lines.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/maps/unit_work.hpp"
#include "commissioning/plot/figure.hpp"
#include "commissioning/session/task_runner.hpp"
#include "laser/analysis/curve.hpp"
#include "laser/analysis/iso230.hpp"
#include "laser/analysis/process.hpp"
#include "params/parameters_toml.hpp"

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

enum class ComponentState {
  present,        ///< from a measured file
  in_parameters,  ///< a squareness that the parameters hold already
  zero,           ///< declared zero, with a reason
  refused,        ///< its file cannot serve
  missing,
};

/// One component that the chosen scope needs.
struct LaserComponent {
  Component component = Component::EXX;
  ComponentState state = ComponentState::missing;
  std::string detail;  ///< files, reason, or why not; of a missing one why its measurement is not used
};

struct LaserMapWork {
  std::optional<params::ParametersFile> parameters;  ///< scope as chosen
  std::string parameters_problem;
  laser::SuggestedRecipe suggested;  ///< which lines serve which component, which serve none
  laser::MapRecipe recipe;           ///< everything: what `ecs map build` would be given
  std::optional<MadeMap> made;       ///< absent: refused, or nothing to build
  std::vector<std::string> refusals;
  std::vector<LaserComponent> components;
  std::string csv;  ///< of the map that was made
  [[nodiscard]] bool complete() const { return made && made->complete(); }
  [[nodiscard]] const std::vector<laser::MapFinding>& findings() const;
  [[nodiscard]] std::size_t missing() const;
};

/// The header: who, when, which machine, as chosen, else what the files say.
[[nodiscard]] laser::MapRecipe header_with_files(laser::MapRecipe chosen, const std::vector<LaserLine>& lines);
/// Some file states a date, in any form. Where none does, the header has the date of today.
[[nodiscard]] bool states_date(const std::vector<LaserLine>& lines);

/// The map that follows from the choices, or the one that was opened, judged. Reads the parameters; what a map cannot
/// name as it is is prepared from the lines, and lies in no file yet.
[[nodiscard]] LaserMapWork laser_map(const LaserChoices& choices, const std::vector<LaserLine>& lines);
/// Places of the lines that a component is made from.
[[nodiscard]] std::vector<std::size_t> lines_behind(const laser::ComponentRecipe& component,
                                                    const std::vector<LaserLine>& lines);
[[nodiscard]] LaserLineChoice choice_for_line(const LaserChoices& choices, const LaserLine& line);

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

/// Why these parameters belong to another machine than the measured lines; empty: as far as is known they do not.
/// Compared: axes, machine named in the files.
[[nodiscard]] std::string mismatch_of(const params::ParametersFile& parameters, const std::vector<LaserLine>& lines);

// --- on disc

struct SavedMap {
  MapFiles files;
  std::string csv;          ///< of the map
  laser::MapRecipe recipe;  ///< as it was kept; of a map that was opened: empty
  std::string opened{};     ///< the map that was opened, as it stood in its file before; empty: none was
};
/// A map that was opened has no recipe. Writes map, parameters with the squareness measured, the recipe that makes the
/// same map with `ecs map build`, and the files that have to be prepared for it. @pre work.made
/// @param choices, lines  that `work` follows from
[[nodiscard]] Result<SavedMap> save_laser_map(const LaserMapWork& work, const LaserChoices& choices,
                                              const std::vector<LaserLine>& lines);
/// The commands that write the same files (commissioning/session/commands.hpp).
/// @param lines  from which the map was made
void note_saved_map(const SavedMap& saved, const LaserChoices& choices, const std::vector<LaserLine>& lines);

}  // namespace ecs::commissioning
