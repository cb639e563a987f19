// The thesis's test rig: the servo of appendix A, its slide, and the compensation of figures 3.5 and 3.9 to 3.12.
#include <filesystem>

#include "modules/rig/rig.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;

namespace {

constexpr double kFeed_mm_min = 1200.0;  // 20 mm/s, as figures 3.3 and 3.4

/// Pulses of a move at constant feed.
double pulses(const ServoParameters& p, double mm) { return mm / p.screw_mm_per_rad * p.encoder_pulses_per_rad; }

ServoDrive run(const ServoParameters& p, double seconds) {
  ServoDrive drive(p);
  while (drive.time_s() < seconds - 0.5 * p.step_s) drive.step(pulses(p, std::min(10.0, 20.0 * drive.time_s())), 0.0);
  return drive;
}

double mean_of(const RigBand& band, Approach approach, double position_mm) {
  for (const RigTarget& t : band.targets)
    if (t.approach == approach && std::abs(t.position_mm - position_mm) < 1e-6) return t.mean_um;
  FAIL("no such target");
  return 0.0;
}

RigPlan two_turns() { return {.from_mm = 16.0, .step_mm = 0.5, .runs = 5}; }

}  // namespace

TEST_CASE("the servo answers a step as figures 3.3 and 3.4 show") {
  const ServoParameters p;
  const ServoStep step = servo_step(p, 10.0, kFeed_mm_min, 1.0);
  CHECK(step.steady_V == Approx(p.tacho_V_s_per_rad * 20.0 / p.screw_mm_per_rad / p.preamplifier).epsilon(0.005));
  CHECK(step.steady_V == Approx(3.0).epsilon(0.02));
  CHECK(step.falls_from_s == Approx(0.5).epsilon(0.01));
  CHECK(step.rise_s == Approx(std::log(9.0) / position_loop_gain_per_s(p)).epsilon(0.03));  // first order
  CHECK(step.dac_V.back() == Approx(0.0).epsilon(0.02));
}

TEST_CASE("with the printed tachogenerator gain the D/A output is at its limit") {
  ServoParameters printed{.tacho_V_s_per_rad = 0.632298, .step_s = 0.00002};
  const ServoStep step = servo_step(printed, 10.0, kFeed_mm_min, 1.0);
  CHECK(step.largest_V == printed.dac_limit_V);
  CHECK(step.steady_V == Approx(printed.dac_limit_V));
}

TEST_CASE("half the step of integration changes the answer by next to nothing") {
  ServoParameters fine;
  fine.step_s = 0.00005;
  for (const double at_s : {0.05, 0.2, 0.55, 0.8}) {
    const ServoDrive coarse = run({}, at_s);
    const ServoDrive finer = run(fine, at_s);
    CHECK(coarse.nut_mm() == Approx(finer.nut_mm()).epsilon(0.002));
  }
}

TEST_CASE("the work of the motor is kinetic energy and heat of friction") {
  const ServoParameters p;
  ServoDrive drive(p);
  double work_J = 0.0, heat_J = 0.0;
  double before_W = 0.0, before_friction_W = 0.0;
  while (drive.time_s() < 0.4) {
    drive.step(pulses(p, 20.0 * drive.time_s()), 0.0);
    const double now_W = p.torque_Nm_per_A * drive.current_A() * drive.speed_rad_s();
    const double friction_W = p.friction_Nm * std::abs(drive.speed_rad_s());
    work_J += 0.5 * p.step_s * (before_W + now_W);
    heat_J += 0.5 * p.step_s * (before_friction_W + friction_W);
    before_W = now_W;
    before_friction_W = friction_W;
  }
  const double kinetic_J = 0.5 * p.inertia_kg_m2 * drive.speed_rad_s() * drive.speed_rad_s();
  CHECK(work_J == Approx(kinetic_J + heat_J).epsilon(0.01));
  CHECK(kinetic_J == Approx(0.5 * p.inertia_kg_m2 * std::pow(20.0 / p.screw_mm_per_rad, 2)).epsilon(0.02));
}

TEST_CASE("an offset voltage moves the axis by as many pulses as it is worth, and no further") {
  const ServoParameters p;
  ServoDrive drive(p);
  while (drive.time_s() < 1.0) drive.step(0.0, 10.0 * p.dac_V_per_pulse);
  CHECK(static_cast<double>(drive.encoder_pulses()) == Approx(10.0).epsilon(0.11));
}

TEST_CASE("the moving slide stays within a pulse, each step applied half an increment early") {
  const MovingError moving = moving_error(kFeed_mm_min);
  double bare_um = 0.0, left_um = 0.0;
  for (std::size_t k = 0; k < moving.desired_mm.size(); ++k) {
    bare_um = std::max(bare_um, std::abs(moving.uncompensated_um[k]));
    left_um = std::max(left_um, std::abs(moving.compensated_um[k]));
  }
  CHECK(bare_um == Approx(0.25 * 80.0).epsilon(0.02));
  CHECK(left_um < Rig::kPulse_um);
  const auto first =
      std::find_if(moving.compensation_um.begin(), moving.compensation_um.end(), [](double um) { return um < -1.0; });
  REQUIRE(first != moving.compensation_um.end());
  const double asked_mm = moving.desired_mm[static_cast<std::size_t>(first - moving.compensation_um.begin())];
  const double following_mm = 20.0 / position_loop_gain_per_s({});
  CHECK(asked_mm - following_mm == Approx(4.0).epsilon(0.03));  // the slide stood at 4 mm, of 8
}

TEST_CASE("the cyclic error of the screw shows in reverse only, with the pitch as its period") {
  Rig rig({}, rig_slide_errors(), 20.0, 5);
  const RigBand band = band_of(calibrated(rig, two_turns(), false));
  const auto swing = [&](Approach approach) {
    return mean_of(band, approach, 2.0) - mean_of(band, approach, 6.0);  // crest less trough
  };
  CHECK(swing(Approach::reverse) == Approx(2.0 * rig_slide_errors().cyclic_um).epsilon(0.1));
  CHECK(std::abs(swing(Approach::forward)) < 6.0);
  CHECK(mean_of(band, Approach::reverse, 3.0) == Approx(mean_of(band, Approach::reverse, 11.0)).epsilon(0.05));
}

TEST_CASE("compensation made from a calibration leaves the scatter, for both approaches") {
  const RigPlan plan = two_turns();
  Rig bare({}, rig_slide_errors(), 20.0, 5);
  const RigBand before = band_of(calibrated(bare, plan, false));
  Rig rig({}, rig_slide_errors(), 20.0, 6);
  rig.compensate_with(tables_of(before, plan), Approach::forward);
  const RigBand after = band_of(calibrated(rig, plan, true));
  CHECK(before.error_band_um > 170.0);
  CHECK(after.error_band_um < 2.0 * after.non_repeatability_um);
  CHECK(after.error_band_um < 0.2 * before.error_band_um);
}

TEST_CASE(
    "wherever the compensation enters the loop it leaves the same band; only a voltage depends on the loop gain") {
  const RigPlan plan = two_turns();
  Rig bare({}, rig_slide_errors(), 20.0, 5);
  const RigBand before = band_of(calibrated(bare, plan, false));
  const auto after = [&](Injection injection, double loop_gain) {
    return band_with(tables_of(before, plan), plan, injection, loop_gain, 6);
  };
  const RigBand voltage = after(Injection::velocity_command, 1.0);
  for (const Injection pulses : {Injection::control_registers, Injection::feedback}) {
    CHECK(std::abs(after(pulses, 1.0).error_band_um - voltage.error_band_um) < 2.0 * Rig::kPulse_um);
    CHECK(after(pulses, 1.1).error_band_um == after(pulses, 1.0).error_band_um);
  }
  // the same voltage moves a loop of a tenth more gain by ten elevenths; reverse, where the errors are large
  const RigBand stiff = after(Injection::velocity_command, 1.1);
  for (const double at_mm : {2.0, 6.0, 10.0, 14.0})
    CHECK(mean_of(stiff, Approach::reverse, at_mm) - mean_of(voltage, Approach::reverse, at_mm) ==
          Approx(mean_of(before, Approach::reverse, at_mm) / 11.0).epsilon(0.2));
}

TEST_CASE("the band is that of means and three standard deviations, whatever the approach") {
  laser::MeasurementSet set;
  const auto add = [&](double position_mm, Approach approach, const std::vector<double>& errors) {
    for (const double e : errors) {
      laser::Reading r;
      r.position_mm[0] = position_mm;
      r.approach = approach;
      r.error = e;
      set.readings.push_back(r);
    }
  };
  add(0.0, Approach::forward, {9.0, 10.0, 11.0});      // mean 10, s 1
  add(0.0, Approach::reverse, {-22.0, -20.0, -18.0});  // mean -20, s 2
  const RigBand band = band_of(set);
  CHECK(band.error_band_um == Approx(13.0 + 26.0));
  CHECK(band.non_repeatability_um == Approx(12.0));
  CHECK(band.largest_reading_um == 22.0);
}

TEST_CASE("the rig names every file that it writes, so that none is overwritten unasked") {
  const Folder folder;
  const std::filesystem::path path = folder / "rig";
  REQUIRE(draw_rig_figures(path, 7).has_value());
  std::vector<std::string> named = rig_files(path), written;
  for (const auto& file : std::filesystem::directory_iterator(path)) written.push_back(file.path());
  std::sort(named.begin(), named.end());
  std::sort(written.begin(), written.end());
  CHECK(named == written);
}
