// A map and a unit: the one in it, one prepared with its parameters, judged and turned into bytes, sent; whether the
// unit holds a map, and where two maps differ.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/result.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/unit/transfer.hpp"
#include "laser/map/error_map.hpp"
#include "laser/map/image.hpp"
#include "params/fields.hpp"
#include "params/parameters_toml.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

struct FoundMap {
  laser::ErrorMap map;
  std::optional<UnitParameters> parameters;  ///< of the unit
  std::string name;                          ///< the file, or "the unit"
};

/// The map in the unit, decoded, with its parameters. Refused, saying why, if it holds none or an unsound one.
[[nodiscard]] Result<FoundMap> map_in(protocol::UnitClient& client, const protocol::ProgressCallback& progress = {});

struct PreparedMap {
  laser::MapHeader header;
  params::Identity identity;  ///< of the parameters
  laser::MapImage image;
  std::vector<std::string> remarks;  ///< findings worth knowing that are no objections; defaults taken
};

struct PrepareOptions {
  bool other_machine = false;                  ///< also a map whose header names another machine
  Incomplete incomplete = Incomplete::refuse;  ///< parameters without their closing line
  bool accept_resampling = false;              ///< also where it changes a table by more than its resolution
};

/// Reads both files; refuses, with every reason, parameters that must not meet a machine, a map that is incomplete for
/// them, one whose header names another machine, or one that resampling changes.
[[nodiscard]] Result<PreparedMap> prepared_map(const std::string& map_file, const std::string& params_file,
                                               const PrepareOptions& options = {});

/// The same of a map and parameters that are not in files yet. @param map_name, params_name  in problems
[[nodiscard]] Result<PreparedMap> prepared_map(const laser::ErrorMap& map, const std::string& map_name,
                                               const params::ParametersFile& parameters, const std::string& params_name,
                                               const PrepareOptions& options = {});

/// The bytes that a unit holds after send_map(), for a file: addressed to the machine and the serial number that the
/// map states, else the parameters. What neither states is filled in from the unit when the image is sent.
[[nodiscard]] Result<std::vector<std::uint8_t>> image_for_file(const PreparedMap& map);

/// The image for that file, judged as for sending; empty where no file is named. What had to be resampled is noted.
[[nodiscard]] Result<std::vector<std::uint8_t>> image_to_write(MessageSink& messages, const std::string& file,
                                                               const laser::ErrorMap& map,
                                                               const params::ParametersFile& parameters,
                                                               const std::string& params_name);
/// Nothing where no file is named.
[[nodiscard]] Result<void> write_image(const std::string& file, std::span<const std::uint8_t> image);

/// "memory image written to mill.image: 1234 bytes, checksum (CRC-32) 1234ABCD, for unit MCM-0107"; null and no text
/// where no file is named. @param image  sound where a file is named
[[nodiscard]] Cell image_cell(const std::string& file, std::span<const std::uint8_t> image);

/// Why the unit with this serial number is not the one of the map, or not the one of its parameters.
[[nodiscard]] std::vector<std::string> other_unit(const PreparedMap& map, const std::string& serial_number);

/// One difference. Values in um, or um/m for a rotation.
struct MapDifference {
  std::optional<Component> component;  ///< absent: the header
  Approach approach = Approach::unknown;
  std::optional<double> position_mm;  ///< absent: the table as a whole
  std::optional<double> expected;
  std::optional<double> found;
  std::string message;  ///< one line that says all of it
};

/// Header lines, declared zeros, tables, then values. Positions within 1e-6 mm and values within 1e-6 are the same.
[[nodiscard]] std::vector<MapDifference> differences_between(const laser::ErrorMap& expected,
                                                             const laser::ErrorMap& found);

/// Tables of the unit that leave the file's own curve by more than their resolution, each where it does so most.
[[nodiscard]] std::vector<MapDifference> beyond_resolution(const laser::ErrorMap& file, const laser::ErrorMap& unit);

/// Where a curve of the unit differs most from the curve that the file gives, at the points of either.
struct LargestDifference {
  Component component = Component::EXX;
  Approach approach = Approach::unknown;
  double position_mm = 0.0;
  double expected = 0.0;  ///< of the file, linear between its points, um or um/m
  double found = 0.0;     ///< of the unit
  [[nodiscard]] double difference() const { return std::abs(expected - found); }
};
/// Nothing: no table is in both.
[[nodiscard]] std::optional<LargestDifference> largest_difference(const laser::ErrorMap& file,
                                                                  const laser::ErrorMap& unit);

/// The checksum of the active image, as the unit names it; nothing if the unit holds none.
[[nodiscard]] Result<std::optional<std::uint32_t>> active_check(protocol::UnitClient& client);

struct SentMap {
  SendReport report;
  protocol::Identity identity;
  std::uint32_t check = 0;                    ///< checksum of what is active now
  std::optional<std::uint32_t> check_before;  ///< of what was active; nothing: the unit held no image
  double seconds = 0.0;
};

/// Called before the first byte leaves: the checksum of the image that is active until the new one is
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
