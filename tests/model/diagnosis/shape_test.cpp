// What is left, in words: each shape by made data, and no words where nothing is proved.
#include "model/diagnosis/shape.hpp"

#include <numbers>

#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;

/// A residual of two or more runs both ways over a metre, and the words for it.
struct Leftover {
  Observations data;
  Eigen::VectorXd residual;
  std::vector<bool> left_out;

  explicit Leftover(const Truth& truth, const Plan& plan = {.step_mm = 12.5, .targets = 81, .runs = 4},
                    unsigned seed = 1)
      : data(observations_of(measured(plan, kNoise_um, truth, seed), Model{}, mill())),
        residual(Eigen::Map<const Eigen::VectorXd>(data.reading.data(), static_cast<Eigen::Index>(data.size()))),
        left_out(data.size(), false) {}
  [[nodiscard]] std::string over(const std::string& variable) const {
    return shape_in_words(data, residual, kNoise_um, left_out, variable);
  }
};

bool has(const std::string& text, const std::string& part) { return contains(text, part); }

}  // namespace

TEST_CASE("a wave whose period grows is described with both periods") {
  const std::string words = Leftover([](const Reading& r) {
                              const double x = p(r) / 1000.0;  // 25 waves a metre at the beginning, 9 at the end
                              return 2.0 * std::sin(kFullTurn * (25.0 * x - 8.0 * x * x));
                            }).over("x_mm");
  CAPTURE(words);
  CHECK(has(words, "whose period grows from 4"));
  CHECK(has(words, "to 11"));
}

TEST_CASE("a wave that dies is described with the end towards which it does") {
  const std::string words = Leftover([](const Reading& r) {
                              return 4.0 * std::exp(-p(r) / 300.0) * std::sin(kFullTurn * p(r) / 80.0);
                            }).over("x_mm");
  CAPTURE(words);
  CHECK(has(words, "a period of 80"));
  CHECK(has(words, "amplitude decays towards X = 1000 mm"));
}

TEST_CASE("a plain wave, a jump, a bump, a line and a curve have their own words") {
  CHECK(has(Leftover([](const Reading& r) { return 2.0 * std::sin(kFullTurn * p(r) / 110.0); }).over("x_mm"),
            " um and a period of 1"));
  const std::string jump = Leftover([](const Reading& r) { return p(r) > 600.0 ? 2.0 : 0.0; }).over("x_mm");
  CAPTURE(jump);
  CHECK(has(jump, "a jump of +"));
  CHECK(has(jump, "at X = 60"));
  const std::string bump =
      Leftover([](const Reading& r) { return 3.0 * std::exp(-0.5 * std::pow((p(r) - 400.0) / 25.0, 2)); }).over("x_mm");
  CHECK(has(bump, "a bump of +"));
  CHECK(has(Leftover([](const Reading& r) { return 3.0 * p(r) / 1000.0; }).over("x_mm"), "a straight line"));
  CHECK(has(Leftover([](const Reading& r) { return 9.0 * std::pow(p(r) / 1000.0 - 0.5, 2); }).over("x_mm"),
            "a smooth curve"));
}

TEST_CASE("runs, directions and time are described") {
  CHECK(has(Leftover([](const Reading& r) { return r.run == 3 ? 2.0 : 0.0; }).over("run"), " um from the others"));
  CHECK(has(Leftover([](const Reading& r) { return 0.7 * r.run; }).over("run"), "a trend by run, +2"));
  CHECK(has(Leftover([](const Reading& r) { return r.run == 1 || r.run == 4 ? 1.0 : -1.0; }).over("run"),
            "each run has a different zero"));
  CHECK(has(Leftover([](const Reading& r) { return 1.0 * d(r); }).over("approach"), "forward lies +2"));
  const std::string half =
      Leftover([](const Reading& r) { return d(r) * (p(r) > 500.0 ? 2.0 : 0.0); }).over("approach");
  CHECK(has(half, "half the difference of the directions is a jump"));
  const std::string moment = Leftover([](const Reading& r) { return *r.time_s > 3000.0 ? 2.0 : 0.0; }).over("time_s");
  CAPTURE(moment);
  CHECK(has(moment, "a jump of +"));
  CHECK(has(moment, " um at time = "));
}

TEST_CASE("noise alone and another value at every target have no words") {
  int said = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const Leftover noise(nothing, {.step_mm = 25.0, .targets = 41, .runs = 3}, seed);
    for (const char* variable : {"x_mm", "approach", "run", "time_s"}) said += noise.over(variable).empty() ? 0 : 1;
  }
  CHECK(said <= 2);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Leftover rough([&](const Reading& r) { return 2.0 * std::sin(7919.0 * (p(r) + seed)); });
    CHECK(rough.over("x_mm").empty());
  }
}

TEST_CASE("the spectrum along the travel lists the periods that hold most") {
  const Leftover two([](const Reading& r) {
    return 2.0 * std::sin(kFullTurn * p(r) / 100.0) + 1.0 * std::sin(kFullTurn * p(r) / 43.0);
  });
  const std::string words = spectrum_in_words(two.data, two.residual, kNoise_um, two.left_out);
  CAPTURE(words);
  CHECK(has(words, "periods along X: 100 mm (7"));
  CHECK(has(words, "(21 %)"));
  const Leftover noise(nothing);
  CHECK(spectrum_in_words(noise.data, noise.residual, kNoise_um, noise.left_out).empty());
}
