// A hidden case on disc: readable by others, sealed against accident, whole or not there at all; what a diagnosis says
// of it does not contradict itself.
#include <chrono>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "base/sealed.hpp"
#include "laser/measurement_set.hpp"
#include "modules/hidden_cases/tests/hidden_cases.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/model/support/sentences.hpp"
#include "tests/support/folder.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;
namespace fs = std::filesystem;

TEST_CASE("a case is a folder of files that others can read, and the truth is not read by accident") {
  const Folder folder;
  HiddenCaseRequest request = request_for(7, CaseKind::single, "map_gain");
  const auto written = must(write_hidden_cases(request, 1, folder.path / "case"));
  const HiddenCase c = case_of(request);
  CHECK(must(laser::read_measurement_set(folder.path / "case/data.csv")).readings.size() == c.readings.size());
  CHECK(must(params::read_machine(folder.path / "case/machine.toml")).warnings.empty());
  CHECK(fs::exists(folder.path / "case/map.csv"));
  const std::string sealed = *read_file(folder.path / "case/truth.sealed");
  for (const char* secret : {"map_gain", "single", "snr", "Hidden"}) CHECK(!contains(sealed, secret));
  for (const char* secret : {"map_gain", "single"}) CHECK(!contains(written.at(0), secret));
  const auto opened = must(unsealed(sealed, "truth.sealed"));
  const auto truth = nlohmann::json::parse(opened);
  CHECK(truth["kind"] == "single");
  CHECK(truth["effects"][0]["name"] == name_of(c.hidden[0].effect));
  CHECK(truth["effects"][0]["parameters"].contains("gain"));
  CHECK(truth["true_model_rms_um"] > 0.0);
}

TEST_CASE("many cases are written to numbered folders, with seeds that count up") {
  const Folder folder;
  HiddenCaseRequest request = request_for(20, CaseKind::blank);
  REQUIRE(write_hidden_cases(request, 3, folder.path / "many").has_value());
  request.seed = 22;
  CHECK(*read_file(folder.path / "many/0003/data.csv") == files_of(case_of(request)).at("data.csv"));
}

TEST_CASE("a folder with something in it is not touched") {
  const Folder folder;
  REQUIRE(write_file(folder.path / "mine.txt", "mine").has_value());
  CHECK(must_fail(write_hidden_cases(request_for(1, CaseKind::blank), 1, folder.path)).kind == ProblemKind::usage);
  CHECK(*read_file(folder.path / "mine.txt") == "mine");
  CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 1);
}

TEST_CASE("what cannot be hidden is refused and leaves nothing behind") {
  const Folder folder;
  const auto refusal = [&](const HiddenCaseRequest& request) {
    const auto written = must_fail(write_hidden_cases(request, 2, folder.path / "case"));
    CHECK(written.kind == ProblemKind::usage);
    CHECK(fs::is_empty(folder.path));
    return written.message;
  };
  CHECK(refusal(request_for(1, CaseKind::blank, "step")).find("effect") == 0);
  CHECK(refusal(request_for(1, CaseKind::confounded, "cyclic")).find("effect") == 0);
  HiddenCaseRequest few = request_for(1, CaseKind::single);
  few.readings = 12;
  CHECK(refusal(few) == "readings: expected 100 to 20000, got 12");
  HiddenCaseRequest silent = request_for(1, CaseKind::single);
  silent.snr = 0.0;
  CHECK(refusal(silent) == "snr: expected above 0 and up to 1000, got 0");
}

namespace {

model::Diagnosis answer_for(const HiddenCase& hidden) {
  const Folder folder;
  for (const auto& [name, content] : files_of(hidden)) (void)folder.with(name, content);
  const auto model = must(model::read_model(folder / "model.toml"));
  const auto set = must(laser::read_measurement_set(folder / "data.csv"));
  const auto machine = must(params::read_machine(folder / "machine.toml"));
  model::DiagnoseOptions options{.noise_replicates = 50};
  return must(model::diagnose(model, model::observations_of(set, model, machine.machine), options));
}

}  // namespace

TEST_CASE("no sentence contradicts its own numbers in the answers of hidden cases") {
  constexpr std::uint64_t kFirstSeed = 770'001;
  constexpr int kFewest = 10, kMost = 400;
  constexpr std::chrono::seconds kLongest{20};
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kMost && (i < kFewest || std::chrono::steady_clock::now() - begin < kLongest); ++i) {
    const auto kind = static_cast<CaseKind>(i % 5);
    auto request = request_for(kFirstSeed + static_cast<std::uint64_t>(i), kind);
    CAPTURE(request.seed);
    model::test::check_sentences(answer_for(case_of(request)));
  }
}

TEST_CASE("an effect that a wander explains as well does not take another effect with it") {
  const auto slope_with_three_outliers = request_for(5, CaseKind::single);
  const model::Diagnosis found = answer_for(case_of(slope_with_three_outliers));
  CHECK(found.verdict == model::Verdict::likely_effect);
  REQUIRE_FALSE(found.candidates.empty());
  CHECK(to_text(found.candidates.front().effect) == "scale:Z:EX");
  CHECK(found.candidates.front().standing == model::Standing::likely);
}
