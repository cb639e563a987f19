#include "model/regression/regressors.hpp"

#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

/// One reading: X moved to 500 mm at y = 200, z = 300, reverse, EX, with every cell.
laser::MeasurementSet one_reading() {
  laser::MeasurementSet set;
  for (int i = 0; i < 2; ++i) {  // a first reading sets the zero of time and temperature
    Reading r{.row = i + 1,
              .position_mm = {i == 0 ? 0.0 : 500.0, 200.0, 300.0},
              .approach = i == 0 ? Approach::forward : Approach::reverse,
              .time_s = i == 0 ? 0.0 : 1800.0,
              .feed_mm_min = 3000.0,
              .load_kg = 200.0,
              .travel_since_reversal_mm = i == 0 ? 0.0 : 20.0,
              .pressure_hPa = 1013.25,
              .humidity_pct = 50.0,
              .sensors_degC = {{"t_material_degC", i == 0 ? 20.0 : 22.0}, {"t_air_degC", i == 0 ? 20.0 : 21.0}}};
    set.readings.push_back(r);
  }
  return set;
}

/// The columns of an effect in the second reading.
Eigen::RowVectorXd row_of(const EffectInstance& one, double nonlinear = 0.0, const char* chain = "TXYZ") {
  const Observations data = observations_of(one_reading(), Model{}, mill(chain));
  const Regressors regressors(data);
  return regressors.columns(one, nonlinear).of.row(1);
}

}  // namespace

TEST_CASE("the columns of every effect have the values that a hand computes") {
  const auto ex = [](EffectId id) { return effect(id, Axis::X, Sense::EX); };
  CHECK(row_of(ex(offset))(0) == 1.0);
  CHECK(row_of(ex(scale))(0) == Approx(0.5));
  CHECK(row_of(ex(backlash))(0) == -0.5);
  CHECK(row_of(ex(step), 499.0)(0) == 1.0);
  CHECK(row_of(ex(step), 501.0)(0) == 0.0);
  CHECK(row_of(ex(sag))(0) == Approx(0.25));
  CHECK(row_of(ex(sag))(1) == Approx(0.125));
  CHECK(row_of(ex(cyclic), 2000.0)(0) == Approx(1.0));  // a quarter of a period
  CHECK(row_of(ex(cyclic), 2000.0)(1) == Approx(0.0));
  CHECK(row_of(ex(cyclic), 2000.0)(3) == Approx(-1.0));  // half a period of the second harmonic
  CHECK(row_of(ex(thermal_scale))(0) == Approx(1.0));    // 0.5 m · 2 degC
  EffectInstance drift = ex(thermal_drift);
  drift.sensor = "t_material_degC";
  CHECK(row_of(drift)(0) == Approx(2.0));
  CHECK(row_of(ex(warm_up), 1800.0)(0) == Approx(1.0 - std::exp(-1.0)));
  CHECK(row_of(ex(warm_up), 1800.0)(1) == Approx(0.5 * (1.0 - std::exp(-1.0))));
  CHECK(row_of(ex(time_drift))(0) == Approx(0.5));  // hours
  CHECK(row_of(ex(cosine))(0) == Approx(-0.25));    // 1 mrad over 500 mm: 0.25 um
  CHECK(row_of(ex(servo_lag))(0) == Approx(-3.0));
  CHECK(row_of(ex(load))(1) == Approx(100.0));
  CHECK(row_of(ex(reversal_spike), 20.0)(0) == Approx(-std::exp(-1.0)));
  // air 1 degC warmer: the index falls by 0.95e-6 (Edlén), so 0.5 m is shown 0.48 um shorter
  CHECK(row_of(ex(air_refraction))(0) == Approx(-0.477).epsilon(0.01));
  CHECK(row_of(ex(dead_path))(0) == Approx(-0.954).epsilon(0.01));
}

TEST_CASE("a rotation acts with the levers of the chain, squareness with the position of the other axis") {
  EffectInstance roll{.id = angular, .axis = Axis::X, .code = Component::ECX};
  CHECK(row_of(roll)(0) == Approx(-0.2));  // TXYZ: E_X = −ECX·Y
  roll.code = Component::EBX;
  CHECK(row_of(roll)(0) == Approx(0.3));  // TXYZ: E_X = EBX·Z
  EffectInstance lean{.id = squareness, .axis = Axis::Y, .code = Component::C0Y};
  CHECK(row_of(lean)(0) == Approx(-0.2));
}

TEST_CASE("an effect of approach leaves readings of unknown approach and of other axes alone") {
  auto set = one_reading();
  set.readings[1].approach = Approach::unknown;
  const Observations data = observations_of(set, Model{}, mill());
  const Regressors regressors(data);
  CHECK(regressors.acting(effect(backlash, Axis::X, Sense::EX)).rows.size() == 1);
  CHECK(regressors.acting(effect(backlash, Axis::Y, Sense::EX)).rows.empty());
  CHECK(regressors.acting(effect(scale, Axis::X, Sense::EX)).rows.size() == 2);
}

TEST_CASE("a reading without the cell that an effect needs is skipped and counted") {
  auto set = one_reading();
  set.readings[0].load_kg = std::nullopt;
  const Observations data = observations_of(set, Model{}, mill());
  const Acting acting = Regressors(data).acting(effect(load, Axis::X, Sense::EX));
  CHECK(acting.rows.size() == 1);
  CHECK(acting.skipped == 1);
  CHECK(acting.lacking == "load_kg");
}

TEST_CASE("faults of a map act on compensated readings with the map's own values") {
  Model model;
  model.map = laser::ErrorMap{};
  for (const Approach a : {Approach::forward, Approach::reverse})
    model.map->tables.push_back({Component::EXX, a, {0.0, 1000.0}, {0.0, a == Approach::forward ? 10.0 : 14.0}});
  auto set = one_reading();
  const Observations data = observations_of(set, model, mill());
  const Regressors regressors(data);
  const auto at = [&](EffectId id, double value) { return regressors.columns(effect(id, Axis::X, Sense::EX), value); };
  CHECK(at(map_polarity, 0.0).fixed(1) == Approx(-14.0));       // −2 · 7
  CHECK(at(map_gain, 0.0).of(1, 0) == Approx(7.0));             // (g − 1) · 7
  CHECK(at(map_shift, 100.0).fixed(1) == Approx(1.4));          // 14/m · 0.1 m
  CHECK(at(map_direction_swap, 0.0).fixed(1) == Approx(-2.0));  // 5 − 7
  set.readings[1].compensated = false;
  const Observations off = observations_of(set, model, mill());
  CHECK(Regressors(off).columns(effect(map_gain, Axis::X, Sense::EX), 0.0).of(1, 0) == 0.0);
}

TEST_CASE("curve functions have neither mean nor slope over the measured positions") {
  std::vector<double> positions;
  for (int i = 0; i < 37; ++i) positions.push_back(-3.0 * i - 0.4 * (i % 3));
  const CurveBasis basis(positions, 14);
  REQUIRE(basis.size() == 14);
  for (std::size_t k = 0; k < basis.size(); ++k) {
    double sum = 0.0, moment = 0.0;
    for (const double at : positions) {
      sum += basis.value(k, at);
      moment += basis.value(k, at) * at;
    }
    CHECK(std::abs(sum) < 1e-9);
    CHECK(std::abs(moment) < 1e-6);
  }
}

TEST_CASE("levers tell an angular error apart only where a target sees it through more than one") {
  EffectInstance pitch = effect(angular, Axis::X, Sense::EX);
  pitch.sense.reset();
  pitch.code = Component::EBX;
  laser::MeasurementSet set;
  for (const double z_mm : {0.0, 300.0})
    for (int i = 0; i <= 12; ++i) {
      Reading r{.row = static_cast<int>(set.readings.size()) + 1, .position_mm = {125.0 * i, 200.0, z_mm}};
      set.readings.push_back(r);
    }
  const auto functions_of = [&](bool varies) {
    const Observations data = observations_of(set, Model{}, mill("TXYZ"));
    const Regressors regressors(data);
    CHECK(regressors.lever_varies(pitch) == varies);
    return regressors.columns(pitch, 0.0).of.cols();
  };
  CHECK(functions_of(true) == 2 + 11);  // mean, slope and free at each of thirteen targets
  set.readings.erase(set.readings.begin(), set.readings.begin() + 13);
  CHECK(functions_of(false) == 2 + 10);  // as many degrees of freedom as every curve has
  set.readings.erase(set.readings.begin());
  CHECK(functions_of(false) == 2 + 10);  // on twelve or fewer free at each
}

TEST_CASE("the size of a curve is that of the curve, not of what levers and approaches make of it") {
  EffectInstance pitch = effect(angular, Axis::X, Sense::EX);
  pitch.sense.reset();
  pitch.code = Component::EBX;
  const Observations data =
      observations_of(measured({.parked_mm = {0.0, 0.0, 300.0}}, 0.0, nothing), Model{}, mill("TXYZ"));
  const Regressors regressors(data);
  Eigen::VectorXd three = Eigen::VectorXd::Zero(regressors.columns(pitch, 0.0).of.cols());
  three(0) = 3.0;  // 3 um/m everywhere: 0.9 um through 300 mm
  CHECK(regressors.rms_of_curve(pitch, regressors.acting(pitch), three) == Approx(3.0));
  CHECK((regressors.columns(pitch, 0.0).of * three).cwiseAbs().maxCoeff() == Approx(0.9));
}
