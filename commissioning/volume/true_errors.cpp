#include "commissioning/volume/true_errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/json.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "commissioning/link/choice.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;

/// A file that goes away with its last user.
class TemporaryFile {
 public:
  static Result<std::shared_ptr<TemporaryFile>> with(const std::string& text) {
    std::string name = (fs::temp_directory_path() / "ecs-machine-XXXXXX").string();
    const int file = ::mkstemp(name.data());
    if (file < 0) return problem(ProblemKind::output, "cannot write {}", name);
    ::close(file);
    auto made = std::make_shared<TemporaryFile>(name);
    ECS_DO(write_file(name, text));
    return made;
  }
  explicit TemporaryFile(std::string name) : name_(std::move(name)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { ::unlink(name_.c_str()); }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
};

/// A machine file of what the parameters and the travels say.
std::string machine_toml(const volume::CompensatedMachine& machine) {
  const UnitParameters& p = machine.parameters;
  std::string text = fmt::format("name = \"machine\"\nconfiguration = \"{}\"\n", configuration_of(p));
  for (const Axis axis : kAllAxes) {
    const std::size_t a = index_of(axis);
    if (!machine.travel_mm[a]) continue;
    const Vector3& line_mm = p.measurement_lines_mm[a];
    std::vector<std::string> line;
    for (const Axis other : kAllAxes)
      if (other != axis && machine.travel_mm[index_of(other)])
        line.push_back(fmt::format("{} = {:.6f}", static_cast<char>('x' + static_cast<char>(index_of(other))),
                                   line_mm[index_of(other)]));
    text += fmt::format("[axis.{}]\ntravel_mm = [{:.6f}, {:.6f}]\ndatum_mm = {:.6f}\nmeasurement_line_mm = {{ {} }}\n",
                        letter_of(axis), (*machine.travel_mm[a])[0], (*machine.travel_mm[a])[1],
                        p.axes[a].datum.reference_position_mm, fmt::join(line, ", "));
  }
  return text;
}

Result<Json> answer_of(const std::vector<std::string>& words, const std::string& errors_file) {
  const auto said = output_of(words, {}, {"ecs-emulator", "install it in the folder of `ecs`", 120.0});
  if (!said) return problem_at(errors_file, 0, 0, said.error().message);
  Json answer = Json::parse(*said, nullptr, false);
  if (!answer.is_object() || !answer.contains("components"))
    return problem(ProblemKind::output, "ecs-emulator: expected one JSON object with \"components\"");
  return answer;
}

void take(const Json& values, std::vector<double>& into) {
  for (const Json& value : values) into.push_back(value.is_number() ? value.get<double>() : 0.0);
}

volume::Components components_in(const Json& answer) {
  volume::Components out;
  for (std::size_t c = 0; c < kCurves; ++c) {
    const Json& curve = answer["components"][std::string(kComponentNames[c])];
    take(curve["reverse"], out.curve[side_of(Approach::reverse)][c]);
    take(curve["forward"], out.curve[side_of(Approach::forward)][c]);
  }
  for (std::size_t c = kCurves; c < kComponents; ++c)
    out.squareness[c] = answer["squareness_um_per_m"].value(std::string(kComponentNames[c]), 0.0);
  return out;
}

MeasurementLines lines_in(const Json& answer) {
  MeasurementLines lines{};
  for (const Axis axis : kAllAxes)
    for (std::size_t l = 0; l < kAxes; ++l)
      lines[index_of(axis)][l] = answer["measurement_lines_mm"][std::string(1, letter_of(axis))][l].get<double>();
  return lines;
}

/// "scatter (EXX, EYX); load (EYZ)"
std::string left_out_in(const Json& answer) {
  std::vector<std::string> causes;
  if (answer.contains("left_out"))
    for (const Json& one : answer["left_out"])
      causes.push_back(fmt::format("{} ({})", one.value("cause", ""),
                                   fmt::join(one.value("components", std::vector<std::string>()), ", ")));
  return fmt::format("{}", fmt::join(causes, "; "));
}

std::vector<std::string> words_for(const std::string& program, const std::string& machine, const std::string& errors,
                                   const volume::Grid& grid) {
  std::vector<std::string> words{program, "components", "--machine", machine, "--errors", errors};
  for (const Axis axis : kAllAxes) {
    if (!grid.exists[index_of(axis)]) continue;
    std::vector<std::string> places;
    for (const double mm : coordinates_of(grid, axis)) places.push_back(shortest(mm));
    words.push_back(
        fmt::format("--{}={}", static_cast<char>('x' + static_cast<char>(index_of(axis))), fmt::join(places, ",")));
  }
  return words;
}

}  // namespace

Result<TrueErrors> true_errors(const std::string& errors_file, const std::string& machine_file,
                               const volume::CompensatedMachine& machine) {
  const auto program = emulator_program();
  if (!program)
    return problem(ProblemKind::output,
                   "--errors: the bundled emulator `ecs-emulator` is not found in the folder of `ecs` or on PATH: it "
                   "is required to read errors files");
  std::shared_ptr<TemporaryFile> made;
  if (machine_file.empty()) {
    ECS_TRY(file, TemporaryFile::with(machine_toml(machine)));
    made = std::move(file);
  }
  const std::string name = made ? made->name() : machine_file;
  const auto ask = [made, name, errors_file, program = program->string()](const volume::Grid& grid) {
    return answer_of(words_for(program, name, errors_file, grid), errors_file);
  };
  ECS_TRY(first, ask(volume::grid_over(machine.travel_mm, 8, volume::reference_of(machine.parameters))));
  volume::ErrorSource source;
  source.kinematics = {volume::terms_of_machine(machine.parameters, Convention::iso, CurveKind::carriage),
                       lines_in(first), machine.tool_offset_mm};
  source.curves = CurveKind::carriage;
  source.components = [ask](const volume::Grid& grid) -> Result<volume::Components> {
    ECS_TRY(answer, ask(grid));
    return components_in(answer);
  };
  return TrueErrors{std::move(source), left_out_in(first)};
}

Result<volume::RotaryErrors> true_rotary_errors(const std::string& errors_file, const std::string& machine_file,
                                                const volume::RotaryAxes& rotary) {
  constexpr double kStep_deg = 0.5;
  const auto program = emulator_program();
  if (!program) return problem(ProblemKind::output, "--errors: the bundled emulator `ecs-emulator` is not found");
  std::vector<std::string> words{program->string(), "components", "--machine", machine_file, "--errors", errors_file};
  std::array<std::vector<double>, kAxes> angles_deg;
  for (std::size_t r = 0; r < kAxes; ++r) {
    const auto& travel = rotary.travel_deg[r];
    if (!travel) continue;
    const auto steps = static_cast<std::size_t>(std::ceil(((*travel)[1] - (*travel)[0]) / kStep_deg));
    std::vector<std::string> places;
    for (std::size_t i = 0; i <= steps; ++i) {
      angles_deg[r].push_back(std::min((*travel)[0] + kStep_deg * static_cast<double>(i), (*travel)[1]));
      places.push_back(shortest(angles_deg[r].back()));
    }
    words.push_back(fmt::format("--{}={}", "abc"[r], fmt::join(places, ",")));
  }
  ECS_TRY(answer, answer_of(words, errors_file));
  volume::RotaryErrors errors;
  for (std::size_t r = 0; r < kAxes; ++r) {
    if (angles_deg[r].empty()) continue;
    for (std::size_t s = 0; s < kSenseNames.size(); ++s) {
      const auto joint = static_cast<kinematics::Joint>(kAxes + r);
      const auto sense = static_cast<Sense>(s);
      errors.location[r][s] = answer["rotary"]["location"].value(volume::location_name(r, s), 0.0);
      errors.location_given[r][s] = true;
      const Json& curve = answer["rotary"]["components"][volume::rotary_name(joint, sense)];
      for (const auto& [side, key] : {std::pair{Approach::forward, "forward"}, {Approach::reverse, "reverse"}}) {
        volume::RotaryTable table{joint, sense, side, angles_deg[r], {}, {}};
        take(curve[key], table.error);
        if (table.error.size() == table.p_deg.size()) errors.tables.push_back(std::move(table));
      }
    }
  }
  return errors;
}

}  // namespace ecs::commissioning
