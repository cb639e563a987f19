#include "ecs_emulator/settings/emulator.hpp"

#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

TEST_CASE("the emulator's table is read beside the machine") {
  const auto machine = machine_of(small_machine() + R"(
[emulator]
serial_number = "M-17"
seed = 9
errors = "true.toml"
[emulator.axis.Y]
dac_um_per_count = -0.2
reference_kind = "siemens"
reference_direction = -1
)");
  CHECK(machine.machine.configuration == "TXYZ");
  CHECK(machine.settings.serial_number == "M-17");
  CHECK(machine.settings.seed == 9);
  CHECK(machine.settings.errors == "./true.toml");
  CHECK(machine.settings.axes[1].dac_um_per_count == -0.2);
  CHECK(machine.settings.axes[1].reference_kind == DatumKind::siemens);
  CHECK(machine.settings.axes[1].reference_direction == Approach::reverse);
  CHECK(machine.settings.axes[0].dac_um_per_count == 0.1);
}

TEST_CASE("an axis comes to its reference switch at the end where the datum is, unless the file says otherwise") {
  const auto direction = [](const std::string& datum, const std::string& more) {
    const auto machine =
        machine_of("configuration = \"TX\"\n[axis.X]\ntravel_mm = [0.0, 500.0]\ndatum_mm = " + datum + "\n" + more);
    return machine.settings.axes[0].reference_direction;
  };
  CHECK(direction("0.0", "") == Approach::reverse);
  CHECK(direction("500.0", "") == Approach::forward);
  CHECK(direction("0.0", "[emulator.axis.X]\nreference_direction = 1\n") == Approach::forward);
}

TEST_CASE("every wrong value of the emulator's table is reported at once") {
  const auto machine = must_fail(parse_workshop_machine(small_machine() + R"(
[emulator]
seriel_number = "M-17"
[emulator.axis.X]
kv_per_s = 0
marker_pitch_mm = "ten"
reference_kind = "heidenhain"
count_polarity = 2
)",
                                                        "machine.toml", "."));
  CHECK(machine.also.size() == 4);
  CHECK(contains(to_text(machine), "did you mean \"serial_number\""));
}

TEST_CASE("a seed that no whole number of 64 bits holds is refused") {
  const auto seed = [](const char* number) {
    return parse_workshop_machine(small_machine() + "[emulator]\nseed = " + number + "\n", "machine.toml", ".");
  };
  CHECK(seed("9007199254740992").value().settings.seed == 9007199254740992U);
  for (const char* number : {"1e300", "18446744073709551616.0"}) {
    CHECK(contains(to_text(must_fail(seed(number))), "seed: expected at most 9007199254740992"));
  }
}
