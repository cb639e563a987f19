#include "laser/csv_line.hpp"

#include <algorithm>
#include <cstddef>

#include "base/text.hpp"

namespace ecs::laser {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// Walks the line and counts characters (UTF-8 continuation bytes are no characters).
class Cursor {
 public:
  explicit Cursor(std::string_view line) : line_(line) {}
  [[nodiscard]] bool at_end() const { return place_ == line_.size(); }
  [[nodiscard]] char here() const { return line_[place_]; }
  [[nodiscard]] int column() const { return column_; }
  char take() {
    const char c = line_[place_++];
    if (at_end() || (static_cast<unsigned char>(line_[place_]) & 0xC0u) != 0x80u) ++column_;
    return c;
  }
  void skip_blanks(char separator) {
    while (!at_end() && is_blank(here()) && here() != separator) take();
  }

 private:
  std::string_view line_;
  std::size_t place_ = 0;
  int column_ = 1;
};

/// After the opening quote up to and with the closing one; false: never closed.
bool take_quoted(Cursor& cursor, std::string& text) {
  while (!cursor.at_end()) {
    const char c = cursor.take();
    if (c != '"') {
      text += c;
    } else if (!cursor.at_end() && cursor.here() == '"') {
      text += cursor.take();
    } else {
      return true;
    }
  }
  return false;
}

}  // namespace

CsvLine csv_fields(std::string_view text, char separator) {
  CsvLine line;
  Cursor cursor(text);
  for (;;) {
    cursor.skip_blanks(separator);
    CsvField field{{}, cursor.column(), false};
    if (!cursor.at_end() && cursor.here() == '"') {
      field.quoted = true;
      cursor.take();
      if (!take_quoted(cursor, field.text)) {
        line.fault = "expected a closing double quote before the end of the line, found none";
        line.fault_column = field.column;
        return line;
      }
      cursor.skip_blanks(separator);
      if (!cursor.at_end() && cursor.here() != separator) {
        line.fault = "expected a separator after the closing double quote, found other text";
        line.fault_column = cursor.column();
        return line;
      }
    } else {
      while (!cursor.at_end() && cursor.here() != separator) field.text += cursor.take();
      field.text = std::string(trimmed(field.text));
    }
    line.fields.push_back(std::move(field));
    if (cursor.at_end()) return line;
    cursor.take();
  }
}

std::string csv_field_of(std::string_view raw) {
  std::string text(raw);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  const bool plain =
      text.find_first_of(",\"") == std::string::npos && trimmed(text).size() == text.size() && !text.starts_with('#');
  if (plain) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace ecs::laser
