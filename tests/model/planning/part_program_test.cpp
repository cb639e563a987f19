#include "base/text.hpp"
#include "model/planning/questions.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

/// A reading that a control running the program would trigger.
struct Triggered {
  Vector3 position_mm{};
  int approach = 0;  ///< sign of the last motion of the axis
  double feed_mm_min = 0.0;
  double dwell_s = 0.0;  ///< since the last motion
};

/// A control of the dialect: G00 G01 G04 G90 G91, X Y Z F H S, M03 M05 M08 M09, $REP … $END.
class Control {
 public:
  explicit Control(Axis axis, Vector3 start) : axis_(axis), at_(start) {}

  std::vector<Triggered> readings;
  std::vector<Vector3> places;  ///< every end of a motion
  int unknown = 0;              ///< words that the dialect does not have

  void run(const std::string& program) {
    std::vector<std::string> lines;
    for (const auto line : lines_of(program)) {
      const std::string code(trimmed(line.substr(0, line.find(';'))));
      if (!code.empty()) lines.push_back(code);
    }
    run(lines, 0, lines.size());
  }

 private:
  void run(const std::vector<std::string>& lines, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      if (lines[i].rfind("$REP", 0) != 0) {
        block(lines[i]);
        continue;
      }
      const auto times = must(integer_in(lines[i].substr(4)));
      std::size_t end = i + 1;
      for (int depth = 1; depth > 0; ++end) {
        REQUIRE(end < to);
        depth += lines[end].rfind("$REP", 0) == 0 ? 1 : lines[end] == "$END" ? -1 : 0;
      }
      for (long long n = 0; n < times; ++n) run(lines, i + 1, end - 1);
      i = end - 1;
    }
  }

  void block(const std::string& line) {
    if (line.front() != '>') {
      ++unknown;
      return;
    }
    std::map<char, double> coordinate;
    double dwell_s = -1.0;
    bool dwell = false, trigger = false;
    for (std::size_t i = 1; i < line.size();) {
      if (line[i] == ' ') {
        ++i;
        continue;
      }
      const char letter = line[i];
      std::size_t end = i + 1;
      while (end < line.size() &&
             (std::isdigit(static_cast<unsigned char>(line[end])) != 0 || line[end] == '.' || line[end] == '-'))
        ++end;
      const auto number = must(number_in(line.substr(i + 1, end - i - 1)));
      i = end;
      const int code = static_cast<int>(number);
      if (letter == 'G' && (code == 90 || code == 91))
        incremental_ = code == 91;
      else if (letter == 'G' && (code == 0 || code == 1))
        rapid_ = code == 0;
      else if (letter == 'G' && code == 4)
        dwell = true;
      else if (letter == 'H')
        dwell_s = number;
      else if (letter == 'F')
        feed_ = number;
      else if (letter == 'M' && (code == 8 || code == 9))
        trigger = code == 8;
      else if (letter == 'S' || (letter == 'M' && (code == 3 || code == 5)))
        continue;  // the spindle, which only warms
      else if (letter >= 'X' && letter <= 'Z')
        coordinate[letter] = number;
      else
        ++unknown;
    }
    if (dwell) dwelt_s_ += dwell_s;
    if (trigger) readings.push_back({at_, approach_, rapid_ ? 0.0 : feed_, dwelt_s_});
    for (const auto& [letter, value] : coordinate) move(letter, value);
  }

  void move(char letter, double value) {
    const Axis a = *axis_of(letter);
    double& place = at_[index_of(a)];
    const double before = place;
    place = incremental_ ? place + value : value;
    if (a == axis_ && place != before) approach_ = place > before ? 1 : -1;
    dwelt_s_ = 0.0;
    places.push_back(at_);
  }

  Axis axis_;
  Vector3 at_;
  bool incremental_ = false, rapid_ = true;
  double feed_ = 0.0, dwelt_s_ = 0.0;
  int approach_ = 0;
};

MeasurementProposal a_line(std::vector<double> targets) {
  return {.condition = "as now",
          .targets_mm = std::move(targets),
          .parked_mm = {0.0, 300.0, 120.5},
          .runs = 3,
          .minutes = 20.0};
}

std::vector<double> even(double from, double step, int count) {
  std::vector<double> targets;
  for (int i = 0; i < count; ++i) targets.push_back(from + step * i);
  return targets;
}

/// Runs the program and holds it against the target list.
void check_program(const MeasurementProposal& plan, const params::Machine& machine) {
  Vector3 middle{};
  for (const Axis a : kAllAxes) {
    const auto& travel = machine.axes[index_of(a)]->travel_mm;
    middle[index_of(a)] = 0.5 * (travel[0] + travel[1]) + 0.123;
  }
  Control control(plan.axis, middle);
  control.run(part_program(plan, machine));
  CHECK(control.unknown == 0);
  const auto list = must(laser::parse_measurement_set(target_list(plan), "targets.csv"));
  REQUIRE(control.readings.size() == list.readings.size());
  for (std::size_t i = 0; i < control.readings.size(); ++i) {
    const Reading& wanted = list.readings[i];
    CAPTURE(i);
    for (const Axis a : kAllAxes)
      CHECK(std::abs(control.readings[i].position_mm[index_of(a)] - wanted.position_mm[index_of(a)]) < 6e-4);
    CHECK(control.readings[i].approach == static_cast<int>(wanted.approach));
    CHECK(control.readings[i].feed_mm_min == Approx(*wanted.feed_mm_min));
    CHECK(control.readings[i].dwell_s == Approx(plan.dwell_s));
  }
  for (const Vector3& place : control.places)
    for (const Axis a : kAllAxes) {
      CHECK(place[index_of(a)] >= machine.axes[index_of(a)]->travel_mm[0]);
      CHECK(place[index_of(a)] <= machine.axes[index_of(a)]->travel_mm[1]);
    }
}

}  // namespace

TEST_CASE("equal steps become loops and are visited as the target list says") {
  const auto plan = a_line(even(25.0, 50.0, 19));
  const std::string program = part_program(plan, mill());
  check_holds(program, {"$REP 3", "$REP 18", "> X50.0G91", "> X-50.0G91"});
  check_program(plan, mill());
}

TEST_CASE("the printed example of the thesis: X from 0 to -4150 in steps of 50, three runs each way") {
  params::Machine machine = mill();
  machine.axes[0]->travel_mm = {-4155.0, 5.0};
  machine.axes[1]->travel_mm = {-1400.0, 0.0};
  auto plan = a_line(even(-4150.0, 50.0, 84));
  plan.approach = -1;
  plan.parked_mm = {0.0, -1400.0, 0.0};
  check_program(plan, machine);
  const std::string program = part_program(plan, machine);
  check_holds(program, {"$REP 3", "> G90G00X5.0", "> G90G01X0.0F2000", "> G04H2", "> M08", "> G04H1", "> M09",
                        "$REP 83", "> X-50.0G91", "$END", "> G90G00X-4155.0", "> G90G01X-4150.0F2000", "> X50.0G91"});
}

TEST_CASE("uneven targets become a line each") {
  const auto plan = a_line({12.3, 47.031, 103.2, 211.987, 400.0, 777.7});
  CHECK(contains(part_program(plan, mill()), "X47.031"));
  check_program(plan, mill());
}

TEST_CASE("steps that are not whole micrometres do not add up to a shift") {
  check_program(a_line(even(10.0, 100.0 / 3.0, 29)), mill());
}

TEST_CASE("one way, downwards, two feeds, on the fly, short reversals") {
  auto plan = a_line(even(100.0, 40.0, 12));
  plan.bidirectional = false;
  plan.approach = -1;
  check_program(plan, mill());
  plan.second_feed_mm_min = 500.0;
  check_program(plan, mill());
  plan.dwell_s = 0.0;
  check_program(plan, mill());
  plan.bidirectional = true;
  plan.overrun_mm = 2.0;
  plan.short_overrun = true;
  check_program(plan, mill());
  for (const auto& row : target_set(plan).readings) CHECK(*row.travel_since_reversal_mm == Approx(2.0));
}

TEST_CASE("an overrun ends at the travel, a target beyond it is left out and reported") {
  auto plan = a_line({2.0, 300.0, 998.5});
  check_program(plan, mill());
  plan.targets_mm.push_back(1200.0);
  const std::string program = part_program(plan, mill());
  CHECK(contains(program, "target 1200.0 omitted"));
  Control control(Axis::X, {});
  control.run(program);
  for (const Vector3& place : control.places) CHECK(place[0] <= 1000.0);
  const std::string at_end = part_program(a_line({0.0, 300.0, 990.0}), mill());
  CHECK(contains(at_end, "no room before 0.0"));
}

TEST_CASE("any plan is visited in the order of its target list") {
  std::mt19937_64 random(7);
  UniformDraws place(10.0, 990.0);
  for (int n = 0; n < 40; ++n) {
    std::vector<double> targets = n % 2 == 0 ? even(10.0 + n, 3.0 + n / 4.0, 5 + n) : std::vector<double>{};
    for (int i = 0; i < n % 5 * 3; ++i) targets.push_back(std::round(place(random) * 1000.0) / 1000.0);
    std::sort(targets.begin(), targets.end());
    targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
    if (targets.empty()) continue;
    auto plan = a_line(targets);
    plan.bidirectional = n % 3 != 0;
    plan.approach = n % 4 < 2 ? 1 : -1;
    plan.runs = 1 + n % 3;
    if (n % 7 == 0) plan.second_feed_mm_min = 750.0;
    check_program(plan, mill());
  }
}

TEST_CASE("a machine that is measured cold and warm is warmed between runs, then left to cool, with one zero") {
  auto plan = a_line({12.3, 100.0, 412.3});
  plan.runs = 4;
  plan.warming = Warming{.runs = 2, .minutes = 5.0};
  check_program(plan, mill());
  const std::string program = part_program(plan, mill());
  check_holds(program, {"> M03S3000", "> G90G01X12.3F6000", "$REP 38", "> G90G01X412.3\n", "> M05", "> G04H300"});
  const auto count = [&](const std::string& word) {
    std::size_t found = 0;
    for (std::size_t at = program.find(word); at != std::string::npos; at = program.find(word, at + 1)) ++found;
    return found;
  };
  CHECK(count("M03") == 2);
  CHECK(count("G04H300") == 1);
  auto at_once = plan;
  at_once.warming.reset();
  CHECK(minutes_of(plan, {}) == Approx(minutes_of(at_once, {}) + 15.0));
}

TEST_CASE("the operator reads what to set up before the first block") {
  auto plan = a_line(even(25.0, 50.0, 19));
  plan.condition = "with the machine 4 degC warmer";
  plan.temperatures_degC["t_material_degC"] = 24.5;
  plan.load_kg = 300.0;
  plan.compensated = false;
  plan.wait_minutes = 60.0;
  plan.new_set_up = true;
  plan.set_up = 2;
  const std::string program = part_program(plan, mill());
  const std::string head = program.substr(0, program.find("\n>"));
  check_holds(head, {"4 degC warmer", "t_material_degC at about 24.5", "300 kg", "COMPENSATION OFF", "60 min",
                     "Y 300.0 mm", "Z 120.5 mm", "set_up = 2", "3 runs, both ways"});
}

TEST_CASE("the target list is a measurement set with every known condition") {
  auto plan = a_line(even(25.0, 50.0, 5));
  plan.temperatures_degC["t_material_degC"] = 24.5;
  plan.compensated = true;
  plan.new_set_up = true;
  plan.set_up = 2;
  plan.first_run = 4;
  const auto list = must(laser::parse_measurement_set(target_list(plan), "targets.csv"));
  CHECK(laser::metadata_value(list, "content")->find("target list") == 0);
  REQUIRE(list.readings.size() == 30);
  const Reading& first = list.readings.front();
  CHECK(first.run == 4);
  CHECK(first.error == 0.0);
  CHECK(first.sensors_degC.at("t_material_degC") == 24.5);
  CHECK(first.compensated == true);
  CHECK(first.extras.at("set_up") == 2.0);
  CHECK(list.readings.back().run == 6);
  // 3 runs there and back over 200 mm at 2000 mm/min with 3 s a reading: 30 × 3 s + 6 × 6 s and the overruns
  CHECK(*list.readings.back().time_s == Approx(126.0).epsilon(0.05));
}
