#include "commissioning/measurements/device_choice.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "devices/description.hpp"

namespace ecs::commissioning {
namespace {

struct Named {
  std::string name;
  std::string which;  ///< serial number or path; empty: not said
};

Named parts_of(const std::string& text) {
  const std::size_t at = text.rfind('@');
  std::error_code error;
  if (at == std::string::npos || at == 0 || std::filesystem::exists(text, error)) return {text, {}};
  return {text.substr(0, at), text.substr(at + 1)};
}

void narrow(devices::DeviceDescription& device, const std::string& which) {
  if (which.empty()) return;
  if (which.front() == '/')
    device.match.path = which;
  else
    device.match.serial = which;
}

}  // namespace

Result<std::vector<devices::DeviceDescription>> described(const std::string& text) {
  const Named named = parts_of(text);
  std::vector<devices::DeviceDescription> found = devices::builtin_named(named.name);
  std::error_code error;
  if (found.empty() || std::filesystem::exists(named.name, error)) {
    auto read = devices::read_device(named.name);
    if (!read) {
      Problem why = read.error();
      if (!std::filesystem::exists(named.name, error))
        why.message +=
            "; expected a device's description: `ecs laser devices --learn` makes one of a trigger, samples/devices "
            "has one of each kind, \"temper\" comes with the program";
      return tl::unexpected(std::move(why));
    }
    found = {std::move(*read)};
  }
  for (devices::DeviceDescription& device : found) narrow(device, named.which);
  return found;
}

Result<devices::DevicePort> opened_device(const std::string& text, devices::DeviceKind kind) {
  const auto devices = described(text);
  if (!devices) return tl::unexpected(devices.error());
  ECS_TRY(present, devices::hid_devices());
  const devices::DeviceDescription* chosen = &devices->front();
  for (const devices::DeviceDescription& device : *devices) {
    if (device.kind != kind)
      return problem(ProblemKind::usage, fmt::format("{}: expected a device of kind {}, this is one of kind {}", text,
                                                     devices::name_of(kind), devices::name_of(device.kind)));
    if (devices::matching(device, present)) chosen = &device;
  }
  return devices::DevicePort::open(*chosen);
}

std::string name_of(const devices::DevicePort& port) {
  return fmt::format("{} ({})", port.device().name, devices::to_text(port.identity()));
}

}  // namespace ecs::commissioning
