// What the unit's address space allows: which bytes exist, what a typed row of bytes means.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/address_map.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::commissioning {

/// A usage problem unless there is at least one byte and all of them lie in the 24 bits of the address space.
[[nodiscard]] Result<void> within_space(Address address, std::size_t bytes);

/// A refused problem unless one region of the address map holds all of these bytes.
/// @param modules  axis memory modules that the unit has
[[nodiscard]] Result<void> memory_there(Address address, std::size_t bytes, std::size_t modules = kMostModules);

/// Bytes of a region in a unit with so many modules.
[[nodiscard]] std::uint32_t size_of(const Region& region, std::size_t modules);

/// Words apart or several in one argument: "4E75", "4E 75", "0x4E 0x75".
[[nodiscard]] Result<std::vector<std::uint8_t>> hex_bytes(const std::vector<std::string>& arguments);

}  // namespace ecs::commissioning
