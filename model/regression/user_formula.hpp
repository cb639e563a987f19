// Effects written by the user as formulas over the columns of a measurement set (muParser).
// Does not live here: how their parameters are fitted (model/fit/fit.cpp).
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "model/data/observations.hpp"
#include "model/effects/definition.hpp"

namespace ecs::model {

class UserFormulas {
 public:
  /// Compiles the formulas of a user effect against the columns that the data have. Variables: every parameter, x_mm
  /// y_mm z_mm (machine coordinates), p_mm (moving axis, from its datum), approach, run, compensated, and the optional
  /// columns by name. Refuses what muParser refuses, with its place, and names the columns there are; and what assigns.
  [[nodiscard]] static Result<UserFormulas> compile(const EffectInstance& effect, const Observations& data);
  UserFormulas(UserFormulas&&) noexcept;
  UserFormulas& operator=(UserFormulas&&) noexcept;
  ~UserFormulas();

  /// Values at these parameters (in the order of `effect.user`), one per reading; kNotMeasured where a cell is missing
  /// or the value is not finite, 0 where no formula is for that sense.
  [[nodiscard]] std::vector<double> values(const std::vector<double>& parameters) const;

  /// Refuses formulas that have no finite value at a reading whose cells are all there, and names the first such one.
  [[nodiscard]] Result<void> finite_at(const std::vector<double>& parameters) const;

  /// Optional columns that the formulas read, each once.
  [[nodiscard]] std::vector<std::string> optional_columns() const;

  /// From the least to the greatest value of each position and optional column that the formulas read at readings of
  /// their senses; columns without two values are not listed.
  [[nodiscard]] std::vector<ValueRange> ranges_read() const;

  /// For each parameter: whether the values are a straight line in it whatever the others are.
  [[nodiscard]] std::vector<bool> linear_parameters(const std::vector<double>& start) const;

 private:
  struct Parts;
  explicit UserFormulas(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// The starting value of a user parameter: its value, its start, the middle of its range, or 1.
[[nodiscard]] double start_of(const UserParameter& parameter);

}  // namespace ecs::model
