#include "commissioning/unit/parameters_view.hpp"

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "params/fields.hpp"

namespace ecs::commissioning {
namespace {

Json value_of(const params::Field& field, const UnitParameters& parameters) {
  const auto number = params::number_of(field, parameters);
  if (field.type == params::FieldType::truth) return number && *number != 0.0;
  if (field.type == params::FieldType::integer && number) return static_cast<long long>(*number);
  if (field.type == params::FieldType::number) return number_or_null(number);
  return params::text_of(field, parameters);
}

bool is_shown(const params::Field& field, const UnitParameters& parameters) {
  return !field.axis || parameters.axis_present[index_of(*field.axis)];
}

}  // namespace

Cell parameters_cell(const UnitParameters& parameters) {
  Json object = Json::object();
  for (const params::Field& field : params::fields()) object[field.key] = value_of(field, parameters);
  std::string text;
  for (const params::Group group :
       {params::Group::configuration, params::Group::compensation, params::Group::datuming}) {
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", params::name_of(group));
    for (const params::Field& field : params::fields())
      if (field.group == group && is_shown(field, parameters))
        text += fmt::format("  {:<40} {:>14}{}{}\n", field.key, params::text_of(field, parameters),
                            field.unit.empty() ? "" : " ", field.unit);
  }
  return {std::move(object), std::move(text)};
}

Cell differences_cell(const std::vector<params::Difference>& differences, std::string_view key_a,
                      std::string_view key_b, std::string_view name_a, std::string_view name_b) {
  Cell list{Json::array(), params::to_text(differences, name_a, name_b)};
  for (const params::Difference& d : differences)
    list.json.push_back(object_of(
        {{"key", word_cell(d.key)}, {"unit", text_cell(d.unit)}, {key_a, word_cell(d.a)}, {key_b, word_cell(d.b)}}));
  return list;
}

}  // namespace ecs::commissioning
