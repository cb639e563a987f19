// Circular tests of emulated machines that hide one fault, and the share of them whose first cause is right.
//   circle_table --seeds A..B [--snr 3] [--step 1] [--runs 2] [--second] [--blank] [--show]
// Each seed draws a machine, a plane, a circle and a fault. The machine is contoured without noise by `contour_circle`;
// its deviations then get noise so that the rms of the fault's part is --snr times that of the noise. --second adds
// another fault of a third of the size. Faults come from the effects and drives of the emulator, which share no code
// with model/circle.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/workshop/circle.hpp"
#include "ecs_emulator/workshop/serve.hpp"
#include "laser/standards/circle.hpp"
#include "laser/standards/circle_file.hpp"
#include "laser/writers/circle_writer.hpp"
#include "model/circle/diagnosis.hpp"

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
};

double between(Random& random, double low, double high) { return low + (high - low) * random.uniform(); }
std::size_t one_of(Random& random, std::size_t count) {
  return std::min(count - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(count)));
}
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

HiddenCircle hidden_circle(std::uint64_t seed, bool second) {
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
  hidden.cause = hide_fault(kFaults[fault], size_um, random, hidden, drives);
  if (second) {
    const std::size_t next = (fault + 1 + one_of(random, kFaults.size() - 1)) % kFaults.size();
    if (kFaults[next] != "friction" && kFaults[fault] != "friction")
      (void)hide_fault(kFaults[next], size_um / 4.0, random, hidden, drives);
  }
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
      const double left = laser::deviation_at(pass, reading.angle_deg) - pass.mean_um;
      squares += left * left;
      ++count;
    }
  return std::sqrt(squares / static_cast<double>(count));
}

struct Tally {
  int cases = 0, right = 0, grouped = 0;
};

}  // namespace

int main(int argc, char** argv) {
  long long first = 1, last = 20;
  double snr = 3.0, step_deg = 1.0;
  int runs = 2;
  bool second = false, show = false, blank = false;
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
    }
  }
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("ecs-circles-{}", first);
  std::filesystem::create_directories(folder);
  std::map<std::string, Tally> tallies;
  Tally all;
  for (long long seed = first; seed <= last; ++seed) {
    HiddenCircle hidden = hidden_circle(static_cast<std::uint64_t>(seed), second);
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
    std::array<std::vector<double>, 2> pitches;
    for (std::size_t i = 0; i < 2; ++i) pitches[i] = {kPitch_mm[index_of(hidden.plan.plane[i])]};
    const auto diagnosis = model::diagnose_circle(test, pitches);
    if (!diagnosis) return fmt::print(stderr, "seed {}: {}\n", seed, to_text(diagnosis.error())), 3;
    const auto& faults = diagnosis->faults;
    const std::string named = faults.empty() ? "none" : faults.front().name;
    const bool right = blank ? faults.empty() : named == hidden.cause;
    Tally& tally = tallies[blank ? "blank" : hidden.cause.substr(0, hidden.cause.find(':'))];
    for (Tally* one : {&tally, &all}) {
      ++one->cases;
      one->right += right;
      one->grouped += right && !faults.empty() && !faults.front().indistinguishable_from.empty();
    }
    if (show || !right) {
      fmt::print("seed {}: {} {}: hidden {}, R {} mm, F {:.0f}, sigma {:.3f} um:", seed, right ? "right" : "WRONG",
                 laser::plane_name(hidden.plan.plane), hidden.cause, hidden.plan.radius_mm, hidden.plan.feed_mm_min,
                 sigma_um);
      for (const auto& fault : faults) fmt::print(" {} {:.3f}", fault.name, fault.rms_um);
      fmt::print("; left {:.3f}\n", diagnosis->left_um);
    }
  }
  std::filesystem::remove_all(folder);
  for (const auto& [name, tally] : tallies)
    fmt::print("{:<16} {:>4} of {:>4} right, {} of them with others that cannot be told apart\n", name, tally.right,
               tally.cases, tally.grouped);
  fmt::print("all, SNR {:g}, seeds {}..{}: {} of {} ({:.1f} %)\n", snr, first, last, all.right, all.cases,
             100.0 * all.right / std::max(all.cases, 1));
}
