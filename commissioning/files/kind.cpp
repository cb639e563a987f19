#include "commissioning/files/kind.hpp"

#include <fstream>

#include <fmt/format.h>

#include "base/text.hpp"
#include "commissioning/laser_session/lines.hpp"
#include "commissioning/memory/dump.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kBeginning = 64U << 10;        ///< bytes that say what a file is
constexpr std::uintmax_t kMostLookedAt = 16U << 20;  ///< bytes; larger files are read when they are chosen

std::string beginning_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kBeginning, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

/// What the beginning alone decides.
FileKind kind_of_beginning(const fs::path& path, std::string_view text) {
  if (path.extension() == ".nc") return FileKind::part_program;
  const FileKind kind = kind_of_content(text);
  const bool is_whole = kind == FileKind::model || kind == FileKind::parameters || kind == FileKind::machine ||
                        kind == FileKind::status || kind == FileKind::datum_record || kind == FileKind::lengths ||
                        (kind == FileKind::memory && text.find('\0') == std::string_view::npos);
  return is_whole ? kind : FileKind::other;
}

FileLook look_at_measurements(const fs::path& path) {
  const LaserFile file = read_laser_file({path.string(), {}});
  FileLook look;
  look.why_not = file.problem;
  if (file.is_map) look.kind = FileKind::map;
  if (file.set || file.wants_answers) look.kind = FileKind::measurements;
  look.wants_answers = file.wants_answers;
  if (file.set || file.is_map)
    look.what = fmt::format("{}  {}", file.summary, file.format);
  else if (!file.format.empty())
    look.what = file.format + ": no readings";
  else
    look.what = file.wants_answers ? "does not say enough: take it, then Enter answers" : "not read";
  return look;
}

}  // namespace

FileLook looked_at(const fs::path& path) {
  const std::string beginning = beginning_of(path);
  FileLook look{kind_of_beginning(path, beginning), {}, false, {}};
  if (look.kind != FileKind::other) {
    look.what = name_of(look.kind);
    return look;
  }
  std::error_code fault;
  if (fs::file_size(path, fault) > kMostLookedAt)
    return {FileKind::measurements, "large: read when it is chosen", false, {}};
  look = look_at_measurements(path);
  if (look.kind != FileKind::other || beginning.find('\0') == std::string::npos) return look;
  if (read_dump(path)) return {FileKind::memory, "memory image", false, {}};
  return look;
}

}  // namespace ecs::commissioning
