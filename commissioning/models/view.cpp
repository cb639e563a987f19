#include "commissioning/models/view.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"

namespace ecs::commissioning {

std::vector<MeasuredLine> measured_lines(const model::Observations& data) {
  std::map<std::tuple<model::Channel, Axis, Vector3>, MeasuredLine> lines;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const Vector3 parked = data.parked_of(k);
    MeasuredLine& line = lines[{data.channel(k), data.axis[k], parked}];
    if (line.rows.empty()) line.path = data.path_name(k);
    line.axis = data.axis[k];
    line.sense = data.sense[k];
    line.rotary = data.rotary;
    line.parked_mm = parked;
    line.rows.push_back(k);
  }
  std::vector<MeasuredLine> list;
  for (auto& each : lines) list.push_back(std::move(each.second));
  return list;
}

std::vector<double> places_along(const model::Observations& data, Axis axis) {
  std::vector<double> x;
  for (std::size_t k = 0; k < data.size(); ++k)
    x.push_back(data.on_path(k) ? data.along[k] : data.position_mm[k][index_of(axis)]);
  return x;
}

std::string label_along(const model::Observations& data, const MeasuredLine& line) {
  if (!line.path.empty()) return std::string(variable_along(data.path_of(line.rows.front())));
  return fmt::format("{} position [{}]", data.letter(line.axis), data.position_unit());
}

std::string title_of(const MeasuredLine& line) {
  if (!line.path.empty()) return line.path;
  const std::string text = fmt::format("{} along {}", name_of(line.sense), laser::letter_of(line.axis, line.rotary));
  std::vector<std::string> parked;
  for (const Axis a : kAllAxes)
    if (a != line.axis && line.parked_mm[index_of(a)] != 0.0)
      parked.push_back(fmt::format("{} {:.6g}", laser::letter_of(a, line.rotary), line.parked_mm[index_of(a)]));
  return parked.empty() ? text : fmt::format("{} at {}", text, fmt::join(parked, ", "));
}

Mark reading_mark(int approach) {
  if (approach == 0) return Mark::reading;
  return approach > 0 ? Mark::forward_reading : Mark::reverse_reading;
}

Mark line_mark(int approach) {
  if (approach == 0) return Mark::both;
  return approach > 0 ? Mark::forward : Mark::reverse;
}

namespace {

using model::LadderStep;
using model::ParameterEstimate;

/// Digits behind the point that show `digits` significant ones of `value`.
int decimals_for(double value, int digits) {
  if (value == 0.0 || !std::isfinite(value)) return 0;
  return std::clamp(digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))), 0, 9);
}

/// Neighbours averaged until at most `most` are left.
std::vector<ShapePoint> thinned(const std::vector<ShapePoint>& points, std::size_t most) {
  if (points.size() <= most) return points;
  std::vector<ShapePoint> few(most);
  std::vector<double> count(most, 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t bin = i * most / points.size();
    few[bin].at += points[i].at;
    few[bin].um += points[i].um;
    count[bin] += 1.0;
  }
  for (std::size_t i = 0; i < most; ++i) {
    few[i].at /= count[i];
    few[i].um /= count[i];
  }
  return few;
}

/// 41 columns with zero in the middle; nothing beside numbers that are all printed as 0.00.
std::string bar(double um, double largest) {
  constexpr int kHalf = 20;
  constexpr double kLeastPrinted = 0.005;
  std::string cells(2 * kHalf + 1, ' ');
  const int length = largest >= kLeastPrinted ? static_cast<int>(std::lround(kHalf * um / largest)) : 0;
  const auto first = static_cast<std::size_t>(std::min(kHalf, kHalf + length)),
             count = static_cast<std::size_t>(std::abs(length)) + 1;
  cells.replace(first, count, count, '#');
  cells[kHalf] = '|';
  cells.erase(cells.find_last_not_of(' ') + 1);
  return cells;
}

constexpr const char* kInitialModel = "(initial model)";
constexpr std::string_view kLadderRow =
    "{step:>4}  {effect} {rms_um:>9} {peak_um:>9} {noise_um:>9} {held_out_rms_um:>9}\n";

AnswerFields fields_of(const model::Model& model, const LadderStep& step, std::size_t number) {
  const std::string name = step.effect.empty() ? kInitialModel : name_with_alternatives(model, step.effect);
  return described("step"_shown(number), "effect"_is(text_or_null(step.effect), padded(name, 34)),
                   "data"_is(text_cell(step.data)), "rms_before_um"_is(step.rms_before_um, 3),
                   "rms_um"_is(step.rms_um, 3), "peak_um"_is(step.peak_um, 3), "noise_um"_is(step.noise_um, 3),
                   "held_out_rms_um"_is(step.held_out_rms_um, 3), "outliers"_is(step.outliers));
}

}  // namespace

std::string few_digits(double value, int digits) {
  const double size = std::abs(value);
  if (!std::isfinite(value)) return "-";
  if (value != 0.0 && (size < 1e-4 || size >= 1e7)) return fmt::format("{:.{}e}", value, digits - 1);
  return fmt::format("{:.{}f}", value, decimals_for(value, digits));
}

std::string position_text(double mm) { return shortest(std::round(1e3 * mm) / 1e3 + 0.0); }

std::string value_text(const ParameterEstimate& p) {
  const std::string unit = p.unit.empty() ? "" : " " + p.unit;
  if (p.held) return few_digits(p.value, 5) + unit + " (fixed)";
  if (p.undetermined) return "not determined by these data";
  if (!p.sigma || *p.sigma <= 0.0) return few_digits(p.value, 4) + unit;
  if (*p.sigma < 1e-9) return few_digits(p.value, 6) + unit;
  const int decimals = decimals_for(*p.sigma, 2);
  return fmt::format("{:.{}f} +- {:.{}f}{}", p.value, decimals, *p.sigma, decimals, unit);
}

std::string parameters_text(const std::vector<ParameterEstimate>& parameters) {
  std::vector<std::string> parts;
  bool any_sigma = false;
  for (const ParameterEstimate& one : parameters) {
    if (one.value == 0.0 && !one.sigma) continue;
    any_sigma = any_sigma || value_text(one).find("+-") != std::string::npos;
    const std::string name = model::spoken_name(shown_name(one), one.unit);
    const char* between = name.empty() ? "" : one.undetermined ? ": " : " ";
    parts.push_back(name + between + value_text(one));
  }
  return fmt::format("{}{}", fmt::join(parts, ", "), any_sigma ? " (k = 1)" : "");
}

std::string rms_heading(std::string_view unit) {
  if (unit == "um") return "rms [um]";
  return unit == "um/m" ? "rms um/m" : "[um,um/m]";
}

std::string_view unit_of_model(const model::Model& model) {
  std::size_t rotations = 0, others = 0;
  const auto count = [&](const std::optional<Sense>& sense, model::Place place) {
    const bool of_readings = place != model::Place::set_up && place != model::Place::location;
    ++(sense && of_readings && is_rotation(*sense) ? rotations : others);
  };
  for (const model::EffectInstance& effect : model.effects) {
    for (const model::UserFormula& formula : effect.formulas) count(formula.sense, model::Place::formulas);
    if (!effect.is_user()) count(effect.sense, effect.definition().place);
  }
  const bool is_of_ball = std::ranges::any_of(model.effects, [](const model::EffectInstance& effect) {
    return effect.definition().place == model::Place::artefact;
  });
  if (rotations == 0 || is_of_ball) return "um";
  return others == 0 ? "um/m" : model::kBothUnits;
}

std::string in_each_unit(double all, const model::SizesByUnit& each, std::string_view unit) {
  if (unit != model::kBothUnits) return fmt::format("{:.3f} {}", all, unit);
  return fmt::format("{:.3f} um and {:.3f} um/m", each.um, each.um_per_m);
}

void add_by_unit(Json& answer, std::string_view unit,
                 const std::vector<std::pair<std::string, model::SizesByUnit>>& sizes) {
  if (unit != model::kBothUnits) return;
  for (const auto& [name, size] : sizes) {
    answer["by_unit"]["um"][name] = number_or_null(size.um);
    answer["by_unit"]["um/m"][name] = number_or_null(size.um_per_m);
  }
}

std::string separation_text(double condition) {
  // condition number from which collinearity seriously degrades estimates (Belsley, Kuh and Welsch 1980)
  constexpr double kPoorlySeparated = 30.0;
  return fmt::format("parameters {} separated (condition number {})", condition < kPoorlySeparated ? "well" : "poorly",
                     few_digits(condition));
}

std::string noise_text(const model::PureError& noise) {
  const std::string size = in_each_unit(noise.noise_um, noise.by_unit, noise.unit);
  if (noise.is_of_step) return size + ", given by the resolution of these readings (their repeats show less)";
  if (noise.from_repeats && noise.in_part)
    return size + " from repeats, or from neighbouring readings where too few were repeated";
  if (noise.from_repeats) return size + " from repeats";
  if (!noise.differ_in.empty())
    return fmt::format("at most {}, from readings of the same targets with different {}", size, noise.differ_in);
  return fmt::format(
      "at most {}, from the residuals of neighbouring readings, because there are too few repeats with the same "
      "approach and conditions; it depends slightly on the model",
      size);
}

std::string_view direction_text(int approach) {
  if (approach == 0) return "unknown";
  return approach > 0 ? "forward" : "reverse";
}

std::string shape_text(const std::string& variable, const std::vector<ShapePoint>& points, std::string_view unit,
                       const std::vector<std::string>& senses) {
  constexpr std::size_t kMostLines = 12;
  const std::vector<ShapePoint> few = thinned(points, kMostLines);
  double largest = 0.0;
  for (const ShapePoint& point : few) largest = std::max(largest, std::abs(point.um));
  std::string text = fmt::format(
      "  {:>22}  {:>9}  of the residual{}\n", variable, fmt::format("mean [{}]", unit),
      senses.empty() ? ", all readings together" : fmt::format(" of {} near each value", fmt::join(senses, ", ")));
  for (const ShapePoint& point : few)
    text += fmt::format("  {:>22}  {:>9.2f}  {}\n", position_text(point.at), point.um, bar(point.um, largest));
  return text;
}

std::string rows_text(const std::vector<int>& rows, std::size_t most) {
  const std::vector<int> first(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(std::min(most, rows.size())));
  std::string text = fmt::format("{}", fmt::join(first, ", "));
  return rows.size() > most ? text + fmt::format(" and {} more", rows.size() - most) : text;
}

Cell ladder_cell(const model::Model& model) {
  const std::vector<LadderStep>& history = model.history;
  if (history.empty()) return {Json::array(), "the model has no added effects; `ecs model add` adds one\n"};
  const std::string_view unit = unit_of_model(model);
  const std::string heading = unit == model::kBothUnits ? "rms [um, um/m]" : rms_heading(unit);
  Cell ladder{Json::array(), fmt::format("{:>4}  {:<29} {:>14} {:>9} {:>9} {:>9}\n", "step", "effect", heading, "peak",
                                         "noise", "held-out")};
  const LadderStep& first = history.front();
  const std::size_t before = first.effect.empty() ? 0 : 1;
  if (before > 0)
    ladder.text += fmt::format("{:>4}  {} {:>9.3f} {:>9} {:>9} {:>9}\n", 0, padded(kInitialModel, 34),
                               first.rms_before_um, "-", "-", "-");
  for (std::size_t i = 0; i < history.size(); ++i)
    ladder.add(record_cell(kLadderRow, fields_of(model, history[i], before + i)));
  const bool same =
      std::all_of(history.begin(), history.end(), [&](const LadderStep& one) { return one.data == first.data; });
  if (same) ladder.text += paragraph("fitted to " + first.data, 6, 8);
  for (std::size_t i = 0; i < history.size() && !same; ++i)
    ladder.text += paragraph(fmt::format("step {} fitted to {}", before + i, history[i].data), 6, 8);
  for (std::size_t i = 0; i < history.size(); ++i)
    if (history[i].outliers > 0)
      ladder.text += paragraph(fmt::format("rms and peak of step {}{} exclude {} outlier{}", before + i,
                                           i == 0 ? ", and the rms before it," : "", history[i].outliers,
                                           history[i].outliers == 1 ? "" : "s"),
                               6, 8);
  if (std::any_of(history.begin(), history.end(),
                  [](const LadderStep& one) { return is_just_below(one.rms_um, one.noise_um); }))
    ladder.text += paragraph(std::string(kBelowNoise), 6, 8);
  return ladder;
}

std::string notes_text(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += paragraph("note: " + note, 0, 6);
  return text;
}

}  // namespace ecs::commissioning
