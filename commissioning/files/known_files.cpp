#include "commissioning/files/known_files.hpp"

#include <fstream>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/laser_session/lines.hpp"
#include "commissioning/memory/dump.hpp"
#include "model/fit/model_file.hpp"

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
                        kind == FileKind::plan || kind == FileKind::recipe || kind == FileKind::true_errors ||
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
    look.what = file.wants_columns   ? "table: select it to assign its columns"
                : file.wants_answers ? "incomplete: select it, then press Enter to add data"
                                     : "unknown kind";
  return look;
}

}  // namespace

namespace {

/// "this is a machine file, not a parameter file: verbs that use one …" up to the colon: what verbs do is of no help
/// where a file is chosen.
std::string without_advice(const std::string& message) { return message.substr(0, message.find(": ")); }

}  // namespace

std::string refusal_as(FileKind wanted, const fs::path& path) {
  if (path.empty()) return {};
  if (!disc::is_file(path)) return fmt::format("There is no file {}.", path.string());
  const FileLook look = looked_at(path);
  if (look.kind == wanted) return {};
  const std::string name = path.filename().string();
  if (const auto wrong = wrong_kind(wanted, beginning_of(path), name))
    return name + without_advice(wrong->message).substr(std::string_view("this").size()) + ".";
  return fmt::format("{}: expected {}, found {}.", name, name_of(wanted), look.what);
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
    return {FileKind::measurements, "large: read when selected", false, {}};
  look = look_at_measurements(path);
  if (const auto known = wrong_kind(FileKind::other, beginning, ""); known && look.kind == FileKind::other)
    look.what = without_advice(known->message).substr(std::string_view("this is ").size());
  if (beginning.starts_with("time_s,mode,fault,axis,position_mm,")) look.what = "a recording of the monitor";
  if (look.kind != FileKind::other || beginning.find('\0') == std::string::npos) return look;
  if (read_dump(path)) return {FileKind::memory, "memory image", false, {}};
  return look;
}

namespace {

namespace fs = std::filesystem;

// Measured files are read to know them, while somebody waits: about a tenth of a second.
constexpr std::size_t kMostLookedInto = 20;
constexpr std::uintmax_t kMostBytes = 4U << 20;

bool is_of_kind(const fs::path& file, FileKind kind) {
  const FileLook look = looked_at(file);
  return look.kind == kind && !look.wants_answers;
}

/// The file of this name if it is of the kind, else the only one of the kind with this ending.
std::string one_of_kind(const fs::path& folder, const std::string& usual, FileKind kind) {
  const fs::path usual_file = folder / usual;
  std::error_code error;
  if (fs::is_regular_file(usual_file, error) && is_of_kind(usual_file, kind)) return usual_file.string();
  std::vector<fs::path> candidates;
  std::uintmax_t bytes = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
    if (entry.path().extension() != usual_file.extension() || !entry.is_regular_file(error)) continue;
    candidates.push_back(folder / entry.path().filename());
    bytes += entry.file_size(error);
  }
  if (candidates.size() > kMostLookedInto || bytes > kMostBytes) return {};
  std::erase_if(candidates, [kind](const fs::path& file) { return !is_of_kind(file, kind); });
  return candidates.size() == 1 ? candidates.front().string() : std::string();
}

/// The files that the model says it was fitted to last, where they are still there.
std::vector<std::string> fitted_to(const fs::path& file) {
  const auto model = model::read_model(file.string());
  if (!model || model->history.empty()) return {};
  std::vector<std::string> files;
  for (const std::string_view word : split(model->history.back().data, ' ')) {
    if (word.empty()) continue;
    const fs::path name(word);
    const fs::path beside = file.parent_path() / name.filename();
    if (disc::is_file(beside))
      files.push_back(beside.string());
    else if (disc::is_file(name))
      files.push_back(name.string());
    else
      return {};
  }
  return files;
}

}  // namespace

FilesBeside files_beside(const fs::path& model) {
  const fs::path folder = model.parent_path();
  FilesBeside found{one_of_kind(folder, "machine.toml", FileKind::machine),
                    one_of_kind(folder, "parameters.toml", FileKind::parameters), fitted_to(model)};
  if (found.data.empty())
    if (std::string data = one_of_kind(folder, "data.csv", FileKind::measurements); !data.empty())
      found.data.push_back(std::move(data));
  return found;
}

}  // namespace ecs::commissioning
