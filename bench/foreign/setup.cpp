// Machines and measuring programmes, drawn freely within what a workshop does.
#include "bench/foreign/setup.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace foreign {
namespace {

double rounded(double value, double step) { return std::round(value / step) * step; }

AxisFacts draw_axis(Random& random, double longest_mm) {
  AxisFacts axis;
  const double length = rounded(random.between_log(250.0, longest_mm), 10.0);
  switch (random.whole(0, 3)) {
    case 0:
      axis.low_mm = -length;
      break;
    case 1:
      axis.low_mm = -rounded(0.5 * length, 10.0);
      break;
    default:
      break;
  }
  axis.high_mm = axis.low_mm + length;
  axis.datum_mm = random.chance(0.5) ? 0.0 : random.chance(0.5) ? axis.low_mm : axis.high_mm;
  axis.resolution_um = random.pick(std::vector<double>{0.1, 0.5, 1.0});
  if (random.chance(0.6)) axis.screw_pitch_mm = random.pick(std::vector<double>{4, 5, 6, 8, 10, 12, 12.7, 16, 20, 25});
  if (random.chance(0.4)) axis.scale_pitch_mm = random.pick(std::vector<double>{0.02, 0.04, 0.1, 2.0});
  axis.expansion_um_per_m_degC = random.pick(std::vector<double>{8.0, 10.5, 11.5, 11.7, 12.0});
  return axis;
}

Machine draw_machine(Random& random) {
  Machine machine;
  machine.name = "machine " + std::to_string(random.whole(100, 999));
  machine.configuration = random.pick(std::vector<std::string>{"TXYZ", "XTYZ", "XYTZ", "XYZT"});
  for (AxisFacts& axis : machine.axes) axis = draw_axis(random, 4000.0);
  for (AxisFacts& axis : machine.axes) {
    if (!random.chance(0.4)) continue;
    std::array<double, 3> line{};
    for (std::size_t k = 0; k < 3; ++k)
      line[k] = rounded(random.between(machine.axes[k].low_mm, machine.axes[k].high_mm), 10.0);
    axis.measurement_line_mm = line;
  }
  return machine;
}

// A temperature over the session, 0 <= u <= 1.
struct Climate {
  double start = 20.0;
  double rise = 0.0;
  double swing = 0.0;
  double phase = 0.0;
  double cycles = 1.0;
  double rate = 3.0;
  std::vector<double> of_run;  // added, one a run; may be empty

  [[nodiscard]] double at(double u, std::size_t run) const {
    const double smooth = rise * (1.0 - std::exp(-rate * u)) / (1.0 - std::exp(-rate));
    return start + smooth + swing * std::sin(2.0 * std::numbers::pi * cycles * u + phase) +
           (of_run.empty() ? 0.0 : of_run[run]);
  }
};

Climate draw_climate(Random& random, std::size_t runs) {
  Climate climate;
  climate.start = random.between(17.5, 24.0);
  climate.rise = random.signed_between(0.2, 4.0);
  climate.swing = random.between(0.1, 1.2);
  climate.phase = random.between(0.0, 2.0 * std::numbers::pi);
  climate.cycles = random.between(0.6, 2.5);
  climate.rate = random.between_log(0.3, 6.0);
  if (random.chance(0.3))
    for (std::size_t k = 0; k < runs; ++k) climate.of_run.push_back(random.between(-1.5, 1.5));
  return climate;
}

std::vector<double> draw_targets(Random& random, const AxisFacts& axis, int count, bool moved) {
  const double length = axis.high_mm - axis.low_mm;
  const double span = length * random.between(0.6, 0.95);
  const double step = std::max(0.5, rounded(span / (count - 1), span / (count - 1) > 5.0 ? 1.0 : 0.1));
  const double room = std::max(0.0, length - step * (count - 1));
  const double first = axis.low_mm + rounded(room * random.between(0.2, 0.8), 0.5);
  const double share = random.between(0.1, 0.35);
  std::vector<double> targets;
  for (int k = 0; k < count; ++k) {
    const double shift = moved ? share * step * random.between(-1.0, 1.0) : 0.0;
    targets.push_back(rounded(first + step * k + shift, 0.001));
  }
  return targets;
}

struct Pass {
  char axis = 'X';
  std::vector<std::string> senses;
  std::array<double, 3> parked_mm{};
  std::vector<double> targets_mm;
};

// Everything that one run has of its own.
struct RunFacts {
  double feed = 1000.0;
  double load = 0.0;
};

class Clock {
 public:
  Clock(Random& random, double dwell_s, double pause_s) : random_(random), dwell_s_(dwell_s), pause_s_(pause_s) {}
  double next() {
    now_s_ += dwell_s_ * random_.between(0.9, 1.1);
    return rounded(now_s_, 0.1);
  }
  void pause() { now_s_ += pause_s_ * random_.between(0.5, 1.5); }

 private:
  Random& random_;
  double dwell_s_;
  double pause_s_;
  double now_s_ = 0.0;
};

void measure(Setup& setup, Clock& clock, const Pass& pass, int run, bool both, const RunFacts& facts,
             double overrun_mm) {
  const std::size_t own = index_of(pass.axis);
  for (const int approach : both ? std::vector<int>{1, -1} : std::vector<int>{1}) {
    for (std::size_t k = 0; k < pass.targets_mm.size(); ++k) {
      const double p = approach > 0 ? pass.targets_mm[k] : pass.targets_mm[pass.targets_mm.size() - 1 - k];
      const double start = approach > 0 ? pass.targets_mm.front() - overrun_mm : pass.targets_mm.back() + overrun_mm;
      Reading reading;
      reading.axis = pass.axis;
      reading.at_mm = pass.parked_mm;
      reading.at_mm[own] = p;
      reading.approach = approach;
      reading.run = run;
      reading.time_s = clock.next();
      reading.feed_mm_min = facts.feed;
      reading.load_kg = facts.load;
      reading.travel_mm = rounded(std::abs(p - start), 0.001);
      for (const std::string& sense : pass.senses) {
        reading.sense = sense;
        setup.readings.push_back(reading);
      }
    }
  }
}

std::string sense_of(char axis) { return std::string("E") + axis; }

std::array<double, 3> draw_parked(Random& random, const Machine& machine) {
  std::array<double, 3> parked{};
  for (std::size_t k = 0; k < 3; ++k)
    parked[k] = rounded(random.between(machine.axes[k].low_mm, machine.axes[k].high_mm), 5.0);
  return parked;
}

// A lever (which coordinate, which direction) that the yaw or pitch of the moving axis acts through, not its own.
struct LeverLine {
  char axis;
  char lever;
  char sense;
};

const std::vector<LeverLine>& lever_lines() {
  static const std::vector<LeverLine> lines = {{'X', 'Z', 'X'}, {'X', 'Y', 'X'}, {'Y', 'Z', 'X'}, {'X', 'Z', 'Y'},
                                               {'Y', 'Z', 'Y'}, {'X', 'Y', 'Z'}, {'Z', 'Y', 'Z'}, {'Z', 'Y', 'X'},
                                               {'Y', 'X', 'Y'}, {'Z', 'X', 'Z'}, {'Y', 'X', 'Z'}, {'Z', 'X', 'Y'}};
  return lines;
}

std::vector<Pass> draw_passes(Random& random, Setup& setup, const Wishes& wishes, int count) {
  const Machine& machine = setup.machine;
  const auto targets_of = [&](char axis, int points) {
    return draw_targets(random, machine.axes[index_of(axis)], points, setup.moved_targets);
  };
  std::vector<Pass> passes;
  if (wishes.plane) {
    setup.layout = "plane";
    const std::vector<std::pair<char, char>> planes = {{'X', 'Y'}, {'X', 'Z'}, {'Y', 'Z'}};
    const auto [first, second] = random.pick(planes);
    const std::array<double, 3> middle = draw_parked(random, machine);
    for (const auto& [axis, other] : {std::pair{first, second}, std::pair{second, first}}) {
      const int points = random.whole(7, 12);
      const std::vector<double> targets = targets_of(axis, points);
      std::array<double, 3> parked = middle;
      const AxisFacts& across = machine.axes[index_of(other)];
      for (int k = 0; k < 3; ++k) {
        parked[index_of(other)] = rounded(across.low_mm + (across.high_mm - across.low_mm) * (0.1 + 0.4 * k), 5.0);
        passes.push_back({axis, {sense_of(first), sense_of(second)}, parked, targets});
      }
    }
    return passes;
  }
  if (wishes.levers) {
    setup.layout = "levers";
    const LeverLine line = random.pick(lever_lines());
    const std::vector<double> targets = targets_of(line.axis, std::max(8, count / 2));
    std::array<double, 3> parked = draw_parked(random, machine);
    const AxisFacts& across = machine.axes[index_of(line.lever)];
    const int lines = random.whole(2, 3);
    for (int k = 0; k < lines; ++k) {
      parked[index_of(line.lever)] =
          rounded(across.low_mm + (across.high_mm - across.low_mm) * (0.05 + 0.9 * k / (lines - 1)), 5.0);
      passes.push_back({line.axis, {sense_of(line.sense)}, parked, targets});
    }
    return passes;
  }
  setup.layout = "line";
  char axis = random.pick(std::vector<char>{'X', 'Y', 'Z'});
  std::string sense = sense_of(axis);
  if (!wishes.square.empty()) {
    axis = wishes.square == "C0Y" ? 'Y' : 'Z';
    sense = wishes.square == "A0Z" ? "EY" : "EX";
  } else if (wishes.across || (!wishes.along && random.chance(0.4))) {
    while (sense == sense_of(axis)) sense = sense_of(random.pick(std::vector<char>{'X', 'Y', 'Z'}));
  }
  passes.push_back({axis, {sense}, draw_parked(random, machine), targets_of(axis, count)});
  return passes;
}

void add_climates(Random& random, Setup& setup, const Wishes& wishes, std::size_t runs) {
  const double last_s = std::max(1.0, setup.readings.back().time_s);
  std::vector<Climate> climates;
  const auto add = [&](const std::string& name, const Climate& climate) {
    setup.sensors.push_back(name);
    climates.push_back(climate);
  };
  Climate material = draw_climate(random, runs);
  if (wishes.one_temperature) {
    material = {};
    material.start = 20.0 + random.signed_between(1.0, 4.0);
  }
  if (wishes.material || wishes.one_temperature || random.chance(0.25)) add("t_material_degC", material);
  if (setup.air) {
    Climate air = draw_climate(random, runs);
    if (wishes.one_weather) {
      air = {};
      air.start = 20.0 + random.signed_between(2.0, 6.0);
    }
    if (wishes.similar_air) air = material;
    add("t_air_degC", air);
  }
  const std::vector<std::string> names = {"t_spindle_degC", "t_column_degC", "t_bed_degC", "t_oil_degC"};
  const int further = std::max(wishes.sensors, random.chance(0.3) ? random.whole(1, 2) : 0);
  for (int k = 0; k < further; ++k) {
    Climate climate = draw_climate(random, runs);
    if (wishes.ramp && k == 0) {
      climate.swing = 0.0;
      climate.of_run.clear();
      climate.rate = 1e-6;
    }
    add(names[static_cast<std::size_t>(k)], climate);
  }
  Climate pressure = draw_climate(random, runs);
  pressure.start = random.between(940.0, 1030.0);
  Climate humidity = draw_climate(random, runs);
  humidity.start = random.between(30.0, 65.0);
  const bool constant = wishes.one_weather || wishes.similar_air;
  const bool exact = wishes.ramp || wishes.similar_air;  // sensors whose equality is the point are not rounded
  for (Reading& reading : setup.readings) {
    const double u = reading.time_s / last_s;
    const auto run = static_cast<std::size_t>(reading.run - 1);
    for (const Climate& climate : climates)
      reading.sensors_degC.push_back(rounded(climate.at(u, run), exact ? 1e-6 : 0.01));
    if (!setup.air) continue;
    reading.pressure_hPa = rounded(constant ? pressure.start : pressure.at(u, run), 0.01);
    reading.humidity_pct = rounded(constant ? humidity.start : humidity.at(u, run), 0.1);
  }
}

void add_map(Random& random, Setup& setup) {
  const Reading& first = setup.readings.front();
  const AxisFacts& axis = setup.machine.axes[index_of(first.axis)];
  const double length = axis.high_mm - axis.low_mm;
  const double step = rounded(std::max(5.0, length / random.whole(20, 50)), 1.0);
  const bool both = random.chance(0.5);
  const double size = random.between(3.0, 25.0);
  const double waves = random.between(1.5, 6.0);
  const double phase = random.between(0.0, 6.28);
  const double slope = random.between(-1.0, 1.0);
  const double lost_um = random.signed_between(1.0, 8.0);
  MapTable table{first.axis, first.sense, both ? 1 : 0, {}, {}};
  MapTable reverse{first.axis, first.sense, -1, {}, {}};
  double wander = 0.0;
  double apart = 0.0;
  for (double p = axis.low_mm; p <= axis.high_mm + 0.5 * step; p += step) {
    wander += 0.15 * size * random.normal();
    apart += 0.1 * lost_um * random.normal();
    const double u = (p - axis.low_mm) / length;
    const double value = size * (std::sin(6.28 * waves * u + phase) + slope * u) + wander;
    table.p_mm.push_back(p);
    table.value_um.push_back(rounded(value, 0.1));
    reverse.p_mm.push_back(p);
    reverse.value_um.push_back(rounded(value + lost_um + apart, 0.1));
  }
  setup.map.push_back(table);
  if (both) setup.map.push_back(reverse);
}

void add_known(Random& random, Setup& setup) {
  const Reading& first = setup.readings.front();
  const AxisFacts& axis = setup.machine.axes[index_of(first.axis)];
  Known known;
  std::string other;
  do {
    other = random.pick(std::vector<std::string>{"A", "B", "C"});
  } while (other[0] - 'A' == first.axis - 'X');
  known.code = "E" + other + first.axis;
  double angle = 0.0;
  for (int k = 0; k <= 40; ++k) {
    known.p_mm.push_back(rounded(axis.low_mm + (axis.high_mm - axis.low_mm) * k / 40.0, 0.01));
    angle += random.between(2.0, 6.0) * random.normal();
    known.value.push_back(rounded(angle, 0.01));
  }
  setup.known = known;
}

}  // namespace

std::size_t index_of(char axis) { return static_cast<std::size_t>(axis - 'X'); }
char axis_of(std::size_t index) { return static_cast<char>('X' + static_cast<char>(index)); }

double interpolated(const std::vector<double>& p, const std::vector<double>& value, double at) {
  if (at <= p.front()) return value.front();
  if (at >= p.back()) return value.back();
  const auto above = static_cast<std::size_t>(std::upper_bound(p.begin(), p.end(), at) - p.begin());
  const double share = (at - p[above - 1]) / (p[above] - p[above - 1]);
  return std::lerp(value[above - 1], value[above], share);
}

double excess_refraction(double air_degC, double pressure_hPa, double humidity_pct) {
  const auto refractivity = [](double t, double hPa, double rh) {
    const double wave_number2 = std::pow(1.0 / 0.6329912, 2);
    const double standard = 1e-8 * (8342.54 + 2406147.0 / (130.0 - wave_number2) + 15998.0 / (38.9 - wave_number2));
    const double pa = 100.0 * hPa;
    const double dry = pa * standard / 96095.43 * (1.0 + 1e-8 * (0.601 - 0.00972 * t) * pa) / (1.0 + 0.0036610 * t);
    const double vapour_pa = rh / 100.0 * 611.2 * std::exp(17.62 * t / (243.12 + t));
    return dry - vapour_pa * (3.7345 - 0.0401 * wave_number2) * 1e-10;
  };
  return refractivity(air_degC, pressure_hPa, humidity_pct) - refractivity(20.0, 1013.25, 50.0);
}

Setup draw_setup(Random& random, const Wishes& wishes) {
  Setup setup;
  setup.machine = draw_machine(random);
  setup.moved_targets = random.chance(0.6);
  const int count = random.whole(16, 60);
  const std::vector<Pass> passes = draw_passes(random, setup, wishes, count);
  const bool many = wishes.feeds || wishes.loads;
  int runs = random.chance(0.15) ? random.whole(1, 2) : random.whole(3, 6);
  if (wishes.runs) runs = std::max(runs, 3);
  if (many) runs = std::max(runs, random.whole(4, 6));
  if (passes.size() > 1) runs = std::clamp(runs, 2, 3);
  const bool both = wishes.both_approaches || wishes.travel || random.chance(0.6);
  setup.feed = wishes.feeds || wishes.one_feed || random.chance(0.15);
  setup.load = wishes.loads || wishes.one_load || random.chance(0.1);
  setup.travel = wishes.travel || (both && random.chance(0.2));
  setup.air = wishes.air || wishes.one_weather || wishes.similar_air || random.chance(0.15);
  Clock clock(random, random.between(4.0, 12.0), random.between_log(20.0, 900.0));
  const double overrun_mm = rounded(random.between(1.0, 8.0), 0.1);
  const double feed = rounded(random.between_log(500.0, 6000.0), 100.0);
  const double load = wishes.loads ? 0.0 : rounded(random.between(10.0, 800.0), 5.0);
  std::vector<double> feeds;
  std::vector<double> loads;
  const double most_kg = random.between_log(100.0, 2000.0);
  for (int k = 0; k < 3; ++k) {
    feeds.push_back(rounded(feed * (0.4 + 0.8 * k), 50.0));
    loads.push_back(rounded(most_kg * 0.5 * k, 5.0));
  }
  int run = 0;
  for (const Pass& pass : passes)
    for (int k = 0; k < runs; ++k) {
      const auto level = static_cast<std::size_t>((k + run / 3) % 3);
      const RunFacts facts{wishes.feeds ? feeds[level] : feed, wishes.loads ? loads[level] : load};
      measure(setup, clock, pass, ++run, both, facts, overrun_mm);
      clock.pause();
    }
  add_climates(random, setup, wishes, static_cast<std::size_t>(run));
  if (wishes.map) add_map(random, setup);
  if (wishes.known) add_known(random, setup);
  return setup;
}

}  // namespace foreign
