// Real measurements that may not be passed on.
#include "tests/model/support/real_sets.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;
using enum Verdict;

namespace {

/// Hole positions of drilled plates: errors in um over the nominal place.
Set plate(const std::string& name) {
  const auto text = real_text("sdss-plugplate-cmm/" + name);
  Set set;
  for (const std::string_view line : lines_of(text)) {
    const auto n = numbers_in(line);
    if (n.size() < 6) continue;
    added(set, Axis::X, Sense::EX, {n[2], n[3], 0.0}, 1000.0 * n[4]);
    added(set, Axis::Y, Sense::EY, {n[2], n[3], 0.0}, 1000.0 * n[5]);
  }
  return set;
}

EffectInstance user_term(const char* name, const char* parameter, const char* in_x, const char* in_y) {
  return {.id = user,
          .name = name,
          .formulas = {{Sense::EX, in_x}, {Sense::EY, in_y}},
          .user = {{parameter, "um/m", {}, {}, {}, {}}}};
}
EffectInstance rotation() { return user_term("rotation", "rot", "-rot*y_mm/1000", "rot*x_mm/1000"); }
EffectInstance magnification() { return user_term("magnification", "mag", "mag*x_mm/1000", "mag*y_mm/1000"); }

}  // namespace

TEST_CASE("a step gauge on a simulated CMM of known errors: the scale of X is named with the laboratory's value") {
  SKIP_UNLESS(!real_data("msl-cmm-simulated").empty(), kNoRealData);
  const auto text = real_text("msl-cmm-simulated/bar_fulldata.csv");
  Set set;
  for (const std::string_view line : lines_of(text)) {
    if (line.empty() || line.find_first_not_of("0123456789.,-") != line.npos) continue;
    const auto n = numbers_in(line);
    if (n.size() < 7) continue;
    constexpr std::array<Sense, 3> kSenses{Sense::EX, Sense::EY, Sense::EZ};
    for (std::size_t s = 0; s < 3; ++s) added(set, Axis::X, kSenses[s], {n[1], n[2], n[3]}, 1000.0 * n[4 + s]);
  }
  REQUIRE(set.readings.size() == 93);
  const Diagnosis found = diagnosed_real("MSL step gauge", offsets({{Axis::X, Sense::EX}}), set);
  CHECK(found.verdict == missing_effect);
  REQUIRE_FALSE(found.candidates.empty());
  CHECK(stands_for(found.candidates.front(), "scale:X:EX"));
  CHECK(found.candidates.front().parameters.front().value == Approx(1.2).epsilon(0.01));  // Txx = 1.2e-6
  CHECK(diagnosed_real("with its scale", straight(), set).verdict == adequate);
}

TEST_CASE("a drilled plate: turned and magnified as its makers' own fit says") {
  SKIP_UNLESS(!real_data("sdss-plugplate-cmm").empty(), kNoRealData);
  const auto set = plate("D8131_1");
  Model model = offsets({{Axis::X, Sense::EX}, {Axis::Y, Sense::EY}});
  model.effects.push_back(rotation());
  model.effects.push_back(magnification());
  const auto fitted = must(fit(model, observations_of(set, model, std::nullopt), {true}));
  // fit_8131_1: offset -0.044 0.079 mm, scale 1.000007, rotation 0.029 deg; root mean square of its 82 distances 8.17
  // um
  CHECK(fitted.effects[0].parameters[0].value == Approx(-44.0).epsilon(0.03));
  CHECK(fitted.effects[1].parameters[0].value == Approx(79.0).epsilon(0.03));
  CHECK(fitted.effects[2].parameters[0].value == Approx(0.029 * std::numbers::pi / 180.0 * 1e6).epsilon(0.02));
  CHECK(fitted.effects[3].parameters[0].value == Approx(7.0).epsilon(0.1));
  CHECK(fitted.rms_um * std::numbers::sqrt2 == Approx(8.175).epsilon(0.002));
}

TEST_CASE("two drilled plates: a rotation among the candidates is named first; one plate has grown or shrunk besides") {
  SKIP_UNLESS(!real_data("sdss-plugplate-cmm").empty(), kNoRealData);
  for (const char* name : {"D1413_1", "D2130_1"}) {
    const auto set = plate(name);
    Model model = offsets({{Axis::X, Sense::EX}, {Axis::Y, Sense::EY}});
    model.candidates = {rotation()};
    const Diagnosis found = diagnosed_real(name, model, set, mill());
    CHECK(found.verdict == missing_effect);
    REQUIRE_FALSE(found.candidates.empty());
    CHECK(found.candidates.front().effect.name == "rotation");
    for (const Candidate& c : found.candidates)
      if (c.named) CHECK((c.effect.name == "rotation" || c.effect.id == scale));
    model.effects.push_back(rotation());
    CHECK(diagnosed_real("with the rotation", model, set, mill()).verdict == adequate);
  }
}

TEST_CASE("a servo pushed from either side: its play is named as backlash") {
  SKIP_UNLESS(!real_data("servo-backlash").empty(), kNoRealData);
  const auto text = real_text("servo-backlash/motor_telemetry_single.csv");
  // Servo 5 alternates between two targets; three samples of each rest, 0.8 s after the command, in encoder counts.
  Set set;
  double target = std::nan("");
  int sense = 0, since = 0, sample = 0;
  for (const std::string_view line : lines_of(text)) {
    const auto cells = split(line, ',');
    if (cells.size() < 3) continue;
    const auto wanted = number_in(cells[1]), at = number_in(cells[2]);
    ++sample;
    if (!wanted || !at) continue;
    if (std::isfinite(target) && *wanted != target) {
      sense = *wanted > target ? 1 : -1;
      since = 0;
    }
    target = *wanted;
    if (++since < 8 || since > 10 || sense == 0) continue;
    laser::Reading& r = added(set, Axis::X, Sense::EX, {*wanted, 0.0, 0.0}, *at - *wanted);
    r.approach = static_cast<Approach>(sense);
    r.time_s = 0.1 * sample;
  }
  const Diagnosis found = diagnosed_real("servo", offsets({{Axis::X, Sense::EX}}), set);
  CHECK(found.verdict == missing_effect);
  REQUIRE_FALSE(found.candidates.empty());
  CHECK(stands_for(found.candidates.front(), "backlash:X:EX"));
  CHECK(found.candidates.front().parameters.front().value == Approx(-11.0).epsilon(0.1));
}

TEST_CASE("a positioning test whose curve no effect explains: backlash is reported, the rest is structure over x") {
  SKIP_UNLESS(!real_data("ecmc-iso230-2/b02_x_ISO230.dat").empty(), kNoRealData);
  const auto set = positioning_test("b02_x");
  const Diagnosis found = diagnosed_real("b02 X", straight(), set);
  // nine targets 5 mm apart, errors of -50 to 73 um with 1.4 um of noise: smooth shapes leave many sigmas
  CHECK(found.verdict == unexplained_structure);
  const auto backlash = std::find_if(found.candidates.begin(), found.candidates.end(),
                                     [](const auto& c) { return stands_for(c, "backlash:X:EX"); });
  REQUIRE(backlash != found.candidates.end());
  CHECK(std::any_of(found.where.begin(), found.where.end(), [](const auto& w) { return w.variable == "x_mm"; }));
  CHECK(std::any_of(found.where.begin(), found.where.end(), [](const auto& w) { return w.variable == "approach"; }));
}
