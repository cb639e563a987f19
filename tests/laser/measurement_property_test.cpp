// Properties of the CSV form over arbitrary sets.
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "laser/measurement_set.hpp"
#include "laser/writers/measurement_writer.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

double number() {
  return *rc::gen::map(rc::gen::arbitrary<int>(), [](int i) { return i / 9970.0; });  // within what a machine can have
}

std::optional<double> maybe_number() { return *rc::gen::arbitrary<bool>() ? std::optional(number()) : std::nullopt; }

std::string text() {
  return *rc::gen::container<std::string>(rc::gen::element('a', 'Z', ',', '"', ' ', '#', '1', '.'));
}

Reading arbitrary_reading() {
  Reading reading;
  reading.axis = *rc::gen::element(Axis::X, Axis::Y, Axis::Z);
  reading.sense = *rc::gen::element(Sense::EX, Sense::EY, Sense::EZ, Sense::EA, Sense::EB, Sense::EC);
  reading.position_mm = {number(), number(), number()};
  reading.error = number();
  reading.approach = *rc::gen::element(Approach::forward, Approach::unknown, Approach::reverse);
  reading.run = *rc::gen::inRange(-3, 100);
  reading.time_s = maybe_number();
  reading.feed_mm_min = maybe_number();
  reading.load_kg = maybe_number();
  reading.travel_since_reversal_mm = maybe_number();
  reading.pressure_hPa = maybe_number();
  reading.humidity_pct = maybe_number();
  if (*rc::gen::arbitrary<bool>()) reading.compensated = *rc::gen::arbitrary<bool>();
  if (const auto value = maybe_number()) reading.sensors_degC["t_air_degC"] = *value;
  if (const auto value = maybe_number()) reading.extras["spindle_rpm"] = *value;
  if (const std::string word = text(); !word.empty()) reading.text_extras["remark"] = "x" + word;
  return reading;
}

}  // namespace

TEST_CASE("what is written is read back exactly") {
  CHECK(rc::check([] {
    MeasurementSet set;
    set.source = "m.csv";
    set.metadata = {{"machine", "mill"}, {"", "free words"}, {"date", "2024-05-06 09:10"}};
    const int count = *rc::gen::inRange(1, 12);
    for (int i = 0; i < count; ++i) {
      set.readings.push_back(arbitrary_reading());
      set.readings.back().row = i + 1;
      set.readings.back().line = i + 5;
    }
    const auto again = parse_measurement_set(to_csv(set), "m.csv");
    RC_ASSERT(again.has_value());
    RC_ASSERT(again->metadata == set.metadata);
    RC_ASSERT(again->readings == set.readings);
    RC_ASSERT(to_csv(*again) == to_csv(set));
  }));
}
