#include "devices/hid_descriptor.hpp"

#include <algorithm>
#include <vector>

namespace ecs::devices {
namespace {

/// Tag and type of a short item, its size bits cleared (HID 1.11, 6.2.2.4 to 6.2.2.7).
enum Item : std::uint8_t {
  kReportSize = 0x74,
  kReportCount = 0x94,
  kReportId = 0x84,
  kPush = 0xA4,
  kPop = 0xB4,
  kInput = 0x80,
  kOutput = 0x90,
  kFeature = 0xB0,
};
constexpr std::uint8_t kLongItem = 0xFE;
constexpr std::size_t kMostBits = 8 * 8192;  ///< above this no descriptor is honest

struct State {
  std::size_t size_bits = 0;
  std::size_t count = 0;
  std::uint8_t id = 0;
};

using ReportBits = std::map<std::uint8_t, std::size_t>;

void add(ReportBits& bits, const State& state) {
  std::size_t& sum = bits[state.id];
  const bool honest = state.size_bits <= kMostBits && state.count <= kMostBits;
  sum = std::min(kMostBits, sum + (honest ? state.size_bits * state.count : kMostBits));
}

ReportBits as_bytes(const ReportBits& bits, bool numbered) {
  ReportBits bytes;
  for (const auto& [id, count] : bits) bytes[id] = (count + 7) / 8 + (numbered ? 1U : 0U);
  return bytes;
}

}  // namespace

HidReports reports_in(std::span<const std::uint8_t> descriptor) {
  State state;
  std::vector<State> stack;
  ReportBits input, output, feature;
  bool numbered = false;
  for (std::size_t at = 0; at < descriptor.size();) {
    const std::uint8_t head = descriptor[at];
    if (head == kLongItem) {
      if (at + 1 >= descriptor.size()) break;
      at += 3U + descriptor[at + 1];
      continue;
    }
    const std::size_t length = (head & 3U) == 3U ? 4U : head & 3U;
    if (at + length >= descriptor.size() && length > 0) break;
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < length; ++k) value |= static_cast<std::uint32_t>(descriptor[at + 1 + k]) << (8 * k);
    at += 1 + length;
    switch (head & 0xFCU) {
      case kReportSize:
        state.size_bits = value;
        break;
      case kReportCount:
        state.count = value;
        break;
      case kReportId:
        state.id = static_cast<std::uint8_t>(value);
        numbered = true;
        break;
      case kPush:
        if (stack.size() < 64) stack.push_back(state);
        break;
      case kPop:
        if (!stack.empty()) {
          state = stack.back();
          stack.pop_back();
        }
        break;
      case kInput:
        add(input, state);
        break;
      case kOutput:
        add(output, state);
        break;
      case kFeature:
        add(feature, state);
        break;
      default:
        break;
    }
  }
  return {numbered, as_bytes(input, numbered), as_bytes(output, numbered), as_bytes(feature, numbered)};
}

}  // namespace ecs::devices
