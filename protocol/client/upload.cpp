// A map sent whole or not at all, and of it only what the unit does not hold yet.
#include <algorithm>

#include <fmt/format.h>

#include "base/file.hpp"
#include "core/memory_image.hpp"
#include "protocol/client/client.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {

namespace {

using Image = std::span<const std::uint8_t>;

/// The image is compared with what the unit holds in pieces of so many bytes.
constexpr std::size_t kPieceBytes = 480;
/// A share of the pieces from which on the rest is sent without looking for more: asking costs as much as a piece.
constexpr double kNearlyAll = 0.8;

/// Where a map is staged while that bank is active.
Address inactive_bank_beside(Bank active) { return active == Bank::A ? kBankB.first : kBankA.first; }

Problem wrong_bank(Address named, const ActiveMap& before) {
  return {ProblemKind::link,
          fmt::format("the unit names 0x{:06X} to write the map to, expected 0x{:06X}, the bank beside the active one; "
                      "another host uses the unit, or its answers are wrong; nothing was written",
                      named, inactive_bank_beside(before.active_bank)),
          {},
          0,
          0,
          {}};
}

std::vector<std::uint32_t> checks_of(Image image) {
  std::vector<std::uint32_t> checks;
  for (std::size_t at = 0; at < image.size(); at += kPieceBytes)
    checks.push_back(crc32_of(image.subspan(at, std::min(kPieceBytes, image.size() - at))));
  return checks;
}

/// The stretches of the image whose pieces the unit does not hold.
std::vector<std::pair<std::size_t, std::size_t>> missing_stretches(const std::vector<bool>& held, std::size_t bytes) {
  std::vector<std::pair<std::size_t, std::size_t>> stretches;
  for (std::size_t piece = 0; piece < held.size(); ++piece) {
    if (held[piece]) continue;
    const std::size_t from = piece * kPieceBytes, to = std::min(from + kPieceBytes, bytes);
    if (!stretches.empty() && stretches.back().second == from)
      stretches.back().second = to;
    else
      stretches.emplace_back(from, to);
  }
  return stretches;
}

std::size_t count_of(const std::vector<bool>& held) {
  return static_cast<std::size_t>(std::count(held.begin(), held.end(), true));
}

/// Tells how far a transfer is. The time left follows from the speed on the wire, where coded bytes are short.
class WireMeter {
 public:
  WireMeter(const ProgressCallback& callback, std::size_t bytes, std::size_t held, std::size_t wire)
      : callback_(callback), bytes_(bytes), done_(held), wire_(wire) {}
  void reach(std::size_t done, std::size_t wire) {
    done_ = std::min(done, bytes_);
    if (!callback_) return;
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun_;
    const std::size_t left = wire_ - std::min(wire, wire_);
    callback_({done_, bytes_,
               spent.count() * static_cast<double>(left) / static_cast<double>(std::max<std::size_t>(wire, 1))});
  }

 private:
  const ProgressCallback& callback_;
  std::size_t bytes_;
  std::size_t done_;
  std::size_t wire_;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

}  // namespace

Address address_of(Bank bank) { return bank == Bank::B ? kBankB.first : kBankA.first; }

/// Which pieces of the image lie at `bank` already, by their checks.
Result<std::vector<bool>> UnitClient::held_at(Address bank, Image image) {
  const auto wanted = checks_of(image);
  std::vector<bool> held;
  while (held.size() < wanted.size()) {
    const std::size_t at = held.size() * kPieceBytes;
    const std::size_t count = std::min(kMostChecks, wanted.size() - held.size());
    const CheckSelect select{static_cast<Address>(bank + at),
                             static_cast<std::uint32_t>(std::min(count * kPieceBytes, image.size() - at)),
                             static_cast<std::uint16_t>(kPieceBytes)};
    const Block answer{kChecks.first, static_cast<std::uint16_t>(1 + 2 * count)};
    ECS_TRY(found, link_.ask(kCheckSelect, registers_of(select, 0), answer));
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t check = static_cast<std::uint32_t>(found[1 + 2 * i]) << 16 | found[2 + 2 * i];
      held.push_back(check == wanted[held.size()]);
    }
  }
  return held;
}

/// Where the staging begins: the active map, or what an earlier transfer has left, whichever has more of the image.
/// What was left is not asked for where the active map has nearly all.
Result<UnitClient::Beginning> UnitClient::beginning_for(const ActiveMap& before, Image image, Held by) {
  if (by == Held::nothing)
    return Beginning{StagingFrom::cleared, std::vector<bool>((image.size() + kPieceBytes - 1) / kPieceBytes)};
  Beginning beginning{StagingFrom::active, {}};
  if (before.active_bank != Bank::none) {
    ECS_TRY(active, held_at(address_of(before.active_bank), image));
    beginning.held = std::move(active);
    if (kNearlyAll * static_cast<double>(beginning.held.size()) <= static_cast<double>(count_of(beginning.held)))
      return beginning;
  }
  ECS_TRY(left, held_at(inactive_bank_beside(before.active_bank), image));
  if (beginning.held.empty() || count_of(left) >= count_of(beginning.held))
    beginning = {StagingFrom::kept, std::move(left)};
  return beginning;
}

Result<void> UnitClient::stage(Address address, Image image, const std::vector<bool>& held,
                               const ProgressCallback& progress, UploadReport& report) {
  std::vector<WindowFrames> windows;
  std::size_t missing = 0, wire = 0;
  for (const auto& [from, to] : missing_stretches(held, image.size())) {
    for (WindowFrames& window : windows_of(address, image, from, to)) windows.push_back(std::move(window));
    missing += to - from;
  }
  for (const WindowFrames& window : windows) wire += wire_bytes(window);
  report.bytes_sent = missing;
  WireMeter meter(progress, image.size(), image.size() - missing, wire);
  std::size_t done = image.size() - missing, on_wire = 0;
  for (const WindowFrames& window : windows) {
    std::size_t brought = 0, bytes = 0;
    const auto sent = [&](const BlockFrame& frame) {
      brought = std::min(brought + frame.bytes, window.bytes.size());
      bytes += frame.payload.size();
      meter.reach(done + brought, on_wire + std::min(bytes, wire_bytes(window)));
    };
    if (const auto written = write_window(window, sent); !written) return written;
    done += window.bytes.size();
    on_wire += wire_bytes(window);
    meter.reach(done, on_wire);
  }
  meter.reach(image.size(), wire);
  return {};
}

Result<UploadReport> UnitClient::upload_image(Image image, const ProgressCallback& progress, Held held) {
  ECS_TRY(before, active_map());
  const SentImage sent{image, crc32_of(image)};
  UploadReport report{image.size(), 0, before.commit_sequence, true};
  if (held == Held::by_checks && names(before, image)) {
    if (progress) progress({image.size(), image.size(), 0.0});
    return report;
  }
  const auto beginning = beginning_for(before, image, held);
  if (!beginning) return tl::unexpected(given_up(beginning.error(), before));
  const auto address = begin_staging(beginning->from);
  if (!address) return tl::unexpected(given_up(address.error(), before));
  if (*address != inactive_bank_beside(before.active_bank))
    return tl::unexpected(given_up(wrong_bank(*address, before), before));
  if (auto staged = stage(*address, image, beginning->held, progress, report); !staged)
    return tl::unexpected(given_up(std::move(staged.error()), before));
  if (auto still = nothing_else_committed(before); !still)
    return tl::unexpected(given_up(std::move(still.error()), before));
  ECS_TRY(committed, commit_staged(before, sent));
  report.commit_sequence = committed;
  report.already_held = false;
  return report;
}

}  // namespace ecs::protocol
