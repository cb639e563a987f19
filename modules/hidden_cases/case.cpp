#include "modules/hidden_cases/case.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"
#include "modules/hidden_cases/compose.hpp"

namespace ecs::emulator {
namespace {

constexpr int kTries = 2000;
constexpr int kTriesOfOne = 40;  ///< before a companion, or a foreign structure, is drawn again
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
  std::vector<const EffectDefinition*> kinds;
  for (const EffectDefinition& kind : effects())
    if (hiding_of(kind).seat != Seat::unit) kinds.push_back(&kind);
  return one(random, kinds);
}

/// Two effects that can be sized independently.
bool can_be_a_pair(const Hiding& a, const Hiding& b) {
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
    return refused("a confounded design and the XYTZ case have their own base models: omit --free-base");
  if (request.noise != NoiseLaw::usual && request.kind != CaseKind::blank)
    return refused("noise: laws other than the usual one are for --kind blank");
  if (request.effect == nullptr || !request.kind) return {};
  if (*request.kind == CaseKind::blank || *request.kind == CaseKind::out_of_library)
    return refused(
        fmt::format("effect: a {} hides no effect of the library; omit --effect", kCaseKinds.of(*request.kind)));
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

/// What is drawn again where the design cannot show it.
void vary(Random& random, const HiddenCaseRequest& request, Wanted& wanted) {
  wanted.structure = &one(random, structures());
  if (request.free_base) wanted.in_base = draw_base_kind(random);
  wanted.design = one(random, confounded_designs());
  if (wanted.kind == CaseKind::confounded && request.effect != nullptr)
    wanted.design = one(random, confounded_designs_of(*request.effect));
  if (wanted.kind != CaseKind::pair) return;
  wanted.effects.resize(1);
  const EffectDefinition* companion = draw_effect_kind(random);
  while (!can_be_a_pair(hiding_of(*wanted.effects[0]), hiding_of(*companion))) companion = draw_effect_kind(random);
  wanted.effects.push_back(companion);
}

std::string number_words(const DrawnEffect& effect) {
  std::string words;
  for (const auto& [name, value] : effect.parameters)
    if (value != 0.0) words += fmt::format("{}{} {:.4g}", words.empty() ? " (" : ", ", name, value);
  return words.empty() ? "" : words + ")";
}

std::string sentence(const HiddenCase& c) {
  if (c.kind == CaseKind::blank) return "Nothing is hidden: the base model is complete.";
  if (c.kind == CaseKind::out_of_library) return fmt::format("Something that is in no library: {}.", c.structure.text);
  std::string text = "Hidden:";
  for (const HiddenEffect& hidden : c.hidden)
    text += fmt::format("{} {}{}, {:.3g} um rms in the readings", &hidden == &c.hidden.front() ? "" : ";",
                        name_of(hidden.effect), number_words(hidden.effect), hidden.rms_um);
  if (!c.group.empty()) {
    text += "; these data cannot distinguish ";
    for (const std::string& name : c.group) text += (&name == &c.group.front() ? "" : ", ") + name;
  }
  return text + ".";
}

}  // namespace

Result<HiddenCase> draw_hidden_case(const HiddenCaseRequest& request) {
  ECS_DO(check(request));
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
  return refused(fmt::format(
      "seed {}: no design with about {} readings shows the requested effect; use more readings or another seed",
      request.seed, wanted.readings));
}

namespace {

constexpr double kLeastSigma_um = 0.02;
constexpr double kMostSigma_um = 20.0;
constexpr double kMostSensorError = 0.15;  ///< what sensors leave of thermal errors, in sigmas
constexpr double kMostBend = 0.15;  ///< what exact matrices make of large rotations beyond first order, in sigmas
constexpr double kOwnPart = 0.3;    ///< of a hidden effect's mean square that its companion must leave

Noise draw_noise_level(Random& random, double sigma_um, NoiseLaw law) {
  Noise noise;
  noise.law = law;
  noise.sigma_um = sigma_um;
  noise.per_unit = std::pow(10.0, std::max(0.0, std::ceil(-std::log10(sigma_um / 8.0))));
  if (law == NoiseLaw::rounded) noise.per_unit = 1.0 / (sigma_um * between(random, 1.5, 4.0));
  if (law == NoiseLaw::by_run || law == NoiseLaw::random_walk) noise.correlated_share = between(random, 0.3, 0.8);
  if (law == NoiseLaw::slow) {
    noise.correlated_share = between(random, 0.5, 0.95);
    noise.correlation_s = log_between(random, 60.0, 600.0);
  }
  if (law != NoiseLaw::usual) return noise;
  if (chance(random, 0.5)) {
    noise.correlated_share = between(random, 0.05, 0.6);
    noise.correlation_s = log_between(random, 2.0, 30.0);
  }
  if (chance(random, 0.2)) noise.outlier_probability = between(random, 0.002, 0.01);
  return noise;
}

/// Makes the map, and with it what its faults do, `factor` times as large.
void scale_map(Scene& scene, double factor) {
  for (UnitTable& table : scene.map)
    for (double& value : table.value) value = rounded(value * factor, 1000.0);
}

class Finishing {
 public:
  Finishing(Random& random, HiddenCase& c, const Ground& ground, const Absorbed& absorbed, double snr, NoiseLaw law)
      : random_(random), case_(c), ground_(ground), absorbed_(absorbed), snr_(snr), law_(law) {}

  bool done() {
    if (!settle_sigma()) return false;
    size_hidden();
    size_background();
    if (!measure()) return false;
    judge();
    if (!companions_apart()) return false;
    if (law_ == NoiseLaw::doubled) give_rows_twice();
    return true;
  }

 private:
  [[nodiscard]] Eigen::VectorXd of(const DrawnEffect& effect) const {
    return vector_of(contribution(case_.scene, effect));
  }

  bool settle_sigma() {
    double sigma_um = log_between(random_, 0.1, 2.0);
    for (const HiddenEffect& hidden : case_.hidden)
      if (hiding_of(hidden.effect).natural_size) sigma_um = rms_of(absorbed_.left_of(of(hidden.effect))) / snr_;
    if (!(sigma_um >= kLeastSigma_um && sigma_um <= kMostSigma_um)) return false;
    case_.noise = draw_noise_level(random_, sigma_um, law_);
    return true;
  }

  void size_hidden() {
    for (HiddenEffect& hidden : case_.hidden) {
      if (hiding_of(hidden.effect).natural_size) continue;
      const double factor = snr_ * case_.noise.sigma_um / rms_of(absorbed_.left_of(of(hidden.effect)));
      if (hiding_of(hidden.effect).seat == Seat::unit)
        scale_map(case_.scene, factor);
      else
        hidden.effect = scaled(hidden.effect, factor);
    }
    if (case_.hidden.empty()) scale_map(case_.scene, case_.noise.sigma_um * between(random_, 2.0, 20.0));
    if (case_.structure.value.empty()) return;
    const Eigen::VectorXd left = absorbed_.left_of(vector_of(case_.structure.value));
    const double factor = snr_ * case_.noise.sigma_um / rms_of(left) * sign_of_chance(random_);
    for (double& value : case_.structure.value) value *= factor;
    case_.structure_snr = snr_;
  }

  void size_background() {
    for (DrawnEffect& effect : case_.base)
      if (!hiding_of(effect).natural_size)
        effect = scaled(effect, case_.noise.sigma_um * log_between(random_, 1.5, 20.0) / rms_of(of(effect)));
  }

  [[nodiscard]] std::vector<DrawnEffect> all_effects() const {
    std::vector<DrawnEffect> all = case_.base;
    for (const HiddenEffect& hidden : case_.hidden) all.push_back(hidden.effect);
    return all;
  }

  bool measure() {
    case_.recorded = as_recorded(random_, case_.scene);
    const auto effects = all_effects();
    Eigen::VectorXd straight = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(case_.scene.stops.size()));
    Eigen::VectorXd blur = straight;
    for (const DrawnEffect& effect : effects) {
      const Eigen::VectorXd own = of(effect);
      straight += own;
      blur += own - vector_of(contribution(case_.recorded, effect));
    }
    if (!case_.structure.value.empty()) straight += vector_of(case_.structure.value);
    case_.readings = exact_errors(case_.scene, effects, case_.structure.value);
    if (rms_of(blur) > kMostSensorError * case_.noise.sigma_um) return false;
    if (rms_of(vector_of(case_.readings) - straight) > kMostBend * case_.noise.sigma_um) return false;
    const auto noise = draw_noise(random_, case_.scene, case_.noise);
    for (std::size_t k = 0; k < noise.size(); ++k)
      case_.readings[k] = rounded(case_.readings[k] + noise[k], case_.noise.per_unit);
    return true;
  }

  /// Sizes as they came out, what the true model leaves, and who does the same.
  void judge() {
    Absorbed truth = absorbed_;
    for (HiddenEffect& hidden : case_.hidden) {
      const Eigen::VectorXd own = of(hidden.effect);
      hidden.rms_um = rms_of(own);
      hidden.snr = rms_of(absorbed_.left_of(own)) / case_.noise.sigma_um;
      truth.add(contribution_columns(case_.scene, ground_, hidden.effect));
    }
    std::stable_sort(case_.hidden.begin(), case_.hidden.end(),
                     [](const HiddenEffect& a, const HiddenEffect& b) { return a.snr > b.snr; });
    if (case_.kind != CaseKind::out_of_library)
      case_.true_model_rms_um = rms_of(truth.left_of(vector_of(case_.readings)));
    if (case_.kind == CaseKind::single) look_for_doubles();
  }

  void look_for_doubles() {
    const HiddenEffect& hidden = case_.hidden.front();
    const std::string name = name_of(hidden.effect);
    for (const Rival& rival :
         rivals_of(case_.scene, ground_, absorbed_, of(hidden.effect), case_.noise.sigma_um, false))
      if (rival.separation < kSame && name_of(rival.effect) != name) case_.group.push_back(name_of(rival.effect));
    if (!case_.group.empty()) case_.group.insert(case_.group.begin(), name);
  }

  void give_rows_twice() {
    const auto twice = [](auto& list) {
      auto each = std::move(list);
      list.clear();
      for (const auto& one : each) list.insert(list.end(), 2, one);
    };
    twice(case_.scene.stops);
    twice(case_.recorded.stops);
    twice(case_.readings);
  }

  /// Neither of two hidden effects can stand for the other, and no single effect that bends likewise for both.
  [[nodiscard]] bool companions_apart() const {
    if (case_.hidden.size() < 2) return true;
    const Eigen::VectorXd both = of(case_.hidden[0].effect) + of(case_.hidden[1].effect);
    for (const EffectDefinition& kind : effects())
      for (const DrawnEffect& single :
           hiding_of(kind).explains_two ? places_of(kind, case_.scene, ground_) : std::vector<DrawnEffect>{}) {
        Absorbed with = absorbed_;
        with.add(contribution_columns(case_.scene, ground_, single));
        if (with.left_of(both).norm() < kApart * case_.noise.sigma_um) return false;
      }
    for (const HiddenEffect& one : case_.hidden)
      for (const HiddenEffect& other : case_.hidden) {
        if (&one == &other) continue;
        Absorbed with = absorbed_;
        with.add(contribution_columns(case_.scene, ground_, other.effect));
        const double alone = absorbed_.left_of(of(one.effect)).squaredNorm();
        if (with.left_of(of(one.effect)).squaredNorm() < kOwnPart * alone) return false;
      }
    return true;
  }

  Random& random_;
  HiddenCase& case_;
  const Ground& ground_;
  const Absorbed& absorbed_;
  double snr_;
  NoiseLaw law_;
};

}  // namespace

std::optional<HiddenCase> finished(Random& random, HiddenCase begun, const Ground& ground, const Absorbed& absorbed,
                                   double snr, NoiseLaw law) {
  if (!Finishing(random, begun, ground, absorbed, snr, law).done()) return std::nullopt;
  return begun;
}

}  // namespace ecs::emulator
