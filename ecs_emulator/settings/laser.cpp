#include "ecs_emulator/settings/laser.hpp"

#include <array>

#include <fmt/format.h>

#include "ecs_emulator/settings/reader.hpp"

namespace ecs::emulator {
namespace {

constexpr std::array<std::string_view, 3> kCompensations{"off", "manual", "automatic"};

struct LaserField {
  const char* name;
  Sign sign;
  double* value;
};

std::vector<LaserField> fields_of(LaserSettings& s) {
  using enum Sign;
  return {{"linear_noise_um", not_negative, &s.linear_noise_um},
          {"straightness_noise_um", not_negative, &s.straightness_noise_um},
          {"angular_noise_um_per_m", not_negative, &s.angular_noise_um_per_m},
          {"level_noise_um_per_m", not_negative, &s.level_noise_um_per_m},
          {"indicator_noise_um", not_negative, &s.indicator_noise_um},
          {"linear_resolution_um", not_negative, &s.linear_resolution_um},
          {"straightness_resolution_um", not_negative, &s.straightness_resolution_um},
          {"angular_resolution_um_per_m", not_negative, &s.angular_resolution_um_per_m},
          {"level_resolution_um_per_m", not_negative, &s.level_resolution_um_per_m},
          {"indicator_resolution_um", not_negative, &s.indicator_resolution_um},
          {"setup_slope_um_per_m", not_negative, &s.setup_slope_um_per_m},
          {"setup_offset_um", not_negative, &s.setup_offset_um},
          {"wavelength_nm", positive, &s.wavelength_nm},
          {"fringe_parts", not_negative, &s.fringe_parts},
          {"dead_path_m", not_negative, &s.dead_path_m},
          {"misalignment_mrad", any, &s.misalignment_mrad},
          {"head_drift_um_per_h", any, &s.head_drift_um_per_h},
          {"turbulence_um_per_sqrt_m", not_negative, &s.turbulence_um_per_sqrt_m},
          {"turbulence_time_s", positive, &s.turbulence_time_s},
          {"nonlinearity_nm", not_negative, &s.nonlinearity_nm},
          {"nonlinearity_cycles", positive, &s.nonlinearity_cycles},
          {"air_sensor_error_degC", any, &s.air_sensor_error_degC},
          {"pressure_sensor_error_hPa", any, &s.pressure_sensor_error_hPa},
          {"humidity_sensor_error_pct", any, &s.humidity_sensor_error_pct},
          {"material_sensor_error_degC", any, &s.material_sensor_error_degC},
          {"material_degC", any, &s.material_degC},
          {"expansion_um_per_m_degC", any, &s.expansion_um_per_m_degC},
          {"trigger_latency_s", not_negative, &s.trigger_latency_s},
          {"trigger_rate_Hz", not_negative, &s.trigger_rate_Hz},
          {"straightness_noise_um_per_m", not_negative, &s.straightness_noise_um_per_m},
          {"straightness_turbulence_um_per_m", not_negative, &s.straightness_turbulence_um_per_m},
          {"air_gradient_degC_per_m", any, &s.air_gradient_degC_per_m},
          {"angular_scale_error_pct", any, &s.angular_scale_error_pct},
          {"angular_drift_um_per_m_h", any, &s.angular_drift_um_per_m_h},
          {"level_settling_s", not_negative, &s.level_settling_s},
          {"level_hysteresis_um_per_m", not_negative, &s.level_hysteresis_um_per_m},
          {"level_zero_um_per_m", any, &s.level_zero_um_per_m},
          {"square_error_um_per_m", any, &s.square_error_um_per_m},
          {"indicator_hysteresis_um", not_negative, &s.indicator_hysteresis_um}};
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
  return settings;
}

LaserSettings read_laser_settings(TomlReader& reader, const toml::table& table) {
  LaserSettings laser;
  std::vector<std::string> names{"air_compensation", "material_compensation", "dead_path_compensation"};
  for (const LaserField& field : fields_of(laser)) {
    names.emplace_back(field.name);
    number_into(reader, table, field.name, field.sign, *field.value);
  }
  compensation_into(reader, table, "air_compensation", laser.air_compensation);
  compensation_into(reader, table, "material_compensation", laser.material_compensation);
  flag_into(reader, table, "dead_path_compensation", laser.dead_path_compensation);
  judge(reader, table, laser);
  reader.only(table, names, "emulator.laser");
  return laser;
}

}  // namespace ecs::emulator
