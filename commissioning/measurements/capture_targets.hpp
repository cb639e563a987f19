// What is to be captured, as it is typed: targets along a line, a row of a plan, or a target list; the stops that
// follow from it are devices/capture_record.hpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/cli/action.hpp"
#include "devices/capture_record.hpp"

namespace ecs::commissioning {

inline constexpr int kMostRuns = 1000;

/// As typed; empty or absent: not given.
struct CaptureTargets {
  std::string axis;
  std::string sense;
  std::optional<double> from_mm;
  std::optional<double> to_mm;
  std::optional<double> step_mm;
  int runs = 0;
  bool moved = false;
  bool one_way = false;
  std::string parked;
  std::optional<double> feed_mm_min;
  std::string targets;
  std::string plan;
  std::string row;
  std::string machine;
  std::string compensated;
  std::vector<std::string> notes;
  static cli::Fields<CaptureTargets> fields();
};

/// Stops and metadata. What the plan's row says can be overridden one by one.
[[nodiscard]] Result<devices::CapturePlan> capture_plan(const CaptureTargets& arguments);

}  // namespace ecs::commissioning
