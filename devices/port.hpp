// A described device that may be unplugged and come back: found, opened, read; lost and found again.
// Does not live here: what its reports mean (description.hpp), hidapi (hid_device.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "devices/description.hpp"

namespace ecs::devices {

/// The one device among `present` that is meant. A `link` problem says what is plugged in instead, or names the devices
/// that are alike and how to tell them apart.
[[nodiscard]] Result<HidIdentity> matching(const DeviceDescription& device, const std::vector<HidIdentity>& present);

/// What has become of a device since it was last asked.
enum class PortChange { none, lost, back };

class DevicePort {
 public:
  /// Opens the device. Fails where it is not there, is not to be told from others, or may not be opened.
  [[nodiscard]] static Result<DevicePort> open(DeviceDescription device);

  /// Looks for a lost device, at most twice a second. @param now_s  steady time
  [[nodiscard]] PortChange look(double now_s);

  /// An input report of this device's layout within the time; nothing if none came, or the device is away.
  [[nodiscard]] std::optional<Bytes> read(std::chrono::milliseconds timeout);
  /// Sends the poll. False: the device is away.
  [[nodiscard]] bool poll();
  /// The feature report of the layout; nothing if the device is away.
  [[nodiscard]] std::optional<Bytes> feature();

  [[nodiscard]] bool present() const { return open_.has_value(); }
  [[nodiscard]] const DeviceDescription& device() const { return device_; }
  [[nodiscard]] const HidIdentity& identity() const { return identity_; }
  /// Why a lost device cannot be had back yet; empty: it is simply not there.
  [[nodiscard]] const std::string& hindrance() const { return hindrance_; }

 private:
  explicit DevicePort(DeviceDescription device) : device_(std::move(device)) {}
  [[nodiscard]] Result<void> connect();
  void lose();

  DeviceDescription device_;
  HidIdentity identity_;
  std::optional<HidDevice> open_;
  std::size_t report_bytes_ = 64;
  bool loss_told_ = true;
  double looked_s_ = -1e9;
  std::string hindrance_;
};

}  // namespace ecs::devices
