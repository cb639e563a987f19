#include "app/cli/verb_unit.hpp"

#include <utility>

#include <fmt/format.h>

#include "base/text.hpp"
#include "commissioning/link/choice.hpp"
#include "commissioning/session/commands.hpp"

namespace ecs::app {

void announce_writing(VerbContext& context) {
  const auto choice = chosen_link(context.link_option);
  if (choice && choice->is_emulator()) context.console.message_prefix = "EMULATOR: ";
}

Result<UnitLink> open_unit(VerbContext& context) {
  ECS_TRY(choice, chosen_link(context.link_option));
  context.link_name = to_text(choice);
  if (choice.is_emulator() && (context.link == Link::writes || context.link == Link::arms))
    context.console.message_prefix = "EMULATOR: ";
  if (choice.origin == "default")
    context.console.note(fmt::format("no link given: using the bundled emulator with {}",
                                     std::get<EmulatorLink>(choice.link).machine.string()));
  if (!context.arm_code.empty()) choice.arm_code = context.arm_code;
  return open_link(choice);
}

void ask_to_reference(VerbContext& context, const UnitLink& unit, std::string_view axes) {
  context.console.note(fmt::format("reference {} at the control now", axes));
  if (unit.workshop().empty()) return;
  const auto emulator = emulator_program();
  context.console.note(
      "to reference the emulated machine, run in another terminal: " +
      shell_command({emulator ? emulator->string() : "ecs-emulator", "workshop", unit.workshop(), "reference"}));
}

protocol::ProgressCallback progress_bar(VerbContext& context, std::string label) {
  return [&console = context.console, label = std::move(label)](const protocol::Progress& progress) {
    const double total = static_cast<double>(progress.bytes_total);
    console.progress(label, total > 0.0 ? static_cast<double>(progress.bytes_done) / total : 0.0,
                     progress.seconds_left);
  };
}

Result<void> confirmed(bool yes, std::string_view what_happens) {
  if (yes) return {};
  return problem(ProblemKind::usage, "{}: give --yes to confirm", what_happens);
}

Result<Axis> axis_named(std::string_view text) {
  for (const Axis axis : kAllAxes)
    if (lower(text) == lower(std::string(1, letter_of(axis)))) return axis;
  return problem(ProblemKind::usage, "expected an axis X, Y or Z, got \"{}\"", text);
}

}  // namespace ecs::app
