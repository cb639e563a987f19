// HID devices that exist only for programs under umockdev-wrapper: the real hidapi lists, opens and reads them. A
// device is plugged in, sends reports, answers what is written to it, and is pulled out.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

struct _UMockdevTestbed;

namespace ecs::fake {

inline void rest(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

using Bytes = std::vector<std::uint8_t>;

/// `count` hexadecimal bytes with or without blanks.
[[nodiscard]] Bytes from_hex(const std::string& text);

struct DeviceSpec {
  std::uint16_t vendor_id = 0x16C0;
  std::uint16_t product_id = 0x27DB;
  std::string manufacturer = "Maker";
  std::string product = "Pedal";
  std::string serial;
  int interface = 0;
  Bytes descriptor;  ///< report descriptor
  Bytes feature;     ///< what HIDIOCGFEATURE answers, report number first; empty: none
};

/// 8 bytes in, 8 out, vendor page: the descriptor of feasibility tests and of the TEMPer sticks.
[[nodiscard]] Bytes eight_bytes_descriptor();

class Bus;

/// One device; lives until unplug().
class Device {
 public:
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  void send(const Bytes& report);
  /// Whatever the host writes (report number first) is answered with these reports, from now on.
  void answers(std::function<std::vector<Bytes>(const Bytes&)> how);
  void unplug();
  [[nodiscard]] const std::string& node() const { return node_; }  ///< "/dev/hidraw0"

 private:
  friend class Bus;
  Device(_UMockdevTestbed* testbed, std::vector<std::string> paths, std::string node);
  void serve();
  void forget_terminal();

  _UMockdevTestbed* testbed_;
  std::vector<std::string> paths_;
  std::string node_;
  int descriptor_ = -1;
  std::atomic<bool> gone_{false};
  std::mutex mutex_;
  std::function<std::vector<Bytes>(const Bytes&)> how_;
  std::thread server_;
};

class Bus {
 public:
  Bus();
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  [[nodiscard]] std::unique_ptr<Device> plug(const DeviceSpec& spec);
  /// Takes the permission to open a device away, from everybody but root.
  void forbid(const Device& device) const;

 private:
  _UMockdevTestbed* testbed_;
  int next_ = 0;
};

/// A stick that answers the TEMPer query with `reply` (one or several reports of 8 bytes).
[[nodiscard]] DeviceSpec temper_spec(std::uint16_t vendor_id, std::uint16_t product_id);
void answer_like_temper(Device& device, std::vector<Bytes> replies);

/// A pedal: report of 8 bytes, bit 0 of byte 0 is the switch.
[[nodiscard]] DeviceSpec pedal_spec(const std::string& serial = "");
void press(Device& pedal, int held_ms = 40);
/// The same with a contact that bounces `times` at both ends, a few milliseconds each.
void press_bouncing(Device& pedal, int times);

/// An indicator that sends its value in 0.1 um as 4 bytes, little endian, after "D".
[[nodiscard]] DeviceSpec gauge_spec();
void show(Device& gauge, double value_um);

}  // namespace ecs::fake
