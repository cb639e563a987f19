#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ecs_emulator/effects/registry.hpp"
#include "ecs_emulator/hidden_cases/files.hpp"
#include "ecs_emulator/verbs/verb.hpp"

namespace ecs::emulator {
namespace {

struct HideArguments {
  std::string folder, kind, effect, noise, printed_case;
  bool free_base = false;
  std::optional<std::uint64_t> seed;
  std::optional<double> snr;
  std::optional<std::size_t> readings;
  int count = 1;
};

void declare_hide(Verb& verb, HideArguments& arguments) {
  verb.seed(arguments.seed, "the same seed gives the same files (1)")
      .text("-o,--output", arguments.folder, "folder that does not exist yet or is empty", Need::required)
      .choice("--kind", arguments.kind, {"blank", "single", "pair", "out-of-library", "confounded"},
              "what is hidden; drawn where absent")
      .text("--effect", arguments.effect, "the effect to hide, as docs/physics.md names it; of a pair, one of the two")
      .number("--snr", arguments.snr, "rms of what the base model cannot absorb / sigma of one reading")
      .add({"--readings",
            cli::OnInteger([&arguments](long long n) { arguments.readings = static_cast<std::size_t>(n); }),
            "about so many readings, 100 to 20000"})
      .integer("--count", arguments.count, "so many cases, seeds counting up, into DIR/0001 …", 1, 9999)
      .flag("--free-base", arguments.free_base,
            "any effect may be in the base model, and its periods, places and time constants are not given")
      .choice("--noise", arguments.noise, {kNoiseLawNames.begin(), kNoiseLawNames.end()},
              "of --kind blank: how the noise is distributed (usual)")
      .choice("--case", arguments.printed_case, {"xytz"},
              "xytz: the XYTZ machine under the thesis's printed equation (27)");
}

Result<Outcome> hide(VerbContext& /*context*/, const HideArguments& arguments) {
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

}  // namespace

extern const VerbDefinition kHide =
    verb<HideArguments>("hide", "measurements with a secret: a machine whose model lacks something",
                        "ecs-emulator hide --seed 7 -o case\n"
                        "  ecs-emulator hide --seed 1 --kind single --effect cyclic --snr 3 -o cyclic\n"
                        "  ecs-emulator hide --seed 1000 --count 300 --kind blank -o blanks\n"
                        "  ecs-emulator hide --case xytz -o xytz\n"
                        "Then diagnose DIR/data.csv, and: ecs model reveal DIR",
                        declare_hide, hide);

}  // namespace ecs::emulator
