#include "model/diagnosis/waves.hpp"

#include <array>
#include <map>
#include <numbers>

#include <rapidcheck.h>

#include "tests/model/support/searching.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

/// A metre of X, pitch of the screw 10 mm; waves of both approaches and of each, a step and a backlash may be chosen.
struct MetreOfX {
  Searching of;
  enum : std::size_t { wave, forward, reverse, step, backlash, curve, drift, reversal };

  MetreOfX() : of(measured_line(nothing), kSigma_um, candidates()) {}
  static std::vector<EffectInstance> candidates() {
    auto list = candidates_named({"cyclic:X:EX", "cyclic:X:EX", "cyclic:X:EX", "step:X:EX", "backlash:X:EX",
                                  "progressive:X:EX", "time_drift:X:EX", "reversal_curve:X:EX"});
    list[forward].approach = ApproachMode::forward;
    list[reverse].approach = ApproachMode::reverse;
    return list;
  }
  static Choice choice(std::size_t family, double nonlinear = 0.0) {
    Choice one{.family = family, .nonlinear = nonlinear};
    return one;
  }
  [[nodiscard]] std::string objection(const std::vector<Choice>& chosen, bool each_proved = false) const {
    return objection_to_waves(of.data, of.search.families(), chosen, std::vector<bool>(chosen.size(), each_proved));
  }
  [[nodiscard]] std::string objection_to_periods(double a_mm, double b_mm) const {
    return objection({choice(wave, a_mm), choice(wave, b_mm)});
  }
};

double pitch_or_part_of_ten(int i) {
  constexpr double kPeriods_mm[] = {10.0, 5.0, 20.0, 10.0 / 3.0, 2.5, 2.0, 30.0, 40.0, 50.0};
  return kPeriods_mm[i];
}

/// What is said of the wave found in a line.
std::string objection_to_wave_in(const Truth& truth, unsigned seed = 1, double sigma_um = kSigma_um) {
  const Searching of(measured({}, sigma_um, truth, seed), sigma_um, candidates_named({"cyclic:X:EX"}));
  const std::vector<Choice> found = of.search.expand(of.search.base());
  REQUIRE_FALSE(found.empty());
  const Solution solution = of.search.refined({found.front()});
  const Choice& choice = solution.chosen.front();
  const auto change =
      change_of_wave(of.regressors, of.whitener, solution.space, of.search.families()[choice.family], choice, 160.0);
  return change ? change->reason : "";
}

/// What is said of the best of these effects beside a wave in time, and of the smoothness of that effect.
struct SaidOfBest {
  std::string in_time, smooth;
  SaidOfBest(const char* candidate, const Truth& truth, unsigned seed) {
    const Searching of(measured({}, kSigma_um, truth, seed), kSigma_um, candidates_named({candidate}));
    const Solution solution = of.search.refined({of.search.expand(of.search.base()).at(0)});
    const auto period_s = period_in_time_s(of.data, of.whitener, of.search.base(), solution.score());
    if (period_s) in_time = objection_by_wave_in_time(*period_s);
    smooth = objection_to_smoothness(of.regressors, of.whitener, solution.space, of.search.families()[0],
                                     solution.chosen.front(), 160.0);
  }
};

double turns_of_87_mm(const Reading& r) { return 2.0 * std::numbers::pi * p(r) / 87.3; }
/// −1 … 1 along the metre.
double along(const Reading& r) { return p(r) / 500.0 - 1.0; }

}  // namespace

TEST_CASE("nothing speaks against one wave, nor against no wave") {
  const MetreOfX x;
  CHECK(x.objection({}).empty());
  CHECK(x.objection({x.choice(x.wave, 87.3)}).empty());
  CHECK(x.objection({x.choice(x.step, 512.0), x.choice(x.backlash)}).empty());
}

TEST_CASE("waves closer than three turns over the travel beat, pitches of the machine or not") {
  const MetreOfX x;
  CHECK(rc::check([&] {
    const double turns = *rc::gen::inRange(60, 190) * 0.1, apart = *rc::gen::inRange(2, 29) * 0.1;
    RC_ASSERT(contains(x.objection_to_periods(1000.0 / turns, 1000.0 / (turns + apart)), "beat"));
  }));
  CHECK(contains(x.objection_to_periods(50.0, 49.0), "beat"));  // 50 mm is five pitches
  CHECK(contains(x.objection_to_periods(87.3, 87.3), "beat"));
}

TEST_CASE("a wave that even targets show as another one beats with that one") {
  Plan even{.step_mm = 50.0, .targets = 20, .runs = 1};
  auto set = measured(even, kSigma_um, nothing);
  for (auto& r : set.readings) r.position_mm[0] = 50.0 * std::round(p(r) / 50.0);
  const Searching of(set, kSigma_um, MetreOfX::candidates());
  const auto objection = [&](double a_mm, double b_mm) {
    return objection_to_waves(of.data, of.search.families(), {MetreOfX::choice(0, a_mm), MetreOfX::choice(0, b_mm)},
                              {true, true});
  };
  const double alias_mm = 1.0 / (1.0 / 50.0 * 20.0 + 1.0 / 400.0);  // as 400 mm, twenty turns faster
  CHECK(contains(objection(410.0, alias_mm), "beat"));
  CHECK_FALSE(contains(objection(150.0, alias_mm), "beat"));
}

TEST_CASE("unrelated waves of which none is a pitch can be anything") {
  const MetreOfX x;
  CHECK(contains(x.objection_to_periods(87.3, 133.7), "are unrelated"));
  CHECK(contains(x.objection({x.choice(x.wave, 87.3), x.choice(x.backlash), x.choice(x.wave, 61.0)}), "unrelated"));
}

TEST_CASE("a wave and a whole fraction of it go together") {
  const MetreOfX x;
  CHECK(rc::check([&] {
    const double period_mm = *rc::gen::inRange(2100, 3300) * 0.1;
    const int parts = *rc::gen::inRange(2, 13);
    RC_PRE((parts - 1) * 1000.0 / period_mm > 3.2);  // fewer turns apart they beat
    RC_ASSERT(x.objection_to_periods(period_mm, period_mm / parts).empty());
  }));
}

TEST_CASE("beside a pitch of the machine, its parts and multiples, another wave may stand") {
  const MetreOfX x;
  CHECK(rc::check([&] {
    const double pitch_mm = pitch_or_part_of_ten(*rc::gen::inRange(0, 9));
    const double other_mm = *rc::gen::inRange(600, 3300) * 0.1;
    RC_PRE(1000.0 / pitch_mm - 1000.0 / other_mm > 3.2);
    RC_ASSERT(x.objection_to_periods(pitch_mm, other_mm).empty());
  }));
}

TEST_CASE("the order in which waves were found does not matter") {
  const MetreOfX x;
  CHECK(rc::check([&] {
    const double a_mm = *rc::gen::inRange(20, 4000) * 0.1, b_mm = *rc::gen::inRange(20, 4000) * 0.1;
    RC_ASSERT(x.objection_to_periods(a_mm, b_mm).empty() == x.objection_to_periods(b_mm, a_mm).empty());
  }));
}

TEST_CASE("one period in forward and in reverse is one cause of two sizes") {
  const MetreOfX x;
  CHECK(x.objection({x.choice(x.forward, 87.3), x.choice(x.reverse, 87.4)}).empty());
  CHECK(contains(x.objection({x.choice(x.forward, 87.3), x.choice(x.forward, 87.4)}), "beat"));
  CHECK(contains(x.objection({x.choice(x.forward, 87.3), x.choice(x.reverse, 95.0)}), "beat"));
}

TEST_CASE("one wave and one step, each proved, are two causes; with a third shape any shape can be written so") {
  const MetreOfX x;
  CHECK(x.objection({x.choice(x.wave, 87.3), x.choice(x.step, 512.0)}, true).empty());
  CHECK(contains(x.objection({x.choice(x.wave, 87.3), x.choice(x.step, 512.0), x.choice(x.curve)}, true), "step"));
  CHECK(x.objection({x.choice(x.wave, 87.3), x.choice(x.step, 512.0), x.choice(x.drift)}, true).empty());
  const auto lost_motion = x.choice(x.reversal);  // what the directions do not share is no third shape
  CHECK(x.objection({x.choice(x.wave, 87.3), x.choice(x.step, 512.0), lost_motion}, true).empty());
}

TEST_CASE("a wave that needs a step is no cause unless it is a pitch; one beside a backlash is") {
  const MetreOfX x;
  CHECK(contains(x.objection({x.choice(x.wave, 87.3), x.choice(x.step, 512.0)}), "step"));
  CHECK(contains(x.objection({x.choice(x.step, 512.0), x.choice(x.wave, 87.3)}), "step"));
  CHECK(x.objection({x.choice(x.wave, 10.0), x.choice(x.step, 512.0)}).empty());
  CHECK(x.objection({x.choice(x.wave, 87.3), x.choice(x.backlash)}).empty());
}

TEST_CASE("a wave of any of many periods is no pitch beside two other shapes") {
  const MetreOfX x;
  const auto objection = [&](const std::vector<Choice>& chosen, const std::vector<std::size_t>& periods) {
    return objection_to_waves(x.of.data, x.of.search.families(), chosen, std::vector<bool>(chosen.size(), true),
                              periods);
  };
  const Choice pitch = x.choice(x.wave, 10.0), other = x.choice(x.wave, 161.8);
  CHECK(objection({pitch, other, x.choice(x.curve)}, {1, 1, 0}).empty());
  CHECK(contains(objection({pitch, other, x.choice(x.curve)}, {12, 1, 0}), "unrelated"));
  CHECK(objection({pitch, other}, {12, 1}).empty());
  CHECK(contains(objection({pitch, x.choice(x.step), x.choice(x.curve)}, {12, 0, 0}), "only together with a step"));
}

TEST_CASE("waves of different lines have nothing to do with each other") {
  const MetreOfX x;
  std::vector<Family> families = x.of.search.families();
  families[x.reverse] = families[x.wave];
  families[x.reverse].effect.sense = Sense::EY;
  CHECK(objection_to_waves(x.of.data, families, {x.choice(x.wave, 87.3), x.choice(x.reverse, 91.0)}, {false, false})
            .empty());
}

TEST_CASE("a period in step with a pitch over the whole travel is the pitch, and what is no wave needs none") {
  const MetreOfX x;
  const auto is_pitch = [&](std::size_t family, double nonlinear) {
    return is_pitch_or_no_wave(x.of.search.families()[family], x.choice(family, nonlinear));
  };
  for (int i = 0; i < 9; ++i) {
    const double pitch = pitch_or_part_of_ten(i), travel = x.of.search.families()[x.wave].travel;
    const auto turns_more = [&](double turns) { return 1.0 / (1.0 / pitch + turns / travel); };
    CHECK(is_pitch(x.wave, turns_more(0.1)));
    CHECK(is_pitch(x.wave, turns_more(-0.1)));
    CHECK_FALSE(is_pitch(x.wave, turns_more(0.3)));
    CHECK_FALSE(is_pitch(x.wave, 1.02 * pitch));
  }
  CHECK_FALSE(is_pitch(x.wave, 87.3));
  CHECK(is_pitch(x.step, 87.3));
  CHECK(is_pitch(x.backlash, 0.0));
}

TEST_CASE("nothing is said of a steady wave, weak or strong") {
  for (unsigned seed = 1; seed <= 30; ++seed)
    for (const double size_um : {0.3, 1.0, 20.0})
      CHECK(
          objection_to_wave_in([&](const Reading& r) { return size_um * std::sin(turns_of_87_mm(r)); }, seed).empty());
}

TEST_CASE("an amplitude that grows along the travel is no cause of one size") {
  for (unsigned seed = 1; seed <= 10; ++seed)
    CHECK(contains(objection_to_wave_in(
                       [](const Reading& r) { return (1.0 + 0.6 * along(r)) * std::sin(turns_of_87_mm(r)); }, seed),
                   "along the travel"));
}

TEST_CASE("a chirp is no wave of one period") {
  for (unsigned seed = 1; seed <= 10; ++seed)
    CHECK(contains(objection_to_wave_in(
                       [](const Reading& r) { return std::sin(turns_of_87_mm(r) + 1.2 * along(r) * along(r)); }, seed),
                   "along the travel"));
}

TEST_CASE("an amplitude that grows with time is reported as such") {
  const double last_s = *measured({}, 0.0, nothing).readings.back().time_s;
  for (unsigned seed = 1; seed <= 10; ++seed)
    CHECK(contains(
        objection_to_wave_in(
            [&](const Reading& r) { return (0.4 + 1.2 * *r.time_s / last_s) * std::sin(turns_of_87_mm(r)); }, seed),
        "in time"));
}

TEST_CASE("a wave that grows from nothing has a third of the gain of the best steady one in its change") {
  const double last_s = *measured({}, 0.0, nothing).readings.back().time_s;
  const auto growing = [&](const Reading& r) { return 10.0 * *r.time_s / last_s * std::sin(turns_of_87_mm(r)); };
  const Searching of(measured({}, kSigma_um, growing), kSigma_um, candidates_named({"cyclic:X:EX"}));
  const Solution solution = of.search.refined({of.search.expand(of.search.base()).front()});
  const Choice& wave = solution.chosen.front();
  const auto change = change_of_wave(of.regressors, of.whitener, solution.space, of.search.families()[0], wave, 160.0);
  REQUIRE(change);
  // means over t = 0 … 1 of t² = 1/3, of which the steady half takes (1/2)² = 1/4
  CHECK(change->gain / wave.gain == Approx(1.0 / 3.0).epsilon(0.1));
}

TEST_CASE("a wave in time is likelier than the lost motion, the sag or the drift that it looks like") {
  for (const char* candidate : {"backlash:X:EX", "reversal_curve:X:EX", "sag:X:EX", "time_drift:X:EX"})
    for (unsigned seed = 1; seed <= 5; ++seed)
      CHECK(contains(
          SaidOfBest(
              candidate, [](const Reading& r) { return 2.0 * std::sin(2.0 * std::numbers::pi * *r.time_s / 420.0); },
              seed)
              .in_time,
          "a wave in time with a period of"));
}

TEST_CASE("runs whose clocks restart show no wave in time that none of them resolves") {
  laser::MeasurementSet set = measured({.targets = 20, .runs = 6, .both_ways = false}, 0.0, nothing);
  std::map<int, double> next_s;
  for (Reading& r : set.readings) {
    double& now_s = next_s.try_emplace(r.run, 40.0 * r.run).first->second;
    r.time_s = now_s;
    now_s += 240.0;
    r.error = 2.0 * std::sin(2.0 * std::numbers::pi * *r.time_s / 100.0);
  }
  const Searching of(set, kSigma_um, {});
  CHECK_FALSE(period_in_time_s(of.data, of.whitener, of.search.base(), 0.0));
}

TEST_CASE("no wave in time is likelier than an effect that is there") {
  const auto value = [](const Reading& r) { return along(r) * along(r); };
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const double size_um : {0.3, 1.0, 20.0}) {
      CHECK(SaidOfBest(
                "backlash:X:EX", [&](const Reading& r) { return size_um * d(r); }, seed)
                .in_time.empty());
      CHECK(SaidOfBest(
                "progressive:X:EX", [&](const Reading& r) { return size_um * value(r); }, seed)
                .in_time.empty());
      CHECK(SaidOfBest(
                "cyclic:X:EX", [&](const Reading& r) { return size_um * std::sin(turns_of_87_mm(r)); }, seed)
                .in_time.empty());
      CHECK(SaidOfBest(
                "time_drift:X:EX", [&](const Reading& r) { return size_um * *r.time_s * 1e-3; }, seed)
                .in_time.empty());
    }
}

TEST_CASE("a lost motion that jumps from zone to zone is no smooth curve; one that bends is") {
  const auto jumping = [](const Reading& r) {
    return d(r) * std::round(2.5 * std::sin(2.4 * std::floor(p(r) / 100.5)));
  };
  const auto bending = [](const Reading& r) {
    return d(r) * (std::pow(along(r), 3) - 0.5 * along(r) + std::cos(5.0 * along(r)));
  };
  const auto said_of = [](const Truth& truth, unsigned seed) {
    return SaidOfBest("reversal_curve:X:EX", truth, seed).smooth;
  };
  for (unsigned seed = 1; seed <= 10; ++seed) {
    CHECK(contains(said_of(jumping, seed), "jumps from target to target"));
    for (const double size : {0.3, 2.0, 20.0})
      CHECK(said_of([&](const Reading& r) { return size * bending(r); }, seed).empty());
  }
}

TEST_CASE("a change of a few percent denies no cause, however small the noise") {
  CHECK(objection_to_wave_in([](const Reading& r) { return (1.0 + 0.05 * along(r)) * std::sin(turns_of_87_mm(r)); }, 1,
                             1e-3)
            .empty());
}

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kTravel_mm = 1000.0;  // nearly: the targets are a little uneven

/// A wave of one size whose phase is drawn again for every run and approach.
laser::MeasurementSet with_free_wave(double period_mm, double amplitude_um, unsigned seed, const Plan& plan = {}) {
  std::mt19937_64 random(seed + 7000);
  UniformDraws any(0.0, 2.0 * std::numbers::pi);
  std::map<std::pair<int, double>, double> phases;
  return measured(
      plan, kSigma_um,
      [&](const Reading& r) {
        const auto phase = phases.find({r.run, d(r)});
        const double rad = phase == phases.end() ? phases[{r.run, d(r)}] = any(random) : phase->second;
        return amplitude_um * std::sin(2.0 * std::numbers::pi * p(r) / period_mm + rad);
      },
      seed);
}

std::optional<FreeWave> free_wave_in(const laser::MeasurementSet& set) {
  const Searching of(set, kSigma_um, {});
  return free_wave(of.data, of.search.base().y, std::vector<bool>(of.data.size(), false));
}

}  // namespace

TEST_CASE("a wave with another phase in every pass is found at its period") {
  CHECK(rc::check([] {
    const double turns = *rc::gen::inRange(30, 150) * 0.1;
    const auto found =
        free_wave_in(with_free_wave(kTravel_mm / turns, 0.6, static_cast<unsigned>(*rc::gen::inRange(1, 10'000))));
    RC_ASSERT(found.has_value());
    // frequencies closer than half a turn over the travel are one
    RC_ASSERT(std::abs(kTravel_mm / found->period - turns) < 0.6);
  }));
  for (const double turns : {17.4, 18.8})  // 41 targets show waves of up to 20 turns
    CHECK(kTravel_mm / must(free_wave_in(with_free_wave(kTravel_mm / turns, 0.6, 3))).period ==
          Approx(turns).epsilon(0.03));
}

TEST_CASE("noise shows a free wave in none of four hundred sets") {
  for (const int targets : {10, 41})
    for (unsigned seed = 1; seed <= 200; ++seed) {
      CHECK_FALSE(free_wave_in(measured({.targets = targets}, kSigma_um, nothing, seed)));
    }
}

TEST_CASE("noise whose neighbours are alike shows a free wave in none of two hundred sets") {
  constexpr double kAlike = 0.6;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 random(seed + 9000);
    NormalDraws any(0.0, kSigma_um);
    std::map<std::pair<int, double>, double> last;
    const auto wandering = [&](const Reading& r) {
      double& value = last[{r.run, d(r)}];
      return value = kAlike * value + any(random);
    };
    CHECK_FALSE(free_wave_in(measured({}, 0.1 * kSigma_um, wandering, seed)));
  }
}

TEST_CASE("a stronger free wave is the more certain one, and its size does not depend on the unit") {
  const auto weak = must(free_wave_in(with_free_wave(62.5, 0.3, 3))),
             strong = must(free_wave_in(with_free_wave(62.5, 0.6, 3)));
  CHECK(strong.minus_log_p > 1.5 * weak.minus_log_p);
  const Searching of(with_free_wave(62.5, 0.6, 3), kSigma_um, {});
  const auto scaled = must(free_wave(of.data, 1e3 * of.search.base().y, std::vector<bool>(of.data.size(), false)));
  CHECK(scaled.minus_log_p == Approx(strong.minus_log_p));
  CHECK(scaled.period == strong.period);
}

TEST_CASE("a slow shape of fewer than two turns over the travel is no wave") {
  CHECK_FALSE(free_wave_in(with_free_wave(2.2 * kTravel_mm, 0.3, 5)));
}

TEST_CASE("one pass has no other to differ from, and passes of seven readings show no wave") {
  Plan once{.runs = 1, .both_ways = false};
  CHECK_FALSE(free_wave_in(with_free_wave(100.0, 2.0, 1, once)));
  Plan brief{.step_mm = 150.0, .targets = 7};
  CHECK_FALSE(free_wave_in(with_free_wave(400.0, 2.0, 1, brief)));
}

TEST_CASE("outliers neither make a free wave nor hide one") {
  const Searching of(with_free_wave(62.5, 0.6, 2), kSigma_um, {});
  std::vector<bool> left_out(of.data.size(), false);
  VectorXd residual = of.search.base().y;
  for (const std::size_t k : {std::size_t{20}, std::size_t{77}, std::size_t{160}}) {
    residual(static_cast<Index>(k)) = 1e4;
    left_out[k] = true;
  }
  CHECK(must(free_wave(of.data, residual, left_out)).period == Approx(62.5).epsilon(0.03));
}

TEST_CASE("a wave in time that is most of the residual is no noise, although repeats show it as turbulence") {
  for (unsigned seed = 1; seed <= 6; ++seed) {  // by chance a run is twice another one in some of them
    const Diagnosis found = diagnosed(
        straight(),
        measured(
            {.targets = 17, .runs = 5}, 0.6,
            [](const Reading& r) { return 2.9 * std::sin(2.0 * std::numbers::pi * *r.time_s / 370.0); }, seed));
    CAPTURE(found.headline);
    CHECK(found.verdict == Verdict::unexplained_structure);
    CHECK(contains(found.headline, "a wave in time with a period of 6"));
  }
}

TEST_CASE("a wave in time in only one of two channels is found, whichever of them has it") {
  for (const Sense which : {Sense::EX, Sense::EZ})
    for (unsigned seed = 1; seed <= 3; ++seed) {
      laser::MeasurementSet set;
      for (const Sense sense : {Sense::EX, Sense::EZ})
        measure(
            set, {.sense = sense, .targets = 17, .runs = 5}, sense == which ? 0.6 : 0.1,
            [&](const Reading& r) {
              return sense == which ? 2.9 * std::sin(2.0 * std::numbers::pi * *r.time_s / 370.0) : 0.0;
            },
            seed);
      const Diagnosis found = diagnosed(usual_model(set), set);
      CAPTURE(found.headline);
      CHECK(found.verdict == Verdict::unexplained_structure);
      CHECK(contains(found.headline, "a wave in time with a period of 6"));
    }
}

TEST_CASE("a wave in time that nearly repeats in every run is no curve, between the frequencies tried too") {
  for (const double period_s : {500.0, 506.0, 514.0}) {  // a run every 1020 s
    const auto set = measured({.runs = 6}, 0.5, [&](const Reading& r) {
      return 1.5 * std::sin(2.0 * std::numbers::pi * *r.time_s / period_s);
    });
    const Diagnosis found = diagnosed(straight(), set);
    CAPTURE(found.headline);
    CHECK(found.verdict == Verdict::unexplained_structure);
    CHECK(contains(found.headline, "a wave in time with a period of 8"));
    CHECK(std::ranges::none_of(found.candidates, &Candidate::in_answer));
  }
}

TEST_CASE("a wave along the axis that grows from run to run is no cause although repeats show its growth as noise") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const double last_s = *measured({.targets = 26, .both_ways = false}, 0.0, nothing).readings.back().time_s;
    const auto set = measured(
        {.targets = 26, .both_ways = false}, kNoise_um,
        [&](const Reading& r) { return 10.0 * *r.time_s / last_s * std::sin(2.0 * std::numbers::pi * p(r) / 103.0); },
        seed);
    const Diagnosis found = diagnosed(straight(), set);
    CAPTURE(found.headline);
    CHECK(found.verdict == Verdict::unexplained_structure);
    CHECK(std::ranges::none_of(found.candidates, &Candidate::in_answer));
  }
}

TEST_CASE("beside a lost motion that jumps from place to place no wave is proved") {
  constexpr std::array kPlaces_mm{14.2,  32.3,  44.6,  65.6,  78.7,  91.3,  111.6, 122.6, 138.3, 150.1,
                                  170.0, 187.2, 201.6, 214.2, 233.1, 240.5, 262.2, 274.4, 289.9, 300.9,
                                  320.1, 333.1, 348.1, 363.8, 376.6, 394.5, 412.5, 424.9, 443.7, 452.3,
                                  468.9, 486.8, 502.2, 515.2, 527.3, 544.2, 566.2, 580.4};
  params::Machine machine = mill();
  machine.axes[index_of(Axis::X)]->screw_pitch_mm = 8.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    auto set = measured({.step_mm = 15.0, .targets = 38, .runs = 4}, 2.5, nothing, seed);
    for (Reading& r : set.readings) {
      const auto place = static_cast<std::size_t>(std::lround(p(r) / 15.0));
      r.position_mm[0] = kPlaces_mm.at(place);
      r.error = std::round(r.error + (place > 9 && place <= 19 ? -47.0 * d(r) : 0.0));
    }
    Model model = straight();
    model.effects.push_back(effect(effects::backlash, Axis::X, Sense::EX));
    const Diagnosis found = must(diagnose(model, observations_of(set, model, machine)));
    for (const Candidate& one : found.candidates)
      CHECK_FALSE_MESSAGE((one.named && one.effect.traits().periodic), found.headline);
  }
}

TEST_CASE("the pitch wave of a screw is proved although bumps are left beside a curve") {
  unsigned proved = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const auto set = measured(
        {.step_mm = 24.0, .targets = 42, .runs = 4}, 0.3,
        [](const Reading& r) {
          const double bump = std::exp(-std::pow((p(r) - 430.0) / 20.0, 2));
          return 3.0 * d(r) * std::sin(p(r) / 200.0) + 2.3 * std::sin(2.0 * std::numbers::pi * p(r) / 10.0) +
                 1.5 * bump;
        },
        seed);
    Model model = straight();
    model.effects.push_back(effect(effects::backlash, Axis::X, Sense::EX));
    for (const Candidate& one : must(diagnose(model, observations_of(set, model, mill()))).candidates)
      if (one.named && one.effect.traits().periodic) ++proved;
  }
  CHECK(proved == 6);
}
