// Logbooks in a folder of the test, kept as the program keeps them.
#pragma once

#include <cstdlib>
#include <string>

#include "modules/logbook/recorder.hpp"
#include "tests/support/folder.hpp"

namespace ecs {

/// While it lives this process keeps logbooks in `path/logbooks`.
struct LogbookFolder : StateFolder {
  LogbookFolder() : LogbookFolder("logbooks") {}
  /// @param name  of the folder, of a file *.ecslog, or "off"
  explicit LogbookFolder(const std::string& name) {
    if (const char* before = std::getenv("ECS_LOGBOOK")) before_ = before;
    ::setenv("ECS_LOGBOOK", (name == "off" ? name : (path / name).string()).c_str(), 1);
    ::setenv("ECS_OPERATOR", "Jo Fitter", 1);
    (void)commissioning::logbook_words();
    commissioning::keep_logbook();
  }
  ~LogbookFolder() {
    commissioning::keep_logbook(false);
    ::unsetenv("ECS_OPERATOR");
    before_.empty() ? ::unsetenv("ECS_LOGBOOK") : ::setenv("ECS_LOGBOOK", before_.c_str(), 1);
  }

 private:
  std::string before_;
};

}  // namespace ecs
