// Typed reads, and a map sent whole or not at all.
#include "protocol/client/client.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/file.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {

namespace {

const Registers kEchoOnly{0};  ///< the link fills it in

/// Where a map is staged while that bank is active.
Address inactive_bank_beside(Bank active) { return active == Bank::A ? kBankB.first : kBankA.first; }

Problem wrong_bank(Address named, const UnitStatus& before) {
  return {ProblemKind::link,
          fmt::format("the unit names 0x{:06X} to write the map to, expected 0x{:06X}, the bank beside the active one; "
                      "another host uses the unit, or its answers are wrong; nothing was written",
                      named, inactive_bank_beside(before.active_bank)),
          {},
          0,
          0,
          {}};
}

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

Result<void> UnitClient::stage(Address address, std::span<const std::uint8_t> image, const UploadOptions& options,
                               const ProgressCallback& progress) {
  const bool in_part = options.copy_active && options.changed_bytes > 0;
  const auto travels = image.first(in_part ? std::min(options.changed_bytes, image.size()) : image.size());
  if (auto written = write_memory(address, travels, progress); !written) return written;
  if (!options.read_back) return {};
  const auto held = read_memory(address, image.size(), progress);
  if (!held) return tl::unexpected(held.error());
  if (!std::equal(held->begin(), held->end(), image.begin(), image.end()))
    return problem(ProblemKind::link, "what was read back from the unit is not what was sent; test its memory");
  return {};
}

Address address_of(Bank bank) { return bank == Bank::B ? kBankB.first : kBankA.first; }

Result<void> UnitClient::upload_image(std::span<const std::uint8_t> image, const UploadOptions& options,
                                      const ProgressCallback& progress) {
  if (serial_number_.empty())
    if (const auto first = identity(); !first) return tl::unexpected(first.error());
  const auto before = status();
  if (!before) return tl::unexpected(before.error());
  const auto address = begin_staging(options.copy_active);
  if (!address) return tl::unexpected(given_up(address.error(), *before));
  if (*address != inactive_bank_beside(before->active_bank))
    return tl::unexpected(given_up(wrong_bank(*address, *before), *before));
  if (auto staged = same_unit().and_then([&] { return stage(*address, image, options, progress); }); !staged)
    return tl::unexpected(given_up(std::move(staged.error()), *before));
  if (auto still = nothing_else_committed(*before); !still)
    return tl::unexpected(given_up(std::move(still.error()), *before));
  return commit_staged(*before, static_cast<std::uint32_t>(image.size()), crc32_of(image));
}

}  // namespace ecs::protocol
