// Rival models of equal size by the difference of their χ²: the likelihood ratio of models that are not nested (Cox
// 1961; Vuong 1989).
#include "model/diagnosis/ties.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "model/diagnosis/ladder.hpp"

namespace ecs::model {
namespace {

/// Difference of χ² that decides: five standard deviations, as for what a fit takes for determined.
constexpr double kDecides = 25.0;

/// The names of `tied_with`, each with its approach: "cyclic:X:EX, reverse, scale:X:EX" are two.
std::vector<std::string> names_in(const std::string& tied_with) {
  std::vector<std::string> names;
  for (const std::string_view part : split(tied_with, ',')) {
    const std::string name(trimmed(part));
    if (approach_mode_named(name) && !names.empty())
      names.back() += ", " + name;
    else
      names.push_back(name);
  }
  return names;
}

/// Takes what follows `mark` off the end of a name.
std::string cut_off(std::string& name, std::string_view mark) {
  const std::size_t at = name.find(mark);
  if (at == std::string::npos) return {};
  std::string rest = name.substr(at + mark.size());
  name.erase(at);
  return rest;
}

/// Of a name as place_text() writes it; nothing for one that is no effect of the library.
std::optional<AddRequest> request_for(std::string name) {
  std::string sensor = cut_off(name, " with ");
  const std::string approach = cut_off(name, ", ");
  auto request = parse_add_request(name);
  if (!request) return std::nullopt;
  request->approach = approach_mode_named(approach).value_or(ApproachMode::both);
  request->sensor2 = cut_off(sensor, " and ");
  request->sensor = sensor;
  return *request;
}

/// Σ r² over the noise's variance, with one more effect; nothing where the readings cannot show it.
std::optional<double> chi2_with(const Model& model, const Observations& data, const std::string& name,
                                double noise_um) {
  const auto request = request_for(name);
  if (!request) return std::nullopt;
  const auto added = add_effect(model, data, *request, "");
  if (!added || added->effect.readings == 0) return std::nullopt;
  return static_cast<double>(data.size()) * std::pow(added->rms_after_um / noise_um, 2);
}

struct Tie {
  std::vector<std::string> out, open, better;
};

Tie judged(const Model& model, std::size_t effect, const Observations& data, double noise_um) {
  Model without = model;
  without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  const auto own = chi2_with(without, data, place_text(model.effects[effect]), noise_um);
  Tie tie;
  for (const std::string& name : names_in(model.effects[effect].tied_with)) {
    const auto other = own ? chi2_with(without, data, name, noise_um) : std::nullopt;
    const double worse = other ? *other - *own : 0.0;
    (worse > kDecides ? tie.out : worse < -kDecides ? tie.better : tie.open).push_back(name);
  }
  return tie;
}

}  // namespace

Result<DecidedTies> decided_ties(const Model& model, const Observations& data) {
  DecidedTies decided{model, {}};
  if (std::all_of(model.effects.begin(), model.effects.end(),
                  [](const auto& effect) { return effect.tied_with.empty(); }))
    return decided;
  ECS_TRY(now, fit(model, data));
  if (!(now.noise.noise_um > 0.0)) return decided;
  for (std::size_t i = 0; i < model.effects.size(); ++i) {
    EffectInstance& effect = decided.model.effects[i];
    if (effect.tied_with.empty()) continue;
    const Tie tie = judged(model, i, data, now.noise.noise_um);
    const std::string name = place_text(effect);
    if (!tie.better.empty()) {
      decided.notes.push_back(fmt::format("these readings speak for {} rather than {}: remove {}, then add it",
                                          fmt::join(tie.better, " or "), name, name));
    } else if (!tie.out.empty()) {
      effect.tied_with = fmt::format("{}", fmt::join(tie.open, ", "));
      decided.notes.push_back(
          fmt::format("these readings rule out {}: {}", fmt::join(tie.out, ", "),
                      tie.open.empty() ? "it is " + name
                                       : fmt::format("{} (or {}) is still open", name, fmt::join(tie.open, ", "))));
    }
  }
  return decided;
}

}  // namespace ecs::model
