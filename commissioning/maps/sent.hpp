// A prepared map into a unit, and whether a unit holds a map: what the verbs and the screens share.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/maps/compare.hpp"
#include "commissioning/maps/prepared_map.hpp"
#include "commissioning/maps/source.hpp"
#include "commissioning/unit/transfer.hpp"
#include "params/fields.hpp"

namespace ecs::commissioning {

/// The block check of the active image, as the unit names it; nothing if the unit holds none.
[[nodiscard]] Result<std::optional<std::uint32_t>> active_check(protocol::UnitClient& client);

struct SentMap {
  SendReport report;
  protocol::Identity identity;
  std::uint32_t check = 0;                    ///< block check of what is active now
  std::optional<std::uint32_t> check_before;  ///< of what was active; nothing: the unit held no image
  double seconds = 0.0;
};

/// Called before the first byte leaves: the block check of the image that is active until the new one is
/// whole.
using BeforeSending = std::function<void(std::optional<std::uint32_t>)>;

/// Refused, before anything is sent, if the unit is another one than the map's or its parameters' (unless
/// `other_machine`) or has too little room. Whole or not at all.
[[nodiscard]] Result<SentMap> send_map(protocol::UnitClient& client, const PreparedMap& map, const std::string& file,
                                       bool other_machine, const BeforeSending& before = {},
                                       const protocol::ProgressCallback& progress = {});

struct MapVerdict {
  std::vector<MapDifference> differences;      ///< of the map, to the resolution of the unit's memory
  std::vector<params::Difference> parameters;  ///< file (a) against unit (b); empty without a parameter file
  std::optional<LargestDifference> largest;    ///< from the file's own curve, before it is resampled
  [[nodiscard]] bool same() const { return differences.empty() && parameters.empty(); }
};

/// Compares what a unit holds with a map file and, unless `params_file` is empty, a parameter file.
[[nodiscard]] Result<MapVerdict> verdict_on(const FoundMap& found, const std::string& map_file,
                                            const std::string& params_file);

}  // namespace ecs::commissioning
