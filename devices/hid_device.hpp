// USB HID devices as the kernel shows them (hidraw): which there are, opening one, its reports.
// Does not live here: what the bytes mean (description.hpp), devices that come and go (port.hpp).
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "devices/hid_descriptor.hpp"

namespace ecs::devices {

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
