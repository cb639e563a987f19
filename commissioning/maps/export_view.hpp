// An export as text and JSON: tables, what to set, what is not carried, what is left over.
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

[[nodiscard]] Cell export_cell(const ExportReport& report);

/// All paths in JSON; "written: a.comp" or "replaced: a.comp" in the text, a line each.
[[nodiscard]] Cell written_files_cell(const std::vector<WrittenFile>& files);
/// Paths that held something before; not shown.
[[nodiscard]] Cell replaced_files_cell(const std::vector<WrittenFile>& files);

}  // namespace ecs::commissioning
