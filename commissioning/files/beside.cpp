#include "commissioning/files/beside.hpp"

#include <algorithm>
#include <optional>

#include "base/text.hpp"
#include "commissioning/files/kind.hpp"
#include "model/fit/model_file.hpp"

namespace ecs::commissioning {
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
    std::error_code error;
    const fs::path name(word);
    const fs::path beside = file.parent_path() / name.filename();
    if (fs::is_regular_file(beside, error))
      files.push_back(beside.string());
    else if (fs::is_regular_file(name, error))
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
