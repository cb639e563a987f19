// Rates with their exact intervals (Clopper and Pearson 1934).
#include "diagnose_tally.hpp"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>

#include "diagnose_score.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::bench {
namespace {

constexpr double kProvedFrom = 100.0;  ///< e-value, docs/model.md

std::string rate(unsigned hits, unsigned cases) {
  const auto interval = model::clopper_pearson(hits, cases);
  return fmt::format("{:>4}/{:<4} = {:5.1f} %  ({:5.1f} … {:5.1f})", hits, cases,
                     cases == 0 ? 0.0 : 100.0 * hits / cases, 100.0 * interval.low, 100.0 * interval.high);
}

}  // namespace

bool count(const Case& one, const Answer& answer, Tally& tally) {
  const model::Diagnosis& d = answer.diagnosis;
  const bool good = right(one, d);
  ++tally.cases;
  tally.blank = one.kind == CaseKind::blank;
  tally.hits += good ? 1U : 0U;
  tally.named += std::any_of(d.candidates.begin(), d.candidates.end(), [](const auto& c) { return c.named; }) ? 1U : 0U;
  tally.proved += std::any_of(d.candidates.begin(), d.candidates.end(),
                              [](const auto& c) { return c.e_value.value_or(0.0) >= kProvedFrom; })
                      ? 1U
                      : 0U;
  tally.likely += std::any_of(d.candidates.begin(), d.candidates.end(),
                              [](const auto& c) { return c.standing == model::Standing::likely; })
                      ? 1U
                      : 0U;
  if (answer.has_rival) tally.rival_hits += rival_right(one, answer.rival) ? 1U : 0U;
  auto& effect = tally.by_effect[one.kind == CaseKind::single ? one.name.substr(0, one.name.find(':')) : ""];
  effect.first += good ? 1U : 0U;
  ++effect.second;
  if (one.kind == CaseKind::out_of_library && good && !one.truth.variables.empty()) {
    ++tally.variables;
    const auto& list = one.truth.variables;
    const bool named = !d.where.empty() && std::find(list.begin(), list.end(), d.where.front().variable) != list.end();
    tally.variables_named += named ? 1U : 0U;
  }
  if ((one.kind == CaseKind::single || one.kind == CaseKind::pair) && good) {
    const ParameterCount parameters = count_parameters(one, d);
    tally.parameters += parameters.counted;
    tally.within += parameters.within;
    if (one.truth.true_model_rms_um > 0.0) {
      ++tally.added;
      tally.added_well += d.rms_after_um <= 1.05 * one.truth.true_model_rms_um ? 1U : 0U;
    }
  }
  return good;
}

std::string report_line(const std::string& where, const Case& one, const Answer& answer) {
  const model::Diagnosis& d = answer.diagnosis;
  std::string text = fmt::format("  {} n {} truth {}", where, one.data.readings.size(), one.name);
  for (const HiddenEffect& effect : one.truth.effects)
    text += fmt::format(" ({}{}snr {:.1f})",
                        effect.approach.empty() || effect.approach == "both" ? "" : effect.approach + " ",
                        effect.sensor.empty() ? "" : effect.sensor + " ", effect.snr);
  if (!one.truth.text.empty() && one.kind != CaseKind::single) text += " \"" + one.truth.text + "\"";
  if (!one.truth.group.empty()) text += fmt::format(" group {}", fmt::join(one.truth.group, " "));
  text += fmt::format(" -> {}", model::name_of(d.verdict));
  for (const model::Candidate& c : d.candidates)
    if (c.named || &c == &d.candidates.front())
      text += fmt::format(
          " [{}{}{}{} {:.3f}->{:.3f} false {:.1g} e {:.2g} {}]", c.named ? "" : "not named: ", to_text(c.effect),
          c.effect.approach == model::ApproachMode::both ? "" : fmt::format("/{}", model::name_of(c.effect.approach)),
          c.effect.sensor.empty() ? "" : "/" + c.effect.sensor, d.rms_um, c.rms_after_um, c.false_naming,
          c.e_value.value_or(0.0), fmt::join(c.indistinguishable_from, " "));
  for (std::size_t i = 0; i < std::min<std::size_t>(d.where.size(), 2); ++i)
    text += fmt::format(" where {} {:.2f}", d.where[i].variable, d.where[i].strength);
  text +=
      fmt::format(" rms {:.3f} after {:.3f} (true {:.3f}) noise {:.3f} (true {:.3f}) {:.2f} s", d.rms_um,
                  d.rms_after_um, one.truth.true_model_rms_um, d.noise.noise_um, one.truth.noise_um, answer.seconds);
  for (const std::string& missed : count_parameters(one, d).missed) text += "; " + missed;
  return text;
}

void print(const std::string& name, const Tally& tally, bool rival) {
  fmt::print("{:<26} {}", name, rate(tally.hits, tally.cases));
  if (rival) fmt::print("   stepwise BIC −6: {}", rate(tally.rival_hits, tally.cases));
  fmt::print("\n");
  if (tally.blank)
    fmt::print("    proved: {}\n    likely: {}\n    e-value of 100 or more: {}\n", rate(tally.named, tally.cases),
               rate(tally.likely, tally.cases), rate(tally.proved, tally.cases));
  else
    fmt::print("    something proved: {}\n    something likely: {}\n", rate(tally.named, tally.cases),
               rate(tally.likely, tally.cases));
  if (tally.variables > 0)
    fmt::print("    strongest dependence is a right one: {}\n", rate(tally.variables_named, tally.variables));
  if (tally.added > 0)
    fmt::print("    rms after adding at most 1.05 of the true model's: {}\n", rate(tally.added_well, tally.added));
  if (tally.parameters > 0)
    fmt::print("    scalar parameters within 3 sigma: {}\n", rate(tally.within, tally.parameters));
  if (tally.by_effect.size() > 1)
    for (const auto& [effect, one] : tally.by_effect)
      fmt::print("    {:<20} {:>3}/{}\n", effect, one.first, one.second);
  std::fflush(stdout);
}

void print(const Times& times) {
  if (times.each.empty()) return;
  std::vector<double> per_thousand, small;
  for (const auto& [seconds, readings] : times.each) {
    per_thousand.push_back(seconds / (0.001 * static_cast<double>(readings)));
    if (readings <= 1000) small.push_back(seconds);
  }
  std::sort(per_thousand.begin(), per_thousand.end());
  fmt::print("processor time per 1,000 readings: median {:.2f} s, worst {:.2f} s; sets of up to 1,000 readings: ",
             per_thousand[per_thousand.size() / 2], per_thousand.back());
  if (small.empty())
    fmt::print("none\n");
  else
    fmt::print("worst {:.2f} s\n", *std::max_element(small.begin(), small.end()));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print("most memory held: {:.0f} MB\n", static_cast<double>(usage.ru_maxrss) / 1024.0);
  std::fflush(stdout);
}

}  // namespace ecs::bench
