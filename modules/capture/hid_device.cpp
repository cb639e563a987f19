#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <hidapi/hidapi.h>
#include <unistd.h>

#include "modules/capture/description.hpp"

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

namespace {

constexpr std::size_t kLongestReport = 4096;

/// hidapi keeps one error text, and one list of devices in the making, for all threads.
std::mutex& library() {
  static std::mutex mutex;
  return mutex;
}

void append_utf8(std::string& text, std::uint32_t code) {
  if (code >= 0x110000 || (code >= 0xD800 && code < 0xE000)) code = 0xFFFD;
  const auto put = [&text](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return put(code);
  if (code < 0x800) {
    put(0xC0U | code >> 6U);
  } else if (code < 0x10000) {
    put(0xE0U | code >> 12U);
    put(0x80U | (code >> 6U & 0x3FU));
  } else {
    put(0xF0U | code >> 18U);
    put(0x80U | (code >> 12U & 0x3FU));
    put(0x80U | (code >> 6U & 0x3FU));
  }
  put(0x80U | (code & 0x3FU));
}

std::string utf8_of(const wchar_t* text) {
  std::string out;
  for (; text != nullptr && *text != L'\0'; ++text) append_utf8(out, static_cast<std::uint32_t>(*text));
  return out;
}

HidReports reports_of(const std::string& path) {
  const std::filesystem::path node =
      std::filesystem::path("/sys/class/hidraw") / std::filesystem::path(path).filename() / "device/report_descriptor";
  std::ifstream file(node, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return reports_in({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

HidIdentity identity_of(const hid_device_info& info) {
  HidIdentity out;
  out.path = info.path == nullptr ? "" : info.path;
  out.vendor_id = info.vendor_id;
  out.product_id = info.product_id;
  out.serial = utf8_of(info.serial_number);
  out.manufacturer = utf8_of(info.manufacturer_string);
  out.product = utf8_of(info.product_string);
  out.interface = info.interface_number;
  out.usage_page = info.usage_page;
  out.usage = info.usage;
  out.reports = reports_of(out.path);
  return out;
}

/// Why a device that is listed cannot be opened.
Problem not_opened(const HidIdentity& identity, int error) {
  std::string why = fmt::format("{} cannot be opened: {}", to_text(identity), std::strerror(error));
  if (error == EACCES || error == EPERM)
    why = fmt::format(
        "no permission for {}: add this line to /etc/udev/rules.d/70-ecs.rules (`ecs laser devices --udev` prints the "
        "file), run `sudo udevadm control --reload && sudo udevadm trigger`, plug it in again: {}",
        to_text(identity), udev_rule(identity.vendor_id, identity.product_id));
  if (error == ENOENT || error == ENODEV || error == ENXIO)
    why = fmt::format("{} was unplugged: plug it in again", to_text(identity));
  return {ProblemKind::link, std::move(why), {}, 0, 0, {}};
}

/// The reason that opening the node gives; 0 if it can be opened.
int error_of_opening(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return errno;
  ::close(descriptor);
  return 0;
}

}  // namespace

struct HidDevice::Handle {
  hid_device* device = nullptr;
  std::string name;
  Handle(hid_device* opened, std::string its_name) : device(opened), name(std::move(its_name)) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { hid_close(device); }
};

std::string to_text(const HidIdentity& identity) {
  std::string name = identity.manufacturer;
  if (!identity.product.empty()) name += (name.empty() ? "" : " ") + identity.product;
  std::string text = fmt::format("{:04x}:{:04x}{} ({}", identity.vendor_id, identity.product_id,
                                 name.empty() ? "" : " " + name, identity.path);
  if (identity.interface >= 0) text += fmt::format(", interface {}", identity.interface);
  if (!identity.serial.empty()) text += ", serial " + identity.serial;
  return text + ")";
}

Result<std::vector<HidIdentity>> hid_devices() {
  const std::lock_guard lock(library());
  if (hid_init() != 0) return problem(ProblemKind::output, "the HID library cannot be started");
  std::vector<HidIdentity> found;
  hid_device_info* list = hid_enumerate(0, 0);
  for (const hid_device_info* each = list; each != nullptr; each = each->next) {
    const bool known = std::ranges::any_of(
        found, [&](const HidIdentity& one) { return each->path != nullptr && one.path == each->path; });
    if (!known) found.push_back(identity_of(*each));
  }
  hid_free_enumeration(list);
  std::ranges::sort(found, [](const HidIdentity& a, const HidIdentity& b) {
    return a.path.size() != b.path.size() ? a.path.size() < b.path.size() : a.path < b.path;
  });
  return found;
}

Result<HidDevice> HidDevice::open(const HidIdentity& identity) {
  const std::lock_guard lock(library());
  if (const int error = error_of_opening(identity.path); error != 0) return tl::unexpected(not_opened(identity, error));
  hid_device* device = hid_open_path(identity.path.c_str());
  if (device == nullptr) return tl::unexpected(not_opened(identity, EIO));
  return HidDevice(std::make_unique<Handle>(device, to_text(identity)));
}

HidDevice::HidDevice(std::unique_ptr<Handle> handle) : handle_(std::move(handle)) {}
HidDevice::HidDevice(HidDevice&&) noexcept = default;
HidDevice& HidDevice::operator=(HidDevice&&) noexcept = default;
HidDevice::~HidDevice() = default;

Problem HidDevice::gone(const char* doing) const {
  return problem(ProblemKind::link, "{} cannot be {}: it was unplugged", handle_->name, doing).value();
}

Result<std::optional<Bytes>> HidDevice::read(std::size_t most_bytes, std::chrono::milliseconds timeout) {
  Bytes report(std::clamp<std::size_t>(most_bytes, 1, kLongestReport));
  const int count =
      hid_read_timeout(handle_->device, report.data(), report.size(), std::max(0, static_cast<int>(timeout.count())));
  if (count < 0) return tl::unexpected(gone("read"));
  if (count == 0) return std::nullopt;
  report.resize(static_cast<std::size_t>(count));
  return report;
}

Result<void> HidDevice::write(std::uint8_t number, std::span<const std::uint8_t> content) {
  Bytes report{number};
  report.insert(report.end(), content.begin(), content.end());
  if (hid_write(handle_->device, report.data(), report.size()) < 0) return tl::unexpected(gone("written to"));
  return {};
}

Result<Bytes> HidDevice::feature(std::uint8_t number, std::size_t bytes) {
  Bytes report(std::clamp<std::size_t>(bytes + (number == 0 ? 1 : 0), 1, kLongestReport));
  report[0] = number;
  const int count = hid_get_feature_report(handle_->device, report.data(), report.size());
  if (count < 0) return tl::unexpected(gone("asked for a feature report"));
  report.resize(std::min(report.size(), static_cast<std::size_t>(count)));
  if (number == 0 && !report.empty()) report.erase(report.begin());
  return report;
}

}  // namespace ecs::devices
