#include "ecs_emulator/settings/laser.hpp"

#include <array>

#include <fmt/format.h>

#include "ecs_emulator/settings/reader.hpp"

namespace ecs::emulator {
namespace {

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
    reader.complain(*table.get(key), fmt::format("{}: expected off, manual or automatic, got \"{}\"", key, *word));
}

void flag_into(TomlReader& reader, const toml::table& table, const char* key, bool& value) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return;
  if (!node->is_boolean()) return reader.complain(*node, fmt::format("{}: expected true or false", key));
  value = node->value_or(false);
}

/// What no single value shows.
void judge(TomlReader& reader, const toml::table& table, const LaserSettings& laser) {
  if (laser.wavelength_nm < 300.0 || laser.wavelength_nm > 1700.0)
    reader.complain(*table.get("wavelength_nm"),
                    fmt::format("wavelength_nm: expected 300 to 1700, got {}", laser.wavelength_nm));
  if (laser.nonlinearity_cycles != 1.0 && laser.nonlinearity_cycles != 2.0)
    reader.complain(*table.get("nonlinearity_cycles"),
                    fmt::format("nonlinearity_cycles: expected 1 or 2, got {}", laser.nonlinearity_cycles));
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

}  // namespace ecs::emulator
