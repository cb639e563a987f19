#include "model/fit/core.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "base/linear/decompositions.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/noise.hpp"
#include "model/fit/search.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kFewValues = 2;  ///< of a searched parameter, where the first will do
constexpr double kNoValue = 1.0;       ///< of a searched parameter that these data give no range
/// A term varies by at most this many times the range of the readings it acts on, else other terms cancel it;
/// directions of unit columns below 1 - 0.995, a correlation of 0.995 between two, are hardly seen (both: the
/// convention of the effect library, docs/physics.md).
constexpr double kMostOfRange = 3.0, kHardlySeen = 0.005;
/// A direction is determined where leaving it out raises χ² by this: five standard deviations, which noise does not do
/// in a million fits. Share of the information along the best seen direction below which a direction is not seen at
/// all.
constexpr double kDetermined = 25.0, kUnseen = 1e-12;
/// Weight in a unit direction from which a column takes part in it.
constexpr double kPartOfDirection = 0.1;
/// Fits that differ by less than this fall of χ² for each value cannot be told apart (three standard deviations of
/// three degrees of freedom, a period and the two sizes of a harmonic): a period is no other one because its double,
/// with a harmonic more, fits noise better.
constexpr double kSameFit = 14.2;
/// A period is half of another where it agrees to a percent.
constexpr double kSamePeriod = 0.01;
/// Readings up to which a fitted value is searched again: the search of one effect takes a few milliseconds there.
constexpr std::size_t kMostSoughtAnew = 4000;

VectorXd readings_of(const Observations& data) {
  return Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size()));
}

/// Least squares by pivoted QR of scaled columns; columns that depend on others get size 0.
Solved solved(const MatrixXd& white, const VectorXd& y, const VectorXd& unwhitened_norms) {
  constexpr double kDependent = 1e-7;
  Solved s;
  const Index k = white.cols();
  s.undetermined.assign(static_cast<std::size_t>(k), false);
  s.collides.assign(static_cast<std::size_t>(k), {});
  s.sizes = VectorXd::Zero(k);
  s.white_residual = y;
  if (k > 0) {
    VectorXd norm = white.colwise().norm();
    for (Index j = 0; j < k; ++j)
      norm(j) = norm(j) <= 1e-12 * std::max(unwhitened_norms(j), 1e-300) ? 0.0 : norm(j) / size_in_order(j);
    MatrixXd scaled = white;
    for (Index j = 0; j < k; ++j) scaled.col(j) *= norm(j) > 0.0 ? 1.0 / norm(j) : 0.0;
    const PivotedQr qr(scaled, kDependent);
    s.rank = qr.rank();
    const VectorXd first = qr.independent_sizes(y);
    for (Index i = 0; i < s.rank; ++i) s.sizes(qr.place(i)) = first(i) / norm(qr.place(i));
    s.condition = qr.condition();
    for (Index i = s.rank; i < k; ++i) {
      const auto column = static_cast<std::size_t>(qr.place(i));
      s.undetermined[column] = true;
      if (s.rank == 0) continue;
      const VectorXd share = qr.share(i);
      for (Index m = 0; m < s.rank; ++m)
        if (std::abs(share(m)) > 0.05) {
          s.collides[column].push_back(qr.place(m));
          s.undetermined[static_cast<std::size_t>(qr.place(m))] = true;
        }
    }
    s.white_residual -= white * s.sizes;
  }
  s.chi2 = s.white_residual.squaredNorm();
  return s;
}

/// A value for a parameter that cannot be sought.
double first_tried(const Observations& motions, const Slot& slot) {
  const TriedValues tried = tried_values(motions, slot.effect, slot.acting, {kFewValues});
  return tried.values.empty() ? kNoValue : tried.values.front();
}

/// How many functions each curve needs, by evidence, the others absorbed; two more than that are kept.
void choose_curve_functions(Assembly& assembly, const Regressors& regressors, const Whitener& whitener) {
  const VectorXd y = readings_of(regressors.data());
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    Slot& slot = assembly.slots[s];
    if (!slot.effect.traits().is_curve || slot.columns.cols() == 0) continue;
    MatrixXd others(y.size(), 0);
    VectorXd rest = y;
    for (std::size_t other = 0; other < assembly.slots.size(); ++other) {
      const Slot& o = assembly.slots[other];
      rest -= o.fixed;
      if (other == s) continue;
      others.conservativeResize(Eigen::NoChange, others.cols() + o.columns.cols());
      others.rightCols(o.columns.cols()) = o.columns;
    }
    const Search search(regressors, whitener, others, rest, {slot.effect});
    if (search.families().empty()) continue;
    const Choice best = search.choice_at(search.base(), 0, 0.0);
    const Columns all = regressors.columns(slot.effect, 0.0, slot.acting);
    const std::size_t wanted = std::min<std::size_t>(static_cast<std::size_t>(all.of.cols()), best.columns.size() + 2);
    slot.used.clear();
    for (std::size_t j = 0; j < wanted; ++j) slot.used.push_back(static_cast<Index>(j));
    assembly.renew(s, regressors);
  }
}

struct FreeNonlinear {
  std::size_t slot = 0, j = 0;
};
std::vector<FreeNonlinear> free_nonlinear(const Assembly& assembly) {
  std::vector<FreeNonlinear> list;
  for (std::size_t s = 0; s < assembly.slots.size(); ++s)
    for (std::size_t j = 0; j < assembly.slots[s].nonlinear.size(); ++j)
      if (assembly.slots[s].nonlinear_free[j] && assembly.slots[s].has_slope()) list.push_back({s, j});
  return list;
}

MatrixXd slopes(Assembly& assembly, const Regressors& regressors, const VectorXd& sizes,
                const std::vector<FreeNonlinear>& free) {
  MatrixXd slope(static_cast<Index>(regressors.data().size()), static_cast<Index>(free.size()));
  for (std::size_t i = 0; i < free.size(); ++i) {
    const VectorXd part =
        sizes.segment(assembly.first_column(free[i].slot), assembly.slots[free[i].slot].columns.cols());
    slope.col(static_cast<Index>(i)) = assembly.slope(free[i].slot, free[i].j, part, regressors);
  }
  return slope;
}

struct Limits {
  double least = -std::numeric_limits<double>::infinity();
  double greatest = std::numeric_limits<double>::infinity();
};

/// Where a fit keeps a nonlinear parameter: beyond, the effect is another one under its name.
Limits limits_of(const Slot& slot, std::size_t j, const Regressors& regressors) {
  if (slot.formulas) {
    const UserParameter& parameter = slot.effect.user[slot.user_nonlinear[j]];
    const Limits all;
    return {parameter.least.value_or(all.least), parameter.greatest.value_or(all.greatest)};
  }
  const SearchDefinition& search = slot.effect.definition().search;
  if (search.either_sign) return {};
  if (search.limits == nullptr || slot.acting.rows.empty()) return {1e-3 * std::abs(slot.nonlinear[j])};
  const ValueRange range = search.limits(regressors.motions(), slot.effect, slot.acting, slot.nonlinear[j]);
  return {range.least, range.greatest};
}

/// Inside the limits. Whether a value has changed.
bool set_nonlinear(Assembly& assembly, const Regressors& regressors, const std::vector<FreeNonlinear>& free,
                   const std::vector<Limits>& limits, const VectorXd& values) {
  bool moved = false;
  for (std::size_t i = 0; i < free.size(); ++i) {
    Slot& slot = assembly.slots[free[i].slot];
    const double value =
        std::clamp(values(static_cast<Index>(i)), limits[i].least, std::max(limits[i].least, limits[i].greatest));
    if (slot.nonlinear[free[i].j] == value) continue;
    slot.nonlinear[free[i].j] = value;
    assembly.renew(free[i].slot, regressors);
    moved = true;
  }
  return moved;
}

/// Difference between the greatest and the least value at some rows.
double range_at(const std::vector<std::size_t>& rows, const VectorXd& values) {
  double least = kBeyondAll, greatest = -kBeyondAll;
  for (const std::size_t k : rows) {
    least = std::min(least, values(static_cast<Index>(k)));
    greatest = std::max(greatest, values(static_cast<Index>(k)));
  }
  return rows.empty() ? 0.0 : greatest - least;
}

/// Whether a term varies by more than kMostOfRange times what the readings do: others cancel it.
bool cancels(const Assembly& assembly, const Observations& data, const VectorXd& sizes) {
  const VectorXd readings = readings_of(data);
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    const Slot& slot = assembly.slots[s];
    if (slot.columns.cols() == 0) continue;
    const VectorXd part = slot.columns * sizes.segment(assembly.first_column(s), slot.columns.cols());
    if (range_at(slot.acting.readings, part) > kMostOfRange * range_at(slot.acting.readings, readings)) return true;
  }
  return false;
}

/// Of columns; 1 for those without entries.
VectorXd lengths_of(const MatrixXd& columns) {
  const VectorXd norm = columns.colwise().norm();
  return (norm.array() > 0.0).select(norm, 1.0);
}

/// The smallest solution where terms cancel each other: directions that the data hardly see are left out one by one
/// (truncated singular value decomposition: Hansen 1987), worst first, until no term exceeds what the readings hold or
/// a direction is one that the readings do determine: there the terms are as large as that.
Solved smallest(const Assembly& assembly, const Observations& data, const MatrixXd& white, const VectorXd& y,
                Solved now) {
  const VectorXd norm = lengths_of(white);
  const MatrixXd scaled = white * norm.cwiseInverse().asDiagonal();
  const Spectrum seen = spectrum_of(scaled.transpose() * scaled);
  const VectorXd right = seen.vectors.transpose() * (scaled.transpose() * y);
  const double freedom = std::max(1.0, static_cast<double>(y.size() - now.rank));
  const double scale = std::max(1.0, now.chi2 / freedom);
  for (Index dropped = 1; dropped < norm.size() && seen.values(dropped - 1) < kHardlySeen; ++dropped) {
    const double rise = right(dropped - 1) * right(dropped - 1) / std::max(seen.values(dropped - 1), kLeastDivisor);
    if (seen.values(dropped - 1) > kUnseen && rise > kDetermined * scale) break;
    const VectorXd direction = seen.vectors.col(dropped - 1);
    for (Index j = 0; j < norm.size(); ++j) {
      if (std::abs(direction(j)) < kPartOfDirection) continue;
      now.undetermined[static_cast<std::size_t>(j)] = true;
      for (Index m = 0; m < norm.size(); ++m)
        if (m != j && std::abs(direction(m)) >= kPartOfDirection)
          now.collides[static_cast<std::size_t>(j)].push_back(m);
    }
    const Index kept = norm.size() - dropped;
    now.sizes = norm.cwiseInverse().asDiagonal() *
                VectorXd(seen.vectors.rightCols(kept) * right.tail(kept).cwiseQuotient(seen.values.tail(kept)));
    now.rank = kept;
    if (!cancels(assembly, data, now.sizes)) break;
  }
  now.white_residual = y - white * now.sizes;
  now.chi2 = now.white_residual.squaredNorm();
  return now;
}

Solved solved_now(const Assembly& assembly, const Observations& data, const Whitener& whitener) {
  const MatrixXd columns = assembly.columns();
  const MatrixXd white = whitener(columns);
  const VectorXd rest = whitener(VectorXd(readings_of(data) - assembly.fixed(data.size())));
  Solved now = solved(white, rest, columns.colwise().norm());
  return cancels(assembly, data, now.sizes) ? smallest(assembly, data, white, rest, std::move(now)) : now;
}

/// Gauss-Newton over nonlinear parameters and sizes together, halved until χ² falls.
Solved refined(Assembly& assembly, const Regressors& regressors, const Whitener& whitener) {
  const Observations& data = regressors.data();
  Solved now = solved_now(assembly, data, whitener);
  const auto free = free_nonlinear(assembly);
  if (free.empty()) return now;
  std::vector<Limits> limits;
  for (const FreeNonlinear& one : free) limits.push_back(limits_of(assembly.slots[one.slot], one.j, regressors));
  for (int round = 0; round < 25; ++round) {
    VectorXd values(static_cast<Index>(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i)
      values(static_cast<Index>(i)) = assembly.slots[free[i].slot].nonlinear[free[i].j];
    const MatrixXd columns = assembly.columns();
    MatrixXd joint(columns.rows(), columns.cols() + values.size());
    joint << columns, slopes(assembly, regressors, now.sizes, free);
    const Solved step = solved(whitener(joint), now.white_residual, joint.colwise().norm());
    const VectorXd change = step.sizes.tail(values.size());
    const double least_progress = 1e-9 * (1.0 + now.chi2);
    bool better = false;
    for (double part = 1.0; part > 0.01 && !better && now.chi2 - step.chi2 > least_progress; part *= 0.4) {
      if (!set_nonlinear(assembly, regressors, free, limits, values + part * change)) continue;
      Solved tried = solved_now(assembly, data, whitener);
      better = tried.chi2 < now.chi2 - least_progress;
      if (better) now = std::move(tried);
    }
    if (!better) {
      set_nonlinear(assembly, regressors, free, limits, values);
      break;
    }
  }
  return now;
}

std::vector<double> first_values(const Assembly& assembly, const std::vector<std::size_t>& slots) {
  std::vector<double> values;
  for (const std::size_t s : slots) values.push_back(assembly.slots[s].nonlinear.front());
  return values;
}

/// Sets the nonlinear parameters of library effects to where they do best together, over their whole ranges: those
/// that have no value yet; where the readings are few enough also those of a former fit, which may be a lesser minimum
/// and is kept where nothing better is found, nor periods that are half of it and fit as well.
void start_nonlinear(Assembly& assembly, const Regressors& regressors, const Whitener& whitener, bool from_values) {
  const Observations& data = regressors.data();
  const VectorXd y = readings_of(data);
  MatrixXd others(y.size(), 0);
  VectorXd rest = y;
  std::vector<EffectInstance> sought;
  std::vector<std::size_t> slots;
  bool all_have_values = true;
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    Slot& slot = assembly.slots[s];
    const bool without_value = !slot.formulas && !slot.nonlinear.empty() && std::isnan(slot.nonlinear.front());
    if (slot.is_sought(regressors.motions()) && (without_value || (!from_values && data.size() <= kMostSoughtAnew))) {
      all_have_values = all_have_values && !without_value;
      sought.push_back(slot.effect);
      slots.push_back(s);
      continue;
    }
    if (without_value) slot.nonlinear.front() = first_tried(regressors.motions(), slot);
    assembly.renew(s, regressors);
    others.conservativeResize(Eigen::NoChange, others.cols() + slot.columns.cols());
    others.rightCols(slot.columns.cols()) = slot.columns;
    rest -= slot.fixed;
  }
  if (sought.empty()) return;
  const Search search(regressors, whitener, others, rest, {}, sought);
  std::vector<double> found;
  for (const Choice& term : search.alone().own) found.push_back(term.nonlinear);
  const auto take = [&](const std::vector<double>& values) {
    for (std::size_t i = 0; i < slots.size(); ++i) {
      assembly.slots[slots[i]].nonlinear.front() = values[i];
      assembly.renew(slots[i], regressors);
    }
  };
  const double former_chi2 = all_have_values ? refined(assembly, regressors, whitener).chi2 : kBeyondAll;
  const std::vector<double> former = first_values(assembly, slots);
  take(found);
  if (!all_have_values) return;
  double margin = 0.0;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const double ratio = found[i] / former[i];
    const bool is_half = sought[i].traits().periodic && std::abs(2.0 * ratio - 1.0) < kSamePeriod;
    if (std::abs(ratio - 1.0) > kSamePeriod) margin += is_half ? -kSameFit : kSameFit;
  }
  if (refined(assembly, regressors, whitener).chi2 > former_chi2 - margin) take(former);
}

MatrixXd covariance_of(Assembly& assembly, const Regressors& regressors, const Whitener& whitener, const Solved& now) {
  const auto free = free_nonlinear(assembly);
  const MatrixXd columns = assembly.columns();
  MatrixXd joint(columns.rows(), columns.cols() + static_cast<Index>(free.size()));
  if (joint.cols() == 0) return joint.transpose() * joint;
  joint << columns, slopes(assembly, regressors, now.sizes, free);
  const MatrixXd white = whitener(joint);
  const VectorXd norm = lengths_of(white);
  const MatrixXd scaled = white * norm.cwiseInverse().asDiagonal();
  // A direction that the data do not see keeps a variance that shows it; left out, it would pass for an exact one.
  const Spectrum directions = spectrum_of(scaled.transpose() * scaled);
  const VectorXd seen = directions.values.cwiseMax(kUnseen * std::max(1.0, directions.values.maxCoeff()));
  const MatrixXd inverse = directions.vectors * seen.cwiseInverse().asDiagonal() * directions.vectors.transpose();
  return norm.cwiseInverse().asDiagonal() * inverse * norm.cwiseInverse().asDiagonal();
}

bool varies(const Observations& data, const std::vector<std::size_t>& rows, Axis a) {
  return std::ranges::any_of(
      rows, [&](std::size_t k) { return std::abs(data.p_mm(k, a) - data.p_mm(rows.front(), a)) > kSamePlace_mm; });
}

/// What smooth axes could show along a path: harmonics of the angle on a circle, smooth functions of the place on a
/// line, and the same with the direction of motion.
void add_smooth_along(const Observations& data, const std::vector<std::size_t>& rows, std::vector<VectorXd>& columns) {
  constexpr std::size_t kHarmonics = 16, kOfDirection = 8;
  const std::size_t had = columns.size();
  const double most = 0.3 * static_cast<double>(rows.size());
  const auto add = [&](const auto& value) {
    if (static_cast<double>(columns.size() - had) >= std::max(2.0, most)) return;
    VectorXd column = VectorXd::Zero(static_cast<Index>(data.size()));
    for (const std::size_t k : rows) column(static_cast<Index>(k)) = value(k);
    columns.push_back(std::move(column));
  };
  const auto d = [&](std::size_t k) { return static_cast<double>(data.approach[k]); };
  add(d);
  if (data.path_of(rows.front()).kind == PathKind::circle) {
    for (std::size_t m = 1; m <= kHarmonics; ++m) {
      const auto angle = [&](std::size_t k) {
        return static_cast<double>(m) * data.along[k] * std::numbers::pi / 180.0;
      };
      add([&](std::size_t k) { return std::cos(angle(k)); });
      add([&](std::size_t k) { return std::sin(angle(k)); });
      if (m > kOfDirection) continue;
      add([&](std::size_t k) { return d(k) * std::cos(angle(k)); });
      add([&](std::size_t k) { return d(k) * std::sin(angle(k)); });
    }
    return;
  }
  std::vector<double> p;
  for (const std::size_t k : rows) p.push_back(data.along[k]);
  const CurveBasis basis(p, kHarmonics);
  if (basis.greatest_mm() <= basis.least_mm()) return;
  add([&](std::size_t k) { return (data.along[k] - basis.centre_mm()) / basis.half_width_mm(); });
  for (std::size_t f = 0; f < basis.size(); ++f) {
    add([&](std::size_t k) { return basis.value(f, data.along[k]); });
    if (f < kOfDirection) add([&](std::size_t k) { return d(k) * basis.value(f, data.along[k]); });
  }
}

}  // namespace

MatrixXd smooth_columns(const Observations& data) {
  std::vector<VectorXd> columns;
  const auto n = static_cast<Index>(data.size());
  for (const Sense sense : {Sense::EX, Sense::EY, Sense::EZ, Sense::EA, Sense::EB, Sense::EC}) {
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.sense[k] == sense && !data.on_path(k)) rows.push_back(k);
    if (rows.empty()) continue;
    const double most = 0.3 * static_cast<double>(rows.size());
    const std::size_t had = columns.size();
    const auto add = [&](const auto& value) {
      if (static_cast<double>(columns.size() - had) >= std::max(2.0, most)) return;
      VectorXd column = VectorXd::Zero(n);
      for (const std::size_t k : rows) column(static_cast<Index>(k)) = value(k);
      columns.push_back(std::move(column));
    };
    add([](std::size_t) { return 1.0; });
    std::array<Axis, kAxes> axes = kAllAxes;  // those that move first: there is room for this many only
    std::stable_partition(axes.begin(), axes.end(), [&](Axis a) {
      return std::ranges::any_of(rows, [&](std::size_t k) { return data.axis[k] == a; });
    });
    for (const Axis a : axes) {
      std::vector<double> p;
      for (const std::size_t k : rows) p.push_back(data.p_mm(k, a));
      const CurveBasis basis(p, 16);
      if (basis.greatest_mm() <= basis.least_mm()) continue;
      add([&](std::size_t k) { return (data.p_mm(k, a) - basis.centre_mm()) / basis.half_width_mm(); });
      const auto d = [&](std::size_t k) { return data.axis[k] == a ? static_cast<double>(data.approach[k]) : 0.0; };
      add(d);
      for (std::size_t f = 0; f < basis.size(); ++f) {
        add([&](std::size_t k) { return basis.value(f, data.p_mm(k, a)); });
        if (f < 8) add([&](std::size_t k) { return d(k) * basis.value(f, data.p_mm(k, a)); });
      }
    }
    using Axes = std::pair<Axis, Axis>;
    for (const Axes& both : {Axes{Axis::X, Axis::Y}, Axes{Axis::X, Axis::Z}, Axes{Axis::Y, Axis::Z}})
      if (varies(data, rows, both.first) && varies(data, rows, both.second))
        add([&](std::size_t k) { return data.p_mm(k, both.first) * data.p_mm(k, both.second); });
  }
  for (std::size_t path = 1; path <= data.paths.size(); ++path) {
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.path[k] == path) rows.push_back(k);
    if (!rows.empty()) add_smooth_along(data, rows, columns);
  }
  MatrixXd matrix(n, static_cast<Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) {
    matrix.col(static_cast<Index>(j)) = columns[j];
    columns[j].resize(0);  // large sets have room for one of both
  }
  return matrix;
}

namespace {

/// Holds coefficients that the readings determine outside their physical range at its limit: beyond, the effect is
/// another one (active set: Nocedal and Wright 2006, 16.5). Whether there was one.
bool hold_at_limits(Assembly& assembly, const Regressors& regressors, const Solved& now) {
  std::vector<std::size_t> changed;
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    Slot& slot = assembly.slots[s];
    if (slot.formulas || slot.effect.traits().is_curve) continue;
    const std::size_t had = slot.at_limit.size();
    for (std::size_t i = 0; i < slot.used.size(); ++i) {
      const auto range = slot.effect.definition().coefficient_range(static_cast<std::size_t>(slot.used[i]));
      const Index column = assembly.first_column(s) + static_cast<Index>(i);
      if (!range || now.undetermined[static_cast<std::size_t>(column)]) continue;
      const double limit = std::clamp(now.sizes(column), range->least, range->greatest);
      if (limit != now.sizes(column)) slot.at_limit[slot.used[i]] = limit;
    }
    if (slot.at_limit.size() > had) changed.push_back(s);
  }
  for (const std::size_t s : changed) assembly.renew(s, regressors);
  return !changed.empty();
}

void release_limits(Assembly& assembly, const Regressors& regressors) {
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    if (assembly.slots[s].at_limit.empty()) continue;
    assembly.slots[s].at_limit.clear();
    assembly.renew(s, regressors);
  }
}

Solved refined_in_ranges(Assembly& assembly, const Regressors& regressors, const Whitener& whitener) {
  release_limits(assembly, regressors);
  Solved now = refined(assembly, regressors, whitener);
  while (hold_at_limits(assembly, regressors, now)) now = refined(assembly, regressors, whitener);
  return now;
}

}  // namespace

CoreFit fitted(Assembly& assembly, const Regressors& regressors, const CoreOptions& options) {
  const Observations& data = regressors.data();
  const VectorXd y = readings_of(data);
  CoreFit core;
  core.left_out.assign(data.size(), false);
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    Slot& slot = assembly.slots[s];
    if (slot.nonlinear.empty() || !std::isnan(slot.nonlinear.front())) assembly.renew(s, regressors);
    if (slot.fixed.size() == 0) {  // until its nonlinear parameter is found it contributes nothing
      slot.fixed = VectorXd::Zero(y.size());
      slot.columns.resize(y.size(), 0);
    }
  }
  std::optional<MatrixXd> made;
  const SmoothColumns smooth = [&]() -> const MatrixXd& {
    if (!made) made = smooth_columns(data);
    return *made;
  };
  VectorXd residual = y - assembly.fixed(data.size());
  MatrixXd columns;  // fitted in the round before
  Solved now;
  if (!options.plain && options.beside == nullptr) {  // no period or place is sought in outliers
    const MatrixXd linear = assembly.columns();
    core.left_out = rows_left_out(
        data, linear.cols() > 0 ? VectorXd(residual - linear * least_squares(linear, residual).sizes) : residual);
  }
  for (int round = 0; round < 4; ++round) {
    if (options.beside != nullptr) {
      core.noise = options.beside->noise;
      core.left_out = options.beside->left_out;
    } else {
      core.noise = options.plain ? plain_noise(data, 1.0) : noise_of(data, residual, smooth, core.left_out, columns);
    }
    const Whitener whitener(data, core.noise, core.left_out);
    if (round == 0) start_nonlinear(assembly, regressors, whitener, options.from_values);
    if (round == 0 && !options.all_curve_functions && !options.plain)
      choose_curve_functions(assembly, regressors, whitener);
    now = refined_in_ranges(assembly, regressors, whitener);
    residual = y - assembly.fixed(data.size());
    columns = assembly.columns();
    if (columns.cols() > 0) residual -= columns * now.sizes;
    if (options.plain || options.beside != nullptr) break;
    const std::vector<bool> outliers = rows_left_out(data, residual);
    if (outliers == core.left_out && round > 0) break;
    core.left_out = outliers;
  }
  if (options.beside != nullptr) {
    core.residual = residual;
    static_cast<Solved&>(core) = std::move(now);
    return core;
  }
  const std::size_t searched = free_nonlinear(assembly).size();
  const double freedom =
      std::max(1.0, static_cast<double>(data.size()) - static_cast<double>(now.rank) - static_cast<double>(searched));
  if (options.plain) {
    core.noise = plain_noise(data, std::max(std::sqrt(now.chi2 / freedom), 1e-9));
    const PureError pure = noise_of(data, residual, smooth, core.left_out, columns).pure;
    core.noise.pure.noise_um = pure.noise_um;
    core.noise.pure.by_unit = pure.by_unit;
  }
  const Whitener whitener(data, core.noise, core.left_out);
  if (options.plain) now = refined_in_ranges(assembly, regressors, whitener);
  core.covariance = covariance_of(assembly, regressors, whitener, now) * std::max(1.0, now.chi2 / freedom);
  core.residual = residual;
  static_cast<Solved&>(core) = std::move(now);
  return core;
}

}  // namespace ecs::model
