// What a file is by its content: text at all, of which kind; and reading a file that has to be of one kind.
// Does not live here: code pages (laser/text_decoding.hpp), the formats of instruments (laser/import/format.hpp), a
// look into a whole file (commissioning/files/known_files.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace ecs {

/// "UTF-16LE" or "UTF-16BE" where the bytes are one: by the mark, else by a zero in every second byte of the start.
[[nodiscard]] std::optional<const char*> utf16_order(std::string_view bytes);

/// For readers that take UTF-8 only: the problem with bytes that are UTF-16 or hold a NUL, with its place; else
/// nothing.
[[nodiscard]] std::optional<Problem> why_no_text(std::string_view bytes, const std::string& file_name);

enum class FileKind : std::uint8_t {
  measurements,  ///< of any instrument
  model,
  map,
  parameters,
  machine,
  memory,        ///< a dump of a unit, or a memory image
  datum_record,  ///< a datum sequence
  status,        ///< the saved state of a unit
  part_program,
  lengths,  ///< measured, or a plan of them (modules/lengths/README.md)
  other,
  circle_test,
  diagonal_test,
  surface,  ///< readings along the lines of a surface
  rotary_errors,
  recipe,  ///< of a map
  plan,    ///< of measurements
  logbook,
  workbook,  ///< of a spreadsheet program
  archive,
  pdf,
  picture,
  spindle_test,  ///< a trace of a master ball over the turns of a spindle
  ball_bar,      ///< the result of a ball bar by its maker's program (.b5r)
  gauge_blocks,  ///< measured lengths of artefacts
  true_errors,   ///< of an emulated machine
};

/// "measurements", "model", "error map", …
[[nodiscard]] std::string_view name_of(FileKind kind);

/// Keeps what a module of the program does about a matter that the core meets and leaves to it, such as a kind of file
/// (by its name; in the words, {} is the file). Only before any file is read.
void advise(std::string_view matter, std::string_view words);
/// Empty: no module is there that does anything.
[[nodiscard]] std::string advice_on(std::string_view matter);
inline constexpr std::string_view kTableOfControl = "compensation table of a control";  ///< a matter
inline constexpr std::string_view kReversalOnCircle = "reversal on a circle";           ///< a matter

/// By the beginning of its content; `measurements` is the measurement CSV alone, `other` whatever this does not know.
[[nodiscard]] FileKind kind_of_content(std::string_view beginning);

/// Why a file of that content is not what was wanted: what it is and the command that takes it. Nothing where it is,
/// and where nobody knows what it is.
[[nodiscard]] std::optional<Problem> wrong_kind(FileKind wanted, std::string_view content, const std::string& file);

/// The whole file (base/file.hpp); a `bad_input` problem that names what it is where it is known to be another kind.
[[nodiscard]] Result<std::string> read_file_of(FileKind wanted, const std::filesystem::path& path);

}  // namespace ecs
