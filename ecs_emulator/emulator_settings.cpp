#include "ecs_emulator/emulator_settings.hpp"

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/toml_reader.hpp"

namespace ecs::emulator {
namespace {

enum class Sign { any, not_negative, positive, not_zero };

void number_into(TomlReader& reader, const toml::table& table, std::string_view key, Sign sign, double& value) {
  const auto found = reader.number(table, key);
  if (!found) return;
  const bool right = sign == Sign::any || (sign == Sign::not_negative && *found >= 0.0) ||
                     (sign == Sign::positive && *found > 0.0) || (sign == Sign::not_zero && *found != 0.0);
  if (right) {
    value = *found;
    return;
  }
  constexpr std::array<std::string_view, 4> kWanted{"a number", "0 or more", "a number above 0", "anything but 0"};
  reader.complain(*table.get(key),
                  fmt::format("{}: expected {}, got {}", key, kWanted[static_cast<std::size_t>(sign)], *found));
}

/// +1 or −1.
void sign_into(TomlReader& reader, const toml::table& table, std::string_view key, int& value) {
  const auto found = reader.number(table, key);
  if (!found) return;
  if (*found == 1.0 || *found == -1.0)
    value = *found > 0.0 ? 1 : -1;
  else
    reader.complain(*table.get(key), fmt::format("{}: expected 1 or -1, got {}", key, *found));
}

void kind_into(TomlReader& reader, const toml::table& table, DatumKind& kind) {
  const auto word = reader.word(table, "reference_kind");
  if (!word) return;
  if (*word == "fanuc")
    kind = DatumKind::fanuc;
  else if (*word == "allen_bradley")
    kind = DatumKind::allen_bradley;
  else if (*word == "siemens")
    kind = DatumKind::siemens;
  else
    reader.complain(*table.get("reference_kind"),
                    fmt::format("reference_kind: expected fanuc, allen_bradley or siemens, got \"{}\"", *word));
}

AxisSettings axis_of(TomlReader& reader, const toml::table& table) {
  reader.only(table,
              {"dac_um_per_count", "kv_per_s", "acceleration_mm_s2", "rapid_mm_min", "servo_lag_um_per_m_min",
               "count_polarity", "reference_kind", "reference_direction", "reference_speed_mm_min", "marker_pitch_mm",
               "null_offset_mm", "switch_width_mm", "switch_polarity"},
              "emulator.axis");
  AxisSettings axis;
  number_into(reader, table, "dac_um_per_count", Sign::not_zero, axis.dac_um_per_count);
  number_into(reader, table, "kv_per_s", Sign::positive, axis.kv_per_s);
  number_into(reader, table, "acceleration_mm_s2", Sign::positive, axis.acceleration_mm_s2);
  number_into(reader, table, "rapid_mm_min", Sign::positive, axis.rapid_mm_min);
  number_into(reader, table, "servo_lag_um_per_m_min", Sign::any, axis.servo_lag_um_per_m_min);
  number_into(reader, table, "reference_speed_mm_min", Sign::positive, axis.reference_speed_mm_min);
  number_into(reader, table, "marker_pitch_mm", Sign::positive, axis.marker_pitch_mm);
  number_into(reader, table, "null_offset_mm", Sign::any, axis.null_offset_mm);
  number_into(reader, table, "switch_width_mm", Sign::positive, axis.switch_width_mm);
  sign_into(reader, table, "count_polarity", axis.count_polarity);
  sign_into(reader, table, "switch_polarity", axis.switch_polarity);
  int direction = 1;
  sign_into(reader, table, "reference_direction", direction);
  axis.reference_direction = static_cast<Approach>(direction);
  kind_into(reader, table, axis.reference_kind);
  return axis;
}

LaserSettings laser_of(TomlReader& reader, const toml::table& table) {
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

void serial_number_into(TomlReader& reader, const toml::table& table, std::string& serial_number) {
  const auto word = reader.word(table, "serial_number");
  if (!word) return;
  if (word->empty() || word->size() > 16)
    reader.complain(*table.get("serial_number"),
                    fmt::format("serial_number: expected 1 to 16 characters, got {}", word->size()));
  else
    serial_number = *word;
}

EmulatorSettings settings_of(TomlReader& reader, const toml::table& table, const std::filesystem::path& folder) {
  EmulatorSettings settings;
  reader.only(table, {"serial_number", "seed", "errors", "load_kg", "tool_offset_mm", "axis", "laser"}, "emulator");
  serial_number_into(reader, table, settings.serial_number);
  double seed = 1.0;
  number_into(reader, table, "seed", Sign::not_negative, seed);
  settings.seed = static_cast<std::uint64_t>(seed);
  number_into(reader, table, "load_kg", Sign::not_negative, settings.load_kg);
  if (const auto* offset = reader.child(table, "tool_offset_mm")) {
    reader.only(*offset, {"x", "y", "z"}, "tool_offset_mm");
    number_into(reader, *offset, "x", Sign::any, settings.tool_offset_mm[0]);
    number_into(reader, *offset, "y", Sign::any, settings.tool_offset_mm[1]);
    number_into(reader, *offset, "z", Sign::any, settings.tool_offset_mm[2]);
  }
  if (const auto errors = reader.word(table, "errors")) settings.errors = folder / *errors;
  if (const auto* laser = reader.child(table, "laser")) settings.laser = laser_of(reader, *laser);
  if (const auto* axes = reader.child(table, "axis")) {
    reader.only(*axes, {"X", "Y", "Z"}, "emulator.axis");
    for (const Axis a : kAllAxes)
      if (const auto* axis = reader.child(*axes, std::string(1, letter_of(a))))
        settings.axes[index_of(a)] = axis_of(reader, *axis);
  }
  return settings;
}

}  // namespace

Result<WorkshopMachine> parse_workshop_machine(std::string_view text, const std::string& file,
                                               const std::filesystem::path& folder) {
  auto machine = params::parse_machine(text, file);
  if (!machine) return tl::unexpected(machine.error());
  TomlReader reader(file);
  const auto table = reader.parsed(text);
  if (!table) return tl::unexpected(table.error());
  WorkshopMachine workshop{std::move(machine->machine), {}};
  if (const auto* own = reader.child(*table, "emulator")) workshop.settings = settings_of(reader, *own, folder);
  if (!reader.clean()) return tl::unexpected(reader.all());
  return workshop;
}

Result<WorkshopMachine> load_workshop_machine(const std::filesystem::path& path) {
  const auto text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  return parse_workshop_machine(*text, path.string(), path.parent_path());
}

}  // namespace ecs::emulator
