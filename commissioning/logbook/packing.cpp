#include "commissioning/logbook/packing.hpp"

#include <zlib.h>

#include "base/file.hpp"

namespace ecs::commissioning {

std::string packed(std::string_view content) {
  uLongf length = ::compressBound(content.size());
  std::string bytes(length, '\0');
  ::compress2(reinterpret_cast<Bytef*>(bytes.data()), &length, reinterpret_cast<const Bytef*>(content.data()),
              content.size(), Z_DEFAULT_COMPRESSION);
  bytes.resize(length);
  return bytes;
}

std::optional<std::string> unpacked(const std::string& bytes, std::int64_t length, const std::string& sha256) {
  if (length < 0 || static_cast<std::size_t>(length) > kLargestKept) return std::nullopt;
  std::string content(static_cast<std::size_t>(length), '\0');
  uLongf got = content.size();
  if (::uncompress(reinterpret_cast<Bytef*>(content.data()), &got, reinterpret_cast<const Bytef*>(bytes.data()),
                   bytes.size()) != Z_OK ||
      got != content.size() || sha256_hex(content) != sha256)
    return std::nullopt;
  return content;
}

}  // namespace ecs::commissioning
