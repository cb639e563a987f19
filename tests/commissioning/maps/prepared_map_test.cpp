// A map with its parameters, judged and made into the bytes for the unit.
#include "base/file.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/image.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

/// A map and parameters of linear scope in a folder of their own.
class MapFiles {
 public:
  MapFiles() {
    auto file = params::read_parameters("samples/mill/parameters.toml").value();
    file.parameters.scope = Scope::linear;
    parameters = file.parameters;
    identity = {"moving column mill", "MCM-0107"};
    map.header.configuration = "TXYZ";
    map.header.machine = identity.machine;
    map.header.serial_number = identity.serial_number;
    map.tables = {{Component::EXX, Approach::unknown, {-4100.0, 0.0}, {1.0, 0.0}},
                  {Component::EYY, Approach::unknown, {-1400.0, 0.0}, {2.0, 0.0}},
                  {Component::EZZ, Approach::unknown, {-1000.0, 0.0}, {3.0, 0.0}}};
  }
  [[nodiscard]] Result<PreparedMap> prepared(const PrepareOptions& options = {}) const {
    REQUIRE(write_file(folder_ / "map.csv", laser::to_map_csv(map)));
    REQUIRE(params::write_parameters(folder_ / "parameters.toml", parameters, identity));
    return prepared_map(folder_ / "map.csv", folder_ / "parameters.toml", options);
  }

  laser::ErrorMap map;
  UnitParameters parameters;
  params::Identity identity;

 private:
  Folder folder_;
};

/// The reasons of a refusal, one below the other.
std::string reasons(const Result<PreparedMap>& refused) {
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ProblemKind::refused);
  return to_text(refused.error());
}

bool names(const std::string& text, std::string_view part) { return contains(text, part); }

}  // namespace

TEST_CASE("the image for a file is addressed to the machine and serial number of the map, else of the parameters") {
  MapFiles files;
  const auto sent = must(files.prepared());
  CHECK(must(image_for_file(sent)) == sent.image.bytes);  // the header states both
  CHECK(laser::stated_identity(must(image_for_file(sent))).serial_number == "MCM-0107");
  files.map.header.serial_number.clear();
  const auto by_parameters = must(image_for_file(must(files.prepared())));
  CHECK(laser::stated_identity(by_parameters).serial_number == "MCM-0107");
  CHECK(laser::stated_identity(by_parameters).machine == "moving column mill");
  CHECK(check_image(by_parameters).fault == ImageFault::none);
  files.identity.serial_number.clear();
  CHECK(laser::stated_identity(must(image_for_file(must(files.prepared())))).serial_number.empty());
}

TEST_CASE("a map that is complete for its parameters becomes the image of the unit, with both owners") {
  const MapFiles files;
  const auto prepared = must(files.prepared());
  CHECK(prepared.identity.serial_number == "MCM-0107");
  CHECK(prepared.header.machine == "moving column mill");
  const auto content = must(laser::content_of(prepared.image.bytes));
  REQUIRE(content.map.tables.size() == 3);
  CHECK(content.map.tables[0].component == Component::EXX);
  CHECK(content.map.tables[0].compensation.front() == Approx(1.0).epsilon(0.01));
  CHECK(content.parameters.scope == Scope::linear);
}

TEST_CASE("a map that resampling changes by more than its resolution is refused unless that is accepted") {
  MapFiles files;
  files.map.tables[0].position_mm = {-4100.0, -4000.0, -3933.0, 0.0};
  files.map.tables[0].compensation = {1.0, 185.0, -20.0, 0.0};
  CHECK(names(reasons(files.prepared()), "--accept-resampling"));
  const auto accepted = must(files.prepared({.accept_resampling = true}));
  const auto content = must(laser::content_of(accepted.image.bytes));
  const auto largest = must(largest_difference(files.map, content.map));
  CHECK(largest.component == Component::EXX);
  CHECK(largest.difference() > 1.0);
  const auto beyond = beyond_resolution(files.map, content.map);
  CHECK(only(beyond).component == Component::EXX);
  CHECK(beyond[0].position_mm == largest.position_mm);
}

TEST_CASE("points that are even within the digits of a map file are not resampled") {
  MapFiles files;
  auto& table = files.map.tables[0];
  table = {Component::EXX, Approach::unknown, {}, {}};
  for (int k = 0; k < 1200; ++k) {
    table.position_mm.push_back(std::round((-4100.0 + 4100.0 * k / 1199.0) * 1e4) * 1e-4);
    table.compensation.push_back(k * 7919 % 101);
  }
  const auto prepared = must(files.prepared());
  const auto content = laser::content_of(prepared.image.bytes);
  CHECK(content->map.tables[0].position_mm.size() == 1200);
  CHECK(beyond_resolution(files.map, content->map).empty());
  CHECK(largest_difference(files.map, content->map)->difference() <= 0.01);
}

TEST_CASE("a component declared zero with a reason is not missing") {
  MapFiles files;
  files.map.tables.pop_back();
  files.map.header.declared_zero.push_back({Component::EZZ, "measured below 1 um"});
  CHECK(files.prepared());
}

TEST_CASE("the unit of another serial number is an objection of the map and of its parameters") {
  const MapFiles files;
  const auto prepared = must(files.prepared());
  CHECK(other_unit(prepared, "MCM-0107").empty());
  CHECK(other_unit(prepared, "").empty());
  CHECK(other_unit(prepared, "MCM-0999").size() == 2);
}

}  // namespace ecs::commissioning
