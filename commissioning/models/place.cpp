#include "commissioning/models/place.hpp"

#include <cmath>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "commissioning/models/view.hpp"
#include "laser/csv_columns.hpp"

namespace ecs::commissioning {
namespace {

using model::PointQuery;
using model::VolumePoint;

struct Asked {
  PointQuery query;
  bool axis_given = false;
  bool sense_given = false;
};

auto not_understood(std::string_view part) {
  return problem(
      ProblemKind::usage,
      "--at: expected x=MM,y=MM,z=MM and, if the model needs them, axis=X|Y|Z, approach=1|-1, sense=EX, time_s, "
      "feed_mm_min, load_kg or t_<sensor>_degC; not understood: \"{}\"",
      part);
}

bool take_word(Asked& asked, std::string_view key, std::string_view value) {
  if (const auto axis = laser::axis_named(value); key == "axis" && axis) {
    asked.query.axis = axis->axis;
    asked.query.rotary = axis->rotary;
    return asked.axis_given = true;
  }
  if (key == "sense" && sense_named(value)) {
    asked.query.sense = *sense_named(value);
    return asked.sense_given = true;
  }
  return false;
}

bool take_number(PointQuery& query, std::string_view key, double value) {
  for (const Axis a : kAllAxes) {
    const std::string_view column = laser::target_column(a, query.rotary);
    if (key != column && key != column.substr(0, 1)) continue;
    query.position_mm[index_of(a)] = value;
    return true;
  }
  for (const Axis a : kAllAxes) {
    const std::string_view column = laser::target_column(a, false);
    if (!query.rotary || (key != column && key != column.substr(0, 1))) continue;
    query.place_mm[index_of(a)] = value;
    return true;
  }
  if (key == "approach" && (value == 1.0 || value == -1.0))
    query.approach = static_cast<int>(value);
  else if (key == "time_s")
    query.time_s = value;
  else if (key == "feed_mm_min")
    query.feed_mm_min = value;
  else if (key == "load_kg")
    query.load_kg = value;
  else if (laser::is_sensor_column(key))
    query.sensors_degC[std::string(key)] = value;
  else
    return false;
  return true;
}

Result<Asked> asked_in(const std::string& words) {
  Asked asked;
  for (const std::string_view part : split(words, ',')) {
    const auto sides = split(part, '=');
    if (sides.size() != 2) return not_understood(part);
    const std::string_view key = trimmed(sides[0]), value = trimmed(sides[1]);
    if (take_word(asked, key, value)) continue;
    const auto number = number_in(value);
    if (!number || !take_number(asked.query, key, *number)) return not_understood(part);
  }
  return asked;
}

double size_of(const Vector3& v) { return std::hypot(v[0], v[1], v[2]); }

const VolumePoint* worst_in(const std::vector<VolumePoint>& points) {
  const VolumePoint* worst = nullptr;
  for (const VolumePoint& point : points)
    if (worst == nullptr || size_of(point.error_um) > size_of(worst->error_um)) worst = &point;
  return worst;
}

/// Smallest and largest error in each direction.
struct Extent {
  Vector3 least{};
  Vector3 most{};
};
Extent extent_of(const std::vector<VolumePoint>& points) {
  Extent extent{points.front().error_um, points.front().error_um};
  for (const VolumePoint& point : points)
    for (std::size_t i = 0; i < kAxes; ++i) {
      extent.least[i] = std::min(extent.least[i], point.error_um[i]);
      extent.most[i] = std::max(extent.most[i], point.error_um[i]);
    }
  return extent;
}

std::string range_text(std::string_view sense, double least, double most) {
  return fmt::format("{} {:.2f} ... {:.2f}", sense, least, most);
}

Cell volume_cell(std::string_view direction, const std::vector<VolumePoint>& points) {
  const VolumePoint& worst = *worst_in(points);
  const Vector3& at = worst.position_mm;
  const double worst_um = size_of(worst.error_um);
  Json worst_json = position_json(at);
  worst_json["error_um"] = number_or_null(worst_um);
  const Extent e = extent_of(points);
  AnswerFields fields = described("points"_is(points.size()));
  for (const auto& [key, sense, i] : {std::tuple{"EX_um", "EX", 0U}, {"EY_um", "EY", 1U}, {"EZ_um", "EZ", 2U}})
    fields.push_back(
        {key, {{number_or_null(e.least[i]), number_or_null(e.most[i])}, range_text(sense, e.least[i], e.most[i])}});
  fields.push_back(
      {"worst",
       {std::move(worst_json), paragraph(fmt::format("worst {:.2f} um at x {} y {} z {} mm", worst_um,
                                                     position_text(at[0]), position_text(at[1]), position_text(at[2])),
                                         4)}});
  return record_cell(fmt::format("  {}: {{EX_um}}, {{EY_um}}, {{EZ_um}} um\n{{worst}}", direction), fields);
}

}  // namespace

Result<PlaceShares> shares_at(const model::Model& fitted, const std::optional<params::Machine>& machine,
                              const std::string& words) {
  ECS_TRY(asked, asked_in(words));
  PlaceShares shares{asked.query, {Sense::EX, Sense::EY, Sense::EZ}, {}};
  const bool of_ball = asked.query.place_mm != Vector3{};
  if (asked.query.rotary && !of_ball) shares.senses = {Sense::EA, Sense::EB, Sense::EC};
  if (asked.sense_given) shares.senses = {asked.query.sense};
  for (const Sense sense : shares.senses) {
    PointQuery query = asked.query;
    query.sense = sense;
    if (!asked.axis_given) query.axis = direction_of(sense);
    ECS_TRY(breakdown, model::breakdown_at(fitted, machine, query));
    shares.per.push_back(std::move(breakdown));
  }
  return shares;
}

Cell shares_cell(const PlaceShares& shares) {
  const Vector3& at = shares.query.position_mm;
  const bool rotary = shares.query.rotary;
  Json senses = Json::array();
  std::string heading = padded("effect", 34), sums = padded("sum", 34);
  std::vector<std::string> rows;
  for (const model::ShareAtPoint& share : shares.per.front().shares) rows.push_back(padded(share.effect, 34));
  for (std::size_t s = 0; s < shares.senses.size(); ++s) {
    const model::Breakdown& per = shares.per[s];
    heading += fmt::format(" {:>10}", name_of(shares.senses[s]));
    sums += fmt::format(" {:>10.3f}", per.total_um);
    Json effects = Json::array();
    for (std::size_t i = 0; i < per.shares.size(); ++i) {
      effects.push_back(object_of("effect"_is(per.shares[i].effect), "um"_is(per.shares[i].um)));
      rows[i] += fmt::format(" {:>10.3f}", per.shares[i].um);
    }
    senses.push_back(object_of("sense"_is(name_of(shares.senses[s])), "total_um"_is(per.total_um),
                               "effects"_is(std::move(effects)), "notes"_is(per.notes)));
  }
  rows.push_back(sums);
  Json object = position_json(at, rotary);
  object["approach"] = shares.query.approach;
  object["senses"] = std::move(senses);
  return {std::move(object),
          fmt::format("\nthe model at {} {} {} {} {} {} {}, {} [um; um/m for EA EB EC]\n{}\n{}\n", rotary ? "a" : "x",
                      position_text(at[0]), rotary ? "b" : "y", position_text(at[1]), rotary ? "c" : "z",
                      position_text(at[2]), laser::target_unit(rotary), direction_text(shares.query.approach), heading,
                      fmt::join(rows, "\n"))};
}

Result<PredictedVolume> volume_of(const model::Model& fitted, const std::optional<params::Machine>& machine,
                                  std::size_t points_per_axis) {
  if (!machine)
    return problem(ProblemKind::usage, "--volume needs --machine: the machine file gives the travels of the axes");
  ECS_TRY(forward, model::predicted_volume(fitted, *machine, points_per_axis, 1));
  ECS_TRY(reverse, model::predicted_volume(fitted, *machine, points_per_axis, -1));
  return PredictedVolume{std::move(forward), std::move(reverse)};
}

Cell volume_cell(const PredictedVolume& volume) {
  Cell cell = record_cell("{forward}{reverse}", "forward"_is(volume_cell("forward", volume.forward)),
                          "reverse"_is(volume_cell("reverse", volume.reverse)));
  cell.text =
      fmt::format("\npredicted error over the working volume, {} positions\n", volume.forward.size()) + cell.text;
  return cell;
}

std::string to_csv(const PredictedVolume& volume) {
  std::string text = "x_mm,y_mm,z_mm,approach,EX_um,EY_um,EZ_um\n";
  for (const auto& [points, approach] : {std::pair{&volume.forward, 1}, {&volume.reverse, -1}})
    for (const VolumePoint& p : *points)
      text += fmt::format("{},{},{},{},{:.4f},{:.4f},{:.4f}\n", shortest(p.position_mm[0]), shortest(p.position_mm[1]),
                          shortest(p.position_mm[2]), approach, p.error_um[0], p.error_um[1], p.error_um[2]);
  return text;
}

}  // namespace ecs::commissioning
