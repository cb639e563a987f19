#include "commissioning/link/unit_link.hpp"

#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "commissioning/link/host.hpp"

namespace ecs::commissioning {
namespace {

/// An emulator of this program or of another one.
struct Reached {
  std::shared_ptr<EmulatorProcess> own;
  std::optional<SharedEmulator> others;
};

/// The emulator with this machine that runs already, here or in another program that shares it, else a new one.
Result<Reached> reached(const EmulatorLink& link, bool shares) {
  const auto program = emulator_program();
  if (!program)
    return problem(ProblemKind::link,
                   "the bundled emulator `ecs-emulator` is not found beside `ecs` nor on PATH: install it, or give "
                   "--link rtu:/dev/ttyUSB0:115200 or --link tcp:HOST:PORT");
  ECS_TRY(memory, memory_file_of(link.machine));
  static std::mutex mutex;
  static std::map<std::filesystem::path, std::weak_ptr<EmulatorProcess>> running;
  const std::lock_guard lock(mutex);
  if (auto process = running[memory].lock(); process && process->running()) return Reached{process, {}};
  if (auto others = shared_emulator(memory)) return Reached{{}, others};
  auto process = EmulatorProcess::start({*program, link.machine, memory, shares});
  if (!process) {
    if (auto others = shared_emulator(memory)) return Reached{{}, others};  // it came up meanwhile
    return tl::unexpected(process.error());
  }
  const std::shared_ptr<EmulatorProcess> own = std::move(*process);
  running[memory] = own;
  return Reached{own, {}};
}

}  // namespace

Result<UnitLink> open_link(const LinkChoice& choice, const std::atomic<bool>& cancelled) {
  UnitLink::Emulator emulator;
  protocol::LinkAddress address;
  protocol::Host host = this_host();
  if (const auto* link = std::get_if<EmulatorLink>(&choice.link)) {
    ECS_TRY(found, reached(*link, choice.shares));
    emulator.bundled = true;
    emulator.process = found.own;
    emulator.workshop = found.own ? found.own->workshop() : found.others->workshop;
    emulator.arm_code = found.own ? found.own->arm_code() : found.others->arm_code;
    ECS_TRY(way, found.own ? protocol::LinkAddress{protocol::SerialPort{found.own->pty()}}
                           : protocol::link_address_of(found.others->link));
    address = std::move(way);
    host.arm_code = emulator.arm_code;
  } else {
    address = std::get<protocol::LinkAddress>(choice.link);
    host.arm_code = arm_code_in_environment();
  }
  if (!choice.arm_code.empty()) host.arm_code = choice.arm_code;
  ECS_TRY(client, protocol::UnitClient::connect(address, {&cancelled, std::nullopt}, host));
  return UnitLink(std::move(emulator), std::move(client), to_text(choice));
}

}  // namespace ecs::commissioning
