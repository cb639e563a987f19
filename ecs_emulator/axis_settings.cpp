#include "ecs_emulator/axis_settings.hpp"

#include <fmt/format.h>

#include "ecs_emulator/settings_reader.hpp"

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
  reader.complain(*table.get(key), fmt::format("{}: expected {}, got \"{}\"", key, expected, *word));
}

TransducerSettings transducer_of(TomlReader& reader, const toml::table& table) {
  reader.only(table,
              {"period_mm", "offset", "imbalance", "quadrature_mrad", "excitation", "carrier_Hz", "noise_um",
               "fastest_mm_min", "dirt_mm", "dirt_counts"},
              "emulator.axis.transducer");
  TransducerSettings transducer;
  number_into(reader, table, "period_mm", Sign::positive, transducer.period_mm);
  number_into(reader, table, "offset", Sign::any, transducer.offset);
  number_into(reader, table, "imbalance", Sign::any, transducer.imbalance);
  number_into(reader, table, "quadrature_mrad", Sign::any, transducer.quadrature_mrad);
  number_into(reader, table, "carrier_Hz", Sign::positive, transducer.carrier_Hz);
  number_into(reader, table, "noise_um", Sign::not_negative, transducer.noise_um);
  number_into(reader, table, "fastest_mm_min", Sign::positive, transducer.fastest_mm_min);
  number_into(reader, table, "dirt_mm", Sign::any, transducer.dirt_mm);
  double counts = 0.0;
  number_into(reader, table, "dirt_counts", Sign::not_negative, counts);
  transducer.dirt_counts = static_cast<std::int64_t>(counts);
  word_into<Excitation, 2>(reader, table, "excitation",
                           {{{"rotor", Excitation::rotor}, {"stator", Excitation::stator}}}, transducer.excitation);
  return transducer;
}

}  // namespace

AxisSettings read_axis_settings(TomlReader& reader, const toml::table& table) {
  reader.only(table,
              {"drive",
               "feedback",
               "friction_Nm",
               "breakaway_Nm",
               "slip_mm_s",
               "lost_motion_um",
               "wind_up_um",
               "wind_up_length_mm",
               "transducer",
               "dac_um_per_count",
               "kv_per_s",
               "acceleration_mm_s2",
               "rapid_mm_min",
               "servo_lag_um_per_m_min",
               "count_polarity",
               "reference_kind",
               "reference_direction",
               "reference_speed_mm_min",
               "creep_speed_mm_min",
               "marker_pitch_mm",
               "null_offset_mm",
               "switch_width_mm",
               "switch_polarity"},
              "emulator.axis");
  AxisSettings axis;
  number_into(reader, table, "dac_um_per_count", Sign::not_zero, axis.dac_um_per_count);
  number_into(reader, table, "kv_per_s", Sign::positive, axis.kv_per_s);
  number_into(reader, table, "acceleration_mm_s2", Sign::positive, axis.acceleration_mm_s2);
  number_into(reader, table, "rapid_mm_min", Sign::positive, axis.rapid_mm_min);
  number_into(reader, table, "servo_lag_um_per_m_min", Sign::any, axis.servo_lag_um_per_m_min);
  number_into(reader, table, "reference_speed_mm_min", Sign::positive, axis.reference_speed_mm_min);
  number_into(reader, table, "creep_speed_mm_min", Sign::positive, axis.creep_speed_mm_min);
  number_into(reader, table, "marker_pitch_mm", Sign::positive, axis.marker_pitch_mm);
  number_into(reader, table, "null_offset_mm", Sign::any, axis.null_offset_mm);
  number_into(reader, table, "switch_width_mm", Sign::positive, axis.switch_width_mm);
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
  number_into(reader, table, "friction_Nm", Sign::not_negative, axis.friction_Nm);
  number_into(reader, table, "breakaway_Nm", Sign::not_negative, axis.breakaway_Nm);
  number_into(reader, table, "slip_mm_s", Sign::positive, axis.slip_mm_s);
  number_into(reader, table, "lost_motion_um", Sign::not_negative, axis.slide.lost_motion_um);
  number_into(reader, table, "wind_up_um", Sign::not_negative, axis.slide.wind_up_um);
  number_into(reader, table, "wind_up_length_mm", Sign::positive, axis.slide.wind_up_length_mm);
  if (const auto* transducer = reader.child(table, "transducer")) axis.transducer = transducer_of(reader, *transducer);
  return axis;
}

}  // namespace ecs::emulator
