// Machine and unit as the speed of the workshop is measured with: every axis moves, every component is compensated.
// Does not live here: the measuring (machine_bench.cpp, machine_callgrind.cpp), the map (tick_map.hpp).
#pragma once

#include <cstdlib>
#include <string>

#include "base/file.hpp"
#include "bench/tick_map.hpp"
#include "ecs_emulator/machine/simulation.hpp"
#include "ecs_emulator/unit/unit.hpp"
#include "ecs_emulator/workshop/procedures.hpp"

namespace ecs::bench {

class Workbench {
 public:
  /// @param drive  of every axis: servo or ideal
  Workbench(const std::string& drive, bool with_unit)
      : simulation_(machine(drive), emulator::TrueErrors(), 1),
        unit_({"BENCH",
               kMostModules,
               {Transducer::encoder, Transducer::encoder, Transducer::encoder},
               emulator::LinkSense::integrate}) {
    if (!with_unit) return;
    simulation_.attach(&unit_);
    unit_.power(true);
    simulation_.tick();
    const auto image = full_image(100'000);
    const auto staged = tell(protocol::Command{.code = protocol::CommandCode::begin_staging});
    need(unit_.write_memory(staged.value, image) == protocol::UnitError::none);
    need(tell(protocol::Command{.code = protocol::CommandCode::commit_staged,
                                .length = static_cast<std::uint32_t>(image.size()),
                                .digest = protocol::short_digest(protocol::digest_of(image))})
             .state == protocol::CommandState::done);
    need(tell(protocol::Command{.code = protocol::CommandCode::enter_compensation}).state ==
         protocol::CommandState::done);
    need(emulator::reference(simulation_, {Axis::X, Axis::Y, Axis::Z}).has_value());
    need(unit_.mode() == UnitMode::compensating);
  }

  /// Feeds through the working volume, every axis moving, for at least so long. @return simulated seconds
  double run(double seconds) {
    const double begin_s = simulation_.machine().time_s();
    while (simulation_.machine().time_s() - begin_s < seconds) {
      if (simulation_.machine().arrived()) {
        onward_ = !onward_;
        const double to_mm = onward_ ? -900.0 : -100.0;
        simulation_.machine().move_to({to_mm, 0.8 * to_mm, 0.6 * to_mm}, 3000.0);
      }
      simulation_.tick();
    }
    return simulation_.machine().time_s() - begin_s;
  }

 private:
  static void need(bool right) {
    if (!right) std::abort();
  }
  static emulator::WorkshopMachine machine(const std::string& drive) {
    std::string text = "configuration = \"XYTZ\"\n";
    for (const char* axis : {"X", "Y", "Z"})
      text += std::string("[axis.") + axis + "]\ntravel_mm = [-1000.0, 0.0]\n[emulator.axis." + axis + "]\ndrive = \"" +
              drive + "\"\n";
    return *emulator::parse_workshop_machine(text, "bench", ".");
  }
  protocol::CommandResult tell(const protocol::Command& command) {
    auto result = unit_.begin(command);
    while (result.state == protocol::CommandState::busy) {
      simulation_.tick();
      result = unit_.progress();
    }
    return result;
  }

  emulator::Simulation simulation_;
  emulator::Unit unit_;
  bool onward_ = false;
};

}  // namespace ecs::bench
