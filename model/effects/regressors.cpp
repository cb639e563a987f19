#include "model/effects/regressors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/data/refractivity.hpp"
#include "model/data/turns.hpp"
#include "model/effects/user_formula.hpp"

namespace ecs::model {
namespace {

using enum EffectId;

constexpr double kReference_degC = 20.0;

/// The row's cell of an optional column; kNotMeasured where the data do not have the column.
double cell(const Column& column, std::size_t k) { return column.empty() ? kNotMeasured : column[k]; }

double sensor(const Observations& data, const std::string& name, std::size_t k) {
  const auto found = data.sensors_degC.find(name);
  return found == data.sensors_degC.end() ? kNotMeasured : cell(found->second, k);
}

double air_deviation_ppm(const Observations& data, std::size_t k) {
  return refractivity_deviation_ppm(sensor(data, "t_air_degC", k), cell(data.pressure_hPa, k),
                                    cell(data.humidity_pct, k));
}

/// First measured value in canonical order.
double first_of(const Column& column) {
  for (const double value : column)
    if (!std::isnan(value)) return value;
  return kNotMeasured;
}

double known_value(const Observations& data, Component code, double position_mm) {
  for (const KnownComponent& known : data.known) {
    if (known.code != code || known.p_mm.empty()) continue;
    const laser::MapTable table{code, Approach::unknown, known.p_mm, known.value};
    return laser::compensation_at(table, position_mm);
  }
  return kNotMeasured;
}

/// Σ sign · lever [m] of the component in reading k; 0 where it does not act.
double lever_m(const Observations& data, std::size_t k, Component code) {
  if (is_rotation(data.sense[k])) return 0.0;
  double sum_mm = 0.0;
  for (const Term& term : data.terms) {
    if (term.component != code || !term.has_lever || !term.uses_coordinate) continue;
    if (index_of(term.observed) != static_cast<std::size_t>(data.sense[k])) continue;
    const double lever_mm = is_squareness(code) ? data.p_mm(k, term.lever)
                                                : data.position_mm[k][index_of(term.lever)] -
                                                      data.lines[index_of(moving_axis(code))][index_of(term.lever)];
    sum_mm += term.sign * lever_mm;
  }
  return sum_mm / 1000.0;
}

/// Column `set_up`: 1 or absent where the optics stand as in the first readings; another number after they were aligned
/// and reset anew, which ends a cosine error and a dead path.
bool first_set_up(const Observations& data, std::size_t k) {
  const auto found = data.extras.find("set_up");
  const double set_up = found == data.extras.end() ? 1.0 : cell(found->second, k);
  return std::isnan(set_up) || set_up == 1.0;
}

bool acts_by_place(const Observations& data, std::size_t k, const EffectInstance& effect) {
  if ((effect.id == cosine || effect.id == dead_path) && !first_set_up(data, k)) return false;
  if (effect.id == angular || effect.id == squareness) return effect.code && lever_m(data, k, *effect.code) != 0.0;
  if (effect.id >= map_polarity && effect.id <= map_direction_swap) {
    if (!data.compensated[k] || !data.map) return false;
    return effect.id != map_direction_swap || data.approach[k] != 0;
  }
  if (effect.sense && data.sense[k] != *effect.sense) return false;
  if (!effect.axis) return true;
  if (info_of(effect.id).of_approach) return is_own_motion(data, k, *effect.axis);
  if (effect.approach == ApproachMode::both) return true;
  return is_own_motion(data, k, *effect.axis) && (data.approach[k] > 0) == (effect.approach == ApproachMode::forward);
}

/// The cell that the effect needs besides the position; any number where it needs none.
double needed_cell(const Observations& data, std::size_t k, const EffectInstance& effect) {
  switch (effect.id) {
    case thermal_scale:
      return sensor(data, "t_material_degC", k);
    case thermal_drift:
      return sensor(data, effect.sensor, k);
    case warm_up:
    case time_drift:
      return cell(data.time_s, k);
    case air_refraction:
    case dead_path:
      return air_deviation_ppm(data, k);
    case servo_lag:
      return cell(data.feed_mm_min, k);
    case load:
      return cell(data.load_kg, k);
    case reversal_spike:
      return cell(data.travel_since_reversal_mm, k);
    case measurement_line:
      return effect.code ? known_value(data, *effect.code, 0.0) : kNotMeasured;
    default:
      return 0.0;
  }
}

std::string_view needed_column(const EffectInstance& effect) {
  switch (effect.id) {
    case thermal_scale:
      return "t_material_degC";
    case thermal_drift:
      return effect.sensor;
    case warm_up:
    case time_drift:
      return "time_s";
    case air_refraction:
    case dead_path:
      return "t_air_degC, pressure_hPa, humidity_pct";
    case servo_lag:
      return "feed_mm_min";
    case load:
      return "load_kg";
    case reversal_spike:
      return "travel_since_reversal_mm";
    case measurement_line:
      return "the known component";
    default:
      return "";
  }
}

/// One row of the columns of an effect with a fixed number of them.
void fill_row(const Observations& data, std::size_t k, const EffectInstance& effect, double nonlinear,
              double first_degC, Eigen::Ref<Eigen::RowVectorXd> row) {
  const double p_mm = effect.axis ? data.p_mm(k, *effect.axis) : 0.0;
  const double p_m = p_mm / 1000.0;
  const double d = data.approach[k];
  switch (effect.id) {
    case offset:
      row(0) = 1.0;
      return;
    case scale:
      row(0) = p_m;
      return;
    case cyclic: {
      const double angle = 2.0 * std::numbers::pi * p_mm / nonlinear;
      row << sine_of(angle), cosine_of(angle), sine_of(2.0 * angle), cosine_of(2.0 * angle);
      return;
    }
    case backlash:
      row(0) = d / 2.0;
      return;
    case step:
      row(0) = p_mm > nonlinear ? 1.0 : 0.0;
      return;
    case sag:
      row << p_m * p_m, std::abs(p_m) * p_m * p_m;
      return;
    case squareness:
      row(0) = lever_m(data, k, *effect.code);
      return;
    case measurement_line:
      row(0) = known_value(data, *effect.code, data.position_mm[k][index_of(*effect.axis)]) / 1000.0;
      return;
    case thermal_scale:
      row(0) = p_m * (needed_cell(data, k, effect) - kReference_degC);
      return;
    case thermal_drift:
      row(0) = needed_cell(data, k, effect) - first_degC;
      return;
    case warm_up:
      row(0) = -std::expm1(-data.time_s[k] / nonlinear);
      row(1) = row(0) * p_m;
      return;
    case time_drift:
      row(0) = data.time_s[k] / 3600.0;
      return;
    case air_refraction:
      row(0) = p_m * air_deviation_ppm(data, k);
      return;
    case dead_path:
      row(0) = air_deviation_ppm(data, k);
      return;
    case cosine:
      row(0) = -5e-4 * p_mm;
      return;
    case servo_lag:
      row(0) = data.feed_mm_min[k] / 1000.0 * d;
      return;
    case load:
      row << data.load_kg[k], data.load_kg[k] * p_m;
      return;
    case reversal_spike:
      row(0) = d * std::exp(-data.travel_since_reversal_mm[k] / nonlinear);
      return;
    case map_gain:
      row(0) = map_compensation(data, k, effect, 0.0, data.approach[k]);
      return;
    default:
      return;
  }
}

std::size_t column_count(EffectId id) {
  if (id == cyclic) return 4;
  return id == sag || id == warm_up || id == load ? 2 : 1;
}

/// What the curve of an effect is multiplied by in reading k.
double curve_factor(const Observations& data, std::size_t k, const EffectInstance& effect) {
  if (effect.id == reversal_curve) return 0.5 * data.approach[k];
  return effect.id == angular ? lever_m(data, k, *effect.code) : 1.0;
}

double fixed_part(const Observations& data, std::size_t k, const EffectInstance& effect, double nonlinear) {
  const double now = map_compensation(data, k, effect, 0.0, data.approach[k]);
  if (effect.id == map_polarity) return -2.0 * now;
  if (effect.id == map_shift) return map_compensation(data, k, effect, nonlinear, data.approach[k]) - now;
  return map_compensation(data, k, effect, 0.0, -data.approach[k]) - now;
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
      columns(static_cast<Eigen::Index>(k), columns.cols() - 1) = std::isnan(value) ? 0.0 : value;
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
    const bool mine = std::any_of(effect.formulas.begin(), effect.formulas.end(),
                                  [&](const UserFormula& formula) { return formula.sense == data.sense[k]; });
    if (!mine) continue;
    if (std::isnan(values[k]))
      ++acting.skipped;
    else
      acting.rows.push_back(k);
  }
  if (acting.skipped > 0) acting.lacking = "a column of its formula";
  return acting;
}

}  // namespace

bool is_own_motion(const Observations& data, std::size_t k, Axis axis) {
  return data.axis[k] == axis && data.approach[k] != 0;
}

std::string_view nonlinear_parameter_of(EffectId id) {
  for (const ParameterInfo& parameter : info_of(id).parameters)
    if (parameter.nonlinear) return parameter.name;
  return "";
}

bool is_curve(EffectId id) { return id == progressive || id == reversal_curve || id == angular; }
bool has_fixed_size(EffectId id) { return id == map_polarity || id == map_shift || id == map_direction_swap; }

Regressors::Regressors(const Observations& data) : data_(data) {}
Regressors::~Regressors() = default;

Acting Regressors::acting(const EffectInstance& effect) const {
  Acting acting;
  if (effect.id == user) return acting_user(data_, effect);
  for (std::size_t k = 0; k < data_.size(); ++k) {
    if (!acts_by_place(data_, k, effect)) continue;
    if (std::isnan(needed_cell(data_, k, effect)))
      ++acting.skipped;
    else
      acting.rows.push_back(k);
  }
  if (acting.skipped > 0) acting.lacking = needed_column(effect);
  return acting;
}

const CurveBasis& Regressors::basis_of(const EffectInstance& effect) const {
  const std::string key = to_text(effect);
  const auto found = bases_.find(key);
  if (found != bases_.end()) return found->second;
  std::vector<double> places;
  for (std::size_t k = 0; k < data_.size(); ++k)
    if (acts_by_place(data_, k, effect)) places.push_back(data_.p_mm(k, *effect.axis));
  return bases_.emplace(key, CurveBasis(places, kMostCurveFunctions)).first->second;
}

Eigen::VectorXd Regressors::of_curve(const EffectInstance& effect, const Acting& acting) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data_.size()));
  if (effect.curve.empty()) return sum;
  const laser::MapTable table{Component::EXX, Approach::unknown, effect.curve.p_mm, effect.curve.value};
  for (const std::size_t k : acting.rows) {
    const double value = laser::compensation_at(table, data_.position_mm[k][index_of(*effect.axis)]);
    sum(static_cast<Eigen::Index>(k)) = value * curve_factor(data_, k, effect);
  }
  return sum;
}

Columns Regressors::columns(const EffectInstance& effect, double nonlinear) const {
  return columns(effect, nonlinear, acting(effect));
}

Columns Regressors::columns(const EffectInstance& effect, double nonlinear, const Acting& acting) const {
  const auto n = static_cast<Eigen::Index>(data_.size());
  Columns columns;
  if (effect.id == user) {
    columns.of = user_columns(data_, effect);
    return columns;
  }
  if (has_fixed_size(effect.id)) {
    columns.of.resize(n, 0);
    columns.fixed = Eigen::VectorXd::Zero(n);
    for (const std::size_t k : acting.rows)
      columns.fixed(static_cast<Eigen::Index>(k)) = fixed_part(data_, k, effect, nonlinear);
    return columns;
  }
  if (is_curve(effect.id)) {
    const CurveBasis& basis = basis_of(effect);
    columns.leading = effect.id == angular ? 2 : 0;
    columns.of = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(columns.leading + basis.size()));
    for (const std::size_t k : acting.rows) {
      const double p = data_.p_mm(k, *effect.axis);
      const double factor = curve_factor(data_, k, effect);
      auto row = columns.of.row(static_cast<Eigen::Index>(k));
      if (columns.leading > 0) {
        row(0) = factor;
        row(1) = factor * (p - basis.centre_mm()) / basis.half_width_mm();
      }
      for (std::size_t f = 0; f < basis.size(); ++f)
        row(static_cast<Eigen::Index>(columns.leading + f)) = factor * basis.value(f, p);
    }
    return columns;
  }
  columns.of = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(column_count(effect.id)));
  const double first_degC = effect.id == thermal_drift && data_.sensors_degC.contains(effect.sensor)
                                ? first_of(data_.sensors_degC.find(effect.sensor)->second)
                                : 0.0;
  Eigen::RowVectorXd row(columns.of.cols());
  for (const std::size_t k : acting.rows) {
    fill_row(data_, k, effect, nonlinear, first_degC, row);
    columns.of.row(static_cast<Eigen::Index>(k)) = row;
  }
  return columns;
}

}  // namespace ecs::model
