// Circular tests in a report: found in its folder or named, drawn, with their causes.
#include <doctest/doctest.h>

#include "base/file.hpp"
#include "tests/app/support/report_folder.hpp"

namespace ecs::app {
namespace {

std::string circle_sample() { return *read_file("samples/standards/circle.csv"); }

TEST_CASE("a circular test is drawn, with its values, its causes and its file") {
  const Commissioning c;
  (void)c.folder.with("test.csv", circle_sample());
  const Ran r = c.report({"--circle", c.folder / "test.csv", "--json"});
  REQUIRE(r.code == 0);
  const auto circles = r.json()["circles"];
  REQUIRE(circles.size() == 1);
  CHECK(circles[0]["plane"] == "XY");
  CHECK(circles[0]["G_um"].get<double>() > 0.0);
  REQUIRE(!circles[0]["causes"].empty());
  const std::string html = c.html();
  CHECK(fault_of(html) == "");
  CHECK(contains(html, "<h2>Circular tests (ISO 230-4)</h2>"));
  CHECK(contains(html, "test.csv, plane XY, radius"));
  CHECK(contains(html, "aria-label=\"Circular test (ISO 230-4)\""));
  CHECK(contains(html, "counter-clockwise"));
  CHECK(contains(html, "least squares circle"));
}

TEST_CASE("circular tests are found in the folder circles/; an open one makes no report") {
  const Commissioning c;
  (void)c.folder.with("circles/XY.csv", circle_sample());
  const Ran r = c.report({"--json"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["circles"].size() == 1);
  (void)c.folder.with("circles/ZX.csv", "# plane: ZX\n# radius_mm: 100\nangle_deg,deviation_um,direction\n0,1,cw\n");
  const Ran refused = c.report();
  CHECK(refused.code == 3);
  CHECK(contains(refused.messages, "ZX.csv"));
  CHECK(contains(refused.messages, "the circle is open"));
}

}  // namespace
}  // namespace ecs::app
