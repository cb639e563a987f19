// How long the reports of a USB HID device are, from its report descriptor.
// Does not live here: reading the descriptor of a device that is plugged in (hid_device.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

namespace ecs::devices {

/// Lengths in bytes as they are read and written, the leading report number included where the device numbers them.
struct HidReports {
  bool numbered = false;                      ///< every report begins with its number
  std::map<std::uint8_t, std::size_t> input;  ///< by report number; 0: not numbered
  std::map<std::uint8_t, std::size_t> output;
  std::map<std::uint8_t, std::size_t> feature;
  friend bool operator==(const HidReports&, const HidReports&) = default;
};

/// Reads the items of a descriptor (USB Device Class Definition for HID 1.11, 6.2.2): Report Size, Report Count,
/// Report ID, Push, Pop, Input, Output, Feature. Never fails: what follows a cut item is left out.
[[nodiscard]] HidReports reports_in(std::span<const std::uint8_t> descriptor);

}  // namespace ecs::devices
