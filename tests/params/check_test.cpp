#include "params/check.hpp"

#include <limits>

#include "params/fields.hpp"
#include "params/parameters_toml.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::params;

namespace {

using Settings = std::vector<std::pair<const char*, const char*>>;

UnitParameters with(const Settings& settings) {
  UnitParameters parameters;
  for (const auto& [key, text] : settings) REQUIRE(set(parameters, key, text));
  return parameters;
}

/// The finding that names `key`, if there is exactly one.
std::optional<Finding> finding_on(const UnitParameters& parameters, std::string_view key,
                                  const Machine* machine = nullptr) {
  std::vector<Finding> found;
  for (const Finding& f : check(parameters, machine))
    if (f.keys.front() == key) found.push_back(f);
  if (found.size() != 1) return std::nullopt;
  return found.front();
}

void expect(Severity severity, const Settings& settings, std::string_view key, std::string_view words,
            const Machine* machine = nullptr) {
  CAPTURE(key);
  const auto finding = must(finding_on(with(settings), key, machine));
  CHECK(finding.severity == severity);
  CAPTURE(finding.message);
  CHECK(contains(finding.message, words));
  CHECK(contains(to_text({finding}), key));
}

constexpr Severity kError = Severity::error;
constexpr Severity kWarning = Severity::warning;

Machine mill() { return must(read_machine("tests/data/params/mill_machine.toml")).machine; }

}  // namespace

TEST_CASE("the defaults and the sample of the mill have no findings") {
  CHECK(to_text(check(UnitParameters{})) == "");
  const auto file = must(read_parameters("tests/data/params/mill_unit.toml"));
  const Machine machine = mill();
  CHECK(to_text(check(file.parameters, &machine)) == "");
}

TEST_CASE("values that no file could hold, as from a corrupt unit, are found with their range") {
  UnitParameters p{.configuration = {'X', 'Y', 'Z', 'Q', 0},
                   .plane = {Axis::X, Axis::X},
                   .loop_period_us = std::numeric_limits<double>::quiet_NaN()};
  p.axes[0].datum.approach_speed_mm_min = 0.0;
  p.axes[1].compensation_polarity = 3;
  p.axes[2].datum.kind = static_cast<DatumKind>(7);
  for (const std::string key :
       {"configuration.chain", "compensation.loop_period_us", "compensation.plane",
        "axis.X.datum.approach_speed_mm_min", "axis.Y.compensation_polarity", "axis.Z.datum.kind"}) {
    CAPTURE(key);
    const auto finding = finding_on(p, key);
    CAPTURE(to_text(check(p)));
    REQUIRE(finding.has_value());
    CHECK(finding->severity == kError);
    CHECK(finding->message.starts_with("expected "));
  }
}

TEST_CASE("each finding names its key, how grave it is and what is wrong") {
  const Settings only_x{{"configuration.chain", "TX"}, {"configuration.axes", "X"}};
  const Settings no_z{{"configuration.chain", "TXY"}, {"configuration.axes", "XY"}, {"compensation.scope", "planar"}};
  struct Expected {
    Severity severity;
    const char* key;
    const char* words;
    Settings settings;  ///< beside those of the key itself
    const char* value = nullptr;
  };
  const Expected all[] = {
      {kError, "configuration.chain", "has no letter Z", {}, "TXY"},
      {kWarning, "configuration.axes", "X is in the kinematic chain", {{"compensation.scope", "linear"}}, "YZ"},
      {kError, "compensation.scope", "choose planar", {{"configuration.chain", "TXY"}, {"configuration.axes", "XY"}}},
      {kError, "compensation.scope", "choose linear", only_x},
      {kError, "compensation.scope", "planar scope needs two axes", only_x, "planar"},
      {kError,
       "compensation.plane",
       "axis Y, which is not present",
       {{"configuration.chain", "TXZ"}, {"configuration.axes", "XZ"}, {"compensation.scope", "planar"}},
       "XY"},
      {kError, "compensation.convention", "choose iso", {{"configuration.chain", "XYZT"}}, "as_printed"},
      {kError, "axis.Y.deadband_um", "less than one position count", {{"axis.Y.position_scale_um_per_count", "-6"}}},
      {kWarning, "axis.Y.deadband_um", "more than 1 mm", {}, "1000.5"},
      {kError, "axis.X.output_limit_um", "3276 um or less", {}, "3276.71"},
      {kWarning, "axis.X.output_limit_um", "disables the compensation", {}, "0"},
      {kError, "axis.X.output_limit_um", "less than one D/A count", {}, "0.09"},
      // 10,000 mm/min = 166.67 mm/s; at 1 um per mm the output must change by 166.67 um/s
      {kWarning, "axis.Z.output_slew_um_per_s", "at least 167 um/s", {}, "166"},
      {kWarning, "axis.Z.output_slew_um_per_s", "has no effect", {}, "2000000"},
      {kWarning, "compensation.loop_period_us", "too short", {}, "100"},
      {kError, "compensation.squareness.B0Z_um_per_m", "wrong unit", {}, "-1000.5"},
      {kWarning, "compensation.squareness.B0Z_um_per_m", "does not use B0Z", {{"compensation.scope", "linear"}}, "10"},
      {kWarning, "compensation.squareness.B0Z_um_per_m", "does not use B0Z", {{"compensation.scope", "planar"}}, "10"},
      {kWarning, "compensation.angular_scale", "switches every angular", {}, "0"},
      {kWarning, "compensation.angular_scale", "inverts the sign", {}, "-1"},
      {kWarning, "axis.Z.measurement_line_mm.x", "not present", no_z, "5"},
      {kWarning, "axis.X.measurement_line_mm.z", "not present", no_z, "5"},
      {kError, "axis.X.datum.switch_finally_active", "leaving the switch", {}, "true"},
      {kError, "axis.X.datum.switch_finally_active", "backing off", {{"axis.X.datum.kind", "allen_bradley"}}, "true"},
      {kError, "axis.X.datum.switch_finally_active", "still on the switch", {{"axis.X.datum.kind", "siemens"}}},
      {kWarning,
       "axis.X.datum.switch_initially_active",
       "switch_polarity = -1",
       {{"axis.X.datum.switch_finally_active", "true"}},
       "true"},
      {kWarning, "axis.X.datum.approach_speed_mm_min", "rapid", {}, "8000"},
  };
  for (Expected one : all) {
    if (one.value != nullptr) one.settings.emplace_back(one.key, one.value);
    expect(one.severity, one.settings, one.key, one.words);
  }
}

TEST_CASE("what is just within a limit is not found") {
  for (const char* chain : {"TXYZ", "XTYZ", "XYTZ"})
    CHECK_FALSE(finding_on(with({{"configuration.chain", chain}, {"compensation.convention", "as_printed"}}),
                           "compensation.convention"));
  CHECK_FALSE(finding_on(with({{"axis.X.output_limit_um", "3276.7"}}), "axis.X.output_limit_um"));
  CHECK_FALSE(finding_on(with({{"axis.Z.output_slew_um_per_s", "167"}}), "axis.Z.output_slew_um_per_s"));
  const char* const key = "compensation.squareness.B0Z_um_per_m";
  CHECK_FALSE(finding_on(with({{key, "10"}, {"compensation.scope", "planar"}, {"compensation.plane", "XZ"}}), key));
  const char* const last = "axis.X.datum.switch_finally_active";
  CHECK_FALSE(finding_on(with({{"axis.X.datum.kind", "siemens"}, {last, "true"}}), last));
}

TEST_CASE("parameters that contradict the machine they are meant for are found") {
  const Machine machine = mill();
  expect(kError, {{"configuration.chain", "XTYZ"}}, "configuration.chain", "machine file states \"TXYZ\"", &machine);
  expect(kError, {{"configuration.axes", "XY"}, {"compensation.scope", "planar"}}, "configuration.axes",
         "axis Z is absent here", &machine);
  expect(kError, {{"axis.X.transducer", "resolver"}}, "axis.X.transducer", "the machine file states \"encoder\"",
         &machine);
  expect(kWarning, {{"axis.X.position_scale_um_per_count", "0.5"}}, "axis.X.position_scale_um_per_count",
         "machine file states 1 um", &machine);
  expect(kError, {{"axis.X.datum.reference_position_mm", "1"}}, "axis.X.datum.reference_position_mm",
         "outside the machine's travel of -4100 to 0 mm", &machine);
  expect(kWarning, {{"axis.X.datum.reference_position_mm", "-1"}}, "axis.X.datum.reference_position_mm",
         "the map is shifted", &machine);
}

TEST_CASE("a direction away from a datum at the end of the travel is found, one inside it may be either") {
  Machine machine = mill();
  machine.axes[0]->datum_mm = 0.0;
  machine.axes[0]->travel_mm = {-4100.0, 0.0};
  expect(kWarning, {{"axis.X.datum.approach_direction", "reverse"}}, "axis.X.datum.approach_direction",
         "it leads away from the datum at the upper end", &machine);
  machine.axes[0]->travel_mm = {-4100.0, 500.0};
  const UnitParameters inside = with({{"axis.X.datum.approach_direction", "reverse"}});
  CHECK(!contains(to_text(check(inside, &machine)), "approach_direction"));
}

TEST_CASE("a null offset larger than the travel is an error") {
  Machine machine = mill();
  machine.axes[0]->travel_mm = {-50.0, 0.0};
  expect(kError, {{"axis.X.datum.null_offset_mm", "-50.5"}}, "axis.X.datum.null_offset_mm", "whole travel of 50 mm",
         &machine);
}

TEST_CASE("a rack holds 8 encoder or 5 resolver modules, and 5 memory modules beside three resolvers") {
  CHECK(rack_holds(1, 8, 0));
  CHECK_FALSE(rack_holds(1, 9, 0));
  CHECK(rack_holds(1, 0, 5));
  CHECK_FALSE(rack_holds(1, 0, 6));
  CHECK_FALSE(rack_holds(2, 0, 5));
  CHECK(rack_holds(5, 0, 3));
  CHECK_FALSE(rack_holds(6, 1, 0));
}

TEST_CASE("more memory modules than a rack holds are found twice: by their range and by the slots") {
  UnitParameters p;
  p.memory_modules = 6;
  const auto findings = check(p);
  REQUIRE(findings.size() == 2);
  for (const Finding& f : findings) CHECK(f.keys.front() == "compensation.memory_modules");
  CHECK(contains(findings[1].message, "one rack has no space for 6 memory"));
}

TEST_CASE("all findings come at once, errors first") {
  const auto findings = check(with({{"axis.X.deadband_um", "2000"},
                                    {"axis.Y.output_limit_um", "9000"},
                                    {"axis.Z.datum.kind", "siemens"},
                                    {"compensation.angular_scale", "0"}}));
  REQUIRE(findings.size() == 4);
  CHECK(has_errors(findings));
  CHECK(findings[0].severity == kError);
  CHECK(findings[1].severity == kError);
  CHECK(findings[2].severity == kWarning);
  CHECK(findings[3].severity == kWarning);
}

TEST_CASE("axes that do not exist are not judged") {
  const auto findings = check(with({{"configuration.chain", "TX"},
                                    {"configuration.axes", "X"},
                                    {"compensation.scope", "linear"},
                                    {"axis.Z.datum.kind", "siemens"},
                                    {"axis.Z.deadband_um", "0"}}));
  CHECK(to_text(findings) == "");
}

TEST_CASE("a file without its closing line is remarked on, an axis without keys is an error, and defaults are named") {
  const auto cut = must(parse_parameters("[axis.X]\ndeadband_um = 3\n[axis.Z]\ntransducer = \"resolver\"\n", "p.toml"));
  const auto findings = check_file(cut);
  REQUIRE(findings.size() == 2);
  CHECK(findings[0].severity == Severity::error);
  CHECK(findings[0].keys.front() == "axis.Y.transducer");
  CHECK(contains(findings[0].message, "no [axis.Y]"));
  CHECK(findings[1].severity == Severity::warning);
  CHECK(contains(findings[1].message, "# end of parameters"));
  const auto taken = defaults_taken(cut);
  CHECK(taken.size() == cut.defaulted.size());
  CHECK(std::find(taken.begin(), taken.end(),
                  "axis.X.output_scale_counts_per_um is not given: the default 10 counts/um is used") != taken.end());
  CHECK(only(defaults_in_short(cut)).starts_with(fmt::format("{} parameters are not given", taken.size())));
  const auto whole = must(parse_parameters(parameters_toml(UnitParameters{}), "p.toml"));
  CHECK(check_file(whole).empty());
  CHECK(defaults_taken(whole).empty());
}
