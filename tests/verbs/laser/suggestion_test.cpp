// Every file comes in with what the program itself suggests, or is refused with line, column and the way in.
#include <filesystem>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "app/cli/catalogue.hpp"
#include "laser/measurement_set.hpp"
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

/// Imports every file below the folders, and again with what a refusal suggests until it is read or nothing is
/// suggested.
Tried tried(const std::vector<std::filesystem::path>& roots) {
  Tried all;
  std::vector<std::filesystem::directory_entry> entries;
  for (const auto& root : roots)
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) entries.push_back(entry);
  for (const auto& entry : entries) {
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
    CHECK_MESSAGE((contains(ran_last.messages, "it seems to be") || contains(ran_last.messages, "expected") ||
                   contains(ran_last.messages, ", not a measurement: ecs ")),
                  ran_last.messages);
  }
  return all;
}

}  // namespace

TEST_CASE("every real and made-up file here comes in as suggested, or is refused with its place and the way in") {
  const Tried real = tried({"samples/real", "tests/data/real"});
  CHECK(real.read >= 8);
  CHECK(real.by_suggestion >= 2);
  CHECK(real.bad_cells == 0);
  const Tried made = tried({"tests/data/made_up"});
  CHECK(made.read >= 8);
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
  CHECK_FALSE(contains(errors + actual + coordinates, "docs/laser.md"));
}

TEST_CASE("so does every further real file") {
  const char* const root = std::getenv("ECS_REAL_DATA");
  SKIP_UNLESS(root != nullptr, kNoRealData);
  const Tried further = tried({root});
  CHECK(further.read + further.by_suggestion >= 35);
  CHECK(further.bad_cells == 0);
}

TEST_CASE("the unit of a heading is the unit of the suggestion, and what it reads is right when pasted") {
  struct Table {
    std::string text;
    std::string suggested;  ///< the rules
    double at_mm, error;    ///< of the second reading
  };
  const std::vector<Table> tables{
      {"Lauf;Position [mm];Abweichung [mm]\n1;0;0,01\n1;100;0,02495\n1;200;0,012\n2;200;0,025\n2;100;0,01\n2;0;0,02\n",
       "x_mm=2[mm],reading=3[mm],approach=motion,run=1", 100.0, 24.95},
      {"Target (m)\tError (\xC2\xB5m)\n0.0\t1.5\n0.1\t-0.5\n0.2\t3\n", "x_mm=1[m],reading=2[um],approach=motion", 100.0,
       -0.5},
      {"Nr;Position_in;Fehler Zoll\n1;0,0;0,0001\n2;10,0;0,0002\n3;20,0;-0,0001\n",
       "x_mm=2[in],reading=3[in],approach=motion", 254.0, 5.08},
      {"Date;Heure;Cible [mm];\xC3\x89"
       "cart [\xC2\xB5m];Temp. air [\xC2\xB0"
       "C]\n2026-03-12;09:00:10;0;1,5;20,1\n"
       "2026-03-12;09:01:10;100;2,5;20,2\n2026-03-12;09:02:10;200;3,5;20,3\n",
       "x_mm=3[mm],reading=4[um],date_time=1..2,t_air_degC=5[degC]", 100.0, 2.5},
      {"Y-Achse;Abw.\nmm;\xC2\xB5m\n0;1\n100;2\n200;3\n", "y_mm=1[mm],reading=2[um],approach=motion", 100.0, 2.0},
      {"pos;dev\n0;0,01\n100;0,02\n200;0,03\n", "x_mm=1[mm],reading=2[mm],approach=motion", 100.0, 20.0},
      {"Target mm|F1 (um)|B1 (um)\n0|1|4\n100|2|5\n200|3|6\n", "x_mm=1[mm],forward1=2[um],reverse1=3[um]", 0.0, 4.0},
      {"run,sample,spindle_C,disp_um\n1,0,20.1,1\n1,1,21.5,2\n2,0,20.2,1\n2,1,21.7,2\n",
       "reading=4[um],run=1,t_spindle_degC=3[degC]", 0.0, 2.0},
  };
  for (const Table& table : tables) {
    const Folder folder;
    const std::string file = folder.with("table.txt", table.text);
    const std::string message = ran({"laser", "import", file}).messages;
    CHECK_MESSAGE(contains(message, "--columns \"" + table.suggested + "\""), message);
    std::vector<std::string> words{"laser", "import", file, "-o", folder / "out.csv"};
    for (const std::string& word : suggested_options(message)) words.push_back(word);
    const Ran imported = ran(words);
    REQUIRE_MESSAGE(imported.code == 0, imported.messages);
    const auto set = laser::read_measurement_set(folder / "out.csv");
    REQUIRE(set.has_value());
    CHECK(laser::target_mm(set->readings[1]) == doctest::Approx(table.at_mm));
    CHECK(set->readings[1].error == doctest::Approx(table.error));
  }
}

TEST_CASE("an angle against a linear axis is suggested as one, a turned axis in degrees by its letter") {
  const Folder folder;
  const auto advice = [&](const std::string& text) {
    return ran({"laser", "import", folder.with("table.txt", text)}).messages;
  };
  CHECK(contains(advice("Position [mm];Nick [\xC2\xB5rad]\n0;1\n100;2\n200;4\n"),
                 "--columns \"x_mm=1[mm],EB=2[urad],approach=motion\""));
  CHECK(contains(advice("B-Achse [deg];Abweichung [arcsec]\n0;1\n90;2\n180;-1\n"),
                 "--columns \"b_deg=1[deg],reading=2[arcsec],approach=motion\""));
}
