#include <random>

#include <fmt/format.h>

#include "base/random.hpp"
#include "modules/fleet/result.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

FleetResult healthy(const std::string& id, const std::string& type, const std::string& batch) {
  return {id, "h", "adequate", {}, type, batch, 0.1, {}, false};
}
FleetResult with_cause(const std::string& id, const std::string& batch, const std::string& cause, double e_value) {
  return {id, "h", "missing_effect", {{cause, 0.9, e_value, 0.005}}, "mill", batch, 0.1, {}, false};
}

TEST_CASE("q-values are those of the procedure of Benjamini and Hochberg") {
  const auto q = q_values_of({0.04, 0.9, 0.01, 0.05});
  CHECK(q[2] == Approx(0.01 * 4.0 / 1.0));
  CHECK(q[3] == Approx(0.05 * 4.0 / 3.0));
  CHECK(q[0] == Approx(0.05 * 4.0 / 3.0));  // the third makes the second hold
  CHECK(q[1] == Approx(0.9));
}

TEST_CASE("of the names that stand at most five per cent are false where the p-values are valid") {
  std::mt19937_64 random(17);
  const UniformDraws uniform(0.0, 1.0);
  double share_sum = 0.0;
  constexpr int kTrials = 400, kMachines = 200, kChanged = 20;
  int found = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> p;
    for (int i = 0; i < kMachines; ++i) {
      const double any = uniform(random);
      p.push_back(i < kChanged ? std::pow(any, 16.0) : any);
    }
    const auto q = q_values_of(p);
    int named = 0, wrong = 0;
    for (int i = 0; i < kMachines; ++i)
      if (q[static_cast<std::size_t>(i)] <= 0.05) ++named, wrong += i >= kChanged ? 1 : 0;
    found += named - wrong;
    share_sum += named > 0 ? static_cast<double>(wrong) / named : 0.0;
  }
  CHECK(share_sum / kTrials <= 0.05);
  CHECK(found > kTrials * kChanged / 2);
}

TEST_CASE("the chance of a shared cause is that of Fisher's exact test") {
  const auto groups_where = [](const auto& has_cause) {
    std::vector<FleetResult> results;
    for (int i = 0; i < 40; ++i) {
      const std::string id = fmt::format("{}", i), batch = i < 5 ? "bad" : "good";
      results.push_back(has_cause(i) ? with_cause(id, batch, "scale", 1e8) : healthy(id, "mill", batch));
    }
    return fleet_names(results, 0.05).groups;
  };
  const auto four_of_five = groups_where([](int i) { return i < 4 || i == 20; });
  CHECK(only(four_of_five).value == "bad");
  CHECK(four_of_five[0].p_value == Approx((5.0 * 35.0 + 1.0) / 658'008.0));
  const auto all_of_five = groups_where([](int i) { return i < 5; });
  CHECK(only(all_of_five).p_value == Approx(1.0 / 658'008.0));
  CHECK(groups_where([](int) { return true; }).empty());
}

TEST_CASE("results without p-values count by the inverse of their e-values, enough for one, not among a thousand") {
  std::vector<FleetResult> results{with_cause("odd", "b", "cyclic:X:EX", 150.0)};
  const FleetNames alone = fleet_names(results, 0.05);
  CHECK(*only(alone.named).q_value == Approx(1.0 / 150.0));
  for (int i = 0; i < 999; ++i) results.push_back(healthy(fmt::format("{}", i), "mill", "b"));
  const FleetNames among = fleet_names(results, 0.05);
  CHECK(among.named.empty());
  CHECK(among.unconfirmed.size() == 1);
  CHECK(among.machines == 1000);
}

TEST_CASE("the p-value of a machine counts, that of a cause beside the others names a further one") {
  FleetResult two = with_cause("m", "b", "scale", 1.0);
  two.causes[0].p_value = 1e-12;
  two.causes.push_back({"cyclic:X:EX", 0.9, 1e9, 0.005, 0.3});
  two.p_value = 1e-5;
  std::vector<FleetResult> results{two};
  for (int i = 0; i < 99; ++i) results.push_back(healthy(fmt::format("{}", i), "mill", "b"));
  const FleetNames names = fleet_names(results, 0.05);
  CHECK(only(names.named).cause == "scale");
  CHECK(*names.named[0].q_value == Approx(1e-5 * 100.0));
  CHECK(only(names.unconfirmed).cause == "cyclic:X:EX");
  results[0].p_value = 1e-3;
  CHECK(fleet_names(results, 0.05).named.empty());
}

TEST_CASE("a machine without an answer takes no part, one without any evidence is not confirmed") {
  FleetResult unread{.id = "gone", .error = "no such file"};
  FleetResult weighed_by_noise = with_cause("m", "b", "scale", 1.0);
  weighed_by_noise.causes[0].e_value.reset();
  const FleetNames names = fleet_names({unread, weighed_by_noise, with_cause("n", "b", "scale", 1e6)}, 0.05);
  CHECK(names.machines == 2);
  CHECK_FALSE(only(names.unconfirmed).q_value);
  CHECK(names.named.size() == 1);
}

TEST_CASE("a further cause of a named machine needs the evidence of a machine of its own") {
  FleetResult two = with_cause("m", "b", "scale", 1e9);
  two.causes.push_back({"backlash:X", 0.9, 1e6, 0.005});
  two.causes.push_back({"cyclic:X:EX", 0.9, 3.0, 0.005});
  std::vector<FleetResult> results{two};
  for (int i = 0; i < 99; ++i) results.push_back(healthy(fmt::format("{}", i), "mill", "b"));
  const FleetNames names = fleet_names(results, 0.05);
  REQUIRE(names.named.size() == 2);
  CHECK(names.named[1].cause == "backlash:X");
  CHECK(*names.named[1].q_value == Approx(100.0 / 1e6));
  CHECK(only(names.unconfirmed).cause == "cyclic:X:EX");
}

TEST_CASE("a bad batch is listed, and its type is not listed for it") {
  std::vector<FleetResult> results;
  for (int i = 0; i < 300; ++i) {
    const std::string id = fmt::format("m{}", i), batch = fmt::format("2026-{:02}", i % 30),
                      type = i < 200 ? "mill" : "lathe";
    FleetResult one = healthy(id, type, batch);
    if (i % 30 == 4 && i < 200) one.causes = {{"cyclic:X:EX", 0.9, 1e8, 0.005}};
    if (i == 17 || i == 250) one.causes = {{"backlash:Y", 0.9, 1e8, 0.005}};
    results.push_back(one);
  }
  const FleetNames names = fleet_names(results, 0.05);
  CHECK(only(names.groups).by == "batch");
  CHECK(names.groups[0].value == "2026-04");
  CHECK(names.groups[0].cause == "cyclic:X:EX");
  CHECK(names.groups[0].machines == 7);
  CHECK(names.groups[0].of == 10);
  CHECK(names.groups[0].p_holm < 1e-6);
}

TEST_CASE("changes since last time are listed by machine and by cause, except of machines without an answer") {
  const auto named = [](const char* id, const char* cause) { return NamedMachine{id, cause, 0.01, "", ""}; };
  const FleetChanges changes = changes_between({named("a", "scale"), named("b", "scale"), named("c", "backlash:X")},
                                               {named("a", "scale"), named("d", "scale")}, {"c"});
  REQUIRE(changes.machines.size() == 2);
  CHECK(changes.machines[0].id == "b");
  CHECK_FALSE(changes.machines[0].is_new);
  CHECK(changes.machines[1].id == "d");
  CHECK(changes.machines[1].is_new);
  CHECK(only(changes.causes).is_new == 1);
  CHECK(changes.causes[0].gone == 1);
}

}  // namespace
}  // namespace ecs::commissioning
