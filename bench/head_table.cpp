// Heads with two to four causes: do at most two proposed sets of a ball lead to the right causes?
//   head_table --seeds A..B
// Each seed is a machine of the emulator (its exact matrices share nothing with the model) with a head B on a head C,
// or with a table C and a head B. Every location error has a size (standard deviation 15 um, 30 um/m), both rotary axes
// have lost motion (10 um/m), and the ball and the tool are off by tens of um, differently at each place and with each
// length; all that is in the model of `ecs model new`. Two to four different causes are hidden: a wave of C, a scale
// error of B (tilt_scale), a scale or squareness of the linear axes (linear_axes), bending in the frame of the head, in
// proportion to the length of the tool, or in the frame of the machine (only where C carries B). Each is as large as
// SNR 3 to 10: rms of the part of it in the first set that this model does not take, divided by the noise of 0.3 to 1
// um; a cause of which the model takes 98 % is drawn again. The first set are the usual sweeps of `ecs-emulator ball`,
// two runs. Then diagnose and add alternate, four rounds at most. The first set of a ball that `next` proposes in these
// rounds is measured and joined to the readings, and all begins again with a new model, twice at most. right: every
// cause is named itself, nothing else. group: every cause is named, or among those told to be the same as one that is,
// nothing else. wrong: a name that is not hidden, nor is any told to be the same. missed: a cause that is neither named
// nor told to be the same as a named one or as a part of it. open: after the last set a group is left that another
// proposed set would separate (by 3 sigma). Seeds 1 to 120 are for development.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/workshop/procedures.hpp"
#include "ecs_emulator/workshop/serve.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/planning/next_measurement.hpp"
#include "model/regression/candidates.hpp"
#include "params/machine.hpp"

using namespace ecs;
using namespace ecs::emulator;

namespace {

constexpr int kMostSets = 2, kMostRounds = 4;
constexpr double kLeastLeft = 0.02, kSeparates = 3.0;

class Draws {
 public:
  explicit Draws(std::uint64_t seed) : random_(seed_of(seed, 34, 1)) {}
  double between(double low, double high) { return low + (high - low) * random_.uniform(); }
  double normal(double deviation) { return deviation * random_.normal(); }
  template <class T>
  T of(const std::vector<T>& list) {
    const auto place = static_cast<std::size_t>(random_.uniform() * static_cast<double>(list.size()));
    return list[std::min(place, list.size() - 1)];
  }

 private:
  Random random_;
};

/// One hidden cause: its shape, and its size.
struct Cause {
  std::string kind, name;
  std::string along, sense, linear;
  double sine = 0.0, cosine = 0.0, period_deg = 0.0, phase_rad = 0.0, size = 10.0;

  /// Shift along one direction with the angle of B: text for the emulator.
  [[nodiscard]] std::string bent() const {
    return fmt::format(
        "[[contribution]]\ncomponent = \"E{}B\"\nformula = \"{:.9f}*sin(p*pi/180)+{:.9f}*(1-cos(p*pi/180))\"\n", along,
        size * sine, size * cosine);
  }
  [[nodiscard]] std::string errors() const {
    if (kind == "cyclic")
      return fmt::format(
          "[[effect]]\nid = \"cyclic\"\naxis = \"C\"\nsense = \"{}\"\nparameters = {{ period_deg = {:.1f}, "
          "amplitude_um = "
          "{:.6f}, phase_rad = {:.4f} }}\n",
          sense, period_deg, size, phase_rad);
    if (kind == "tilt_scale")
      return fmt::format("[[contribution]]\ncomponent = \"EBB\"\nformula = \"{:.9f}*p\"\n", size);
    if (kind == "linear_axes" && linear.size() == 1)
      return fmt::format("[[effect]]\nid = \"scale\"\naxis = \"{}\"\nparameters = {{ um_per_m = {:.6f} }}\n", linear,
                         size);
    if (kind == "linear_axes")
      return fmt::format("[[effect]]\nid = \"squareness\"\ncode = \"{}\"\nparameters = {{ um_per_m = {:.6f} }}\n",
                         linear, size);
    if (kind == "head_bending") return bent();
    if (kind == "tool_bending") return bent() + "bends = \"tool\"\n";
    return bent() + "bends = \"machine\"\n";
  }
};

Cause drawn(const std::string& kind, Draws& draw) {
  Cause one{kind, kind, draw.of<std::string>({"X", "Y", "Z"}), "",
            draw.of<std::string>({"X", "Y", "Z", "C0Y", "B0Z", "A0Z"})};
  const double turn = draw.between(0.0, 2.0 * std::numbers::pi);
  one.sine = std::cos(turn);
  one.cosine = std::sin(turn);
  std::tie(one.sense, one.period_deg) = draw.of<std::pair<std::string, double>>(
      {{"EC", 360.0}, {"EC", 180.0}, {"EX", 180.0}, {"EY", 120.0}, {"EZ", 360.0}});
  one.phase_rad = draw.between(0.0, 2.0 * std::numbers::pi);
  if (kind == "cyclic") one.name = "cyclic:C:" + one.sense;
  if (kind == "tilt_scale") one.name = "tilt_scale:B:EB";
  return one;
}

template <class T>
T checked(Result<T> result) {
  if (result) return std::move(*result);
  fmt::print(stderr, "{}\n", to_text(result.error()));
  std::exit(3);
}

void written(const std::filesystem::path& path, const std::string& text) {
  if (write_file(path, text)) return;
  fmt::print(stderr, "cannot write {}\n", path.string());
  std::exit(5);
}

/// A sealed machine.
class Head {
 public:
  Head(std::uint64_t seed, std::filesystem::path folder) : seed_(seed), draw_(seed), folder_(std::move(folder)) {
    chain_ = draw_.of<std::string>({"TXYZCB", "XTYZCB", "XYCTZB"});
    noise_um_ = draw_.between(0.3, 1.0);
    first_.tool_offset_mm = {0.0, 0.0, -draw_.between(120.0, 250.0)};
    for (double& mm : first_.ball_mm) mm = draw_.between(-300.0, 300.0);
    machine_text_ = machine();
    base_ = base_errors();
    written(folder_ / "machine.toml", machine_text_);
    machine_ = checked(params::parse_machine(machine_text_, "machine.toml")).machine;
    std::vector<std::string> kinds{"cyclic", "tilt_scale", "linear_axes", "head_bending", "tool_bending"};
    if (has_double_head()) kinds.emplace_back("machine_bending");
    for (int count = draw_.of<int>({2, 3, 4}); count > 0; --count) {
      const std::string kind = draw_.of(kinds);
      std::erase(kinds, kind);
      causes_.push_back(sized(kind));
    }
  }

  [[nodiscard]] const std::vector<Cause>& causes() const { return causes_; }
  [[nodiscard]] const params::Machine& facts() const { return machine_; }
  [[nodiscard]] const std::string& chain() const { return chain_; }

  laser::MeasurementSet first_set() { return measured(first_, causes_, noise_um_, true); }
  /// From where the first set ended: an axis at rest keeps the lost motion with which it arrived.
  laser::MeasurementSet followed(const model::MeasurementProposal& proposal) {
    BallPlan plan;
    plan.ball_mm = proposal.ball->place_mm;
    plan.tool_offset_mm = proposal.ball->tool_mm;
    for (const auto& sweep : proposal.ball->sweeps)
      plan.sweeps.push_back({index_of(sweep.axis), sweep.targets_deg, sweep.parked_deg});
    plan.runs = proposal.runs;
    plan.stand = stand_;
    return measured(plan, causes_, noise_um_, true);
  }

 private:
  [[nodiscard]] bool has_double_head() const { return chain_.find('C') > chain_.find('T'); }

  std::string machine() {
    std::string text = fmt::format("name = \"head {0}\"\nconfiguration = \"{0}\"\n", chain_);
    for (const char axis : {'X', 'Y', 'Z'}) text += fmt::format("[axis.{}]\ntravel_mm = [-1500.0, 1500.0]\n", axis);
    text += fmt::format("[axis.B]\ntravel_deg = {}\npivot_mm = [{:.3f}, {:.3f}, {:.3f}]\n",
                        draw_.of<std::string>({"[-90.0, 90.0]", "[-100.0, 100.0]", "[-110.0, 60.0]"}),
                        draw_.between(-30, 30), draw_.between(-30, 30), draw_.between(150, 350));
    Vector3 pivot{draw_.between(-30, 30), draw_.between(-30, 30), draw_.between(400, 600)};
    if (!has_double_head())
      for (std::size_t d = 0; d < kAxes; ++d) pivot[d] = first_.ball_mm[d] + draw_.between(-200, 200);
    return text + fmt::format("[axis.C]\ntravel_deg = [0.0, 360.0]\npivot_mm = [{:.3f}, {:.3f}, {:.3f}]\n", pivot[0],
                              pivot[1], pivot[2]);
  }

  std::string base_errors() {
    std::string text = "[location]\n";
    for (const char axis : {'B', 'C'})
      for (const char letter : std::string("XYZABC"))
        if (letter != axis && letter != axis - 'A' + 'X')
          text += fmt::format("{}O{} = {:.6f}\n", letter, axis, draw_.normal(letter >= 'X' ? 15.0 : 30.0));
    for (const char axis : {'B', 'C'})
      text += fmt::format("[[effect]]\nid = \"backlash\"\naxis = \"{}\"\nparameters = {{ um = {:.6f} }}\n", axis,
                          draw_.normal(10.0));
    return text;
  }

  laser::MeasurementSet measured(BallPlan plan, const std::vector<Cause>& causes, double noise_um, bool whole) {
    std::string errors = whole ? base_ : "[location]\nXOC = 0.0\n";
    for (const Cause& one : causes) errors += one.errors();
    plan.noise_um = noise_um;
    if (whole) {  // a vector of its own of each place and each tool
      Draws of_place(seed_ * 1000 + static_cast<std::uint64_t>(std::abs(plan.ball_mm[0] + 3.0 * plan.ball_mm[1])));
      Draws of_tool(seed_ * 1000 + 500 + static_cast<std::uint64_t>(-plan.tool_offset_mm[2]));
      for (double& um : plan.off_um) um = of_place.between(-40.0, 40.0);
      for (double& um : plan.tool_off_um) um = of_tool.between(-40.0, 40.0);
    } else {
      plan.runs = 1;
    }
    written(folder_ / "errors.toml", errors);
    auto simulation = checked(simulation_for(folder_ / "machine.toml", folder_ / "errors.toml", seed_ * 10 + ++sets_));
    laser::MeasurementSet set = checked(ball_readings(simulation, plan));
    stand_ = stand_after(set, plan.stand);
    return set;
  }

  Cause sized(const std::string& kind) {
    for (int i = 0; i < 50; ++i) {
      Cause one = drawn(kind, draw_);
      const laser::MeasurementSet set = measured(first_, {one}, 0.0, false);
      model::Model model;
      model.effects = model::usual_effects(model::observations_of(set, model, machine_));
      // plain: without noise every deviation would be an outlier
      const double left_um =
          checked(model::fit(model, model::observations_of(set, model, machine_), {.plain = true})).rms_um;
      double square = 0.0;
      for (const laser::Reading& r : set.readings) square += r.error * r.error;
      if (left_um < kLeastLeft * std::sqrt(square / static_cast<double>(set.readings.size()))) continue;
      one.size *= draw_.between(3.0, 10.0) * noise_um_ / left_um * draw_.of<double>({-1.0, 1.0});
      return one;
    }
    fmt::print(stderr, "seed {}: no {} that shows\n", seed_, kind);
    std::exit(3);
  }

  std::uint64_t seed_, sets_ = 0;
  Draws draw_;
  std::filesystem::path folder_;
  std::string chain_, machine_text_, base_;
  double noise_um_ = 0.0;
  BallPlan first_;
  RotaryState stand_;  ///< at the end of the latest set
  params::Machine machine_;
  std::vector<Cause> causes_;
};

void join(laser::MeasurementSet& all, const laser::MeasurementSet& more) {
  const int runs = std::ranges::max_element(all.readings, {}, &laser::Reading::run)->run;
  const double time_s = all.readings.back().time_s.value_or(0.0);
  for (laser::Reading r : more.readings) {
    r.run += runs;
    r.time_s = r.time_s.value_or(0.0) + time_s;
    all.readings.push_back(std::move(r));
  }
  for (std::size_t k = 0; k < all.readings.size(); ++k) all.readings[k].row = static_cast<int>(k) + 1;
}

struct Answer {
  std::vector<std::vector<std::string>> groups;  ///< each named cause, then those told to be the same
  std::string verdict;
  std::vector<std::string> followed;
  bool open = false;  ///< a proposed set would separate a group
};

/// Diagnose and add, from a new model on.
std::optional<model::MeasurementProposal> judged(const laser::MeasurementSet& set, const params::Machine& machine,
                                                 Answer& answer) {
  answer.groups.clear();
  model::Model model;
  model.effects = model::usual_effects(model::observations_of(set, model, machine));
  const model::Observations data = model::observations_of(set, model, machine);
  std::optional<model::MeasurementProposal> proposal;
  for (int round = 0; round < kMostRounds; ++round) {
    model::Diagnosis found = checked(model::diagnose(model, data));
    answer.verdict = std::string(name_of(found.verdict));
    if (!proposal) {
      const model::NextMeasurement next = model::planned_next(model, data, found);
      if (!next.proposals.empty() && next.proposals.front().ball) proposal = next.proposals.front();
    }
    bool any = false;
    for (const model::Candidate& one : found.candidates) {
      if (!one.in_answer()) continue;
      answer.groups.push_back({to_text(one.effect)});
      answer.groups.back().insert(answer.groups.back().end(), one.indistinguishable_from.begin(),
                                  one.indistinguishable_from.end());
      for (const model::RivalOfPart& rival : one.in_part) answer.groups.back().push_back(to_text(rival.other));
      model = checked(model::add_effect(model, data, model::request_of(one.effect), "data")).model;
      any = true;
    }
    if (!any) break;
  }
  return proposal;
}

Answer answer_about(Head& head) {
  Answer answer;
  laser::MeasurementSet set = head.first_set();
  join(set, {});
  for (int i = 0; i <= kMostSets; ++i) {
    const auto proposal = judged(set, head.facts(), answer);
    answer.open = proposal && proposal->separation_sigma >= kSeparates && !proposal->pairs.empty() &&
                  !proposal->pairs.front().rival.empty();
    if (!proposal || i == kMostSets) break;
    answer.followed.push_back(proposal->condition);
    join(set, head.followed(*proposal));
  }
  return answer;
}

struct Tally {
  int machines = 0, right = 0, group = 0, with_wrong = 0, names = 0, wrong = 0, causes = 0, missed = 0, sets = 0,
      open = 0;
};

void judge(std::uint64_t seed, const std::filesystem::path& folder, Tally& tally) {
  Head head(seed, folder);
  const Answer answer = answer_about(head);
  std::vector<std::string> hidden;
  for (const Cause& one : head.causes()) hidden.push_back(one.name);
  const auto is_hidden = [&](const std::string& name) { return std::ranges::find(hidden, name) != hidden.end(); };
  int wrong = 0, missed = 0;
  std::vector<std::string> firsts, groups;
  for (const auto& group : answer.groups) {
    wrong += std::ranges::none_of(group, is_hidden) ? 1 : 0;
    if (std::ranges::find(firsts, group.front()) == firsts.end()) firsts.push_back(group.front());
    groups.push_back(fmt::format("{}", fmt::join(group, "|")));
  }
  for (const std::string& name : hidden)
    missed += std::ranges::none_of(answer.groups,
                                   [&](const auto& group) { return std::ranges::find(group, name) != group.end(); })
                  ? 1
                  : 0;
  const bool right = firsts.size() == hidden.size() && std::ranges::all_of(firsts, is_hidden);
  const bool group = wrong == 0 && missed == 0 && firsts.size() <= hidden.size();
  ++tally.machines;
  tally.right += right ? 1 : 0;
  tally.group += right || group ? 1 : 0;
  tally.with_wrong += wrong > 0 ? 1 : 0;
  tally.names += static_cast<int>(answer.groups.size());
  tally.wrong += wrong;
  tally.causes += static_cast<int>(hidden.size());
  tally.missed += missed;
  tally.sets += static_cast<int>(answer.followed.size());
  tally.open += answer.open ? 1 : 0;
  fmt::print("{} {} {} hidden {}; named {}; {}; {}{}\n", seed, head.chain(),
             right       ? "right"
             : wrong > 0 ? "WRONG"
             : group     ? "group"
                         : "missed",
             fmt::join(hidden, " "), fmt::join(groups, " "), answer.verdict, fmt::join(answer.followed, "; "),
             answer.open ? "; open" : "");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  long long first = 0, last = -1;
  if (argc != 3 || std::string_view(argv[1]) != "--seeds" || std::sscanf(argv[2], "%lld..%lld", &first, &last) != 2)
    return fmt::print(stderr, "usage: head_table --seeds A..B\n"), 2;
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("ecs-heads-{}", first);
  std::filesystem::create_directories(folder);
  Tally tally;
  for (long long seed = first; seed <= last; ++seed) judge(static_cast<std::uint64_t>(seed), folder, tally);
  std::filesystem::remove_all(folder);
  fmt::print(
      "seeds {}..{}: {} machines, right {}, right or in a group {}, with a wrong name {}; {} names, {} wrong; {} "
      "causes, {} "
      "missed; {} sets followed; {} open\n",
      first, last, tally.machines, tally.right, tally.group, tally.with_wrong, tally.names, tally.wrong, tally.causes,
      tally.missed, tally.sets, tally.open);
}
