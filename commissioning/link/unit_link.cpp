#include "commissioning/link/unit_link.hpp"

#include <map>
#include <mutex>
#include <utility>

#include <fmt/format.h>

namespace ecs::app {
namespace {

/// The emulator with this machine that runs already, else a new one.
Result<std::shared_ptr<EmulatorProcess>> started(const EmulatorLink& link) {
  const auto program = emulator_program();
  if (!program)
    return problem(ProblemKind::link,
                   "the bundled emulator `ecs-emulator` is not found beside `ecs` nor on PATH: install it, or give "
                   "--link rtu:/dev/ttyUSB0:115200 or --link tcp:HOST:PORT");
  auto memory = memory_file_of(link.machine);
  if (!memory) return tl::unexpected(memory.error());
  static std::mutex mutex;
  static std::map<std::filesystem::path, std::weak_ptr<EmulatorProcess>> running;
  const std::lock_guard lock(mutex);
  if (auto process = running[*memory].lock(); process && process->running()) return process;
  auto process = EmulatorProcess::start({*program, link.machine, *memory});
  if (!process) return tl::unexpected(process.error());
  const std::shared_ptr<EmulatorProcess> shared = std::move(*process);
  running[*memory] = shared;
  return shared;
}

}  // namespace

Result<UnitLink> open_link(const LinkChoice& choice, const std::atomic<bool>& cancelled) {
  std::shared_ptr<EmulatorProcess> emulator;
  protocol::LinkAddress address;
  if (const auto* link = std::get_if<EmulatorLink>(&choice.link)) {
    auto process = started(*link);
    if (!process) return tl::unexpected(process.error());
    emulator = std::move(*process);
    address.endpoint = protocol::SerialPort{emulator->pty()};
  } else {
    address = std::get<protocol::LinkAddress>(choice.link);
  }
  auto client = protocol::UnitClient::connect(address, {&cancelled, std::nullopt});
  if (!client) return tl::unexpected(client.error());
  return UnitLink(std::move(emulator), std::move(*client), to_text(choice));
}

void announce_writing(VerbContext& context) {
  const auto choice = chosen_link(context.link_option);
  if (choice && choice->is_emulator()) context.console.message_prefix = "EMULATOR: ";
}

Result<UnitLink> open_unit(VerbContext& context, Access access) {
  auto choice = chosen_link(context.link_option);
  if (!choice) return tl::unexpected(choice.error());
  context.link_name = to_text(*choice);
  if (choice->is_emulator() && access == Access::writes) context.console.message_prefix = "EMULATOR: ";
  if (choice->origin == "default")
    context.console.note(fmt::format("no link given: using the bundled emulator with {}",
                                     std::get<EmulatorLink>(choice->link).machine.string()));
  return open_link(*choice);
}

void ask_to_reference(VerbContext& context, const UnitLink& unit, std::string_view axes) {
  context.console.note(fmt::format("reference {} of the machine now: the unit watches", axes));
  if (!unit.workshop().empty())
    context.console.note(fmt::format("from another terminal: ecs-emulator workshop {} reference", unit.workshop()));
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
  return problem(ProblemKind::usage, fmt::format("{}: give --yes if that is meant", what_happens));
}

}  // namespace ecs::app
