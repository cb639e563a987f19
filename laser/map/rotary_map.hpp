// The rotary axes of a map: as lines of its header, and as the unit's image holds them.
// Does not live here: what the core makes of them (core/rotary.hpp), where they come from (commissioning/maps/).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/rotary.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::laser {

/// The axes of a map with the bytes of their curves; views into itself.
class PackedRotary {
 public:
  /// Values are rounded to the resolution_for() their curve. @pre at most kRotaryInputs axes
  explicit PackedRotary(const MapHeader& header);
  PackedRotary(const PackedRotary&) = delete;
  PackedRotary& operator=(const PackedRotary&) = delete;
  [[nodiscard]] const RotarySetup& setup() const { return setup_; }

 private:
  RotarySetup setup_{};
  PerRotary<std::array<std::vector<std::uint8_t>, 2>> values_{};
};

/// The axes of an image into the header of its map.
void take_rotary(MapHeader& header, const RotarySetup& setup);

/// "EXC"
[[nodiscard]] std::string rotary_curve_name(char letter, std::size_t sense);
/// "XOC"
[[nodiscard]] std::string rotary_location_name(char letter, std::size_t place);

/// A location error or a curve of a rotary axis, or a size of bending.
struct RotaryPart {
  std::string name;      ///< "XOC", "EXC", "machine_bending x_sin"
  double largest = 0.0;  ///< |value|
  std::string unit;      ///< um, um/m
};
/// Every one that is not zero, by axis, location errors first.
[[nodiscard]] std::vector<RotaryPart> parts_of(const MapRotaryAxis& one);
/// Sizes with their signs, also those that are zero, by effect and as the model has them.
[[nodiscard]] std::vector<RotaryPart> parts_of(const RotaryBending& bending);

/// The error (actual - target) of a curve between the values of its table, as the unit takes it; nothing beyond the
/// ends of a table that is no whole turn. @param side  0 reverse, 1 forward
[[nodiscard]] std::optional<double> rotary_error_at(const MapRotaryAxis& one, std::size_t side, std::size_t sense,
                                                    double angle_deg);

/// Lines `key: value` of the header; empty: no rotary axes.
[[nodiscard]] std::string rotary_lines(const MapHeader& header);
[[nodiscard]] bool is_rotary_key(std::string_view key);
/// One of those lines back into the header. @return what was expected and found; empty: taken. @pre is_rotary_key(key)
[[nodiscard]] std::string take_rotary_line(MapHeader& header, std::string_view key, std::string_view value);

/// Why the unit would not compensate them with these parameters; empty: it would.
[[nodiscard]] std::string rotary_objection(const MapHeader& header, const UnitParameters& parameters);

}  // namespace ecs::laser
