// Any measurement file of the registry as a measurement set.
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
#include "laser/import/format.hpp"
#include "laser/import/matrix.hpp"
#include "laser/measurement_set.hpp"
#include "laser/text_decoding.hpp"
#include "laser/units.hpp"

namespace ecs::laser {

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
  std::optional<MatrixLayout> matrix;    ///< the same for values on a grid
  std::string note;                      ///< about the file, kept with what had to be assumed
  std::size_t most_samples = 200'000;    ///< .rtx: longer captures are thinned to every n-th sample; at least 1
};

struct Imported {
  const FileFormat* format = nullptr;          ///< never null in an answer
  MeasurementSet set;                          ///< what had to be assumed stands in `set.notes`
  std::vector<EnvironmentRecord> environment;  ///< of an environment log, whose set has no readings
};

/// Why a text of no known format is not read: what it seems to be, the table found in it, and how to import that.
[[nodiscard]] std::string explanation_of(std::string_view text);

/// Reads a file's bytes as whatever they are. Refused with an explanation if they are no known format, with a `usage`
/// problem if the options lack what the file does not say.
[[nodiscard]] Result<Imported> parse_any(std::string_view bytes, const std::string& file_name,
                                         const ImportOptions& options);

/// The same from a file.
[[nodiscard]] Result<Imported> read_any(const std::filesystem::path& path, const ImportOptions& options);

}  // namespace ecs::laser
