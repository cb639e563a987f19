// Instruments' files as users have them: other encodings, decimal commas, key case, units, sensors that were not there.
#include <rapidcheck.h>

#include "base/text.hpp"
#include "laser/import/format.hpp"
#include "laser/import/import.hpp"
#include "laser/writers/writers.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

MeasurementSet read(const std::string& text, const std::string& name, const ImportOptions& options = along_x()) {
  return must(parse_any(text, name, options)).set;
}

/// The readings alone: lines differ between line ends.
std::vector<Reading> plain(MeasurementSet set) {
  for (Reading& reading : set.readings) reading.line = 0;
  return set.readings;
}

}  // namespace

TEST_CASE("a run file is the same in every encoding, with every line end and decimal sign, in any case of its keys") {
  const std::string good = sample_text("vmc_x.rtl");
  const auto wanted = plain(read(good, "a.rtl"));
  std::string unix_ends;
  for (const char c : good)
    if (c != '\r') unix_ends += c;
  CHECK(plain(read(unix_ends, "a.rtl")) == wanted);
  CHECK(plain(read("\xEF\xBB\xBF" + good, "a.rtl")) == wanted);
  std::string wide = "\xFF\xFE";
  for (const char c : good) wide += std::string{c, '\0'};
  CHECK(plain(read(wide, "a.rtl")) == wanted);
  CHECK(plain(read(replaced(good, ".", ","), "a.rtl")) == wanted);
  CHECK(plain(read(lower(good), "a.rtl")) == wanted);
}

TEST_CASE("keys are kept in their usual spelling, equipment too") {
  std::string text = lower(sample_text("vmc_x.rtl"));
  text = replaced(text, "environment::", "equipment::\nlaser : ML10 serial 77\noptics: linear\n\nenvironment::");
  const auto set = read(text, "a.rtl");
  CHECK(metadata_value(set, "Machine") == "vmc 7");
  CHECK(metadata_value(set, "Serial No").has_value());
  CHECK(metadata_value(set, "Exp coeff").has_value());
  CHECK(metadata_value(set, "laser") == "ML10 serial 77");
  CHECK(metadata_value(set, "optics") == "linear");
}

TEST_CASE("a material sensor that was pulled off during the test keeps the value it had") {
  const auto set = read(replaced(sample_text("vmc_x.rtl"), "20.200000 20.400000", "20.200000 -10.000000"), "a.rtl");
  CHECK(set.readings.back().sensors_degC.at("t_material_degC") == Approx(20.2));
}

TEST_CASE("inch files by the option, and by the unit that assignments name") {
  ImportOptions inch = along_x();
  inch.target_unit = unit_named("in");
  inch.reading_unit = unit_named("mil");
  const auto table = read(sample_text("table.REN"), "t.ren", inch);
  CHECK(target_mm(table.readings[2]) == Approx(200.0 * 25.4));
  CHECK(table.readings[2].error == Approx(3.6 * 0.0254));
  CHECK(says(table.notes, "targets read as in"));
  const auto metric = read(sample_text("axis.dat"), "a.dat");
  const auto imperial = read(replaced(sample_text("axis.dat"), "UNIT=mm", "UNIT=in"), "a.dat");
  CHECK(target_mm(imperial.readings[0]) == Approx(target_mm(metric.readings[0]) * 25.4));
  CHECK(imperial.readings[0].error == Approx(metric.readings[0].error * 25.4));
  ImportOptions wrong = along_x();
  wrong.reading_unit = unit_named("arcsec");
  CHECK(contains(to_text(parse_any(sample_text("table.REN"), "t.ren", wrong).error()), "arcsec is not a unit of EX"));
  CHECK_FALSE(parse_any(sample_text("x_axis.csv"), "x.csv", inch).has_value());
}

TEST_CASE("angles in arc seconds by the option") {
  ImportOptions options;
  options.sense = Sense::EC;
  const auto mrad = read(sample_text("pitch.rta"), "p.rta", options);
  options.reading_unit = unit_named("arcsec");
  const auto arcsec = read(sample_text("pitch.rta"), "p.rta", options);
  CHECK(mrad.readings[1].error / arcsec.readings[1].error == Approx(206.265).epsilon(1e-5));
}

TEST_CASE("a compensation table whose rows end before its head says so is cut short") {
  std::string text = sample_text("table.REN");
  text.resize(text.rfind("3  "));
  CHECK(contains(to_text(parse_any(text, "t.ren", along_x()).error()), "expected the last position at 200"));
  ImportOptions accept = along_x();
  accept.accept_truncated = true;
  CHECK(read(text, "t.ren", accept).readings.size() == 2);
  CHECK(read(replaced(sample_text("table.REN"), " : ", "   "), "t.ren").readings.size() == 3);
}

TEST_CASE("Shift-JIS and Latin-1 if asked for") {
  const std::string text = replaced(sample_text("vmc_x.rtl"), "VMC 7", "\x8B\x40\x8A\x42 \xB5");
  ImportOptions options = along_x();
  options.encoding = Encoding::shift_jis;
  CHECK(metadata_value(read(text, "a.rtl", options), "Machine") == "\xE6\xA9\x9F\xE6\xA2\xB0 \xEF\xBD\xB5");
  options.encoding = Encoding::latin1;
  CHECK(contains(
      *metadata_value(read(replaced(sample_text("vmc_x.rtl"), "VMC 7", "Fr\xE4se"), "a.rtl", options), "Machine"),
      "Fr\xC3\xA4se"));
}

TEST_CASE("nine numbers are an environment log only with a pressure among them") {
  CHECK(recognised_format("-50 -50 -0.03 0 0 0 0 0 0\n", "p.txt") == nullptr);
  CHECK(recognised_format("1E-2 1E-2 1E-3 21 21 21 97635 42 23\n", "p.txt")->id == "sios_environment");
  CHECK(recognised_format("1 2 3 4 5 6 7 8 9\n", "p.txt") == nullptr);
}

TEST_CASE("what a table writer writes, the reader reads back") {
  const bool same = rc::check("compensation table, report and assignments", [](const std::vector<short>& values) {
    RC_PRE(values.size() >= 2);
    MeasurementSet set;
    for (std::size_t i = 0; i < values.size(); ++i)
      for (const Approach approach : {Approach::forward, Approach::reverse})
        set.readings.push_back(reading(Axis::X, Sense::EX, 12.5 * static_cast<double>(i) - 40.0,
                                       values[i] / 100.0 + (approach == Approach::reverse ? 0.5 : 0.0), approach));
    const auto near = [](double a, double b) { return std::abs(a - b) < 1e-4; };
    const auto table = parse_any(*to_renishaw_table(set), "t.ren", along_x());
    RC_ASSERT(table.has_value());
    RC_ASSERT(table->set.readings.size() == values.size());
    const auto report = parse_any(*to_api_pos(set), "t.pos", along_x());
    RC_ASSERT(report.has_value());
    RC_ASSERT(report->set.readings.size() == set.readings.size());
    const auto runs = parse_any(*to_iso230_assignments(set), "t.dat", along_x());
    RC_ASSERT(runs.has_value());
    RC_ASSERT(runs->set.readings.size() == set.readings.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      RC_ASSERT(near(table->set.readings[i].error, values[i] / 100.0 + 0.25));
      RC_ASSERT(near(report->set.readings[i].error, values[i] / 100.0));
      RC_ASSERT(near(report->set.readings[values.size() + i].error, values[i] / 100.0 + 0.5));
      RC_ASSERT(near(runs->set.readings[i].error, values[i] / 100.0));
      RC_ASSERT(near(target_mm(runs->set.readings[i]), 12.5 * static_cast<double>(i) - 40.0));
    }
  });
  CHECK(same);
}

TEST_CASE("a plate gives two readings for each hole, at its nominal place") {
  const auto set = read(sample_text("plate.txt"), "plate.txt");
  REQUIRE(set.readings.size() == 4);
  CHECK(set.readings[0].position_mm == Vector3{-10.72, -11.577, 0.0});
  CHECK(set.readings[0].error == Approx(39.0));
  CHECK(set.readings[1].axis == Axis::Y);
  CHECK(set.readings[1].sense == Sense::EY);
  CHECK(set.readings[1].error == Approx(21.0));
  CHECK(metadata_value(set, "Plug Plate") == "1413");
}
