#include "model/regression/regressors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "model/effects/quantities.hpp"
#include "model/regression/needs.hpp"
#include "model/regression/user_formula.hpp"

namespace ecs::model {
namespace {

/// Levers closer than a hundredth of a millimetre are one, targets closer than a micrometre.
constexpr double kSameLever_m = 1e-5, kSameTarget_mm = 1e-3;

bool acts_by_place(const Observations& data, std::size_t k, const EffectInstance& effect) {
  const EffectDefinition& definition = effect.definition();
  if (definition.traits.until_new_set_up && !first_set_up(data, k)) return false;
  if (definition.has_lever()) return effect.code && lever_m(data, k, *effect.code) != 0.0;
  if (definition.place == Place::set_up)
    return !is_rotation(data.sense[k]) && direction_of(data.sense[k]) != direction_of(*effect.sense);
  if (definition.place == Place::map)
    return data.compensated[k] && data.map && (!definition.traits.of_approach || data.approach[k] != 0);
  if (effect.sense && data.sense[k] != *effect.sense) return false;
  if (!effect.axis) return true;
  if (definition.traits.of_approach) return is_own_motion(data, k, *effect.axis);
  if (effect.approach == ApproachMode::both) return true;
  return is_own_motion(data, k, *effect.axis) && (data.approach[k] > 0) == (effect.approach == ApproachMode::forward);
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

Regressors::Regressors(const Observations& data) : data_(data) {}
Regressors::~Regressors() = default;

Acting Regressors::acting(const EffectInstance& effect) const {
  Acting acting;
  if (effect.is_user()) return acting_user(data_, effect);
  for (std::size_t k = 0; k < data_.size(); ++k) {
    if (!acts_by_place(data_, k, effect)) continue;
    if (!has_needs(data_, k, effect))
      ++acting.skipped;
    else
      acting.rows.push_back(k);
  }
  if (acting.skipped > 0) acting.lacking = needed_columns(effect);
  return acting;
}

const CurveBasis& Regressors::basis_of(const EffectInstance& effect) const {
  const std::string key = to_text(effect);
  const auto found = bases_.find(key);
  if (found != bases_.end()) return found->second;
  std::vector<double> places;
  for (std::size_t k = 0; k < data_.size(); ++k)
    if (acts_by_place(data_, k, effect)) places.push_back(data_.p_mm(k, *effect.axis));
  return bases_.emplace(key, CurveBasis(places, kMostCurveFunctions, lever_varies(effect))).first->second;
}

bool Regressors::lever_varies(const EffectInstance& effect) const {
  if (effect.definition().place != Place::rotation) return false;
  std::map<std::pair<Sense, std::int64_t>, double> lever_at;  // by target
  for (std::size_t k = 0; k < data_.size(); ++k) {
    if (data_.axis[k] != *effect.axis) continue;
    const double lever = lever_m(data_, k, *effect.code);
    const auto target = std::llround(data_.p_mm(k, *effect.axis) / kSameTarget_mm);
    if (std::abs(lever - lever_at.try_emplace({data_.sense[k], target}, lever).first->second) > kSameLever_m)
      return true;
  }
  return false;
}

Eigen::VectorXd Regressors::of_curve(const EffectInstance& effect, const Acting& acting) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data_.size()));
  if (effect.curve.empty()) return sum;
  const laser::MapTable table{Component::EXX, Approach::unknown, effect.curve.p_mm, effect.curve.value};
  for (const std::size_t k : acting.rows) {
    const double value = laser::compensation_at(table, data_.position_mm[k][index_of(*effect.axis)]);
    sum(static_cast<Eigen::Index>(k)) = value * effect.definition().curve_factor({data_, k, effect});
  }
  return sum;
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
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(data_.size()), static_cast<Eigen::Index>(count));
  for (const std::size_t k : acting.rows) {
    const double p = data_.p_mm(k, *effect.axis);
    const double factor = definition.curve_factor({data_, k, effect});
    for (std::size_t f = 0; f < count; ++f)
      columns(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(f)) =
          factor * curve_function(definition, basis, f, p);
  }
  return columns;
}

Columns Regressors::columns(const EffectInstance& effect, double searched, const Acting& acting) const {
  const auto n = static_cast<Eigen::Index>(data_.size());
  const EffectDefinition& definition = effect.definition();
  Columns columns;
  if (effect.is_user()) {
    columns.of = user_columns(data_, effect);
    return columns;
  }
  if (definition.traits.fixed_size) {
    columns.of.resize(n, 0);
    columns.fixed = Eigen::VectorXd::Zero(n);
    for (const std::size_t k : acting.rows)
      columns.fixed(static_cast<Eigen::Index>(k)) = definition.fixed_part({data_, k, effect, searched});
    return columns;
  }
  if (definition.traits.is_curve) {
    columns.leading = definition.leading_columns();
    columns.of = curve_columns(effect, acting);
    return columns;
  }
  columns.of = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(definition.column_count()));
  Eigen::RowVectorXd row(columns.of.cols());
  for (const std::size_t k : acting.rows) {
    fill_row({data_, k, effect, searched}, {row.data(), static_cast<std::size_t>(row.size())});
    columns.of.row(static_cast<Eigen::Index>(k)) = row;
  }
  return columns;
}

}  // namespace ecs::model
