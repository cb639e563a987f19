// Sentences about what to measure next and what compensation would leave: none contradicts its own numbers. In CTest as
// many cases as twenty seconds allow; ECS_SENTENCES=400 in the environment takes this many, however long.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <regex>

#include <fmt/format.h>

#include "tests/support/emulator.hpp"
#include "tests/support/verb_run.hpp"

using namespace ecs;
using namespace ecs::app;
using Answer = nlohmann::json;

namespace {

Answer answer(const std::string& verb, const std::filesystem::path& folder) {
  const Ran one =
      ran({"model", verb, folder / "model.toml", folder / "data.csv", "--machine", folder / "machine.toml", "--json"});
  REQUIRE_MESSAGE(one.code == 0, one.messages);
  return one.json();
}

/// What a proposal tells: minutes and separation of its own run, which is the run of its sentence.
void check_proposal(const Answer& one) {
  const std::string tells = one["tells"], sentence = one["sentence"];
  CHECK_MESSAGE(contains(tells, fmt::format("{:.0f} min", one["minutes"].get<double>())), tells);
  std::smatch found;
  if (static const std::regex sigma(R"((?:: |\(| at )(\d+\.\d) sigma)"); std::regex_search(tells, found, sigma)) {
    const double told = std::stod(found[1]);
    const bool is_own = std::any_of(one["pairs"].begin(), one["pairs"].end(), [&](const Answer& pair) {
      return std::abs(pair["sigma"].get<double>() - told) < 0.051;
    });
    CHECK_MESSAGE((is_own || std::abs(one["separation_sigma"].get<double>() - told) < 0.051), tells);
    CHECK_MESSAGE(told >= 1.0, tells);
  } else {
    CHECK_MESSAGE(one["pairs"].empty(), tells);
  }
  const auto& targets = one["targets_mm"];
  CHECK_MESSAGE(contains(sentence, fmt::format("{} targets ", targets.size())), sentence);
  const double first = targets.front().get<double>(), last = targets.back().get<double>();
  const bool states_ends = contains(sentence, fmt::format("from {:g} to {:g} mm", first, last)) ||
                           contains(sentence, fmt::format("moved to {:g} and {:g} mm", first, last));
  CHECK_MESSAGE(states_ends, sentence);
  const int runs = one["runs"];
  CHECK_MESSAGE(contains(sentence, fmt::format(", {} {}, feed", runs, runs == 1 ? "run" : "runs")), sentence);
  CHECK_MESSAGE(contains(sentence, "both ways") == one["bidirectional"].get<bool>(), sentence);
}

/// `next` and the answer of `diagnose` propose the same, and nothing where nothing is in doubt.
void check_next(const Answer& next, const Answer& diagnosis) {
  for (const Answer& one : next["proposals"]) check_proposal(one);
  const bool settled = std::any_of(next["notes"].begin(), next["notes"].end(), [](const Answer& note) {
    return note.get<std::string>().starts_with("No further measurement is needed");
  });
  if (settled) CHECK(next["proposals"].empty());
  CHECK(next["verdict"] == diagnosis["verdict"]);
  for (const Answer& candidate : diagnosis["candidates"]) {
    if (!candidate["named"].get<bool>()) continue;
    if (settled) CHECK(contains(candidate["next_measurement"].get<std::string>(), "No further measurement is needed"));
    if (!candidate["indistinguishable_from"].empty() && !next["proposals"].empty()) {
      const Answer& first = next["proposals"][0];
      const bool tells_it_apart = std::any_of(first["pairs"].begin(), first["pairs"].end(), [&](const Answer& pair) {
        const auto of = [&](const char* key) {
          return pair[key].is_string() &&
                 pair[key].get<std::string>().starts_with(candidate["name"].get<std::string>());
        };
        return pair["sigma"].get<double>() >= 3.0 && (of("truth") || of("rival"));
      });
      if (tells_it_apart || first["pairs"].empty())
        CHECK(candidate["next_measurement"].get<std::string>().starts_with(first["sentence"].get<std::string>()));
      break;  // the first group of rivals
    }
  }
}

/// Two sums that make up what is predicted; a direction that gets worse is reported, and no other.
void check_what_if(const Answer& after) {
  const double machine = after["machine_um"], measurement = after["measurement_um"], left = after["rms_after_um"];
  if (measurement == 0.0) CHECK(machine == Approx(left).epsilon(1e-6));
  CHECK(left <= (machine + measurement) * (1.0 + 1e-9));
  bool of_measurement = false;
  for (const Answer& effect : after["effects"]) {
    CHECK_FALSE((effect["carried"].get<bool>() && effect["of_measurement"].get<bool>()));
    of_measurement = of_measurement || effect["of_measurement"].get<bool>();
  }
  CHECK((measurement > 0.0) == of_measurement);
  static const std::regex worse(R"(worse, (\S+) -> ([^:]+):)");
  for (const Answer& note : after["notes"]) {
    const std::string text = note;
    std::smatch found;
    if (std::regex_search(text, found, worse)) CHECK_MESSAGE(std::stod(found[2]) >= std::stod(found[1]), text);
  }
}

}  // namespace

TEST_CASE("no sentence on the next measurement or on compensation contradicts its numbers in hidden cases") {
  const char* const wanted = std::getenv("ECS_SENTENCES");
  const int least = wanted == nullptr ? 6 : std::stoi(wanted), most = std::max(least, 200);
  constexpr std::chrono::seconds kLongest{20};
  const Folder folder;
  const std::string hide = fmt::format("{} hide --seed 780001 --count {} --readings 150 -o {} >/dev/null", kEmulator,
                                       most, folder / "cases");
  REQUIRE(std::system(hide.c_str()) == 0);
  std::vector<std::filesystem::path> cases;
  for (const auto& one : std::filesystem::directory_iterator(folder / "cases")) cases.push_back(one.path());
  std::sort(cases.begin(), cases.end());
  REQUIRE(cases.size() == static_cast<std::size_t>(most));
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < most && (i < least || std::chrono::steady_clock::now() - begin < kLongest); ++i) {
    const auto& one = cases[static_cast<std::size_t>(i)];
    CAPTURE(one.filename().string());
    check_next(answer("next", one), answer("diagnose", one));
    check_what_if(answer("what-if", one));
  }
}

TEST_CASE("beside readings that wander no effect is likely for which held-out readings do not speak") {
  const Folder folder;
  for (const auto& [noise, seed] : {std::pair{"slow", 13836}, std::pair{"random-walk", 13834}}) {
    CAPTURE(noise);
    const std::filesystem::path one = folder / noise;
    const std::string hide =
        fmt::format("{} hide --seed {} --kind blank --noise {} -o {} >/dev/null", kEmulator, seed, noise, one.string());
    REQUIRE(std::system(hide.c_str()) == 0);
    const Answer diagnosis = answer("diagnose", one);
    CHECK(diagnosis["verdict"] == "unexplained_structure");
    for (const Answer& candidate : diagnosis["candidates"]) CHECK(candidate["standing"] == "possible");
  }
}
