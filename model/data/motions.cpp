#include "model/data/motions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

namespace ecs::model {
namespace {

/// A direction of which less than this share is measured does not count; what is left of a function beside others, as a
/// share of its square, below which it is one of them.
constexpr double kNoShare = 1e-12, kNothingLeft = 1e-9;
constexpr double kSecondsPerMinute = 60.0;
constexpr double kRad_per_deg = std::numbers::pi / 180.0;

/// The values of a function over the readings of a pass, made orthonormal to those before.
void add_function(Motions::Free& free, std::vector<double> values) {
  double square = 0.0;
  for (const double v : values) square += v * v;
  for (int twice = 0; twice < 2; ++twice)
    for (const std::vector<double>& other : free.functions) {
      double product = 0.0;
      for (std::size_t i = 0; i < values.size(); ++i) product += values[i] * other[i];
      for (std::size_t i = 0; i < values.size(); ++i) values[i] -= product * other[i];
    }
  double left = 0.0;
  for (const double v : values) left += v * v;
  if (left <= kNothingLeft * square) return;
  for (double& v : values) v /= std::sqrt(left);
  free.functions.push_back(std::move(values));
}

/// Of a circle the centre of each pass and the radius of each part of it; of a line the zero of each run, which both
/// ways share.
std::vector<Motions::Free> free_of(const Observations& data) {
  std::map<std::tuple<std::size_t, int, int>, std::vector<std::size_t>> passes;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (!data.on_path(k)) continue;
    const bool circle = data.path_of(k).kind == PathKind::circle;
    passes[{data.path[k], data.run[k], circle ? data.approach[k] : 0}].push_back(k);
  }
  std::vector<Motions::Free> all;
  for (auto& [pass, readings] : passes) {
    Motions::Free free;
    free.readings = std::move(readings);
    const auto add = [&](const auto& function) {
      std::vector<double> values;
      for (const std::size_t k : free.readings) values.push_back(function(kRad_per_deg * data.along[k]));
      add_function(free, std::move(values));
    };
    const auto part = data.extras.find(kPartColumn);
    std::set<double> parts;
    for (const std::size_t k : free.readings)
      if (const double number = part == data.extras.end() ? 1.0 : cell(part->second, k); std::isfinite(number))
        parts.insert(number);
    add([](double) { return 1.0; });
    for (const double number : parts) {
      std::vector<double> values;
      for (const std::size_t k : free.readings)
        values.push_back(part != data.extras.end() && cell(part->second, k) == number ? 1.0 : 0.0);
      if (parts.size() > 1) add_function(free, std::move(values));
    }
    if (data.path_of(free.readings.front()).kind == PathKind::circle) {
      add([](double angle) { return std::cos(angle); });
      add([](double angle) { return std::sin(angle); });
    }
    all.push_back(std::move(free));
  }
  return all;
}

/// One row of the motions: a reading, seen in one sense while one axis moves.
struct Seen {
  std::size_t reading = 0;
  Axis sense = Axis::X;
  Axis moving = Axis::X;
};

/// The sense of an axis as that axis moves, then as each other one does, where both count.
std::vector<Seen> seen_in(std::size_t k, const PlaceOnPath& place) {
  std::vector<Seen> rows;
  for (const Axis sense : kAllAxes) {
    if (std::abs(place.direction[index_of(sense)]) < kNoShare) continue;
    rows.push_back({k, sense, sense});
    for (const Axis moving : kAllAxes)
      if (moving != sense && place.approach[index_of(moving)] != 0) rows.push_back({k, sense, moving});
  }
  return rows;
}

}  // namespace

void Motions::take_out_free(double* column) const {
  for (const Free& pass : free)
    for (const std::vector<double>& function : pass.functions) {
      double product = 0.0;
      for (std::size_t i = 0; i < function.size(); ++i) product += function[i] * column[pass.readings[i]];
      for (std::size_t i = 0; i < function.size(); ++i) column[pass.readings[i]] -= product * function[i];
    }
}

void set_motions(Observations& data) {
  if (data.paths.empty()) return;
  auto motions = std::make_shared<Motions>();
  motions->readings = data.size();
  motions->free = free_of(data);
  std::vector<Seen> seen;
  std::vector<std::size_t> owners;
  std::vector<PlaceOnPath> places(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (data.on_path(k)) places[k] = place_on(data.path_of(k), data.position_mm[k], data.approach[k]);
    const std::vector<Seen> rows =
        data.on_path(k) ? seen_in(k, places[k]) : std::vector<Seen>{{k, data.axis[k], data.axis[k]}};
    for (const Seen& one : rows) {
      const double weight = data.on_path(k) ? places[k].direction[index_of(one.sense)] : 1.0;
      motions->shares.push_back({k, seen.size(), weight});
      owners.push_back(k);
      seen.push_back(one);
    }
  }
  Observations& rows = motions->rows = subset(data, owners);
  rows.paths.clear();
  rows.path.clear();
  rows.along.clear();
  rows.place.clear();
  rows.aside.assign(rows.size(), false);
  motions->on_path.assign(rows.size(), false);
  if (rows.travel_since_reversal_mm.empty()) rows.travel_since_reversal_mm.assign(rows.size(), kNotMeasured);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const std::size_t k = seen[i].reading, moving = index_of(seen[i].moving);
    if (!data.on_path(k)) continue;
    motions->on_path[i] = true;
    rows.axis[i] = seen[i].moving;
    rows.sense[i] = static_cast<Sense>(index_of(seen[i].sense));
    rows.aside[i] = seen[i].moving != seen[i].sense;
    rows.approach[i] = places[k].approach[moving];
    rows.travel_since_reversal_mm[i] = places[k].since_reversal_mm[moving].value_or(kNotMeasured);
    if (rows.feed_mm_min.empty()) continue;
    const auto way_mm = places[k].path_since_reversal_mm[moving];
    if (way_mm && rows.feed_mm_min[i] > 0.0) {
      Column& since_s = rows.extras[std::string(kTimeSinceReversalColumn)];
      since_s.resize(seen.size(), kNotMeasured);
      since_s[i] = *way_mm / rows.feed_mm_min[i] * kSecondsPerMinute;
    }
    rows.feed_mm_min[i] *= places[k].share_of_feed[moving];
  }
  if (std::ranges::all_of(rows.travel_since_reversal_mm, [](double mm) { return std::isnan(mm); }))
    rows.travel_since_reversal_mm.clear();
  set_natural_axes(rows);
  motions->take_out_free(data.reading.data());
  data.moved = std::move(motions);
  data.of_moved.resize(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) data.of_moved[k] = k;
}

Observations without_paths(const Observations& data) {
  if (data.paths.empty()) return data;
  std::vector<std::size_t> lines;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!data.on_path(k)) lines.push_back(k);
  Observations part = subset(data, lines);
  part.paths.clear();
  part.path.clear();
  part.along.clear();
  part.place.clear();
  part.moved.reset();
  part.of_moved.clear();
  set_natural_axes(part);
  return part;
}

}  // namespace ecs::model
