// Every format of measurement files in the registry: its words, its sample, its fuzzer, and what it refuses.
#include "laser/import/registry.hpp"

#include <set>

#include <doctest/doctest.h>

#include "laser/import/import.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

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
    const auto imported = read_any(sample(std::string(format->sample)), along_x());
    REQUIRE_MESSAGE(imported, to_text(imported.error()));
    CHECK(imported->format == format);
    CHECK(imported->set.readings.size() + imported->environment.rows.size() > 0);
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
    const auto written = format->write(set, name);
    REQUIRE_MESSAGE(written, to_text(written.error()));
    const auto again = parse_any(*written, name, along_x());
    REQUIRE_MESSAGE(again, to_text(again.error()));
    CHECK(again->format == format);
    CHECK(again->set.readings.size() == set.readings.size());
  }
}

TEST_CASE("every file format has a fuzzer and seeds for it") {
  const auto list = read_file("tests/fuzz/CMakeLists.txt");
  REQUIRE(list);
  for (const FileFormat* format : file_formats()) {
    CAPTURE(format->id);
    const std::string id(format->id);
    const std::string seeds = "tests/fuzz/corpus/" + id;
    const bool listed = list->find(" " + id) != std::string::npos;
    CHECK_MESSAGE(listed, "add " << id << " to the readers in tests/fuzz/CMakeLists.txt");
    const bool seeded = std::filesystem::is_directory(seeds) && !std::filesystem::is_empty(seeds);
    CHECK_MESSAGE(seeded, "put a seed into " << seeds);
  }
}

}  // namespace
}  // namespace ecs::laser
