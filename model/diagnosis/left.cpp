// A class is a space of functions: of the direction, times those of the position, times those of a condition. It is
// weighed by the fall of χ² beside the model less its freedom, which is what it would predict of readings left out
// (Mallows 1973). The terms of the formula are chosen one by one (orthogonal matching pursuit, Pati et al. 1993).
#include "model/diagnosis/left.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "model/data/curve_basis.hpp"
#include "model/diagnosis/left_classes.hpp"
#include "model/diagnosis/words.hpp"
#include "model/fit/compare.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/statistics.hpp"
#include "model/regression/user_formula.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Share of what is above noise that a class must predict to be told: a smaller part may be anything.
constexpr double kToldShare = 0.9;
/// Share by which the opposites must fall short of it.
constexpr double kFarApart = 0.15;
/// Spaces are as good as each other within five standard deviations, and this share.
constexpr double kSureChi2 = 25.0, kAsGood = 0.03;
/// Below this much above noise [σ²] nothing is asked.
constexpr double kLeastToAsk = 40.0;

class Questions {
 public:
  explicit Questions(const LeftReadings& of) : r_(of), conditions_(conditions_of(of)) {
    const double readings = static_cast<double>(r_.y.size() - r_.base.cols());
    for (const Condition& condition : conditions_) tried_.push_back(tried(condition, r_.ways));
    // noise is what the richest space leaves, where repeats between which something changes have hidden it
    for (const std::vector<Weight>& weights : tried_) {
      constexpr double kFewest = 20.0, kSure = 3.0;
      const double freedom = readings - weights.back().freedom;
      const double left = (r_.y.squaredNorm() - weights.back().gain) / freedom;
      if (freedom >= kFewest && left < variance_ * (1.0 - kSure * std::sqrt(2.0 / freedom))) variance_ = left;
    }
    whole_ = r_.y.squaredNorm() - readings * variance_;
    for (const std::vector<Weight>& weights : tried_) most_ = std::max(most_, above(best_of(weights)));
  }

  /// None: too little is above noise to ask.
  [[nodiscard]] std::vector<LeftProperty> answers() {
    if (whole_ < kLeastToAsk * variance_) return {};
    std::vector<LeftProperty> list{direction(), position()};
    if (r_.data.rotary) list.push_back(turns());
    add_changes(list);
    add_steps(list);
    return list;
  }
  /// The condition that what is left depends on; null: not told.
  [[nodiscard]] const Condition* told() const { return told_; }

 private:
  /// An answer to a question, and what its space takes above noise.
  struct Option {
    std::string is, words;
    double above = 0.0;
  };
  struct Chosen {
    std::size_t one = 0;
    std::vector<std::size_t> as_well;  ///< as good, and not because they hold it
  };

  [[nodiscard]] double above(const Weight& weight) const { return weight.gain - weight.freedom * variance_; }
  [[nodiscard]] double tolerance() const { return std::max(kSureChi2 * variance_, kAsGood * whole_); }
  /// And what else is left is small, or no more than chance.
  [[nodiscard]] bool is_nearly_all(double above_noise) const {
    constexpr double kSmall = 0.03, kChance = 5.0;
    const double chance = kChance * std::sqrt(2.0 * static_cast<double>(r_.y.size())) * variance_;
    return above_noise >= kToldShare * whole_ && whole_ - above_noise <= kSmall * whole_ + chance;
  }
  /// "opposite in the two directions 3.10 um rms (97 %)"
  [[nodiscard]] std::string evidence(const std::string& words, double above_noise) const {
    return fmt::format("{} {:.2f} {} rms ({:.0f} %)", words,
                       std::sqrt(std::max(0.0, above_noise) / static_cast<double>(r_.y.size())),
                       laser::unit_of(r_.sense), kPercent * std::clamp(above_noise / whole_, 0.0, 1.0));
  }
  [[nodiscard]] std::string with_noise(const std::vector<std::string>& parts) const {
    return fmt::format("{}; noise of {} along {} {:.2f} {}", fmt::join(parts, ", "), name_of(r_.sense),
                       r_.data.letter(r_.axis), std::sqrt(variance_), laser::unit_of(r_.sense));
  }

  /// What a condition takes of `of` with these ways: constant, straight, any function over the position (a free size at
  /// each target where enough readings share them, else a smooth one); a shape on its own.
  [[nodiscard]] Weight weight(const VectorXd& of, const Condition& condition, const MatrixXd& ways,
                              std::size_t over) const {
    if (condition.is_shape) return r_.weight(of, r_.one_cell, condition.functions);
    const MatrixXd columns = times(ways, condition.functions);
    if (over < 2) return r_.weight(of, r_.one_cell, times(legendre(r_.u, 0, static_cast<Index>(over)), columns));
    constexpr double kMostFreedom = 0.6;
    constexpr Index kMostDegrees = 16;
    const Index n = of.size();
    const Cells& targets = condition.targets.empty() ? r_.targets : condition.targets;
    const std::set<std::size_t> different(targets.begin(), targets.end());
    if (static_cast<double>(different.size()) * static_cast<double>(columns.cols()) <=
        kMostFreedom * static_cast<double>(n))
      return r_.weight(of, targets, columns);
    const Index degrees = std::min({kMostDegrees, n / (4 * columns.cols()), r_.distinct_targets * 2 / 3});
    return r_.weight(of, r_.one_cell, times(legendre(r_.u, 0, degrees), columns));
  }
  [[nodiscard]] std::vector<Weight> tried(const Condition& condition, const MatrixXd& ways) const {
    std::vector<Weight> weights;
    for (std::size_t over = 0; over < (condition.is_shape ? 1U : condition.is_flat ? 2U : 3U); ++over)
      weights.push_back(weight(r_.y, condition, ways, over));
    return weights;
  }
  /// The smallest space that is as good as the best.
  [[nodiscard]] const Weight& best_of(const std::vector<Weight>& weights) const {
    double most = -kBeyondAll;
    for (const Weight& weight : weights) most = std::max(most, above(weight));
    return *std::ranges::find_if(weights, [&](const Weight& weight) { return above(weight) >= most - tolerance(); });
  }

  /// @param options  of which at most one is true  @param measure  where several take nearly all
  [[nodiscard]] LeftProperty decided(const char* property, std::vector<Option> options,
                                     const char* measure = "") const {
    std::ranges::stable_sort(options, std::greater{}, &Option::above);
    const Option& best = options.front();
    const double apart = std::max(kSureChi2 * variance_, kFarApart * whole_);
    const bool alone = std::all_of(options.begin() + 1, options.end(),
                                   [&](const Option& other) { return other.above <= best.above - apart; });
    std::vector<std::string> parts;
    for (const Option& option : options) parts.push_back(evidence(option.words, option.above));
    const bool is_all = is_nearly_all(best.above);
    return {property, alone && is_all ? best.is : "", with_noise(parts), is_all && !alone ? measure : ""};
  }
  /// Calls `take` with each condition that may matter.
  template <class Take>
  void each_condition(const Take& take) const {
    for (std::size_t i = 0; i < conditions_.size(); ++i)
      if (!conditions_[i].is_shape && above(best_of(tried_[i])) >= 0.5 * most_) take(conditions_[i]);
  }

  [[nodiscard]] LeftProperty direction() const {
    if (!r_.both_ways)
      return {"direction", "", "only one direction was measured", "Measure every target from both directions."};
    const Cells pairs = r_.in_runs(r_.targets, false);
    const auto option = [&](const char* is, const char* words, const VectorXd& way) {
      double most = above(r_.weight(r_.y, pairs, way));  // whatever changes from run to run
      each_condition([&](const Condition& c) { most = std::max(most, above(best_of(tried(c, way)))); });
      return Option{is, words, most};
    };
    const VectorXd forward = (r_.d.array() > 0.0).cast<double>(), reverse = (r_.d.array() < 0.0).cast<double>();
    return decided(
        "direction",
        {option("even", "the same in both directions", VectorXd::Ones(r_.y.size())),
         option("odd", "opposite in the two directions", r_.d), option("forward", "forward only", forward),
         option("reverse", "reverse only", reverse)},
        "Approach each target from both directions one after the other: here a change over time, temperature "
        "or runs would look the same.");
  }

  [[nodiscard]] LeftProperty position() const {
    const std::string about = r_.data.rotary ? "the angle 0" : "the middle";
    const VectorXd x = r_.p.array() - r_.middle;
    const VectorXd side = x.unaryExpr([&](double from_middle) {
      return std::abs(from_middle) < 0.01 * r_.step ? 0.0 : std::copysign(1.0, from_middle);
    });
    const auto parity = [&](Index first, const VectorXd& sign) {
      double most = -kBeyondAll;
      each_condition([&](const Condition& c) {
        constexpr Index kMostDegrees = 16;
        const MatrixXd columns = times(r_.ways, c.functions);
        const Index degrees = c.is_flat ? 1 : std::min(kMostDegrees, r_.distinct_targets * 2 / 3);
        MatrixXd over = legendre(x / r_.half, first, degrees, 2);
        if (r_.data.rotary) {
          over.resize(x.size(), std::max<Index>(1, degrees / 2));
          for (Index m = 0; m < over.cols(); ++m) over.col(m) = turning(x, static_cast<int>(m + first)).col(first);
        }
        if (c.targets.empty() && 2 * columns.cols() * over.cols() <= x.size())
          most = std::max(most, above(r_.weight(r_.y, r_.one_cell, times(over, columns))));
      });
      if (r_.is_symmetric)
        most = std::max({most, above(r_.weight(r_.y, r_.in_runs(r_.mirrored, true), sign)),
                         above(r_.weight(r_.y, r_.mirrored, times(sign, r_.ways)))});
      return most;
    };
    const VectorXd one = VectorXd::Ones(x.size());
    double constant = above(r_.weight(r_.y, r_.in_runs(r_.one_cell, true), one));
    each_condition([&](const Condition& c) { constant = std::max(constant, above(weight(r_.y, c, r_.ways, 0))); });
    const double even = parity(0, one);
    LeftProperty answer =
        decided("position", {{"odd", "of opposite sign on the two sides of " + about, parity(1, side)},
                             constant >= even - tolerance() ? Option{"constant", "the same everywhere", constant}
                                                            : Option{"even", "symmetric about " + about, even}});
    if (answer.is.empty() && r_.distinct_targets < 8)
      answer.measure = "Measure eight targets or more, as far to either side of the middle.";
    return answer;
  }

  /// Waves of whole turns of the moving axis.
  [[nodiscard]] LeftProperty turns() const {
    constexpr double kFullTurn_deg = 300.0;
    constexpr int kMostWaves = 6;
    if (2.0 * r_.half < kFullTurn_deg) return {"turn", "", "less than a turn was measured", "Measure a whole turn."};
    std::vector<Option> options;
    for (int waves = 1; waves <= kMostWaves; ++waves)
      options.push_back({fmt::format("{}", waves), fmt::format("{} a turn", waves),
                         above(r_.weight(r_.y, r_.one_cell, times(turning(r_.p, waves), r_.ways)))});
    return decided("turn", options);
  }

  /// The smallest space as good as the best of those wanted; nothing where none predicts nearly all.
  template <class Wanted>
  [[nodiscard]] std::optional<Chosen> choose(const Wanted& wanted) const {
    std::vector<std::size_t> considered, good;
    double most = 0.0;
    for (std::size_t i = 0; i < tried_.size(); ++i)
      if (wanted(conditions_[i]) && adds(i)) considered.push_back(i);
    for (const std::size_t i : considered) most = std::max(most, above(best_of(tried_[i])));
    if (!is_nearly_all(most)) return std::nullopt;
    for (const std::size_t i : considered)
      if (above(best_of(tried_[i])) >= most - tolerance()) good.push_back(i);
    Chosen chosen{*std::ranges::min_element(good, {}, [&](std::size_t i) { return best_of(tried_[i]).freedom; }), {}};
    for (const std::size_t i : good)
      if (!conditions_[i].tells_the_same(conditions_[chosen.one]) && !is_contrived(i, chosen.one) &&
          !holds(i, chosen.one))
        chosen.as_well.push_back(i);
    return chosen;
  }
  /// Whether a condition takes more than functions of the position do without it, by more than spaces that are as good
  /// as each other differ. The freedom alone does not decide: a smooth change over long travels has less of it than a
  /// free size at each target, though it changes next to nothing.
  [[nodiscard]] bool adds(std::size_t i) const {
    const Condition& c = conditions_[i];
    if (c.is.empty() || c.is_shape || !c.targets.empty()) return true;
    const Weight& mine = best_of(tried_[i]);
    double same = -kBeyondAll;
    for (std::size_t over = 0; over <= static_cast<std::size_t>(&mine - tried_[i].data()); ++over)
      same = std::max(same, above(tried_.front()[over]));
    return above(mine) > same + tolerance();
  }
  /// A square of one column that does what a straight line of another or a delay does, and no more.
  [[nodiscard]] bool is_contrived(std::size_t bent, std::size_t one) const {
    constexpr double kMore = 0.4;
    const auto is_bent = [](const Condition& c) { return c.property == "growth" && c.functions.cols() == 3; };
    return is_bent(conditions_[bent]) && !is_bent(conditions_[one]) && conditions_[one].property != "session" &&
           above(best_of(tried_[bent])) <= above(best_of(tried_[one])) + kMore * tolerance();
  }
  /// Whether a space takes all that a smaller one does, and so much more could that this is no chance.
  [[nodiscard]] bool holds(std::size_t larger, std::size_t smaller) const {
    // chance that levels at random lie along what does not hold them; less is asked where people chose the levels
    constexpr double kTheSame = 0.98, kFarChi2 = 9.0, kLeastMore = 0.9, kChanceByHand = 0.1, kChance = 0.03;
    const Condition& c = conditions_[smaller];
    const Weight &large = best_of(tried_[larger]), &small = best_of(tried_[smaller]);
    const auto over = static_cast<std::size_t>(&large - tried_[larger].data());
    const double more = (large.freedom - small.freedom) / static_cast<double>(r_.ways.cols() * (over == 0 ? 1 : 2));
    const double missed = std::max(0.0, above(large) - above(small)) + kFarChi2 * variance_;
    const bool is_likely = c.is_shape || c.is.empty() || c.set_by_hand;
    return more >= kLeastMore && std::pow(missed / above(large), 0.5 * more) <= (is_likely ? kChanceByHand : kChance) &&
           weight(small.taken, conditions_[larger], r_.ways, over).gain >= kTheSame * small.taken.squaredNorm();
  }
  [[nodiscard]] static std::string words_of(const Condition& c) {
    if (c.is.empty()) return "the same in all conditions";
    if (c.property == "growth") return "changes with " + c.is;
    if (c.property == "session") return "different in each " + c.is;
    if (c.property == "clock") return "follows " + c.is + " as a delay does";
    return c.is == "workpiece" ? "moves with the set-up" : "turns with " + c.is;
  }

  /// Frame, growth and session; where they show excitation, clock, sign and arithmetic.
  void add_changes(std::vector<LeftProperty>& list) {
    const auto is_change = [](const Condition& c) { return !c.is_shape || c.property == "clock"; };
    const auto change = choose(is_change), any = choose([](const Condition&) { return true; });
    if (change && change->as_well.empty()) told_ = &conditions_[change->one];

    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < tried_.size(); ++i)
      if (is_change(conditions_[i])) order.emplace_back(-above(best_of(tried_[i])), i);
    std::ranges::sort(order);
    std::vector<std::string> parts;
    std::set<std::string> named;
    for (const auto& [less, i] : order)
      if (const std::string words = words_of(conditions_[i]); named.size() < 4 && named.insert(words).second)
        parts.push_back(evidence(words, -less));
    LeftProperty same{"", "", with_noise(parts), ""};
    if (change && !change->as_well.empty()) {
      std::set<std::string> alike{words_of(conditions_[change->one])};
      for (const std::size_t i : change->as_well) alike.insert(words_of(conditions_[i]));
      same.measure = fmt::format("Measure so that these differ: {}.", fmt::join(alike, ", "));
      list.push_back({"excitation", "poor", fmt::format("the readings do not determine: {}", fmt::join(alike, ", ")),
                      same.measure});
    }
    const auto varied = [&](const char* property) {
      return std::ranges::any_of(conditions_,
                                 [&](const Condition& c) { return c.property == property && !c.is.empty(); });
    };
    const auto answer = [&](const char* property, const char* otherwise, const char* measure) {
      LeftProperty one = same;
      one.property = property;
      if (told_ != nullptr && told_->property == property && !told_->is.empty()) {
        one.is = told_->is;
      } else if (!varied(property)) {
        one.because = "no condition was varied that would show it";
        one.measure = measure;
      } else if (told_ != nullptr && told_->property != "clock" && (told_->is.empty() || one.property != "frame")) {
        one.is = otherwise;
      }
      return one;
    };
    const LeftProperty changes[]{
        answer("frame", "machine",
               r_.data.extras.contains("reversed") ? "Measure again with the artefact elsewhere along the axis."
                                                   : "Measure again with the optics set up elsewhere along the axis."),
        answer("growth", "none", "Measure with another load and another feed."),
        answer("session", "none", "Repeat the line in three runs or more.")};
    list.insert(list.begin() + 2, std::begin(changes), std::end(changes));
    const auto sure = std::ranges::find_if(conditions_, &Condition::is_sure);
    const Condition* const shape = sure != conditions_.end()     ? &*sure
                                   : any && any->as_well.empty() ? &conditions_[any->one]
                                                                 : nullptr;
    if (shape != nullptr && shape->is_shape) list.push_back({shape->property, shape->is, shape->says, ""});
  }

  /// Readings in steps so coarse that their rounding, 0.29 of a step, is what is left.
  void add_steps(std::vector<LeftProperty>& list) const {
    constexpr double kCoarse = 2.0, kRounding = 1e-3;
    const std::vector<double> different = distinct({r_.reading.begin(), r_.reading.end()}, 1e-9);
    double step = kBeyondAll;
    for (std::size_t i = 1; i < different.size(); ++i) step = std::min(step, different[i] - different[i - 1]);
    const double rms = rms_of(r_.y);
    if (different.size() >= 3 && step > kCoarse * rms && std::ranges::all_of(different, [&](double v) {
          return std::abs(std::remainder(v - different.front(), step)) < kRounding * step;
        }))
      list.push_back({"instrument", "steps",
                      fmt::format("all readings are multiples of {:.3g}, and the residual is {:.2g} rms", step, rms),
                      ""});
  }

  const LeftReadings& r_;
  std::vector<Condition> conditions_;
  std::vector<std::vector<Weight>> tried_;  ///< of each condition; the last is its richest
  double variance_ = r_.variance, whole_ = 0.0, most_ = 0.0;
  const Condition* told_ = nullptr;
};

/// A term of a formula.
struct Term {
  std::string text;
  VectorXd values;
};

Term product_of(const Term& a, const Term& b) {
  return {a.text.empty() || b.text.empty() ? a.text + b.text : a.text + " * " + b.text,
          a.values.cwiseProduct(b.values)};
}

/// "((load_kg - 200) / 100)", "(y_mm / 140)"
std::string scaled_text(const std::string& column, double middle, double half) {
  constexpr double kNothing = 1e-9;
  if (std::abs(middle) < kNothing * half) return fmt::format("({} / {:.6g})", column, half);
  return fmt::format("(({} {} {:.6g}) / {:.6g})", column, middle < 0.0 ? '+' : '-', std::abs(middle), half);
}

/// Powers and waves over the position, those that what is told of it leaves.
std::vector<Term> terms_of_position(const LeftReadings& r, const std::string& told, bool is_flat) {
  const std::string name(r.data.position_name(r.axis)), scaled = scaled_text(name, r.middle, r.half);
  const VectorXd x = r.p.array() - r.middle;
  std::vector<Term> terms{{"", VectorXd::Ones(x.size())}};
  if (told == "constant") return terms;
  if (told == "odd") terms.clear();
  for (int power = 1; power <= (is_flat ? 1 : 5); ++power)
    if (told.empty() || (told == "odd") == (power % 2 == 1))
      terms.push_back({power == 1 ? scaled : fmt::format("{}^{}", scaled, power),
                       (x / r.half).unaryExpr([power](double part) { return std::pow(part, power); })});
  if (is_flat) return terms;
  constexpr double kTargetsAPeriod = 2.5, kMostPeriods = 40.0, kTurn_deg = 360.0;
  const double travel = r.data.rotary ? kTurn_deg : 2.0 * r.half;  // what turns comes back
  const double most =
      std::min(kMostPeriods, static_cast<double>(r.distinct_targets) / kTargetsAPeriod * travel / (2.0 * r.half));
  const int steps_a_wave = r.data.rotary ? 1 : 4;
  for (int step = steps_a_wave; step <= static_cast<int>(most * steps_a_wave); ++step) {
    const double period = travel * steps_a_wave / step;
    const Eigen::ArrayXd angle = 2.0 * std::numbers::pi / period * x.array();
    const std::string text = fmt::format("(2 * pi * {})", scaled_text(name, r.middle, period));
    if (told != "even") terms.push_back({"sin" + text, angle.sin()});
    if (told != "odd") terms.push_back({"cos" + text, angle.cos()});
  }
  return terms;
}

std::vector<Term> terms_of_direction(const LeftReadings& r, const std::string& told) {
  const Term same{"", VectorXd::Ones(r.y.size())}, opposite{"approach", r.d};
  if (told == "odd") return {opposite};
  if (told == "forward") return {{"(approach > 0)", (r.d.array() > 0.0).cast<double>()}};
  if (told == "reverse") return {{"(approach < 0)", (r.d.array() < 0.0).cast<double>()}};
  return told == "even" || !r.both_ways ? std::vector{same} : std::vector{same, opposite};
}

/// 1, and what is told of the condition: the column from -1 to 1 and its square, or each run on its own.
std::vector<Term> terms_of_condition(const LeftReadings& r, const Condition* told) {
  std::vector<Term> terms{{"", VectorXd::Ones(r.y.size())}};
  if (told == nullptr || told->is.empty()) return terms;
  if (told->property == "session") {
    const auto set_up = r.data.extras.find("set_up");
    const auto number = [&](std::size_t k) { return told->is == "run" ? r.data.run[k] : set_up->second[k]; };
    std::set<double> values;
    for (const std::size_t k : r.rows) values.insert(number(k));
    for (const double value : values)
      terms.push_back({fmt::format("({} == {:.6g})", told->is, value),
                       r.column([&](std::size_t k) { return number(k) == value ? 1.0 : 0.0; })});
  } else if (told->property == "growth") {
    const double since_s = told->is == "time_s" ? r.data.first_since_s : 0.0;  // formulas count from the origin
    const VectorXd column = r.column([&](std::size_t k) { return variable_of(r.data, k, told->is) + since_s; });
    const double from = column.minCoeff(), to = column.maxCoeff();
    const Term once{scaled_text(told->is, 0.5 * (from + to), 0.5 * (to - from)),
                    (2.0 * column.array() - from - to) / (to - from)};
    terms.push_back(once);
    if (told->functions.cols() > 2) terms.push_back(product_of(once, once));
  }
  return terms;
}

/// The terms that take most, one after the other; as few as take nearly all of what four do.
std::vector<Term> best_terms(const LeftReadings& r, std::vector<Term> terms) {
  constexpr std::size_t kMostTerms = 4;
  constexpr double kNew = 1e-3, kNearlyAsWell = 0.92;
  constexpr double kLeastSeen = 0.01;  // mean square of a term at the readings: one that is zero there has any size
  MatrixXd columns(r.y.size(), static_cast<Index>(terms.size()));
  for (std::size_t j = 0; j < terms.size(); ++j) columns.col(static_cast<Index>(j)) = terms[j].values;
  const VectorXd before = columns.colwise().squaredNorm();
  columns = without(r.base, std::move(columns));
  VectorXd y = r.y;
  std::vector<Term> chosen;
  std::vector<double> gained;
  while (chosen.size() < kMostTerms) {
    const VectorXd norm = columns.colwise().squaredNorm(), dot = columns.transpose() * y;
    Index best = -1;
    double most = kSureChi2 * r.variance;
    for (Index j = 0; j < norm.size(); ++j)
      if (norm(j) > kNew * before(j) && before(j) > kLeastSeen * static_cast<double>(y.size()) &&
          dot(j) * dot(j) > most * norm(j)) {
        most = dot(j) * dot(j) / norm(j);
        best = j;
      }
    if (best < 0) break;
    const VectorXd q = columns.col(best).normalized();
    y -= q * q.dot(y);
    columns -= q * (q.transpose() * columns).eval();
    chosen.push_back(terms[static_cast<std::size_t>(best)]);
    gained.push_back(r.y.squaredNorm() - y.squaredNorm());
  }
  if (!gained.empty())
    chosen.resize(static_cast<std::size_t>(
        1 + std::distance(gained.begin(),
                          std::ranges::find_if(gained, [&](double g) { return g >= kNearlyAsWell * gained.back(); }))));
  return chosen;
}

/// Fitted to all readings of the sense beside everything else; nothing where it predicts no better.
std::optional<ProposedFormula> fitted_formula(const LeftReadings& r, const Model& model, const LinearProblem& problem,
                                              const FittedWith& with, const std::vector<Term>& terms) {
  constexpr double kWorthIt = 0.95;
  if (terms.empty()) return std::nullopt;
  ProposedFormula formula;
  EffectInstance& effect = formula.effect;
  effect.id = effect_at(Place::formulas);
  const auto is_taken = [&](const EffectInstance& other) { return other.is_user() && other.name == effect.name; };
  for (int number = 1; effect.name.empty() || std::ranges::any_of(model.effects, is_taken) ||
                       std::ranges::any_of(model.candidates, is_taken);
       ++number)
    effect.name = fmt::format("{} {}", kProposedName, number);
  std::vector<std::string> texts;
  for (std::size_t j = 0; j < terms.size(); ++j) {
    const std::string size = fmt::format("k{}", j + 1);
    texts.push_back(product_of({size, {}}, {terms[j].text, {}}).text);
    effect.user.push_back({size, std::string(laser::unit_of(r.sense)), {}, 1.0, {}, {}});
  }
  effect.formulas = {{r.sense, fmt::format("{}", fmt::join(texts, " + "))}};
  const auto compiled = UserFormulas::compile(effect, r.data);
  if (!compiled) return std::nullopt;
  MatrixXd columns(problem.target.size(), static_cast<Index>(terms.size()));
  for (std::size_t j = 0; j < terms.size(); ++j) {
    std::vector<double> one(terms.size(), 0.0);
    one[j] = 1.0;
    const std::vector<double> values = compiled->values(one);
    for (std::size_t k = 0; k < values.size(); ++k)
      columns(static_cast<Index>(k), static_cast<Index>(j)) = std::isfinite(values[k]) ? values[k] : 0.0;
  }
  const MatrixXd all = beside(problem.columns, columns);
  const Whitener whitener(r.data, with.noise, with.left_out);
  const VectorXd sizes = smallest_sizes(whitener(all), whitener(problem.target));
  formula.rms_after_um = rms_of(problem.target - all * sizes);
  for (std::size_t j = 0; j < terms.size(); ++j)
    effect.user[j].start = sizes(problem.columns.cols() + static_cast<Index>(j));
  const Parts parts = parts_of(r.data);
  const auto held_out = [&](const MatrixXd& of) {
    return held_out_rms(r.data, with.noise, with.left_out, parts, of, problem.target);
  };
  formula.held_out_rms_before_um = held_out(problem.columns);
  formula.held_out_rms_um = held_out(all);
  if (formula.held_out_rms_um > kWorthIt * formula.held_out_rms_before_um) return std::nullopt;
  return formula;
}

}  // namespace

Left what_is_left(const Model& model, const Observations& data, const LinearProblem& problem, const FittedWith& with) {
  const LeftReadings readings(data, problem, with);
  if (readings.rows.empty()) return {};
  Questions questions(readings);
  Left left{questions.answers(), {}};
  const Condition* condition = questions.told();
  if (left.properties.empty() ||
      (condition != nullptr && condition->property != "growth" && condition->property != "session"))
    return left;
  const std::string direction = left.properties[0].is, position = left.properties[1].is;
  std::vector<Term> terms;
  for (const Term& way : terms_of_direction(readings, direction))
    for (const Term& over : terms_of_condition(readings, condition))
      for (const Term& place : terms_of_position(readings, position, condition != nullptr && condition->is_flat))
        terms.push_back(product_of(product_of(way, over), place));
  left.formula = fitted_formula(readings, model, problem, with, best_terms(readings, std::move(terms)));
  if (!left.formula) return left;
  std::vector<std::string> known;
  for (const LeftProperty& one : left.properties)
    if (!one.is.empty() && one.is != "none") known.push_back(one.property + " " + one.is);
  const std::size_t sizes = left.formula->effect.user.size();
  left.formula->why = fmt::format("{} term{}{}", sizes, sizes == 1 ? "" : "s",
                                  known.empty() ? "" : fmt::format(" ({})", fmt::join(known, ", ")));
  return left;
}

std::string beside_formulas(const Model& model, const Diagnosis& diagnosis) {
  for (const EffectInstance& formula : model.effects) {
    if (!formula.is_user() || !formula.name.starts_with(kProposedName)) continue;
    for (const Candidate& candidate : diagnosis.candidates)
      for (const UserFormula& of : formula.formulas)
        if (candidate.in_answer() && candidate.effect.sense == of.sense)
          return fmt::format(
              " The model contains user:{}, which has no known cause: {} may be a part of the same error, which the "
              "formula does not describe completely.",
              formula.name, to_text(candidate.effect));
  }
  return {};
}

}  // namespace ecs::model
