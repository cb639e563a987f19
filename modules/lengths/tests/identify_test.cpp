// All components from lengths alone: exact lengths give them back, what is not determined is named, uncertainties hold.
// What it costs that variances of noise are estimates: against what is known in closed form.
#include <fmt/format.h>

#include "model/fit/statistics.hpp"
#include "modules/lengths/shared_noise.hpp"
#include "modules/lengths/tests/support/made_lengths.hpp"

namespace ecs::test {
namespace {

using model::Identification;
using model::IdentifiedCurve;
using model::IdentifySettings;

IdentifySettings exact_lengths() { return {.scale_um_per_m = 0.0}; }

std::string why_not(const Identification& found, Component component) {
  for (const IdentifiedCurve& curve : found.curves)
    if (curve.component == component) return curve.why_not;
  return {};
}

TEST_CASE("exact lengths from four stations with three tools give all 21 components back, on every kind of chain") {
  for (const char* configuration : {"TXYZ", "XYTZ", "XTYZ", "YXTZ", "XYZT", "ZTXY"}) {
    CAPTURE(configuration);
    MadeLengths lengths(configuration);
    lengths.stations(7);
    const MadeComponents made(3);
    lengths.measure(made);
    const Identification found = identified(lengths, exact_lengths());
    for (const IdentifiedCurve& curve : found.curves) CHECK_MESSAGE(curve.determined, name_of(curve.component));
    CHECK(found.whole());
    CHECK(farthest_from(found, made, lengths.machine) < 1e-5);
    CHECK(std::abs(found.set_ups[0].station_correction_mm[0] - 0.2) < 1e-6);
  }
}

TEST_CASE("a scale known beforehand counts as an unknown and as an observation") {
  MadeLengths lengths("XYTZ");
  lengths.stations(7);
  lengths.measure(MadeComponents(3));
  const Identification with = identified(lengths, {.scale_um_per_m = 0.1}),
                       without = identified(lengths, exact_lengths());
  CHECK(with.known_values == static_cast<int>(lengths.test.set_ups.size()));
  CHECK(without.known_values == 0);
  CHECK(with.unknowns == without.unknowns + with.known_values);
  CHECK(with.degrees_of_freedom == without.degrees_of_freedom);
}

TEST_CASE("without a second tool what only a tool offset levers is left out, and the rest is whole") {
  MadeLengths lengths("XYTZ");
  lengths.test.tools = {{"A", {0, 0, 0}}};
  for (const Vector3& place : {Vector3{-150, -130, -260}, Vector3{640, -120, -240}, Vector3{620, 510, -250}}) {
    lengths.test.set_ups.push_back(
        {"S" + std::to_string(lengths.test.set_ups.size()), model::LengthInstrument::tracker, place, 0});
    lengths.volume(lengths.test.set_ups.size() - 1, 0, 7);
  }
  const MadeComponents made(4);
  lengths.measure(made);
  const Identification found = identified(lengths, exact_lengths());
  CHECK(found.whole());
  for (const Component idle : {Component::EAZ, Component::EBZ, Component::ECZ})
    CHECK(!found.curves[index_of(idle)].acts);
  CHECK(found.curves[index_of(Component::EAX)].determined);
  CHECK(farthest_from(found, made, lengths.machine) < 1e-5);
}

MadeLengths body_diagonals() {
  MadeLengths lengths("XYTZ");
  lengths.test.tools = {{"A", {0, 0, 0}}};
  for (auto& knots : lengths.test.knots_mm) knots = 1000.0;
  const double length = std::hypot(500.0, 400.0, 300.0);
  for (int bits = 0; bits < 4; ++bits) {
    const Vector3 a{(bits & 1) != 0 ? 500.0 : 0.0, (bits & 2) != 0 ? 400.0 : 0.0, 0.0};
    const Vector3 b{500.0 - a[0], 400.0 - a[1], 300.0};
    lengths.test.set_ups.push_back({"D" + std::to_string(bits + 1),
                                    model::LengthInstrument::interferometer,
                                    {(b[0] - a[0]) / length, (b[1] - a[1]) / length, 300.0 / length},
                                    0});
    lengths.line(lengths.test.set_ups.size() - 1, 0, a, b, 31);
  }
  return lengths;
}

TEST_CASE("body diagonals alone determine no positioning error: they hold it only together with others") {
  MadeLengths lengths = body_diagonals();
  lengths.measure(MadeComponents(5));
  const Identification found = identified(lengths, exact_lengths());
  CHECK(!found.whole());
  CHECK(!found.volume_um.has_value());
  for (const Component c : {Component::EXX, Component::EYY, Component::EZZ}) {
    CAPTURE(why_not(found, c));
    CHECK(contains(why_not(found, c), "only together with"));
  }
}

TEST_CASE("lines along the axes at one height: the rolls are named with the lever that never changes") {
  MadeLengths lengths("XYTZ");
  lengths.test.tools = {{"A", {0, 0, 0}}};
  for (auto& knots : lengths.test.knots_mm) knots = 1000.0;
  const auto line = [&](const Vector3& a, const Vector3& b, const Vector3& along) {
    lengths.test.set_ups.push_back(
        {"L" + std::to_string(lengths.test.set_ups.size()), model::LengthInstrument::interferometer, along, 0});
    for (int run = 1; run <= 3; ++run) lengths.line(lengths.test.set_ups.size() - 1, 0, a, b, 15, run);
  };
  line({0, 0, 0}, {500, 0, 0}, {1, 0, 0});
  line({0, 0, 0}, {0, 400, 0}, {0, 1, 0});
  line({0, 0, 0}, {0, 0, 300}, {0, 0, 1});
  line({0, 400, 0}, {500, 400, 0}, {1, 0, 0});
  lengths.measure(MadeComponents(6));
  const Identification found = identified(lengths, exact_lengths());
  CHECK(found.curves[index_of(Component::EXX)].determined);
  CHECK(found.curves[index_of(Component::EYY)].determined);
  CHECK(found.curves[index_of(Component::EZZ)].determined);
  CHECK(contains(why_not(found, Component::EBX), "has the same Z and tool"));
  CHECK(contains(why_not(found, Component::EYX), "no length looks along Y while X moves"));
  CHECK(contains(found.squareness[0].why_not, "no length is inclined in the plane XY"));
}

TEST_CASE("too few readings: nothing is computed, and every component that they leave open is named") {
  MadeLengths lengths = body_diagonals();
  lengths.test.readings.resize(62);
  lengths.measure(MadeComponents(7));
  const auto refused = must_fail(model::identify(lengths.test, lengths.machine, {}));
  check_holds(to_text(refused), {"readings for", "EXX is not determined"});
}

TEST_CASE("another machine, another chain and poses beyond the travel are refused") {
  MadeLengths lengths("XYTZ");
  lengths.stations(5);
  lengths.test.readings[3].position_mm[0] = 900.0;
  const auto beyond = must_fail(model::identify(lengths.test, lengths.machine, {}));
  CHECK(contains(to_text(beyond), "made.csv:13: expected X within its travel 0 to 500 mm, found 900"));
  const auto chain = must_fail(model::identify(lengths.test, length_test_machine("TXYZ"), {}));
  CHECK(contains(to_text(chain), "of a machine XYTZ, the machine file of TXYZ"));
  CHECK(contains(to_text(model::length_machine(length_test_machine("XTZ")).error()), "three-axis machines"));
}

TEST_CASE("a reading that is wrong is named and left out") {
  MadeLengths lengths("XYTZ");
  lengths.stations(7);
  const MadeComponents made(8);
  lengths.measure(made, 0.2);
  lengths.test.readings[100].deviation_um += 10.0;
  const Identification found = identified(lengths, {});
  CHECK(only(found.outliers).line == 110);
  CHECK(found.outliers[0].residual_um == Approx(10.0).epsilon(0.15));
  IdentifySettings keep{.keep_outliers = true};
  CHECK(identified(lengths, keep).readings == lengths.test.readings.size());
}

std::string notes_in(const Identification& found) {
  std::string text;
  for (const std::string& note : found.notes) text += note + "\n";
  return text;
}

TEST_CASE("a beam lost within a run is told with its line and size, and what is found is as without it") {
  MadeLengths lengths("XYTZ");
  lengths.stations(7);
  const MadeComponents made(8);
  lengths.measure(made, 0.2);
  const Identification before = identified(lengths, {});
  CHECK(!contains(notes_in(before), "jump"));
  const std::size_t first = 2 * lengths.test.readings.size() / 5;
  const model::LengthReading lost = lengths.test.readings[first];
  for (std::size_t i = first; i < lengths.test.readings.size(); ++i) {
    model::LengthReading& r = lengths.test.readings[i];
    if (r.set_up == lost.set_up && r.tool == lost.tool) r.deviation_um += 5.0;
  }
  for (const bool keep_outliers : {false, true}) {
    IdentifySettings settings{.keep_outliers = keep_outliers};
    const Identification found = identified(lengths, settings);
    CAPTURE(notes_in(found));
    CHECK(contains(notes_in(found),
                   fmt::format("set-up {}, tool {}: the lengths jump by +", lengths.test.set_ups[lost.set_up].name,
                               lengths.test.tools[lost.tool].name)));
    CHECK(contains(notes_in(found), fmt::format("at line {} and do not return", lost.line)));
    CHECK(found.outliers.empty());
    CHECK(found.residual_um == Approx(before.residual_um).epsilon(0.05));
    CHECK(farthest_from(found, made, lengths.machine) < 1.1 * farthest_from(before, made, lengths.machine) + 0.05);
  }
}

TEST_CASE("a zero that drifts steadily is no lost beam") {
  MadeLengths lengths("XYTZ");
  lengths.stations(7);
  lengths.measure(MadeComponents(8), 0.2);
  double drift_um = 0.0;
  for (model::LengthReading& r : lengths.test.readings)
    if (r.set_up == 1 && r.tool == 0) r.deviation_um += (drift_um += 0.02);
  const Identification found = identified(lengths, {});
  CAPTURE(notes_in(found));
  CHECK(!contains(notes_in(found), "jump"));
}

TEST_CASE("a component that is declared zero and is none is told, with its size; one that is zero is not") {
  MadeLengths lengths("XYTZ");
  lengths.stations(7);
  MadeComponents made(8);
  made.form[index_of(Component::EBY)] = {};
  lengths.measure(made, 0.2);
  IdentifySettings settings;
  settings.zero[index_of(Component::EBY)] = true;
  CHECK(!contains(notes_in(identified(lengths, settings)), "is declared zero"));
  made.form[index_of(Component::EBY)] = {0.0, 10.0, 0.0, 0.0};  // 10 um/m at the far end of Y
  lengths.measure(made, 0.2);
  const Identification found = identified(lengths, settings);
  CAPTURE(notes_in(found));
  CHECK(contains(notes_in(found), "EBY is declared zero, but the lengths show up to "));
  CHECK(contains(notes_in(found), "at Y 400 mm"));
  CHECK(found.contradictions.size() == 1);
  settings.zero[index_of(Component::EBY)] = false;
  settings.zero[index_of(Component::C0Y)] = true;
  CHECK(contains(notes_in(identified(lengths, settings)), "C0Y is declared zero, but the lengths show "));
}

TEST_CASE("a station 40 mm off is told, whichever of file and nominal lengths has it wrong; 0.3 mm are not") {
  MadeLengths lengths("XYTZ");
  lengths.stations(7);
  const MadeComponents made(8);
  lengths.measure(made, 0.2);
  CHECK(!contains(notes_in(identified(lengths, {})), "set-up"));
  // The nominal lengths count from where the file puts the station, and it stands 40 mm from there.
  lengths.measure(made, 0.2, 1, {0.0, 40.0, 0.0});
  CAPTURE(notes_in(identified(lengths, {})));
  CHECK(contains(notes_in(identified(lengths, {})), "set-up S2, tool A: the station lies 40.0 mm from its position"));
  // It stands where the nominal lengths count from, and the file has another place.
  lengths.measure(made, 0.2);
  lengths.test.set_ups[1].place[0] += 40.0;
  const Identification found = identified(lengths, {});
  CAPTURE(notes_in(found));
  CHECK(contains(notes_in(found), "set-up S2: the lengths start"));
}

TEST_CASE("uncertainties hold: with white noise values lie within the stated 95 % as often as they should") {
  MadeLengths lengths("XYTZ");
  lengths.stations(5);
  std::size_t inside = 0, all = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const MadeComponents made(20 + seed);
    lengths.measure(made, 0.5, seed);
    const Identification found = identified(lengths, {});
    CHECK(found.residual_um == Approx(0.5).epsilon(0.15));
    for (const IdentifiedCurve& curve : found.curves) {
      const auto& travel = lengths.machine.axes[index_of(moving_axis(curve.component))]->travel_mm;
      for (std::size_t i = 1; i < curve.position_mm.size(); ++i) {
        const double part = (curve.position_mm[i] - travel[0]) / (travel[1] - travel[0]);
        const double off = std::abs(curve.forward[i] - made.value(curve.component, part, 1));
        inside += off <= curve.U_forward[i] ? 1U : 0U;
        ++all;
      }
    }
  }
  CHECK(static_cast<double>(inside) / static_cast<double>(all) > 0.90);
  CHECK(static_cast<double>(inside) / static_cast<double>(all) < 0.995);
}

/// Three stations, one tool, lines of 13 targets: Y every 33 mm, knots 100 mm apart.
MadeLengths of_many_targets() {
  MadeLengths lengths("XYTZ");
  for (auto& knots : lengths.test.knots_mm) knots = 100.0;
  lengths.test.tools = {{"A", {0, 0, 0}}};
  for (const Vector3& place : {Vector3{-150, -130, -260}, Vector3{640, -120, -240}, Vector3{620, 510, -250}}) {
    lengths.test.set_ups.push_back(
        {"S" + std::to_string(lengths.test.set_ups.size()), model::LengthInstrument::tracker, place, 0});
    lengths.volume(lengths.test.set_ups.size() - 1, 0, 13);
  }
  return lengths;
}

TEST_CASE("waves of 2.7 knots, which the curves cannot follow, are in U: a fit with more knots shows them") {
  MadeLengths lengths = of_many_targets();
  double inside = 0.0, inside_without = 0.0, all = 0.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    MadeComponents made(60 + seed);
    made.wave = {Component::EXY, 3.0, 270.0 / 400.0, 1.5 * seed};
    lengths.measure(made, 0.3, seed);
    const Identification found = identified(lengths, {});
    const IdentifiedCurve& curve = found.curves[index_of(Component::EXY)];
    for (std::size_t i = 1; i < curve.position_mm.size(); ++i) {
      const double off = curve.forward[i] - made.value(Component::EXY, curve.position_mm[i] / 400.0, 1);
      const double without = std::sqrt(std::pow(curve.U_forward[i], 2) - std::pow(2.0 * curve.u_finer, 2));
      inside += std::abs(off) <= curve.U_forward[i] ? 1.0 : 0.0;
      inside_without += std::abs(off) <= without ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  CHECK(inside >= 0.9 * all);
  CHECK(inside_without < 0.8 * all);
}

TEST_CASE("where the knots are close enough, the comparison with more knots adds little") {
  MadeLengths lengths = of_many_targets();
  double added2 = 0.0, noise2 = 0.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    lengths.measure(MadeComponents(60 + seed), 0.3, seed);
    for (const IdentifiedCurve& curve : identified(lengths, {}).curves) {
      if (!curve.acts) continue;
      added2 += curve.u_finer * curve.u_finer;
      for (const double u : curve.u_forward)
        noise2 += (u * u - curve.u_finer * curve.u_finer) / static_cast<double>(curve.u_forward.size());
    }
  }
  CHECK(added2 < 0.35 * noise2);
}

TEST_CASE("angles that scatter at every stop are told from translations, and uncertainties count their levers") {
  MadeLengths lengths("XYTZ");
  lengths.stations(7);
  lengths.stop_um = 0.4, lengths.stop_um_per_m = 3.0;
  double translations = 0.0, angles = 0.0, off2 = 0.0, stated2 = 0.0;
  constexpr unsigned kSeeds = 8;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const MadeComponents made(40 + seed);
    lengths.measure(made, 0.1, seed);
    const Identification found = identified(lengths, {});
    translations += found.stop_um / kSeeds;
    angles += found.stop_um_per_m / kSeeds;
    for (const auto& square : found.squareness) {
      off2 += std::pow(square.um_per_m - made.value(square.component, 0.0, 0), 2);
      stated2 += square.u_um_per_m * square.u_um_per_m;
    }
  }
  CHECK(translations == Approx(0.4).epsilon(0.25));
  CHECK(angles == Approx(3.0).epsilon(0.15));
  CHECK(off2 < 1.8 * stated2);  // 24 values: beyond once in a hundred
  CHECK(off2 > 0.4 * stated2);
}

TEST_CASE("poses from one side only: the reversal is said to be unknown") {
  MadeLengths lengths("XYTZ");
  lengths.stations(7);
  MadeComponents made(9);
  made.reversal = false;
  std::erase_if(lengths.test.readings, [](const model::LengthReading& r) {
    return r.approach != PerAxis<int>{1, 1, 1};
  });
  lengths.measure(made);
  const Identification found = identified(lengths, exact_lengths());
  REQUIRE(!found.notes.empty());
  CHECK(contains(found.notes[0], "approached from the same side"));
  CHECK(farthest_from(found, made, lengths.machine) < 1e-5);
}

TEST_CASE("the coverage factor is that of tables of Student's t at 95.45 %, and 2 where the noise is known") {
  // GUM table G.2
  const std::pair<double, double> table[] = {{1, 13.97}, {2, 4.53},  {3, 3.31}, {5, 2.65},
                                             {10, 2.28}, {20, 2.13}, {50, 2.05}};
  for (const auto& [freedom, k] : table) CHECK(model::coverage_factor(freedom) == Approx(k).epsilon(0.0025));
  CHECK(model::coverage_factor(0.2) == model::coverage_factor(1.0));
  CHECK(model::coverage_factor(1e5) == Approx(2.0).epsilon(1e-4));
  CHECK(model::coverage_factor(std::numeric_limits<double>::infinity()) == 2.0);
}

TEST_CASE("noise of one variance has the degrees of freedom that the readings leave, and adds nothing") {
  MadeLengths lengths("XYTZ");
  lengths.test.tools = {{"A", {0, 0, 0}}};
  lengths.test.set_ups = {{"X", model::LengthInstrument::interferometer, {1, 0, 0}, 0}};
  lengths.line(0, 0, {0, 0, 0}, {500, 0, 0}, 11);
  model::CurveSettings settings;
  for (double& knots : settings.knots_mm) knots = 500.0;
  const auto machine = must(model::length_machine(lengths.machine));
  const model::MachineCurves curves(machine, settings);
  const Eigen::Index n = 22, p = 3;
  Eigen::MatrixXd direction = Eigen::MatrixXd::Zero(n, 3);
  direction.col(0).setOnes();
  const model::SharedNoise shared(lengths.test, curves, direction);
  std::mt19937 generator(5);
  NormalDraws normal;
  Eigen::MatrixXd columns(n, p);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < p; ++j) columns(i, j) = normal(generator);
  const double variance = 0.3;
  const model::LengthSolution solution = model::solution_of(columns / std::sqrt(variance), Eigen::VectorXd::Zero(n));
  const model::NoiseCertainty sure(shared, solution.basis, solution.back, {variance, 0.0, 0.0, 0.0, 0.0},
                                   {true, false, false, false, false});
  CHECK((sure.covariance() - solution.covariance).norm() < 1e-9 * solution.covariance.norm());
  CHECK(sure.degrees_of_freedom(Eigen::VectorXd(Eigen::VectorXd::Ones(p)), 0) == Approx(static_cast<double>(n - p)));
  CHECK(sure.spread()(0, 0) == Approx(2.0 * variance * variance / static_cast<double>(n - p)));
}

TEST_CASE("where several variances are estimated the covariance grows and the degrees of freedom are fewer") {
  MadeLengths lengths("XYTZ");
  lengths.stations(7);
  lengths.stop_um = 0.6, lengths.stop_um_per_m = 1.0;
  lengths.measure(MadeComponents(3), 0.2, 3);
  const model::Identification found = identified(lengths, {});
  REQUIRE(found.whole());
  for (const auto& square : found.squareness) {
    CHECK(square.degrees_of_freedom > 5.0);
    CHECK(square.degrees_of_freedom < found.degrees_of_freedom);
    CHECK(square.U_um_per_m > 2.0 * square.u_um_per_m);
    CHECK(square.U_um_per_m < 2.7 * square.u_um_per_m);
  }
  CHECK(*found.volume_U_um > 2.0 * *found.volume_um);
}

}  // namespace
}  // namespace ecs::test
