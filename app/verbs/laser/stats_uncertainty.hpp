// The uncertainty of `ecs laser stats`: its options and its part of the answer.
#pragma once

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "laser/standards/iso230_uncertainty.hpp"

namespace ecs::app {

struct UncertaintyOptions : laser::Iso230Conditions {
  /// Adds the options below a heading of their own.
  explicit UncertaintyOptions(Verb& verb);
  /// Whether anything that contributes was given.
  [[nodiscard]] bool given() const;
};

/// null and no text where nothing was given, or no uncertainty exists.
[[nodiscard]] Cell uncertainty_cell(const laser::Iso230& iso, const UncertaintyOptions& options);

}  // namespace ecs::app
