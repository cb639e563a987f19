// A dump of a unit's memory: taken from the unit, kept in one file, read back even where the file is damaged.  The
// file: one line `ECSDUMP 1 CRC32-OF-THE-JSON`, one line of JSON (when, which unit, its status registers, the regions
// with address, size and CRC-32), then the bytes of the regions one after the other.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "commissioning/unit/status.hpp"
#include "core/address_map.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

struct DumpRegion {
  std::string name;
  Address address = 0;
  std::vector<std::uint8_t> bytes;  ///< as many as there are
  std::uint32_t size = 0;           ///< as many as there should be
  bool intact = true;               ///< all there, and their CRC agrees
};

struct MemoryDump {
  std::string taken;          ///< ISO 8601; empty: unknown
  std::string link;           ///< empty: unknown
  std::string serial_number;  ///< empty: unknown
  std::optional<StatusSnapshot> status;
  std::vector<DumpRegion> regions;  ///< by address
  std::vector<std::string> damage;  ///< what is wrong with the file, in words; empty: nothing
  bool image_alone = false;         ///< the bytes of an image, whichever bank of whichever unit it is for
};

/// What a dump takes along.
enum class DumpScope {
  all,     ///< every region of the unit
  active,  ///< commit records and the active image: all that decoding parameters and map needs
};
[[nodiscard]] Result<MemoryDump> take_dump(protocol::UnitClient& client, const std::string& link, DumpScope scope,
                                           const protocol::ProgressCallback& progress = {});

[[nodiscard]] std::string to_bytes(const MemoryDump& dump);

/// A dump, or the bytes of a bare memory image (they count as bank A). What is damaged is said in `damage` and the rest
/// is given; only bytes that show no sign of either are refused.
[[nodiscard]] Result<MemoryDump> dump_in(std::string_view bytes, const std::string& name);
[[nodiscard]] Result<MemoryDump> read_dump(const std::filesystem::path& path);

/// The region that begins at this address; nullptr if the dump has none.
[[nodiscard]] const DumpRegion* region_at(const MemoryDump& dump, Address address);

}  // namespace ecs::commissioning
