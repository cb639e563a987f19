// Many measurement lines in few rows: what `ecs laser stats` shows where each by itself would fill pages.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "laser/analysis/iso230.hpp"

namespace ecs::app {

/// One measurement line of the answer.
struct LineStatistics {
  laser::Iso230 iso;
  laser::Group group;
  std::vector<std::string> files;
  std::size_t outliers = 0;
  bool drifts = false;   ///< or a run is apart from the others
  double largest = 0.0;  ///< the reading farthest from 0, um or um/m
};

/// Up to so many lines are shown whole.
inline constexpr std::size_t kMostWholeLines = 6;

/// A row for each component, then the worst lines (by A; without A by range, then by the largest reading), then the
/// notes with the number of lines that have them. @param lines  at least one
[[nodiscard]] std::string summary_text(const std::vector<LineStatistics>& lines);

}  // namespace ecs::app
