// Columns of effects over observations, and what stands between their linear coefficients and the parameters that
// people read.
#include "model/regression/regressors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "model/data/motions.hpp"
#include "model/effects/quantities.hpp"
#include "model/regression/needs.hpp"
#include "model/regression/user_formula.hpp"

namespace ecs::model {
namespace {

/// Levers closer than a hundredth of a millimetre are one, targets closer than a micrometre.
constexpr double kSameLever_m = 1e-5, kSameTarget_mm = 1e-3;

/// Only what the approach of its moving axis does counts in the row.
bool is_aside(const Observations& data, std::size_t k) { return !data.aside.empty() && data.aside[k]; }

/// An error motion of a rotary axis in readings of a ball.
bool acts_through_chain(const Observations& data, const EffectInstance& effect) {
  return !data.through_chain.empty() && effect.rotary && effect.axis && effect.sense &&
         effect.definition().place == Place::axis_and_sense;
}

double chain_factor(const Observations& data, std::size_t k, const EffectInstance& effect) {
  return acts_through_chain(data, effect) ? data.share_of(k, *effect.axis, *effect.sense) : 1.0;
}

bool acts_by_place(const Observations& data, std::size_t k, const EffectInstance& effect) {
  const EffectDefinition& definition = effect.definition();
  if (is_aside(data, k)) {
    const bool by_motion = definition.traits.of_approach || effect.approach != ApproachMode::both;
    if (!by_motion || definition.place == Place::map) return false;
  }
  if (definition.traits.until_new_set_up && !first_set_up(data, k)) return false;
  if (definition.has_lever()) return effect.code && lever_m(data, k, *effect.code) != 0.0;
  if (definition.place == Place::set_up)
    return !is_rotation(data.sense[k]) && direction_of(data.sense[k]) != direction_of(*effect.sense);
  if (definition.place == Place::map)
    return data.compensated[k] && data.map && (!definition.traits.of_approach || data.approach[k] != 0);
  if (definition.place == Place::artefact) return !data.through_chain.empty() && !is_rotation(data.sense[k]);
  if (definition.place == Place::location)
    return !data.through_chain.empty() && data.share_of(k, *effect.axis, *effect.sense) != 0.0;
  if (acts_through_chain(data, effect) ? data.share_of(k, *effect.axis, *effect.sense) == 0.0
                                       : effect.sense && data.sense[k] != *effect.sense)
    return false;
  if (!effect.axis) return true;
  if (definition.traits.of_lines && effect.sense && data.through_chain.empty()) {
    if (effect.line > 0 && data.axis[k] != *effect.axis) return false;
    if (effect.line > 1 && data.line_of(k) != effect.line) return false;
    if (effect.from_run > 0 && (data.axis[k] != *effect.axis || data.run[k] < effect.from_run)) return false;
  }
  if (definition.traits.of_approach) return is_own_motion(data, k, *effect.axis);
  if (effect.approach == ApproachMode::both) return true;
  return is_own_motion(data, k, *effect.axis) &&
         (data.approach_of(k, *effect.axis) > 0) == (effect.approach == ApproachMode::forward);
}

void fill_row(const ReadingAt& at, std::span<double> row) {
  const EffectDefinition& definition = at.effect.definition();
  if (definition.columns_of_place != nullptr)
    definition.columns_of_place(at.p_mm(), at.searched, row);
  else
    definition.columns(at, row);
}

/// Values at the starting parameters, the linear ones at 0 but for `one`.
std::vector<double> user_values(const UserFormulas& formulas, const EffectInstance& effect,
                                const std::vector<bool>& linear, std::size_t one) {
  std::vector<double> at;
  for (std::size_t i = 0; i < effect.user.size(); ++i)
    at.push_back(linear[i] && !effect.user[i].value ? (i == one ? 1.0 : 0.0) : start_of(effect.user[i]));
  return formulas.values(at);
}

/// One column per linear parameter that is not held, at the starting values of the others.
Eigen::MatrixXd user_columns(const Observations& data, const EffectInstance& effect) {
  const auto n = static_cast<Eigen::Index>(data.size());
  Eigen::MatrixXd columns(n, 0);
  const auto formulas = UserFormulas::compile(effect, data);
  if (!formulas) return columns;
  std::vector<double> start;
  for (const UserParameter& parameter : effect.user) start.push_back(start_of(parameter));
  const std::vector<bool> linear = formulas->linear_parameters(start);
  const std::vector<double> nothing = user_values(*formulas, effect, linear, effect.user.size());
  for (std::size_t j = 0; j < effect.user.size(); ++j) {
    if (!linear[j] || effect.user[j].value) continue;
    const std::vector<double> values = user_values(*formulas, effect, linear, j);
    columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
    for (std::size_t k = 0; k < data.size(); ++k) {
      const double value = values[k] - nothing[k];
      columns(static_cast<Eigen::Index>(k), columns.cols() - 1) = std::isnan(value) || is_aside(data, k) ? 0.0 : value;
    }
  }
  return columns;
}

Acting acting_user(const Observations& data, const EffectInstance& effect) {
  Acting acting;
  const auto formulas = UserFormulas::compile(effect, data);
  if (!formulas) return acting;
  std::vector<double> start;
  for (const UserParameter& parameter : effect.user) start.push_back(start_of(parameter));
  const std::vector<double> values = formulas->values(start);
  for (std::size_t k = 0; k < data.size(); ++k) {
    const bool mine = std::ranges::any_of(effect.formulas,
                                          [&](const UserFormula& formula) { return formula.sense == data.sense[k]; });
    if (!mine || is_aside(data, k)) continue;
    if (std::isnan(values[k]))
      ++acting.skipped;
    else
      acting.rows.push_back(k);
  }
  if (acting.skipped > 0) acting.lacking = "a column of its formula";
  return acting;
}

}  // namespace

Regressors::Regressors(const Observations& data) : data_(data), motions_(data.motions()) {}
Regressors::~Regressors() = default;

Acting Regressors::acting(const EffectInstance& effect) const {
  Acting acting;
  if (effect.is_user()) {
    acting = acting_user(motions_, effect);
  } else {
    for (std::size_t k = 0; k < motions_.size(); ++k) {
      if (!acts_by_place(motions_, k, effect)) continue;
      if (data_.moved && data_.moved->on_path[k] && effect.traits().of_optics()) continue;
      const bool far_from_reversal = data_.moved && data_.moved->on_path[k] && follows_reversal(effect.definition());
      if (!has_needs(motions_, k, effect))
        acting.skipped += far_from_reversal ? 0 : 1;
      else
        acting.rows.push_back(k);
    }
    if (acting.skipped > 0) acting.lacking = needed_columns(effect);
  }
  return with_readings(std::move(acting));
}

Acting Regressors::with_readings(Acting acting) const {
  if (!data_.moved) {
    acting.readings = acting.rows;
    return acting;
  }
  std::vector<bool> moved(motions_.size()), acted(data_.moved->readings);
  for (const std::size_t row : acting.rows) moved[row] = true;
  for (const Motions::Share& share : data_.moved->shares)
    if (moved[share.row]) acted[share.reading] = true;
  acting.readings.clear();
  for (std::size_t k = 0; k < data_.size(); ++k)
    if (acted[data_.of_moved[k]]) acting.readings.push_back(k);
  acting.skipped = std::min(acting.skipped, data_.size() - acting.readings.size());
  return acting;
}

Eigen::MatrixXd Regressors::readings_from(Eigen::MatrixXd of_motions) const {
  if (!data_.moved) return of_motions;
  /// Of a column less than this share is left: centre, radius or zero of the passes took all of it. Shapes are kept in
  /// single precision.
  constexpr double kTakenOut = 1e-6;
  const Motions& moved = *data_.moved;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(moved.readings), of_motions.cols());
  Eigen::MatrixXd chosen(static_cast<Eigen::Index>(data_.size()), of_motions.cols());
  for (Eigen::Index j = 0; j < all.cols(); ++j) {
    double* const to = all.col(j).data();
    const double* const from = of_motions.col(j).data();
    for (const Motions::Share& share : moved.shares) to[share.reading] += share.weight * from[share.row];
    moved.take_out_free(to);
    const double least = kTakenOut * of_motions.col(j).norm();
    if (all.col(j).norm() <= least) all.col(j).setZero();
    for (std::size_t k = 0; k < data_.size(); ++k) chosen(static_cast<Eigen::Index>(k), j) = to[data_.of_moved[k]];
  }
  return chosen;
}

Eigen::MatrixXd Regressors::motions_from(Eigen::MatrixXd of_readings) const {
  if (!data_.moved) return of_readings;
  const Motions& moved = *data_.moved;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(motions_.size()), of_readings.cols());
  std::vector<double> all(moved.readings);
  for (Eigen::Index j = 0; j < rows.cols(); ++j) {
    std::ranges::fill(all, 0.0);
    for (std::size_t k = 0; k < data_.size(); ++k)
      all[data_.of_moved[k]] = of_readings(static_cast<Eigen::Index>(k), j);
    moved.take_out_free(all.data());
    double* const to = rows.col(j).data();
    for (const Motions::Share& share : moved.shares) to[share.row] += share.weight * all[share.reading];
  }
  return rows;
}

Eigen::VectorXd Regressors::of_formulas(const std::vector<double>& values) const {
  Eigen::MatrixXd column(static_cast<Eigen::Index>(values.size()), 1);
  for (std::size_t k = 0; k < values.size(); ++k)
    column(static_cast<Eigen::Index>(k), 0) = std::isnan(values[k]) || is_aside(motions_, k) ? 0.0 : values[k];
  return readings_from(std::move(column)).col(0);
}

const CurveBasis& Regressors::basis_of(const EffectInstance& effect) const {
  const std::string key = to_text(effect);
  const auto found = bases_.find(key);
  if (found != bases_.end()) return found->second;
  std::vector<double> places;
  for (std::size_t k = 0; k < motions_.size(); ++k)
    if (acts_by_place(motions_, k, effect)) places.push_back(motions_.p_mm(k, *effect.axis));
  return bases_.emplace(key, CurveBasis(places, kMostCurveFunctions, lever_varies(effect))).first->second;
}

bool Regressors::lever_varies(const EffectInstance& effect) const {
  if (effect.definition().place != Place::rotation) return false;
  std::map<std::pair<Sense, std::int64_t>, double> lever_at;  // by target
  for (std::size_t k = 0; k < motions_.size(); ++k) {
    if (motions_.axis[k] != *effect.axis) continue;
    const double lever = lever_m(motions_, k, *effect.code);
    const auto target = std::llround(motions_.p_mm(k, *effect.axis) / kSameTarget_mm);
    if (std::abs(lever - lever_at.try_emplace({motions_.sense[k], target}, lever).first->second) > kSameLever_m)
      return true;
  }
  return false;
}

Eigen::VectorXd Regressors::of_curve(const EffectInstance& effect, const Acting& acting) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(motions_.size()));
  if (effect.curve.empty()) return sum;
  const laser::MapTable table{Component::EXX, Approach::unknown, effect.curve.p_mm, effect.curve.value};
  for (const std::size_t k : acting.rows) {
    const double value = laser::compensation_at(table, motions_.position_mm[k][index_of(*effect.axis)]);
    sum(static_cast<Eigen::Index>(k)) =
        value * effect.definition().curve_factor({motions_, k, effect}) * chain_factor(motions_, k, effect);
  }
  if (data_.moved) return readings_from(sum).col(0);
  return sum;
}

double Regressors::rms_of_curve(const EffectInstance& effect, const Acting& acting,
                                const Eigen::VectorXd& sizes) const {
  const CurveBasis& basis = basis_of(effect);
  double squares = 0.0;
  for (const std::size_t k : acting.rows) {
    double value = 0.0;
    for (Eigen::Index j = 0; j < sizes.size(); ++j)
      value += sizes(j) *
               curve_function(effect.definition(), basis, static_cast<std::size_t>(j), motions_.p_mm(k, *effect.axis));
    squares += value * value;
  }
  return acting.rows.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(acting.rows.size()));
}

Columns Regressors::columns(const EffectInstance& effect, double searched) const {
  return columns(effect, searched, acting(effect));
}

double curve_function(const EffectDefinition& definition, const CurveBasis& basis, std::size_t column, double p_mm) {
  const std::size_t leading = definition.leading_columns();
  if (column >= leading) return basis.value(column - leading, p_mm);
  if (column == 0 && definition.traits.keeps_mean) return 1.0;
  return (p_mm - basis.centre_mm()) / basis.half_width_mm();
}

Eigen::MatrixXd Regressors::curve_columns(const EffectInstance& effect, const Acting& acting) const {
  const EffectDefinition& definition = effect.definition();
  const CurveBasis& basis = basis_of(effect);
  const std::size_t count = definition.leading_columns() + basis.size();
  Eigen::MatrixXd columns =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(motions_.size()), static_cast<Eigen::Index>(count));
  std::map<double, Eigen::RowVectorXd> at_place;  // targets repeat
  for (const std::size_t k : acting.rows) {
    const double p = motions_.p_mm(k, *effect.axis);
    const double factor = definition.curve_factor({motions_, k, effect}) * chain_factor(motions_, k, effect);
    const auto [at, is_new] = at_place.try_emplace(p, columns.cols());
    for (std::size_t f = 0; f < count && is_new; ++f)
      at->second(static_cast<Eigen::Index>(f)) = curve_function(definition, basis, f, p);
    columns.row(static_cast<Eigen::Index>(k)) = factor * at->second;
  }
  return columns;
}

Columns Regressors::columns(const EffectInstance& effect, double searched, const Acting& acting) const {
  Columns columns = motion_columns(effect, searched, acting);
  if (!data_.moved) return columns;
  columns.of = readings_from(std::move(columns.of));
  if (columns.fixed.size() > 0) columns.fixed = readings_from(columns.fixed).col(0);
  return columns;
}

Columns Regressors::motion_columns(const EffectInstance& effect, double searched, const Acting& acting) const {
  const auto n = static_cast<Eigen::Index>(motions_.size());
  const EffectDefinition& definition = effect.definition();
  Columns columns;
  if (effect.is_user()) {
    columns.of = user_columns(motions_, effect);
    return columns;
  }
  if (definition.traits.fixed_size) {
    columns.of.resize(n, 0);
    columns.fixed = Eigen::VectorXd::Zero(n);
    for (const std::size_t k : acting.rows)
      columns.fixed(static_cast<Eigen::Index>(k)) = definition.fixed_part({motions_, k, effect, searched});
    return columns;
  }
  if (definition.traits.is_curve) {
    columns.leading = definition.leading_columns();
    columns.of = curve_columns(effect, acting);
    return columns;
  }
  columns.of = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(definition.column_count()));
  Eigen::RowVectorXd row(columns.of.cols());
  const std::vector<double> late =
      definition.traits.has_lag ? late_degC(motions_, effect, searched) : std::vector<double>{};
  for (const std::size_t k : acting.rows) {
    fill_row({motions_, k, effect, searched, late}, {row.data(), static_cast<std::size_t>(row.size())});
    columns.of.row(static_cast<Eigen::Index>(k)) = chain_factor(motions_, k, effect) * row;
  }
  return columns;
}

Eigen::VectorXd Regressors::unknown(const EffectInstance& effect, double searched) const {
  Eigen::VectorXd unknown = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data_.size()));
  if (!effect.traits().has_lag || data_.moved) return unknown;
  const std::vector<double> degC = unknown_degC(data_, effect, searched);
  if (degC.empty()) return unknown;
  const std::vector<double> none(data_.size(), 0.0);
  double at_degC = 0.0, at_none = 0.0;
  for (const std::size_t k : acting(effect).rows) {
    fill_row({data_, k, effect, searched, degC}, {&at_degC, 1});
    fill_row({data_, k, effect, searched, none}, {&at_none, 1});
    unknown(static_cast<Eigen::Index>(k)) = chain_factor(data_, k, effect) * (at_degC - at_none);
  }
  return unknown;
}

namespace {

std::optional<double> given(const EffectInstance& effect, std::string_view name) {
  const auto found = effect.parameters.find(std::string(name));
  return found == effect.parameters.end() ? std::nullopt : std::optional(found->second);
}

/// Coefficients that a parameter stands for.
std::size_t coefficients_of(Coding coding) {
  if (coding == Coding::amplitude) return 2;
  return coding == Coding::coefficient || coding == Coding::square_root ? 1 : 0;
}

/// A parameter with its coefficients.
struct Coded {
  std::size_t parameter = 0;    ///< place among the parameters of the definition
  std::size_t coefficient = 0;  ///< its first
};
std::vector<Coded> coded(const EffectDefinition& definition) {
  std::vector<Coded> all;
  std::size_t coefficient = 0;
  for (std::size_t i = 0; i < definition.parameters.size(); ++i) {
    const std::size_t count = coefficients_of(definition.parameters[i].coding);
    if (count > 0) all.push_back({i, coefficient});
    coefficient += count;
  }
  return all;
}

/// Amplitude and phase of a·sin + b·cos, with sigmas by propagation.
void add_harmonic(const EffectInstance& effect, std::vector<ParameterEstimate>& out, const Eigen::VectorXd& c,
                  const Eigen::MatrixXd& covariance, Eigen::Index at, std::span<const ParameterDefinition, 2> names) {
  if (at + 1 >= c.size()) return;
  const double a = c(at), b = c(at + 1);
  const double size = std::sqrt(a * a + b * b);
  ParameterEstimate amplitude{std::string(names[0].name), unit_of(effect, names[0]), size, {}, false, false};
  ParameterEstimate phase{std::string(names[1].name), std::string(names[1].unit), std::atan2(b, a), {}, false, false};
  if (covariance.rows() > at + 1 && size > 0.0) {
    const double vaa = covariance(at, at), vbb = covariance(at + 1, at + 1), vab = covariance(at, at + 1);
    amplitude.sigma = std::sqrt(std::max(0.0, (a * a * vaa + b * b * vbb + 2.0 * a * b * vab))) / size;
    phase.sigma = std::sqrt(std::max(0.0, (b * b * vaa + a * a * vbb - 2.0 * a * b * vab))) / (size * size);
  }
  out.push_back(amplitude);
  out.push_back(phase);
}

/// Coefficient `within` (0 sine, 1 cosine) of a wave that amplitude and phase give; nothing: to be fitted. A harmonic
/// that is not given beside a wave that is given whole is 0.
std::optional<double> held_in_wave(const EffectInstance& effect, std::size_t parameter, std::size_t within) {
  const auto& parameters = effect.definition().parameters;
  const auto amplitude = given(effect, parameters[parameter].name);
  const auto phase = given(effect, parameters[parameter + 1].name);
  if (amplitude && *amplitude == 0.0) return 0.0;
  const bool harmonic = parameter >= 2 && parameters[parameter - 2].coding == Coding::amplitude;
  if (harmonic && !amplitude && given(effect, parameters[parameter - 2].name) &&
      given(effect, parameters[parameter - 1].name))
    return 0.0;
  if (!amplitude || !phase) return std::nullopt;
  return *amplitude * (within == 0 ? std::cos(*phase) : std::sin(*phase));
}

}  // namespace

std::size_t EffectDefinition::column_count() const {
  std::size_t count = 0;
  for (const ParameterDefinition& parameter : parameters) count += coefficients_of(parameter.coding);
  return count;
}

bool has_exact_period(const EffectInstance& effect) { return effect.rotary && effect.traits().periodic; }

std::vector<ParameterEstimate> parameters_from(const EffectInstance& effect, const Eigen::VectorXd& linear,
                                               const Eigen::MatrixXd& covariance, std::optional<double> searched,
                                               std::optional<double> searched_sigma) {
  const EffectDefinition& definition = effect.definition();
  std::vector<ParameterEstimate> out;
  const auto add = [&](const ParameterDefinition& parameter, double value, std::optional<double> sigma, bool held) {
    out.push_back(
        {std::string(parameter.name), unit_of(effect, parameter), value, sigma, held, false, is_direction(effect)});
  };
  for (const ParameterDefinition& parameter : definition.parameters) {
    if (parameter.coding == Coding::searched && searched && !is_left_out(effect, parameter.name, *searched))
      add(parameter, *searched, has_exact_period(effect) ? std::nullopt : searched_sigma,
          given(effect, parameter.name).has_value());
    if (parameter.coding == Coding::fixed) add(parameter, 1.0, {}, false);
  }
  for (const auto& [place, first] : coded(definition)) {
    const ParameterDefinition& parameter = definition.parameters[place];
    const auto j = static_cast<Eigen::Index>(first);
    if (j >= linear.size()) break;
    if (parameter.coding == Coding::amplitude) {
      add_harmonic(effect, out, linear, covariance, j, std::span<const ParameterDefinition, 2>(&parameter, 2));
      continue;
    }
    std::optional<double> sigma;
    if (covariance.rows() > j) sigma = std::sqrt(std::max(0.0, covariance(j, j)));
    if (parameter.coding == Coding::square_root) {
      const double root = std::sqrt(std::max(0.0, linear(j)));
      if (sigma) sigma = *sigma / (2.0 * std::max(root, std::sqrt(*sigma)));
      add(parameter, root, sigma, false);
    } else {
      add(parameter, parameter.neutral + linear(j), sigma, false);
    }
  }
  return out;
}

std::optional<double> held_coefficient(const EffectInstance& effect, std::size_t j) {
  for (const auto& [place, first] : coded(effect.definition())) {
    const ParameterDefinition& parameter = effect.definition().parameters[place];
    if (j < first || j >= first + coefficients_of(parameter.coding)) continue;
    if (parameter.coding == Coding::amplitude) return held_in_wave(effect, place, j - first);
    const auto value = given(effect, parameter.name);
    if (!value) return std::nullopt;
    return parameter.coding == Coding::square_root ? *value * *value : *value - parameter.neutral;
  }
  return std::nullopt;
}

std::optional<ValueRange> EffectDefinition::coefficient_range(std::size_t j) const {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  for (const auto& [number, first] : coded(*this)) {
    const ParameterDefinition& parameter = parameters[number];
    if (j != first) continue;
    if (parameter.coding == Coding::square_root) {
      const double most = parameter.limits ? parameter.limits->greatest : kAny;
      return ValueRange{0.0, most * most};
    }
    if (parameter.coding == Coding::coefficient && parameter.limits)
      return ValueRange{parameter.limits->least - parameter.neutral, parameter.limits->greatest - parameter.neutral};
  }
  return std::nullopt;
}

std::string parameter_of_coefficient(const EffectDefinition& definition, std::size_t j) {
  for (const auto& [place, first] : coded(definition))
    if (j >= first && j < first + coefficients_of(definition.parameters[place].coding))
      return std::string(definition.parameters[place].name);
  return "";
}

}  // namespace ecs::model
