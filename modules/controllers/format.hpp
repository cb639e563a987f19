// One file format of a controller: its words, what it holds, its options, writing and reading. Verbs, help, detection,
// documentation and tests walk the list of those that the program knows.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "modules/controllers/tables.hpp"

namespace ecs::controllers {

/// A whole number within least … most.
struct IntegerRange {
  int least = 0, most = 0;
};

/// What a format leaves to its user: `--name` on the command line. Text, unless words, a range or a flag say otherwise.
struct FormatOption {
  std::string_view name;  ///< without dashes
  std::string_view help;
  std::string_view fallback = {};            ///< the value where none was given
  std::vector<std::string_view> words = {};  ///< one of these
  std::optional<IntegerRange> range = {};
  bool is_flag = false;  ///< "1" where it was given, else empty
};

/// The values of options by name.
class OptionValues {
 public:
  OptionValues() = default;
  /// The fallbacks of the options.
  explicit OptionValues(const std::vector<FormatOption>& options);
  void set(std::string_view name, std::string value) { values_[std::string(name)] = std::move(value); }
  /// Empty where there is none.
  [[nodiscard]] std::string_view text(std::string_view name) const;
  /// 0 where there is none.
  [[nodiscard]] int integer(std::string_view name) const;
  [[nodiscard]] bool flag(std::string_view name) const { return !text(name).empty(); }

 private:
  std::map<std::string, std::string> values_;
};

/// "X=AX1,Y=AX2", pair by pair; no axis where the text is no such pair. Empty: no pairs.
[[nodiscard]] std::vector<std::pair<std::optional<Axis>, std::string_view>> axis_pairs(std::string_view text);

/// A file to be read.
struct ReadRequest {
  std::string file_name;
  std::string_view text;   ///< decoded, UTF-8
  std::string_view bytes;  ///< as in the file
  bool only_file = true;   ///< no other file is read with it
  OptionValues options;
};

/// What option "axis" says; nothing if it was not given. A `usage` problem where several files are read.
[[nodiscard]] Result<std::optional<Axis>> axis_option(const ReadRequest& request);

/// What a format can hold of a map, in the words of the documentation.
struct Holds {
  std::string_view positioning, reversal, straightness, squareness, rotations, points;
};

struct ControllerFormat {
  std::string_view id;                ///< "linuxcnc": verb `ecs export linuxcnc`
  std::string_view title;             ///< "SINUMERIK 840D", heading of a report
  std::string_view name;              ///< "SINUMERIK", within a sentence
  std::string_view summary = {};      ///< help of the verb
  std::string_view example = {};      ///< a whole command line
  std::string_view output_help = {};  ///< of -o
  std::string_view marks;             ///< by what a file is recognised, in words
  Holds holds;
  double resolution_um = 0.0;  ///< of the values in a file
  bool tables_add_up = false;  ///< the controller adds several tables of one component
  std::vector<FormatOption> write_options = {};
  std::vector<FormatOption> read_options = {};
  /// Whether the writer names files like that, in a folder. None: one file under any name.
  bool (*is_file)(std::string_view name) = nullptr;
  /// Whether decoded text is of this format.
  bool (*recognises)(std::string_view text) = nullptr;
  /// None: the format is read only, and has no summary, example and resolution.
  Result<ControllerExport> (*write)(const ExportSource& source, const OptionValues& options) = nullptr;
  Result<ControllerTables> (*read)(const ReadRequest& request) = nullptr;
  /// Formats with lever arms: a map that was read, as parameters expect it. @param levers_from_lines  the curves are
  /// those of their measurement lines already; else they count from the machine zero
  laser::ErrorMap (*at_measurement_lines)(const laser::ErrorMap& read, const UnitParameters& parameters,
                                          bool levers_from_lines) = nullptr;
};

/// In the order of menus and documentation.
[[nodiscard]] std::span<const ControllerFormat* const> controller_formats();

/// Nothing if no format has this id.
[[nodiscard]] const ControllerFormat* controller_format(std::string_view id);

/// The first format that recognises decoded text; nothing if none does.
[[nodiscard]] const ControllerFormat* recognised_format(std::string_view text);

/// Its row of the table "What each holds" in modules/controllers/README.md.
[[nodiscard]] std::string holds_row(const ControllerFormat& format);

}  // namespace ecs::controllers
