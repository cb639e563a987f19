// Tables for other controls: files written together or not at all, the answer as text and JSON.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/result.hpp"
#include "commissioning/maps/machine_map.hpp"
#include "commissioning/session/message.hpp"
#include "modules/controllers/curve.hpp"
#include "modules/controllers/tables.hpp"

namespace ecs::commissioning {

/// The error of the machine at places: from the model if one is given, else from the map.
/// @param work  must outlive what is returned
[[nodiscard]] Result<ErrorsAt> errors_for(MessageSink& messages, const ExportArguments& arguments,
                                          const ExportWork& work);

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
