// Units that headings of tables state.
#include "laser/import/heading_units.hpp"

#include <doctest/doctest.h>

using namespace ecs::laser;

namespace {

std::string unit_of_heading(const std::string& heading) {
  const auto unit = unit_in_heading(heading);
  return unit ? std::string(unit->name) : "";
}

}  // namespace

TEST_CASE("a unit is found between brackets, behind an underscore and at the end") {
  CHECK(unit_of_heading("Abweichung [mm]") == "mm");
  CHECK(unit_of_heading("Position (m)") == "m");
  CHECK(unit_of_heading("error_in") == "in");
  CHECK(unit_of_heading("Weg Zoll") == "in");
  CHECK(unit_of_heading("Zoll (Zoll)") == "in");
  CHECK(unit_of_heading("\xC3\x89"
                        "cart / \xC2\xB5m") == "um");
  CHECK(unit_of_heading("Fehler in mm") == "mm");
  CHECK(unit_of_heading("Abw. [in \xCE\xBCm]") == "um");
  CHECK(unit_of_heading("T Luft [\xC2\xB0"
                        "C]") == "degC");
  CHECK(unit_of_heading("ambient_C") == "degC");
  CHECK(unit_of_heading("Winkel (Grad)") == "deg");
  CHECK(unit_of_heading("Nick [arcsec]") == "arcsec");
  CHECK(unit_of_heading("Zeit [s]") == "s");
  CHECK(unit_of_heading("error_um_per_m") == "um/m");
  CHECK(unit_of_heading("slope_um_per_degC").empty());
  CHECK(unit_of_heading("Temp (C)") == "degC");
}

TEST_CASE("letters and words that mean something else are no units") {
  for (const char* heading : {"", "mm", "Lauf", "Error (F)", "Fehler (B)", "C", "err_min", "lead in", "Position [X]",
                              "run (2)", "deviation", "pos_x", "Soll"})
    CHECK_MESSAGE(unit_of_heading(heading).empty(), heading);
}
