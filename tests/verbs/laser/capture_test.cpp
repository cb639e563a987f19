// `ecs laser capture` without devices: typed values, files of readings, interruption and resumption.
#include <deque>

#include <doctest/doctest.h>

#include "app/cli/console.hpp"
#include "commissioning/measurements/capture_source.hpp"
#include "laser/measurement_set.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

class Script final : public Keyboard {
 public:
  explicit Script(std::vector<std::string> lines) : lines_(lines.begin(), lines.end()) {}
  std::optional<std::string> line() override {
    if (lines_.empty()) return std::nullopt;
    std::string line = lines_.front();
    lines_.pop_front();
    return line;
  }
  [[nodiscard]] bool ended() const override { return lines_.empty(); }

 private:
  std::deque<std::string> lines_;
};

Ran typed(const std::vector<std::string>& words, std::vector<std::string> lines) {
  std::ostringstream out, messages;
  ConsoleOptions options;
  options.keyboard = std::make_shared<Script>(std::move(lines));
  std::vector<std::string> all{"laser", "capture"};
  all.insert(all.end(), words.begin(), words.end());
  const int code = run_program(all, out, messages, options);
  return {code, out.str(), messages.str()};
}

/// X 0, 50, 100 forward and back, once.
std::vector<std::string> line(const std::string& output, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{"--axis", "X",  "--sense", "EX", "--from",         "0", "--to", "100",
                                 "--step", "50", "--runs",  "1",  "--min-interval", "0", "-o",   output};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

std::vector<double> readings_in(const std::string& file) {
  const auto set = laser::read_measurement_set(file);
  REQUIRE_MESSAGE(set, to_text(set.error()));
  std::vector<double> values;
  for (const laser::Reading& reading : set->readings) values.push_back(reading.error);
  return values;
}

TEST_CASE("typed values become a measurement set, one at each target, forward and back") {
  const Folder folder;
  const std::string out = folder / "exx.csv";
  const Ran run =
      typed(line(out, {"--parked", "y=-5", "--note", "operator=AB", "--json"}), {"0", "1.5", "2", "3", "2.5", "1"});
  REQUIRE_MESSAGE(run.code == 0, run.out);
  CHECK(run.json()["complete"] == true);
  CHECK(run.json()["readings"] == 6);
  CHECK(run.json()["part"].is_null());
  CHECK(!std::filesystem::exists(out + ".part"));
  const auto set = laser::read_measurement_set(out);
  REQUIRE(set);
  CHECK(readings_in(out) == std::vector<double>{0, 1.5, 2, 3, 2.5, 1});
  CHECK(set->readings[2].position_mm == Vector3{100.0, -5.0, 0.0});
  CHECK(set->readings[3].approach == Approach::reverse);
  CHECK(set->readings[5].time_s.has_value());
  CHECK(laser::metadata_value(*set, "operator") == "AB");
  CHECK(run.messages.find("next: X forward to 0 mm (1 of 3, run 1 of 1, 1 of 6 in all); start below it") !=
        std::string::npos);
}

TEST_CASE("u takes a value back, s leaves a target out, and what was left out is said") {
  const Folder folder;
  const std::string out = folder / "exx.csv";
  const Ran run = typed(line(out), {"0", "99", "u", "1.5", "s", "3", "2.5", "1"});
  REQUIRE(run.code == 0);
  CHECK(readings_in(out) == std::vector<double>{0, 1.5, 3, 2.5, 1});
  CHECK(run.out.find("left out: X forward 100 mm, run 1") != std::string::npos);
}

TEST_CASE("a capture left before its end is kept and can be continued") {
  const Folder folder;
  const std::string out = folder / "exx.csv";
  const Ran left = typed(line(out, {"--json"}), {"0", "1.5", "q"});
  CHECK(left.code == 1);
  CHECK(left.json()["complete"] == false);
  CHECK(left.json()["part"] == out + ".part");
  CHECK(readings_in(out + ".part") == std::vector<double>{0, 1.5});
  CHECK(!std::filesystem::exists(out));
  CHECK(typed(line(out), {"0"}).code == 2);  // not over an unfinished one
  const Ran resumed = typed({"--resume", out + ".part"}, {"2", "3", "2.5", "1"});
  REQUIRE_MESSAGE(resumed.code == 0, resumed.messages);
  CHECK(readings_in(out) == std::vector<double>{0, 1.5, 2, 3, 2.5, 1});
  CHECK(!std::filesystem::exists(out + ".part"));
}

TEST_CASE("stdin that ends leaves what was read, and says how to go on") {
  const Folder folder;
  const std::string out = folder / "exx.csv";
  const Ran run = typed(line(out), {"0", "1.5"});
  CHECK(run.code == 3);
  CHECK(run.messages.find("stdin has ended") != std::string::npos);
  CHECK(run.messages.find("--resume " + out + ".part") != std::string::npos);
  CHECK(readings_in(out + ".part").size() == 2);
}

TEST_CASE("a word that is not a value is not a reading") {
  const Folder folder;
  const Ran run = typed(line(folder / "exx.csv"), {"1,5", "hello", "0", "1", "2", "3", "4", "5"});
  CHECK(run.code == 0);
  CHECK(run.messages.find("\"1,5\" is no value and no command") != std::string::npos);
}

TEST_CASE("each reading of a file is taken in order; positions show doubled and missed triggers") {
  const Folder folder;
  const std::string file =
      folder.with("display.txt", "0.001\n0.001\n50.002\n100.000\n99.999\n# doubled, then 50 missed\n0.003\n");
  const std::string out = folder / "exx.csv";
  const Ran run = ran({"laser",     "capture", "--axis",  "X",        "--sense", "EX", "--from",     "0",
                       "--to",      "100",     "--step",  "50",       "--runs",  "1",  "--readings", file,
                       "--trigger", "each",    "--shows", "position", "-o",      out,  "--json"});
  REQUIRE_MESSAGE(run.code == 0, run.out);
  CHECK(run.json()["left_out"] == 1);
  CHECK(run.json()["in_doubt"] == 1);
  CHECK(run.messages.find("still shows 0.001 mm") != std::string::npos);
  CHECK(run.messages.find("a trigger was missed") != std::string::npos);
  const auto values = readings_in(out);
  REQUIRE(values.size() == 5);
  CHECK(values[1] == doctest::Approx(2.0));
  CHECK(values[3] == doctest::Approx(-1.0));
  CHECK(values[4] == doctest::Approx(3.0));
}

TEST_CASE("a file that ends too early leaves the rest for later") {
  const Folder folder;
  const std::string file = folder.with("display.txt", "1\n2\n");
  const Ran run = ran({"laser", "capture", "--axis", "X", "--sense", "EX", "--from", "0", "--to", "100", "--step", "50",
                       "--readings", file, "--trigger", "each", "-o", folder / "exx.csv"});
  CHECK(run.code == 3);
  CHECK(run.messages.find("holds no further reading") != std::string::npos);
  CHECK(std::filesystem::exists(folder / "exx.csv.part"));
}

TEST_CASE("the row of a plan gives axis, targets, runs and feed") {
  const Folder folder;
  const std::string out = folder / "c0y.csv";
  const Ran run = typed({"--plan", "samples/mill/plan.toml", "--row", "EXX", "--runs", "1", "--step", "2050",
                         "--min-interval", "0", "-o", out},
                        {"0", "1", "2", "3", "4", "5"});
  REQUIRE_MESSAGE(run.code == 0, run.messages);
  const auto set = laser::read_measurement_set(out);
  CHECK(set->readings[1].position_mm == Vector3{-2050.0, -1400.0, 0.0});
  CHECK(set->readings[1].feed_mm_min == 2000.0);
  CHECK(laser::metadata_value(*set, "measurement") == "EXX");
  const Ran wrong = typed({"--plan", "samples/mill/plan.toml", "--row", "EXQ", "-o", out + "2"}, {});
  CHECK(wrong.code == 2);
  CHECK(wrong.messages.find("holds no measurement \"EXQ\"; there are: EXX, EYX") != std::string::npos);
}

TEST_CASE("a target list is followed row by row with its conditions") {
  const Folder folder;
  const std::string targets =
      folder.with("next.csv",
                  "# content: target list\n# condition: load on the table\n"
                  "axis,sense,x_mm,reading,approach,run,load_kg\nX,EX,10,0,1,1,300\nX,EX,5,0,-1,1,300\n");
  const std::string out = folder / "exx.csv";
  REQUIRE(typed({"--targets", targets, "--min-interval", "0", "-o", out}, {"1", "2"}).code == 0);
  const auto set = laser::read_measurement_set(out);
  CHECK(set->readings[1].load_kg == 300.0);
  CHECK(set->readings[1].error == 2.0);
  CHECK(laser::metadata_value(*set, "condition") == "load on the table");
  CHECK(!laser::metadata_value(*set, "content").has_value());
}

TEST_CASE("missing or contradicting options are reported before anything begins") {
  const Folder folder;
  const std::string out = folder / "exx.csv";
  const Ran missing = typed({"--axis", "X", "-o", out}, {});
  CHECK(missing.code == 2);
  CHECK(missing.messages.find("Missing: --sense, --from, --to, --step") != std::string::npos);
  CHECK(typed(line(out, {"--trigger", "enter"}), {}).code == 2);
  CHECK(typed(line(out, {"--shows", "position", "--sense", "EY"}), {}).code == 2);
  CHECK(ran({"laser", "capture", "--axis", "X", "--sense", "EX", "--from", "0", "--to", "9", "--step", "3", "-o", out})
            .code == 2);
  const std::string there = folder.with("there.csv", "keep me");
  CHECK(typed(line(there), {"1"}).code == 2);
  CHECK(content_of(there) == "keep me");
  CHECK(typed(line(folder / "no/such/folder.csv"), {"1"}).code == 5);
}

TEST_CASE("the number of a display is the last one of its line") {
  CHECK(last_number_in("X -50.0012 mm") == -50.0012);
  CHECK(last_number_in("12 3.5um") == 3.5);
  CHECK(!last_number_in("no signal").has_value());
  CHECK(!last_number_in("").has_value());
}

TEST_CASE("a display that writes continuously is followed: its last complete line counts") {
  const Folder folder;
  const std::string file = folder.with("log.txt", "1\n2\n3\n4.5");
  auto source = following_source(file);
  REQUIRE(source);
  (*source)->ask(0.0);
  const Shown shown = (*source)->shown(0.1);
  REQUIRE(shown.kind == Shown::Kind::value);
  CHECK(shown.value == 3.0);
  std::ofstream(file, std::ios::app) << "6\n";
  CHECK((*source)->shown(0.2).value == 4.56);
}

TEST_CASE("a command is asked for what its display shows") {
  const auto source = command_source("echo shows 7.25 um");
  CHECK(source->shown(0.0).value == 7.25);
  CHECK(command_source("false")->shown(0.0).kind == Shown::Kind::none);
}

}  // namespace
}  // namespace ecs::app
