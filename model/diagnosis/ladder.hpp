// Adding effects one by one and watching the error fall; taking them back; what is left after compensation; whether
// readings decide between an effect and the alternatives kept with it. Does not live here: which effect to add
// (diagnose.hpp), which effects form a tie (stepwise.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/fit/fit.hpp"

namespace ecs::model {

/// What `ecs model add` was told; absent parts come from the best fit.
struct AddRequest {
  EffectId id = nullptr;
  std::optional<Axis> axis;
  bool rotary = false;  ///< the axis is A, B or C
  std::optional<Sense> sense;
  std::optional<Component> code;
  std::optional<ApproachMode> approach;
  std::string sensor;
  std::string sensor2;
  std::string name;  ///< of a user effect
  int ball = 1;      ///< of a ball on the table
  int line = 0;      ///< of an offset
  int from_run = 0;  ///< of an offset
  /// As a diagnosis names it, its values as a start; or a user effect that the model does not know yet.
  std::optional<EffectInstance> as_named{};
};
/// The effect is one that the request allows.
[[nodiscard]] bool is_requested(const EffectInstance& effect, const AddRequest& request);
/// This effect at its place, as it is.
[[nodiscard]] AddRequest request_of(const EffectInstance& effect);
/// "cyclic:X:EX", "angular:X:ECX", "backlash:X", "scale", "user:encoder tilt"; as place_text() writes them, too:
/// "cyclic:X:EX, reverse", "thermal_drift:X:EX with t_spindle_degC".
[[nodiscard]] Result<AddRequest> parse_add_request(std::string_view text);
/// The names of `EffectInstance::tied_with`, each with its approach: "cyclic:X:EX, reverse, scale:X:EX" are two.
[[nodiscard]] std::vector<std::string> alternatives_in(const std::string& tied_with);

struct Added {
  Model model;  ///< with the effect, its nonlinear parameters held, its history one step longer
  EffectFit effect;
  double rms_before_um = 0.0;
  double rms_after_um = 0.0;
  double noise_um = 0.0;
  bool noise_is_upper_limit = false;
  LadderStep step;
};
/// Refits the model with the effect in the place that fits best among those the request allows.
[[nodiscard]] Result<Added> add_effect(const Model& model, const Observations& data, const AddRequest& request,
                                       const std::string& data_name);

/// The model without its last added effect; refused where nothing was added.
[[nodiscard]] Result<Model> undo(const Model& model);

/// What is left of the modelled error once the unit compensates all that it can.
struct WhatIf {
  double rms_now_um = 0.0;    ///< of the readings
  double rms_after_um = 0.0;  ///< predicted, noise included
  double peak_after_um = 0.0;
  double machine_um = 0.0;      ///< rms of what the machine would keep, noise included
  double measurement_um = 0.0;  ///< rms of what belongs to the measurement: air, drift of the readout, set-up
  struct Share {
    std::string effect;
    double rms_um = 0.0;
    double peak_um = 0.0;  ///< largest contribution to a reading
    bool carried = false;
    bool of_measurement = false;
    std::string how;
  };
  std::vector<Share> shares;
};
[[nodiscard]] Result<WhatIf> what_if(const Model& model, const Observations& data);

struct DecidedTies {
  Model model;                     ///< without the alternatives that these readings rule out
  std::vector<std::string> notes;  ///< one for each tie of which they say anything
};

/// An alternative is ruled out where χ² with it is larger by five standard deviations' worth than with the effect of
/// the model; where one of them is as much better than the effect, nothing is changed and the note says so. An
/// alternative that these readings cannot show stays.
/// @param data  all readings that are to decide, the former ones too
[[nodiscard]] Result<DecidedTies> decided_ties(const Model& model, const Observations& data);

/// An effect of a model whose alternatives these readings do not rule out, or effects of it that do the same on them.
struct Undecided {
  Model without;                         ///< the model without it or them
  std::vector<EffectInstance> possible;  ///< the effect and its alternatives, or the effects: each as fitted alone
};
/// None of readings of a ball, whose exchangeable location errors a fit states.
[[nodiscard]] std::vector<Undecided> undecided_effects(const Model& model, const Observations& data);
/// " These readings do not distinguish causes listed in the model: scale:X:EX or cosine:X:EX."; "" where there is
/// nothing of the kind.
[[nodiscard]] std::string undecided_text(const Model& model, const Observations& data);

}  // namespace ecs::model
