// Cases of each row: drawn, weighed by their own linear algebra, drawn again until a perfect method could answer.
#include <algorithm>
#include <cmath>
#include <optional>

#include "bench/foreign/case.hpp"
#include "bench/foreign/rivals.hpp"

namespace foreign {
namespace {

constexpr int kTries = 4000;
constexpr double kLeastSnr = 1.5;
constexpr double kGreatestSnr = 8.0;
constexpr double kOutsideChi2 = 60.0;     // that the best sum of library effects must leave of an outside structure
constexpr double kOutsideShare = 0.3;     // the same as a share of the structure
constexpr double kOneEffectShare = 0.15;  // that the best single effect must leave
constexpr int kOutsideEffects = 3;        // in that sum
constexpr std::size_t kLeastReadings = 30;

const std::vector<std::string>& single_ids() {
  static const std::vector<std::string> ids = {"offset",
                                               "scale",
                                               "progressive",
                                               "cyclic",
                                               "backlash",
                                               "reversal_curve",
                                               "step",
                                               "sag",
                                               "angular",
                                               "squareness",
                                               "measurement_line",
                                               "thermal_scale",
                                               "thermal_drift",
                                               "warm_up",
                                               "thermal_bend",
                                               "set_up_rotation",
                                               "time_drift",
                                               "air_refraction",
                                               "dead_path",
                                               "cosine",
                                               "servo_lag",
                                               "load",
                                               "reversal_spike"};
  return ids;
}

// Effects that most sets can tell from all others.
const std::vector<std::string>& pair_ids() {
  static const std::vector<std::string> ids = {
      "scale",         "progressive", "cyclic",       "backlash",         "reversal_curve",
      "step",          "sag",         "angular",      "measurement_line", "thermal_scale",
      "thermal_drift", "warm_up",     "thermal_bend", "time_drift",       "air_refraction",
      "dead_path",     "servo_lag",   "load",         "reversal_spike"};
  return ids;
}

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

double span_mm(const Setup& setup, char axis) {
  double low = 1e300;
  double high = -1e300;
  for (const Reading& reading : setup.readings) {
    low = std::min(low, reading.at_mm[index_of(axis)]);
    high = std::max(high, reading.at_mm[index_of(axis)]);
  }
  return high - low;
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
    const double shortest = 2.2 * 1000.0 * span_m / 60.0;
    term.nonlinear = random.between_log(std::min(shortest, 300.0 * span_m), 350.0 * span_m);
    if (axis.screw_pitch_mm && random.chance(0.6)) term.nonlinear = *axis.screw_pitch_mm;
  } else if (term.id == "sag") {
    term.coefficients = {random.normal() / span_m, random.normal() / span_m / span_m};
  } else if (term.id == "warm_up") {
    const double session = setup.readings.back().time_s;
    term.nonlinear = random.between_log(session / 15.0, session / 2.0);
    term.coefficients = {random.normal(), random.normal() / span_m};
  } else if (term.id == "load") {
    term.coefficients = {random.normal(), random.normal() / span_m};
  } else if (term.id == "cosine") {
    term.coefficients = {1.0};
  } else if (term.id == "map_gain") {
    term.coefficients = {random.sign() * random.between(0.08, 0.5)};
  } else if (term.id == "map_shift") {
    term.nonlinear = std::round(10.0 * random.sign() * random.between(3.0, 40.0)) / 10.0;
    term.coefficients = {1.0};
  } else if (term.id.starts_with("map_") || term.id == "air_refraction") {
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

const Noise& unit_noise() {
  static const Noise noise{"white", 1.0, 0.0, 0.0};
  return noise;
}

// What the base model cannot take of it, rms [um].
double free_rms(const Setup& setup, const std::vector<Term>& base, const Column& um) {
  return rms(Projector(setup, unit_noise(), base).rest_of(um));
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

bool among(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

// A base term whose part beyond the others is worth having.
void add_base(Random& random, Case& drawn, const std::string& id, char axis, const std::string& sense, double size) {
  Term term;
  term.id = id;
  term.axis = axis;
  term.sense = sense;
  draw_shape(random, drawn.setup, term);
  if (term.id == "thermal_drift") return;
  const Column before = contribution(drawn.setup, term);
  if (free_rms(drawn.setup, drawn.base, before) < 0.05 * rms(before) || !(rms(before) > 0.0)) return;
  scale_size(term, size / rms(before));
  term.given = (id == "scale" || id == "backlash") && random.chance(0.2);
  if (term.given)
    for (double& coefficient : term.coefficients) coefficient = std::round(coefficient * 100.0) / 100.0;
  drawn.base.push_back(term);
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
  const double before = free_rms(drawn.setup, drawn.base, contribution(drawn.setup, *term));
  if (!(before > 0.0)) return false;
  scale_size(*term, drawn.noise.sigma_um * random.between(3.0, 15.0) / before);
  if (!Projector(drawn.setup, drawn.noise, drawn.base).parameters_of(*term)) return false;
  const Rivals rivals =
      rivals_of(Projector(drawn.setup, drawn.noise, drawn.base), *term, contribution(drawn.setup, *term));
  if (!rivals.clear || !rivals.required.empty() || !rivals.simplest) return false;
  drawn.base.push_back(*term);
  return true;
}

// Brings the hidden effect (or the noise, where the effect has no free size) to a drawn ratio.
bool set_size(Random& random, Case& drawn, Term& term) {
  const double snr = random.between(kLeastSnr, kGreatestSnr);
  const Column um = contribution(drawn.setup, term);
  const double now = free_rms(drawn.setup, drawn.base, um);
  if (!(now > 1e-3 * rms(um)) || !(now > 0.0)) return false;
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

void finish_readings(Random& random, Case& drawn) {
  const Setup& setup = drawn.setup;
  drawn.readings_um = draw_noise_um(random, setup, drawn.noise);
  add_scaled(drawn.readings_um, drawn.hidden_um, 1.0);
  for (const Term& term : drawn.base) add_scaled(drawn.readings_um, contribution(setup, term), 1.0);
  const double step = drawn.noise.law == "rounded" ? drawn.noise.step_um : 1e-4;
  for (double& value : drawn.readings_um) value = std::round(value / step) * step;
}

// An informed least-squares check: is every hidden effect the best beside the others, and how sure is it?
void ask_oracle(Case& drawn) {
  Column um = drawn.readings_um;
  for (const Term& term : drawn.base) add_scaled(um, contribution(drawn.setup, term), -1.0);
  drawn.oracle_p = 0.0;
  for (std::size_t k = 0; k < drawn.hidden.size(); ++k) {
    std::vector<Term> known = drawn.base;
    Column others = um;
    for (std::size_t j = 0; j < drawn.hidden.size(); ++j) {
      if (j == k) continue;
      known.push_back(drawn.hidden[j]);
      add_scaled(others, contribution(drawn.setup, drawn.hidden[j]), -1.0);
    }
    const Projector projector(drawn.setup, drawn.noise, known);
    const Column rest = projector.rest_of(others);
    const std::vector<Reproduction> ranked = projector.ranked(rest);
    const std::string best = name_of(ranked.front().term);
    const bool right = best == name_of(drawn.hidden[k]) || among(drawn.required, best) || among(drawn.allowed, best);
    drawn.oracle_right = drawn.oracle_right && right;
    const Reproduction own = projector.of(drawn.hidden[k], rest);
    const double p = chi2_exceeds(dot(rest, rest) - own.excess, std::max(1, own.parameters));
    drawn.oracle_p = std::max(drawn.oracle_p, p);
  }
}

void start(Random& random, Case& drawn, const Wishes& wishes) {
  drawn.setup = draw_setup(random, wishes);
  drawn.noise = draw_noise(random);
}

// The columns of `term` count as known beside the base.
std::vector<Term> with(std::vector<Term> base, const Term& term) {
  base.push_back(term);
  return base;
}

const std::string& pick_free(Random& random, Wishes& wishes) {
  static const std::vector<std::string> ids = {"cyclic", "progressive", "warm_up", "reversal_spike"};
  const std::string& id = random.pick(ids);
  wish_for(random, id, wishes);
  return id;
}

bool try_single(Random& random, Case& drawn, bool free_base) {
  Wishes wishes;
  const std::string id = random.pick(single_ids());
  wish_for(random, id, wishes);
  const std::string free_id = free_base ? pick_free(random, wishes) : "";
  if (free_base && (free_id == id ? id != "cyclic" : false)) return false;
  // Same seed of chance, many sets: the id stays what was drawn, so that no effect is rarer than the others.
  for (int attempt = 0; attempt < 60; ++attempt) {
    Case now = drawn;
    start(random, now, wishes);
    if (now.setup.readings.size() < kLeastReadings) continue;
    std::vector<std::string> without = {id};
    if (id == "cosine" || id == "squareness" || id == "set_up_rotation") without.push_back("scale");
    draw_base(random, now, without);
    if (free_base && !add_free_base(random, now, free_id)) continue;
    std::optional<Term> term = draw_term(random, now.setup, id);
    if (!term || !set_size(random, now, *term)) continue;
    if (free_base && free_id == id && std::abs(std::log(term->nonlinear / now.base.back().nonlinear)) < 0.3) continue;
    now.hidden_um = contribution(now.setup, *term);
    const Rivals rivals = rivals_of(Projector(now.setup, now.noise, now.base), *term, now.hidden_um);
    if (!rivals.clear || !rivals.simplest) continue;
    now.hidden = {*term};
    now.required = rivals.required;
    now.allowed = rivals.allowed;
    now.snr = {free_rms(now.setup, now.base, now.hidden_um) / now.noise.sigma_um};
    drawn = now;
    return true;
  }
  return false;
}

bool try_pair(Random& random, Case& drawn, bool free_base) {
  Wishes wishes;
  const std::string first = random.pick(pair_ids());
  const std::string second = random.pick(pair_ids());
  if (first == second) return false;
  wish_for(random, first, wishes);
  wish_for(random, second, wishes);
  const std::string free_id = free_base ? pick_free(random, wishes) : "";
  if (free_id == first || free_id == second || (wishes.along && wishes.across)) return false;
  for (int attempt = 0; attempt < 40; ++attempt) {
    Case now = drawn;
    start(random, now, wishes);
    if (now.setup.readings.size() < kLeastReadings) continue;
    draw_base(random, now, {first, second});
    if (free_base && !add_free_base(random, now, free_id)) continue;
    now.hidden_um.assign(now.setup.readings.size(), 0.0);
    for (const std::string& id : {first, second}) {
      std::optional<Term> term = draw_term(random, now.setup, id);
      if (!term || !set_size(random, now, *term)) break;
      add_scaled(now.hidden_um, contribution(now.setup, *term), 1.0);
      now.snr.push_back(free_rms(now.setup, now.base, contribution(now.setup, *term)) / now.noise.sigma_um);
      now.hidden.push_back(*term);
    }
    if (now.hidden.size() != 2) continue;
    bool clear = true;
    for (std::size_t k = 0; k < 2 && clear; ++k) {
      const Projector projector(now.setup, now.noise, with(now.base, now.hidden[1 - k]));
      const Column own = contribution(now.setup, now.hidden[k]);
      clear = free_rms(now.setup, with(now.base, now.hidden[1 - k]), own) > 0.5 * now.snr[k] * now.noise.sigma_um;
      if (!clear) break;
      const Rivals rivals = rivals_of(projector, now.hidden[k], own);
      clear = rivals.clear && rivals.simplest && rivals.required.empty();
    }
    if (!clear) continue;
    const Projector alone(now.setup, now.noise, now.base);
    const Column rest = alone.rest_of(now.hidden_um);
    const int own = alone.parameters_of(now.hidden[0]) + alone.parameters_of(now.hidden[1]);
    const Reproduction best = alone.ranked(rest).front();
    if (best.excess + (best.parameters - own) * std::log(static_cast<double>(rest.size())) < kClearMargin) continue;
    drawn = now;
    return true;
  }
  return false;
}

bool try_confounded(Random& random, Case& drawn) {
  using Ids = std::vector<std::string>;
  Wishes wishes;
  std::string id;
  std::vector<std::string> without = {"scale"};
  bool scale_in_base = false;
  switch (random.whole(0, 8)) {
    case 0:
      wishes.one_temperature = wishes.along = true;
      id = random.pick(Ids{"scale", "cosine", "thermal_scale"});
      break;
    case 1:
      wishes.one_weather = wishes.along = true;
      id = random.pick(Ids{"scale", "cosine", "air_refraction"});
      break;
    case 2:
      wishes.one_feed = wishes.along = wishes.both_approaches = true;
      id = random.pick(Ids{"backlash", "servo_lag"});
      without = {"backlash"};
      break;
    case 3:
      id = "squareness";
      wish_for(random, id, wishes);
      break;
    case 4:
      wishes.ramp = wishes.runs = true;
      wishes.sensors = 1;
      id = random.pick(Ids{"time_drift", "thermal_drift"});
      without = {"time_drift"};
      break;
    case 5:
      wishes.similar_air = wishes.material = wishes.along = wishes.runs = scale_in_base = true;
      id = random.pick(Ids{"air_refraction", "dead_path", "thermal_drift"});
      without = {"thermal_scale"};
      break;
    case 6:
      wishes.one_load = wishes.along = true;
      id = random.pick(Ids{"scale", "load"});
      break;
    case 7:
      wishes.one_temperature = wishes.one_weather = wishes.one_load = wishes.along = true;
      id = random.pick(Ids{"scale", "cosine", "thermal_scale", "air_refraction", "load"});
      break;
    default:
      wishes.one_feed = wishes.one_load = wishes.one_temperature = wishes.along = wishes.both_approaches = true;
      id = random.pick(Ids{"backlash", "servo_lag"});
      without = {"backlash", "thermal_scale"};
      break;
  }
  start(random, drawn, wishes);
  if (drawn.setup.readings.size() < kLeastReadings) return false;
  without.push_back(id);
  if (wishes.one_temperature) without.push_back("thermal_scale");
  draw_base(random, drawn, without);
  const bool has_scale = std::any_of(drawn.base.begin(), drawn.base.end(),
                                     [](const Term& term) { return term.id == "scale" && !term.given; });
  if (scale_in_base && !has_scale) return false;
  std::optional<Term> term = draw_term(random, drawn.setup, id);
  if (!term || !set_size(random, drawn, *term)) return false;
  drawn.hidden_um = contribution(drawn.setup, *term);
  const Rivals rivals = rivals_of(Projector(drawn.setup, drawn.noise, drawn.base), *term, drawn.hidden_um);
  if (!rivals.clear || rivals.required.empty()) return false;
  drawn.hidden = {*term};
  drawn.required = rivals.required;
  drawn.allowed = rivals.allowed;
  drawn.snr = {free_rms(drawn.setup, drawn.base, drawn.hidden_um) / drawn.noise.sigma_um};
  return true;
}

// Whether the library comes near the structure: one effect, or a few of them that are no waves (physics.md 5: anything
// can be written as enough waves).
bool library_explains(const Case& drawn, int effects, double share) {
  std::vector<Term> known = drawn.base;
  double least = 0.0;
  for (int k = 0; k < effects; ++k) {
    const Projector projector(drawn.setup, drawn.noise, known);
    const Column rest = projector.rest_of(drawn.hidden_um);
    if (k == 0) {
      const double noise = kOutsideChi2 + 3.0 * std::sqrt(2.0 * static_cast<double>(rest.size()));
      least = std::max(share * dot(rest, rest), noise);
    }
    std::vector<Reproduction> ranked = projector.ranked(rest);
    if (k == 0 && ranked.front().excess < std::min(least, kOneEffectShare * dot(rest, rest))) return true;
    std::erase_if(ranked, [](const Reproduction& found) { return found.term.id == "cyclic"; });
    if (ranked.empty()) return false;
    Reproduction best = ranked.front();
    if (best.excess < least) return true;
    best.term.coefficients.assign(columns_of(drawn.setup, best.term).size(), 1.0);
    known.push_back(best.term);
  }
  return false;
}

bool try_structure(Random& random, Case& drawn, bool bad_run) {
  Wishes wishes;
  wishes.runs = true;
  wishes.both_approaches = !bad_run && random.chance(0.7);
  start(random, drawn, wishes);
  if (drawn.setup.readings.size() < kLeastReadings || drawn.setup.layout != "line") return false;
  draw_base(random, drawn, {});
  const int kind = static_cast<int>(drawn.seed % static_cast<std::uint64_t>(outside_kinds()));
  Structure structure = bad_run ? draw_bad_run(random, drawn.setup) : draw_outside(random, drawn.setup, kind);
  const double now = free_rms(drawn.setup, drawn.base, structure.um);
  if (!(now > 1e-3 * rms(structure.um))) return false;
  double snr = random.between(2.0, kGreatestSnr);
  if (structure.kind == "one run noisy") snr = random.between(4.0, 8.0) * rms(structure.um);
  drawn.hidden_um = structure.um;
  for (double& value : drawn.hidden_um) value *= snr * drawn.noise.sigma_um / now;
  drawn.structure = structure.kind;
  drawn.snr = {snr};
  if (structure.kind == "one run noisy") return true;
  return bad_run ? !library_explains(drawn, 1, 0.1) : !library_explains(drawn, kOutsideEffects, kOutsideShare);
}

bool try_blank(Random& random, Case& drawn, bool free_base) {
  Wishes wishes;
  const std::string free_id = free_base ? pick_free(random, wishes) : "";
  start(random, drawn, wishes);
  if (drawn.setup.readings.size() < kLeastReadings) return false;
  draw_base(random, drawn, {});
  if (free_base && !add_free_base(random, drawn, free_id)) return false;
  drawn.hidden_um.assign(drawn.setup.readings.size(), 0.0);
  return true;
}

bool try_map(Random& random, Case& drawn) {
  const std::string id =
      random.pick(std::vector<std::string>{"map_polarity", "map_gain", "map_shift", "map_direction_swap"});
  Wishes wishes;
  wish_for(random, id, wishes);
  start(random, drawn, wishes);
  if (drawn.setup.readings.size() < kLeastReadings) return false;
  draw_base(random, drawn, {});
  std::optional<Term> term = draw_term(random, drawn.setup, id);
  if (!term || !set_size(random, drawn, *term)) return false;
  drawn.hidden_um = contribution(drawn.setup, *term);
  const Rivals rivals = rivals_of(Projector(drawn.setup, drawn.noise, drawn.base), *term, drawn.hidden_um);
  if (!rivals.clear) return false;
  drawn.hidden = {*term};
  drawn.required = rivals.required;
  drawn.allowed = rivals.allowed;
  drawn.snr = {free_rms(drawn.setup, drawn.base, drawn.hidden_um) / drawn.noise.sigma_um};
  return true;
}

bool try_row(Random& random, Case& drawn) {
  if (drawn.row == "single") return try_single(random, drawn, false);
  if (drawn.row == "single_free_base") return try_single(random, drawn, true);
  if (drawn.row == "pair") return try_pair(random, drawn, false);
  if (drawn.row == "pair_free_base") return try_pair(random, drawn, true);
  if (drawn.row == "confounded") return try_confounded(random, drawn);
  if (drawn.row == "outside") return try_structure(random, drawn, false);
  if (drawn.row == "bad_run") return try_structure(random, drawn, true);
  if (drawn.row == "blank") return try_blank(random, drawn, drawn.seed % 4 == 0);
  return try_map(random, drawn);
}

}  // namespace

const std::vector<std::string>& row_names() {
  static const std::vector<std::string> names = {"single",  "single_free_base", "pair",  "pair_free_base", "confounded",
                                                 "outside", "bad_run",          "blank", "map_faults"};
  return names;
}

std::map<std::string, double> parameter_sigmas(const Case& drawn, std::size_t index) {
  const Term& term = drawn.hidden[index];
  std::vector<Column> jacobian;
  const auto add = [&](const Term& other) {
    for (const Column& column : columns_of(drawn.setup, other))
      jacobian.push_back(whitened(drawn.setup, drawn.noise, column));
    if (has_nonlinear(other.id) && other.id != "step")
      jacobian.push_back(whitened(drawn.setup, drawn.noise, nonlinear_derivative(drawn.setup, other)));
  };
  add(term);
  const std::size_t own = jacobian.size();
  for (const Term& other : drawn.base)
    if (!other.given) add(other);
  for (std::size_t k = 0; k < drawn.hidden.size(); ++k)
    if (k != index) add(drawn.hidden[k]);
  const std::vector<Column> covariance = inverse_normal(jacobian);
  // Gradient of each named parameter, by differences in the coefficients and the nonlinear parameter.
  std::map<std::string, double> sigmas;
  for (const auto& [name, value] : parameters_of(drawn.setup, term)) {
    if (term.id == "step" && name == "position_mm") continue;
    Column gradient(own, 0.0);
    for (std::size_t k = 0; k < own; ++k) {
      Term moved = term;
      double& at = k < term.coefficients.size() ? moved.coefficients[k] : moved.nonlinear;
      const double step = 1e-6 * std::max(1e-6, std::abs(at));
      at += step;
      gradient[k] = (parameters_of(drawn.setup, moved).at(name) - value) / step;
    }
    double variance = 0.0;
    for (std::size_t i = 0; i < own; ++i)
      for (std::size_t j = 0; j < own; ++j) variance += gradient[i] * covariance[i][j] * gradient[j];
    sigmas[name] = std::sqrt(std::max(0.0, variance));
  }
  return sigmas;
}

Case draw_case(const std::string& row, std::uint64_t seed) {
  const auto at = std::find(row_names().begin(), row_names().end(), row) - row_names().begin();
  Random random(seed * 1000003U + static_cast<std::uint64_t>(at) * 7919U);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    Case drawn;
    drawn.row = row;
    drawn.seed = seed;
    if (!try_row(random, drawn)) continue;
    finish_readings(random, drawn);
    if (!drawn.hidden.empty()) ask_oracle(drawn);
    return drawn;
  }
  return {};
}

}  // namespace foreign
