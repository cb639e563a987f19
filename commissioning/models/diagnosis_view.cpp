#include "commissioning/models/diagnosis_view.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/paragraph.hpp"
#include "commissioning/models/view.hpp"
#include "model/effects/definition.hpp"

namespace ecs::commissioning {
namespace {

using model::Candidate;
using model::Diagnosis;
using model::Verdict;

/// "cyclic:X:EX, reverse (periodic error)"
std::string titled(const Candidate& candidate) {
  std::string title(candidate.effect.definition().title);
  if (!title.empty() && !candidate.effect.is_user())
    title[0] = static_cast<char>(title[0] >= 'A' && title[0] <= 'Z' ? title[0] - 'A' + 'a' : title[0]);
  return fmt::format("{} ({})", place_text(candidate.effect), title);
}

std::string named_effects(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const Candidate& candidate : diagnosis.candidates) {
    if (!candidate.named) continue;
    std::string name = titled(candidate);
    if (!candidate.indistinguishable_from.empty())
      name += fmt::format(", or {}, which these data cannot tell from it",
                          fmt::join(candidate.indistinguishable_from, " or "));
    names.push_back(std::move(name));
  }
  return fmt::format("{}", fmt::join(names, "; and "));
}

std::string structure_sentence(const Diagnosis& diagnosis) {
  std::string text = "The residual is not noise, and no effects of the library, alone or together, explain all of it";
  std::vector<std::string> variables;
  for (const model::Dependence& one : diagnosis.where)
    if (variables.size() < 3 && (variables.empty() || one.strength >= 0.1)) variables.push_back(one.variable);
  if (variables.empty()) return text + ".";
  return text + fmt::format(": it depends on {}.", fmt::join(variables, ", "));
}

std::string summary(const Diagnosis& d) {
  std::string text = fmt::format("{} readings. The model leaves rms {:.3f} um; the noise of one reading is {}. ",
                                 d.observations, d.rms_um, noise_text(d.noise));
  if (d.verdict != Verdict::adequate && d.rms_after_um < d.rms_um)
    text +=
        fmt::format("With {}: rms {:.3f} um. ",
                    d.verdict == Verdict::missing_effect ? "what is named" : "the best that was tried", d.rms_after_um);
  text += fmt::format("Lack of fit: {}", lack_of_fit_text(d.lack_of_fit));
  if (d.lack_of_fit_after && d.verdict == Verdict::missing_effect)
    text += fmt::format("; afterwards {}", lack_of_fit_text(d.lack_of_fit_after));
  return paragraph(text + ".");
}

std::string percent(double share) { return fmt::format("{:.1f} %", 100.0 * share); }

std::string false_naming_text(double chance, std::size_t blanks) {
  const double least = 1.0 / (static_cast<double>(blanks) + 1.0);
  return chance <= least ? fmt::format("< {:.2g} %", 100.0 * least) : fmt::format("{:.2g} %", 100.0 * chance);
}

constexpr std::string_view kHead =
    "                               rms after  above noise    held out [um]     false\n"
    "                                    [um]    explained   before    after   naming\n";

std::string evidence_row(const Candidate& c, std::size_t blanks) {
  const auto cell = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.3f}", *value) : std::string("-");
  };
  return fmt::format("{} {:>9.3f} {:>12} {:>8} {:>8} {:>8}\n", padded(place_text(c.effect), 30), c.rms_after_um,
                     percent(c.explainable_share), cell(c.held_out_rms_before_um), cell(c.held_out_rms_um),
                     false_naming_text(c.false_naming, blanks));
}

std::string details(const Candidate& c) {
  std::string text;
  if (!c.parameters.empty()) text += paragraph(parameters_text(c.parameters), 2, 4);
  if (!c.because.empty()) text += paragraph("because: " + c.because, 2, 4);
  if (!c.indistinguishable_from.empty())
    text += paragraph(fmt::format("cannot be told from: {}", fmt::join(c.indistinguishable_from, ", ")), 2, 4);
  if (c.skipped > 0) text += paragraph(fmt::format("{} readings lack a cell that it needs", c.skipped), 2, 4);
  if (!c.next_measurement.empty()) text += paragraph("next: " + c.next_measurement, 2, 4);
  return text;
}

std::string table_of(const Diagnosis& d, bool named, std::string_view title) {
  std::string text;
  for (const Candidate& candidate : d.candidates) {
    if (candidate.named != named) continue;
    if (text.empty()) text = fmt::format("\n{}\n{}", title, kHead);
    text += evidence_row(candidate, d.noise_replicates);
    if (named) text += details(candidate);
  }
  return text;
}

std::vector<ShapePoint> shape_of(const model::Dependence& one) {
  std::vector<ShapePoint> points;
  for (std::size_t i = 0; i < std::min(one.at.size(), one.mean_um.size()); ++i)
    points.push_back({one.at[i], one.mean_um[i]});
  return points;
}

double largest_in(const std::vector<ShapePoint>& points) {
  double largest = 0.0;
  for (const ShapePoint& point : points) largest = std::max(largest, std::abs(point.um));
  return largest;
}

std::string where_text(const Diagnosis& d) {
  if (d.where.empty()) return {};
  std::string text = "\nwhat the residual depends on (share of its variance)\n";
  for (const model::Dependence& one : d.where)
    text += fmt::format("  {} {:>8}  in noise alone: p = {:.1g}\n", padded(one.variable, 26), percent(one.strength),
                        one.p_value);
  std::size_t shapes = 0;
  for (const model::Dependence& one : d.where) {
    const std::vector<ShapePoint> points = shape_of(one);
    if (one.strength < kWorthAShape || largest_in(points) < 0.3 * d.noise.noise_um || ++shapes > kMostShapes) continue;
    text += "\n" + shape_text(one.variable, points);
  }
  return text;
}

}  // namespace

std::string verdict_sentence(const Diagnosis& diagnosis) {
  switch (diagnosis.verdict) {
    case Verdict::adequate:
      return "The model is adequate: what it leaves is noise.";
    case Verdict::missing_effect:
      return fmt::format("The model lacks {}.", named_effects(diagnosis));
    default:
      return structure_sentence(diagnosis);
  }
}

std::string diagnosis_text(const Diagnosis& d) {
  std::string text = paragraph(verdict_sentence(d)) + "\n" + summary(d);
  text += table_of(d, true, d.verdict == Verdict::missing_effect ? "what is missing" : "the best explanation there is");
  text += table_of(d, false, "rivals and weaker explanations");
  text += where_text(d);
  if (!d.outliers.empty())
    text += "\n" + paragraph(fmt::format("outliers: rows {} ({} of {} readings) differ; they weigh little, and "
                                         "stay in every rms",
                                         rows_text(d.outliers), d.outliers.size(), d.observations),
                             0, 2);
  text += "\n";
  if (d.noise_replicates > 0)
    text += paragraph(fmt::format("{} candidates were tried, and {} blanks of noise alone on the same design",
                                  d.candidates_tried, d.noise_replicates));
  text += notes_text(d.notes);
  return text;
}

}  // namespace ecs::commissioning
