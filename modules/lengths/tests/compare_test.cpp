// A map beside lengths: maps made of known components, lengths computed from the same ones by the term table alone.
#include "modules/lengths/compare_lengths.hpp"
#include "modules/lengths/tests/support/made_lengths.hpp"
#include "params/machine.hpp"

namespace ecs::test {
namespace {

struct MadeMap {
  laser::ErrorMap map;
  UnitParameters parameters;
};

/// Tables of both approaches every 5 mm, so fine that lines between the points cost a thousandth of a micrometre.
MadeMap map_of(const MadeComponents& made, const params::Machine& machine) {
  MadeMap out;
  std::ranges::copy(machine.configuration, out.parameters.configuration.begin());
  out.parameters.measurement_lines_mm = params::measurement_lines_of(machine);
  for (std::size_t c = 0; c < kComponents; ++c) {
    const auto component = static_cast<Component>(c);
    if (is_squareness(component)) {
      squareness_um_per_m(out.parameters, component) = made.value(component, 0.0, 0);
      continue;
    }
    const auto& travel = machine.axes[index_of(moving_axis(component))]->travel_mm;
    for (const Approach approach : {Approach::forward, Approach::reverse}) {
      laser::MapTable table{component, approach, {}, {}};
      const int points = static_cast<int>((travel[1] - travel[0]) / 5.0) + 1;
      for (int i = 0; i < points; ++i) {
        const double p = travel[0] + 5.0 * i;
        table.position_mm.push_back(p);
        table.compensation.push_back(
            -made.value(component, (p - travel[0]) / (travel[1] - travel[0]), approach == Approach::forward ? 1 : -1));
      }
      out.map.tables.push_back(std::move(table));
    }
  }
  return out;
}

model::LengthComparison compared(const MadeLengths& lengths, const MadeMap& made) {
  return must(model::compared_lengths(lengths.test, made.map, made.parameters, 3));
}

TEST_CASE("a map of the true curves explains every length, on every chain, with stations millimetres off") {
  for (const char* configuration : {"TXYZ", "XYTZ", "YXTZ"}) {
    CAPTURE(configuration);
    MadeLengths lengths(configuration);
    lengths.stations(7);
    const MadeComponents made(3);
    lengths.measure(made, 0.0, 1, {5.0, -3.0, 4.0});
    const model::LengthComparison found = compared(lengths, map_of(made, lengths.machine));
    CHECK(found.readings == lengths.test.readings.size());
    CHECK(found.unknowns == 12 * 4);  // a station and a zero of each set-up and tool
    CHECK(found.error_um > 2.0);
    CHECK(found.left_um < 0.01);
    CHECK(found.agreement() > 0.998);
    for (const model::ComparedSetUp& set_up : found.set_ups) {
      CHECK(set_up.station_correction_mm[0] == Approx(5.0).epsilon(1e-4));
      CHECK(set_up.station_correction_mm[1] == Approx(-3.0).epsilon(1e-4));
      CHECK(set_up.station_correction_mm[2] == Approx(4.0).epsilon(1e-4));
    }
  }
}

TEST_CASE("what the map leaves has the size of the noise, and of a component that it lacks") {
  MadeLengths lengths("XYTZ");
  lengths.stations(7);
  const MadeComponents made(5);
  constexpr double kNoise_um = 0.4;
  lengths.measure(made, kNoise_um, 7);
  MadeMap whole = map_of(made, lengths.machine);
  const model::LengthComparison with = compared(lengths, whole);
  const double n = static_cast<double>(with.readings - 48);
  CHECK(std::abs(with.left_um / kNoise_um - 1.0) < 4.0 / std::sqrt(2.0 * n));  // four standard deviations
  squareness_um_per_m(whole.parameters, Component::C0Y) += 30.0;
  const model::LengthComparison without = compared(lengths, whole);
  CHECK(without.left_um > 3.0 * with.left_um);
  CHECK(without.agreement() < with.agreement());
  REQUIRE(without.worst.size() == 3);
  CHECK(std::abs(without.worst[0].left_um) >= std::abs(without.worst[1].left_um));
  CHECK(without.error_um == with.error_um);
}

TEST_CASE("along an interferometer's beam the map is the error along it, less the zero of each run") {
  MadeLengths lengths("XYTZ");
  lengths.test.tools = {{"A", {0.0, 0.0, 0.0}}};
  lengths.test.set_ups = {{"L1", model::LengthInstrument::interferometer, {1.0, 0.0, 0.0}, 0}};
  for (const int run : {1, 2}) lengths.line(0, 0, {0.0, 200.0, 100.0}, {500.0, 200.0, 100.0}, 11, run);
  const MadeComponents made(6);
  lengths.measure(made);
  const model::LengthComparison found = compared(lengths, map_of(made, lengths.machine));
  CHECK(found.unknowns == 2);
  CHECK(found.left_um < 0.01);
  REQUIRE(found.repeat_um);
  CHECK(*found.repeat_um < 1e-9);
}

TEST_CASE("as many zeros as lengths prove nothing, and that is said") {
  MadeLengths lengths("XYTZ");
  lengths.test.tools = {{"A", {0.0, 0.0, 0.0}}};
  lengths.test.set_ups = {{"L1", model::LengthInstrument::interferometer, {1.0, 0.0, 0.0}, 0}};
  for (int run = 1; run <= 4; ++run)
    lengths.test.readings.push_back({10 + run, 0, 0, run, {100.0 * run, 0.0, 0.0}, {1, 1, 1}, 2.0});
  const auto found =
      model::compared_lengths(lengths.test, {}, map_of(MadeComponents(1), lengths.machine).parameters, 3);
  REQUIRE_FALSE(found);
  CHECK(
      found.error().message ==
      "expected more lengths than unknown zeros and stations, found 4 lengths and 4 unknowns: measure more lengths in "
      "each run");
}

}  // namespace
}  // namespace ecs::test
