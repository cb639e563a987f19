// Manual pages in the macros of man(7). Does not live here: what they are made of (shown_program.hpp).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/cli/shown_program.hpp"
#include "base/result.hpp"

namespace ecs::cli {

/// The page of a verb, with its synopsis, options, example and exit codes.
[[nodiscard]] std::string manual_page(const ShownProgram& program, const ShownVerb& verb);

/// The page of the program: every verb below its menu.
[[nodiscard]] std::string manual_overview(const ShownProgram& program);

struct ManualPage {
  std::string file;  ///< "ecs-map-build.1"; of the program itself "ecs.1"
  std::string text;
};
/// The overview, then a page for each verb.
[[nodiscard]] std::vector<ManualPage> manual_pages(const ShownProgram& program);
/// Makes the folder. A `usage` problem if a page is there and `force` is not given.
[[nodiscard]] Result<void> write_pages(const std::vector<ManualPage>& pages, const std::filesystem::path& folder,
                                       bool force);

}  // namespace ecs::cli
