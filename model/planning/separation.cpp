// T-optimality (Atkinson and Fedorov 1975): the χ² by which a rival, refitted to present and new readings together,
// would fail if an explanation is true; refits by orthogonal projection in the whitened space, curves with as many
// functions as Schwarz's criterion (1978) asks for. Rows of readings yet to be taken.
#include "model/planning/separation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/linear/decompositions.hpp"
#include "model/data/motions.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/compare.hpp"
#include "model/fit/search.hpp"
#include "model/fit/statistics.hpp"
#include "model/regression/user_formula.hpp"

namespace ecs::model {
namespace {

/// The columns that readings along paths have.
void make_room_for_paths(Observations& data) {
  if (data.feed_mm_min.empty()) data.feed_mm_min.assign(data.size(), kNotMeasured);
  if (!data.path.empty()) return;
  data.path.assign(data.size(), 0);
  data.along.assign(data.size(), kNotMeasured);
  data.place.assign(data.size(), kNotMeasured);
}

/// A present reading of the same axis and sense, to take from what a proposal does not say.
std::size_t pattern_of(const Observations& present, const MeasurementProposal& proposal) {
  for (std::size_t k = 0; k < present.size(); ++k)
    if (present.axis[k] == proposal.axis && present.sense[k] == proposal.sense) return k;
  return 0;
}

void set(Column& column, std::size_t k, const std::optional<double>& value) {
  if (!column.empty() && value) column[k] = *value;
}

void fill(Observations& data, std::size_t k, const MeasurementProposal& proposal, const Stop& stop, double start_s) {
  data.axis[k] = proposal.axis;
  data.sense[k] = proposal.sense;
  data.run[k] = stop.run;
  data.approach[k] = stop.approach;
  data.position_mm[k] = proposal.parked_mm;
  data.position_mm[k][index_of(proposal.axis)] = stop.target_mm;
  if (!data.path.empty()) data.path[k] = 0;
  if (proposal.circle) {
    data.position_mm[k] = point_on_circle(*proposal.circle, stop.target_mm);
    data.path[k] = data.paths.size();
    data.along[k] = data.place[k] = stop.target_mm;
  }
  if (proposal.compensated) data.compensated[k] = *proposal.compensated;
  set(data.time_s, k, start_s + stop.after_s);
  set(data.feed_mm_min, k, stop.feed_mm_min);
  set(data.load_kg, k, proposal.load_kg);
  set(data.travel_since_reversal_mm, k, stop.since_reversal_mm);
  set(data.pressure_hPa, k, proposal.pressure_hPa);
  set(data.humidity_pct, k, proposal.humidity_pct);
  for (auto& [sensor, column] : data.sensors_degC)
    if (const auto degC = proposal.temperatures_degC.find(sensor); degC != proposal.temperatures_degC.end())
      set(column, k, degC->second);
  if (const auto set_up = data.extras.find("set_up"); set_up != data.extras.end()) set_up->second[k] = proposal.set_up;
  if (const auto reversed = data.extras.find("reversed"); reversed != data.extras.end() && proposal.reversed)
    reversed->second[k] = *proposal.reversed ? 1.0 : 0.0;
}

/// Rows of a set of a ball from `first` on.
void fill_ball(Observations& data, std::size_t first, const MeasurementProposal& proposal, double start_s) {
  laser::MeasurementSet planned;
  planned.readings = proposal.ball->readings;
  const Observations rows = observations_of(planned, KnownTables{}, *data.ball_machine);
  std::vector<int> balls, tools;  // their numbers among the present ones
  for (const Vector3& one : rows.balls_mm) balls.push_back(numbered_place(data.balls_mm, one, kSameBall_mm));
  for (const Vector3& one : rows.tools_mm) tools.push_back(numbered_place(data.tools_mm, one, kSameTool_mm));
  for (const char* const column : kToolColumns) data.extras.try_emplace(column, Column(data.size(), kNotMeasured));
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const std::size_t k = first + j;
    data.axis[k] = rows.axis[j];
    data.sense[k] = rows.sense[j];
    data.run[k] = rows.run[j];
    data.approach[k] = rows.approach[j];
    data.position_mm[k] = rows.position_mm[j];
    data.place_mm[k] = rows.place_mm[j];
    data.through_chain[k] = rows.through_chain[j];
    data.through_chain[k].ball = balls[static_cast<std::size_t>(rows.through_chain[j].ball) - 1];
    data.through_chain[k].tool = tools[static_cast<std::size_t>(rows.through_chain[j].tool) - 1];
    set(data.time_s, k, start_s + rows.time_s[j]);
    for (std::size_t d = 0; d < kAxes; ++d) data.extras.find(kToolColumns[d])->second[k] = proposal.ball->tool_mm[d];
  }
}

bool describes_ball(std::string_view column) {
  return column == kOnWorkpiece || column == kAtTip || std::ranges::find(kToolColumns, column) != kToolColumns.end();
}

/// An extra column as a straight line over another one; over none it is constant.
struct Follows {
  std::string column;
  double at_zero = 0.0;
  double slope = 0.0;
  [[nodiscard]] double at(const Observations& data, std::size_t k) const {
    return column.empty() ? at_zero : at_zero + slope * variable_of(data, k, column);
  }
};

/// The line through the readings with the least and the greatest value of `column`, if all others lie on it. Every
/// `step`-th reading counts.
std::optional<Follows> line_over(const Observations& present, const Column& extra, const std::string& column,
                                 std::size_t step) {
  constexpr double kSame = 1e-5;  // of the range: the last digit of a cell
  double least = kBeyondAll, greatest = -kBeyondAll, low = kBeyondAll, high = -kBeyondAll;
  double at_least = 0.0, at_greatest = 0.0;
  for (std::size_t k = 0; k < present.size(); k += step) {
    const double x = column.empty() ? 0.0 : variable_of(present, k, column);
    if (std::isnan(x) || std::isnan(extra[k])) return std::nullopt;
    if (x < least) at_least = extra[k];
    if (x > greatest) at_greatest = extra[k];
    least = std::min(least, x);
    greatest = std::max(greatest, x);
    low = std::min(low, extra[k]);
    high = std::max(high, extra[k]);
  }
  Follows line{column, at_least, 0.0};
  if (greatest > least) line.slope = (at_greatest - at_least) / (greatest - least);
  line.at_zero -= line.slope * least;
  for (std::size_t k = 0; k < present.size(); k += step)
    if (std::abs(line.at(present, k) - extra[k]) > kSame * (high - low)) return std::nullopt;
  return line;
}

/// What a column without a meaning of its own depends on; places before conditions, since a run chooses them first.
std::optional<Follows> follows(const Observations& present, const Column& extra) {
  std::vector<std::string> columns{"", "x_mm", "y_mm", "z_mm", "approach", "feed_mm_min", "load_kg", "pressure_hPa"};
  columns.insert(columns.end(), {"humidity_pct", "travel_since_reversal_mm"});
  for (const auto& [sensor, degC] : present.sensors_degC) columns.push_back(sensor);
  columns.emplace_back("time_s");
  constexpr std::size_t kFewReadings = 50;  // show of most columns that they are no line
  for (const std::string& column : columns) {
    if (!line_over(present, extra, column, 1 + present.size() / kFewReadings)) continue;
    if (auto line = line_over(present, extra, column, 1)) return line;
  }
  return std::nullopt;
}

/// Marks rows of the present readings by a 1 among zeros.
bool is_mark(const Column& extra) {
  return std::ranges::all_of(extra, [](double value) { return value == 0.0 || value == 1.0; });
}

/// Cells of the extra columns in the new rows, which are otherwise whole.
/// @param zeroed_each_run  marks are the zeros of past runs
void fill_extras(WithProposals& all, const Observations& present, bool zeroed_each_run) {
  for (auto& [name, column] : all.data.extras) {
    if (name == "set_up" || name == "reversed" || describes_ball(name)) continue;
    const Column& known = present.extras.find(name)->second;
    const auto line = zeroed_each_run && is_mark(known) ? std::optional(Follows{}) : follows(present, known);
    if (line) all.extras_follow[name] = line->column;
    for (std::size_t k = all.present; k < column.size(); ++k) column[k] = line ? line->at(all.data, k) : kNotMeasured;
  }
}

}  // namespace

Observations present_of(const WithProposals& all) {
  std::vector<std::size_t> rows(all.present);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return subset(all.data, rows);
}

WithProposals with_proposals(const Observations& present, const std::vector<MeasurementProposal>& proposals) {
  WithProposals all;
  all.present = present.size();
  std::vector<std::size_t> rows(present.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::vector<std::vector<Stop>> stops;
  for (MeasurementProposal one : proposals) {
    one.runs = 1;
    stops.push_back(stops_of(one));
    all.first.push_back(rows.size());
    all.count.push_back(one.ball ? one.ball->readings.size() : stops.back().size());
    rows.insert(rows.end(), all.count.back(), pattern_of(present, one));
  }
  all.data = subset(present, rows);
  double last_s = 0.0;
  for (const double t : present.time_s)
    if (!std::isnan(t)) last_s = std::max(last_s, t);
  if (std::ranges::any_of(proposals, [](const MeasurementProposal& p) { return p.set_up != 1; }))
    all.data.extras.try_emplace("set_up", Column(rows.size(), 1.0));
  if (std::ranges::any_of(proposals, [](const MeasurementProposal& p) { return p.circle.has_value(); }))
    make_room_for_paths(all.data);
  for (std::size_t i = 0; i < proposals.size(); ++i) {
    if (proposals[i].circle) all.data.paths.push_back(*proposals[i].circle);  // a pass of its own, measured or not
    const double start_s = last_s + kSecondsAMinute * (proposals[i].wait_minutes + proposals[i].set_up_minutes);
    if (proposals[i].ball) fill_ball(all.data, all.first[i], proposals[i], start_s);
    for (std::size_t j = 0; j < stops[i].size(); ++j)
      fill(all.data, all.first[i] + j, proposals[i], stops[i][j], start_s);
  }
  fill_extras(all, present, std::ranges::any_of(proposals, [](const auto& p) { return p.own_zero; }));
  set_motions(all.data);
  return all;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A column of which less than this (of its norm) is left beside others does what they do.
constexpr double kDependentColumn = 1e-5;
/// Change of a nonlinear parameter for its slope: this share of it, and at least this: half the digits of a double.
constexpr double kSlopeStep = 1e-5, kLeastSlopeStep = 1e-7;

void append(MatrixXd& to, const MatrixXd& columns) {
  const Index had = to.cols();
  to.conservativeResize(columns.rows(), had + columns.cols());
  to.rightCols(columns.cols()) = columns;
}

/// Nonlinear values and noise from a fit to the present readings. @param beside  of which the noise is taken, or null
Result<std::pair<Assembly, CoreFit>> fitted_to(const Model& model, const Regressors& present, const CoreFit* beside) {
  ECS_TRY(assembly, Assembly::of(model, present));
  CoreOptions options;
  options.all_curve_functions = true;
  options.beside = beside;
  CoreFit core = fitted(assembly, present, options);
  return std::pair{std::move(assembly), std::move(core)};
}

/// Slopes of the free nonlinear parameters of the model at the sizes found.
MatrixXd slopes_of(Assembly& assembly, const Assembly& fitted_assembly, const VectorXd& sizes, const Regressors& all) {
  MatrixXd slopes(static_cast<Index>(all.data().size()), 0);
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    const Slot& slot = assembly.slots[s];
    if (!slot.has_slope()) continue;
    for (std::size_t j = 0; j < slot.nonlinear.size(); ++j) {
      if (!slot.nonlinear_free[j]) continue;
      const Index first = fitted_assembly.first_column(s);
      const VectorXd own = sizes.segment(first, fitted_assembly.slots[s].columns.cols());
      if (own.size() == slot.columns.cols()) append(slopes, assembly.slope(s, j, own, all));
    }
  }
  return slopes;
}

/// Columns for the places of balls or tools with the numbers after `known`.
void append_places(Belief& belief, std::string_view effect, std::size_t known, std::size_t count,
                   const Regressors& all) {
  for (std::size_t number = known + 1; number <= count; ++number) {
    EffectInstance place;
    place.id = effect_named(effect);
    place.rotary = true;
    place.ball = static_cast<int>(number);
    append(belief.columns, all.columns(place, 0.0).of);
  }
}

/// The effect with its fitted values as the starting values of its formulas.
EffectInstance started_at_fit(EffectInstance effect) {
  for (UserParameter& parameter : effect.user)
    if (const auto value = effect.fitted.find(parameter.name); value != effect.fitted.end())
      parameter.start = value->second;
  return effect;
}

/// Change of a nonlinear parameter for its slope.
double slope_step(double value) { return std::max(std::abs(value) * kSlopeStep, kLeastSlopeStep); }

/// Columns of an effect that are fitted, what it holds as its fixed part.
Columns free_columns(const Regressors& regressors, const EffectInstance& effect, double nonlinear) {
  Columns all = regressors.columns(effect, nonlinear);
  if (effect.traits().is_curve || effect.is_user()) return all;
  Columns free;
  free.fixed = all.fixed.size() > 0 ? all.fixed : VectorXd(VectorXd::Zero(all.of.rows()));
  free.of.resize(all.of.rows(), 0);
  for (Index j = 0; j < all.of.cols(); ++j) {
    if (const auto held = held_coefficient(effect, static_cast<std::size_t>(j)))
      free.fixed += *held * all.of.col(j);
    else
      append(free.of, all.of.col(j));
  }
  return free;
}

/// Sizes of whitened columns beside a base that is absorbed first; 0 for what the base or the others do as well.
VectorXd sizes_beside(const MatrixXd& base, const MatrixXd& columns, const VectorXd& target) {
  Space space;
  space.y = target;
  space.q.resize(target.size(), 0);
  absorb(space, base);
  VectorXd sizes = VectorXd::Zero(columns.cols());
  const MatrixXd left = without(space.q, columns);
  std::vector<Index> kept;
  for (Index j = 0; j < columns.cols(); ++j)
    if (left.col(j).norm() > kDependentColumn * columns.col(j).norm()) kept.push_back(j);
  if (kept.empty()) return sizes;
  MatrixXd own(target.size(), static_cast<Index>(kept.size()));
  VectorXd scale(own.cols());
  for (Index j = 0; j < own.cols(); ++j) {
    const auto column = kept[static_cast<std::size_t>(j)];
    scale(j) = 1.0 / left.col(column).norm();
    own.col(j) = left.col(column) * scale(j);
  }
  const PivotedQr qr(own, kDependentColumn);
  const VectorXd first = qr.independent_sizes(space.y);
  for (Index i = 0; i < qr.rank(); ++i) {
    const Index j = qr.place(i);
    sizes(kept[static_cast<std::size_t>(j)]) = first(i) * scale(j);
  }
  return sizes;
}

/// Leading columns of a curve that the present readings call for (Schwarz); all of anything else.
Index columns_called_for(const EffectInstance& effect, const Columns& columns, const MatrixXd& base,
                         const VectorXd& target, const Whitener& whitener) {
  if (!effect.traits().is_curve) return columns.of.cols();
  const auto n = static_cast<double>(target.size());
  const MatrixXd own = whitener(MatrixXd(columns.of.topRows(target.size())));
  Space space;
  space.y = whitener(target);
  space.q.resize(space.y.size(), 0);
  absorb(space, whitener(MatrixXd(base.topRows(target.size()))));
  Index best = std::min<Index>(1, columns.of.cols());
  double least = kBeyondAll;
  for (Index j = 0; j < own.cols(); ++j) {
    absorb(space, own.col(j));
    const double price = space.chi2() + std::log(n) * static_cast<double>(j + 1);
    if (price < least) {
      least = price;
      best = j + 1;
    }
  }
  return best;
}

/// Of the present circle of that name, else of any; without circles that of a reading of the lines.
NoiseGroup noise_of_circle(const Belief& belief, const std::string& name) {
  NoiseGroup group;
  group.white = belief.noise.pure.noise_um;
  for (const NoiseGroup& known : belief.noise.groups)
    if (!known.path.empty() && (group.path.empty() || known.path == name)) group = known;
  return group;
}

NoiseModel with_new_rows(const Belief& belief, const WithProposals& all,
                         const std::vector<MeasurementProposal>& proposals) {
  NoiseModel noise = belief.noise;
  noise.shapes.clear();
  for (std::size_t i = 0; i < proposals.size(); ++i) {
    NoiseGroup group;
    group.white = belief.noise.pure.noise_um;
    for (const NoiseGroup& known : belief.noise.groups)
      if (known.path.empty() && !proposals[i].circle && known.sense == proposals[i].sense &&
          known.axis == proposals[i].axis)
        group = known;
    if (proposals[i].circle) group = noise_of_circle(belief, name_of(*proposals[i].circle));
    group.rows.clear();
    for (std::size_t k = 0; k < all.count[i]; ++k) group.rows.push_back(all.first[i] + k);
    noise.groups.push_back(std::move(group));
  }
  return noise;
}

}  // namespace

Result<Belief> belief_of(const Model& model, const std::vector<EffectInstance>& known,
                         const std::vector<EffectInstance>& likely, const Observations& present,
                         const Regressors& all) {
  Model with = model;
  with.effects.insert(with.effects.end(), known.begin(), known.end());
  Model more = with;
  more.effects.insert(more.effects.end(), likely.begin(), likely.end());
  const Regressors now(present);
  std::optional<CoreFit> beside;
  if (!likely.empty())
    if (auto found = fitted_to(more, now, nullptr)) beside = std::move(found->second);
  ECS_TRY(found, fitted_to(with, now, beside ? &*beside : nullptr));
  auto& [assembly, core] = found;
  Belief belief;
  belief.noise = core.noise;
  belief.left_out = core.left_out;
  belief.target = Eigen::Map<const VectorXd>(present.reading.data(), static_cast<Index>(present.size())) -
                  assembly.fixed(present.size());
  ECS_TRY(wide, Assembly::of(with, all));
  for (std::size_t s = 0; s < wide.slots.size(); ++s) {
    wide.slots[s].nonlinear = assembly.slots[s].nonlinear;
    wide.renew(s, all);
  }
  belief.columns.resize(static_cast<Index>(all.data().size()), 0);
  if (!wide.slots.empty()) belief.columns = wide.columns();
  append(belief.columns, slopes_of(wide, assembly, core.sizes, all));
  // after a ball or a tool has been set up again its position differs by more than a micrometre
  append_places(belief, "ball_on_table", present.balls_mm.size(), all.data().balls_mm.size(), all);
  append_places(belief, "ball_in_spindle", present.tools_mm.size(), all.data().tools_mm.size(), all);
  return belief;
}

Explanation explained_by(const std::string& name, const EffectInstance& believed, const Belief& belief,
                         const WithProposals& all, const Regressors& regressors) {
  const EffectInstance effect = started_at_fit(believed);
  const auto present = static_cast<Index>(all.present);
  const std::string parameter(effect.definition().searched_parameter());
  const auto value = effect.fitted.find(parameter);
  const double nonlinear = value == effect.fitted.end() ? 0.0 : value->second;
  const Columns columns = free_columns(regressors, effect, nonlinear);
  const Whitener whitener(present_of(all), belief.noise, belief.left_out);
  Explanation one;
  one.name = name;
  one.fixed = columns.fixed.size() > 0 ? columns.fixed : VectorXd(VectorXd::Zero(columns.of.rows()));
  one.columns = columns.of;
  const VectorXd target = belief.target - one.fixed.head(present);
  const MatrixXd base = belief.columns.topRows(present);
  const Index used = columns_called_for(effect, columns, base, target, whitener);
  const VectorXd sizes =
      sizes_beside(whitener(base), whitener(MatrixXd(columns.of.topRows(present).leftCols(used))), whitener(target));
  one.truth = one.fixed + columns.of.leftCols(used) * sizes;
  if (!parameter.empty() && effect.definition().search.has_slope && !effect.parameters.contains(parameter)) {
    const double change = slope_step(nonlinear);
    const Columns moved = free_columns(regressors, effect, nonlinear + change);
    append(one.columns, (moved.of.leftCols(used) * sizes + moved.fixed - one.truth) / change);
  }
  if (effect.is_user())
    for (const std::size_t i : nonlinear_user_parameters(effect, all.data)) {
      EffectInstance moved = effect;
      const double change = slope_step(start_of(effect.user[i]));
      moved.user[i].start = start_of(effect.user[i]) + change;
      append(one.columns, (free_columns(regressors, moved, 0.0).of * sizes - columns.of * sizes) / change);
    }
  return one;
}

Separations::Separations(const WithProposals& all, const std::vector<MeasurementProposal>& proposals,
                         const Belief& belief, const std::vector<Explanation>& explanations, bool zero_matters)
    : all_(all), proposals_(proposals), zero_matters_(zero_matters) {
  MatrixXd everything = belief.columns;
  base_ = everything.cols();
  for (const Explanation& one : explanations) {
    first_.push_back(everything.cols());
    count_.push_back(one.columns.cols());
    append(everything, one.columns);
    append(everything, one.fixed);
    append(everything, one.truth);
  }
  const NoiseModel noise = with_new_rows(belief, all, proposals);
  std::vector<bool> left_out = belief.left_out;
  left_out.resize(all.data.size(), false);
  const MatrixXd white = Whitener(all.data, noise, left_out)(everything);
  const auto present = static_cast<Index>(all.present);
  present_ = white.topRows(present);
  if (present > white.cols()) present_ = PivotedQr(present_).basis().transpose() * present_;
  white_ = white.bottomRows(white.rows() - present);
  for (std::size_t i = 0; i < proposals.size(); ++i)
    sigma_.push_back(noise.groups[belief.noise.groups.size() + i].sigma());
  present_squares_ = squares(present_, false, true);
}

MatrixXd Separations::squares(const MatrixXd& rows, bool own_zero, bool between) const {
  const auto count = static_cast<Index>(first_.size());
  Space base;
  base.y = VectorXd::Zero(rows.rows());
  base.q.resize(rows.rows(), 0);
  absorb(base, rows.leftCols(base_));
  if (own_zero) absorb(base, rows.rightCols(1));
  MatrixXd result = MatrixXd::Zero(count, count + 1), left(rows.rows(), count);
  for (Index j = between ? 0 : count; j <= count; ++j) {
    Space space = base;
    const bool alone = j == count;
    if (!alone)
      absorb(space, rows.middleCols(first_[static_cast<std::size_t>(j)], count_[static_cast<std::size_t>(j)]));
    for (Index i = 0; i < count; ++i) {
      const auto ii = static_cast<std::size_t>(i);
      left.col(i) = rows.col(first_[ii] + count_[ii] + 1);
      if (!alone) left.col(i) -= rows.col(first_[static_cast<std::size_t>(j)] + count_[static_cast<std::size_t>(j)]);
    }
    result.col(j) = without(space.q, left).colwise().squaredNorm().transpose();
    if (!alone) result(j, j) = 0.0;
  }
  return result;
}

MatrixXd Separations::of(std::size_t proposal, int runs, bool between) const {
  const auto first = static_cast<Index>(all_.first[proposal] - all_.present);
  const auto count = static_cast<Index>(all_.count[proposal]);
  const bool own_zero = proposals_[proposal].own_zero;
  const bool zero = proposals_[proposal].new_set_up || own_zero;
  const Index extra = zero ? 1 : 0;
  // optics that were reset have a zero of their own: free on another line, as good as the mean of ten readings on the
  // same line, where it is set at the same target
  const Index prior = zero && !own_zero && !proposals_[proposal].other_line && !zero_matters_ ? 1 : 0;
  MatrixXd rows = MatrixXd::Zero(present_.rows() + count + prior, white_.cols() + extra);
  rows.topLeftCorner(present_.rows(), white_.cols()) = present_;
  const double weight = std::sqrt(static_cast<double>(runs));
  rows.block(present_.rows(), 0, count, white_.cols()) = weight * white_.middleRows(first, count);
  if (zero) rows.block(present_.rows(), white_.cols(), count, 1).setConstant(weight / sigma_[proposal]);
  constexpr double kReadings = 10.0;  // a choice: that many readings are averaged in effect where a zero is set
  if (prior > 0) rows(rows.rows() - 1, white_.cols()) = std::sqrt(kReadings) / sigma_[proposal];
  return (squares(rows, zero, between) - present_squares_).cwiseMax(0.0).cwiseSqrt();
}

}  // namespace ecs::model
