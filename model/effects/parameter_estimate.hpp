// A parameter of an effect with its value from a fit.
#pragma once

#include <optional>
#include <string>

namespace ecs::model {

struct ParameterEstimate {
  std::string name;
  std::string unit;
  double value = 0.0;
  std::optional<double> sigma;  ///< absent: held, or the data do not determine it
  bool held = false;            ///< given in the model file
  bool undetermined = false;    ///< another term of the model does the same on these data; value is one of many
};

}  // namespace ecs::model
