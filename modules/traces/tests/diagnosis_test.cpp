#include "modules/traces/diagnosis.hpp"

#include <random>

#include "base/random.hpp"
#include "modules/traces/tests/true_drive.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using enum ecs::model::DriveConstant;
using enum ecs::model::DriveVerdict;

namespace {

struct Recorder {
  double quantum = 0.02, noise = 0.008, trigger_s = 0.02, seconds = 0.8, interval_s = 0.001, edge = 1e9;
  unsigned seed = 1;
  bool tacho = false;
};

/// What a recorder shows of an axis: through the reader, so that noise and clipping are found as in a file.
DriveTrace recorded(const DriveParameters& drive, const Recorder& recorder = {}, const DriveMove& move = {}) {
  const DriveResponse response = simulated(drive, move, recorder.seconds + 2.0);
  std::mt19937_64 random(recorder.seed);
  NormalDraws normal;
  const auto shown = [&](double v, double part) {
    v = std::clamp(v + part * recorder.noise * normal(random), -recorder.edge, recorder.edge);
    return std::round(v / (part * recorder.quantum)) * part * recorder.quantum;
  };
  std::string text = "# feed_mm_min: " + std::to_string(move.feed_mm_min) +
                     "\n# distance_mm: " + std::to_string(move.distance_mm) + "\ntime_s,dac_V" +
                     (recorder.tacho ? ",tacho_V\n" : "\n");
  for (double t = 0.0; t < recorder.seconds; t += recorder.interval_s) {
    text += std::to_string(t) + "," + std::to_string(shown(response.at(DriveSignal::dac, t - recorder.trigger_s), 1.0));
    if (recorder.tacho)
      text += "," + std::to_string(shown(response.at(DriveSignal::tacho, t - recorder.trigger_s), 0.5));
    text += "\n";
  }
  return parse_trace(text, "step.csv").value();
}

std::vector<DriveConstant> names_of(const DriveCandidate& candidate) {
  std::vector<DriveConstant> names;
  for (const DriveChange& change : candidate.alternatives) names.push_back(change.constant);
  std::sort(names.begin(), names.end());
  return names;
}

/// The one candidate that explains, for a true axis and the axis as believed.
DriveCandidate named(const DriveParameters& truth, const DriveParameters& believed, const Recorder& recorder = {}) {
  const DriveDiagnosis found = diagnose_drive(believed, recorded(truth, recorder));
  CHECK(found.verdict == wrong_constant);
  REQUIRE_FALSE(found.candidates.empty());
  CHECK(found.candidates.front().explains);
  return found.candidates.front();
}

}  // namespace

TEST_CASE(
    "a step recorded by another program: the printed tacho gain is ten times too large, or K ten times too small") {
  const auto trace = must(read_trace("samples/rig/step_recorded.csv"));
  const auto drive = must(read_drive("samples/rig/drive_as_printed.toml"));
  const DriveDiagnosis found = diagnose_drive(drive, trace);
  CHECK(found.verdict == wrong_constant);
  CHECK(found.observations == 801);
  CHECK(found.rms_V > 5.0);
  CHECK(*found.measured.steady == Approx(2.98).epsilon(0.004));
  CHECK(*found.as_given.steady > 9.0);
  CHECK(*found.mended.steady == Approx(2.98).epsilon(0.004));
  CHECK(*found.mended.rise_s == Approx(0.067).epsilon(0.03));
  CHECK(*found.mended.decay_start_s == Approx(0.50).epsilon(0.01));
  CHECK(found.start_s == Approx(0.020).epsilon(0.03));

  REQUIRE_FALSE(found.candidates.empty());
  const DriveCandidate& first = found.candidates.front();
  CHECK(first.explains);
  CHECK_FALSE(first.together);
  CHECK(names_of(first) == std::vector{K, Kw});
  for (const DriveChange& change : first.alternatives) {
    if (change.constant == Kw) {
      CHECK(change.factor == Approx(0.1).epsilon(0.01));
      CHECK(std::abs(change.value - 0.0632298) < 3.0 * change.sigma);
      CHECK(change.sigma < 0.001);
    } else {
      CHECK(change.factor == Approx(10.0).epsilon(0.01));
    }
    CHECK(change.rms_after < found.floor_V);
  }
  REQUIRE(first.separated_by == std::vector{DriveSignal::tacho});
  CHECK(first.signals.front().peak == Approx(0.993).epsilon(0.01));
  CHECK(only(first.signals.front().members).peak == Approx(9.93).epsilon(0.01));
  for (std::size_t i = 1; i < found.candidates.size(); ++i) CHECK_FALSE(found.candidates[i].explains);
}

TEST_CASE("with the tacho voltage recorded too, K and Kw are no group any more") {
  Recorder recorder;
  recorder.tacho = true;
  CHECK(names_of(named(true_drive(), DriveParameters{}, recorder)) == std::vector{Kw});
  DriveParameters other;  // the amplifier's scaling is the culprit, the tacho as printed
  other[K] = 10.0 / 3.0;
  CHECK(names_of(named(other, DriveParameters{}, recorder)) == std::vector{K});
}

TEST_CASE("a drive as believed agrees with its recording, whatever noise, trigger and samples") {
  for (unsigned seed = 1; seed <= 6; ++seed)
    for (const double noise : {0.0, 0.008, 0.03}) {
      Recorder recorder{
          .noise = noise, .trigger_s = 0.003 + 0.01 * seed, .interval_s = seed % 2 == 0 ? 0.0005 : 0.002, .seed = seed};
      const DriveDiagnosis found = diagnose_drive(true_drive(), recorded(true_drive(), recorder));
      CHECK(found.verdict == agrees);
      CHECK(found.candidates.empty());
      CHECK(found.start_s == Approx(recorder.trigger_s).epsilon(0.05));
    }
}

TEST_CASE("each constant that the D/A voltage shows is named, with those that act like it") {
  const auto with = [](DriveConstant constant, double factor) {
    DriveParameters believed = true_drive();
    believed[constant] *= factor;
    return named(true_drive(), believed);
  };
  const DriveCandidate gain = with(Kd, 1.3);
  CHECK(names_of(gain) == std::vector{Kd, Ke});
  CHECK(gain.alternatives.front().factor == Approx(1.0 / 1.3).epsilon(0.01));
  CHECK(gain.separated_by.empty());  // only the product of the two acts on anything that can be measured
  CHECK(names_of(with(pitch, 0.8)) == std::vector{pitch});
  CHECK(names_of(with(Kw, 0.7)) == std::vector{K, Kw});
  CHECK(names_of(with(J1, 30.0)) == std::vector{J1});  // the motor's own inertia cannot be taken below nothing
}

TEST_CASE("an axis heavier than assumed: no signal separates the inertias, the current separates the gains") {
  DriveParameters truth = true_drive();
  truth[J1] = 0.01;
  const DriveCandidate group = named(truth, true_drive());
  CHECK(names_of(group) == std::vector{Ka, Kt, Jm, J1});
  CHECK(group.separated_by.empty());
  const auto current = std::find_if(group.signals.begin(), group.signals.end(),
                                    [](const auto& s) { return s.signal == DriveSignal::current; });
  REQUIRE(current != group.signals.end());
  for (const MemberDifference& m : current->members) {
    if (m.member == J1 || m.member == Jm) CHECK(m.relative < 1e-3);
    if (m.member == Kt) CHECK(m.relative > kClearDifference);
  }
  DriveParameters believed = true_drive();  // and with the tacho gain ten times too large beside it
  believed[Kw] *= 10.0;
  const DriveDiagnosis found = diagnose_drive(believed, recorded(truth));
  CHECK(found.verdict == wrong_constants);
}

TEST_CASE("a limit of the converter is found") {
  DriveParameters truth = true_drive();
  truth[dac_limit] = 2.0;
  const DriveCandidate limit = named(truth, true_drive());
  CHECK(names_of(limit) == std::vector{dac_limit});
  CHECK(limit.alternatives.front().value == Approx(2.0).epsilon(0.01));
}

TEST_CASE("what the recording does not show is reported") {
  const DriveDiagnosis found = diagnose_drive(true_drive(), recorded(true_drive()));
  CHECK(std::find(found.silent.begin(), found.silent.end(), Ks) != found.silent.end());
  CHECK(std::find(found.silent.begin(), found.silent.end(), dac_limit) != found.silent.end());
  CHECK(std::find(found.silent.begin(), found.silent.end(), Kw) == found.silent.end());
}

TEST_CASE("two wrong constants are named together only where no single one does") {
  DriveParameters believed = true_drive();
  believed[Kw] *= 10.0;
  believed[Kd] *= 0.6;
  const DriveDiagnosis found = diagnose_drive(believed, recorded(true_drive()));
  CHECK(found.verdict == wrong_constants);
  REQUIRE_FALSE(found.candidates.empty());
  CHECK(found.candidates.front().together);
  const bool among = std::any_of(found.candidates.begin(), found.candidates.end(), [](const DriveCandidate& c) {
    if (!c.together || !c.explains) return false;
    std::vector<DriveConstant> all = names_of(c);
    all.insert(all.end(), c.like_first.begin(), c.like_first.end());
    all.insert(all.end(), c.like_second.begin(), c.like_second.end());
    return std::count(all.begin(), all.end(), Kw) == 1 && std::count(all.begin(), all.end(), Kd) == 1;
  });
  CHECK(among);
}

TEST_CASE("a recorder that clips, or was triggered late, still gives the constant") {
  Recorder clipping;
  clipping.edge = 2.0;
  CHECK(names_of(named(true_drive(), DriveParameters{}, clipping)) == std::vector{K, Kw});
  Recorder late;
  late.trigger_s = -0.2;
  CHECK(names_of(named(true_drive(), DriveParameters{}, late)) == std::vector{K, Kw});
}

TEST_CASE("an axis that saturates, assumed healthy, is recognised in the recording") {
  Recorder recorder{.quantum = 0.08, .noise = 0.03, .seconds = 2.5};
  const DriveCandidate found = named(DriveParameters{}, true_drive(), recorder);
  CHECK(names_of(found) == std::vector{K, Kw});
  CHECK(diagnose_drive(DriveParameters{}, recorded(DriveParameters{}, recorder)).verdict == agrees);
}

TEST_CASE("a recording of something else is called unexplained") {
  DriveTrace trace = recorded(true_drive());
  for (std::size_t k = 0; k < trace.time_s.size(); ++k)
    trace.signals[0].value[k] += 0.6 * std::sin(40.0 * trace.time_s[k]);
  const DriveDiagnosis found = diagnose_drive(true_drive(), trace);
  CHECK(found.verdict == unexplained);
  for (const DriveCandidate& c : found.candidates) CHECK_FALSE(c.explains);
}

TEST_CASE("a few glitches of the recorder do not change the answer") {
  DriveTrace trace = recorded(true_drive());
  for (const std::size_t k : {50U, 300U, 301U, 620U}) trace.signals[0].value[k] += 4.0;
  const DriveDiagnosis found = diagnose_drive(DriveParameters{}, trace);
  CHECK(found.verdict == wrong_constant);
  REQUIRE_FALSE(found.candidates.empty());
  CHECK(names_of(found.candidates.front()) == std::vector{K, Kw});
}
