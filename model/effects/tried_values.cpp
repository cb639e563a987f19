#include "model/effects/tried_values.hpp"

#include <algorithm>
#include <cmath>

#include "model/data/curve_basis.hpp"

namespace ecs::model {
namespace {

/// Positions closer than this [mm] are one target: targets differ by more, and rounding of arithmetic is far below.
constexpr double kSameTarget_mm = 1e-5;

}  // namespace

std::vector<double> logarithmic(double least, double greatest, std::size_t count) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(least * std::pow(greatest / least, static_cast<double>(i) / static_cast<double>(count - 1)));
  return values;
}

std::vector<double> acting_positions(const Observations& data, const Acting& acting, Axis axis) {
  std::vector<double> p;
  for (const std::size_t k : acting.rows) p.push_back(data.p_mm(k, axis));
  return distinct(std::move(p), kSameTarget_mm);
}

std::pair<double, double> acting_range(const Observations& data, const Acting& acting, Axis axis) {
  double least = 1e300, greatest = -1e300;
  for (const std::size_t k : acting.rows) {
    least = std::min(least, data.p_mm(k, axis));
    greatest = std::max(greatest, data.p_mm(k, axis));
  }
  return {least, greatest};
}

std::pair<double, double> extent_of(const Column& column, const Acting& acting) {
  double least = 1e300, greatest = 0.0;
  for (const std::size_t k : acting.rows) {
    greatest = std::max(greatest, column[k]);
    if (column[k] > 0.0) least = std::min(least, column[k]);
  }
  return {std::min(least, greatest), greatest};
}

TriedValues tried_values(const Observations& data, const EffectInstance& effect, const Acting& acting,
                         const SearchExtent& extent) {
  const EffectDefinition& definition = effect.definition();
  const auto held = effect.parameters.find(std::string(definition.searched_parameter()));
  if (held != effect.parameters.end()) return {{held->second}, {}, 1.0};
  if (definition.search.tried == nullptr) return {{0.0}, {}, 1.0};
  return definition.search.tried(data, effect, acting, extent);
}

}  // namespace ecs::model
