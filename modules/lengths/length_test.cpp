#include "modules/lengths/length_test.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/csv_table.hpp"
#include "laser/findings.hpp"

namespace ecs::model {
namespace {

constexpr std::array<std::string_view, 9> kLengthColumns{"set_up", "run",        "tool",       "x_mm",      "y_mm",
                                                         "z_mm",   "approach_x", "approach_y", "approach_z"};
constexpr std::string_view kDeviation = "deviation_um";
constexpr std::array<std::string_view, kAxes> kDeviations{"deviation_x_um", "deviation_y_um", "deviation_z_um"};
/// Across the line of an interferometer, over its length: 1 mm a metre costs 0.5 um/m of cosine error.
constexpr double kOffLine_mm = 0.01, kOffLine_per_mm = 1e-3;
constexpr double kNearest_mm = 10.0;
constexpr double kFarthest_mm = 1e6;  ///< no machine, tool or station is a kilometre away
/// A deviation beyond this is a length, not a deviation.
constexpr double kLargestDeviation_um = 1e5;

struct InstrumentWord {
  LengthInstrument instrument;
  std::string_view word;
};
constexpr std::array<InstrumentWord, 4> kInstrumentWords{{{LengthInstrument::interferometer, "interferometer"},
                                                          {LengthInstrument::tracker, "tracker"},
                                                          {LengthInstrument::ball_bar, "ball_bar"},
                                                          {LengthInstrument::points, "points"}}};

std::vector<std::string> words_in(std::string_view text) {
  std::vector<std::string> words;
  for (const auto word : split(text, ' '))
    if (!trimmed(word).empty()) words.emplace_back(trimmed(word));
  return words;
}

std::optional<Vector3> vector_in(const std::vector<std::string>& words, std::size_t first) {
  Vector3 out{};
  if (words.size() != first + kAxes) return std::nullopt;
  for (std::size_t a = 0; a < kAxes; ++a) {
    const auto number = number_in(words[first + a]);
    if (!number || std::abs(*number) > kFarthest_mm) return std::nullopt;
    out[a] = *number;
  }
  return out;
}

class LengthReader {
 public:
  LengthReader(const laser::CsvTable& table, laser::Findings& findings, LengthTest& test, bool plan)
      : table_(table),
        findings_(findings),
        test_(test),
        plan_(plan),
        points_(std::ranges::any_of(kDeviations, [&](auto column) { return place_of(table, column).has_value(); })) {}

  void read() {
    if (plan_ && points_) return findings_.add(0, 0, "expected a plan of lengths, found deviations of points");
    if (!plan_ && !points_ && !place_of(table_, kDeviation))
      return findings_.add(table_.header_line, 0, "expected a column deviation_um, found none");
    for (const laser::MetadataEntry& entry : table_.metadata) take(entry);
    if (test_.tools.empty())
      findings_.add(0, 0, "expected a line `# tool: NAME X Y Z` with the offset of the reflector in mm, found none");
    if (test_.set_ups.empty())
      findings_.add(0, 0,
                    points_ ? "expected a line `# set_up: NAME points`, found none"
                            : "expected a line `# set_up: NAME interferometer DX DY DZ`, `# set_up: NAME tracker X Y "
                              "Z` or `# set_up: NAME ball_bar X Y Z`, found none");
    for (const laser::CsvRow& row : table_.rows) take(row);
    if (findings_.empty()) check();
  }

 private:
  void take(const laser::MetadataEntry& entry) {
    const auto words = words_in(entry.value);
    if (entry.key == "machine") test_.machine = entry.value;
    if (entry.key == "configuration") test_.configuration = entry.value;
    if (entry.key == "minutes") test_.minutes = number_in(entry.value);
    if (entry.key == "bar_um") {
      test_.bar_um = number_in(entry.value);
      if (!test_.bar_um || !(*test_.bar_um > 0.0)) {
        test_.bar_um.reset();
        findings_.add(0, 0, "bar_um: expected the standard uncertainty of the ball bar's length, above 0, found {}",
                      laser::in_quotes(entry.value));
      }
    }
    if (entry.key == "knots_mm") {
      const auto knots = vector_in(words, 0);
      if (!knots || std::ranges::any_of(*knots, [](double mm) { return !(mm > 0.0); }))
        findings_.add(0, 0, "knots_mm: expected three lengths above 0, found {}", laser::in_quotes(entry.value));
      else
        for (std::size_t a = 0; a < kAxes; ++a) test_.knots_mm[a] = (*knots)[a];
    }
    if (entry.key == "tool") take_tool(words, entry.value);
    if (entry.key == "set_up") take_set_up(words, entry.value);
  }

  /// Names stand in cells as they are.
  static bool is_name(const std::string& word) { return word.find_first_of(",;\"\t") == std::string::npos; }

  void take_tool(const std::vector<std::string>& words, const std::string& value) {
    const auto offset = vector_in(words, 1);
    if (!offset || !is_name(words[0]))
      findings_.add(0, 0, "tool: expected NAME X Y Z in mm, found {}", laser::in_quotes(value));
    else if (find(test_.tools, words[0]))
      findings_.add(0, 0, "tool: {} is described twice", words[0]);
    else
      test_.tools.push_back({words[0], *offset});
  }

  /// "NAME points", in a file of deviations; there nothing else.
  void take_placement(const std::vector<std::string>& words, const std::string& value) {
    if (words.size() != 2 || words[1] != word_of(LengthInstrument::points) || !is_name(words[0]))
      findings_.add(0, 0, "set_up: expected NAME points in a file with deviation_x_um, found {}",
                    laser::in_quotes(value));
    else if (find(test_.set_ups, words[0]))
      findings_.add(0, 0, "set_up: {} is described twice", words[0]);
    else
      test_.set_ups.push_back({words[0], LengthInstrument::points, {}, 0});
  }

  void take_set_up(const std::vector<std::string>& words, const std::string& value) {
    if (points_) return take_placement(words, value);
    const auto place = vector_in(words, 2);
    const auto kind = std::find_if(kInstrumentWords.begin(), kInstrumentWords.end(),
                                   [&](const auto& one) { return words.size() > 1 && one.word == words[1]; });
    if (!place || kind == kInstrumentWords.end() || kind->instrument == LengthInstrument::points ||
        !is_name(words[0])) {
      findings_.add(0, 0,
                    "set_up: expected NAME, one of interferometer, tracker, ball_bar, and three numbers "
                    "(direction, or station in mm), found {}",
                    laser::in_quotes(value));
      return;
    }
    LengthSetUp set_up{words[0], kind->instrument, *place, 0};
    if (find(test_.set_ups, set_up.name)) {
      findings_.add(0, 0, "set_up: {} is described twice", set_up.name);
      return;
    }
    if (set_up.instrument == LengthInstrument::interferometer) {
      const double length = std::hypot(set_up.place[0], set_up.place[1], set_up.place[2]);
      if (!(length > 0.0)) {
        findings_.add(0, 0, "set_up {}: expected a direction, found 0 0 0", set_up.name);
        return;
      }
      for (double& part : set_up.place) part /= length;
    }
    test_.set_ups.push_back(std::move(set_up));
  }

  template <class Named>
  static std::optional<std::size_t> find(const std::vector<Named>& list, std::string_view name) {
    for (std::size_t i = 0; i < list.size(); ++i)
      if (list[i].name == name) return i;
    return std::nullopt;
  }

  std::optional<double> number(const laser::CsvRow& row, std::string_view column) {
    const laser::CsvField& field = row.fields[*place_of(table_, column)];
    const auto value = number_in(field.text);
    if (!value)
      findings_.add(row.line, field.column, "{}: expected a number, found {}", column, laser::in_quotes(field.text));
    return value;
  }

  template <class Named>
  std::optional<std::size_t> named(const laser::CsvRow& row, std::string_view column, const std::vector<Named>& list) {
    const laser::CsvField& field = row.fields[*place_of(table_, column)];
    const auto place = find(list, field.text);
    if (!place && !list.empty())
      findings_.add(row.line, field.column, "{}: expected a name from a line `# {}: ` at the top of the file, found {}",
                    column, column, laser::in_quotes(field.text));
    return place;
  }

  void take(const laser::CsvRow& row) {
    LengthReading reading;
    reading.line = row.line;
    const auto set_up = named(row, "set_up", test_.set_ups);
    const auto tool = named(row, "tool", test_.tools);
    const auto run = number(row, "run");
    constexpr double kMostRuns = 1e6;
    const bool counted = run && *run == std::floor(*run) && *run >= 1.0 && *run <= kMostRuns;
    if (run && !counted)
      findings_.add(row.line, row.fields[*place_of(table_, "run")].column,
                    "run: expected a whole number from 1, found {:g}", *run);
    bool whole = set_up && tool && counted;
    constexpr std::array<std::string_view, kAxes> kPlaces{"x_mm", "y_mm", "z_mm"};
    constexpr std::array<std::string_view, kAxes> kApproaches{"approach_x", "approach_y", "approach_z"};
    for (std::size_t a = 0; a < kAxes; ++a) {
      const auto mm = number(row, kPlaces[a]), side = number(row, kApproaches[a]);
      if (side && *side != 1.0 && *side != -1.0)
        findings_.add(row.line, row.fields[*place_of(table_, kApproaches[a])].column,
                      "{}: expected 1 or -1, the direction of the last motion, found {:g}", kApproaches[a], *side);
      if (mm && std::abs(*mm) > kFarthest_mm)
        findings_.add(row.line, row.fields[*place_of(table_, kPlaces[a])].column,
                      "{}: expected a position in mm, found {:g}", kPlaces[a], *mm);
      whole = whole && mm && side;
      reading.position_mm[a] = mm.value_or(0.0);
      reading.approach[a] = side.value_or(1.0) < 0.0 ? -1 : 1;
    }
    const auto add = [&](std::optional<double> deviation_um) {
      if (!whole || !deviation_um) return;
      reading.set_up = *set_up;
      reading.tool = *tool;
      reading.run = static_cast<int>(*run);
      reading.deviation_um = *deviation_um;
      test_.readings.push_back(reading);
    };
    if (plan_) return add(0.0);
    if (!points_) return add(deviation(row, kDeviation));
    bool any = false;
    for (std::size_t a = 0; a < kAxes; ++a) {
      const auto place = place_of(table_, kDeviations[a]);
      if (!place || trimmed(row.fields[*place].text).empty()) continue;
      any = true;
      reading.along = {};
      reading.along[a] = 1.0;
      add(deviation(row, kDeviations[a]));
    }
    if (!any) findings_.add(row.line, 0, "expected a deviation along one axis or more, found none");
  }

  std::optional<double> deviation(const laser::CsvRow& row, std::string_view column) {
    const auto um = number(row, column);
    if (um && std::abs(*um) > kLargestDeviation_um)
      findings_.add(row.line, row.fields[*place_of(table_, column)].column,
                    "{}: expected measured minus nominal {}, at most {:g} um, found {:g}", column,
                    points_ ? "coordinate" : "length", kLargestDeviation_um, *um);
    return um;
  }

  void check() {
    for (std::size_t s = 0; s < test_.set_ups.size(); ++s) check(s);
    if (test_.readings.empty()) findings_.add(table_.header_line, 0, "expected readings below the header, found none");
  }

  void check(std::size_t s) {
    const LengthSetUp& set_up = test_.set_ups[s];
    const LengthReading* first = nullptr;
    for (const LengthReading& reading : test_.readings) {
      if (reading.set_up != s) continue;
      const Vector3 point = point_of(test_, reading);
      if (set_up.instrument == LengthInstrument::points) {
        first = &reading;
        break;
      }
      if (set_up.instrument != LengthInstrument::interferometer) {
        if (std::hypot(point[0] - set_up.place[0], point[1] - set_up.place[1], point[2] - set_up.place[2]) <
            kNearest_mm)
          findings_.add(reading.line, 0, "the station of set-up {} is nearer than {:g} mm to the tool", set_up.name,
                        kNearest_mm);
      } else if (first == nullptr || first->tool != reading.tool) {
        first = &reading;
      } else {
        check_on_line(set_up, *first, reading);
      }
      if (first == nullptr) first = &reading;
    }
    if (first == nullptr && !test_.readings.empty())
      findings_.add(0, 0, "set_up {}: expected readings of it, found none", set_up.name);
  }

  void check_on_line(const LengthSetUp& set_up, const LengthReading& first, const LengthReading& reading) {
    double along = 0.0, squares = 0.0;
    for (std::size_t a = 0; a < kAxes; ++a) {
      const double d = reading.position_mm[a] - first.position_mm[a];
      along += d * set_up.place[a];
      squares += d * d;
    }
    const double across = std::sqrt(std::max(0.0, squares - along * along));
    if (across > kOffLine_mm + kOffLine_per_mm * std::abs(along))
      findings_.add(reading.line, 0,
                    "set-up {}: expected a pose on the line of line {} along ({:.4f}, {:.4f}, {:.4f}), "
                    "found one {:.3f} mm off it",
                    set_up.name, first.line, set_up.place[0], set_up.place[1], set_up.place[2], across);
  }

  const laser::CsvTable& table_;
  laser::Findings& findings_;
  LengthTest& test_;
  bool plan_ = false;
  bool points_ = false;  ///< deviations along the axes, of points
};

}  // namespace

std::string_view word_of(LengthInstrument instrument) {
  return kInstrumentWords[static_cast<std::size_t>(instrument)].word;
}

bool has_points(const LengthTest& test) {
  return std::ranges::any_of(test.set_ups,
                             [](const LengthSetUp& one) { return one.instrument == LengthInstrument::points; });
}

Vector3 point_of(const LengthTest& test, const LengthReading& reading) {
  Vector3 point = reading.position_mm;
  for (std::size_t a = 0; a < kAxes; ++a) point[a] += test.tools[reading.tool].offset_mm[a];
  return point;
}

Result<LengthTest> parse_lengths(std::string_view text, const std::string& file_name, bool plan) {
  laser::Findings findings(file_name);
  std::vector<std::string_view> needed(kLengthColumns.begin(), kLengthColumns.end());
  const bool points =
      std::ranges::any_of(kDeviations, [&](auto column) { return text.find(column) != std::string_view::npos; });
  if (!plan && !points) needed.push_back(kDeviation);
  ECS_TRY(table, laser::parse_csv_table(text, file_name, needed, findings));
  LengthTest test;
  test.source = file_name;
  LengthReader(table, findings, test, plan).read();
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return test;
}

std::string to_csv(const LengthTest& test, bool plan) {
  std::string text;
  if (!test.machine.empty()) text += fmt::format("# machine: {}\n", test.machine);
  if (!test.configuration.empty()) text += fmt::format("# configuration: {}\n", test.configuration);
  if (test.knots_mm[0] && test.knots_mm[1] && test.knots_mm[2])
    text += fmt::format("# knots_mm: {:g} {:g} {:g}\n", *test.knots_mm[0], *test.knots_mm[1], *test.knots_mm[2]);
  if (test.minutes) text += fmt::format("# minutes: {:.1f}\n", *test.minutes);
  if (test.bar_um) text += fmt::format("# bar_um: {:g}\n", *test.bar_um);
  for (const LengthTool& tool : test.tools)
    text +=
        fmt::format("# tool: {} {:g} {:g} {:g}\n", tool.name, tool.offset_mm[0], tool.offset_mm[1], tool.offset_mm[2]);
  for (const LengthSetUp& set_up : test.set_ups)
    text += set_up.instrument == LengthInstrument::points
                ? fmt::format("# set_up: {} {}\n", set_up.name, word_of(set_up.instrument))
                : fmt::format("# set_up: {} {} {:.9g} {:.9g} {:.9g}\n", set_up.name, word_of(set_up.instrument),
                              set_up.place[0], set_up.place[1], set_up.place[2]);
  const bool points = has_points(test);
  text += fmt::format("{}{}\n", fmt::join(kLengthColumns, ","),
                      points ? fmt::format(",{}", fmt::join(kDeviations, ","))
                      : plan ? std::string()
                             : fmt::format(",{}", kDeviation));
  for (const LengthReading& r : test.readings) {
    text += fmt::format("{},{},{},{:.10g},{:.10g},{:.10g},{},{},{}", test.set_ups[r.set_up].name, r.run,
                        test.tools[r.tool].name, r.position_mm[0], r.position_mm[1], r.position_mm[2], r.approach[0],
                        r.approach[1], r.approach[2]);
    if (points)
      for (const double part : r.along) text += part == 0.0 ? std::string(",") : fmt::format(",{:.4f}", r.deviation_um);
    else if (!plan)
      text += fmt::format(",{:.4f}", r.deviation_um);
    text += "\n";
  }
  return text;
}

}  // namespace ecs::model
