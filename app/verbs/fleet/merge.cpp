// `ecs fleet merge`: the results of many hosts as one answer, with the false-discovery rate controlled over machines.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "commissioning/fleet/gathered.hpp"

namespace ecs::app {
namespace {

constexpr double kUsualRate = 0.05;

struct FleetMergeArguments : VerbArguments {
  const std::vector<std::string>& results =
      texts("RESULTS", "results of `ecs fleet diagnose`, from one host or many", Need::required);
  const double& rate =
      number("--fdr", "share of false names among all names, on average", kUsualRate, Need::optional, 1e-6, 1.0);
  const std::string& previous =
      text("--previous", "results of last time, or the answer of `fleet merge --json`: what changed");
  const std::string& output = output_file("-o,--output", "the results of all hosts as one file");
};

Cell q_value_cell(const std::optional<double>& q) {
  return {number_or_null(q), q ? fmt::format("{:.1e}", *q) : "no evidence"};
}

Cell named_cell(const std::vector<NamedMachine>& machines, const char* title) {
  const std::string heading = machines.empty() ? "" : fmt::format("\n{}\n", title);
  return list_cell(
      machines,
      [](const NamedMachine& one) {
        return record_cell("  {id:<24} {cause:<36} {q_value:>10}  {type} {batch}\n",
                           {{"id", word_cell(one.id)},
                            {"cause", word_cell(one.cause)},
                            {"q_value", q_value_cell(one.q_value)},
                            {"type", {text_or_null(one.type), one.type}},
                            {"batch", {text_or_null(one.batch), one.batch}}});
      },
      heading);
}

Cell groups_cell(const std::vector<SharedCause>& groups) {
  return list_cell(
      groups,
      [](const SharedCause& one) {
        return record_cell("  {by:<6} {value:<24} {cause:<36} {machines:>6} of {of:<6} p = {p_holm}\n",
                           {{"by", word_cell(one.by)},
                            {"value", word_cell(one.value)},
                            {"cause", word_cell(one.cause)},
                            {"machines", count_cell(one.machines)},
                            {"of", count_cell(one.of)},
                            {"p_value", {number_or_null(one.p_value), ""}},
                            {"p_holm", {number_or_null(one.p_holm), fmt::format("{:.1e}", one.p_holm)}}});
      },
      groups.empty() ? "" : "\nshared by a type or batch (for all of them together)\n");
}

Cell changed_cell(const FleetChanges& changes) {
  return list_cell(
      changes.machines,
      [](const FleetChange& one) {
        return record_cell("  {id:<24} {cause:<36} {change}\n", {{"id", word_cell(one.id)},
                                                                 {"cause", word_cell(one.cause)},
                                                                 {"change", word_cell(one.is_new ? "new" : "gone")}});
      },
      changes.machines.empty() ? "" : "\nchanged since last time\n");
}

Cell changed_causes_cell(const FleetChanges& changes) {
  return list_cell(
      changes.causes,
      [](const FleetChanges::Count& one) {
        return record_cell(
            "  {cause:<36} {new:>6} new {gone:>6} gone\n",
            {{"cause", word_cell(one.cause)}, {"new", count_cell(one.is_new)}, {"gone", count_cell(one.gone)}});
      },
      changes.causes.empty() ? "" : "\nby cause\n");
}

Result<Outcome> fleet_merge(VerbContext& context, const FleetMergeArguments& arguments) {
  ECS_TRY(gathered, gathered_results(arguments.results));
  for (const std::string& line : gathered.unreadable) context.console.warn(line);
  for (const std::string& line : gathered.conflicts) context.console.warn(line);
  const FleetNames names = fleet_names(gathered.results, arguments.rate);
  std::vector<std::string> errors;
  for (const FleetResult& result : gathered.results)
    if (!result.error.empty()) errors.push_back(result.id);
  AnswerFields fields{{"machines", count_cell(names.machines)},
                      {"errors", {errors, fmt::format("{}", errors.size())}},
                      {"conflicts", {gathered.conflicts, ""}},
                      {"fdr", {arguments.rate, fmt::format("{:g}", 100.0 * arguments.rate)}},
                      {"count", shown_cell(fmt::format("{}", names.named.size()))},
                      {"named", named_cell(names.named, "named (q-value)")},
                      {"unconfirmed", named_cell(names.unconfirmed, "not sure enough among so many machines")},
                      {"unexplained",
                       {names.unexplained, names.unexplained.empty()
                                               ? ""
                                               : fmt::format("\n{} machines with structure that no effect explains\n",
                                                             names.unexplained.size())}},
                      {"groups", groups_cell(names.groups)}};
  std::string layout =
      "{machines} machines, {errors} without an answer; {count} names, of which at most {fdr} % are false on average\n"
      "{named}{unconfirmed}{unexplained}{groups}";
  if (!arguments.previous.empty()) {
    ECS_TRY(before, previously_named(arguments.previous, arguments.rate));
    const FleetChanges changes = changes_between(before, names.named, errors);
    fields.push_back({"changed", changed_cell(changes)});
    fields.push_back({"changed_causes", changed_causes_cell(changes)});
    layout += "{changed}{changed_causes}";
  }
  if (!arguments.output.empty()) ECS_DO(write_results(arguments.output, gathered.results));
  return outcome_of(record_cell(layout, fields), gathered.conflicts.empty() ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kFleetMerge = verb<FleetMergeArguments>(
    "fleet merge", "results of many machines: which names hold, what changed, which batch shares a cause",
    "ecs fleet merge results*.jsonl --fdr 0.05 --previous yesterday.jsonl -o today.jsonl", fleet_merge);

}  // namespace ecs::app
