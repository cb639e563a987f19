// What the engineer chose on the way from laser files to a map: small, kept on disc as a draft, undone by putting an
// older value in its place. The files of it as measured lines: one axis, one sense, one place, the readings of all
// files that hold them; as files that a map can name: joined, without what is left out, with a place corrected.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/cli/action.hpp"
#include "commissioning/measurements/fields.hpp"
#include "commissioning/measurements/files.hpp"
#include "core/axis.hpp"
#include "laser/map/recipe.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::commissioning {

struct LaserFileChoice {
  std::string path;
  ImportArguments answers;  ///< what the file does not say
  /// Where the other axes stood, as in "y=-1400,z=0", where the file states it wrongly; by the line as the file states
  /// it (LaserLine::stated).
  std::map<std::string, std::string> places{};
};

/// Readings left out of one measured line, each with its reason (may be empty). Nothing is removed from any file.
struct LaserLineChoice {
  std::map<int, std::string> runs;
  std::map<std::size_t, std::string> readings;  ///< by their place in the line
  friend bool operator==(const LaserLineChoice&, const LaserLineChoice&) = default;
};

struct LaserChoices {
  std::vector<LaserFileChoice> files;
  std::map<std::string, LaserLineChoice> lines;  ///< by LaserLine::key
  /// Its header (empty: from the files, else from the parameters), what is done to each component, what is declared
  /// zero; which files the components have follows from the lines.
  laser::MapRecipe recipe;
  std::string opened_map;  ///< an error map taken as it is, in place of one from the lines; empty: none
  std::string params_file;
  std::string scope;  ///< "linear", "planar", "volumetric"; empty: as in the parameters
  std::string map_file = "map.csv";
};

/// JSON; reading it back gives the same choices.
[[nodiscard]] std::string choices_text(const LaserChoices& choices);
/// Nothing if it is no such text.
[[nodiscard]] std::optional<LaserChoices> choices_in(const std::string& text);
[[nodiscard]] inline bool operator==(const LaserChoices& a, const LaserChoices& b) {
  return choices_text(a) == choices_text(b);
}

/// A file, read or not.
struct LaserFile {
  LaserFileChoice choice;
  std::string stamp;                                 ///< size and time of writing when it was read
  std::string format;                                ///< "measurement CSV"
  std::string summary;                               ///< "EXX, 498 readings"
  std::shared_ptr<const laser::MeasurementSet> set;  ///< null: not read
  std::string sha256;
  std::string problem;             ///< why not
  bool wants_answers = false;      ///< it would be read with answers
  bool wants_columns = false;      ///< … with the meaning of its columns
  bool is_map = false;             ///< no measurement, but an error map
  PerAxis<bool> position_known{};  ///< file or answers say where this axis stood
};
[[nodiscard]] LaserFile read_laser_file(const LaserFileChoice& choice);
/// What was read of this file with these answers; null: nothing yet.
[[nodiscard]] const LaserFile* file_read(const std::vector<LaserFile>& files, const LaserFileChoice& choice);
/// Size and time of writing; empty: there is no such file.
[[nodiscard]] std::string stamp_of(const std::string& path);

struct LaserLine {
  std::string key;                       ///< the same as long as the line is the same: "EX along X at Y -1400, Z 0"
  Component component = Component::EXX;  ///< the curve, or the squareness that an indicator on a square shows
  bool square = false;                   ///< read on a square
  std::string place;                     ///< "Y -1400, Z 0"; "Y ?, Z 0" where nothing says it: taken as 0
  std::vector<Axis> place_unknown;       ///< the axes whose place nothing says
  std::shared_ptr<const laser::MeasurementSet> set;  ///< its readings and no others
  laser::Group group;                                ///< all of them
  LineSummary summary;
  std::vector<std::string> files;
  std::vector<std::string> stated;  ///< the key of the line as each of the files states it
  std::vector<std::string> notes;
  /// Of the one file that holds this line alone and says all of it: a map can name it as it is. Empty: there is none.
  std::string whole_file_sha256;
  std::vector<std::size_t> suspects;  ///< readings far from their repeats; nothing is done to them
};

/// Corrects where the other axes stood in all files of the line. @param parked  "y=-1400,z=0"; empty: as the files say.
/// A `usage` problem names what is wrong.
[[nodiscard]] Result<void> correct_place(LaserChoices& choices, const LaserLine& line, const std::string& parked);

/// What is missing of the place and what tells it, in words; empty: nothing is.
[[nodiscard]] std::string missing_place_of(const LaserLine& line);

/// "EXX", "C0Y (square)"
[[nodiscard]] std::string name_of_line(const LaserLine& line);

/// In the order of the components. Files that measured the same line are joined, their runs numbered on; what cannot be
/// joined stands apart, with a note.
[[nodiscard]] std::vector<LaserLine> laser_lines(const std::vector<LaserFile>& files);

/// The line without what is left out, and said so in its metadata.
[[nodiscard]] laser::MeasurementSet prepared_set(const LaserLine& line, const LaserLineChoice& choice);

/// `ecs laser prepare`.
struct PrepareRequest {
  std::vector<std::string> files;
  std::string line;                         ///< as a file states it; empty: the only one
  std::string place;                        ///< that corrects the stated one; empty: it stays
  std::vector<std::string> runs, readings;  ///< left out: "3=vibration", "3"; readings from 1
  std::string output;
  ImportArguments import;  ///< for all files
  static cli::Fields<PrepareRequest> fields();
};
/// A `usage` problem where there is no such line, run or reading: it names those that there are.
[[nodiscard]] Result<laser::MeasurementSet> prepared_line(const PrepareRequest& request);

/// The words of `ecs laser prepare` for a line of the screen. Nothing where its files have different answers or places.
/// @param files  of the screen, with their answers
[[nodiscard]] std::optional<std::vector<std::string>> prepare_words(const LaserLine& line,
                                                                    const LaserLineChoice& left_out,
                                                                    const std::vector<LaserFileChoice>& files,
                                                                    const std::string& output);

}  // namespace ecs::commissioning
