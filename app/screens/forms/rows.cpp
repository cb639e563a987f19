#include "app/screens/forms/rows.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/cli/module.hpp"
#include "app/verbs/registry.hpp"
#include "base/text.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/remembered.hpp"
#include "commissioning/unit/utility_work.hpp"
#include "commissioning/utility/unit_view.hpp"
#include "commissioning/volume/view.hpp"
#include "commissioning/volume/work.hpp"
#include "core/address_map.hpp"
#include "protocol/client/client.hpp"

namespace ecs::app {
namespace {

// --- VOLUME
Result<PlotFigure> figure_of_volume(const FormValues& values) {
  const auto given = [&values](const char* option) {
    const auto found = values.find(option);
    return found == values.end() ? std::string() : found->second;
  };
  VolumeArguments arguments;
  arguments.map = given("MAP");
  arguments.params = given("--params");
  arguments.errors = given("--errors");
  arguments.model = given("--model");
  arguments.machine = given("--machine");
  arguments.rotary = given("--rotary");
  arguments.other_machine = !given("--other-machine").empty();
  arguments.plane = kLongestPlane;
  NoMessages nobody;
  ECS_TRY(work, volume_work(nobody, arguments));
  return volume_figure(work);
}

// --- RUN USER SOFTWARE
constexpr std::size_t kPeekBytes = 8;

/// Where a program may lie, and what it finds there.
struct ProgramRegion {
  Region region;
  const char* what;
};

std::vector<ProgramRegion> program_regions() {
  Region programs = kSystemRam;
  programs.first = kUserPrograms;
  programs.size = kSystemRam.first + kSystemRam.size - kUserPrograms;
  return {{programs, "your programs, data and stack"},
          {kEprom, "the firmware: read only"},
          {{kSystemRam.first, kUserRegisterBytes, false, kSystemRam.name}, "registers after a run"},
          {kMachineInputs, "periods, positions, axes: read only"},
          {kCommitRecords, "active bank: read only"},
          {kBankA, "error map and parameters"},
          {kBankB, "error map and parameters"}};
}

std::vector<std::string> region_rows() {
  std::vector<std::string> rows{
      fmt::format("{:<10}{:<10}{:<20}{}", "from", "to", "memory", "memory seen by a program")};
  for (const auto& [region, what] : program_regions())
    rows.push_back(
        fmt::format("0x{:06X}  0x{:06X}  {:<20}{}", region.first, region.first + region.size - 1, region.name, what));
  rows.insert(rows.end(), {"", "A program ends with RTS and returns D0. Use MEMORY ACCESS to write programs and",
                           "their data into system RAM, which loses its contents without power."});
  return rows;
}

std::vector<std::string> region_addresses() {
  std::vector<std::string> addresses;
  for (const ProgramRegion& one : program_regions()) addresses.push_back(fmt::format("0x{:06X}", one.region.first));
  return addresses;
}

/// Names the program's first bytes.
Result<Question> sure_to_run(UnitConnection& connection, JobControl& control, const FormValues& values) {
  if (const auto seen = connection.newest())
    if (const std::string why = refusal_in(seen->mode); !why.empty()) return problem(ProblemKind::refused, why);
  ECS_TRY(start, whole_number(values.at("ADDRESS"), "ADDRESS"));
  const Address address = start;
  ECS_TRY(argument, whole_number(values.at("--argument"), "--argument"));
  ECS_TRY(bytes, connection.with_link(
                     control, [address](UnitLink& link) { return link.client().read_memory(address, kPeekBytes); }));
  std::string words;
  for (std::size_t k = 0; k + 1 < bytes.size(); k += 2) words += fmt::format(" {:02X}{:02X}", bytes[k], bytes[k + 1]);
  const bool empty = std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0; });
  return Question{
      fmt::format("Run the program at 0x{:06X}?", address),
      (empty ? std::string("NO PROGRAM at this address, only zeros: write one with MEMORY ACCESS. ")
             : fmt::format("It begins with{}. ", words)) +
          fmt::format("D0 is set to {} (0x{:08X}). The program may write to all RAM of the unit, including the error "
                      "map, and is stopped after {} s. An access outside the memory is a fault that the unit stores.",
                      argument, argument, values.at("--wait")),
      "run it", "cancel"};
}

/// What a program returned as a number with a sign; of one that failed the registers where it ended.
std::string end_of_run(UnitConnection& connection, JobControl& control, int exit_code) {
  const auto registers = connection.with_link(control, [](UnitLink& link) { return kept_registers(link.client()); });
  if (!registers) return {};
  if (exit_code != 0) return "no result was returned; registers at the end:\n" + registers_text(*registers);
  const auto returned =
      std::find_if(registers->begin(), registers->end(), [](const auto& one) { return one.name == "D0"; });
  return returned == registers->end() ? "" : fmt::format("signed {}", static_cast<std::int32_t>(returned->value));
}

// --- ARM THE UNIT
constexpr const char* kArmTitle = "ARM THE UNIT";
constexpr const char* kArmExplained =
    "The unit is read-only for this host: it refuses to write, move an axis, close a relay or run code. Type the code "
    "that the unit shows, then repeat the refused command. Commands that stop or switch off need no code.";

FormEntry volume_entry() {
  return {"error anywhere, before and after compensation",
          {.verb = "volume",
           .title = "VOLUME",
           .asks = "How large is the error in the working volume?",
           .about = "The length of the error vector over the whole working volume, before compensation and after it, "
                    "with a 95 % bound from the uncertainty of the map. Page 1 shows the sizes, pages 2 and 3 the "
                    "error along the body diagonals. Press s to save the wire cube, the slice with arrows and the "
                    "diagonals as SVG or PNG. If the machine file has rotary axes, the sizes cover every angle; slice "
                    "and pictures are drawn at the angles of the largest error, given on page 1.",
           .fields = {"MAP", "--params", "--errors", "--machine", "--rotary"},
           .figure = figure_of_volume,
           .panels = {{"before", 4}, {"after", 5}}}};
}

FormEntry run_entry() {
  return {"machine code in the unit's memory",
          {.verb = "utility run",
           .title = "RUN USER SOFTWARE",
           .asks = "Which program in the unit's system RAM?",
           .about = "Runs 68000 machine code in the unit's system RAM. D0 contains the argument. RTS ends the program, "
                    "D0 is its result, and its final registers are shown. An access to missing memory, an illegal "
                    "instruction or the time limit ends the program, and the unit stores the fault user_software.",
           .fields = {"ADDRESS", "--argument", "--wait"},
           .confirmed = "--yes",
           .preset = {{"ADDRESS", fmt::format("0x{:06X}", kUserPrograms)}, {"--argument", "0"}},
           .offers = {{"ADDRESS", {fmt::format("0x{:06X}", kUserPrograms)}}, {"--argument", region_addresses()}},
           .idle = region_rows(),
           .question = sure_to_run,
           .more = end_of_run,
           .done = [](UnitConnection&, const FormValues& values, int exit_code) {
             if (exit_code != 0) note_remark("the program at " + values.at("ADDRESS") + " was run and failed");
           }}};
}

FormEntry arm_entry() {
  return {{},
          {.verb = "unit arm",
           .title = kArmTitle,
           .asks = kArmExplained,
           .about = std::string(kArmExplained) +
                    " The emulator shows its code when it starts; `ecs-emulator workshop SOCKET arm-code` shows it "
                    "again. After a wrong code the unit waits before it accepts another one.",
           .fields = {"--arm-code", "--minutes"},
           .leaves_when_done = true,
           .done = [](UnitConnection& connection, const FormValues& values, int exit_code) {
             if (exit_code == 0) connection.know_code(std::string(trimmed(values.at("--arm-code"))));
           }}};
}

FormEntry table_entry() {
  const MeasuredPhases phases = measured_phases();
  return {{},
          {.verb = "laser table",
           .preset = {{"PLAN", phases.plan}, {"--before", phases.before}, {"--after", phases.after}}}};
}

VerbEntry verb_named(const std::string& name) {
  for (const MenuEntry& menu : verb_catalogue(all_verbs()))
    for (const VerbEntry& verb : menu.verbs)
      if (verb.name() == name) return verb;
  return {};
}

}  // namespace

std::vector<FormEntry> form_entries() {
  std::vector<FormEntry> entries{
      volume_entry(),
      run_entry(),
      arm_entry(),
      table_entry(),
  };
  for (const Module* module : modules())
    if (module->forms != nullptr)
      for (FormEntry& entry : module->forms()) entries.push_back(std::move(entry));
  return entries;
}

std::unique_ptr<Screen> form_titled(const std::string& title, const std::shared_ptr<UnitConnection>& connection,
                                    const FormValues& values, bool at_once) {
  for (FormEntry& entry : form_entries())
    if (entry.row.title == title) {
      VerbEntry verb = verb_named(entry.row.verb);
      return form_screen(std::move(entry.row), std::move(verb), connection, values, at_once);
    }
  return nullptr;
}

std::unique_ptr<Screen> verb_screen(const VerbEntry& verb, const std::shared_ptr<UnitConnection>& connection) {
  FormRow row{.verb = verb.name()};
  for (FormEntry& entry : form_entries())
    if (entry.row.verb == row.verb && entry.row.title.empty()) row = std::move(entry.row);
  return form_screen(std::move(row), verb, connection);
}

std::unique_ptr<Screen> arm_screen_if_wanted(const std::shared_ptr<UnitConnection>& connection) {
  if (!connection->snapshot().wants_code) return nullptr;
  connection->know_code({});
  return form_titled(kArmTitle, connection);
}

}  // namespace ecs::app
