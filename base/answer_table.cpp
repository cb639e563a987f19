#include "base/answer_table.hpp"

#include <fmt/args.h>
#include <fmt/format.h>

namespace ecs {

Cell number_cell(const std::optional<double>& value, int decimals) {
  return {number_or_null(value), value ? fmt::format("{:.{}f}", *value, decimals) : "-"};
}

Cell count_cell(std::size_t count) { return {count, fmt::format("{}", count)}; }
Cell word_cell(std::string_view word) { return {std::string(word), std::string(word)}; }
Cell yes_cell(bool yes, std::string_view when_true, std::string_view when_false) {
  return {yes, std::string(yes ? when_true : when_false)};
}
Cell shown_cell(std::string text) { return {Json(Json::value_t::discarded), std::move(text)}; }

std::string laid_out(std::string_view layout, const CellTexts& cells) {
  fmt::dynamic_format_arg_store<fmt::format_context> arguments;
  std::vector<std::string> keys;  // fmt wants them to end in a zero, and to stay
  keys.reserve(cells.size());
  for (const auto& [key, text] : cells) {
    keys.emplace_back(key);
    arguments.push_back(fmt::arg(keys.back().c_str(), text));
  }
  return fmt::vformat(layout, arguments) + "\n";
}

}  // namespace ecs
