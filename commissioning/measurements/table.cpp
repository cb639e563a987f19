#include "commissioning/measurements/table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/file_kind.hpp"
#include "base/toml_reader.hpp"
#include "commissioning/measurements/fields.hpp"
#include "laser/map/error_map.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::commissioning {
namespace {

bool is_plain_name(const std::string& name) {
  return !name.empty() && name.front() != '.' && name.find('/') == std::string::npos &&
         std::none_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
}

class PlanReader {
 public:
  explicit PlanReader(const std::string& file) : reader_(file) {}

  Result<std::vector<PlannedMeasurement>> read(std::string_view text) {
    ECS_TRY(table, reader_.parsed(text));
    std::vector<PlannedMeasurement> plan;
    const auto entries = reader_.children(table, "measure");
    if (entries.empty()) reader_.complain(1, "expected [[measure]] with name, axis and sense; found none");
    for (const toml::table* entry : entries) plan.push_back(measurement(*entry, plan));
    if (!reader_.clean()) return tl::unexpected(reader_.all());
    return plan;
  }

 private:
  PlannedMeasurement measurement(const toml::table& table, const std::vector<PlannedMeasurement>& before) {
    PlannedMeasurement out;
    out.name = reader_.word(table, "name").value_or("");
    if (!is_plain_name(out.name)) reader_.complain(table, "name: expected a plain file name without .csv");
    if (std::any_of(before.begin(), before.end(), [&](const auto& other) { return other.name == out.name; }))
      reader_.complain(table, "name: {} is in the plan twice", out.name);
    const std::string axis = reader_.word(table, "axis").value_or("");
    const std::string sense = reader_.word(table, "sense").value_or("");
    const auto moved = axis.size() == 1 ? axis_of(axis[0]) : std::nullopt;
    const auto read = sense_named(sense);
    if (!moved) reader_.complain(table, "axis: expected X, Y or Z, found \"{}\"", axis);
    if (!read) reader_.complain(table, "sense: expected EX EY EZ EA EB or EC, found \"{}\"", sense);
    out.axis = moved.value_or(Axis::X);
    out.sense = read.value_or(Sense::EX);
    const Component component = curve_of(out.sense, out.axis);
    out.title = reader_.word(table, "title").value_or(laser::description_of(component));
    out.slope = slope_of(table, component);
    out.phase = phase_of(table);
    out.published_before = band_of(table, "published_before");
    out.published_after = band_of(table, "published_after");
    return out;
  }

  laser::SlopeMethod slope_of(const toml::table& table, Component component) {
    const auto word = reader_.word(table, "slope");
    if (!word && reader_.word(table, "instrument") == "square") return laser::SlopeMethod::none;
    if (!word) return laser::default_slope(component);
    const auto method = laser::slope_method_named(*word);
    if (!method)
      reader_.complain(*table.get("slope"), "slope: expected none, end_points or least_squares, found \"{}\"", *word);
    return method.value_or(laser::SlopeMethod::none);
  }

  PlanPhase phase_of(const toml::table& table) {
    const std::string word = reader_.word(table, "phase").value_or("both");
    if (word == "before") return PlanPhase::before;
    if (word == "after") return PlanPhase::after;
    if (word != "both")
      reader_.complain(*table.get("phase"), "phase: expected both, before or after, found \"{}\"", word);
    return PlanPhase::both;
  }

  std::optional<double> band_of(const toml::table& table, std::string_view key) {
    const auto value = reader_.number(table, key);
    if (value && *value <= 0.0) reader_.complain(*table.get(key), "{}: expected a band above 0", key);
    return value;
  }

  TomlReader reader_;
};

}  // namespace

Result<std::vector<PlannedMeasurement>> parse_plan(std::string_view text, const std::string& file_name) {
  return PlanReader(file_name).read(text);
}

Result<std::vector<PlannedMeasurement>> read_plan(const std::filesystem::path& path) {
  ECS_TRY(text, read_file_of(FileKind::plan, path));
  return parse_plan(text, path.string());
}

namespace {

constexpr std::size_t kTextWidth = 80;

auto unfit(const std::filesystem::path& file, std::string message) {
  return problem_at(file.string(), 0, 0, std::move(message));
}

std::string lines_of_set(const std::vector<laser::Group>& groups) {
  std::string text;
  for (const laser::Group& g : groups)
    text += fmt::format("{}{} along {} at {}, {}", text.empty() ? "" : "; ", name_of(g.sense), letter_of(g.axis),
                        parked_text(g), compensation_text(g));
  return text;
}

/// The one line of the planned axis and sense. Readings that say they were taken with compensation the other way than
/// the phase has it do not fit: folders may have been exchanged.
Result<laser::Group> line_for(const PlannedMeasurement& planned, bool compensated, const laser::MeasurementSet& set,
                              const std::filesystem::path& file) {
  const auto all = laser::groups_of(set);
  std::vector<laser::Group> fitting;
  for (const laser::Group& group : all)
    if (group.axis == planned.axis && group.sense == planned.sense &&
        group.compensated.value_or(compensated) == compensated)
      fitting.push_back(group);
  if (fitting.size() == 1) return fitting.front();
  const bool exchanged = fitting.empty() && std::ranges::any_of(all, [&](const laser::Group& group) {
                           return group.axis == planned.axis && group.sense == planned.sense;
                         });
  return unfit(file, fmt::format("expected one line of {} along {}, {} compensation, found {}{}",
                                 name_of(planned.sense), letter_of(planned.axis), compensated ? "with" : "without",
                                 lines_of_set(fitting.empty() ? all : fitting),
                                 exchanged ? "; perhaps --before and --after are exchanged" : ""));
}

Result<MeasuredPhase> measured(const PlannedMeasurement& planned, const std::filesystem::path& folder,
                               bool compensated) {
  const std::filesystem::path file = folder / (planned.name + ".csv");
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    return unfit(file, fmt::format("file missing: measure {}, or remove it from the plan", planned.name));
  if (std::filesystem::is_other(file, error)) return unfit(file, "is not a plain file (a pipe or a device): not read");
  ECS_TRY(set, laser::read_measurement_set(file));
  ECS_TRY(group, line_for(planned, compensated, set, file));
  auto readings = laser::processed_readings(set, group, {planned.slope});
  if (!readings) return unfit(file, readings.error().message);
  const auto groups = laser::groups_of(readings->after);
  auto iso = laser::iso230_of(readings->after, groups.front());
  if (!iso) return unfit(file, iso.error().message);
  return MeasuredPhase{file, std::move(*readings), std::move(*iso)};
}

TableRow row_of(const PlannedMeasurement& planned, const std::filesystem::path& before,
                const std::filesystem::path& after) {
  TableRow row{planned, {}, {}, {}};
  const auto take = [&](std::optional<MeasuredPhase>& into, const std::filesystem::path& folder, bool compensated) {
    auto phase = measured(planned, folder, compensated);
    if (phase)
      into = std::move(*phase);
    else
      row.problems.push_back(phase.error());
  };
  if (planned.phase != PlanPhase::after) take(row.before, before, false);
  if (planned.phase != PlanPhase::before) take(row.after, after, true);
  return row;
}

// --- as text

std::string number(const std::optional<double>& value) { return value ? fmt::format("{:.1f}", *value) : "-"; }

std::string arrow(const std::optional<double>& before, const std::optional<double>& after) {
  if (!before && !after) return "-";
  return fmt::format("{:>5}->{:<5}", number(before), number(after));
}

std::optional<double> band(const std::optional<MeasuredPhase>& phase) {
  if (!phase) return std::nullopt;
  return phase->readings.band;
}

std::string cut(const std::string& text, std::size_t width) {
  return text.size() <= width ? text : text.substr(0, width - 1) + "~";
}

/// One phase has no text: the row shows both.
Cell phase_cell(const std::optional<MeasuredPhase>& phase) {
  if (!phase) return null_cell();
  return {object_of("file"_is(phase->file.string()), "readings"_is(phase->readings.before.readings.size()),
                    "band"_is(phase->readings.band), "band_as_measured"_is(phase->readings.band_before),
                    "slope_removed_per_m"_is(phase->readings.level.removed.slope_per_m), "A"_is(phase->iso.A),
                    "E"_is(phase->iso.E), "R"_is(phase->iso.R), "B"_is(phase->iso.B)),
          {}};
}

Cell row_cell(const TableRow& row) {
  const PlannedMeasurement& p = row.planned;
  const MeasuredPhase* shown = row.after ? &*row.after : row.before ? &*row.before : nullptr;
  const std::string ours = !row.before && !row.after ? "no readings" : arrow(band(row.before), band(row.after));
  Json problems = Json::array();
  for (const Problem& one : row.problems) problems.push_back(problem_json(one));
  return record_cell(
      "{name:<10} {title:<20} {unit:<4} {published:<12} {measured:<12} {A:>5} {E:>5} {ratio:>4}{exceeds_published}\n",
      "name"_is(p.name, cut(p.name, 10)), "title"_is(p.title, cut(p.title, 20)),
      "axis"_is(std::string(1, letter_of(p.axis))), "sense"_is(name_of(p.sense)), "unit"_is(laser::unit_of(p.sense)),
      "slope"_is(laser::name_of(p.slope)), "published_before"_is(p.published_before),
      "published_after"_is(p.published_after), "published"_shown(arrow(p.published_before, p.published_after)),
      "before"_is(phase_cell(row.before)), "after"_is(phase_cell(row.after)), "measured"_shown(ours),
      "A"_shown(number(shown != nullptr ? shown->iso.A : std::nullopt)),
      "E"_shown(number(shown != nullptr ? shown->iso.E : std::nullopt)), "ratio"_is(row.ratio(), number(row.ratio())),
      "exceeds_published"_is(row.exceeds_published(), "!", ""), "problems"_is(std::move(problems)));
}

/// Which rows lost their slope by which method, within 80 columns.
std::string slopes_text(const std::vector<TableRow>& rows) {
  std::string text;
  for (const auto method :
       {laser::SlopeMethod::least_squares, laser::SlopeMethod::end_points, laser::SlopeMethod::none}) {
    std::string line;
    for (const TableRow& row : rows) {
      if (row.planned.slope != method) continue;
      if (line.empty() || line.size() + row.planned.name.size() > kTextWidth - 2) {
        text += line + (line.empty() ? "" : "\n");
        line = line.empty() ? fmt::format("  {}:", laser::name_of(method)) : "   ";
      }
      line += " " + row.planned.name;
    }
    text += line + (line.empty() ? "" : "\n");
  }
  return text;
}

}  // namespace

std::optional<double> TableRow::ratio() const {
  if (!before || !after || after->readings.band <= 0.0) return std::nullopt;
  return before->readings.band / after->readings.band;
}

bool TableRow::exceeds_published() const {
  return after && planned.published_after && after->readings.band > *planned.published_after;
}

std::vector<TableRow> table_of(const std::vector<PlannedMeasurement>& plan, const std::filesystem::path& before,
                               const std::filesystem::path& after) {
  std::vector<TableRow> rows;
  for (const PlannedMeasurement& planned : plan) rows.push_back(row_of(planned, before, after));
  return rows;
}

Cell table_cell(const std::vector<TableRow>& rows) {
  Cell table = list_cell(rows, row_cell,
                         fmt::format("{:<10} {:<20} {:<4} {:<12} {:<12} {:>5} {:>5} {:>4}\n", "name", "measurement",
                                     "unit", " published", "  measured", "A", "E", "x"));
  table.text +=
      fmt::format("\n{}.\nSlope removed, as stated in the plan (end_points: line through the end points):\n{}",
                  laser::kBandDefinition, slopes_text(rows));
  table.text +=
      "A, E: accuracy and systematic error (ISO 230-2) after compensation (before,\nif only that was measured); x: "
      "ratio of the bands; published: bands stated in the plan; 40.0->10.0: before -> after; !: more than published.\n";
  for (const TableRow& row : rows)
    for (const Problem& p : row.problems) table.text += fmt::format("{}: {}\n", row.planned.name, to_text(p));
  return table;
}

}  // namespace ecs::commissioning
