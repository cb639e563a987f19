#include "commissioning/files/kind.hpp"

#include <array>
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

/// A line of the text begins with it.
bool has_line(std::string_view text, std::string_view begin) {
  return text.starts_with(begin) || text.find("\n" + std::string(begin)) != std::string_view::npos;
}

FileKind kind_of_toml(std::string_view text) {
  if (has_line(text, "[[effect]]")) return FileKind::model;
  if (has_line(text, "[configuration]")) return FileKind::parameters;
  if (has_line(text, "configuration =") && has_line(text, "[axis.")) return FileKind::machine;
  return FileKind::other;
}

/// What the beginning alone decides.
FileKind kind_of_beginning(const fs::path& path, std::string_view text) {
  if (text.starts_with("ECSDUMP ")) return FileKind::memory;
  if (path.extension() == ".toml") return kind_of_toml(text);
  if (path.extension() == ".nc") return FileKind::part_program;
  if (text.starts_with("{") && text.find("\"ecs_status\"") != std::string_view::npos) return FileKind::status;
  if (has_line(text, "# sample_period_us:") && has_line(text, "# um_per_count:")) return FileKind::datum_record;
  if (has_line(text, "# set_up: ") && has_line(text, "# tool: ")) return FileKind::lengths;
  return FileKind::other;
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

std::string_view name_of(FileKind kind) {
  static constexpr std::array<std::string_view, 11> kNames{
      "measurements",   "model",           "error map",    "parameters", "machine", "memory of a unit",
      "datum sequence", "state of a unit", "part program", "lengths",    "file"};
  return kNames[static_cast<std::size_t>(kind)];
}

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
