#include "model/diagnosis/visits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/QR>
#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kFreedoms = 6;  ///< of a rigid body
constexpr std::size_t kFewestPoints = 3, kFewestGroups = 2;
/// Motions that chance makes look as good once in a thousand sets of readings, among all columns that number groups.
constexpr double kByChance = 1e-3;
/// Of the squares at readings left out, at most this share may remain.
constexpr double kMostHeldOut = 0.5;

/// The readings of one group.
struct Visit {
  MatrixXd columns;  ///< (readings × freedoms): what a shift [um] and a turn [um/m] about the centre do to each
  VectorXd off_um;
  std::vector<Vector3> point_mm;  ///< of each reading
};

/// Label of the group of each reading; a grouping is a column with few different values.
using Labels = std::vector<double>;

std::map<std::string, Labels> groupings(const Observations& data) {
  std::map<std::string, Labels> all;
  all["run"] = {data.run.begin(), data.run.end()};
  all["approach"] = {data.approach.begin(), data.approach.end()};
  for (const auto& [name, column] : data.extras) all[name] = column;
  std::erase_if(all, [](const auto& each) {
    const std::set<double> values(each.second.begin(), each.second.end());
    const std::size_t readings = each.second.size();
    return std::ranges::any_of(each.second, [](double one) { return std::isnan(one); }) ||
           values.size() < kFewestGroups || values.size() * kFewestPoints * kAxes > readings;
  });
  return all;
}

/// Whether each point is read in EX, EY and EZ one after the other: of lines that were measured apart, each sense has a
/// zero of its own.
bool are_points(const Observations& data) {
  std::vector<std::size_t> order(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) order[k] = k;
  std::ranges::sort(order, {}, [&](std::size_t k) { return data.file_order[k]; });
  if (order.size() % kAxes != 0) return false;
  for (std::size_t i = 0; i < order.size(); i += kAxes) {
    std::set<Sense> senses;
    for (std::size_t j = i; j < i + kAxes; ++j) {
      if (data.position_mm[order[j]] != data.position_mm[order[i]]) return false;
      senses.insert(data.sense[order[j]]);
    }
    if (senses.size() != kAxes) return false;
  }
  return true;
}

/// Readings less the mean of their point and sense over all groups: an error that belongs to the point is no motion.
/// @return NaN where a point was seen once only
VectorXd off_points(const Observations& data, const VectorXd& residual) {
  std::map<std::pair<Vector3, Sense>, std::pair<double, double>> sums;
  for (std::size_t k = 0; k < data.size(); ++k) {
    auto& [sum, count] = sums[{data.position_mm[k], data.sense[k]}];
    sum += residual(static_cast<Index>(k));
    ++count;
  }
  VectorXd off(residual.size());
  for (std::size_t k = 0; k < data.size(); ++k) {
    const auto& [sum, count] = sums.at({data.position_mm[k], data.sense[k]});
    off(static_cast<Index>(k)) = count > 1.0 ? residual(static_cast<Index>(k)) - sum / count : kNotMeasured;
  }
  return off;
}

std::map<double, Visit> groups_by(const Observations& data, const Labels& labels, const VectorXd& off_um) {
  Vector3 centre_mm{};
  for (const Vector3& position : data.position_mm)
    for (std::size_t i = 0; i < kAxes; ++i) centre_mm[i] += position[i] / static_cast<double>(data.size());
  std::map<double, std::vector<std::size_t>> rows;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!std::isnan(off_um(static_cast<Index>(k)))) rows[labels[k]].push_back(k);
  std::map<double, Visit> groups;
  for (const auto& [label, of_group] : rows) {
    Visit& group = groups[label];
    group.columns = MatrixXd::Zero(static_cast<Index>(of_group.size()), kFreedoms);
    group.off_um.resize(static_cast<Index>(of_group.size()));
    for (Index i = 0; i < group.off_um.size(); ++i) {
      const std::size_t k = of_group[static_cast<std::size_t>(i)];
      const auto along = static_cast<Index>(index_of(direction_of(data.sense[k])));
      const Index next = (along + 1) % 3, last = (along + 2) % 3;  // a turn about one moves the other by its lever
      const auto lever_m = [&](Index axis) {
        const auto a = static_cast<std::size_t>(axis);
        return (data.position_mm[k][a] - centre_mm[a]) / kMmPerM;
      };
      group.columns(i, along) = 1.0;
      group.columns(i, 3 + next) = lever_m(last);
      group.columns(i, 3 + last) = -lever_m(next);
      group.off_um(i) = off_um(static_cast<Index>(k));
      group.point_mm.push_back(data.position_mm[k]);
    }
  }
  return groups;
}

/// Squares at readings that the motion of their group was not fitted to: point by point, or reading by reading.
double held_out_squares(const Visit& group) {
  const std::set<Vector3> points(group.point_mm.begin(), group.point_mm.end());
  const Index n = group.off_um.size();
  double squares = 0.0;
  for (Index out = 0; out < n; ++out) {
    std::vector<Index> kept;
    for (Index i = 0; i < n; ++i) {
      const bool is_out = points.size() > kFewestPoints ? group.point_mm[static_cast<std::size_t>(i)] ==
                                                              group.point_mm[static_cast<std::size_t>(out)]
                                                        : i == out;
      if (!is_out) kept.push_back(i);
    }
    const VectorXd motion =
        Eigen::ColPivHouseholderQR<MatrixXd>(group.columns(kept, Eigen::all)).solve(group.off_um(kept));
    const double off = group.off_um(out) - group.columns.row(out).dot(motion);
    squares += off * off;
  }
  return squares;
}

std::optional<MotionsOfGroups> motions_by(const Observations& data, const std::string& by, const Labels& labels,
                                          const VectorXd& off_um, double chance) {
  const std::map<double, Visit> groups = groups_by(data, labels, off_um);
  if (groups.size() < kFewestGroups) return std::nullopt;
  double before = 0.0, after = 0.0, held_out = 0.0, shifts = 0.0, turns = 0.0;
  Index readings = 0;
  std::set<std::pair<Vector3, Index>> points;
  for (const auto& [label, group] : groups) {
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(group.columns);
    if (group.off_um.size() <= kFreedoms || qr.rank() < kFreedoms) return std::nullopt;
    const VectorXd motion = qr.solve(group.off_um);
    before += group.off_um.squaredNorm();
    after += (group.off_um - group.columns * motion).squaredNorm();
    held_out += held_out_squares(group);
    shifts += motion.head(3).squaredNorm();
    turns += motion.tail(3).squaredNorm();
    readings += group.off_um.size();
    for (Index i = 0; i < group.off_um.size(); ++i) {
      Index along = 0;
      group.columns.row(i).head(3).maxCoeff(&along);
      points.insert({group.point_mm[static_cast<std::size_t>(i)], along});
    }
  }
  const auto count = static_cast<double>(groups.size()), all = static_cast<double>(readings);
  // what the means of the points have taken of a common motion is counted once
  const double freedoms = static_cast<double>(kFreedoms) * (count - 1.0);
  const double left = all - freedoms - static_cast<double>(points.size());
  if (left < 1.0 || held_out > kMostHeldOut * before) return std::nullopt;
  const double F = (before - after) / freedoms / std::max(after / left, kLeastDivisor);
  const double ln_p = ln_f_tail(F, freedoms, left);
  if (ln_p > std::log(chance)) return std::nullopt;
  const auto rms = [](double squares, double of) { return std::sqrt(squares / of); };
  return MotionsOfGroups{by,
                         groups.size(),
                         rms(before, all),
                         rms(after, all),
                         rms(held_out, all),
                         std::exp(ln_p),
                         rms(shifts, 3.0 * count),
                         rms(turns, 3.0 * count)};
}

}  // namespace

std::optional<MotionsOfGroups> motions_of_groups(const Observations& data, const VectorXd& residual) {
  if (data.rotary || data.moved || !data.through_chain.empty() || std::ranges::any_of(data.sense, is_rotation) ||
      !are_points(data))
    return std::nullopt;
  const std::map<std::string, Labels> all = groupings(data);
  const VectorXd off_um = off_points(data, residual);
  std::optional<MotionsOfGroups> best;
  for (const auto& [by, labels] : all) {
    const auto motions = motions_by(data, by, labels, off_um, kByChance / static_cast<double>(all.size()));
    if (motions && (!best || motions->held_out_rms_um < best->held_out_rms_um)) best = motions;
  }
  return best;
}

namespace {

/// Visits come back to a point within this; instruments read its place each time.
constexpr double kSamePoint_mm = 0.1;
/// Of points seen less often than this the noise is the scatter of the points themselves.
constexpr Index kVisits = 2;
/// Of a column of position this share at most differs from visit to visit: the places differ a little.
constexpr double kSameAtVisits = 0.01;

std::array<long long, kAxes> point_of(const Vector3& position_mm) {
  std::array<long long, kAxes> point{};
  for (std::size_t a = 0; a < kAxes; ++a) point[a] = std::llround(position_mm[a] / kSamePoint_mm);
  return point;
}

}  // namespace

bool are_scattered_points(const Observations& data) {
  if (data.rotary || data.moved || !data.through_chain.empty()) return false;
  using Point = std::array<long long, kAxes>;
  std::map<std::pair<Axis, Sense>, std::set<Point>> lines;
  for (std::size_t k = 0; k < data.size(); ++k)
    lines[{data.axis[k], data.sense[k]}].insert(point_of(data.position_mm[k]));
  return std::ranges::all_of(lines, [](const auto& line) {
    std::size_t varied = 0;
    for (std::size_t a = 0; a < kAxes; ++a) {
      std::map<Point, std::set<long long>> along;  // by the other coordinates
      std::set<long long> all;
      for (const Point& point : line.second) {
        Point others = point;
        others[a] = 0;
        along[others].insert(point[a]);
        all.insert(point[a]);
      }
      if (std::ranges::any_of(along, [](const auto& each) { return each.second.size() >= kFewestCurveTargets; }))
        return false;
      varied += all.size() > 1 ? 1U : 0U;
    }
    return varied > 1;
  });
}

namespace {

/// chance_of_points() in the readings of these senses, or of all where these alone do not tell the effect from the
/// others: a turned set-up looks in one sense like a slope.
std::optional<double> chance_in_senses(const Observations& data, const std::vector<bool>& left_out,
                                       const std::set<Sense>& acting, const MatrixXd& others, const MatrixXd& effect,
                                       const VectorXd& target) {
  std::map<std::tuple<Axis, Sense, std::array<long long, kAxes>>, std::vector<Index>> points;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!left_out[k] && acting.contains(data.sense[k]))
      points[{data.axis[k], data.sense[k], point_of(data.position_mm[k])}].push_back(static_cast<Index>(k));
  const auto count = static_cast<Index>(points.size());
  Index readings = 0;
  for (const auto& [point, rows] : points) readings += static_cast<Index>(rows.size());
  if (readings < kVisits * count) return std::nullopt;
  MatrixXd of_others(count, others.cols()), of_both(count, others.cols() + effect.cols());
  VectorXd of_target(count);
  double between_visits = 0.0;
  Index i = 0;
  for (const auto& [point, rows] : points) {
    const double root = std::sqrt(static_cast<double>(rows.size()));
    const MatrixXd own = effect(rows, Eigen::all);
    of_others.row(i) = root * others(rows, Eigen::all).colwise().mean();
    of_both.row(i) << of_others.row(i), root * own.colwise().mean();
    of_target(i++) = root * target(rows).mean();
    between_visits += (own.rowwise() - own.colwise().mean()).squaredNorm();
  }
  if (between_visits > kSameAtVisits * kSameAtVisits * effect.squaredNorm()) return std::nullopt;
  const PivotedQr without(of_others), with(of_both);
  const auto gained = static_cast<double>(with.rank() - without.rank());
  const auto spare = static_cast<double>(count - with.rank());
  const std::set<Sense> all(data.sense.begin(), data.sense.end());
  if (gained < 1.0 && acting != all) return chance_in_senses(data, left_out, all, others, effect, target);
  if (gained < 1.0 || spare < 1.0) return 1.0;
  const double left = (of_target - of_both * with.solve(of_target)).squaredNorm();
  const double before = (of_target - of_others * without.solve(of_target)).squaredNorm();
  return std::exp(ln_f_tail((before - left) / gained / std::max(left / spare, kLeastDivisor), gained, spare));
}

}  // namespace

std::optional<double> chance_of_points(const Observations& data, const std::vector<bool>& left_out,
                                       const MatrixXd& others, const MatrixXd& effect, const VectorXd& target) {
  std::set<Sense> acting;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!left_out[k] && effect.row(static_cast<Index>(k)).squaredNorm() > 0.0) acting.insert(data.sense[k]);
  return chance_in_senses(data, left_out, acting, others, effect, target);
}

std::string words_for(const MotionsOfGroups& motions) {
  const std::string group = motions.by == "run"        ? "visit (run)"
                            : motions.by == "approach" ? "way of approach"
                            : motions.by == "set_up"   ? "set-up"
                                                       : motions.by;
  return fmt::format(
      "Each {} has a rigid motion of its own: all points are displaced together by {:.2g} um and turned by {:.2g} um/m "
      "(rms of a coordinate over {}). These motions reduce the scatter of the points from {:.3g} to {:.3g} um rms, and "
      "to {:.3g} um at readings left out of their fit. No map corrects that: the machine arrives elsewhere, by play or "
      "friction. Repeat with one way of approach.",
      group, motions.shift_um, motions.turn_um_per_m, motions.groups, motions.rms_before_um, motions.rms_after_um,
      motions.held_out_rms_um);
}

}  // namespace ecs::model
