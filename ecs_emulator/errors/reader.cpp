#include "ecs_emulator/errors/reader.hpp"

#include <algorithm>
#include <cmath>

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::emulator {
namespace {

/// A position and one or two values.
bool is_point(const std::vector<double>& numbers, std::size_t cells) {
  return numbers.size() == cells && (cells == 2 || cells == 3) &&
         std::all_of(numbers.begin(), numbers.end(), [](double number) { return std::isfinite(number); });
}

std::vector<CurvePoint> points_in(TomlReader& reader, const toml::node& node) {
  std::vector<CurvePoint> points;
  const toml::array* rows = node.as_array();
  if (rows == nullptr || rows->empty()) {
    reader.complain(node, "points: expected [[position_mm, forward, reverse], …]");
    return {};
  }
  for (const toml::node& row : *rows) {
    const toml::array* cells = row.as_array();
    std::vector<double> numbers;
    if (cells != nullptr)
      for (const toml::node& cell : *cells)
        if (const auto number = cell.value<double>()) numbers.push_back(*number);
    if (cells == nullptr || !is_point(numbers, cells->size())) {
      reader.complain(row, "points: expected [position_mm, forward, reverse] or [position_mm, value]");
      return {};
    }
    if (!points.empty() && numbers[0] <= points.back().p_mm) {
      reader.complain(row, "points: expected ascending positions");
      return {};
    }
    points.push_back({numbers[0], numbers[1], numbers.back()});
  }
  return points;
}

std::vector<CurvePoint> csv_in(ErrorsReading& reading, const toml::table& table) {
  const auto name = reading.reader.word(table, "csv");
  if (!name) return {};
  const std::filesystem::path path = reading.folder / *name;
  const auto text = read_file(path);
  if (!text) {
    reading.reader.complain(*table.get("csv"), text.error().message);
    return {};
  }
  std::vector<CurvePoint> points;
  int line_number = 0;
  for (const std::string_view line : lines_of(*text)) {
    ++line_number;
    if (trimmed(line).empty() || line.front() == '#' || (points.empty() && line.starts_with("p_mm"))) continue;
    const auto cells = split(line, ',');
    std::vector<double> numbers;
    for (const std::string_view cell : cells)
      if (const auto number = number_in(cell)) numbers.push_back(*number);
    if (!is_point(numbers, cells.size()) || (!points.empty() && numbers[0] <= points.back().p_mm)) {
      reading.reader.add({ProblemKind::bad_input,
                          "expected p_mm,forward,reverse with ascending positions",
                          path.string(),
                          line_number,
                          0,
                          {}});
      return {};
    }
    points.push_back({numbers[0], numbers[1], numbers.back()});
  }
  if (points.empty()) reading.reader.complain(*table.get("csv"), "csv: expected at least one row");
  return points;
}

std::optional<Contribution> contribution_in(ErrorsReading& reading, const toml::table& table) {
  reading.reader.only(table, {"component", "formula", "points", "csv", "cause"}, "contribution");
  const auto name = reading.reader.word(table, "component");
  const auto component = component_of(name.value_or(""));
  if (!component || is_squareness(*component)) {
    reading.reader.complain(table, "component: expected EXX … ECZ, got \"{}\"", name.value_or(""));
    return std::nullopt;
  }
  auto curve = curve_in(reading, table, "contribution");
  if (!curve) return std::nullopt;
  const auto line = static_cast<int>(table.source().begin.line);
  reading.parts.demands.push_back({"contribution", line, moving_axis(*component), Demand::Side::any, {}});
  return Contribution{*component, std::move(*curve), line};
}

void read_squareness(ErrorsReading& reading) {
  const toml::table* table = reading.reader.child(reading.file, "squareness");
  if (table == nullptr) return;
  reading.reader.only(*table, {"C0Y", "B0Z", "A0Z"}, "squareness");
  for (const Component c : {Component::C0Y, Component::B0Z, Component::A0Z})
    reading.parts.constants[index_of(c)] = reading.reader.number(*table, name_of(c)).value_or(0.0);
}

void read_scatter(ErrorsReading& reading) {
  const toml::table* table = reading.reader.child(reading.file, "scatter");
  if (table == nullptr) return;
  for (const auto& [key, node] : *table) {
    const auto component = component_of(key.str());
    const auto* entry = node.as_table();
    if (!component || is_squareness(*component) || entry == nullptr) {
      reading.reader.complain(node, "scatter: expected EXX … ECZ = {{ pass = …, reading = … }}, got \"{}\"", key.str());
      continue;
    }
    numbers_into(reading.reader, *entry, "scatter",
                 {{"pass", &reading.parts.pass_sigma[index_of(*component)], Sign::not_negative},
                  {"reading", &reading.parts.reading_sigma[index_of(*component)], Sign::not_negative}});
  }
}

bool gives_form(const toml::table& table) {
  return table.contains("formula") || table.contains("points") || table.contains("csv");
}

void read_artefact(ErrorsReading& reading, const toml::table& table) {
  TomlReader& reader = reading.reader;
  reader.only(table, {"axis", "sense", "angle_um_per_m", "formula", "points", "csv"}, "artefact");
  const std::string axis_word = reader.word(table, "axis").value_or(""),
                    sense_word = reader.word(table, "sense").value_or("");
  const auto axis = axis_word.size() == 1 ? axis_of(axis_word.front()) : std::nullopt;
  const auto sense = sense_named(sense_word);
  if (!axis) return reader.complain(table, "artefact: axis: expected X, Y or Z, got \"{}\"", axis_word);
  if (!sense || is_rotation(*sense) || direction_of(*sense) == *axis)
    return reader.complain(table, "artefact: sense: expected EX, EY or EZ other than along {}, got \"{}\"",
                           letter_of(*axis), sense_word);
  if (!gives_form(table) && !table.contains("angle_um_per_m"))
    return reader.complain(table, "artefact: expected angle_um_per_m, or a form by formula, points or csv");
  Artefact artefact{*axis, *sense, reader.number(table, "angle_um_per_m").value_or(0.0), std::nullopt,
                    static_cast<int>(table.source().begin.line)};
  if (gives_form(table)) {
    artefact.form = curve_in(reading, table, "artefact");
    if (!artefact.form) return;
  }
  demand(reading, table, "artefact", *axis);
  reading.parts.artefacts.push_back(std::move(artefact));
}

}  // namespace

std::optional<Formula> formula_in(ErrorsReading& reading, const toml::table& table, std::string_view key) {
  const auto expression = reading.reader.word(table, key);
  if (!expression) return std::nullopt;
  auto formula = Formula::compile(*expression, reading.parts.variables);
  if (formula) return std::move(*formula);
  reading.reader.complain(*table.get(key), formula.error().message);
  return std::nullopt;
}

std::optional<ErrorCurve> curve_in(ErrorsReading& reading, const toml::table& table, const char* what) {
  if (table.contains("formula") + table.contains("points") + table.contains("csv") != 1) {
    reading.reader.complain(table, "{}: expected exactly one of formula, points, csv", what);
    return std::nullopt;
  }
  ErrorCurve curve;
  if (table.contains("formula")) {
    curve.formula = formula_in(reading, table, "formula");
    if (!curve.formula) return std::nullopt;
    return curve;
  }
  curve.points = table.contains("points") ? points_in(reading.reader, *table.get("points")) : csv_in(reading, table);
  if (curve.points.empty()) return std::nullopt;
  return curve;
}

void for_each_axis(ErrorsReading& reading, const char* name,
                   const std::function<void(Axis, const toml::table&)>& each) {
  const toml::table* tables = reading.reader.child(reading.file, name);
  if (tables == nullptr) return;
  reading.reader.only(*tables, {"X", "Y", "Z"}, name);
  for (const Axis a : kAllAxes)
    if (const toml::table* table = reading.reader.child(*tables, std::string(1, letter_of(a)))) each(a, *table);
}

void demand(ErrorsReading& reading, const toml::table& table, std::string name, Axis axis, Demand::Side side,
            std::optional<std::array<double, 2>> covers_mm) {
  reading.parts.demands.push_back(
      {std::move(name), static_cast<int>(table.source().begin.line), axis, side, covers_mm});
}

void read_curves(ErrorsReading& reading) {
  for (const toml::table* table : reading.reader.children(reading.file, "contribution")) {
    if (read_rotary_contribution(reading, *table)) continue;
    if (auto contribution = contribution_in(reading, *table))
      reading.parts.contributions.push_back(std::move(*contribution));
  }
  read_squareness(reading);
  read_scatter(reading);
}

void read_artefacts(ErrorsReading& reading) {
  for (const toml::table* table : reading.reader.children(reading.file, "artefact")) read_artefact(reading, *table);
}

}  // namespace ecs::emulator
