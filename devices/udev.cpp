#include "devices/udev.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace ecs::devices {

std::string udev_rule(std::uint16_t vendor_id, std::uint16_t product_id) {
  return fmt::format(
      "KERNEL==\"hidraw*\", ATTRS{{idVendor}}==\"{:04x}\", ATTRS{{idProduct}}==\"{:04x}\", MODE=\"0660\", "
      "GROUP=\"plugdev\", TAG+=\"uaccess\"",
      vendor_id, product_id);
}

std::string udev_rules(const std::vector<DeviceDescription>& devices) {
  std::string text =
      "# HID devices of the workshop, for ECS. Belongs to /etc/udev/rules.d/70-ecs.rules; afterwards:\n"
      "#   sudo udevadm control --reload && sudo udevadm trigger\n"
      "# The file's number stays below 73, where uaccess is dealt with.\n";
  std::vector<std::string> written;
  for (const DeviceDescription& device : devices)
    for (const DeviceMatch::Ids& ids : device.match.ids) {
      const std::string rule = udev_rule(ids.vendor_id, ids.product_id);
      if (std::find(written.begin(), written.end(), rule) != written.end()) continue;
      written.push_back(rule);
      text += fmt::format("# {}\n{}\n", device.name, rule);
    }
  return text;
}

}  // namespace ecs::devices
