// A verb is defined in a file of its menu's folder, app/verbs/<menu>/; here it gets its row.
#include "app/verbs/registry.hpp"

#include "app/cli/linear.hpp"
#include "app/cli/parser.hpp"
#include "app/verbs/logged.hpp"

namespace ecs::app {

extern const VerbDefinition kParamsShow, kParamsCheck, kParamsSet, kParamsDiff, kParamsNew, kParamsSend, kParamsReceive;
extern const VerbDefinition kMonitor;
extern const VerbDefinition kLaserImport, kLaserShow, kLaserStats, kLaserProcess, kLaserPrepare, kLaserNormalise,
    kLaserAir, kLaserTable, kLaserCapture, kLaserDevices;
extern const VerbDefinition kTestCircle, kTestDiagonals, kTestDrift, kTestFlatness, kTestWarmUp;
extern const VerbDefinition kLengthsFit, kLengthsPlan;
extern const VerbDefinition kMapBuild, kMapShow, kMapHeader, kMapSend, kMapReceive, kMapVerify;
extern const VerbDefinition kUtilityPosition, kUtilityOutput, kUtilityRun, kUtilityRamtest, kUtilityReset,
    kUtilityClear, kUtilityMode, kUtilityDatumRecord, kUtilityDatumShow, kUtilityDatumTest, kUtilityStatus;
extern const VerbDefinition kUnitArm, kUnitDisarm, kUnitEvents;
extern const VerbDefinition kMemoryRead, kMemoryWrite, kMemoryDump, kMemoryLoad, kMemoryShow, kMemoryCompare;
extern const VerbDefinition kModelEffects, kModelNew, kModelPredict, kModelFit, kModelCompare, kModelDiagnose,
    kModelCheck, kModelNext, kModelInvestigate, kModelAdd, kModelUndo, kModelRemove, kModelDecide, kModelHistory,
    kModelWhatIf, kModelRepair, kModelReveal;
extern const VerbDefinition kVolume;
extern const VerbDefinition kReport;
extern const VerbDefinition kExportRead;
/// One for each controller format.
const std::vector<VerbDefinition>& export_writers();
extern const VerbDefinition kFleetDiagnose, kFleetMerge;
extern const VerbDefinition kBatch;
extern const VerbDefinition kLogList, kLogShow, kLogCompare, kLogExport, kLogVerify, kLogReplay, kLogInstrument;
extern const VerbDefinition kDoctor;
extern const VerbDefinition kCompletion, kManual;

namespace {

const std::vector<MenuDefinition>& menus() {
  static const std::vector<MenuDefinition> all{
      {"params", "E.C.S. PARAMETERS"},
      {"laser", "PROCESS LASER DATA: measurements"},
      {"test", "PROCESS LASER DATA: tests of the ISO 230 standards"},
      {"lengths", "PROCESS LASER DATA: all components from lengths"},
      {"map", "PROCESS LASER DATA: error maps"},
      {"utility", "ECS UTILITY"},
      {"utility datum", "datum sequences: record, show, test"},
      {"unit", "ECS UTILITY: who may write to the unit, and what was done to it"},
      {"memory", "MEMORY ACCESS"},
      {"model", "MODEL: the error model against measurements"},
      {"fleet", "MODEL: many machines, on many hosts"},
      {"export", "the error map as compensation tables of other controls, and back"},
      {"log", "LOGBOOK: what was done at a machine, each entry tied to the one before"}};
  return all;
}

std::vector<const VerbDefinition*> verbs_in_order() {
  std::vector<const VerbDefinition*> verbs{
      &kParamsShow,
      &kParamsCheck,
      &kParamsSet,
      &kParamsDiff,
      &kParamsNew,
      &kParamsSend,
      &kParamsReceive,
      &kMonitor,
      &kLaserImport,
      &kLaserShow,
      &kLaserStats,
      &kLaserProcess,
      &kLaserPrepare,
      &kLaserNormalise,
      &kLaserAir,
      &kLaserTable,
      &kLaserCapture,
      &kLaserDevices,
      // of the standards
      &kTestCircle,
      &kTestDiagonals,
      &kTestDrift,
      &kTestFlatness,
      &kTestWarmUp,
      &kLengthsFit,
      &kLengthsPlan,
      &kMapBuild,
      &kMapShow,
      &kMapHeader,
      &kMapSend,
      &kMapReceive,
      &kMapVerify,
      &kUtilityPosition,
      &kUtilityOutput,
      &kUtilityRun,
      &kUtilityRamtest,
      &kUtilityReset,
      &kUtilityClear,
      &kUtilityMode,
      &kUtilityDatumRecord,
      &kUtilityDatumShow,
      &kUtilityDatumTest,
      &kUtilityStatus,
      &kUnitArm,
      &kUnitDisarm,
      &kUnitEvents,
      &kMemoryRead,
      &kMemoryWrite,
      &kMemoryDump,
      &kMemoryLoad,
      &kMemoryShow,
      &kMemoryCompare,
      &kModelEffects,
      &kModelNew,
      &kModelPredict,
      &kModelFit,
      &kModelCompare,
      &kModelDiagnose,
      &kModelCheck,
      &kModelNext,
      &kModelInvestigate,
      &kModelAdd,
      &kModelUndo,
      &kModelRemove,
      &kModelDecide,
      &kModelHistory,
      &kModelWhatIf,
      &kModelRepair,
      &kModelReveal,
      &kVolume,
      &kReport,
  };
  for (const VerbDefinition& writer : export_writers()) verbs.push_back(&writer);
  verbs.insert(verbs.end(), {&kExportRead, &kFleetDiagnose, &kFleetMerge, &kBatch, &kLogList, &kLogShow, &kLogCompare,
                             &kLogExport, &kLogVerify, &kLogReplay, &kLogInstrument, &kDoctor, &kCompletion, &kManual});
  return verbs;
}

}  // namespace

const VerbRegistry& all_verbs() {
  static const VerbRegistry registry{menus(), verbs_in_order()};
  return registry;
}

int run_program(const std::vector<std::string>& words, std::ostream& out, std::ostream& messages,
                ConsoleOptions options) {
  return run_command_line(all_verbs(), words, out, messages, std::move(options), logged_verb(words));
}

int run_linear_program(std::istream& in, std::ostream& out, std::ostream& messages) {
  Console console(out, messages, {});
  VerbContext context{console, {}, {}, {}};
  const cli::ShownProgram program = shown_program(all_verbs(), context);
  return run_linear(
      program, [&](const std::vector<std::string>& words) { return run_program(words, out, messages); }, in, out);
}

}  // namespace ecs::app
