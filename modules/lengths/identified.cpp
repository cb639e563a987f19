// What the unknowns of a test by lengths mean, in words and numbers; what lengths lack to determine a component, from
// levers and directions that do not change.

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/units.hpp"
#include "model/fit/statistics.hpp"
#include "modules/lengths/fitted_lengths.hpp"
#include "modules/lengths/identify.hpp"

namespace ecs::model {
namespace {

constexpr double kLooks = 0.05;        ///< cosine from which a length sees a direction
constexpr double kSameLever_mm = 1.0;  ///< levers closer than this are one

/// Readings of set-ups in which the axis moves.
std::vector<std::size_t> while_moving(const LengthTest& test, Axis axis) {
  const std::size_t a = index_of(axis);
  std::vector<std::set<double>> places(test.set_ups.size());
  for (const LengthReading& r : test.readings) places[r.set_up].insert(r.position_mm[a]);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < test.readings.size(); ++i)
    if (places[test.readings[i].set_up].size() > 1) out.push_back(i);
  return out;
}

std::string letters_in(const std::vector<Component>& components) {
  std::vector<std::string> names;
  for (const Component c : components) names.emplace_back(name_of(c));
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::string what_is_missing(Component component, const LengthTest& test, const MachineCurves& curves,
                            const Eigen::MatrixXd& direction, const std::vector<Component>& together_with) {
  const std::string name(name_of(component));
  const auto looks = [&](std::size_t i, Axis d) {
    return std::abs(direction(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(index_of(d)))) > kLooks;
  };
  if (is_squareness(component)) {
    for (const Term& term : curves.terms())
      if (term.component == component)
        return has_points(test)
                   ? fmt::format(
                         "{0} is not determined: no placement has both deviations along {1} at several {2} and "
                         "deviations along {2} at several {1}: add such points",
                         name, letter_of(term.observed), letter_of(term.lever))
                   : fmt::format(
                         "{} is not determined: no length is inclined in the plane {}{}: add diagonals of that face",
                         name, letter_of(term.observed), letter_of(term.lever));
    return name + " is not determined";
  }
  const Axis axis = moving_axis(component);
  const auto moving = while_moving(test, axis);
  if (moving.empty())
    return fmt::format("{} is not determined: {} is at one position in every set-up: add {} while {} moves", name,
                       letter_of(axis), has_points(test) ? "points" : "lengths", letter_of(axis));
  std::set<double> places;
  for (const std::size_t i : moving) places.insert(test.readings[i].position_mm[index_of(axis)]);
  const auto needed = static_cast<std::size_t>(curves.block(component).even) + 1;
  if (places.size() < needed)
    return fmt::format(
        "{} is not determined: {} positions of {} for a curve that needs {}: add targets, or use a larger knot spacing",
        name, places.size(), letter_of(axis), needed);
  std::vector<std::string> lacks;
  bool some_lever_changes = false;
  for (const Term& term : curves.terms()) {
    if (term.component != component) continue;
    const char seen = letter_of(term.observed);
    std::set<long long> levers;
    double lever_mm = 0.0;
    bool looked = false;
    for (const std::size_t i : moving) {
      if (!looks(i, term.observed)) continue;
      looked = true;
      lever_mm = curves.lever_mm(term, test.readings[i].position_mm, test.tools[test.readings[i].tool].offset_mm);
      levers.insert(std::llround(lever_mm / kSameLever_mm));
    }
    const std::string no_look =
        has_points(test)
            ? fmt::format("no deviation along {} is given while {} moves: measure it", seen, letter_of(axis))
            : fmt::format(
                  "no length looks along {} while {} moves: add a diagonal inclined to {}, or lengths from a station",
                  seen, letter_of(axis), seen);
    if (!looked) {
      lacks.push_back(no_look);
    } else if (term.has_lever && levers.size() < 2) {
      const char lever = letter_of(term.lever);
      lacks.push_back(term.uses_coordinate
                          ? fmt::format("every {} along {} while {} moves has the same {} and tool (lever {:.0f} mm): "
                                        "add {} at another {} or with another tool",
                                        has_points(test) ? "deviation" : "length that looks", seen, letter_of(axis),
                                        lever, lever_mm, has_points(test) ? "points" : "lines", lever)
                          : fmt::format("only a tool offset along {} levers it into {}, and every length has the same "
                                        "({:.0f} mm): add a second tool length",
                                        lever, seen, lever_mm));
    } else {
      some_lever_changes = true;
    }
  }
  std::ranges::sort(lacks);
  lacks.erase(std::unique(lacks.begin(), lacks.end()), lacks.end());
  std::string text = name + " is not determined";
  if (!some_lever_changes && !lacks.empty()) return fmt::format("{}: {}", text, fmt::join(lacks, "; "));
  if (!together_with.empty())
    text += fmt::format(": these {} determine it only together with {}", has_points(test) ? "points" : "lengths",
                        letters_in(together_with));
  text += has_points(test) ? ": add points at other offsets, placements in other planes or a tool of another length"
                           : ": add lines at other offsets, in other directions or with a tool of another length";
  return text;
}

namespace {

constexpr double kPartner = 0.05;  ///< share of a combination from which a component is named
/// Standard uncertainty [um, um/m] that is as good as not determined: poses a micrometre off their sphere or plane show
/// what they should not, so little that it is uncertain by millimetres.
constexpr double kAsGoodAsNothing = 1000.0;
constexpr double kLeastRepeats = 10.0;
constexpr double kOfForm = 2.0;             ///< coverage factor of form finer than the knots
constexpr double kStationByTape_mm = 10.0;  ///< a station farther off than this was not measured, or typed wrongly

class LengthReport {
 public:
  explicit LengthReport(const FittedLengths& fitted) : fitted_(fitted), covariance_(fitted.certainty.covariance()) {
    for (std::size_t c = 0; c < kComponents; ++c) largest_u_[c] = largest_u(static_cast<Component>(c));
  }

  void fill(Identification& out) const {
    for (std::size_t c = 0; c < kCurves; ++c) out.curves.push_back(curve_of_component(static_cast<Component>(c)));
    for (const Component c : {Component::C0Y, Component::B0Z, Component::A0Z}) out.squareness.push_back(square_of(c));
    out.outliers = fitted_.outliers;
    out.readings = fitted_.test.readings.size();
    out.unknowns = fitted_.solution.rank;
    out.degrees_of_freedom = fitted_.degrees_of_freedom;
    out.known_values = out.degrees_of_freedom + out.unknowns - static_cast<int>(out.readings);
    const auto deviation = [&](Scatter scatter) { return std::sqrt(fitted_.variances[index_of(scatter)]); };
    out.white_um = deviation(Scatter::reading);
    out.stop_um = deviation(Scatter::stop);
    out.stop_um_per_m = deviation(Scatter::stop_angle);
    out.pass_um = deviation(Scatter::pass);
    out.pass_um_per_m = deviation(Scatter::pass_angle);
    out.residual_um = fitted_.single_um;
    out.repeat_um = repeats_of(fitted_.test);
    report_set_ups(out);
    report_stations(out);
    report_jumps(out);
    if (out.whole()) {
      const Eigen::MatrixXd weight =
          volume_weight(fitted_.curves, {fitted_.test.tools.front().offset_mm}, kVolumePlaces);
      const auto m = fitted_.curves.size();
      const double noise = std::sqrt(std::max(0.0, (weight * covariance_.topLeftCorner(m, m)).trace()));
      const double k = coverage_factor(fitted_.certainty.degrees_of_freedom(weight, 0));
      const double finer = fitted_.finer.volume_um.value_or(0.0);
      out.volume_um = std::hypot(noise, finer);
      out.volume_U_um = std::hypot(k * noise, kOfForm * finer);
    }
    compare_repeats(out);
  }

 private:
  /// Standard uncertainty of a component where it is greatest.
  [[nodiscard]] double largest_u(Component component) const {
    const auto& block = fitted_.curves.block(component);
    if (block.size() == 0) return 0.0;
    const Eigen::MatrixXd own = covariance_.block(block.first, block.first, block.size(), block.size());
    if (is_squareness(component)) return std::sqrt(own(0, 0));
    double most = 0.0;
    const auto& [low, high] = fitted_.curves.machine().travel_mm[index_of(moving_axis(component))];
    for (const double p : {low, 0.5 * (low + high), high}) {
      const Eigen::VectorXd row = fitted_.curves.value_row(component, p, 1);
      most = std::max(most, row.dot(own * row));
    }
    return std::sqrt(most);
  }

  /// Components in the combinations that are free together with this one.
  [[nodiscard]] std::vector<Component> together_with(Component component) const {
    const auto& own = fitted_.curves.block(component);
    const Eigen::MatrixXd weights =
        fitted_.solution.free.middleRows(own.first, own.size()) * fitted_.solution.free.transpose();
    std::vector<Component> out;
    for (std::size_t c = 0; c < kComponents; ++c) {
      const auto& other = fitted_.curves.block(static_cast<Component>(c));
      if (other.size() == 0 || static_cast<Component>(c) == component) continue;
      const bool both_faint = largest_u_[index_of(component)] > kAsGoodAsNothing && largest_u_[c] > kAsGoodAsNothing;
      if (both_faint || weights.middleCols(other.first, other.size()).norm() > kPartner * weights.norm())
        out.push_back(static_cast<Component>(c));
    }
    return out;
  }

  IdentifiedCurve curve_of_component(Component component) const {
    IdentifiedCurve out;
    out.component = component;
    const auto& block = fitted_.curves.block(component);
    out.acts = fitted_.curves.acts(component);
    if (!out.acts || block.size() == 0) return out;
    out.position_mm = reported_mm(fitted_.curves, moving_axis(component));
    const auto points = static_cast<Eigen::Index>(out.position_mm.size());
    out.u_finer = fitted_.finer.u[index_of(component)].value_or(0.0);
    const Eigen::MatrixXd own = covariance_.block(block.first, block.first, block.size(), block.size());
    Eigen::MatrixXd rows(points, block.size()), squares = Eigen::MatrixXd::Zero(block.size(), block.size());
    out.determined = largest_u_[index_of(component)] <= kAsGoodAsNothing;
    for (Eigen::Index i = 0; i < points; ++i) {
      const double p = out.position_mm[static_cast<std::size_t>(i)];
      rows.row(i) = fitted_.curves.value_row(component, p, 0).transpose();
      for (const int side : {1, -1}) {
        const Eigen::VectorXd row = fitted_.curves.value_row(component, p, side);
        if (is_free(fitted_.solution, row, block.first)) out.determined = false;
        const double value = row.dot(fitted_.solution.x.segment(block.first, block.size()));
        const double noise = std::sqrt(std::max(0.0, row.dot(own * row)));
        (side > 0 ? out.forward : out.reverse).push_back(value);
        const double k = coverage_factor(fitted_.certainty.degrees_of_freedom(row, block.first));
        (side > 0 ? out.u_forward : out.u_reverse).push_back(std::hypot(noise, out.u_finer));
        (side > 0 ? out.U_forward : out.U_reverse).push_back(std::hypot(k * noise, kOfForm * out.u_finer));
        squares += row * row.transpose();
      }
    }
    if (!out.determined) {
      out.why_not =
          what_is_missing(component, fitted_.test, fitted_.curves, fitted_.linear.direction, together_with(component));
      for (auto* list : {&out.forward, &out.reverse, &out.u_forward, &out.u_reverse, &out.U_forward, &out.U_reverse})
        list->clear();
      return out;
    }
    out.degrees_of_freedom = freedom_of(squares, block.first);
    state_for_map(
        out, rows * own * rows.transpose() + out.u_finer * out.u_finer * Eigen::MatrixXd::Identity(points, points));
    return out;
  }

  /// Of a mean variance: never more than the readings leave.
  [[nodiscard]] double freedom_of(const Eigen::MatrixXd& weights, Eigen::Index first) const {
    return std::min(fitted_.certainty.degrees_of_freedom(weights, first),
                    static_cast<double>(fitted_.degrees_of_freedom));
  }

  /// Two numbers for the header of a map, which counts errors from the reference: what lies between neighbours, and
  /// what is common to the table.
  static void state_for_map(IdentifiedCurve& out, const Eigen::MatrixXd& covariance) {
    const auto n = covariance.rows();
    double second = 0.0;
    for (Eigen::Index i = 0; i + 2 < n; ++i) {
      Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
      d(i) = d(i + 2) = 1.0;
      d(i + 1) = -2.0;
      second += d.dot(covariance * d);
    }
    constexpr double kOfNoise = 6.0;  // variance of a second difference of unit noise
    const double value2 = second / kOfNoise / std::max<double>(1.0, static_cast<double>(n - 2));
    double mean2 = 0.0;
    for (std::size_t i = 0; i < out.u_forward.size(); ++i)
      mean2 += 0.5 * (out.u_forward[i] * out.u_forward[i] + out.u_reverse[i] * out.u_reverse[i]);
    mean2 /= static_cast<double>(out.u_forward.size());
    out.value = std::sqrt(std::min(value2, 0.5 * mean2));
    // from the reference the shapes of a pass differ by about √2 of their own size (volume/curve_covariance.hpp)
    out.pass = std::sqrt(std::max(0.0, 0.5 * mean2 - out.value * out.value));
  }

  IdentifiedSquareness square_of(Component component) const {
    IdentifiedSquareness out;
    out.component = component;
    const auto& block = fitted_.curves.block(component);
    out.acts = fitted_.curves.acts(component);
    if (!out.acts || block.size() == 0) return out;
    out.determined = largest_u_[index_of(component)] <= kAsGoodAsNothing &&
                     !is_free(fitted_.solution, Eigen::VectorXd::Ones(1), block.first);
    if (!out.determined) {
      out.why_not =
          what_is_missing(component, fitted_.test, fitted_.curves, fitted_.linear.direction, together_with(component));
      return out;
    }
    out.um_per_m = fitted_.solution.x(block.first);
    const double noise = std::sqrt(covariance_(block.first, block.first));
    const double finer = fitted_.finer.u[index_of(component)].value_or(0.0);
    out.u_um_per_m = std::hypot(noise, finer);
    out.degrees_of_freedom = freedom_of(Eigen::MatrixXd::Ones(1, 1), block.first);
    out.U_um_per_m = std::hypot(coverage_factor(out.degrees_of_freedom) * noise, kOfForm * finer);
    return out;
  }

  void report_set_ups(Identification& out) const {
    for (std::size_t s = 0; s < fitted_.test.set_ups.size(); ++s) {
      IdentifiedSetUp one;
      one.name = fitted_.test.set_ups[s].name;
      double squares = 0.0;
      bool first = true;
      for (std::size_t i = 0; i < fitted_.test.readings.size(); ++i) {
        const LengthReading& r = fitted_.test.readings[i];
        if (r.set_up != s) continue;
        ++one.readings;
        squares += std::pow(fitted_.residual_um(static_cast<Eigen::Index>(i)), 2);
        if (!std::exchange(first, false)) continue;
        const auto station = fitted_.nuisance.station.find({r.set_up, r.tool});
        if (station != fitted_.nuisance.station.end())
          for (std::size_t a = 0; a < kAxes; ++a)
            one.station_correction_mm[a] =
                fitted_.solution.x(station->second + static_cast<Eigen::Index>(a)) / kUmPerMm;
      }
      if (const auto turn = fitted_.nuisance.rotation.find(s); turn != fitted_.nuisance.rotation.end()) {
        const Eigen::Vector3d um_per_m = fitted_.solution.x.segment(turn->second, 3);
        one.turned_um_per_m = Vector3{um_per_m(0), um_per_m(1), um_per_m(2)};
      }
      if (one.readings > 0) one.rms_um = std::sqrt(squares / static_cast<double>(one.readings));
      out.set_ups.push_back(one);
    }
  }

  /// Stations that lie far from where the file puts them.
  void report_stations(Identification& out) const {
    for (const auto& [of, first] : fitted_.nuisance.station) {
      if (has_points(fitted_.test)) break;  // an artefact lies as it lies
      const Eigen::Vector3d off_mm = fitted_.solution.x.segment(first, 3) / kUmPerMm;
      if (off_mm.norm() <= kStationByTape_mm) continue;
      out.notes.push_back(
          fmt::format("set-up {}, tool {}: the station lies {:.1f} mm from its position in the file (by {:+.1f}, "
                      "{:+.1f}, {:+.1f} mm); a tape measure locates it within {:g} mm. Check its coordinates (# "
                      "set_up) and the offset of the tool (# tool)",
                      fitted_.test.set_ups[of.first].name, fitted_.test.tools[of.second].name, off_mm.norm(), off_mm(0),
                      off_mm(1), off_mm(2), kStationByTape_mm));
    }
    if (fitted_.misplaced) {
      const MisplacedStation& one = *fitted_.misplaced;
      const double far_mm = std::hypot(one.off_mm[0], one.off_mm[1], one.off_mm[2]);
      if (far_mm <= kStationByTape_mm) return;
      out.notes.push_back(fmt::format(
          "set-up {}: the lengths start {:.0f} mm from the position in the file (U = {:.0f}; by {:+.0f}, {:+.0f}, "
          "{:+.0f} mm): the error of the directions falsifies every component. Correct its coordinates (# set_up)",
          fitted_.test.set_ups[one.set_up].name, far_mm, 2.0 * one.u_mm, one.off_mm[0], one.off_mm[1], one.off_mm[2]));
    }
  }

  /// Zeros that were taken again within a run, with the change of the zero.
  void report_jumps(Identification& out) const {
    for (const ZeroJump& jump : fitted_.jumps) {
      const auto zero = [&](int run) { return fitted_.nuisance.zero.find({jump.set_up, run, jump.tool}); };
      if (zero(jump.run) == fitted_.nuisance.zero.end() || zero(jump.run_after) == fitted_.nuisance.zero.end())
        continue;
      const auto before = zero(jump.run)->second, after = zero(jump.run_after)->second;
      const double um = fitted_.solution.x(after) - fitted_.solution.x(before);
      const double u_um = std::sqrt(
          std::max(0.0, covariance_(after, after) + covariance_(before, before) - 2.0 * covariance_(after, before)));
      out.notes.push_back(fmt::format(
          "set-up {}, tool {}: the lengths jump by {:+.1f} um (U = {:.1f}) at line {} and do not return: the beam was "
          "lost, or the instrument was touched. A new zero is used from that line on. Give these rows their own run "
          "number, or measure the set-up again",
          fitted_.test.set_ups[jump.set_up].name, fitted_.test.tools[jump.tool].name, um, 2.0 * u_um, jump.line));
    }
  }

  void compare_repeats(Identification& out) const {
    if (!out.repeat_um) {
      out.notes.push_back("no length is measured in two runs: the noise is estimated from the residuals alone");
      return;
    }
    constexpr double kMuchMore = 1.3;
    if (out.residual_um > kMuchMore * *out.repeat_um)
      out.notes.push_back(fmt::format(
          "residuals {:.2f} um, repeats {:.2f} um: the curves do not follow the machine closely enough. Place their "
          "points closer together (--knots) or check for drift. The uncertainties include the residuals",
          out.residual_um, *out.repeat_um));
  }

  const FittedLengths& fitted_;
  const Eigen::MatrixXd& covariance_;
  std::array<double, kComponents> largest_u_{};
};

}  // namespace

std::vector<double> reported_mm(const MachineCurves& curves, Axis axis) {
  const auto& [low, high] = curves.machine().travel_mm[index_of(axis)];
  const int steps = 2 * curves.intervals(axis);
  std::vector<double> places;
  for (int i = 0; i <= steps; ++i) places.push_back(std::lerp(low, high, static_cast<double>(i) / steps));
  return places;
}

std::optional<double> repeats_of(const LengthTest& test) {
  std::map<std::tuple<std::size_t, std::size_t, Vector3, PerAxis<int>, Vector3>, std::map<int, double>> poses;
  for (const LengthReading& r : test.readings)
    poses[{r.set_up, r.tool, r.position_mm, r.approach, r.along}][r.run] = r.deviation_um;
  std::map<std::tuple<std::size_t, std::size_t, int, int>, std::vector<double>> differences;
  for (const auto& [pose, runs] : poses)
    for (auto a = runs.begin(); a != runs.end(); ++a)
      if (const auto b = std::next(a); b != runs.end())
        differences[{std::get<0>(pose), std::get<1>(pose), a->first, b->first}].push_back(b->second - a->second);
  double squares = 0.0, freedom = 0.0;
  for (const auto& [runs, list] : differences) {
    const double mean = std::accumulate(list.begin(), list.end(), 0.0) / static_cast<double>(list.size());
    for (const double d : list) squares += (d - mean) * (d - mean);
    freedom += static_cast<double>(list.size()) - 1.0;
  }
  if (freedom < kLeastRepeats) return std::nullopt;
  return std::sqrt(squares / freedom / 2.0);
}

bool Identification::whole() const {
  const auto right = [](const auto& one) { return one.why_not.empty(); };
  return std::ranges::all_of(curves, right) && std::ranges::all_of(squareness, right);
}

void report_on(const FittedLengths& fitted, Identification& out) { LengthReport(fitted).fill(out); }

}  // namespace ecs::model
