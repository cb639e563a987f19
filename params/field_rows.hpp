// How a row of the field table is built, for the files that hold the rows.
#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "params/fields.hpp"

namespace ecs::params {

/// What a row says about itself, apart from its type and its place in UnitParameters.
struct Words {
  std::string key;
  Group group;
  std::string help;
  std::string thesis_name = {};
};

struct Range {
  double least;
  double most;
  bool zero_allowed = true;
};

inline Field row(Words words, FieldType type) {
  Field field;
  field.key = std::move(words.key);
  field.group = words.group;
  field.type = type;
  field.help = std::move(words.help);
  field.thesis_name = std::move(words.thesis_name);
  return field;
}

/// `member` gives the place in a UnitParameters, const or not: [](auto& p) -> auto& { return p.loop_period_us; }.
template <class Member>
void stored_in(Field& field, Member member) {
  field.get = [member](const UnitParameters& p) { return static_cast<double>(member(p)); };
  field.put = [member](UnitParameters& p, double value) {
    using Value = std::remove_reference_t<decltype(member(p))>;
    member(p) = static_cast<Value>(value);
  };
}

template <class Member>
Field number(Words words, std::string unit, Range range, Member member) {
  Field field = row(std::move(words), FieldType::number);
  field.unit = std::move(unit);
  field.least = range.least;
  field.most = range.most;
  field.zero_allowed = range.zero_allowed;
  stored_in(field, member);
  return field;
}

template <class Member>
Field integer(Words words, Range range, Member member) {
  Field field = number(std::move(words), "", range, member);
  field.type = FieldType::integer;
  return field;
}

template <class Member>
Field truth(Words words, Member member) {
  Field field = row(std::move(words), FieldType::truth);
  field.most = 1.0;
  stored_in(field, member);
  return field;
}

/// @param choices  in the order of the enumeration
template <class Member>
Field choice(Words words, std::vector<std::string> choices, Member member) {
  Field field = row(std::move(words), FieldType::choice);
  field.most = static_cast<double>(choices.size() - 1);
  field.choices = std::move(choices);
  stored_in(field, member);
  return field;
}

}  // namespace ecs::params
