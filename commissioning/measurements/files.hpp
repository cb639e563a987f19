// Measurement files: what a file does not say, given as words; reading one; joining several; folders in place of files.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/cli/action.hpp"
#include "base/result.hpp"
#include "commissioning/session/message.hpp"
#include "laser/analysis/curve.hpp"
#include "laser/import/import.hpp"

namespace ecs::commissioning {

/// As typed; empty: not given.
struct ImportArguments {
  std::string axis;
  bool takes_rotary = false;  ///< the work suits rotary axes; false: their readings are refused
  std::string sense;
  std::string parked;  ///< "y=-1400,z=0"
  std::string encoding;
  bool accept_truncated = false;
  bool table_holds_errors = false;
  std::string target_unit;
  std::string reading_unit;
  std::string channel;
  std::string channels;  ///< "x_mm=ENC[mm],reading=AI1": channels of a log, joined by time
  std::string join;      ///< linear, nearest, previous
  std::optional<double> max_gap_s;
  std::optional<double> at_rest_mm;           ///< only rows that stay within this
  bool average = false;                       ///< readings at rest are one
  std::string environment;                    ///< a file of air and temperatures over time
  std::optional<double> environment_every_s;  ///< between its rows, where it has no time
  bool keep_set_up = false;                   ///< shift and rotation of measured positions stay in the errors
  std::string columns;        ///< "x_mm=1,reading=3*0.001,run=2,approach=4": the file is a table, read by this
  int skip = 0;               ///< lines before the table
  int rows = 0;               ///< rows to take; 0: all
  std::string delimiter;      ///< one character, or blank, tab, comma, semicolon
  std::string decimal;        ///< point or comma
  std::string values;         ///< error, actual, compensation
  std::string matrix;         ///< "x=xmin..xmax,y=ymin+20": the file is a matrix of values (laser/import/readers.hpp)
  std::string section;        ///< the part of the file that holds the matrix
  std::string line_prefix;    ///< taken off every line of it
  std::string absent;         ///< a cell of it without a value
  std::string row_begins;     ///< "word date time any": how a row begins; other lines are passed over
  int channel_column = 0;     ///< from 1; 0: none
  std::string target_lines;   ///< the unit of lines that state the target of the rows below
  std::string note;           ///< kept with what had to be assumed
  std::string recognised_by;  ///< a text that files of a profile contain; empty: the lines of `row_begins`
  std::string headings;       ///< of the table that these options were used for; only where they are remembered
  std::string used_for;       ///< the file that was read so
  std::string profile;        ///< name or path of a profile with the answers above

  /// The same for work that suits rotary axes.
  [[nodiscard]] ImportArguments of_any_axis() const {
    ImportArguments any = *this;
    any.takes_rotary = true;
    return any;
  }

  /// Those of `laser import`: what most files need, then the others below headings of their own.
  /// @param sense_option  where --sense means something else to the action
  static cli::Fields<ImportArguments> fields(const std::string& sense_option = "--sense");
};

/// The options of `laser import` that are given, without their dashes: "axis" → "X"; of a flag "yes".
[[nodiscard]] std::map<std::string, std::string> given_answers(ImportArguments arguments);
/// The same as words of a command line: "--axis", "X".
[[nodiscard]] std::vector<std::string> import_words(ImportArguments arguments);
/// One of them from its text; what was expected where that is no number. Another name is passed over.
std::string set_answer(ImportArguments& arguments, const std::string& name, const std::string& value);

/// A `usage` problem names the option that is wrong.
[[nodiscard]] Result<laser::ImportOptions> import_options(const ImportArguments& arguments);

// Profiles: named answers to what a kind of file does not say, the import options, kept in a TOML file.

/// `NAME` → import/NAME.toml beside the configuration file, else the profile of that name that comes with the program
/// (samples/profiles); a name with a slash or ending in .toml is a path.
[[nodiscard]] std::filesystem::path profile_file(const std::string& name);

/// Fills what `arguments` leave open from its profile. A `usage` problem lists the profiles there are if it is none of
/// them; unknown keys and wrong values are refused with their line.
[[nodiscard]] Result<ImportArguments> with_profile(ImportArguments arguments);

/// With neither a profile nor a mapping given: the profile that comes with the program for files whose bytes contain
/// its `recognised_by` or, where it has none, two lines that begin as its `row_begins`, if there is one.
[[nodiscard]] ImportArguments with_found_profile(std::string_view bytes, const std::string& file,
                                                 ImportArguments given);

/// Writes what was given as a profile; the file that was written. A profile of that name is replaced with `force` only.
[[nodiscard]] Result<std::filesystem::path> save_profile(const std::string& name, const ImportArguments& arguments,
                                                         bool force);

// Mappings of columns that a file was read with, kept beside the profiles by the headings of its table.

/// How a file with the same headings was read.
struct RememberedMapping {
  ImportArguments options;  ///< columns by number; the lines to skip are those above the table
  std::string file;         ///< its name
  std::filesystem::path kept_in;
};
/// Nothing: none was read so, or the table has no headings.
[[nodiscard]] std::optional<RememberedMapping> remembered_mapping(const laser::TableShape& shape);
/// Keeps how a file was read. What cannot be written is not remembered, nor a table without headings.
void remember_mapping(const std::string& file, const ImportArguments& options);

/// The beginning of a file in whole lines, decoded: enough to see how its table looks.
struct FileHead {
  std::string text;
  double part = 1.0;  ///< of the bytes of the file
};
/// Nothing where the file cannot be read, or is no text.
[[nodiscard]] std::optional<FileHead> beginning_of_text(const std::string& file, const std::string& encoding = {});

/// Reads a file as whatever it is. A problem over what the file does not say names the options.
/// @param answered  if given: the arguments with those of a profile that was found for the file
[[nodiscard]] Result<laser::Imported> read_measurements(const std::string& file, const ImportArguments& arguments,
                                                        ImportArguments* answered = nullptr);
/// The same of the bytes of a file that was read.
[[nodiscard]] Result<laser::Imported> measurements_in(std::string_view bytes, const std::string& file,
                                                      const ImportArguments& arguments,
                                                      ImportArguments* answered = nullptr);

/// Says what a file was taken for, and what had to be assumed.
void note_what_was_read(MessageSink& messages, const std::string& file, const laser::Imported& imported);
[[nodiscard]] Result<laser::Imported> read_with_notes(MessageSink& messages, const std::string& file,
                                                      const ImportArguments& arguments);

/// Several sets as one. Where two files measured the same line, the runs of the later one are numbered on, and a note
/// says so. Metadata that differ are kept from the first file, with a note. `refused` if the files name different
/// machines or serial numbers.
[[nodiscard]] Result<laser::MeasurementSet> joined(const std::vector<laser::MeasurementSet>& sets);

/// The exclusions of --exclude-run and --exclude-row: "2", or "2,5".
[[nodiscard]] Result<std::vector<laser::Exclusion>> exclusions_of(const std::vector<std::string>& runs,
                                                                  const std::vector<std::string>& rows);

/// A `usage` problem if `output` is one of the files that are read. Empty: nothing is written.
[[nodiscard]] Result<void> check_output_not_input(const std::string& output, const std::vector<std::string>& inputs);

/// The readings of one group as a set of its own.
[[nodiscard]] laser::MeasurementSet set_of(const laser::MeasurementSet& set, const laser::Group& group);

/// The files of a verb that takes several: in place of a folder stand the measurements in it, in the order of their
/// names. A folder without any is refused. Of files of the same bytes only the first is among `files`.
struct GivenFiles {
  std::vector<std::string> files;
  std::vector<std::string> notes;  ///< which were taken of a folder, and the copies
};
/// @param with_paths  files of circles and diagonals are measurements too
[[nodiscard]] Result<GivenFiles> given_files(const std::vector<std::string>& words, bool with_paths = false);

/// By its beginning: a measurement CSV, or a file of an instrument.
[[nodiscard]] bool is_measurement(const std::filesystem::path& path, bool with_paths);

}  // namespace ecs::commissioning
