// A mill's unit behind a pseudo-terminal at the speed of a slow line, and a map for it ready to be sent from the
// screen.
#pragma once

#include "app/verbs/registry.hpp"
#include "base/file.hpp"
#include "commissioning/link/emulator_process.hpp"
#include "tests/screens/support/laser_screen.hpp"
#include "tests/support/emulator.hpp"

namespace ecs::app {

/// A mill's unit behind a pseudo-terminal at the speed of a slow line; its memory outlives it.
class PacedUnit {
 public:
  PacedUnit(const StateFolder& folder, std::string baud) : folder_(&folder), baud_(std::move(baud)) { start(); }
  PacedUnit(const PacedUnit&) = delete;
  PacedUnit& operator=(const PacedUnit&) = delete;
  ~PacedUnit() { kill(); }

  void start() {
    const std::string pty = (folder_->path / "unit").string();
    disc::remove(pty);
    child_ = started({kEmulator, "serve", "--machine", "samples/mill/machine.toml", "--pty", pty, "--memory",
                      *folder_ / "battery.bin", "--mode", "integrate", "--arm-code", kArmCode, "--pace", baud_});
    for (int k = 0; k < 1200 && !disc::exists(pty); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(25));
  }
  void kill() {
    end_process(child_, SIGKILL);
    child_ = -1;
  }
  [[nodiscard]] std::string link() const { return "rtu:" + (folder_->path / "unit").string() + ":" + baud_; }

 private:
  const StateFolder* folder_;
  std::string baud_;
  pid_t child_ = -1;
};

/// Linear scope: three lines are enough for a map.
struct LinearMill {
  explicit LinearMill(const StateFolder& folder, double step_mm = 50.0)
      : files{folder.with("EXX.csv", measured_csv({'X', "EX", 0, -4100, step_mm, {0, -1400, 0}}, error)),
              folder.with("EYY.csv", measured_csv({'Y', "EY", -1400, 0, step_mm}, error)),
              folder.with("EZZ.csv", measured_csv({'Z', "EZ", 0, -1000, step_mm, {0, -1400, 0}}, error))} {}
  static double error(double p) { return 20.0 * std::sin(p / 400.0); }
  std::vector<std::string> files;
};

inline void make_ready(LaserScreenDriver& driver, const StateFolder& folder, const LinearMill& mill) {
  driver.controller().change("all", [&](LaserChoices& c) {
    for (const std::string& file : mill.files) c.files.push_back({file, {}});
    c.params_file = "samples/mill/parameters.toml";
    c.scope = "linear";
    c.map_file = (folder.path / "map.csv").string();
  });
  REQUIRE(driver.settled());
  REQUIRE(driver.controller().work().map.complete());
  driver.type("8");
}

/// A mill whose map is ready to be sent to its unit.
struct ReadyMill {
  explicit ReadyMill(const std::string& baud = "115200", double step_mm = 50.0)
      : unit(folder, baud), mill(folder, step_mm), driver(unit.link()) {
    make_ready(driver, folder, mill);
  }
  /// Saved and checked by Enter, sent by the answer to the question.
  void begin_sending() {
    driver.type("\n");
    REQUIRE(driver.shows("Send the map to"));
    driver.type("y");
  }
  StateFolder folder;
  PacedUnit unit;
  LinearMill mill;
  LaserScreenDriver driver;
};

inline std::string ran_text(const std::vector<std::string>& words) {
  const Ran run = ran(words);
  return fmt::format("{} {}", run.code, run.all());
}

inline void send_from(ReadyMill& ready) {
  ready.begin_sending();
  REQUIRE(ready.driver.until([&] { return ready.driver.controller().sent_is_current(); }, 60));
}

}  // namespace ecs::app
