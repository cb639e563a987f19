// The readings of all runs of an investigation as one set, and the model with the zeros of the runs: every run begins
// with an instrument set to zero anew, so that what shifts a whole run says nothing. The slope of a line against a
// straight edge, which is that of its set-up, is taken out of a model before a map is made. Does not live here:
// measuring (workshop.hpp).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"
#include "model/data/observations.hpp"
#include "model/fit/model_file.hpp"
#include "modules/investigation/first_look.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

/// Whether the name is that of a zero that an InvestigationReadings added to the model.
[[nodiscard]] bool is_zero_of_run(std::string_view effect_name);

class InvestigationReadings {
 public:
  explicit InvestigationReadings(model::Model base) : base_(std::move(base)) {}

  /// Rows and runs are numbered on; times before the end of the last run are moved behind it.
  /// @param pause_minutes  between the last run and this one, where its times begin anew
  /// @param against_square  its slope is that of the machine, not of a straight edge
  void add(laser::MeasurementSet run, double pause_minutes, bool against_square = false);

  /// The base model with a zero for each run; a straight edge has a slope of its own as well. The first run of a sense
  /// needs none where the model has an offset of that sense.
  [[nodiscard]] model::Model model_with_zeros() const;
  [[nodiscard]] model::Observations observations(const params::Machine& machine) const;
  [[nodiscard]] const laser::MeasurementSet& all() const { return all_; }

 private:
  struct Zero {
    Sense sense = Sense::EX;
    int number = 0;
    bool offset = true;
    bool slope = false;
  };
  model::Model base_;
  laser::MeasurementSet all_;
  std::vector<Zero> zeros_;
  double last_s_ = 0.0;
};

/// The model without the zeros of runs.
[[nodiscard]] model::Model without_zeros(model::Model model);

/// The usual slope of the line is set so that all that a map carries of it is level over the travel (least squares):
/// then compensating the line does not turn the axis, from which squareness counts. A slope that a person gave stays.
[[nodiscard]] Result<void> make_level(model::Model& model, const InvestigatedLine& line,
                                      const params::Machine& machine);

}  // namespace ecs::commissioning
