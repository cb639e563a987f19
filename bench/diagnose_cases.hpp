// Data sets with a known hidden cause, made by arithmetic of their own: machines, layouts, instruments and noises of
// several kinds. Does not live here: the method under test (model/), how it is scored (diagnose_table.cpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "laser/measurement_set.hpp"
#include "model/model_file.hpp"
#include "params/machine.hpp"

namespace ecs::bench {

enum class CaseKind : std::uint8_t { single, pair, blank, out_of_library, confounded };

/// A hidden cause as "effect:axis:sense-or-code".
struct Truth {
  std::vector<std::string> effects;    ///< one, two or none
  std::vector<std::string> group;      ///< of a confounded case: all that cannot be told apart
  std::vector<std::string> variables;  ///< of structure outside the library: what it depends on
  std::optional<double> parameter;     ///< of the first effect, where it has a single one
  std::string parameter_name;
  std::string noise;         ///< its kind, in words
  double sigma_um = 0.0;     ///< of one reading
  double true_rms_um = 0.0;  ///< of the readings less base and hidden effects as they are
};

struct Case {
  CaseKind kind = CaseKind::blank;
  std::string name;
  model::Model model;
  params::Machine machine;
  laser::MeasurementSet data;
  Truth truth;
};

/// @param snr  rms of each hidden effect, beyond what the model absorbs, over the standard deviation of one reading
[[nodiscard]] Case make_case(CaseKind kind, double snr, std::uint64_t seed);

}  // namespace ecs::bench
