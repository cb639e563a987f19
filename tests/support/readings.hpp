// Readings and curves made up by hand for the tests of laser/. Does not live here: tests.
#pragma once

#include <filesystem>

#include "base/file.hpp"
#include "core/parameters.hpp"
#include "laser/analysis/curve.hpp"
#include "laser/measurement_set.hpp"
#include "tests/support/test.hpp"

namespace ecs::laser {

inline Reading reading(Axis axis, Sense sense, double target_mm, double error, Approach approach = Approach::unknown,
                       int run = 1) {
  Reading made{.axis = axis, .sense = sense};
  made.position_mm[index_of(axis)] = target_mm;
  made.error = error;
  made.approach = approach;
  made.run = run;
  return made;
}

/// Errors by run at each target, along X in EX.
struct Stop {
  double target_mm;
  std::vector<double> forward;
  std::vector<double> reverse;
};

inline MeasurementSet set_of(const std::vector<Stop>& stops) {
  MeasurementSet set;
  for (const Stop& stop : stops) {
    int run = 0;
    for (const double error : stop.forward)
      set.readings.push_back(reading(Axis::X, Sense::EX, stop.target_mm, error, Approach::forward, ++run));
    run = 0;
    for (const double error : stop.reverse)
      set.readings.push_back(reading(Axis::X, Sense::EX, stop.target_mm, error, Approach::reverse, ++run));
  }
  return set;
}

inline Curve curve_of(const std::vector<Stop>& stops) {
  const MeasurementSet set = set_of(stops);
  return must(averaged(set, groups_of(set).front()));
}

/// Parameters of a machine with the axis X alone.
inline UnitParameters one_axis() {
  return {.configuration = {'T', 'X', 0, 0, 0}, .axis_present = {true, false, false}, .scope = Scope::linear};
}

/// A measured file: of samples/laser, else of tests/data/laser, which has the broken and the odd ones.
inline std::filesystem::path sample(const std::string& name) {
  const std::filesystem::path of_user = "samples/laser/" + name;
  return std::filesystem::exists(of_user) ? of_user : std::filesystem::path("tests/data/laser/" + name);
}

inline std::string sample_text(const std::string& name) {
  const auto text = read_file(sample(name));
  REQUIRE_MESSAGE(text.has_value(), name);
  return *text;
}

/// True if some entry contains the words.
inline bool says(const std::vector<std::string>& notes, const std::string& words) {
  for (const std::string& note : notes)
    if (contains(note, words)) return true;
  return false;
}

}  // namespace ecs::laser
