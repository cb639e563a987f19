// Instruments' own files as measurement sets. Every format of measurement files in the registry: its words, its sample,
// its fuzzer, and what it refuses.
#include "laser/import/import.hpp"

#include <set>

#include "base/text.hpp"
#include "laser/import/format.hpp"
#include "laser/writers/writers.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

ImportOptions options_with(std::optional<Axis> axis, std::optional<Sense> sense = std::nullopt) {
  return {.axis = axis, .sense = sense};
}

Imported imported(const std::string& name, const ImportOptions& options = {}) {
  return must(read_any(sample(name), options));
}

std::string refusal(const std::string& name, const ImportOptions& options = {}) {
  return to_text(must_fail(read_any(sample(name), options)));
}

}  // namespace

TEST_CASE("a linear run uses the target number, not the order of lines") {
  const Imported file = imported("vmc_x.rtl");
  CHECK(file.format->id == "renishaw_run");
  REQUIRE(file.set.readings.size() == 6);
  const Reading& fourth = file.set.readings[3];
  CHECK(fourth.axis == Axis::X);
  CHECK(fourth.sense == Sense::EX);
  CHECK(target_mm(fourth) == 200.0);
  CHECK(fourth.error == 3.1);
  CHECK(fourth.approach == Approach::reverse);
  CHECK(fourth.run == 1);
  CHECK(target_mm(file.set.readings[5]) == 0.0);
  CHECK(metadata_value(file.set, "Date") == "2024-05-06 09:10:11");
}

TEST_CASE("the environment goes from start to end over the readings, pressure in hPa, missing sensors left out") {
  const Imported file = imported("vmc_x.rtl");
  const Reading& first = file.set.readings.front();
  const Reading& last = file.set.readings.back();
  CHECK(first.sensors_degC.at("t_air_degC") == Approx(20.1));
  CHECK(last.sensors_degC.at("t_air_degC") == Approx(20.3));
  CHECK(file.set.readings[1].sensors_degC.at("t_material_degC") == Approx(20.24));
  CHECK(*first.pressure_hPa == Approx(991.0));
  CHECK(*last.humidity_pct == Approx(45.2));
  CHECK_FALSE(first.sensors_degC.contains("t_material2_degC"));
  ImportOptions ends_only;
  ends_only.spread_environment = false;
  const Imported ends = imported("vmc_x.rtl", ends_only);
  CHECK_FALSE(ends.set.readings[2].pressure_hPa.has_value());
  CHECK(*ends.set.readings.back().pressure_hPa == Approx(991.1));
}

TEST_CASE("code pages of Western and Chinese PCs become UTF-8") {
  CHECK(metadata_value(imported("windows1252.rtl").set, "Machine") == "Fr\xC3\xA4smaschine");
  const Imported chinese = imported("chinese.rtl");
  CHECK(metadata_value(chinese.set, "Machine") ==
        "\xE7\xAB\x8B\xE5\xBC\x8F\xE5\x8A\xA0\xE5\xB7\xA5\xE4\xB8\xAD\xE5\xBF\x83");
  CHECK(says(chinese.set.notes, "GBK"));
}

TEST_CASE("descending targets start in reverse, and zero-filled passes of a one-way file are left out") {
  const Imported file = imported("one_way.rtl");
  REQUIRE(file.set.readings.size() == 6);
  CHECK(file.set.readings[0].axis == Axis::Z);
  CHECK(target_mm(file.set.readings[0]) == 200.0);
  CHECK(file.set.readings[0].approach == Approach::reverse);
  CHECK(file.set.readings[3].run == 2);
  CHECK(file.set.readings[5].error == 3.5);
}

TEST_CASE("angular runs are mrad in the file and um/m here, and need their sense") {
  CHECK(contains(refusal("pitch.rta"), "give EA, EB or EC"));
  CHECK(contains(refusal("pitch.rta", options_with({}, Sense::EX)), "the file needs the sense EA, EB or EC"));
  const Imported file = imported("pitch.rta", options_with({}, Sense::EC));
  CHECK(file.set.readings[1].sense == Sense::EC);
  CHECK(file.set.readings[1].error == Approx(50.0));
}

TEST_CASE("straightness runs need a sense across the axis") {
  CHECK(read_any(sample("straight.rts"), {}).error().kind == ProblemKind::usage);
  CHECK(contains(refusal("straight.rts", options_with({}, Sense::EX)),
                 "EX was given, but the file needs the sense EY or EZ across the axis X"));
  CHECK(imported("straight.rts", options_with({}, Sense::EZ)).set.readings[1].error == Approx(5.0));
}

TEST_CASE("a run file cut short is refused unless asked for") {
  CHECK(contains(refusal("broken_cut.rtl"), "truncated"));
  ImportOptions accept;
  accept.accept_truncated = true;
  CHECK(imported("broken_cut.rtl", accept).set.readings.size() == 4);
  const std::string whole = sample_text("broken_cut.rtl");
  const std::string cut = whole.substr(0, whole.find_last_not_of("\r\n") - 2);  // digits of the last point are missing
  CHECK(contains(to_text(parse_any(cut, "cut.rtl", {}).error()), "--accept-truncated"));
  CHECK(parse_any(cut, "cut.rtl", accept)->set.readings.size() == 3);
}

TEST_CASE("every bad point of a run file is reported with its line") {
  const auto result = must_fail(read_any(sample("broken_points.rtl"), {}));
  CHECK(result.line == 28);
  CHECK(only(result.also).line == 31);
}

TEST_CASE("a dynamic capture gives displacements over time") {
  const Imported file = imported("capture.rtx");
  CHECK(file.format->id == "renishaw_dynamic");
  REQUIRE(file.set.readings.size() == 4);
  CHECK(file.set.readings[2].error == Approx(-2.0));
  CHECK(*file.set.readings[2].time_s == Approx(2.0 / 500.0));
  CHECK(file.set.readings[2].axis == Axis::X);
  ImportOptions thin;
  thin.most_samples = 2;
  const Imported thinned = imported("capture.rtx", thin);
  REQUIRE(thinned.set.readings.size() == 2);
  CHECK(*thinned.set.readings[1].time_s == Approx(2.0 / 500.0));
  CHECK(says(thinned.set.notes, "every 2. of 4"));
}

TEST_CASE("a dynamic capture with fewer samples than announced is refused unless asked for") {
  std::string bytes = sample_text("capture.rtx");
  bytes.resize(bytes.size() - 20);
  CHECK(contains(to_text(parse_any(bytes, "c.rtx", {}).error()), "expected 4 samples (Sample no), found 2"));
  ImportOptions accept;
  accept.accept_truncated = true;
  CHECK(parse_any(bytes, "c.rtx", accept)->set.readings.size() == 2);
}

TEST_CASE("a compensation table becomes errors of the opposite sign, in um") {
  CHECK(contains(refusal("table.REN"), "Give the axis"));
  const Imported file = imported("table.REN", options_with(Axis::Y));
  CHECK(file.format->id == "renishaw_table");
  REQUIRE(file.set.readings.size() == 3);
  CHECK(file.set.readings[2].error == Approx(3.6));
  CHECK(file.set.readings[2].position_mm == Vector3{0.0, 200.0, 0.0});
  ImportOptions errors = options_with(Axis::Y);
  errors.table_holds_errors = true;
  CHECK(imported("table.REN", errors).set.readings[2].error == Approx(-3.6));
}

TEST_CASE("an API report gives the two directions rather than their mean") {
  const Imported file = imported("report.pos", options_with(Axis::X));
  CHECK(file.format->id == "api_pos");
  REQUIRE(file.set.readings.size() == 4);
  CHECK(file.set.readings[1].approach == Approach::forward);
  CHECK(file.set.readings[1].error == Approx(1.9));
  CHECK(file.set.readings[3].error == Approx(0.9));
  const std::string text = sample_text("report.pos");
  const auto mean_only =
      must(parse_any(text.substr(0, text.find("Position   \tForward")), "r.pos", options_with(Axis::X)));
  REQUIRE(mean_only.set.readings.size() == 2);
  CHECK(mean_only.set.readings[1].approach == Approach::unknown);
}

TEST_CASE("an environment log gives records and no readings") {
  const Imported file = imported("environment.pos");
  CHECK(file.format->id == "sios_environment");
  REQUIRE(file.environment.rows.size() == 2);
  CHECK(file.environment.value(0, "x_mm").value() == Approx(12.8479997342998));
  CHECK(file.environment.value(0, "t_air_y_degC").value() == Approx(21.56));
  CHECK(file.environment.value(1, "pressure_hPa").value() == Approx(992.3));
  CHECK(file.environment.value(1, "t_material_degC").value() == Approx(23.1));
  CHECK(file.set.readings.empty());
}

TEST_CASE("assignments of absolute positions become errors in um") {
  const Imported file = imported("axis.dat", options_with(Axis::Z));
  REQUIRE(file.set.readings.size() == 8);
  CHECK(file.set.readings[0].error == Approx(1.0));
  CHECK(file.set.readings[0].approach == Approach::forward);
  CHECK(target_mm(file.set.readings[0]) == -10.0);
  CHECK(file.set.readings[7].error == Approx(-4.0));
  CHECK(file.set.readings[7].approach == Approach::reverse);
  CHECK(file.set.readings[7].run == 2);
}

TEST_CASE("assignments that contradict themselves are refused") {
  const std::string good = sample_text("axis.dat");
  const auto refused = [&](const std::string& text, const std::string& words) {
    const auto result = must_fail(parse_any(text, "a.dat", options_with(Axis::Z)));
    CHECK_MESSAGE(contains(to_text(result), words), to_text(result));
  };
  refused(good + "TGT_DATA[1]=-10\n", "each index once");
  refused(good + "REF_DATA_FWD[1]=2\n", "target and cycle index");
  refused(good + "REF_DATA_FWD[9,1]=2\n", "an index with a target");
  refused(good.substr(0, good.rfind("REF_DATA")), "truncated");
  std::string furlongs = good;
  furlongs.replace(furlongs.find("UNIT=mm"), 7, "UNIT=fur");
  refused(furlongs, "UNIT: expected a unit of length");
}

TEST_CASE("our own CSV is imported like any other format") {
  CHECK(imported("x_axis.csv").format->id == "measurement_csv");
  CHECK(imported("semicolon.csv").set.readings[0].error == 1.5);
}

TEST_CASE("a file of no known format is refused with what was looked for") {
  const auto result = must_fail(parse_any("Dear all,\nno readings today.\n", "letter.txt", {}));
  check_holds(result.message, {"Renishaw run file", "measurement CSV"});
}

TEST_CASE("a written run file is read back: both ways, one way, and angles") {
  for (const Sense sense : {Sense::EX, Sense::EY, Sense::EB}) {
    for (const bool one_way : {false, true}) {
      MeasurementSet set = one_way ? set_of({{-200.0, {}, {1.25, 2.5}}, {-100.0, {}, {3.0, -4.125}}})
                                   : set_of({{-200.0, {1.25, 2.5}, {0.5, 0.25}}, {-100.0, {3.0, -4.125}, {7.0, 8.0}}});
      for (Reading& r : set.readings) r.sense = sense;
      set.readings.front().sensors_degC["t_air_degC"] = 20.5;
      set.readings.back().sensors_degC["t_air_degC"] = 21.5;
      const auto text = must(to_renishaw_run(set));
      const auto back = must(parse_any(text, "x" + renishaw_extension(set), options_with({}, sense)));
      REQUIRE(back.set.readings.size() == set.readings.size());
      for (const Reading& wanted : set.readings) {
        int found = 0;
        for (const Reading& r : back.set.readings)
          if (r.run == wanted.run && r.approach == wanted.approach && target_mm(r) == target_mm(wanted)) {
            ++found;
            CHECK(r.error == Approx(wanted.error));
            CHECK(r.sense == sense);
          }
        CHECK(found == 1);
      }
      CHECK(back.set.readings.back().sensors_degC.at("t_air_degC") == Approx(21.5));
    }
  }
}

TEST_CASE("incomplete or mixed sets are not written as run files") {
  MeasurementSet set = set_of({{0.0, {1.0, 2.0}, {1.0, 2.0}}, {10.0, {1.0}, {1.0, 2.0}}});
  CHECK(contains(to_renishaw_run(set).error().message, "complete runs (8 readings), found 7"));
  set.readings.back().axis = Axis::Y;
  CHECK(contains(to_renishaw_run(set).error().message, "one axis"));
  CHECK(to_renishaw_run(MeasurementSet{}).error().kind == ProblemKind::refused);
}

TEST_CASE("real environment logs are read completely") {
  const auto log = must(read_any("tests/data/real/nmm-environment/T22-0263_L2_16_1.pos", {}));
  CHECK(log.environment.rows.size() == 251);
  CHECK(log.environment.value(0, "pressure_hPa").value() == Approx(976.35));
}

namespace ecs::laser {
namespace {

TEST_CASE("every file format has words, a way to read, and an id of its own") {
  std::set<std::string_view> ids;
  for (const FileFormat* format : file_formats()) {
    CAPTURE(format->id);
    CHECK(ids.insert(format->id).second);
    CHECK_FALSE(format->title.empty());
    CHECK((format->read != nullptr) != (format->read_environment != nullptr));
    CHECK((format->write != nullptr) == !format->written_extensions.empty());
    CHECK(file_format(format->id) == format);
    for (const std::string_view extension : format->written_extensions) CHECK(&format_written_as(extension) == format);
  }
  CHECK(file_format("none") == nullptr);
  CHECK(format_written_as(".unknown").id == "measurement_csv");
}

TEST_CASE("every file format that is found by content recognises and reads its sample") {
  for (const FileFormat* format : file_formats()) {
    if (!format->recognises) continue;
    CAPTURE(format->id);
    ImportOptions options = along_x();
    if (format->id == "guide_log") options = {.takes_rotary = true};
    const auto imported = must(read_any(sample(std::string(format->sample)), options));
    CHECK(imported.format == format);
    CHECK(imported.set.readings.size() + imported.environment.rows.size() > 0);
  }
}

TEST_CASE("every file format refuses another content, with the file named") {
  ImportOptions options = along_x();
  options.mapping = column_mapping("x_mm=1,reading=2").value();
  options.matrix = MatrixLayout{matrix_axes("x=0..1,y=0..1").value(), "", "", "", ','};
  for (const FileFormat* format : file_formats()) {
    CAPTURE(format->id);
    const std::string text = "nothing of the kind\nnor here\n";
    const auto problem = format->read_environment ? format->read_environment(text, "garbage.txt").error()
                                                  : format->read(text, "garbage.txt", options).error();
    CHECK(problem.file == "garbage.txt");
    CHECK_FALSE(problem.message.empty());
  }
}

TEST_CASE("what a file format writes it recognises and reads again") {
  MeasurementSet set;
  for (int i = 0; i < 5; ++i) {
    set.readings.push_back(reading(Axis::X, Sense::EX, 100.0 * i, 0.5 * i, Approach::forward));
    set.readings.back().time_s = i;
  }
  for (const FileFormat* format : file_formats()) {
    if (!format->write) continue;
    CAPTURE(format->id);
    const std::string name = "out" + std::string(format->written_extensions.front());
    const auto written = must(format->write(set, name));
    const auto again = must(parse_any(written, name, along_x()));
    CHECK(again.format == format);
    CHECK(again.set.readings.size() == set.readings.size());
  }
}

TEST_CASE("every file format has a fuzzer and seeds for it") {
  const auto list = must(read_file("tests/fuzz/CMakeLists.txt"));
  for (const FileFormat* format : file_formats()) {
    CAPTURE(format->id);
    const std::string id(format->id);
    const std::string seeds = "tests/fuzz/corpus/" + id;
    const bool listed = contains(list, " " + id);
    CHECK_MESSAGE(listed, "add " << id << " to the readers in tests/fuzz/CMakeLists.txt");
    const bool seeded = std::filesystem::is_directory(seeds) && !std::filesystem::is_empty(seeds);
    CHECK_MESSAGE(seeded, "put a seed into " << seeds);
  }
}

}  // namespace
}  // namespace ecs::laser
