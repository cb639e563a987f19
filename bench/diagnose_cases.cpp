#include "diagnose_cases.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <Eigen/Dense>
#include <fmt/format.h>

namespace ecs::bench {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using laser::Reading;
using model::EffectId;

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed * 7919 + 13) {}
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  bool chance(double p) { return between(0.0, 1.0) < p; }
  double normal() { return std::normal_distribution<double>()(random_); }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }
  template <class T>
  const T& one_of(const std::vector<T>& list) {
    return list[static_cast<std::size_t>(whole(0, static_cast<int>(list.size()) - 1))];
  }

 private:
  std::mt19937_64 random_;
};

/// One line as it is measured.
struct Line {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Vector3 parked{};
  std::vector<double> targets;
};

/// The workshop: where and under which conditions readings are taken.
struct Shop {
  params::Machine machine;
  std::vector<Line> lines;
  int runs = 3;
  bool time = true;
  bool sensors = true;
  bool air = true;
  bool feeds = true;
  bool loads = false;
  bool spikes = false;  ///< travel since reversal recorded
  bool map = false;
  double dwell_s = 8.0;
};

params::Machine a_machine(Dice& dice) {
  params::Machine machine;
  machine.name = "bench";
  machine.configuration = dice.one_of<std::string>({"TXYZ", "XTYZ", "XYTZ", "XYZT"});
  for (const Axis a : kAllAxes) {
    params::MachineAxis axis;
    const double travel = dice.between(400.0, 3000.0);
    const bool negative = dice.chance(0.4);
    axis.travel_mm = {negative ? -travel : 0.0, negative ? 0.0 : travel};
    axis.screw_pitch_mm = dice.one_of<double>({5.0, 8.0, 10.0, 12.0, 20.0});
    axis.scale_pitch_mm = dice.one_of<double>({0.02, 0.04, 0.1});
    for (const Axis other : kAllAxes)
      if (other != a) axis.measurement_line_mm[index_of(other)] = 0.0;
    machine.axes[index_of(a)] = axis;
  }
  return machine;
}

std::vector<double> targets(Dice& dice, const params::MachineAxis& axis, int count) {
  std::vector<double> list;
  const bool uneven = dice.chance(0.6);
  const double step = (axis.travel_mm[1] - axis.travel_mm[0]) / count;
  for (int i = 0; i < count; ++i) {
    const double shift = uneven ? dice.between(-0.35, 0.35) : 0.0;
    list.push_back(std::round((axis.travel_mm[0] + (i + 0.5 + shift) * step) * 100.0) / 100.0);
  }
  return list;
}

Shop a_shop(Dice& dice) {
  Shop shop;
  shop.machine = a_machine(dice);
  shop.runs = dice.whole(2, 5);
  shop.dwell_s = dice.between(4.0, 20.0);
  const int kind = dice.whole(0, 3);
  const auto line = [&](Axis axis, Sense sense, Vector3 parked, int count) {
    shop.lines.push_back({axis, sense, parked, targets(dice, *shop.machine.axes[index_of(axis)], count)});
  };
  const Axis axis = static_cast<Axis>(dice.whole(0, 2));
  if (kind <= 1) {  // one line
    const Sense sense = kind == 0 ? static_cast<Sense>(axis) : static_cast<Sense>(dice.whole(0, 2));
    line(axis, sense, {}, dice.whole(20, 70));
  } else {  // several senses, several parallel lines: a volume
    for (const Axis moving : kAllAxes)
      for (int parallel = 0; parallel < 2; ++parallel) {
        Vector3 parked{};
        for (const Axis other : kAllAxes) {
          const auto& travel = shop.machine.axes[index_of(other)]->travel_mm;
          if (other != moving) parked[index_of(other)] = std::round(dice.between(travel[0], travel[1]));
        }
        for (const Axis direction : kAllAxes)
          if (direction == moving || dice.chance(0.5))
            line(moving, static_cast<Sense>(direction), parked, dice.whole(12, 20));
      }
    shop.runs = 2;
  }
  shop.loads = dice.chance(0.4);
  shop.spikes = dice.chance(0.4);
  return shop;
}

laser::MeasurementSet readings_of(Shop& shop, Dice& dice) {
  laser::MeasurementSet set;
  double t = 0.0;
  const double warm = dice.between(1.0, 5.0), tau = dice.between(1500.0, 6000.0), day = dice.between(0.5, 2.0);
  const double phase = dice.between(0.0, 6.0), pressure = dice.between(980.0, 1030.0),
               falling = dice.between(-2.0, 2.0);
  const std::vector<double> feeds{1000.0, 3000.0};
  for (int run = 1; run <= shop.runs; ++run) {
    for (const Line& line : shop.lines) {
      for (const int d : {1, -1}) {
        std::vector<double> order = line.targets;
        if (d < 0) std::reverse(order.begin(), order.end());
        double travelled = 5.0;
        double before = order.front();
        for (const double target : order) {
          Reading r;
          r.axis = line.axis;
          r.sense = line.sense;
          r.position_mm = line.parked;
          r.position_mm[index_of(line.axis)] = target;
          r.approach = static_cast<Approach>(d);
          r.run = run;
          t += shop.dwell_s * dice.between(0.9, 1.1);
          travelled += std::abs(target - before);
          before = target;
          if (shop.time) r.time_s = t;
          const double spindle = 20.0 + warm * (1.0 - std::exp(-t / tau)),
                       air = 20.5 + day * std::sin(t / 5000.0 + phase);
          if (shop.sensors) {
            r.sensors_degC["t_material_degC"] =
                20.3 + 0.5 * day * std::sin(t / 9000.0 + 2.0 * phase) + 0.02 * dice.normal();
            r.sensors_degC["t_spindle_degC"] = spindle + 0.02 * dice.normal();
            r.sensors_degC["t_air_degC"] = air + 0.02 * dice.normal();
          }
          if (shop.air) {
            r.pressure_hPa = pressure + falling * t / 3600.0 + 0.02 * dice.normal();
            r.humidity_pct = 45.0 + 3.0 * std::sin(t / 4000.0);
          }
          if (shop.feeds) r.feed_mm_min = feeds[static_cast<std::size_t>(run % 2)];
          if (shop.loads) r.load_kg = run % 2 == 0 ? 800.0 : 0.0;
          if (shop.spikes) r.travel_since_reversal_mm = travelled;
          set.readings.push_back(r);
        }
        t += 30.0;
      }
    }
    t += dice.between(120.0, 900.0);
  }
  for (std::size_t k = 0; k < set.readings.size(); ++k) set.readings[k].row = static_cast<int>(k) + 1;
  return set;
}

/// A smooth curve: natural cubic through random knots, or a few low waves.
std::function<double(double)> smooth_curve(Dice& dice, double low, double high) {
  const int waves = dice.whole(2, 4);
  std::vector<std::array<double, 3>> parts;
  for (int i = 1; i <= waves; ++i)
    parts.push_back({dice.normal() / i, dice.between(0.4, 0.9) * i, dice.between(0.0, 6.28)});
  return [=](double p) {
    double sum = 0.0;
    for (const auto& [a, f, phase] : parts)
      sum += a * std::sin(2.0 * std::numbers::pi * f * (p - low) / (high - low) + phase);
    return sum;
  };
}

/// Mean and slope over the readings removed (rows of the line's own motion).
VectorXd levelled(const laser::MeasurementSet& set, Axis axis, Sense sense, const std::function<double(double)>& f) {
  double n = 0, sp = 0, spp = 0, sf = 0, spf = 0;
  for (const Reading& r : set.readings) {
    if (r.axis != axis || r.sense != sense) continue;
    const double p = r.position_mm[index_of(axis)], v = f(p);
    n += 1;
    sp += p;
    spp += p * p;
    sf += v;
    spf += p * v;
  }
  const double slope = (spf - sp * sf / n) / (spp - sp * sp / n), mean = (sf - slope * sp) / n;
  VectorXd out = VectorXd::Zero(static_cast<Index>(set.readings.size()));
  for (std::size_t k = 0; k < set.readings.size(); ++k) {
    const Reading& r = set.readings[k];
    if (r.sense != sense) continue;
    const double p = r.position_mm[index_of(axis)];
    out(static_cast<Index>(k)) = f(p) - mean - slope * p;
  }
  return out;
}

/// A hidden effect: name, contribution per unit size, and its parameter.
struct Hidden {
  std::string name;
  VectorXd shape;
  std::string parameter;
  double scale = 1.0;  ///< parameter per unit size
  bool fixed_size = false;
};

struct Context {
  Shop& shop;
  laser::MeasurementSet& set;
  Dice& dice;
  model::Model& model;
};

double p_of(const Reading& r, Axis a) { return r.position_mm[index_of(a)]; }  // data are at 0 in every machine here

double edlen_ppm(double t, double p, double h) {  // simplified, good enough to differ a little from any exact formula
  return -0.953 * (t - 20.0) + 0.2685 * (p - 1013.25) - 0.0086 * (h - 50.0) - 0.0009 * (t - 20.0) * (p - 1013.25);
}

VectorXd shape_of(const Context& c, const std::function<double(const Reading&)>& f) {
  VectorXd out(static_cast<Index>(c.set.readings.size()));
  for (std::size_t k = 0; k < c.set.readings.size(); ++k) out(static_cast<Index>(k)) = f(c.set.readings[k]);
  return out;
}

double lever_m(const params::Machine& machine, const Reading& r, Component code) {
  const auto chain = params::chain_of(machine);
  const auto table = terms_of(*chain, Convention::iso, CurveKind::carriage);
  double sum = 0.0;
  for (const Term& term : *table)
    if (term.component == code && term.has_lever && term.uses_coordinate &&
        index_of(term.observed) == static_cast<std::size_t>(r.sense))
      sum += term.sign * r.position_mm[index_of(term.lever)] / 1000.0;
  return sum;
}

std::optional<Hidden> hidden(const Context& c, EffectId id) {
  Dice& dice = c.dice;
  const Line& line = dice.one_of(c.shop.lines);
  const Axis a = line.axis;
  const Sense s = line.sense;
  const auto& travel = c.shop.machine.axes[index_of(a)]->travel_mm;
  const double low = travel[0], high = travel[1], length = high - low;
  const std::string place = fmt::format(":{}:{}", letter_of(a), name_of(s));
  const auto natural = [&] {
    const bool own = std::any_of(c.shop.lines.begin(), c.shop.lines.end(), [&](const Line& l) {
      return l.sense == s && static_cast<std::size_t>(l.axis) == static_cast<std::size_t>(s);
    });
    return fmt::format(":{}:{}", own ? static_cast<char>('X' + static_cast<int>(s)) : letter_of(a), name_of(s));
  };
  const auto of_sense = [&](const std::function<double(const Reading&)>& f) {
    return shape_of(c, [&](const Reading& r) { return r.sense == s ? f(r) : 0.0; });
  };
  const auto own = [&](const Reading& r) { return r.sense == s && r.axis == a && r.approach != Approach::unknown; };
  const auto d = [](const Reading& r) { return static_cast<double>(static_cast<int>(r.approach)); };
  switch (id) {
    case EffectId::scale:
      return Hidden{"scale" + place, of_sense([&](const Reading& r) { return p_of(r, a) / 1000.0; }), "um_per_m"};
    case EffectId::progressive:
      return Hidden{"progressive" + place, levelled(c.set, a, s, smooth_curve(dice, low, high)), ""};
    case EffectId::cyclic: {
      const auto& axis = *c.shop.machine.axes[index_of(a)];
      const double step = length / static_cast<double>(line.targets.size());
      double period = dice.chance(0.5) ? *axis.screw_pitch_mm * dice.one_of<double>({0.5, 1.0, 2.0})
                                       : dice.between(2.2, 8.0) * step;
      period = std::max(period, 0.5);
      const double phase = dice.between(0.0, 6.28), second = dice.chance(0.3) ? dice.between(0.2, 0.6) : 0.0,
                   phase2 = dice.between(0.0, 6.28);
      const int mode = dice.whole(0, 3);
      return Hidden{"cyclic" + place, of_sense([&](const Reading& r) {
                      if (mode >= 2 && (!own(r) || (d(r) > 0) != (mode == 2))) return 0.0;
                      const double angle = 2.0 * std::numbers::pi * p_of(r, a) / period;
                      return std::sin(angle + phase) + second * std::sin(2.0 * angle + phase2);
                    }),
                    ""};
    }
    case EffectId::backlash:
      return Hidden{"backlash" + place, shape_of(c, [&](const Reading& r) { return own(r) ? 0.5 * d(r) : 0.0; }), "um"};
    case EffectId::reversal_curve: {
      const auto f = smooth_curve(dice, low, high);
      VectorXd shape = levelled(c.set, a, s, f);
      for (std::size_t k = 0; k < c.set.readings.size(); ++k) {
        const Reading& r = c.set.readings[k];
        shape(static_cast<Index>(k)) *= own(r) ? 0.5 * d(r) : 0.0;
      }
      return Hidden{"reversal_curve" + place, shape, ""};
    }
    case EffectId::step: {
      const double place_mm = low + length * dice.between(0.2, 0.8);
      return Hidden{"step" + place, of_sense([&](const Reading& r) { return p_of(r, a) > place_mm ? 1.0 : 0.0; }),
                    "height_um"};
    }
    case EffectId::sag: {
      const double cubic = dice.chance(0.5) ? dice.between(-1.0, 1.0) : 0.0;
      return Hidden{"sag" + place, of_sense([&](const Reading& r) {
                      const double e = std::abs(p_of(r, a)) / 1000.0;
                      return e * e + cubic * e * e * e;
                    }),
                    ""};
    }
    case EffectId::angular: {
      const Component code = curve_of(static_cast<Sense>(dice.whole(3, 5)), a);
      const auto f = smooth_curve(dice, low, high);
      const double slope = dice.normal();
      return Hidden{fmt::format("angular:{}:{}", letter_of(a), name_of(code)),
                    shape_of(c,
                             [&](const Reading& r) {
                               if (is_rotation(r.sense)) return 0.0;
                               return lever_m(c.shop.machine, r, code) * (f(p_of(r, a)) + slope * p_of(r, a) / length);
                             }),
                    ""};
    }
    case EffectId::squareness: {
      const Component code = dice.one_of<Component>({Component::C0Y, Component::B0Z, Component::A0Z});
      const char axis = code == Component::C0Y ? 'Y' : 'Z';
      return Hidden{
          fmt::format("squareness:{}:{}", axis, name_of(code)),
          shape_of(c, [&](const Reading& r) { return is_rotation(r.sense) ? 0.0 : lever_m(c.shop.machine, r, code); }),
          "um_per_m"};
    }
    case EffectId::measurement_line: {
      if (is_rotation(s)) return std::nullopt;
      const Component code = curve_of(Sense::EC, a);
      const auto f = smooth_curve(dice, low, high);
      model::KnownComponent known{code, {}, {}};
      for (int i = 0; i <= 40; ++i) {
        known.p_mm.push_back(low + length * i / 40.0);
        known.value.push_back(20.0 * f(known.p_mm.back()) + 10.0 * known.p_mm.back() / length);
      }
      c.model.known.push_back(known);
      return Hidden{"measurement_line" + place, of_sense([&](const Reading& r) {
                      const laser::MapTable table{code, Approach::unknown, known.p_mm, known.value};
                      return laser::compensation_at(table, p_of(r, a)) / 1000.0;
                    }),
                    "lever_mm"};
    }
    case EffectId::thermal_scale:
      return Hidden{"thermal_scale" + place, of_sense([&](const Reading& r) {
                      return p_of(r, a) / 1000.0 * (r.sensors_degC.at("t_material_degC") - 20.0);
                    }),
                    "um_per_m_degC"};
    case EffectId::thermal_drift: {
      const std::string sensor = dice.one_of<std::string>({"t_spindle_degC", "t_air_degC", "t_material_degC"});
      const double first = c.set.readings.front().sensors_degC.at(sensor);
      return Hidden{"thermal_drift" + natural(),
                    of_sense([&](const Reading& r) { return r.sensors_degC.at(sensor) - first; }), "um_per_degC"};
    }
    case EffectId::warm_up: {
      const double last = *c.set.readings.back().time_s, tau = last * dice.between(0.05, 0.4);
      const bool slope = dice.chance(0.4);
      return Hidden{"warm_up" + (slope ? place : natural()), of_sense([&](const Reading& r) {
                      return (1.0 - std::exp(-*r.time_s / tau)) * (slope ? p_of(r, a) / 1000.0 : 1.0);
                    }),
                    ""};
    }
    case EffectId::time_drift:
      return Hidden{"time_drift" + natural(), of_sense([&](const Reading& r) { return *r.time_s / 3600.0; }),
                    "um_per_h"};
    case EffectId::air_refraction: {
      if (static_cast<std::size_t>(s) != index_of(a)) return std::nullopt;
      return Hidden{"air_refraction" + place, of_sense([&](const Reading& r) {
                      return p_of(r, a) / 1000.0 *
                             edlen_ppm(r.sensors_degC.at("t_air_degC"), *r.pressure_hPa, *r.humidity_pct);
                    }),
                    "factor"};
    }
    case EffectId::dead_path: {
      if (static_cast<std::size_t>(s) != index_of(a)) return std::nullopt;
      return Hidden{"dead_path" + place, of_sense([&](const Reading& r) {
                      return edlen_ppm(r.sensors_degC.at("t_air_degC"), *r.pressure_hPa, *r.humidity_pct);
                    }),
                    "length_m"};
    }
    case EffectId::cosine: {
      if (static_cast<std::size_t>(s) != index_of(a)) return std::nullopt;
      return Hidden{"cosine" + place, of_sense([&](const Reading& r) { return -p_of(r, a) / 1000.0; }), ""};
    }
    case EffectId::servo_lag:
      return Hidden{"servo_lag" + place,
                    shape_of(c, [&](const Reading& r) { return own(r) ? *r.feed_mm_min / 1000.0 * d(r) : 0.0; }),
                    "um_per_m_min"};
    case EffectId::load: {
      if (!c.shop.loads) return std::nullopt;
      const bool slope = dice.chance(0.4);
      return Hidden{"load" + (slope ? place : natural()),
                    of_sense([&](const Reading& r) { return *r.load_kg * (slope ? p_of(r, a) / 1000.0 : 1.0); }), ""};
    }
    case EffectId::reversal_spike: {
      if (!c.shop.spikes) return std::nullopt;
      const double u0 = length / static_cast<double>(line.targets.size()) * dice.between(1.0, 4.0);
      return Hidden{
          "reversal_spike" + place,
          shape_of(c,
                   [&](const Reading& r) { return own(r) ? d(r) * std::exp(-*r.travel_since_reversal_mm / u0) : 0.0; }),
          ""};
    }
    case EffectId::map_polarity:
    case EffectId::map_gain:
    case EffectId::map_shift:
    case EffectId::map_direction_swap: {
      const Component code = curve_of(s, a);
      const auto f = smooth_curve(dice, low, high), g = smooth_curve(dice, low, high);
      laser::ErrorMap map;
      for (const Approach approach : {Approach::forward, Approach::reverse}) {
        laser::MapTable table{code, approach, {}, {}};
        for (int i = 0; i <= 60; ++i) {
          const double p = low + length * i / 60.0;
          table.position_mm.push_back(p);
          table.compensation.push_back(8.0 * f(p) + 0.01 * p +
                                       (approach == Approach::forward ? 1.0 : -1.0) * (1.5 + g(p)));
        }
        map.tables.push_back(table);
      }
      const double shift = dice.sign() * length * dice.between(0.02, 0.08);
      c.model.map = map;
      c.model.map_file = "map.csv";
      const auto value = [&](const Reading& r, double by, double way) {
        if (r.axis != a) {
          const double p = p_of(r, a) + by;
          return 0.5 * (laser::compensation_at(map.tables[0], p) + laser::compensation_at(map.tables[1], p));
        }
        return laser::compensation_at(map.tables[d(r) * way > 0 ? 0 : 1], p_of(r, a) + by);
      };
      if (id == EffectId::map_polarity)
        return Hidden{"map_polarity" + place, of_sense([&](const Reading& r) { return -2.0 * value(r, 0.0, 1.0); }), "",
                      1.0, true};
      if (id == EffectId::map_gain)
        return Hidden{"map_gain" + place, of_sense([&](const Reading& r) { return value(r, 0.0, 1.0); }), "gain"};
      if (id == EffectId::map_shift)
        return Hidden{"map_shift" + place,
                      of_sense([&](const Reading& r) { return value(r, shift, 1.0) - value(r, 0.0, 1.0); }), "", 1.0,
                      true};
      return Hidden{"map_direction_swap" + place, of_sense([&](const Reading& r) {
                      return r.axis == a ? value(r, 0.0, -1.0) - value(r, 0.0, 1.0) : 0.0;
                    }),
                    "", 1.0, true};
    }
    default:
      return std::nullopt;
  }
}

/// Structure that no effect of the library makes.
Hidden foreign(const Context& c, std::vector<std::string>& variables) {
  Dice& dice = c.dice;
  const Line& line = dice.one_of(c.shop.lines);
  const Axis a = line.axis;
  const Sense s = line.sense;
  const auto& travel = c.shop.machine.axes[index_of(a)]->travel_mm;
  const double low = travel[0], length = travel[1] - travel[0];
  const std::string x = fmt::format("{}_mm", static_cast<char>('x' + static_cast<int>(a)));
  const auto of = [&](const std::function<double(const Reading&)>& f) {
    return shape_of(c, [&](const Reading& r) { return r.sense == s && r.axis == a ? f(r) : 0.0; });
  };
  const auto d = [](const Reading& r) { return static_cast<double>(static_cast<int>(r.approach)); };
  switch (dice.whole(c.shop.runs < 3 ? 2 : 0, 5)) {  // which of two runs is the bad one nobody can say
    case 0: {                                        // one bad run
      const int bad = dice.whole(1, c.shop.runs);
      variables = {"run"};
      return {"bad run", of([&](const Reading& r) { return r.run == bad ? 1.0 : 0.0; }), ""};
    }
    case 1: {  // one run with a shape of its own
      const int bad = dice.whole(1, c.shop.runs);
      const auto f = smooth_curve(dice, low, low + length);
      variables = {"run"};
      return {"strange run", of([&](const Reading& r) { return r.run == bad ? f(p_of(r, a)) : 0.0; }), ""};
    }
    case 2: {  // a sweep: its period changes along the axis
      const double n = dice.between(2.0, 3.0);
      variables = {x};
      return {"sweep", of([&](const Reading& r) {
                const double u = (p_of(r, a) - low) / length;
                return std::sin(2.0 * std::numbers::pi * (n * u + 4.0 * u * u));
              }),
              ""};
    }
    case 3: {  // rough: another value at every target
      std::map<double, double> values;
      for (const double target : line.targets) values[target] = dice.normal();
      variables = {x};
      return {"rough", of([&](const Reading& r) {
                const auto found = values.find(p_of(r, a));
                return found == values.end() ? 0.0 : found->second;
              }),
              ""};
    }
    case 4: {  // rough and different by approach
      std::map<std::pair<double, int>, double> values;
      for (const double target : line.targets)
        for (const int way : {1, -1}) values[{target, way}] = dice.normal();
      variables = {x, "approach"};
      return {"rough by approach", of([&](const Reading& r) {
                const auto found = values.find({p_of(r, a), static_cast<int>(d(r))});
                return found == values.end() ? 0.0 : found->second;
              }),
              ""};
    }
    default: {  // wandering in time, slower than a run
      const double last = *c.set.readings.back().time_s;
      std::vector<std::array<double, 3>> waves;
      const double fastest = 0.8 * c.shop.runs;  // no wave shorter than a run
      for (int i = 0; i < 5; ++i) waves.push_back({dice.normal(), dice.between(0.8, fastest), dice.between(0.0, 6.28)});
      variables = {"time_s", "run"};
      return {"wander", of([&](const Reading& r) {
                double sum = 0.0;
                for (const auto& [amp, f, phase] : waves)
                  sum += amp * std::sin(2.0 * std::numbers::pi * f * *r.time_s / last + phase);
                return sum;
              }),
              ""};
    }
  }
}

/// The base model: what is believed and fitted, with columns of its own arithmetic.
MatrixXd base_model(const Context& c, EffectId avoid, VectorXd& truth) {
  std::vector<VectorXd> columns;
  const auto add = [&](EffectId id, Axis a, Sense s, const VectorXd& column, double size) {
    model::EffectInstance effect;
    effect.id = id;
    effect.axis = a;
    effect.sense = s;
    c.model.effects.push_back(effect);
    columns.push_back(column);
    truth += size * column;
  };
  std::vector<std::pair<Sense, Axis>> seen;
  for (const Line& line : c.shop.lines) {
    const Sense s = line.sense;
    const Axis a = line.axis;
    const bool new_sense = std::none_of(seen.begin(), seen.end(), [&](const auto& x) { return x.first == s; });
    if (std::find(seen.begin(), seen.end(), std::pair{s, a}) != seen.end()) continue;
    seen.emplace_back(s, a);
    if (new_sense)
      add(EffectId::offset, a, s, shape_of(c, [&](const Reading& r) { return r.sense == s ? 1.0 : 0.0; }),
          5.0 * c.dice.normal());
    const bool slope_free = avoid == EffectId::scale || avoid == EffectId::cosine || avoid == EffectId::squareness ||
                            avoid == EffectId::angular;
    if (!slope_free || (avoid == EffectId::angular && static_cast<std::size_t>(s) == index_of(a)))
      add(EffectId::scale, a, s,
          shape_of(c, [&](const Reading& r) { return r.sense == s ? p_of(r, a) / 1000.0 : 0.0; }),
          15.0 * c.dice.normal());
    if (avoid != EffectId::backlash && c.dice.chance(0.7))
      add(EffectId::backlash, a, s,
          shape_of(c,
                   [&](const Reading& r) {
                     return r.sense == s && r.axis == a ? 0.5 * static_cast<double>(static_cast<int>(r.approach)) : 0.0;
                   }),
          4.0 * c.dice.normal());
  }
  MatrixXd all(static_cast<Index>(c.set.readings.size()), static_cast<Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) all.col(static_cast<Index>(j)) = columns[j];
  return all;
}

VectorXd beyond(const MatrixXd& base, const VectorXd& v) {
  if (base.cols() == 0) return v;
  return v - base * Eigen::ColPivHouseholderQR<MatrixXd>(base).solve(v);
}

/// White, turbulent, heavy-tailed, rounded; now and then a gross outlier. Size one before rounding.
VectorXd noise(const laser::MeasurementSet& set, Dice& dice, std::string& words) {
  const int kind = dice.whole(0, 3);
  const double tau = dice.between(5.0, 40.0), share = kind == 1 ? dice.between(0.3, 0.8) : 0.0;
  const bool outliers = dice.chance(0.4);
  words = fmt::format("{}{}",
                      kind == 1   ? fmt::format("turbulence {:.0f} s {:.0f} %", tau, 100.0 * share)
                      : kind == 2 ? "heavy tails"
                                  : "white",
                      outliers ? ", outliers" : "");
  VectorXd out(static_cast<Index>(set.readings.size()));
  double state = dice.normal(), before = 0.0;
  for (std::size_t k = 0; k < set.readings.size(); ++k) {
    const double memory = std::exp(-(*set.readings[k].time_s - before) / tau);
    before = *set.readings[k].time_s;
    state = memory * state + std::sqrt(1.0 - memory * memory) * dice.normal();
    double white = dice.normal();
    if (kind == 2) {  // Student t, 5 degrees of freedom
      double square = 0.0;
      for (int i = 0; i < 5; ++i) square += std::pow(dice.normal(), 2);
      white /= std::sqrt(square / 5.0) * std::sqrt(5.0 / 3.0);
    }
    double value = std::sqrt(1.0 - share) * white + std::sqrt(share) * state;
    if (outliers && dice.chance(0.01)) value += dice.sign() * dice.between(8.0, 30.0);
    out(static_cast<Index>(k)) = value;
  }
  return out;
}

const std::vector<EffectId>& hideable() {
  using enum EffectId;
  static const std::vector<EffectId> list{
      scale,   progressive,    cyclic,         backlash,         reversal_curve, step,
      sag,     angular,        squareness,     measurement_line, thermal_scale,  thermal_drift,
      warm_up, time_drift,     air_refraction, dead_path,        cosine,         servo_lag,
      load,    reversal_spike, map_polarity,   map_gain,         map_shift,      map_direction_swap};
  return list;
}

}  // namespace

Case make_case(CaseKind kind, double snr, std::uint64_t seed) {
  for (std::uint64_t attempt = 0;; ++attempt) {
    Dice dice(seed * 1000 + attempt);
    Case out;
    out.kind = kind;
    Shop shop = a_shop(dice);
    const EffectId first = hideable()[(seed + attempt * 7) % hideable().size()];
    if (first == EffectId::load) shop.loads = true;
    if (first == EffectId::reversal_spike) shop.spikes = true;
    if (kind == CaseKind::confounded) shop.feeds = true;
    out.data = readings_of(shop, dice);
    if (out.data.readings.size() < 100 || out.data.readings.size() > 1500) continue;
    if (kind == CaseKind::confounded) {
      for (Reading& r : out.data.readings) {
        r.feed_mm_min = 2000.0;
        r.sensors_degC["t_material_degC"] = 21.5;
        r.load_kg = std::nullopt;
      }
    }
    out.machine = shop.machine;
    const Context context{shop, out.data, dice, out.model};
    VectorXd readings = VectorXd::Zero(static_cast<Index>(out.data.readings.size()));
    EffectId avoid = kind == CaseKind::single || kind == CaseKind::pair ? first : EffectId::user;
    if (kind == CaseKind::confounded) avoid = seed % 2 == 0 ? EffectId::backlash : EffectId::scale;
    const MatrixXd base = base_model(context, avoid, readings);
    out.truth.noise_um = std::exp(dice.between(std::log(0.05), std::log(2.0)));
    double sigma = out.truth.noise_um;
    bool shortens = false;
    const auto hide = [&](const Hidden& effect) {
      const double size =
          std::sqrt(beyond(base, effect.shape).squaredNorm() / static_cast<double>(effect.shape.size()));
      if (size < 0.03 * std::sqrt(effect.shape.squaredNorm() / static_cast<double>(effect.shape.size())) || size <= 0.0)
        return false;
      double factor = snr * sigma / size * (effect.name.starts_with("cosine") ? 1.0 : dice.sign());
      if (effect.fixed_size) {  // the noise is chosen to fit the effect
        factor = 1.0;
        sigma = out.truth.noise_um = size / snr;
      }
      if (effect.name.starts_with("air_refraction")) {
        factor = dice.between(0.4, 1.5);
        sigma = out.truth.noise_um = factor * size / snr;
      }
      if (effect.name.starts_with("dead_path")) {
        factor = dice.between(0.3, 3.0);
        sigma = out.truth.noise_um = factor * size / snr;
      }
      HiddenEffect truth;
      truth.name = effect.name;
      truth.snr = snr;
      if (!effect.parameter.empty()) {
        truth.parameters[effect.parameter] = factor * effect.scale + (effect.parameter == "gain" ? 1.0 : 0.0);
      }
      shortens = factor < 0.0;
      out.truth.snr = snr;
      if (kind != CaseKind::out_of_library) out.truth.effects.push_back(truth);
      readings += factor * effect.shape;
      return true;
    };
    bool good = true;
    if (kind == CaseKind::single || kind == CaseKind::pair) {
      const auto one = hidden(context, first);
      good = one && hide(*one);
      if (good && kind == CaseKind::pair) {
        const EffectId second = hideable()[static_cast<std::size_t>(dice.whole(0, 19))];
        const bool same = second == first || second == EffectId::load || second == EffectId::reversal_spike ||
                          second == EffectId::air_refraction || second == EffectId::dead_path || second == avoid ||
                          first >= EffectId::map_polarity || first == EffectId::air_refraction ||
                          first == EffectId::dead_path;
        const auto two = same ? std::nullopt : hidden(context, second);
        good = two && hide(*two);
      }
    } else if (kind == CaseKind::out_of_library) {
      const Hidden strange = foreign(context, out.truth.variables);
      good = hide(strange);
      out.name = strange.name;
    } else if (kind == CaseKind::confounded) {
      const auto one = hidden(context, avoid == EffectId::backlash ? EffectId::backlash : EffectId::scale);
      good = one && hide(*one);
      if (good) {
        const std::string place = one->name.substr(one->name.find(':'));
        out.truth.group = avoid == EffectId::backlash
                              ? std::vector<std::string>{"backlash" + place, "servo_lag" + place}
                              : std::vector<std::string>{"scale" + place, "thermal_scale" + place};
        if (avoid == EffectId::scale && shortens && place[1] == place[4]) out.truth.group.push_back("cosine" + place);
      }
    }
    if (!good) continue;
    if (out.name.empty())
      for (const HiddenEffect& effect : out.truth.effects) out.name += (out.name.empty() ? "" : " + ") + effect.name;
    if (out.name.empty()) out.name = "blank";
    const VectorXd scatter = noise(out.data, dice, out.truth.text) * sigma;
    const double resolution = dice.chance(0.5) ? 0.1 * sigma : 0.5 * sigma;
    for (std::size_t k = 0; k < out.data.readings.size(); ++k) {
      const auto i = static_cast<Index>(k);
      out.data.readings[k].error = std::round((readings(i) + scatter(i)) / resolution) * resolution;
    }
    out.truth.true_model_rms_um = std::sqrt(scatter.squaredNorm() / static_cast<double>(scatter.size()));
    return out;
  }
}

}  // namespace ecs::bench
