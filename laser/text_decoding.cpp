#include "laser/text_decoding.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

#include <iconv.h>

#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "base/words.hpp"

namespace ecs::laser {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

unsigned byte_at(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

/// Length of the UTF-8 character at `i`; 0: not one (overlong forms, surrogates and values above U+10FFFF included).
std::size_t utf8_length(std::string_view text, std::size_t i) {
  const unsigned lead = byte_at(text, i);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 && lead <= 0xF4  ? 4
                             : lead >= 0xE0 && lead < 0xF0 ? 3
                             : lead >= 0xC2 && lead < 0xE0 ? 2
                                                           : 0;
  if (length == 0 || i + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte_at(text, i + k) & 0xC0u) != 0x80u) return 0;
  const unsigned second = byte_at(text, i + 1);
  const bool outside = (lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F) ||
                       (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F);
  return outside ? 0 : length;
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text, i);
    if (length == 0) return false;
    i += length;
  }
  return true;
}

/// Every high byte stands in a pair of the GB 2312 plane. An accented Windows-1252 letter is followed by a plain one.
bool pairs_as_chinese(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (byte_at(text, i) < 0x80) continue;
    const bool lead = byte_at(text, i) >= 0xA1 && byte_at(text, i) <= 0xF7;
    if (!lead || i + 1 == text.size() || byte_at(text, i + 1) < 0xA1 || byte_at(text, i + 1) == 0xFF) return false;
    ++i;
  }
  return true;
}

std::optional<std::string> converted(std::string_view text, const char* code_page) {
  const iconv_t converter = ::iconv_open("UTF-8", code_page);
  if (converter == reinterpret_cast<iconv_t>(-1)) return std::nullopt;
  std::string in(text);
  std::string out(text.size() * 4 + 4, '\0');
  char* from = in.data();
  char* to = out.data();
  std::size_t left = in.size();
  std::size_t room = out.size();
  const bool whole = ::iconv(converter, &from, &left, &to, &room) != static_cast<std::size_t>(-1) && left == 0;
  ::iconv_close(converter);
  if (!whole) return std::nullopt;
  out.resize(out.size() - room);
  return out;
}

/// Windows-1252 leaves five bytes undefined; they become U+FFFD so that a stray one in a comment costs no measurement.
std::optional<std::string> from_windows_1252(std::string_view text) {
  std::string out;
  std::string known;
  const auto flush = [&]() -> bool {
    const auto part = converted(known, "WINDOWS-1252");
    known.clear();
    if (part) out += *part;
    return part.has_value();
  };
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool undefined = byte == 0x81 || byte == 0x8D || byte == 0x8F || byte == 0x90 || byte == 0x9D;
    if (!undefined) {
      known += c;
      continue;
    }
    if (!flush()) return std::nullopt;
    out += "\xEF\xBF\xBD";
  }
  if (!flush()) return std::nullopt;
  return out;
}

Encoding guessed(std::string_view text) {
  if (is_utf8(text)) return Encoding::utf8;
  return pairs_as_chinese(text) ? Encoding::gbk : Encoding::windows_1252;
}

std::optional<std::string> from_utf16(std::string_view bytes, const char* order) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) bytes.remove_prefix(2);
  return bytes.size() % 2 == 0 ? converted(bytes, order) : std::nullopt;
}

bool is_binary(std::string_view text) {
  return std::ranges::any_of(text, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f' && c != '\v' && byte != 0x1A;
  });
}

}  // namespace

std::string_view name_of(Encoding encoding) {
  constexpr WordTable<Encoding, 7> kEncodings{
      {"automatic", "UTF-8", "Windows-1252", "GBK", "ISO-8859-1", "Shift-JIS", "UTF-16"}};
  return kEncodings.of(encoding);
}

Result<DecodedText> decoded(std::string_view bytes, const std::string& file_name, Encoding wanted) {
  if (const auto order = utf16_order(bytes); order && (wanted == Encoding::automatic || wanted == Encoding::utf16)) {
    const auto plain = from_utf16(bytes, *order);
    if (!plain) return problem_at(file_name, 0, 0, "expected UTF-16 text, found invalid bytes");
    auto text = decoded(*plain, file_name, Encoding::utf8);
    if (text) text->encoding = Encoding::utf16;
    return text;
  }
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  if (trimmed(bytes).empty()) return problem_at(file_name, 0, 0, "expected readings, found an empty file");
  if (is_binary(bytes)) return problem_at(file_name, 0, 0, "expected text, found a binary file");
  const Encoding taken = wanted == Encoding::automatic ? guessed(bytes) : wanted;
  std::optional<std::string> text;
  if (taken == Encoding::utf8 && is_utf8(bytes)) text = std::string(bytes);
  if (taken == Encoding::gbk) text = converted(bytes, "GBK");
  if (taken == Encoding::windows_1252) text = from_windows_1252(bytes);
  if (taken == Encoding::latin1) text = converted(bytes, "ISO-8859-1");
  if (taken == Encoding::shift_jis) text = converted(bytes, "SHIFT-JIS");
  if (!text) return problem_at(file_name, 0, 0, "expected {} text, found invalid bytes", name_of(taken));
  return DecodedText{std::move(*text), taken};
}

}  // namespace ecs::laser
