#include "core/thermal.hpp"

#include <algorithm>
#include <cmath>

#include <zlib.h>

#include "base/words.hpp"
#include "core/parameters.hpp"

namespace ecs {
namespace {

constexpr double kLargestCoefficient = 1e5, kLargestReference = 1e6, kLongestLag_s = 1e7, kFurthest_mm = 1e6;
constexpr double kFastestActive_s = 1.0, kLargestActive_um = 500.0;

bool within(double value, double least, double greatest) noexcept { return value >= least && value <= greatest; }

/// D = 1 of a translation: c, c·p, c·p² along its direction, p = (position − origin) / 1000.
void add_translation(const ThermalRow& row, std::size_t observed, ThermalPolynomial& to) noexcept {
  const std::size_t a = index_of(moving_axis(row.component));
  const double c = row.coefficient, o = row.origin_mm;
  if (row.law == ThermalLaw::shift || row.law == ThermalLaw::active) {
    to.offset[observed] += c;
  } else if (row.law == ThermalLaw::growth) {
    to.gain[a][observed] += c * 1e-3;
    to.offset[observed] -= c * o * 1e-3;
  } else {
    to.bend[a][observed] += c * 1e-6;
    to.gain[a][observed] -= 2.0 * c * o * 1e-6;
    to.offset[observed] += c * o * o * 1e-6;
  }
}

/// D = 1 of a rotation c about the measurement line, through the levers of the term table.
void add_rotation(const ThermalRow& row, const Term& term, const UnitParameters& p, ThermalWorking::Row& to) noexcept {
  const std::size_t lever = index_of(term.lever), observed = index_of(term.observed);
  const double per_mm = term.sign * p.angular_scale * row.coefficient * 1e-3;
  const double line_mm = p.measurement_lines_mm[index_of(moving_axis(row.component))][lever];
  to.of_tool[lever][observed] += per_mm;
  if (!term.uses_coordinate) return;
  to.of_one.offset[observed] -= per_mm * line_mm;
  to.of_one.gain[lever][observed] += per_mm;
}

void set_tool(ThermalWorking::Row& row, const Vector3& tool_offset_mm) noexcept {
  row.of_one.offset = row.without_tool;
  for (std::size_t l = 0; l < kAxes; ++l)
    for (std::size_t o = 0; o < kAxes; ++o) row.of_one.offset[o] += row.of_tool[l][o] * tool_offset_mm[l];
}

void add_scaled(const ThermalPolynomial& of_one, double by, ThermalPolynomial& to) noexcept {
  for (std::size_t o = 0; o < to.offset.size(); ++o) {
    to.offset[o] += of_one.offset[o] * by;
    for (std::size_t a = 0; a < kAxes; ++a) {
      to.gain[a][o] += of_one.gain[a][o] * by;
      to.bend[a][o] += of_one.bend[a][o] * by;
    }
  }
}

}  // namespace

namespace {
constexpr WordTable<ThermalLaw, kThermalLaws> kLaws{{"shift", "growth", "bending", "active"}};
}  // namespace

std::string_view name_of(ThermalLaw law) noexcept { return kLaws.of(law); }
std::optional<ThermalLaw> thermal_law_named(std::string_view word) noexcept { return kLaws.value_of(word); }

bool sound(const ThermalRow& row) noexcept {
  const bool known = index_of(row.component) < kCurves && static_cast<std::uint8_t>(row.law) < kThermalLaws &&
                     row.source < kThermalSources;
  if (!known || (is_angular(row.component) && row.law != ThermalLaw::shift)) return false;
  const bool active = row.law == ThermalLaw::active;
  if (active != (row.source == kDeviationSource)) return false;
  if (active && !(row.lag_s >= kFastestActive_s && within(row.reference, 0.1, kLargestActive_um))) return false;
  if (row.minus != kNoInput && (row.minus >= kTemperatureInputs || row.source >= kTemperatureInputs)) return false;
  return within(row.coefficient, -kLargestCoefficient, kLargestCoefficient) &&
         within(row.reference, follows_motion(row.source) ? 1.0 : -kLargestReference, kLargestReference) &&
         within(row.lag_s, 0.0, kLongestLag_s) && within(row.origin_mm, -kFurthest_mm, kFurthest_mm);
}

bool sound(const ThermalSettings& s) noexcept {
  return within(s.rate_um_per_s, 1e-3, 2.0) && within(s.hold_s, 0.0, 1e5) && within(s.longest_age_s, 0.1, 1e5) &&
         within(s.stuck_s, 0.0, 1e6) && within(s.fastest_degC_per_s, 1e-4, 10.0) && within(s.step_degC, 0.01, 100.0) &&
         within(s.least_degC, -273.15, 1000.0) && within(s.greatest_degC, -273.15, 1000.0) &&
         s.least_degC < s.greatest_degC;
}

void compile_thermal(std::span<const ThermalRow> rows, const ThermalSettings& settings, const UnitParameters& p,
                     ThermalWorking& working) noexcept {
  working.settings = settings;
  working.count = 0;
  const auto chain = chain_of(p);
  // A temperature changes the machine after its curves were measured: levers of the moving axis itself act too.
  const auto physical = chain ? terms_of(*chain, p.convention, CurveKind::carriage) : std::nullopt;
  if (!physical) return;
  const TermTable terms = terms_in_scope(*physical, *chain, p.scope, p.plane);
  for (const ThermalRow& from : rows) {
    ThermalWorking::Row& row = working.rows[working.count++];
    row = {{}, {}, {}, from.source, from.minus, from.reference, from.lag_s, from.law == ThermalLaw::active};
    for (const Term& term : terms) {
      if (term.component != from.component) continue;
      if (term.has_lever)
        add_rotation(from, term, p, row);
      else
        add_translation(from, index_of(term.observed), row.of_one);
    }
    row.without_tool = row.of_one.offset;
    set_tool(row, p.tool_offset_mm);
  }
}

std::string_view name_of(InputState state) noexcept {
  return WordTable<InputState, kInputStateCount>{{"unused", "good", "missing", "out of range", "jumping", "stuck"}}.of(
      state);
}

namespace {

/// A load is a number that somebody states, a deviation goes to zero: they have a range alone.
bool in_range(std::size_t input, const ThermalSettings& s, double value) noexcept {
  if (input == kDeviationInput) return within(value, -kLargestDeviation_um, kLargestDeviation_um);
  return input == kLoadInput ? within(value, 0.0, kGreatestLoad_kg) : within(value, s.least_degC, s.greatest_degC);
}

/// How the value stands to what was believed last, its course in time apart.
InputState judged(std::size_t i, const ThermalState::Input& input, const InputValue& now,
                  const ThermalSettings& s) noexcept {
  if (!now.present) return InputState::missing;
  if (!in_range(i, s, now.value)) return InputState::out_of_range;
  if (i == kLoadInput) return InputState::good;
  if (input.age_s > s.longest_age_s) return InputState::missing;
  if (i == kDeviationInput) return InputState::good;
  if (s.stuck_s > 0.0 && input.same_s >= s.stuck_s) return InputState::stuck;
  const double drift_degC = s.fastest_degC_per_s * std::min(input.doubtful_s, s.hold_s);
  if (input.has_value && !(std::abs(now.value - input.held) <= s.step_degC + drift_degC)) return InputState::jumping;
  return InputState::good;
}

/// @return the input has become doubtful
bool watch(std::size_t i, ThermalState::Input& input, const InputValue& now, const ThermalSettings& s,
           double seconds) noexcept {
  const bool is_new = now.present && (now.number != input.last.number || !input.last.present);
  input.age_s = is_new ? 0.0 : input.age_s + seconds;
  input.same_s = now.present && input.last.present && now.value == input.last.value ? input.same_s + seconds : 0.0;
  input.last = now;
  const InputState found = judged(i, input, now, s);
  if (is_doubtful(found)) {
    const bool begins = !is_doubtful(input.state);
    if (begins && input.faults < 0xFFFF) ++input.faults;
    input.state = found;
    input.doubtful_s += seconds;
    input.good_s = 0.0;
    return begins;
  }
  if (is_doubtful(input.state) && input.has_value && i != kLoadInput) {
    input.doubtful_s += seconds;
    input.good_s += seconds;
    if (input.good_s < kBelievedAfter_s) return false;
  }
  const bool first = !input.has_value || i == kLoadInput || i == kDeviationInput;
  const double most = s.fastest_degC_per_s * seconds;
  input.held = first ? now.value : input.held + std::clamp(now.value - input.held, -most, most);
  input.has_value = true;
  input.state = InputState::good;
  input.doubtful_s = input.good_s = 0.0;
  return false;
}

/// Of the inputs a row follows, longest doubtful.
double doubtful_s(const ThermalState& state, const ThermalWorking::Row& row) noexcept {
  double longest_s = 0.0;
  for (const std::uint8_t source : {row.source, row.minus}) {
    const auto number = input_of_source(source);
    if (!number) continue;
    const ThermalState::Input& input = state.inputs[*number];
    if (is_doubtful(input.state)) longest_s = std::max(longest_s, input.doubtful_s);
  }
  return longest_s;
}

/// Without a first value a row has no D.
bool has_values(const ThermalState& state, const ThermalWorking::Row& row) noexcept {
  const auto has_value = [&](std::uint8_t source) {
    const auto number = input_of_source(source);
    return !number || state.inputs[*number].has_value;
  };
  return has_value(row.source) && has_value(row.minus);
}

double input_of(const ThermalState& state, const ThermalWorking::Row& row, const Vector3& moved_mm,
                double seconds) noexcept {
  if (follows_motion(row.source)) {
    const double mm_per_min = seconds > 0.0 ? moved_mm[row.source - kMotionOfX] / seconds * 60.0 : 0.0;
    return std::min(1.0, mm_per_min / row.reference);
  }
  if (row.active) return state.inputs[kDeviationInput].held;
  return state.inputs[row.source].held - (row.minus == kNoInput ? row.reference : state.inputs[row.minus].held);
}

double size_um(const ThermalPolynomial& of_one, const Vector3& position_mm) noexcept {
  const Lanes um = value_um(of_one, position_mm);
  return std::abs(um[0]) + std::abs(um[1]) + std::abs(um[2]);
}

/// D of an active row a step later, from what acts: it never runs ahead of the limit in rate, and stands still while
/// its instrument is in doubt.
double worked_against(const ThermalState::Input& deviation, const ThermalWorking::Row& row, double seconds,
                      double applied_um) noexcept {
  if (deviation.state != InputState::good) return applied_um;
  return std::clamp(applied_um - deviation.held * seconds / row.lag_s, -row.reference, row.reference);
}

void sum_up(const ThermalWorking& working, ThermalState& state) noexcept {
  state.acting = {};
  for (std::size_t k = 0; k < working.count; ++k) add_scaled(working.rows[k].of_one, state.applied[k], state.acting);
}

}  // namespace

void set_tool_of_rows(ThermalWorking& working, ThermalState& state, const Vector3& tool_offset_mm) noexcept {
  for (std::size_t k = 0; k < working.count; ++k) set_tool(working.rows[k], tool_offset_mm);
  sum_up(working, state);
}

PerAxis<Vector3> thermal_tool_effect_um_per_mm(const ThermalWorking& working, const ThermalState& state) noexcept {
  PerAxis<Vector3> effect{};
  for (std::size_t k = 0; k < working.count; ++k)
    for (std::size_t l = 0; l < kAxes; ++l)
      for (std::size_t o = 0; o < kAxes; ++o) effect[l][o] += working.rows[k].of_tool[l][o] * state.applied[k];
  return effect;
}

bool begin_thermal(const ThermalWorking& working, ThermalState& state, const InputValues& inputs,
                   const Vector3& position_mm, const StoredThermal* stored, double age_s) noexcept {
  state = ThermalState{};
  state.position_mm = position_mm;
  std::array<bool, kLiveInputs> used{};
  for (std::size_t k = 0; k < working.count; ++k)
    for (const std::uint8_t source : {working.rows[k].source, working.rows[k].minus})
      if (const auto number = input_of_source(source)) used[*number] = true;
  bool doubtful = false;
  for (std::size_t i = 0; i < kLiveInputs; ++i)
    if (used[i]) doubtful = watch(i, state.inputs[i], inputs[i], working.settings, 0.0) || doubtful;
  if (stored != nullptr) state.stored_age_s = age_s;
  for (std::size_t k = 0; k < working.count; ++k) {
    const ThermalWorking::Row& row = working.rows[k];
    if (!has_values(state, row)) continue;
    if (row.active) continue;  // it begins with nothing
    const double now = input_of(state, row, {}, 0.0);
    const bool follows = stored != nullptr && row.lag_s > 0.0;
    state.lagged[k] = follows ? now + (stored->lagged[k] - now) * std::exp(-age_s / row.lag_s) : now;
    state.applied[k] = state.lagged[k];
    state.has_begun[k] = true;
  }
  sum_up(working, state);
  return doubtful;
}

bool step_thermal(const ThermalWorking& working, ThermalState& state, const InputValues& inputs,
                  const Vector3& position_mm, double seconds) noexcept {
  bool doubtful = false;
  for (std::size_t i = 0; i < kLiveInputs; ++i)
    if (state.inputs[i].state != InputState::unused)
      doubtful = watch(i, state.inputs[i], inputs[i], working.settings, seconds) || doubtful;
  Vector3 moved_mm{};
  for (std::size_t a = 0; a < kAxes; ++a) moved_mm[a] = std::abs(position_mm[a] - state.position_mm[a]);
  state.position_mm = position_mm;
  const double most_um =
      working.settings.rate_um_per_s * seconds / static_cast<double>(std::max<std::size_t>(working.count, 1));
  for (std::size_t k = 0; k < working.count; ++k) {
    const ThermalWorking::Row& row = working.rows[k];
    if (row.active) {
      state.lagged[k] = worked_against(state.inputs[kDeviationInput], row, seconds, state.applied[k]);
    } else if (has_values(state, row)) {
      const double now = input_of(state, row, moved_mm, seconds);
      if (!state.has_begun[k]) state.lagged[k] = follows_motion(row.source) ? 0.0 : now;
      state.has_begun[k] = true;
      const double part = row.lag_s > 0.0 ? seconds / (row.lag_s + seconds) : 1.0;
      state.lagged[k] += (now - state.lagged[k]) * part;
    }
    const double target = doubtful_s(state, row) > working.settings.hold_s ? 0.0 : state.lagged[k];
    const double change = target - state.applied[k];
    const double change_um = size_um(row.of_one, position_mm) * std::abs(change);
    state.applied[k] += change_um > most_um ? change * (most_um / change_um) : change;
  }
  sum_up(working, state);
  return doubtful;
}

namespace {

constexpr std::uint32_t kThermalMagic = 0x5448524D;  // "THRM"
constexpr std::uint32_t kLaggedAt = 24, kThermalCheckAt = kLaggedAt + 8 * kMostThermalRows;
static_assert(kThermalCheckAt + 4 <= kStoredThermalBytes);

std::uint32_t crc_of(ByteView slot) noexcept {
  return static_cast<std::uint32_t>(::crc32_z(0, slot.data(), kThermalCheckAt));
}

std::optional<StoredThermal> slot_in(ByteView bytes) noexcept {
  if (load_big<std::uint32_t>(bytes, 0) != kThermalMagic) return std::nullopt;
  if (load_big<std::uint32_t>(bytes, kThermalCheckAt) != crc_of(bytes)) return std::nullopt;
  StoredThermal stored{
      load_big<std::uint32_t>(bytes, 4), load_big<std::uint32_t>(bytes, 8), load_double(bytes, 16), {}};
  if (!std::isfinite(stored.clock_s)) return std::nullopt;
  for (std::size_t k = 0; k < kMostThermalRows; ++k) {
    stored.lagged[k] = load_double(bytes, kLaggedAt + 8 * k);
    if (!within(stored.lagged[k], -2.0 * kLargestReference, 2.0 * kLargestReference)) return std::nullopt;
  }
  return stored;
}

}  // namespace

std::optional<StoredThermal> stored_thermal(ByteView region) noexcept { return newest_record(region, slot_in); }
std::uint32_t next_thermal_slot(ByteView region) noexcept { return next_slot(region, slot_in); }

void encode_thermal(const StoredThermal& stored, Bytes slot) noexcept {
  std::fill(slot.begin(), slot.end(), std::uint8_t{0});
  store_big(slot, 0, kThermalMagic);
  store_big(slot, 4, stored.sequence);
  store_big(slot, 8, stored.image_check);
  store_double(slot, 16, stored.clock_s);
  for (std::size_t k = 0; k < kMostThermalRows; ++k) store_double(slot, kLaggedAt + 8 * k, stored.lagged[k]);
  store_big(slot, kThermalCheckAt, crc_of(slot));
}

}  // namespace ecs
