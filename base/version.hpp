// The version of the programs; its number is that of the CMake project, its commit is read when the build is
// configured (cmake/commit.cmake).
#pragma once

namespace ecs {

/// "ecs 0.2.0"
[[nodiscard]] const char* program_version();
/// "ecs 0.2.0 (87a4e47)"; "ecs 0.2.0" where the sources are neither a git checkout nor an archive that git has made.
[[nodiscard]] const char* program_version_and_commit();

}  // namespace ecs
