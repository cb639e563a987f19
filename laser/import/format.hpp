// One format of measurement files: its words, how it is recognised, reading and writing. Detection, messages, `laser
// import`, tests and fuzzers walk the list of those that the program knows.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/environment_series.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

struct ImportOptions;

/// What a format is recognised by.
struct FileStart {
  FileStart(std::string_view whole, std::string_view name);
  [[nodiscard]] bool has(std::string_view lower_case) const { return head.find(lower_case) != std::string::npos; }

  std::string_view text;        ///< decoded, or the bytes of a binary file
  std::string_view file_name;   ///< its extension is a hint where the content leaves a choice
  std::string head;             ///< the first 16 KiB in lower case
  std::string_view first_line;  ///< the first that holds something and is no comment
};

enum class Recognition {
  no,
  likely,  ///< unless another format is certain
  certain
};

/// Units of the errors in a file.
enum class ErrorUnits {
  usual,      ///< mm and mrad, or um and mrad where `holds_um`
  positions,  ///< the file holds positions: the errors have the unit of the targets
  fixed       ///< the format states its units: none can be asked for
};

struct FileFormat {
  std::string_view id;      ///< "renishaw_run", the name of its fuzzer
  std::string_view title;   ///< "Renishaw run file (.rtl .rta .rts)", in messages and JSON
  std::string_view sample;  ///< a file of this format in samples/laser
  Recognition (*recognises)(const FileStart& file) = nullptr;  ///< none: never found by content
  bool is_binary = false;                                      ///< read from the bytes, not from decoded text
  /// Reads the readings; what had to be assumed goes into the notes.
  Result<MeasurementSet> (*read)(std::string_view text, const std::string& file_name,
                                 const ImportOptions& options) = nullptr;
  /// Reads an environment log, instead of readings.
  Result<EnvironmentSeries> (*read_environment)(std::string_view text, const std::string& file_name) = nullptr;
  std::vector<std::string_view> written_extensions = {};  ///< ".rtl"; none: not written
  Result<std::string> (*write)(const MeasurementSet& set, const std::string& file_name) = nullptr;
  bool writes_means = false;  ///< … as means at each target
  ErrorUnits units = ErrorUnits::usual;
  bool holds_um = false;           ///< translations in um instead of mm
  PerAxis<bool> states_place{};    ///< axes whose coordinates the file states
  bool places_in_columns = false;  ///< … or its columns x_mm, y_mm, z_mm do
};

/// In the order of messages and documentation; the first is the measurement CSV, the last are
/// read by a mapping only.
[[nodiscard]] std::span<const FileFormat* const> file_formats();

/// Nothing if no format has this id.
[[nodiscard]] const FileFormat* file_format(std::string_view id);

/// The format by content, the extension only where the content leaves a choice; nothing if no format fits.
/// @param text  decoded, or the bytes of a binary file
[[nodiscard]] const FileFormat* recognised_format(std::string_view text, const std::string& file_name);

/// The format that writes files of this extension (".rtl", any case); the measurement CSV for any other.
[[nodiscard]] const FileFormat& format_written_as(std::string_view extension);

}  // namespace ecs::laser
