#include "core/terms.hpp"

namespace ecs {
namespace {

void add(TermTable& table, const Term& term) noexcept { table.rows[table.count++] = term; }

/// ε × L: for a rotation about `about`, the two directions it moves the tool in.
/// EA: E_Y −= EA·L_Z, E_Z += EA·L_Y;  EB: E_X += EB·L_Z, E_Z −= EB·L_X;  EC: E_X −= EC·L_Y, E_Y += EC·L_X.
void add_rotation(TermTable& table, const Chain& chain, Component component, CurveKind curves) noexcept {
  const Axis b = moving_axis(component);
  const std::size_t about = index_of(direction_of(sense_of(component)));
  for (const Axis observed : kAllAxes) {
    if (index_of(observed) == about) continue;
    const std::size_t lever = 3 - about - index_of(observed);
    const bool cyclic = index_of(observed) == (about + 1) % 3;  // (ε × L)_{i+1} = −ε_i L_{i+2}
    const Axis lever_axis = static_cast<Axis>(lever);
    const bool own = lever_axis == b && curves == CurveKind::measured;
    add(table, {observed, component, true, lever_axis, is_lever(chain, b, lever_axis) && !own,
                static_cast<std::int8_t>(cyclic ? -1 : 1)});
  }
}

/// C0Y: E_X −= C0Y·Y;  B0Z: E_X += B0Z·Z;  A0Z: E_Y −= A0Z·Z.
void add_squareness(TermTable& table, const Chain& chain, std::int8_t sign_of_c0y, std::int8_t sign_of_a0z) noexcept {
  const auto pair = [&](Axis observed, Component c, Axis lever, std::int8_t sign) {
    if (chain.has(observed) && chain.has(lever)) add(table, {observed, c, true, lever, true, sign});
  };
  pair(Axis::X, Component::C0Y, Axis::Y, sign_of_c0y);
  pair(Axis::X, Component::B0Z, Axis::Z, 1);
  pair(Axis::Y, Component::A0Z, Axis::Z, sign_of_a0z);
}

void add_translations(TermTable& table, Axis moving) noexcept {
  for (const Axis direction : kAllAxes)
    add(table, {direction, curve_of(static_cast<Sense>(direction), moving), false, Axis::X, false, 1});
}

TermTable iso_terms(const Chain& chain, CurveKind curves) noexcept {
  TermTable table;
  for (const Axis moving : kAllAxes) {
    if (!chain.has(moving)) continue;
    add_translations(table, moving);
    for (const Sense s : {Sense::EA, Sense::EB, Sense::EC}) add_rotation(table, chain, curve_of(s, moving), curves);
  }
  add_squareness(table, chain, -1, -1);
  return table;
}

/// Rows common to the printed equations (20)-(28), then those of one chain.
std::optional<TermTable> printed_terms(const Chain& chain) noexcept {
  TermTable table;
  for (const Axis moving : kAllAxes) add_translations(table, moving);
  const auto row = [&](Axis observed, Component c, Axis lever, std::int8_t sign) {
    add(table, {observed, c, true, lever, true, sign});
  };
  using enum Component;
  row(Axis::X, EBX, Axis::Z, 1);
  row(Axis::X, EBY, Axis::Z, 1);
  row(Axis::Y, EAX, Axis::Z, 1);
  row(Axis::Y, EAY, Axis::Z, 1);
  if (chain == chain_of("TXYZ")) {
    row(Axis::X, ECX, Axis::Y, 1);
    row(Axis::Z, EAX, Axis::Y, -1);
  } else if (chain == chain_of("XTYZ")) {
    row(Axis::X, ECX, Axis::Y, 1);
    row(Axis::Y, ECX, Axis::X, -1);
    row(Axis::Z, EAX, Axis::Y, -1);
    row(Axis::Z, EBX, Axis::X, -1);
  } else if (chain == chain_of("XYTZ")) {
    row(Axis::X, ECY, Axis::Y, 1);
    row(Axis::Y, ECX, Axis::X, -1);
    row(Axis::Z, EBX, Axis::X, -1);
    row(Axis::Z, EBY, Axis::X, -1);
    row(Axis::Z, EAY, Axis::Y, -1);
  } else {
    return std::nullopt;
  }
  add_squareness(table, chain, 1, 1);
  return table;
}

bool in_plane(Axis axis, Plane plane) noexcept { return axis == plane.first || axis == plane.second; }

bool in_plane(const Term& term, Plane plane) noexcept {
  if (!in_plane(term.observed, plane)) return false;
  if (term.has_lever && !in_plane(term.lever, plane)) return false;
  return is_squareness(term.component) || in_plane(moving_axis(term.component), plane);
}

}  // namespace

std::optional<TermTable> terms_of(const Chain& chain, Convention convention, CurveKind curves) noexcept {
  if (convention == Convention::as_printed) return printed_terms(chain);
  return iso_terms(chain, curves);
}

Vector3 tool_error_um(const TermTable& terms, const ComponentValues& values, const Vector3& position_mm,
                      const MeasurementLines& lines, const Vector3& tool_offset_mm) noexcept {
  Vector3 error_um{};
  for (const Term& term : terms) {
    double lever = 1.0;
    if (term.has_lever) {
      const std::size_t l = index_of(term.lever);
      double lever_mm = 0.0;
      if (term.uses_coordinate) lever_mm += position_mm[l];
      if (!is_squareness(term.component)) {
        lever_mm += tool_offset_mm[l];
        if (term.uses_coordinate) lever_mm -= lines[index_of(moving_axis(term.component))][l];
      }
      lever = lever_mm / 1000.0;  // um/m · m
    }
    error_um[index_of(term.observed)] += term.sign * values[index_of(term.component)] * lever;
  }
  return error_um;
}

TermTable terms_in_scope(const TermTable& terms, const Chain& chain, Scope scope, Plane plane) noexcept {
  TermTable kept;
  for (const Term& term : terms) {
    if (!chain.has(term.observed)) continue;
    const bool keep = scope == Scope::volumetric || (scope == Scope::planar && in_plane(term, plane)) ||
                      (scope == Scope::linear && is_positioning(term.component) && !term.has_lever);
    if (keep) add(kept, term);
  }
  return kept;
}

ComponentSet components_needed(const TermTable& terms, bool with_tool_offset) noexcept {
  ComponentSet set;
  for (const Term& term : terms)
    if (!term.has_lever || term.uses_coordinate || with_tool_offset) set.has[index_of(term.component)] = true;
  return set;
}

}  // namespace ecs
