#include "commissioning/link/unit_link.hpp"

#include <map>
#include <mutex>
#include <utility>

#include "commissioning/link/host.hpp"

namespace ecs::commissioning {
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
  protocol::Host host = this_host();
  if (const auto* link = std::get_if<EmulatorLink>(&choice.link)) {
    auto process = started(*link);
    if (!process) return tl::unexpected(process.error());
    emulator = std::move(*process);
    address.endpoint = protocol::SerialPort{emulator->pty()};
    host.arm_code = emulator->arm_code();
  } else {
    address = std::get<protocol::LinkAddress>(choice.link);
    host.arm_code = arm_code_in_environment();
  }
  if (!choice.arm_code.empty()) host.arm_code = choice.arm_code;
  auto client = protocol::UnitClient::connect(address, {&cancelled, std::nullopt}, host);
  if (!client) return tl::unexpected(client.error());
  return UnitLink(std::move(emulator), std::move(*client), to_text(choice));
}

}  // namespace ecs::commissioning
