#include "ecs_emulator/true_errors.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "ecs_emulator/formula.hpp"
#include "ecs_emulator/random.hpp"

namespace ecs::emulator {
namespace {

struct Point {
  double p_mm = 0.0;
  double forward = 0.0;
  double reverse = 0.0;
};

/// Linear between points, the end points hold beyond them.
double interpolated(const std::vector<Point>& points, double p_mm, double approach) {
  const auto value = [&](const Point& at) { return approach < 0.0 ? at.reverse : at.forward; };
  if (p_mm <= points.front().p_mm) return value(points.front());
  if (p_mm >= points.back().p_mm) return value(points.back());
  const auto above = std::upper_bound(points.begin(), points.end(), p_mm,
                                      [](double position, const Point& point) { return position < point.p_mm; });
  const auto below = above - 1;
  return std::lerp(value(*below), value(*above), (p_mm - below->p_mm) / (above->p_mm - below->p_mm));
}

struct Contribution {
  Component component = Component::EXX;
  std::optional<Formula> formula;
  std::vector<Point> points;
};

struct Sensor {
  std::string name;
  Formula formula;
};

}  // namespace

struct TrueErrors::Parts {
  mutable Variables variables;
  std::vector<Contribution> contributions;
  std::vector<Sensor> sensors;
  ComponentValues constants{};
  ComponentValues pass_sigma{};
  ComponentValues reading_sigma{};

  void set(const MachineState& state) const {
    variables.x = state.position_mm[0];
    variables.y = state.position_mm[1];
    variables.z = state.position_mm[2];
    variables.t = state.time_s;
    variables.f = state.feed_mm_min;
    variables.m = state.load_kg;
    for (const Sensor& sensor : sensors) variables.temperatures[sensor.name] = sensor.formula.value();
  }
  void set_moving(const MachineState& state, Axis axis) const {
    const std::size_t i = index_of(axis);
    variables.p = state.position_mm[i];
    variables.d = state.approach[i] == Approach::reverse ? -1.0 : 1.0;
    variables.u = state.travel_since_reversal_mm[i];
  }
};

namespace {

/// Reads the tables of one errors file into its parts.
class ErrorsFile {
 public:
  ErrorsFile(TomlReader& reader, std::filesystem::path folder, Variables& variables)
      : reader_(reader), folder_(std::move(folder)), variables_(variables) {}

  std::vector<Sensor> sensors(const toml::table& file) {
    std::vector<Sensor> found;
    const toml::table* table = reader_.child(file, "temperature");
    if (table == nullptr) return found;
    for (const auto& [key, node] : *table) variables_.temperatures.emplace(std::string(key.str()), 20.0);
    for (const auto& [key, node] : *table)
      if (auto formula = formula_of(*table, key.str())) found.push_back({std::string(key.str()), std::move(*formula)});
    return found;
  }

  std::vector<Contribution> contributions(const toml::table& file) {
    std::vector<Contribution> found;
    for (const toml::table* table : reader_.children(file, "contribution"))
      if (auto contribution = contribution_of(*table)) found.push_back(std::move(*contribution));
    return found;
  }

  void squareness(const toml::table& file, ComponentValues& values) {
    const toml::table* table = reader_.child(file, "squareness");
    if (table == nullptr) return;
    reader_.only(*table, {"C0Y", "B0Z", "A0Z"}, "squareness");
    for (const Component c : {Component::C0Y, Component::B0Z, Component::A0Z})
      values[index_of(c)] = reader_.number(*table, name_of(c)).value_or(0.0);
  }

  void scatter(const toml::table& file, ComponentValues& pass, ComponentValues& reading) {
    const toml::table* table = reader_.child(file, "scatter");
    if (table == nullptr) return;
    for (const auto& [key, node] : *table) {
      const auto component = component_of(key.str());
      const auto* entry = node.as_table();
      if (!component || is_squareness(*component) || entry == nullptr) {
        reader_.complain(
            node, fmt::format("scatter: expected EXX … ECZ = {{ pass = …, reading = … }}, got \"{}\"", key.str()));
        continue;
      }
      reader_.only(*entry, {"pass", "reading"}, "scatter");
      pass[index_of(*component)] = deviation(*entry, "pass");
      reading[index_of(*component)] = deviation(*entry, "reading");
    }
  }

 private:
  double deviation(const toml::table& table, std::string_view key) {
    const double value = reader_.number(table, key).value_or(0.0);
    if (value < 0.0) reader_.complain(*table.get(key), fmt::format("{}: expected 0 or more, got {}", key, value));
    return value;
  }

  std::optional<Formula> formula_of(const toml::table& table, std::string_view key) {
    const auto expression = reader_.word(table, key);
    if (!expression) return std::nullopt;
    auto formula = Formula::compile(*expression, variables_);
    if (formula) return std::move(*formula);
    reader_.complain(*table.get(key), formula.error().message);
    return std::nullopt;
  }

  std::optional<Contribution> contribution_of(const toml::table& table) {
    reader_.only(table, {"component", "formula", "points", "csv", "cause"}, "contribution");
    const auto name = reader_.word(table, "component");
    const auto component = component_of(name.value_or(""));
    if (!component || is_squareness(*component)) {
      reader_.complain(table, fmt::format("component: expected EXX … ECZ, got \"{}\"", name.value_or("")));
      return std::nullopt;
    }
    if (table.contains("formula") + table.contains("points") + table.contains("csv") != 1) {
      reader_.complain(table, "contribution: expected exactly one of formula, points, csv");
      return std::nullopt;
    }
    Contribution contribution{*component, std::nullopt, {}};
    if (table.contains("formula")) {
      contribution.formula = formula_of(table, "formula");
      if (!contribution.formula) return std::nullopt;
      return contribution;
    }
    contribution.points = table.contains("points") ? points_of(*table.get("points")) : csv_of(table);
    if (contribution.points.empty()) return std::nullopt;
    return contribution;
  }

  std::vector<Point> points_of(const toml::node& node) {
    std::vector<Point> points;
    const toml::array* rows = node.as_array();
    if (rows == nullptr || rows->empty()) {
      reader_.complain(node, "points: expected [[position_mm, forward, reverse], …]");
      return {};
    }
    for (const toml::node& row : *rows) {
      const toml::array* cells = row.as_array();
      std::vector<double> numbers;
      if (cells != nullptr)
        for (const toml::node& cell : *cells)
          if (const auto number = cell.value<double>()) numbers.push_back(*number);
      if (cells == nullptr || numbers.size() != cells->size() || numbers.size() < 2 || numbers.size() > 3) {
        reader_.complain(row, "points: expected [position_mm, forward, reverse] or [position_mm, value]");
        return {};
      }
      if (!points.empty() && numbers[0] <= points.back().p_mm) {
        reader_.complain(row, "points: expected ascending positions");
        return {};
      }
      points.push_back({numbers[0], numbers[1], numbers.back()});
    }
    return points;
  }

  std::vector<Point> csv_of(const toml::table& table) {
    const auto name = reader_.word(table, "csv");
    if (!name) return {};
    const std::filesystem::path path = folder_ / *name;
    const auto text = read_file(path);
    if (!text) {
      reader_.complain(*table.get("csv"), text.error().message);
      return {};
    }
    std::vector<Point> points;
    int line_number = 0;
    for (const std::string_view line : lines_of(*text)) {
      ++line_number;
      if (trimmed(line).empty() || line.front() == '#' || (points.empty() && line.starts_with("p_mm"))) continue;
      const auto cells = split(line, ',');
      std::vector<double> numbers;
      for (const std::string_view cell : cells)
        if (const auto number = number_in(cell)) numbers.push_back(*number);
      const bool right = numbers.size() == cells.size() && (numbers.size() == 2 || numbers.size() == 3) &&
                         (points.empty() || numbers[0] > points.back().p_mm);
      if (!right) {
        reader_.add({ProblemKind::bad_input,
                     "expected p_mm,forward,reverse with ascending positions",
                     path.string(),
                     line_number,
                     0,
                     {}});
        return {};
      }
      points.push_back({numbers[0], numbers[1], numbers.back()});
    }
    if (points.empty()) reader_.complain(*table.get("csv"), "csv: expected at least one row");
    return points;
  }

  TomlReader& reader_;
  std::filesystem::path folder_;
  Variables& variables_;
};

/// A smooth shape of standard deviation 1 over the travel: offset (half of the variance), slope (a quarter) and two
/// waves (a quarter).
double shape(std::uint64_t seed, double place) {
  constexpr double kTwoPi = 6.283185307179586;
  Random random(seed);
  const double offset = std::sqrt(0.5) * random.normal();
  const double slope = std::sqrt(0.25 * 3.0) * random.normal();
  double value = offset + slope * (2.0 * place - 1.0);
  for (const double waves : {1.0, 2.0}) {
    const double size = std::sqrt(0.125 * 2.0) * random.normal();
    value += size * std::sin(kTwoPi * (waves * place + random.uniform()));
  }
  return value;
}

}  // namespace

TrueErrors::TrueErrors() : parts_(std::make_unique<Parts>()) {}
TrueErrors::~TrueErrors() = default;
TrueErrors::TrueErrors(TrueErrors&&) noexcept = default;
TrueErrors& TrueErrors::operator=(TrueErrors&&) noexcept = default;

Result<TrueErrors> TrueErrors::load(const std::filesystem::path& path) {
  const auto text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  return parse(*text, path.string(), path.parent_path());
}

Result<TrueErrors> TrueErrors::parse(std::string_view text, const std::string& file,
                                     const std::filesystem::path& folder) {
  TomlReader reader(file);
  const auto table = reader.parsed(text);
  if (!table) return tl::unexpected(table.error());
  TrueErrors errors;
  Parts& parts = *errors.parts_;
  reader.only(*table, {"squareness", "contribution", "scatter", "temperature"}, "errors file");
  ErrorsFile contents(reader, folder, parts.variables);
  parts.sensors = contents.sensors(*table);
  parts.contributions = contents.contributions(*table);
  contents.squareness(*table, parts.constants);
  contents.scatter(*table, parts.pass_sigma, parts.reading_sigma);
  if (!reader.clean()) return tl::unexpected(reader.all());
  return errors;
}

ComponentValues TrueErrors::at(const MachineState& state) const {
  ComponentValues values = parts_->constants;
  parts_->set(state);
  for (const Contribution& contribution : parts_->contributions) {
    parts_->set_moving(state, moving_axis(contribution.component));
    values[index_of(contribution.component)] +=
        contribution.formula ? contribution.formula->value()
                             : interpolated(contribution.points, parts_->variables.p, parts_->variables.d);
  }
  return values;
}

ComponentValues TrueErrors::pass_scatter(const MachineState& state, const PerAxis<std::array<double, 2>>& travel_mm,
                                         std::uint64_t seed) const {
  ComponentValues values{};
  for (std::size_t c = 0; c < kCurves; ++c) {
    if (parts_->pass_sigma[c] == 0.0) continue;
    const std::size_t axis = index_of(moving_axis(static_cast<Component>(c)));
    const auto [low, high] = travel_mm[axis];
    const double place = high > low ? (state.position_mm[axis] - low) / (high - low) : 0.0;
    values[c] = parts_->pass_sigma[c] * shape(seed_of(seed, c, state.pass[axis]), place);
  }
  return values;
}

const ComponentValues& TrueErrors::reading_scatter() const { return parts_->reading_sigma; }

std::vector<NamedTemperature> TrueErrors::temperatures(double time_s) const {
  parts_->variables.t = time_s;
  std::vector<NamedTemperature> found;
  for (const Sensor& sensor : parts_->sensors) found.emplace_back(sensor.name, sensor.formula.value());
  return found;
}

}  // namespace ecs::emulator
