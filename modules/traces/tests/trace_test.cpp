#include "modules/traces/trace.hpp"

#include <fmt/format.h>

#include "modules/traces/simulation.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;

namespace {

const std::string kHead = "# feed_mm_min: 1200\n# distance_mm: 10\n";

std::string samples(int count) {
  std::string text;
  for (int k = 0; k < count; ++k) text += fmt::format("{:.3f},{:.2f}\n", 0.001 * k, k % 7 * 0.1);
  return text;
}

/// The problem with which a file is refused, all of it.
std::string refusal(const std::string& text) {
  const auto read = parse_trace(text, "step.csv");
  return read ? "" : to_text(read.error());
}

}  // namespace

TEST_CASE("a recorded step is read with its move, its noise and the step of its converter") {
  const auto trace = must(read_trace("samples/rig/step_recorded.csv"));
  CHECK(trace.time_s.size() == 801);
  CHECK(trace.move.feed_mm_min == 1200.0);
  CHECK(trace.move.distance_mm == 10.0);
  CHECK(trace.dac().quantum == Approx(0.02).epsilon(1e-6));
  CHECK(trace.dac().noise > 0.005);
  CHECK(trace.dac().noise < 0.012);
  const StepShape shape = shape_of(trace.time_s, trace.dac().value, trace.dac().noise);
  CHECK(*shape.steady == Approx(2.98).epsilon(0.004));
  CHECK(*shape.rise_s == Approx(0.067).epsilon(0.02));
  CHECK(*shape.decay_start_s == Approx(0.50).epsilon(0.005));
  CHECK(*shape.start_s == Approx(0.020).epsilon(0.05));
}

TEST_CASE("columns come in any order, others are left out and reported") {
  const auto trace = must(parse_trace(
      kHead + "note,dac_V,tacho_V,time_s\n" +
          [] {
            std::string rows;
            for (int k = 0; k < 30; ++k) rows += fmt::format("7,{},{},{}\n", 0.1 * k, 0.03 * k, 0.01 * k);
            return rows;
          }(),
      "step.csv"));
  REQUIRE(trace.signals.size() == 2);
  CHECK(trace.signals[1].id == DriveSignal::tacho);
  CHECK(trace.signals[1].value[10] == Approx(0.3));
  REQUIRE_FALSE(trace.notes.empty());
  CHECK(contains(trace.notes[0], "note"));
}

TEST_CASE("every wrong row is refused with its line and reason") {
  const std::string text =
      kHead + "time_s,dac_V\n0,0\n0.001,zero\n0.002,1,2\n0.003,nan\n0.0025,1\n0.0024,1\n" + samples(3);
  const std::string problems = refusal(text);
  check_holds(problems, {"step.csv:5:7: dac_V: expected a number, found \"zero\"", "step.csv:6:1: expected 2 fields",
                         "step.csv:7:7: dac_V: expected a number", "step.csv:9:1: time_s: expected more than 0.0025"});
}

TEST_CASE("a file without what a step needs is refused with what to add") {
  CHECK(contains(refusal(""), "header row"));
  CHECK(contains(refusal("time_s,dac_V\n" + samples(30)), "# feed_mm_min: 1200"));
  CHECK(contains(refusal("# feed_mm_min: 1200\ntime_s,dac_V\n" + samples(30)), "# distance_mm: 10"));
  CHECK(refusal("# feed_mm_min: fast\n# distance_mm: 10\ntime_s,dac_V\n" + samples(30))
            .find("step.csv:1:1: feed_mm_min") != std::string::npos);
  CHECK(
      contains(refusal("# feed_mm_min: -5\n# distance_mm: 0\ntime_s,dac_V\n" + samples(30)), "distance_mm: expected"));
  CHECK(contains(refusal(kHead + "time_s,volts\n" + samples(30)), "column dac_V"));
  CHECK(contains(refusal(kHead + "time_s,dac_V,dac_V\n"), "found dac_V twice"));
  CHECK(contains(refusal(kHead + "time_s,dac_V\n" + samples(10)), "at least 20 samples, found 10"));
  std::string flat = kHead + "time_s,dac_V\n";
  for (int k = 0; k < 50; ++k) flat += fmt::format("{},1.5\n", k);
  CHECK(contains(refusal(flat), "found 1.5 in every sample"));
}

TEST_CASE("a step recording differs from a measurement file by its header row") {
  CHECK(is_drive_trace("# a: b\n\ntime_s,dac_V\n0,0\n"));
  CHECK(
      is_drive_trace("\xEF\xBB\xBF"
                     "dac_V , time_s\r\n"));
  CHECK_FALSE(is_drive_trace("axis,sense,reading,time_s\nX,EX,1,2\n"));
  CHECK_FALSE(is_drive_trace(""));
}

TEST_CASE("a curve that runs into a flat end at full slope is clipped, a plateau reached slowly is not") {
  const auto read = [](double edge) {
    std::string rows = kHead + "time_s,dac_V\n";
    for (int k = 0; k < 500; ++k) {
      const double v = k < 20 ? 0.0 : 3.0 * (1.0 - std::exp(-(k - 20) / 30.0)) + 0.004 * std::sin(1.7 * k * k);
      rows += fmt::format("{},{:.2f}\n", 0.001 * k, std::min(v, edge));
    }
    return parse_trace(rows, "step.csv").value();
  };
  CHECK_FALSE(read(9.0).dac().clipped_above);
  REQUIRE(read(1.5).dac().clipped_above);
  CHECK(*read(1.5).dac().clipped_above == Approx(1.5).epsilon(0.01));
}

TEST_CASE("a model without a drive table has the constants as printed in appendix A") {
  const auto drive = must(parse_drive("name = \"rig\"\n", "rig.toml"));
  CHECK(drive[DriveConstant::Kw] == 0.632298);
  CHECK(drive[DriveConstant::Kd] == 0.0099734);
  CHECK(drive[DriveConstant::Ka] == 30.06);
  CHECK(drive[DriveConstant::J1] == 0.000517711);
  const auto named = must(parse_drive("[drive]\nKw_V_s_per_rad = 0.07\nK = 0.5\n", "rig.toml"));
  CHECK(named[DriveConstant::Kw] == 0.07);
  CHECK(named[DriveConstant::K] == 0.5);
  CHECK(parse_drive("[drive]\nKw = 0.07\n", "rig.toml").value()[DriveConstant::Kw] == 0.07);
  CHECK(parse_drive("compensated_readings = 12\n[drive]\nKw = 0.07\n", "fitted.toml"));
  CHECK(must(read_drive("samples/rig/drive_as_printed.toml")) == DriveParameters{});
}

TEST_CASE("wrong keys and values of a drive table are refused with their line") {
  const std::string problems = to_text(must_fail(
      parse_drive("[drive]\nKq = 1.0\nKa = -3\nTi_s = \"fast\"\nKw = 1.0\nKw_V_s_per_rad = 1.0\n", "rig.toml")));
  check_holds(problems, {"rig.toml:2", "rig.toml:3:6: Ka: expected a positive number in A/V, found -3",
                         "Ti_s: expected a finite number", "found both"});
}
