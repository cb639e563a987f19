// Any measurement file of the registry as a measurement set.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/environment_series.hpp"
#include "laser/import/columns.hpp"
#include "laser/import/format.hpp"
#include "laser/import/matrix.hpp"
#include "laser/measurement_set.hpp"
#include "laser/text_decoding.hpp"
#include "laser/units.hpp"

namespace ecs::laser {

/// How a channel of a log gets a value at the time of another.
enum class Joining {
  linear,   ///< between the values before and after
  nearest,  ///< in time
  previous  ///< the last value before: of channels that are written when they change
};

/// What a file does not say and the caller knows.
struct ImportOptions {
  std::optional<Axis> axis;    ///< moving axis; overrides an instrument file, not a measurement CSV
  bool rotary = false;         ///< … it turns about that direction: A, B, C; targets are in degrees
  bool takes_rotary = false;   ///< what is to be done with the readings suits rotary axes too; false: they are refused
  std::optional<Sense> sense;  ///< needed for .rta and .rts: pitch or yaw, vertical or horizontal is not in the file
  Vector3 parked_mm{};  ///< coordinates of the axes that do not move; the moving axis's own entry is the origin of
                        ///< a dynamic capture, and the one target of a table without positions
  PerAxis<bool> parked_stated{};  ///< which of them were given
  Encoding encoding = Encoding::automatic;
  bool accept_truncated = false;    ///< take what is left of a file that ends too early
  bool table_holds_errors = false;  ///< .REN: values are errors; false: they are compensation = −error
  bool spread_environment = true;  ///< Renishaw runs: air and material go from the start to the end value linearly over
                                   ///< the readings; false: only the first and the last reading carry them
  std::optional<Unit> target_unit;   ///< length, of rotary axes angle: of target positions, where the file has another
                                     ///< than it usually has
  std::optional<Unit> reading_unit;  ///< of the errors, in the same case
  std::string channel;               ///< of a channel log; empty: the only one
  std::optional<ColumnMapping> channels;  ///< of a log: its headings are names of channels, joined by time
  Joining joining = Joining::linear;
  std::optional<double> greatest_gap_s;  ///< over which channels are joined; absent: five times the usual interval
  std::optional<ColumnMapping> mapping;  ///< the file is a table, read by this; the format is not looked for
  std::optional<MatrixLayout> matrix;    ///< the same for values on a grid
  std::optional<double> at_rest_mm;      ///< only readings whose position stays within this while others are taken
  bool average = false;                  ///< readings taken at rest become one, their mean
  bool keep_set_up = false;              ///< of measured positions: shift and rotation stay in the errors
  bool approach_unknown = false;  ///< of a measurement CSV without that column; false: from the order of its targets
  std::string note;               ///< about the file, kept with what had to be assumed
  std::size_t most_samples = 200'000;  ///< .rtx: longer captures are thinned to every n-th sample; at least 1
};

struct Imported {
  const FileFormat* format = nullptr;  ///< never null in an answer
  MeasurementSet set;                  ///< what had to be assumed stands in `set.notes`
  EnvironmentSeries environment;       ///< of an environment log, whose set has no readings
  std::string sha256{};                ///< of the bytes that were read
};

/// Why a text of no known format is not read: what it seems to be and where it says so, the table found in it, and the
/// options that import that.
[[nodiscard]] Problem explanation_of(std::string_view text, const std::string& file_name);

/// How the note on assumed places of axes begins.
inline constexpr std::string_view kPlaceNotStated = "the file states no parked position of";

/// Axes whose place the file states, or its columns do; a reader takes 0 for the others.
[[nodiscard]] PerAxis<bool> places_stated(const Imported& imported, const ImportOptions& options);

/// Reads a file's bytes as whatever they are. Refused with an explanation if they are no known format, with a `usage`
/// problem if the options lack what the file does not say.
[[nodiscard]] Result<Imported> parse_any(std::string_view bytes, const std::string& file_name,
                                         const ImportOptions& options);

/// The same of the bytes of a whole file, with their checksum; files of another kind than measurements are refused.
[[nodiscard]] Result<Imported> imported_from(std::string_view bytes, const std::string& file_name,
                                             const ImportOptions& options);
[[nodiscard]] Result<Imported> read_any(const std::filesystem::path& path, const ImportOptions& options = {});

/// How the files of a piece of work are read, with the checksum of each: what the caller knows about them is in it.
using FileReader = std::function<Result<Imported>(const std::filesystem::path&)>;

/// The same, but each file is read once, however often it is asked for.
[[nodiscard]] FileReader reading_once(FileReader read);

/// Files that say everything themselves.
[[nodiscard]] inline Result<Imported> read_plain(const std::filesystem::path& path) { return read_any(path); }

}  // namespace ecs::laser
