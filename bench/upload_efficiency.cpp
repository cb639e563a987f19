// How much of a serial link an upload uses: payload ÷ (baud/10 × time), everything included (staging, headers,
// acknowledgements, check, commit), on a pseudo-terminal paced like a wire: 10 bits a byte both ways and the silent
// gaps. The yardstick is plain function 16 with 123 registers: 255 + 8 bytes and two gaps for 246 bytes of payload.
#include <atomic>
#include <chrono>
#include <random>
#include <thread>
#include <vector>

#include <fmt/core.h>

#include "base/file.hpp"
#include "protocol/client/client.hpp"
#include "protocol/server/register_server.hpp"
#include "protocol/server/server.hpp"

namespace {

using namespace ecs;
using namespace ecs::protocol;

/// One bank of memory that takes everything.
class PlainMemory : public UnitPort {
 public:
  Identity identity() override { return {kProtocolVersion, 1, 0, "BENCH", "bench", 1, {true, true, true}, 32'000}; }
  UnitStatus status() override { return status_; }
  MonitorSample monitor() override { return {}; }
  UnitError read_memory(Address address, std::span<std::uint8_t> out) override {
    if (!holds(address, out.size())) return UnitError::address_unknown;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(address - kBankA.first), out.size(), out.begin());
    return UnitError::none;
  }
  UnitError may_write(Address address, std::uint32_t size) override {
    return holds(address, size) ? UnitError::none : UnitError::address_unknown;
  }
  UnitError write_memory(Address address, std::span<const std::uint8_t> bytes) override {
    if (!holds(address, bytes.size())) return UnitError::address_unknown;
    std::copy(bytes.begin(), bytes.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(address - kBankA.first));
    return UnitError::none;
  }
  CommandResult begin(const Command& command) override {
    CommandResult result{0, CommandState::done, UnitError::none, 0, kBankA.first, {}};
    const bool commits = command.code == CommandCode::commit_staged;
    if (commits && crc32_of(std::span(bytes_).first(command.length)) != command.crc)
      result.state = CommandState::failed;
    else if (commits)
      result.value = activate(command.length);
    return result;
  }
  CommandResult progress() override { return {}; }

 private:
  [[nodiscard]] bool holds(Address address, std::size_t size) const {
    return address >= kBankA.first && address - kBankA.first + size <= bytes_.size();
  }
  /// The commit sequence afterwards.
  std::uint32_t activate(std::uint32_t length) {
    status_.active_bank = Bank::A;
    status_.image_length_bytes = length;
    return ++status_.commit_sequence;
  }
  UnitStatus status_;
  std::vector<std::uint8_t> bytes_ = std::vector<std::uint8_t>(kBankBytes);
};

double plain_efficiency(const LinkTiming& timing) {
  constexpr double kPayload = 246.0;
  constexpr double kWireBytes = 255.0 + 8.0;
  const std::chrono::duration<double> byte_s = timing.byte_time;
  const std::chrono::duration<double> gap_s = timing.frame_gap;
  return kPayload * byte_s.count() / (kWireBytes * byte_s.count() + 2.0 * gap_s.count());
}

bool measure(int baud, std::size_t size) {
  auto server = ModbusServer::on_pty({{}, baud, true, 1});
  if (!server) return false;
  const LinkAddress address = server->address();
  std::atomic<bool> ended{false};
  std::thread unit([&] {
    PlainMemory memory;
    RegisterServer registers(memory);
    while (!ended) server->serve_ready(registers, std::chrono::milliseconds(20));
  });
  std::vector<std::uint8_t> image(size);
  std::mt19937 random(1);
  for (auto& byte : image) byte = static_cast<std::uint8_t>(random());

  auto client = UnitClient::connect(address);
  const auto begun = std::chrono::steady_clock::now();
  const auto sent = client.and_then([&](UnitClient& connected) { return connected.upload_image(image); });
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun;
  ended = true;
  unit.join();
  if (!sent) {
    fmt::print("{:>7} baud: {}\n", baud, to_text(sent.error()));
    return false;
  }
  const double efficiency = static_cast<double>(size) / (baud / 10.0 * spent.count());
  const double plain = plain_efficiency(timing_of(address));
  fmt::print(
      "{:>7} baud {:>6} bytes {:>8.2f} s {:>8.1f} bytes/s {:>6.1f} %  of plain 123-register writes ({:.1f} %): {:.1f} "
      "%\n",
      baud, size, spent.count(), static_cast<double>(size) / spent.count(), 100.0 * efficiency, 100.0 * plain,
      100.0 * efficiency / plain);
  return true;
}

}  // namespace

int main() {
  const bool good = measure(9600, 20'480) && measure(38'400, 65'536) && measure(115'200, 65'536);
  return good ? 0 : 1;
}
