// Every controller format of the registry: its words, its row in the documentation, and that reading gives back what
// writing was given.
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "base/file.hpp"
#include "modules/controllers/curve.hpp"
#include "modules/controllers/format.hpp"
#include "modules/controllers/tests/support/small_machine_map.hpp"

namespace ecs::controllers {
namespace {

/// The defaults of all options, and the one that a table in counts needs.
OptionValues usual(const std::vector<FormatOption>& options) {
  OptionValues values(options);
  values.set("counts-per-mm", "1000");
  return values;
}

/// The files of an export read back into a map, with the usual options.
laser::ErrorMap read_back(const ControllerFormat& format, const ControllerExport& made, const ExportSource& source) {
  ControllerTables all;
  for (const ExportFile& file : made.files) {
    const bool only_file = made.files.size() == 1;
    auto tables = format.read({file.name, file.content, file.content, only_file, usual(format.read_options)});
    REQUIRE_MESSAGE(tables, file.name);
    REQUIRE(append(all, std::move(*tables), !format.tables_add_up));
  }
  laser::ErrorMap map = map_of(all).map;
  return format.at_measurement_lines ? format.at_measurement_lines(map, source.parameters, false) : map;
}

TEST_CASE("every controller format has words, options with help, and an id of its own") {
  std::set<std::string_view> ids;
  for (const ControllerFormat* format : controller_formats()) {
    CAPTURE(format->id);
    CHECK(ids.insert(format->id).second);
    for (const std::string_view words : {format->title, format->name, format->marks}) CHECK_FALSE(words.empty());
    for (const std::string_view words : {format->summary, format->example, format->output_help})
      CHECK(words.empty() == (format->write == nullptr));
    if (format->write) CHECK(format->example.find(fmt::format("ecs export {} ", format->id)) == 0);
    CHECK((format->resolution_um > 0.0) == (format->write != nullptr));
    for (const auto* options : {&format->write_options, &format->read_options})
      for (const FormatOption& option : *options) CHECK_MESSAGE(!option.help.empty(), option.name);
    CHECK(controller_format(format->id) == format);
  }
  CHECK(controller_format("none") == nullptr);
}

TEST_CASE("the documentation has the row of every controller format") {
  const auto text = must(read_file("modules/controllers/README.md"));
  for (const ControllerFormat* format : controller_formats())
    CHECK_MESSAGE(contains(text, holds_row(*format)), holds_row(*format));
}

TEST_CASE("what a controller format writes is recognised as that format, by name and content") {
  const ExportSource source = whole_machine();
  for (const ControllerFormat* format : controller_formats()) {
    if (!format->write) continue;
    CAPTURE(format->id);
    const auto made = must(format->write(source, usual(format->write_options)));
    CHECK_FALSE(made.files.empty());
    for (const ExportFile& file : made.files) {
      CHECK(recognised_format(file.content) == format);
      if (format->is_file) CHECK(format->is_file(file.name));
    }
  }
  CHECK(recognised_format("nothing of the kind") == nullptr);
}

TEST_CASE("reading gives back what a controller format was given, within its resolution") {
  const ExportSource source = whole_machine();
  for (const ControllerFormat* format : controller_formats()) {
    if (!format->write) continue;
    const auto made = must(format->write(source, usual(format->write_options)));
    const laser::ErrorMap again = read_back(*format, made, source);
    for (const Component component : {Component::EXX, Component::EYY, Component::EZZ}) {
      CAPTURE(format->id);
      CAPTURE(name_of(component));
      const auto given = must(curve_of(source.map, component));
      const auto read = must(curve_of(again, component));
      for (const double p : given.position_mm) {  // counted from the reference position, as tables of some formats are
        const double expected = mean_at(given, p) - mean_at(given, 0.0);
        CHECK(std::abs(mean_at(read, p) - mean_at(read, 0.0) - expected) <= format->resolution_um * 1.001);
        if (!format->holds.reversal.starts_with("yes")) continue;
        const auto reversal = [&](const ControlCurve& curve) {
          return value_at(curve, Approach::forward, p) - value_at(curve, Approach::reverse, p);
        };
        CHECK(std::abs(reversal(read) - reversal(given)) <= format->resolution_um * 2.001);
      }
    }
  }
}

TEST_CASE("every controller format lists the errors of rotary axes that it does not export") {
  ExportSource source = whole_machine();
  laser::MapRotaryAxis axis;
  axis.axis.letter = 'C';
  axis.axis.location[3] = -12.0;
  for (auto& side : axis.compensation) side.fill({0.0, 0.0});
  axis.compensation[0][5] = {0.0, 7.5};
  source.map.header.rotary = {axis};
  source.map.header.bending.of_tool[4] = -30.0;
  for (const ControllerFormat* format : controller_formats()) {
    if (!format->write) continue;
    CAPTURE(format->id);
    const auto left = must(format->write(source, usual(format->write_options))).not_carried;
    REQUIRE(left.size() >= 3);
    const LeftBehind &location = left[left.size() - 3], &curve = left[left.size() - 2], &bending = left.back();
    CHECK(location.what == "AOC");
    CHECK(location.largest == 12.0);
    CHECK(location.unit == "um/m");
    CHECK(curve.what == "ECC");
    CHECK(curve.largest == 7.5);
    CHECK(contains(curve.why, "not the angle of a rotary axis"));
    CHECK(bending.what == "tool_bending y_cos");
    CHECK(bending.largest == 30.0);
    CHECK(contains(bending.why, "not the tilt of a head"));
  }
}

TEST_CASE("a controller format refuses a file of another kind, with the file named") {
  const std::string text = "axis,sense,reading\nX,EX,1\n";
  for (const ControllerFormat* format : controller_formats()) {
    CAPTURE(format->id);
    const auto read = must_fail(format->read({"x.csv", text, text, true, usual(format->read_options)}));
    CHECK(read.file == "x.csv");
    CHECK_FALSE(read.message.empty());
  }
}

TEST_CASE(
    "every controller format is the one of its source, from which its fuzzer gets its name, and has seeds for it") {
  for (const ControllerFormat* format : controller_formats()) {
    CAPTURE(format->id);
    CHECK(std::filesystem::exists(fmt::format("modules/controllers/{}_format.cpp", format->id)));
    CHECK(std::filesystem::is_directory(fmt::format("tests/fuzz/corpus/{}", format->id)));
  }
}

TEST_CASE("--axis is refused where several files are read") {
  for (const ControllerFormat* format : controller_formats()) {
    OptionValues options(format->read_options);
    options.set("axis", "X");
    const ReadRequest several{"file.comp", "0 0 0\n", "0 0 0\n", false, options};
    CHECK(axis_option(several).error().kind == ProblemKind::usage);
  }
}

}  // namespace
}  // namespace ecs::controllers
