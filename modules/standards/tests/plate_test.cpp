// Flatness from the lines of a union jack, against Moody's own plate (samples/real/moody-plate).
#include "modules/standards/plate.hpp"

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

const std::string kMoody = "samples/real/moody-plate/moody.csv";

std::string moody_text() { return *read_file(kMoody); }

std::string with(std::string text, const std::string& old_text, const std::string& new_text) {
  const std::size_t at = text.find(old_text);
  REQUIRE(at != text.npos);
  return text.replace(at, old_text.size(), new_text);
}

std::string refusal(const std::string& text) { return to_text(must_fail(parse_plate_readings(text, "plate.csv"))); }

/// Eight lines over z(x, y), 8 by 6 steps of 100 mm; x, y in steps.
template <class Surface>
std::string plate_over(const Surface& z) {
  const double ends[8][4] = {{0, 6, 8, 0}, {8, 6, 0, 0}, {8, 6, 0, 6}, {8, 6, 8, 0},
                             {8, 0, 0, 0}, {0, 6, 0, 0}, {8, 3, 0, 3}, {4, 6, 4, 0}};
  const int steps[8] = {10, 10, 8, 6, 8, 6, 8, 6};
  std::string text = "# step_mm: 100\n# unit: um/m\nline,station_mm,reading\n";
  for (std::size_t i = 0; i < kPlateLines; ++i)
    for (int k = 0; k < steps[i]; ++k) {
      const auto height = [&](int at) {
        const double share = static_cast<double>(at) / steps[i];
        return z(std::lerp(ends[i][0], ends[i][2], share), std::lerp(ends[i][1], ends[i][3], share));
      };
      text += fmt::format("{},{},{:.9g}\n", kPlateLineNames[i], 100 * (k + 1), 10.0 * (height(k + 1) - height(k)));
    }
  return text;
}

}  // namespace

TEST_CASE("Moody's plate: his 126 heights, the highest 4.532 um, his closure errors") {
  const auto plate = must(parse_plate_readings(moody_text(), kMoody));
  const Flatness flatness = flatness_of(plate);
  REQUIRE(flatness.stations.size() == 126);
  const std::string heights = *read_file("samples/real/moody-plate/heights.csv");
  const auto rows = lines_of(heights);
  REQUIRE(rows.size() == 128);
  for (std::size_t k = 0; k < flatness.stations.size(); ++k) {
    const auto cells = split(rows[k + 2], ',');
    const PlateStation& station = flatness.stations[k];
    CHECK(cells[0] == kPlateLineNames[station.line]);
    CHECK(std::abs(station.height_um - *number_in(cells[2])) < 1e-4);
  }
  CHECK(flatness.moody_um == Approx(4.532).epsilon(0.0002));
  // Column 6 of the work sheets at the centre: -0.7 arcsec over 4 inches for E-W, 0 for N-S.
  CHECK(flatness.closure_um[0] == Approx(-0.7 * 4.848 * 0.1016).epsilon(0.01));
  CHECK(std::abs(flatness.closure_um[1]) < 1e-3);
  CHECK(flatness.minimum_zone_um <= flatness.least_squares_um);
  CHECK(flatness.least_squares_um <= flatness.moody_um);
}

TEST_CASE("readings as printed leave the closure error that gave the printing error away") {
  const auto printed = must(parse_plate_readings(with(moody_text(), "NE-NW,1016.0,18.8", "NE-NW,1016.0,18.3"), kMoody));
  CHECK(std::abs(flatness_of(printed).closure_um[1]) > 0.05);
}

TEST_CASE("the zero of each line is free: a tilted, displaced foot changes nothing") {
  const auto plate = must(parse_plate_readings(moody_text(), kMoody));
  PlateReadings moved = plate;
  for (std::size_t i = 0; i < kPlateLines; ++i)
    for (double& slope : moved.slopes_um_per_m[i]) slope += 3.0 * static_cast<double>(i);
  CHECK(flatness_of(moved).minimum_zone_um == Approx(flatness_of(plate).minimum_zone_um).epsilon(1e-6));
}

TEST_CASE("a bowl of 8 um over its length closes and has that flatness; a twisted plane has its twist") {
  const auto bowl =
      must(parse_plate_readings(plate_over([](double x, double) { return 0.5 * (x - 4.0) * (x - 4.0); }), "b"));
  CHECK(std::abs(flatness_of(bowl).closure_um[0]) < 1e-6);
  CHECK(flatness_of(bowl).minimum_zone_um == Approx(8.0));
  const auto twist =
      must(parse_plate_readings(plate_over([](double x, double y) { return (x - 4.0) * (y - 3.0); }), "t"));
  CHECK(flatness_of(twist).minimum_zone_um == Approx(24.0));
  CHECK(flatness_of(twist).moody_um == Approx(24.0));
}

TEST_CASE("what a surface file lacks is said in words") {
  const std::string text = moody_text();
  CHECK(
      contains(refusal(with(text, "# step_mm: 101.6\n", "")), "expected `# step_mm: ` with the distance of the feet"));
  const std::size_t n_s = text.find("N-S,");
  CHECK(contains(refusal(text.substr(0, n_s)), "the line N-S is missing; the order is NW-SE, NE-SW, NE-NW"));
  CHECK(
      contains(refusal(with(text, "NW-SE,279.4,6.0\n", "NW-SE,280.9,6.0\n")),
               "plate.csv:7:7: station_mm: expected 279.4, a step of 101.6 mm from 177.8, found 280.9: the steps must "
               "be equal"));
  CHECK(contains(refusal(with(text, "N-S,1117.6,7\n", "")), "line N-S: expected an even number of steps"));
  std::string swapped = text.substr(n_s) + text.substr(text.find("NW-SE,"), n_s - text.find("NW-SE,"));
  CHECK(contains(refusal(text.substr(0, text.find("NW-SE,")) + swapped),
                 "line: expected NW-SE here, found N-S: the order is NW-SE, NE-SW"));
  std::string turned = text;
  for (std::size_t at = turned.find("E-W,"); at != turned.npos; at = turned.find("\nE-W,", at))
    turned.replace(turned[at] == '\n' ? at + 1 : at, 3, "W-E");
  CHECK(contains(refusal(turned), "expected E-W from its first station, found W-E: reverse the order of its readings"));
  CHECK(contains(refusal(with(text, "NW-SE,177.8,6.5", "NW-SE,177.8,")), "reading: expected a number, found nothing"));
  CHECK(contains(refusal(with(text, "unit: arcsec", "unit: deg")), "unit: expected arcsec or um/m, found \"deg\""));
}
