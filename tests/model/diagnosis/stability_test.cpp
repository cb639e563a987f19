// Readings moved by far less than their last digit: the answer to every sample stays what it is. Rounding of another
// compiler or processor moves numbers in the same way.
#include <map>
#include <random>

#include "laser/import/import.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;

namespace {

constexpr double kMoved_um = 1e-9;
constexpr int kTimes = 20;
/// Enough for a limit of names; the answer is held, not judged.
constexpr std::size_t kReplicates = 40;
/// A share of a number, and of the logarithm of evidence; numbers below the least are zero.
constexpr double kShare = 1e-3, kLeast = 1e-6;

struct Sample {
  Model model;
  laser::MeasurementSet set;
  std::optional<params::Machine> machine;
};

Sample sample(const std::string& model, const std::string& data, const std::string& machine) {
  Sample one;
  const auto read = must(read_model(model));
  one.model = read;
  const auto readings = must(laser::read_any(data, {}));
  one.set = readings.set;
  if (!machine.empty()) {
    const auto of = must(params::read_machine(machine));
    one.machine = of.machine;
  }
  return one;
}

Diagnosis answer_to(const Sample& one, const laser::MeasurementSet& set) {
  DiagnoseOptions options{.noise_replicates = kReplicates};
  return must(diagnose(one.model, observations_of(set, one.model, one.machine), options));
}

/// Verdict, headline and names in their order.
std::string words_of(const Diagnosis& found) {
  std::string words = std::string(name_of(found.verdict)) + "\n" + found.headline + "\n" + found.reservation;
  for (const Candidate& candidate : found.candidates) {
    words += "\n" + place_text(candidate.effect) + (candidate.named ? " named" : "") + ":";
    for (const std::string& rival : candidate.indistinguishable_from) words += " " + rival;
    for (const SetMember& member : candidate.set) words += " | " + member.place;
  }
  for (const Dependence& one : found.where) words += "\n" + one.variable + " " + one.looks_like;
  for (const int row : found.outliers) words += "\n" + std::to_string(row);
  return words;
}

/// All numbers by name; of evidence and small probabilities the logarithm.
std::map<std::string, double> numbers_in(const Diagnosis& found) {
  std::map<std::string, double> numbers;
  const auto ln = [](double chance) { return std::log(std::max(chance, 1e-300)); };
  const auto add_chance = [&](const std::string& name, double chance) {
    numbers[name] = chance < 1e-6 ? ln(chance) : chance;
  };
  numbers["rms"] = found.rms_um;
  numbers["rms after"] = found.rms_after_um;
  numbers["noise"] = found.noise.noise_um;
  if (found.lack_of_fit) numbers["F"] = found.lack_of_fit->F;
  if (found.lack_of_fit_after) numbers["F after"] = found.lack_of_fit_after->F;
  for (const OwnTerm& term : found.own_terms) numbers["own " + std::to_string(term.effect)] = term.value;
  for (std::size_t i = 0; i < found.candidates.size(); ++i) {
    const Candidate& candidate = found.candidates[i];
    const std::string of = std::to_string(i) + " " + to_text(candidate.effect) + " ";
    numbers[of + "rms after"] = candidate.rms_after_um;
    numbers[of + "explained"] = candidate.explained;
    numbers[of + "share"] = candidate.explainable_share;
    numbers[of + "value"] = candidate.tried_at.value;
    numbers[of + "held out"] = candidate.held_out_rms_um.value_or(0.0);
    add_chance(of + "p", candidate.p_value);
    add_chance(of + "false naming", candidate.false_naming);
    add_chance(of + "probability", candidate.probability);
    if (candidate.e_value) numbers[of + "ln e"] = ln(*candidate.e_value);
    for (const ParameterEstimate& parameter : candidate.parameters) {
      numbers[of + parameter.name] = parameter.value;
      numbers[of + parameter.name + " sigma"] = parameter.sigma.value_or(0.0);
    }
    for (const auto& [name, values] : candidate.parameters_set)
      for (std::size_t j = 0; j < values.size(); ++j) numbers[of + name + " " + std::to_string(j)] = values[j];
    for (const SetMember& member : candidate.set) add_chance(of + "set " + member.place, member.probability);
  }
  for (const Dependence& one : found.where) {
    numbers[one.variable] = one.strength;
    for (std::size_t j = 0; j < one.mean_um.size(); ++j)
      numbers[one.variable + " " + std::to_string(j)] = one.mean_um[j];
  }
  return numbers;
}

/// @param times  fewer for large sets
void check_stays(const Sample& one, int times = kTimes) {
  const Diagnosis first = answer_to(one, one.set);
  const std::string words = words_of(first);
  const std::map<std::string, double> numbers = numbers_in(first);
  std::mt19937_64 random(7710001);
  for (int time = 0; time < times; ++time) {
    laser::MeasurementSet moved = one.set;
    for (laser::Reading& reading : moved.readings) reading.error += random() % 2 == 0 ? kMoved_um : -kMoved_um;
    const Diagnosis again = answer_to(one, moved);
    CHECK(words_of(again) == words);
    for (const auto& [name, number] : numbers_in(again)) {
      const auto was = numbers.find(name);
      REQUIRE_MESSAGE(was != numbers.end(), name);
      const double most = std::max(kLeast, kShare * std::abs(was->second));
      CHECK_MESSAGE(std::abs(number - was->second) <= most, name << " " << was->second << " became " << number);
    }
  }
}

Sample hidden(const std::string& number) {
  const std::string of = "samples/hidden/" + number + "/";
  return sample(of + "model.toml", of + "data.csv", of + "machine.toml");
}

Sample made(const std::string& name) {
  const std::string of = "tests/data/made_up/" + name;
  return sample(of + ".toml", of + ".csv", "");
}

}  // namespace

TEST_CASE("the answers to six machines that hide something stay where readings move by a billionth of a micrometre") {
  for (const char* number : {"1", "2", "3", "4", "5", "6"}) {
    CAPTURE(number);
    check_stays(hidden(number));
  }
}

TEST_CASE("so do those to the made-up sets that show one fault each") {
  for (const char* name : {"five_targets", "twisted_mesh"}) {
    CAPTURE(name);
    check_stays(made(name));
  }
}

TEST_CASE("so do those to sets of more than a thousand readings, which are moved less often for the time it takes") {
  for (const char* name : {"one_target", "plate", "edge_outliers", "two_periods"}) {
    CAPTURE(name);
    check_stays(made(name), 2);
  }
}
