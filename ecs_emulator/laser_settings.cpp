#include "ecs_emulator/laser_settings.hpp"

#include "ecs_emulator/settings_reader.hpp"

namespace ecs::emulator {

LaserSettings read_laser_settings(TomlReader& reader, const toml::table& table) {
  LaserSettings laser;
  const std::vector<std::pair<std::string, double*>> fields{
      {"linear_noise_um", &laser.linear_noise_um},
      {"straightness_noise_um", &laser.straightness_noise_um},
      {"angular_noise_um_per_m", &laser.angular_noise_um_per_m},
      {"level_noise_um_per_m", &laser.level_noise_um_per_m},
      {"indicator_noise_um", &laser.indicator_noise_um},
      {"linear_resolution_um", &laser.linear_resolution_um},
      {"straightness_resolution_um", &laser.straightness_resolution_um},
      {"angular_resolution_um_per_m", &laser.angular_resolution_um_per_m},
      {"level_resolution_um_per_m", &laser.level_resolution_um_per_m},
      {"indicator_resolution_um", &laser.indicator_resolution_um},
      {"setup_slope_um_per_m", &laser.setup_slope_um_per_m},
      {"setup_offset_um", &laser.setup_offset_um}};
  std::vector<std::string> names;
  for (const auto& [name, value] : fields) {
    names.push_back(name);
    number_into(reader, table, name, Sign::not_negative, *value);
  }
  reader.only(table, names, "emulator.laser");
  return laser;
}

}  // namespace ecs::emulator
