#include "ecs_emulator/errors/true_errors.hpp"

#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/units.hpp"
#include "ecs_emulator/effects/effects.hpp"
#include "ecs_emulator/errors/reader.hpp"
#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {

struct TrueErrors::Parts : ErrorParts {
  MachinePlace place;

  void set(const MachineState& state, const Heat& from);
  void set_moving(const MachineState& state, Axis axis, double from_mm);
  [[nodiscard]] double value_of(const FileEffect& one, const MachineState& state, const Heat& from);
  /// What is wrong with a curve at the ends, the middle and the datum of its axis, if anything.
  /// @param from_mm  where the positions of the curve count from
  [[nodiscard]] std::optional<std::string> out_of_reach(const params::MachineAxis& facts, Axis axis, double from_mm,
                                                        const ErrorCurve& curve);
  /// What is wrong with a formula of `[temperature]` within a day, if anything.
  [[nodiscard]] std::optional<std::string> no_temperature(const TemperatureFormula& sensor);
  /// A sensor of `[temperature]`; leaves the formulas' time at `time_s`.
  [[nodiscard]] double formula_degC(const std::string& sensor, double time_s);
  /// The temperature of any sensor, and what it was when the machine was switched on.
  [[nodiscard]] std::array<double, 2> degC_of(const std::string& sensor, double time_s, const Heat& from);
};

namespace {

constexpr double kLargestError = 1e6;  ///< um or um/m: no machine errs by a metre

/// A smooth shape of standard deviation 1 over the travel: offset (half of the variance), slope (a quarter) and two
/// waves (a quarter).
double shape(std::uint64_t seed, double place) {
  constexpr double kTwoPi = 6.283185307179586;
  Random random(seed);
  const double offset = std::sqrt(0.5) * random.normal();
  const double slope = std::sqrt(0.25 * 3.0) * random.normal();
  double value = offset + slope * (2.0 * place - 1.0);
  for (const double waves : {1.0, 2.0}) {
    const double size = std::sqrt(0.125 * 2.0) * random.normal();
    value += size * std::sin(kTwoPi * (waves * place + random.uniform()));
  }
  return value;
}

/// Place of a sensor of `[sensor.name]`; nothing where it is one of `[temperature]`.
std::optional<std::size_t> heat_sensor(const ErrorParts& parts, const std::string& name) {
  for (std::size_t i = 0; i < parts.heat.sensors.size(); ++i)
    if (parts.heat.sensors[i].name == name) return i;
  return std::nullopt;
}

}  // namespace

void TrueErrors::Parts::set(const MachineState& state, const Heat& from) {
  variables.x = state.position_mm[0];
  variables.y = state.position_mm[1];
  variables.z = state.position_mm[2];
  variables.t = state.time_s;
  variables.f = state.feed_mm_min;
  variables.m = state.load_kg;
  for (std::size_t i = 0; i < from.sensors(); ++i)
    variables.temperatures[heat.sensors[i].name] = from.degC_at(i, state.time_s);
  for (const TemperatureFormula& sensor : temperatures) variables.temperatures[sensor.name] = sensor.formula.value();
}

/// @param from_mm  where `p` counts from
void TrueErrors::Parts::set_moving(const MachineState& state, Axis axis, double from_mm) {
  const std::size_t i = index_of(axis);
  variables.p = state.position_mm[i] - from_mm;
  variables.d = state.approach[i] == Approach::reverse ? -1.0 : 1.0;
  variables.u = state.travel_since_reversal_mm[i];
}

double TrueErrors::Parts::formula_degC(const std::string& sensor, double time_s) {
  for (const TemperatureFormula& one : temperatures) {
    if (one.name != sensor) continue;
    variables.t = time_s;
    return one.formula.value();
  }
  return 0.0;
}

std::array<double, 2> TrueErrors::Parts::degC_of(const std::string& sensor, double time_s, const Heat& from) {
  if (const auto i = heat_sensor(*this, sensor))
    return *i < from.sensors() ? std::array{from.degC_at(*i, time_s), from.first_degC_at(*i)} : std::array{0.0, 0.0};
  const double first_degC = formula_degC(sensor, 0.0);
  return {formula_degC(sensor, time_s), first_degC};
}

double TrueErrors::Parts::value_of(const FileEffect& one, const MachineState& state, const Heat& from) {
  const PlacedEffect& effect = one.effect;
  const std::size_t axis = index_of(*effect.axis);
  if (effect.approach != Approach::unknown && effect.approach != state.approach[axis]) return 0.0;
  set_moving(state, *effect.axis, place.datum_mm[axis]);
  Conditions at{.p_mm = variables.p,
                .approach = variables.d,
                .curve = one.curve ? one.curve->value(variables) : 0.0,
                .time_s = state.time_s,
                .feed_mm_min = state.feed_mm_min,
                .load_kg = state.load_kg,
                .travel_since_reversal_mm = state.travel_since_reversal_mm[axis]};
  if (effect.kind->of_material) at.material_degC = from.material_degC(state.time_s);
  for (std::size_t i = 0; i < static_cast<std::size_t>(effect.kind->sensors); ++i) {
    const auto [now, first] = degC_of(i == 0 ? effect.sensor : effect.sensor2, state.time_s, from);
    at.degC[i] = now;
    if (i == 0) at.first_degC = first;
  }
  return effect.kind->value(effect, at);
}

TrueErrors::TrueErrors() : parts_(std::make_unique<Parts>()) {}
TrueErrors::~TrueErrors() = default;
TrueErrors::TrueErrors(TrueErrors&&) noexcept = default;
TrueErrors& TrueErrors::operator=(TrueErrors&&) noexcept = default;

Result<TrueErrors> TrueErrors::load(const std::filesystem::path& path) {
  const auto text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  return parse(*text, path.string(), path.parent_path());
}

Result<TrueErrors> TrueErrors::parse(std::string_view text, const std::string& file,
                                     const std::filesystem::path& folder) {
  TomlReader reader(file);
  const auto table = reader.parsed(text);
  if (!table) return tl::unexpected(table.error());
  TrueErrors errors;
  errors.parts_->file = file;
  reader.only(*table,
              {"squareness", "location", "contribution", "effect", "scatter", "temperature", "gravity", "ram", "bed",
               "table", "air", "column", "material", "spindle", "screw", "sensor", "artefact"},
              "errors file");
  ErrorsReading reading{reader, *table, folder, *errors.parts_};
  read_heat(reading);
  read_curves(reading);
  read_effects(reading);
  read_gravity(reading);
  read_artefacts(reading);
  read_location(reading);
  if (!reader.clean()) return tl::unexpected(reader.all());
  return errors;
}

Result<void> TrueErrors::checked_for(const params::Machine& machine) const {
  std::vector<Problem> problems;
  const Chain chain = params::chain_of(machine).value_or(Chain{});
  for (const Demand& demand : parts_->demands) {
    const std::size_t a = index_of(demand.axis);
    const auto complain = [&](const std::string& message) {
      problems.push_back({ProblemKind::bad_input, demand.table + ": " + message, parts_->file, demand.line, 0, {}});
    };
    if (!chain.has(demand.axis)) {
      complain(fmt::format("this machine has no {}", letter_of(demand.axis)));
      continue;
    }
    if (demand.side == Demand::Side::tool && chain.carries_workpiece[a])
      complain(fmt::format("expected an axis on the tool side, {} is on the workpiece side", letter_of(demand.axis)));
    if (demand.side == Demand::Side::workpiece && !chain.carries_workpiece[a])
      complain(fmt::format("expected an axis on the workpiece side, {} is on the tool side", letter_of(demand.axis)));
    const auto& travel_mm = machine.axes[a]->travel_mm;
    if (demand.covers_mm && ((*demand.covers_mm)[0] > travel_mm[0] || (*demand.covers_mm)[1] < travel_mm[1]))
      complain(fmt::format("expected supports on both sides of the travel {} … {} mm", travel_mm[0], travel_mm[1]));
  }
  for (std::size_t a = 0; a < kAxes; ++a)
    if (const int line = parts_->rotary.line[a]; line > 0 && !machine.rotary[a])
      problems.push_back({ProblemKind::bad_input,
                          fmt::format("this machine has no rotary axis {}", "ABC"[a]),
                          parts_->file,
                          line,
                          0,
                          {}});
  for (const RotaryMotion& one : parts_->rotary.motions) {
    const std::string& letters = machine.rotary_configuration;
    if (one.bends != Bends::nothing && letters.find("ABC"[one.axis]) < letters.find('T'))
      problems.push_back(
          {ProblemKind::bad_input,
           fmt::format("bends: expected an axis on the tool side, {} is on the workpiece side", "ABC"[one.axis]),
           parts_->file,
           one.line,
           0,
           {}});
  }
  const auto judge = [&](const std::string& what, Axis axis, bool from_datum, const ErrorCurve& curve, int line) {
    const auto& facts = machine.axes[index_of(axis)];
    if (!facts) return;
    if (const auto wrong = parts_->out_of_reach(*facts, axis, from_datum ? facts->datum_mm : 0.0, curve))
      problems.push_back({ProblemKind::bad_input, what + ": " + *wrong, parts_->file, line, 0, {}});
  };
  for (const Contribution& one : parts_->contributions)
    judge(fmt::format("contribution to {}", name_of(one.component)), moving_axis(one.component), false, one.curve,
          one.line);
  for (const FileEffect& one : parts_->effects)
    if (one.curve) judge("effect " + name_of(one.effect), *one.effect.axis, true, *one.curve, 0);
  for (const Artefact& one : parts_->artefacts)
    if (one.form) judge("artefact", one.axis, false, *one.form, one.line);
  for (const TemperatureFormula& sensor : parts_->temperatures)
    if (auto wrong = parts_->no_temperature(sensor))
      problems.push_back({ProblemKind::bad_input, *wrong, parts_->file, 0, 0, {}});
  if (problems.empty()) return {};
  return tl::unexpected(folded(std::move(problems)));
}

std::optional<std::string> TrueErrors::Parts::out_of_reach(const params::MachineAxis& facts, Axis axis, double from_mm,
                                                           const ErrorCurve& curve) {
  const auto [low_mm, high_mm] = facts.travel_mm;
  MachineState state;
  for (const double at_mm : {low_mm, std::midpoint(low_mm, high_mm), high_mm, facts.datum_mm})
    for (const Approach approach : {Approach::forward, Approach::reverse}) {
      state.position_mm[index_of(axis)] = at_mm;
      state.approach[index_of(axis)] = approach;
      set_moving(state, axis, from_mm);
      const double value = curve.formula ? curve.formula->raw() : curve.value(variables);
      if (!(std::abs(value) <= kLargestError))
        return fmt::format("expected values within {} um or um/m, at {} mm it is {}", kLargestError, at_mm, value);
    }
  return std::nullopt;
}

std::optional<std::string> TrueErrors::Parts::no_temperature(const TemperatureFormula& sensor) {
  for (const double at_s : {0.0, 60.0, 3'600.0, 86'400.0}) {
    variables.t = at_s;
    const double degC = sensor.formula.raw();
    if (!std::isfinite(degC))
      return fmt::format("temperature.{}: expected finite values, at {} s it is {}", sensor.name, at_s, degC);
  }
  return std::nullopt;
}

RotaryValues TrueErrors::rotary_at(const RotaryState& state) const {
  return values_of(parts_->rotary, parts_->variables, state);
}

void TrueErrors::put_on(const MachinePlace& machine) { parts_->place = machine; }

const HeatSettings& TrueErrors::heat() const { return parts_->heat; }

ComponentValues TrueErrors::at(const MachineState& state, const Heat& heat) const {
  Parts& parts = *parts_;
  ComponentValues values = parts.constants;
  parts.set(state, heat);
  for (const Contribution& contribution : parts.contributions) {
    parts.set_moving(state, moving_axis(contribution.component), 0.0);
    values[index_of(contribution.component)] += contribution.curve.value(parts.variables);
  }
  for (const FileEffect& effect : parts.effects)
    values[index_of(effect.component)] += parts.value_of(effect, state, heat);
  add_gravity(parts.gravity, parts.place, state.position_mm, state.load_kg, values);
  heat.add_errors(state.position_mm, state.time_s, values);
  return values;
}

double TrueErrors::artefact_um(Axis axis, Sense sense, double position_mm) const {
  double sum_um = 0.0;
  for (const Artefact& one : parts_->artefacts) {
    if (one.axis != axis || one.sense != sense) continue;
    sum_um += one.angle_um_per_m * (position_mm - parts_->place.datum_mm[index_of(axis)]) / kMmPerM;
    if (!one.form) continue;
    parts_->variables.p = position_mm;
    parts_->variables.d = 1.0;
    sum_um += one.form->value(parts_->variables);
  }
  return sum_um;
}

ComponentValues TrueErrors::pass_scatter(const MachineState& state, const PerAxis<std::array<double, 2>>& travel_mm,
                                         std::uint64_t seed) const {
  ComponentValues values{};
  for (std::size_t c = 0; c < kCurves; ++c) {
    if (parts_->pass_sigma[c] == 0.0) continue;
    const std::size_t axis = index_of(moving_axis(static_cast<Component>(c)));
    const auto [low, high] = travel_mm[axis];
    const double place = high > low ? (state.position_mm[axis] - low) / (high - low) : 0.0;
    values[c] = parts_->pass_sigma[c] * shape(seed_of(seed, c, state.pass[axis]), place);
  }
  return values;
}

const ComponentValues& TrueErrors::reading_scatter() const { return parts_->reading_sigma; }

std::vector<NamedTemperature> TrueErrors::temperatures(double time_s) const {
  parts_->variables.t = time_s;
  std::vector<NamedTemperature> found;
  for (const TemperatureFormula& sensor : parts_->temperatures) found.emplace_back(sensor.name, sensor.formula.value());
  return found;
}

}  // namespace ecs::emulator
