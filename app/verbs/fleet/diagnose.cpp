// `ecs fleet diagnose`: the machines of a manifest, on all cores, resumed where a former run ended.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "commissioning/fleet/machine_set.hpp"
#include "commissioning/fleet/run.hpp"

namespace ecs::app {
namespace {

/// Errors listed in the answer; all of them are in the results.
constexpr std::size_t kMostErrors = 1000;

struct FleetDiagnoseArguments : VerbArguments {
  const std::string& manifest = text(
      "MANIFEST", "table (.csv) with the columns id, model, data, machine, type, batch; files count from its folder",
      Need::required);
  const std::string& output =
      text("-o,--output", "results, a line of JSON a machine; those of a former run are gone on with", Need::required);
  const int& threads =
      integer("--threads", "machines at the same time; 0: as many as there are cores", 0, 0, kMostThreads);
  const int& blanks = integer("--blanks", "simulated data sets of noise alone that a finding must beat",
                              static_cast<int>(FleetOptions{}.noise_replicates), 50, 20'000);
  const std::string& part =
      text("--part", "only a share of the rows, for one host of many: 3/16", Need::optional, "1/1");
  const double& limit = number("--limit", "for one machine, by the clock [s]; then the others go on",
                               FleetOptions{}.most_s, Need::optional, 0.1, 86'400.0);
};

Cell errors_cell(const FleetReport& report) {
  Cell errors{Json::array(), {}};
  for (const FleetError& error : report.errors)
    if (errors.json.size() < kMostErrors)
      errors.add(record_cell(
          {},
          {{"line", integer_cell(error.line)}, {"id", text_cell(error.id)}, {"message", word_cell(error.message)}}));
  return errors;
}

Cell verdicts_cell(const FleetReport& report) {
  Cell verdicts{Json::object(), {}};
  for (const auto& [verdict, count] : report.verdicts) {
    verdicts.json[verdict] = count;
    verdicts.text += fmt::format("  {:<22} {:>8}\n", verdict, count);
  }
  return verdicts;
}

Result<Outcome> fleet_diagnose(VerbContext& context, const FleetDiagnoseArguments& arguments) {
  ECS_TRY(manifest, Manifest::read(arguments.manifest, fleet_columns()));
  ECS_TRY(part, fleet_part(arguments.part));
  FleetWatch watch;
  watch.progress = [&context](const FleetProgress& now) {
    context.console.progress(
        fmt::format("{} of {} machines", now.done, now.machines),
        now.machines == 0 ? 1.0 : static_cast<double>(now.done) / static_cast<double>(now.machines), now.seconds_left);
  };
  watch.error = [&context](const FleetError& error) { context.console.warn(error.message); };
  const auto report =
      run_fleet(manifest, arguments.output,
                {arguments.threads, static_cast<std::size_t>(arguments.blanks), arguments.limit, part}, watch);
  context.console.end_progress();
  if (!report) return tl::unexpected(report.error());
  const Cell answer = record_cell(
      "{machines} machines: {diagnosed} diagnosed, {skipped} done before, {error_count} with errors; {processor_s} s "
      "of "
      "processor time\n{verdicts}{stopped}",
      {{"manifest", word_cell(arguments.manifest)},
       {"output", word_cell(arguments.output)},
       {"machines", count_cell(report->machines)},
       {"diagnosed", count_cell(report->diagnosed)},
       {"skipped", count_cell(report->skipped)},
       {"error_count", count_cell(report->errors.size())},
       {"errors", errors_cell(*report)},
       {"verdicts", verdicts_cell(*report)},
       {"processor_s", number_cell(report->processor_s, 1)},
       {"seconds", number_cell(report->seconds, 1)},
       {"stopped", yes_cell(report->stopped, "stopped by a signal: the same command goes on\n", "")}});
  return outcome_of(answer, report->errors.empty() ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kFleetDiagnose =
    verb<FleetDiagnoseArguments>("fleet diagnose", "what is missing from the models of many machines, on all cores",
                                 "ecs fleet diagnose fleet.csv -o results.jsonl\n"
                                 "  fleet.csv:  id,model,data,machine,type,batch\n"
                                 "              7001,mill.toml,7001.csv,mill_machine.toml,mill,2026-04",
                                 fleet_diagnose);

}  // namespace ecs::app
