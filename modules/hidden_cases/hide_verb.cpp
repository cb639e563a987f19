// The verb `hide`, which the module brings to the emulator.

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ecs_emulator/effects/definition.hpp"
#include "ecs_emulator/verbs/module.hpp"
#include "ecs_emulator/verbs/verb.hpp"
#include "modules/hidden_cases/case.hpp"

namespace ecs::emulator {
namespace {

struct HideRequest {
  std::string folder, kind, effect, noise, printed_case;
  bool free_base = false;
  std::optional<std::uint64_t> seed;
  std::optional<double> snr;
  std::optional<std::size_t> readings;
  int count = 1;
  static Fields<HideRequest> fields() {
    using R = HideRequest;
    const auto readings = [](R& r) -> cli::Argument::Target {
      return cli::OnInteger([&r](long long n) { r.readings = static_cast<std::size_t>(n); });
    };
    return {
        {"--seed", &R::seed, "the same seed gives the same files (1)"},
        {"-o,--output", &R::folder, "folder that does not exist yet or is empty", Need::required},
        {"--kind", &R::kind, "what is hidden; drawn where absent",
         Words{"blank", "single", "pair", "out-of-library", "confounded"}},
        {"--effect", &R::effect, "the effect to hide, as docs/physics.md names it; of a pair, one of the two"},
        {"--snr", &R::snr, "rms of what the base model cannot absorb / sigma of one reading"},
        {{"--readings", {}, "about so many readings, 100 to 20000"}, readings},
        {"--count", &R::count, "so many cases, seeds counting up, into DIR/0001 …", cli::Range{1, 9999}},
        {"--free-base", &R::free_base,
         "any effect may be in the base model, and its periods, places and time constants are not given"},
        {"--noise", &R::noise, "of --kind blank: how the noise is distributed (usual)",
         Words{kNoiseLawNames.begin(), kNoiseLawNames.end()}},
        {"--case", &R::printed_case, "xytz: the XYTZ machine under the thesis's printed equation (27)", Words{"xytz"}}};
  }
};

Result<Outcome> hide(VerbContext& /*context*/, const HideRequest& arguments) {
  HiddenCaseRequest request;
  request.seed = arguments.seed.value_or(1);
  request.snr = arguments.snr;
  request.readings = arguments.readings;
  request.xytz = !arguments.printed_case.empty();
  request.free_base = arguments.free_base;
  if (!arguments.noise.empty())
    request.noise = static_cast<NoiseLaw>(std::find(kNoiseLawNames.begin(), kNoiseLawNames.end(), arguments.noise) -
                                          kNoiseLawNames.begin());
  if (!arguments.kind.empty()) request.kind = case_kind_named(arguments.kind);
  if (!arguments.effect.empty()) request.effect = effect_named(arguments.effect);
  if (!arguments.effect.empty() && request.effect == nullptr)
    return problem(ProblemKind::usage,
                   fmt::format("--effect: expected one of the {} effects of docs/physics.md, got {}", effects().size(),
                               arguments.effect));
  ECS_TRY(lines, write_hidden_cases(request, arguments.count, arguments.folder));
  return Outcome{fmt::format("{}", fmt::join(lines, "\n")), {}};
}

const std::vector<Action> kHide{action("hide", "measurements with a secret: a machine whose model lacks something",
                                       "ecs-emulator hide --seed 7 -o case\n"
                                       "  ecs-emulator hide --seed 1 --kind single --effect cyclic --snr 3 -o cyclic\n"
                                       "  ecs-emulator hide --seed 1000 --count 300 --kind blank -o blanks\n"
                                       "  ecs-emulator hide --case xytz -o xytz\n"
                                       "Then diagnose DIR/data.csv, and: ecs model reveal DIR",
                                       hide)};

}  // namespace

const Module& hidden_cases_emulator_module() {
  static const Module module{{"program", &kHide}};
  return module;
}

}  // namespace ecs::emulator
