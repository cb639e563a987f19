#include <array>
#include <string_view>

#include <fmt/format.h>

#include "ecs_emulator/instruments/arguments.hpp"
#include "ecs_emulator/workshop/actions.hpp"

namespace ecs::emulator {
namespace {

using Provoke = Result<void> (*)(const Workshop&, Arguments&);

std::optional<Address> address_in(Arguments& arguments, Unit& unit) {
  const auto address = arguments.integer("address", 0, 0xFFFFFF);
  if (!address || !unit.memory().exists(static_cast<Address>(*address), 1)) {
    arguments.complain("address: expected an address of the unit's memory");
    return std::nullopt;
  }
  return static_cast<Address>(*address);
}

Result<void> stick_ram(const Workshop& workshop, Arguments& arguments) {
  const auto address = address_in(arguments, *workshop.unit);
  const auto bit = arguments.integer("bit", 0, 7).value_or(0);
  const auto level = arguments.integer("level", 0, 1).value_or(1);
  ECS_DO(arguments.checked());
  workshop.unit->memory().stick(*address, static_cast<int>(bit), static_cast<int>(level));
  return {};
}

Result<void> corrupt_ram(const Workshop& workshop, Arguments& arguments) {
  const auto address = address_in(arguments, *workshop.unit);
  const auto bits = arguments.integer("bits", 1, 255).value_or(1);
  ECS_DO(arguments.checked());
  workshop.unit->memory().corrupt(*address, static_cast<std::uint8_t>(bits));
  return {};
}

Result<void> overrun(const Workshop& workshop, Arguments& arguments) {
  const double extra_us = arguments.number_or("us", 1e6);
  const auto periods = arguments.integer("count", 0, 100'000'000).value_or(0);
  ECS_DO(arguments.checked());
  workshop.unit->slow_down(extra_us, static_cast<std::uint64_t>(periods));
  return {};
}

Result<void> power_fails(const Workshop& workshop, Arguments& arguments) {
  const auto bytes = arguments.integer("count", 0, 100'000'000).value_or(0);
  ECS_DO(arguments.checked());
  workshop.unit->memory().power_fails_after(static_cast<std::uint64_t>(bytes));
  return {};
}

Result<void> hang(const Workshop& workshop, Arguments& arguments) {
  ECS_DO(arguments.checked());
  workshop.unit->hang();
  return {};
}

/// The axis that a fault is asked for; complains where the machine has none.
std::optional<Axis> axis_in(const Workshop& workshop, Arguments& arguments) {
  const auto axis = arguments.axis("axis");
  if (axis && workshop.simulation->machine().has(*axis)) return axis;
  arguments.complain("axis: expected an axis of this machine");
  return std::nullopt;
}

Result<void> lose_transducer(const Workshop& workshop, Arguments& arguments) {
  const auto axis = axis_in(workshop, arguments);
  const bool back = arguments.flag("back");
  ECS_DO(arguments.checked());
  workshop.simulation->machine().axis(*axis).lose_transducer(!back);
  return {};
}

Result<void> lose_marker(const Workshop& workshop, Arguments& arguments) {
  const auto axis = axis_in(workshop, arguments);
  const bool back = arguments.flag("back");
  ECS_DO(arguments.checked());
  workshop.simulation->machine().axis(*axis).lose_marker(!back);
  return {};
}

Result<void> hang_switch(const Workshop& workshop, Arguments& arguments) {
  const auto axis = axis_in(workshop, arguments);
  const auto level = arguments.integer("level", 0, 1).value_or(1);
  const bool back = arguments.flag("back");
  ECS_DO(arguments.checked());
  workshop.simulation->machine().axis(*axis).hang_switch(back ? std::nullopt : std::optional(level == 1));
  return {};
}

Result<void> miscount(const Workshop& workshop, Arguments& arguments) {
  const auto axis = axis_in(workshop, arguments);
  const auto counts = arguments.integer("count", -1'000'000'000, 1'000'000'000).value_or(10'000);
  ECS_DO(arguments.checked());
  workshop.simulation->machine().axis(*axis).miscount(counts);
  workshop.simulation->idle_tick();
  return {};
}

Result<void> line_fault(const Workshop& workshop, Arguments& arguments, protocol::LinkFault fault) {
  const auto count = arguments.integer("count", 0, 1'000'000);
  const double probability = arguments.number_or("probability", 0.0);
  const auto slow_ms = arguments.number("slow_ms");
  if (workshop.line == nullptr) arguments.complain("no line comes here");
  if (!(probability >= 0.0 && probability <= 1.0)) arguments.complain("probability: expected 0 to 1");
  ECS_DO(arguments.checked());
  if (slow_ms) workshop.line->slow_ms = *slow_ms;
  if (count)
    workshop.line->next(fault, static_cast<std::uint32_t>(*count));
  else
    workshop.line->with_probability(fault, probability);
  return {};
}

Result<void> clear(const Workshop& workshop, Arguments& arguments) {
  ECS_DO(arguments.checked());
  if (workshop.line != nullptr) workshop.line->clear();
  if (workshop.unit != nullptr) {
    workshop.unit->memory().repair();
    workshop.unit->slow_down(0.0);
  }
  for (const Axis a : kAllAxes) {
    if (!workshop.simulation->machine().has(a)) continue;
    AxisOfMachine& axis = workshop.simulation->machine().axis(a);
    axis.lose_transducer(false);
    axis.lose_marker(false);
    axis.hang_switch(std::nullopt);
  }
  return {};
}

struct NamedFault {
  std::string_view name;
  Provoke provoke;
  bool in_unit;
};
constexpr std::array<NamedFault, 10> kFaults{{{"clear", clear, false},
                                              {"transducer", lose_transducer, false},
                                              {"marker", lose_marker, false},
                                              {"switch", hang_switch, false},
                                              {"miscount", miscount, false},
                                              {"ram_stuck", stick_ram, true},
                                              {"corrupt", corrupt_ram, true},
                                              {"overrun", overrun, true},
                                              {"hang", hang, true},
                                              {"power_fails", power_fails, true}}};

}  // namespace

Result<void> provoke(const Workshop& workshop, Arguments& arguments) {
  const std::string name = arguments.word("name");
  std::string names;
  for (const NamedFault& fault : kFaults) {
    names += fmt::format("{}, ", fault.name);
    if (fault.name != name) continue;
    if (fault.in_unit && workshop.unit == nullptr) return problem(ProblemKind::usage, "this machine has no unit");
    return fault.provoke(workshop, arguments);
  }
  if (const auto line = protocol::link_fault_named(name)) return line_fault(workshop, arguments, *line);
  return problem(ProblemKind::usage, fmt::format("name: expected {}{}, got \"{}\"", names,
                                                 fmt::join(protocol::kLinkFaultNames, ", "), name));
}

}  // namespace ecs::emulator
