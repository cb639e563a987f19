// What a file is, by what is in it: for choosing among files, and for opening whatever is given.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace ecs::commissioning {

enum class FileKind : std::uint8_t {
  measurements,  ///< of any instrument
  model,
  map,
  parameters,
  machine,
  memory,        ///< a dump of a unit, or a memory image
  datum_record,  ///< a datum sequence
  status,        ///< the saved state of a unit
  part_program,
  lengths,  ///< measured, or a plan of them (docs/identification.md)
  other,
};
/// "measurements", "model", "error map", …
[[nodiscard]] std::string_view name_of(FileKind kind);

/// What is known of a file after a look into it.
struct FileLook {
  FileKind kind = FileKind::other;
  std::string what;            ///< in a few words: "EXX, 498 readings  measurement CSV"
  bool wants_answers = false;  ///< measurements that do not say enough
  std::string why_not;         ///< of a file that nothing reads
};
/// Reads it as far as needed; what is too large is taken for what its beginning says.
[[nodiscard]] FileLook looked_at(const std::filesystem::path& path);

}  // namespace ecs::commissioning
