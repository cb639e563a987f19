// USB HID devices as the kernel shows them (hidraw): which there are, opening one, its reports, and how long these are
// by its report descriptor. Does not live here: what the bytes mean (description.hpp), devices that come and go
// (port.hpp).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"

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

using Bytes = std::vector<std::uint8_t>;

/// What a device tells of itself before it is opened.
struct HidIdentity {
  std::string path;  ///< "/dev/hidraw3"; another one when it is plugged in again
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::string serial;  ///< empty: it has none
  std::string manufacturer;
  std::string product;
  int interface = -1;            ///< of a USB device with several; -1: unknown
  std::uint16_t usage_page = 0;  ///< of its first collection; 0: unknown
  std::uint16_t usage = 0;
  HidReports reports;  ///< lengths; empty where the descriptor cannot be read
  friend bool operator==(const HidIdentity&, const HidIdentity&) = default;
};

/// "0c45:7401 RDing TEMPerV1.4 (/dev/hidraw3, interface 1, serial SN0001)"
[[nodiscard]] std::string to_text(const HidIdentity& identity);

/// Every HID device that is plugged in, each once, by path. Needs no permission on the devices.
[[nodiscard]] Result<std::vector<HidIdentity>> hid_devices();

/// An open device. Destroying it closes it. Once a call has failed the device is gone: close it, look for it again.
class HidDevice {
 public:
  /// A `link` problem says why not: no permission (with the udev rule that gives it), in use, gone.
  [[nodiscard]] static Result<HidDevice> open(const HidIdentity& identity);

  HidDevice(HidDevice&&) noexcept;
  HidDevice& operator=(HidDevice&&) noexcept;
  HidDevice(const HidDevice&) = delete;
  HidDevice& operator=(const HidDevice&) = delete;
  ~HidDevice();

  /// The next input report, its number first where the device numbers them; nothing within the time is nothing.
  /// @param most_bytes  a longer report is cut
  [[nodiscard]] Result<std::optional<Bytes>> read(std::size_t most_bytes, std::chrono::milliseconds timeout);
  /// Sends an output report. @param number  0: not numbered
  [[nodiscard]] Result<void> write(std::uint8_t number, std::span<const std::uint8_t> content);
  /// A feature report, its number first where it has one (`number` above 0). @param bytes  number included
  [[nodiscard]] Result<Bytes> feature(std::uint8_t number, std::size_t bytes);

 private:
  struct Handle;
  explicit HidDevice(std::unique_ptr<Handle> handle);
  [[nodiscard]] Problem gone(const char* doing) const;
  std::unique_ptr<Handle> handle_;
};

}  // namespace ecs::devices
