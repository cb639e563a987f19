// An export as text and JSON: tables, what to set, what stays behind, what is left over.
// Only for .cpp files (heavy header).
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "commissioning/maps/export_files.hpp"
#include "commissioning/maps/export_source.hpp"

namespace ecs::commissioning {

/// One export, for its report.
struct ExportReport {
  std::string control;  ///< "LinuxCNC"
  const ExportWork& work;
  const controllers::ControllerExport& made;
  const std::vector<controllers::ResidualRow>& residuals;
  std::vector<WrittenFile> written;  ///< empty: nothing was written
  std::string output_hint;           ///< how to have it written
};

[[nodiscard]] std::string export_text(const ExportReport& report);
[[nodiscard]] Json json_of(const ExportReport& report);

}  // namespace ecs::commissioning
