// Real measurements as sets of readings, and what the diagnosis says of them.
#pragma once

#include <sstream>

#include "base/file.hpp"
#include "base/text.hpp"
#include "laser/import/import.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/real_data.hpp"
#include "tests/support/test.hpp"

namespace ecs::model::test {

using Set = laser::MeasurementSet;

/// Text of a file of a real set, which is there.
inline std::string real_text(const std::string& name) {
  const auto text = read_file(real_data(name));
  REQUIRE_MESSAGE(text.has_value(), name);
  return *text;
}

/// Numbers of a line, separated by blanks or commas; empty where something else stands among them.
inline std::vector<double> numbers_in(std::string_view line) {
  std::string text(line);
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream words(text);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    const auto number = number_in(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

inline Reading& added(Set& set, Axis axis, Sense sense, const Vector3& position_mm, double error) {
  Reading r{.row = static_cast<int>(set.readings.size()) + 1,
            .axis = axis,
            .position_mm = position_mm,
            .sense = sense,
            .error = error};
  return set.readings.emplace_back(r);
}

inline Diagnosis diagnosed_as_new(const Set& set) {
  return must(diagnose(usual_model(set), observations_of(set, usual_model(set), std::nullopt)));
}

inline Model offsets(const std::vector<std::pair<Axis, Sense>>& places) {
  Model model;
  for (const auto& [axis, sense] : places) model.effects.push_back(effect(effects::offset, axis, sense));
  return model;
}

inline std::string summary_of(const Diagnosis& found) {
  std::ostringstream text;
  text << name_of(found.verdict) << ", rms " << found.rms_um << " -> " << found.rms_after_um << ", noise "
       << found.noise.noise_um;
  for (const Candidate& c : found.candidates) {
    if (&c - found.candidates.data() > 3) break;
    text << "\n  " << (c.named ? "named " : "      ") << to_text(c.effect) << ' ' << c.effect.sensor << " rms "
         << c.rms_after_um;
    for (const ParameterEstimate& parameter : c.parameters) text << ' ' << parameter.name << '=' << parameter.value;
    for (const std::string& other : c.indistinguishable_from) text << " | " << other;
  }
  return text.str();
}

inline Diagnosis diagnosed_real(const char* what, const Model& model, const Set& set,
                                const std::optional<params::Machine>& machine = std::nullopt) {
  const auto result = must(diagnose(model, observations_of(set, model, machine)));
  const std::string answer = std::string(what) + ": " + summary_of(result);
  MESSAGE(answer);
  return result;
}

/// Positioning tests of motion axes, five cycles, absolute positions in mm.
inline Set positioning_test(const std::string& name) {
  const auto text = real_text("ecmc-iso230-2/" + name + "_ISO230.dat");
  laser::ImportOptions options;
  options.axis = Axis::X;
  return laser::parse_any(text, name + ".dat", options).value().set;
}

}  // namespace ecs::model::test
