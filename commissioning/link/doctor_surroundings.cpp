// What else of this computer the program uses: emulator, sample machine, gnuplot, terminal.
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "base/text.hpp"
#include "commissioning/link/doctor.hpp"

namespace ecs::commissioning {
namespace {

bool on_path(const char* program) {
  const char* path = std::getenv("PATH");
  for (const std::string_view folder : split(path == nullptr ? "" : path, ':'))
    if (::access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

DoctorFinding emulator_finding() {
  if (const auto program = emulator_program()) return {"emulator", FindingState::ok, program->string(), {}};
  return {"emulator", FindingState::note, "the bundled emulator `ecs-emulator` is not found",
          "install it beside `ecs`; only --link emulator needs it"};
}

DoctorFinding sample_finding() {
  if (const auto machine = sample_machine()) return {"sample machine", FindingState::ok, machine->string(), {}};
  return {"sample machine", FindingState::note, "samples/mill/machine.toml is not found",
          "set ECS_SAMPLES to the folder `samples`, or give --link emulator:machine.toml"};
}

DoctorFinding gnuplot_finding() {
  if (on_path("gnuplot")) return {"gnuplot", FindingState::ok, "gnuplot is there", {}};
  return {"gnuplot", FindingState::note, "gnuplot is not found: no plots as SVG or PNG",
          "install the package gnuplot-nox"};
}

DoctorFinding terminal_finding() {
  const char* kind = std::getenv("TERM");
  if (::isatty(STDOUT_FILENO) == 1 && kind != nullptr && std::string_view(kind) != "dumb")
    return {"terminal", FindingState::ok, fmt::format("a terminal of kind {}", kind), {}};
  return {"terminal", FindingState::note, "stdout is no terminal, or TERM is not set: no screens, no progress bar", {}};
}

}  // namespace

std::vector<DoctorFinding> surroundings() {
  return {emulator_finding(), sample_finding(), gnuplot_finding(), terminal_finding()};
}

}  // namespace ecs::commissioning
