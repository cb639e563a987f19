// The plan of lengths, beside what the usual way takes: one component after the other, each with its own set-up (thesis
// 6.3).
#include "modules/lengths/plan_lengths.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "model/planning/run.hpp"
#include "modules/lengths/plan_choice.hpp"

namespace ecs::model {
namespace {

constexpr double kPlannedIntervals = 12.0;
constexpr double kCoverageOfPlan = 2.0;
constexpr std::size_t kMostStations = 4;  ///< of a tracker
constexpr std::size_t kSetsTried = 2;     ///< of stations, of each number of stations

class LengthPlanner {
 public:
  LengthPlanner(const params::Machine& machine, const LengthPlanSettings& settings, const MachineCurves& curves)
      : settings_(settings), curves_(curves), task_{plan_.test, curves, settings, {}, 0.0} {
    plan_.test.machine = machine.name;
    plan_.test.configuration = machine.configuration;
    for (std::size_t t = 0; t < settings.tools_mm.size(); ++t)
      plan_.test.tools.push_back({fmt::format("T{}", t + 1), settings.tools_mm[t]});
    task_.weight = volume_weight(curves, settings.tools_mm, kPlanPlaces);
    task_.mean_square_um2 = std::pow(settings.volume_U_um / kCoverageOfPlan, 2);
  }

  Result<LengthPlan> run() {
    add_set_ups();
    if (stands_.empty())
      return problem(ProblemKind::usage,
                     "no circle of {:g} mm about any station lies within the travel: "
                     "expected a shorter ball bar or other stations",
                     settings_.ball_bar_mm);
    for (const PlanStand& stand : stands_) known_.emplace_back(task_, stand);
    find_free();
    write(settings_.instrument == LengthInstrument::tracker ? from_stations()
                                                            : chosen_set_ups(task_, stands_, known_, free_));
    return std::move(plan_);
  }

 private:
  void add_set_up(std::string name, const Vector3& place, std::size_t first_tool, std::size_t end_tool,
                  const std::vector<PlanPath>& paths) {
    plan_.test.set_ups.push_back({std::move(name), settings_.instrument, place, 0});
    for (std::size_t t = first_tool; t < end_tool; ++t) stands_.push_back({plan_.test.set_ups.size() - 1, t, &paths});
  }

  void add_set_ups() {
    const std::size_t tools = settings_.tools_mm.size();
    if (settings_.instrument == LengthInstrument::ball_bar) {
      for (const Vector3& centre : plan_stations(curves_.machine(), settings_)) {
        auto arcs = plan_arcs(curves_, settings_, centre);
        if (!arcs.empty()) paths_.push_back(std::move(arcs)), centres_.push_back(centre);
      }
      for (std::size_t c = 0; c < centres_.size(); ++c)  // the ball follows the tool: the same poses with each
        for (std::size_t t = 0; t < tools; ++t) {
          Vector3 ball = centres_[c];
          for (std::size_t a = 0; a < kAxes; ++a) ball[a] += settings_.tools_mm[t][a];
          add_set_up(fmt::format("B{}T{}", c + 1, t + 1), ball, t, t + 1, paths_[c]);
        }
      return;
    }
    paths_.push_back(plan_lines(curves_, settings_));
    if (settings_.instrument == LengthInstrument::tracker) {
      for (const Vector3& station : plan_stations(curves_.machine(), settings_))
        add_set_up(fmt::format("S{}", plan_.test.set_ups.size() + 1), station, 0, tools, paths_[0]);
      return;
    }
    const std::vector<PlanPath> lines = std::move(paths_[0]);
    paths_.clear();
    for (const PlanPath& line : lines) paths_.push_back({line});
    for (const auto& line : paths_) {
      const Vector3& a = line[0].readings.front().position_mm;
      const Vector3& b = line[0].readings[line[0].readings.size() / 2].position_mm;
      const double length = distance_mm(a, b);
      add_set_up(fmt::format("L{}", plan_.test.set_ups.size() + 1),
                 {(b[0] - a[0]) / length, (b[1] - a[1]) / length, (b[2] - a[2]) / length}, 0, tools, line);
    }
  }

  /// What no candidate shows counts as known for the choice, and is said.
  void find_free() {
    const Eigen::MatrixXd first = first_information(task_, {});
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(first.rows(), first.cols());
    for (const StandInformation& known : known_) all += known.of_runs(1);
    all(all.rows() - 1, all.rows() - 1) += first(first.rows() - 1, first.cols() - 1);  // the length of the bar
    free_ = directions_left_free(all, first);
    if (free_.cols() == 0) return;
    std::vector<std::string_view> names;
    for (std::size_t c = 0; c < kComponents; ++c) {
      const auto& block = curves_.block(static_cast<Component>(c));
      constexpr double kSomeShare = 1e-3;
      if (block.size() > 0 && free_.middleRows(block.first, block.size()).norm() > kSomeShare)
        names.push_back(name_of(static_cast<Component>(c)));
    }
    plan_.undetermined.assign(names.begin(), names.end());
    plan_.notes.push_back(
        fmt::format("no length of these set-ups determines {} by {}: {} contain{} a part that changes no length; the "
                    "uncertainty is that of the remaining part",
                    names.size() == 1 ? "a component" : "components", names.size() == 1 ? "itself" : "themselves",
                    fmt::join(names, ", "), names.size() == 1 ? "s" : ""));
  }

  using Stations = std::vector<std::size_t>;

  /// The stands of some set-ups.
  [[nodiscard]] std::vector<std::size_t> stands_at(const Stations& set_ups) const {
    std::vector<std::size_t> out;
    for (std::size_t s = 0; s < stands_.size(); ++s)
      if (std::ranges::find(set_ups, stands_[s].set_up) != set_ups.end()) out.push_back(s);
    return out;
  }

  /// Stations that tell most together when every path is taken from each, best first.
  [[nodiscard]] std::vector<std::pair<double, Stations>> best_of(const std::vector<Stations>& sets) const {
    std::vector<std::pair<double, Stations>> out;
    for (const Stations& set : sets) {
      Eigen::MatrixXd information = first_information(task_, free_);
      for (const std::size_t s : stands_at(set)) information += known_[s].of_runs(1);
      out.emplace_back(mean_square_of(task_, information), set);
    }
    std::ranges::sort(out);
    return out;
  }

  /// One station, the best two, three, … : of each number those that tell most; then the fewest minutes of all.
  [[nodiscard]] PlanChoice from_stations() const {
    std::optional<PlanChoice> best;
    std::vector<Stations> sets;
    const std::size_t count = plan_.test.set_ups.size();
    for (std::size_t s = 0; s < count; ++s) sets.push_back({s});
    for (std::size_t k = 1; k <= std::min(kMostStations, count); ++k) {
      const auto ranked = best_of(sets);
      for (std::size_t i = 0; i < std::min(kSetsTried, ranked.size()); ++i) {
        std::vector<PlanStand> stands;
        for (const std::size_t s : stands_at(ranked[i].second)) stands.push_back(stands_[s]);
        if (best && best->reached && static_cast<double>(k) * settings_.times.line_minutes >= best->minutes) break;
        if (best && settings_.stopped && settings_.stopped()) return std::move(*best);
        PlanChoice choice = chosen_paths(task_, stands);
        if (!best || better(choice, *best)) best = std::move(choice);
      }
      std::set<Stations> wider;
      constexpr std::size_t kWidened = 4;
      for (std::size_t i = 0; i < std::min(kWidened, ranked.size()); ++i)
        for (std::size_t s = 0; s < count; ++s) {
          Stations set = ranked[i].second;
          if (std::ranges::find(set, s) != set.end()) continue;
          set.push_back(s);
          std::ranges::sort(set);
          wider.insert(set);
        }
      sets.assign(wider.begin(), wider.end());
    }
    return std::move(*best);
  }

  static bool better(const PlanChoice& a, const PlanChoice& b) {
    if (a.reached != b.reached) return a.reached;
    return a.reached ? a.minutes < b.minutes : a.mean_square_um2 < b.mean_square_um2;
  }

  void write(const PlanChoice& choice) {
    LengthTest& test = plan_.test;
    std::vector<LengthSetUp> kept;
    std::vector<std::optional<std::size_t>> number(test.set_ups.size());
    for (std::size_t s = 0; s < choice.stands.size(); ++s) {
      if (std::ranges::all_of(choice.used[s], [](int runs) { return runs == 0; })) continue;
      const PlanStand& stand = choice.stands[s];
      if (!number[stand.set_up]) {
        number[stand.set_up] = kept.size();
        kept.push_back(test.set_ups[stand.set_up]);
      }
      write(stand, choice.used[s], *number[stand.set_up]);
    }
    test.set_ups = std::move(kept);
    if (settings_.instrument == LengthInstrument::ball_bar && settings_.bar_um > 0.0) test.bar_um = settings_.bar_um;
    plan_.set_ups = test.set_ups.size();
    plan_.set_up_minutes = choice.set_up_minutes;
    plan_.minutes = choice.minutes;
    test.minutes = plan_.minutes;
    const LengthMachine& machine = curves_.machine();
    for (std::size_t a = 0; a < kAxes; ++a)
      test.knots_mm[a] = (machine.travel_mm[a][1] - machine.travel_mm[a][0]) / curves_.intervals(kAllAxes[a]);
    plan_.volume_U_um = kCoverageOfPlan * std::sqrt(choice.mean_square_um2);
    const Eigen::MatrixXd first = volume_weight(curves_, {settings_.tools_mm.front()}, kPlanPlaces);
    plan_.first_tool_U_um = kCoverageOfPlan * std::sqrt(first.cwiseProduct(choice.covariance).sum());
    plan_.reached = choice.reached;
    plan_.single_first_tool = single_set_ups(curves_, settings_, {settings_.tools_mm.front()}, plan_.first_tool_U_um);
    plan_.single = single_set_ups(curves_, settings_, settings_.tools_mm, plan_.volume_U_um);
  }

  void write(const PlanStand& stand, const std::vector<int>& used, std::size_t set_up) {
    for (int run = 1; run <= kMostPathRuns; ++run)
      for (std::size_t p = 0; p < used.size(); ++p) {
        if (used[p] < run) continue;
        ++plan_.paths;
        for (LengthReading reading : (*stand.paths)[p].readings) {
          reading.set_up = set_up;
          reading.tool = stand.tool;
          reading.run = run;
          plan_.test.readings.push_back(reading);
        }
      }
  }

  const LengthPlanSettings& settings_;
  const MachineCurves& curves_;
  LengthPlan plan_;
  PlanTask task_;
  std::deque<std::vector<PlanPath>> paths_;  ///< that stands point at
  std::vector<Vector3> centres_;
  std::vector<PlanStand> stands_;
  std::vector<StandInformation> known_;
  Eigen::MatrixXd free_;
};

}  // namespace

Result<LengthPlan> planned_lengths(const params::Machine& machine, const LengthPlanSettings& settings) {
  ECS_TRY(known, length_machine(machine));
  CurveSettings curves;
  curves.tools_mm = settings.tools_mm;
  curves.reversal_degree = settings.reversal_degree;
  for (std::size_t a = 0; a < kAxes; ++a) {
    const double span_mm = known.travel_mm[a][1] - known.travel_mm[a][0];
    curves.knots_mm[a] = std::min(span_mm, settings.knots_mm[a].value_or(span_mm / kPlannedIntervals));
  }
  const MachineCurves made(known, curves);
  return LengthPlanner(machine, settings, made).run();
}

namespace {

constexpr int kMostSingleRuns = 50;
constexpr double kCoverageOfSingle = 2.0;
constexpr int kTargetsBeyondCurve = 4;

/// Noise of one reading with the instrument for a sense, as the emulated instruments have it (docs/emulator.md).
double instrument_noise(Component component) {
  constexpr double kLinear_um = 0.1, kStraightness_um = 0.5, kAngular_um_per_m = 0.5, kLevel_um_per_m = 1.0;
  if (is_positioning(component)) return kLinear_um;
  if (!is_angular(component)) return kStraightness_um;
  return direction_of(sense_of(component)) == moving_axis(component) ? kLevel_um_per_m : kAngular_um_per_m;
}

/// One component as the usual set-up measures it.
struct SingleComponent {
  MeasurementProposal proposal;
  Eigen::MatrixXd covariance;  ///< of its unknowns
};

/// Even targets over the travel, both ways, with the zero of the readout.
SingleComponent single_component(const MachineCurves& curves, const LengthPlanSettings& settings, Component component,
                                 int targets) {
  SingleComponent out;
  const auto size = curves.block(component).size();
  Axis axis = is_squareness(component) ? Axis::Y : moving_axis(component);
  for (const Term& term : curves.terms())
    if (is_squareness(component) && term.component == component) axis = term.lever;
  const auto [low, high] = curves.machine().travel_mm[index_of(axis)];
  Eigen::MatrixXd rows(2 * targets, size + 1);
  for (int i = 0; i < targets; ++i) {
    const double p = std::lerp(low, high, i / (targets - 1.0));
    out.proposal.targets_mm.push_back(p);
    for (const int side : {1, -1}) {
      const int row = 2 * i + (side > 0 ? 0 : 1);
      rows.row(row).head(size) = curves.value_row(component, p, side).transpose();
      rows(row, size) = 1.0;
    }
  }
  const double scatter = is_angular(component) ? settings.scatter_um_per_m : settings.scatter_um;
  if (is_squareness(component)) {
    constexpr double kIndicator_um = 0.5;
    constexpr double kEvenPlaces = 12.0;  // variance of even places over a span: span² / 12
    const double span_m = (high - low) / kMmPerM;
    out.covariance = Eigen::MatrixXd::Constant(
        1, 1, (scatter * scatter + kIndicator_um * kIndicator_um) * kEvenPlaces / (2.0 * targets * span_m * span_m));
  } else {
    const double noise = instrument_noise(component);
    const Eigen::MatrixXd normal = rows.transpose() * rows;
    const Eigen::MatrixXd inverse = solved_symmetric(normal, Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
    out.covariance = (scatter * scatter + noise * noise) * inverse.topLeftCorner(size, size);
  }
  out.proposal.set_up_minutes = settings.times.line_minutes;
  out.proposal.feed_mm_min = settings.feed_mm_min;
  out.proposal.dwell_s = settings.dwell_s;
  out.proposal.trigger_s = settings.trigger_s;
  return out;
}

/// With this many targets a line, and as many runs as it takes.
SingleSetUps with_targets(const MachineCurves& curves, const LengthPlanSettings& settings,
                          const std::vector<Component>& components, const Eigen::MatrixXd& weight, double volume_U_um,
                          int targets) {
  SingleSetUps out;
  out.targets = targets;
  double square = 0.0;
  std::vector<MeasurementProposal> proposals;
  for (const Component component : components) {
    const auto& block = curves.block(component);
    SingleComponent one = single_component(curves, settings, component, targets);
    square += weight.block(block.first, block.first, block.size(), block.size()).cwiseProduct(one.covariance).sum();
    proposals.push_back(std::move(one.proposal));
  }
  const double wanted = std::pow(volume_U_um / kCoverageOfSingle, 2);
  out.set_ups = static_cast<int>(proposals.size());
  out.runs = std::clamp(static_cast<int>(std::ceil(square / wanted)), 1, kMostSingleRuns);
  out.volume_U_um = kCoverageOfSingle * std::sqrt(square / out.runs);
  constexpr double kRounding = 1.000001;
  out.reached = out.volume_U_um <= volume_U_um * kRounding;
  for (MeasurementProposal& proposal : proposals) {
    proposal.runs = out.runs;
    out.minutes += minutes_of(proposal, settings.times);
  }
  return out;
}

}  // namespace

SingleSetUps single_set_ups(const MachineCurves& curves, const LengthPlanSettings& settings,
                            const std::vector<Vector3>& tools_mm, double volume_U_um) {
  std::array<bool, kComponents> acts{};
  for (const Term& term : curves.terms())
    for (const Vector3& tool_mm : tools_mm)
      if (!term.has_lever || term.uses_coordinate || tool_mm[index_of(term.lever)] != 0.0)
        acts[index_of(term.component)] = true;
  std::vector<Component> components;
  for (std::size_t c = 0; c < kComponents; ++c)
    if (acts[c] && curves.block(static_cast<Component>(c)).size() > 0) components.push_back(static_cast<Component>(c));
  const Eigen::MatrixXd weight = volume_weight(curves, tools_mm, kPlanPlaces);
  constexpr int kMostTargets = 25;
  int fewest = 0;
  for (const Axis axis : kAllAxes) fewest = std::max(fewest, curves.intervals(axis) + kTargetsBeyondCurve);
  SingleSetUps best;
  for (int targets = std::min(fewest, kMostTargets); targets <= kMostTargets; ++targets) {
    const SingleSetUps now = with_targets(curves, settings, components, weight, volume_U_um, targets);
    if (best.set_ups == 0 || (now.reached && (!best.reached || now.minutes < best.minutes))) best = now;
  }
  return best;
}

}  // namespace ecs::model
