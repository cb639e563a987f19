// Scans of a rotary axis: readings taken while it moves, as a recorder of a control writes them.
#include <fmt/format.h>

#include "model/regression/candidates.hpp"
#include "tests/model/support/real_sets.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

/// How the readings of a made scan differ from the angle.
struct Made {
  double delay_ms = 0.0, lost_motion_deg = 0.0;
  double wave_deg = 8.0, harmonic_deg = 0.65, noise_deg = 0.05;
  double acceleration_deg_s2 = 50.0;  ///< of each stroke; 0: full speed from its first reading to its last
  int cycles = 1;                     ///< there and back; of a single one a drift in time explains lost motion too
  unsigned seed = 1;
};

/// The angle after `t_s` of a stroke from 0 to 360 deg at 36 deg/s.
double stroke_deg(double t_s, double acceleration_deg_s2) {
  constexpr double kSpeed_deg_s = 36.0, kTurn_deg = 360.0;
  if (acceleration_deg_s2 == 0.0) return std::clamp(kSpeed_deg_s * t_s, 0.0, kTurn_deg);
  const double ramp_s = kSpeed_deg_s / acceleration_deg_s2, whole_s = kTurn_deg / kSpeed_deg_s + ramp_s;
  const double t = std::clamp(t_s, 0.0, whole_s);
  if (t < ramp_s) return 0.5 * acceleration_deg_s2 * t * t;
  if (t > whole_s - ramp_s) return kTurn_deg - 0.5 * acceleration_deg_s2 * (whole_s - t) * (whole_s - t);
  return 0.5 * kSpeed_deg_s * ramp_s + kSpeed_deg_s * (t - ramp_s);
}

/// A recording every 40 ms: rest, there, rest, back; as a file, with moments in steps of 100 ns since 1601.
std::string scan_text(const Made& made) {
  constexpr double kInterval_s = 0.04, kRest_s = 1.0, kStroke_s = 12.0, kRad = std::numbers::pi / 180.0;
  const auto angle_deg = [&](double t_s) {
    const double back_s = t_s - 2.0 * kRest_s - kStroke_s;
    return back_s > 0.0 ? 360.0 - stroke_deg(back_s, made.acceleration_deg_s2)
                        : stroke_deg(t_s - kRest_s, made.acceleration_deg_s2);
  };
  std::mt19937_64 random(made.seed);
  NormalDraws noise(0.0, made.noise_deg);
  std::string text = "stamp;set;actual\n";
  for (int i = 0; i < 700 * made.cycles; ++i) {
    const double t_s = kInterval_s * (i % 700), side = t_s < kRest_s + kStroke_s ? 0.5 : -0.5;
    const double seen_deg = angle_deg(t_s - made.delay_ms / 1000.0) + side * made.lost_motion_deg;
    text += fmt::format("{};{:.6f};{:.6f}\n", 132900081483250000 + std::int64_t{400000} * i, angle_deg(t_s),
                        seen_deg + made.wave_deg * std::sin(4.0 * kRad * seen_deg + 0.4) +
                            made.harmonic_deg * std::sin(8.0 * kRad * seen_deg - 1.0) + noise(random));
  }
  return text;
}

/// Read with the options that the program suggests for it.
Set scan(const Made& made) {
  const std::string text = scan_text(made);
  const Problem why = must_fail(laser::parse_any(text, "scan.csv", {}));
  const std::size_t from = why.message.find("--columns \"") + 11;
  REQUIRE_MESSAGE(from != why.message.npos + 11, why.message);
  laser::ImportOptions options;
  options.takes_rotary = true;
  options.mapping = must(laser::column_mapping(why.message.substr(from, why.message.find('"', from) - from)));
  options.mapping->values = laser::TableValues::actual_positions;
  options.mapping->skip_lines = 1;
  return must(laser::parse_any(text, "scan.csv", options)).set;
}

const Candidate* in_answer(const Diagnosis& found, const std::string& name) {
  for (const Candidate& one : found.candidates)
    if (one.in_answer() && to_text(one.effect) == name) return &one;
  return nullptr;
}

bool says_reversal(const Diagnosis& found) {
  return std::ranges::any_of(found.candidates,
                             [](const Candidate& c) { return c.in_answer() && c.effect.traits().of_approach; });
}

}  // namespace

TEST_CASE(
    "readings 33 ms late in a scan are a delay of that size, beside a wave and its harmonic; nothing of reversal") {
  for (const unsigned seed : {21U, 22U, 23U}) {
    const Diagnosis found = diagnosed_as_new(scan({.delay_ms = 33.0, .seed = seed}));
    INFO(summary_of(found));
    const Candidate* const late = in_answer(found, "delay:C:EC");
    REQUIRE(late);
    CHECK(late->parameters.front().value == Approx(33.0).epsilon(0.03));
    CHECK(late->rivals.empty());
    CHECK(in_answer(found, "cyclic:C:EC"));
    CHECK_FALSE(says_reversal(found));
    CHECK(contains(found.headline, "90.00 deg, 1/4 turn, and of +-"));
    CHECK(contains(found.headline, "45.00 deg, 1/8 turn"));
  }
}

TEST_CASE("lost motion in a scan is an error of reversal and no delay, because slower readings show it in full") {
  for (const unsigned seed : {31U, 32U}) {
    const Diagnosis found = diagnosed_as_new(
        scan({.lost_motion_deg = 1.2, .wave_deg = 0.0, .harmonic_deg = 0.0, .cycles = 2, .seed = seed}));
    INFO(summary_of(found));
    const Candidate* const lost = in_answer(found, "backlash:C:EC");
    REQUIRE(lost);
    CHECK(lost->parameters.front().value == Approx(1.2 * 1e6 * std::numbers::pi / 180.0).epsilon(0.03));
    CHECK_FALSE(in_answer(found, "delay:C:EC"));
  }
}

TEST_CASE(
    "lost motion beside large waves of the reading is lost motion of that size, and neither a delay nor a curve") {
  for (const unsigned seed : {51U, 52U})
    for (const double lost_deg : {-1.9, -1.2, 1.2}) {
      const Diagnosis found = diagnosed_as_new(scan({.lost_motion_deg = lost_deg, .seed = seed}));
      INFO(summary_of(found));
      const Candidate* const lost = in_answer(found, "backlash:C:EC");
      REQUIRE(lost);
      CHECK(lost->parameters.front().value == Approx(lost_deg * 1e6 * std::numbers::pi / 180.0).epsilon(0.03));
      CHECK(lost->rivals.empty());
      CHECK_FALSE(in_answer(found, "delay:C:EC"));
      CHECK_FALSE(in_answer(found, "reversal_curve:C:EC"));
    }
}

TEST_CASE("at one constant speed a delay and lost motion are rivals, and another speed decides") {
  for (const Made& made : {Made{.delay_ms = 23.0, .acceleration_deg_s2 = 0.0, .seed = 41},
                           Made{.delay_ms = -23.0, .acceleration_deg_s2 = 0.0, .seed = 42},
                           Made{.lost_motion_deg = 0.8, .acceleration_deg_s2 = 0.0, .seed = 43}}) {
    const Diagnosis found = diagnosed_as_new(scan(made));
    INFO(summary_of(found));
    CHECK(contains(found.headline, "delay:C:EC"));
    CHECK(contains(found.headline, "backlash:C:EC"));
    const auto first = std::ranges::find_if(found.candidates, [](const Candidate& c) {
      return c.in_answer() && (to_text(c.effect) == "delay:C:EC" || to_text(c.effect) == "backlash:C:EC");
    });
    REQUIRE(first != found.candidates.end());
    CHECK(contains(first->next_measurement, "Repeat the C line both ways at a quarter of the speed"));
  }
}

TEST_CASE("a new model of readings on the fly takes no lost motion for granted; one of readings at rest does") {
  const auto has_backlash = [](const Set& set) {
    const auto usual = usual_effects(observations_of(set, Model{}, std::nullopt));
    return std::ranges::any_of(usual, [](const EffectInstance& one) { return one.id == backlash; });
  };
  Set set = scan({.delay_ms = 33.0});
  CHECK_FALSE(has_backlash(set));
  for (Reading& reading : set.readings) reading.extras.clear();
  CHECK(has_backlash(set));
}
