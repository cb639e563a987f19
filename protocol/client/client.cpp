// Typed reads.
#include "protocol/client/client.hpp"

#include <fmt/format.h>

#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {

namespace {

const Registers kEchoOnly{0};  ///< the link fills it in

}  // namespace

Result<UnitClient> UnitClient::connect(const LinkAddress& address, const LinkOptions& options) {
  auto link = Link::open(address, options);
  if (!link) return tl::unexpected(link.error());
  UnitClient client(std::move(*link));
  const auto version = client.link_.ask(kEcho, kEchoOnly, kVersion);
  if (!version) return tl::unexpected(version.error());
  if ((*version)[1] != kProtocolVersion)
    return problem(
        ProblemKind::link,
        fmt::format("{}: the unit speaks protocol version {}, this program version {}; use matching versions",
                    to_text(address), (*version)[1], kProtocolVersion));
  if (const auto identity = client.identity(); !identity) return tl::unexpected(identity.error());
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
  const auto pointers = link_.ask(kEcho, kEchoOnly, kPointers);
  if (!pointers) return tl::unexpected(pointers.error());
  if (const auto taken = take_pointers(*pointers, *status); !taken) return tl::unexpected(taken.error());
  return status;
}

Result<UnitStatus> UnitClient::state() {
  return link_.ask(kEcho, kEchoOnly, kStatusHead).and_then([](Registers head) {
    head.resize(kStatus.count, 0);
    return status_in(head);
  });
}

}  // namespace ecs::protocol
