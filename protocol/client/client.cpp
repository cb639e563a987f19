// Typed reads.
#include "protocol/client/client.hpp"

#include <algorithm>
#include <limits>
#include <random>

#include <fmt/format.h>

#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {

namespace {

const Registers kEchoOnly{0};  ///< the link fills it in

}  // namespace

UnitClient::UnitClient(Link link, const Host& host) : link_(std::move(link)) {
  std::random_device chance;
  self_.key = host.key != 0 ? host.key : std::uint64_t{chance()} << 32 | chance();
  self_.number = chance();
  self_.host = host.name;
  arm_code_ = host.arm_code;
}

Result<UnitClient> UnitClient::connect(const LinkAddress& address, const LinkOptions& options, const Host& host) {
  ECS_TRY(link, Link::open(address, options));
  UnitClient client(std::move(link), host);
  ECS_TRY(version, client.link_.ask(kEcho, kEchoOnly, kVersion));
  if (version[1] != kProtocolVersion)
    return problem(
        ProblemKind::link,
        fmt::format("{}: the unit speaks protocol version {}, this program version {}; use matching versions",
                    to_text(address), version[1], kProtocolVersion));
  ECS_DO(client.identity());
  return client;
}

Result<Identity> UnitClient::identity() {
  auto identity = link_.ask(kEcho, kEchoOnly, kIdentity).and_then(identity_in);
  if (identity && serial_number_.empty()) serial_number_ = identity->serial_number;
  return identity;
}

Result<MonitorSample> UnitClient::monitor() { return link_.ask(kEcho, kEchoOnly, kMonitor).and_then(monitor_in); }

Result<UnitStatus> UnitClient::status() {
  auto status = link_.ask(kEcho, kEchoOnly, kStatus).and_then(status_in);
  if (!status) return status;
  ECS_TRY(pointers, link_.ask(kEcho, kEchoOnly, kPointers));
  ECS_DO(take_pointers(pointers, *status));
  return status;
}

Result<std::vector<Registers>> UnitClient::event_blocks(std::size_t most) {
  std::vector<Registers> blocks;
  if (most == 0) return blocks;
  const auto asked = [this](std::uint32_t first) {
    return link_.ask(kEventSelect, registers_of(EventSelect{first}, 0), kEvents);
  };
  ECS_TRY(newest, asked(std::numeric_limits<std::uint32_t>::max()).and_then(event_page_in));
  std::uint32_t next = newest.newest > most ? newest.newest - static_cast<std::uint32_t>(most) + 1 : 1;
  while (next <= newest.newest) {
    ECS_TRY(block, asked(next));
    ECS_TRY(page, event_page_in(block));
    const std::uint32_t last =
        std::max_element(page.events.begin(), page.events.end(), [](const auto& a, const auto& b) {
          return a.number < b.number;
        })->number;
    if (last < next) return blocks;
    next = last + 1;
    blocks.push_back(std::move(block));
  }
  return blocks;
}

}  // namespace ecs::protocol
