// Whether an image, a map or parameters are for this unit.
#include "commissioning/unit/transfer.hpp"
#include "core/memory_image.hpp"
#include "laser/map/image.hpp"
#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

namespace ecs::commissioning {
namespace {

std::vector<std::uint8_t> image_with(std::size_t values, std::uint8_t modules, const std::string& serial_number = {}) {
  UnitParameters parameters{.configuration = {'T', 'X', 0, 0, 0},
                            .axis_present = {true, false, false},
                            .memory_modules = modules,
                            .scope = Scope::linear};
  laser::ErrorMap map;
  map.header.serial_number = serial_number;
  map.header.configuration = "TX";
  laser::MapTable table;
  for (std::size_t i = 0; i < values; ++i) {
    table.position_mm.push_back(static_cast<double>(i) - static_cast<double>(values - 1));
    table.compensation.push_back(0.0);
  }
  map.tables.push_back(std::move(table));
  return must(laser::image_of(map, parameters)).bytes;
}

protocol::Identity unit_with(std::uint16_t modules, std::uint32_t capacity) {
  return {.memory_modules = modules, .capacity_values = capacity};
}

TEST_CASE("an image fits a unit that has its modules and as much room as it has values, and no smaller one") {
  const auto image = image_with(1000, 2);
  CHECK(no_room_for(image, unit_with(2, 1000)).empty());
  CHECK(no_room_for(image, unit_with(5, 160'000)).empty());
  CHECK(no_room_for(image, unit_with(1, 32'000)).size() == 1);
  CHECK(no_room_for(image, unit_with(2, 999)).size() == 1);
  CHECK(no_room_for(image_with(40'000, 2), unit_with(1, 32'000)).size() == 3);  // modules, values and bytes
}

TEST_CASE("an image without room in the unit is refused before the unit is given any command") {
  auto shop = protocol::Workshop::on_tcp();  // one module, 32,000 values
  auto unit = shop.client();
  const auto sent = must_fail(send_image(unit, image_with(1000, 2)));
  CHECK(sent.kind == ProblemKind::refused);
  CHECK(contains(sent.message, "require 2 axis memory modules, the unit has 1"));
  UnitParameters parameters;
  parameters.memory_modules = 3;
  CHECK_FALSE(send_parameters(unit, parameters, {}).has_value());
  CHECK(shop.in_server([](protocol::ModbusServer&, protocol::UnitModel& model) { return model.log; }).empty());
  CHECK(send_image(unit, image_with(1000, 1)).has_value());
}

TEST_CASE("a dump belongs to a unit when neither its own serial number nor that of its map says otherwise") {
  const auto image = image_with(10, 1, "A-1");
  CHECK(other_unit("A-1", image, "A-1").empty());
  CHECK(other_unit("", image_with(10, 1), "A-1").size() == 1);  // its header names nobody
  CHECK(other_unit("B-2", image, "A-1").size() == 1);
  CHECK(other_unit("A-1", image, "B-2").size() == 2);
}

TEST_CASE("a dump whose map cannot be read is not taken for that of the unit") {
  auto image = image_with(10, 1, "A-1");
  image[kPrefixBytes + 3] ^= 1;
  CHECK(other_unit("A-1", image, "A-1").size() == 1);
}

TEST_CASE("parameters without a serial number are for any unit, others for theirs alone") {
  CHECK(other_unit(params::Identity{"mill", ""}, "A-1").empty());
  CHECK(other_unit(params::Identity{"mill", "A-1"}, "A-1").empty());
  CHECK(other_unit(params::Identity{"mill", "B-2"}, "A-1").size() == 1);
}

}  // namespace
}  // namespace ecs::commissioning
