// The udev rules that let a user open the devices: one line for each kind. Does not live here: who prints them (app/).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "devices/description.hpp"

namespace ecs::devices {

/// One rule: whoever sits at the machine (uaccess) and the group plugdev may read and write.
[[nodiscard]] std::string udev_rule(std::uint16_t vendor_id, std::uint16_t product_id);

/// The file 70-ecs.rules: a rule for every id of `devices`, each once, below a heading that says where it goes.
[[nodiscard]] std::string udev_rules(const std::vector<DeviceDescription>& devices);

}  // namespace ecs::devices
