// What the module brings: the verbs and screens LENGTHS and PLAN LENGTHS.
#include "app/cli/module.hpp"

#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/screens/forms/rows.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "commissioning/session/commands.hpp"
#include "modules/lengths/length_test.hpp"

namespace ecs::app {

extern const std::vector<Action> kLengths;

namespace {

/// What a plan asks for, set-up by set-up; nothing: the file holds measured lengths, or is none.
std::optional<std::string> plan_in(const FormValues& values) {
  const std::string& file = values.at("LENGTHS");
  const auto text = read_file(file);
  if (!text || text->find("deviation_um") != std::string::npos) return std::nullopt;
  const auto plan = model::parse_lengths(*text, file, true);
  if (!plan) return std::nullopt;
  std::string out = fmt::format("{}: a plan of {} lengths{}, not measured yet\n", plan->source, plan->readings.size(),
                                plan->minutes ? fmt::format(", {:.1f} minutes", *plan->minutes) : "");
  for (std::size_t s = 0; s < plan->set_ups.size(); ++s) {
    const model::LengthSetUp& set_up = plan->set_ups[s];
    std::set<std::string> tools;
    std::size_t count = 0;
    for (const model::LengthReading& reading : plan->readings) {
      if (reading.set_up != s) continue;
      tools.insert(plan->tools[reading.tool].name);
      ++count;
    }
    out += fmt::format("  set-up {}: {} {:.6g}, {:.6g}, {:.6g}: {} lengths, tools {}\n", set_up.name,
                       model::word_of(set_up.instrument), set_up.place[0], set_up.place[1], set_up.place[2], count,
                       fmt::join(tools, ", "));
  }
  for (const model::LengthTool& tool : plan->tools)
    out += fmt::format("  tool {}: reflector at {:.6g}, {:.6g}, {:.6g} mm\n", tool.name, tool.offset_mm[0],
                       tool.offset_mm[1], tool.offset_mm[2]);
  return out + "Measure row by row and add the column deviation_um; of the emulated machine:\n  " +
         shell_command({"ecs-emulator", "lengths", path_word(plan->source), "--machine",
                        path_word(values.at("--machine")), "-o", "lengths.csv"});
}

FormEntry lengths_entry() {
  return {
      "all 21 components from lengths, and which of them are undetermined",
      {.verb = "lengths fit",
       .title = "LENGTHS",
       .asks = "Which lengths, of which machine?",
       .about = "All 21 components of a three-axis machine from lengths alone: along the beam of an interferometer, "
                "from a tracking interferometer or the ball of a ball bar; or from deviations of points. Shows each "
                "component with its expanded uncertainty (95 %), the scatter of a reading and the place of each "
                "set-up. Lists "
                "components that are not determined, and the lengths that would determine them. Press s to save the "
                "map, and "
                "the parameters with the squareness. "
                "For a plan, the planned lengths are listed. PLAN LENGTHS makes a plan.",
       .fields = {"LENGTHS", "--machine", "--params", "--knots"},
       .opens = {{FileKind::lengths, "LENGTHS"}, {FileKind::machine, "--machine"}, {FileKind::parameters, "--params"}},
       .instead = plan_in}};
}

FormEntry plan_entry() {
  return {"lengths for a required uncertainty in the shortest time",
          {.verb = "lengths plan",
           .title = "PLAN LENGTHS",
           .asks = "Choose the machine and the required uncertainty of its volume.",
           .about = "The set-ups and lengths that need the fewest minutes for a required uncertainty of the volume, "
                    "compared with single set-ups. The search needs half a minute. Press s to save the plan. After "
                    "measuring, open it in LENGTHS.",
           .fields = {"--machine", "--volume-um", "--knots"}}};
}

std::vector<FormEntry> lengths_forms() { return {lengths_entry(), plan_entry()}; }

}  // namespace

const Module& lengths_module() {
  constexpr const char* kLengthsSought =
      "tracker tracking interferometer ball bar diagonal multilateration squareness identify 21 points grid ball plate";
  constexpr const char* kPlanSought =
      "tracker tracking interferometer ball bar diagonal multilateration fewest minutes";
  static const Module module{
      .menus = {{"lengths", "PROCESS LASER DATA: all error components from measured lengths"}},
      .verbs = {{"laser", &kLengths}},
      .forms = lengths_forms,
      .synonyms = {{"LENGTHS", kLengthsSought},
                   {"PLAN LENGTHS", kPlanSought},
                   {"lengths fit", kLengthsSought},
                   {"lengths plan", kPlanSought}},
      .advice = {{name_of(FileKind::lengths), "use `ecs lengths fit {} --machine MACHINE.toml`"}}};
  return module;
}

}  // namespace ecs::app
