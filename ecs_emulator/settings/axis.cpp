#include "ecs_emulator/settings/axis.hpp"

#include <fmt/format.h>

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
  reader.complain(*table.get(key), fmt::format("{}: expected {}, got \"{}\"", key, expected, *word));
}

/// A number of a table, and what it may be.
struct Field {
  const char* key;
  double* value;
  double low;
  double high;
};

void fields_into(TomlReader& reader, const toml::table& table, const std::vector<Field>& fields) {
  for (const Field& field : fields) {
    const auto found = reader.number(table, field.key);
    if (!found) continue;
    if (*found >= field.low && *found <= field.high)
      *field.value = *found;
    else
      reader.complain(*table.get(field.key),
                      fmt::format("{}: expected {} to {}, got {}", field.key, field.low, field.high, *found));
  }
}

void only(TomlReader& reader, const toml::table& table, const std::vector<Field>& fields,
          std::vector<std::string> others, std::string_view what) {
  for (const Field& field : fields) others.emplace_back(field.key);
  reader.only(table, others, what);
}

TransducerSettings transducer_of(TomlReader& reader, const toml::table& table) {
  TransducerSettings transducer;
  double counts = 0.0;
  const std::vector<Field> fields{{"period_mm", &transducer.period_mm, 1e-4, 1000.0},
                                  {"offset", &transducer.offset, -0.5, 0.5},
                                  {"imbalance", &transducer.imbalance, -1.0, 1.0},
                                  {"quadrature_mrad", &transducer.quadrature_mrad, -500.0, 500.0},
                                  {"carrier_Hz", &transducer.carrier_Hz, 50.0, 1e6},
                                  {"noise_um", &transducer.noise_um, 0.0, 1000.0},
                                  {"fastest_mm_min", &transducer.fastest_mm_min, 1.0, 1e6},
                                  {"dirt_mm", &transducer.dirt_mm, -1e6, 1e6},
                                  {"dirt_counts", &counts, 0.0, 1e6}};
  only(reader, table, fields, {"excitation"}, "emulator.axis.transducer");
  fields_into(reader, table, fields);
  const bool uneven = transducer.offset != 0.0 || transducer.imbalance != 0.0 || transducer.quadrature_mrad != 0.0;
  if (uneven && transducer.period_mm == 0.0)
    reader.complain(table, "transducer: expected period_mm beside offset, imbalance or quadrature_mrad");
  transducer.dirt_counts = static_cast<std::int64_t>(counts);
  word_into<Excitation, 2>(reader, table, "excitation",
                           {{{"rotor", Excitation::rotor}, {"stator", Excitation::stator}}}, transducer.excitation);
  return transducer;
}

}  // namespace

AxisSettings read_axis_settings(TomlReader& reader, const toml::table& table) {
  AxisSettings axis;
  const std::vector<Field> fields{{"kv_per_s", &axis.kv_per_s, 1.0, 300.0},
                                  {"dac_um_per_count", &axis.dac_um_per_count, -100.0, 100.0},
                                  {"acceleration_mm_s2", &axis.acceleration_mm_s2, 1.0, 1e5},
                                  {"rapid_mm_min", &axis.rapid_mm_min, 10.0, 120'000.0},
                                  {"servo_lag_um_per_m_min", &axis.servo_lag_um_per_m_min, -1e5, 1e5},
                                  {"friction_Nm", &axis.friction_Nm, 0.0, 20.0},
                                  {"breakaway_Nm", &axis.breakaway_Nm, 0.0, 20.0},
                                  {"slip_mm_s", &axis.slip_mm_s, 1e-3, 1000.0},
                                  {"lost_motion_um", &axis.slide.lost_motion_um, 0.0, 1e4},
                                  {"wind_up_um", &axis.slide.wind_up_um, 0.0, 1e4},
                                  {"wind_up_length_mm", &axis.slide.wind_up_length_mm, 1e-3, 1000.0},
                                  {"reference_speed_mm_min", &axis.reference_speed_mm_min, 1.0, 60'000.0},
                                  {"creep_speed_mm_min", &axis.creep_speed_mm_min, 1.0, 60'000.0},
                                  {"marker_pitch_mm", &axis.marker_pitch_mm, 0.1, 100.0},
                                  {"null_offset_mm", &axis.null_offset_mm, -1000.0, 1000.0},
                                  {"switch_width_mm", &axis.switch_width_mm, 0.1, 100.0}};
  only(
      reader, table, fields,
      {"drive", "feedback", "transducer", "count_polarity", "reference_kind", "reference_direction", "switch_polarity"},
      "emulator.axis");
  fields_into(reader, table, fields);
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

}  // namespace ecs::emulator
