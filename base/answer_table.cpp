#include "base/answer_table.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/args.h>
#include <fmt/format.h>

#include "base/text.hpp"

namespace {

struct CellInLayout {
  const ecs::Cell* cell;
};

}  // namespace

/// A cell's text; its number where the format has a type of numbers.
template <>
struct fmt::formatter<CellInLayout> {
  std::string format_spec;

  auto parse(fmt::format_parse_context& context) {
    const auto end = std::find(context.begin(), context.end(), '}');
    format_spec.assign(context.begin(), end);
    return end;
  }
  auto format(const CellInLayout& shown, fmt::format_context& context) const {
    const ecs::Cell& cell = *shown.cell;
    const auto write = [&](const std::string& spec, const auto& value) {
      return fmt::format_to(context.out(), fmt::runtime("{:" + spec + "}"), value);
    };
    if (format_spec.empty() || std::string_view("efg").find(format_spec.back()) == std::string_view::npos)
      return write(format_spec, cell.text);
    if (cell.json.is_number()) return write(format_spec, cell.json.get<double>());
    std::string place = format_spec.substr(0, format_spec.find_first_of(".efg"));
    std::erase(place, '+');
    return write(place.starts_with('<') || place.starts_with('>') ? place : ">" + place, "-");
  }
};

namespace ecs {

Cell number_cell(const std::optional<double>& value, int decimals) {
  std::string text = value ? fmt::format("{:.{}f}", *value, decimals) : "-";
  if (text.size() > 1 && text.find_first_not_of("-0.") == std::string::npos && text.front() == '-') text.erase(0, 1);
  return {number_or_null(value), std::move(text)};
}

Cell cell_of(double value) { return {number_or_null(value), fmt::format("{}", value)}; }
Cell cell_of(const std::optional<double>& value) { return value ? cell_of(*value) : null_cell("-"); }
Cell cell_of(bool value) { return {value, {}}; }
Cell cell_of(std::string_view word) { return {std::string(word), std::string(word)}; }
Cell text_cell(std::string_view text) { return {text_or_null(text), std::string(text)}; }
Cell null_cell(std::string_view shown) { return {nullptr, std::string(shown)}; }
Cell shown_cell(std::string text) { return {Json(Json::value_t::discarded), std::move(text)}; }
Cell written_cell(std::string_view what, std::string_view file, std::string_view otherwise) {
  if (file.empty()) return null_cell(otherwise);
  return {std::string(file), fmt::format("{} written to {}\n", what, file)};
}

Cell lines_cell(const std::vector<std::string>& lines, std::string_view begin) {
  Cell cell{lines, {}};
  for (const std::string& line : lines) cell.text += fmt::format("{}{}\n", begin, line);
  return cell;
}

Cell paragraphs_cell(const std::vector<std::string>& paragraphs, std::string_view begin) {
  Cell cell{paragraphs, {}};
  for (const std::string& one : paragraphs) cell.text += paragraph(std::string(begin) + one, 0, begin.size());
  return cell;
}

void append(AnswerFields& fields, AnswerFields more) {
  fields.insert(fields.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

Json object_of(const AnswerFields& fields) {
  Json object = Json::object();
  for (const auto& [key, cell, shown_only] : fields) {
    if (key.empty())
      object.update(cell.json);
    else if (!shown_only && !cell.json.is_discarded())
      object[std::string(key)] = cell.json;
  }
  return object;
}

std::string laid_out(std::string_view layout, const AnswerFields& fields) {
  fmt::dynamic_format_arg_store<fmt::format_context> arguments;
  std::vector<std::string> keys;  // fmt wants them to end in a zero, and to stay
  keys.reserve(fields.size());
  for (const AnswerField& field : fields) {
    keys.emplace_back(field.key);
    arguments.push_back(fmt::arg(keys.back().c_str(), CellInLayout{&field.cell}));
  }
  return fmt::vformat(layout, arguments);
}

Cell record_cell(std::string_view layout, const AnswerFields& fields) {
  return {object_of(fields), laid_out(layout, fields)};
}

Outcome outcome_of(const Cell& answer, int exit_code) { return {answer.text, one_line(answer.json), exit_code}; }
Outcome finished_outcome_of(const Cell& answer) { return {answer.text, one_line(answer.json), kDone, true}; }

}  // namespace ecs
