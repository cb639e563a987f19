// A verb is defined in a file of its menu's folder, app/verbs/<menu>/; here it gets its row.
#include "app/verbs/registry.hpp"

#include <string>
#include <utility>
#include <vector>

#include "app/cli/linear.hpp"
#include "app/cli/module.hpp"
#include "base/file_kind.hpp"

namespace ecs::app {

// In the order of the help.
#define ECS_FAMILIES(FAMILY) \
  FAMILY(kParameters)        \
  FAMILY(kMonitoring)        \
  FAMILY(kLaserReading)      \
  FAMILY(kLaserStatistics)   \
  FAMILY(kLaserProcessing)   \
  FAMILY(kLaserTables)       \
  FAMILY(kMapBuilding)       \
  FAMILY(kMapOfUnit)         \
  FAMILY(kUtilityCommands)   \
  FAMILY(kUtilityDatum)      \
  FAMILY(kUtilityInputs)     \
  FAMILY(kUtilityTools)      \
  FAMILY(kUnitAccess)        \
  FAMILY(kMemory)            \
  FAMILY(kModelBeginning)    \
  FAMILY(kModelFitting)      \
  FAMILY(kModelDiagnosis)    \
  FAMILY(kModelLadder)       \
  FAMILY(kModelJudgement)    \
  FAMILY(kVolume)            \
  FAMILY(kDoctor)            \
  FAMILY(kDocuments)

#define FAMILY(name) extern const std::vector<Action> name;  // NOLINT(bugprone-macro-parentheses): a name, not a value
ECS_FAMILIES(FAMILY)
#undef FAMILY

namespace {

Registry core_verbs() {
  Registry registry;
  registry.menus = {{"params", "E.C.S. PARAMETERS"},
                    {"laser", "PROCESS LASER DATA: measurements"},
                    {"map", "PROCESS LASER DATA: error maps"},
                    {"utility", "ECS UTILITY: mode, status, datum, output and tests of the unit"},
                    {"utility datum", "datum sequences: record, show, test"},
                    {"unit", "ECS UTILITY: write access to the unit, and its event list"},
                    {"memory", "MEMORY ACCESS"},
                    {"model", "MODEL: the error model against measurements"}};
#define FAMILY(name) \
  for (const Action& action : (name)) registry.actions.push_back(&action);
  ECS_FAMILIES(FAMILY)
#undef FAMILY
  return registry;
}

}  // namespace

const Registry& all_verbs() {
  static const Registry registry = [] {
    Registry all = core_verbs();
    for (const Module* module : modules()) {
      all.menus.insert(all.menus.end(), module->menus.begin(), module->menus.end());
      for (const auto& family : module->verbs) all.add(family);
    }
    return all;
  }();
  return registry;
}

void begin_modules() {
  for (const Module* module : modules()) {
    for (const auto& [matter, words] : module->advice) advise(matter, words);
    if (module->begin != nullptr) module->begin();
  }
}

int run_program(const std::vector<std::string>& words, std::ostream& out, std::ostream& messages,
                ConsoleOptions options) {
  AroundVerb around;
  for (const Module* module : modules())
    if (!around && module->around != nullptr) around = module->around(words);
  return run_command_line(all_verbs(), words, out, messages, std::move(options), around);
}

int run_linear_program(std::istream& in, std::ostream& out, std::ostream& messages) {
  Console console(out, messages, {});
  VerbContext context{console};
  const cli::ShownProgram program = shown_program(all_verbs(), context);
  return run_linear(
      program, [&](const std::vector<std::string>& words) { return run_program(words, out, messages); }, in, out);
}

}  // namespace ecs::app
