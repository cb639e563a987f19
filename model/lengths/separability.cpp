// What lengths lack to determine a component. No method of its own: levers and directions that do not change.
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/lengths/identify.hpp"

namespace ecs::model {
namespace {

constexpr double kLooks = 0.05;        ///< cosine from which a length sees a direction
constexpr double kSameLever_mm = 1.0;  ///< levers closer than this are one

/// Readings of set-ups in which the axis moves.
std::vector<std::size_t> while_moving(const LengthTest& test, Axis axis) {
  const std::size_t a = index_of(axis);
  std::vector<std::set<double>> places(test.set_ups.size());
  for (const LengthReading& r : test.readings) places[r.set_up].insert(r.position_mm[a]);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < test.readings.size(); ++i)
    if (places[test.readings[i].set_up].size() > 1) out.push_back(i);
  return out;
}

std::string letters_in(const std::vector<Component>& components) {
  std::vector<std::string> names;
  for (const Component c : components) names.emplace_back(name_of(c));
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::string what_is_missing(Component component, const LengthTest& test, const MachineCurves& curves,
                            const Eigen::MatrixXd& direction, const std::vector<Component>& together_with) {
  const std::string name(name_of(component));
  const auto looks = [&](std::size_t i, Axis d) {
    return std::abs(direction(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(index_of(d)))) > kLooks;
  };
  if (is_squareness(component)) {
    for (const Term& term : curves.terms())
      if (term.component == component)
        return fmt::format("{} is not determined: no length is inclined in the plane {}{}: add diagonals of that face",
                           name, letter_of(term.observed), letter_of(term.lever));
    return name + " is not determined";
  }
  const Axis axis = moving_axis(component);
  const auto moving = while_moving(test, axis);
  if (moving.empty())
    return fmt::format("{} is not determined: {} stands at one place in every set-up: add lengths while {} moves", name,
                       letter_of(axis), letter_of(axis));
  std::set<double> places;
  for (const std::size_t i : moving) places.insert(test.readings[i].position_mm[index_of(axis)]);
  const auto needed = static_cast<std::size_t>(curves.block(component).even) + 1;
  if (places.size() < needed)
    return fmt::format(
        "{} is not determined: {} places of {} for a curve that needs {}: add targets, or take knots "
        "farther apart",
        name, places.size(), letter_of(axis), needed);
  std::vector<std::string> lacks;
  bool some_lever_changes = false;
  for (const Term& term : curves.terms()) {
    if (term.component != component) continue;
    const char seen = letter_of(term.observed);
    std::set<long long> levers;
    double lever_mm = 0.0;
    bool looked = false;
    for (const std::size_t i : moving) {
      if (!looks(i, term.observed)) continue;
      looked = true;
      lever_mm = curves.lever_mm(term, test.readings[i].position_mm, test.tools[test.readings[i].tool].offset_mm);
      levers.insert(std::llround(lever_mm / kSameLever_mm));
    }
    const std::string no_look =
        fmt::format("no length looks along {} while {} moves: add a diagonal inclined to {}, or lengths from a station",
                    seen, letter_of(axis), seen);
    if (!looked) {
      lacks.push_back(no_look);
    } else if (!term.has_lever) {
      some_lever_changes = true;
    } else if (levers.size() < 2) {
      const char lever = letter_of(term.lever);
      lacks.push_back(term.uses_coordinate
                          ? fmt::format("every length that looks along {} while {} moves has the same {} and tool "
                                        "(lever {:.0f} mm): add lines at another {} or with another tool",
                                        seen, letter_of(axis), lever, lever_mm, lever)
                          : fmt::format("only a tool offset along {} levers it into {}, and every length has the same "
                                        "({:.0f} mm): add a second tool length",
                                        lever, seen, lever_mm));
    } else {
      some_lever_changes = true;
    }
  }
  std::sort(lacks.begin(), lacks.end());
  lacks.erase(std::unique(lacks.begin(), lacks.end()), lacks.end());
  std::string text = name + " is not determined";
  if (!some_lever_changes && !lacks.empty()) return fmt::format("{}: {}", text, fmt::join(lacks, "; "));
  if (!together_with.empty())
    text += fmt::format(": these lengths hold it only together with {}", letters_in(together_with));
  text += ": add lines at other offsets, in other directions or with a tool of another length";
  return text;
}

}  // namespace ecs::model
