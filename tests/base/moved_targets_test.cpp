// Targets moved off an even grid.
#include "base/moved_targets.hpp"

#include "tests/support/test.hpp"

using namespace ecs;

namespace {

std::vector<double> even(double from_mm, double step_mm, int count) {
  std::vector<double> targets;
  for (int i = 0; i < count; ++i) targets.push_back(from_mm + step_mm * i);
  return targets;
}

}  // namespace

TEST_CASE("even targets are moved by up to 0.3 of the step, the ends not, and a tenth and more is common") {
  const auto before = even(0.0, 50.0, 83), after = moved_targets(before);
  REQUIRE(after.size() == before.size());
  CHECK(after.front() == before.front());
  CHECK(after.back() == before.back());
  int by_a_tenth = 0;
  for (std::size_t i = 1; i + 1 < after.size(); ++i) {
    CHECK(std::abs(after[i] - before[i]) <= 0.3 * 50.0 + 1e-3);
    by_a_tenth += std::abs(after[i] - before[i]) >= 0.1 * 50.0 ? 1 : 0;
    CHECK(after[i] == Approx(std::round(after[i] * 1000.0) / 1000.0));
  }
  CHECK(by_a_tenth > 40);
  CHECK(std::is_sorted(after.begin(), after.end()));
  CHECK(moved_targets(before) == after);
  CHECK(!even_step_mm(after));
}

TEST_CASE("another line is moved otherwise, a descending one stays descending") {
  const auto one = moved_targets(even(0.0, 50.0, 20)), other = moved_targets(even(10.0, 50.0, 20));
  CHECK(std::abs(one[3] - (other[3] - 10.0)) > 0.01);
  const auto down = moved_targets(even(0.0, -50.0, 20));
  CHECK(std::is_sorted(down.rbegin(), down.rend()));
  CHECK(down[3] != Approx(-150.0));
}

TEST_CASE("a short last step is moved by its own size; fewer than three targets stay as they are") {
  const auto after = moved_targets({0.0, 40.0, 80.0, 120.0, 130.0});
  CHECK(std::abs(after[3] - 120.0) <= 3.0);
  CHECK(after[4] == 130.0);
  CHECK(moved_targets(even(0.0, 50.0, 2)) == even(0.0, 50.0, 2));
  CHECK(moved_targets({}).empty());
}

TEST_CASE("targets with gaps are even where they lie on one grid") {
  CHECK(even_step_mm({300.0, 0.0, 50.0, 50.0, 100.0}).value() == Approx(50.0));
  CHECK(even_step_mm({0.0, 25.0001, 50.0, 74.9999}).value() == Approx(25.0).epsilon(0.001));
  CHECK(!even_step_mm({0.0, 50.0, 105.0}));
  CHECK(!even_step_mm({0.0, 50.0}));
  std::vector<double> finer_at_one_end = even(0.0, 50.0, 21);
  for (const double target_mm : even(0.0, 2.0, 11)) finer_at_one_end.push_back(target_mm);
  CHECK(even_step_mm(finer_at_one_end).value() == Approx(2.0));
}

TEST_CASE("uneven targets written to a micrometre are not even at a micrometre") {
  auto three_lines = moved_targets(even(0.0, 50.0, 20));
  for (const double first_mm : {10.0, 20.0})
    for (const double target_mm : moved_targets(even(first_mm, 50.0, 20))) three_lines.push_back(target_mm);
  three_lines.push_back(three_lines[5] + 0.001);
  CHECK(!even_step_mm(three_lines));
  std::vector<double> on_the_fly{0.0};  // steps of 3 to 12 um, one of them of 1 um
  for (int i = 1; i < 2000; ++i) on_the_fly.push_back(on_the_fly.back() + 0.001 * (i == 7 ? 1 : 3 + i * i % 10));
  CHECK(!even_step_mm(on_the_fly));
}
