// A head that its own weight bends: with the tilting angle b of the rotary axis next to the tool the moment of gravity
// changes as sin b, the share across it as 1 - cos b (a beam under its own weight, Timoshenko 1925). The shift is one
// in the frame of the part that carries that axis, or of the machine where its slides and column give way; a tool that
// bends shifts in proportion to its length.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "model/effects/artefact_place.hpp"

namespace ecs::model::effects {
namespace {

constexpr std::array kAlong{Sense::EX, Sense::EY, Sense::EZ};

/// Another rotary axis carries the tilting one: its frame turns in that of the machine, and nothing turns the
/// workpiece.
bool has_turning_head(const Observations& data) {
  const std::string& letters = data.machine.rotary_configuration;
  return std::ranges::count_if(std::string_view(letters).substr(std::min(letters.find('T'), letters.size())),
                               [](char letter) { return letter >= 'A' && letter <= 'C'; }) == 2;
}

/// From the tool reference point to the ball or probe [mm].
double tool_length_mm(const Observations& data, std::size_t k) {
  double square = 0.0;
  for (const char* const column : kToolColumns)
    if (const auto found = data.extras.find(column); found != data.extras.end() && !std::isnan(found->second[k]))
      square += found->second[k] * found->second[k];
  return std::sqrt(square);
}

/// With one length only it is the same as bending of the head, and told as that.
bool has_tool_length(const Observations& data) {
  for (std::size_t k = 0; k < data.size(); ++k)
    if (tool_length_mm(data, k) > 0.0) return true;
  return false;
}

double in_head(const ReadingAt& at, std::size_t along) {
  return at.data.share_of(at.k, tilting_axis(at.data).value_or(Axis::X), kAlong[along]);
}

double in_machine(const ReadingAt& at, std::size_t along) {
  return -at.data.through_chain[at.k].of_workpiece[along];  // the workpiece does not turn
}

double in_head_by_length(const ReadingAt& at, std::size_t along) {
  constexpr double kMmPerM = 1000.0;
  return tool_length_mm(at.data, at.k) / kMmPerM * in_head(at, along);
}

double odd_moment(double angle_deg) { return std::sin(angle_deg * std::numbers::pi / 180.0); }
double even_moment(double angle_deg) { return 1.0 - std::cos(angle_deg * std::numbers::pi / 180.0); }

/// sin b along X, Y, Z, then 1 - cos b. @param share  of 1 um along X, Y or Z in the reading
template <double (*share)(const ReadingAt&, std::size_t)>
void bending_columns(const ReadingAt& at, std::span<double> row) {
  const Axis axis = tilting_axis(at.data).value_or(Axis::X);  // without one its errors reach nothing
  const double b_deg = at.data.position_mm[at.k][index_of(axis)];
  const std::array<double, 2> part{odd_moment(b_deg), even_moment(b_deg)};
  for (std::size_t i = 0; i < row.size(); ++i) row[i] = part[i / kAxes] * share(at, i % kAxes);
}

struct Words {
  std::string_view id, title, formula, cause, headline, how;
};

/// What the three have in common.
EffectDefinition bending(const Words& words) {
  return {
      .id = words.id,
      .title = words.title,
      .formula = words.formula,
      .cause = words.cause,
      .tells_apart = "follows sine and cosine of the tilting angle; even and odd in its sign",
      .check = "hang a weight on the head at +90 and -90 degrees and watch the tool with a gauge",
      .headline = words.headline,
      .parameters = {{"x_sin_um", "um", "along X with sin b"},
                     {"y_sin_um", "um", "along Y with sin b"},
                     {"z_sin_um", "um", "along Z with sin b"},
                     {"x_cos_um", "um", "along X with 1 - cos b"},
                     {"y_cos_um", "um", "along Y with 1 - cos b"},
                     {"z_cos_um", "um", "along Z with 1 - cos b"}},
      .carrier = Carrier::none,
      .how = words.how,
      .separated_by = {53,
                       "Measure the ball at pairs of +b and -b of the tilting axis, with two lengths of tool: a shift "
                       "of the axis line does not change with the length, bending does."},
      .traits = {.on_rotary_axes = true},
      .place = Place::artefact,
      // one direction and part of the moment, one direction, the plane in which the head tilts, everything
      .column_sets =
          {{0}, {1}, {2}, {3}, {4}, {5}, {0, 3}, {1, 4}, {2, 5}, {0, 2, 3, 5}, {1, 2, 4, 5}, {0, 1, 2, 3, 4, 5}},
  };
}

}  // namespace

EffectDefinition head_bending() {
  EffectDefinition head = bending({"head_bending", "Bending of the head",
                                   "s sin b + c (1 - cos b), in the frame that carries the tilting axis",
                                   "head or spindle bent by its own weight, which the tilting axis turns",
                                   "a head that bends as it tilts: {sizes}", "curves of the tilting axis in the map"});
  head.carrier = Carrier::error_map;
  for (std::size_t i = 0; i < head.parameters.size(); ++i)
    head.motions.push_back({head.parameters[i].name, kAlong[i % kAxes], i < kAxes ? odd_moment : even_moment});
  head.preference = 65;
  head.columns = bending_columns<in_head>;
  head.of_sense = [](const Site& site) {
    return tilting_axis(site.data) ? once_for_ball(site) : std::vector<EffectInstance>{};
  };
  return head;
}

EffectDefinition machine_bending() {
  EffectDefinition machine =
      bending({"machine_bending", "Bending of the machine under its head",
               "s sin b + c (1 - cos b), in the frame of the machine",
               "slide or column bent by the weight of the head, which the tilting axis turns",
               "a machine that bends as its head tilts: {sizes}", "bending of the machine in the map"});
  machine.carrier = Carrier::error_map;
  machine.bending = &RotaryBending::of_machine;
  machine.preference = 66;
  machine.columns = bending_columns<in_machine>;
  machine.of_sense = [](const Site& site) {
    return has_turning_head(site.data) ? once_for_ball(site) : std::vector<EffectInstance>{};
  };
  return machine;
}

EffectDefinition tool_bending() {
  EffectDefinition tool =
      bending({"tool_bending", "Bending in proportion to the length of the tool",
               "L (s sin b + c (1 - cos b)), in the frame that carries the tilting axis",
               "tool, holder or spindle bearing that gives way to the weight, with the length of the tool as lever",
               "a tool that gives way to its weight as the head tilts: {sizes}", "bending of the tool in the map"});
  tool.carrier = Carrier::error_map;
  tool.bending = &RotaryBending::of_tool;
  for (ParameterDefinition& parameter : tool.parameters) parameter.unit = "um/m";
  constexpr std::array<std::string_view, 2 * kAxes> kNames{"x_sin_um_per_m", "y_sin_um_per_m", "z_sin_um_per_m",
                                                           "x_cos_um_per_m", "y_cos_um_per_m", "z_cos_um_per_m"};
  for (std::size_t i = 0; i < kNames.size(); ++i) tool.parameters[i].name = kNames[i];
  tool.preference = 67;
  tool.columns = bending_columns<in_head_by_length>;
  tool.of_sense = [](const Site& site) {
    const bool is_tried = tilting_axis(site.data) && has_tool_length(site.data);
    return is_tried ? once_for_ball(site) : std::vector<EffectInstance>{};
  };
  return tool;
}

}  // namespace ecs::model::effects
