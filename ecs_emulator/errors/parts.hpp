// What an errors file says, as data: one part for each table (docs/emulator.md).
// Does not live here: the notation (reader.hpp), the values at a state (true_errors.hpp).
#pragma once

#include <string>
#include <vector>

#include "core/terms.hpp"
#include "ecs_emulator/effects/placed.hpp"
#include "ecs_emulator/errors/curve.hpp"
#include "ecs_emulator/errors/gravity.hpp"
#include "ecs_emulator/errors/rotary_errors.hpp"
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

}  // namespace ecs::emulator
