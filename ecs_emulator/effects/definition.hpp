// One physical cause as the emulator knows it, whole: words, parameters, what it adds to a reading, how a hidden case
// draws it. The formulas are those of docs/physics.md, "The effect library", written down independently of `model/`:
// the machine that hides an effect and the method that finds it share core types only.
// Does not live here: the effects themselves, one file each; their list (registry.hpp).
#pragma once

#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "ecs_emulator/effects/conditions.hpp"
#include "ecs_emulator/effects/designs.hpp"
#include "ecs_emulator/effects/placed.hpp"
#include "ecs_emulator/scene/ground.hpp"
#include "ecs_emulator/scene/needs.hpp"

namespace ecs::emulator {

/// How the contribution grows with a parameter.
enum class Growth { not_at_all, linear, square };

/// Open interval.
struct Range {
  double above = -std::numeric_limits<double>::infinity();
  double below = std::numeric_limits<double>::infinity();
};
inline constexpr Range kPositive{.above = 0.0};

struct ParameterDefinition {
  std::string_view name;
  std::string_view unit;  ///< "1": a ratio
  Growth growth = Growth::not_at_all;
  double drawn = 1.0;     ///< size in a hidden case, either sign; effects of about 1 um
  bool optional = false;  ///< in an errors file; if all are, at least one is given
  Range range{};          ///< of a size that nature sets: what is drawn or taken for possible
  /// Values at which to try a parameter that the contribution depends on nonlinearly.
  std::vector<double> (*search)(const Scene&, const Ground&, const PlacedEffect&) = nullptr;
  std::optional<double> unit_value{};  ///< of a fault of the map: its contribution has the size of the map
};

/// Where in the workshop an effect has its seat.
enum class Seat {
  machine,     ///< an error component of the machine
  instrument,  ///< the laser
  unit,        ///< the compensation
};

enum class CurveOf { nothing, shape, shape_mean_and_slope };

/// Why a fault of the map has no place in an errors file.
inline constexpr std::string_view kFaultOfTheMap =
    "a fault of the unit's map: give the unit such a map, or polarity and gain in its parameters";

/// What says which component it sits in.
enum class PlacedBy {
  sense,
  code_of_rotation,
  code_of_squareness,
  code_of_set_up,  ///< EA, EB, EC: kept as the sense; no axis
};

/// A search for places of an effect on a scene.
struct PlaceSearch {
  const EffectDefinition& kind;
  const Scene& scene;
  const Ground& ground;
  bool good;  ///< only where it makes physical sense and shows well; else wherever a model of these data could have it
};

/// A shape being drawn.
struct Drawing {
  Random& random;
  const Scene& scene;
  const Ground& ground;
  double sign;  ///< of its size, drawn
};

struct EffectDefinition {
  std::string_view id;
  Seat seat = Seat::machine;
  std::vector<ParameterDefinition> parameters{};  ///< those that an errors file must give come first
  CurveOf curve = CurveOf::nothing;
  PlacedBy placed_by = PlacedBy::sense;
  int sensors = 0;               ///< temperatures it depends on, by name: 0 to 2
  bool needs_axis = false;       ///< depends on place or way of an axis; else an errors file may leave it to the sense
  bool straightness = false;     ///< acts across the axis only
  bool own_axis_only = false;    ///< acts only while its own axis is the one that moves
  std::string_view elsewhere{};  ///< why it has no place in an errors file and where it has one; empty: it has

  /// Value of its component, or what the instrument adds [um or um/m].
  double (*value)(const PlacedEffect&, const Conditions&) = nullptr;
  /// What it adds to each component that it acts in, where that is not one.
  std::vector<PlacedEffect> (*parts)(const PlacedEffect&) = nullptr;
  /// What a fault of the unit makes of a map's reading.
  void (*spoil)(const PlacedEffect&, MapReading&) = nullptr;

  Needs needs{};  ///< of the measurement that can show it
  std::vector<PlacedEffect> (*places)(const PlaceSearch&) = nullptr;
  /// Parameters and curve of size about 1 um; false where the stops are too few to show it. Absent: as the parameters
  /// say.
  bool (*draw)(const Drawing&, PlacedEffect&) = nullptr;
  /// Effects of size one that span it, where they are not one for each parameter that it grows with.
  std::vector<PlacedEffect> (*units)(const PlacedEffect&) = nullptr;
  bool natural_size = false;          ///< its size is a matter of nature: noise is made to fit it
  bool fixed_size = false;            ///< it fits as it is or not at all
  bool explains_two = false;          ///< a single one may do what two hidden effects do together
  bool on_request = false;            ///< hidden only where asked for by name
  bool in_every_base = false;         ///< at every place it can have
  double base_probability = 0.0;      ///< how often an engineer's model holds it at a good place
  std::string_view line{};            ///< id of the effect that holds mean and slope of its curve
  Designs confounded_in = kNoDesign;  ///< designs on which it can be hidden among others that do the same
  Designs excluded_from = kNoDesign;  ///< designs whose base model must not hold it: it would take the group's place
};

}  // namespace ecs::emulator
