#include "base/sealed.hpp"

#include <cstdint>
#include <vector>

#include <fmt/format.h>
#include <nettle/base64.h>
#include <zlib.h>

namespace ecs {
namespace {

constexpr std::size_t kLineLength = 76;
constexpr std::size_t kMostText = std::size_t{1} << 26;  ///< a truth is a few kilobytes

}  // namespace

std::string base64_of(std::string_view bytes) {
  std::string text(BASE64_ENCODE_RAW_LENGTH(bytes.size()), '\0');
  base64_encode_raw(text.data(), bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
  return text;
}

std::string sealed(std::string_view text, std::string_view heading) {
  uLongf length = compressBound(text.size());
  std::vector<Bytef> packed(length);
  compress2(packed.data(), &length, reinterpret_cast<const Bytef*>(text.data()), text.size(), Z_BEST_COMPRESSION);
  packed.resize(length);
  const std::string coded = base64_of({reinterpret_cast<const char*>(packed.data()), packed.size()});
  std::string out = fmt::format("# {}\n# {} bytes\n", heading, text.size());
  for (std::size_t k = 0; k < coded.size(); k += kLineLength) out += coded.substr(k, kLineLength) + "\n";
  return out;
}

Result<std::string> unsealed(std::string_view sealed_text, const std::string& file) {
  const auto refused = [&file](int line, const std::string& why) {
    return problem_at(file, line, 0, "expected a sealed text as it was written, " + why + "; copy the file again");
  };
  const std::size_t size_line = sealed_text.find('\n') + 1;
  if (!sealed_text.starts_with("# ") || size_line == 0) return refused(1, "its heading is missing");
  const std::size_t body = sealed_text.find('\n', size_line) + 1;
  if (body == 0 || !sealed_text.substr(size_line).starts_with("# ")) return refused(2, "its size is missing");
  uLongf size = 0;
  for (const char c : sealed_text.substr(size_line + 2, body - size_line - 2)) {
    if (c < '0' || c > '9') break;
    size = size * 10 + static_cast<uLongf>(c - '0');
    if (size > kMostText) return refused(2, "its size is too large");
  }
  const std::string_view coded = sealed_text.substr(body);
  base64_decode_ctx context;
  base64_decode_init(&context);
  std::vector<std::uint8_t> packed(BASE64_DECODE_LENGTH(coded.size()));
  std::size_t length = packed.size();
  if (base64_decode_update(&context, &length, packed.data(), coded.size(), coded.data()) != 1 ||
      base64_decode_final(&context) != 1)
    return refused(3, "found text that is not base64");
  std::string text(size, '\0');
  uLongf got = size;
  if (uncompress(reinterpret_cast<Bytef*>(text.data()), &got, packed.data(), length) != Z_OK || got != size)
    return refused(3, "found it changed or truncated");
  return text;
}

}  // namespace ecs
