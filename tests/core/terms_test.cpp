// The rows of the term table: those of the rigid-body model, those of the printed thesis, those of a scope.
#include "core/terms.hpp"

#include <set>

#include "core/parameters.hpp"
#include "tests/support/random_values.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

using Rows = std::set<std::string>;

/// "+EBX·Z": sign, component, lever; rows that only a tool offset levers left out.
Rows rows(const TermTable& table, Axis observed) {
  Rows found;
  for (const Term& term : table) {
    if (term.observed != observed || (term.has_lever && !term.uses_coordinate)) continue;
    std::string text = (term.sign > 0 ? "+" : "-") + std::string(name_of(term.component));
    if (term.has_lever) text += std::string("·") + letter_of(term.lever);
    CHECK_MESSAGE(found.insert(text).second, text << " stands twice");
  }
  return found;
}

Rows with_translations(Rows expected, char observed, const std::string& axes = "XYZ") {
  for (const char moving : axes) expected.insert(std::string("+E") + observed + moving);
  return expected;
}

void check_rows(const TermTable& table, const Rows& in_x, const Rows& in_y, const Rows& in_z) {
  CHECK(rows(table, Axis::X) == with_translations(in_x, 'X'));
  CHECK(rows(table, Axis::Y) == with_translations(in_y, 'Y'));
  CHECK(rows(table, Axis::Z) == with_translations(in_z, 'Z'));
}

TermTable iso(const char* chain) { return *terms_of(*chain_of(chain), Convention::iso, CurveKind::carriage); }
TermTable printed(const char* chain) {
  return *terms_of(*chain_of(chain), Convention::as_printed, CurveKind::carriage);
}
TermTable measured(const char* chain) { return *terms_of(*chain_of(chain), Convention::iso, CurveKind::measured); }

std::set<std::string> names(const ComponentSet& set) {
  std::set<std::string> found;
  for (std::size_t c = 0; c < kComponents; ++c)
    if (set.has[c]) found.insert(std::string(kComponentNames[c]));
  return found;
}

std::set<std::string> needed(const std::string& chain, Scope scope, Plane plane = {}, Vector3 tool_offset_mm = {}) {
  UnitParameters p;
  set_configuration(p, chain);
  p.scope = scope;
  p.plane = plane;
  p.tool_offset_mm = tool_offset_mm;
  return names(components_needed(p));
}

}  // namespace

TEST_CASE("a configuration has exactly one T and each axis at most once") {
  for (const char* wrong : {"", "T", "XYZ", "TXYZT", "TXX", "TXYA", "txyz", "TX Y", "XYZTT"})
    CHECK_MESSAGE(!chain_of(wrong), wrong);
  CHECK(chain_of("TX"));
  CHECK(chain_of("ZYXT"));
}

TEST_CASE("the rows of TXYZ") {
  check_rows(iso("TXYZ"), {"+EBX·Z", "+EBY·Z", "-ECX·Y", "-C0Y·Y", "+B0Z·Z"}, {"-EAX·Z", "-EAY·Z", "-A0Z·Z"},
             {"+EAX·Y"});
}

TEST_CASE("the rows of XTYZ") {
  check_rows(iso("XTYZ"), {"+EBX·Z", "+EBY·Z", "-ECX·Y", "-C0Y·Y", "+B0Z·Z"}, {"+ECX·X", "-EAX·Z", "-EAY·Z", "-A0Z·Z"},
             {"+EAX·Y", "-EBX·X"});
}

TEST_CASE("the rows of XYTZ") {
  check_rows(iso("XYTZ"), {"+EBX·Z", "+EBY·Z", "-ECY·Y", "-C0Y·Y", "+B0Z·Z"},
             {"+ECX·X", "+ECY·X", "-EAX·Z", "-EAY·Z", "-A0Z·Z"}, {"+EAY·Y", "-EBX·X", "-EBY·X"});
}

TEST_CASE("the rows of XYZT") {
  check_rows(iso("XYZT"), {"+EBZ·Z", "-ECY·Y", "-ECZ·Y", "-C0Y·Y", "+B0Z·Z"},
             {"+ECX·X", "+ECY·X", "+ECZ·X", "-EAZ·Z", "-A0Z·Z"}, {"+EAY·Y", "+EAZ·Y", "-EBX·X", "-EBY·X", "-EBZ·X"});
}

TEST_CASE("equations (20)-(22) of the thesis, as printed") {
  check_rows(printed("TXYZ"), {"+EBX·Z", "+ECX·Y", "+EBY·Z", "+B0Z·Z", "+C0Y·Y"}, {"+EAX·Z", "+EAY·Z", "+A0Z·Z"},
             {"-EAX·Y"});
}

TEST_CASE("equations (23)-(25) of the thesis, as printed") {
  check_rows(printed("XTYZ"), {"+EBY·Z", "+EBX·Z", "+ECX·Y", "+B0Z·Z", "+C0Y·Y"},
             {"+EAX·Z", "-ECX·X", "+EAY·Z", "+A0Z·Z"}, {"-EAX·Y", "-EBX·X"});
}

TEST_CASE("equations (26)-(28) of the thesis, as printed: E_Y lacks θz(y)·X") {
  check_rows(printed("XYTZ"), {"+EBX·Z", "+EBY·Z", "+ECY·Y", "+B0Z·Z", "+C0Y·Y"},
             {"-ECX·X", "+EAX·Z", "+EAY·Z", "+A0Z·Z"}, {"-EBX·X", "-EBY·X", "-EAY·Y"});
}

TEST_CASE("the thesis prints no equations for other chains") {
  for (const std::string& chain : every_chain())
    CHECK_MESSAGE(terms_of(*chain_of(chain), Convention::as_printed, CurveKind::measured).has_value() ==
                      (chain == "TXYZ" || chain == "XTYZ" || chain == "XYTZ"),
                  chain);
}

TEST_CASE("a map of measured curves leaves the levers of the moving axis itself out") {
  check_rows(measured("TXYZ"), {"+EBX·Z", "+EBY·Z", "-ECX·Y", "-C0Y·Y", "+B0Z·Z"}, {"-EAX·Z", "-EAY·Z", "-A0Z·Z"},
             {"+EAX·Y"});
  check_rows(measured("XTYZ"), {"+EBX·Z", "+EBY·Z", "-ECX·Y", "-C0Y·Y", "+B0Z·Z"}, {"-EAX·Z", "-EAY·Z", "-A0Z·Z"},
             {"+EAX·Y"});
  check_rows(measured("XYTZ"), {"+EBX·Z", "+EBY·Z", "-C0Y·Y", "+B0Z·Z"}, {"+ECY·X", "-EAX·Z", "-EAY·Z", "-A0Z·Z"},
             {"-EBY·X"});
  check_rows(measured("XYZT"), {"-ECZ·Y", "-C0Y·Y", "+B0Z·Z"}, {"+ECY·X", "+ECZ·X", "-A0Z·Z"},
             {"+EAZ·Y", "-EBY·X", "-EBZ·X"});
}

TEST_CASE("rows are in the order of the components, then of the directions") {
  const TermTable table = iso("XYZT");
  for (std::size_t i = 1; i < table.count; ++i) {
    const Term& before = table.rows[i - 1];
    const Term& here = table.rows[i];
    CHECK(std::pair(before.component, before.observed) < std::pair(here.component, here.observed));
  }
  CHECK(table.count == kMostTerms);
}

TEST_CASE("the moving-column mill needs the seventeen components of thesis 6.2.1") {
  const std::set<std::string> thesis{"EXX", "EYX", "EZX", "EAX", "EBX", "ECX", "EYY", "EXY", "EZY",
                                     "EBY", "EAY", "EZZ", "EXZ", "EYZ", "C0Y", "B0Z", "A0Z"};
  REQUIRE(thesis.size() == 17);
  CHECK(needed("TXYZ", Scope::volumetric) == thesis);
}

TEST_CASE("a tool offset along Z makes the mill need EAZ and EBZ too, one along X all 21") {
  const auto along_z = needed("TXYZ", Scope::volumetric, {}, {0.0, 0.0, 150.0});
  CHECK(along_z.size() == 19);
  CHECK(along_z.count("EAZ") + along_z.count("EBZ") == 2);
  CHECK(needed("TXYZ", Scope::volumetric, {}, {10.0, 0.0, 150.0}).size() == 21);
}

TEST_CASE("the linear scope is the positioning of each axis") {
  CHECK(needed("TXYZ", Scope::linear) == std::set<std::string>{"EXX", "EYY", "EZZ"});
  CHECK(needed("TX", Scope::linear) == std::set<std::string>{"EXX"});
  CHECK(needed("XYTZ", Scope::linear, {}, {0.0, 0.0, 150.0}) == std::set<std::string>{"EXX", "EYY", "EZZ"});
}

TEST_CASE("the planar scope is what acts in its plane and levers over it") {
  CHECK(needed("TXYZ", Scope::planar, {Axis::X, Axis::Y}) ==
        std::set<std::string>{"EXX", "EYX", "ECX", "EXY", "EYY", "C0Y"});
  CHECK(needed("TXYZ", Scope::planar, {Axis::Z, Axis::X}) ==
        std::set<std::string>{"EXX", "EZX", "EBX", "EXZ", "EZZ", "B0Z"});
  CHECK(needed("XYTZ", Scope::planar, {Axis::X, Axis::Y}) ==
        std::set<std::string>{"EXX", "EYX", "EXY", "EYY", "ECY", "C0Y"});
}

TEST_CASE("one axis has its positioning only, a lathe its plane") {
  CHECK(needed("TX", Scope::volumetric) == std::set<std::string>{"EXX"});
  CHECK(needed("TYZ", Scope::volumetric) == std::set<std::string>{"EYY", "EZY", "EAY", "EYZ", "EZZ", "A0Z"});
}

TEST_CASE("a lathe may be configured as XTYZ with X absent, printed equations included") {
  UnitParameters lathe;
  set_configuration(lathe, "XTYZ");
  lathe.axis_present = {false, true, true};
  CHECK(names(components_needed(lathe)) == needed("TYZ", Scope::volumetric));
  lathe.convention = Convention::as_printed;
  CHECK(names(components_needed(lathe)) == needed("TYZ", Scope::volumetric));
}

TEST_CASE("with the printed equations, too, an axis that does not exist is no lever") {
  UnitParameters p;
  set_configuration(p, "XYTZ");
  p.convention = Convention::as_printed;
  p.axis_present = {false, true, true};
  CHECK(names(components_needed(p)) == std::set<std::string>{"EYY", "EZY", "EAY", "EYZ", "EZZ", "A0Z"});  // not EBY·X
  p.axis_present = {true, false, true};
  CHECK(names(components_needed(p)) == std::set<std::string>{"EXX", "EZX", "EBX", "EXZ", "EZZ", "B0Z"});  // not C0Y·Y
}

TEST_CASE("levers count from the measurement line, squareness from zero, and the tool offset reaches angles only") {
  ComponentValues values{};
  values[index_of(Component::EBX)] = 50.0;
  values[index_of(Component::B0Z)] = 10.0;
  MeasurementLines lines{};
  lines[index_of(Axis::X)] = {0.0, 0.0, -200.0};
  const Vector3 error_um = tool_error_um(iso("TXYZ"), values, {-1000.0, 0.0, -800.0}, lines, {0.0, 0.0, -100.0});
  // 50 um/m · (−0.8 + 0.2 − 0.1) m + 10 um/m · −0.8 m
  CHECK(error_um[0] == Approx(-35.0 - 8.0));
}

TEST_CASE("component names read back, and say what they are") {
  for (std::size_t c = 0; c < kComponents; ++c) CHECK(component_of(kComponentNames[c]) == static_cast<Component>(c));
  CHECK(!component_of("EXA"));
  CHECK(!component_of("exx"));
  CHECK(!component_of(""));
  CHECK(!sense_named(""));
  CHECK(is_positioning(Component::EYY));
  CHECK(is_straightness(Component::EYX));
  CHECK(is_angular(Component::ECZ));
  CHECK(!is_angular(Component::C0Y));
  CHECK(unit_of(Component::A0Z) == "um/m");
  CHECK(unit_of(Component::EZX) == "um");
  for (std::size_t c = 0; c < kCurves; ++c) {
    const auto component = static_cast<Component>(c);
    CHECK(curve_of(sense_of(component), moving_axis(component)) == component);
    CHECK(sense_named(name_of(sense_of(component))) == sense_of(component));
  }
}

TEST_CASE("squareness lies among the parameters, each component in its place") {
  UnitParameters parameters;
  squareness_um_per_m(parameters, Component::C0Y) = 16.0;
  squareness_um_per_m(parameters, Component::B0Z) = -38.8;
  squareness_um_per_m(parameters, Component::A0Z) = -66.93;
  CHECK(parameters.C0Y_um_per_m == 16.0);
  CHECK(parameters.B0Z_um_per_m == -38.8);
  CHECK(parameters.A0Z_um_per_m == -66.93);
  const UnitParameters& same = parameters;
  CHECK(squareness_um_per_m(same, Component::C0Y) == 16.0);
  CHECK(squareness_um_per_m(same, Component::B0Z) == -38.8);
  CHECK(squareness_um_per_m(same, Component::A0Z) == -66.93);
}
