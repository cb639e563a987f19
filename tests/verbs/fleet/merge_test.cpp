#include <doctest/doctest.h>

#include "tests/support/fleet_folder.hpp"

namespace ecs::app {
namespace {

std::string fleet_line(const std::string& id, const std::string& hash, const std::string& batch, double e_value) {
  const std::string cause =
      e_value > 0.0
          ? fmt::format(R"({{"name":"cyclic:X:EX","probability":0.99,"e_value":{},"false_naming":0.005}})", e_value)
          : "";
  return fmt::format(
             R"({{"id":"{}","hash":"{}","verdict":"{}","causes":[{}],"type":"mill","batch":"{}","processor_s":0.1}})",
             id, hash, e_value > 0.0 ? "missing_effect" : "adequate", cause, batch) +
         "\n";
}

/// Ten batches of ten; batch 7 has a periodic error.
std::string fleet_night(double e_value) {
  std::string text;
  for (int i = 0; i < 100; ++i)
    text += fleet_line(fmt::format("m{}", i), "aa", fmt::format("b{}", i / 10), i / 10 == 7 ? e_value : 0.0);
  return text;
}

TEST_CASE("results of many hosts become one answer that names the machines and their batch") {
  const Folder folder;
  const std::string all = fleet_night(1e12);
  const std::string a = folder.with("a.jsonl", all.substr(0, all.size() / 2));  // a line is cut
  const std::string b = folder.with("b.jsonl", all);
  const Ran r = ran({"fleet", "merge", a, b, "--fdr", "0.05", "-o", folder / "all.jsonl", "--json"});
  CHECK(r.code == 0);
  const auto answer = r.json();
  CHECK(answer["machines"] == 100);
  REQUIRE(answer["named"].size() == 10);
  CHECK(answer["named"][0]["cause"] == "cyclic:X:EX");
  CHECK(answer["named"][0]["q_value"].get<double>() == doctest::Approx(100.0 / (10 * 1e12)));
  REQUIRE(answer["groups"].size() == 1);
  check_has(answer["groups"][0], {"by", "value", "cause", "machines", "p_value"});
  CHECK(answer["groups"][0]["value"] == "b7");
  CHECK(contains(r.messages, "a.jsonl"));
  CHECK(owned_lines_of(content_of(folder / "all.jsonl")).size() >= 100);
  CHECK(ran({"fleet", "merge", a, "-o", folder / "all.jsonl"}).code == 2);
}

TEST_CASE("what changed since last time is told from its results or its answer") {
  const Folder folder;
  const std::string before = folder.with("before.jsonl", fleet_night(0.0)),
                    now = folder.with("now.jsonl", fleet_night(1e12));
  const std::string answer = folder.with("now.json", ran({"fleet", "merge", now, "--json"}).out);
  const auto appeared = ran({"fleet", "merge", now, "--previous", before, "--json"}).json();
  CHECK(appeared["changed"].size() == 10);
  CHECK(appeared["changed"][0]["change"] == "new");
  CHECK(appeared["changed_causes"][0]["new"] == 10);
  const auto mended = ran({"fleet", "merge", before, "--previous", answer, "--json"}).json();
  CHECK(mended["changed_causes"][0]["gone"] == 10);
  CHECK(ran({"fleet", "merge", now, "--previous", now, "--json"}).json()["changed"].empty());
}

TEST_CASE("one id with two contents is a conflict, exit code 1") {
  const Folder folder;
  const std::string a = folder.with("a.jsonl", fleet_line("m", "aa", "b", 0.0)),
                    b = folder.with("b.jsonl", fleet_line("m", "bb", "b", 0.0));
  const Ran r = ran({"fleet", "merge", a, b});
  CHECK(r.code == 1);
  CHECK(contains(r.messages, "b.jsonl: m has other contents"));
  CHECK(ran({"fleet", "merge", folder.with("x.txt", "no results\n")}).code == 3);
}

}  // namespace
}  // namespace ecs::app
