// Formulas of the errors file, compiled once, and curves over an axis: a formula, or points with a value for each
// approach. Does not live here: which component they belong to, their notation in the file (reader.hpp).
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace ecs::emulator {

/// The variables that formulas read; formulas keep the addresses, so it does not move while they live.
struct Variables {
  double p = 0.0, d = 0.0, x = 0.0, y = 0.0, z = 0.0, t = 0.0, f = 0.0, m = 0.0, u = 0.0;
  std::map<std::string, double> temperatures;  ///< by sensor name; seen by formulas as T_<name>
};

/// One expression in the notation of muParser.
class Formula {
 public:
  /// `message` of the problem says what is wrong and where in the expression; file and line are the caller's.
  [[nodiscard]] static Result<Formula> compile(const std::string& expression, Variables& variables);
  Formula(Formula&&) noexcept;
  Formula& operator=(Formula&&) noexcept;
  ~Formula();
  /// The value at the variables as they stand; 0 where it is not finite.
  [[nodiscard]] double value() const;
  /// The same, finite or not.
  [[nodiscard]] double raw() const;

 private:
  struct Parser;
  explicit Formula(std::unique_ptr<Parser> parser);
  std::unique_ptr<Parser> parser_;
};

struct CurvePoint {
  double p_mm = 0.0;
  double forward = 0.0;
  double reverse = 0.0;
};

/// Either a formula or at least one point, ascending.
struct ErrorCurve {
  std::optional<Formula> formula;
  std::vector<CurvePoint> points;
  /// At the formula's variables as they stand, or at their p and d: linear between points, the end points hold.
  [[nodiscard]] double value(const Variables& variables) const;
};

}  // namespace ecs::emulator
