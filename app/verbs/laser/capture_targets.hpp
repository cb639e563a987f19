// What is to be captured, as a command line says it: a line of targets, a row of a plan, or a target list.
// Does not live here: the stops themselves (devices/capture_plan.hpp), devices (capture.cpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/cli/verb.hpp"
#include "devices/capture_plan.hpp"

namespace ecs::app {

/// As typed; empty or absent: not given.
struct TargetArguments {
  std::string axis;
  std::string sense;
  std::optional<double> from_mm;
  std::optional<double> to_mm;
  std::optional<double> step_mm;
  int runs = 0;
  bool one_way = false;
  std::string parked;
  std::optional<double> feed_mm_min;
  std::string targets;
  std::string plan;
  std::string row;
  std::string machine;
  std::string compensated;
  std::vector<std::string> notes;
};

/// Adds --axis --sense --from --to --step --runs --one-way --parked --feed --targets --plan --row --machine
/// --compensated --note.
void take_target_options(Verb& verb, TargetArguments& arguments);

/// Stops and metadata. What the plan's row says can be overridden one by one.
[[nodiscard]] Result<devices::CapturePlan> capture_plan(const TargetArguments& arguments);

}  // namespace ecs::app
