#include "params/machine.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "params/fields.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::params {
namespace {

constexpr double kFurthest_mm = 1e6;      ///< no machine is longer than a kilometre
constexpr double kCoarsest_um = 1e4;      ///< position count
constexpr double kLongestPitch_mm = 1e4;  ///< of a screw or a scale
constexpr double kFurthest_deg = 3600.0;  ///< ten turns: a cable or a hose ends before
constexpr double kCoarsest_deg = 1.0;     ///< of a count
constexpr double kFastest_mm_min = 1e6;   ///< mean speed of an axis
constexpr double kShortest = 1e-6;        ///< direction that is none

const std::vector<std::string>& axis_keys() {
  static const std::vector<std::string> keys{"travel_mm",
                                             "datum_mm",
                                             "transducer",
                                             "resolution_um",
                                             "screw_pitch_mm",
                                             "scale_pitch_mm",
                                             "expansion_um_per_m_degC",
                                             "measurement_line_mm"};
  return keys;
}

const std::vector<std::string>& rotary_keys() {
  static const std::vector<std::string> keys{"travel_deg", "direction", "pivot_mm", "resolution_deg",
                                             "transducer_zero_deg"};
  return keys;
}

/// 0, 1, 2 → A, B, C.
char rotary_letter(std::size_t rotary) { return static_cast<char>('A' + static_cast<char>(rotary)); }

std::vector<std::string> known_keys() {
  std::vector<std::string> keys{"name", "configuration", "emulator", "inputs"};
  for (const Axis a : kAllAxes) {
    keys.push_back(fmt::format("axis.{}", letter_of(a)));
    for (const std::string& key : axis_keys()) keys.push_back(fmt::format("axis.{}.{}", letter_of(a), key));
  }
  for (std::size_t r = 0; r < kAxes; ++r) {
    keys.push_back(fmt::format("axis.{}", rotary_letter(r)));
    for (const std::string& key : rotary_keys()) keys.push_back(fmt::format("axis.{}.{}", rotary_letter(r), key));
  }
  return keys;
}

/// "x", "y", "z" → axis.
std::optional<Axis> axis_of_small(std::string_view part) {
  if (part.size() != 1 || part.front() < 'x' || part.front() > 'z') return std::nullopt;
  return static_cast<Axis>(part.front() - 'x');
}

std::optional<double> number_of(const TomlEntry& entry) {
  if (const auto* whole = std::get_if<long long>(&entry.value)) return static_cast<double>(*whole);
  const auto* real = std::get_if<double>(&entry.value);
  return real != nullptr && std::isfinite(*real) ? std::optional(*real) : std::nullopt;
}

/// One pass over the entries of a machine file; keeps every problem and every warning.
class MachineReader {
 public:
  explicit MachineReader(std::string name) : name_(std::move(name)) {}

  void take(const TomlEntry& entry) {
    const bool table = std::holds_alternative<TomlTable>(entry.value);
    if (entry.key == "emulator" || entry.key.starts_with("emulator.") || inside_unknown_table(entry.key)) return;
    if (entry.key == "name") return take_text(entry, file_.machine.name);
    if (entry.key == "configuration") return take_configuration(entry);
    if ((entry.key == "axis" || entry.key == "inputs") && table) return;
    if (entry.key.starts_with("inputs."))
      return take_input(entry, entry.key.substr(std::string_view("inputs.").size()));
    if (const auto rotary = rotary_in(entry.key)) return take_rotary(*rotary, entry, table);
    const auto axis = axis_in(entry.key);
    if (!axis) return warn_unknown(entry);
    if (entry.key.size() == std::string_view("axis.X").size())
      take_axis_table(*axis, entry, table);
    else if (file_.machine.axes[index_of(*axis)])
      take_axis_entry(*axis, entry, std::string_view(entry.key).substr(std::string_view("axis.X.").size()));
  }

  [[nodiscard]] RotaryMachine rotary() const { return rotary_; }
  [[nodiscard]] Result<MachineFile> result() {
    if (!configuration_given_)
      refuse_file("configuration: expected the kinematic chain, such as configuration = \"TXYZ\"");
    judge_axes();
    std::vector<Problem>& warnings = file_.warnings;
    sort_by_place(warnings);
    if (has_rotary_axes(rotary_)) {
      file_.machine.rotary_configuration = rotary_.configuration;
      file_.machine.rotary = rotary_.rotary;
    }
    if (problems_.empty()) return std::move(file_);
    problems_.insert(problems_.end(), warnings.begin(), warnings.end());
    sort_by_place(problems_);
    return tl::unexpected(folded(std::move(problems_)));
  }

 private:
  [[nodiscard]] Problem at(const TomlEntry& entry, std::string message) const {
    return {ProblemKind::bad_input, fmt::format("{}: {}", entry.key, message), name_, entry.line, entry.column, {}};
  }
  void refuse(const TomlEntry& entry, std::string_view expected) {
    problems_.push_back(at(entry, fmt::format("expected {}, found {}", expected, shown(entry))));
  }
  void refuse_file(std::string message) {
    problems_.push_back({ProblemKind::bad_input, std::move(message), name_, 0, 0, {}});
  }
  void warn(const TomlEntry& entry, std::string message) { file_.warnings.push_back(at(entry, std::move(message))); }

  void warn_unknown(const TomlEntry& entry) {
    if (std::holds_alternative<TomlTable>(entry.value)) unknown_tables_.push_back(entry.key + ".");
    warn(entry, fmt::format("not a key of a machine file{}; ignored", did_you_mean(entry.key, known_keys())));
  }
  [[nodiscard]] bool inside_unknown_table(const std::string& key) const {
    return std::ranges::any_of(unknown_tables_, [&](const std::string& table) { return key.starts_with(table); });
  }

  /// "axis.X…" → X.
  static std::optional<Axis> axis_in(std::string_view key) {
    if (!key.starts_with("axis.") || key.size() < 6 || (key.size() > 6 && key[6] != '.')) return std::nullopt;
    return axis_of(key[5]);
  }

  /// "axis.A…" → 0.
  static std::optional<std::size_t> rotary_in(std::string_view key) {
    if (!key.starts_with("axis.") || key.size() < 6 || (key.size() > 6 && key[6] != '.')) return std::nullopt;
    if (key[5] < 'A' || key[5] > 'C') return std::nullopt;
    return static_cast<std::size_t>(key[5] - 'A');
  }

  void take_rotary(std::size_t rotary, const TomlEntry& entry, bool table) {
    auto& axis = rotary_.rotary[rotary];
    if (entry.key.size() == std::string_view("axis.A").size()) {
      if (!table) return refuse(entry, "a table");
      axis.emplace().direction[rotary] = 1.0;
      rotary_places_[rotary] = entry;
    } else if (axis) {
      take_rotary_entry(rotary, *axis, entry, std::string_view(entry.key).substr(std::string_view("axis.A.").size()));
    }
  }

  void take_rotary_entry(std::size_t rotary, MachineRotaryAxis& axis, const TomlEntry& entry, std::string_view key) {
    if (key == "travel_deg") {
      rotary_travel_given_[rotary] = true;
      const auto* ends = std::get_if<std::vector<double>>(&entry.value);
      const bool sound = ends != nullptr && ends->size() == 2 && std::abs((*ends)[0]) <= kFurthest_deg &&
                         std::abs((*ends)[1]) <= kFurthest_deg && (*ends)[0] < (*ends)[1];
      if (!sound) return refuse(entry, "two ends in deg, the lower first, such as [-120.0, 30.0], within 3600 of 0");
      axis.travel_deg = {(*ends)[0], (*ends)[1]};
    } else if (key == "pivot_mm") {
      pivot_given_[rotary] = true;
      const auto pivot = vector_in(entry, kFurthest_mm);
      if (!pivot) return refuse(entry, "a point x, y, z within 1000000 mm of 0, such as [300.0, 250.0, -410.0]");
      axis.pivot_mm = *pivot;
    } else if (key == "direction") {
      const auto direction = vector_in(entry, kFurthest_mm);
      const double length = direction ? std::hypot((*direction)[0], (*direction)[1], (*direction)[2]) : 0.0;
      if (length < kShortest) return refuse(entry, "a direction x, y, z that is not 0, such as [0.0, 1.0, 1.0]");
      for (std::size_t d = 0; d < kAxes; ++d) axis.direction[d] = (*direction)[d] / length;
    } else if (key == "resolution_deg" || key == "transducer_zero_deg") {
      const bool zero = key == "transducer_zero_deg";
      const auto value = number_of(entry);
      if (!value || std::abs(*value) > (zero ? kFurthest_deg : kCoarsest_deg) || (!zero && *value == 0.0))
        return refuse(entry, zero ? "an angle within 3600 deg of 0"
                                  : "an angle for each count, not 0 and within 1 deg of it, such as 0.001");
      (zero ? axis.transducer_zero_deg : axis.resolution_deg.emplace()) = *value;
    } else {
      warn_unknown(entry);
    }
  }

  static std::optional<Vector3> vector_in(const TomlEntry& entry, double most) {
    const auto* parts = std::get_if<std::vector<double>>(&entry.value);
    if (parts == nullptr || parts->size() != kAxes) return std::nullopt;
    for (const double part : *parts)
      if (!(std::abs(part) <= most)) return std::nullopt;
    return Vector3{(*parts)[0], (*parts)[1], (*parts)[2]};
  }

  void take_text(const TomlEntry& entry, std::string& text) {
    const auto* found = std::get_if<std::string>(&entry.value);
    if (found == nullptr)
      refuse(entry, "a text in quotes");
    else if (found->size() > kLongestName)
      problems_.push_back(at(entry, fmt::format("expected at most {} bytes, found {}", kLongestName, found->size())));
    else
      text = ecs::shown(*found);
  }

  /// Column of a sensor = number of its input, from 1.
  void take_input(const TomlEntry& entry, const std::string& sensor) {
    if (sensor == "load_kg") {
      const auto* yes = std::get_if<bool>(&entry.value);
      return yes == nullptr ? refuse(entry, "true or false") : static_cast<void>(file_.machine.states_load = *yes);
    }
    if (sensor.size() == 15 && sensor.starts_with("motion_") && sensor.ends_with("_mm_min") && axis_of(sensor[7]))
      return take_positive(entry, kFastest_mm_min,
                           file_.machine.full_duty_mm_min[index_of(*axis_of(sensor[7]))].emplace());
    const auto* number = std::get_if<long long>(&entry.value);
    if (!sensor.starts_with("t_") || !sensor.ends_with("_degC"))
      return refuse(entry, "the column of a sensor such as t_spindle_degC, load_kg, or motion_X_mm_min as the key");
    if (number == nullptr || *number < 1 || *number > static_cast<long long>(kTemperatureInputs))
      return refuse(entry, fmt::format("the number of an input of the unit, 1 to {}", kTemperatureInputs));
    std::string& input = file_.machine.inputs[static_cast<std::size_t>(*number - 1)];
    if (!input.empty()) return refuse(entry, fmt::format("an input of its own, not that of {}", input));
    input = sensor;
  }

  void take_configuration(const TomlEntry& entry) {
    configuration_given_ = true;
    const auto* text = std::get_if<std::string>(&entry.value);
    if (text == nullptr) return refuse(entry, kAnyChain);
    if (ecs::chain_of(*text)) {
      file_.machine.configuration = rotary_.configuration = *text;
      return;
    }
    if (const auto fault = kinematics::fault_of(*text))
      return refuse(entry, text->find_first_of("ABC") == std::string::npos ? kAnyChain : *fault);
    rotary_.configuration = *text;
    file_.machine.configuration = kinematics::linear_configuration(*text);
    configuration_ = entry;
  }

  void take_axis_table(Axis axis, const TomlEntry& entry, bool table) {
    if (!table) return refuse(entry, "a table");
    file_.machine.axes[index_of(axis)].emplace();
    places_[index_of(axis)] = entry;
  }

  void take_axis_entry(Axis axis, const TomlEntry& entry, std::string_view key) {
    MachineAxis& a = *file_.machine.axes[index_of(axis)];
    if (key == "travel_mm") return take_travel(axis, entry);
    if (key == "datum_mm") return take_position(entry, a.datum_mm);
    if (key == "transducer") return take_transducer(entry, a);
    if (key == "resolution_um") return take_positive(entry, kCoarsest_um, a.resolution_um);
    if (key == "screw_pitch_mm") return take_positive(entry, kLongestPitch_mm, a.screw_pitch_mm.emplace());
    if (key == "scale_pitch_mm") return take_positive(entry, kLongestPitch_mm, a.scale_pitch_mm.emplace());
    if (key == "expansion_um_per_m_degC") return take_number(entry, a.expansion_um_per_m_degC.emplace());
    if (key == "measurement_line_mm") {
      if (!std::holds_alternative<TomlTable>(entry.value)) refuse(entry, "a table such as { y = -1400.0, z = 0.0 }");
      return;
    }
    if (key.starts_with("measurement_line_mm.")) return take_line(axis, entry, key.substr(key.find('.') + 1));
    warn_unknown(entry);
  }

  void take_travel(Axis axis, const TomlEntry& entry) {
    travel_given_[index_of(axis)] = true;
    const auto* ends = std::get_if<std::vector<double>>(&entry.value);
    const bool sound = ends != nullptr && ends->size() == 2 && std::abs((*ends)[0]) <= kFurthest_mm &&
                       std::abs((*ends)[1]) <= kFurthest_mm && (*ends)[0] < (*ends)[1];
    if (!sound) return refuse(entry, "two ends in mm, the lower first, such as [-4100.0, 0.0], within 1000000 mm of 0");
    file_.machine.axes[index_of(axis)]->travel_mm = {(*ends)[0], (*ends)[1]};
  }

  void take_transducer(const TomlEntry& entry, MachineAxis& a) {
    const auto* word = std::get_if<std::string>(&entry.value);
    if (word != nullptr && *word == "encoder")
      a.transducer = Transducer::encoder;
    else if (word != nullptr && *word == "resolver")
      a.transducer = Transducer::resolver;
    else
      refuse(entry, "\"encoder\" or \"resolver\"");
  }

  void take_number(const TomlEntry& entry, double& number) {
    if (const auto value = number_of(entry))
      number = *value;
    else
      refuse(entry, "a finite number");
  }

  void take_position(const TomlEntry& entry, double& position_mm) {
    const auto value = number_of(entry);
    if (!value || std::abs(*value) > kFurthest_mm) return refuse(entry, "a position within 1000000 mm of 0");
    position_mm = *value;
  }

  void take_positive(const TomlEntry& entry, double most, double& number) {
    const auto value = number_of(entry);
    if (!value || *value <= 0.0 || *value > most)
      return refuse(entry, fmt::format("a number above 0, at most {}", shortest(most)));
    number = *value;
  }

  void take_line(Axis axis, const TomlEntry& entry, std::string_view part) {
    const auto lever = axis_of_small(part);
    if (!lever) return warn(entry, "a measurement line has the coordinates x, y, z; ignored");
    if (*lever == axis) return warn(entry, "an axis is not a coordinate of its own measurement line; ignored");
    take_position(entry, file_.machine.axes[index_of(axis)]->measurement_line_mm[index_of(*lever)].emplace());
  }

  void judge_axes() {
    const auto chain = ecs::chain_of(file_.machine.configuration);
    bool any = false;
    for (const Axis a : kAllAxes) {
      const auto& axis = file_.machine.axes[index_of(a)];
      if (!axis) continue;
      any = true;
      judge_axis(a, *axis, chain);
    }
    judge_rotary_axes();
    if (!any) refuse_file("axis: expected at least one table such as [axis.X] with travel_mm = [-4100.0, 0.0]");
  }

  void judge_axis(Axis a, const MachineAxis& axis, const std::optional<Chain>& chain) {
    const TomlEntry& place = places_[index_of(a)];
    if (chain && !chain->has(a))
      problems_.push_back(at(place, fmt::format("configuration \"{}\" has no letter {}; add it or remove the table",
                                                file_.machine.configuration, letter_of(a))));
    if (!travel_given_[index_of(a)])
      problems_.push_back(at(place, "expected travel_mm = [lower end, upper end], found none"));
    else if (axis.travel_mm[0] < axis.travel_mm[1] &&
             (axis.datum_mm < axis.travel_mm[0] || axis.datum_mm > axis.travel_mm[1]))
      warn(place, fmt::format("datum_mm {} lies outside the travel of {} to {} mm; check both", shortest(axis.datum_mm),
                              shortest(axis.travel_mm[0]), shortest(axis.travel_mm[1])));
  }

  static constexpr const char* kAnyChain = "the letter T and one to three of X, Y, Z, each once, such as \"TXYZ\"";

  /// Each letter has its table with a pivot and a travel, each table its letter.
  void judge_rotary_axes() {
    const std::string& letters = rotary_.configuration;
    for (std::size_t r = 0; r < kAxes; ++r) {
      const bool named = letters.find(rotary_letter(r)) != std::string::npos;
      const TomlEntry& place = rotary_places_[r];
      if (!rotary_.rotary[r]) {
        if (named)
          problems_.push_back(at(configuration_, fmt::format("letter {0}: expected a table [axis.{0}] with travel_deg "
                                                             "and pivot_mm, found none",
                                                             rotary_letter(r))));
        continue;
      }
      if (!named && !letters.empty())
        problems_.push_back(at(place, fmt::format("configuration \"{}\" has no letter {}; add it or remove the table",
                                                  letters, rotary_letter(r))));
      if (!rotary_travel_given_[r])
        problems_.push_back(at(place, "expected travel_deg = [lower end, upper end], found none"));
      if (!pivot_given_[r])
        problems_.push_back(at(place,
                               "expected pivot_mm = [x, y, z], a point on its axis with all axes at 0, found "
                               "none"));
    }
  }

  std::string name_;
  MachineFile file_{};
  RotaryMachine rotary_{};  ///< its rotary axes alone
  bool configuration_given_ = false;
  TomlEntry configuration_{};           ///< where rotary axes are named
  PerAxis<TomlEntry> rotary_places_{};  ///< heads of the tables of A, B, C
  PerAxis<bool> rotary_travel_given_{}, pivot_given_{};
  PerAxis<TomlEntry> places_{};  ///< heads of the axis tables
  PerAxis<bool> travel_given_{};
  std::vector<std::string> unknown_tables_;
  std::vector<Problem> problems_;
};

Scope widest_scope(const PerAxis<bool>& present) {
  const auto axes = std::ranges::count(present, true);
  return axes == 3 ? Scope::volumetric : axes == 2 ? Scope::planar : Scope::linear;
}

Plane plane_of(const PerAxis<bool>& present) {
  if (!present[0]) return {Axis::Y, Axis::Z};
  return {Axis::X, present[1] ? Axis::Y : Axis::Z};
}

}  // namespace

std::optional<std::size_t> Machine::input_of(std::string_view sensor) const {
  const auto its = std::ranges::find(inputs, sensor);
  return sensor.empty() || its == inputs.end() ? std::nullopt : std::optional<std::size_t>(its - inputs.begin());
}

Result<MachineFile> parse_machine(std::string_view text, const std::string& name) {
  ECS_TRY(entries, flat_toml(text, name));
  MachineReader reader(name);
  for (const TomlEntry& entry : entries) reader.take(entry);
  return reader.result();
}

Result<MachineFile> read_machine(const std::filesystem::path& path) {
  ECS_TRY(text, read_file_of(FileKind::machine, path));
  return parse_machine(text, path.string());
}

std::optional<Chain> chain_of(const Machine& machine) {
  const auto whole = ecs::chain_of(machine.configuration);
  if (!whole) return std::nullopt;
  PerAxis<bool> present{};
  for (const Axis a : kAllAxes) present[index_of(a)] = machine.axes[index_of(a)].has_value();
  return restricted_to(*whole, present);
}

Result<RotaryMachine> parse_rotary_machine(std::string_view text, const std::string& name) {
  ECS_TRY(entries, flat_toml(text, name));
  MachineReader reader(name);
  for (const TomlEntry& entry : entries) reader.take(entry);
  ECS_TRY(file, reader.result());
  RotaryMachine machine = reader.rotary();
  machine.machine = std::move(file.machine);
  return machine;
}

Result<RotaryMachine> read_rotary_machine(const std::filesystem::path& path) {
  ECS_TRY(text, read_file_of(FileKind::machine, path));
  return parse_rotary_machine(text, path.string());
}

bool has_rotary_axes(const RotaryMachine& machine) {
  return std::ranges::any_of(machine.rotary, [](const auto& axis) { return axis.has_value(); });
}

std::optional<kinematics::JointChain> joint_chain_of(const RotaryMachine& machine) {
  std::string letters;
  for (const char letter : machine.configuration) {
    const auto axis = axis_of(letter);
    if (!axis || machine.machine.axes[index_of(*axis)]) letters += letter;
  }
  return kinematics::joint_chain_of(letters);
}

std::optional<kinematics::JointMachine> joint_machine_of(const Machine& machine) {
  if (machine.rotary_configuration.empty()) return std::nullopt;
  const auto chain = joint_chain_of({machine, machine.rotary_configuration, machine.rotary});
  if (!chain) return std::nullopt;
  kinematics::JointMachine joints;
  joints.chain = *chain;
  joints.terms = kinematics::terms_of(*chain);
  joints.lines_mm = measurement_lines_of(machine);
  for (std::size_t r = 0; r < kAxes; ++r)
    if (const auto& axis = machine.rotary[r]) joints.rotary[r] = {axis->direction, axis->pivot_mm};
  return joints;
}

MeasurementLines measurement_lines_of(const Machine& machine) {
  MeasurementLines lines{};
  for (const Axis b : kAllAxes) {
    const auto& axis = machine.axes[index_of(b)];
    if (!axis) continue;
    for (const Axis lever : kAllAxes)
      lines[index_of(b)][index_of(lever)] = axis->measurement_line_mm[index_of(lever)].value_or(0.0);
  }
  return lines;
}

UnitParameters default_parameters_for(const Machine& machine) {
  UnitParameters parameters;
  parameters.configuration.fill('\0');
  const std::size_t letters = std::min(machine.configuration.size(), parameters.configuration.size() - 1);
  std::copy_n(machine.configuration.begin(), letters, parameters.configuration.begin());
  for (const Axis a : kAllAxes) {
    const auto& axis = machine.axes[index_of(a)];
    parameters.axis_present[index_of(a)] = axis.has_value();
    if (!axis) continue;
    AxisParameters& unit = parameters.axes[index_of(a)];
    unit.transducer = axis->transducer;
    unit.position_scale_um_per_count = axis->resolution_um;
    unit.deadband_um = 5.0 * axis->resolution_um;
    unit.datum.reference_position_mm = axis->datum_mm;
    const bool lower_half = axis->datum_mm < 0.5 * (axis->travel_mm[0] + axis->travel_mm[1]);
    unit.datum.approach_direction = lower_half ? Approach::reverse : Approach::forward;
  }
  parameters.scope = widest_scope(parameters.axis_present);
  if (parameters.scope == Scope::planar) parameters.plane = plane_of(parameters.axis_present);
  parameters.measurement_lines_mm = measurement_lines_of(machine);
  for (const Axis lever : kAllAxes)
    if (!parameters.axis_present[index_of(lever)])
      for (Vector3& line : parameters.measurement_lines_mm) line[index_of(lever)] = 0.0;
  return parameters;
}

}  // namespace ecs::params
