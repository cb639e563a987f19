// Which file is the logbook of a machine, and whether one is kept at all.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "modules/logbook/store.hpp"

namespace ecs::commissioning {

/// $ECS_LOGBOOK, else `logbook` in the settings: "off"; a file *.ecslog, which then takes every entry; a folder with a
/// logbook for each machine. Without either the folder `logbooks` of the state folder.
struct LogbookSetting {
  bool off = false;
  std::filesystem::path file;    ///< empty: one for each machine
  std::filesystem::path folder;  ///< empty: off, or `file`
};
[[nodiscard]] Result<LogbookSetting> logbook_setting();

/// The logbook of that machine, or where it would begin: named after machine, and after serial number too where another
/// machine has that name. Nothing where the folder is wanted and nothing names the machine.
[[nodiscard]] Result<std::optional<std::filesystem::path>> logbook_of(const LogbookSetting& setting,
                                                                      const LogOwner& owner);

/// Every logbook of the setting, the one written last first.
[[nodiscard]] std::vector<std::filesystem::path> logbooks(const LogbookSetting& setting);

/// $ECS_OPERATOR, else `operator` in the settings, else the login name.
[[nodiscard]] std::string operator_name();

/// Whose file it is, by what it says: a machine file, parameters, a measurement set, a map. Empty: it does not say.
[[nodiscard]] LogOwner owner_in(std::string_view content);

}  // namespace ecs::commissioning
