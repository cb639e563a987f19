#include "protocol/registers/fields.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/file.hpp"

namespace ecs::protocol {
namespace {

std::size_t cut_length(std::string_view text, std::size_t bytes) {
  std::size_t length = std::min(text.size(), bytes);
  if (length == text.size()) return length;
  while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0u) == 0x80u) --length;
  return length;
}

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

}  // namespace

void FieldWriter::axes(const PerAxis<bool>& set) {
  unsigned mask = 0;
  for (const Axis a : kAllAxes)
    if (set[index_of(a)]) mask |= 1u << index_of(a);
  out_.push_back(static_cast<std::uint16_t>(mask));
}

void FieldWriter::check() {
  std::vector<std::uint8_t> bytes(2 * (out_.size() - 1));
  for (std::size_t i = 1; i < out_.size(); ++i) store_big(bytes, 2 * (i - 1), out_[i]);
  number(crc32_of(bytes), "check");
}

void FieldWriter::text(const std::string& value, std::size_t bytes, std::string_view) {
  std::string field_text = value.substr(0, cut_length(value, bytes));
  field_text.resize(bytes, '\0');
  for (std::size_t i = 0; i + 1 < bytes; i += 2)
    out_.push_back(static_cast<std::uint16_t>((static_cast<unsigned char>(field_text[i]) << 8) |
                                              static_cast<unsigned char>(field_text[i + 1])));
}

std::uint16_t FieldReader::next() {
  if (in_.empty()) {
    fail("the block is too short");
    return 0;
  }
  const std::uint16_t word = in_.front();
  in_ = in_.subspan(1);
  return word;
}

void FieldReader::real(double& value, std::string_view name) {
  std::uint64_t bits = 0;
  number(bits, name);
  const auto number_read = std::bit_cast<double>(bits);
  if (!std::isfinite(number_read)) return fail(fmt::format("{}: expected a finite number", name));
  value = number_read;
}

void FieldReader::flag(bool& value, std::string_view name) {
  int word = 0;
  one_of(word, 2, name);
  value = word == 1;
}

void FieldReader::approach(Approach& value) {
  std::int16_t word = 0;
  number(word, "approach");
  if (word < -1 || word > 1) return fail(fmt::format("approach: expected -1, 0 or 1, got {}", word));
  value = static_cast<Approach>(word);
}

void FieldReader::axes(PerAxis<bool>& set) {
  std::uint16_t mask = 0;
  one_of(mask, 1u << kAxes, "axes");
  for (const Axis a : kAllAxes) set[index_of(a)] = (mask >> index_of(a) & 1) != 0;
}

void FieldReader::letter(bool& present, Axis axis) {
  const std::uint16_t word = next();
  if (word != 0 && word != static_cast<unsigned char>(letter_of(axis)))
    return fail(fmt::format("axis letter: expected {} or 0, got {}", letter_of(axis), word));
  present = word != 0;
}

void FieldReader::rotary_letter(char& letter) {
  const std::uint16_t word = next();
  if (word != 0 && (word < 'A' || word > 'C'))
    return fail(fmt::format("rotary axis: expected A, B, C or 0, got {}", word));
  letter = static_cast<char>(word);
}

void FieldReader::text(std::string& value, std::size_t bytes, std::string_view name) {
  std::string field_text;
  for (std::size_t i = 0; i + 1 < bytes; i += 2) {
    const std::uint16_t word = next();
    field_text.push_back(static_cast<char>(word >> 8));
    field_text.push_back(static_cast<char>(word & 0xFF));
  }
  field_text.erase(std::find(field_text.begin(), field_text.end(), '\0'), field_text.end());
  if (std::any_of(field_text.begin(), field_text.end(), is_control))
    return fail(fmt::format("{}: expected printable characters", name));
  value = field_text;
}

}  // namespace ecs::protocol
