// What differs between two parameter sets. Reading them from files or units lives elsewhere.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/parameters.hpp"

namespace ecs::params {

struct Difference {
  std::string key;
  std::string unit;  ///< empty: none
  std::string a;     ///< value in the first set, full precision
  std::string b;     ///< value in the second
  friend bool operator==(const Difference&, const Difference&) = default;
};

/// Every field whose values, written in full, differ; in the order of the field table.
[[nodiscard]] std::vector<Difference> diff(const UnitParameters& a, const UnitParameters& b);

/// A table with one line per difference, headed by the names of the two sets; empty without differences.
[[nodiscard]] std::string to_text(const std::vector<Difference>& differences, std::string_view name_a,
                                  std::string_view name_b);

}  // namespace ecs::params
