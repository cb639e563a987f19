// The fit of the project against certified values of NIST StRD (tests/data/real/nist-strd): parameters and their
// sigmas.
#include <map>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "laser/measurement_set.hpp"
#include "model/data/observations.hpp"
#include "model/fit/fit.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;

namespace {

struct Certified {
  double start1 = 0.0, start2 = 0.0, value = 0.0, sigma = 0.0;
};

/// A NIST file: certified values by name, the residual standard deviation, and the data as a measurement set with x in
/// the column `u` and y as readings.
struct NistProblem {
  std::map<std::string, Certified> parameters;
  double residual_sigma = 0.0;
  std::string csv = "axis,sense,x_mm,u,reading\n";
  std::size_t observations = 0;
};

std::vector<std::string_view> words_in(std::string_view line) {
  std::vector<std::string_view> words;
  for (const std::string_view word : split(line, ' '))
    if (!trimmed(word).empty()) words.push_back(trimmed(word));
  return words;
}

NistProblem nist(const std::string& name) {
  NistProblem problem;
  const std::string text = *read_file("tests/data/real/nist-strd/" + name + ".dat");
  bool in_data = false;
  for (const std::string_view line : lines_of(text)) {
    const auto words = words_in(line);
    if (in_data && words.size() == 2) {
      problem.csv += fmt::format("X,EX,{0},{0},{1}\n", words[1], words[0]);
      ++problem.observations;
    } else if (words.size() == 6 && words[1] == "=" && words[0].front() == 'b') {
      problem.parameters[std::string(words[0])] = {*number_in(words[2]), *number_in(words[3]), *number_in(words[4]),
                                                   *number_in(words[5])};
    } else if (line.starts_with("Residual Standard Deviation:")) {
      problem.residual_sigma = *number_in(words.back());
    } else if (line.starts_with("Data:") && problem.residual_sigma > 0.0) {
      in_data = true;
    }
  }
  return problem;
}

Fit plain_fit(const std::string& model_text, const std::string& csv) {
  const auto model = must(parse_model(model_text, "nist.toml", ""));
  const auto set = must(laser::parse_measurement_set(csv, "nist.csv"));
  return must(fit(model, observations_of(set, model, {}), {.plain = true}));
}

/// Differences from the certified numbers: of a parameter in its certified sigma, of a sigma relative.
constexpr double kOfSigma = 0.01, kOfItself = 1e-3;

/// Fits a user formula from one of NIST's starting points and compares all that is certified.
void check_certified(const std::string& name, const std::string& formula, double Certified::*start) {
  CAPTURE(name);
  const NistProblem problem = nist(name);
  REQUIRE(problem.residual_sigma > 0.0);
  std::string parameters;
  for (const auto& [key, certified] : problem.parameters)
    parameters += fmt::format("{}{} = {{ start = {:.12e} }}", parameters.empty() ? "" : ", ", key, certified.*start);
  const Fit fitted = plain_fit(fmt::format("[[effect]]\nid = \"user\"\nname = \"nist\"\nformula = {{ EX = \"{}\" }}\n"
                                           "parameters = {{ {} }}\n",
                                           formula, parameters),
                               problem.csv);
  REQUIRE(fitted.effects.size() == 1);
  for (const ParameterEstimate& estimate : fitted.effects[0].parameters) {
    CAPTURE(estimate.name);
    const Certified& certified = problem.parameters.at(estimate.name);
    CHECK(std::abs(estimate.value - certified.value) < kOfSigma * certified.sigma);
    REQUIRE(estimate.sigma);
    CHECK(std::abs(*estimate.sigma / certified.sigma - 1.0) < kOfItself);
  }
  const double freedom = static_cast<double>(problem.observations - problem.parameters.size());
  const double squares = fitted.rms_um * fitted.rms_um * static_cast<double>(problem.observations);
  CHECK(std::sqrt(squares / freedom) == Approx(problem.residual_sigma).epsilon(1e-5));
}

}  // namespace

TEST_CASE("NIST Misra1a: two parameters, lower difficulty") {
  check_certified("Misra1a", "b1*(1-exp(-b2*u))", &Certified::start2);
}

TEST_CASE("NIST Thurber: a rational function of seven parameters, higher difficulty") {
  check_certified("Thurber", "(b1+b2*u+b3*u^2+b4*u^3)/(1+b5*u+b6*u^2+b7*u^3)", &Certified::start2);
}

TEST_CASE("NIST MGH17: two exponentials and a constant, average difficulty") {
  check_certified("MGH17", "b1+b2*exp(-u*b4)+b3*exp(-u*b5)", &Certified::start2);
}

TEST_CASE("NIST Gauss1: two peaks on an exponential") {
  check_certified("Gauss1", "b1*exp(-b2*u)+b3*exp(-(u-b4)^2/b5^2)+b6*exp(-(u-b7)^2/b8^2)", &Certified::start2);
}

TEST_CASE("NIST Eckerle4: one peak, higher difficulty") {
  check_certified("Eckerle4", "(b1/b2)*exp(-0.5*((u-b3)/b2)^2)", &Certified::start2);
}

TEST_CASE("NIST ENSO as a formula: three periods") {
  check_certified("ENSO",
                  "b1+b2*cos(2*_pi*u/12)+b3*sin(2*_pi*u/12)+b5*cos(2*_pi*u/b4)+b6*sin(2*_pi*u/b4)+b8*cos(2*_pi*u/b7)"
                  "+b9*sin(2*_pi*u/b7)",
                  &Certified::start2);
}

TEST_CASE("NIST ENSO as `cyclic` effects with second harmonics: beside 12 and 26.888 months the search finds 44.3") {
  const NistProblem problem = nist("ENSO");
  const auto wave = [](const std::string& parameters) {
    return "[[effect]]\nid = \"cyclic\"\naxis = \"X\"\nsense = \"EX\"\n" + parameters;
  };
  const Fit fitted = plain_fit("[[effect]]\nid = \"offset\"\naxis = \"X\"\nsense = \"EX\"\n" +
                                   wave("parameters = { period_mm = 12.0 }\n") +
                                   wave("parameters = { period_mm = 26.887614440 }\n") + wave(""),
                               problem.csv);
  const Certified& certified = problem.parameters.at("b4");
  const auto& found = fitted.effects.back().parameters.front();
  CHECK(found.name == "period_mm");
  CHECK(std::abs(found.value - certified.value) < certified.sigma);
  REQUIRE(found.sigma);
  CHECK(*found.sigma == Approx(certified.sigma).epsilon(0.2));
}
