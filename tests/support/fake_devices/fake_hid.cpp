#include "tests/support/fake_devices/fake_hid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <umockdev.h>
#include <unistd.h>

namespace ecs::fake {
namespace {

constexpr std::size_t kWritten = 9;  ///< report number and 8 bytes

std::string hex_of(const Bytes& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{:02X}", byte);
  return text;
}

/// The one ioctl that hidapi needs to open a device, and what a feature report answers.
void answer_ioctls(UMockdevTestbed* testbed, const DeviceSpec& spec, int number) {
  const std::filesystem::path ioctl =
      std::filesystem::temp_directory_path() / fmt::format("ecs-fake-{}-{}.ioctl", ::getpid(), number);
  std::ofstream file(ioctl);
  file << fmt::format("@DEV /dev/hidraw{}\nHIDIOCGRDESCSIZE 0 {:02X}000000\n", number, spec.descriptor.size());
  if (!spec.feature.empty()) file << fmt::format("HIDIOCGFEATURE {} {}\n", spec.feature.size(), hex_of(spec.feature));
  file.close();
  GError* error = nullptr;
  if (umockdev_testbed_load_ioctl(testbed, fmt::format("/dev/hidraw{}", number).c_str(), ioctl.c_str(), &error) == 0)
    throw std::runtime_error(error == nullptr ? "umockdev refuses the ioctl" : error->message);
  std::filesystem::remove(ioctl);
}

}  // namespace

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  std::string digits;
  for (const char c : text)
    if (c != ' ') digits += c;
  for (std::size_t k = 0; k + 1 < digits.size(); k += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(digits.substr(k, 2), nullptr, 16)));
  return bytes;
}

Bytes eight_bytes_descriptor() { return from_hex("0600FF0901A10119012908150026FF00750895088102190129089102C0"); }

Device::Device(_UMockdevTestbed* testbed, std::vector<std::string> paths, std::string node)
    : testbed_(testbed), paths_(std::move(paths)), node_(std::move(node)) {
  descriptor_ = umockdev_testbed_get_dev_fd(testbed_, node_.c_str());
  if (descriptor_ < 0) throw std::runtime_error("no descriptor for " + node_);
  ::fcntl(descriptor_, F_SETFD, FD_CLOEXEC);  // a program started later must not hold the device itself
  server_ = std::thread([this] { serve(); });
}

Device::~Device() { unplug(); }

void Device::serve() {
  Bytes written;
  while (!gone_) {
    pollfd wanted{descriptor_, POLLIN, 0};
    if (::poll(&wanted, 1, 5) <= 0 || (wanted.revents & POLLIN) == 0) {
      if (wanted.revents != 0) rest(2);
      continue;
    }
    std::uint8_t piece[64];
    const ssize_t count = ::read(descriptor_, piece, sizeof piece);
    if (count <= 0) {
      rest(2);
      continue;
    }
    written.insert(written.end(), piece, piece + count);
    if (written.size() < kWritten) continue;
    std::function<std::vector<Bytes>(const Bytes&)> how;
    {
      const std::lock_guard lock(mutex_);
      how = how_;
    }
    if (how)
      for (const Bytes& reply : how(written)) {
        rest(15);  // the fake loses the ends of reports that stand in the queue together
        send(reply);
      }
    written.clear();
  }
}

void Device::send(const Bytes& report) {
  if (!gone_ && ::write(descriptor_, report.data(), report.size()) < 0) std::perror("fake device");
}

void Device::answers(std::function<std::vector<Bytes>(const Bytes&)> how) {
  const std::lock_guard lock(mutex_);
  how_ = std::move(how);
}

void Device::unplug() {
  if (gone_.exchange(true)) return;
  server_.join();
  for (const std::string& path : paths_) umockdev_testbed_remove_device(testbed_, path.c_str());
  forget_terminal();
  ::close(descriptor_);
}

/// umockdev keeps the number of the pseudo-terminal that played the device and trips over it when the kernel gives the
/// same number to the next one.
void Device::forget_terminal() {
  char name[128];
  if (::ptsname_r(descriptor_, name, sizeof name) != 0) return;
  gchar* given = umockdev_testbed_get_root_dir(testbed_);
  std::string link = name;
  std::replace(link.begin(), link.end(), '/', '_');
  std::error_code ignored;
  std::filesystem::remove(std::filesystem::path(given) / "dev/.ptymap" / link, ignored);
  g_free(given);
}

Bus::Bus() : testbed_(umockdev_testbed_new()) {}
Bus::~Bus() { g_object_unref(testbed_); }

void Bus::forbid(const Device& device) const {
  gchar* given = umockdev_testbed_get_root_dir(testbed_);
  const std::filesystem::path root = given;
  g_free(given);
  const auto all = std::filesystem::perms::all;
  std::filesystem::permissions(root, all);  // what the fake itself needs stays open
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "ioctl"))
    std::filesystem::permissions(entry.path(), all);
  std::filesystem::permissions(root.string() + device.node(), std::filesystem::perms::none);
}

std::unique_ptr<Device> Bus::plug(const DeviceSpec& spec) {
  const int number = next_++;
  const std::string ids = fmt::format("{:04X}:{:04X}", spec.vendor_id, spec.product_id);
  const std::string usb = fmt::format("/devices/pci0000:00/0000:00:14.0/usb1/1-{}", number + 1);
  const std::string port = fmt::format("{}/1-{}:1.{}", usb, number + 1, spec.interface);
  const std::string hid = fmt::format("{}/0003:{}.{:04X}", port, ids, number + 1);
  const std::string node = fmt::format("hidraw{}", number);
  const std::string raw = fmt::format("{}/hidraw/{}", hid, node);
  std::string text = fmt::format(
      "P: {}\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nA: bcdDevice=0100\\n\nA: manufacturer={}\\n\nA: product={}\\n\n",
      usb, spec.manufacturer, spec.product);
  if (!spec.serial.empty()) text += fmt::format("A: serial={}\\n\n", spec.serial);
  text += fmt::format("\nP: {}\nE: DEVTYPE=usb_interface\nE: SUBSYSTEM=usb\nA: bInterfaceNumber={:02d}\\n\n", port,
                      spec.interface);
  text += fmt::format(
      "\nP: {}\nE: HID_ID=0003:0000{:04X}:0000{:04X}\nE: HID_NAME={} {}\nE: HID_UNIQ={}\nE: SUBSYSTEM=hid\nH: "
      "report_descriptor={}\n",
      hid, spec.vendor_id, spec.product_id, spec.manufacturer, spec.product, spec.serial, hex_of(spec.descriptor));
  text += fmt::format(
      "\nP: {}\nN: {}\nL: device=../../../0003:{}.{:04X}\nE: DEVNAME=/dev/{}\nE: MAJOR=240\nE: MINOR={}\nE: "
      "SUBSYSTEM=hidraw\nA: dev=240:{}\\n\n\n",
      raw, node, ids, number + 1, node, number, number);
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(testbed_, text.c_str(), &error) == 0)
    throw std::runtime_error(error == nullptr ? "umockdev refuses the device" : error->message);
  answer_ioctls(testbed_, spec, number);
  return std::unique_ptr<Device>(
      new Device(testbed_, {"/sys" + raw, "/sys" + hid, "/sys" + port, "/sys" + usb}, "/dev/" + node));
}

DeviceSpec temper_spec(std::uint16_t vendor_id, std::uint16_t product_id) {
  DeviceSpec spec;
  spec.vendor_id = vendor_id;
  spec.product_id = product_id;
  spec.manufacturer = "RDing";
  spec.product = "TEMPer";
  spec.interface = 1;
  spec.descriptor = eight_bytes_descriptor();
  return spec;
}

void answer_like_temper(Device& device, std::vector<Bytes> replies) {
  device.answers([replies = std::move(replies)](const Bytes& written) {
    return written == from_hex("00 01 80 33 01 00 00 00 00") ? replies : std::vector<Bytes>{};
  });
}

DeviceSpec pedal_spec(const std::string& serial) {
  DeviceSpec spec;
  spec.serial = serial;
  spec.descriptor = eight_bytes_descriptor();
  return spec;
}

void press(Device& pedal, int held_ms) {
  pedal.send({1, 0, 0, 0, 0, 0, 0, 0});
  rest(held_ms);
  pedal.send({0, 0, 0, 0, 0, 0, 0, 0});
}

void press_bouncing(Device& pedal, int times) {
  for (const std::uint8_t last : {std::uint8_t{1}, std::uint8_t{0}}) {
    for (int k = 0; k < times; ++k) {
      pedal.send({last, 0, 0, 0, 0, 0, 0, 0});
      rest(4);
      pedal.send({static_cast<std::uint8_t>(1 - last), 0, 0, 0, 0, 0, 0, 0});
      rest(4);
    }
    pedal.send({last, 0, 0, 0, 0, 0, 0, 0});
    rest(120);
  }
}

DeviceSpec gauge_spec() {
  DeviceSpec spec;
  spec.vendor_id = 0x0483;
  spec.product_id = 0x5750;
  spec.manufacturer = "Gauge Works";
  spec.product = "Indicator";
  spec.descriptor = eight_bytes_descriptor();
  return spec;
}

void show(Device& gauge, double value_um) {
  const auto raw = static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(value_um * 10.0)));
  Bytes report{'D'};
  for (unsigned k = 0; k < 4; ++k) report.push_back(static_cast<std::uint8_t>(raw >> 8U * k));
  report.resize(8, 0);
  gauge.send(report);
}

}  // namespace ecs::fake
