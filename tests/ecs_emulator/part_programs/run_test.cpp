#include "ecs_emulator/part_programs/run.hpp"

#include <numbers>

#include "base/file.hpp"
#include "base/text.hpp"
#include "ecs_emulator/instruments/measurement.hpp"
#include "ecs_emulator/part_programs/writer.hpp"
#include "ecs_emulator/workshop/workshop.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

/// Drives that follow as one lag of first order each, quick enough for a test.
std::string ideal_drives(double kv_per_s) {
  std::string text;
  for (const char axis : {'X', 'Y', 'Z'})
    text += "[emulator.axis." + std::string(1, axis) + "]\ndrive = \"ideal\"\nkv_per_s = " + shortest(kv_per_s) + "\n";
  return text;
}

Program program_of(const std::string& text) { return must(parse_program(text, "p.nc")); }

ProgramResult ran(Simulation& simulation, const std::string& text, const ProgramOrder& order = {}) {
  return must(run_program(simulation, program_of(text), order));
}

ProgramOrder measuring(Axis axis, Sense sense) { return {.axis = axis, .sense = sense}; }

/// A trace as numbers, row by row.
std::vector<std::vector<double>> rows_of(const std::string& file) {
  const auto text = must(read_file(file));
  std::vector<std::vector<double>> rows;
  const auto lines = lines_of(text);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (lines[i].empty()) continue;
    rows.emplace_back();
    for (const auto field : split(lines[i], ',')) rows.back().push_back(number_in(field).value());
  }
  return rows;
}

/// The mill with ideal drives, and another travel of X where one is given.
WorkshopMachine mill(const std::string& x_travel = "") {
  std::string text = *read_file("samples/mill/machine.toml");
  const auto replace = [&](const std::string& old, const std::string& by) {
    REQUIRE(text.find(old) != text.npos);
    text.replace(text.find(old), old.size(), by);
  };
  if (!x_travel.empty()) replace("travel_mm = [-4100.0, 0.0]", "travel_mm = " + x_travel);
  for (const std::string axis : {"X", "Y", "Z"})
    replace("[emulator.axis." + axis + "]\n", "[emulator.axis." + axis + "]\ndrive = \"ideal\"\n");
  return machine_of(text + kPerfectInstruments);
}

}  // namespace

TEST_CASE("the program of the thesis's appendix B is refused on the mill, with the lines that go beyond its travel") {
  Simulation simulation(mill(), TrueErrors(), 1);
  const auto program = must(read_program("samples/mill/appendix_b.nc"));
  const Vector3 before_mm = simulation.machine().command_mm();
  const std::string all = to_text(must_fail(run_program(simulation, program, measuring(Axis::X, Sense::EX))));
  CHECK(all.find("appendix_b.nc:9: X: goes to -4150 mm") != all.npos);  // the last pass of the loop
  CHECK(all.find("appendix_b.nc:15: X: goes to -4155 mm") != all.npos);
  CHECK(all.find("appendix_b.nc:16: X: goes to -4150 mm") != all.npos);
  CHECK(simulation.machine().command_mm() == before_mm);
}

TEST_CASE("the program of the thesis's appendix B takes six times 84 readings where the axis is long enough") {
  Simulation simulation(mill("[-4200.0, 0.0]"),
                        errors_of("[[contribution]]\ncomponent = \"EXX\"\nformula = \"-0.008*p + 1.5*d\"\n"), 1);
  const auto program = must(read_program("samples/mill/appendix_b.nc"));
  const auto result = must(run_program(simulation, program, measuring(Axis::X, Sense::EX)));
  const auto& readings = result.readings->readings;
  REQUIRE(readings.size() == 6 * 84);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const std::size_t pass = i / 84;
    const double step = static_cast<double>(i % 84);
    CHECK(laser::target_mm(readings[i]) == (pass % 2 == 0 ? -50.0 * step : -4150.0 + 50.0 * step));
    CHECK(readings[i].approach == (pass % 2 == 0 ? Approach::reverse : Approach::forward));
    CHECK(readings[i].run == static_cast<int>(pass / 2) + 1);
    const double error_um = -0.008 * laser::target_mm(readings[i]) + (pass % 2 == 0 ? 0.0 : 3.0);
    CHECK(readings[i].error == Approx(error_um).epsilon(1e-3).scale(10.0));
  }
}

TEST_CASE("a program written for a plan reads what measure reads") {
  const std::string errors =
      "[[contribution]]\ncomponent = \"EXX\"\nformula = \"0.02*p + 1.5*d + 2*sin(p/7)\"\n"
      "[[contribution]]\ncomponent = \"EYX\"\nformula = \"0.01*p*p/50\"\n";
  for (const bool bidirectional : {true, false}) {
    for (const Sense sense : {Sense::EX, Sense::EY}) {
      MeasurementPlan plan{.sense = sense, .targets_mm = targets_between(-10.0, -430.0, 40.0)};
      plan.targets_mm.insert(plan.targets_mm.begin() + 1, -12.3456);
      plan.bidirectional = bidirectional;
      plan.feed_mm_min = 6000.0;
      plan.parked_mm = {std::nullopt, -100.0, -20.0};
      auto one = simulation_of(errors, small_machine() + ideal_drives(30.0));
      auto other = simulation_of(errors, small_machine() + ideal_drives(30.0));
      const auto by_hand = must(measure(one, plan));
      const auto by_program = ran(other, program_for(plan), measuring(Axis::X, sense));
      REQUIRE(by_program.readings->readings.size() == by_hand.readings.size());
      for (std::size_t i = 0; i < by_hand.readings.size(); ++i) {
        const auto& a = by_hand.readings[i];
        const auto& b = by_program.readings->readings[i];
        CHECK(b.position_mm == a.position_mm);
        CHECK(b.approach == a.approach);
        CHECK(b.run == a.run);
        CHECK(b.error == Approx(a.error).epsilon(1e-4).scale(1.0));
      }
    }
  }
}

TEST_CASE("every row of the mill's plan becomes a program that the mill can run") {
  const auto files = must(programs_of_plan("samples/mill/plan.toml", "samples/mill/machine.toml"));
  CHECK(files.front().name == "EXX.nc");
  CHECK(!contains(files.front().text, "$REP 82"));  // moved off equal steps
  CHECK(files.size() == 19);
  const auto even = must(programs_of_plan("samples/mill/plan.toml", "samples/mill/machine.toml", true));
  CHECK(contains(even.front().text, "$REP 82"));
}

TEST_CASE("programs in the form in which the host proposes a measurement run") {
  auto simulation = simulation_of("", small_machine() + ideal_drives(30.0));
  const auto result =
      ran(simulation,
          "; EXX along X, to tell backlash from cyclic error\n"
          "> G90G00Y-100.0Z-20.0  ;PARK THE OTHER AXES\n"
          "$REP 2                 ;REPEAT 2 TIMES\n"
          "> G90G00X0.0           ;REMOVE BACKLASH BEFORE FIRST READING\n"
          "> G90G01X-5.0F2000\n> G04H2\n> M08\n> G04H1\n> M09\n"
          "$REP 4\n> X-100.0G91           ;MOVE INCREMENTALLY -100.0 mm\n> G04H2\n> M08\n> G04H1\n> M09\n$END\n"
          "> G90G00X-410.0\n> G90G00X-400.0         ;REVERSE SHORTLY BEFORE THE TARGET\n"
          "> G90G01X-405.0F500\n> M08\n> G04H1\n> M09\n"
          "$END                   ;END OF RUNS\n",
          measuring(Axis::X, Sense::EX));
  const auto& readings = result.readings->readings;
  REQUIRE(readings.size() == 12);
  CHECK(readings[4].position_mm == Vector3{-405.0, -100.0, -20.0});
  CHECK(readings[4].run == 1);
  CHECK(readings[5].run == 2);  // the same target in the same approach once more
  CHECK(readings[10].run == 3);
  CHECK(readings[11].run == 4);
  CHECK(readings[5].approach == Approach::reverse);
}

TEST_CASE("a square is zeroed before the program that measures against it begins") {
  const std::string errors = "[squareness]\nC0Y = 30.0\n[[contribution]]\ncomponent = \"EYX\"\nformula = \"0.05*p\"\n";
  auto simulation = simulation_of(errors, small_machine() + ideal_drives(30.0));
  auto order = measuring(Axis::Y, Sense::EX);
  order.instrument = InstrumentKind::square;
  const auto result = ran(simulation, "G90G00X0Y5\nY0F6000\nG04H1\nM08\nM09\nY-400\nG04H1\nM08\nM09", order);
  CHECK(result.readings->readings.back().error == Approx(-8.0).epsilon(1e-3));  // as measurement_test.cpp
}

TEST_CASE("a reading without a dwell is taken in position, no later") {
  auto simulation = simulation_of("", small_machine() + ideal_drives(30.0));
  const auto result =
      ran(simulation, "G90G00X5\nG01X0F6000\nG04H1\nM08\nM09\nX-100\nM08\nM09", measuring(Axis::X, Sense::EX));
  const double lag_um = result.readings->readings.back().error;
  CHECK(lag_um > 1.0);
  CHECK(lag_um <= 10.0);
}

TEST_CASE("a wrong or cancelled program moves nothing and writes nothing") {
  auto simulation = simulation_of("", small_machine() + ideal_drives(30.0));
  const Vector3 before_mm = simulation.machine().command_mm();
  CHECK(!run_program(simulation, program_of("G00X-5\nX-900"), {}).has_value());
  CHECK(simulation.machine().command_mm() == before_mm);
  CHECK(!run_program(simulation, program_of("G00X-5"), measuring(Axis::X, Sense::EX)).has_value());  // no reading
  simulation.on_pause([] { return false; });
  const Folder folder;
  ProgramOrder order;
  order.trace = folder / "trace.csv";
  const auto result = must_fail(run_program(simulation, program_of("$REP 100\nG01F100X-500\nX0\n$END"), order));
  CHECK(result.kind == ProblemKind::refused);
  CHECK(!std::filesystem::exists(order.trace));
  CHECK(!std::filesystem::exists(folder / "trace.csv.part"));
}

TEST_CASE("the spindle starts before the motion and stops after it") {
  auto simulation = simulation_of("", small_machine() + ideal_drives(30.0));
  std::vector<std::pair<double, double>> heard;  // rpm, command of X
  ProgramHooks hooks;
  hooks.spindle = [&](double rpm) { heard.emplace_back(rpm, simulation.machine().command_mm()[0]); };
  REQUIRE(run_program(simulation, program_of("G90G00X0\nS1500M03X-10\nX-20M05\nM04S200"), {}, hooks).has_value());
  CHECK(heard == std::vector<std::pair<double, double>>{{1500.0, 0.0}, {0.0, -20.0}, {-200.0, -20.0}});
}

TEST_CASE("a program longer than the look-ahead runs through at its feed") {
  auto simulation = simulation_of("", small_machine() + ideal_drives(30.0));
  const auto result = ran(simulation, "G90G00X0\nG01F6000\n$REP 40000\nX-0.01G91\n$END");  // 400 mm at 100 mm/s
  CHECK(simulation.machine().command_mm()[0] == -400.0);
  CHECK(result.took_s < 5.5);
}

TEST_CASE("the circle of thesis 7.3 is commanded as a circle, both ways round, and nothing of it is lost") {
  Simulation simulation(mill(), TrueErrors(), 1);
  const Folder folder;
  ProgramOrder order{.trace = folder / "trace.csv", .trace_period_s = 0.01};
  const Vector3 start_mm = simulation.machine().command_mm();
  const auto program = must(read_program("samples/mill/circle_xz.nc"));
  const auto result = must(run_program(simulation, program, order));
  const double to_start_mm = std::hypot(start_mm[0] + 1900.0, start_mm[2] + 475.0);
  CHECK(result.summary.path_mm == Approx(to_start_mm + 550.0 * std::numbers::pi).epsilon(1e-9));
  double worst_mm = 0.0;
  double turned_rad[2] = {0.0, 0.0};
  double last_rad = 0.0;
  for (const auto& row : rows_of(order.trace)) {
    const int line = static_cast<int>(row[1]);
    if (line != 8 && line != 12) continue;
    const double x = row[2] + 2000.0;
    const double z = row[8] + 500.0;
    worst_mm = std::max(worst_mm, std::abs(std::hypot(x, z) - 125.0));
    const double angle_rad = std::atan2(x, z);  // from Z towards X
    const double turn = std::remainder(angle_rad - last_rad, 2.0 * std::numbers::pi);
    if (std::abs(turn) < 0.1) turned_rad[line == 8 ? 0 : 1] += turn;
    last_rad = angle_rad;
  }
  CHECK(worst_mm < 1e-9);
  CHECK(turned_rad[0] == Approx(2.0 * std::numbers::pi).epsilon(0.001));
  CHECK(turned_rad[1] == Approx(-2.0 * std::numbers::pi).epsilon(0.001));
}

TEST_CASE("a drive of first order cuts a circle smaller by v squared over 2 Kv squared R") {
  auto simulation = simulation_of("", small_machine() + ideal_drives(10.0));
  const Folder folder;
  ProgramOrder order;
  order.trace = folder / "trace.csv";
  ran(simulation, "G90G18G00X-250Z-25\nG03F3000X-250Z-25K-125\nX-250Z-25K-125\n", order);
  const double speed = 50.0;
  const double expected_mm = speed * speed / (2.0 * 10.0 * 10.0 * 125.0);  // 0.1 mm
  double sum_mm = 0.0;
  int count = 0;
  for (const auto& row : rows_of(order.trace)) {
    if (static_cast<int>(row[1]) != 3) continue;  // the first round gets rid of the start
    const double radius = std::hypot(row[3] + 250.0, row[9] + 150.0);
    if (std::hypot(row[2] + 250.0, row[8] + 25.0) < 60.0) continue;  // away from the braking at the end
    sum_mm += 125.0 - radius;
    ++count;
  }
  REQUIRE(count > 1000);
  CHECK(sum_mm / count == Approx(expected_mm).epsilon(0.01));
}

TEST_CASE("the workshop runs programs and single blocks by request") {
  auto simulation = simulation_of("", small_machine() + ideal_drives(30.0));
  const Workshop workshop{&simulation, nullptr, nullptr};
  const auto moved = perform(workshop, R"({"action": "mdi", "block": "G01 X-100 F2000"})");
  CHECK(moved.find("\"ok\":true") != moved.npos);
  CHECK(simulation.machine().command_mm()[0] == -100.0);
  const auto refused = perform(workshop, R"({"action": "mdi", "block": "G01 X-100"})");
  CHECK(refused.find("mdi:1: expected a feed") != refused.npos);
  const Folder folder;
  const std::string program = folder.with("request.nc", "$REP 50\nG00X-5\nX0\nG04H1\nM08\nM08\nM09\n$END\n");
  std::vector<std::string> reports;
  const auto answer =
      perform(workshop, R"({"action": "run", "program": ")" + program + R"(", "axis": "X", "sense": "EX"})",
              [&](const std::string& line) { reports.push_back(line); });
  CHECK(answer.find("\"readings\":50") != answer.npos);
  CHECK(answer.find("\"missed_trigger_lines\":[6]") != answer.npos);
  CHECK(reports.size() > 50);
  CHECK(reports.front().rfind("{\"progress\":0.0", 0) == 0);  // as the socket tells it from an answer
  CHECK(contains(reports.front(), "\"line\":"));
}
