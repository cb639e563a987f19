// Structure that no library effect explains, and bad runs.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "bench/foreign/case.hpp"

namespace foreign {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

struct Walker {
  Random& random;
  double value = 0.0;
  double next() { return value += random.normal(); }
};

// What a structure may use: own coordinate brought to 0 … 1, time brought to 0 … 1.
class Shape {
 public:
  explicit Shape(const Setup& setup) : setup_(setup), axis_(setup.readings.front().axis) {
    low_ = high_ = setup.readings.front().at_mm[index_of(axis_)];
    for (const Reading& reading : setup.readings) {
      low_ = std::min(low_, reading.at_mm[index_of(axis_)]);
      high_ = std::max(high_, reading.at_mm[index_of(axis_)]);
      runs_ = std::max(runs_, reading.run);
    }
    start_s_ = setup.readings.front().time_s;
    end_s_ = setup.readings.back().time_s;
  }
  [[nodiscard]] double u(const Reading& reading) const { return (reading.at_mm[index_of(axis_)] - low_) / span(); }
  [[nodiscard]] double t(const Reading& reading) const { return (reading.time_s - start_s_) / (end_s_ - start_s_); }
  [[nodiscard]] double span() const { return high_ - low_; }
  [[nodiscard]] double session_s() const { return end_s_ - start_s_; }
  [[nodiscard]] int runs() const { return runs_; }
  template <class F>
  [[nodiscard]] Column over(F&& f) const {
    Column values;
    for (const Reading& reading : setup_.readings) values.push_back(f(reading));
    return values;
  }

 private:
  const Setup& setup_;
  char axis_;
  double low_ = 0.0;
  double high_ = 0.0;
  double start_s_ = 0.0;
  double end_s_ = 0.0;
  int runs_ = 1;
};

double sawtooth(double x) { return 2.0 * (x - std::floor(x)) - 1.0; }

// A value for each target, drawn once.
Column by_target(const Shape& shape, Random& random, bool walk, int only_approach) {
  std::map<double, double> value_at;
  std::vector<double> places = shape.over([&](const Reading& reading) { return shape.u(reading); });
  std::sort(places.begin(), places.end());
  double value = 0.0;
  for (const double place : places)
    if (!value_at.contains(place)) {
      value = walk ? value + random.normal() : random.normal();
      value_at[place] = value;
    }
  return shape.over([&](const Reading& reading) {
    return only_approach == 0 || reading.approach == only_approach ? value_at[shape.u(reading)] : 0.0;
  });
}

}  // namespace

int outside_kinds() { return 20; }

Structure draw_outside(Random& random, const Setup& setup, int kind) {
  const Shape shape(setup);
  const double phase = random.between(0.0, kTurn);
  const double waves = random.between(3.0, 7.0);
  const double place = random.between(0.3, 0.7);
  const auto wave = [&](double u) { return std::sin(kTurn * waves * u + phase); };
  const auto over = [&](auto&& f) { return shape.over(f); };
  const auto zones = [&](int count) {
    std::vector<double> values;
    for (int k = 0; k < count; ++k) values.push_back(random.normal());
    return values;
  };
  Walker walker{random};
  switch (kind) {
    case 0:
      return {"chirp", over([&](const Reading& r) {
                return std::sin(kTurn * (2.0 * shape.u(r) + waves * std::pow(shape.u(r), 2)) + phase);
              })};
    case 1:
      return {"amplitude-modulated wave",
              over([&](const Reading& r) { return wave(shape.u(r)) * std::sin(kTurn * 0.9 * shape.u(r) + place); })};
    case 2:
      return {"random walk over targets", by_target(shape, random, true, 0)};
    case 3: {
      const double every = shape.session_s() / 60.0;
      std::vector<double> path;
      for (int k = 0; k < 63; ++k) path.push_back(walker.next());
      return {"random walk over time", over([&](const Reading& r) {
                const double at = shape.t(r) * shape.session_s() / every;
                const auto k = static_cast<std::size_t>(at);
                return std::lerp(path[k], path[k + 1], at - std::floor(at));
              })};
    }
    case 4:
      return {"square wave", over([&](const Reading& r) { return wave(shape.u(r)) > 0.0 ? 1.0 : -1.0; })};
    case 5:
      return {"sawtooth", over([&](const Reading& r) { return sawtooth(waves * shape.u(r) + place); })};
    case 6: {
      const std::vector<double> nodes = zones(16);
      return {"straight pieces with kinks", over([&](const Reading& r) {
                const double at = 14.999 * shape.u(r);
                const auto k = static_cast<std::size_t>(at);
                return std::lerp(nodes[k], nodes[k + 1], at - std::floor(at));
              })};
    }
    case 7: {
      const std::vector<double> plays = zones(12);
      return {"play that jumps from zone to zone", over([&](const Reading& r) {
                return r.approach * plays[static_cast<std::size_t>(11.999 * shape.u(r))];
              })};
    }
    case 8:
      return {"wave that grows with time", over([&](const Reading& r) { return wave(shape.u(r)) * shape.t(r); })};
    case 9: {
      const int run = random.whole(1, shape.runs());
      return {"burst in one run", over([&](const Reading& r) {
                return r.run == run && std::abs(shape.u(r) - place) < 0.12 ? std::cos(40.0 * shape.u(r)) : 0.0;
              })};
    }
    case 10:
      return {"two waves that beat",
              over([&](const Reading& r) { return wave(shape.u(r)) + std::sin(kTurn * (waves + 0.7) * shape.u(r)); })};
    case 11:
      return {"four unrelated waves", over([&](const Reading& r) {
                const double u = shape.u(r);
                return wave(u) + std::sin(kTurn * waves * 1.37 * u) + std::sin(kTurn * waves * 0.73 * u + 1.0) +
                       std::sin(kTurn * waves * 1.83 * u + 2.0);
              })};
    case 12:
      return {"narrow bump", over([&](const Reading& r) {
                return std::exp(-0.5 * std::pow((shape.u(r) - place) / 0.04, 2)) -
                       0.8 * std::exp(-0.5 * std::pow((shape.u(r) - place + 0.2) / 0.03, 2));
              })};
    case 13:
      return {"period that jumps", over([&](const Reading& r) {
                const double u = shape.u(r);
                return std::sin(kTurn * (u < place ? waves : 1.9 * waves) * (u - place) + phase);
              })};
    case 14: {
      const double cycles = std::max(4.0, shape.session_s() / random.between(240.0, 900.0));
      return {"wave in time", over([&](const Reading& r) { return std::sin(kTurn * cycles * shape.t(r) + phase); })};
    }
    case 15: {
      const auto middle = setup.readings[setup.readings.size() / 2].run;
      return {"jump in the middle of a run", over([&](const Reading& r) {
                const bool late = r.run > middle || (r.run == middle && shape.u(r) > place);
                return late ? 1.0 : r.run == middle ? 0.0 : -1.0;
              })};
    }
    case 16:
      return {"wave that dies along the travel",
              over([&](const Reading& r) { return wave(shape.u(r)) * std::exp(-5.0 * shape.u(r)); })};
    case 17:
      return {"random values at targets, forward only", by_target(shape, random, false, 1)};
    case 18:
      return {"wave whose phase drifts with time", over([&](const Reading& r) {
                return std::sin(kTurn * (waves * shape.u(r) + 1.3 * shape.t(r)) + phase);
              })};
    default:
      return {"random values at targets", by_target(shape, random, false, 0)};
  }
}

Structure draw_bad_run(Random& random, const Setup& setup) {
  const Shape shape(setup);
  const int run = random.whole(1, shape.runs());
  const int kind = random.whole(0, 2);
  const double turn_at = random.between(0.3, 0.7);
  const char* names[] = {"offset of one run", "one run rotated", "one run noisy"};
  Random* source = &random;
  return {names[kind], shape.over([&](const Reading& r) {
            if (r.run != run) return 0.0;
            if (kind == 0) return 1.0;
            return kind == 1 ? shape.u(r) - turn_at : source->normal();
          })};
}

}  // namespace foreign
