// The requests `measure` and `capture` as plans. For .cpp files only: it is heavy.
#pragma once

#include "ecs_emulator/instruments/arguments.hpp"
#include "ecs_emulator/instruments/capture.hpp"
#include "ecs_emulator/instruments/measurement.hpp"

namespace ecs::emulator {

/// Asks `arguments` for everything that a plan has; what is wrong stays with them. Nothing without axis and sense.
[[nodiscard]] std::optional<MeasurementPlan> plan_in(Arguments& arguments);
/// The same for the request `capture`.
[[nodiscard]] std::optional<CapturePlan> capture_in(Arguments& arguments);

}  // namespace ecs::emulator
