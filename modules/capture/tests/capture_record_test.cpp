#include "modules/capture/capture_record.hpp"

#include <rapidcheck.h>

#include "laser/writers/writers.hpp"
#include "tests/support/test.hpp"

namespace ecs::devices {
namespace {

CaptureLine line() {
  return {.from_mm = 0.0, .to_mm = 100.0, .step_mm = 50.0, .runs = 2, .parked_mm = {0.0, -1400.0, 5.0}};
}

CaptureRecord record(CaptureRules rules = {}) { return {{{{"machine", "mill"}}, *stops_of(line())}, rules}; }

CaptureRules by_position() { return {.shows = Shows::position, .min_interval_s = 0.2}; }

TEST_CASE("a line is measured forward and back in every run, each target from its side") {
  const auto stops = *stops_of(line());
  REQUIRE(stops.size() == 12);
  std::vector<double> targets;
  for (const laser::Reading& stop : stops) targets.push_back(target_mm(stop));
  CHECK(targets == std::vector<double>{0, 50, 100, 100, 50, 0, 0, 50, 100, 100, 50, 0});
  CHECK(stops[2].approach == Approach::forward);
  CHECK(stops[3].approach == Approach::reverse);
  CHECK(stops[3].run == 1);
  CHECK(stops[6].run == 2);
  CHECK(stops[0].position_mm == Vector3{0.0, -1400.0, 5.0});
}

TEST_CASE("moved targets keep the ends of the line, and are the same in every pass") {
  CaptureLine moved = line();
  moved.moved = true;
  const auto stops = *stops_of(moved);
  REQUIRE(stops.size() == 12);
  const double middle = target_mm(stops[1]);
  CHECK(std::abs(middle - 50.0) <= 15.0);
  CHECK(middle != 50.0);
  std::vector<double> targets;
  for (const laser::Reading& stop : stops) targets.push_back(target_mm(stop));
  CHECK(targets == std::vector<double>{0, middle, 100, 100, middle, 0, 0, middle, 100, 100, middle, 0});
}

TEST_CASE("a line into the negative begins with reverse approaches and ends at its end, short step or not") {
  CaptureLine down = line();
  down.to_mm = -110.0;
  down.one_way = true;
  down.runs = 1;
  const auto stops = *stops_of(down);
  REQUIRE(stops.size() == 4);
  CHECK(stops[0].approach == Approach::reverse);
  CHECK(target_mm(stops[2]) == -100.0);
  CHECK(target_mm(stops[3]) == -110.0);
}

TEST_CASE("a reading has its time, its surroundings and the target that was due") {
  CaptureRecord r = record();
  const Verdict verdict = r.offer(1.5, 3.0, {{Quantity::air_degC, 20.5}, {Quantity::pressure_hPa, 1010.0}});
  CHECK(verdict.taken);
  CHECK(verdict.warning.empty());
  CHECK(only(r.taken()).error == 1.5);
  CHECK(r.taken()[0].time_s == 3.0);
  CHECK(r.taken()[0].sensors_degC.at("t_air_degC") == 20.5);
  CHECK(r.taken()[0].pressure_hPa == 1010.0);
  CHECK(!r.taken()[0].humidity_pct.has_value());
  CHECK(target_mm(*r.due()) == 50.0);
  CHECK(r.place().number == 2);
  CHECK(r.place().of == 3);
  for (int k = 1; k < 3; ++k) CHECK(r.offer(k, 10.0 * k, {}).taken);
  CHECK(target_mm(*r.due()) == 100.0);  // the first target on the way back keeps its number
  CHECK(r.place().number == 3);
}

TEST_CASE("a trigger too soon after the last one is a doubled one") {
  CaptureRecord r = record();
  CHECK(r.offer(1.0, 10.0, {}).taken);
  const Verdict twice = r.offer(1.0, 10.3, {});
  CHECK(!twice.taken);
  CHECK(contains(twice.warning, "double trigger, 0.30 s after the last one"));
  CHECK(r.offer(1.0, 10.6, {}).taken);
}

TEST_CASE("a reading that took much longer than usual is questioned, and kept until it is undone") {
  CaptureLine longer = line();
  longer.to_mm = 500.0;
  CaptureRecord r({{}, *stops_of(longer)}, {});
  for (int k = 0; k < 5; ++k) CHECK(r.offer(k, 5.0 * k, {}).warning.empty());
  const Verdict late = r.offer(6.0, 30.0, {});
  CHECK(late.taken);
  CHECK(contains(late.warning, "was a trigger missed?"));
  CHECK(*metadata_value(r.result(), "in doubt") == "X forward 250 mm, run 1: " + late.warning);
  CHECK(r.undo());
  CHECK(!metadata_value(r.result(), "in doubt").has_value());
  CHECK(target_mm(*r.due()) == 250.0);
  CHECK(r.offer(6.0, 60.0, {}).warning.empty());  // what was taken back says nothing about the pace
}

TEST_CASE("the same value again, sooner than usual, is asked about") {
  CaptureLine longer = line();
  longer.to_mm = 500.0;
  CaptureRecord r({{}, *stops_of(longer)}, {});
  for (int k = 0; k < 5; ++k) CHECK(r.offer(0.1 * k, 5.0 * k, {}).warning.empty());
  CHECK(contains(r.offer(0.4, 21.0, {}).warning, "triggered twice?"));
}

TEST_CASE("a pause is no missed trigger") {
  CaptureLine longer = line();
  longer.to_mm = 500.0;
  CaptureRecord r({{}, *stops_of(longer)}, {});
  for (int k = 0; k < 5; ++k) CHECK(r.offer(0.1 * k, 5.0 * k, {}).warning.empty());
  r.pause();
  CHECK(r.offer(0.7, 300.0, {}).warning.empty());
}

TEST_CASE("where the display shows the position, the error is position less target") {
  CaptureRecord r = record(by_position());
  CHECK(r.offer(0.0012, 1.0, {}).taken);
  CHECK(r.taken()[0].error == Approx(1.2));
  CHECK(r.offer(49.9970, 2.0, {}).taken);
  CHECK(r.taken()[1].error == Approx(-3.0));
}

TEST_CASE("where the display shows the position, a doubled trigger is seen however late it comes") {
  CaptureRecord r = record(by_position());
  CHECK(r.offer(0.0, 1.0, {}).taken);
  const Verdict twice = r.offer(0.0, 9.0, {});
  CHECK(!twice.taken);
  CHECK(contains(twice.warning, "still shows 0 mm"));
  CHECK(r.taken().size() == 1);
}

TEST_CASE("where the display shows the position, a missed trigger leaves its target out and goes on right") {
  CaptureRecord r = record(by_position());
  CHECK(r.offer(0.0, 1.0, {}).taken);
  const Verdict missed = r.offer(100.001, 2.0, {});
  CHECK(missed.taken);
  CHECK(missed.missed == 1);
  CHECK(r.skipped() == 1);
  CHECK(r.taken().back().error == Approx(1.0));
  CHECK(*metadata_value(r.result(), "left out") == "X forward 50 mm, run 1");
  CHECK(r.undo());
  CHECK(target_mm(*r.due()) == 50.0);
  CHECK(r.skipped() == 0);
}

TEST_CASE("a position that is not a target of the pass is not taken") {
  CaptureRecord r = record(by_position());
  const Verdict lost = r.offer(-300.0, 1.0, {});
  CHECK(!lost.taken);
  CHECK(contains(lost.warning, "this pass has no target there"));
}

TEST_CASE("skip and undo go one step forward and back") {
  CaptureRecord r = record();
  CHECK(!r.undo());
  CHECK(r.offer(1.0, 1.0, {}).taken);
  CHECK(r.skip());
  CHECK(target_mm(*r.due()) == 100.0);
  CHECK(r.undo());
  CHECK(target_mm(*r.due()) == 50.0);
  CHECK(r.taken().size() == 1);
  CHECK(r.undo());
  CHECK(r.taken().empty());
  CHECK(target_mm(*r.due()) == 0.0);
}

TEST_CASE("after every reading the part reads back as where the capture was") {
  rc::check([] {
    CaptureRecord r = record(by_position());
    const auto steps = *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 5));
    double at_s = 0.0;
    for (const int step : steps) {
      at_s += 1.0;
      if (step == 0) {
        r.skip();
      } else if (step == 1) {
        r.undo();
      } else if (r.due() != nullptr) {
        static_cast<void>(r.offer(target_mm(*r.due()) + 0.001 * step, at_s, {{Quantity::air_degC, 20.0 + step}}));
      }
      if (r.taken().empty()) continue;
      const auto set = laser::parse_measurement_set(to_csv(r.part()), "a.csv.part");
      RC_ASSERT(set.has_value());
      const auto again = CaptureRecord::from_part(*set);
      RC_ASSERT(again.has_value());
      RC_ASSERT(again->next() == r.next());
      RC_ASSERT(laser::to_csv(again->part()) == laser::to_csv(r.part()));
      RC_ASSERT(laser::to_csv(again->result()) == laser::to_csv(r.result()));
    }
  });
}

TEST_CASE("a part that was changed so that it does not hold together is refused") {
  CaptureRecord r = record();
  CHECK(r.offer(1.0, 1.0, {}).taken);
  CHECK(r.offer(2.0, 2.0, {}).taken);
  const std::string text = laser::to_csv(r.part());
  const auto refused = [](std::string changed) {
    return !CaptureRecord::from_part(must(laser::parse_measurement_set(changed, "a.csv.part"))).has_value();
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    const std::size_t at = changed.find(from);
    REQUIRE(at != std::string::npos);
    return changed.replace(at, from.size(), to);
  };
  CHECK(!refused(text));
  CHECK(refused(with("# capture read: 0 1", "# capture read: 0 7")));
  CHECK(refused(with("# capture read: 0 1", "# capture read: 1 0")));
  CHECK(refused(with("# capture next: 2", "# capture next: 1")));
  CHECK(refused(with("# capture next: 2", "# capture next: 99")));
  CHECK(refused(with("# capture: unfinished", "# capture: finished")));
}

TEST_CASE("a target list gives its rows, and one without an approach is refused") {
  const auto set =
      laser::parse_measurement_set("axis,sense,x_mm,reading,approach,run,load_kg\nX,EY,5,0,-1,2,300\n", "t.csv");
  const auto stops = must(stops_of_targets(*set));
  CHECK(stops[0].load_kg == 300.0);
  CHECK(stops[0].run == 2);
  const auto none = laser::parse_measurement_set("axis,sense,x_mm,reading\nX,EY,5,0\n", "t.csv");
  REQUIRE(!stops_of_targets(*none));
  CHECK(to_text(stops_of_targets(*none).error()).find("t.csv:2") == 0);
}

}  // namespace
}  // namespace ecs::devices
