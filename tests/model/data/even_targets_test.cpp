// The remark on targets at equal steps.
#include "model/data/even_targets.hpp"

#include <doctest/doctest.h>

#include "base/moved_targets.hpp"
#include "model/fit/model_file.hpp"
#include "tests/model/support/measured_lines.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

laser::MeasurementSet line_at(const std::vector<double>& targets_mm, Axis axis = Axis::X) {
  laser::MeasurementSet set;
  for (const double target_mm : targets_mm) {
    laser::Reading r;
    r.row = static_cast<int>(set.readings.size()) + 1;
    r.axis = axis;
    r.position_mm[index_of(axis)] = target_mm;
    set.readings.push_back(r);
  }
  return set;
}

const std::vector<double> kEven{0.0, 50.0, 100.0, 150.0, 200.0, 250.0, 300.0};

}  // namespace

TEST_CASE("even targets call for a remark with the periods that they do not show") {
  const auto note = even_targets_note(observations_of(line_at(kEven), Model{}, std::nullopt));
  REQUIRE(note);
  CHECK(note->find("targets are even at 50 mm along X (EX): periods below 100 mm cannot be told from longer ones") ==
        0);
  CHECK(note->find("pitch") == std::string::npos);
}

TEST_CASE("a pitch of the machine that even targets do not show is named") {
  params::Machine machine = mill();
  REQUIRE(machine.axes[0]);
  machine.axes[0]->screw_pitch_mm = 10.0;
  machine.axes[0]->scale_pitch_mm.reset();
  const auto note = even_targets_note(observations_of(line_at(kEven), Model{}, machine));
  REQUIRE(note);
  CHECK(note->find("longer ones, the screw pitch of 10 mm among them") != std::string::npos);
}

TEST_CASE("moved targets call for no remark, nor even ones that another run moved") {
  CHECK(!even_targets_note(observations_of(line_at(moved_targets(kEven)), Model{}, std::nullopt)));
  auto two_runs = line_at(kEven);
  for (const auto& r : line_at({17.3, 64.9, 121.1}).readings) two_runs.readings.push_back(r);
  CHECK(!even_targets_note(observations_of(two_runs, Model{}, std::nullopt)));
}

TEST_CASE("each axis whose targets are even is named once") {
  auto set = line_at(kEven);
  for (laser::Reading r : line_at({0.0, 20.0, 40.0, 60.0}, Axis::Y).readings)
    for (const Sense sense : {Sense::EX, Sense::EY}) {
      r.sense = sense;
      set.readings.push_back(r);
    }
  const auto note = even_targets_note(observations_of(set, Model{}, std::nullopt));
  REQUIRE(note);
  CHECK(note->find("even at 50 mm along X (EX)") != std::string::npos);
  CHECK(note->find("; targets are even at 20 mm along Y (EX, EY): periods below 40 mm") != std::string::npos);
}
