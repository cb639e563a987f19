// The maps of all samples with a plan of measurements: by the wizard and by `ecs map build` bit for bit the same.
#include <sstream>

#include "tests/screens/support/laser_screen.hpp"

namespace ecs::app {
namespace {

namespace fs = std::filesystem;

/// `key = value` of a block of the plan, without quotation marks; empty: it has none.
std::string value_in(const std::string& block, const std::string& key) {
  const std::size_t at = block.find("\n" + key + " = ");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + key.size() + 4;
  std::string value = block.substr(begin, block.find('\n', begin) - begin);
  std::erase(value, '"');
  return value;
}

double parked_in(const std::string& block, char axis) {
  const std::string place = value_in(block, "parked_mm");
  const std::size_t at = place.find(std::string(1, axis) + " = ");
  return at == std::string::npos ? 0.0 : std::stod(place.substr(at + 4));
}

/// Every line that the plan of a sample asks for, its error a formula of its own. @return the files
std::vector<std::string> measured_by_plan(const Folder& folder, const std::string& sample) {
  const std::string plan = content_of("samples/" + sample + "/plan.toml");
  std::vector<std::string> files;
  double k = 1.0;
  for (std::size_t at = plan.find("[[measure]]"); at != std::string::npos;) {
    const std::size_t next = plan.find("[[measure]]", at + 1);
    const std::string block = plan.substr(at, next - at);
    at = next;
    const char axis = value_in(block, "axis")[0];
    Measured line{axis,
                  value_in(block, "sense"),
                  std::stod(value_in(block, "from_mm")),
                  std::stod(value_in(block, "to_mm")),
                  std::stod(value_in(block, "step_mm")),
                  {parked_in(block, 'x'), parked_in(block, 'y'), parked_in(block, 'z')},
                  value_in(block, "instrument")};
    k += 0.3;
    std::string csv =
        measured_csv(line, [&](double p) { return 10.0 * std::sin(p / (300.0 + 40.0 * k)) + 0.002 * k * p; });
    csv.erase(0, csv.find("# instrument"));  // the mill's name and serial number
    files.push_back(folder.with(value_in(block, "name") + ".csv", csv));
  }
  return files;
}

TEST_CASE("the wizard and the verb make the same maps of all samples, bit for bit") {
  for (const char* sample : {"lathe", "machining_centre", "mill"}) {
    CAPTURE(sample);
    const StateFolder folder;
    const std::string params = fmt::format("samples/{}/parameters.toml", sample);
    LaserScreenDriver driver;
    driver.take_files(measured_by_plan(folder, sample), params);
    driver.controller().change("the rest", [&](LaserChoices& c) {
      for (const LaserComponent& one : driver.controller().work().map.components)
        if (one.state == ComponentState::missing)
          c.components[std::string(name_of(one.component))].zero_reason = "not measured";
      c.header.customer = "Works";
      c.map_file = (folder.path / "screen.csv").string();
    });
    REQUIRE(driver.settled());
    REQUIRE(driver.controller().work().map.made);
    driver.controller().save();
    REQUIRE(driver.shows("saved: "));
    const std::string verb = (folder.path / "verb.csv").string(), unit = (folder.path / "verb.toml").string();
    REQUIRE(ran({"map", "build", folder / "screen-recipe.toml", "--params", params, "-o", verb, "--params-out", unit})
                .code == 0);
    CHECK(content_of(verb) == content_of(folder / "screen.csv"));
    CHECK(content_of(unit) == content_of(folder / "screen-parameters.toml"));
    CHECK(driver.controller().work().map.csv == content_of(verb));
  }
}

}  // namespace
}  // namespace ecs::app
