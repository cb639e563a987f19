// A mill measured by a formula, and the laser screen on it: keys in, pictures out.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "app/screens/laser/screen.hpp"
#include "tests/support/screen_driver.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {

inline const std::string kNoUnit = "rtu:/nowhere/at/all:115200";

/// One measured line: three runs there and back, the error a function of the position, 1 um apart from run to run,
/// reverse 2 um above forward.
struct Measured {
  char axis = 'X';
  std::string sense = "EX";
  double from_mm = 0.0, to_mm = -400.0, step_mm = 50.0;
  Vector3 parked_mm{};
  std::string instrument = "linear";
  bool compensated = false;
};
inline const std::string kExx = "EX along X at Y -1400, Z 0";
inline const Measured kPositioning{'X', "EX", 0, -400, 50, {0, -1400, 0}};
using ErrorAt = std::function<double(double)>;

inline std::string measured_csv(const Measured& m, const ErrorAt& error) {
  std::string text = fmt::format(
      "# machine: moving column mill\n# serial_number: MCM-0107\n# instrument: {}\n# date: 1990-03-12\n"
      "axis,x_mm,y_mm,z_mm,sense,reading,approach,run,t_air_degC,compensated\n",
      m.instrument);
  const int steps = static_cast<int>(std::lround(std::abs(m.to_mm - m.from_mm) / m.step_mm));
  const double by_mm = m.to_mm > m.from_mm ? m.step_mm : -m.step_mm;
  for (int run = 1; run <= 3; ++run)
    for (const bool back : {false, true})
      for (int k = 0; k <= steps; ++k) {
        const double p = m.from_mm + by_mm * (back ? steps - k : k);
        const int approach = (by_mm > 0.0) == back ? -1 : 1;
        Vector3 at = m.parked_mm;
        at[static_cast<std::size_t>(m.axis - 'X')] = p;
        // a small pattern in place of noise, so that repeats differ a little
        const double jitter = 0.05 * static_cast<double>((7 * k + 3 * run + (back ? 5 : 0)) % 11);
        text += fmt::format("{},{},{},{},{},{:.3f},{},{},20.{},{}\n", m.axis, at[0], at[1], at[2], m.sense,
                            error(p) + run + (approach < 0 ? 2.0 : 0.0) + jitter, approach, run, run,
                            m.compensated ? 1 : 0);
      }
  return text;
}

/// The files that samples/mill/recipe.toml names, measured by formulas.
inline void measure_mill(const StateFolder& folder) {
  struct Line {
    const char* name;
    Measured m;
  };
  const Vector3 x{0, -1400, 0}, y{0, 0, 0}, z{0, -1400, 0};
  const Line lines[] = {{"EXX", {'X', "EX", 0, -4100, 50, x}},
                        {"EXX_z-1000", {'X', "EX", 0, -4100, 50, {0, -1400, -1000}}},
                        {"EYX", {'X', "EY", 0, -4100, 25, x, "straightness"}},
                        {"EZX", {'X', "EZ", 0, -4100, 25, x, "straightness"}},
                        {"EAX", {'X', "EA", 0, -4100, 25, x, "level"}},
                        {"ECX", {'X', "EC", 0, -4100, 25, x, "angular"}},
                        {"EXY", {'Y', "EX", -1400, 0, 50, y, "straightness"}},
                        {"EYY", {'Y', "EY", -1400, 0, 50, y}},
                        {"EYY_z-1000", {'Y', "EY", -1400, 0, 50, {0, 0, -1000}}},
                        {"EZY", {'Y', "EZ", -1400, 0, 50, y, "straightness"}},
                        {"EXZ", {'Z', "EX", 0, -1000, 20, z, "straightness"}},
                        {"EYZ", {'Z', "EY", 0, -1000, 20, z, "straightness"}},
                        {"EZZ", {'Z', "EZ", 0, -1000, 20, z}},
                        {"C0Y", {'Y', "EX", -1400, 0, 50, y, "square"}},
                        {"B0Z", {'Z', "EX", 0, -1000, 20, z, "square"}},
                        {"A0Z", {'Z', "EY", 0, -1000, 20, z, "square"}}};
  double k = 1.0;
  for (const Line& line : lines) {
    k += 0.3;
    folder.with(fmt::format("before/{}.csv", line.name), measured_csv(line.m, [&](double p) {
                  return 10.0 * std::sin(p / (300.0 + 40.0 * k)) + 0.002 * k * p;
                }));
  }
}

/// The screen with its keys and what is seen.
class LaserScreenDriver {
 public:
  explicit LaserScreenDriver(const std::string& link = kNoUnit)
      : unit(std::make_shared<UnitConnection>(link)), screen(std::make_unique<LaserScreen>(unit)) {}

  LaserController& controller() { return screen->controller(); }

  [[nodiscard]] std::string seen(int rows = 24, int columns = 80, Glyphs glyphs = Glyphs::unicode) const {
    return screen_test::picture(*screen, rows, columns, glyphs);
  }
  /// \n is Enter, \t Tab, \x1b Esc.
  Step::Kind type(const std::string& keys) {
    Step::Kind kind = Step::Kind::stay;
    for (const char c : keys) kind = screen->on_key(screen_test::key_of(c)).kind;
    return kind;
  }
  /// What is seen when these keys were typed.
  std::string after(const std::string& keys) {
    type(keys);
    return seen();
  }
  Step::Kind press(Key::Name name, int times = 1) {
    Step::Kind kind = Step::Kind::stay;
    for (int k = 0; k < times; ++k) kind = screen->on_key({name}).kind;
    return kind;
  }
  /// Until `is` holds; @return whether it did within this many seconds
  bool until(const std::function<bool()>& is, int seconds = 20) {
    for (int k = 0; k < seconds * 200; ++k) {
      (void)screen->advance();
      if (is()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  bool settled() {
    return until([&] { return !controller().working() && !controller().busy(); });
  }
  bool settles_after(const std::string& keys) {
    type(keys);
    return settled();
  }
  bool shows(const std::string& text) {
    return until([&] { return contains(seen(), text); });
  }
  bool shows_after(const std::string& keys, const std::string& text) {
    type(keys);
    return shows(text);
  }
  /// Files given straight to the controller.
  void take_files(const std::vector<std::string>& files, const std::string& params = {}) {
    controller().change("files", [&](LaserChoices& c) {
      for (const std::string& file : files) c.files.push_back({file, {}});
      c.params_file = params;
    });
    REQUIRE(settled());
  }

  std::shared_ptr<UnitConnection> unit;
  std::unique_ptr<LaserScreen> screen;
};

}  // namespace ecs::app
