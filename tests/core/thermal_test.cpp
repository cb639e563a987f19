// Thermal and load rows: their laws against the plain formulas, the watch over their inputs, the state without power.
#include "core/thermal.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>

#include "base/random.hpp"
#include "core/tick.hpp"
#include "tests/core/support/image_of.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

constexpr double kStep_s = kThermalStep_s;

UnitParameters parameters_for(std::string_view configuration) {
  UnitParameters p;
  std::copy(configuration.begin(), configuration.end(), p.configuration.begin());
  return p;
}

/// A map of zeros with these rows, and the loop over it, at rest where the test says.
struct Loop {
  std::unique_ptr<CompiledMap> map = std::make_unique<CompiledMap>();
  ThermalState state;
  InputValues inputs{};
  Vector3 position_mm{};

  explicit Loop(const std::vector<ThermalRow>& rows, const UnitParameters& p = {},
                const ThermalSettings& settings = {}) {
    const auto image = image_of(p, with_zeros({}), "", rows, settings);
    REQUIRE(check_image(image).fault == ImageFault::none);
    REQUIRE(compile(ImageView(image), *map).fault == Fault::none);
    for (auto& input : inputs) input = {20.0, true, 1};
  }
  bool begin(const StoredThermal* stored = nullptr, double age_s = 0.0) {
    return begin_thermal(map->thermal, state, inputs, position_mm, stored, age_s);
  }
  /// A new value at every input that is present.
  bool step(double seconds = kStep_s) {
    for (auto& input : inputs) input.number += input.present ? 1 : 0;
    return step_thermal(map->thermal, state, inputs, position_mm, seconds);
  }
  /// @return  how often an input became doubtful
  int run(double seconds) {
    int doubtful = 0;
    for (double t = 0.0; t < seconds - 1e-9; t += kStep_s) doubtful += step() ? 1 : 0;
    return doubtful;
  }
  [[nodiscard]] Vector3 um() const {
    const Lanes lanes = value_um(state.acting, position_mm);
    return {lanes[0], lanes[1], lanes[2]};
  }
  [[nodiscard]] InputState input(std::size_t i) const { return state.inputs[i].state; }
};

ThermalRow growth_of_x(double lag_s = 0.0) {
  return {Component::EXX, ThermalLaw::growth, 0, kNoInput, -11.5, 20.0, lag_s, 0.0};
}

}  // namespace

TEST_CASE("an active row takes a deviation away slowly, within its limit, and stands still without its instrument") {
  const ThermalRow row{Component::EZX, ThermalLaw::active, kDeviationSource, kNoInput, 1.0, 25.0, 20.0, 0.0};
  REQUIRE(sound(row));
  Loop loop({row}, {}, {.rate_um_per_s = 2.0, .hold_s = 30.0});
  const double error_um = 12.0;
  const auto run = [&](double seconds, double of_um) {
    double largest_step_um = 0.0;
    for (double t = 0.0; t < seconds; t += kStep_s) {
      const double before_um = loop.um()[2];
      loop.inputs[kDeviationInput].value = of_um + before_um;
      loop.step();
      largest_step_um = std::max(largest_step_um, std::abs(loop.um()[2] - before_um));
    }
    return largest_step_um;
  };
  loop.inputs[kDeviationInput].value = error_um;
  CHECK_FALSE(loop.begin());
  CHECK(loop.um()[2] == 0.0);
  CHECK(run(20.0, error_um) <= 0.2 + 1e-12);
  CHECK(loop.um()[2] == Approx(-error_um * (1.0 - std::exp(-1.0))).epsilon(0.02));
  run(300.0, error_um);
  CHECK(loop.um()[2] == Approx(-error_um).epsilon(1e-3));
  run(600.0, 40.0);
  CHECK(loop.um()[2] == Approx(-25.0));  // not beyond its limit
  run(300.0, error_um);
  loop.inputs[kDeviationInput].present = false;
  CHECK(loop.run(1.0) == 1);
  CHECK(loop.input(kDeviationInput) == InputState::missing);
  CHECK(loop.um()[2] == Approx(-error_um).epsilon(1e-3));
  loop.run(60.0);
  CHECK(std::abs(loop.um()[2]) < 1e-9);  // faded out after it was held
}

TEST_CASE("an active row needs a deviation, a time constant and a limit") {
  const ThermalRow good{Component::EYX, ThermalLaw::active, kDeviationSource, kNoInput, -1.0, 25.0, 20.0, 0.0};
  CHECK(sound(good));
  for (const auto& change : std::vector<std::function<void(ThermalRow&)>>{
           [](ThermalRow& r) { r.source = 3; }, [](ThermalRow& r) { r.law = ThermalLaw::shift; },
           [](ThermalRow& r) { r.lag_s = 0.5; }, [](ThermalRow& r) { r.reference = 0.0; },
           [](ThermalRow& r) { r.reference = 600.0; }, [](ThermalRow& r) { r.minus = 2; },
           [](ThermalRow& r) { r.component = Component::EAX; }}) {
    ThermalRow bad = good;
    change(bad);
    CHECK_FALSE(sound(bad));
  }
}

TEST_CASE("shift, growth and bending are c D, c p D and c p^2 D along the direction of their component") {
  Loop loop({{Component::EZZ, ThermalLaw::shift, 0, kNoInput, 2.4, 21.0, 0.0, 0.0},
             {Component::EXX, ThermalLaw::growth, 1, kNoInput, -11.5, 20.0, 0.0, -100.0},
             {Component::EYX, ThermalLaw::bending, 2, 3, 5.0, 0.0, 0.0, 50.0}});
  loop.inputs[0].value = 26.0;
  loop.inputs[1].value = 23.0;
  loop.inputs[2].value = 25.0;
  loop.inputs[3].value = 21.0;
  loop.position_mm = {-900.0, 300.0, -200.0};
  CHECK_FALSE(loop.begin());
  CHECK(loop.um()[2] == Approx(2.4 * 5.0));
  CHECK(loop.um()[0] == Approx(-11.5 * -0.8 * 3.0));
  CHECK(loop.um()[1] == Approx(5.0 * 0.95 * 0.95 * 4.0));
  loop.position_mm[0] = 400.0;  // the same temperatures act exactly wherever the axis is
  CHECK(loop.um()[0] == Approx(-11.5 * 0.5 * 3.0));
}

TEST_CASE("a rotation that follows a temperature acts through the levers of the physical machine") {
  for (const std::string_view configuration : {"TXYZ", "XTYZ", "XYTZ", "XYZT"})
    for (const Component c : {Component::EAX, Component::EBX, Component::ECX, Component::EAY, Component::EBZ}) {
      UnitParameters p = parameters_for(configuration);
      p.tool_offset_mm = {11.0, -5.0, 120.0};
      p.measurement_lines_mm[index_of(moving_axis(c))] = {-30.0, 40.0, -60.0};
      Loop loop({{c, ThermalLaw::shift, 0, kNoInput, 3.0, 20.0, 0.0, 0.0}}, p);
      loop.inputs[0].value = 24.0;
      loop.position_mm = {-700.0, 250.0, -410.0};
      (void)loop.begin();
      ComponentValues values{};
      values[index_of(c)] = 3.0 * 4.0;
      const auto terms = must(terms_of(*chain_of(p), Convention::iso, CurveKind::carriage));
      const Vector3 expected = tool_error_um(terms, values, loop.position_mm, p.measurement_lines_mm, p.tool_offset_mm);
      for (std::size_t a = 0; a < kAxes; ++a) CHECK(loop.um()[a] == Approx(expected[a]).epsilon(1e-12));
    }
}

TEST_CASE("the scope of the parameters keeps rows out as it keeps tables out") {
  UnitParameters p;
  p.scope = Scope::linear;
  Loop loop({growth_of_x(), {Component::EYX, ThermalLaw::shift, 0, kNoInput, 7.0, 20.0, 0.0, 0.0}}, p);
  loop.inputs[0].value = 22.0;
  loop.position_mm = {1000.0, 0.0, 0.0};
  (void)loop.begin();
  CHECK(loop.um()[0] == Approx(-23.0));
  CHECK(loop.um()[1] == 0.0);
}

TEST_CASE("a tick adds the rows at the position of its own period") {
  Loop loop({growth_of_x()});
  loop.inputs[0].value = 24.0;
  (void)loop.begin();
  TickState state;
  start(state, {}, {}, {Approach::forward, Approach::forward, Approach::forward});
  for (std::int64_t counts = 0; counts <= 500'000; counts += 10'000) {
    tick(*loop.map, state, {counts, 0, 0}, loop.state.acting);
    CHECK(state.compensation_um[0] == Approx(-11.5 * 4.0 * static_cast<double>(counts) * 1e-6));
  }
  TickState cold = state;
  tick(*loop.map, cold, {500'000, 0, 0});
  CHECK(cold.compensation_um[0] == 0.0);
}

TEST_CASE("a row follows its input with its lag of first order") {
  Loop loop({growth_of_x(600.0)});
  loop.position_mm = {100.0, 0.0, 0.0};
  (void)loop.begin();
  double largest = 0.0;
  for (double t = 0.0; t < 3000.0; t += kStep_s) {
    const double degC = 20.0 + 5.0 * (1.0 - std::exp(-t / 900.0));
    loop.inputs[0].value = degC;
    (void)loop.step();
    // x' = (u - x)/600 of u = 5 (1 - e^(-t/900)), solved
    const double s = t + kStep_s;
    const double exact = 5.0 * (1.0 - (900.0 * std::exp(-s / 900.0) - 600.0 * std::exp(-s / 600.0)) / 300.0);
    largest = std::max(largest, std::abs(loop.state.applied[0] - exact));
  }
  CHECK(largest < 0.002);  // degC
}

TEST_CASE("a machine that warms itself follows the motion of its axis, and cools at rest") {
  Loop loop({{Component::EZZ, ThermalLaw::shift, kMotionOfX, kNoInput, -20.0, 1200.0, 300.0, 0.0}});
  CHECK_FALSE(loop.begin());
  CHECK(loop.um()[2] == 0.0);
  for (int k = 0; k < 3000; ++k) {  // 600 mm/min, half of full duty, for 300 s
    loop.position_mm[0] += k % 200 < 100 ? 1.0 : -1.0;
    (void)loop.step();
  }
  CHECK(loop.um()[2] == Approx(-20.0 * 0.5 * (1.0 - std::exp(-1.0))).epsilon(0.002));
  (void)loop.run(300.0);
  CHECK(loop.um()[2] == Approx(-20.0 * 0.5 * (1.0 - std::exp(-1.0)) * std::exp(-1.0)).epsilon(0.002));
  for (int k = 0; k < 3000; ++k) {  // ten times full duty is full duty
    loop.position_mm[0] += k % 2 == 0 ? 20.0 : -20.0;
    (void)loop.step();
  }
  CHECK(loop.state.lagged[0] < 1.0);
}

TEST_CASE("a doubtful input keeps its last good value for the time stated, then its rows fade, and it comes back") {
  Loop loop({growth_of_x()});
  loop.position_mm = {1000.0, 0.0, 0.0};
  loop.inputs[0].value = 21.0;
  (void)loop.begin();
  REQUIRE(loop.um()[0] == Approx(-11.5));
  loop.inputs[0].present = false;
  CHECK(loop.run(59.0) == 1);
  CHECK(loop.input(0) == InputState::missing);
  CHECK(loop.um()[0] == Approx(-11.5));
  (void)loop.run(12.0);  // 11 s of fading at 0.5 um/s
  CHECK(loop.um()[0] == Approx(-11.5 + 5.5).epsilon(0.02));
  (void)loop.run(60.0);
  CHECK(loop.um()[0] == 0.0);
  loop.inputs[0].present = true;
  (void)loop.run(9.0);
  CHECK(loop.input(0) == InputState::missing);
  (void)loop.run(2.0);
  CHECK(loop.input(0) == InputState::good);
  CHECK(std::abs(loop.um()[0]) < 2.0);
  (void)loop.run(30.0);
  CHECK(loop.um()[0] == Approx(-11.5));
  CHECK(loop.state.inputs[0].faults == 1);
}

TEST_CASE("an input is missing, out of range, jumping or stuck exactly beyond its limits") {
  Loop loop({growth_of_x()});
  (void)loop.begin();
  loop.inputs[0].value = 20.99;
  CHECK_FALSE(loop.step());
  loop.inputs[0].value = 22.0;
  CHECK(loop.step());
  CHECK(loop.input(0) == InputState::jumping);
  loop.inputs[0].value = 20.0;
  (void)loop.run(11.0);
  CHECK(loop.input(0) == InputState::good);
  for (const double wrong : {120.1, -30.1, std::nan(""), HUGE_VAL}) {
    loop.inputs[0].value = wrong;
    CHECK(loop.step());
    CHECK(loop.input(0) == InputState::out_of_range);
    loop.inputs[0].value = 20.0;
    (void)loop.run(11.0);
    REQUIRE(loop.input(0) == InputState::good);
  }
  for (int k = 0; k < 36'000; ++k) {  // an hour in which the value changes again and again
    loop.inputs[0].value = 20.0 + 0.01 * (k / 20'000);
    CHECK_FALSE(loop.step());
  }
  for (int k = 0; k < 40'000 && loop.input(0) == InputState::good; ++k) (void)loop.step();
  CHECK(loop.input(0) == InputState::stuck);
  loop.inputs[0].value = 20.02;
  (void)loop.run(11.0);
  CHECK(loop.input(0) == InputState::good);
  for (int k = 0; k < 99; ++k) CHECK_FALSE(step_thermal(loop.map->thermal, loop.state, loop.inputs, {}, kStep_s));
  bool said = false;  // nothing new came for 10 s
  for (int k = 0; k < 3; ++k) said = step_thermal(loop.map->thermal, loop.state, loop.inputs, {}, kStep_s) || said;
  CHECK(said);
  CHECK(loop.input(0) == InputState::missing);
}

TEST_CASE("a load acts at its rate, is not watched in time, and is said where it is unknown") {
  Loop loop({{Component::EYZ, ThermalLaw::shift, kLoadInput, kNoInput, 0.02, 100.0, 0.0, 0.0}});
  loop.inputs[kLoadInput] = {};
  CHECK(loop.begin());
  CHECK(loop.um()[1] == 0.0);
  loop.inputs[kLoadInput] = {350.0, true, 1};
  CHECK_FALSE(loop.step());
  CHECK(loop.um()[1] == Approx(0.05));
  (void)loop.run(12.0);
  CHECK(loop.um()[1] == Approx(5.0));
  CHECK(loop.run(3700.0) == 0);
  loop.inputs[kLoadInput].value = -1.0;
  CHECK(loop.step());
  CHECK(loop.um()[1] == Approx(5.0));
}

TEST_CASE("in 10,000 random faults of sensors no output steps by more than 0.2 um, and none remains unsaid") {
  std::mt19937 random(33);
  const auto uniform = [&] { return std::uniform_real_distribution<double>(0.0, 1.0)(random); };
  int said = 0, faults = 0;
  double largest_um = 0.0;
  while (faults < 10'000) {
    Loop loop({growth_of_x(uniform() < 0.5 ? 0.0 : 100.0 * uniform()),
               {Component::EZX, ThermalLaw::bending, 1, 2, 8.0, 0.0, 0.0, 0.0},
               {Component::EZZ, ThermalLaw::shift, 2, kNoInput, -2.4, 20.0, 0.0, 0.0},
               {Component::EBX, ThermalLaw::shift, 3, kNoInput, 3.0, 20.0, 30.0, 0.0}},
              {}, {.hold_s = 5.0, .stuck_s = 30.0});
    loop.position_mm = {-4000.0 * uniform(), -1400.0 * uniform(), -1000.0 * uniform()};
    PerAxis<std::int64_t> counts{};
    TickState output;
    Vector3 before{};
    const auto advance = [&](double degC_per_step) {
      for (std::size_t i = 0; i < 4; ++i) loop.inputs[i].value += degC_per_step + 0.004 * (uniform() - 0.5);
    };
    for (auto& input : loop.inputs) input.value = 15.0 + 15.0 * uniform();
    (void)loop.begin();
    start(output, counts, loop.position_mm, {Approach::forward, Approach::forward, Approach::forward});
    for (int k = 0; k < 100; ++k) tick(*loop.map, output, counts, loop.state.acting);  // the outputs slew up
    before = output.compensation_um;
    for (int f = 0; f < 25; ++f, ++faults) {
      const std::size_t failing = one_of(random, 4);
      const auto kind = one_of(random, 6);
      const double size_degC = (uniform() < 0.5 ? -1.0 : 1.0) * (2.0 + 60.0 * uniform());
      bool doubtful = false;
      const InputValue truth = loop.inputs[failing];
      for (int k = 0; k < 400; ++k) {  // 40 s: held, and faded as far as the rate goes
        advance(0.003 * (uniform() - 0.5));
        InputValue& input = loop.inputs[failing];
        if (kind == 0) input.present = false;
        if (kind == 1) input.value = truth.value;  // stuck
        if (kind == 2) input.value = truth.value + size_degC + 0.001 * k;
        if (kind == 3) input.value = k % 2 == 0 ? 1e9 : -1e9;
        if (kind == 4) input.value = std::nan("");
        if (kind == 5) input.value = truth.value + 0.35 * k;  // a wire that corrodes: 3.5 degC/s
        doubtful = loop.step() || doubtful;
        tick(*loop.map, output, counts, loop.state.acting);
        for (std::size_t a = 0; a < kAxes; ++a)
          largest_um = std::max(largest_um, std::abs(output.compensation_um[a] - before[a]));
        before = output.compensation_um;
      }
      said += doubtful && is_doubtful(loop.input(failing)) && loop.state.inputs[failing].faults > 0 ? 1 : 0;
      for (std::size_t i = 0; i < 4; ++i) {
        loop.inputs[i].present = true;
        loop.inputs[i].value = loop.state.inputs[i].held;
      }
      for (int k = 0; k < 150; ++k) {
        advance(0.0);
        (void)loop.step();
        tick(*loop.map, output, counts, loop.state.acting);
        for (std::size_t a = 0; a < kAxes; ++a)
          largest_um = std::max(largest_um, std::abs(output.compensation_um[a] - before[a]));
        before = output.compensation_um;
      }
      REQUIRE(loop.input(failing) == InputState::good);
    }
  }
  CHECK(said == faults);
  CHECK(largest_um <= 0.2);
  CHECK(largest_um <= 0.05 + 1e-9);  // the usual rate, in a step of the slow loop
}

TEST_CASE("rows and settings of impossible numbers are refused, and so is a format of the future") {
  const ThermalRow good = growth_of_x();
  CHECK(sound(good));
  const auto with = [&](auto change) {
    ThermalRow row = good;
    change(row);
    return row;
  };
  for (const ThermalRow& bad :
       {with([](ThermalRow& r) { r.coefficient = std::nan(""); }), with([](ThermalRow& r) { r.coefficient = 1.1e5; }),
        with([](ThermalRow& r) { r.component = Component::C0Y; }), with([](ThermalRow& r) { r.source = 20; }),
        with([](ThermalRow& r) { r.minus = 16; }), with([](ThermalRow& r) { r.lag_s = -1.0; }),
        with([](ThermalRow& r) { r.origin_mm = 1.1e6; }), with([](ThermalRow& r) { r.component = Component::ECX; }),
        with([](ThermalRow& r) { r.reference = HUGE_VAL; }),
        with([](ThermalRow& r) { r.source = kLoadInput, r.minus = 1; }),
        with([](ThermalRow& r) { r.source = kMotionOfX, r.reference = 0.5; })}) {
    CHECK_FALSE(sound(bad));
    const auto image = image_of({}, with_zeros({}), "", {good, bad});
    CHECK(check_image(image).fault == ImageFault::bad_thermal_row);
    CHECK(check_image(image).table == 1);
  }
  CHECK(check_image(image_of({}, with_zeros({}), "", {good}, {.rate_um_per_s = 2.1})).fault ==
        ImageFault::bad_thermal_row);
  CHECK(check_image(image_of({}, with_zeros({}), "", std::vector<ThermalRow>(kMostThermalRows, good))).fault ==
        ImageFault::none);
  CHECK(check_image(image_of({}, with_zeros({}), "", std::vector<ThermalRow>(kMostThermalRows + 1, good))).fault ==
        ImageFault::bad_thermal_row);
  auto image = image_of({}, with_zeros({}), "", {good});
  CHECK(ImageView(image).thermal_row(0) == good);
  CHECK(ImageView(image).thermal_settings() == ThermalSettings{});
  store_big<std::uint16_t>(image, prefix_at::format, kFormatWithBending + 1);
  seal_image(image);
  CHECK(check_image(image).fault == ImageFault::wrong_format);
}

TEST_CASE("what rows have come to survives a loss of power at every byte, older or newer") {
  std::vector<std::uint8_t> region(2 * kStoredThermalBytes, 0);
  CHECK_FALSE(stored_thermal(region));
  StoredThermal stored{1, 0xABCD, 100.0, {}};
  for (std::uint32_t n = 1; n <= 4; ++n) {
    const auto before = stored_thermal(region);
    stored.sequence = n;
    stored.lagged[0] = 0.5 * n;
    std::vector<std::uint8_t> slot(kStoredThermalBytes);
    encode_thermal(stored, slot);
    const std::uint32_t at = next_thermal_slot(region) * kStoredThermalBytes;
    for (std::uint32_t written = 0; written < kStoredThermalBytes; ++written) {
      const auto now = stored_thermal(region);
      CHECK((now == before || now == stored));
      region[at + written] = slot[written];
    }
    CHECK(stored_thermal(region) == stored);
  }
}

TEST_CASE("a row goes on from its stored state as old as it is, and begins in balance without one") {
  Loop loop({growth_of_x(1000.0)});
  loop.position_mm = {100.0, 0.0, 0.0};
  loop.inputs[0].value = 26.0;
  (void)loop.begin();
  CHECK(loop.state.lagged[0] == Approx(6.0));
  CHECK_FALSE(loop.state.stored_age_s);
  StoredThermal stored;
  stored.lagged[0] = 2.0;
  (void)loop.begin(&stored, 500.0);
  CHECK(loop.state.lagged[0] == Approx(6.0 + (2.0 - 6.0) * std::exp(-0.5)));
  CHECK(loop.state.stored_age_s == 500.0);
}
