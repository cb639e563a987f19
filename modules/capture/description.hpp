// USB HID devices as the kernel shows them (hidraw): which there are, opening one, its reports, and how long these are
// by its report descriptor. What a device of the workshop is and how its reports read, as TOML
// (modules/capture/README.md): a measuring trigger, a sensor of the surroundings, an indicator gauge. The descriptions
// that come with the program: thermometers whose protocol is public. The udev rules that let a user open the devices.
// Does not live here: devices that come and go (port.hpp).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
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

enum class DeviceKind { trigger, environment, gauge };

/// What one number of a report is.
enum class Quantity { air_degC, material_degC, pressure_hPa, humidity_pct, reading_um };

[[nodiscard]] std::string_view name_of(DeviceKind kind);
[[nodiscard]] std::string_view name_of(Quantity quantity);

/// Which device is meant; what is absent is not asked for.
struct DeviceMatch {
  struct Ids {
    std::uint16_t vendor_id = 0;
    std::uint16_t product_id = 0;
    friend bool operator==(const Ids&, const Ids&) = default;
  };
  std::vector<Ids> ids;  ///< any of them
  std::optional<std::string> serial;
  std::optional<std::string> path;
  std::optional<int> interface;
  std::optional<std::uint16_t> usage_page;
};

/// How a report is had.
struct ReportLayout {
  bool feature = false;          ///< a feature report that is asked for; else input reports
  std::uint8_t number = 0;       ///< 0: not numbered. Other input reports are passed over
  std::size_t bytes = 0;         ///< number included; 0: as the device's report descriptor says
  Bytes poll;                    ///< sent before each reading; empty: the device sends on its own
  std::uint8_t poll_number = 0;  ///< number of that output report
  int replies = 1;               ///< most reports that answer one poll
  int timeout_ms = 500;          ///< for the first reply; later ones follow within a quarter of it
};

struct TriggerLayout {
  std::size_t byte = 0;
  std::uint8_t mask = 1;    ///< the button is held when all of these bits are active
  bool active_high = true;  ///< 1 means held
  int debounce_ms = 30;     ///< the button counts again once it was let go for so long
};

/// One number: value = raw · scale + offset.
struct ReportField {
  Quantity quantity = Quantity::air_degC;
  std::size_t byte = 0;  ///< of its first byte in the report, the report number counted
  int bytes = 2;         ///< 1 … 4
  bool big_endian = false;
  bool is_signed = true;
  double scale = 1.0;
  double offset = 0.0;
  std::optional<std::int64_t> absent;  ///< raw value that means "no sensor"
  Bytes starts;                        ///< only in a report that starts so; empty: the first reply
};

struct DeviceDescription {
  std::string name;
  std::string file;    ///< where it was read; empty: built in
  std::string source;  ///< what the description is from
  DeviceKind kind = DeviceKind::trigger;
  DeviceMatch match;
  ReportLayout report;
  TriggerLayout trigger;
  std::vector<ReportField> fields;
};

/// Every wrong, unknown or missing key at once, with its line.
[[nodiscard]] Result<DeviceDescription> parse_device(std::string_view text, const std::string& file);
[[nodiscard]] Result<DeviceDescription> read_device(const std::filesystem::path& path);

/// Text that parse_device() reads back as the same description.
[[nodiscard]] std::string to_toml(const DeviceDescription& device);

/// The level of the button in a report; nothing in a report of another number, or one that is too short.
[[nodiscard]] std::optional<bool> held_in(const DeviceDescription& device, const Bytes& report);

using Values = std::map<Quantity, double>;
/// The numbers in the replies to one poll; without a sensor, or in a short report, a number is left out.
[[nodiscard]] Values values_in(const DeviceDescription& device, const std::vector<Bytes>& replies);

/// Thermometers of the TEMPer family, by the names "temper-fm75" and "temper-hundredths"; from public descriptions that
/// `source` names, none tried on a real stick.
[[nodiscard]] const std::vector<DeviceDescription>& builtin_devices();

/// The built-in descriptions that a name stands for: its own, or "temper" for all of the family.
[[nodiscard]] std::vector<DeviceDescription> builtin_named(const std::string& name);

/// One rule: whoever sits at the machine (uaccess) and the group plugdev may read and write.
[[nodiscard]] std::string udev_rule(std::uint16_t vendor_id, std::uint16_t product_id);

/// The file 70-ecs.rules: a rule for every id of `devices`, each once, below a heading that says where it goes.
[[nodiscard]] std::string udev_rules(const std::vector<DeviceDescription>& devices);

}  // namespace ecs::devices
