// Terms of a case: what a set must have for an effect, its shape, its size, and the base model around it.
#include "bench/foreign/terms.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/foreign/rivals.hpp"

namespace foreign {
namespace {

constexpr double kLeastFreeShare = 0.02;  // of a hidden effect, that the base model cannot take

bool among(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

double span_mm(const Setup& setup, char axis) {
  const auto [low, high] = span_of(setup, axis);
  return high - low;
}

// A little more than two targets a period on even targets; one on moved ones.
double shortest_period_mm(const Setup& setup, char axis) {
  std::set<double> targets;
  for (const Reading& reading : setup.readings) targets.insert(reading.at_mm[index_of(axis)]);
  const double step = span_mm(setup, axis) / static_cast<double>(targets.size() - 1);
  return std::min(0.3 * span_mm(setup, axis), (setup.moved_targets ? 1.1 : 2.2) * step);
}

// The shape of a term: everything but its size.
void draw_shape(Random& random, const Setup& setup, Term& term) {
  const double span_m = std::max(1e-3, span_mm(setup, term.axis) / 1000.0);
  const auto curve = [&](int columns) {
    for (int k = 0; k < columns; ++k) term.coefficients.push_back(random.normal() / (1.0 + 0.6 * k));
  };
  const std::vector<double> grid = nonlinear_grid(setup, term);
  if (term.id == "progressive" || term.id == "reversal_curve") {
    curve(kCurveColumns);
  } else if (term.id == "angular") {
    curve(kCurveColumns + 2);
    for (std::size_t k = 7; k < term.coefficients.size(); ++k) term.coefficients[k] = 0.0;
  } else if (term.id == "cyclic") {
    const double phase = random.between(-3.1, 3.1);
    const double second = random.chance(0.4) ? random.between(0.15, 0.5) : 0.0;
    const double phase2 = random.between(-3.1, 3.1);
    term.coefficients = {std::cos(phase), std::sin(phase), second * std::cos(phase2), second * std::sin(phase2)};
    const AxisFacts& axis = setup.machine.axes[index_of(term.axis)];
    term.nonlinear = random.between_log(shortest_period_mm(setup, term.axis), 350.0 * span_m);
    if (axis.screw_pitch_mm && random.chance(0.6)) term.nonlinear = *axis.screw_pitch_mm;
  } else if (term.id == "sag") {
    term.coefficients = {random.normal() / span_m, random.normal() / span_m / span_m};
  } else if (term.id == "warm_up") {
    const double session = setup.readings.back().time_s;
    term.nonlinear = random.between_log(session / 15.0, session / 2.0);
    term.coefficients = {random.normal(), random.normal() / span_m};
  } else if (term.id == "load") {
    term.coefficients = {random.normal(), random.normal() / span_m};
  } else if (term.id == "map_gain") {
    term.coefficients = {random.signed_between(0.08, 0.5)};
  } else if (term.id == "map_shift") {
    term.nonlinear = std::round(10.0 * random.signed_between(3.0, 40.0)) / 10.0;
    term.coefficients = {1.0};
  } else if (term.id.starts_with("map_") || term.id == "air_refraction" || term.id == "cosine") {
    term.coefficients = {1.0};
  } else {
    term.coefficients = {random.sign()};
  }
  if (term.id == "step" && !grid.empty()) term.nonlinear = random.pick(grid);
  if (term.id == "reversal_spike" && !grid.empty())
    term.nonlinear = random.between_log(2.0 * grid.front(), 0.6 * grid.back());
}

bool fits_the_user(const Setup& setup, const Term& term) {
  const bool along = !term.sense.empty() && term.sense[1] == term.axis;
  if (term.id == "scale") return along;
  if (term.id == "sag") return !along;
  if (term.id == "angular")
    return std::any_of(setup.readings.begin(), setup.readings.end(),
                       [&](const Reading& reading) { return reading.axis == term.axis; });
  if (term.id == "offset") return setup.layout == "line";
  if (term.id == "set_up_rotation") {  // in the plane that was measured
    const char normal = static_cast<char>('X' + (term.code[1] - 'A'));
    return std::none_of(setup.readings.begin(), setup.readings.end(),
                        [&](const Reading& reading) { return reading.axis == normal || reading.sense[1] == normal; });
  }
  if (term.id == "squareness") {
    const Reading& first = setup.readings.front();
    return setup.layout == "plane" || (first.axis == term.code[2] && first.sense == (term.code == "A0Z" ? "EY" : "EX"));
  }
  return may_be_candidate(setup, term);
}

const Noise& unit_noise() {
  static const Noise noise{"white", 1.0, 0.0, 0.0};
  return noise;
}

void scale_size(Term& term, double factor) {
  for (double& coefficient : term.coefficients) coefficient *= factor;
}

bool inside_physics(const Term& term) {
  if (term.id == "air_refraction") return term.coefficients[0] > 0.15 && term.coefficients[0] < 1.7;
  if (term.id == "dead_path") return std::abs(term.coefficients[0]) < 9.0;
  if (term.id == "cosine") return term.coefficients[0] > 0.0 && term.coefficients[0] < 400.0;
  return true;
}

// A base term whose part beyond the others is worth having.
void add_base(Random& random, Case& drawn, const std::string& id, char axis, const std::string& sense, double size) {
  Term term;
  term.id = id;
  term.axis = axis;
  term.sense = sense;
  draw_shape(random, drawn.setup, term);
  const Column before = contribution(drawn.setup, term);
  if (free_rms(drawn.setup, drawn.base, before) < 0.05 * rms(before) || !(rms(before) > 0.0)) return;
  scale_size(term, size / rms(before));
  term.given = (id == "scale" || id == "backlash") && random.chance(0.2);
  if (term.given)
    for (double& coefficient : term.coefficients) coefficient = std::round(coefficient * 100.0) / 100.0;
  drawn.base.push_back(term);
}

}  // namespace

void wish_for(Random& random, const std::string& id, Wishes& wishes) {
  const auto one_of = [&](std::initializer_list<const char*> ids) {
    return std::any_of(ids.begin(), ids.end(), [&](const char* other) { return id == other; });
  };
  if (one_of({"scale", "thermal_scale", "air_refraction", "dead_path", "cosine", "servo_lag"})) wishes.along = true;
  if (one_of({"sag", "thermal_bend"})) wishes.across = true;
  if (one_of({"backlash", "reversal_curve", "servo_lag", "reversal_spike"})) wishes.both_approaches = true;
  if (one_of({"thermal_scale", "thermal_drift", "warm_up", "time_drift", "thermal_bend"})) wishes.runs = true;
  if (id == "reversal_spike") wishes.travel = true;
  if (id == "servo_lag") wishes.feeds = true;
  if (id == "load") wishes.loads = true;
  if (id == "thermal_scale") wishes.material = true;
  if (id == "thermal_drift") wishes.sensors = std::max(wishes.sensors, 1);
  if (id == "thermal_bend") wishes.sensors = std::max(wishes.sensors, 2);
  if (one_of({"air_refraction", "dead_path"})) wishes.air = true;
  if (id == "angular") wishes.levers = true;
  if (id == "set_up_rotation") wishes.plane = true;
  if (id == "measurement_line") wishes.known = true;
  if (id == "squareness") wishes.square = random.pick(std::vector<std::string>{"C0Y", "B0Z", "A0Z"});
  if (id.starts_with("map_")) wishes.map = wishes.along = true;
  if (id == "map_direction_swap") wishes.both_approaches = true;
}

std::optional<Term> draw_term(Random& random, const Setup& setup, const std::string& id) {
  std::vector<Term> places;
  for (const Term& term : library_of(setup))
    if (term.id == id && fits_the_user(setup, term) && !nonlinear_grid(setup, term).empty()) places.push_back(term);
  if (places.empty()) return std::nullopt;
  Term term = random.pick(places);
  if (id == "cyclic" && random.chance(0.5)) term.approach = 0;
  draw_shape(random, setup, term);
  return term;
}

// What the base model cannot take of it, rms [um].
double free_rms(const Setup& setup, const std::vector<Term>& base, const Column& um) {
  return rms(Projector(setup, unit_noise(), base).rest_of(um));
}

void draw_base(Random& random, Case& drawn, const std::vector<std::string>& without) {
  const Setup& setup = drawn.setup;
  const auto size = [&] { return random.between(1.0, 15.0); };
  const auto wanted = [&](const char* id, double probability) {
    const bool take = random.chance(probability);
    return take && !among(without, id);
  };
  std::vector<std::pair<char, std::string>> places;
  for (const Reading& reading : setup.readings) {
    const std::pair<char, std::string> place(setup.layout == "plane" ? reading.sense[1] : reading.axis, reading.sense);
    if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
  }
  const bool both = std::any_of(setup.readings.begin(), setup.readings.end(),
                                [](const Reading& reading) { return reading.approach < 0; });
  for (const auto& [axis, sense] : places) {
    if (!among(without, "offset")) add_base(random, drawn, "offset", axis, sense, size());
    if (wanted("scale", 0.75)) add_base(random, drawn, "scale", axis, sense, size());
    if (both && wanted("backlash", 0.45)) add_base(random, drawn, "backlash", axis, sense, 0.4 * size());
    if (wanted("time_drift", 0.1)) add_base(random, drawn, "time_drift", axis, sense, 0.4 * size());
    if (wanted("sag", 0.12)) add_base(random, drawn, "sag", axis, sense, size());
    if (!setup.map.empty()) continue;
    const bool material = among(setup.sensors, "t_material_degC") && sense[1] == axis;
    if (material && wanted("thermal_scale", 0.15)) add_base(random, drawn, "thermal_scale", axis, sense, 0.4 * size());
  }
}

// A free nonlinear term that is truly there.
bool add_free_base(Random& random, Case& drawn, const std::string& id) {
  std::optional<Term> term = draw_term(random, drawn.setup, id);
  if (!term) return false;
  term->approach = 0;
  const Column um = contribution(drawn.setup, *term);
  const double before = free_rms(drawn.setup, drawn.base, um);
  if (!(before > kLeastFreeShare * rms(um))) return false;  // a wave that these targets do not see, for one
  scale_size(*term, drawn.noise.sigma_um * random.between(3.0, 15.0) / before);
  if (!Projector(drawn.setup, drawn.noise, drawn.base).parameters_of(*term)) return false;
  const Rivals rivals =
      rivals_of(Projector(drawn.setup, drawn.noise, drawn.base), *term, contribution(drawn.setup, *term));
  if (!rivals.clear || !rivals.required.empty() || !rivals.simplest) return false;
  drawn.base.push_back(*term);
  drawn.free_base = id;
  return true;
}

// Brings the hidden effect (or the noise, where the effect has no free size) to a drawn ratio.
bool set_size(Random& random, Case& drawn, Term& term) {
  const double snr = random.between(kLeastSnr, kGreatestSnr);
  const Column um = contribution(drawn.setup, term);
  const double now = free_rms(drawn.setup, drawn.base, um);
  if (!(now > kLeastFreeShare * rms(um)) || !(now > 0.0)) return false;
  if (has_fixed_size(term.id)) {
    const double factor = now / snr / drawn.noise.sigma_um;
    drawn.noise.sigma_um *= factor;
    drawn.noise.step_um *= factor;
    if (drawn.noise.sigma_um < 0.05 || drawn.noise.sigma_um > 8.0) return false;
  } else {
    scale_size(term, snr * drawn.noise.sigma_um / now);
  }
  return inside_physics(term);
}

}  // namespace foreign
