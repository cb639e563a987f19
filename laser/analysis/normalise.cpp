#include "laser/analysis/normalise.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"

namespace ecs::laser {
namespace {

constexpr std::string_view kMetadataKey = "normalised";

bool is_positioning(const Reading& reading) {
  return index_of(reading.axis) == static_cast<std::size_t>(reading.sense);
}

bool is_normalised(const MeasurementSet& set) {
  return std::any_of(set.readings.begin(), set.readings.end(),
                     [](const Reading& reading) { return reading.extras.contains(kBeforeNormalisation); });
}

std::string place_of(const Reading& reading) {
  return reading.line > 0 ? fmt::format("line {}", reading.line) : fmt::format("row {}", reading.row);
}

Result<double> temperature_of(const Reading& reading, const Normalisation& how) {
  std::optional<double> found = how.material_degC;
  if (!found) {
    const auto sensor = reading.sensors_degC.find(how.sensor);
    if (sensor == reading.sensors_degC.end())
      return problem(ProblemKind::refused,
                     fmt::format("{}: expected the temperature of the material in {}, found none: name another sensor "
                                 "or give one temperature for all",
                                 place_of(reading), how.sensor));
    found = sensor->second;
  }
  if (*found >= -50.0 && *found <= 150.0) return *found;
  return problem(ProblemKind::refused, fmt::format("{}: expected a material temperature of -50 to 150 degC, found {}",
                                                   place_of(reading), shortest(*found)));
}

/// Largest difference between material sensors of one reading.
double spread_of_sensors_degC(const MeasurementSet& set) {
  double spread = 0.0;
  for (const Reading& reading : set.readings) {
    std::optional<double> least, most;
    for (const auto& [name, value] : reading.sensors_degC) {
      if (name.starts_with("t_air")) continue;
      least = std::min(least.value_or(value), value);
      most = std::max(most.value_or(value), value);
    }
    if (least) spread = std::max(spread, *most - *least);
  }
  return spread;
}

void add_notes(Normalised& done, const Normalisation& how) {
  done.notes.push_back(fmt::format(
      "coefficient {} um/(m degC) from {}; the material stood at {:.2f} to {:.2f} degC{}; position {} mm stays",
      shortest(how.coefficient_um_per_m_degC),
      done.instrument_um_per_m_degC == 0.0
          ? std::string("errors as measured")
          : fmt::format("the {} that the instrument applied", shortest(done.instrument_um_per_m_degC)),
      done.least_degC, done.most_degC, how.material_degC ? " (one value for all readings)" : "",
      shortest(how.fixed_mm)));
  done.notes.push_back(
      fmt::format("a coefficient wrong by 1 um/(m degC) makes up to {:.3f} um here", done.per_coefficient_um));
  done.notes.push_back(
      "one coefficient stands for the whole machine: where scale, screw, bed and column are of several materials or of "
      "several temperatures it can be grossly wrong (thesis 6.3.1), and a map for a machine that works at this "
      "temperature may better be measured without it");
  const double spread_degC = spread_of_sensors_degC(done.set);
  if (spread_degC > 0.5)
    done.notes.push_back(fmt::format(
        "material sensors differ by up to {:.2f} degC: the machine is not at one temperature", spread_degC));
}

}  // namespace

std::optional<double> instrument_coefficient(const MeasurementSet& set) {
  for (const MetadataEntry& entry : set.metadata) {
    if (lower(entry.key) != "exp coeff") continue;
    const std::string_view first = std::string_view(entry.value).substr(0, entry.value.find(' '));
    if (const auto value = number_in(first)) return value;
  }
  return std::nullopt;
}

Result<Normalised> normalised(const MeasurementSet& set, const Normalisation& how) {
  if (is_normalised(set))
    return problem(ProblemKind::refused, "the readings are referred to 20 degC already: take that back first");
  Normalised done;
  done.set = set;
  done.instrument_um_per_m_degC =
      how.instrument_um_per_m_degC ? *how.instrument_um_per_m_degC : instrument_coefficient(set).value_or(0.0);
  for (const double coefficient : {how.coefficient_um_per_m_degC, done.instrument_um_per_m_degC})
    if (!(std::abs(coefficient) <= 1000.0))
      return problem(ProblemKind::refused,
                     fmt::format("coefficient: expected at most 1000 um/(m degC), found {}", shortest(coefficient)));
  const double difference = how.coefficient_um_per_m_degC - done.instrument_um_per_m_degC;
  for (Reading& reading : done.set.readings) {
    if (!is_positioning(reading)) continue;
    ECS_TRY(material_degC, temperature_of(reading, how));
    const double per_coefficient_um = (material_degC - kReference_degC) * (target_mm(reading) - how.fixed_mm) / kMmPerM;
    reading.extras.insert_or_assign(std::string(kBeforeNormalisation), reading.error);
    reading.error -= difference * per_coefficient_um;
    done.least_degC = done.changed == 0 ? material_degC : std::min(done.least_degC, material_degC);
    done.most_degC = done.changed == 0 ? material_degC : std::max(done.most_degC, material_degC);
    done.largest_um = std::max(done.largest_um, std::abs(difference * per_coefficient_um));
    done.per_coefficient_um = std::max(done.per_coefficient_um, std::abs(per_coefficient_um));
    ++done.changed;
  }
  if (done.changed == 0)
    return problem(ProblemKind::refused,
                   "expected errors along the moving axis, found none: straightness and angles are not referred to "
                   "20 degC by a coefficient");
  done.set.metadata.push_back(
      {std::string(kMetadataKey),
       fmt::format("to 20 degC with {} um/(m degC), instrument {}, {}, fixed at {} mm",
                   shortest(how.coefficient_um_per_m_degC), shortest(done.instrument_um_per_m_degC),
                   how.material_degC ? shortest(*how.material_degC) + " degC" : how.sensor, shortest(how.fixed_mm))});
  add_notes(done, how);
  return done;
}

Result<MeasurementSet> denormalised(const MeasurementSet& set) {
  if (!is_normalised(set))
    return problem(ProblemKind::refused,
                   fmt::format("expected readings referred to 20 degC (column {}), found none", kBeforeNormalisation));
  MeasurementSet back = set;
  for (Reading& reading : back.readings) {
    const auto before = reading.extras.find(kBeforeNormalisation);
    if (before == reading.extras.end()) continue;
    reading.error = before->second;
    reading.extras.erase(before);
  }
  std::erase(back.columns, kBeforeNormalisation);
  std::erase_if(back.metadata, [](const MetadataEntry& entry) { return entry.key == kMetadataKey; });
  return back;
}

}  // namespace ecs::laser
