// The runs that an investigation begins with, one for each line that the model speaks of, and the full programme of ISO
// 230-2 on the same lines, against which its minutes are held.
// Does not live here: which run comes next (model/planning/next_measurement.hpp).
#pragma once

#include <cstddef>
#include <vector>

#include "model/fit/model_file.hpp"
#include "model/planning/next_measurement.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

/// Readings of one sense along one axis, the other axes on its measurement line.
struct InvestigatedLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  bool against_square = false;  ///< the model has a squareness of these axes: the slope is of the machine
  friend bool operator==(const InvestigatedLine&, const InvestigatedLine&) = default;
};

/// The lines on which effects of the model act; of a model without effects the positioning of every axis.
[[nodiscard]] std::vector<InvestigatedLine> lines_of_model(const model::Model& model, const params::Machine& machine);
/// Positioning of the axes that the model does not speak of.
[[nodiscard]] std::vector<InvestigatedLine> other_lines(const std::vector<InvestigatedLine>& lines,
                                                        const params::Machine& machine);

/// Times of an investigation in the virtual workshop, where instruments are set up by a request: three minutes a line,
/// one to start another run on it. Choices, the same for the programme of ISO 230-2.
[[nodiscard]] model::MeasuringTimes workshop_times();

/// Two bidirectional runs, so that repeats show the noise, over targets moved from even places by up to a fifth of the
/// step (ISO 230-2:2014, 5.3.2, so that no period hides between them). @pre the machine has the axis
[[nodiscard]] model::MeasurementProposal first_look(const InvestigatedLine& line, const params::Machine& machine,
                                                    const model::MeasuringTimes& times);

/// The line of a first look again, on targets between its own.
[[nodiscard]] model::MeasurementProposal look_between(const model::MeasurementProposal& look,
                                                      const model::MeasuringTimes& times);
/// The same line once both ways without stops: what depends on the feed shows only in motion.
[[nodiscard]] model::MeasurementProposal look_in_motion(const model::MeasurementProposal& look,
                                                        const model::MeasuringTimes& times);
inline constexpr const char* kWithLoad = "with a load";
/// The same line once both ways with a load on the machine. @param is_on  the load is on already
[[nodiscard]] model::MeasurementProposal look_with_load(const model::MeasurementProposal& look,
                                                        const model::MeasuringTimes& times, bool is_on);

/// The same line once both ways with its artefact turned over: what is the artefact's changes its sign (ISO 230-1).
[[nodiscard]] model::MeasurementProposal look_turned_over(const model::MeasurementProposal& look,
                                                          const model::MeasuringTimes& times);

/// ISO 230-2:2014, 5.3: five bidirectional runs a line; targets every 50 mm as in thesis 6.3, 25 at least.
struct IsoProgramme {
  static constexpr int kRuns = 5;
  std::size_t targets = 0;  ///< of all lines
  std::size_t lines = 0;
  double dwell_s = 0.0;         ///< at each target, the time of the trigger included
  double set_up_minutes = 0.0;  ///< for each line
  double minutes = 0.0;         ///< everything
};
[[nodiscard]] IsoProgramme iso_programme(const std::vector<InvestigatedLine>& lines, const params::Machine& machine,
                                         const model::MeasuringTimes& times);

}  // namespace ecs::commissioning
