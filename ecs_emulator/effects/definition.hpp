// One physical cause as the emulator knows it, whole: words, parameters, what it adds to a reading, how a hidden case
// draws it. The formulas are those of docs/physics.md, "The effect library", written down independently of `model/`:
// the machine that hides an effect and the method that finds it share core types only. Below: where an
// effect can sit on a given ground, and its shape there: drawn, of size one, over what it depends on.
// Does not live here: the effects themselves, one file each; how large they are made (modules/hidden_cases).
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/axis.hpp"
#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/scene/scene.hpp"

namespace ecs::emulator {

/// Designs of a measurement on which different effects do exactly the same; an effect says in which of them it can be
/// hidden. Made in modules/hidden_cases/compose.cpp.
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

/// What an effect depends on, at one reading or at one instant of the machine.
class Conditions {
 public:
  Conditions() = default;
  Conditions(const Conditions&) = delete;
  Conditions& operator=(const Conditions&) = delete;
  virtual ~Conditions() = default;

  double p_mm = 0.0;      ///< of the effect's axis, from its datum
  double approach = 1.0;  ///< 1 or −1
  double curve = 0.0;     ///< value at p of the effect's curve, if it has one [um or um/m]
  double time_s = 0.0;
  double feed_mm_min = 0.0;
  double load_kg = 0.0;
  double travel_since_reversal_mm = 0.0;

  [[nodiscard]] virtual double material_degC() const = 0;
  /// At the place of a sensor.
  [[nodiscard]] virtual double degC(const std::string& sensor) const = 0;
  /// The same at time 0.
  [[nodiscard]] virtual double first_degC(const std::string& sensor) const = 0;
  /// n − n of the reference air.
  [[nodiscard]] virtual double missing_refraction() const { return 0.0; }
  /// The component that was measured separately [um or um/m].
  [[nodiscard]] virtual double known_value() const { return 0.0; }
};

/// A value that is being read from a map: what a fault of the unit changes.
struct MapReading {
  double position_mm = 0.0;
  int approach = 0;  ///< 0: the axis of the map stands still
  double gain = 1.0;
};

/// A smooth curve over a travel: Legendre polynomials of degree 2, 3, …; a mean and a slope where the effect keeps
/// them.
struct SmoothCurve {
  double from_mm = 0.0;
  double to_mm = 1.0;
  double mean = 0.0;
  double slope = 0.0;         ///< over half the range
  std::vector<double> waves;  ///< of degree 2, 3, …
  [[nodiscard]] bool empty() const { return waves.empty() && mean == 0.0 && slope == 0.0; }
};

/// Beyond the range the end value holds.
[[nodiscard]] double value_at(const SmoothCurve& curve, double p_mm);

/// Without mean and slope, size about 1. @param places_mm  ascending, not empty: the curve runs over them
[[nodiscard]] SmoothCurve draw_curve(Random& random, const std::vector<double>& places_mm);

struct EffectDefinition;

/// An effect at its place in a machine, with its size. Parameters bear the names of docs/physics.md; curves have a
/// shape instead.
struct PlacedEffect {
  const EffectDefinition* kind = nullptr;
  std::optional<Axis> axis;
  std::optional<Sense> sense;
  std::optional<Component> code;
  Approach approach = Approach::unknown;  ///< unknown: both
  std::string sensor;                     ///< of an effect that depends on one
  std::string sensor2;                    ///< of an effect that depends on two
  std::map<std::string, double, std::less<>> parameters;
  SmoothCurve curve;
  [[nodiscard]] double parameter(std::string_view name) const;  ///< 0 where there is none
};

/// "cyclic:X:EX", "angular:X:ECX", "map_polarity:X" (all curves of X), "map_polarity" (the whole map).
[[nodiscard]] std::string name_of(const PlacedEffect& effect);
/// The same with a contribution `factor` times as large. @pre not a fault of the map; an effect of one sign keeps it
[[nodiscard]] PlacedEffect scaled(PlacedEffect effect, double factor);
/// It acts on this reading at all.
[[nodiscard]] bool acts_on(const PlacedEffect& effect, const Stop& stop);
/// The effects of one component each that it consists of; mostly itself alone.
[[nodiscard]] std::vector<PlacedEffect> parts_of(const PlacedEffect& effect);
/// The component of the machine that carries it. @pre it has its seat in the machine and is a part
[[nodiscard]] Component carrier_of(const PlacedEffect& effect);

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

/// All effects of the emulator. Hidden cases draw by the order of this list: new ones go to its end.
[[nodiscard]] std::span<const EffectDefinition* const> effects();
/// Those that a hidden case may draw by itself.
[[nodiscard]] const std::vector<const EffectDefinition*>& drawn_effects();
/// Null where there is none of that id.
[[nodiscard]] const EffectDefinition* effect_named(std::string_view id);

[[nodiscard]] std::vector<PlacedEffect> possible_places(const Scene& scene, const Ground& ground,
                                                        const EffectDefinition& kind);
[[nodiscard]] std::vector<PlacedEffect> good_places(const Scene& scene, const Ground& ground,
                                                    const EffectDefinition& kind);

[[nodiscard]] PlacedEffect at_place(const EffectDefinition& kind, std::optional<Axis> axis, std::optional<Sense> sense,
                                    std::optional<Component> code = {});
/// The sense is the translation along the axis.
[[nodiscard]] bool is_along(Sense sense, Axis axis);
/// The data tell the approaches of this axis apart.
[[nodiscard]] bool shows_approach(const PlaceSearch& search, Sense sense, Axis axis);
/// The data hold temperature, pressure and humidity of the air.
[[nodiscard]] bool shows_air(const PlaceSearch& search);

/// May it sit there, over what every effect of an axis asks for?
using Admits = bool (*)(const PlaceSearch&, Sense, Axis);

/// Every axis in every sense, where it has places enough.
[[nodiscard]] std::vector<PlacedEffect> on_axes(const PlaceSearch& search, Admits admits);
[[nodiscard]] std::vector<PlacedEffect> on_all_axes(const PlaceSearch& search);
/// The same, and an axis that stands still if it is the natural one of the sense.
[[nodiscard]] std::vector<PlacedEffect> on_axes_or_parked(const PlaceSearch& search);
/// Each sense at its natural axis.
[[nodiscard]] std::vector<PlacedEffect> on_senses(const PlaceSearch& search);
/// The whole map, all of one axis, or one curve: each where it is not the same as a smaller part.
[[nodiscard]] std::vector<PlacedEffect> in_map(const PlaceSearch& search);

/// Coordinates of a lever that readings of the sense have, less the measurement line; ascending, each once.
[[nodiscard]] std::vector<double> levers_mm(const Scene& scene, const Ground& ground, Sense sense, Component code);
/// Fewer targets do not show a curve or a slope.
inline constexpr std::size_t kFewTargets = 6;

/// Draws the shape of an effect at its place; size about 1 um. Nothing where the stops are too few to show one.
[[nodiscard]] std::optional<PlacedEffect> with_shape(Random& random, const Scene& scene, const Ground& ground,
                                                     PlacedEffect effect);

/// Effects of size one whose contributions span all that the effect can produce at its nonlinear parameters.
[[nodiscard]] std::vector<PlacedEffect> unit_effects(const Ground& ground, const PlacedEffect& effect);

/// The effect at each value at which its nonlinear parameter is tried; the effect itself where it has none.
[[nodiscard]] std::vector<PlacedEffect> trials_of(const Scene& scene, const Ground& ground, PlacedEffect effect);

/// A curve, or a nonlinear parameter that is searched.
[[nodiscard]] bool is_flexible(const EffectDefinition& kind);
/// Its contribution has the same sign whatever its parameter.
[[nodiscard]] bool has_one_sign(const EffectDefinition& kind);

/// The places that a curve of this effect runs over.
[[nodiscard]] const std::vector<double>& places_under(const Ground& ground, const PlacedEffect& effect);
/// Draws a curve without mean and slope over the readings on which the effect acts (least squares).
void draw_curve_without_line(const Drawing& drawing, PlacedEffect& effect);

}  // namespace ecs::emulator
