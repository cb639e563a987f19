// A part program run on the machine, with an instrument that the program triggers and a trace of the track where
// wanted. Does not live here: what the words mean (interpreter.hpp), the request (ecs_emulator/workshop/actions.hpp).
#pragma once

#include <filesystem>
#include <functional>

#include "ecs_emulator/instruments/measuring_post.hpp"
#include "ecs_emulator/part_programs/interpreter.hpp"

namespace ecs::emulator {

/// An exact stop ends when no axis is further than this from its command.
inline constexpr double kInPosition_mm = 0.010;

struct ProgramOrder {
  std::optional<Axis> axis;  ///< whose component is measured, with `sense`; absent: nothing is measured
  std::optional<Sense> sense;
  std::optional<InstrumentKind> instrument;  ///< absent: instrument_for()
  std::optional<bool> reversed;              ///< square or straight edge turned over, column `reversed`
  std::filesystem::path trace;               ///< empty: none
  double trace_period_s = 0.001;
  std::string date;  ///< into the metadata, as the next
  std::string engineer;
};

struct ProgramProgress {
  std::size_t blocks_done = 0;
  std::size_t blocks_total = 0;
  int line = 0;
  std::size_t readings = 0;
};

struct ProgramResult {
  ProgramSummary summary;
  double took_s = 0.0;  ///< simulated
  std::optional<laser::MeasurementSet> readings;
};

/// What a person at the machine has to do with a program besides starting it.
struct ProgramHooks {
  std::function<void(const ProgramProgress&)> report;  ///< called after every block that ends standing
  std::function<void(double rpm)> spindle;             ///< M03 (positive), M04 (negative), M05 (0)
  std::function<void()> each;                          ///< called after every tick
};

/// Where the axes of this machine can be sent: their travel and kOvertravel_mm.
[[nodiscard]] ProgramRange range_of(const MachineTool& machine);

/// Checks the whole program from where the machine is now, then runs it. Nothing moves where anything is wrong.
/// Feed blocks run through; a rapid, G09, G04 and every M word end standing, in position.
/// Every M08 is a reading at the commanded place, as the machine stands when it comes. Its approach is the direction in
/// which the measured axis was last sent; its run counts how often that target has been read with that approach.
[[nodiscard]] Result<ProgramResult> run_program(Simulation& simulation, const Program& program,
                                                const ProgramOrder& order, const ProgramHooks& hooks = {});

}  // namespace ecs::emulator
