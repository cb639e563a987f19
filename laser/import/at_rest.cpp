#include "laser/import/at_rest.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "laser/csv_columns.hpp"
#include "laser/groups.hpp"
#include "laser/import/readers.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kLeastAtRest = 3;
constexpr int kTextDigits = 4;

using Stretch = std::vector<const Reading*>;

/// What tells one stretch from the next besides the place.
bool goes_on(const Reading& first, const Reading& next, double within_mm) {
  if (first.run != next.run || first.approach != next.approach || first.compensated != next.compensated) return false;
  for (std::size_t i = 0; i < kAxes; ++i)
    if (!(std::abs(first.position_mm[i] - next.position_mm[i]) <= within_mm) ||
        !(std::abs(first.angle_deg[i] - next.angle_deg[i]) <= within_mm))
      return false;
  return true;
}

std::vector<Stretch> stretches_in(const std::vector<Reading>& readings, double within_mm) {
  std::vector<Stretch> stretches;
  std::map<std::pair<Axis, Sense>, std::size_t> open;
  for (const Reading& reading : readings) {
    const auto [at, is_new] = open.try_emplace({reading.axis, reading.sense}, 0);
    if (is_new || !goes_on(*stretches[at->second].front(), reading, within_mm)) {
      at->second = stretches.size();
      stretches.emplace_back();
    }
    stretches[at->second].push_back(&reading);
  }
  return stretches;
}

template <class Value>
std::optional<double> mean_over(const Stretch& stretch, Value value_of) {
  std::vector<double> values;
  for (const Reading* reading : stretch)
    if (const std::optional<double> value = value_of(*reading)) values.push_back(*value);
  return mean_of(values);
}

using Numbers = std::map<std::string, double, std::less<>>;

Numbers means_of(const Stretch& stretch, Numbers Reading::*member) {
  Numbers means;
  for (const Reading* reading : stretch)
    for (const auto& [name, first] : reading->*member)
      if (!means.contains(name))
        means[name] = *mean_over(stretch, [&, &key = name](const Reading& one) {
          const auto found = (one.*member).find(key);
          return found == (one.*member).end() ? std::nullopt : std::optional(found->second);
        });
  return means;
}

Reading mean_reading(const Stretch& stretch) {
  Reading mean = *stretch.front();
  std::vector<double> errors;
  for (const Reading* reading : stretch) errors.push_back(reading->error);
  mean.error = *mean_of(errors);
  for (std::size_t i = 0; i < kAxes; ++i)
    for (const auto place : {&Reading::position_mm, &Reading::angle_deg})
      (mean.*place)[i] = *mean_over(stretch, [&](const Reading& one) { return std::optional((one.*place)[i]); });
  for (const NumberColumn& column : kNumberColumns)
    mean.*column.member = mean_over(stretch, [&](const Reading& one) { return one.*column.member; });
  mean.sensors_degC = means_of(stretch, &Reading::sensors_degC);
  mean.extras = means_of(stretch, &Reading::extras);
  mean.extras["readings_averaged"] = static_cast<double>(stretch.size());
  if (const auto scatter = deviation_of(errors)) mean.extras["scatter"] = *scatter;
  return mean;
}

}  // namespace

void keep_at_rest(MeasurementSet& set, std::optional<double> at_rest_mm, bool average) {
  const auto stretches = stretches_in(set.readings, at_rest_mm.value_or(kSamePlace_mm));
  std::vector<Reading> kept;
  std::size_t averaged = 0, moving = 0;
  for (const Stretch& stretch : stretches) {
    if (at_rest_mm && stretch.size() < kLeastAtRest) {
      moving += stretch.size();
      continue;
    }
    if (average) {
      averaged += stretch.size();
      kept.push_back(mean_reading(stretch));
    } else {
      for (const Reading* reading : stretch) kept.push_back(*reading);
    }
  }
  if (at_rest_mm)
    set.notes.push_back(
        fmt::format("{} readings while the machine moved are left out: fewer than {} one after the other "
                    "within {:.{}g} mm",
                    moving, kLeastAtRest, *at_rest_mm, kTextDigits));
  if (average) {
    set.notes.push_back(fmt::format("{} readings at rest averaged to {}", averaged, kept.size()));
    for (const char* const column : {"readings_averaged", "scatter"})
      if (!set.columns.empty()) set.columns.emplace_back(column);
  } else {
    std::stable_sort(kept.begin(), kept.end(), [](const Reading& a, const Reading& b) { return a.row < b.row; });
  }
  set.readings = std::move(kept);
  number_rows(set);
}

}  // namespace ecs::laser
