#include "commissioning/measurements/plan.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/file_kind.hpp"
#include "base/toml_reader.hpp"
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
      reader_.complain(table, fmt::format("name: {} is in the plan twice", out.name));
    const std::string axis = reader_.word(table, "axis").value_or("");
    const std::string sense = reader_.word(table, "sense").value_or("");
    const auto moved = axis.size() == 1 ? axis_of(axis[0]) : std::nullopt;
    const auto read = sense_named(sense);
    if (!moved) reader_.complain(table, fmt::format("axis: expected X, Y or Z, found \"{}\"", axis));
    if (!read) reader_.complain(table, fmt::format("sense: expected EX EY EZ EA EB or EC, found \"{}\"", sense));
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
      reader_.complain(*table.get("slope"),
                       fmt::format("slope: expected none, end_points or least_squares, found \"{}\"", *word));
    return method.value_or(laser::SlopeMethod::none);
  }

  PlanPhase phase_of(const toml::table& table) {
    const std::string word = reader_.word(table, "phase").value_or("both");
    if (word == "before") return PlanPhase::before;
    if (word == "after") return PlanPhase::after;
    if (word != "both")
      reader_.complain(*table.get("phase"), fmt::format("phase: expected both, before or after, found \"{}\"", word));
    return PlanPhase::both;
  }

  std::optional<double> band_of(const toml::table& table, std::string_view key) {
    const auto value = reader_.number(table, key);
    if (value && *value <= 0.0) reader_.complain(*table.get(key), fmt::format("{}: expected a band above 0", key));
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

}  // namespace ecs::commissioning
