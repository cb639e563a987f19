#include "model/lengths/plan_lengths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "base/units.hpp"
#include "model/planning/run.hpp"

namespace ecs::model {
namespace {

constexpr double kWidePrior = 1e3;  ///< of every unknown before anything is measured [um, um/m]
constexpr double kWideZero_um = 1e5;
constexpr int kMostRuns = 3;  ///< of one path
constexpr int kTargetsBeyondKnots = 4;
constexpr double kPlannedIntervals = 12.0;
constexpr int kVolumeAlong = 4;  ///< places along each axis
constexpr double kCoverageOfPlan = 2.0;
constexpr int kAngles = 24;  ///< of a circle
constexpr std::size_t kMostSteps = 400;
constexpr int kMostSingleRuns = 50;

/// One path of the tool, there and back.
struct Path {
  std::vector<LengthReading> readings;
  double minutes = 0.0;
  bool in_bundle = false;  ///< of the first paths at a new set-up
  Eigen::MatrixXd rows;    ///< whitened, over all unknowns of the plan
  int used = 0;
};

/// A set-up with one tool.
struct Stand {
  std::size_t set_up = 0, tool = 0;
  std::vector<Path> paths;
  bool open = false;
};

LengthReading pose_at(const Vector3& p, const PerAxis<int>& approach) {
  LengthReading reading;
  for (std::size_t a = 0; a < kAxes; ++a) reading.position_mm[a] = to_micrometre(p[a]);
  reading.approach = approach;
  return reading;
}

Vector3 between(const Vector3& a, const Vector3& b, double part) {
  return {std::lerp(a[0], b[0], part), std::lerp(a[1], b[1], part), std::lerp(a[2], b[2], part)};
}

double distance(const Vector3& a, const Vector3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

class LengthPlanner {
 public:
  LengthPlanner(const params::Machine& machine, const LengthMachine& known, const LengthPlanSettings& settings,
                const MachineCurves& curves)
      : settings_(settings), machine_(known), curves_(curves) {
    plan_.test.machine = machine.name;
    plan_.test.configuration = machine.configuration;
    for (std::size_t t = 0; t < settings.tools_mm.size(); ++t)
      plan_.test.tools.push_back({fmt::format("T{}", t + 1), settings.tools_mm[t]});
  }

  Result<LengthPlan> run() {
    set_ups();
    if (stands_.empty())
      return problem(ProblemKind::usage,
                     fmt::format("no circle of {:g} mm about any station lies within the travel: expected a shorter "
                                 "ball bar or other stations",
                                 settings_.ball_bar_mm));
    prepare();
    grow();
    prune();
    write();
    return std::move(plan_);
  }

 private:
  [[nodiscard]] Vector3 corner(int bits) const {
    Vector3 out{};
    for (std::size_t a = 0; a < kAxes; ++a) out[a] = machine_.travel_mm[a][(bits >> a) & 1];
    return out;
  }

  /// From `a` to `b` and back at even targets.
  [[nodiscard]] Path line(const Vector3& a, const Vector3& b, bool in_bundle) const {
    Path path;
    path.in_bundle = in_bundle;
    int intervals = 1;
    PerAxis<int> there{1, 1, 1}, back{1, 1, 1};
    for (std::size_t k = 0; k < kAxes; ++k) {
      if (a[k] == b[k]) continue;
      intervals = std::max(intervals, curves_.intervals(kAllAxes[k]));
      there[k] = b[k] > a[k] ? 1 : -1;
      back[k] = -there[k];
    }
    const int targets = intervals + kTargetsBeyondKnots;
    for (int i = 0; i < targets; ++i) path.readings.push_back(pose_at(between(a, b, i / (targets - 1.0)), there));
    for (int i = targets - 1; i >= 0; --i) path.readings.push_back(pose_at(between(a, b, i / (targets - 1.0)), back));
    path.minutes = minutes_for(path);
    return path;
  }

  /// A circle of a ball bar in the plane of two axes, counter-clockwise and clockwise; nothing: it leaves the travel.
  [[nodiscard]] std::optional<Path> circle(const Vector3& centre, std::size_t u, std::size_t v) const {
    Path path;
    path.in_bundle = true;
    for (const int sense : {1, -1})
      for (int i = 0; i < kAngles; ++i) {
        const double angle = sense * (i + 0.5) * kTurn / kAngles;
        Vector3 p = centre;
        p[u] += settings_.ball_bar_mm * std::cos(angle);
        p[v] += settings_.ball_bar_mm * std::sin(angle);
        PerAxis<int> approach{1, 1, 1};
        approach[u] = -sense * std::sin(angle) < 0.0 ? -1 : 1;
        approach[v] = sense * std::cos(angle) < 0.0 ? -1 : 1;
        for (std::size_t a = 0; a < kAxes; ++a)
          if (p[a] < machine_.travel_mm[a][0] || p[a] > machine_.travel_mm[a][1]) return std::nullopt;
        path.readings.push_back(pose_at(p, approach));
      }
    path.minutes = minutes_for(path);
    return path;
  }

  /// By the kinematics of the other plans (model/planning/run.hpp): the targets as places along the path.
  [[nodiscard]] double minutes_for(const Path& path) const {
    MeasurementProposal proposal;
    double along_mm = 0.0;
    for (std::size_t i = 0; i < path.readings.size() / 2; ++i) {
      if (i > 0) along_mm += distance(path.readings[i - 1].position_mm, path.readings[i].position_mm);
      proposal.targets_mm.push_back(along_mm);
    }
    proposal.set_up_minutes = 0.0;
    proposal.feed_mm_min = settings_.feed_mm_min;
    proposal.dwell_s = settings_.dwell_s;
    proposal.trigger_s = settings_.trigger_s;
    double whole_mm = 0.0;  // from the path before, on average half the volume away
    for (const auto& travel : machine_.travel_mm) whole_mm += 0.5 * (travel[1] - travel[0]);
    return minutes_of(proposal, settings_.times) + whole_mm / settings_.times.rapid_mm_min;
  }

  /// From one face to the opposite one, all axes moving: every reading has its own stop of every axis.
  void add_skew_lines(std::vector<Path>& out) const {
    for (std::size_t a = 0; a < kAxes; ++a) {
      const std::size_t b = (a + 1) % kAxes, c = (a + 2) % kAxes;
      const auto at = [&](std::size_t axis, int third) {
        return std::lerp(machine_.travel_mm[axis][0], machine_.travel_mm[axis][1], third / 2.0);
      };
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
          Vector3 from{}, to{};
          from[a] = machine_.travel_mm[a][0], to[a] = machine_.travel_mm[a][1];
          from[b] = at(b, i), to[b] = at(b, (i + 2) % 3);
          from[c] = at(c, k), to[c] = at(c, (k + 1) % 3);
          out.push_back(line(from, to, false));
        }
    }
  }

  /// Edges of the volume, lines through its middle, diagonals of faces and body, skew lines.
  [[nodiscard]] std::vector<Path> lines() const {
    std::vector<Path> out;
    const Vector3 middle = between(corner(0), corner(7), 0.5);
    for (std::size_t a = 0; a < kAxes; ++a) {
      const int own = 1 << a;
      for (int bits = 0; bits < 8; ++bits)
        if ((bits & own) == 0) out.push_back(line(corner(bits), corner(bits | own), bits == 0));
      Vector3 from = middle, to = middle;
      from[a] = machine_.travel_mm[a][0];
      to[a] = machine_.travel_mm[a][1];
      out.push_back(line(from, to, false));
    }
    for (int bits = 0; bits < 4; ++bits) out.push_back(line(corner(bits), corner(7 - bits), true));
    for (std::size_t a = 0; a < kAxes; ++a) {  // faces across this axis
      const int first = 1 << ((a + 1) % kAxes), second = 1 << ((a + 2) % kAxes);
      for (const int side : {0, 1 << a}) {
        out.push_back(line(corner(side), corner(side | first | second), false));
        out.push_back(line(corner(side | first), corner(side | second), false));
      }
    }
    add_skew_lines(out);
    return out;
  }

  [[nodiscard]] std::vector<Vector3> stations() const {
    if (!settings_.stations_mm.empty()) return settings_.stations_mm;
    std::vector<Vector3> out;
    if (settings_.instrument == LengthInstrument::ball_bar) {
      for (int x = 0; x < 3; ++x)
        for (int y = 0; y < 3; ++y)
          for (int z = 0; z < 3; ++z) {
            Vector3 p{};
            const PerAxis<int> part{x, y, z};
            for (std::size_t a = 0; a < kAxes; ++a) {
              const auto [low, high] = machine_.travel_mm[a];
              p[a] = std::lerp(low + settings_.ball_bar_mm + 1.0, high - settings_.ball_bar_mm - 1.0, part[a] / 2.0);
            }
            out.push_back(p);
          }
      return out;
    }
    double lowest_tool_mm = 0.0;
    for (const Vector3& tool : settings_.tools_mm) lowest_tool_mm = std::min(lowest_tool_mm, tool[2]);
    constexpr double kAside = 0.2, kBelow_mm = 150.0;
    for (int bits = 0; bits < 4; ++bits)
      for (const bool low : {true, false}) {
        Vector3 p = corner(bits);
        for (std::size_t a = 0; a < 2; ++a) {
          const double span = machine_.travel_mm[a][1] - machine_.travel_mm[a][0];
          p[a] += (((bits >> a) & 1) != 0 ? kAside : -kAside) * span;
        }
        const auto [z_low, z_high] = machine_.travel_mm[2];
        p[2] = (low ? z_low - kBelow_mm : 0.5 * (z_low + z_high)) + lowest_tool_mm;
        out.push_back(p);
      }
    return out;
  }

  void add_stand(LengthSetUp set_up, const std::vector<Path>& paths) {
    plan_.test.set_ups.push_back(std::move(set_up));
    for (std::size_t t = 0; t < plan_.test.tools.size(); ++t)
      stands_.push_back({plan_.test.set_ups.size() - 1, t, paths, false});
  }

  void set_ups() {
    const auto all = lines();
    if (settings_.instrument == LengthInstrument::interferometer) {
      for (std::size_t i = 0; i < all.size(); ++i) {
        const Vector3& a = all[i].readings.front().position_mm;
        const Vector3& b = all[i].readings[all[i].readings.size() / 2].position_mm;
        const double length = distance(a, b);
        Path only = all[i];
        only.in_bundle = true;
        add_stand({fmt::format("L{}", i + 1),
                   settings_.instrument,
                   {(b[0] - a[0]) / length, (b[1] - a[1]) / length, (b[2] - a[2]) / length},
                   0},
                  {only});
      }
      return;
    }
    for (const Vector3& station : stations()) {
      std::vector<Path> paths = all;
      if (settings_.instrument == LengthInstrument::ball_bar) {
        paths.clear();
        for (const auto& [u, v] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 2}, {2, 0}})
          if (auto path = circle(station, u, v)) paths.push_back(std::move(*path));
        if (paths.empty()) continue;
      }
      const std::string name = fmt::format("S{}", plan_.test.set_ups.size() + 1);
      add_stand({name, settings_.instrument, station, 0}, paths);
    }
    if (settings_.instrument != LengthInstrument::ball_bar) return;
    for (Stand& stand : stands_)  // the bar stands in the tool's space
      for (std::size_t a = 0; a < kAxes && stand.tool == 0; ++a)
        plan_.test.set_ups[stand.set_up].place[a] += settings_.tools_mm[0][a];
    std::erase_if(stands_, [](const Stand& stand) { return stand.tool != 0; });
  }

  /// Whitened rows of every path over the unknowns of everything that could be set up.
  void prepare() {
    LengthTest every = plan_.test;
    for (const Stand& stand : stands_) {
      LengthReading reading = stand.paths.front().readings.front();
      reading.set_up = stand.set_up, reading.tool = stand.tool;
      every.readings.push_back(reading);
    }
    nuisance_ = nuisance_of(every, curves_.size());
    const NoiseRatios ratios{std::pow(settings_.scatter_um / settings_.instrument_um, 2), 0.0};
    const Eigen::VectorXd zeros = Eigen::VectorXd::Zero(nuisance_.end);
    for (Stand& stand : stands_)
      for (Path& path : stand.paths) {
        every.readings = path.readings;
        for (LengthReading& reading : every.readings) reading.set_up = stand.set_up, reading.tool = stand.tool;
        const Linearised linear = linearised(every, curves_, nuisance_, zeros);
        path.rows = SharedNoise(every, machine_).whitened(linear.columns, linear.direction, ratios, nullptr) /
                    settings_.instrument_um;
      }
    information_ = Eigen::MatrixXd::Zero(nuisance_.end, nuisance_.end);
    information_.diagonal().setConstant(1.0 / (kWidePrior * kWidePrior));
    for (Eigen::Index i = curves_.size(); i < nuisance_.end; ++i)
      information_(i, i) = 1.0 / (kWideZero_um * kWideZero_um);
    for (const auto& [set_up, column] : nuisance_.scale)
      information_(column, column) = 1.0 / std::pow(std::max(settings_.scale_um_per_m, 1e-6), 2);
    weight_ = Eigen::MatrixXd::Zero(nuisance_.end, nuisance_.end);
    const auto m = curves_.size();
    weight_.topLeftCorner(m, m) = volume_weight(curves_, settings_.tools_mm, kVolumeAlong);
    target_ = std::pow(settings_.volume_U_um / kCoverageOfPlan, 2);
    update();
  }

  void update() {
    const Eigen::LLT<Eigen::MatrixXd> factor(information_);
    covariance_ = factor.solve(Eigen::MatrixXd::Identity(information_.rows(), information_.cols()));
    worth_ = covariance_ * weight_ * covariance_;
    mean_square_ = (weight_.cwiseProduct(covariance_)).sum();
  }

  /// What these rows take off the mean square.
  [[nodiscard]] double gain(const Eigen::MatrixXd& rows) const {
    Eigen::MatrixXd inner = rows * covariance_ * rows.transpose();
    inner.diagonal().array() += 1.0;
    const Eigen::MatrixXd outer = rows * worth_ * rows.transpose();
    return Eigen::LLT<Eigen::MatrixXd>(inner).solve(outer).trace();
  }

  /// A path more at an open stand, or a stand to open with its first paths.
  struct Option {
    std::size_t stand = 0;
    std::optional<std::size_t> path;
    double score = std::numeric_limits<double>::max();
  };

  [[nodiscard]] double set_up_cost(const Stand& stand) const {
    for (const Stand& other : stands_)
      if (other.open && other.set_up == stand.set_up) return settings_.tool_minutes;
    return settings_.instrument == LengthInstrument::ball_bar ? settings_.times.align_minutes
                                                              : settings_.times.line_minutes;
  }

  [[nodiscard]] double score_of(const Option& option) const {
    const Stand& stand = stands_[option.stand];
    if (option.path) {
      const Path& path = stand.paths[*option.path];
      return path.used >= kMostRuns ? 0.0 : gain(path.rows) / path.minutes;
    }
    Eigen::Index count = 0;
    double minutes = set_up_cost(stand);
    for (const Path& path : stand.paths)
      if (path.in_bundle) count += path.rows.rows(), minutes += path.minutes;
    Eigen::MatrixXd rows(count, information_.cols());
    count = 0;
    for (const Path& path : stand.paths)
      if (path.in_bundle) rows.middleRows(count, path.rows.rows()) = path.rows, count += path.rows.rows();
    return gain(rows) / minutes;
  }

  void take(const Option& option, std::vector<Option>& options) {
    Stand& stand = stands_[option.stand];
    const auto use = [&](Path& path) {
      information_ += path.rows.transpose() * path.rows;
      ++path.used;
    };
    if (option.path) {
      use(stand.paths[*option.path]);
    } else {
      stand.open = true;
      for (std::size_t p = 0; p < stand.paths.size(); ++p) {
        if (stand.paths[p].in_bundle) use(stand.paths[p]);
        options.push_back({option.stand, p});
      }
    }
    update();
  }

  /// Scores only fall as more is known, nearly: the best of those before is looked at again first (lazy greedy,
  /// M. Minoux 1978).
  void grow() {
    std::vector<Option> options;
    for (std::size_t s = 0; s < stands_.size(); ++s) options.push_back({s, std::nullopt});
    const auto less = [](const Option& a, const Option& b) { return a.score < b.score; };
    for (std::size_t step = 0; step < kMostSteps && mean_square_ > target_; ++step) {
      std::set<const Option*> fresh;
      std::size_t best = 0;
      for (;;) {
        best = static_cast<std::size_t>(std::max_element(options.begin(), options.end(), less) - options.begin());
        if (!fresh.insert(&options[best]).second) break;
        options[best].score = score_of(options[best]);
      }
      const Option chosen = options[best];
      if (chosen.score <= 0.0) break;
      if (!chosen.path) options.erase(options.begin() + static_cast<std::ptrdiff_t>(best));
      take(chosen, options);
    }
  }

  [[nodiscard]] bool enough(const Eigen::MatrixXd& information) const {
    const Eigen::LLT<Eigen::MatrixXd> factor(information);
    if (factor.info() != Eigen::Success) return false;
    return weight_.cwiseProduct(factor.solve(Eigen::MatrixXd::Identity(weight_.rows(), weight_.cols()))).sum() <=
           target_;
  }

  /// Whole stands first, the dearest path first then.
  void prune() {
    if (mean_square_ > target_) return;
    for (Stand& stand : stands_) {
      if (!stand.open) continue;
      Eigen::MatrixXd without = information_;
      for (const Path& path : stand.paths) without -= path.used * (path.rows.transpose() * path.rows);
      if (!enough(without)) continue;
      information_ = without;
      for (Path& path : stand.paths) path.used = 0;
      stand.open = false;
    }
    std::vector<Path*> used;
    for (Stand& stand : stands_)
      for (Path& path : stand.paths)
        if (path.used > 0) used.push_back(&path);
    std::stable_sort(used.begin(), used.end(), [](const Path* a, const Path* b) { return a->minutes > b->minutes; });
    for (Path* path : used)
      while (path->used > 0) {
        const Eigen::MatrixXd without = information_ - path->rows.transpose() * path->rows;
        if (!enough(without)) break;
        information_ = without;
        --path->used;
      }
    for (Stand& stand : stands_)
      stand.open = std::any_of(stand.paths.begin(), stand.paths.end(), [](const Path& p) { return p.used > 0; });
    update();
  }

  void write() {
    LengthTest& test = plan_.test;
    std::vector<LengthSetUp> kept;
    std::vector<std::optional<std::size_t>> number(test.set_ups.size());
    for (std::size_t s = 0; s < stands_.size(); ++s) {
      Stand& stand = stands_[s];
      if (!stand.open) continue;
      stand.open = false;  // so that the cost of the set-up counts once
      plan_.set_up_minutes += number[stand.set_up] ? settings_.tool_minutes : set_up_cost(stand);
      stand.open = true;
      if (!number[stand.set_up]) {
        number[stand.set_up] = kept.size();
        kept.push_back(test.set_ups[stand.set_up]);
      }
      write(stand, *number[stand.set_up]);
    }
    test.set_ups = std::move(kept);
    plan_.set_ups = test.set_ups.size();
    plan_.minutes += plan_.set_up_minutes;
    test.minutes = plan_.minutes;
    for (std::size_t a = 0; a < kAxes; ++a)
      test.knots_mm[a] = (machine_.travel_mm[a][1] - machine_.travel_mm[a][0]) / curves_.intervals(kAllAxes[a]);
    plan_.volume_U_um = kCoverageOfPlan * std::sqrt(mean_square_);
    const auto m = curves_.size();
    const Eigen::MatrixXd first = volume_weight(curves_, {settings_.tools_mm.front()}, kVolumeAlong);
    plan_.first_tool_U_um = kCoverageOfPlan * std::sqrt(first.cwiseProduct(covariance_.topLeftCorner(m, m)).sum());
    plan_.reached = mean_square_ <= target_;
    plan_.single_first_tool = single_set_ups(curves_, settings_, {settings_.tools_mm.front()}, plan_.first_tool_U_um);
    plan_.single = single_set_ups(curves_, settings_, settings_.tools_mm, plan_.volume_U_um);
  }

  void write(const Stand& stand, std::size_t set_up) {
    for (int run = 1; run <= kMostRuns; ++run)
      for (const Path& path : stand.paths) {
        if (path.used < run) continue;
        ++plan_.paths;
        plan_.minutes += path.minutes;
        for (LengthReading reading : path.readings) {
          reading.set_up = set_up;
          reading.tool = stand.tool;
          reading.run = run;
          plan_.test.readings.push_back(reading);
        }
      }
  }

  const LengthPlanSettings& settings_;
  const LengthMachine& machine_;
  const MachineCurves& curves_;
  LengthPlan plan_;
  std::vector<Stand> stands_;
  NuisanceColumns nuisance_;
  Eigen::MatrixXd information_, covariance_, worth_, weight_;
  double mean_square_ = 0.0, target_ = 0.0;
};

/// Noise of one reading with the instrument for a sense, as the emulated instruments have it (docs/instruments.md).
double instrument_noise(Component component) {
  constexpr double kLinear_um = 0.1, kStraightness_um = 0.5, kAngular_um_per_m = 0.5, kLevel_um_per_m = 1.0;
  if (is_positioning(component)) return kLinear_um;
  if (!is_angular(component)) return kStraightness_um;
  return direction_of(sense_of(component)) == moving_axis(component) ? kLevel_um_per_m : kAngular_um_per_m;
}

}  // namespace

SingleSetUps single_set_ups(const MachineCurves& curves, const LengthPlanSettings& settings,
                            const std::vector<Vector3>& tools_mm, double volume_U_um) {
  constexpr int kTargets = 25;
  constexpr double kEvenPlaces = 12.0;  // variance of even places over a span: span² / 12
  SingleSetUps out;
  const auto m = curves.size();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(m, m);
  std::vector<MeasurementProposal> proposals;
  std::array<bool, kComponents> acts{};
  for (const Term& term : curves.terms())
    for (const Vector3& tool_mm : tools_mm)
      if (!term.has_lever || term.uses_coordinate || tool_mm[index_of(term.lever)] != 0.0)
        acts[index_of(term.component)] = true;
  for (std::size_t c = 0; c < kComponents; ++c) {
    const auto component = static_cast<Component>(c);
    const auto& block = curves.block(component);
    if (!acts[c] || block.size() == 0) continue;
    Axis axis = is_squareness(component) ? Axis::Y : moving_axis(component);
    for (const Term& term : curves.terms())
      if (is_squareness(component) && term.component == component) axis = term.lever;
    const auto [low, high] = curves.machine().travel_mm[index_of(axis)];
    MeasurementProposal proposal;
    Eigen::MatrixXd rows(2 * kTargets, block.size() + 1);
    for (int i = 0; i < kTargets; ++i) {
      const double p = std::lerp(low, high, i / (kTargets - 1.0));
      proposal.targets_mm.push_back(p);
      for (const int side : {1, -1}) {
        const int row = 2 * i + (side > 0 ? 0 : 1);
        rows.row(row).head(block.size()) = curves.value_row(component, p, side).transpose();
        rows(row, block.size()) = 1.0;  // the zero of the readout
      }
    }
    const double scatter = is_angular(component) ? settings.scatter_um_per_m : settings.scatter_um;
    if (is_squareness(component)) {
      constexpr double kIndicator_um = 0.5;
      const double span_m = (high - low) / kMmPerM;
      covariance(block.first, block.first) =
          (scatter * scatter + kIndicator_um * kIndicator_um) * kEvenPlaces / (2.0 * kTargets * span_m * span_m);
    } else {
      const double noise = instrument_noise(component);
      const Eigen::MatrixXd normal = rows.transpose() * rows;
      covariance.block(block.first, block.first, block.size(), block.size()) =
          (scatter * scatter + noise * noise) * normal.ldlt()
                                                    .solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols()))
                                                    .topLeftCorner(block.size(), block.size());
    }
    proposal.set_up_minutes = settings.times.line_minutes;
    proposal.feed_mm_min = settings.feed_mm_min;
    proposal.dwell_s = settings.dwell_s;
    proposal.trigger_s = settings.trigger_s;
    proposals.push_back(std::move(proposal));
  }
  const double square = volume_weight(curves, tools_mm, kVolumeAlong).cwiseProduct(covariance).sum();
  const double wanted = std::pow(volume_U_um / kCoverageOfPlan, 2);
  out.set_ups = static_cast<int>(proposals.size());
  out.runs = std::clamp(static_cast<int>(std::ceil(square / wanted)), 1, kMostSingleRuns);
  out.volume_U_um = kCoverageOfPlan * std::sqrt(square / out.runs);
  out.reached = out.volume_U_um <= volume_U_um * 1.000001;
  for (MeasurementProposal& proposal : proposals) {
    proposal.runs = out.runs;
    out.minutes += minutes_of(proposal, settings.times);
  }
  return out;
}

Result<LengthPlan> planned_lengths(const params::Machine& machine, const LengthPlanSettings& settings) {
  const auto known = length_machine(machine);
  if (!known) return tl::unexpected(known.error());
  CurveSettings curves;
  curves.tools_mm = settings.tools_mm;
  curves.reversal_degree = settings.reversal_degree;
  for (std::size_t a = 0; a < kAxes; ++a) {
    const double span_mm = known->travel_mm[a][1] - known->travel_mm[a][0];
    curves.knots_mm[a] = std::min(span_mm, settings.knots_mm[a].value_or(span_mm / kPlannedIntervals));
  }
  const MachineCurves made(*known, curves);
  return LengthPlanner(machine, *known, settings, made).run();
}

}  // namespace ecs::model
