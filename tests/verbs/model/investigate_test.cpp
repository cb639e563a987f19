// `ecs model investigate` against the workshop of a running emulator.
#include <algorithm>
#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "controllers/tables.hpp"
#include "params/parameters_toml.hpp"
#include "tests/support/emulator.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

const std::string kInvestigation = "samples/investigation/";

/// The emulator of the sample with its workshop, until the end of the test.
class ServedSample {
 public:
  explicit ServedSample(std::string sample = kInvestigation) : sample_(std::move(sample)) {
    process_ = started({kEmulator, "serve", "--machine", sample_ + "machine.toml", "--workshop", workshop, "--mode",
                        "integrate", "--with-parent"},
                       folder / "ready.json");
    constexpr int kLooks = 400;
    for (int i = 0; i < kLooks && content_of(folder / "ready.json").empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(25));
  }
  ServedSample(const ServedSample&) = delete;
  ServedSample& operator=(const ServedSample&) = delete;
  ~ServedSample() { end_process(process_, SIGTERM); }

  [[nodiscard]] Ran investigate(const std::string& minutes, std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"model",
                                   "investigate",
                                   sample_ + "model.toml",
                                   "--machine",
                                   sample_ + "machine.toml",
                                   "--workshop",
                                   workshop,
                                   "--minutes",
                                   minutes};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }

  StateFolder folder;
  std::string workshop = folder / "shop";

 private:
  std::string sample_;
  pid_t process_ = -1;
};

TEST_CASE("the cause that the machine hides is found, added, compensated and measured again") {
  const ServedSample served;
  const std::string found = served.folder / "found.toml";
  const Ran investigated = served.investigate("200", {"-o", found, "--json"});
  REQUIRE_MESSAGE(investigated.code == 0, investigated.all());
  const auto answer = investigated.json();
  CHECK(answer["verdict"] == "missing_effect");
  REQUIRE(answer["causes"].size() == 1);
  CHECK(answer["causes"][0]["name"] == "cyclic:Y:EY");
  CHECK(answer["causes"][0]["parameters"]["period_mm"].get<double>() == doctest::Approx(10.0).epsilon(0.01));
  CHECK(answer["steps"].back()["set"].size() == 1);
  CHECK(answer["rms_before_um"].get<double>() > 2.0);
  CHECK(answer["rms_compensated_um"].get<double>() < 0.8);
  CHECK(answer["minutes"].get<double>() < 0.6 * answer["programme_minutes"].get<double>());
  CHECK(content_of(found).find("cyclic") != std::string::npos);
  CHECK(content_of(found).find("zero") == std::string::npos);
}

TEST_CASE("square and straight edge are turned over: what is theirs is named and no part of the machine") {
  const ServedSample served("samples/artefacts/");
  const std::string found = served.folder / "found.toml";
  const Ran investigated = served.investigate("600", {"-o", found, "--json"});
  REQUIRE_MESSAGE(investigated.code == 0, investigated.all());
  const auto answer = investigated.json();
  std::vector<std::string> names;
  for (const auto& cause : answer["causes"]) {
    names.push_back(cause["name"]);
    if (names.back() == "artefact_angle:Y:EX")
      CHECK(cause["parameters"]["um_per_m"].get<double>() == doctest::Approx(12.0).epsilon(0.15));
  }
  std::sort(names.begin(), names.end());
  CHECK(names == std::vector<std::string>{"artefact_angle:Y:EX", "artefact_form:X:EY", "progressive:X:EY"});
  CHECK(answer["rms_before_um"].get<double>() > 3.0);
  CHECK(answer["rms_compensated_um"].get<double>() < 1.5);
  const std::string map = served.folder / "map.csv", parameters = served.folder / "parameters.toml";
  REQUIRE(ran({"map", "build", "--from-model", found, "--machine", "samples/artefacts/machine.toml", "--zero-missing",
               "test", "-o", map, "--params-out", parameters})
              .code == 0);
  const auto kept = params::read_parameters(parameters);
  REQUIRE(kept.has_value());
  CHECK(controllers::squareness_of(kept->parameters)[index_of(Component::C0Y)] == doctest::Approx(35.0).epsilon(0.06));
}

TEST_CASE("the ledger is a table that a person can follow") {
  const ServedSample served;
  const Ran investigated = served.investigate("200");
  CHECK(investigated.code == 0);
  CHECK(investigated.out.find("EX along X, first look") != std::string::npos);
  CHECK(investigated.out.find("cyclic:Y:EY 1.00") != std::string::npos);
  CHECK(investigated.out.find("ISO 230-2 programme of the same 3 lines: 5 bidirectional runs") != std::string::npos);
}

TEST_CASE("minutes that allow no run leave nothing measured, and exit 0") {
  const ServedSample served;
  const Ran investigated = served.investigate("1", {"--json"});
  CHECK(investigated.code == 0);
  CHECK(investigated.json()["steps"].empty());
  CHECK(investigated.json()["verdict"].is_null());
}

TEST_CASE("a workshop or a folder, not both and not neither") {
  CHECK(ran({"model", "investigate", kInvestigation + "model.toml", "--machine", kInvestigation + "machine.toml",
             "--minutes", "10"})
            .code == 2);
  CHECK(ran({"model", "investigate", kInvestigation + "model.toml", "--machine", kInvestigation + "machine.toml",
             "--minutes", "10", "--workshop", "/tmp/none", "--watch", "/tmp/none"})
            .code == 2);
}

TEST_CASE("a socket on which no workshop listens is a fault of the link") {
  const Ran investigated = ran({"model", "investigate", kInvestigation + "model.toml", "--machine",
                                kInvestigation + "machine.toml", "--minutes", "10", "--workshop", "/nowhere/shop"});
  CHECK(investigated.code == 4);
  CHECK(investigated.messages.find("no workshop listens here") != std::string::npos);
}

}  // namespace
}  // namespace ecs::app
