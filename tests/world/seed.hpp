// What a world has before anything happens: its source of chance, and the maps that its hosts send.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "tests/world/place.hpp"

namespace ecs::world {

/// While it lives, every number by chance of protocol and sodium comes from here. One at a time.
class SeededChance {
 public:
  explicit SeededChance(std::uint64_t seed);

 private:
  Random random_;
};

constexpr std::size_t kImages = 4;
inline const std::string kSerialNumber = "EMULATOR-1", kMachine = "mill";

/// Small, smooth, rough, and rough with the end of another one.
[[nodiscard]] const std::array<Bytes, kImages>& images();

}  // namespace ecs::world
