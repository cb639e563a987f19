#include "modules/hidden_cases/case.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.hpp"
#include "ecs_emulator/effects/definition.hpp"
#include "ecs_emulator/random/random.hpp"
#include "modules/hidden_cases/compose.hpp"

namespace ecs::emulator {
namespace {

constexpr int kTries = 2000;
constexpr int kTriesOfOne = 40;  ///< before a companion, or a foreign structure, is drawn anew
constexpr std::size_t kLeastReadings = 100;
constexpr std::size_t kMostReadings = 20'000;

tl::unexpected<Problem> refused(std::string message) { return problem(ProblemKind::usage, std::move(message)); }

CaseKind draw_kind(Random& random) {
  const double what = random.uniform();
  if (what < 0.2) return CaseKind::blank;
  if (what < 0.6) return CaseKind::single;
  if (what < 0.75) return CaseKind::pair;
  return what < 0.9 ? CaseKind::out_of_library : CaseKind::confounded;
}

const EffectDefinition* draw_effect_kind(Random& random) {
  return drawn_effects()[static_cast<std::size_t>(whole(random, 0, static_cast<int>(drawn_effects().size()) - 1))];
}

/// An effect that a free base model must hold: a fault of the map is none of a model.
const EffectDefinition* draw_base_kind(Random& random) {
  std::vector<const EffectDefinition*> kinds(effects().begin(), effects().end());
  std::erase_if(kinds, [](const EffectDefinition* kind) { return kind->seat == Seat::unit; });
  return one(random, kinds);
}

/// Two effects that can be sized independently.
bool can_be_a_pair(const EffectDefinition& a, const EffectDefinition& b) {
  return &a != &b && !(a.seat == Seat::unit && b.seat == Seat::unit) && !(a.natural_size && b.natural_size);
}

Result<void> check(const HiddenCaseRequest& request) {
  if (request.readings && (*request.readings < kLeastReadings || *request.readings > kMostReadings))
    return refused(
        fmt::format("readings: expected {} to {}, got {}", kLeastReadings, kMostReadings, *request.readings));
  if (request.snr && !(*request.snr > 0.0 && *request.snr <= 1000.0))
    return refused(fmt::format("snr: expected above 0 and up to 1000, got {}", shortest(*request.snr)));
  if (request.xytz && (request.kind || request.effect != nullptr))
    return refused("the XYTZ case has its own kind and effect: omit --kind and --effect");
  if (request.free_base && (request.xytz || request.kind == CaseKind::confounded))
    return refused("a confounded design and the XYTZ case have base models of their own: omit --free-base");
  if (request.noise != NoiseLaw::usual && request.kind != CaseKind::blank)
    return refused("noise: laws other than the usual one are for --kind blank");
  if (request.effect == nullptr || !request.kind) return {};
  if (*request.kind == CaseKind::blank || *request.kind == CaseKind::out_of_library)
    return refused(fmt::format("effect: a {} hides no effect of the library; omit --effect", name_of(*request.kind)));
  if (*request.kind == CaseKind::confounded && confounded_designs_of(*request.effect).empty())
    return refused(fmt::format("effect: no confounded design is known for {}", request.effect->id));
  return {};
}

/// What does not depend on the tries.
Wanted begin(Random& random, const HiddenCaseRequest& request) {
  Wanted wanted;
  const CaseKind drawn = request.effect != nullptr ? CaseKind::single : draw_kind(random);
  wanted.kind = request.kind.value_or(drawn);
  const bool plain = wanted.kind == CaseKind::blank || wanted.kind == CaseKind::single || wanted.kind == CaseKind::pair;
  const double snr =
      plain ? one(random, std::vector{2.0, 3.0, 3.0, 5.0, 8.0, 12.0}) : one(random, std::vector{3.0, 4.0, 6.0, 10.0});
  wanted.snr = request.snr.value_or(request.xytz ? 10.0 : snr);
  const double most = plain ? 1500.0 : wanted.kind == CaseKind::confounded ? 400.0 : 600.0;
  const auto readings =
      static_cast<std::size_t>(log_between(random, wanted.kind == CaseKind::confounded ? 180.0 : 110.0, most));
  wanted.readings = request.readings.value_or(readings);
  wanted.free_base = request.free_base;
  wanted.law = request.noise;
  const EffectDefinition* effect = draw_effect_kind(random);
  if (request.effect != nullptr)
    wanted.effects = {request.effect};
  else if (plain)
    wanted.effects = {effect};
  return wanted;
}

/// What is drawn anew where the design cannot show it.
void vary(Random& random, const HiddenCaseRequest& request, Wanted& wanted) {
  wanted.structure = &one(random, structures());
  if (request.free_base) wanted.in_base = draw_base_kind(random);
  wanted.design = one(random, confounded_designs());
  if (wanted.kind == CaseKind::confounded && request.effect != nullptr)
    wanted.design = one(random, confounded_designs_of(*request.effect));
  if (wanted.kind != CaseKind::pair) return;
  wanted.effects.resize(1);
  const EffectDefinition* companion = draw_effect_kind(random);
  while (!can_be_a_pair(*wanted.effects[0], *companion)) companion = draw_effect_kind(random);
  wanted.effects.push_back(companion);
}

std::string number_words(const PlacedEffect& effect) {
  std::string words;
  for (const auto& [name, value] : effect.parameters)
    if (value != 0.0) words += fmt::format("{}{} {:.4g}", words.empty() ? " (" : ", ", name, value);
  return words.empty() ? "" : words + ")";
}

std::string sentence(const HiddenCase& c) {
  switch (c.kind) {
    case CaseKind::blank:
      return "Nothing is hidden: the base model is complete.";
    case CaseKind::out_of_library:
      return fmt::format("Something that is in no library: {}.", c.structure.text);
    default:
      break;
  }
  std::string text = "Hidden:";
  for (const HiddenEffect& hidden : c.hidden)
    text += fmt::format("{} {}{}, {:.3g} um rms, signal to noise {:.3g}", &hidden == &c.hidden.front() ? "" : ";",
                        name_of(hidden.effect), number_words(hidden.effect), hidden.rms_um, hidden.snr);
  if (!c.group.empty()) {
    text += "; these data cannot tell apart ";
    for (const std::string& name : c.group) text += (&name == &c.group.front() ? "" : ", ") + name;
  }
  return text + ".";
}

}  // namespace

std::optional<CaseKind> case_kind_named(std::string_view name) {
  std::string word(name);
  std::replace(word.begin(), word.end(), '-', '_');
  for (std::size_t i = 0; i < kCaseKindNames.size(); ++i)
    if (kCaseKindNames[i] == word) return static_cast<CaseKind>(i);
  return std::nullopt;
}

Result<HiddenCase> draw_hidden_case(const HiddenCaseRequest& request) {
  if (auto fit = check(request); !fit) return tl::unexpected(fit.error());
  Random choice(seed_of(request.seed, 0x68696465, 0));
  Wanted wanted = begin(choice, request);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    if (attempt % kTriesOfOne == 0) vary(choice, request, wanted);
    Random random(seed_of(request.seed, 0x68696465, 1 + static_cast<std::uint64_t>(attempt)));
    auto made = request.xytz                          ? compose_xytz(random, wanted)
                : wanted.kind == CaseKind::confounded ? compose_confounded(random, wanted)
                                                      : compose(random, wanted);
    if (!made) continue;
    made->seed = request.seed;
    made->text = sentence(*made);
    return std::move(*made);
  }
  return refused(
      fmt::format("seed {}: no design was found that shows what was asked for with about {} readings; "
                  "ask for more readings or take another seed",
                  request.seed, wanted.readings));
}

}  // namespace ecs::emulator
