// Location errors that the readings of a ball do not tell apart: what `fit --rotary` states of each, and the bound of
// the volume that follows, over many made machines, of which exact matrices say the errors.
#include "commissioning/volume/fitted_rotary.hpp"

#include <map>

#include "tests/model/support/turning_machine.hpp"
#include "tests/support/volume_machine.hpp"
#include "volume/joint_volume.hpp"
#include "volume/rotary_uncertainty.hpp"

namespace ecs::commissioning {
namespace {

using model::test::TurningMachine;

/// Which errors the machines of a test have, as standard deviations [um; twice that in um/m].
struct Sizes {
  double of_a = 0.0, of_c = 0.0, of_ball = 0.0;
};

struct Made {
  TurningMachine truth = model::test::trunnion();
  laser::MeasurementSet set;  ///< only C was turned, with A at 0
};

Made made_machine(const Sizes& sizes, std::uint64_t seed) {
  Made made;
  std::mt19937_64 random(seed);
  NormalDraws normal;
  for (const std::size_t r : {0U, 2U})
    for (std::size_t s = 0; s < 6; ++s) {
      const bool of_itself = s % 3 == r;  // XOA is no error, AOA the zero of A, which the workpiece is set up with
      if (!of_itself)
        made.truth.exact.location[r][s] = (r == 0 ? sizes.of_a : sizes.of_c) * (s < 3 ? 1 : 2) * normal(random);
    }
  const Eigen::Vector3d off(normal(random), normal(random), normal(random));
  made.set = ball_set(made.truth, {sizes.of_ball * off, 0.4}, seed);
  std::erase_if(made.set.readings, [](const auto& r) { return r.axis != Axis::Z || r.angle_deg[0] != 0.0; });
  return made;
}

FittedRotary found_by_fit(const Made& made) {
  const model::Model model = model::test::usual_model(made.set, made.truth.machine);
  const model::Observations data = observations_of(made.set, model, made.truth.machine);
  return must(fitted_rotary(model, must(fit(model, data)), made.truth.machine, data));
}

volume::CompensatedMachine machine_with(const volume::RotaryErrors& errors) {
  volume::CompensatedMachine machine = volume::straight_machine("XYTZ");
  volume::RotaryAxes rotary;
  rotary.machine.chain = *kinematics::joint_chain_of("XYACTZ");
  rotary.machine.terms = kinematics::terms_of(rotary.machine.chain);
  const TurningMachine made = model::test::trunnion();
  for (const std::size_t r : {0U, 2U}) {
    rotary.machine.rotary[r] = made.exact.rotary[r];
    rotary.travel_deg[r] = made.machine.rotary[r]->travel_deg;
  }
  rotary.errors = errors;
  machine.rotary = rotary;
  return machine;
}

constexpr std::size_t kPlaces = 150;

double bound_of(const volume::RotaryErrors& errors) {
  volume::UncertaintySettings only_locations;
  only_locations.declared_zero = 0.0;
  only_locations.draws = 100;
  const volume::CompensatedMachine machine = machine_with(errors);
  return must(uncertainty_of(machine, {}, rotary_budget_of(*machine.rotary, only_locations), only_locations, kPlaces))
      .largest_95_um;
}

double true_largest_um(const TurningMachine& truth) {
  volume::RotaryErrors errors;
  errors.location = truth.exact.location;
  return must(evaluated_with_rotary(machine_with(errors), kPlaces)).after.all.largest_um;
}

/// How many of the machines are inside.
struct Counted {
  std::map<std::string, int> alone;  ///< of each location error, within twice its standard uncertainty
  int bound = 0;
};

Counted counted(const Sizes& sizes, int machines, std::uint64_t first_seed) {
  Counted count;
  for (int k = 0; k < machines; ++k) {
    const Made made = made_machine(sizes, first_seed + static_cast<std::uint64_t>(k));
    const FittedRotary found = found_by_fit(made);
    for (std::size_t r = 0; r < kAxes; ++r)
      for (std::size_t s = 0; s < 6; ++s) {
        if (!found.errors.location_u[r][s]) continue;
        const double off = std::abs(made.truth.exact.location[r][s] - found.errors.location[r][s]);
        count.alone[volume::location_name(r, s)] += static_cast<int>(off <= 2.0 * *found.errors.location_u[r][s]);
      }
    if (true_largest_um(made.truth) <= bound_of(found.errors)) ++count.bound;
  }
  return count;
}

TEST_CASE("each of two location errors that cannot be told apart is within 2 u, and the volume within its bound") {
  struct Case {
    const char* what;
    Sizes sizes;
  };
  for (const Case& one : {Case{"both alike", {10.0, 10.0, 10.0}}, Case{"the kept one alone", {0.0, 10.0, 10.0}},
                          Case{"the other alone", {10.0, 0.0, 10.0}}, Case{"the ball far off", {10.0, 10.0, 60.0}},
                          Case{"the ball in place", {20.0, 5.0, 2.0}}}) {
    CAPTURE(one.what);
    constexpr int kMachines = 100;
    const Counted count = counted(one.sizes, kMachines, 4100);
    for (const char* name : {"YOA", "ZOA", "BOA", "YOC", "BOC"}) {
      CAPTURE(name);
      REQUIRE(count.alone.contains(name));
      CHECK(count.alone.at(name) >= 90);  // binomial: 95 expected at least, below 90 one in 90
    }
    CHECK(count.bound >= 90);
  }
}

}  // namespace
}  // namespace ecs::commissioning
