// The question for the code, on the screens.
#include "app/screens/unit/screens.hpp"
#include "tests/screens/support/bad_line.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

/// A unit whose code the program does not know.
struct UnarmedCase : StateFolder {
  OwnEmulator emulator{*this, {"--mode", "integrate"}};
  std::shared_ptr<UnitConnection> unit;
  UnarmedCase() {
    ::unsetenv("ECS_ARM_CODE");
    unit = std::make_shared<UnitConnection>("rtu:" + emulator.pty + ":115200");
  }
  UnarmedCase(const UnarmedCase&) = delete;
  UnarmedCase& operator=(const UnarmedCase&) = delete;
  ~UnarmedCase() { ::setenv("ECS_ARM_CODE", kArmCode.c_str(), 1); }
  [[nodiscard]] Result<void> preset() const {
    JobControl control;
    return unit->with_link(control, [](UnitLink& link) { return link.client().set_axis_position(Axis::X, 1.0); });
  }
};

TEST_CASE("what the unit refuses for want of its code opens the question for it, and goes afterwards") {
  const UnarmedCase bench;
  CHECK(arm_screen_if_wanted(bench.unit) == nullptr);
  const auto refused = bench.preset();
  REQUIRE_FALSE(refused.has_value());
  CHECK(refused.error().kind == ProblemKind::refused);
  CHECK(bench.unit->snapshot().wants_code);
  const auto question = arm_screen_if_wanted(bench.unit);
  REQUIRE(question != nullptr);
  CHECK(arm_screen_if_wanted(bench.unit) == nullptr);  // asked once
  CHECK(reads(picture(*question), "The unit is read-only for this host"));
  enter(*question, "314159");
  CHECK(shows(*question, "this is not the code that the unit shows"));
  for (int k = 0; k < 50 && !contains(picture(*question), "takes writes"); ++k) {  // a second of the unit's clock
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    replace_line(*question, kArmCode);
    CHECK(until(*question, [&] {
      return question->advance() || contains(picture(*question), "try again") ||
             contains(picture(*question), "takes writes");
    }));
  }
  CHECK(shows(*question, "The unit takes writes and commands of this host for 30 minutes"));
  CHECK(press(*question, Key::Name::enter).kind == Step::Kind::back);
  CHECK(bench.preset().has_value());
}

TEST_CASE("Esc leaves the unit read-only") {
  const UnarmedCase bench;
  CHECK_FALSE(bench.preset().has_value());
  const auto question = arm_screen_if_wanted(bench.unit);
  REQUIRE(question != nullptr);
  CHECK(press(*question, Key::Name::escape).kind == Step::Kind::back);
  CHECK_FALSE(bench.preset().has_value());
}

}  // namespace
}  // namespace ecs::app
