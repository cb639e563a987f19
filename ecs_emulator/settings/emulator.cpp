#include "ecs_emulator/settings/emulator.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/file_kind.hpp"
#include "base/toml_reader.hpp"
#include "core/tools.hpp"
#include "ecs_emulator/settings/reader.hpp"

namespace ecs::emulator {
namespace {

/// One of several words; `value` stays as it is where the key is absent or wrong.
template <class Value, std::size_t N>
void word_into(TomlReader& reader, const toml::table& table, std::string_view key,
               const std::array<std::pair<std::string_view, Value>, N>& words, Value& value) {
  const auto word = reader.word(table, key);
  if (!word) return;
  std::string expected;
  for (const auto& [name, meaning] : words) {
    if (*word == name) {
      value = meaning;
      return;
    }
    expected += fmt::format("{}{}", expected.empty() ? "" : " or ", name);
  }
  reader.complain(*table.get(key), "{}: expected {}, got \"{}\"", key, expected, *word);
}

TransducerSettings transducer_of(TomlReader& reader, const toml::table& table) {
  TransducerSettings transducer;
  double counts = 0.0;
  numbers_into(reader, table, "emulator.axis.transducer",
               {{"period_mm", &transducer.period_mm, Within{1e-4, 1000.0}},
                {"offset", &transducer.offset, Within{-0.5, 0.5}},
                {"imbalance", &transducer.imbalance, Within{-1.0, 1.0}},
                {"quadrature_mrad", &transducer.quadrature_mrad, Within{-500.0, 500.0}},
                {"carrier_Hz", &transducer.carrier_Hz, Within{50.0, 1e6}},
                {"noise_um", &transducer.noise_um, Within{0.0, 1000.0}},
                {"fastest_mm_min", &transducer.fastest_mm_min, Within{1.0, 1e6}},
                {"dirt_mm", &transducer.dirt_mm, Within{-1e6, 1e6}},
                {"dirt_counts", &counts, Within{0.0, 1e6}}},
               {"excitation"});
  const bool uneven = transducer.offset != 0.0 || transducer.imbalance != 0.0 || transducer.quadrature_mrad != 0.0;
  if (uneven && transducer.period_mm == 0.0)
    reader.complain(table, "transducer: expected period_mm together with offset, imbalance or quadrature_mrad");
  transducer.dirt_counts = static_cast<std::int64_t>(counts);
  word_into<Excitation, 2>(reader, table, "excitation",
                           {{{"rotor", Excitation::rotor}, {"stator", Excitation::stator}}}, transducer.excitation);
  return transducer;
}

AxisSettings read_axis_settings(TomlReader& reader, const toml::table& table) {
  AxisSettings axis;
  numbers_into(reader, table, "emulator.axis",
               {{"kv_per_s", &axis.kv_per_s, Within{1.0, 300.0}},
                {"dac_um_per_count", &axis.dac_um_per_count, Within{-100.0, 100.0}},
                {"acceleration_mm_s2", &axis.acceleration_mm_s2, Within{1.0, 1e5}},
                {"rapid_mm_min", &axis.rapid_mm_min, Within{10.0, 120'000.0}},
                {"servo_lag_um_per_m_min", &axis.servo_lag_um_per_m_min, Within{-1e5, 1e5}},
                {"friction_Nm", &axis.friction_Nm, Within{0.0, 20.0}},
                {"breakaway_Nm", &axis.breakaway_Nm, Within{0.0, 20.0}},
                {"slip_mm_s", &axis.slip_mm_s, Within{1e-3, 1000.0}},
                {"lost_motion_um", &axis.slide.lost_motion_um, Within{0.0, 1e4}},
                {"wind_up_um", &axis.slide.wind_up_um, Within{0.0, 1e4}},
                {"wind_up_length_mm", &axis.slide.wind_up_length_mm, Within{1e-3, 1000.0}},
                {"reference_speed_mm_min", &axis.reference_speed_mm_min, Within{1.0, 60'000.0}},
                {"creep_speed_mm_min", &axis.creep_speed_mm_min, Within{1.0, 60'000.0}},
                {"marker_pitch_mm", &axis.marker_pitch_mm, Within{0.1, 100.0}},
                {"null_offset_mm", &axis.null_offset_mm, Within{-1000.0, 1000.0}},
                {"switch_width_mm", &axis.switch_width_mm, Within{0.1, 100.0}}},
               {"drive", "feedback", "transducer", "count_polarity", "reference_kind", "reference_direction",
                "switch_polarity"});
  if (axis.dac_um_per_count == 0.0) reader.complain(*table.get("dac_um_per_count"), "dac_um_per_count: expected not 0");
  sign_into(reader, table, "count_polarity", axis.count_polarity);
  sign_into(reader, table, "switch_polarity", axis.switch_polarity);
  int direction = 1;
  sign_into(reader, table, "reference_direction", direction);
  axis.reference_direction = static_cast<Approach>(direction);
  word_into<DatumKind, 3>(
      reader, table, "reference_kind",
      {{{"fanuc", DatumKind::fanuc}, {"allen_bradley", DatumKind::allen_bradley}, {"siemens", DatumKind::siemens}}},
      axis.reference_kind);
  word_into<DriveKind, 2>(reader, table, "drive", {{{"servo", DriveKind::servo}, {"ideal", DriveKind::ideal}}},
                          axis.drive);
  word_into<Feedback, 2>(reader, table, "feedback", {{{"scale", Feedback::scale}, {"motor", Feedback::motor}}},
                         axis.feedback);
  if (const auto* transducer = reader.child(table, "transducer")) axis.transducer = transducer_of(reader, *transducer);
  return axis;
}

constexpr std::array<std::string_view, 3> kCompensations{"off", "manual", "automatic"};

std::vector<NumberField> fields_of(LaserSettings& s) {
  using enum Sign;
  return {{"linear_noise_um", &s.linear_noise_um, not_negative},
          {"straightness_noise_um", &s.straightness_noise_um, not_negative},
          {"angular_noise_um_per_m", &s.angular_noise_um_per_m, not_negative},
          {"level_noise_um_per_m", &s.level_noise_um_per_m, not_negative},
          {"indicator_noise_um", &s.indicator_noise_um, not_negative},
          {"linear_resolution_um", &s.linear_resolution_um, not_negative},
          {"straightness_resolution_um", &s.straightness_resolution_um, not_negative},
          {"angular_resolution_um_per_m", &s.angular_resolution_um_per_m, not_negative},
          {"level_resolution_um_per_m", &s.level_resolution_um_per_m, not_negative},
          {"indicator_resolution_um", &s.indicator_resolution_um, not_negative},
          {"setup_slope_um_per_m", &s.setup_slope_um_per_m, not_negative},
          {"setup_offset_um", &s.setup_offset_um, not_negative},
          {"wavelength_nm", &s.wavelength_nm, positive},
          {"fringe_parts", &s.fringe_parts, not_negative},
          {"dead_path_m", &s.dead_path_m, not_negative},
          {"misalignment_mrad", &s.misalignment_mrad, any},
          {"head_drift_um_per_h", &s.head_drift_um_per_h, any},
          {"turbulence_um_per_sqrt_m", &s.turbulence_um_per_sqrt_m, not_negative},
          {"turbulence_time_s", &s.turbulence_time_s, positive},
          {"nonlinearity_nm", &s.nonlinearity_nm, not_negative},
          {"nonlinearity_cycles", &s.nonlinearity_cycles, positive},
          {"air_sensor_error_degC", &s.air_sensor_error_degC, any},
          {"pressure_sensor_error_hPa", &s.pressure_sensor_error_hPa, any},
          {"humidity_sensor_error_pct", &s.humidity_sensor_error_pct, any},
          {"material_sensor_error_degC", &s.material_sensor_error_degC, any},
          {"material_degC", &s.material_degC, any},
          {"expansion_um_per_m_degC", &s.expansion_um_per_m_degC, any},
          {"trigger_latency_s", &s.trigger_latency_s, not_negative},
          {"trigger_rate_Hz", &s.trigger_rate_Hz, not_negative},
          {"straightness_noise_um_per_m", &s.straightness_noise_um_per_m, not_negative},
          {"straightness_turbulence_um_per_m", &s.straightness_turbulence_um_per_m, not_negative},
          {"air_gradient_degC_per_m", &s.air_gradient_degC_per_m, any},
          {"angular_scale_error_pct", &s.angular_scale_error_pct, any},
          {"angular_drift_um_per_m_h", &s.angular_drift_um_per_m_h, any},
          {"level_settling_s", &s.level_settling_s, not_negative},
          {"level_hysteresis_um_per_m", &s.level_hysteresis_um_per_m, not_negative},
          {"level_zero_um_per_m", &s.level_zero_um_per_m, any},
          {"square_error_um_per_m", &s.square_error_um_per_m, any},
          {"indicator_hysteresis_um", &s.indicator_hysteresis_um, not_negative}};
}

void compensation_into(TomlReader& reader, const toml::table& table, const char* key, Compensation& value) {
  const auto word = reader.word(table, key);
  if (!word) return;
  if (const auto named = compensation_named(*word))
    value = *named;
  else
    reader.complain(*table.get(key), "{}: expected off, manual or automatic, got \"{}\"", key, *word);
}

void flag_into(TomlReader& reader, const toml::table& table, const char* key, bool& value) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return;
  if (!node->is_boolean()) return reader.complain(*node, "{}: expected true or false", key);
  value = node->value_or(false);
}

/// What no single value shows.
void judge(TomlReader& reader, const toml::table& table, const LaserSettings& laser) {
  if (laser.wavelength_nm < 300.0 || laser.wavelength_nm > 1700.0)
    reader.complain(*table.get("wavelength_nm"), "wavelength_nm: expected 300 to 1700, got {}", laser.wavelength_nm);
  if (laser.nonlinearity_cycles != 1.0 && laser.nonlinearity_cycles != 2.0)
    reader.complain(*table.get("nonlinearity_cycles"), "nonlinearity_cycles: expected 1 or 2, got {}",
                    laser.nonlinearity_cycles);
}

LaserSettings read_laser_settings(TomlReader& reader, const toml::table& table) {
  LaserSettings laser;
  numbers_into(reader, table, "emulator.laser", fields_of(laser),
               {"air_compensation", "material_compensation", "dead_path_compensation"});
  compensation_into(reader, table, "air_compensation", laser.air_compensation);
  compensation_into(reader, table, "material_compensation", laser.material_compensation);
  flag_into(reader, table, "dead_path_compensation", laser.dead_path_compensation);
  judge(reader, table, laser);
  return laser;
}

void serial_number_into(TomlReader& reader, const toml::table& table, std::string& serial_number) {
  const auto word = reader.word(table, "serial_number");
  if (!word) return;
  if (word->empty() || word->size() > 16)
    reader.complain(*table.get("serial_number"), "serial_number: expected 1 to 16 characters, got {}", word->size());
  else
    serial_number = *word;
}

void seed_into(TomlReader& reader, const toml::table& table, std::uint64_t& seed) {
  constexpr double kGreatest = 9007199254740992.0;  // 2^53: every whole number up to it is a double
  double number = static_cast<double>(seed);
  number_into(reader, table, "seed", Sign::not_negative, number);
  if (number <= kGreatest)
    seed = static_cast<std::uint64_t>(number);
  else
    reader.complain(*table.get("seed"), "seed: expected at most {:.0f}, got {}", kGreatest, number);
}

std::vector<MagazineTool> magazine_of(TomlReader& reader, const toml::table& table) {
  std::vector<MagazineTool> tools;
  for (const toml::table* its : reader.children(table, "tool")) {
    MagazineTool tool;
    double number = 0.0;
    Vector3& to = tool.offset_mm;
    numbers_into(reader, *its, "emulator.tool",
                 {required("number", number, Within{1.0, kGreatestToolNumber}),
                  {"x_mm", &to[0]},
                  {"y_mm", &to[1]},
                  {"z_mm", &to[2]}});
    tool.number = static_cast<std::uint16_t>(number);
    if (std::any_of(tools.begin(), tools.end(), [&](const MagazineTool& one) { return one.number == tool.number; }))
      reader.complain(*its, "tool: a second one with the number {}", tool.number);
    tools.push_back(tool);
  }
  return tools;
}

EmulatorSettings settings_of(TomlReader& reader, const toml::table& table, const std::filesystem::path& folder) {
  EmulatorSettings settings;
  reader.only(table,
              {"serial_number", "seed", "errors", "load_kg", "tool_offset_mm", "tool", "tool_wires", "power_on_wire",
               "deviation", "axis", "laser"},
              "emulator");
  serial_number_into(reader, table, settings.serial_number);
  seed_into(reader, table, settings.seed);
  number_into(reader, table, "load_kg", Sign::not_negative, settings.load_kg);
  if (const auto* offset = reader.child(table, "tool_offset_mm")) {
    Vector3& to = settings.tool_offset_mm;
    numbers_into(reader, *offset, "tool_offset_mm", {{"x", &to[0]}, {"y", &to[1]}, {"z", &to[2]}});
  }
  settings.tools = magazine_of(reader, table);
  flag_into(reader, table, "tool_wires", settings.tool_wires);
  flag_into(reader, table, "power_on_wire", settings.power_on_wire);
  if (const auto axis = reader.word(table, "deviation")) {
    settings.deviation = axis->size() == 1 ? axis_of(axis->front()) : std::nullopt;
    if (!settings.deviation) reader.complain(*table.get("deviation"), "deviation: expected X, Y or Z");
  }
  if (const auto errors = reader.word(table, "errors")) settings.errors = folder / *errors;
  if (const auto* laser = reader.child(table, "laser")) settings.laser = read_laser_settings(reader, *laser);
  if (const auto* axes = reader.child(table, "axis")) {
    reader.only(*axes, {"X", "Y", "Z"}, "emulator.axis");
    for (const Axis a : kAllAxes)
      if (const auto* axis = reader.child(*axes, std::string(1, letter_of(a))))
        settings.axes[index_of(a)] = read_axis_settings(reader, *axis);
  }
  return settings;
}

/// A switch stands at the end where the datum is, and the axis comes to it from the other: what a control does unless
/// the file says otherwise.
void reference_towards_datum(const toml::table& file, WorkshopMachine& workshop) {
  for (const Axis a : kAllAxes) {
    const auto& axis = workshop.machine.axes[index_of(a)];
    const std::string name(1, letter_of(a));
    if (!axis || file["emulator"]["axis"][name]["reference_direction"]) continue;
    const bool at_lower_end = axis->datum_mm < 0.5 * (axis->travel_mm[0] + axis->travel_mm[1]);
    workshop.settings.axes[index_of(a)].reference_direction = at_lower_end ? Approach::reverse : Approach::forward;
  }
}

}  // namespace

std::string_view name_of(Compensation compensation) { return kCompensations[static_cast<std::size_t>(compensation)]; }

std::optional<Compensation> compensation_named(std::string_view name) {
  for (std::size_t i = 0; i < kCompensations.size(); ++i)
    if (kCompensations[i] == name) return static_cast<Compensation>(i);
  return std::nullopt;
}

LaserSettings with(LaserSettings settings, const InstrumentSetting& setting) {
  settings.air_compensation = setting.air.value_or(settings.air_compensation);
  settings.material_compensation = setting.material.value_or(settings.material_compensation);
  settings.material_degC = setting.material_degC.value_or(settings.material_degC);
  settings.dead_path_m = setting.dead_path_m.value_or(settings.dead_path_m);
  settings.misalignment_mrad = setting.misalignment_mrad.value_or(settings.misalignment_mrad);
  settings.trigger_latency_s = setting.trigger_latency_s.value_or(settings.trigger_latency_s);
  if (setting.reversed.value_or(false)) settings.square_error_um_per_m = -settings.square_error_um_per_m;
  return settings;
}

Result<WorkshopMachine> parse_workshop_machine(std::string_view text, const std::string& file,
                                               const std::filesystem::path& folder) {
  ECS_TRY(machine, params::parse_machine(text, file));
  TomlReader reader(file);
  ECS_TRY(table, reader.parsed(text));
  WorkshopMachine workshop{std::move(machine.machine), {}};
  for (const Axis a : kAllAxes) {
    const auto& axis = workshop.machine.axes[index_of(a)];
    if (axis && (axis->datum_mm < axis->travel_mm[0] || axis->datum_mm > axis->travel_mm[1]))
      reader.complain(1, "axis.{}: expected datum_mm within travel_mm, or the control cannot go there, got {}",
                      letter_of(a), axis->datum_mm);
  }
  if (const auto* own = reader.child(table, "emulator")) workshop.settings = settings_of(reader, *own, folder);
  reference_towards_datum(table, workshop);
  if (!reader.clean()) return tl::unexpected(reader.all());
  return workshop;
}

Result<WorkshopMachine> load_workshop_machine(const std::filesystem::path& path) {
  ECS_TRY(text, read_file_of(FileKind::machine, path));
  return parse_workshop_machine(text, path.string(), path.parent_path());
}

}  // namespace ecs::emulator
