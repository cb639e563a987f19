// The fixed-period loop: positions, approach sensing, output, pointers.
#include "core/tick.hpp"

#include <limits>
#include <memory>

#include "tests/core/support/image_of.hpp"
#include "tests/support/random_values.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

/// A single axis X with one map, ready to run: 1 um a count, 10 D/A counts a um, no slew limit to speak of, and no
/// drive: the counts are given, the output moves nothing.
struct Bench {
  UnitParameters parameters;
  std::unique_ptr<CompiledMap> map = std::make_unique<CompiledMap>();
  TickState state;

  Bench() {
    set_configuration(parameters, "TX");
    parameters.axes[0].output_slew_um_per_s = 1e8;
  }
  void begin(std::vector<PlannedTable> tables, double datum_mm = 0.0, std::int64_t datum_counts = 0,
             Approach approach = Approach::forward) {
    const auto image = image_of(parameters, tables);
    REQUIRE(check_image(image).fault == ImageFault::none);
    REQUIRE(compile(ImageView(image), *map).fault == Fault::none);
    map->output.mm_per_output = {};
    start(state, {datum_counts, 0, 0}, {datum_mm, 0.0, 0.0}, {approach, Approach::forward, Approach::forward});
  }
  void begin_constant(std::int16_t value_um) {
    begin({{Component::EXX, Approach::unknown, 0.0, 1.0, 1.0, {value_um}}});
  }
  void at_counts(std::int64_t counts) { tick(*map, state, {counts, 0, 0}); }
};

const std::vector<PlannedTable> kTwoWays{{Component::EXX, Approach::forward, 0.0, 1.0, 1.0, {4}},
                                         {Component::EXX, Approach::reverse, 0.0, 1.0, 1.0, {-4}}};

}  // namespace

TEST_CASE("positions count from the datum, with the sign and scale of the transducer") {
  Bench bench;
  bench.parameters.axes[0].position_scale_um_per_count = -2.0;
  bench.begin(kTwoWays, -4100.0, 5000);
  bench.at_counts(5000);
  CHECK(bench.state.position_mm[0] == -4100.0);
  bench.at_counts(4000);
  CHECK(bench.state.position_mm[0] == Approx(-4098.0));
  CHECK(bench.state.ticks == 2);
}

TEST_CASE("a transducer counter that wraps round does not move the axis") {
  Bench bench;
  const auto last = std::numeric_limits<std::int64_t>::max();
  bench.begin(kTwoWays, 0.0, last);
  bench.at_counts(std::numeric_limits<std::int64_t>::min() + 999);
  CHECK(bench.state.position_mm[0] == Approx(1.0));
}

TEST_CASE("the outputs begin at zero and the approach is known from the start") {
  Bench bench;
  bench.begin(kTwoWays, 0.0, 0, Approach::unknown);
  CHECK(bench.state.output_counts[0] == 0.0);
  CHECK(bench.state.approach[0] == Approach::forward);
}

TEST_CASE("the approach selects the table") {
  Bench bench;
  bench.begin(kTwoWays, 0.0, 0, Approach::reverse);
  bench.at_counts(-1000);
  CHECK(bench.state.compensation_um[0] == -4.0);
  bench.at_counts(0);
  CHECK(bench.state.approach[0] == Approach::forward);
  CHECK(bench.state.compensation_um[0] == 4.0);
}

TEST_CASE("jitter within the deadband never turns the approach, however long it lasts") {
  CHECK(rc::check([] {
    Bench bench;
    bench.parameters.axes[0].deadband_um = 5.0;
    bench.begin(kTwoWays);
    bench.at_counts(1000);
    for (int i = 0; i < 100; ++i) {
      bench.at_counts(1000 - *rc::gen::inRange(0, 6));
      RC_ASSERT(bench.state.approach[0] == Approach::forward);
    }
  }));
}

TEST_CASE("creeping back turns the approach once the travel from the furthest point exceeds the deadband") {
  Bench bench;
  bench.parameters.axes[0].deadband_um = 5.0;
  bench.begin(kTwoWays);
  bench.at_counts(1000);
  for (std::int64_t back = 1; back <= 5; ++back) {
    bench.at_counts(1000 - back);
    CHECK(bench.state.approach[0] == Approach::forward);
  }
  bench.at_counts(994);
  CHECK(bench.state.approach[0] == Approach::reverse);
  CHECK(bench.state.extreme_mm[0] == Approx(0.994));
  bench.at_counts(999);
  CHECK(bench.state.approach[0] == Approach::reverse);
  bench.at_counts(1000);
  CHECK(bench.state.approach[0] == Approach::forward);
}

TEST_CASE("any travel beyond the deadband turns the approach, any onward travel keeps it") {
  CHECK(rc::check([] {
    const double deadband_mm = number_between(0.0, 0.05);
    double extreme_mm = number_up_to(100.0);
    const double from_mm = extreme_mm;
    const Approach before = *rc::gen::element(Approach::forward, Approach::reverse);
    const double sign = before == Approach::forward ? 1.0 : -1.0;
    const double onward_mm = number_up_to(0.2);
    const Approach after = sensed_approach(before, from_mm + sign * onward_mm, deadband_mm, extreme_mm);
    if (onward_mm >= 0.0) RC_ASSERT(after == before);
    if (onward_mm < -deadband_mm - 1e-9) RC_ASSERT(after != before);
    if (onward_mm < 0.0 && onward_mm > -deadband_mm + 1e-9) {
      RC_ASSERT(after == before);
      RC_ASSERT(extreme_mm == from_mm);
    }
  }));
}

TEST_CASE("a position that may be wrong turns the approach only by travel that it cannot have mistaken") {
  CHECK(rc::check([] {
    const double deadband_mm = number_between(0.0, 0.05), unsure_mm = number_between(0.0, 0.05);
    const Approach before = *rc::gen::element(Approach::forward, Approach::reverse);
    const double sign = before == Approach::forward ? 1.0 : -1.0;
    double extreme_mm = 0.0;
    // an axis that stands may be seen anywhere within what is unsure, again and again
    for (int look = 0; look < 20; ++look)
      RC_ASSERT(sensed_approach(before, number_up_to(unsure_mm), deadband_mm, extreme_mm, unsure_mm) == before);
    // one that turns is seen to turn after the deadband and twice what is unsure
    RC_ASSERT(sensed_approach(before, sign * 1.0, deadband_mm, extreme_mm, unsure_mm) == before);
    const double back_mm = deadband_mm + 2.0 * unsure_mm + 1e-6;
    RC_ASSERT(sensed_approach(before, sign * (1.0 - back_mm), deadband_mm, extreme_mm, unsure_mm) != before);
  }));
}

TEST_CASE("output = compensation × scaling × polarity, rounded to the nearest count") {
  Bench bench;
  bench.parameters.axes[0].output_scale_counts_per_um = 3.3;
  bench.begin_constant(7);  // 23.1 counts
  bench.at_counts(0);
  CHECK(bench.state.output_counts[0] == Approx(23.1));
  CHECK(bench.state.dac_counts[0] == 23);
  bench.begin_constant(-8);  // −26.4
  bench.at_counts(0);
  CHECK(bench.state.dac_counts[0] == -26);
  bench.begin_constant(-5);  // −16.5 is half way; −16.51 would not be
  bench.parameters.axes[0].output_scale_counts_per_um = 3.302;
  bench.begin_constant(-5);
  bench.at_counts(0);
  CHECK(bench.state.dac_counts[0] == -17);
  bench.parameters.axes[0].compensation_polarity = -1;
  bench.begin_constant(-5);
  bench.at_counts(0);
  CHECK(bench.state.dac_counts[0] == 17);
  CHECK(bench.state.compensation_um[0] == -5.0);  // before polarity
}

TEST_CASE("the size limit holds the output and says so") {
  Bench bench;
  bench.parameters.axes[0].output_limit_um = 50.0;
  for (const std::int16_t sign : {std::int16_t{1}, std::int16_t{-1}}) {
    bench.begin_constant(static_cast<std::int16_t>(sign * 51));
    bench.at_counts(0);
    CHECK(bench.state.dac_counts[0] == sign * 500);
    CHECK(bench.state.at_limit[0]);
    bench.begin_constant(static_cast<std::int16_t>(sign * 50));
    bench.at_counts(0);
    CHECK(bench.state.dac_counts[0] == sign * 500);
    CHECK(!bench.state.at_limit[0]);
  }
}

TEST_CASE("whatever is asked for, the output stays within 16 bits") {
  Bench bench;
  bench.parameters.axes[0].output_scale_counts_per_um = 1000.0;
  bench.parameters.axes[0].output_limit_um = 1e6;
  bench.begin_constant(32'767);
  bench.at_counts(0);
  CHECK(bench.state.dac_counts[0] == 32'767);
  CHECK(bench.state.at_limit[0]);
  bench.begin_constant(-32'768);
  bench.at_counts(0);
  CHECK(bench.state.dac_counts[0] == -32'767);
}

TEST_CASE("the slew limit spreads a step over ticks, below one count a tick too") {
  Bench bench;
  bench.parameters.loop_period_us = 1000.0;
  bench.parameters.axes[0].output_slew_um_per_s = 500.0;  // 0.5 um = 5 counts a tick
  bench.begin_constant(2);
  for (const int expected : {5, 10, 15, 20, 20}) {
    bench.at_counts(0);
    CHECK(bench.state.dac_counts[0] == expected);
    CHECK(!bench.state.at_limit[0]);
  }
  bench.parameters.axes[0].output_slew_um_per_s = 20.0;  // 0.2 counts a tick
  bench.begin_constant(-1);
  for (int i = 0; i < 25; ++i) bench.at_counts(0);
  CHECK(bench.state.dac_counts[0] == -5);
  for (int i = 0; i < 25; ++i) bench.at_counts(0);
  CHECK(bench.state.dac_counts[0] == -10);
}

TEST_CASE("an axis that does not exist is not moved, whatever its counts") {
  UnitParameters lathe;
  set_configuration(lathe, "XTYZ");
  lathe.axis_present = {false, true, true};
  lathe.A0Z_um_per_m = 100.0;
  lathe.C0Y_um_per_m = 100.0;
  lathe.tool_offset_mm = {5.0, 6.0, 7.0};
  std::vector<PlannedTable> tables;
  for (std::size_t c = 0; c < kCurves; ++c)
    tables.push_back({static_cast<Component>(c), Approach::unknown, 0.0, 1.0, 1.0, {10, 20}});
  const auto image = image_of(lathe, tables);
  auto map = std::make_unique<CompiledMap>();
  REQUIRE(compile(ImageView(image), *map).fault == Fault::none);
  TickState moved;
  TickState still;
  const PerAxis<Approach> forward{Approach::forward, Approach::forward, Approach::forward};
  start(moved, {}, {}, forward);
  start(still, {}, {}, forward);
  for (std::int64_t i = 0; i < 2000; ++i) {
    tick(*map, moved, {i * 1000, 500, 600});
    tick(*map, still, {0, 500, 600});
  }
  CHECK(moved.dac_counts[0] == 0);
  CHECK(moved.compensation_um[0] == 0.0);
  CHECK(moved.dac_counts[1] == still.dac_counts[1]);
  CHECK(moved.dac_counts[2] == still.dac_counts[2]);
  CHECK(moved.dac_counts[1] != 0);
}

TEST_CASE("the address pointers point to the values selected") {
  Bench bench;
  bench.begin({{Component::EXX, Approach::reverse, 0.0, 10.0, 1.0, {1, 2, 3}},
               {Component::EXX, Approach::forward, -20.0, 10.0, 1.0, {4, 5, 6, 7}}});
  const auto pointer = [&] { return selected_value(*bench.map, bench.state, Axis::X, Sense::EX); };
  bench.at_counts(1'000);  // 1 mm forward: between 0 mm (third value) and 10 mm
  CHECK(pointer() == SelectedValue{2, 3 + 2});
  bench.at_counts(50'000);
  CHECK(pointer() == SelectedValue{3, 3 + 3});
  bench.at_counts(15'000);  // reverse
  CHECK(pointer() == SelectedValue{1, 1});
  bench.at_counts(-90'000);
  CHECK(pointer() == SelectedValue{0, 0});
  CHECK(!selected_value(*bench.map, bench.state, Axis::X, Sense::EY));
  CHECK(!selected_value(*bench.map, bench.state, Axis::Y, Sense::EY));
}

TEST_CASE("with nearest-point stepping the pointer goes to the value half an increment ahead") {
  Bench bench;
  bench.parameters.interpolation = Interpolation::nearest;
  bench.begin({{Component::EXX, Approach::unknown, 0.0, 10.0, 1.0, {1, 2, 3}}});
  bench.at_counts(4'999);
  CHECK(selected_value(*bench.map, bench.state, Axis::X, Sense::EX)->place == 0);
  bench.at_counts(5'001);
  CHECK(selected_value(*bench.map, bench.state, Axis::X, Sense::EX)->place == 1);
  CHECK(bench.state.compensation_um[0] == 2.0);
}

TEST_CASE("the tick asks for what compensation_um_at() says at its position and approach") {
  CHECK(rc::check([] {
    UnitParameters p;
    p.tool_offset_mm = vector_up_to(100.0);
    std::vector<PlannedTable> tables;
    for (std::size_t c = 0; c < kCurves; ++c)
      for (const Approach approach : {Approach::forward, Approach::reverse})
        tables.push_back({static_cast<Component>(c), approach, number_up_to(100.0), 10.0, 0.01,
                          *rc::gen::container<std::vector<std::int16_t>>(5, rc::gen::arbitrary<std::int16_t>())});
    const auto image = image_of(p, tables);
    auto map = std::make_unique<CompiledMap>();
    RC_ASSERT(compile(ImageView(image), *map).fault == Fault::none);
    TickState state;
    start(state, {}, {}, {Approach::forward, Approach::reverse, Approach::forward});
    for (int i = 0; i < 20; ++i) {
      tick(*map, state, {*rc::gen::inRange(-100'000, 100'000), *rc::gen::inRange(-100'000, 100'000), i});
      RC_ASSERT(state.compensation_um == compensation_um_at(*map, state.position_mm, state.approach));
    }
  }));
}

TEST_CASE("the largest numbers that an image may hold neither overflow nor become not-a-number") {
  UnitParameters p{.angular_scale = 1e9, .C0Y_um_per_m = 1e9, .tool_offset_mm = {1e9, -1e9, 1e9}};
  for (auto& line : p.measurement_lines_mm) line = {-1e9, 1e9, -1e9};
  for (auto& axis : p.axes) {
    axis.position_scale_um_per_count = 1e9;
    axis.output_scale_counts_per_um = 1e9;
    axis.output_limit_um = 1e9;
    axis.output_slew_um_per_s = 1e9;
  }
  std::vector<PlannedTable> tables;
  for (std::size_t c = 0; c < kCurves; ++c)
    tables.push_back({static_cast<Component>(c), Approach::unknown, 1e6, 1e-4, 1000.0, {32'767, -32'768}});
  const auto image = image_of(p, tables);
  REQUIRE(check_image(image).fault == ImageFault::none);
  auto map = std::make_unique<CompiledMap>();
  REQUIRE(compile(ImageView(image), *map).fault == Fault::none);
  TickState state;
  start(state, {}, {}, {});
  for (const std::int64_t counts :
       {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()}) {
    tick(*map, state, {counts, counts, counts});
    for (std::size_t a = 0; a < kAxes; ++a) {
      CHECK(std::isfinite(state.compensation_um[a]));
      CHECK(std::abs(state.dac_counts[a]) <= 32'767);
    }
  }
}
