// `ecs map build --from-model`: the error map that a fitted model compiles to.
// Does not live here: the arithmetic (model/diagnosis/ladder.hpp), maps from measured files (app/verbs/map/build.cpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/outcome.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::commissioning {

/// As typed; empty: not given.
struct FromModelArguments {
  std::string model;
  std::string machine;
  std::optional<double> increment_mm;  ///< absent: fine enough for the model
  std::string params;                  ///< empty: those that fit the machine
  std::string output;
  std::string params_out;
  std::vector<std::string> zero;
  std::string customer;
  std::string engineer;
  std::string date;
};

[[nodiscard]] Result<Outcome> map_from_model(MessageSink& messages, const FromModelArguments& arguments);

}  // namespace ecs::commissioning
