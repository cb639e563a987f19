// The tables of an errors file, read into its parts; what is wrong stays in the reader, each with its place.
// Does not live here: what the values mean (parts.hpp and the headers it names).
#pragma once

#include <filesystem>
#include <functional>

#include "base/toml_reader.hpp"
#include "ecs_emulator/errors/parts.hpp"
#include "ecs_emulator/settings/reader.hpp"

namespace ecs::emulator {

/// One errors file under way.
struct ErrorsReading {
  TomlReader& reader;
  const toml::table& file;
  std::filesystem::path folder;  ///< where `csv = "…"` is looked for
  ErrorParts& parts;
};

/// Temperatures and sensors before everything whose formulas or effects name them.
void read_heat(ErrorsReading& reading);
void read_curves(ErrorsReading& reading);  ///< [squareness], [[contribution]], [scatter]
void read_effects(ErrorsReading& reading);
void read_gravity(ErrorsReading& reading);
void read_artefacts(ErrorsReading& reading);
void read_location(ErrorsReading& reading);  ///< [location] of rotary axes
/// False: it is none of a rotary axis.
[[nodiscard]] bool read_rotary_contribution(ErrorsReading& reading, const toml::table& table);
[[nodiscard]] bool read_rotary_effect(ErrorsReading& reading, const toml::table& table);

/// Exactly one of `formula`, `points`, `csv`; complains as `what`.
[[nodiscard]] std::optional<ErrorCurve> curve_in(ErrorsReading& reading, const toml::table& table, const char* what);
/// A formula under `key`.
[[nodiscard]] std::optional<Formula> formula_in(ErrorsReading& reading, const toml::table& table, std::string_view key);
/// The tables `[name.X]`, `[name.Y]`, `[name.Z]` that are there; `each` may complain about them.
void for_each_axis(ErrorsReading& reading, const char* name, const std::function<void(Axis, const toml::table&)>& each);
/// Notes what `table` asks of the machine.
void demand(ErrorsReading& reading, const toml::table& table, std::string name, Axis axis,
            Demand::Side side = Demand::Side::any, std::optional<std::array<double, 2>> covers_mm = std::nullopt);

}  // namespace ecs::emulator
