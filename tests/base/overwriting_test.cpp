// The one rule for files: nothing is overwritten without --force; a verb's own input is changed in place.
#include "base/file.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

namespace ecs {
namespace {

TEST_CASE("would_overwrite() spares nothing but regular files with content that are not one's own") {
  const Folder folder;
  const std::string file = folder.with("a.csv", "x");
  CHECK(would_overwrite(file));
  CHECK_FALSE(would_overwrite(file, {file}));
  CHECK_FALSE(would_overwrite(folder.with("empty.csv", "")));
  CHECK_FALSE(would_overwrite((folder.path / "none.csv").string()));
  CHECK_FALSE(would_overwrite("/dev/null"));
  CHECK_FALSE(would_overwrite(folder.path.string()));
}

}  // namespace
}  // namespace ecs
