// Measurements of real machines and instruments, made by others: what the tool says, and whether a person would agree.
// Skips where the shared data are absent.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <sstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "base/text.hpp"
#include "laser/import/import.hpp"
#include "tests/support/measured_lines.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using doctest::Approx;
using enum EffectId;
using enum Verdict;
using Set = laser::MeasurementSet;

namespace {

/// Text of a shared file; nothing, said as a message, where it is absent.
std::optional<std::string> shared_text(const std::string& file) {
  const char* shared = std::getenv("ECS_SHARED_DATA");
  const std::filesystem::path path = std::filesystem::path(shared != nullptr ? shared : "../shared/data") / file;
  if (!std::filesystem::exists(path)) {
    const std::string why = "skipped: no " + path.string();
    MESSAGE(why);
    return std::nullopt;
  }
  return read_file(path).value();
}

/// Numbers of a line, separated by blanks or commas; empty where something else stands among them.
std::vector<double> numbers_in(std::string_view line) {
  std::string text(line);
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream words(text);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    const auto number = number_in(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

laser::Reading& added(Set& set, Axis axis, Sense sense, const Vector3& position_mm, double error) {
  laser::Reading r;
  r.row = static_cast<int>(set.readings.size()) + 1;
  r.axis = axis;
  r.sense = sense;
  r.position_mm = position_mm;
  r.error = error;
  return set.readings.emplace_back(r);
}

Model offsets(const std::vector<std::pair<Axis, Sense>>& places) {
  Model model;
  for (const auto& [axis, sense] : places) model.effects.push_back(effect(offset, axis, sense));
  return model;
}

bool stands_for(const Candidate& candidate, const std::string& place) {
  const auto& group = candidate.indistinguishable_from;
  return to_text(candidate.effect) == place || std::find(group.begin(), group.end(), place) != group.end();
}

std::string told(const Diagnosis& found) {
  std::ostringstream text;
  text << name_of(found.verdict) << ", rms " << found.rms_um << " -> " << found.rms_after_um << ", noise "
       << found.noise.noise_um;
  for (const Candidate& c : found.candidates) {
    if (&c - found.candidates.data() > 3) break;
    text << "\n  " << (c.named ? "named " : "      ") << to_text(c.effect) << ' ' << c.effect.sensor << " rms "
         << c.rms_after_um;
    for (const ParameterEstimate& parameter : c.parameters) text << ' ' << parameter.name << '=' << parameter.value;
    for (const std::string& other : c.indistinguishable_from) text << " | " << other;
  }
  return text.str();
}

Diagnosis diagnosed_real(const char* what, const Model& model, const Set& set,
                         const std::optional<params::Machine>& machine = std::nullopt) {
  const auto result = diagnose(model, observations_of(set, model, machine));
  REQUIRE(result);
  const std::string answer = std::string(what) + ": " + told(*result);
  MESSAGE(answer);
  return *result;
}

/// Positioning tests of motion axes, five cycles, absolute positions in mm.
std::optional<Set> positioning_test(const std::string& name) {
  const auto text = shared_text("ecmc-iso230-2/" + name + "_ISO230.dat");
  if (!text) return std::nullopt;
  laser::ImportOptions options;
  options.axis = Axis::X;
  return laser::parse_any(*text, name + ".dat", options).value().set;
}

/// Hole positions of drilled plates: errors in um over the nominal place.
std::optional<Set> plate(const std::string& name) {
  const auto text = shared_text("sdss-plugplate-cmm/" + name);
  if (!text) return std::nullopt;
  Set set;
  for (const std::string_view line : lines_of(*text)) {
    const auto n = numbers_in(line);
    if (n.size() < 6) continue;
    added(set, Axis::X, Sense::EX, {n[2], n[3], 0.0}, 1000.0 * n[4]);
    added(set, Axis::Y, Sense::EY, {n[2], n[3], 0.0}, 1000.0 * n[5]);
  }
  return set;
}

EffectInstance user_term(const char* name, const char* parameter, const char* in_x, const char* in_y) {
  EffectInstance one;
  one.id = user;
  one.name = name;
  one.formulas = {{Sense::EX, in_x}, {Sense::EY, in_y}};
  one.user = {{parameter, "um/m", {}, {}, {}, {}}};
  return one;
}
EffectInstance rotation() { return user_term("rotation", "rot", "-rot*y_mm/1000", "rot*x_mm/1000"); }
EffectInstance magnification() { return user_term("magnification", "mag", "mag*x_mm/1000", "mag*y_mm/1000"); }

/// A trigger point probed for 47 minutes while a printer is heated and cooled, sensors interpolated to the probings.
std::optional<Set> probing(const std::string& name) {
  const auto text = shared_text("zprobe-thermal-drift/probe_accuracy_" + name + ".json");
  if (!text) return std::nullopt;
  struct Temperatures {
    double t = 0.0, bed = 0.0, nozzle = 0.0, chamber = 0.0;
  };
  std::vector<Temperatures> warm;
  std::vector<std::pair<double, double>> probed;
  for (const std::string_view line : lines_of(*text)) {
    if (trimmed(line).empty()) continue;
    const auto object = nlohmann::json::parse(line);
    if (object.contains("z"))
      probed.emplace_back(object["ts"], object["z"]);
    else
      warm.push_back({object["ts"], object["btemp"], object["etemp"], object["atherms"][0]["temp"]});
  }
  Set set;
  for (const auto& [t, z] : probed) {
    const auto after = std::find_if(warm.begin(), warm.end(), [at = t](const auto& w) { return w.t >= at; });
    if (after == warm.begin() || after == warm.end()) continue;
    const Temperatures &a = *(after - 1), &b = *after;
    const double part = (t - a.t) / (b.t - a.t);
    laser::Reading& r = added(set, Axis::Z, Sense::EZ, {}, 1000.0 * z);
    r.time_s = t - probed.front().first;
    r.sensors_degC = {{"t_bed_degC", std::lerp(a.bed, b.bed, part)},
                      {"t_nozzle_degC", std::lerp(a.nozzle, b.nozzle, part)},
                      {"t_chamber_degC", std::lerp(a.chamber, b.chamber, part)}};
  }
  return set;
}

}  // namespace

TEST_CASE("a step gauge on a simulated CMM of known errors: the scale of X is named with the laboratory's value") {
  const auto text = shared_text("msl-cmm-simulated/bar_fulldata.csv");
  if (!text) return;
  Set set;
  for (const std::string_view line : lines_of(*text)) {
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

TEST_CASE("an interferometer after its ellipse correction: four periods in one fringe") {
  const auto text = shared_text("interferometer-interpolation-error/X_Heydemann.csv");
  if (!text) return;
  Set set;
  int line_number = 0;
  for (const std::string_view line : lines_of(*text))
    if (const auto n = numbers_in(line); n.size() == 3 && ++line_number % 20 == 0)
      added(set, Axis::X, Sense::EX, {n[0], 0.0, 0.0}, n[2]);  // phase in degrees for a position
  const Diagnosis found = diagnosed_real("interferometer", offsets({{Axis::X, Sense::EX}}), set);
  CHECK(found.verdict == missing_effect);
  REQUIRE_FALSE(found.candidates.empty());
  CHECK(stands_for(found.candidates.front(), "cyclic:X:EX"));
  CHECK(found.candidates.front().parameters.front().value == Approx(90.0).epsilon(0.01));
}

TEST_CASE("a drilled plate: turned and magnified as its makers' own fit says") {
  const auto set = plate("D8131_1");
  if (!set) return;
  Model model = offsets({{Axis::X, Sense::EX}, {Axis::Y, Sense::EY}});
  model.effects.push_back(rotation());
  model.effects.push_back(magnification());
  const auto fitted = fit(model, observations_of(*set, model, std::nullopt), {true});
  REQUIRE(fitted);
  // fit_8131_1: offset -0.044 0.079 mm, scale 1.000007, rotation 0.029 deg; root mean square of its 82 distances 8.17
  // um
  CHECK(fitted->effects[0].parameters[0].value == Approx(-44.0).epsilon(0.03));
  CHECK(fitted->effects[1].parameters[0].value == Approx(79.0).epsilon(0.03));
  CHECK(fitted->effects[2].parameters[0].value == Approx(0.029 * std::numbers::pi / 180.0 * 1e6).epsilon(0.02));
  CHECK(fitted->effects[3].parameters[0].value == Approx(7.0).epsilon(0.1));
  CHECK(fitted->rms_um * std::numbers::sqrt2 == Approx(8.175).epsilon(0.002));
}

TEST_CASE("two drilled plates: a rotation among the candidates is named first; one plate has grown or shrunk besides") {
  for (const char* name : {"D1413_1", "D2130_1"}) {
    const auto set = plate(name);
    if (!set) return;
    Model model = offsets({{Axis::X, Sense::EX}, {Axis::Y, Sense::EY}});
    model.candidates = {rotation()};
    const Diagnosis found = diagnosed_real(name, model, *set, mill());
    CHECK(found.verdict == missing_effect);
    REQUIRE_FALSE(found.candidates.empty());
    CHECK(found.candidates.front().effect.name == "rotation");
    for (const Candidate& c : found.candidates)
      if (c.named) CHECK((c.effect.name == "rotation" || c.effect.id == scale));
    model.effects.push_back(rotation());
    CHECK(diagnosed_real("with the rotation", model, *set, mill()).verdict == adequate);
  }
}

TEST_CASE("a servo pushed from either side: its slack is named as backlash") {
  const auto text = shared_text("servo-backlash/motor_telemetry_single.csv");
  if (!text) return;
  // Servo 5 alternates between two targets; three samples of each rest, 0.8 s after the command, in encoder counts.
  Set set;
  double target = std::nan("");
  int sense = 0, since = 0, sample = 0;
  for (const std::string_view line : lines_of(*text)) {
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

TEST_CASE("a positioning test whose curve no library shape makes: backlash is told, the rest is structure over x") {
  const auto set = positioning_test("b02_x");
  if (!set) return;
  const Diagnosis found = diagnosed_real("b02 X", straight(), *set);
  // nine targets 5 mm apart, errors of -50 to 73 um with 1.4 um of noise: smooth shapes leave many sigmas
  CHECK(found.verdict == unexplained_structure);
  const auto backlash = std::find_if(found.candidates.begin(), found.candidates.end(),
                                     [](const auto& c) { return stands_for(c, "backlash:X:EX"); });
  REQUIRE(backlash != found.candidates.end());
  CHECK(std::any_of(found.where.begin(), found.where.end(), [](const auto& w) { return w.variable == "x_mm"; }));
  CHECK(std::any_of(found.where.begin(), found.where.end(), [](const auto& w) { return w.variable == "approach"; }));
}

TEST_CASE("a very good stage: no more than a wiggle of tens of nanometres") {
  const auto set = positioning_test("fat_sat");
  if (!set) return;
  const Diagnosis found = diagnosed_real("fat_sat", straight(), *set);
  for (const Candidate& c : found.candidates) CHECK_FALSE(c.named);
  CHECK(found.rms_um < 0.05);
}

TEST_CASE("a probe while a printer heats: the drift follows the temperatures, the bed's or the nozzle's first") {
  for (const char* name : {"GX-H12A", "GX-H8A", "N3F-H4NB", "superpinda"}) {
    const auto set = probing(name);
    if (!set) return;
    const Diagnosis found = diagnosed_real(name, offsets({{Axis::Z, Sense::EZ}}), *set);
    CHECK(found.verdict != adequate);
    REQUIRE_FALSE(found.candidates.empty());
    const auto best = std::min_element(found.candidates.begin(), found.candidates.end(),
                                       [](const auto& a, const auto& b) { return a.rms_after_um < b.rms_after_um; });
    CHECK(best->effect.id == thermal_drift);
    const bool heater = best->effect.sensor == "t_bed_degC" || best->effect.sensor == "t_nozzle_degC";
    CHECK(heater);
    CHECK(best->explained > 0.6);
  }
}
