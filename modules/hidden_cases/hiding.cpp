#include "modules/hidden_cases/hiding.hpp"

#include <algorithm>
#include <numbers>

#include "base/units.hpp"
#include "modules/hidden_cases/places.hpp"

namespace ecs::emulator {
namespace {

/// Draws a curve without mean and slope over the readings on which the effect acts (least squares).
bool draw_curve_without_line(const Drawing& drawing, DrawnEffect& effect) {
  effect.curve = draw_curve(drawing.random, places_under(drawing.ground, effect));
  double n = 0.0, sx = 0.0, sxx = 0.0, sv = 0.0, sxv = 0.0;
  const double centre_mm = 0.5 * (effect.curve.from_mm + effect.curve.to_mm);
  const double half_mm = 0.5 * (effect.curve.to_mm - effect.curve.from_mm);
  for (const Stop& stop : drawing.scene.stops) {
    if (!acts_on(effect, stop)) continue;
    const double x = (drawing.scene.p_mm(stop, *effect.axis) - centre_mm) / half_mm;
    const double v = value_at(effect.curve, drawing.scene.p_mm(stop, *effect.axis));
    n += 1.0;
    sx += x;
    sxx += x * x;
    sv += v;
    sxv += x * v;
  }
  const double slope = (n * sxv - sx * sv) / (n * sxx - sx * sx);
  effect.curve.slope = -slope;
  effect.curve.mean = -(sv - slope * sx) / n;
  return true;
}

constexpr double kMostWaves = 60.0;  ///< that are tried over a travel

/// Periods at which to try it: ever closer, as many waves as the targets can show.
std::vector<double> periods_mm(const Scene&, const Ground& ground, const DrawnEffect& effect) {
  std::vector<double> periods;
  const auto& places = ground.cover(*effect.sense, *effect.axis).places_mm;
  const double length_mm = places.back() - places.front();
  const double most = std::min(kMostWaves, static_cast<double>(places.size()) / 2.0);
  double waves = 1.0;
  while (waves < most) {
    periods.push_back(length_mm / waves);
    waves *= 1.0 + 0.2 / (waves + 1.0);
  }
  return periods;
}

/// A period that the machine's facts suggest, or any.
double draw_period_mm(Random& random, const Scene& scene, Axis axis) {
  const auto pitch = scene.machine.axes[index_of(axis)]->screw_pitch_mm;
  if (pitch && chance(random, 0.7)) return *pitch * one(random, std::vector{1.0, 1.0, 1.0, 1.0, 2.0, 0.5});
  return rounded(log_between(random, 4.0, 40.0), 1000.0);
}

/// The targets show a wave of this period without taking it for another.
bool period_shows(const Scene& scene, const std::vector<double>& places, double period_mm) {
  const double length_mm = places.back() - places.front();
  const double step_mm = length_mm / static_cast<double>(places.size() - 1);
  if (length_mm < 3.0 * period_mm) return false;
  return scene.even_grid ? period_mm > 2.5 * step_mm : places.size() >= 16;
}

bool draw_cyclic(const Drawing& drawing, DrawnEffect& e) {
  const auto& [random, scene, ground, sign] = drawing;
  const auto& cover = ground.cover(*e.sense, *e.axis);
  const double period_mm = draw_period_mm(random, scene, *e.axis);
  if (!period_shows(scene, cover.places_mm, period_mm)) return false;
  e.parameters = {{"period_mm", period_mm},
                  {"amplitude_um", 1.4},
                  {"phase_rad", rounded(between(random, 0.0, 2.0 * std::numbers::pi), 1000.0)},
                  {"amplitude2_um", 0.0},
                  {"phase2_rad", 0.0}};
  if (period_shows(scene, cover.places_mm, period_mm / 2.0) && chance(random, 0.4)) {
    e.parameters["amplitude2_um"] = 1.4 * between(random, 0.2, 0.7);
    e.parameters["phase2_rad"] = rounded(between(random, 0.0, 2.0 * std::numbers::pi), 1000.0);
  }
  if (cover.both_ways && scene.shown.approach && chance(random, 0.3))
    e.approach = chance(random, 0.5) ? Approach::forward : Approach::reverse;
  return true;
}

/// Sine and cosine of either harmonic.
std::vector<DrawnEffect> cyclic_units(const DrawnEffect& effect) {
  std::vector<DrawnEffect> units;
  for (const double phase : {0.0, std::numbers::pi / 2.0}) {
    DrawnEffect first = effect;
    first.parameters["amplitude_um"] = 1.0;
    first.parameters["phase_rad"] = phase;
    first.parameters["amplitude2_um"] = 0.0;
    units.push_back(first);
    DrawnEffect second = effect;
    second.parameters["amplitude_um"] = 0.0;
    second.parameters["amplitude2_um"] = 1.0;
    second.parameters["phase2_rad"] = phase;
    units.push_back(second);
  }
  return units;
}

std::vector<double> between_targets_mm(const Scene&, const Ground& ground, const DrawnEffect& effect) {
  std::vector<double> middles;
  const auto& places = ground.cover(*effect.sense, *effect.axis).places_mm;
  for (std::size_t k = 1; k < places.size(); ++k) middles.push_back(0.5 * (places[k - 1] + places[k]));
  return middles;
}

/// Between two targets, three of them at least on either side and not near the ends: fewer are readings that are wrong
/// together.
bool draw_step(const Drawing& drawing, DrawnEffect& e) {
  const auto& places = places_under(drawing.ground, e);
  const int count = static_cast<int>(places.size());
  if (count < 8) return false;
  const int beyond = std::max(2, count / 5);
  const auto k = static_cast<std::size_t>(whole(drawing.random, beyond, count - 2 - beyond));
  e.parameters = {{"height_um", 2.0 * drawing.sign},
                  {"position_mm", rounded(between(drawing.random, places[k], places[k + 1]), 1000.0)}};
  return e.parameters["position_mm"] > places[k] && e.parameters["position_mm"] < places[k + 1];
}

std::vector<double> time_constants_s(const Scene& scene, const Ground&, const DrawnEffect&) {
  std::vector<double> values;
  for (const double part : {0.03, 0.08, 0.2, 0.4, 0.8, 2.0}) values.push_back(part * scene.stops.back().time_s);
  return values;
}

bool draw_warm_up(const Drawing& drawing, DrawnEffect& e) {
  Random& random = drawing.random;
  const double duration_s = drawing.scene.stops.back().time_s;
  e.parameters["tau_s"] = rounded(duration_s * between(random, 0.12, 0.45), 1.0);
  e.parameters["c_um"] = chance(random, 0.75) ? drawing.sign : 0.0;
  e.parameters["c_um_per_m"] = 0.0;
  if (e.parameters["c_um"] == 0.0 || chance(random, 0.3)) e.parameters["c_um_per_m"] = sign_of_chance(random) * 1.5;
  return true;
}

/// The component that was measured separately [um or um/m].
double known_value(const Scene& scene, const Stop& at, Component code) {
  for (const KnownCurve& known : scene.known)
    if (known.code == code)
      return between_points(known.p_mm, known.value, at.position_mm[index_of(moving_axis(known.code))]);
  return 0.0;
}

std::vector<double> decays_mm(const Scene&, const Ground&, const DrawnEffect&) {
  return {3.0, 8.0, 20.0, 50.0, 150.0, 500.0, 2000.0};
}

std::vector<double> shifts_mm(const Scene&, const Ground&, const DrawnEffect&) {
  return {-50.0, -20.0, -5.0, 5.0, 20.0, 50.0};
}

}  // namespace

const std::vector<Hiding>& hidings() {
  using Search = const PlaceSearch&;
  using Draw = const Drawing&;
  using Effect = const DrawnEffect&;
  using On = const Scene&;
  using At = const Stop&;
  static const std::vector<Hiding> kAll{
      {.id = "offset",
       .drawn = 2.0,
       .places = on_senses,
       .in_every_base = true,
       .confounded_in = Design::kZero,
       .excluded_from = Design::kZero},
      {.id = "scale",
       .base_probability = 0.6,
       .confounded_in = Design::kWarm | Design::kAir | Design::kWarmAir | Design::kSquare | Design::kCold,
       .excluded_from = Design::kWarm | Design::kAir | Design::kWarmAir | Design::kSquare | Design::kCold},
      {.id = "progressive",
       .draw = draw_curve_without_line,
       .base_probability = 0.35,
       .line = "scale",
       .confounded_in = Design::kOneLever,
       .excluded_from = Design::kOneLever},
      {.id = "cyclic",
       .sizes = {"amplitude_um", "amplitude2_um"},
       .searched = "period_mm",
       .search = periods_mm,
       .needs = {.fine = true},
       .draw = draw_cyclic,
       .units = cyclic_units,
       .base_probability = 0.35},
      {.id = "backlash",
       .drawn = 2.0,
       .own_axis_only = true,
       .needs = {.bidirectional = true},
       .admits = shows_approach,
       .base_probability = 0.4,
       .confounded_in = Design::kOneFeed,
       .excluded_from = Design::kOneFeed},
      {.id = "reversal_curve",
       .own_axis_only = true,
       .needs = {.bidirectional = true},
       .admits = shows_approach,
       .draw = draw_curve_without_line,
       .base_probability = 0.08,
       .line = "backlash",
       .excluded_from = Design::kOneFeed},
      {.id = "step",
       .sizes = {"height_um"},
       .searched = "position_mm",
       .search = between_targets_mm,
       .draw = draw_step,
       .base_probability = 0.05,
       .excluded_from = Design::kOneLever},
      {.id = "sag",
       .needs = {.translations = true},
       .admits = [](Search, Sense sense, Axis axis) { return !is_along(sense, axis); },  // a weight bends across
       .draw =
           [](Draw by, DrawnEffect& e) {
             const bool cubic = chance(by.random, 0.5);
             e.parameters["k2"] = by.sign;
             e.parameters["k3"] = 0.0;
             if (cubic) e.parameters["k3"] = sign_of_chance(by.random) * between(by.random, 0.2, 1.0);
             return true;
           },
       .explains_two = true,
       .base_probability = 0.08,
       .excluded_from = Design::kOneLever},
      {.id = "angular",
       .mean_and_slope = true,
       .needs = {.translations = true, .levers = true, .least_axes = 2},
       .places = rotations,
       .draw =
           [](Draw by, DrawnEffect& e) {
             e.curve = draw_curve(by.random, places_under(by.ground, e));
             e.curve.mean = by.random.normal();
             e.curve.slope = by.random.normal();
             return true;
           },
       .explains_two = true,
       .base_probability = 0.3,
       .confounded_in = Design::kOneLever,
       .excluded_from = kEveryDesign},
      {.id = "squareness",
       .needs = {.translations = true, .squares = true, .least_axes = 2},
       .places = squarenesses,
       .base_probability = 0.5,
       .confounded_in = Design::kSquare,
       .excluded_from = kEveryDesign},
      {.id = "measurement_line",
       .drawn = 300.0,
       .adds = [](Effect e, On scene,
                  At at) { return e.parameter("lever_mm") / kMmPerM * known_value(scene, at, *e.code); },
       .needs = {.known = true, .translations = true},
       .places = lines_of_known,
       .base_probability = 0.3,
       .excluded_from = kEveryDesign},
      {.id = "thermal_scale",
       .needs = {.temperature = true, .along = true, .translations = true, .least_runs = 3},
       .admits = [](Search on, Sense s,
                    Axis a) { return on.scene.sensor("t_material_degC").has_value() && (!on.good || is_along(s, a)); },
       .base_probability = 0.4,
       .confounded_in = Design::kWarm | Design::kWarmAir,
       .excluded_from = kEveryDesign},
      {.id = "thermal_drift",
       .needs = {.temperature = true, .least_runs = 3},
       .places = sensors_of_senses,
       .base_probability = 0.1,
       .excluded_from = kEveryDesign},
      {.id = "warm_up",
       .sizes = {"c_um", "c_um_per_m"},
       .searched = "tau_s",
       .search = time_constants_s,
       .needs = {.time = true, .least_runs = 3},
       .places =
           [](Search search) {
             return search.scene.shown.time ? on_axes_or_parked(search) : std::vector<DrawnEffect>{};
           },
       .draw = draw_warm_up,
       .base_probability = 0.03,
       .excluded_from = kEveryDesign},
      {.id = "time_drift",
       .seat = Seat::instrument,
       .needs = {.time = true, .least_runs = 3},
       .places = [](Search search) { return search.scene.shown.time ? on_senses(search) : std::vector<DrawnEffect>{}; },
       .base_probability = 0.12,
       .excluded_from = kEveryDesign},
      {.id = "air_refraction",
       .seat = Seat::instrument,
       .range = {.above = 0.05, .below = 1.9},
       .adds =
           [](Effect e, On scene, At at) {
             return e.parameter("factor") * scene.p_mm(at, *e.axis) * 1e3 * missing_refraction(scene, at);
           },
       .needs = {.temperature = true, .air = true, .along = true, .translations = true, .least_runs = 3},
       .admits = [](Search on, Sense s, Axis a) { return shows_air(on) && is_along(s, a); },
       .draw =
           [](Draw by, DrawnEffect& e) {
             const bool whole = chance(by.random, 0.7);
             e.parameters["factor"] = whole ? 1.0 : rounded(between(by.random, 0.3, 1.2), 100.0);
             return true;
           },
       .natural_size = true,
       .confounded_in = Design::kAir | Design::kWarmAir},
      {.id = "dead_path",
       .seat = Seat::instrument,
       .range = {.above = 0.02, .below = 9.5},
       .adds = [](Effect e, On scene, At at) { return e.parameter("length_m") * 1e6 * missing_refraction(scene, at); },
       .needs = {.temperature = true, .air = true, .along = true, .translations = true, .least_runs = 3},
       .places =
           [](Search search) {
             auto found = shows_air(search) ? on_senses(search) : std::vector<DrawnEffect>{};
             std::erase_if(found, [](Effect place) { return !is_along(*place.sense, *place.axis); });
             return found;
           },
       .draw =
           [](Draw by, DrawnEffect& e) {
             e.parameters["length_m"] = rounded(log_between(by.random, 0.2, 5.0), 1000.0);
             return true;
           },
       .natural_size = true,
       .confounded_in = Design::kZero},
      {.id = "cosine",
       .seat = Seat::instrument,
       .square = true,
       .drawn = 1.5,
       .adds =
           [](Effect e, On scene, At at) {
             return -scene.p_mm(at, *e.axis) / kMmPerM * e.parameter("angle_mrad") * e.parameter("angle_mrad") / 2.0;
           },
       .needs = {.along = true, .translations = true},
       .admits = [](Search, Sense s, Axis a) { return is_along(s, a); },
       .confounded_in = Design::kWarm | Design::kAir | Design::kWarmAir | Design::kCold},
      {.id = "servo_lag",
       .own_axis_only = true,
       .needs = {.feeds = true, .bidirectional = true, .least_runs = 3},
       .admits = [](Search on, Sense s, Axis a) { return shows_approach(on, s, a) && on.scene.shown.feed; },
       .base_probability = 0.1,
       .confounded_in = Design::kOneFeed,
       .excluded_from = kEveryDesign},
      {.id = "load",
       .needs = {.loads = true, .least_runs = 3},
       .places =
           [](Search search) {
             return search.scene.shown.load ? on_axes_or_parked(search) : std::vector<DrawnEffect>{};
           },
       .draw =
           [](Draw by, DrawnEffect& e) {
             const bool tilts = chance(by.random, 0.5);
             e.parameters["um_per_kg"] = by.sign * 0.01;
             e.parameters["um_per_kg_m"] = tilts ? sign_of_chance(by.random) * 0.01 : 0.0;
             return true;
           },
       .base_probability = 0.15,
       .excluded_from = kEveryDesign},
      {.id = "reversal_spike",
       .sizes = {"c_um"},
       .searched = "u0_mm",
       .search = decays_mm,
       .own_axis_only = true,
       .needs = {.travel = true, .bidirectional = true},
       .admits = [](Search on, Sense s, Axis a) { return shows_approach(on, s, a) && on.scene.shown.travel; },
       .draw =
           [](Draw by, DrawnEffect& e) {
             const auto& places = places_under(by.ground, e);
             const double step_mm = (places.back() - places.front()) / static_cast<double>(places.size() - 1);
             e.parameters["c_um"] = 2.0 * by.sign;
             e.parameters["u0_mm"] = rounded(step_mm * between(by.random, 0.7, 3.0) + 3.0, 100.0);
             return true;
           }},
      {.id = "map_polarity",
       .seat = Seat::unit,
       .unit_value = 1.0,
       .spoil = [](Effect, MapReading& reading) { reading.gain = -reading.gain; },
       .needs = {.map = true, .translations = true},
       .places = in_map,
       .fixed_size = true},
      {.id = "map_gain",
       .seat = Seat::unit,
       .unit_value = 2.0,
       .spoil = [](Effect e, MapReading& reading) { reading.gain *= e.parameter("gain"); },
       .needs = {.map = true, .translations = true},
       .places = in_map,
       .draw =
           [](Draw by, DrawnEffect& e) {
             e.parameters["gain"] = one(by.random, std::vector{0.0, 0.5, 0.8, 1.25, 1.5, 2.0, 10.0});
             return true;
           }},
      {.id = "map_shift",
       .seat = Seat::unit,
       .searched = "shift_mm",
       .search = shifts_mm,
       .spoil = [](Effect e, MapReading& reading) { reading.position_mm += e.parameter("shift_mm"); },
       .needs = {.map = true, .translations = true},
       .places = in_map,
       .draw =
           [](Draw by, DrawnEffect& e) {
             const double sign = sign_of_chance(by.random);
             e.parameters["shift_mm"] = rounded(sign * log_between(by.random, 5.0, 60.0), 10.0);
             return true;
           },
       .fixed_size = true},
      {.id = "map_direction_swap",
       .seat = Seat::unit,
       .spoil = [](Effect, MapReading& reading) { reading.approach = -reading.approach; },
       .needs = {.map = true, .one_axis = true, .bidirectional = true, .translations = true},
       .places =
           [](Search search) {
             const auto& map = search.scene.map;
             const bool two_tables = !map.empty() && map.front().approach != Approach::unknown;
             return two_tables ? in_map(search) : std::vector<DrawnEffect>{};
           },
       .fixed_size = true},
      {.id = "thermal_bend",
       .needs = {.temperature = true, .translations = true, .least_runs = 3},
       .admits = [](Search, Sense s, Axis a) { return !is_rotation(s) && !is_along(s, a); },
       .places = pairs_of_sensors,
       .on_request = true},
      {.id = "set_up_rotation", .needs = {.translations = true, .least_axes = 2}, .places = planes, .on_request = true},
  };
  return kAll;
}

}  // namespace ecs::emulator
