// Limits as they are written; a freeze that shows whether it was changed; groups, refusals and openings; the test of an
// added effect against numbers that a hand can check.
#include "modules/judging/judging.hpp"

#include <numbers>

#include <rapidcheck.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "tests/support/model_workspace.hpp"

namespace ecs::commissioning {
namespace {

using app::ran;
using app::Ran;

// --- limits

TEST_CASE("limits are read as they are written") {
  const JudgingLimits limits = must(parse_judging_limits(R"(zero = "run"
known = ["cyclic:X:EX"]
[inside]
t_material_degC = [18, 24.5]
[[group]]
by = "run"
values = [4, "five"]
share = 0.25
readings = 20
inside = { rms_um = 1.5, max_um = 5 }
[[group]]
by = "sector"
sector_deg = 45
beyond = { rms_um = 3 }
)",
                                                         "l.toml"));
  CHECK(limits.zero_of_each_run);
  CHECK(only(limits.known).effect == "cyclic:X:EX");
  CHECK(limits.inside.at("t_material_degC").greatest == 24.5);
  REQUIRE(limits.groups.size() == 2);
  const HeldOutGroups& runs = limits.groups[0];
  CHECK(runs.values == std::vector<std::string>{"4", "five"});
  CHECK((runs.share == 0.25 && runs.readings == 20 && runs.inside->rms_um == 1.5 && runs.inside->max_um == 5.0));
  CHECK_FALSE(runs.beyond);
  CHECK(limits.groups[1].sector_deg == 45.0);
  CHECK(limits.groups[1].readings == 10);
}

TEST_CASE("wrong limits are refused at their place") {
  const auto group = [](const std::string& more) { return "[[group]]\nby = \"run\"\n" + more; };
  const std::string limit = "inside = { rms_um = 1 }\n";
  const std::vector<std::tuple<std::string, int, int, std::string>> wrong{
      {"", 1, 0, "[[group]]"},
      {"[[group]]\n" + limit, 1, 1, "by"},
      {"limit = 3\n" + group(limit), 1, 9, "expected one of"},
      {"zero = \"drift\"\n" + group(limit), 1, 8, "zero"},
      {"known = [3]\n" + group(limit), 1, 10, "known"},
      {group(""), 1, 1, "expected a limit"},
      {group("inside = { rms_um = -1 }"), 3, 21, "above 0"},
      {group("inside = { rms_um = nan }"), 3, 21, "finite"},
      {group("inside = { rms_um = 0 }"), 3, 21, "above 0"},
      {group("inside = { rms_um = \"1\" }"), 3, 21, "number"},
      {group("inside = { max_um = 1 }"), 3, 10, "rms_um"},
      {group("inside = { rms_um = 1, peak_um = 3 }"), 3, 34, "expected one of"},
      {group(limit + "values = [1, 2, 1]"), 4, 17, "twice"},
      {group(limit + "values = []"), 4, 10, "values"},
      {group(limit + "values = [nan]"), 4, 11, "values"},
      {group(limit + "share = 0.95"), 4, 9, "share"},
      {group(limit + "share = -0.1"), 4, 9, "share"},
      {group(limit + "readings = 3"), 4, 12, "whole number"},
      {group(limit + "readings = 4.5"), 4, 12, "whole number"},
      {group(limit + "sector_deg = 90"), 4, 14, "sector"},
      {"[[group]]\nby = \"sector\"\nsector_deg = 77\n" + limit, 3, 14, "part of 360"},
      {group(limit) + group(limit), 4, 1, "given twice"},
      {"[inside]\nx_mm = [5, 1]\n" + group(limit), 2, 8, "least"},
  };
  for (const auto& [text, line, column, part] : wrong) {
    CAPTURE(text);
    const Problem why = must_fail(parse_judging_limits(text, "l.toml"));
    CHECK(why.file == "l.toml");
    CHECK((why.line == line && why.column == column));
    CHECK_MESSAGE(contains(why.message, part), why.message);
  }
  CHECK(must_fail(parse_judging_limits("a = 1\nb = 2\n" + group(limit), "l.toml")).also.size() == 1);
}

// --- the freeze

FrozenModel a_freeze() {
  FrozenModel frozen;
  frozen.time = "2026-05-04T09:30:00Z";
  frozen.program_sha256 = "01";
  frozen.model = {"m.toml", "02"};
  frozen.map = FrozenFile{"map.csv", "03"};
  frozen.data = {{"a.csv", "04"}, {"b.csv", "05"}};
  frozen.limits_text = "zero = \"run\"\n";
  frozen.readings = 12;
  frozen.rms_um = 0.1 + 0.2;
  frozen.runs = {"06"};
  frozen.ranges = {{"EX X", "x_mm", -1.0 / 3.0, 1e-300}};
  frozen.without = {{"cyclic:X:EX", "[[effect]]\n"}};
  return frozen;
}

TEST_CASE("a freeze is read as it was written, and refused once a byte of it was changed") {
  const std::string text = to_json(a_freeze());
  CHECK(must(parse_frozen_model(text, "f.json")) == a_freeze());
  for (std::size_t k = 0; k < text.size(); ++k) {
    std::string changed = text;
    changed[k] = changed[k] == '7' ? '8' : '7';
    CAPTURE(k);
    CHECK(must_fail(parse_frozen_model(changed, "f.json")).file == "f.json");
  }
}

// --- the test of an added effect

/// So many runs along X, a reading every 10 mm and every minute.
model::Observations runs_of(int count, int readings = 2) {
  laser::MeasurementSet set;
  for (int run = 1; run <= count; ++run)
    for (int k = 0; k < readings; ++k) {
      laser::Reading& reading = set.readings.emplace_back();
      reading.row = static_cast<int>(set.readings.size());
      reading.position_mm[0] = 10.0 * k;
      reading.run = run;
      reading.time_s = 60.0 * reading.row;
    }
  return observations_of(set, model::KnownTables{}, std::nullopt);
}

TEST_CASE("of four runs the chance is that of Student's t with three degrees of freedom") {
  const model::Observations data = runs_of(4);
  std::vector<double> with(8, 0.0), without;
  for (const double square : {1.0, 2.0, 3.0, 4.0}) without.insert(without.end(), 2, std::sqrt(square));
  const JudgedEffect judged = judged_effect(data, with, without);
  // mean 2.5, standard error sqrt(5/3 / 4); P(T > t) = 1/2 − (x/(1 + x²) + atan x)/π, x = t/√3
  const double x = 2.5 / std::sqrt(5.0 / 12.0) / std::sqrt(3.0);
  CHECK(*judged.p_value == Approx(0.5 - (x / (1.0 + x * x) + std::atan(x)) / std::numbers::pi));
  CHECK(judged.stretches == 4);
  CHECK(judged.rms_without_um == Approx(std::sqrt(2.5)));
  CHECK(judged.rms_um == 0.0);
  CHECK(judged.better());
  CHECK(*judged_effect(data, without, with).p_value == Approx(1.0 - *judged.p_value));
}

TEST_CASE("scale and, of few runs, the zero of a run do not change the chance") {
  CHECK(rc::check("judged_effect", [] {
    const int runs = *rc::gen::inRange(1, 7);
    const model::Observations data = runs_of(runs, 12);
    std::vector<double> with, without;
    for (std::size_t k = 0; k < data.size(); ++k) {
      with.push_back(*rc::gen::inRange(-1000, 1001) / 100.0);
      without.push_back(*rc::gen::inRange(-1000, 1001) / 100.0);
    }
    const JudgedEffect judged = judged_effect(data, with, without);
    if (judged.readings < data.size()) return;  // some run has no difference
    RC_ASSERT(judged.stretches >= static_cast<std::size_t>(runs));
    RC_ASSERT(judged.stretches <= static_cast<std::size_t>(runs < 4 ? 3 * runs : runs));
    std::vector<double> a = with, b = without;
    for (std::size_t k = 0; k < a.size(); ++k) a[k] *= 8.0, b[k] *= 8.0;
    RC_ASSERT(std::abs(*judged_effect(data, a, b).p_value - *judged.p_value) < 1e-9);
    if (runs >= 4) return;
    for (std::size_t k = 0; k < a.size(); ++k) a[k] += 50.0 * data.run[k], b[k] += 50.0 * data.run[k];
    RC_ASSERT(std::abs(*judged_effect(data, a, b).p_value - *judged.p_value) < 1e-6);
  }));
}

TEST_CASE("what acts at one place of a single run is seen there: readings are cut where it acts") {
  const model::Observations data = runs_of(1, 80);
  std::vector<double> with, without;
  for (std::size_t k = 0; k < 80; ++k) {
    with.push_back(0.5 * std::sin(7.0 * static_cast<double>(k)));
    without.push_back(with.back() + (k >= 20 && k < 40 ? 2.0 + static_cast<double>(k % 3) : 0.0));
  }
  CHECK(judged_effect(data, with, without).better());
  CHECK_FALSE(judged_effect(data, without, with).better());
}

TEST_CASE("a run that is too short shows nothing") {
  const JudgedEffect judged = judged_effect(runs_of(1, 6), {0, 0, 0, 0, 0, 0}, {1, -1, 1, -1, 1, -1});
  CHECK((judged.readings == 6 && judged.stretches == 1 && !judged.p_value && !judged.better()));
}

TEST_CASE("an effect that changes no prediction is not judged") {
  const std::vector<double> same(8, 1.0);
  const JudgedEffect judged = judged_effect(runs_of(4), same, same);
  CHECK(judged.readings == 0);
  CHECK_FALSE(judged.better());
}

// --- from files

const char* const kTrueModel = R"([[effect]]
id = "scale"
axis = "X"
sense = "EX"
parameters = { um_per_m = 5.0 }
[[effect]]
id = "cyclic"
axis = "X"
sense = "EX"
parameters = { period_mm = 8.0, amplitude_um = 2.0, phase_rad = 0.4 }
)";

/// A machine, a model that is true, data that it was fitted to and others; a freeze of them.
struct Bench : StateFolder {
  std::string machine = with("machine.toml", app::kTestMachine), model = with("m.toml", kTrueModel);
  std::string data = with("fit.csv", app::measured_x(app::cyclic_x, {.runs = 2}));
  std::string held = with("held.csv", app::measured_x(app::cyclic_x, {.runs = 2, .seed = 7}));
  std::string frozen = *this / "f.json";

  Ran freeze(const std::string& limits, const std::vector<std::string>& more = {"--force"}) const {
    std::vector<std::string> words{
        "model", "freeze", model, "--data", data, "--machine", machine, "--limits", with("l.toml", limits),
        "-o",    frozen};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
  [[nodiscard]] Ran judge(const std::string& file) const { return ran({"model", "judge", frozen, file, "--json"}); }
  [[nodiscard]] Ran judge() const { return judge(held); }
};

std::string by(const std::string& name, const std::string& more = "") {
  return "[[group]]\nby = \"" + name + "\"\ninside = { rms_um = 1 }\nbeyond = { rms_um = 2 }\n" + more;
}

/// {"run 1": "inside", …}
std::map<std::string, std::string> kinds_in(const Ran& r) {
  INFO(r.all());
  REQUIRE((r.code == 0 || r.code == 1));
  std::map<std::string, std::string> kinds;
  const auto json = r.json();
  for (const auto& one : json["groups"]) kinds[one["value"].get<std::string>()] += one["kind"].get<std::string>();
  return kinds;
}

TEST_CASE("the model is judged as it stands: its residuals are the noise, and the limit decides") {
  const Bench bench;
  REQUIRE(bench.freeze("[[group]]\nby = \"run\"\ninside = { rms_um = 0.5, max_um = 1.3 }\n").code == 0);
  const Ran r = bench.judge();
  CHECK(r.code == 0);
  const auto json = r.json(), group = json["groups"][0];
  double squares = 0.0;
  std::size_t rows = 0;
  const auto set = must(laser::read_measurement_set(bench.held));
  for (const laser::Reading& one : set.readings)
    if (one.run == 1) ++rows, squares += std::pow(one.error - app::cyclic_x(one.position_mm[0], 1, 1), 2);
  CHECK(group["rms_um"].get<double>() == Approx(std::sqrt(squares / static_cast<double>(rows))));
  CHECK(group["readings"] == rows);
  CHECK(group["limit_um"] == 0.5);
  CHECK(json["effects"][0]["effect"] == "cyclic:X:EX");
  CHECK(json["effects"][0]["better"] == true);
  CHECK(json["opened"].is_null());
  CHECK(json["seen"].is_null());
  REQUIRE(bench.freeze("[[group]]\nby = \"run\"\ninside = { rms_um = 0.2 }\n").code == 0);
  CHECK(bench.judge().code == 1);
  CHECK(bench.judge().json()["groups"][0]["holds"] == false);
}

TEST_CASE("an effect that is not there does not hold, however wide the limits, unless it is known from elsewhere") {
  Bench bench;
  bench.held = bench.with("held.csv", app::measured_x(app::straight_x, {.runs = 4, .seed = 7}));
  REQUIRE(bench.freeze("[[group]]\nby = \"all\"\ninside = { rms_um = 99 }\n").code == 0);
  CHECK(bench.judge().code == 1);
  CHECK(bench.judge().json()["effects"][0]["better"] == false);
  REQUIRE(bench.freeze("known = [\"cyclic:X:EX\"]\n[[group]]\nby = \"all\"\ninside = { rms_um = 99 }\n").code == 0);
  CHECK(bench.judge().code == 0);
  const Ran r = bench.freeze(std::string("\n") + "known = [\"sag:X:EX\"]\n" + by("all"));
  CHECK(r.code == 3);
  CHECK(contains(r.messages, "l.toml:2: known"));
}

TEST_CASE("what lies beyond the fitted conditions has a limit of its own") {
  const Bench bench;
  REQUIRE(bench.freeze(by("all")).code == 0);
  const auto shifted = [](double x, int, int) { return app::cyclic_x(x, 1, 1); };
  const std::string far = app::measured_x(shifted, {.runs = 1, .targets = 61, .seed = 3});
  const Ran r = bench.judge(bench.with("far.csv", far));
  CHECK(kinds_in(r)["all"] == "insidebeyond");
  CHECK(r.json()["groups"][1]["beyond"][0].get<std::string>().starts_with("x_mm outside 0 to"));
  CHECK(r.json()["groups"][1]["limit_um"] == 2.0);
  // a few readings cannot be judged alone: they count with the others
  const std::string near = app::measured_x(shifted, {.runs = 1, .targets = 43, .seed = 3});
  CHECK(kinds_in(bench.judge(bench.with("near.csv", near)))["all"] == "inside");
  REQUIRE(bench.freeze("[inside]\nx_mm = [0, 2000]\n" + by("all")).code == 0);
  CHECK(kinds_in(bench.judge(bench.with("far.csv", far)))["all"] == "inside");
  REQUIRE(bench.freeze("[[group]]\nby = \"all\"\ninside = { rms_um = 1 }\n").code == 0);
  const Ran refused = bench.judge(bench.with("far.csv", far));
  CHECK(refused.code == 3);
  CHECK(contains(refused.out, "no limit for that"));
}

TEST_CASE("a hold-out is divided by half, day, set-up, tool and sense") {
  Bench bench;
  std::string text = app::measured_x(app::cyclic_x, {.runs = 2, .seed = 9});
  std::string rows = "# begun: 2026-03-01 23:50:00\n";
  int number = 0;
  for (const std::string_view line : lines_of(text)) {
    if (line.empty()) continue;
    rows += fmt::format("{},{},{}\n", line,
                        number == 0       ? "set_up"
                        : number % 2 == 0 ? "1"
                                          : "2",
                        number == 0    ? "tool"
                        : number < 100 ? "long"
                                       : "short");
    ++number;
  }
  bench.held = bench.with("held.csv", rows);
  using Kinds = std::map<std::string, std::string>;
  const std::vector<std::pair<std::string, Kinds>> wanted{{"half", {{"X lower", "inside"}, {"X upper", "inside"}}},
                                                          {"day", {{"2026-03-01", "inside"}, {"2026-03-02", "inside"}}},
                                                          {"set_up", {{"1", "inside"}, {"2", "inside"}}},
                                                          {"tool", {{"long", "inside"}, {"short", "inside"}}},
                                                          {"sense", {{"EX", "inside"}}},
                                                          {"approach", {{"-1", "inside"}, {"1", "inside"}}}};
  for (const auto& [name, kinds] : wanted) {
    CAPTURE(name);
    REQUIRE(bench.freeze(by(name)).code == 0);
    CHECK(kinds_in(bench.judge()) == kinds);
  }
}

TEST_CASE("angles are divided by sector and sign") {
  Bench bench;
  const auto turned = [](int seed) {
    std::string text = "axis,sense,c_deg,reading,approach,run,time_s\n";
    for (int k = 0; k < 72; ++k) text += fmt::format("C,EC,{},{},1,1,{}\n", 5 * k - 180, (k * seed) % 7, k);
    return text;
  };
  bench.model =
      bench.with("m.toml", "[[effect]]\nid = \"offset\"\naxis = \"C\"\nsense = \"EC\"\nparameters = { um = 3 }\n");
  bench.data = bench.with("fit.csv", turned(3));
  bench.held = bench.with("held.csv", turned(5));
  const std::string wide = "[[group]]\nby = \"{}\"\ninside = {{ rms_um = 9 }}\n{}";
  REQUIRE(bench.freeze(fmt::format(fmt::runtime(wide), "sign", "")).code == 0);
  CHECK(kinds_in(bench.judge()) == std::map<std::string, std::string>{{"C +", "inside"}, {"C -", "inside"}});
  CHECK(bench.judge().json()["groups"][0]["readings"] == 36);  // 0 is +
  REQUIRE(bench.freeze(fmt::format(fmt::runtime(wide), "sector", "sector_deg = 60\n")).code == 0);
  const Ran sectors = bench.judge();
  CHECK(kinds_in(sectors).size() == 6);
  CHECK(sectors.json()["groups"][1]["value"] == "C 60..120");
  CHECK(bench.freeze(by("half")).code == 3);
}

TEST_CASE("angles are divided by their magnitude, and by a rotary axis other than the one that moves") {
  Bench bench;
  const auto turned = [](int seed) {
    std::string text = "axis,sense,b_deg,c_deg,reading,approach,run,time_s\n";
    for (int k = 0; k < 72; ++k)
      text += fmt::format("C,EC,{},{},{},1,1,{}\n", 45 * (k % 3 - 1), 5 * k - 180, (k * seed) % 7, k);
    return text;
  };
  bench.model =
      bench.with("m.toml", "[[effect]]\nid = \"offset\"\naxis = \"C\"\nsense = \"EC\"\nparameters = { um = 3 }\n");
  bench.data = bench.with("fit.csv", turned(3));
  bench.held = bench.with("held.csv", turned(5));
  const std::string wide = "[[group]]\nby = \"{}\"\ninside = {{ rms_um = 9 }}\naxis = \"B\"\n";
  REQUIRE(bench.freeze(fmt::format(fmt::runtime(wide), "magnitude")).code == 0);
  CHECK(kinds_in(bench.judge()) == std::map<std::string, std::string>{{"|B| 0", "inside"}, {"|B| 45", "inside"}});
  REQUIRE(bench.freeze(fmt::format(fmt::runtime(wide), "sign")).code == 0);
  CHECK(kinds_in(bench.judge()) == std::map<std::string, std::string>{{"B +", "inside"}, {"B -", "inside"}});
  CHECK(bench.freeze(fmt::format(fmt::runtime(wide), "run")).code == 3);
}

TEST_CASE("with the zero of each run the mean of a run is no error") {
  Bench bench;
  bench.held = bench.with(
      "held.csv", app::measured_x([](double x, int a, int run) { return app::cyclic_x(x, a, run) + 40.0 * run; },
                                  {.runs = 2, .seed = 7}));
  REQUIRE(bench.freeze(by("run")).code == 0);
  CHECK(bench.judge().code == 1);
  REQUIRE(bench.freeze("zero = \"run\"\n" + by("run")).code == 0);
  CHECK(bench.judge().code == 0);
  CHECK(bench.judge().json()["groups"][0]["rms_um"].get<double>() < 0.4);
}

/// Refused with exit 3 and these words, and no number of a residual told.
void check_refused(const Ran& r, std::initializer_list<std::string_view> words,
                   std::string_view file = __builtin_FILE(), int line = __builtin_LINE()) {
  INFO(file, ":", line);
  CHECK(r.code == 3);
  check_holds(r.all(), words, file, line);
  CHECK_FALSE(contains(r.out, "rms_um"));
}

TEST_CASE("what was changed since the freeze is named with both hashes") {
  const Bench bench;
  REQUIRE(bench.freeze(by("all")).code == 0);
  const std::string kept = content_of(bench.frozen);
  FrozenModel other = must(parse_frozen_model(kept, "f"));
  other.program_sha256 = std::string(64, '0');
  (void)bench.with("f.json", to_json(other));
  check_refused(bench.judge(), {"the program has changed", "000000", must(running_program_sha256())});
  (void)bench.with("f.json", kept);
  (void)bench.with("m.toml", std::string(kTrueModel) + "\n");
  check_refused(bench.judge(), {"m.toml", "the model has changed", sha256_hex(kTrueModel),
                                sha256_hex(std::string(kTrueModel) + "\n")});
  (void)bench.with("m.toml", kTrueModel);
  (void)bench.with("machine.toml", std::string(app::kTestMachine) + "#");
  check_refused(bench.judge(), {"the machine file has changed"});
  (void)bench.with("machine.toml", app::kTestMachine);
  CHECK(bench.judge().code == 0);
  std::string text = kept;
  text.replace(text.find("rms_um = 1"), 10, "rms_um = 9");
  (void)bench.with("f.json", text);
  check_refused(bench.judge(), {"changed after it was written"});
  (void)bench.with("f.json", kept.substr(0, kept.size() / 2));
  const Ran cut = bench.judge();
  check_refused(cut, {"f.json", "found a truncated file"});
  CHECK_FALSE(contains(cut.all(), "parse error"));
}

TEST_CASE("readings that were fitted, and those of another machine or axis, are no hold-out") {
  const Bench bench;
  REQUIRE(bench.freeze(by("all")).code == 0);
  check_refused(bench.judge(bench.data), {"fitted to this file"});
  check_refused(bench.judge(bench.with("copy.csv", "# a copy\n" + content_of(bench.data))),
                {"run 1 of EX X", "fitted to these readings"});
  check_refused(bench.judge(bench.with("other.csv", "# machine: lathe\n" + content_of(bench.held))),
                {"lathe", "test mill"});
  std::string y = content_of(bench.held);
  for (std::size_t at = y.find("X,EX"); at != std::string::npos; at = y.find("X,EX")) y.replace(at, 4, "Y,EY");
  y.replace(y.find("x_mm"), 4, "y_mm");
  check_refused(bench.judge(bench.with("y.csv", y)), {"axis Y"});
  const Ran twice = ran({"model", "judge", bench.frozen, bench.held, bench.held, "--json"});
  check_refused(twice, {"given twice"});
}

TEST_CASE("groups that are empty, too small or not held out are refused at their table") {
  const Bench bench;
  REQUIRE(bench.freeze("\n" + by("run", "values = [1, 2, 3]\n")).code == 0);
  check_refused(bench.judge(), {R"("line":2)", "run 3 is held out", "no reading"});
  REQUIRE(bench.freeze(by("run", "readings = 200\n")).code == 0);
  check_refused(bench.judge(), {"run 1: expected at least 200 readings", "got 82"});
  REQUIRE(bench.freeze(by("run", "values = [1]\n")).code == 0);
  check_refused(bench.judge(), {"82 of 164 readings have a different run"});
  REQUIRE(bench.freeze(by("all", "share = 0.6\n")).code == 0);
  check_refused(bench.judge(), {"0.6 of 328 readings"});
  REQUIRE(bench.freeze(by("tool")).code == 0);
  check_refused(bench.judge(), {"row 1: it has no tool"});
}

TEST_CASE("a model whose values are open is not frozen, and a freeze is not overwritten unasked") {
  Bench bench;
  REQUIRE(bench.freeze(by("all")).code == 0);
  CHECK(bench.freeze(by("all"), {}).code == 2);
  bench.model = bench.with("open.toml", app::kStraightModel);
  const Ran r = bench.freeze(by("all"));
  CHECK(r.code == 3);
  CHECK(contains(r.messages, "fit the model to data first"));
}

// --- the logbook, as any module may keep it

std::vector<RecordedUse> kept_uses;
constexpr RecordKeeper kKeptUses{.record = [](LogRecord) {},
                                 .watch = []() -> std::unique_ptr<FileWatch> { return nullptr; },
                                 .rest = [](std::chrono::milliseconds) {},
                                 .end = []() -> std::optional<RecordsEnd> { return std::nullopt; },
                                 .uses = [](const std::vector<std::string>&) { return std::optional(kept_uses); }};

struct Quiet final : MessageSink {
  void note(std::string_view) override {}
  void warn(std::string_view) override {}
};

TEST_CASE("openings are counted, and looks before the freeze are told") {
  const Bench bench;
  REQUIRE(bench.freeze(by("all")).code == 0);
  const std::string held = sha256_hex(content_of(bench.held)), frozen = sha256_hex(content_of(bench.frozen));
  Quiet quiet;
  const auto judged = [&](std::vector<RecordedUse> uses) {
    kept_uses = std::move(uses);
    let_keep_records(&kKeptUses);
    const auto judgement = judge(quiet, bench.frozen, {bench.held}, {});
    let_keep_records(nullptr);
    return must(judgement);
  };
  CHECK(judged({}).openings->empty());
  CHECK(contains(only(judged({}).notes), "does not know this freeze"));
  const std::string before = "2000-01-01T00:00:00Z", after = "2999-01-01T00:00:00Z";
  const Judgement one = judged({{1, before, "measurement", "", "input", held},
                                {2, before, "diagnosis", "model compare", "input", held},
                                {3, before, "model", "model freeze", "output", frozen},
                                {3, before, "export", "export", "output", held},
                                {4, after, "test", "model judge", "input", frozen},
                                {4, after, "test", "model judge", "input", held},
                                {5, after, "test", "model judge", "input", held},
                                {6, after, "diagnosis", "model compare", "input", held}});
  REQUIRE(one.openings->size() == 2);
  CHECK(one.openings->back().number == 5);
  CHECK(one.notes.empty());
  CHECK(only(*one.seen).number == 2);
}

}  // namespace
}  // namespace ecs::commissioning
