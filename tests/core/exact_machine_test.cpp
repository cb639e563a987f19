// The term table against a machine of exact matrices: agreement to second order for every chain.
#include "tests/support/exact_machine.hpp"

#include "core/terms.hpp"
#include "tests/support/random_values.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

MachineErrors random_errors() {
  MachineErrors errors;
  for (double& value : errors.values) value = number_up_to(1000.0);
  errors.lines_mm = lines_up_to(800.0);
  errors.tool_offset_mm = vector_up_to(300.0);
  return errors;
}

MachineErrors scaled(MachineErrors errors, double by) {
  for (double& value : errors.values) value *= by;
  return errors;
}

double norm(const Vector3& v) { return std::hypot(v[0], v[1], v[2]); }
Vector3 difference(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Vector3 without_absent(const std::string& chain, Vector3 position_mm) {
  for (const Axis a : kAllAxes)
    if (!contains(chain, letter_of(a))) position_mm[index_of(a)] = 0.0;
  return position_mm;
}

/// Two axes that do not both exist have no squareness.
MachineErrors without_absent(const std::string& chain, MachineErrors errors) {
  const auto lacks = [&](char axis) { return !contains(chain, axis); };
  if (lacks('X') || lacks('Y')) errors.values[index_of(Component::C0Y)] = 0.0;
  if (lacks('X') || lacks('Z')) errors.values[index_of(Component::B0Z)] = 0.0;
  if (lacks('Y') || lacks('Z')) errors.values[index_of(Component::A0Z)] = 0.0;
  return errors;
}

/// Exact minus linear at one pose [um].
Vector3 nonlinear_rest_um(const std::string& chain, const MachineErrors& errors, const Vector3& position_mm) {
  const auto terms = terms_of(*chain_of(chain), Convention::iso, CurveKind::carriage);
  const Vector3 linear = tool_error_um(*terms, errors.values, position_mm, errors.lines_mm, errors.tool_offset_mm);
  return difference(exact_error_um(chain, errors, position_mm), linear);
}

}  // namespace

TEST_CASE("there are 48 chains of one to three axes") { CHECK(every_chain().size() == 48); }

TEST_CASE("halving every error quarters what the linear model leaves of the exact machine, for every chain") {
  CHECK(rc::check([] {
    const MachineErrors any_errors = random_errors();
    const Vector3 anywhere_mm = vector_up_to(2000.0);
    for (const std::string& chain : every_chain()) {
      const Vector3 position_mm = without_absent(chain, anywhere_mm);
      const MachineErrors errors = without_absent(chain, any_errors);
      const double whole_um = norm(nonlinear_rest_um(chain, errors, position_mm));
      const double half_um = norm(nonlinear_rest_um(chain, scaled(errors, 0.5), position_mm));
      // third order leans the ratio a little; a first-order term with the wrong sign or lever would leave 0.5
      if (half_um > 0.27 * whole_um + 1e-5) RC_FAIL(chain + " is not right to first order");
      RC_ASSERT(whole_um < 30.0);  // (1 mrad)² · 10 m
    }
  }));
}

TEST_CASE("a lathe is XTYZ without X: the same as TYZ") {
  CHECK(rc::check([] {
    MachineErrors errors = random_errors();
    for (const Component c : {Component::EXX, Component::EYX, Component::EZX, Component::EAX, Component::EBX,
                              Component::ECX, Component::C0Y, Component::B0Z})
      errors.values[index_of(c)] = 0.0;
    const Vector3 position_mm{0.0, number_up_to(500.0), number_up_to(500.0)};
    const auto lathe = terms_of(*chain_of("TYZ"), Convention::iso, CurveKind::carriage);
    const auto mill = terms_of(*chain_of("XTYZ"), Convention::iso, CurveKind::carriage);
    const Vector3 as_lathe = tool_error_um(*lathe, errors.values, position_mm, errors.lines_mm, errors.tool_offset_mm);
    const Vector3 as_mill = tool_error_um(*mill, errors.values, position_mm, errors.lines_mm, errors.tool_offset_mm);
    RC_ASSERT(norm(difference(as_lathe, as_mill)) < 1e-9);
    RC_ASSERT(norm(difference(as_lathe, exact_error_um("TYZ", errors, position_mm))) < 10.0);
    RC_ASSERT(restricted_to(*chain_of("XTYZ"), {false, true, true}).axis_count() == 2);
  }));
}

TEST_CASE("with A and C rotations, θxy and θyz turned round, the printed equations are those of the exact machine") {
  for (const std::string chain : {"TXYZ", "XTYZ", "XYTZ"}) {
    CAPTURE(chain);
    CHECK(rc::check([&] {
      MachineErrors errors = random_errors();
      errors.lines_mm = {};
      errors.tool_offset_mm = {};
      for (double& value : errors.values) value *= 0.1;
      const Vector3 position_mm = vector_up_to(1000.0);

      ComponentValues turned = errors.values;
      for (const char* name : {"EAX", "EAY", "EAZ", "ECX", "ECY", "ECZ", "C0Y", "A0Z"})
        turned[index_of(*component_of(name))] *= -1.0;
      const auto printed = terms_of(*chain_of(chain), Convention::as_printed, CurveKind::carriage);
      const Vector3 rest_um =
          difference(exact_error_um(chain, errors, position_mm), tool_error_um(*printed, turned, position_mm, {}, {}));

      const double ecy_x_um = errors.values[index_of(Component::ECY)] * position_mm[0] / 1000.0;
      const double missing_in_y_um = chain == "XYTZ" ? ecy_x_um : 0.0;          // equation (27) lacks θz(y)·X
      RC_ASSERT(norm(difference(rest_um, {0.0, missing_in_y_um, 0.0})) < 0.3);  // (0.1 mrad)² · some metres
    }));
  }
}

TEST_CASE("the universal sum (29)-(31) cannot be made TXYZ by zeroing data: it holds ECX·X in E_Y") {
  // every row of the three printed sets once: what equations (29)-(31) print
  TermTable universal;
  for (const char* chain : {"TXYZ", "XTYZ", "XYTZ"}) {
    const TermTable printed = *terms_of(*chain_of(chain), Convention::as_printed, CurveKind::carriage);
    for (const Term& term : printed)
      if (std::find(universal.begin(), universal.end(), term) == universal.end())
        universal.rows[universal.count++] = term;
  }

  MachineErrors mill;
  mill.values[index_of(Component::ECX)] = 100.0;  // needed: it acts on E_X through Y
  const Vector3 position_mm{-2000.0, -700.0, -500.0};
  const Vector3 exact_um = exact_error_um("TXYZ", mill, position_mm);
  CHECK(exact_um[0] == Approx(100.0 * 0.7).epsilon(0.001));
  CHECK(std::abs(exact_um[1]) < 0.01);

  ComponentValues printed_sign = mill.values;
  printed_sign[index_of(Component::ECX)] *= -1.0;
  const Vector3 universal_um = tool_error_um(universal, printed_sign, position_mm, {}, {});
  CHECK(universal_um[0] == Approx(70.0));
  CHECK(universal_um[1] == Approx(-200.0));  // ECX·X, which a TXYZ machine does not have
}
