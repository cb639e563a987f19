// What an errors file says, as data, one part for each table (docs/emulator.md), and the reading of it; what is wrong
// stays in the reader, each with its place. Does not live here: the values at a state (true_errors.hpp).
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/toml_reader.hpp"
#include "core/terms.hpp"
#include "ecs_emulator/effects/effects.hpp"
#include "ecs_emulator/errors/formula.hpp"
#include "ecs_emulator/errors/gravity.hpp"
#include "ecs_emulator/errors/kinematics.hpp"
#include "ecs_emulator/settings/reader.hpp"
#include "ecs_emulator/thermal/heat.hpp"

namespace ecs::emulator {

/// `[[contribution]]`
struct Contribution {
  Component component = Component::EXX;
  ErrorCurve curve;
  int line = 0;  ///< of its table
};

/// `[[effect]]`
struct FileEffect {
  PlacedEffect effect;  ///< axis always there; its curve is the one below
  Component component = Component::EXX;
  std::optional<ErrorCurve> curve;  ///< over positions from the axis's datum
};

/// `[[artefact]]`: the square or straight edge that a line across an axis is measured against.
struct Artefact {
  Axis axis = Axis::X;  ///< that moves
  Sense sense = Sense::EY;
  double angle_um_per_m = 0.0;
  std::optional<ErrorCurve> form;  ///< over positions of the axis [um]
  int line = 0;                    ///< of its table
};

/// `[temperature]`: a sensor that is a formula of time.
struct TemperatureFormula {
  std::string name;
  Formula formula;
};

/// What a table of the file demands of the machine it is put on.
struct Demand {
  enum class Side { any, tool, workpiece };
  std::string table;  ///< as written: "ram.Z"
  int line = 0;
  Axis axis = Axis::X;
  Side side = Side::any;
  std::optional<std::array<double, 2>> covers_mm;  ///< a range that must hold all of the axis's travel
};

struct ErrorParts {
  std::string file;
  Variables variables;  ///< that the formulas below read
  std::vector<TemperatureFormula> temperatures;
  std::vector<Contribution> contributions;
  std::vector<FileEffect> effects;
  std::vector<Artefact> artefacts;
  ComponentValues constants{};  ///< squareness
  ComponentValues pass_sigma{};
  ComponentValues reading_sigma{};
  RotaryParts rotary;
  GravitySettings gravity;
  HeatSettings heat;
  std::vector<Demand> demands;
};

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
