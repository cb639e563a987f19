#include "ecs_emulator/hidden_cases/verb.hpp"

#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "ecs_emulator/command_line/request_verb.hpp"
#include "ecs_emulator/effects/registry.hpp"
#include "ecs_emulator/hidden_cases/files.hpp"

namespace ecs::emulator {
namespace {

/// What `hide` is asked for.
struct HiddenCaseOptions {
  HiddenCaseRequest request;
  int count = 1;
  std::string folder;
};

void add_options(CLI::App* verb, HiddenCaseOptions& options) {
  HiddenCaseRequest& request = options.request;
  verb->add_option("--seed", request.seed, "the same seed gives the same files (1)");
  verb->add_option("-o,--output", options.folder, "folder that does not exist yet or is empty")->required();
  verb->add_option_function<std::string>(
          "--kind", [&](const std::string& name) { request.kind = case_kind_named(name); },
          "what is hidden; drawn where absent")
      ->option_text("blank|single|pair|out-of-library|confounded")
      ->check([](const std::string& name) {
        return case_kind_named(name) ? std::string()
                                     : std::string("expected blank, single, pair, out-of-library or confounded");
      });
  verb->add_option_function<std::string>(
          "--effect", [&](const std::string& name) { request.effect = effect_named(name); },
          "the effect to hide, as docs/physics.md names it; of a pair, one of the two")
      ->option_text("NAME")
      ->check([](const std::string& name) {
        return effect_named(name) != nullptr
                   ? std::string()
                   : fmt::format("expected one of the {} effects of docs/physics.md", effects().size());
      });
  verb->add_option("--snr", request.snr, "rms of what the base model cannot absorb / sigma of one reading");
  verb->add_option("--readings", request.readings, "about so many readings, 100 to 20000");
  verb->add_option("--count", options.count, "so many cases, seeds counting up, into DIR/0001 …")
      ->check(CLI::Range(1, 9999));
  verb->add_option_function<std::string>(
          "--case", [&](const std::string&) { request.xytz = true; },
          "xytz: the XYTZ machine under the thesis's printed equation (27)")
      ->option_text("xytz")
      ->check(CLI::IsMember({"xytz"}));
  verb->footer(
      "Examples:\n  ecs-emulator hide --seed 7 -o case\n"
      "  ecs-emulator hide --seed 1 --kind single --effect cyclic --snr 3 -o cyclic\n"
      "  ecs-emulator hide --seed 1000 --count 300 --kind blank -o blanks\n"
      "  ecs-emulator hide --case xytz -o xytz\n"
      "Then diagnose DIR/data.csv, and: ecs model reveal DIR");
}

int run(const HiddenCaseOptions& options) {
  const auto lines = write_hidden_cases(options.request, options.count, options.folder);
  if (!lines) return exit_code_after(lines.error());
  for (const std::string& line : *lines) fmt::print("{}\n", line);
  return 0;
}

}  // namespace

void add_hide_verb(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand("hide", "measurements with a secret: a machine whose model lacks something");
  const auto options = std::make_shared<HiddenCaseOptions>();
  add_options(verb, *options);
  verb->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace ecs::emulator
