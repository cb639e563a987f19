#include <array>
#include <map>
#include <optional>
#include <sstream>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "ecs_emulator/workshop/procedures.hpp"
#include "laser/csv_table.hpp"

namespace ecs::emulator {
namespace {

using Eigen::Vector3d;

/// What stands in the workshop: where it really is.
struct TrueSetUp {
  bool along_line = false;
  bool ball_bar = false;
  Vector3d nominal = Vector3d::Zero();  ///< direction, or station [mm]
  Vector3d actual = nominal;
  double scale_um_per_m = 0.0;
  bool has_first = false;
  Vector3d first_mm = Vector3d::Zero();
};

struct TrueTool {
  Vector3d nominal_mm = Vector3d::Zero();
  Vector3d actual_mm = nominal_mm;
};

Eigen::Map<const Vector3d> eigen(const Vector3& v) { return Eigen::Map<const Vector3d>(v.data()); }

class LengthPlanReader {
 public:
  LengthPlanReader(Simulation& simulation, const LengthInstrumentSettings& settings, const std::string& file)
      : simulation_(simulation), settings_(settings), findings_(file) {}

  Result<MeasuredLengths> measure(std::string_view text, const std::string& file) {
    constexpr std::array<std::string_view, 9> kColumns{"set_up", "run",        "tool",       "x_mm",      "y_mm",
                                                       "z_mm",   "approach_x", "approach_y", "approach_z"};
    ECS_TRY(table, laser::parse_csv_table(text, file, kColumns, findings_));
    for (const laser::MetadataEntry& entry : table.metadata) take_head(entry);
    MeasuredLengths out;
    for (const laser::MetadataEntry& entry : table.metadata)
      if (!entry.key.empty()) out.csv += fmt::format("# {}: {}\n", entry.key, entry.value);
    out.csv += "set_up,run,tool,x_mm,y_mm,z_mm,approach_x,approach_y,approach_z,deviation_um\n";
    for (const laser::CsvRow& row : table.rows) {
      std::vector<std::string> cells;
      for (const std::string_view column : kColumns) cells.push_back(row.fields[*place_of(table, column)].text);
      const auto deviation_um = read(row.line, cells);
      if (!deviation_um) continue;
      for (const std::string& cell : cells) out.csv += cell + ',';
      out.csv += fmt::format("{:.4f}\n", *deviation_um);
      ++out.readings;
    }
    if (findings_.empty() && out.readings == 0) findings_.add(table.header_line, 0, "expected poses, found none");
    if (!findings_.empty()) return tl::unexpected(findings_.as_problem());
    return out;
  }

 private:
  double drawn(double deviation) { return deviation > 0.0 ? deviation * simulation_.random().normal() : 0.0; }

  void take_head(const laser::MetadataEntry& entry) {
    if (entry.key == "bar_um") bar_um_ = drawn(settings_.bar_um);
    if (entry.key != "tool" && entry.key != "set_up") return;
    std::istringstream words(entry.value);
    std::string name, kind;
    Vector3d v = Vector3d::Zero();
    words >> name;
    if (entry.key == "set_up") words >> kind;
    if (!(words >> v[0] >> v[1] >> v[2])) {
      findings_.add(0, 0, "{}: expected a name and three numbers, found {}", entry.key, laser::in_quotes(entry.value));
      return;
    }
    if (entry.key == "tool") {
      TrueTool tool{v, v};
      for (double& mm : tool.actual_mm) mm += drawn(settings_.tool_mm);
      tools_[name] = tool;
      return;
    }
    if (kind != "interferometer" && kind != "tracker" && kind != "ball_bar") {
      findings_.add(0, 0, "set_up {}: expected interferometer, tracker or ball_bar, found {}", name,
                    laser::in_quotes(kind));
      return;
    }
    TrueSetUp set_up{kind == "interferometer", kind == "ball_bar", v, v, drawn(settings_.scale_um_per_m)};
    if (set_up.along_line) {
      set_up.nominal = set_up.actual = v.normalized();
    } else {
      for (double& mm : set_up.actual) mm += drawn(settings_.station_mm);
    }
    set_ups_[name] = set_up;
  }

  std::optional<double> read(int line, const std::vector<std::string>& cells) {
    const auto set_up = set_ups_.find(cells[0]);
    const auto tool = tools_.find(cells[2]);
    if (set_up == set_ups_.end() || tool == tools_.end()) {
      findings_.add(line, 0, "set_up {}, tool {}: expected names of the head of the plan", cells[0], cells[2]);
      return std::nullopt;
    }
    MachineState state = simulation_.machine().state();
    state.feed_mm_min = 0.0;
    for (std::size_t a = 0; a < kAxes; ++a) {
      const auto mm = number_in(cells[3 + a]), side = number_in(cells[6 + a]);
      if (!mm || !side || (*side != 1.0 && *side != -1.0)) {
        findings_.add(line, 0, "expected numbers as coordinates, 1 or -1 as approaches");
        return std::nullopt;
      }
      const auto [low_mm, high_mm] = simulation_.machine().travel_mm()[a];
      if (simulation_.machine().has(static_cast<Axis>(a)) && (*mm < low_mm || *mm > high_mm)) {
        findings_.add(line, 0, "expected {} within {:g} to {:g} mm, found {:g}", letter_of(kAllAxes[a]), low_mm,
                      high_mm, *mm);
        return std::nullopt;
      }
      state.position_mm[a] = *mm;
      state.approach[a] = *side < 0.0 ? Approach::reverse : Approach::forward;
      follow(a, *mm, *side < 0.0 ? -1 : 1);
      state.pass[a] = pass_[a];
    }
    last_mm_ = state.position_mm;
    return deviation(state, set_up->second, cells[0], cells[1], tool->second, cells[2]);
  }

  /// A new pass wherever an axis has to turn.
  void follow(std::size_t a, double mm, int side) {
    if (side != side_[a] || (mm - last_mm_[a]) * side < 0.0) ++pass_[a];
    side_[a] = side;
  }

  double deviation(const MachineState& state, TrueSetUp& set_up, const std::string& set_up_name, const std::string& run,
                   const TrueTool& tool, const std::string& tool_name) {
    const ToolPose pose = simulation_.tool_at(state, state.position_mm, settings_.scatter);
    const Vector3d from_spindle = tool.actual_mm - eigen(simulation_.description().settings.tool_offset_mm);
    const Vector3d error_um =
        eigen(pose.error_um) + eigen(pose.rotation_um_per_m).cross(from_spindle) / kMmPerM;  // um/m · mm
    const auto position_mm = eigen(state.position_mm);
    double deviation_um = 0.0, length_mm = 0.0;
    if (set_up.along_line) {
      if (!std::exchange(set_up.has_first, true)) set_up.first_mm = position_mm;
      length_mm = (position_mm - set_up.first_mm).dot(set_up.nominal);
      deviation_um = error_um.dot(set_up.actual);
    } else {
      const Vector3d is_mm = position_mm + tool.actual_mm + error_um / kUmPerMm;
      length_mm = (position_mm + tool.nominal_mm - set_up.nominal).norm();
      deviation_um = ((is_mm - set_up.actual).norm() - length_mm) * kUmPerMm;
    }
    const double zero_um = set_up.ball_bar && bar_um_ ? *bar_um_ : zero_of({set_up_name, run, tool_name});
    return deviation_um + zero_um + set_up.scale_um_per_m * length_mm / kMmPerM + drawn(settings_.noise_um);
  }

  double zero_of(const std::tuple<std::string, std::string, std::string>& run) {
    const auto zero = zeros_.find(run);
    return zero != zeros_.end() ? zero->second : zeros_.emplace(run, drawn(settings_.zero_um)).first->second;
  }

  Simulation& simulation_;
  const LengthInstrumentSettings& settings_;
  laser::Findings findings_;
  std::optional<double> bar_um_;  ///< how much longer the ball bar is than it says
  std::map<std::string, TrueTool> tools_;
  std::map<std::string, TrueSetUp> set_ups_;
  std::map<std::tuple<std::string, std::string, std::string>, double> zeros_;
  Vector3 last_mm_{};
  PerAxis<int> side_{};
  PerAxis<std::uint64_t> pass_{};
};

}  // namespace

Result<MeasuredLengths> measured_lengths(Simulation& simulation, std::string_view plan, const std::string& file,
                                         const LengthInstrumentSettings& settings) {
  return LengthPlanReader(simulation, settings, file).measure(plan, file);
}

}  // namespace ecs::emulator
