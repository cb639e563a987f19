#include "kinematics/joint_terms.hpp"

namespace ecs::kinematics {
namespace {

void add_translations(JointTable& table, Joint moving) {
  for (const Axis direction : kAllAxes)
    table.rows[table.count++] = {direction, moving, static_cast<Sense>(direction), false, Axis::X, 1};
}

/// ε × L: (ε × L)_{i+1} = −ε_i L_{i+2}, (ε × L)_{i+2} = ε_i L_{i+1}.
void add_rotations(JointTable& table, Joint moving) {
  for (const Sense sense : {Sense::EA, Sense::EB, Sense::EC}) {
    const std::size_t about = ecs::index_of(ecs::direction_of(sense));
    for (const Axis observed : kAllAxes) {
      const std::size_t o = ecs::index_of(observed);
      if (o == about) continue;
      const auto lever = static_cast<Axis>(3 - about - o);
      const auto sign = static_cast<std::int8_t>(o == (about + 1) % kAxes ? -1 : 1);
      table.rows[table.count++] = {observed, moving, sense, true, lever, sign};
    }
  }
}

std::size_t place_of(const JointChain& chain, Joint joint) {
  std::size_t place = 0;
  while (place < chain.count && chain.joints[place].joint != joint) ++place;
  return place;
}

}  // namespace

JointTable terms_of(const JointChain& chain) {
  JointTable table;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const auto joint = static_cast<Joint>(j);
    if (!chain.has(joint)) continue;
    add_translations(table, joint);
    add_rotations(table, joint);
  }
  for (const SquarenessTerm& term :
       {SquarenessTerm{Axis::X, Component::C0Y, Axis::Y, -1}, SquarenessTerm{Axis::X, Component::B0Z, Axis::Z, 1},
        SquarenessTerm{Axis::Y, Component::A0Z, Axis::Z, -1}})
    if (chain.has(joint_of(term.observed)) && chain.has(joint_of(term.lever)))
      table.squareness[table.squareness_count++] = term;
  return table;
}

bool is_beyond(const JointChain& chain, Joint b, Joint other, CurveKind curves) {
  const std::size_t place_b = place_of(chain, b), place_other = place_of(chain, other);
  if (place_b == chain.count || place_other == chain.count) return false;
  if (place_b != place_other) return place_other > place_b;
  const bool workpiece = chain.joints[place_b].carries_workpiece;
  return is_rotary(b) ? !workpiece : workpiece && curves == CurveKind::carriage;
}

TermTable as_linear_terms(const JointChain& chain, CurveKind curves) {
  TermTable out;
  const JointTable table = terms_of(chain);
  for (std::size_t i = 0; i < table.count; ++i) {
    const JointTerm& row = table.rows[i];
    out.rows[out.count++] = {row.observed,
                             curve_of(row.sense, direction_of(row.moving)),
                             row.has_lever,
                             row.lever,
                             row.has_lever && is_beyond(chain, row.moving, joint_of(row.lever), curves),
                             row.sign};
  }
  for (std::size_t i = 0; i < table.squareness_count; ++i) {
    const SquarenessTerm& row = table.squareness[i];
    out.rows[out.count++] = {row.observed, row.component, true, row.lever, true, row.sign};
  }
  return out;
}

}  // namespace ecs::kinematics
