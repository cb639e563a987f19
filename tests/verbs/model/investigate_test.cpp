// `ecs model investigate` against the workshop of a running emulator.
#include <algorithm>
#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "tests/support/emulator.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

const std::string kInvestigation = "samples/investigation/";

/// The emulator of the sample with its workshop, until the end of the test.
class ServedSample {
 public:
  ServedSample() {
    process_ = started({kEmulator, "serve", "--machine", kInvestigation + "machine.toml", "--workshop", workshop,
                        "--mode", "integrate", "--with-parent"},
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
                                   kInvestigation + "model.toml",
                                   "--machine",
                                   kInvestigation + "machine.toml",
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
