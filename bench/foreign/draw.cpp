// The rows: cases drawn, weighed by their own linear algebra, drawn again until a perfect method could answer.
#include <algorithm>
#include <cmath>
#include <optional>

#include "bench/foreign/case.hpp"
#include "bench/foreign/rivals.hpp"
#include "bench/foreign/terms.hpp"

namespace foreign {
namespace {

constexpr double kLeastOutsideSnr = 2.0;
constexpr int kTries = 4000;
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

void finish_readings(Random& random, Case& drawn) {
  const Setup& setup = drawn.setup;
  drawn.readings_um = draw_noise_um(random, setup, drawn.noise);
  add_scaled(drawn.readings_um, drawn.hidden_um, 1.0);
  for (const Term& term : drawn.base) add_scaled(drawn.readings_um, contribution(setup, term), 1.0);
  const double step = drawn.noise.law == "rounded" ? drawn.noise.step_um : 1e-4;
  for (double& value : drawn.readings_um) value = std::round(value / step) * step;
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
  if (free_id == id && id != "cyclic") return false;
  // The effect stays what was drawn, so that hard ones are not rarer than the others.
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
    if (free_base) {
      Column um = now.hidden_um;
      add_scaled(um, contribution(now.setup, now.base.back()), 1.0);
      if (!clear_of_free_base(now.setup, now.noise, now.base, *term, rivals, um)) continue;
    }
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
      now.allowed.insert(now.allowed.end(), rivals.allowed.begin(), rivals.allowed.end());
      if (!clear || !free_base) continue;
      std::vector<Term> beside = {now.hidden[1 - k]};
      beside.insert(beside.end(), now.base.begin(), now.base.end());
      Column um = own;
      add_scaled(um, contribution(now.setup, now.base.back()), 1.0);
      clear = clear_of_free_base(now.setup, now.noise, beside, now.hidden[k], rivals, um);
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
  switch (drawn.seed % 9) {  // so that kinds which are seldom clear are not rare
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
  double total = 0.0;
  double noise = 0.0;
  for (int k = 0; k < effects; ++k) {
    const Projector projector(drawn.setup, drawn.noise, known);
    const Column rest = projector.rest_of(drawn.hidden_um);
    if (k == 0) {
      total = dot(rest, rest);
      noise = kOutsideChi2 + 3.0 * std::sqrt(2.0 * static_cast<double>(rest.size()));
    }
    const std::vector<Reproduction> ranked = projector.ranked(rest, false);
    if (ranked.empty()) break;
    Reproduction best = ranked.front();
    if (best.excess < std::max(noise, share * total)) return true;
    best.term.coefficients.assign(columns_of(drawn.setup, best.term).size(), 1.0);
    known.push_back(best.term);
  }
  const Projector projector(drawn.setup, drawn.noise, drawn.base);
  const Reproduction best = projector.ranked(projector.rest_of(drawn.hidden_um)).front();
  return best.excess < std::max(noise, kOneEffectShare * total);
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
  double snr = random.between(kLeastOutsideSnr, kGreatestSnr);
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
