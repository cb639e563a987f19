// A made telescope with a worm, guided by a made program: its log gives the error without guiding, and the diagnosis
// names the worm.
#include <fmt/format.h>

#include "tests/model/support/real_sets.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr double kArcsecOfAxis = 1e6 * kRadPerDegree / 3600.0;  ///< in um/m
constexpr double kScale_arcsec_px = 1.85, kSeeing_arcsec = 0.35, kFrame_s = 4.0, kGuideSpeed_arcsec_s = 7.3;

/// One night at one star.
struct Night {
  double hours = 1.0, declination_deg = 40.0, hour_angle_h = -2.0;
  int dither_every = 0;  ///< frames; 0: never
  unsigned seed = 1;
};

struct GuidedNight {
  std::string log;
  std::vector<double> true_arcsec;  ///< of the axis without guiding, at each frame that is no dropped one
};

/// Actual − target of the axis: a worm of 180 teeth and the drift of an axis that does not point to the pole.
double true_error_arcsec(double hour_angle_deg, double t_s) {
  return 8.0 * std::sin(180.0 * hour_angle_deg * kRadPerDegree + 0.7) + 0.03 * t_s;
}

/// The camera is turned by 30 deg; the guiding corrects 0.7 of each move beyond 0.15 px.
GuidedNight guided(const Night& night) {
  const double across = std::cos(night.declination_deg * kRadPerDegree),
               px_s = kGuideSpeed_arcsec_s * across / kScale_arcsec_px;
  std::mt19937_64 random(night.seed);
  NormalDraws seeing_px(0.0, kSeeing_arcsec / kScale_arcsec_px);
  GuidedNight made;
  made.log = fmt::format(
      "Guiding Begins at 2021-03-05 22:10:00\nPixel scale = {} arc-sec/px, Binning = 1, Focal length = 418 mm\n"
      "Mount = Made, connected, guiding enabled, xAngle = 30.0, xRate = {:.4f}, yAngle = 120.0, yRate = 4.0, parity = "
      "Even/Even\nRA = 7.21 hr, Dec = {:.1f} deg, Hour angle = {:.2f} hr, Pier side = West\nLock position = 400.000, "
      "300.000, Star position = 400.0, 300.0\nFrame,Time,mount,dx,dy,RARawDistance,DECRawDistance,RAGuideDistance,"
      "DECGuideDistance,RADuration,RADirection,DECDuration,DECDirection,XStep,YStep,StarMass,SNR,ErrorCode\n",
      kScale_arcsec_px, px_s, night.declination_deg, night.hour_angle_h);
  double pulses_arcsec = 0.0, lock_px = 0.0;
  const int frames = static_cast<int>(night.hours * 3600.0 / kFrame_s);
  for (int k = 1; k <= frames; ++k) {
    const double t_s = kFrame_s * k;
    const double error_arcsec = true_error_arcsec(15.0 * night.hour_angle_h + 15.041067 / 3600.0 * t_s, t_s);
    if (night.dither_every > 0 && k % night.dither_every == 0) {
      const double by_px = k % 2 == 0 ? 2.5 : -1.5;
      lock_px += by_px;
      made.log += fmt::format("INFO: DITHER by {:.3f}, 0.000, new lock pos = {:.3f}, {:.3f}\n", by_px,
                              400.0 + lock_px * std::cos(30.0 * kRadPerDegree),
                              300.0 + lock_px * std::sin(30.0 * kRadPerDegree));
    }
    const double star_px = -(error_arcsec + pulses_arcsec) * across / kScale_arcsec_px - lock_px + seeing_px(random);
    if (k % 97 == 0) {
      made.log += fmt::format("{},{:.3f},\"DROP\",,,,,,,,,,,,,40,2.10,2,\"Star lost\"\n", k, t_s);
      continue;
    }
    const double move_px = std::abs(star_px) > 0.15 ? 0.7 * star_px : 0.0;
    const int pulse_ms = std::min(2500, static_cast<int>(std::round(std::abs(move_px) / px_s * 1000.0)));
    const char* const direction = pulse_ms == 0 ? "" : star_px > 0.0 ? "W" : "E";
    made.log += fmt::format("{},{:.3f},\"Mount\",0,0,{:.3f},0,{:.3f},0,{},{},0,,,,4210,31.2,0\n", k, t_s, star_px,
                            move_px, pulse_ms, direction);
    made.true_arcsec.push_back(error_arcsec);
    pulses_arcsec += (star_px > 0.0 ? 1.0 : -1.0) * pulse_ms / 1000.0 * kGuideSpeed_arcsec_s;
  }
  made.log += "Guiding Ends at 2021-03-05 23:10:00\n";
  return made;
}

Set read_log(const std::string& sections) {
  laser::ImportOptions options;
  options.takes_rotary = true;
  const std::string first = "PHD2 version 2.6.10, Log version 2.5. Log enabled at 2021-03-05 22:00:00\n\n";
  return must(laser::parse_any(first + sections, "guide.txt", options)).set;
}

/// Root mean square of what the readings differ from the truth by, apart from their zero.
double rms_from_truth_arcsec(const Set& set, const std::vector<double>& true_arcsec) {
  REQUIRE(set.readings.size() == true_arcsec.size());
  double sum = 0.0, squares = 0.0;
  const auto count = static_cast<double>(true_arcsec.size());
  for (std::size_t i = 0; i < true_arcsec.size(); ++i) {
    const double difference = set.readings[i].error / kArcsecOfAxis - true_arcsec[i];
    sum += difference;
    squares += difference * difference;
  }
  return std::sqrt(squares / count - sum * sum / count / count);
}

}  // namespace

TEST_CASE("the pulses of a guide log summed give the true error of the axis, within the seeing") {
  for (const double declination_deg : {0.0, 40.0, -65.0}) {
    const GuidedNight night = guided({.declination_deg = declination_deg, .dither_every = 60});
    const Set set = read_log(night.log);
    const double seeing_arcsec = kSeeing_arcsec / std::cos(declination_deg * kRadPerDegree);
    CHECK(rms_from_truth_arcsec(set, night.true_arcsec) == Approx(seeing_arcsec).epsilon(0.1));
    CHECK(set.readings.back().run == 1);
    double left_px = 0.0;
    for (const Reading& reading : set.readings) left_px = std::max(left_px, std::abs(reading.error));
    CHECK(left_px / kArcsecOfAxis > 100.0);  // far more than the guiding left
  }
}

TEST_CASE("a guide log shows the worm of the telescope as a wave of its period, beside the drift") {
  const Set set = read_log(guided({.hours = 1.5, .dither_every = 75}).log);
  const Diagnosis found = diagnosed_as_new(set);
  INFO(summary_of(found));
  CHECK(contains(found.headline, "+-39 um/m in C positioning, period 2.000 deg, 1/180 turn (cyclic:C:EC)"));
  CHECK(contains(found.headline, "time_drift:C:EC"));
}

TEST_CASE("sections at stars of other declinations give one worm, with a zero for each run") {
  const Night other{.declination_deg = -20.0, .hour_angle_h = 1.0, .seed = 2};
  const Set set = read_log(guided({}).log + guided(other).log);
  REQUIRE(set.readings.back().run == 2);
  const Diagnosis found = diagnosed_as_new(set);
  INFO(summary_of(found));
  CHECK(contains(found.headline, "+-39 um/m in C positioning, period 2.000 deg, 1/180 turn (cyclic:C:EC)"));
}
