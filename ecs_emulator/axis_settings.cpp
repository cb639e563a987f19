#include "ecs_emulator/axis_settings.hpp"

#include <fmt/format.h>

#include "ecs_emulator/settings_reader.hpp"

namespace ecs::emulator {
namespace {

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

}  // namespace

AxisSettings read_axis_settings(TomlReader& reader, const toml::table& table) {
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

}  // namespace ecs::emulator
