// `ecs lengths fit`: the 21 components from lengths, the map and the squareness. `plan`: which lengths to measure for a
// wanted uncertainty of the volume, in the fewest minutes.

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/interrupt.hpp"
#include "commissioning/measurements/files.hpp"
#include "laser/map/csv.hpp"
#include "modules/lengths/lengths_work.hpp"

namespace ecs::app {
namespace {

Result<Outcome> fit_lengths(VerbContext&, const LengthsArguments& a) {
  if (const auto wrong = wrong_date(a.date)) return problem(ProblemKind::usage, "--date: " + *wrong);
  if ((!a.output.empty() || !a.params_out.empty()) && a.params.empty())
    return problem(ProblemKind::usage, "--params is required for a map: the parameters of the unit that it is for");
  for (const std::string& output : {a.output, a.params_out})
    ECS_DO(check_output_not_input(output, {a.file, a.machine, a.params}));
  ECS_TRY(work, lengths_work(a));
  const bool writes = work.map.has_value();
  if (writes && !a.output.empty()) ECS_DO(write_file(a.output, laser::to_map_csv(*work.map)));
  if (writes && !a.params_out.empty())
    ECS_DO(params::write_parameters(a.params_out, work.unit->parameters, work.unit->identity));
  return outcome_of(lengths_cell(work, writes ? a.output : "", writes ? a.params_out : ""),
                    work.found.whole() ? kDone : kDoesNotHold);
}

Result<Outcome> plan_the_lengths(VerbContext&, const LengthsPlanAsked& a) {
  ECS_DO(check_output_not_input(a.output, {a.machine}));
  ECS_TRY(plan, lengths_plan(a, [] { return interrupted().load(); }));
  if (!a.output.empty()) ECS_DO(write_file(a.output, model::to_csv(plan.test, true)));
  return outcome_of(lengths_plan_cell(plan, a.volume_um, a.output), plan.reached ? kDone : kDoesNotHold);
}

}  // namespace

extern const std::vector<Action> kLengths{
    action("lengths fit",
           "the 21 components from lengths alone, with uncertainties; which are determined and which are not",
           "ecs lengths fit lengths.csv --machine machine.toml --params parameters.toml -o map.csv --params-out "
           "measured.toml",
           fit_lengths),
    action("lengths plan",
           "the lengths with the fewest minutes for a wanted uncertainty of the volume, beside single set-ups",
           "ecs lengths plan --machine machine.toml --volume-um 2 -o plan.csv", plan_the_lengths)};

}  // namespace ecs::app
