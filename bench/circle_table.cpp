// Circular tests of emulated machines that hide one fault, and the share of them whose first cause is right.
//   circle_table --seeds A..B [--snr 3] [--step 1] [--runs 2] [--second] [--blank] [--show] [--model
//   [--lines|--follow|--together]]
// Each seed draws a machine, a plane, a circle and a fault. The machine is contoured without noise by `contour_circle`;
// its deviations then get noise so that the rms of the fault's part is --snr times that of the noise. --second adds
// another fault of a quarter of the size. Faults come from the effects and drives of the emulator, which share no code
// with modules/standards. --model diagnoses by the library of the error model (`ecs model diagnose`) instead, with the
// same names; --lines gives it a line along each axis of the plane as well, of a machine that has lost motion on the
// first; seeds whose fault such a line would show as well are passed over. --follow runs the first circle that `ecs
// model next` proposes on the same machine with the same noise, and diagnoses both together; only seeds are counted
// whose first circle leaves the cause in a group and has such a proposal. --together hides lost motion and friction of
// the same axis in every seed; right is a first cause that is one of them.
#include <cmath>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/workshop/procedures.hpp"
#include "ecs_emulator/workshop/serve.hpp"
#include "laser/standards/circle.hpp"
#include "model/data/path.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/model_file.hpp"
#include "model/planning/next_measurement.hpp"
#include "model/regression/candidates.hpp"
#include "modules/standards/circle_diagnosis.hpp"
#include "params/machine.hpp"

using namespace ecs;
using namespace ecs::emulator;

namespace {

const std::vector<std::string> kFaults{"backlash", "reversal_spike", "friction", "squareness",
                                       "scale",    "servo_mismatch", "cyclic",   "straightness"};
constexpr double kPitch_mm[] = {10.0, 12.0, 16.0};

/// One hidden case, drawn from its seed.
struct HiddenCircle {
  std::string machine, errors;  ///< TOML
  CirclePlan plan;
  std::string cause;  ///< name that the diagnosis should give
  std::string fault;  ///< as hidden: friction makes reversal spikes too
  std::string axis;   ///< of which it is; one circle does not tell of which a scale or a lag is, two do
};

std::size_t one_of(Random& random, std::size_t count) {
  return std::min(count - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(count)));
}
double between(Random& random, double low, double high) { return low + (high - low) * random.uniform(); }
double either_sign(Random& random) { return random.uniform() < 0.5 ? -1.0 : 1.0; }

struct Drives {
  std::array<double, 3> kv{30.0, 30.0, 30.0};
  bool servo = false;  ///< all of one kind: unlike drives are a servo mismatch
  std::array<double, 3> friction_Nm{0.02, 0.02, 0.02};
};

/// Adds a fault of about `size_um` to the case. @return its name for the diagnosis
std::string hide_fault(const std::string& fault, double size_um, Random& random, HiddenCircle& hidden, Drives& drives) {
  const std::size_t which = one_of(random, 2);
  const Axis axis = hidden.plan.plane[which], other = hidden.plan.plane[1 - which];
  const std::string letter(1, letter_of(axis)), plane = laser::plane_name(hidden.plan.plane);
  const double signed_um = size_um * either_sign(random);
  if (hidden.axis.empty()) hidden.axis = letter;
  const auto effect = [&](const std::string& id, const std::string& parameters) {
    hidden.errors +=
        fmt::format("[[effect]]\nid = \"{}\"\naxis = \"{}\"\nparameters = {{ {} }}\n", id, letter, parameters);
  };
  if (fault == "backlash") effect("backlash", fmt::format("um = {}", 2.0 * signed_um));
  if (fault == "reversal_spike")
    effect("reversal_spike",
           fmt::format("c_um = {}, u0_mm = {}", 6.0 * signed_um,
                       hidden.plan.radius_mm * std::exp(between(random, std::log(0.0004), std::log(0.02)))));
  if (fault == "friction") {
    drives.servo = true;
    drives.friction_Nm[index_of(axis)] = 1.0;
  }
  if (fault == "scale") effect("scale", fmt::format("um_per_m = {}", signed_um * 2.0 / hidden.plan.radius_mm * 1000.0));
  if (fault == "cyclic")
    effect("cyclic", fmt::format("period_mm = {}, amplitude_um = {}, phase_rad = {}", kPitch_mm[index_of(axis)],
                                 2.0 * size_um, between(random, 0.0, 6.28)));
  if (fault == "servo_mismatch") {
    // Δr = v (1/kv_u − 1/kv_v)/2 · sin 2θ
    const double seconds = 2.0 * signed_um / 1000.0 / (hidden.plan.feed_mm_min / 60.0);
    drives.kv[index_of(axis)] = 1.0 / (1.0 / drives.kv[index_of(axis)] + seconds);
  }
  if (fault == "squareness") {
    const bool xy = plane == "XY" || plane == "YX", yz = plane == "YZ" || plane == "ZY";
    hidden.errors += fmt::format("[squareness]\n{} = {}\n",
                                 xy   ? "C0Y"
                                 : yz ? "A0Z"
                                      : "B0Z",
                                 2.0 * signed_um / hidden.plan.radius_mm * 1000.0);
  }
  if (fault == "straightness") {
    const std::string component = fmt::format("E{}{}", letter_of(other), letter);
    hidden.errors +=
        fmt::format("[[contribution]]\ncomponent = \"{}\"\nformula = \"{} * ((p - {}) / {})^2\"\n", component,
                    4.0 * signed_um, hidden.plan.centre_mm[index_of(axis)], hidden.plan.radius_mm);
  }
  if (fault == "friction") return "reversal_spike:" + letter;
  if (fault == "scale") return "scale_mismatch:" + plane;
  if (fault == "squareness" || fault == "servo_mismatch") return fault + ":" + plane;
  return fault + ":" + letter;
}

/// Lost motion and friction of the same axis, in place of the fault drawn.
void hide_together(double size_um, Random& random, HiddenCircle& hidden, Drives& drives) {
  hidden.errors.clear();
  drives = {};
  const Axis axis = hidden.plan.plane[one_of(random, 2)];
  hidden.axis = letter_of(axis);
  hidden.fault = "together";
  hidden.cause = "backlash:" + hidden.axis;
  hidden.errors = fmt::format("[[effect]]\nid = \"backlash\"\naxis = \"{}\"\nparameters = {{ um = {} }}\n", hidden.axis,
                              2.0 * size_um * either_sign(random));
  drives.servo = true;
  drives.friction_Nm[index_of(axis)] = std::exp(between(random, std::log(0.05), 0.0));
}

HiddenCircle hidden_circle(std::uint64_t seed, bool second, bool together) {
  Random random(seed_of(seed, 230, 4));
  HiddenCircle hidden;
  constexpr std::array<std::array<Axis, 2>, 3> kPlanes{{{Axis::X, Axis::Y}, {Axis::Y, Axis::Z}, {Axis::Z, Axis::X}}};
  hidden.plan.plane = kPlanes[one_of(random, kPlanes.size())];
  hidden.plan.centre_mm = {between(random, 250.0, 550.0), between(random, 220.0, 280.0),
                           between(random, -230.0, -170.0)};
  hidden.plan.radius_mm = 50.0 * static_cast<double>(1 + one_of(random, 3));
  hidden.plan.feed_mm_min = between(random, 500.0, 3000.0);
  hidden.plan.start_angle_deg = between(random, 0.0, 360.0);
  hidden.plan.runs = 1;
  hidden.plan.noise_um = 0.0;
  Drives drives;
  const std::size_t fault = one_of(random, kFaults.size());
  const double size_um = between(random, 1.0, 8.0);
  hidden.fault = kFaults[fault];
  hidden.cause = hide_fault(kFaults[fault], size_um, random, hidden, drives);
  if (second) {
    const std::size_t next = (fault + 1 + one_of(random, kFaults.size() - 1)) % kFaults.size();
    if (kFaults[next] != "friction" && kFaults[fault] != "friction")
      (void)hide_fault(kFaults[next], size_um / 4.0, random, hidden, drives);
  }
  if (together) hide_together(size_um, random, hidden, drives);
  hidden.machine = "name = \"hidden\"\nconfiguration = \"XYTZ\"\n";
  constexpr const char* kTravel[] = {"[0.0, 800.0]", "[0.0, 500.0]", "[-400.0, 0.0]"};
  for (const Axis axis : kAllAxes)
    hidden.machine +=
        fmt::format("[axis.{}]\ntravel_mm = {}\ndatum_mm = 0.0\nresolution_um = 0.1\nscrew_pitch_mm = {}\n",
                    letter_of(axis), kTravel[index_of(axis)], kPitch_mm[index_of(axis)]);
  hidden.machine += "[emulator]\nseed = 1\n";
  for (const Axis axis : kAllAxes)
    hidden.machine +=
        fmt::format("[emulator.axis.{}]\ndrive = \"{}\"\nkv_per_s = {}\nfriction_Nm = {}\n", letter_of(axis),
                    drives.servo ? "servo" : "ideal", drives.kv[index_of(axis)], drives.friction_Nm[index_of(axis)]);
  return hidden;
}

/// Noisy runs of what one run without noise showed.
laser::CircleTest with_noise(const laser::CircleTest& clean, double sigma_um, int runs, Random& random) {
  laser::CircleTest noisy = clean;
  noisy.readings.clear();
  for (int run = 1; run <= runs; ++run)
    for (laser::CircleReading reading : clean.readings) {
      reading.run = run;
      reading.deviation_um += sigma_um * random.normal();
      noisy.readings.push_back(reading);
    }
  return noisy;
}

double rms_about_centre(const laser::CircleTest& test) {
  double squares = 0.0;
  std::size_t count = 0;
  for (const laser::CirclePass& pass : laser::circle_values_of(test).passes)
    for (const laser::CircleReading& reading : pass.readings) {
      const double left = laser::deviation_at(pass, reading.angle_deg, pass.centre_um) - pass.mean_um;
      squares += left * left;
      ++count;
    }
  return std::sqrt(squares / static_cast<double>(count));
}

struct Tally {
  int cases = 0, right = 0, grouped = 0, wrong = 0;
  int beside = 0;  ///< with a further name, of a fault that is not there
  void operator+=(const Tally& more) {
    cases += more.cases, right += more.right, grouped += more.grouped, wrong += more.wrong, beside += more.beside;
  }
};

/// A cause as the error model names it, in the words of the circle's faults: "backlash:X:EX" → "backlash:X".
std::string fault_of(std::string_view effect, const std::string& plane) {
  const auto parts = split(effect, ':');
  const std::string id(parts.front()), axis(parts.size() > 1 ? parts[1] : ""), at(parts.size() > 2 ? parts[2] : "");
  const bool own = at == "E" + axis;
  if (id == "scale" && own) return "scale_mismatch:" + plane;
  if (id == "squareness" || (id == "scale" && !own)) return "squareness:" + plane;
  if (id == "servo_lag") return "servo_mismatch:" + plane;
  if ((id == "progressive" || id == "sag") && !own) return "straightness:" + axis;
  if (own && (id == "backlash" || id == "reversal_spike" || id == "friction" || id == "cyclic")) return id + ":" + axis;
  return std::string(effect);
}

/// What a diagnosis named, first alternatives included.
struct Named {
  std::string first = "none";
  std::vector<std::string> alike{};  ///< that these readings cannot tell from it
  std::string verdict{};
  std::vector<std::string> further{};  ///< named beside the first
  std::vector<std::string> notes{};    ///< where nothing is named: what was closest, and why
};

/// A line along an axis both ways, five runs of 21 targets, with lost motion and noise.
void add_line(laser::MeasurementSet& set, Axis axis, double lost_um, double sigma_um, Random& random) {
  constexpr double kFrom_mm[] = {50.0, 50.0, -380.0}, kStep_mm[] = {35.13, 20.17, 18.05};
  for (int run = 1; run <= 5; ++run)
    for (const int approach : {1, -1})
      for (int i = 0; i <= 20; ++i) {
        laser::Reading reading;
        const int place = approach > 0 ? i : 20 - i;
        reading.axis = axis;
        reading.sense = static_cast<Sense>(axis);
        reading.position_mm[index_of(axis)] = kFrom_mm[index_of(axis)] + kStep_mm[index_of(axis)] * place;
        reading.approach = static_cast<Approach>(approach);
        reading.run = run;
        reading.error = 0.5 * lost_um * approach + sigma_um * random.normal();
        set.readings.push_back(reading);
      }
}

/// What a diagnosis names, in the words of the circle's faults.
Named named_by(const model::Diagnosis& diagnosis, const std::string& plane) {
  Named named;
  named.verdict = name_of(diagnosis.verdict);
  for (const model::Candidate& candidate : diagnosis.candidates) {
    if (!candidate.in_answer()) continue;
    const std::string fault = fault_of(to_text(candidate.effect), plane);
    if (named.first != "none") {
      named.verdict += " + " + to_text(candidate.effect);
      named.further.push_back(fault);
      continue;
    }
    named.first = fault;
    named.verdict += " " + to_text(candidate.effect);
    for (const std::string& rival : candidate.indistinguishable_from) named.alike.push_back(fault_of(rival, plane));
  }
  if (named.first == "none" && diagnosis.verdict != model::Verdict::adequate) {
    for (const model::Candidate& candidate : diagnosis.candidates)
      if (candidate.found)
        named.notes.push_back(fmt::format("{} leaves {:.3f} of {:.3f} um, noise {:.3f} um, e-value {:.3g}",
                                          place_text(candidate.effect), candidate.rms_after_um, diagnosis.rms_um,
                                          diagnosis.noise.noise_um, candidate.e_value.value_or(-1.0)));
    for (const model::Dependence& one : diagnosis.where)
      named.notes.push_back(fmt::format("depends on {} ({:.2f})", one.variable, one.strength));
    named.notes.insert(named.notes.end(), diagnosis.notes.begin(), diagnosis.notes.end());
  }
  return named;
}

/// Readings of both circles as one set, runs numbered on.
laser::MeasurementSet with_circle(laser::MeasurementSet all, const laser::CircleTest& test, int first_run) {
  for (laser::Reading& reading : model::set_of_circle(test).readings) {
    reading.run += first_run - 1;
    all.readings.push_back(reading);
  }
  int row = 0;
  for (laser::Reading& reading : all.readings) reading.row = ++row;
  return all;
}

/// The first circle leaves the cause in a group; the first circle proposed then decides, or not.
struct Followed {
  bool counts = false;
  Named before, after;
  std::string sentence;
  double sigma = 0.0;
};
Result<Followed> followed(const laser::CircleTest& test, const HiddenCircle& hidden, Simulation& simulation,
                          const std::filesystem::path& machine_file, double sigma_um, Random& random) {
  ECS_TRY(machine, params::read_machine(machine_file));
  const std::string plane = laser::plane_name(test.plane);
  const laser::MeasurementSet set = with_circle({}, test, 1);
  const model::Model model;
  const auto data = model::observations_of(set, model, machine.machine);
  ECS_TRY(first, model::diagnose(model, data));
  Followed result;
  result.before = named_by(first, plane);
  if (result.before.alike.empty()) return result;
  const model::NextMeasurement next = model::planned_next(model, data, first);
  if (next.proposals.empty() || !next.proposals.front().circle) return result;
  const model::MeasurementProposal& proposal = next.proposals.front();
  result.counts = true;
  result.sentence = proposal.tells + ": " + proposal.sentence;
  result.sigma = proposal.separation_sigma;
  CirclePlan plan = hidden.plan;
  plan.plane = proposal.circle->plane;
  plan.centre_mm = proposal.circle->from_mm;
  plan.radius_mm = proposal.circle->radius_mm;
  plan.feed_mm_min = proposal.feed_mm_min;
  plan.step_deg = proposal.circle_step_deg;
  ECS_TRY(clean, contour_circle(simulation, plan));
  const laser::MeasurementSet both =
      with_circle(set, with_noise(clean, sigma_um, proposal.runs, random), proposal.first_run);
  ECS_TRY(second, model::diagnose(model, model::observations_of(both, model, machine.machine)));
  result.after = named_by(second, plane);
  return result;
}

Result<Named> named_by_model(const laser::CircleTest& test, const std::filesystem::path& machine_file, bool lines,
                             double sigma_um, Random& random) {
  ECS_TRY(machine, params::read_machine(machine_file));
  laser::MeasurementSet set = model::set_of_circle(test);
  model::Model model;
  if (lines) {
    const double lost_um = 6.0 * sigma_um;
    laser::MeasurementSet all;
    for (const Axis axis : test.plane) add_line(all, axis, axis == test.plane[0] ? lost_um : 0.0, sigma_um, random);
    for (laser::Reading& reading : set.readings) {
      const model::Path path = *model::path_in(reading.text_extras.find(model::kPathColumn)->second);
      const auto place = place_on(path, reading.position_mm, static_cast<int>(reading.approach));
      const std::size_t u = index_of(test.plane[0]);
      reading.error += 0.5 * lost_um * place.approach[u] * place.direction[u];
      all.readings.push_back(reading);
    }
    set = std::move(all);
  }
  int row = 0;
  for (laser::Reading& reading : set.readings) reading.row = ++row;
  const auto data = model::observations_of(set, model, machine.machine);
  model.effects = model::usual_effects(data);
  ECS_TRY(diagnosis, model::diagnose(model, data));
  return named_by(diagnosis, laser::plane_name(test.plane));
}

std::string case_text(long long seed, bool right, const HiddenCircle& hidden, double sigma_um) {
  return fmt::format("seed {}: {} {}: hidden {}, R {} mm, F {:.0f}, sigma {:.3f} um:", seed, right ? "right" : "WRONG",
                     laser::plane_name(hidden.plan.plane), hidden.cause, hidden.plan.radius_mm, hidden.plan.feed_mm_min,
                     sigma_um);
}

}  // namespace

int main(int argc, char** argv) {
  long long first = 1, last = 20;
  double snr = 3.0, step_deg = 1.0;
  int runs = 2;
  bool second = false, show = false, blank = false, by_model = false, lines = false, follow = false, together = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--seeds" && i + 1 < argc) {
      const std::string_view range = argv[++i];
      const std::size_t dots = range.find("..");
      first = integer_in(range.substr(0, dots)).value_or(1);
      last = dots == range.npos ? first : integer_in(range.substr(dots + 2)).value_or(first);
    } else if (word == "--snr" && i + 1 < argc) {
      snr = number_in(argv[++i]).value_or(snr);
    } else if (word == "--step" && i + 1 < argc) {
      step_deg = number_in(argv[++i]).value_or(step_deg);
    } else if (word == "--runs" && i + 1 < argc) {
      runs = static_cast<int>(integer_in(argv[++i]).value_or(runs));
    } else {
      second |= word == "--second";
      show |= word == "--show";
      blank |= word == "--blank";
      by_model |= word == "--model";
      lines |= word == "--lines";
      follow |= word == "--follow";
      together |= word == "--together";
    }
  }
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("ecs-circles-{}", first);
  std::filesystem::create_directories(folder);
  std::map<std::string, Tally> tallies;
  Tally all;
  int both = 0;  ///< of a seed that hides two faults together both are named
  const auto count = [&](const std::string& name, const Tally& one) {
    for (Tally* tally : {&tallies[name], &all}) *tally += one;
  };
  for (long long seed = first; seed <= last; ++seed) {
    HiddenCircle hidden = hidden_circle(static_cast<std::uint64_t>(seed), second, together);
    const bool on_lines = hidden.fault == "backlash" || hidden.fault == "scale" || hidden.fault == "cyclic";
    if (lines && on_lines && !blank) continue;
    hidden.plan.step_deg = step_deg;
    const auto machine = folder / "machine.toml", errors = folder / "errors.toml";
    if (!write_file(machine, hidden.machine) || !write_file(errors, hidden.errors.empty() ? "\n" : hidden.errors))
      return 5;
    auto simulation = simulation_for(machine, errors, std::nullopt);
    if (!simulation) return fmt::print(stderr, "seed {}: {}\n", seed, to_text(simulation.error())), 3;
    const auto clean = contour_circle(*simulation, hidden.plan);
    if (!clean) return fmt::print(stderr, "seed {}: {}\n", seed, to_text(clean.error())), 3;
    Random random(seed_of(static_cast<std::uint64_t>(seed), 230, 5));
    laser::CircleTest bare = *clean;
    if (blank)
      for (laser::CircleReading& reading : bare.readings) reading.deviation_um = 0.0;
    const double sigma_um = blank ? 1.0 : rms_about_centre(*clean) / snr;
    const laser::CircleTest test = with_noise(bare, sigma_um, runs, random);
    if (follow) {
      if (hidden.fault == "friction") hidden.cause.replace(0, hidden.cause.find(':'), "friction");
      const auto result = followed(test, hidden, *simulation, machine, sigma_um, random);
      if (!result) return fmt::print(stderr, "seed {}: {}\n", seed, to_text(result.error())), 3;
      if (!result->counts) continue;
      const auto& alike = result->after.alike;
      const bool right =
          result->after.first == hidden.cause || std::find(alike.begin(), alike.end(), hidden.cause) != alike.end();
      const bool of_one = hidden.fault != "scale" && hidden.fault != "servo_mismatch";
      const bool alone = right && alike.empty() &&
                         (of_one || result->after.verdict.find(":" + hidden.axis + ":") != std::string::npos);
      count(hidden.fault,
            {1, right, right && !alone, !right && result->after.first != "none", !result->after.further.empty()});
      fmt::print("seed {}: {}: hidden {}: {} or {}; {} -> {}{}{}\n", seed, right ? "right" : "WRONG", hidden.cause,
                 result->before.verdict, fmt::join(result->before.alike, ", "), result->sentence, result->after.verdict,
                 alone ? "" : " or ", fmt::join(result->after.alike, ", "));
      std::fflush(stdout);
      continue;
    }
    if (by_model) {
      const auto named = named_by_model(test, machine, lines, sigma_um, random);
      if (!named) return fmt::print(stderr, "seed {}: {}\n", seed, to_text(named.error())), 3;
      // the circle's own faults have friction as a spike, the library has it apart
      if (hidden.fault == "friction") hidden.cause.replace(0, hidden.cause.find(':'), "friction");
      const bool among = std::find(named->alike.begin(), named->alike.end(), hidden.cause) != named->alike.end();
      const std::string friction = "friction:" + hidden.axis;
      const auto is_there = [&](const std::string& name) {
        return name == hidden.cause || (together && name == friction);
      };
      const bool right = blank ? named->first == "none" : is_there(named->first) || among;
      both += together && right && std::any_of(named->further.begin(), named->further.end(), is_there);
      const bool beside = !second && std::any_of(named->further.begin(), named->further.end(),
                                                 [&](const std::string& name) { return !together || !is_there(name); });
      count(blank ? "blank" : hidden.fault,
            {1, right, right && !named->alike.empty(), !right && named->first != "none", beside});
      if (show || !right) {
        fmt::print("{} {}", case_text(seed, right, hidden, sigma_um), named->verdict);
        if (together) fmt::print(" ({})", hidden.machine.substr(hidden.machine.find("[emulator.axis")));
        for (const std::string& other : named->alike) fmt::print(" or {}", other);
        fmt::print("\n");
        if (show && !right) fmt::print("    hidden by {}\n{}", hidden.fault, hidden.errors);
        if (show)
          for (const std::string& note : named->notes) fmt::print("    {}\n", note);
        std::fflush(stdout);
      }
      continue;
    }
    std::array<std::vector<double>, 2> pitches;
    for (std::size_t i = 0; i < 2; ++i) pitches[i] = {kPitch_mm[index_of(hidden.plan.plane[i])]};
    const auto diagnosis = model::diagnose_circle(test, pitches);
    if (!diagnosis) return fmt::print(stderr, "seed {}: {}\n", seed, to_text(diagnosis.error())), 3;
    const auto& faults = diagnosis->faults;
    const std::string named = faults.empty() ? "none" : faults.front().name;
    const bool right = blank ? faults.empty() : named == hidden.cause;
    count(blank ? "blank" : hidden.cause.substr(0, hidden.cause.find(':')),
          {1, right, right && !faults.empty() && !faults.front().indistinguishable_from.empty(), false, false});
    if (show || !right) {
      fmt::print("{}", case_text(seed, right, hidden, sigma_um));
      for (const auto& fault : faults) fmt::print(" {} {:.3f}", fault.name, fault.rms_um);
      fmt::print("; left {:.3f}\n", diagnosis->left_um);
    }
  }
  std::filesystem::remove_all(folder);
  for (const auto& [name, tally] : tallies)
    fmt::print(
        "{:<16} {:>4} of {:>4} right, {} of them with others that cannot be told apart{}\n", name, tally.right,
        tally.cases, tally.grouped,
        by_model || follow ? fmt::format("; {} wrongly named, {} with a further name", tally.wrong, tally.beside) : "");
  fmt::print("all, SNR {:g}, seeds {}..{}: {} of {} ({:.1f} %){}\n", snr, first, last, all.right, all.cases,
             100.0 * all.right / std::max(all.cases, 1),
             by_model || follow ? fmt::format(", {} with a further name", all.beside) : "");
  if (together) fmt::print("both named in {}\n", both);
}
