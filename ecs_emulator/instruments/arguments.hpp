// Arguments of a request as typed values, a wrong one reported by its name, and the plans of `measure` and `capture`
// made from them. For .cpp files only: it is heavy.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "ecs_emulator/instruments/measurement.hpp"

namespace ecs::emulator {

class Arguments {
 public:
  explicit Arguments(const nlohmann::json& request) : request_(request) {}

  [[nodiscard]] std::optional<double> number(const char* key);
  [[nodiscard]] double number_or(const char* key, double otherwise) { return number(key).value_or(otherwise); }
  /// Each number that is there goes into its place.
  void numbers_into(std::initializer_list<std::pair<const char*, double*>> places);
  /// A whole number from `low` to `high`.
  [[nodiscard]] std::optional<long long> integer(const char* key, long long low, long long high);
  [[nodiscard]] std::string word(const char* key);  ///< empty where it is absent
  [[nodiscard]] bool flag(const char* key);         ///< false where it is absent
  /// 0 or 1, as in a column; nothing where it is absent.
  [[nodiscard]] std::optional<bool> zero_or_one(const char* key);
  [[nodiscard]] std::vector<double> numbers(const char* key);
  [[nodiscard]] std::vector<std::string> words(const char* key);  ///< one text or a list of them
  [[nodiscard]] std::optional<Axis> axis(const char* key);
  /// Under "sense".
  [[nodiscard]] std::optional<Sense> sense(bool required);
  /// Under "instrument".
  [[nodiscard]] std::optional<InstrumentKind> instrument();
  /// Coordinates under X, Y, Z of `object` (null: of the request itself).
  [[nodiscard]] PerAxis<std::optional<double>> coordinates(const char* object);

  void complain(std::string message);
  /// The same with a format string and its arguments (fmt).
  template <class First, class... Rest>
  void complain(fmt::format_string<First, Rest...> form, First&& first, Rest&&... rest) {
    complain(fmt::format(form, std::forward<First>(first), std::forward<Rest>(rest)...));
  }
  /// Call after every argument has been asked for: whatever was not is unknown. `usage` problem with all that is wrong.
  [[nodiscard]] Result<void> checked();

 private:
  [[nodiscard]] const nlohmann::json* find(const char* key);
  const nlohmann::json& request_;
  std::vector<std::string> known_{"action"};
  std::vector<Problem> problems_;
};

/// Asks `arguments` for everything that a plan has; what is wrong stays with them. Nothing without axis and sense.
[[nodiscard]] std::optional<MeasurementPlan> plan_in(Arguments& arguments);
/// The same for the request `capture`.
[[nodiscard]] std::optional<CapturePlan> capture_in(Arguments& arguments);

}  // namespace ecs::emulator
