// Centroid, version 1 of the ball screw tables: writing and reading. What is not documented is asked for, or said in
// every answer.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "modules/controllers/curve.hpp"
#include "modules/controllers/format.hpp"

namespace ecs::controllers {
namespace {

constexpr double kMostCountsPerMm = 1e6;
constexpr double kMostOfUneven = 1000.0;  ///< steps of a table whose map has uneven ones
constexpr long long kMostValues = 1'000'000;
constexpr long long kMostCounts = 1'000'000'000'000;

std::string centroid_file(Axis axis) { return fmt::format("CNC7{}.TAB", letter_of(axis)); }

bool is_centroid_file(std::string_view name) {
  return std::ranges::any_of(kAllAxes, [&](Axis axis) { return name == centroid_file(axis); });
}

/// Where a table begins, and how far it goes, in counts.
struct ScrewTravel {
  double home_mm = 0.0;
  long long counts = 0;
  [[nodiscard]] double place_mm(std::size_t i, std::size_t values, double counts_per_mm) const {
    const double part = static_cast<double>(i) / static_cast<double>(values - 1);
    return home_mm + static_cast<double>(counts) * part / counts_per_mm;
  }
};

/// From home to the far end of the curve.
Result<ScrewTravel> travel_of(const ControlCurve& curve, Axis axis, double home_mm, double counts_per_mm) {
  const double first_mm = curve.position_mm.front(), last_mm = curve.position_mm.back();
  const double count_mm = 1.0 / counts_per_mm;
  if (home_mm > first_mm + count_mm && home_mm < last_mm - count_mm)
    return problem(ProblemKind::refused,
                   "{}: home ({} mm) is inside the table ({} to {} mm), but a Centroid table runs from home in one "
                   "direction only: give --home {}=POSITION, or a map of one side",
                   letter_of(axis), home_mm, first_mm, last_mm, letter_of(axis));
  const double far_mm = home_mm <= first_mm + count_mm ? last_mm : first_mm;
  const ScrewTravel travel{home_mm, std::llround((far_mm - home_mm) * counts_per_mm)};
  if (travel.counts == 0)
    return problem(ProblemKind::refused, "{}: the table is shorter than one encoder count ({} counts per mm)",
                   letter_of(axis), counts_per_mm);
  return travel;
}

/// How many values at even steps the curve needs at its smallest step.
std::size_t at_smallest_step(const ControlCurve& curve) {
  const auto& p = curve.position_mm;
  double smallest_mm = p.back() - p.front();
  for (std::size_t i = 1; i < p.size(); ++i) smallest_mm = std::min(smallest_mm, p[i] - p[i - 1]);
  const double steps = std::min((p.back() - p.front()) / smallest_mm, kMostOfUneven);
  return std::max(p.size(), static_cast<std::size_t>(std::lround(steps)) + 1);
}

/// How many values at even steps follow the curve from home on, whose end value holds as far as home.
std::size_t values_for(const ControlCurve& curve, const ScrewTravel& travel, std::size_t most) {
  ControlCurve whole = curve;
  if (travel.home_mm < curve.position_mm.front() || travel.home_mm > curve.position_mm.back()) {
    std::vector<double> places = curve.position_mm;
    places.insert(std::ranges::lower_bound(places, travel.home_mm), travel.home_mm);
    whole = resampled(curve, std::move(places));
  }
  const std::size_t points = even_grid(whole, most >= 2 ? most : at_smallest_step(whole)).points;
  return std::min(points, static_cast<std::size_t>(std::abs(travel.counts)) + 1);
}

/// One axis into files, tables, settings and `applied`; false: the map or the machine has none.
Result<bool> add_screw_table(const ExportSource& source, const CentroidOptions& options, Axis axis,
                             ControllerExport& made) {
  const Component component = positioning_curve(axis);
  const auto curve = curve_of(source.map, component);
  if (!curve || !has_axis(source, axis)) return false;
  const double reference_mm = source.parameters.axes[index_of(axis)].datum.reference_position_mm;
  const double home_mm = options.home_mm[index_of(axis)].value_or(reference_mm) + 0.0;
  ECS_TRY(travel, travel_of(*curve, axis, home_mm, options.counts_per_mm));
  const std::size_t values = values_for(mean_of(*curve), travel, options.most_points);
  const double shift_um = mean_at(*curve, home_mm);
  const double counts_per_um = (options.adds ? 1.0 : -1.0) * options.counts_per_mm / kUmPerMm;
  std::string text = fmt::format("{} {}\r\n", values, travel.counts);
  for (std::size_t i = 0; i < values; ++i) {
    const double place_mm = travel.place_mm(i, values, options.counts_per_mm);
    text += fmt::format("{}\r\n", std::llround((mean_at(*curve, place_mm) - shift_um) * counts_per_um));
  }
  const std::string name = centroid_file(axis);
  made.files.push_back({name, std::move(text)});
  CentroidOptions used = options;
  used.home_mm[index_of(axis)] = home_mm;
  auto again = parse_centroid(made.files.back().content, name, axis, used);
  if (!again) return unwritable(again.error());
  const laser::MapTable& table = again->tables.front();
  ControlCurve written{table.position_mm, table.compensation, table.compensation};
  const double largest = largest_in(written);
  for (std::size_t i = 0; i < values; ++i) written.forward[i] = written.reverse[i] = table.compensation[i] + shift_um;
  made.tables.push_back({std::string(name_of(component)), name, curve->position_mm.size(), values, largest,
                         deviation_from_unit(written, source.map, component, source.parameters.interpolation),
                         shift_um});
  made.settings.push_back(
      fmt::format("{}: {} counts from home ({} mm) to {:.3f} mm, {} counts per mm", name, travel.counts, home_mm,
                  travel.place_mm(values - 1, values, options.counts_per_mm), options.counts_per_mm));
  if (const double half_um = 0.5 * largest_reversal(*curve); half_um > 0.0005)
    made.not_carried.push_back({fmt::format("half the reversal of {}", name_of(component)), half_um, "um",
                                "version 1 has one value for both approaches, the mean"});
  ECS_DO(append(made.applied, std::move(*again), true));
  return true;
}

std::string tab_sign_words(bool adds) { return adds ? "adds" : "subtracts"; }

/// What is assumed of every table.
std::vector<std::string> centroid_assumptions(const CentroidOptions& options) {
  return {
      "assumed, because the available description does not state it: values and travel are in encoder counts, and the "
      "second number of the heading is the travel from the first value to the last, its sign the direction from home",
      fmt::format("assumed: the control {} a value, which corrects the position; tested on no control: measure one "
                  "axis again first",
                  tab_sign_words(options.adds))};
}

Result<CentroidOptions> centroid_options(const OptionValues& values) {
  CentroidOptions options;
  const std::string_view counts = values.text("counts-per-mm");
  if (counts.empty())
    return problem(ProblemKind::usage,
                   "--counts-per-mm is needed: the encoder counts of the control per mm of the axis; a Centroid table "
                   "is in encoder counts and does not state how many make 1 mm");
  options.counts_per_mm = number_in(counts).value_or(0.0);
  if (!(options.counts_per_mm >= 1.0 / kMostCountsPerMm && options.counts_per_mm <= kMostCountsPerMm))
    return problem(ProblemKind::usage, "--counts-per-mm: expected a number above 0, at most {}, found \"{}\"",
                   kMostCountsPerMm, counts);
  for (const auto& [axis, position] : axis_pairs(values.text("home"))) {
    const auto home_mm = number_in(position);
    if (!axis || !home_mm || std::abs(*home_mm) > kLargestPosition_mm)
      return problem(ProblemKind::usage, "--home: expected X=MM,Y=MM,Z=MM, as in X=0, found \"{}\"",
                     values.text("home"));
    options.home_mm[index_of(*axis)] = *home_mm;
  }
  options.adds = values.text("tab-sign") != "subtracts";
  options.most_points = static_cast<std::size_t>(values.integer("points"));
  return options;
}

Result<ControllerExport> write_centroid(const ExportSource& source, const OptionValues& values) {
  ECS_TRY(options, centroid_options(values));
  return centroid_export(source, options);
}

Result<ControllerTables> read_centroid(const ReadRequest& request) {
  ECS_TRY(options, centroid_options(request.options));
  ECS_TRY(axis, axis_of_file(request));
  return parse_centroid(request.text, request.file_name, axis, options);
}

/// Two whole numbers, and one in the next line.
bool begins_with_count_and_travel(std::string_view text) {
  std::vector<std::string_view> words;
  std::size_t head = 0;
  for (const std::string_view line : lines_of(text)) {
    const auto more = blank_words(line);
    if (more.empty()) continue;
    words.insert(words.end(), more.begin(), more.end());
    if (head != 0) break;
    head = words.size();
  }
  return head == 2 && words.size() == 3 &&
         std::ranges::all_of(words, [](std::string_view word) { return integer_in(word).has_value(); });
}

const FormatOption kCounts{
    .name = "counts-per-mm",
    .help = "encoder counts of the control per mm of the axis; needed, because the table is in counts"};
const FormatOption kTabSign{.name = "tab-sign",
                            .help = "whether the control adds a value to the position or subtracts it; default adds",
                            .fallback = "adds",
                            .words = {"adds", "subtracts"}};

}  // namespace

Result<ControllerExport> centroid_export(const ExportSource& source, const CentroidOptions& options) {
  ECS_DO(check_exportable(source.map));
  ControllerExport made;
  std::vector<Component> carried;
  for (const Axis axis : kAllAxes) {
    ECS_TRY(added, add_screw_table(source, options, axis, made));
    if (added) carried.push_back(positioning_curve(axis));
  }
  if (carried.empty())
    return problem(ProblemKind::refused,
                   "the map has no positioning table (EXX, EYY, EZZ) of an axis that the machine has: a ball screw "
                   "table contains nothing else");
  leave_behind(made, source, carried, "cannot be corrected by a ball screw table, which has no lever arm",
               "a ball screw table acts along its own axis only");
  made.notes = centroid_assumptions(options);
  made.notes.insert(
      made.notes.end(),
      {"the reversal stays with the backlash compensation of the control: the table holds the mean of both approaches",
       "version 1 of the format (CNC7 6.00 to 7.17): the layout of versions 2 and 3 is not known, nor whether later "
       "software accepts version 1",
       "values are whole encoder counts, zero at home"});
  return made;
}

extern const ControllerFormat centroid_format{
    .id = "centroid",
    .title = "Centroid, ball screw tables version 1",
    .name = "Centroid",
    .summary = "a ball screw table for each axis (.TAB, version 1): positioning, the mean of both approaches",
    .example = "ecs export centroid map.csv --params mill.toml --counts-per-mm 1259.8425 -o centroid/",
    .output_help = "folder for CNC7X.TAB, CNC7Y.TAB, CNC7Z.TAB",
    .marks = "a line of two whole numbers, then one a line",
    .place = 55,
    .holds = {"yes", "mean only", "–", "–", "–", "even steps from home"},
    .resolution_um = 1.0,  // one count, at 1000 counts per mm
    .write_options =
        {kCounts,
         {.name = "home",
          .help = "positions of home in mm, as X=0,Y=0,Z=0; default: the reference positions of the parameters"},
         kTabSign,
         {.name = "points",
          .help =
              "maximum number of values of a table; default: as many as the map has, or needs if its steps are uneven",
          .fallback = "0",
          .range = IntegerRange{2, static_cast<int>(kMostValues)}}},
    .read_options = {{.name = "axis", .help = "axis; default: from the file's name"},
                     kCounts,
                     {.name = "home", .help = "positions of home in mm, as X=0,Y=0,Z=0; default 0"},
                     kTabSign},
    .is_file = is_centroid_file,
    .recognises = begins_with_count_and_travel,
    .write = write_centroid,
    .read = read_centroid,
};

namespace {

struct CentroidHead {
  long long values = 0;
  ScrewTravel travel;
};

/// "24 -1448819"
std::optional<CentroidHead> centroid_head_in(const NumberedLine& line, double home_mm, laser::Findings& findings) {
  const auto words = blank_words(line.text);
  const auto values = words.size() == 2 ? integer_in(words[0]) : std::nullopt;
  const auto counts = words.size() == 2 ? integer_in(words[1]) : std::nullopt;
  if (!values || !counts) {
    findings.add(line.number, 1,
                 "expected two whole numbers, of values and of counts of travel, found {}; versions 2 and 3 of the "
                 "format, with two values a point, cannot be read: their layout is not known",
                 laser::in_quotes(trimmed(line.text)));
    return std::nullopt;
  }
  if (*values < 2 || *values > kMostValues)
    findings.add(line.number, laser::column_of(line.text, words[0]),
                 "expected the number of values, from 2 to {}, found {}", kMostValues, *values);
  else if (*counts > kMostCounts || *counts < -kMostCounts || std::abs(*counts) < *values - 1)
    findings.add(line.number, laser::column_of(line.text, words[1]),
                 "expected the travel in counts, at least one for each step between {} values, found {}", *values,
                 *counts);
  return CentroidHead{*values, {home_mm, *counts}};
}

}  // namespace

Result<ControllerTables> parse_centroid(std::string_view text, const std::string& file_name, Axis axis,
                                        const CentroidOptions& options) {
  laser::Findings findings(file_name);
  std::optional<CentroidHead> head;
  std::vector<std::pair<long long, int>> values;  // with their lines
  for (const NumberedLine& line : numbered_lines_of(text)) {
    const std::string_view content = trimmed(line.text);
    if (content.empty()) continue;
    if (!head) {
      head = centroid_head_in(line, options.home_mm[index_of(axis)].value_or(0.0), findings);
      if (!head) break;
      continue;
    }
    const auto value = integer_in(content);
    if (!value)
      findings.add(line.number, laser::column_of(line.text, content), "expected a whole number of counts, found {}",
                   laser::in_quotes(content));
    values.emplace_back(value.value_or(0), line.number);
  }
  if (findings.empty() && !head) findings.add(0, 0, "no table: the file is empty");
  if (findings.empty() && static_cast<long long>(values.size()) != head->values)
    findings.add(1, 1, "the heading announces {} values, the file has {}", head->values, values.size());
  if (!findings.empty()) return tl::unexpected(findings.as_problem());

  laser::MapTable table{positioning_curve(axis), Approach::unknown, {}, {}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double place_mm = head->travel.place_mm(i, values.size(), options.counts_per_mm);
    const double um =
        (options.adds ? 1.0 : -1.0) * static_cast<double>(values[i].first) / options.counts_per_mm * kUmPerMm + 0.0;
    if (std::abs(place_mm) > kLargestPosition_mm)
      findings.add(values[i].second, 1, "{:.6g} mm is not a plausible position. Is --counts-per-mm right?", place_mm);
    else if (std::abs(um) > kLargestValue_um)
      findings.add(
          values[i].second, 1,
          "a compensation of {:.6g} mm is implausibly large. Is --counts-per-mm right, and is it a Centroid table?",
          um / kUmPerMm);
    table.position_mm.push_back(place_mm);
    table.compensation.push_back(um);
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (head->travel.counts < 0) {
    std::ranges::reverse(table.position_mm);
    std::ranges::reverse(table.compensation);
  }
  ControllerTables read;
  read.notes = {fmt::format("{}: {} values every {:.6g} mm from {} mm to {:.6g} mm", file_name, values.size(),
                            std::abs(static_cast<double>(head->travel.counts)) / options.counts_per_mm /
                                static_cast<double>(values.size() - 1),
                            head->travel.home_mm,
                            head->travel.place_mm(values.size() - 1, values.size(), options.counts_per_mm))};
  for (std::string& note : centroid_assumptions(options)) read.notes.push_back(std::move(note));
  read.sources.push_back({std::string(name_of(table.component)), file_name, sha256_hex(std::string(text))});
  read.tables.push_back(std::move(table));
  return read;
}

}  // namespace ecs::controllers
