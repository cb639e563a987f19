// Measurements that separate several effects, strongest first: a switch before a condition, a condition before a shape.
// Does not live here: measurements for one effect alone (its own file).
#pragma once

#include "model/effects/definition.hpp"

namespace ecs::model::separations {

inline constexpr SeparatingMeasurement kCompensationOff{
    10, "Repeat the same line with compensation switched off (compensated = 0): a fault of the map disappears."};
inline constexpr SeparatingMeasurement kOtherPressure{20,
                                                      "Repeat the {axis} line on a day when the air pressure differs "
                                                      "by at least 10 hPa, and record air temperature, "
                                                      "pressure and humidity."};
inline constexpr SeparatingMeasurement kOtherTemperature{
    30, "Repeat the {axis} line with the machine at least 3 degC warmer or colder, sensors recorded."};
inline constexpr SeparatingMeasurement kFromCold{
    50, "Repeat the {axis} line from the cold machine and again after two hours, targets in reverse order."};
inline constexpr SeparatingMeasurement kTurnedOver{
    52, "Turn the square or straight edge over and repeat the {axis} line with column reversed = 1 (0 before)."};
inline constexpr SeparatingMeasurement kSecondLine{
    80, "Measure along {axis} again on a second line, the other axes parked as far as possible from the first."};
inline constexpr SeparatingMeasurement kAfterReversal{
    100,
    "Measure {axis} both ways at five targets, each approached with short and with long travel after the reversal."};
inline constexpr SeparatingMeasurement kFinerTargets{
    120, "Measure a line along {axis}, both ways, at closely spaced targets."};

}  // namespace ecs::model::separations
