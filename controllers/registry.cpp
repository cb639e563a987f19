#include "controllers/registry.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace ecs::controllers {

extern const ControllerFormat kLinuxCnc, kSiemens, kEtalon, kTwinCat, kHeidenhain, kAerotech;

std::span<const ControllerFormat* const> controller_formats() {
  static constexpr std::array<const ControllerFormat*, 6> kFormats{
      &kLinuxCnc, &kSiemens, &kEtalon, &kTwinCat, &kHeidenhain, &kAerotech,
  };
  return kFormats;
}

const ControllerFormat* controller_format(std::string_view id) {
  const auto formats = controller_formats();
  const auto at = std::find_if(formats.begin(), formats.end(), [&](const auto* format) { return format->id == id; });
  return at == formats.end() ? nullptr : *at;
}

const ControllerFormat* recognised_format(std::string_view text) {
  const auto formats = controller_formats();
  const auto at =
      std::find_if(formats.begin(), formats.end(), [&](const auto* format) { return format->recognises(text); });
  return at == formats.end() ? nullptr : *at;
}

std::string holds_row(const ControllerFormat& format) {
  const Holds& holds = format.holds;
  return fmt::format("| {} | {} | {} | {} | {} | {} | {} |", format.name, holds.positioning, holds.reversal,
                     holds.straightness, holds.squareness, holds.rotations, holds.points);
}

}  // namespace ecs::controllers
