#include "base/file.hpp"
#include "ecs_emulator/unit/memory.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;

TEST_CASE("axis memory and commit records survive in the battery's file, system RAM does not") {
  const Folder folder;
  const auto file = folder.path / "battery";
  UnitMemory memory(2);
  memory.write(kBankA.first + 5, 17);
  memory.write(kBankB.first + bank_bytes(2) - 1, 18);
  memory.write(kCommitRecords.first, 19);
  memory.write(kSystemRam.first, 20);
  CHECK(memory.changed());
  REQUIRE(keep(memory, file).has_value());
  CHECK(!memory.changed());
  UnitMemory other(2);
  REQUIRE(restore(other, file).has_value());
  CHECK(other.read(kBankA.first + 5) == 17);
  CHECK(other.read(kBankB.first + bank_bytes(2) - 1) == 18);
  CHECK(other.read(kCommitRecords.first) == 19);
  CHECK(other.read(kSystemRam.first) == 0);
}

TEST_CASE("a file that is not a battery memory, or is of another rack, is refused; a missing one is an empty memory") {
  const Folder folder;
  UnitMemory memory(1);
  CHECK(restore(memory, folder.path / "missing").has_value());
  REQUIRE(write_file(folder.path / "text", "hello").has_value());
  CHECK(!restore(memory, folder.path / "text").has_value());
  UnitMemory larger(3);
  REQUIRE(keep(larger, folder.path / "three").has_value());
  CHECK(!restore(memory, folder.path / "three").has_value());
}

TEST_CASE("the mark of a memory in use is never written into another file") {
  const Folder folder;
  const auto battery = folder.path / "battery";
  REQUIRE(write_file(folder.path / "precious", "data").has_value());
  std::filesystem::create_symlink(folder.path / "precious", folder.path / "battery.in-use");
  CHECK(!BatteryLock::take(battery).has_value());
  CHECK(read_file(folder.path / "precious").value() == "data");
  std::filesystem::remove(folder.path / "battery.in-use");
  REQUIRE(write_file(folder.path / "battery.in-use", "notes of somebody").has_value());
  CHECK(contains(to_text(must_fail(BatteryLock::take(battery))), "found another file"));
  CHECK(read_file(folder.path / "battery.in-use").value() == "notes of somebody");
  std::filesystem::remove(folder.path / "battery.in-use");
  CHECK(BatteryLock::take(battery).has_value());
}
