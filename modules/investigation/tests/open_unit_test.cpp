// An investigation with the bundled emulator, whose port this program itself has open.
#include <chrono>
#include <filesystem>
#include <thread>

#include <doctest/doctest.h>

#include "commissioning/link/unit_connection.hpp"
#include "modules/investigation/socket_workshop.hpp"
#include "tests/support/emulator.hpp"
#include "tests/support/folder.hpp"

namespace ecs::commissioning {
namespace {

TEST_CASE("the map goes to the unit over the link that is open; its port cannot be opened a second time") {
  const StateFolder folder;
  const std::string machine_file = folder / "machine.toml";
  for (const char* name : {"machine.toml", "errors.toml"})
    std::filesystem::copy_file(std::string("samples/investigation/") + name, folder / name);
  const auto unit = std::make_shared<UnitConnection>("emulator:" + machine_file);
  for (int k = 0; k < 3000 && !unit->newest(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  REQUIRE_MESSAGE(unit->newest(), unit->snapshot().problem);
  const WatchedUnit seen = unit->snapshot();
  REQUIRE_FALSE(seen.workshop.empty());
  const auto machine = params::read_machine(machine_file);
  REQUIRE(machine);
  const auto model =
      model::parse_model("[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\nparameters = { um_per_m = 20.0 }\n",
                         "model.toml", folder.path);
  REQUIRE_MESSAGE(model, to_text(model.error()));
  JobControl control;
  NoMessages messages;
  SocketWorkshopOptions options;
  options.socket = seen.workshop;
  options.sources.machine = machine_file;
  options.machine = machine->machine;
  SUBCASE("opened by itself it is refused") {
    const auto workshop = SocketWorkshop::open(messages, options, control.cancelled);
    REQUIRE(workshop);
    const auto active = (*workshop)->activate(*model);
    REQUIRE_FALSE(active);
    CHECK(active.error().message.find("in use by") != std::string::npos);
  }
  SUBCASE("over the open link the unit compensates afterwards") {
    options.open_unit = {seen.where, seen.workshop, [&](const auto& work) {
                           return unit->with_link(control, [&](UnitLink& link) { return work(link.client()); });
                         }};
    SUBCASE("known by the socket") {}
    SUBCASE("known by the port") { options.open_unit.workshop.clear(); }
    const auto workshop = SocketWorkshop::open(messages, options, control.cancelled);
    REQUIRE(workshop);
    const auto active = (*workshop)->activate(*model);
    REQUIRE_MESSAGE(active, to_text(active.error()));
    const auto status = unit->with_link(control, [](UnitLink& link) { return link.client().status(); });
    REQUIRE(status);
    CHECK(status->mode == UnitMode::compensating);
  }
}

}  // namespace
}  // namespace ecs::commissioning
