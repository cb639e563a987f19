// Free sizes in every cell are eliminated cell by cell (Frisch and Waugh 1933).
#include "model/diagnosis/left_classes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "model/data/curve_basis.hpp"
#include "model/diagnosis/bad_run.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Fewest and most readings looked at (of more an even choice bounds the time), and most runs told apart: choices.
constexpr std::size_t kFewestOfLeft = 16, kMostOfLeft = 4000, kMostRunsAsked = 40;
/// A column of which less than this square is left beside the others depends on them.
constexpr double kGone = 1e-9;
/// Targets closer than this share of their step are one.
constexpr double kSameTarget = 0.02;

}  // namespace

MatrixXd times(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd products(a.rows(), a.cols() * b.cols());
  for (Index i = 0; i < a.cols(); ++i)
    products.middleCols(i * b.cols(), b.cols()) = b.array().colwise() * a.col(i).array();
  return products;
}

MatrixXd legendre(const VectorXd& u, Index from, Index to, Index step) {
  MatrixXd all = MatrixXd::Ones(u.size(), std::max<Index>(to + 1, 2));
  all.col(1) = u;
  for (Index n = 1; n < to; ++n) {
    const auto m = static_cast<double>(n);
    all.col(n + 1) = ((2.0 * m + 1.0) * u.cwiseProduct(all.col(n)) - m * all.col(n - 1)) / (m + 1.0);
  }
  MatrixXd chosen(u.size(), to < from ? 0 : (to - from) / step + 1);
  for (Index j = 0; j < chosen.cols(); ++j) chosen.col(j) = all.col(from + j * step);
  return chosen;
}

MatrixXd turning(const VectorXd& deg, int waves) {
  const Eigen::ArrayXd angle = waves * deg.array() * (std::numbers::pi / 180.0);
  MatrixXd both(deg.size(), 2);
  both << angle.cos().matrix(), angle.sin().matrix();
  return both;
}

LeftReadings::LeftReadings(const Observations& all, const LinearProblem& problem, const FittedWith& with)
    : data(all), fit(with.fit) {
  std::map<std::pair<Channel, Axis>, std::pair<double, std::vector<std::size_t>>> groups;
  const std::vector<double> sigma = with.noise.sigma_by_row(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (with.left_out[k] || data.on_path(k) || !data.through_chain.empty()) continue;
    auto& [above, of] = groups[{data.channel(k), data.axis[k]}];
    above += std::pow(with.left(static_cast<Index>(k)), 2) - sigma[k] * sigma[k];
    of.push_back(k);
  }
  if (groups.empty()) return;
  const auto& most = std::ranges::max_element(groups, {}, [](const auto& g) { return g.second.first; })->second.second;
  if (most.size() < kFewestOfLeft) return;
  for (const std::size_t i : even_choice(most.size(), std::min(most.size(), kMostOfLeft))) rows.push_back(most[i]);
  axis = data.axis[rows.front()];
  sense = data.sense[rows.front()];
  base = PivotedQr(problem.columns(rows, Eigen::all), kGone).basis();
  y = without(base, VectorXd(problem.target(rows)));
  reading = column([&](std::size_t k) { return data.reading[k]; });
  variance = sigma[rows.front()] * sigma[rows.front()];

  p = column([&](std::size_t k) { return data.position_mm[k][index_of(axis)]; });
  d = column([&](std::size_t k) { return static_cast<double>(data.approach[k]); });
  const double from = p.minCoeff(), to = p.maxCoeff();
  middle = data.rotary ? 0.0 : 0.5 * (from + to);
  half = std::max(0.5 * (to - from), kSamePlace_mm);
  u = (p.array() - 0.5 * (from + to)) / half;
  step = 2.0 * half /
         static_cast<double>(std::max<std::size_t>(distinct({p.begin(), p.end()}, kSamePlace_mm).size(), 2) - 1);
  apart = std::max(kSamePlace_mm, kSameTarget * step);
  one_cell.assign(rows.size(), 0);
  targets = levels(p, apart);
  distinct_targets = static_cast<Index>(std::set<std::size_t>(targets.begin(), targets.end()).size());
  mirrored = levels((p.array() - middle).abs(), 2.0 * apart);
  std::map<std::size_t, std::array<bool, 2>> sides;
  for (std::size_t i = 0; i < rows.size(); ++i) sides[mirrored[i]][p(static_cast<Index>(i)) < middle ? 0 : 1] = true;
  const auto paired = std::ranges::count_if(sides, [](const auto& s) { return s.second[0] && s.second[1]; });
  is_symmetric = sides.size() > 2 && 10 * static_cast<std::size_t>(paired) >= 8 * (sides.size() - 1);
  both_ways = (d.array() > 0.0).count() >= 5 && (d.array() < 0.0).count() >= 5;
  ways = legendre(d, 0, both_ways ? 1 : 0);
}

Weight LeftReadings::weight(const VectorXd& of, const Cells& cells, const MatrixXd& columns) const {
  MatrixXd rest(of.size(), base.cols() + 1);
  rest << base, of;
  std::vector<std::size_t> order(cells.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return cells[k]; });
  Weight weight;
  for (auto from = order.begin(); from != order.end();) {
    const auto to = std::find_if(from, order.end(), [&](std::size_t k) { return cells[k] != cells[*from]; });
    const std::vector<std::size_t> here(from, to);
    MatrixXd block = columns(here, Eigen::all), mine = rest(here, Eigen::all);
    Index taken = 0;
    for (Index j = 0; j < block.cols() && taken < block.rows(); ++j) {
      VectorXd v = block.col(j);
      const double before = v.squaredNorm();
      for (int twice = 0; twice < 2; ++twice)
        v -= block.leftCols(taken) * (block.leftCols(taken).transpose() * v).eval();
      if (v.squaredNorm() <= kGone * before) continue;
      block.col(taken++) = v.normalized();
    }
    mine -= block.leftCols(taken) * (block.leftCols(taken).transpose() * mine).eval();
    rest(here, Eigen::all) = mine;
    weight.freedom += static_cast<double>(taken);
    from = to;
  }
  Space left;
  left.y = rest.col(base.cols());
  left.q.resize(of.size(), 0);
  MatrixXd of_base = rest.leftCols(base.cols());
  for (Index j = 0; j < of_base.cols(); ++j)
    if (of_base.col(j).squaredNorm() < kGone) of_base.col(j).setZero();
  absorb(left, of_base);
  weight.freedom += static_cast<double>(left.q.cols() - base.cols());
  weight.gain = of.squaredNorm() - left.chi2();
  weight.taken = of - left.y;
  return weight;
}

Cells LeftReadings::in_runs(const Cells& cells, bool each_way) const {
  std::map<std::tuple<std::size_t, int, int, long, long, long>, std::size_t> number;
  Cells parts;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Vector3 parked = data.parked_of(rows[i]);
    parts.push_back(number
                        .try_emplace({cells[i], data.run[rows[i]], each_way ? data.approach[rows[i]] : 0,
                                      std::lround(parked[0]), std::lround(parked[1]), std::lround(parked[2])},
                                     number.size())
                        .first->second);
  }
  return parts;
}

Cells LeftReadings::levels(const VectorXd& values, double apart) {
  const std::vector<double> list = distinct({values.begin(), values.end()}, apart);
  Cells cells;
  for (const double v : values)
    cells.push_back(static_cast<std::size_t>(std::ranges::upper_bound(list, v + 0.01 * apart) - list.begin()));
  return cells;
}

namespace {

/// The table, class by class.
class Conditions {
 public:
  explicit Conditions(const LeftReadings& of) : r_(of), data_(of.data), one_(VectorXd::Ones(of.y.size())) {
    list.push_back({"growth", "", one_});
    add_column("load_kg", data_.load_kg, true);
    add_column("feed_mm_min", data_.feed_mm_min, true);
    for (const Axis other : kAllAxes)
      if (other != r_.axis)
        add_values(std::string(data_.position_name(other)),
                   r_.column([&](std::size_t k) { return data_.position_mm[k][index_of(other)]; }), true);
    add_column("time_s", data_.time_s);
    add_column("pressure_hPa", data_.pressure_hPa);
    add_column("humidity_pct", data_.humidity_pct);
    for (const auto& [name, of_sensor] : data_.sensors_degC) add_column(name, of_sensor);
    for (const auto& [name, extra] : data_.extras)
      if (name != "set_up" && name != "reversed") add_column(name, extra);
    add_levels_of("run", r_.column([&](std::size_t k) { return static_cast<double>(data_.run[k]); }));
    add_set_ups();
    for (const Axis a : kAllAxes) add_turns_of(a);
    if (!data_.time_s.empty())
      for (const EffectFit& effect : r_.fit.effects) add_delay_of(effect);
    for (const EffectFit& effect : r_.fit.effects) add_factor_of(effect);
    add_factor_of_run();
    add_factor_of_line();
  }
  std::vector<Condition> list;

 private:
  void add_column(const std::string& name, const Column& column, bool set_by_hand = false) {
    if (!column.empty()) add_values(name, r_.column([&](std::size_t k) { return column[k]; }), set_by_hand);
  }
  /// Its size is a straight line of the values, or has their square too.
  void add_values(const std::string& name, const VectorXd& values, bool set_by_hand) {
    if (!values.allFinite()) return;
    const double from = values.minCoeff(), to = values.maxCoeff();
    if (to - from <= 1e-9 * std::max(1.0, std::abs(to))) return;
    const MatrixXd functions = legendre((2.0 * values.array() - from - to) / (to - from), 0, 2);
    list.push_back({"growth", name, functions.leftCols(2), false, false, {}, {}, set_by_hand});
    if (distinct({values.begin(), values.end()}, 1e-3 * (to - from)).size() > 2)
      list.push_back({"growth", name, functions});
  }
  /// A constant and a slope of its own for each.
  void add_levels_of(const char* name, const VectorXd& numbers) {
    const std::set<double> values(numbers.begin(), numbers.end());
    if (values.size() < 2 || values.size() > kMostRunsAsked) return;
    MatrixXd functions(numbers.size(), static_cast<Index>(values.size()));
    for (Index j = 0; const double value : values) functions.col(j++) = (numbers.array() == value).cast<double>();
    list.push_back({"session", name, functions, true});
  }
  /// A function of the position from the first target of each set-up.
  void add_set_ups() {
    const auto column = data_.extras.find("set_up");
    if (column == data_.extras.end()) return;
    const VectorXd number = r_.column([&](std::size_t k) { return column->second[k]; });
    if (!number.allFinite()) return;
    add_levels_of("set_up", number);
    std::map<double, double> origin;
    VectorXd moved = r_.p;
    for (Index i = 0; i < number.size(); ++i) {
      double& from = origin.try_emplace(number(i), r_.p(i)).first->second;
      from = std::min(from, r_.p(i));
    }
    for (Index i = 0; i < number.size(); ++i) moved(i) -= origin.at(number(i));
    if (moved.maxCoeff() < 2.0 * r_.half - 0.1 * r_.step)
      list.push_back({"frame", "workpiece", one_, false, false, {}, LeftReadings::levels(moved, r_.apart)});
  }
  /// Waves of whole turns of an axis that stood while this one moved.
  void add_turns_of(Axis a) {
    if (data_.pose_deg.empty()) return;
    const VectorXd deg = r_.column([&](std::size_t k) { return data_.pose_deg[k][index_of(a)]; });
    const std::size_t angles = distinct({deg.begin(), deg.end()}, 1e-3).size();
    MatrixXd functions = one_;
    for (int waves = 1; waves <= 3 && 2 * static_cast<std::size_t>(waves) < angles; ++waves)
      functions = beside(functions, turning(deg, waves));
    if (functions.cols() > 1) list.push_back({"frame", fmt::format("axis {}", laser::letter_of(a, true)), functions});
  }

  /// The temperature some time before or after, of an effect of that sensor.
  void add_delay_of(const EffectFit& effect) {
    constexpr int kDelays = 40;
    constexpr double kLongest = 0.2;  // share of the session
    const auto sensor = data_.sensors_degC.find(effect.effect.sensor);
    if (sensor == data_.sensors_degC.end()) return;
    const auto clock_of = [&](std::size_t k) { return data_.history ? data_.history->clock[data_.in_history[k]] : 0; };
    std::map<std::pair<int, double>, double> degC;  // by clock and time
    for (std::size_t k = 0; k < data_.size(); ++k)
      if (std::isfinite(data_.time_s[k] + sensor->second[k])) degC[{clock_of(k), data_.time_s[k]}] = sensor->second[k];
    const VectorXd t = r_.column([&](std::size_t k) { return data_.time_s[k]; });
    if (degC.size() < kFewestOfLeft || !t.allFinite()) return;
    const auto at = [&](int clock, double time_s) {
      const auto after = degC.lower_bound({clock, time_s});
      if (after == degC.begin()) return after->second;
      const auto before = std::prev(after);
      if (after == degC.end() || (after->first.first != clock && before->first.first == clock)) return before->second;
      if (before->first.first != clock) return after->second;
      const double from_s = before->first.second, to_s = after->first.second;
      return std::lerp(before->second, after->second, (time_s - from_s) / (to_s - from_s));
    };
    // what explains most beside the model; and the delay at which the effect alone leaves the least of what is its due
    const VectorXd due = r_.y + r_.column([&](std::size_t k) { return effect.contribution[k]; });
    const MatrixXd over = legendre(r_.u, 0, 1);
    const double session_s = t.maxCoeff() - t.minCoeff();
    MatrixXd best;
    double most = 0.0, least = kBeyondAll, best_s = 0.0;
    for (int i = -kDelays; i <= kDelays; ++i) {
      const double delay_s = kLongest * session_s * i / kDelays;
      const MatrixXd delayed =
          times(over, r_.column([&](std::size_t k) { return at(clock_of(k), data_.time_s[k] - delay_s); }));
      if (const double gain = r_.weight(r_.y, r_.one_cell, delayed).gain; i != 0 && gain > most) {
        most = gain;
        best = delayed;
      }
      if (const double left = ecs::least_squares(beside(over, delayed), due).squares_left; left < least) {
        least = left;
        best_s = delay_s;
      }
    }
    if (best_s != 0.0 && most > 0.0)
      list.push_back({"clock", sensor->first, best, true, true,
                      fmt::format("{} acts {:.0f} s {} than {} shows", to_text(effect.effect), std::abs(best_s),
                                  best_s > 0.0 ? "later" : "earlier", sensor->first)});
  }

  /// The factor between units that this is, 0 for none.
  static double unit_of_factor(double factor, double sigma) {
    for (const double unit : kUnitFactors)
      if (std::abs(factor - unit) < std::max(0.02 * unit, 2.0 * sigma) && sigma < 0.3 * std::abs(1.0 - unit) * unit)
        return unit;
    return 0.0;
  }
  void add_arithmetic(const MatrixXd& shape, double factor, double sigma, const std::string& says) {
    if (const double unit = unit_of_factor(factor, sigma); unit != 0.0)
      list.push_back({"arithmetic", fmt::format("{:.5g}", unit), shape, true, true, says});
  }
  /// A term that the model holds, with a wrong sign or in a wrong unit.
  void add_factor_of(const EffectFit& effect) {
    const VectorXd h = r_.column([&](std::size_t k) { return effect.contribution[k]; });
    const VectorXd alone = without(r_.base, h);
    const double square = alone.squaredNorm();
    if (square <= 0.01 * h.squaredNorm()) return;
    const double factor = 1.0 + alone.dot(r_.y) / square, sigma = std::sqrt(r_.variance / square);
    const std::string says = fmt::format("the readings contain {:.3g} times {}", factor, to_text(effect.effect));
    if (sigma < 0.1 && std::abs(factor + 1.0) < std::max(0.03, 3.0 * sigma))
      list.push_back({"sign", to_text(effect.effect), h, true, true, says});
    else
      add_arithmetic(h, factor, sigma, says);
  }
  /// Readings of one run or line in another unit than the others.
  template <class IsOfGroup>
  void add_factor_of_group(double factor, const std::string& says, const IsOfGroup& is_of_group) {
    const VectorXd of_group = r_.column([&](std::size_t k) { return is_of_group(k) ? data_.reading[k] : 0.0; });
    if (!of_group.isZero())
      list.push_back({"arithmetic", fmt::format("{:.5g}", factor), of_group, true, true, says, {}, false, true});
  }
  void add_factor_of_run() {
    if (const auto scaled = scaled_run(data_))
      add_factor_of_group(scaled->factor, words_for(*scaled, data_.reading_unit()),
                          [&](std::size_t k) { return data_.run[k] == scaled->run; });
  }
  void add_factor_of_line() {
    if (const auto scaled = scaled_line(data_))
      add_factor_of_group(scaled->factor, words_for(*scaled, data_), [&](std::size_t k) {
        return data_.channel(k) == data_.channel(scaled->first) && data_.axis[k] == data_.axis[scaled->first] &&
               data_.line[k] == data_.line[scaled->first];
      });
  }

  const LeftReadings& r_;
  const Observations& data_;
  VectorXd one_;
};

}  // namespace

std::vector<Condition> conditions_of(const LeftReadings& readings) { return Conditions(readings).list; }

}  // namespace ecs::model
