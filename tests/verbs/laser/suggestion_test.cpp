// Every file comes in with what the program itself suggests, or is refused with line, column and the way in.
#include <filesystem>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "app/cli/catalogue.hpp"
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
  if (contains(message, "(--axis X, --sense EX)")) return {"--axis", "X"};
  if (contains(message, "give one of ")) {
    const std::size_t name = message.find("give one of ") + 12;
    return {"--axis", "X", "--channel", message.substr(name, message.find(' ', name) - name)};
  }
  return suggested_options(message);
}

struct Tried {
  int read = 0;
  int by_suggestion = 0;
  int refused = 0;
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
    ++all.refused;
    const std::string place = ran_last.messages.substr(ran_last.messages.find(file) + file.size(), 12);
    CHECK_MESSAGE((place.size() > 4 && place[0] == ':' && std::isdigit(place[1]) != 0), ran_last.messages);
    all.bad_cells += asked ? 1 : 0;
    CHECK_MESSAGE((contains(ran_last.messages, "it seems to be") || contains(ran_last.messages, "expected")),
                  ran_last.messages);
  }
  return all;
}

}  // namespace

TEST_CASE("every real and made-up file here comes in as suggested, or is refused with its place and the way in") {
  const Tried real = tried("samples/real");
  CHECK(real.read >= 8);
  CHECK(real.by_suggestion >= 2);
  CHECK(real.bad_cells == 0);
  const Tried made = tried("samples/made_up");
  CHECK(made.read == 6);
  CHECK(made.refused == 1);  // blank.csv, which has an empty cell in each column
  CHECK(made.bad_cells == 0);
}

TEST_CASE("columns are suggested where they look like targets and errors, and named where they do not") {
  const Folder folder;
  const auto advice = [&](const std::string& text) {
    const Ran refused = ran({"laser", "import", folder.with("table.txt", text)});
    CHECK(refused.code == 3);
    return refused.messages;
  };
  const std::string errors = advice("0;1.5\n100;-0.5\n200;3\n");
  CHECK(contains(
      errors,
      "--columns \"x_mm=1[mm],reading=2[um],approach=motion\" reads column 1 as targets and column 2 as errors"));
  const std::string actual = advice("n;pos;laser\n1;0;0.0001\n2;100;100.002\n3;200;199.999\n");
  CHECK(contains(actual,
                 "--columns \"x_mm=2[mm],reading=3[mm],approach=motion\" --values actual --skip 1 reads column 2"));
  const std::string coordinates = advice("0;500\n100;-500\n200;300\n");  // no error is as large as that
  CHECK(contains(coordinates,
                 "expected targets and errors beside them, found the columns 1 (0 to 200), 2 (-500 to 500)"));
  CHECK(contains(coordinates, "x_mm=N[mm],reading=M[um] with their numbers after --columns"));
  CHECK(contains(advice("5;1\n-3;2\n8;1\n-7;3\n2;0\n"), "expected targets and errors"));  // in no order
  const std::string turned =
      advice("angle_deg,direction,run,error_um_per_m\n0,1,1,5\n90,1,1,-40\n180,1,1,30\n90,-1,1,-38\n0,-1,1,6\n");
  CHECK(contains(turned, "--columns \"c_deg=1[deg],reading=4[um/m],approach=2,run=3\" --skip 1 reads column 1 as"));
  CHECK_FALSE(contains(errors + actual + coordinates, "docs/formats.md"));
}

TEST_CASE("so does every further real file") {
  const char* const root = std::getenv("ECS_REAL_DATA");
  SKIP_UNLESS(root != nullptr, kNoRealData);
  const Tried further = tried(root);
  CHECK(further.read + further.by_suggestion >= 35);
  CHECK(further.bad_cells == 0);
}
