// Every file of real machines comes in with what the program itself suggests, or is refused with line, column and the
// way in. Those that may be passed on: tests/transcripts/laser/real_files.case.
#include <filesystem>

#include "app/cli/catalogue.hpp"
#include "commissioning/measurements/files.hpp"
#include "laser/groups.hpp"
#include "tests/support/real_data.hpp"
#include "tests/support/verb_run.hpp"

using namespace ecs;
using namespace ecs::app;

namespace {

/// The options in a message, from --columns to what they read; empty: none are suggested.
std::vector<std::string> suggested_options(const std::string& message) {
  const std::size_t from = message.find("--columns \"");
  const std::size_t to = message.find(" reads column ", from);
  if (to == std::string::npos) return {};
  return split_words(message.substr(from, to - from));
}

/// What a refusal asks for: axis and sense, or which table it is.
std::vector<std::string> options_asked_for(const std::string& message) {
  if (contains(message, "--axis X --sense EX")) return {"--axis", "X"};
  if (contains(message, "give one of ")) {
    const std::size_t name = message.find("give one of ") + 12;
    return {"--axis", "X", "--channel", message.substr(name, message.find(' ', name) - name)};
  }
  return suggested_options(message);
}

struct Tried {
  int read = 0;
  int by_suggestion = 0;
  int bad_cells = 0;  ///< of them: refused although the options suggested were given
};

/// Imports every file below a folder, and again with what a refusal suggests until it is read or nothing is suggested.
Tried tried(const std::filesystem::path& root) {
  Tried all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_regular_file() || name == "SOURCE.md" || name == "README.md" || entry.path().extension() == ".toml")
      continue;
    const std::string file = entry.path().string();
    CAPTURE(file);
    std::vector<std::string> options;
    Ran ran_last = ran({"laser", "import", file});
    if (ran_last.code == 0) {
      ++all.read;
      continue;
    }
    bool asked = false;
    for (int round = 0; round < 3 && ran_last.code != 0; ++round) {
      const auto more = options_asked_for(ran_last.messages);
      if (more.empty()) break;
      asked = true;
      options.insert(options.end(), more.begin(), more.end());
      std::vector<std::string> words{"laser", "import", file};
      words.insert(words.end(), options.begin(), options.end());
      ran_last = ran(words);
    }
    if (asked && ran_last.code == 0) {
      ++all.by_suggestion;
      continue;
    }
    const std::string place = ran_last.messages.substr(ran_last.messages.find(file) + file.size(), 12);
    CHECK_MESSAGE((place.size() > 4 && place[0] == ':' && std::isdigit(place[1]) != 0), ran_last.messages);
    all.bad_cells += asked ? 1 : 0;
    CHECK_MESSAGE((contains(ran_last.messages, "it seems to be") || contains(ran_last.messages, "xpected") ||
                   contains(ran_last.messages, ", not a measurement: use ")),
                  ran_last.messages);
  }
  return all;
}

/// A log of a real sensor, which may not be passed on.
laser::MeasurementSet read_log(const std::filesystem::path& file, const std::string& channel = {}) {
  commissioning::ImportArguments arguments{.axis = "X", .channel = channel};
  return must(commissioning::read_measurements(file.string(), arguments)).set;
}

}  // namespace

TEST_CASE("every further real file comes in as suggested, or is refused with its place and the way in") {
  const char* const root = std::getenv("ECS_REAL_DATA");
  SKIP_UNLESS(root != nullptr, kNoRealData);
  const Tried further = tried(root);
  CHECK(further.read + further.by_suggestion >= 35);
  CHECK(further.bad_cells == 0);
}

TEST_CASE("a real sensor calibration: headings are the targets") {
  const auto folder = real_data("epics-pv-logs");
  SKIP_UNLESS(!folder.empty(), kNoRealData);
  const auto log = read_log(folder / "sensor1_calib.log");
  const auto groups = laser::groups_of(log);
  const auto targets = laser::targets_of(log, only(groups), 1e-3);
  REQUIRE(targets.size() == 5);
  CHECK(targets[4].position_mm == 15.0);
  CHECK(log.readings[0].error == Approx((2.97127 - 3.0) * 1000.0));
}

TEST_CASE("one channel of a real log by its name") {
  const auto folder = real_data("epics-pv-logs");
  SKIP_UNLESS(!folder.empty(), kNoRealData);
  const auto log = read_log(folder / "radial_x_minus_10kN.log", "IOC_TEST:m0s005-AI02");
  CHECK(log.readings[0].error == Approx(12632.5));
  CHECK(*log.readings[0].time_s == 0.0);
  const Ran none = ran({"laser", "import", folder / "radial_x_minus_10kN.log", "--axis", "X", "--channel", "AI09"});
  CHECK(contains(none.messages, "no channel \"AI09\""));
}
