// The one rule for files that are there: nothing is overwritten unasked. A screen asks, a verb wants --force.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace ecs {

/// Whether writing to `path` destroys something: a regular file with content, and none of `own`, the files that the
/// same work reads or wrote before and so changes in place.
[[nodiscard]] bool would_overwrite(const std::string& path, const std::vector<std::string>& own = {});

/// A `usage` problem for the first of the files that would be overwritten, unless `force`.
[[nodiscard]] Result<void> spared(const std::vector<std::string>& files, bool force,
                                  const std::vector<std::string>& own = {});
/// The same where nothing can force it. @param instead  what to do: "give another folder"
[[nodiscard]] Result<void> none_there(const std::vector<std::string>& files, std::string_view instead);

}  // namespace ecs
