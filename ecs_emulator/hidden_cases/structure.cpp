#include "ecs_emulator/hidden_cases/structure.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "base/units.hpp"
#include "ecs_emulator/random/draw.hpp"

namespace ecs::emulator {
namespace {

constexpr std::array<const char*, 3> kPositionNames{"x_mm", "y_mm", "z_mm"};

/// The line that structure is put on: one axis, one sense.
struct Place {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  double from_mm = 0.0;
  double to_mm = 1.0;
  std::size_t targets = 0;
  int runs = 1;
  double duration_s = 0.0;
  [[nodiscard]] double part(double p_mm) const { return (p_mm - from_mm) / (to_mm - from_mm); }
  [[nodiscard]] std::string position() const { return kPositionNames[index_of(axis)]; }
};

Place place_in(Random& random, const Scene& scene, const Ground& ground) {
  Place place;
  place.sense = one(random, ground.senses);
  for (const Axis a : kAllAxes)
    if (ground.cover(place.sense, a).moved) place.axis = a;
  const auto& places = ground.cover(place.sense, place.axis).places_mm;
  place.from_mm = places.front();
  place.to_mm = places.back();
  place.targets = places.size();
  for (const Stop& stop : scene.stops) place.runs = std::max(place.runs, stop.run);
  place.duration_s = scene.stops.back().time_s;
  return place;
}

class Drawing {
 public:
  Drawing(Random& random, const Scene& scene, const Ground& ground)
      : random_(random), scene_(scene), ground_(ground), at_(place_in(random, scene, ground)) {}

  Structure of(StructureKind kind) {
    const double t = at_.duration_s;
    switch (kind) {
      case StructureKind::bad_run: {
        if (at_.runs < 3) return {};
        const int bad = whole(random_, 1, at_.runs);
        const double tilt = chance(random_, 0.3) ? between(random_, -1.5, 1.5) : 0.0;
        return with({"run", "time_s"}, "one run differs from all others",
                    [=, this](const Stop& s) { return s.run == bad ? 1.0 + tilt * part(s) : 0.0; });
      }
      case StructureKind::bad_pass: {
        if (at_.runs < 3) return {};
        const int bad = whole(random_, 1, at_.runs);
        const int way = chance(random_, 0.5) ? 1 : -1;
        return with({"run", "approach", "time_s"}, "the axis stuck in one direction of one run",
                    [=](const Stop& s) { return s.run == bad && s.approach == way ? 1.0 : 0.0; });
      }
      case StructureKind::wander: {
        const double period_s = t / between(random_, 1.4, 2.6);
        const double phase = between(random_, 0.0, kTurn);
        return with({"time_s", "run"}, "the zero wanders with the time of day, over more than one run",
                    [=](const Stop& s) { return std::sin(kTurn * s.time_s / period_s + phase); });
      }
      case StructureKind::bumped_optics: {
        const double when_s = t * between(random_, 0.2, 0.8);
        return with({"time_s", "run"}, "somebody bumped the optics: a jump at a moment of time",
                    [=](const Stop& s) { return s.time_s > when_s ? 1.0 : 0.0; });
      }
      case StructureKind::random_runs: {
        if (at_.runs < 5) return {};
        const auto walk = per_run();
        return with({"run", "time_s"}, "the zero walks at random from run to run",
                    [=](const Stop& s) { return walk.at(s.run); });
      }
      case StructureKind::run_slopes: {
        if (at_.runs < 4) return {};
        const auto slopes = per_run();
        return with({"run", "time_s", at_.position()}, "every run has a scale of its own",
                    [=, this](const Stop& s) { return slopes.at(s.run) * (part(s) - 0.5); });
      }
      default:
        return of_sensors(kind);
    }
  }

 private:
  using Value = std::function<double(const Stop&)>;

  Structure of_sensors(StructureKind kind) {
    switch (kind) {
      case StructureKind::squared_temperature: {
        const auto sensor = a_sensor();
        if (!sensor) return {};
        const double middle = mean([&](const Stop& s) { return s.weather.degC[*sensor]; });
        return with({scene_.sensors[*sensor], "time_s", "run"}, "an error that grows with the square of a temperature",
                    [=](const Stop& s) { return std::pow(s.weather.degC[*sensor] - middle, 2); });
      }
      case StructureKind::humidity:
        if (!scene_.shown.air) return {};
        return with({"humidity_pct", "time_s", "run"}, "an error that follows the humidity",
                    [](const Stop& s) { return 0.2 * (s.weather.humidity_pct - 50.0); });
      case StructureKind::warm_backlash: {
        const auto sensor = a_sensor();
        if (!sensor) return {};
        const double middle = mean([&](const Stop& s) { return s.weather.degC[*sensor]; });
        return with({"approach", scene_.sensors[*sensor], "time_s", "run"}, "lost motion that changes with temperature",
                    [=](const Stop& s) { return s.approach * (s.weather.degC[*sensor] - middle); });
      }
      case StructureKind::growing_backlash: {
        const double t = at_.duration_s;
        return with({"approach", "time_s", "run"}, "lost motion that grows with time",
                    [=](const Stop& s) { return s.approach * (s.time_s / t - 0.5); });
      }
      case StructureKind::squared_feed:
        return with({"feed_mm_min", "run", "time_s"}, "an error that goes with the square of the feed",
                    [](const Stop& s) { return std::pow(s.feed_mm_min / 4000.0, 2); });
      case StructureKind::squared_load:
        return with({"load_kg", "run", "time_s"}, "an error that bends with the load",
                    [](const Stop& s) { return std::pow((s.load_kg - 300.0) / 200.0, 2); });
      default:
        return of_position(kind);
    }
  }

  Structure of_position(StructureKind kind) {
    const double step = 1.0 / static_cast<double>(at_.targets);
    switch (kind) {
      case StructureKind::product:
        return product();
      case StructureKind::chirp: {
        if (at_.targets < 40) return {};
        const double most = static_cast<double>(at_.targets) / 3.5;
        const double few = between(random_, 0.25, 0.5) * most;
        const double phase = between(random_, 0.0, kTurn);
        return with({at_.position()}, "a wave whose period changes along the axis", [=, this](const Stop& s) {
          const double x = part(s);
          return std::sin(kTurn * (few * x + 0.5 * (most - few) * x * x) + phase);
        });
      }
      case StructureKind::burst: {
        if (at_.targets < 30) return {};
        const double centre = between(random_, 0.25, 0.75);
        const double width = between(random_, 3.0, 5.0) * step;
        const double wave = between(random_, 3.0, 4.5) * step;
        const double phase = between(random_, 0.0, kTurn);
        return with({at_.position()}, "ripples at one place of the travel", [=, this](const Stop& s) {
          const double u = part(s) - centre;
          return std::exp(-0.5 * u * u / (width * width)) * std::sin(kTurn * u / wave + phase);
        });
      }
      case StructureKind::dent: {
        if (at_.targets < 20) return {};
        const double centre = between(random_, 0.2, 0.8);
        const double width = between(random_, 1.0, 1.8) * step;
        return with({at_.position()}, "a bump at one place of the travel", [=, this](const Stop& s) {
          const double u = (part(s) - centre) / width;
          return std::exp(-0.5 * u * u);
        });
      }
      case StructureKind::graduation: {
        if (at_.runs < 3 || at_.targets < 14) return {};
        std::map<double, double> marks;
        for (const double p : ground_.cover(at_.sense, at_.axis).places_mm) marks[p] = random_.normal();
        return with({at_.position()}, "every line of the scale is off by an amount of its own",
                    [=, this](const Stop& s) { return marks.at(scene_.p_mm(s, at_.axis)); });
      }
      default:
        return {};
    }
  }

  /// Curved along both of two axes: no rotation of a rigid carriage does that.
  Structure product() {
    for (const Axis other : kAllAxes) {
      const auto& places = ground_.cover(at_.sense, other).places_mm;
      if (other == at_.axis || places.size() < 4) continue;
      const double from = places.front();
      const double span = places.back() - from;
      const double a = between(random_, 0.8, 1.2);
      const double b = between(random_, 0.8, 1.2);
      return with({at_.position(), kPositionNames[index_of(other)]},
                  "an error curved along two axes at once, as no rigid body moves", [=, this](const Stop& s) {
                    const double y = (scene_.p_mm(s, other) - from) / span;
                    return std::cos(kTurn * a * part(s)) * std::cos(kTurn * b * y);
                  });
    }
    return {};
  }

  Structure with(std::vector<std::string> variables, std::string text, const Value& value) {
    Structure s;
    for (const Stop& stop : scene_.stops) s.value.push_back(stop.sense == at_.sense ? value(stop) : 0.0);
    s.text = std::move(text);
    for (std::string& name : variables) {
      const bool shown = (name != "time_s" || scene_.shown.time) && (name != "run" || scene_.shown.run);
      if (shown) s.variables.push_back(std::move(name));
    }
    return s;
  }

  [[nodiscard]] double part(const Stop& stop) const { return at_.part(scene_.p_mm(stop, at_.axis)); }
  [[nodiscard]] std::map<int, double> per_run() {
    std::map<int, double> values;
    for (int run = 1; run <= at_.runs; ++run) values[run] = random_.normal();
    return values;
  }
  [[nodiscard]] std::optional<std::size_t> a_sensor() {
    if (scene_.sensors.size() < 2) return std::nullopt;
    return static_cast<std::size_t>(whole(random_, 1, static_cast<int>(scene_.sensors.size()) - 1));
  }
  [[nodiscard]] double mean(const Value& value) const {
    double sum = 0.0;
    for (const Stop& stop : scene_.stops) sum += value(stop);
    return sum / static_cast<double>(scene_.stops.size());
  }

  Random& random_;
  const Scene& scene_;
  const Ground& ground_;
  Place at_;
};

}  // namespace

Needs needs_of(StructureKind kind) {
  Needs n;
  n.least_runs = 3;
  switch (kind) {
    case StructureKind::random_runs:
    case StructureKind::run_slopes:
      n.least_runs = 5;
      [[fallthrough]];
    case StructureKind::bad_run:
      n.time = n.whole_runs = true;
      break;
    case StructureKind::bad_pass:
      n.time = n.whole_runs = n.bidirectional = true;
      break;
    case StructureKind::wander:
    case StructureKind::bumped_optics:
      n.least_runs = 5;
      n.time = true;
      break;
    case StructureKind::squared_temperature:
      n.temperature = n.time = true;
      n.least_runs = 5;
      break;
    case StructureKind::humidity:
      n.air = n.time = true;
      n.least_runs = 5;
      break;
    case StructureKind::warm_backlash:
      n.temperature = n.time = n.bidirectional = true;
      break;
    case StructureKind::growing_backlash:
      n.time = n.bidirectional = true;
      break;
    case StructureKind::product:
      n.grid = n.translations = true;
      n.least_axes = 2;
      n.least_runs = 1;
      break;
    case StructureKind::squared_feed:
      n.feeds = true;
      break;
    case StructureKind::squared_load:
      n.loads = true;
      n.least_runs = 4;
      break;
    default:
      n.whole_runs = true;
      break;
  }
  return n;
}

Structure draw_structure(Random& random, const Scene& scene, const Ground& ground, StructureKind kind) {
  return Drawing(random, scene, ground).of(kind);
}

}  // namespace ecs::emulator
