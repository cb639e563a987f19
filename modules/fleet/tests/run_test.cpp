#include "modules/fleet/run.hpp"

#include <map>

#include "base/file.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "modules/fleet/result.hpp"
#include "tests/support/model_workspace.hpp"

namespace ecs::commissioning {
namespace {

const ManifestColumns kTwoColumns{{"id", "data"}, {"batch"}};

Result<Manifest> manifest_of(const std::string& text) {
  return Manifest::parse(text, "fleet.csv", "/fleet", kTwoColumns);
}

TEST_CASE("a manifest takes its columns in any order and leaves others alone") {
  const auto manifest =
      must(manifest_of("\xEF\xBB\xBF# of the night\ndata,site,id\n\na.csv,\"Hall 1, west\",m1\r\nb.csv,,m2"));
  REQUIRE(manifest.size() == 2);
  CHECK(manifest.row(0)->cells == std::vector<std::string>{"m1", "a.csv", ""});
  CHECK(manifest.row(1)->id() == "m2");
  CHECK(manifest.row(1)->line == 5);
  CHECK(manifest.from_folder("sets/a.csv") == "/fleet/sets/a.csv");
}

TEST_CASE("a manifest without a needed column or without rows is refused with its line") {
  CHECK(contains(manifest_of("id,batch\nm1,b\n").error().message, "lacks the column data"));
  CHECK(contains(manifest_of("# x\nid,dta\nm1,a.csv\n").error().message, "did you mean data"));
  CHECK(manifest_of("# x\nid,dta\nm1,a.csv\n").error().line == 2);
  CHECK(contains(manifest_of("id,data,id\nm1,a,b\n").error().message, "found id twice"));
  CHECK_FALSE(manifest_of("id,data\n"));
  CHECK_FALSE(manifest_of(""));
}

TEST_CASE("a wrong row of a manifest spoils no other") {
  const auto manifest = must(manifest_of("id,data\nm1,a.csv,b.csv\n,a.csv\nm3,\n\"m4,a.csv\nm5,a.csv\n"));
  CHECK(contains(manifest.row(0).error().message, "expected 2 cells"));
  CHECK(contains(manifest.row(1).error().message, "id: expected a value"));
  CHECK(manifest.row(2).error().line == 4);
  CHECK_FALSE(manifest.row(3));
  CHECK(manifest.row(4)->id() == "m5");
}

TEST_CASE("rows of a manifest with the id of an earlier one are known with its line") {
  const auto manifest = must(manifest_of("id,data\nm1,a.csv\nm2,b.csv\nm1,c.csv\nm1,d.csv\n"));
  CHECK_FALSE(manifest.doubles_line(0));
  CHECK_FALSE(manifest.doubles_line(1));
  CHECK(manifest.doubles_line(2) == 2);
  CHECK(manifest.doubles_line(3) == 2);
}

using namespace app;

/// A small fleet in a folder of its own: healthy machines and some with a periodic error.
struct FleetFolder {
  Folder folder;
  std::string results = folder / "results.jsonl";

  FleetFolder() {
    static_cast<void>(folder.with("model.toml", kStraightModel));
    static_cast<void>(folder.with("machine.toml", kTestMachine));
    for (unsigned i = 0; i < 4; ++i)
      static_cast<void>(
          folder.with(fmt::format("{}.csv", i), measured_x(i == 2 ? cyclic_x : straight_x, {.seed = i + 7})));
  }
  /// A row for 0.csv … 3.csv under the ids m0 … m3.
  [[nodiscard]] static std::string row(unsigned i, const std::string& batch = "b") {
    return fmt::format("m{},model.toml,{}.csv,machine.toml,mill,{}\n", i, i, batch);
  }
  [[nodiscard]] std::string manifest(const std::string& rows) const {
    return folder.with("fleet.csv", "id,model,data,machine,type,batch\n" + rows);
  }
  [[nodiscard]] Ran diagnose(const std::string& manifest_file, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"fleet", "diagnose", manifest_file, "-o", results, "--blanks", "50", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
  [[nodiscard]] std::vector<std::string> lines() const { return owned_lines_of(content_of(results)); }
  /// By id, without the time they took.
  [[nodiscard]] std::map<std::string, FleetResult> answers() const {
    std::map<std::string, FleetResult> all;
    for (const std::string& line : lines()) {
      auto result = must(result_in(line));
      result.processor_s = 0.0;
      CHECK_MESSAGE(all.emplace(result.id, result).second, "more than one line for ", result.id);
    }
    return all;
  }
};

Result<FleetReport> run_of(const FleetFolder& fleet, const std::string& rows, FleetOptions options = {},
                           const FleetWatch& watch = {}) {
  options.noise_replicates = 50;
  return run_fleet(must(Manifest::read(fleet.manifest(rows), fleet_columns())), fleet.results, options, watch);
}

std::string four_rows() {
  return FleetFolder::row(0) + FleetFolder::row(1) + FleetFolder::row(2) + FleetFolder::row(3);
}

TEST_CASE("answers do not depend on the number of threads") {
  const FleetFolder one, many;
  REQUIRE(run_of(one, four_rows(), {.threads = 1}));
  REQUIRE(run_of(many, four_rows(), {.threads = 4}));
  CHECK(one.answers() == many.answers());
  CHECK(one.answers().at("m2").causes.at(0).name == "cyclic:X:EX");
  CHECK(one.answers().at("m1").verdict == "adequate");
}

TEST_CASE("a run that was killed in the middle of a line goes on without loss") {
  const FleetFolder fleet;
  REQUIRE(run_of(fleet, four_rows(), {.threads = 1}));
  const auto whole = fleet.answers();
  const auto lines = fleet.lines();
  std::ofstream(fleet.results) << lines[0] << '\n' << lines[1] << '\n' << lines[2].substr(0, 40);
  const auto again = must(run_of(fleet, four_rows(), {.threads = 1}));
  CHECK(again.skipped == 2);
  CHECK(again.diagnosed == 2);
  CHECK(fleet.answers() == whole);
  CHECK_FALSE(std::filesystem::exists(fleet.results + ".work"));
}

TEST_CASE("a link or a file of another program beside the results is refused, and stays as it was") {
  const FleetFolder fleet;
  const std::string precious = fleet.results + ".precious", work = fleet.results + ".work";
  std::ofstream(precious) << "keep me\n";
  std::filesystem::create_symlink(precious, work);
  const auto through_link = must_fail(run_of(fleet, FleetFolder::row(0)));
  CHECK(through_link.kind == ProblemKind::refused);
  CHECK(contains(through_link.message, "symbolic link"));
  std::filesystem::remove(work);
  std::filesystem::copy_file(precious, work);
  CHECK(contains(must_fail(run_of(fleet, FleetFolder::row(0))).message, "not a file of `ecs fleet diagnose`"));
  for (const std::string& file : {precious, work}) CHECK(read_file(file) == "keep me\n");
}

TEST_CASE("a signal stops a fleet in good order") {
  const FleetFolder fleet;
  FleetWatch watch;
  ask_to_stop();
  const auto stopped = run_of(fleet, four_rows(), {.threads = 2}, watch);
  stop_asking();
  REQUIRE(stopped);
  CHECK(stopped->stopped);
  CHECK(stopped->diagnosed == 0);
  const auto rest = must(run_of(fleet, four_rows()));
  CHECK(rest.skipped + rest.diagnosed == 4);
  CHECK(fleet.answers().size() == 4);
}

TEST_CASE("changed content is diagnosed again, a changed batch is not") {
  const FleetFolder fleet;
  REQUIRE(run_of(fleet, four_rows()));
  static_cast<void>(fleet.folder.with("1.csv", app::measured_x(app::cyclic_x, {.seed = 99})));
  const auto again = must(run_of(fleet, FleetFolder::row(0, "other") + FleetFolder::row(1)));
  CHECK(again.diagnosed == 1);
  CHECK(again.skipped == 1);
  const auto third = run_of(fleet, FleetFolder::row(0, "other") + FleetFolder::row(1));  // leaves replaced lines out
  CHECK(third->skipped == 2);
  CHECK(fleet.answers().at("m0").batch == "other");
  CHECK(fleet.answers().at("m1").verdict == "missing_effect");
  CHECK(fleet.answers().size() == 4);
}

TEST_CASE("the hash is of the content, wherever it lies") {
  const FleetFolder one, other;
  const auto hash_in = [](const FleetFolder& fleet, const char* data) {
    return content_hash({"m", fleet.folder / "model.toml", fleet.folder / data, fleet.folder / "machine.toml", "", ""},
                        200);
  };
  CHECK(hash_in(one, "0.csv").value() == hash_in(other, "0.csv").value());
  CHECK(hash_in(one, "0.csv").value() != hash_in(one, "1.csv").value());
}

TEST_CASE("files that end the program three times are left out, told, and tried again by the next run") {
  const FleetFolder fleet;
  static_cast<void>(fleet.folder.with("results.jsonl.work", "W 2 m1\nW 0 m0\nK 1 m3\n"));
  const auto report = must(run_of(fleet, four_rows(), {.threads = 1}));
  CHECK(report.diagnosed == 3);
  CHECK(only(report.errors).line == 3);
  CHECK(contains(report.errors[0].message, "ended 3 times"));
  CHECK(commissioning::result_in(fleet.lines()[0])->id == "m2");  // those that were under way come last
  CHECK(run_of(fleet, four_rows())->diagnosed == 1);
}

TEST_CASE("parts of a manifest together are the whole") {
  const FleetFolder fleet;
  CHECK(run_of(fleet, four_rows(), {.part = {1, 3}})->diagnosed == 2);
  CHECK(run_of(fleet, four_rows(), {.part = {2, 3}})->machines == 1);
  CHECK(run_of(fleet, four_rows(), {.part = {3, 3}})->diagnosed == 1);
  CHECK(run_of(fleet, four_rows(), {.part = {7, 9}})->machines == 0);
  CHECK(run_of(fleet, four_rows())->skipped == 4);
  CHECK(fleet_part("3/16")->of == 16);
  for (const char* wrong : {"", "0/4", "5/4", "3", "a/b", "1/2/3"}) CHECK_FALSE(fleet_part(wrong));
}

TEST_CASE("two runs do not write the same results") {
  const FleetFolder fleet;
  auto first = must(UnderWay::open(fleet.results + ".work", 1));
  CHECK(must_fail(run_of(fleet, four_rows())).kind == ProblemKind::refused);
  first.remove();
}

TEST_CASE("a machine that takes too long is an error, and the others go on") {
  const FleetFolder fleet;
  app::MeasuredAxis large{.runs = 20, .targets = 80};
  static_cast<void>(fleet.folder.with("0.csv", app::measured_x(app::cyclic_x, large)));
  const auto report = must(run_of(fleet, FleetFolder::row(0) + FleetFolder::row(1), {.threads = 2, .most_s = 0.01}));
  REQUIRE_FALSE(report.errors.empty());
  CHECK(contains(report.errors[0].message, "stopped after 0.01 s"));
}

}  // namespace
}  // namespace ecs::commissioning
