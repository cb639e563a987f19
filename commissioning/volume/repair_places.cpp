// B. Efron, R. Tibshirani, An Introduction to the Bootstrap (1993), 6.5. Correlated noise is a first-order process in
// time.
#include "commissioning/volume/repair_places.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>

#include "base/random.hpp"
#include "commissioning/maps/from_model.hpp"
#include "model/effects/definition.hpp"
#include "volume/field.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::size_t kCirclePlaces = 180;
/// The circle: at most this share of the shorter travel and no larger; a choice, ISO 230-4 leaves it to the user.
constexpr double kShareOfTravel = 0.8, kLargestDiameter_mm = 300.0;

volume::Travels travels_of_axes(const params::Machine& machine) {
  volume::Travels travels;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (machine.axes[a]) travels[a] = machine.axes[a]->travel_mm;
  return travels;
}

/// Places on the axis of a wave that see all of it: even places that are about a period apart would see one phase only.
std::size_t places_of_wave(const model::EffectInstance& effect, const params::Machine& machine) {
  constexpr double kPlacesPerPeriod = 6.0, kFewest = 120.0, kMost = 180.0;
  const auto period_mm = period_mm_of(effect);
  if (!period_mm || !effect.axis || !machine.axes[index_of(*effect.axis)]) return 0;
  const auto& travel_mm = machine.axes[index_of(*effect.axis)]->travel_mm;
  const double periods = (travel_mm[1] - travel_mm[0]) / *period_mm;
  if (kPlacesPerPeriod * periods <= kFewest) return static_cast<std::size_t>(std::ceil(kPlacesPerPeriod * periods)) + 1;
  // too many: fewer, each in another phase than the one before; the golden section spreads them most evenly
  constexpr double kGolden = 0.381966;
  double best = kFewest, least_off = 1.0;
  for (double count = kFewest; count < kMost; ++count) {
    const double phase = std::remainder(periods / count, 1.0), off = std::abs(std::abs(phase) - kGolden);
    if (off < least_off) {
      least_off = off;
      best = count;
    }
  }
  return static_cast<std::size_t>(best) + 1;
}

/// Even places, of waves as many as these need: the other axes have fewer then, but their ends and middle.
volume::Grid grid_for(const model::Fit& fit, const params::Machine& machine, std::size_t most,
                      const Vector3& datum_mm) {
  constexpr std::size_t kFewest = 5;
  volume::Grid grid = volume::grid_over(travels_of_axes(machine), most, datum_mm);
  PerAxis<std::size_t> wanted{};
  for (const model::EffectFit& effect : fit.effects)
    if (const std::size_t count = places_of_wave(effect.effect, machine); count > 0)
      wanted[index_of(*effect.effect.axis)] = std::max(wanted[index_of(*effect.effect.axis)], count);
  double room = static_cast<double>(most);
  std::size_t others = 0;
  for (std::size_t a = 0; a < kAxes; ++a) {
    wanted[a] = wanted[a] > grid.mm[a].size() ? wanted[a] : 0;
    if (wanted[a] > 0)
      room /= static_cast<double>(wanted[a]);
    else if (machine.axes[a])
      ++others;
  }
  if (wanted == PerAxis<std::size_t>{}) return grid;
  for (std::size_t a = 0; a < kAxes; ++a) {
    if (!machine.axes[a]) continue;
    const double root = std::pow(room, 1.0 / static_cast<double>(std::max<std::size_t>(others, 1)));
    const std::size_t count =
        wanted[a] > 0 ? wanted[a]
                      : std::clamp(static_cast<std::size_t>(root), kFewest, std::max(kFewest, grid.mm[a].size()));
    grid.mm[a] = volume::even_grid(travels_of_axes(machine), count, datum_mm).mm[a];
  }
  return grid;
}

/// Places that one more effect asks for on its axis, of a step that nobody has seen: just before and behind its place
/// in this machine, and the points of the table between which the map climbs. Between these the error is even.
void add_places_about(const model::EffectInstance& in_machine, const model::EffectInstance& in_map,
                      const params::Machine& machine, const std::vector<double>& table_mm, volume::Grid& grid) {
  constexpr double kBeside_mm = 0.01;
  const std::string name(in_map.definition().searched_parameter());
  const std::size_t axis = index_of(*in_map.axis);
  const double datum_mm = machine.axes[axis]->datum_mm, place_mm = in_machine.fitted.at(name) + datum_mm;
  const std::array<double, 2> climb_mm = points_about(table_mm, in_map.fitted.at(name) + datum_mm);
  std::vector<double>& mm = grid.mm[axis];
  const double least = mm.front(), greatest = mm.back();
  for (const double p_mm : {place_mm - kBeside_mm, place_mm + kBeside_mm, climb_mm[0], climb_mm[1]})
    if (p_mm > least && p_mm < greatest) mm.push_back(p_mm);
  std::sort(mm.begin(), mm.end());
  mm.erase(std::unique(mm.begin(), mm.end()), mm.end());
}

/// Half the way to the neighbours on either side.
std::vector<double> shares_of(const std::vector<double>& mm) {
  std::vector<double> shares(mm.size(), 1.0);
  for (std::size_t i = 0; i < mm.size() && mm.size() > 1; ++i)
    shares[i] = 0.5 * (mm[std::min(i + 1, mm.size() - 1)] - mm[i == 0 ? 0 : i - 1]);
  return shares;
}

}  // namespace

std::array<double, 2> points_about(const std::vector<double>& table_mm, double position_mm) {
  const auto above = std::upper_bound(table_mm.begin() + 1, table_mm.end() - 1, position_mm);
  return {*(above - 1), *above};
}

TablePoints tables_of(const params::Machine& machine, const model::Model& model) {
  const double increment_mm = table_increment_mm(model, machine);
  TablePoints tables;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (machine.axes[a]) tables[a] = model::table_positions(*machine.axes[a], increment_mm);
  return tables;
}

VolumePlaces volume_places(const params::Machine& machine, std::size_t most, const model::Fit& possible,
                           const model::Fit& fit, const model::Observations& data, const TablePoints& tables_mm) {
  Vector3 datum_mm{};
  for (std::size_t a = 0; a < kAxes; ++a)
    if (machine.axes[a]) datum_mm[a] = machine.axes[a]->datum_mm;
  volume::Grid grid = grid_for(fit, machine, most, datum_mm);
  for (std::size_t i = 0; i < fit.effects.size(); ++i)
    if (const model::EffectInstance& effect = fit.effects[i].effect;
        targets_about(effect, data) && machine.axes[index_of(*effect.axis)])
      add_places_about(possible.effects[i].effect, effect, machine, tables_mm[index_of(*effect.axis)], grid);
  VolumePlaces out;
  const auto add = [&](const Vector3& at, double weight) {
    for (const Approach side : {Approach::forward, Approach::reverse}) {
      out.places.push_back({at, {side, side, side}});
      out.weight.push_back(weight);
    }
  };
  PerAxis<std::vector<double>> share;
  for (std::size_t a = 0; a < kAxes; ++a) share[a] = shares_of(grid.mm[a]);
  for (std::size_t x = 0; x < grid.mm[0].size(); ++x)
    for (std::size_t y = 0; y < grid.mm[1].size(); ++y)
      for (std::size_t z = 0; z < grid.mm[2].size(); ++z)
        add(grid.at({x, y, z}), share[0][x] * share[1][y] * share[2][z]);
  add(datum_mm, 0.0);
  return out;
}

Circle circle_of(const params::Machine& machine) {
  const volume::Travels travels = travels_of_axes(machine);
  const auto length = [&](std::size_t a) { return travels[a] ? (*travels[a])[1] - (*travels[a])[0] : 0.0; };
  std::array<std::size_t, kAxes> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return length(a) > length(b); });
  Circle circle;
  circle.first = std::min(order[0], order[1]);
  circle.second = std::max(order[0], order[1]);
  circle.diameter_mm = std::min(kShareOfTravel * length(order[1]), kLargestDiameter_mm);
  if (circle.diameter_mm <= 0.0) return circle;
  Vector3 middle{};
  for (std::size_t a = 0; a < kAxes; ++a)
    if (travels[a]) middle[a] = 0.5 * ((*travels[a])[0] + (*travels[a])[1]);
  for (std::size_t i = 0; i < kCirclePlaces; ++i) {
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / kCirclePlaces;
    MachinePlace place{middle, {Approach::forward, Approach::forward, Approach::forward}};
    place.position_mm[circle.first] += 0.5 * circle.diameter_mm * std::cos(angle);
    place.position_mm[circle.second] += 0.5 * circle.diameter_mm * std::sin(angle);
    if (std::sin(angle) > 0.0) place.approach[circle.first] = Approach::reverse;
    if (std::cos(angle) < 0.0) place.approach[circle.second] = Approach::reverse;
    circle.places.push_back(place);
  }
  return circle;
}

namespace {

/// Noise of one sense along one axis, in the order of the rows.
class DrawnNoise {
 public:
  DrawnNoise(const model::NoiseReport& noise, std::mt19937_64& random) : noise_(noise), random_(random) {}

  /// @param time  of the reading [s], or its number
  double next(double time) {
    if (noise_.correlated_um > 0.0 && noise_.correlation_time_s > 0.0) {
      const double kept = last_time_ ? std::exp(-std::abs(time - *last_time_) / noise_.correlation_time_s) : 0.0;
      slow_um_ = kept * slow_um_ + noise_.correlated_um * std::sqrt(1.0 - kept * kept) * normal_(random_);
      last_time_ = time;
    }
    return slow_um_ + noise_.white_um * normal_(random_);
  }
  [[nodiscard]] bool is_of(Axis axis, Sense sense) const { return noise_.axis == axis && noise_.sense == sense; }

 private:
  const model::NoiseReport& noise_;
  std::mt19937_64& random_;
  NormalDraws normal_{};
  std::optional<double> last_time_;
  double slow_um_ = 0.0;
};

/// Where an effect falls between two targets: each draw another of `count` equal parts, in an order of its own for
/// every effect.
class PlacesBetween {
 public:
  PlacesBetween(std::size_t effects, std::size_t count, std::mt19937_64& random) : part_(effects) {
    for (std::vector<std::size_t>& part : part_) {
      part.resize(count);
      std::iota(part.begin(), part.end(), std::size_t{0});
      shuffle(part, random);
    }
  }
  /// The middle of the part.
  [[nodiscard]] double share(std::size_t effect, std::size_t draw) const {
    return (static_cast<double>(part_[effect][draw]) + 0.5) / static_cast<double>(part_[effect].size());
  }

 private:
  std::vector<std::vector<std::size_t>> part_;
};

}  // namespace

std::optional<std::array<double, 2>> targets_about(const model::EffectInstance& effect,
                                                   const model::Observations& data) {
  const std::string name(effect.definition().searched_parameter());
  if (effect.definition().search.has_slope || !effect.axis || effect.parameters.contains(name)) return std::nullopt;
  const auto place = effect.fitted.find(name);
  if (place == effect.fitted.end()) return std::nullopt;
  std::optional<double> below, above;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const double p_mm = data.p_mm(k, *effect.axis);
    if (p_mm <= place->second && (!below || p_mm > *below)) below = p_mm;
    if (p_mm > place->second && (!above || p_mm < *above)) above = p_mm;
  }
  if (!below || !above) return std::nullopt;
  return std::array{*below, *above};
}

std::vector<model::Fit> refits(const model::Model& model, const model::Observations& data, const model::Fit& fit,
                               std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<model::Fit> again;
  PlacesBetween between(fit.effects.size(), count, random);
  for (std::size_t draw = 0; draw < count; ++draw) {
    std::vector<DrawnNoise> noises;
    for (const model::NoiseReport& noise : fit.noise_by_sense) noises.emplace_back(noise, random);
    model::Observations drawn = data;
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      drawn.reading[k] = fit.predicted[k];
      for (DrawnNoise& noise : noises)
        if (noise.is_of(data.axis[k], data.sense[k]))
          drawn.reading[k] += noise.next(data.time_s.empty() ? static_cast<double>(k) : data.time_s[k]);
    }
    auto one = model::fit(model, drawn);
    if (!one) continue;
    for (std::size_t i = 0; i < one->effects.size(); ++i)
      if (model::EffectInstance& effect = one->effects[i].effect; const auto targets = targets_about(effect, data))
        effect.fitted[std::string(effect.definition().searched_parameter())] =
            std::lerp((*targets)[0], (*targets)[1], between.share(i, draw));
    again.push_back(std::move(*one));
  }
  return again;
}

}  // namespace ecs::commissioning
