// Where readings come from, and what a plan says of them. A capture under way, from triggers and values to the part
// file, with a display that exists only here. Surroundings beside the monitor: run under umockdev-wrapper.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "commissioning/measurements/table.hpp"
#include "laser/measurement_set.hpp"
#include "modules/capture/capture.hpp"
#include "tests/support/fake_devices/fake_hid.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

TEST_CASE("the number of a display is the last one of its line") {
  CHECK(last_number_in("X -50.0012 mm") == -50.0012);
  CHECK(last_number_in("12 3.5um") == 3.5);
  CHECK(!last_number_in("no signal").has_value());
  CHECK(!last_number_in("").has_value());
}

TEST_CASE("a display that writes continuously is followed: its last complete line counts") {
  const Folder folder;
  const std::string file = folder.with("log.txt", "1\n2\n3\n4.5");
  auto source = must(following_source(file));
  source->ask(0.0);
  const Shown shown = source->shown(0.1);
  REQUIRE(shown.kind == Shown::Kind::value);
  CHECK(shown.value == 3.0);
  std::ofstream(file, std::ios::app) << "6\n";
  CHECK(source->shown(0.2).value == 4.56);
}

TEST_CASE("a command is asked for what its display shows") {
  const auto source = command_source("echo shows 7.25 um");
  CHECK(source->shown(0.0).value == 7.25);
  CHECK(command_source("false")->shown(0.0).kind == Shown::Kind::none);
}

TEST_CASE("the default slope follows the kind of measurement") {
  const auto plan = must(parse_plan(
      "[[measure]]\nname = \"a\"\naxis = \"X\"\nsense = \"EX\"\n[[measure]]\nname = \"b\"\naxis = \"X\"\nsense = "
      "\"EY\"\n"
      "[[measure]]\nname = \"c\"\naxis = \"X\"\nsense = \"EC\"\n"
      "[[measure]]\nname = \"d\"\naxis = \"Y\"\nsense = \"EX\"\ninstrument = \"square\"\n",
      "plan.toml"));
  CHECK(plan[0].slope == laser::SlopeMethod::none);
  CHECK(plan[1].slope == laser::SlopeMethod::least_squares);
  CHECK(plan[2].slope == laser::SlopeMethod::none);
  CHECK(plan[3].slope == laser::SlopeMethod::none);
}

bool says(const SurroundingsWatch& watch, const std::string& text) {
  for (int k = 0; k < 500; ++k) {
    if (contains(watch.now().text, text)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  MESSAGE(watch.now().text);
  return false;
}

TEST_CASE("a thermometer is read beside the monitor, reported when unplugged, and read again when it is back") {
  fake::Bus bus;
  const auto watch = environment_watch("temper", 0.1);
  CHECK(says(*watch, "temper"));  // none is plugged in, and that is said
  auto stick = bus.plug(fake::temper_spec(0x0C45, 0x7401));
  fake::answer_like_temper(*stick, {{0x80, 0x04, 0x14, 0x80, 0x13, 0x40, 0, 0}});  // 20.5 and 19.25 degC
  CHECK(says(*watch, "air 20.50 degC, material 19.25 degC"));
  stick->unplug();
  CHECK(says(*watch, "was unplugged"));
  stick = bus.plug(fake::temper_spec(0x0C45, 0x7401));
  fake::answer_like_temper(*stick, {{0x80, 0x04, 0x15, 0x00, 0x13, 0x40, 0, 0}});
  CHECK(says(*watch, "air 21.00 degC"));
}

TEST_CASE("a device that is not an environment sensor is refused with its kind") {
  const auto watch = environment_watch("samples/devices/foot_switch.toml", 0.1);
  CHECK(says(*watch, "trigger"));
}

/// A display that shows these values, one for each trigger, and then none any more.
class Display final : public ReadingSource {
 public:
  explicit Display(std::vector<double> values) : values_(std::move(values)) {}
  void ask(double) override { ++asked_; }
  Shown shown(double) override {
    if (asked_ > values_.size()) return {Shown::Kind::ended, 0.0, "the display was switched off"};
    return {Shown::Kind::value, values_[asked_ - 1], {}};
  }
  [[nodiscard]] std::string name() const override { return "a display"; }

 private:
  std::vector<double> values_;
  std::size_t asked_ = 0;
};

/// X at 0, 100 and 200 mm, forward and back: six targets, one run.
devices::CaptureRecord record() {
  devices::CaptureLine line{.to_mm = 200.0, .step_mm = 100.0, .runs = 1};
  return {devices::CapturePlan{{}, devices::stops_of(line).value()}, {}};
}

CaptureSetup typed_into(const std::string& part = {}) {
  CaptureSetup setup;
  setup.part = part;
  return setup;
}

CaptureSetup triggered(std::vector<double> values) {
  return {.trigger_kind = TriggerKind::enter, .source = std::make_unique<Display>(std::move(values))};
}

void trigger(CaptureRun& run, double at_s) {
  run.typed("", at_s);
  run.step(std::chrono::milliseconds(0), at_s);
}

bool warned(CaptureRun& run, std::string_view part) {
  for (const CaptureNews& news : run.take_news())
    if (news.kind == CaptureNews::Kind::warning && contains(news.text, part)) return true;
  return false;
}

}  // namespace

TEST_CASE("typed values go to the targets in the order of measuring") {
  CaptureRun run(record(), typed_into(), 0.0);
  REQUIRE(run.record().plan().stops.size() == 6);
  double at_s = 0.0;
  for (const char* value : {"1", "2.5", "-3", "4", "5", "6"}) run.typed(value, at_s += 2.0);
  CHECK(run.done());
  const auto& taken = run.record().taken();
  REQUIRE(taken.size() == 6);
  CHECK(laser::target_mm(taken[1]) == 100.0);
  CHECK(taken[1].error == 2.5);
  CHECK(taken[1].approach == Approach::forward);
  CHECK(laser::target_mm(taken[5]) == 0.0);
  CHECK(taken[5].approach == Approach::reverse);
  CHECK(taken[5].time_s.value() == Approx(12.0));
}

TEST_CASE("a trigger takes the value of the display, one sooner than half a second after the last is none") {
  CaptureRun run(record(), triggered({1.0, 2.0, 3.0}), 0.0);
  trigger(run, 2.0);
  CHECK(run.record().taken().size() == 1);
  static_cast<void>(run.take_news());
  trigger(run, 2.2);
  CHECK(run.record().taken().size() == 1);
  CHECK(warned(run, "double trigger"));
  trigger(run, 4.0);
  REQUIRE(run.record().taken().size() == 2);
  CHECK(run.record().taken().back().error == 2.0);
}

TEST_CASE("a value typed where a display gives them is refused") {
  CaptureRun run(record(), triggered({1.0}), 0.0);
  static_cast<void>(run.take_news());
  run.typed("7.5", 2.0);
  CHECK(run.record().taken().empty());
  CHECK(warned(run, "readings come from a display"));
}

TEST_CASE("a display that ends strands the capture, and what was read is kept") {
  CaptureRun run(record(), triggered({1.0}), 0.0);
  trigger(run, 2.0);
  trigger(run, 4.0);
  CHECK(run.stuck() == "the display was switched off");
  CHECK(run.record().taken().size() == 1);
  CHECK_FALSE(run.done());
}

TEST_CASE("u takes the last reading back, s leaves a target without one, q leaves") {
  CaptureRun run(record(), typed_into(), 0.0);
  run.typed("1", 2.0);
  run.typed("2", 4.0);
  run.typed("u", 5.0);
  CHECK(run.record().taken().size() == 1);
  CHECK(laser::target_mm(*run.record().due()) == 100.0);
  run.typed("s", 6.0);
  CHECK(run.record().skipped() == 1);
  CHECK(laser::target_mm(*run.record().due()) == 200.0);
  static_cast<void>(run.take_news());
  run.typed("nonsense", 7.0);
  CHECK(warned(run, "neither a value (with a decimal point) nor a command"));
  CHECK_FALSE(run.left());
  run.typed("q", 8.0);
  CHECK(run.left());
}

TEST_CASE("every reading is on disc, and the capture goes on from there") {
  const auto part = (std::filesystem::temp_directory_path() / "ecs-capture-session-test.part.csv").string();
  {
    CaptureRun run(record(), typed_into(part), 0.0);
    run.typed("1", 2.0);
    run.typed("2", 4.0);
    CHECK(run.part_is_safe());
  }
  const auto set = must(laser::read_measurement_set(part));
  CHECK(set.readings.size() == 2);
  const auto again = must(devices::CaptureRecord::from_part(set));
  REQUIRE(again.due() != nullptr);
  CHECK(laser::target_mm(*again.due()) == 200.0);
  std::filesystem::remove(part);
}

TEST_CASE("a part file that cannot be written is said, and the readings stay in memory") {
  CaptureRun run(record(), typed_into("/no/such/folder/part.csv"), 0.0);
  run.typed("1", 2.0);
  CHECK_FALSE(run.part_is_safe());
  CHECK(warned(run, "the readings are only in memory"));
  CHECK(run.record().taken().size() == 1);
}

}  // namespace ecs::commissioning
