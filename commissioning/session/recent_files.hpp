// The files that were opened or saved last, kept from one run of the program to the next.
#pragma once

#include <string>
#include <vector>

namespace ecs::commissioning {

/// Puts it first. What cannot be written is not remembered. @param path  made absolute
void remember_file(const std::string& path);
/// Absolute paths that still exist, the newest first.
[[nodiscard]] std::vector<std::string> recent_files();

}  // namespace ecs::commissioning
