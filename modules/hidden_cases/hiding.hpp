// How a hidden case draws the effects of the emulator (ecs_emulator/effects): where on a given ground one can sit, its
// shape there (drawn, of size one, over what it depends on), which measurement shows it, in which base models it may
// be. What is none of the machine's, faults of a map and of the instrument, is evaluated here. Does not live here: how
// large effects are made (case.cpp), what they are (ecs_emulator/effects/effects.hpp).
#pragma once

#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "ecs_emulator/effects/effects.hpp"
#include "modules/hidden_cases/scene.hpp"

namespace ecs::emulator {

/// Designs of a measurement on which different effects do exactly the same; an effect says in which of them it can be
/// hidden. Made in compose.cpp.
struct Design {
  enum Id : unsigned {
    kWarm = 1,       ///< positioning at one temperature of the material, not 20 °C
    kAir = 2,        ///< positioning in one air, not the reference air
    kWarmAir = 4,    ///< both
    kOneFeed = 8,    ///< both approaches at one feed
    kZero = 16,      ///< a zero in one air
    kSquare = 32,    ///< one axis in the direction of another
    kOneLever = 64,  ///< a rotation seen with one lever arm
    kCold = 128,     ///< positioning without temperatures
  };
};
using Designs = unsigned;  ///< of Design::Id, by |
inline constexpr Designs kNoDesign = 0;
inline constexpr Designs kEveryDesign = 255;

/// A smooth curve over a travel: Legendre polynomials of degree 2, 3, …; a mean and a slope where the effect keeps
/// them.
struct SmoothCurve {
  double from_mm = 0.0;
  double to_mm = 1.0;
  double mean = 0.0;
  double slope = 0.0;         ///< over half the range
  std::vector<double> waves;  ///< of degree 2, 3, …
};
/// Beyond the range the end value holds.
[[nodiscard]] double value_at(const SmoothCurve& curve, double p_mm);
/// Without mean and slope, size about 1. @param places_mm  ascending, not empty: the curve runs over them
[[nodiscard]] SmoothCurve draw_curve(Random& random, const std::vector<double>& places_mm);

struct DrawnEffect : PlacedEffect {
  SmoothCurve curve;
};

/// The same with a contribution `factor` times as large. @pre not a fault of the map; an effect of one sign keeps it
[[nodiscard]] DrawnEffect scaled(DrawnEffect effect, double factor);
/// It acts on this reading at all.
[[nodiscard]] bool acts_on(const DrawnEffect& effect, const Stop& stop);

/// A value that is being read from a map: what a fault of the unit changes.
struct MapReading {
  double position_mm = 0.0;
  int approach = 0;  ///< 0: the axis of the map stands still
  double gain = 1.0;
};

/// Where in the workshop an effect has its seat.
enum class Seat {
  machine,     ///< an error component of the machine
  instrument,  ///< the laser
  unit,        ///< the compensation
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

/// Open interval.
struct Range {
  double above = -std::numeric_limits<double>::infinity();
  double below = std::numeric_limits<double>::infinity();
};

struct Hiding {
  std::string_view id;  ///< of the effect
  Seat seat = Seat::machine;
  /// Parameters that the contribution is proportional to; none named: all of them.
  std::vector<std::string_view> sizes{};
  bool square = false;          ///< it grows with the square of its size and has the same sign whatever that is
  double drawn = 1.0;           ///< its size where there is no `draw`, either sign; effects of about 1 um
  Range range{};                ///< of a size that nature sets: what is drawn or taken for possible
  std::string_view searched{};  ///< the parameter that the contribution depends on nonlinearly,
  /// and values at which to try it.
  std::vector<double> (*search)(const Scene&, const Ground&, const DrawnEffect&) = nullptr;
  std::optional<double> unit_value{};  ///< of a fault of the map: its contribution has the size of the map
  bool mean_and_slope = false;         ///< its curve has them itself
  bool own_axis_only = false;          ///< acts only while its own axis is the one that moves
  /// What it adds to the reading or to its component, where the value is none of the machine's [um or um/m].
  double (*adds)(const DrawnEffect&, const Scene&, const Stop&) = nullptr;
  /// What a fault of the unit makes of a map's reading.
  void (*spoil)(const DrawnEffect&, MapReading&) = nullptr;
  Needs needs{};  ///< of the measurement that can show it
  /// May it sit there, over what every effect of an axis asks for?
  bool (*admits)(const PlaceSearch&, Sense, Axis) = nullptr;
  std::vector<DrawnEffect> (*places)(const PlaceSearch&) = nullptr;  ///< absent: on all axes that admit it
  /// Parameters and curve of size about 1 um; false where the stops are too few to show it.
  bool (*draw)(const Drawing&, DrawnEffect&) = nullptr;
  /// Effects of size one that span it, where they are not one for each parameter that it grows with.
  std::vector<DrawnEffect> (*units)(const DrawnEffect&) = nullptr;
  bool natural_size = false;          ///< its size is a matter of nature: noise is made to fit it
  bool fixed_size = false;            ///< it fits as it is or not at all
  bool explains_two = false;          ///< a single one may do what two hidden effects do together
  bool on_request = false;            ///< hidden only where asked for by name
  bool in_every_base = false;         ///< at every place it can have
  double base_probability = 0.0;      ///< how often an engineer's model holds it at a good place
  std::string_view line{};            ///< id of the effect that holds mean and slope of its curve
  Designs confounded_in = kNoDesign;  ///< designs on which it can be hidden among others that do the same
  Designs excluded_from = kNoDesign;  ///< designs whose base model must not hold it: it would take the group's place

  /// A curve, or a nonlinear parameter that is searched.
  [[nodiscard]] bool is_flexible() const;
};

/// One for each of effects(), in its order, by which cases are drawn.
[[nodiscard]] const std::vector<Hiding>& hidings();
/// @param kind  one of effects()
[[nodiscard]] const Hiding& hiding_of(const EffectDefinition& kind);
[[nodiscard]] inline const Hiding& hiding_of(const PlacedEffect& effect) { return hiding_of(*effect.kind); }
/// Those that a hidden case may draw without being asked for one.
[[nodiscard]] const std::vector<const EffectDefinition*>& drawn_effects();

/// @param good  as of PlaceSearch
[[nodiscard]] std::vector<DrawnEffect> places_of(const EffectDefinition& kind, const Scene& scene, const Ground& ground,
                                                 bool good = false);
[[nodiscard]] DrawnEffect at_place(const EffectDefinition& kind, std::optional<Axis> axis, std::optional<Sense> sense,
                                   std::optional<Component> code = {});

/// Draws the shape of an effect at its place; size about 1 um. Nothing where the stops are too few to show one.
[[nodiscard]] std::optional<DrawnEffect> with_shape(Random& random, const Scene& scene, const Ground& ground,
                                                    DrawnEffect effect);
/// Effects of size one whose contributions span all that the effect can produce at its nonlinear parameters.
[[nodiscard]] std::vector<DrawnEffect> unit_effects(const Ground& ground, const DrawnEffect& effect);
/// The effect at each value at which its nonlinear parameter is tried; the effect itself where it has none.
[[nodiscard]] std::vector<DrawnEffect> trials_of(const Scene& scene, const Ground& ground, DrawnEffect effect);

}  // namespace ecs::emulator
