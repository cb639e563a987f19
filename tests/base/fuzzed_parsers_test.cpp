// Every parser of a text (parse_x(std::string_view …) in a header) is fuzzed, and has seeds.
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>

#include <doctest/doctest.h>

#include "base/file.hpp"

namespace ecs {
namespace {

namespace fs = std::filesystem;

/// Those that a fuzzer reaches through another name.
const std::map<std::string, std::string> kReachedThrough{{"csv_table", "measurement_csv"},
                                                         {"measurement_set", "measurement_csv"},
                                                         {"plate_readings", "plate"},
                                                         {"header", "map"},
                                                         {"toml", "machine"}};

std::set<std::string> found_in(const std::string& text, const char* expression) {
  std::set<std::string> found;
  const std::regex wanted(expression);
  for (std::sregex_iterator at(text.begin(), text.end(), wanted), end; at != end; ++at) found.insert((*at)[1]);
  return found;
}

/// The names, without parse_, in the headers of every folder that is a library.
std::set<std::string> parsers() {
  std::set<std::string> names;
  for (const auto& folder : fs::directory_iterator(".")) {
    const std::string name = folder.path().filename().string();
    if (!folder.is_directory() || name.starts_with('.') || name == "tests" || name == "bench" || name == "build")
      continue;
    for (const auto& file : fs::recursive_directory_iterator(folder.path()))
      if (file.path().extension() == ".hpp")
        names.merge(found_in(read_file(file.path()).value(), R"(\bparse_([a-z_0-9]+)\(std::string_view)"));
  }
  return names;
}

/// The sources of all fuzzers, those of modules with them.
std::string all_fuzzers() {
  std::string text;
  for (const char* const folder : {"tests/fuzz", "modules"})
    for (const auto& file : fs::recursive_directory_iterator(folder))
      if (file.path().string().ends_with("_fuzz.cpp")) text += read_file(file.path()).value();
  return text;
}

/// What is fuzzed, of modules too: of controls whichever have a source (modules/controllers/registry.cmake).
std::string all_lists() {
  std::string text = read_file("tests/fuzz/CMakeLists.txt").value();
  constexpr std::string_view kControl = "_format.cpp";
  for (const auto& module : fs::directory_iterator("modules")) {
    text += read_file(module.path() / "CMakeLists.txt").value();
    for (const auto& file : fs::directory_iterator(module))
      if (const std::string name = file.path().filename().string(); name.ends_with(kControl))
        text += " " + name.substr(0, name.size() - kControl.size());
  }
  return text;
}

TEST_CASE("every parser of a text has a fuzzer") {
  const std::string fuzzers = all_fuzzers();
  const std::string list = all_lists();
  const std::set<std::string> names = parsers();
  CHECK(names.size() > 20);
  for (const std::string& name : names) {
    CAPTURE(name);
    const auto through = kReachedThrough.find(name);
    const std::string reader = through == kReachedThrough.end() ? name : through->second;
    const bool called = contains(fuzzers, "::parse_" + name + "(") || contains(fuzzers, " parse_" + name + "(") ||
                        contains(list, " " + reader);
    CHECK_MESSAGE(called, "add parse_" << name << " to the parsers in tests/fuzz/text_fuzz.cpp");
  }
  for (const auto& [name, through] : kReachedThrough) CHECK_MESSAGE(names.contains(name), name << " is no parser now");
}

TEST_CASE("every fuzzer of texts is run by ctest and has seeds that it reads whole") {
  const std::string list = all_lists();
  constexpr std::uintmax_t kMostBytes = 4096;  // tests/fuzz/fuzz: -max_len
  const auto ids = found_in(all_fuzzers(), R"rx(\{"([a-z_]+)", [a-z_]+\})rx");
  CHECK(ids.size() > 15);
  for (const std::string& id : ids) {
    CAPTURE(id);
    CHECK_MESSAGE(std::regex_search(list, std::regex("\\s" + id + "\\b")),
                  "add " << id << " to texts in tests/fuzz/CMakeLists.txt, or of its module");
    const fs::path seeds = "tests/fuzz/corpus/" + id;
    const bool seeded = fs::is_directory(seeds) && !fs::is_empty(seeds);
    CHECK_MESSAGE(seeded, "put a seed into " << seeds.string());
    if (!seeded) continue;
    for (const auto& seed : fs::directory_iterator(seeds)) CHECK(seed.file_size() <= kMostBytes);
  }
}

}  // namespace
}  // namespace ecs
