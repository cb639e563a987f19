#include "commissioning/measurements/given_files.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/file_watch.hpp"
#include "laser/import/format.hpp"
#include "laser/text_decoding.hpp"

namespace ecs::commissioning {
namespace {

/// By its beginning: a measurement CSV, or a file of an instrument.
bool is_measurement(const std::filesystem::path& path, bool with_paths) {
  constexpr std::size_t kBeginning = 64U << 10;
  const std::string head = head_of(path, kBeginning);
  const FileKind kind = kind_of_content(head);
  if (kind == FileKind::circle_test || kind == FileKind::diagonal_test) return with_paths;
  if (kind != FileKind::other) return kind == FileKind::measurements;
  if (laser::recognised_format(head, path.string()) != nullptr) return true;
  const auto text = laser::decoded(head, path.string());
  return text && laser::recognised_format(text->text, path.string()) != nullptr;
}

}  // namespace

Result<GivenFiles> given_files(const std::vector<std::string>& words, bool with_paths) {
  namespace fs = std::filesystem;
  GivenFiles given;
  for (const std::string& word : words) {
    std::error_code error;
    if (!fs::is_directory(word, error)) {
      given.files.push_back(word);
      continue;
    }
    std::vector<std::string> taken, names;
    std::size_t others = 0;
    for (const auto& entry : fs::directory_iterator(word, error)) {
      const fs::path& path = entry.path();
      if (!entry.is_regular_file(error) || path.filename().string().starts_with('.')) continue;
      if (is_measurement(path, with_paths))
        taken.push_back(path.string());
      else
        ++others;
    }
    std::sort(taken.begin(), taken.end());
    if (taken.empty()) {
      auto refused = read_file(word);  // names the files of the folder
      if (refused) return problem(ProblemKind::bad_input, word + ": expected a file or a folder");
      refused.error().message += "; none of them is a measurement file that is known here";
      return tl::unexpected(std::move(refused.error()));
    }
    for (const std::string& path : taken) names.push_back(fs::path(path).filename().string());
    given.notes.push_back(fmt::format("{}: a folder; its measurement files are {}{}", word, fmt::join(names, ", "),
                                      others > 0 ? fmt::format("; {} other files are left out", others) : ""));
    given.files.insert(given.files.end(), taken.begin(), taken.end());
  }
  return given;
}

}  // namespace ecs::commissioning
