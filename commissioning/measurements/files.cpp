#include "commissioning/measurements/files.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "commissioning/session/commands.hpp"
#include "laser/csv_columns.hpp"
#include "laser/import/environment.hpp"
#include "laser/import/format.hpp"
#include "laser/text_decoding.hpp"

namespace ecs::commissioning {
namespace {

using laser::MeasurementSet;

/// Where the other axes stood: of the lines of one file. Every reading has its own place.
constexpr const char* kParked = "parked";

/// "y=-1400,z=0" into the entries it names.
Result<PerAxis<std::optional<double>>> parked_in(std::string_view text) {
  PerAxis<std::optional<double>> parked{};
  for (const std::string_view part : split(text, ',')) {
    const auto sides = split(part, '=');
    const std::string name = lower(trimmed(sides.front()));
    const auto axis = name.size() == 1 ? axis_of(static_cast<char>(name[0] - 'a' + 'A')) : std::nullopt;
    const auto value = sides.size() == 2 ? number_in(sides[1]) : std::nullopt;
    if (!axis || !value)
      return problem(ProblemKind::usage, "position of the other axes: expected AXIS=MM, as in y=-1400,z=0, got \"{}\"",
                     trimmed(part));
    parked[index_of(*axis)] = *value;
  }
  return parked;
}

laser::Encoding encoding_named(const std::string& name) {
  for (const auto encoding : {laser::Encoding::utf8, laser::Encoding::windows_1252, laser::Encoding::gbk,
                              laser::Encoding::latin1, laser::Encoding::shift_jis, laser::Encoding::utf16})
    if (name == laser::name_of(encoding)) return encoding;
  return laser::Encoding::automatic;
}

Result<std::optional<laser::Unit>> unit_given(const std::string& name, const char* option) {
  if (name.empty()) return std::optional<laser::Unit>();
  if (const auto unit = laser::unit_named(name)) return std::optional(*unit);
  return problem(ProblemKind::usage, "{}: expected a unit ({}), got \"{}\"", option, laser::unit_names(), name);
}

Result<char> delimiter_given(const std::string& name) {
  if (name.empty()) return '\0';
  if (name.size() == 1) return name[0];
  for (const auto& [word, character] :
       {std::pair{"blank", ' '}, {"tab", '\t'}, {"\\t", '\t'}, {"comma", ','}, {"semicolon", ';'}, {"bar", '|'}})
    if (lower(name) == word) return character;
  return problem(ProblemKind::usage, "--delimiter: expected one character, or blank, tab, comma, semicolon, got \"{}\"",
                 name);
}

laser::TableValues values_given(const ImportArguments& arguments) {
  if (arguments.values == "actual") return laser::TableValues::actual_positions;
  if (arguments.values == "compensation") return laser::TableValues::compensations;
  return laser::TableValues::errors;
}

Result<std::optional<laser::ColumnMapping>> mapping_given(const ImportArguments& arguments) {
  if (arguments.columns.empty()) {
    if (!arguments.matrix.empty()) return std::optional<laser::ColumnMapping>();
    if (arguments.skip > 0 || arguments.rows > 0 || !arguments.delimiter.empty() || !arguments.decimal.empty() ||
        (!arguments.values.empty() && arguments.channels.empty()))
      return problem(
          ProblemKind::usage,
          "--skip, --rows, --delimiter, --decimal and --values need --columns: give the meaning of the columns");
    return std::optional<laser::ColumnMapping>();
  }
  ECS_TRY(mapping, laser::column_mapping(arguments.columns));
  ECS_TRY(delimiter, delimiter_given(arguments.delimiter));
  mapping.delimiter = delimiter;
  mapping.skip_lines = arguments.skip;
  mapping.most_rows = arguments.rows;
  if (!arguments.decimal.empty()) mapping.decimal = arguments.decimal == "comma" ? ',' : '.';
  ECS_TRY(row_begins, laser::cell_kinds(arguments.row_begins));
  ECS_TRY(target_lines, unit_given(arguments.target_lines, "target_lines"));
  mapping.row_begins = std::move(row_begins);
  mapping.channel_column = arguments.channel_column;
  mapping.target_lines = target_lines;
  mapping.values = values_given(arguments);
  return std::optional(std::move(mapping));
}

Result<std::optional<laser::MatrixLayout>> matrix_given(const ImportArguments& arguments) {
  if (arguments.matrix.empty()) return std::optional<laser::MatrixLayout>();
  ECS_TRY(axes, laser::matrix_axes(arguments.matrix));
  ECS_TRY(delimiter, delimiter_given(arguments.delimiter));
  const char between = delimiter == '\0' ? ',' : delimiter;
  return std::optional(laser::MatrixLayout{axes, arguments.section, arguments.line_prefix, arguments.absent, between});
}

bool same_line(const laser::Group& a, const laser::Group& b) {
  return a.axis == b.axis && a.rotary == b.rotary && a.sense == b.sense && a.parked_mm == b.parked_mm &&
         a.parked_deg == b.parked_deg && a.compensated == b.compensated;
}

int largest_run(const MeasurementSet& set, const laser::Group& group) {
  int largest = 0;
  for (const std::size_t i : group.readings) largest = std::max(largest, set.readings[i].run);
  return largest;
}

constexpr std::string_view kInstrument = "instrument";
/// What each line has of its own: it says nothing that two files differ in it.
constexpr std::string_view kOfEachLine[] = {kInstrument, "plan", "readings"};

/// "; they are of another instrument": one line of two instruments is rarely meant.
std::string other_instrument(const MeasurementSet& all, const MeasurementSet& more) {
  const auto first = laser::metadata_value(all, kInstrument), second = laser::metadata_value(more, kInstrument);
  if (!first || !second || *first == *second) return {};
  return fmt::format(
      ", although their instrument is \"{}\" and that of {} is \"{}\"; give the files one by one to judge them "
      "separately",
      *second, all.source, *first);
}

/// Numbers the runs of `more` on from those of the same line in `all`.
void renumber(MeasurementSet& more, const MeasurementSet& all, std::vector<std::string>& notes) {
  const auto known = laser::groups_of(all);
  for (const laser::Group& group : laser::groups_of(more)) {
    const auto same = std::find_if(known.begin(), known.end(), [&](const auto& k) { return same_line(k, group); });
    if (same == known.end()) continue;
    const int offset = largest_run(all, *same);
    for (const std::size_t i : group.readings) more.readings[i].run += offset;
    notes.push_back(fmt::format("{}: its runs of {} are renumbered from {}{}", more.source,
                                laser::curve_name(group.sense, group.axis, group.rotary), offset + 1,
                                other_instrument(all, more)));
  }
}

constexpr const char* kMachineKeys[] = {"machine", "serial_number", "Machine", "Serial No"};

std::string conflict(const MeasurementSet& a, const MeasurementSet& b, std::string_view key) {
  const auto first = laser::metadata_value(a, key), second = laser::metadata_value(b, key);
  if (!first || !second || first->empty() || second->empty() || *first == *second) return {};
  return fmt::format("{}: {} is \"{}\", in {} it is \"{}\"", b.source, key, *second, a.source, *first);
}

Result<void> join_metadata(MeasurementSet& all, const MeasurementSet& more) {
  for (const char* key : kMachineKeys)
    if (const std::string differs = conflict(all, more, key); !differs.empty())
      return problem(ProblemKind::refused, differs + "; files of different machines are not joined");
  for (const laser::MetadataEntry& entry : more.metadata) {
    if (entry.key == kParked) continue;
    const auto known = laser::metadata_value(all, entry.key);
    if (!known)
      all.metadata.push_back(entry);
    else if (*known != entry.value && std::ranges::find(kOfEachLine, entry.key) == std::end(kOfEachLine))
      all.notes.push_back(
          fmt::format("{}: {} is \"{}\", the first file has \"{}\": all readings are used, the header keeps the value "
                      "of the first file",
                      more.source, entry.key, entry.value, *known));
  }
  return {};
}

void join_columns(MeasurementSet& all, const MeasurementSet& more) {
  for (const std::string& column : more.columns)
    if (std::find(all.columns.begin(), all.columns.end(), column) == all.columns.end()) all.columns.push_back(column);
}

Result<std::vector<int>> integers_in(const std::vector<std::string>& words, const char* option) {
  std::vector<int> numbers;
  for (const std::string& word : words)
    for (const std::string_view part : split(word, ',')) {
      const auto number = integer_in(part);
      if (!number || *number < 0 || *number > 1'000'000'000)
        return problem(ProblemKind::usage, "{}: expected whole numbers, got \"{}\"", option, part);
      numbers.push_back(static_cast<int>(*number));
    }
  return numbers;
}

/// Joins the environment of another file by time.
Result<void> with_environment(MeasurementSet& set, const ImportArguments& arguments) {
  ECS_TRY(log, laser::read_any(arguments.environment));
  if (log.environment.rows.empty())
    return tl::unexpected(Problem{ProblemKind::usage,
                                  fmt::format("--environment: expected temperatures, pressure or humidity over time (a "
                                              "SIOS .pos file, or a table with these headings), found {}",
                                              log.format->title),
                                  arguments.environment,
                                  0,
                                  0,
                                  {}});
  return laser::join_environment(set, log.environment, arguments.environment_every_s);
}

/// The option that a problem of usage asks for.
std::string_view option_that_helps(const Problem& wrong) {
  const auto says = [&](std::string_view word) { return wrong.message.find(word) != std::string::npos; };
  if (says("give --channels") || says("--parked")) return "";
  if (wrong.message.starts_with("channels:")) return " (--channels)";
  if (says("channel")) return " (--channel NAME)";
  if (says("across the axis")) return ", for example --axis X --sense EY";
  if (says("EA, EB or EC")) return ", for example --axis X --sense EB";
  if (says("unit")) return " (--target-unit, --reading-unit)";
  if (says("columns") && !says("axis")) return " (--columns)";
  return ", for example --axis X --sense EX";
}

}  // namespace

cli::Fields<ImportArguments> ImportArguments::fields(const std::string& sense_option) {
  using A = ImportArguments;
  using F = cli::Fields<A>;
  using cli::Range, cli::Words;
  return {
      {"--axis", &A::axis,
       "axis that moved in the measurement; overrides the axis stated in an instrument's file. Ignored for a "
       "measurement CSV, which states the axis in every row",
       Words{"X", "Y", "Z", "A", "B", "C"}},
      {sense_option, &A::sense, "which error was measured (sense), if the file does not state it",
       Words{"EX", "EY", "EZ", "EA", "EB", "EC"}},
      {"--parked", &A::parked, "position of the other axes, if the file does not state it, as in y=-1400,z=0 [mm]"},
      {"--columns", &A::columns,
       "read a table: FIELD=COLUMN[unit]*factor, as in x_mm=1[in],reading=3[um]*0.1,run=2,approach=4. "
       "approach=motion and run=motion: approach or run is derived from the order of the positions"},
      {"--profile", &A::profile, "use the import options saved under this name or path"},
      F{{"--encoding", &A::encoding, "code page; detected if not given",
         Words{"UTF-8", "Windows-1252", "GBK", "ISO-8859-1", "Shift-JIS", "UTF-16"}},
        {"--target-unit", &A::target_unit,
         "unit of the targets if it is not mm or degrees, for example inch or arcsec"},
        {"--reading-unit", &A::reading_unit,
         "unit of the readings if it is not the usual one of the format, for example mil or arcsec"},
        {"--accept-truncated", &A::accept_truncated, "read the complete part of a truncated file"},
        {"--table-holds-errors", &A::table_holds_errors, "read the values of a .REN table as errors, not compensation"}}
          .under("More about a measurement file"),
      F{{"--skip", &A::skip, "number of lines before the table", Range{0, 1'000'000}},
        {"--rows", &A::rows, "number of table rows to read; 0: all", Range{0, 1'000'000}},
        {"--delimiter", &A::delimiter,
         "separator: one character, or blank, tab, comma, semicolon; detected if not given"},
        {"--decimal", &A::decimal, "decimal separator of the table; both are accepted if not given",
         Words{"point", "comma"}},
        {"--values", &A::values, "meaning of the readings of the table; default: error",
         Words{"error", "actual", "compensation"}},
        {"--keep-set-up", &A::keep_set_up,
         "do not remove shift and rotation of the set-up from measured_x_mm, measured_y_mm, ..."}}
          .under("With --columns"),
      F{{"--channel", &A::channel, "channel to read if a log has several"},
        {"--channels", &A::channels, "channels to join by time, as in x_mm=ENC[mm],reading=AI1[um]"},
        {"--join", &A::join, "interpolation of channels in time; linear if not given",
         Words{"linear", "nearest", "previous"}},
        {"--max-gap", &A::max_gap_s,
         "largest gap over which channels are joined [s]; default: 5 times the usual interval"},
        {"--at-rest", &A::at_rest_mm, "use only rows whose position is constant within this range [mm]"},
        {"--average", &A::average, "average the readings of each standstill into one"},
        {"--environment", &A::environment,
         "file with air data and temperatures over time: .pos, or a table with headings"},
        {"--environment-every", &A::environment_every_s,
         "interval between the rows of --environment, if that file has no time column [s]"}}
          .under("For readings recorded over time")};
}

namespace {

/// An answer as text, whatever its kind; empty: not given.
std::string answer_text(const cli::Argument& option) {
  return std::visit(
      [](const auto& value) -> std::string {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::string*>) return *value;
        if constexpr (std::is_same_v<Value, std::optional<double>*>) return *value ? shortest(**value) : "";
        if constexpr (std::is_same_v<Value, int*>) return *value > 0 ? std::to_string(*value) : "";
        if constexpr (std::is_same_v<Value, bool*>) return *value ? "yes" : "";
        return {};
      },
      option.into);
}

}  // namespace

std::map<std::string, std::string> given_answers(ImportArguments arguments) {
  std::map<std::string, std::string> given;
  for (const cli::Argument& option : cli::fields_of<ImportArguments>().arguments_for(arguments))
    if (std::string text = answer_text(option); !text.empty()) given[option.name.substr(2)] = std::move(text);
  return given;
}

std::vector<std::string> import_words(ImportArguments arguments) {
  std::map<std::string, std::vector<std::string>> by_name;
  for (const cli::Argument& option : cli::fields_of<ImportArguments>().arguments_for(arguments))
    if (std::string text = answer_text(option); !text.empty())
      by_name[option.name] = option.is_flag() ? std::vector{option.name} : std::vector{option.name, std::move(text)};
  std::vector<std::string> words;
  for (const auto& [name, with_value] : by_name) words.insert(words.end(), with_value.begin(), with_value.end());
  return words;
}

std::string set_answer(ImportArguments& arguments, const std::string& name, const std::string& value) {
  for (const cli::Argument& option : cli::fields_of<ImportArguments>().arguments_for(arguments)) {
    if (option.name.substr(2) != name) continue;
    auto* const* number = std::get_if<std::optional<double>*>(&option.into);
    auto* const* count = std::get_if<int*>(&option.into);
    if ((number != nullptr || count != nullptr) && !value.empty() && !number_in(value))
      return fmt::format("{}: expected a number, found \"{}\"", name, value);
    if (number != nullptr) **number = number_in(value);
    if (count != nullptr) **count = static_cast<int>(integer_in(value).value_or(0));
    if (auto* const* text = std::get_if<std::string*>(&option.into)) **text = value;
    if (auto* const* flag = std::get_if<bool*>(&option.into)) **flag = value == "yes";
  }
  return {};
}

std::optional<FileHead> beginning_of_text(const std::string& file, const std::string& encoding) {
  constexpr std::size_t kBytes = 256U << 10;
  std::error_code error;
  const auto size = static_cast<double>(std::filesystem::file_size(file, error));
  std::string bytes = error ? std::string() : head_of(file, kBytes);
  if (bytes.empty()) return std::nullopt;
  const bool is_part = bytes.size() == kBytes && size > static_cast<double>(kBytes);
  const bool wide = bytes.find('\0') != std::string::npos;  // UTF-16: an even number of bytes is whole characters
  if (is_part && !wide) bytes.resize(std::min(bytes.rfind('\n') + 1, bytes.size()));
  auto text = laser::decoded(bytes, file, encoding_named(encoding));
  if (!text) return std::nullopt;
  FileHead head{std::string(text->text), std::min(1.0, static_cast<double>(bytes.size()) / size)};
  if (is_part) head.text.resize(head.text.rfind('\n') + 1);
  return head;
}

void note_what_was_read(MessageSink& messages, const std::string& file, const laser::Imported& imported) {
  messages.note(fmt::format("{}: read as {}", file, imported.format->title));
  for (const std::string& note : imported.set.notes) messages.note(fmt::format("{}: {}", file, note));
}

Result<laser::Imported> read_with_notes(MessageSink& messages, const std::string& file,
                                        const ImportArguments& arguments) {
  ECS_TRY(imported, read_measurements(file, arguments));
  note_what_was_read(messages, file, imported);
  return imported;
}

Result<laser::ImportOptions> import_options(const ImportArguments& given) {
  ECS_TRY(whole, with_profile(given));
  const ImportArguments& arguments = whole;
  laser::ImportOptions options;
  ECS_TRY(target_unit, unit_given(arguments.target_unit, "--target-unit"));
  ECS_TRY(reading_unit, unit_given(arguments.reading_unit, "--reading-unit"));
  ECS_TRY(mapping, mapping_given(arguments));
  ECS_TRY(matrix, matrix_given(arguments));
  options.target_unit = target_unit;
  options.reading_unit = reading_unit;
  options.mapping = std::move(mapping);
  if (options.mapping && options.mapping->rules.empty() && options.mapping->no_approach) {
    options.approach_unknown = true;
    options.mapping.reset();
  }
  options.matrix = std::move(matrix);
  if (!arguments.channels.empty()) {
    ECS_TRY(channels, laser::column_mapping(arguments.channels));
    options.channels = std::move(channels);
    options.channels->values = values_given(arguments);
  }
  if (arguments.join == "nearest") options.joining = laser::Joining::nearest;
  if (arguments.join == "previous") options.joining = laser::Joining::previous;
  options.greatest_gap_s = arguments.max_gap_s;
  options.at_rest_mm = arguments.at_rest_mm;
  options.average = arguments.average;
  options.keep_set_up = arguments.keep_set_up;
  options.note = arguments.note;
  options.channel = arguments.channel;
  if (const auto named = laser::axis_named(arguments.axis)) {
    options.axis = named->axis;
    options.rotary = named->rotary;
  }
  options.takes_rotary = arguments.takes_rotary;
  if (!arguments.sense.empty()) options.sense = sense_named(arguments.sense);
  if (!arguments.parked.empty()) {
    ECS_TRY(parked, parked_in(arguments.parked));
    for (const Axis axis : kAllAxes) {
      options.parked_mm[index_of(axis)] = parked[index_of(axis)].value_or(0.0);
      options.parked_stated[index_of(axis)] = parked[index_of(axis)].has_value();
    }
  }
  options.encoding = encoding_named(arguments.encoding);
  options.accept_truncated = arguments.accept_truncated;
  options.table_holds_errors = arguments.table_holds_errors;
  return options;
}

Result<laser::Imported> read_measurements(const std::string& file, const ImportArguments& arguments,
                                          ImportArguments* answered) {
  if (answered != nullptr) *answered = arguments;
  ECS_TRY(bytes, read_file(file));
  return measurements_in(bytes, file, arguments, answered);
}

namespace {

/// Adds how a file with the same headings was read: it is said, and left to the user.
void add_remembered(Problem& problem, const std::string& file) {
  const auto head = beginning_of_text(file);
  if (!head || laser::recognised_format(head->text, file) != nullptr) return;
  const auto shape = laser::table_shape(head->text);
  const auto known = shape ? remembered_mapping(*shape) : std::nullopt;
  if (!known) return;
  const std::string hint = fmt::format(
      ". A file with these headings, {}, was read with {}; the same options read this one. Delete {} if they are not "
      "to be suggested again",
      known->file, shell_command(import_words(known->options)), known->kept_in.string());
  problem.message.insert(std::min(problem.message.find(". Known formats: "), problem.message.size()), hint);
}

}  // namespace

Result<laser::Imported> measurements_in(std::string_view bytes, const std::string& file,
                                        const ImportArguments& arguments, ImportArguments* answered) {
  const ImportArguments all = with_found_profile(bytes, file, arguments);
  if (answered != nullptr) *answered = all;
  ECS_TRY(options, import_options(all));
  auto imported = laser::imported_from(bytes, file, options);
  if (!imported && imported.error().kind == ProblemKind::usage)
    imported.error().message += option_that_helps(imported.error());
  if (!imported && !options.mapping && !options.matrix && imported.error().kind == ProblemKind::bad_input)
    add_remembered(imported.error(), file);
  if (imported && imported->set.source.empty()) imported->set.source = file;
  if (imported && !arguments.environment.empty()) ECS_DO(with_environment(imported->set, arguments));
  return imported;
}

namespace {

bool names_machine(const MeasurementSet& set) {
  return std::ranges::any_of(kMachineKeys, [&](const char* key) {
    const auto value = laser::metadata_value(set, key);
    return value && !value->empty();
  });
}

}  // namespace

Result<MeasurementSet> joined(const std::vector<MeasurementSet>& sets) {
  if (sets.empty()) return MeasurementSet{};
  MeasurementSet all = sets.front();
  bool unnamed = false;
  for (std::size_t i = 1; i < sets.size(); ++i) {
    MeasurementSet more = sets[i];
    ECS_DO(join_metadata(all, more));
    const std::size_t before = all.notes.size();
    renumber(more, all, all.notes);
    unnamed = unnamed || (all.notes.size() > before && !(names_machine(more) && names_machine(sets.front())));
    join_columns(all, more);
    all.notes.insert(all.notes.end(), more.notes.begin(), more.notes.end());
    all.readings.insert(all.readings.end(), more.readings.begin(), more.readings.end());
  }
  if (unnamed)
    all.notes.push_back(
        "not all of these files name their machine: the same line in several files is treated as runs on one machine, "
        "and "
        "their differences are treated as noise. Give files of different machines one by one");
  const auto parked = laser::metadata_value(all, kParked);
  if (std::any_of(sets.begin(), sets.end(),
                  [&](const MeasurementSet& set) { return laser::metadata_value(set, kParked) != parked; }))
    std::erase_if(all.metadata, [](const laser::MetadataEntry& entry) { return entry.key == kParked; });
  return all;
}

Result<std::vector<laser::Exclusion>> exclusions_of(const std::vector<std::string>& runs,
                                                    const std::vector<std::string>& rows) {
  ECS_TRY(run_numbers, integers_in(runs, "--exclude-run"));
  ECS_TRY(row_numbers, integers_in(rows, "--exclude-row"));
  std::vector<laser::Exclusion> exclusions;
  for (const int run : run_numbers) exclusions.emplace_back().run = run;
  for (const int row : row_numbers) exclusions.emplace_back().row = row;
  return exclusions;
}

Result<void> check_output_not_input(const std::string& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code error;
    if (!output.empty() && std::filesystem::equivalent(input, output, error))
      return problem(ProblemKind::usage, "{} would be overwritten: give another output name", input);
  }
  return {};
}

MeasurementSet set_of(const MeasurementSet& set, const laser::Group& group) {
  MeasurementSet own = set;
  own.readings.clear();
  for (const std::size_t i : group.readings) own.readings.push_back(set.readings[i]);
  return own;
}

bool is_measurement(const std::filesystem::path& path, bool with_paths) {
  constexpr std::size_t kBeginning = 64U << 10;
  const std::string head = head_of(path, kBeginning);
  const FileKind kind = kind_of_content(head);
  if (kind == FileKind::circle_test || kind == FileKind::diagonal_test || kind == FileKind::gauge_blocks)
    return with_paths;
  if (kind != FileKind::other) return kind == FileKind::measurements;
  if (laser::recognised_format(head, path.string()) != nullptr) return true;
  const auto text = laser::decoded(head, path.string());
  return text && laser::recognised_format(text->text, path.string()) != nullptr;
}

namespace {

/// Leaves the first of files of the same bytes. What cannot be read, or only once (a pipe), is compared with none.
void leave_out_copies(GivenFiles& given) {
  std::map<std::string, std::string> file_of;  // by SHA-256
  std::vector<std::string> kept, copies;
  for (const std::string& file : given.files) {
    std::error_code error;
    const auto bytes = std::filesystem::is_regular_file(file, error) ? read_file(file) : std::string();
    const bool comparable = bytes && !bytes->empty();
    const auto [first, is_new] = file_of.try_emplace(comparable ? sha256_hex(*bytes) : file, file);
    if (is_new || !comparable)
      kept.push_back(file);
    else
      copies.push_back(file == first->second ? file + " (given twice)"
                                             : fmt::format("{} (of {})", file, first->second));
  }
  given.files = std::move(kept);
  if (!copies.empty())
    given.notes.push_back(fmt::format("exact copies of files count once: {}", fmt::join(copies, ", ")));
}

}  // namespace

Result<GivenFiles> given_files(const std::vector<std::string>& words, bool with_paths) {
  namespace fs = std::filesystem;
  GivenFiles given;
  for (const std::string& word : words) {
    std::error_code error;
    if (!fs::is_directory(word, error)) {
      given.files.push_back(word);
      continue;
    }
    std::vector<std::string> taken, names;
    std::size_t others = 0;
    for (const auto& entry : fs::directory_iterator(word, error)) {
      const fs::path& path = entry.path();
      if (!entry.is_regular_file(error) || path.filename().string().starts_with('.')) continue;
      if (is_measurement(path, with_paths))
        taken.push_back(path.string());
      else
        ++others;
    }
    std::sort(taken.begin(), taken.end());
    if (taken.empty())
      return problem_at(word, 0, 0,
                        "a folder without measurement files: expected files that `ecs laser import` reads, such as "
                        ".csv, .rtl, .rta, .rts, .pos or .dat");
    for (const std::string& path : taken) names.push_back(fs::path(path).filename().string());
    given.notes.push_back(fmt::format("{} is a folder. Its measurement files are {}{}", word, fmt::join(names, ", "),
                                      others > 0 ? fmt::format("; {} other files are ignored", others) : ""));
    given.files.insert(given.files.end(), taken.begin(), taken.end());
  }
  if (given.files.size() > 1) leave_out_copies(given);
  return given;
}

}  // namespace ecs::commissioning
