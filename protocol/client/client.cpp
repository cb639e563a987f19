// Typed reads, and a map sent whole or not at all.
#include "protocol/client/client.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/file.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {

namespace {

const Registers kEchoOnly{0};  ///< the link fills it in

}  // namespace

Result<UnitClient> UnitClient::connect(const LinkAddress& address, const LinkOptions& options) {
  auto link = Link::open(address, options);
  if (!link) return tl::unexpected(link.error());
  UnitClient client(std::move(*link));
  const auto identity = client.identity();
  if (!identity) return tl::unexpected(identity.error());
  if (identity->protocol_version != kProtocolVersion)
    return problem(
        ProblemKind::link,
        fmt::format("{}: the unit speaks protocol version {}, this program version {}; use matching versions",
                    to_text(address), identity->protocol_version, kProtocolVersion));
  return client;
}

Result<Identity> UnitClient::identity() { return link_.ask(kEcho, kEchoOnly, kIdentity).and_then(identity_in); }

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

/// Takes back what was staged before any commit, even after a cancel.
Problem UnitClient::given_up(Problem why) {
  if (!link_.connected()) return why;
  link_.heed_cancel(false);
  if (const auto abandoned = abandon_staged(); !abandoned && link_.last_failure() != LinkFailure::none)
    why.message += " (what was sent could not be abandoned; the old map is active)";
  link_.heed_cancel(true);
  return why;
}

Address address_of(Bank bank) { return bank == Bank::B ? kBankB.first : kBankA.first; }

Result<void> UnitClient::upload_image(std::span<const std::uint8_t> image, const UploadOptions& options,
                                      const ProgressCallback& progress) {
  const auto address = begin_staging(options.copy_active);
  if (!address) return tl::unexpected(address.error());
  if (auto staged = stage(*address, image, options, progress); !staged)
    return tl::unexpected(given_up(std::move(staged.error())));
  return commit_staged(static_cast<std::uint32_t>(image.size()), crc32_of(image));
}

}  // namespace ecs::protocol
