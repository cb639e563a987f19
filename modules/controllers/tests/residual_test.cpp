#include "modules/controllers/residual.hpp"

#include <doctest/doctest.h>

#include "modules/controllers/linuxcnc.hpp"
#include "modules/controllers/siemens.hpp"
#include "modules/controllers/tests/support/small_machine_map.hpp"

namespace ecs::controllers {
namespace {

using doctest::Approx;

/// One axis, 0 … 200 mm: error −10 um at 200 (compensation +10), reversal ±1 um.
ExportSource one_axis() {
  ExportSource source;
  source.parameters.configuration = {'T', 'X', 0, 0, 0};
  source.parameters.axis_present = {true, false, false};
  source.travel_mm[0] = {0.0, 200.0};
  add_table(source, Component::EXX, {0, 200}, {1, 11}, {-1, 9});
  return source;
}

TEST_CASE("before compensation the residual is the error, afterwards nothing of what the map says") {
  const ExportSource source = one_axis();
  const auto made = linuxcnc_export(source, {});
  REQUIRE(made);
  const auto rows = residuals(source, made->applied, {}, errors_of_map(source));
  REQUIRE(rows);
  REQUIRE(rows->size() == 2);
  CHECK((*rows)[0].where == "line of X");
  CHECK((*rows)[0].places == 402);
  CHECK((*rows)[0].before.largest_um[0] == Approx(11.0));
  CHECK((*rows)[0].unit.largest_um[0] == Approx(0.0));
  CHECK((*rows)[0].control.largest_um[0] == Approx(0.0));
}

TEST_CASE("a unit that steps leaves half a step") {
  ExportSource source = one_axis();
  source.parameters.interpolation = Interpolation::nearest;
  const auto made = linuxcnc_export(source, {});
  REQUIRE(made);
  CHECK(made->tables[0].deviation == Approx(5.0));
  const auto rows = residuals(source, made->applied, {}, errors_of_map(source));
  REQUIRE(rows);
  CHECK((*rows)[0].unit.largest_um[0] == Approx(5.0).epsilon(0.02));
  CHECK((*rows)[0].control.largest_um[0] == Approx(0.0));
}

TEST_CASE("an encoder table without cross tables leaves half the reversal") {
  const ExportSource source = one_axis();
  SiemensOptions options;
  options.most_tables = 0;
  const auto made = siemens_export(source, options);
  REQUIRE(made);
  const auto rows = residuals(source, made->applied, {}, errors_of_map(source));
  REQUIRE(rows);
  CHECK((*rows)[0].control.largest_um[0] == Approx(1.0));
  CHECK((*rows)[0].control.rms_um[0] == Approx(1.0));
}

TEST_CASE("a constant shift is no residual: it is counted from the reference point") {
  ExportSource source = one_axis();
  source.parameters.axes[0].datum.reference_position_mm = 200.0;  // siemens shifts its table by 10 um
  const auto made = siemens_export(source, {});
  REQUIRE(made);
  CHECK(made->tables[0].shift == Approx(10.0));
  const auto rows = residuals(source, made->applied, {}, errors_of_map(source));
  REQUIRE(rows);
  CHECK((*rows)[0].before.largest_um[0] == Approx(11.0));  // at 0, seen from 200
  CHECK((*rows)[0].control.largest_um[0] < 0.001);
}

TEST_CASE("errors given from elsewhere replace the map, and their problem is returned") {
  const ExportSource source = one_axis();
  const auto made = linuxcnc_export(source, {});
  const auto rows = residuals(source, made->applied, {}, [](const std::vector<MachinePlace>& places) {
    return Result<std::vector<Vector3>>(std::vector<Vector3>(places.size(), Vector3{}));
  });
  REQUIRE(rows);
  CHECK((*rows)[0].before.largest_um[0] == 0.0);
  CHECK((*rows)[0].control.largest_um[0] == Approx(11.0));  // compensated what is not there
  CHECK_FALSE(residuals(source, made->applied, {}, [](const auto&) -> Result<std::vector<Vector3>> {
    return problem(ProblemKind::bad_input, "no");
  }));
}

}  // namespace
}  // namespace ecs::controllers
