// One door for every measurement file: what an instrument wrote, as a measurement set.
// Does not live here: the readers themselves (readers.hpp), the CSV form (measurement_set.hpp).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/environment_record.hpp"
#include "laser/import/columns.hpp"
#include "laser/measurement_set.hpp"
#include "laser/text_decoding.hpp"
#include "laser/units.hpp"

namespace ecs::laser {

enum class FileFormat {
  measurement_csv,     ///< our own CSV (measurement_set.hpp)
  renishaw_run,        ///< Renishaw .rtl .rta .rts
  renishaw_dynamic,    ///< Renishaw .rtx
  renishaw_table,      ///< Renishaw error compensation table (.REN)
  api_pos,             ///< API XD laser report (.pos)
  sios_environment,    ///< SIOS nanomeasuring machine environment log (.pos)
  iso230_assignments,  ///< ecmc ISO 230-2 input (.dat)
  plate,               ///< hole positions of a plate from a coordinate measuring machine (SDSS)
  height_map,          ///< probed surface: Klipper, RepRapFirmware, LinuxCNC
  channel_log,         ///< time-stamped log of channels (EPICS camonitor)
  mapped_columns       ///< any table, by a mapping of its columns; never found by `format_of`
};

inline constexpr std::size_t kFileFormats = 11;

/// In words, for messages.
[[nodiscard]] std::string_view name_of(FileFormat format);

/// What a file does not say and the caller knows.
struct ImportOptions {
  std::optional<Axis> axis;    ///< moving axis; wins over the file's own statement
  std::optional<Sense> sense;  ///< needed for .rta and .rts: pitch or yaw, vertical or horizontal is not in the file
  Vector3 parked_mm{};  ///< coordinates of the axes that do not move; the moving axis's own entry is the origin of
                        ///< a dynamic capture and unused otherwise
  Encoding encoding = Encoding::automatic;
  bool accept_truncated = false;    ///< take what is left of a file that ends too early
  bool table_holds_errors = false;  ///< .REN: values are errors; false: they are compensation = −error
  bool spread_environment = true;  ///< Renishaw runs: air and material go from the start to the end value linearly over
                                   ///< the readings; false: only the first and the last reading carry them
  std::optional<Unit> target_unit;   ///< length: of target positions, where the file has another than it usually has
  std::optional<Unit> reading_unit;  ///< of the errors, in the same case
  std::string channel;               ///< of a channel log; empty: the only one
  std::optional<ColumnMapping> mapping;  ///< the file is a table, read by this; the format is not looked for
  std::size_t most_samples = 200'000;    ///< .rtx: longer captures are thinned to every n-th sample; at least 1
};

struct Imported {
  FileFormat format = FileFormat::measurement_csv;
  MeasurementSet set;                          ///< what had to be assumed stands in `set.notes`
  std::vector<EnvironmentRecord> environment;  ///< of an environment log, whose set has no readings
};

/// The format by content, the extension only where the content leaves a choice; nothing if no format fits.
/// @param text  decoded, or the bytes of a dynamic capture
[[nodiscard]] std::optional<FileFormat> format_of(std::string_view text, const std::string& file_name);

/// Why a text of no known format is not read: what it seems to be, the table found in it, and how to import that.
[[nodiscard]] std::string explanation_of(std::string_view text);

/// Reads a file's bytes as whatever they are. Refused with an explanation if they are no known format, with a `usage`
/// problem if the options lack what the file does not say.
[[nodiscard]] Result<Imported> parse_any(std::string_view bytes, const std::string& file_name,
                                         const ImportOptions& options);

/// The same from a file.
[[nodiscard]] Result<Imported> read_any(const std::filesystem::path& path, const ImportOptions& options);

}  // namespace ecs::laser
