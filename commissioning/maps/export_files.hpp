// Several output files that belong together: all of them on disc, or none.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace ecs::commissioning {

struct OutputFile {
  std::string path;
  std::string content;
};

struct WrittenFile {
  std::string path;
  bool replaced = false;  ///< something of that name was there before
};

/// Writes every file beside its name, then renames them all. Where one cannot be written, or its name is a folder or a
/// device, no file was changed; where renaming fails in the middle, what was renamed before is taken back. The `output`
/// problem says what stands where. A single file may also be a device, and is then written into.
[[nodiscard]] Result<std::vector<WrittenFile>> write_together(const std::vector<OutputFile>& files);

/// Names of files in the folder that `is_ours` knows and that were not written now, sorted: an earlier export left them
/// there, with another map.
[[nodiscard]] std::vector<std::string> left_from_before(const std::string& folder,
                                                        const std::vector<WrittenFile>& written,
                                                        const std::function<bool(std::string_view)>& is_ours);

}  // namespace ecs::commissioning
