#include "commissioning/models/view.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/paragraph.hpp"
#include "base/text.hpp"

namespace ecs::commissioning {
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

/// 41 columns with zero in the middle.
std::string bar(double um, double largest) {
  constexpr int kHalf = 20;
  std::string cells(2 * kHalf + 1, ' ');
  const int length = largest > 0.0 ? static_cast<int>(std::lround(kHalf * um / largest)) : 0;
  for (int i = std::min(0, length); i <= std::max(0, length); ++i) cells[static_cast<std::size_t>(kHalf + i)] = '#';
  cells[kHalf] = '|';
  cells.erase(cells.find_last_not_of(' ') + 1);
  return cells;
}

std::string ladder_row(std::size_t step, const std::string& effect, double rms_um, std::optional<double> peak_um,
                       std::optional<double> noise_um, std::optional<double> held_out_um) {
  const auto cell = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.3f}", *value) : std::string("-");
  };
  return fmt::format("{:>4}  {} {:>9.3f} {:>9} {:>9} {:>9}\n", step, padded(effect, 34), rms_um, cell(peak_um),
                     cell(noise_um), cell(held_out_um));
}

}  // namespace

std::string place_text(const model::EffectInstance& effect) {
  std::string text = to_text(effect);
  if (effect.approach != model::ApproachMode::both) text += fmt::format(", {}", name_of(effect.approach));
  if (!effect.sensor.empty()) text += fmt::format(" with {}", sensors_text(effect));
  return text;
}

std::string few_digits(double value, int digits) {
  const double size = std::abs(value);
  if (!std::isfinite(value)) return "-";
  if (value != 0.0 && (size < 1e-4 || size >= 1e7)) return fmt::format("{:.{}e}", value, digits - 1);
  return fmt::format("{:.{}f}", value, decimals_for(value, digits));
}

std::string position_text(double mm) { return shortest(std::round(1e3 * mm) / 1e3 + 0.0); }

std::string value_text(const ParameterEstimate& p) {
  const std::string unit = p.unit.empty() ? "" : " " + p.unit;
  if (p.held) return few_digits(p.value, 5) + unit + " (held)";
  if (p.undetermined) return few_digits(p.value) + unit + " (undetermined)";
  if (!p.sigma || *p.sigma <= 0.0) return few_digits(p.value, 4) + unit;
  if (*p.sigma < 1e-9) return few_digits(p.value, 6) + unit;
  const int decimals = decimals_for(*p.sigma, 2);
  return fmt::format("{:.{}f} +- {:.{}f}{}", p.value, decimals, *p.sigma, decimals, unit);
}

std::string parameters_text(const std::vector<ParameterEstimate>& parameters) {
  std::vector<std::string> parts;
  for (const ParameterEstimate& one : parameters)
    if (one.value != 0.0 || one.sigma) parts.push_back(fmt::format("{} {}", one.name, value_text(one)));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string lack_of_fit_text(const std::optional<model::LackOfFit>& test) {
  return test ? fmt::format("F = {}, p = {:.1g}", few_digits(test->F), test->p) : "too few repeats to judge";
}

std::string noise_text(const model::PureError& noise) {
  return fmt::format("{:.3f} um from {}", noise.noise_um,
                     noise.from_repeats ? "repeats" : "neighbouring readings (there are no repeats)");
}

std::string_view direction_text(int approach) {
  if (approach == 0) return "no approach";
  return approach > 0 ? "forward" : "reverse";
}

std::string shape_text(const std::string& variable, const std::vector<ShapePoint>& points, std::size_t most_lines) {
  const std::vector<ShapePoint> few = thinned(points, most_lines);
  double largest = 0.0;
  for (const ShapePoint& point : few) largest = std::max(largest, std::abs(point.um));
  std::string text = fmt::format("  {:>22}  {:>9}\n", variable, "mean [um]");
  for (const ShapePoint& point : few)
    text += fmt::format("  {:>22}  {:>9.2f}  {}\n", position_text(point.at), point.um, bar(point.um, largest));
  return text;
}

std::string rows_text(const std::vector<int>& rows, std::size_t most) {
  const std::vector<int> first(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(std::min(most, rows.size())));
  std::string text = fmt::format("{}", fmt::join(first, ", "));
  return rows.size() > most ? text + fmt::format(" and {} more", rows.size() - most) : text;
}

std::string ladder_text(const std::vector<LadderStep>& history) {
  if (history.empty()) return "no step was taken yet: `ecs model add` takes one\n";
  std::string text = fmt::format("{:>4}  {} {:>9} {:>9} {:>9} {:>9}\n", "step", padded("effect", 34), "rms [um]",
                                 "peak", "noise", "held-out");
  std::size_t step = 0;
  if (!history.front().effect.empty())
    text += ladder_row(step++, "(before)", history.front().rms_before_um, {}, {}, {});
  for (const LadderStep& one : history)
    text += ladder_row(step++, one.effect.empty() ? "(the model as it began)" : one.effect, one.rms_um, one.peak_um,
                       one.noise_um, one.held_out_rms_um);
  const bool same = std::all_of(history.begin(), history.end(),
                                [&](const LadderStep& one) { return one.data == history.front().data; });
  if (same) return text + paragraph("fitted to " + history.front().data, 6, 8);
  step = history.front().effect.empty() ? 0 : 1;
  for (const LadderStep& one : history) text += paragraph(fmt::format("step {} fitted to {}", step++, one.data), 6, 8);
  return text;
}

std::string notes_text(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += paragraph("note: " + note, 0, 6);
  return text;
}

}  // namespace ecs::commissioning
