// Records of an answer whose fields are described once, each by its key: record_cell("{axis}: {error_um} um\n",
// "axis"_is(letter), "error_um"_is(error, 2)). Two writers visit them: one makes the JSON, one the text. Answers in
// prose keep their own text. Only for .cpp files (heavy header).
#pragma once

#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/json.hpp"
#include "base/outcome.hpp"

namespace ecs {

/// A value, a record or a list, as JSON holds it and as a terminal shows it.
struct Cell {
  Json json;
  std::string text;

  /// One item more of a list.
  void add(const Cell& item) {
    json.push_back(item.json);
    text += item.text;
  }
};

/// null and "-" where there is none.
[[nodiscard]] Cell number_cell(const std::optional<double>& value, int decimals);
/// The text; null in JSON where it is empty.
[[nodiscard]] Cell text_cell(std::string_view text);
/// null in JSON.
[[nodiscard]] Cell null_cell(std::string_view shown = {});
/// Shown only, if at all; JSON has no such key.
[[nodiscard]] Cell shown_cell(std::string text = {});
/// The file, null where none is written. @param otherwise  the text then; else "map written to map.csv"
[[nodiscard]] Cell written_cell(std::string_view what, std::string_view file, std::string_view otherwise = {});
/// A list in JSON, a line each in the text. @param begin  of each line: "note: "
[[nodiscard]] Cell lines_cell(const std::vector<std::string>& lines, std::string_view begin);

/// A list in JSON, a paragraph each in the text. @param begin  of each paragraph; its other lines begin below its end
[[nodiscard]] Cell paragraphs_cell(const std::vector<std::string>& paragraphs, std::string_view begin);

/// A cell for each item, below a heading in the text. @param make  the cell of an item
template <class Items, class Make>
[[nodiscard]] Cell list_cell(const Items& items, const Make& make, std::string heading = {}) {
  Cell list{Json::array(), std::move(heading)};
  for (const auto& item : items) list.add(make(item));
  return list;
}

struct AnswerField {
  std::string_view key;  ///< in JSON and in the layout; empty: the keys of the cell's object take its place
  Cell cell;
  bool shown_only = false;  ///< only the layout has it
};

/// A number (null and "-" where there is none), an integer, true or false, a word, a cell; whatever else JSON takes has
/// no text. Numbers are shown with as few digits as give them back.
[[nodiscard]] Cell cell_of(double value);
[[nodiscard]] Cell cell_of(const std::optional<double>& value);
[[nodiscard]] Cell cell_of(bool value);
[[nodiscard]] Cell cell_of(std::string_view word);
[[nodiscard]] inline Cell cell_of(const char* word) { return cell_of(std::string_view(word)); }
[[nodiscard]] inline Cell cell_of(const std::string& word) { return cell_of(std::string_view(word)); }
[[nodiscard]] inline Cell cell_of(Cell cell) { return cell; }
[[nodiscard]] inline Cell cell_of(Json value) { return {std::move(value), {}}; }
template <std::integral Integer>
[[nodiscard]] Cell cell_of(Integer value) {
  return {value, std::to_string(value)};
}

/// Describes a field: "position_mm"_is(value, 4), "referenced"_is(flag, "yes", "no"), "at"_is(list, text).
class FieldKey {
 public:
  constexpr explicit FieldKey(std::string_view key, bool shown_only = false) : key_(key), shown_only_(shown_only) {}

  template <class Value>
  [[nodiscard]] AnswerField operator()(Value&& value) const {
    return {key_, cell_of(std::forward<Value>(value)), shown_only_};
  }
  /// Another text.
  template <class Value, std::convertible_to<std::string_view> Text>
  [[nodiscard]] AnswerField operator()(Value&& value, const Text& text) const {
    return {key_, {cell_of(std::forward<Value>(value)).json, std::string(text)}, shown_only_};
  }
  /// A number with these decimals.
  template <std::convertible_to<std::optional<double>> Number>
  [[nodiscard]] AnswerField operator()(const Number& value, int decimals) const {
    return {key_, number_cell(value, decimals), shown_only_};
  }
  [[nodiscard]] AnswerField operator()(bool yes, std::string_view when_true, std::string_view when_false) const {
    return {key_, {yes, std::string(yes ? when_true : when_false)}, shown_only_};
  }

 private:
  std::string_view key_;
  bool shown_only_;
};

/// Of a field in JSON and in the layout.
constexpr FieldKey operator""_is(const char* key, std::size_t size) { return FieldKey(std::string_view(key, size)); }
/// Of a field that only the layout has.
constexpr FieldKey operator""_shown(const char* key, std::size_t size) {
  return FieldKey(std::string_view(key, size), true);
}
/// The fields of this record among those of another.
[[nodiscard]] inline AnswerField inlined(Cell record) { return {{}, std::move(record)}; }

/// In this order.
template <std::same_as<AnswerField>... Field>
[[nodiscard]] AnswerFields described(Field... fields) {
  AnswerFields all;
  all.reserve(sizeof...(fields));
  (all.push_back(std::move(fields)), ...);
  return all;
}
template <std::same_as<AnswerField>... Field>
void append(AnswerFields& fields, Field... more) {
  (fields.push_back(std::move(more)), ...);
}
void append(AnswerFields& fields, AnswerFields more);

/// The writer of JSON: an object with the keys in the order of the fields.
[[nodiscard]] Json object_of(const AnswerFields& fields);
template <std::same_as<AnswerField>... Field>
requires(sizeof...(Field) > 0) [[nodiscard]] Json object_of(Field... fields) {
  return object_of(described(std::move(fields)...));
}
/// The writer of text. @param layout  as fmt takes it, a field by its key: "{axis:<4} {position_mm:>11}"; a type that
///   numbers have formats the number, "-" where there is none: "{rms_um:>8.3f}"
[[nodiscard]] std::string laid_out(std::string_view layout, const AnswerFields& fields);
/// Both.
[[nodiscard]] Cell record_cell(std::string_view layout, const AnswerFields& fields);
template <std::same_as<AnswerField>... Field>
requires(sizeof...(Field) > 0) [[nodiscard]] Cell record_cell(std::string_view layout, Field... fields) {
  return record_cell(layout, described(std::move(fields)...));
}
[[nodiscard]] Outcome outcome_of(const Cell& answer, int exit_code = kDone);
/// The same after a write that is complete (Outcome::finished).
[[nodiscard]] Outcome finished_outcome_of(const Cell& answer);

}  // namespace ecs
