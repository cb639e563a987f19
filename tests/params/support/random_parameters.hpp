// Random parameter sets whose every field lies in its range, for property tests.
#pragma once

#include <bit>
#include <cstdint>
#include <string>

#include <rapidcheck.h>

#include "params/fields.hpp"

namespace ecs::params {

/// Any number of the field's range, its ends, both zeros and a subnormal included.
inline double random_number(const Field& field) {
  const double share = static_cast<double>(*rc::gen::arbitrary<std::uint64_t>() >> 11) * 0x1p-53;
  const double inside = std::clamp(field.least + (field.most - field.least) * share, field.least, field.most);
  const double drawn = *rc::gen::element(inside, inside, inside, field.least, field.most, 0.0, -0.0, 5e-324);
  return objection_to_number(field, drawn).empty() ? drawn : field.most;
}

inline std::string random_text(const Field& field) {
  if (field.key == "configuration.chain")
    return *rc::gen::element<std::string>("TXYZ", "XTYZ", "XYTZ", "XYZT", "TX", "ZT", "YTZ", "ZXYT");
  return *rc::gen::element<std::string>("X", "Y", "Z", "XY", "XZ", "YZ", "XYZ");
}

inline double random_value(const Field& field) {
  if (field.type == FieldType::number) return random_number(field);
  const double drawn = *rc::gen::inRange(static_cast<int>(field.least), static_cast<int>(field.most) + 1);
  return objection_to_number(field, drawn).empty() ? drawn : field.most;
}

inline UnitParameters random_parameters() {
  UnitParameters parameters;
  for (const Field& field : fields()) {
    if (field.type == FieldType::text)
      RC_ASSERT(set_text(field, parameters, random_text(field)).has_value());
    else
      RC_ASSERT(set_number(field, parameters, random_value(field)).has_value());
  }
  return parameters;
}

/// Equal to the last bit, unlike ==, for which -0.0 is 0.0.
inline bool same_bits(const UnitParameters& a, const UnitParameters& b) {
  if (!(a == b)) return false;
  for (const Field& field : fields())
    if (field.type == FieldType::number &&
        std::bit_cast<std::uint64_t>(field.get(a)) != std::bit_cast<std::uint64_t>(field.get(b)))
      return false;
  return true;
}

}  // namespace ecs::params
