// Error motions of a spindle: against values that NumPy gave (the comments say how), against what the parts of a made
// trace are, and over many draws of noise; recordings that are refused.
#include "modules/standards/spindle.hpp"

#include <cmath>
#include <functional>
#include <random>

#include <fmt/format.h>

#include "base/random.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

constexpr double kRad = kTurn / 360.0;

/// A value over the angle of the spindle [rad] and the turns since the first reading.
using Signal = std::function<double(double angle, double turns)>;

struct Recording {
  int turns = 20, per_turn = 120;
  double start_deg = 20.0;
  bool falling = false;
  std::size_t readings = 0;  ///< 0: whole turns
};

std::size_t count_in(const Recording& made) {
  return made.readings > 0 ? made.readings : static_cast<std::size_t>(made.turns * made.per_turn);
}
double turns_at(const Recording& made, std::size_t i) { return static_cast<double>(i) / made.per_turn; }
double angle_at(const Recording& made, std::size_t i) {
  return kRad * made.start_deg + (made.falling ? -kTurn : kTurn) * turns_at(made, i);
}

/// A trace as a file would give it.
SpindleTrace trace_of(const Recording& made, const std::vector<std::pair<SpindleSensor, Signal>>& signals) {
  SpindleTrace trace{.source = "made.csv", .first_deg = made.start_deg, .falling = made.falling, .has_origin = true};
  for (std::size_t i = 0; i < count_in(made); ++i) {
    trace.turn.push_back(turns_at(made, i));
    for (const auto& [sensor, signal] : signals)
      trace.value_um[static_cast<std::size_t>(sensor)].push_back(signal(angle_at(made, i), turns_at(made, i)));
  }
  return trace;
}

const SpindleMotion& motion_in(const SpindleTest& test, std::string_view id) {
  const auto found = std::ranges::find(test.motions, id, &SpindleMotion::id);
  REQUIRE(found != test.motions.end());
  return *found;
}

SpindleMotion radial_of(const Recording& made, const Signal& signal) {
  return motion_in(spindle_test_of(trace_of(made, {{SpindleSensor::x, signal}})), "radial_x");
}

/// An oval and three lobes on an eccentric ball.
double ball_um(double angle) {
  return 31.0 + 12.0 * std::cos(angle - 0.7) + 0.8 * std::cos(2.0 * angle) + 0.3 * std::cos(3.0 * angle - 0.5);
}

/// Disorder that every program makes alike, within ±0.1.
double disorder(std::size_t k) { return (static_cast<double>((k * 7919 + 104729) % 1009) / 1009.0 - 0.5) * 0.2; }

/// The parts of everything, for the comparison with NumPy.
SpindleTrace full_trace() {
  const Recording made;
  const auto number = [](double turns) { return static_cast<std::size_t>(std::lround(turns * 120.0)); };
  const auto growth = [](double turns) { return 1.0 - std::exp(-turns / 8.0); };
  const auto cage = [](double turns) { return kTurn * 0.41 * turns; };
  const Signal x = [=](double a, double u) {
    return ball_um(a) + 0.4 * std::cos(cage(u)) + 2.0 * growth(u) + disorder(number(u));
  };
  const Signal y = [=](double a, double u) {
    return -4.0 + 12.0 * std::sin(a - 0.7) + 0.5 * std::sin(2.0 * a + 0.3) + 0.4 * std::sin(cage(u)) + growth(u) +
           disorder(number(u) + 5000);
  };
  const Signal z = [=](double a, double u) {
    return 7.0 + 0.25 * std::cos(a - 1.0) + 0.1 * std::cos(4.0 * a) + 0.15 * std::cos(cage(u) + 1.0) +
           0.5 * disorder(number(u) + 9000);
  };
  const Signal x2 = [=](double a, double u) {
    return x(a, u) + 3.0 * std::cos(a - 2.0) + 0.2 * std::cos(2.0 * a + 1.0) + 0.3 * disorder(number(u) + 13000);
  };
  SpindleTrace trace =
      trace_of(made, {{SpindleSensor::x, x}, {SpindleSensor::y, y}, {SpindleSensor::z, z}, {SpindleSensor::x2, x2}});
  trace.planes_mm = 100.0;
  return trace;
}

}  // namespace

TEST_CASE("all motions have the values that NumPy gives for the same trace") {
  // numpy 1.24: polyfit through the means of the turns, lstsq of 1, cos and sin, ptp over all, over the mean and over
  // the turns at each angle; MRS by a search of patterns; rfft of the mean.
  const SpindleTest test = spindle_test_of(full_trace());
  REQUIRE(test.motions.size() == 5);
  const auto check = [&](std::string_view id, double total, double synchronous, double asynchronous, double at_deg,
                         double rms) {
    CAPTURE(id);
    const SpindleMotion& motion = motion_in(test, id);
    CHECK(motion.total == Approx(total).epsilon(1e-6));
    CHECK(motion.synchronous == Approx(synchronous).epsilon(1e-6));
    CHECK(motion.asynchronous == Approx(asynchronous).epsilon(1e-6));
    CHECK(motion.asynchronous_deg == Approx(at_deg));
    CHECK(motion.asynchronous_rms == Approx(rms).epsilon(4e-6));
  };
  check("radial_x", 3.079938, 2.094780, 1.042330, 110.0, 0.298624);
  check("radial_y", 2.035845, 1.011906, 1.015870, 284.0, 0.293152);
  check("radial_rotating", 1.842688, 0.848177, 1.003720, 209.0, 0.294155);
  check("axial", 1.022691, 0.672939, 0.372631, 47.0, 0.111447);
  check("tilt_x", 4.574991, 4.055831, 0.589959, 110.0, 0.176101);
  const SpindleMotion& x = motion_in(test, "radial_x");
  CHECK(x.once.amplitude == Approx(11.998289));
  CHECK(x.synchronous_zone == Approx(1.801296).epsilon(1e-5));
  CHECK(*x.drift == Approx(1.627100).epsilon(1e-6));
  CHECK(x.asynchronous_drift == Approx(2.457865).epsilon(1e-6));
  CHECK(x.waves[0].amplitude == Approx(0.798267).epsilon(1e-5));
  CHECK(x.waves[1].amplitude == Approx(0.298582).epsilon(1e-5));
  CHECK(motion_in(test, "radial_rotating").synchronous_zone == Approx(0.735336).epsilon(1e-5));
  CHECK_FALSE(motion_in(test, "radial_rotating").drift.has_value());
  const SpindleMotion& z = motion_in(test, "axial");
  CHECK(2.0 * z.once.amplitude == Approx(0.504881).epsilon(1e-5));
  CHECK(z.residual_synchronous == Approx(0.208949).epsilon(1e-5));
}

TEST_CASE("a motion that repeats every turn is synchronous alone, and its waves are found") {
  const SpindleMotion motion = radial_of({}, [](double a, double) { return ball_um(a); });
  CHECK(motion.asynchronous < 1e-9);
  CHECK(motion.total == Approx(motion.synchronous));
  CHECK(motion.once.amplitude == Approx(12.0));
  CHECK(motion.once.at_deg == Approx(0.7 / kRad));
  CHECK(motion.waves[0].per_turn == 2);
  CHECK(motion.waves[0].amplitude == Approx(0.8));
  CHECK(motion.waves[1].amplitude == Approx(0.3));
  CHECK(motion.waves[1].at_deg == Approx(0.5 / 3.0 / kRad));
  CHECK(motion.waves[2].amplitude < 1e-9);
}

TEST_CASE("a cage that repeats after five turns shows the widest range of five phases") {
  // 0.4 per turn: phases 72 degrees apart; the widest range of five is 2 cos 18 degrees of the amplitude.
  const SpindleMotion motion = radial_of(
      {.turns = 40, .per_turn = 360}, [](double a, double u) { return ball_um(a) + 0.5 * std::cos(0.4 * kTurn * u); });
  CHECK(motion.asynchronous == Approx(std::cos(18.0 * kRad)).epsilon(0.01));
  CHECK(motion.synchronous ==
        Approx(radial_of({.turns = 5, .per_turn = 360}, [](double a, double) { return ball_um(a); }).synchronous)
            .epsilon(0.01));
}

TEST_CASE("start, zero, eccentricity and direction of rotation do not change the error motions") {
  const auto signal = [](double eccentricity, double zero) {
    return [=](double a, double u) {
      return ball_um(a) + eccentricity * std::cos(a + 1.0) + zero + 0.3 * std::cos(0.4 * kTurn * u);
    };
  };
  const SpindleMotion plain = radial_of({.start_deg = 0.0}, signal(0.0, 0.0));
  for (const SpindleMotion& other :
       {radial_of({.start_deg = 0.0}, signal(30.0, 0.0)), radial_of({.start_deg = 0.0}, signal(0.0, 500.0)),
        radial_of({.start_deg = 117.0}, signal(0.0, 0.0))}) {
    CHECK(other.synchronous == Approx(plain.synchronous).epsilon(1e-3));
    CHECK(other.asynchronous == Approx(plain.asynchronous).epsilon(1e-3));
  }
  // Turning the other way, the ball shows the same form at the same angles.
  const SpindleMotion back = radial_of({.start_deg = 0.0, .falling = true}, signal(0.0, 0.0));
  CHECK(back.waves[1].at_deg == Approx(plain.waves[1].at_deg).epsilon(1e-3));
  CHECK(back.synchronous == Approx(plain.synchronous).epsilon(1e-3));
}

TEST_CASE("readings between the angles of other turns cost nothing of an eccentricity of 30 um") {
  // 120.37 readings a turn: each turn is read elsewhere. Chords of 30 um would be 0.01 um off.
  SpindleTrace trace;
  trace.source = "made.csv";
  for (std::size_t i = 0; i < 2420; ++i) {
    const double turn = static_cast<double>(i) / 120.37;
    trace.turn.push_back(turn);
    trace.value_um[0].push_back(30.0 * std::cos(kTurn * turn) + 0.5 * std::cos(2.0 * kTurn * turn));
  }
  const SpindleMotion motion = motion_in(spindle_test_of(trace), "radial_x");
  CHECK(motion.turns.size() == 20);
  CHECK(motion.asynchronous < 0.001);
  CHECK(motion.synchronous == Approx(1.0).epsilon(0.002));
}

TEST_CASE("growth is reported as drift, and is not asynchronous motion") {
  const auto with_growth = [](double um) {
    return [=](double a, double u) { return ball_um(a) + um * (u / 20.0 - 0.4 * u * u / 400.0); };
  };
  const SpindleMotion still = radial_of({}, with_growth(0.0)), warm = radial_of({}, with_growth(5.0));
  const double first = 0.5 * 119.0 / 120.0 / 20.0, last = first + 19.0 / 20.0;  // the middle of each turn
  CHECK(*warm.drift == Approx(5.0 * (last - first - 0.4 * (last * last - first * first))));
  CHECK(warm.turn_means.back() == Approx(*warm.drift));
  CHECK(warm.asynchronous < 1e-9);
  CHECK(warm.synchronous == Approx(still.synchronous));
  CHECK(warm.asynchronous_drift == Approx(5.0 * (19.0 / 20.0 - 0.4 * 361.0 / 400.0)));  // at the start of each turn
}

TEST_CASE("the rotating direction sees what turns with the spindle, and not the sensors' zeros") {
  // The axis moves by 0.4·cos 3θ along the direction that turns with it: x = r·cos θ, y = r·sin θ.
  using enum SpindleSensor;
  const auto radius = [](double a) { return 0.4 * std::cos(3.0 * a); };
  const SpindleTest test = spindle_test_of(
      trace_of({.per_turn = 360}, {{x, [=](double a, double) { return 9.0 + radius(a) * std::cos(a); }},
                                   {y, [=](double a, double) { return -70.0 + radius(a) * std::sin(a); }}}));
  const SpindleMotion& rotating = motion_in(test, "radial_rotating");
  CHECK(rotating.synchronous == Approx(0.8).epsilon(1e-6));
  CHECK(rotating.waves[1].amplitude == Approx(0.4));
  CHECK(motion_in(test, "radial_x").waves[0].amplitude == Approx(0.2));  // half at 2, half at 4 per turn
}

TEST_CASE("the expected range of noise has the values of the tables") {
  // d2 of control charts (Tippett 1925).
  CHECK(largest_range_of_noise(2, 1) == Approx(1.128).epsilon(0.001));
  CHECK(largest_range_of_noise(5, 1) == Approx(2.326).epsilon(0.001));
  CHECK(largest_range_of_noise(10, 1) == Approx(3.078).epsilon(0.001));
  CHECK(largest_range_of_noise(20, 1) == Approx(3.735).epsilon(0.001));
  CHECK(largest_range_of_noise(100, 1) == Approx(5.015).epsilon(0.001));
}

TEST_CASE("noise alone gives the stated values, more in more turns; on a wave it adds less to the synchronous value") {
  std::mt19937_64 random(7);
  NormalDraws noise(0.0, 0.1);
  double before = 0.0;
  for (const int turns : {6, 20, 60}) {
    CAPTURE(turns);
    constexpr int kRepeats = 60;
    double asynchronous = 0.0, synchronous = 0.0, on_wave = 0.0;
    SpindleNoise stated;
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      SpindleTrace trace =
          trace_of({.turns = turns, .per_turn = 72},
                   {{SpindleSensor::x, [&](double, double) { return noise(random); }},
                    {SpindleSensor::y, [&](double a, double) { return std::cos(2.0 * a) + noise(random); }}});
      trace.noise_um = 0.1;
      const SpindleTest test = spindle_test_of(trace);
      const SpindleMotion& motion = motion_in(test, "radial_x");
      stated = *motion.of_sensor;
      asynchronous += motion.asynchronous / kRepeats;
      synchronous += motion.synchronous / kRepeats;
      on_wave += motion_in(test, "radial_y").synchronous / kRepeats;
    }
    // What is fitted, three numbers of a curve and three of the drift, takes a little away.
    CHECK(asynchronous == Approx(stated.asynchronous).epsilon(0.02));
    CHECK(synchronous == Approx(stated.synchronous).epsilon(0.04));
    CHECK(asynchronous > before);
    CHECK(on_wave > 2.0);
    CHECK(on_wave < 2.0 + stated.synchronous);
    before = asynchronous;
  }
}

TEST_CASE("the uncertainty of a wave is the scatter of its amplitude over recordings") {
  std::mt19937_64 random(11);
  NormalDraws noise(0.0, 0.3);
  constexpr int kRepeats = 300;
  double sum = 0.0, squares = 0.0, sigma = 0.0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const SpindleMotion motion =
        radial_of({.turns = 12, .per_turn = 48}, [&](double a, double) { return ball_um(a) + noise(random); });
    sum += motion.waves[0].amplitude;
    squares += std::pow(motion.waves[0].amplitude, 2);
    sigma += motion.waves[0].sigma / kRepeats;
  }
  const double scatter = std::sqrt((squares - sum * sum / kRepeats) / (kRepeats - 1));
  CHECK(scatter == Approx(0.3 * std::sqrt(2.0 / (12.0 * 48.0))).epsilon(0.1));
  CHECK(sigma == Approx(scatter).epsilon(0.1));
}

TEST_CASE("a reversal separates the spindle from its ball, with its uncertainty") {
  const auto form = [](double a) { return 0.5 * std::cos(2.0 * a + 0.4) + 0.1 * std::cos(5.0 * a); };
  const auto spindle = [](double a) { return 0.3 * std::cos(3.0 * a - 1.0); };
  const auto test_of = [&](double sign, double start_deg, int per_turn, const std::function<double()>& noise) {
    return spindle_test_of(
        trace_of({.per_turn = per_turn, .start_deg = start_deg}, {{SpindleSensor::x, [&](double a, double) {
                                                                     return sign * 20.0 + 8.0 * std::cos(a + sign) +
                                                                            form(a) + sign * spindle(a) + noise();
                                                                   }}}));
  };
  const auto none = [] { return 0.0; };
  const SpindleSeparation exact = must(separated(test_of(1.0, 0.0, 360, none), test_of(-1.0, 0.0, 360, none))).front();
  CHECK(exact.synchronous_um == Approx(0.6).epsilon(1e-4));
  const SpindleMotion alone = radial_of({.per_turn = 360, .start_deg = 0.0}, [&](double a, double) { return form(a); });
  CHECK(exact.form_um == Approx(alone.synchronous).epsilon(1e-6));
  CHECK(exact.form_zone_um <= exact.form_um);
  // Other angles in the second recording.
  const SpindleSeparation other = must(separated(test_of(1.0, 0.0, 360, none), test_of(-1.0, 77.3, 400, none))).front();
  CHECK(other.synchronous_um == Approx(0.6).epsilon(2e-3));
  std::mt19937_64 random(5);
  NormalDraws draws(0.0, 0.2);
  const auto noise = [&] { return draws(random); };
  constexpr int kRepeats = 60;
  double squares = 0.0, stated = 0.0;
  std::size_t count = 0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const SpindleSeparation one = must(separated(test_of(1.0, 0.0, 60, noise), test_of(-1.0, 0.0, 60, noise))).front();
    stated += one.sigma_um / kRepeats;
    for (std::size_t m = 0; m < one.angle_deg.size(); ++m, ++count)
      squares += std::pow(one.spindle_um[m] - spindle(kRad * one.angle_deg[m]), 2);
  }
  CHECK(std::sqrt(squares / static_cast<double>(count)) == Approx(stated).epsilon(0.04));
}

TEST_CASE("recordings that cannot be compared are not separated") {
  const SpindleTest first = spindle_test_of(full_trace());
  SpindleTest second = first;
  second.has_origin = false;
  CHECK(contains(to_text(must_fail(separated(first, second))), "expected a column angle_deg or index"));
  second = first;
  second.falling = true;
  CHECK(contains(to_text(must_fail(separated(first, second))), "expected the direction of rotation of made.csv"));
  second = first;
  std::erase_if(second.motions, [](const SpindleMotion& motion) { return motion.id != "axial"; });
  CHECK(contains(to_text(must_fail(separated(first, second))), "expected a radial sensor"));
}

namespace {

using Row = std::function<std::string(std::size_t i)>;

std::string file_of(std::string_view head, const Row& row, std::size_t count = 2400) {
  std::string text(head);
  for (std::size_t i = 0; i < count; ++i) text += row(i) + "\n";
  return text;
}

/// 120 readings a turn.
double x_at(std::size_t i) { return ball_um(kTurn * static_cast<double>(i) / 120.0) + disorder(i); }
std::string by_angle(std::size_t i) {
  return fmt::format("{:.3f},{:.4f}", std::fmod(3.0 * static_cast<double>(i) + 20.0, 360.0), x_at(i));
}

SpindleTrace spindle_read(const std::string& text) { return must(parse_spindle_trace(text, "s.csv")); }
std::string spindle_refusal(const std::string& text) { return to_text(must_fail(parse_spindle_trace(text, "s.csv"))); }
SpindleMotion first_of(const std::string& text) { return spindle_test_of(spindle_read(text)).motions.front(); }

}  // namespace

TEST_CASE("angles that wrap, count on, fall or come with decimal commas give the same motion") {
  const SpindleMotion wrapped = first_of(file_of("angle_deg,x_um\n", by_angle));
  CHECK(wrapped.turns.size() == 20);
  CHECK(wrapped.mean.size() == 120);
  const SpindleMotion counted = first_of(file_of("angle_deg,x_um\n", [](std::size_t i) {
    return fmt::format("{:.3f},{:.4f}", 3.0 * static_cast<double>(i) - 700.0, x_at(i));
  }));
  CHECK(counted.synchronous == Approx(wrapped.synchronous).epsilon(1e-6));
  const SpindleMotion commas = first_of(file_of("angle_deg;x_um\n", [](std::size_t i) {
    std::string row = by_angle(i);
    row.replace(row.find(','), 1, ";");
    for (char& c : row) c = c == '.' ? ',' : c;
    return row;
  }));
  CHECK(commas.asynchronous == wrapped.asynchronous);
  const SpindleTrace falling = spindle_read(file_of("angle_deg,x_um\n", [](std::size_t i) {
    return fmt::format("{:.3f},{:.4f}", 359.0 - std::fmod(3.0 * static_cast<double>(i), 360.0), x_at(i));
  }));
  CHECK(falling.falling);
  CHECK(spindle_test_of(falling).motions.front().asynchronous == Approx(wrapped.asynchronous).epsilon(1e-6));
}

TEST_CASE("an index pulse per turn gives the turns, in even rows or by time") {
  // 120.37 readings a turn, the mark 30 readings behind the first.
  const auto turn_at = [](std::size_t i) { return (static_cast<double>(i) - 30.0) / 120.37; };
  const auto value = [&](std::size_t i) { return ball_um(kTurn * turn_at(i)); };
  const auto pulse = [&](std::size_t i) {
    return i > 0 && std::floor(turn_at(i)) > std::floor(turn_at(i - 1)) ? 1 : 0;
  };
  const std::string rows = file_of(
      "index,x_um\n", [&](std::size_t i) { return fmt::format("{},{:.5f}", pulse(i), value(i)); }, 2600);
  const SpindleTest test = spindle_test_of(spindle_read(rows));
  CHECK(test.turns == 21);
  CHECK(test.has_origin);
  // The mark is uncertain by a part of a reading, which shifts the angle and not the form.
  CHECK(test.motions.front().once.at_deg == Approx(0.7 / kRad).epsilon(0.05));
  CHECK(test.motions.front().asynchronous < 0.02);
  CHECK(test.motions.front().waves[0].amplitude == Approx(0.8).epsilon(0.002));
  const SpindleTrace timed = spindle_read(file_of(
      "time_s,index,x_um\n",
      [&](std::size_t i) {
        return fmt::format("{:.6f},{},{:.5f}", 0.001 * static_cast<double>(i), pulse(i), value(i));
      },
      2600));
  CHECK(*timed.speed_rpm == Approx(60.0 / 0.12037).epsilon(1e-3));
}

TEST_CASE("a stated speed is corrected by the once-per-turn motion") {
  const auto file = [](double stated_rpm) {
    return file_of(fmt::format("# speed_rpm: {}\ntime_s,x_um\n", stated_rpm), [](std::size_t i) {
      return fmt::format("{:.7f},{:.5f}", static_cast<double>(i) / 6000.0, x_at(i));  // 3000 rpm
    });
  };
  for (const double stated_rpm : {3000.0, 3010.0, 2950.0}) {
    const SpindleTrace trace = spindle_read(file(stated_rpm));
    CHECK(*trace.speed_rpm == Approx(3000.0).epsilon(1e-5));
    CHECK(contains(trace.notes.front(), "Speed from the once-per-turn motion of x_um: "));
    CHECK(spindle_test_of(trace).motions.front().waves[0].amplitude == Approx(0.8).epsilon(0.005));
  }
  CHECK(contains(spindle_refusal(file(3100.0)), "s.csv: speed_rpm: the once-per-turn motion of x_um fits 3"));
}

TEST_CASE("recordings without enough turns, readings or order are refused with their lines") {
  const std::string head = "angle_deg,x_um\n";
  const auto with = [&](std::size_t at, const std::string& row) {
    return file_of(head, [&](std::size_t i) { return i == at ? row : by_angle(i); });
  };
  CHECK(contains(spindle_refusal(file_of(head, by_angle, 480)),
                 "s.csv:1: expected 5 turns or more of 32 readings or more, found 4.0 turns of 120"));
  CHECK(contains(spindle_refusal(file_of(head, by_angle, 100)), "found 100 readings"));
  CHECK(contains(
      spindle_refusal(file_of(head, [](std::size_t i) { return fmt::format("{},{}", 15 * i % 360, x_at(5 * i)); })),
      "turns of 24"));
  CHECK(contains(spindle_refusal(with(50, "200,1")),
                 "s.csv:52:1: angle_deg: expected a step of 11.25 degrees at most, found 33"));
  CHECK(contains(spindle_refusal(with(50, "100,1")),
                 "s.csv:52:1: angle_deg: the direction of rotation reverses, from 167 to 100"));
  CHECK(contains(spindle_refusal(with(50, "170,")), "s.csv:52:5: x_um: expected a number, found nothing"));
  CHECK(contains(spindle_refusal(with(50, "170,20000")), "s.csv:52:5: x_um: expected a number within 10000"));
  CHECK(contains(spindle_refusal("angle_deg,v_um\n1,1\n"), "expected a column x_um, y_um or z_um"));
  CHECK(contains(spindle_refusal("time_s,x_um\n1,1\n"), "expected a column angle_deg, or index"));
  CHECK(contains(spindle_refusal("angle_deg,x_um,x2_um\n1,1,1\n"), "expected `# planes_mm: `"));
  CHECK(contains(spindle_refusal("# planes_mm: -2\nangle_deg,x_um,y2_um\n1,1,1\n"), "y2_um needs a column y_um"));
  CHECK(contains(spindle_refusal(file_of(head, [](std::size_t i) { return fmt::format("7,{}", x_at(i)); })),
                 "expected an angle that changes"));
  CHECK(contains(spindle_refusal(file_of("index,x_um\n", [](std::size_t i) { return fmt::format("0,{}", x_at(i)); })),
                 "found 0 such rows"));
  CHECK(contains(spindle_refusal(file_of(
                     "index,x_um\n",
                     [](std::size_t i) { return fmt::format("{},{}", i % 120 == 1 && i != 601 ? 1 : 0, x_at(i)); })),
                 "s.csv:723:1: index: the turn that ends here takes 240 readings, the usual one 120"));
  CHECK(contains(spindle_refusal(file_of("# speed_rpm: 3000\ntime_s,x_um\n",
                                         [](std::size_t i) {
                                           return fmt::format("{},{}", i == 9 ? 0.0 : static_cast<double>(i) / 6000.0,
                                                              x_at(i));
                                         })),
                 "s.csv:12:1: time_s: expected a time after"));
}

TEST_CASE("a sensor that does not change or is beyond its range is refused; a coarse one is not") {
  const auto file = [](const std::function<double(double)>& sensor) {
    return file_of("angle_deg,x_um\n",
                   [&](std::size_t i) { return fmt::format("{},{:.5f}", 3 * i % 360, sensor(x_at(i))); });
  };
  CHECK(contains(spindle_refusal(file([](double) { return 5.0; })), "s.csv:2:"));
  CHECK(contains(spindle_refusal(file([](double) { return 5.0; })), "x_um: all readings are 5. Check the sensor"));
  const std::string clipped = spindle_refusal(file([](double x) { return std::min(x, 40.0); }));
  CHECK(contains(clipped, "consecutive readings equal the maximum, 40 um: the sensor is beyond its range"));
  CHECK(contains(spindle_refusal(file([](double x) { return std::max(x, 22.0); })), "readings equal the minimum"));
  CHECK(spindle_read(file([](double x) { return std::round(x); })).of(SpindleSensor::x).size() == 2400);
}

TEST_CASE("a missing row is noted, and changes little") {
  const SpindleMotion whole = first_of(file_of("angle_deg,x_um\n", by_angle));
  const SpindleTrace trace = spindle_read(file_of(
      "angle_deg,x_um\n", [](std::size_t i) { return by_angle(i < 300 ? i : i + 1); }, 2399));
  CHECK(contains(trace.notes.front(), "1 of the steps from reading to reading are longer than 1.5 times"));
  CHECK(contains(trace.notes.front(), "6 degrees, ends at line 302"));
  CHECK(spindle_test_of(trace).motions.front().synchronous == Approx(whole.synchronous).epsilon(0.005));
}
