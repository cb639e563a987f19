// Fitting a model to readings: joint weighted least squares, robust to outliers, nonlinear parameters by variable
// projection. Does not live here: where a model fails (compare.hpp), what is missing from it
// (model/diagnosis/diagnose.hpp).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "model/data/observations.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/model_file.hpp"

namespace ecs::model {

struct FitOptions {
  bool plain = false;        ///< ordinary least squares: every reading counts the same, no outliers
  bool from_values = false;  ///< nonlinear parameters that have a value are refined from it, not searched again
};

struct EffectFit {
  EffectInstance effect;  ///< with `fitted` and `curve` filled
  std::vector<ParameterEstimate> parameters;
  double rms_um = 0.0;               ///< of its contribution over the readings it acts on
  std::size_t readings = 0;          ///< on which it acts
  std::size_t skipped = 0;           ///< that lack a cell it needs
  std::vector<double> contribution;  ///< per reading, canonical order; 0 where it does not act
};

/// A size of readings in um and of those in um/m, each over its own readings; 0 where there are none.
struct SizesByUnit {
  double um = 0.0, um_per_m = 0.0;
};
/// √(mean r²) of each. @param left_out  outliers, not counted; empty: none
[[nodiscard]] SizesByUnit rms_by_unit(const Observations& data, std::span<const double> residual,
                                      const std::vector<bool>& left_out = {});

/// Scatter of repeats: same axis, sense, position, approach and conditions.
struct PureError {
  double noise_um = 0.0;      ///< standard deviation of one reading
  SizesByUnit by_unit;        ///< the same
  bool from_repeats = false;  ///< false: from differences of neighbouring readings
  bool in_part = false;       ///< from repeats, but too few readings of one kind were repeated: there from neighbours
  double dof = 0.0;           ///< degrees of freedom of the repeats
  std::string differ_in;      ///< "feeds or loads": from readings of the same targets that differ in these; else empty
  bool is_of_step = false;    ///< repeats scatter less than the step of the readings must: they do not show the noise
  std::string_view unit = "um";  ///< of the readings: um, um/m, or both
  [[nodiscard]] bool all_from_repeats() const { return from_repeats && !in_part; }
  /// Neighbouring readings differ by the shape of the error as well as by their noise.
  [[nodiscard]] bool is_upper_limit() const { return !from_repeats && !is_of_step; }
};

struct LackOfFit {
  double F = 0.0;
  double p = 1.0;  ///< nominal: of normal noise without correlation
  /// Repeats say that the model is not right. Heavy tails, rounding and correlation make small p commoner: one in ten
  /// thousand fails, below one in a hundred is in doubt.
  [[nodiscard]] bool fails() const { return p < 1e-4; }
  [[nodiscard]] bool is_in_doubt() const { return p < 0.01 && !fails(); }
};

struct Correlation {
  std::string first;  ///< "scale:X:EX um_per_m"
  std::string second;
  double value = 0.0;  ///< −1 … 1
};

/// Noise of one sense: white and correlated part.
struct NoiseReport {
  Sense sense = Sense::EX;
  Axis axis = Axis::X;
  double white_um = 0.0;
  double correlated_um = 0.0;
  double correlation_time_s = 0.0;  ///< in readings where there is no time
  std::string path{};               ///< "circle XY"; "": of a sense along one axis
};

struct Fit {
  std::vector<EffectFit> effects;  ///< in the order of the model
  std::vector<double> predicted;   ///< canonical order of the observations
  std::vector<double> residual;    ///< reading − predicted
  double rms_um = 0.0;             ///< √(mean r²) over all readings, outliers included
  double peak_um = 0.0;
  SizesByUnit rms_by_unit, peak_by_unit;  ///< the same
  std::size_t fitted_parameters = 0;      ///< rank of the fit
  double condition = 1.0;                 ///< of the scaled normal equations' factor
  std::vector<Correlation> correlations;  ///< of magnitude 0.5 and more, strongest first
  std::vector<std::string> undetermined;  ///< terms that the data cannot determine, by name with what they collide with
  std::vector<int> outliers;              ///< row numbers, ascending; they weigh little or nothing, and stay in rms
  PureError noise;
  std::optional<LackOfFit> lack_of_fit;  ///< absent without repeats
  std::vector<NoiseReport> noise_by_sense;
  Origin origin;                   ///< from which its effects count
  std::vector<std::string> notes;  ///< skipped rows and their reasons
};

/// Refuses a model that cannot act on these data (a formula with an unknown column, no reading of a sense at all) and
/// fewer readings than one.
[[nodiscard]] Result<Fit> fit(const Model& model, const Observations& data, const FitOptions& options = {});

/// "offset:X:EX:99: acts on none of these readings: EX was measured along X in 1 line"; "" where it acts on some, or
/// they lack a cell that it needs. @param acting  of the effect
[[nodiscard]] std::string note_of_no_reading(const EffectInstance& effect, const Observations& data,
                                             const Acting& acting);

/// The model with every fitted value held, as if it had been given; effects that were never fitted stay as they are.
[[nodiscard]] Model with_values_held(Model model);

/// The model with `fitted`, curves and origin taken from a fit.
[[nodiscard]] Model with_values(Model model, const Fit& fit);

/// A rung of the ladder: the outliers of the fit are left out.
/// @param before  residuals without the effect, in canonical order
[[nodiscard]] LadderStep rung_of(const std::string& effect, const std::string& data_name,
                                 const std::vector<double>& before, const Fit& fit, const Observations& data);

/// "scale:X:EX: has no values; …" for each effect with neither `parameters` nor `fitted`.
[[nodiscard]] std::vector<Problem> problems_without_values(const Model& model);

/// Prediction per reading (canonical order) without fitting: `parameters`, else `fitted`, of every effect.
/// Refuses an effect that has neither.
[[nodiscard]] Result<std::vector<double>> predicted(const Model& model, const Observations& at);

/// "thermal_drift:X:EX is left out of 2 of 9 predictions: they lack t_material_degC" for each effect that is.
[[nodiscard]] Result<std::vector<std::string>> notes_of_lacking(const Model& model, const Observations& at);

}  // namespace ecs::model
