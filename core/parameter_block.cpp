// Parameters as the fixed block of the memory image. The order of the lines is the layout: append only, then raise
// kImageFormat. One list of fields serves both directions.
#include <algorithm>
#include <cmath>

#include "core/memory_image.hpp"

namespace ecs {
namespace {

/// Far beyond every number of a machine tool, far below what could overflow in the tick.
constexpr double kLargestNumber = 1e9;

/// Walks the block field by field, storing.
class Writer {
 public:
  explicit Writer(Bytes block) noexcept : block_(block) {}
  void byte(std::uint8_t value) noexcept { block_[at_++] = value; }
  void number(double value) noexcept {
    store_double(block_, at_, value);
    at_ += 8;
  }
  template <class E>
  void word(E value, E) noexcept {
    byte(static_cast<std::uint8_t>(value));
  }
  void flag(bool value) noexcept { byte(value ? 1 : 0); }
  void sign(std::int8_t value) noexcept { byte(static_cast<std::uint8_t>(value)); }
  void letter(char value) noexcept { byte(static_cast<std::uint8_t>(value)); }

 private:
  Bytes block_;
  std::size_t at_ = 0;
};

/// Walks the block field by field, loading; remembers whether every value can be.
class Reader {
 public:
  explicit Reader(ByteView block) noexcept : block_(block) {}
  [[nodiscard]] bool sound() const noexcept { return sound_; }
  void byte(std::uint8_t& value) noexcept { value = block_[at_++]; }
  void number(double& value) noexcept {
    value = load_double(block_, at_);
    at_ += 8;
    sound_ = sound_ && std::abs(value) <= kLargestNumber;  // not a number fails as well
  }
  template <class E>
  void word(E& value, E last) noexcept {
    const std::uint8_t code = block_[at_++];
    sound_ = sound_ && code <= static_cast<std::uint8_t>(last);
    value = static_cast<E>(code);
  }
  void flag(bool& value) noexcept {
    const std::uint8_t code = block_[at_++];
    sound_ = sound_ && code <= 1;
    value = code == 1;
  }
  void sign(std::int8_t& value) noexcept {
    value = static_cast<std::int8_t>(block_[at_++]);
    sound_ = sound_ && (value == 1 || value == -1);
  }
  void letter(char& value) noexcept {
    value = static_cast<char>(block_[at_++]);
    sound_ = sound_ && (value == '\0' || value == 'T' || axis_of(value).has_value());
  }

 private:
  ByteView block_;
  std::size_t at_ = 0;
  bool sound_ = true;
};

template <class Walk, class Datum>
void walk_datum(Walk& walk, Datum& d) noexcept {
  walk.word(d.kind, DatumKind::siemens);
  walk.sign(d.switch_polarity);
  walk.flag(d.switch_initially_active);
  walk.flag(d.switch_finally_active);
  walk.number(d.approach_speed_mm_min);
  bool forward = d.approach_direction == Approach::forward;
  walk.flag(forward);
  if constexpr (!std::is_const_v<Datum>) d.approach_direction = forward ? Approach::forward : Approach::reverse;
  walk.number(d.null_offset_mm);
  walk.number(d.reference_position_mm);
}

template <class Walk, class AxisValues>
void walk_axis(Walk& walk, AxisValues& a) noexcept {
  walk.word(a.transducer, Transducer::resolver);
  walk.number(a.position_scale_um_per_count);
  walk.number(a.deadband_um);
  walk.number(a.output_scale_counts_per_um);
  walk.sign(a.compensation_polarity);
  walk.number(a.output_limit_um);
  walk.number(a.output_slew_um_per_s);
  walk.number(a.position_loop_gain_per_s);
  walk_datum(walk, a.datum);
}

template <class Walk, class Parameters>
void walk_all(Walk& walk, Parameters& p) noexcept {
  for (auto& letter : p.configuration) walk.letter(letter);
  for (auto& present : p.axis_present) walk.flag(present);
  walk.word(p.measurement_system, MeasurementSystem::imperial);
  walk.byte(p.memory_modules);
  walk.word(p.scope, Scope::volumetric);
  walk.word(p.plane.first, Axis::Z);
  walk.word(p.plane.second, Axis::Z);
  walk.word(p.interpolation, Interpolation::linear);
  walk.word(p.convention, Convention::as_printed);
  walk.number(p.loop_period_us);
  walk.number(p.angular_scale);
  walk.number(p.C0Y_um_per_m);
  walk.number(p.B0Z_um_per_m);
  walk.number(p.A0Z_um_per_m);
  for (auto& mm : p.tool_offset_mm) walk.number(mm);
  for (auto& line : p.measurement_lines_mm)
    for (auto& mm : line) walk.number(mm);
  for (auto& axis : p.axes) walk_axis(walk, axis);
  for (auto& mm : p.tool_range_mm) walk.number(mm);
  walk.number(p.tool_rate_um_per_s);
  walk.number(p.load_range_kg);
  walk.number(p.unknown_input_limit_um);
}

/// Images of before end with the axes, and zeros follow.
void add_defaults(UnitParameters& p) noexcept {
  if (p.tool_rate_um_per_s == 0.0) p.tool_rate_um_per_s = UnitParameters{}.tool_rate_um_per_s;
  if (p.unknown_input_limit_um == 0.0) p.unknown_input_limit_um = UnitParameters{}.unknown_input_limit_um;
}

/// Ranges without which the core cannot run; params/ holds the narrower ones that make sense.
bool usable(const UnitParameters& p) noexcept {
  if (!chain_of(p) || !terms_of(p)) return false;
  if (p.memory_modules < 1 || p.memory_modules > kMostModules) return false;
  if (p.loop_period_us < 100.0 || p.loop_period_us > 20'000.0) return false;
  const bool ranges = std::all_of(p.tool_range_mm.begin(), p.tool_range_mm.end(), [](double mm) { return mm >= 0.0; });
  if (!ranges || p.load_range_kg < 0.0 || p.tool_rate_um_per_s < 0.0 || p.unknown_input_limit_um < 0.0) return false;
  return std::all_of(p.axes.begin(), p.axes.end(), [](const AxisParameters& a) {
    return a.position_scale_um_per_count != 0.0 && a.deadband_um >= 0.0 && a.output_scale_counts_per_um > 0.0 &&
           a.output_limit_um >= 0.0 && a.output_slew_um_per_s > 0.0 && a.position_loop_gain_per_s > 0.0 &&
           a.datum.approach_speed_mm_min > 0.0;
  });
}

}  // namespace

void encode_parameters(const UnitParameters& parameters, Bytes block) noexcept {
  std::fill(block.begin(), block.end(), std::uint8_t{0});
  Writer writer(block);
  walk_all(writer, parameters);
}

std::optional<UnitParameters> decode_parameters(ByteView block) noexcept {
  UnitParameters parameters;
  Reader reader(block);
  walk_all(reader, parameters);
  if (!reader.sound() || !usable(parameters)) return std::nullopt;
  add_defaults(parameters);
  return parameters;
}

}  // namespace ecs
