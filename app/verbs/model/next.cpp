// `ecs model next`: the measurement that separates the rivals, and whether a planned one can determine a model.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/file.hpp"
#include "base/paragraph.hpp"
#include "commissioning/models/diagnosis_view.hpp"
#include "commissioning/models/json.hpp"
#include "commissioning/models/plan.hpp"
#include "commissioning/models/view.hpp"
#include "model/planning/next_measurement.hpp"
#include "model/planning/part_program.hpp"

namespace ecs::app {
namespace {

using model::MeasurementProposal;
using model::PlanCheck;

struct NextArguments : VerbArguments {
  ModelOptions common{*this, Need::optional};
  const std::string& check =
      text("--check", "a planned measurement set (readings do not count): exit 1 if it cannot determine MODEL");
  const int& proposal = integer("--proposal", "which of the proposals --program and --targets are for", 1, 1, 100);
  const std::string& program = output_file("--program", "part program of the proposal to write");
  const std::string& targets =
      output_file("--targets", "target list of the proposal to write, a measurement set without readings");
  const bool& ball_bar =
      flag("--ball-bar", "a ball bar is at hand: circles are proposed too; where DATA hold circles they are");
  const double& noise_um =
      number("--noise", "of one reading, for --check without DATA [um]", 0.5, Need::optional, 1e-6, 1e6);
};

// --- proposals

Cell proposal_cell(const MeasurementProposal& one, std::size_t number) {
  Json pairs = Json::array();
  for (const model::PairSeparation& pair : one.pairs)
    pairs.push_back(
        {{"truth", pair.truth}, {"rival", text_or_null(pair.rival)}, {"sigma", number_or_null(pair.sigma)}});
  Json separation;  // null: a repetition separates nothing by itself
  if (!one.pairs.empty()) separation = number_or_null(one.separation_sigma);
  AnswerFields fields = {{"tells", {one.tells, paragraph(fmt::format("{}. {}", number, one.tells), 0, 3)}},
                         {"axis", word_cell(axis_json(one.axis))},
                         {"sense", word_cell(name_of(one.sense))},
                         {"targets_mm", {one.targets_mm, ""}},
                         {"parked_mm", {position_json(one.parked_mm), ""}},
                         {"bidirectional", {one.bidirectional, ""}},
                         {"approach", integer_cell(one.approach)},
                         {"runs", integer_cell(one.runs)},
                         {"feed_mm_min", {number_or_null(one.feed_mm_min), ""}},
                         {"second_feed_mm_min", {number_or_null(one.second_feed_mm_min), ""}},
                         {"dwell_s", {number_or_null(one.dwell_s), ""}},
                         {"new_set_up", {one.new_set_up, ""}},
                         {"temperatures_degC", {one.temperatures_degC, ""}},
                         {"pressure_hPa", {number_or_null(one.pressure_hPa), ""}},
                         {"humidity_pct", {number_or_null(one.humidity_pct), ""}},
                         {"load_kg", {number_or_null(one.load_kg), ""}},
                         {"compensated", {one.compensated ? Json(*one.compensated) : Json(nullptr), ""}},
                         {"reversed", {one.reversed ? Json(*one.reversed) : Json(nullptr), ""}},
                         {"condition", word_cell(one.condition)},
                         {"wait_minutes", {number_or_null(one.wait_minutes), ""}},
                         {"set_up_minutes", {number_or_null(one.set_up_minutes), ""}},
                         {"minutes", {number_or_null(one.minutes), ""}},
                         {"separation_sigma", {std::move(separation), ""}},
                         {"pairs", {std::move(pairs), ""}},
                         {"sentence", {one.sentence, paragraph(one.sentence, 3)}}};
  if (one.circle)
    fields.push_back({"circle", {{{"path", to_text(*one.circle)}, {"step_deg", one.circle_step_deg}}, ""}});
  return record_cell("\n{tells}{sentence}", fields);
}

std::string rivals_text(const std::vector<std::string>& rivals) {
  if (rivals.size() > 1) return paragraph(fmt::format("to be separated: {}", fmt::join(rivals, ", ")), 0, 2);
  return rivals.empty() ? std::string() : paragraph("to be confirmed: " + rivals.front());
}

Cell proposals_cell(const model::NextMeasurement& next, const model::Diagnosis& diagnosis,
                    const NextArguments& arguments) {
  Cell proposals{Json::array(), {}};
  for (const MeasurementProposal& one : next.proposals) proposals.add(proposal_cell(one, proposals.json.size() + 1));
  if (proposals.json.size() > 1) proposals.text += "\nFirst the run that decides the most in a minute.\n";
  return record_cell("{verdict}{rivals}{proposals}{notes}",
                     {{"verdict", {name_of(diagnosis.verdict), paragraph(diagnosis.headline)}},
                      {"rivals", {next.rivals, rivals_text(next.rivals)}},
                      {"proposals", std::move(proposals)},
                      {"program", text_cell(arguments.program)},
                      {"targets", text_cell(arguments.targets)},
                      {"notes", {next.notes, notes_text(next.notes)}}});
}

/// Part program and target list of the chosen proposal; says what was written.
Result<std::string> written_for(const model::NextMeasurement& next, const std::optional<params::Machine>& machine,
                                const NextArguments& arguments) {
  std::string text;
  if (arguments.program.empty() && arguments.targets.empty()) return text;
  if (!arguments.program.empty() && !machine)
    return problem(ProblemKind::usage, "--program needs --machine: no motion may leave its travels");
  const auto place = static_cast<std::size_t>(arguments.proposal - 1);
  if (next.proposals.empty())
    return problem(ProblemKind::refused,
                   fmt::format("no measurement is proposed, so nothing was written: {}", fmt::join(next.notes, "; ")));
  if (place >= next.proposals.size())
    return problem(ProblemKind::refused, fmt::format("there is no proposal {}, the last one is {}: nothing was written",
                                                     arguments.proposal, next.proposals.size()));
  const MeasurementProposal& proposal = next.proposals[place];
  if (!arguments.program.empty()) {
    text += fmt::format("\npart program of proposal {} written to {}", arguments.proposal, arguments.program);
    ECS_DO(write_file(arguments.program, part_program(proposal, *machine)));
  }
  if (!arguments.targets.empty()) {
    text += fmt::format("\ntarget list of proposal {} written to {}", arguments.proposal, arguments.targets);
    ECS_DO(write_file(arguments.targets, target_list(proposal)));
  }
  return text + "\n";
}

model::MeasuringTimes times_of(const NextArguments& arguments) {
  model::MeasuringTimes times;
  times.ball_bar = arguments.ball_bar;
  return times;
}

Result<Outcome> propose(VerbContext& context, const NextArguments& arguments) {
  if (arguments.common.data.empty())
    return problem(ProblemKind::usage, "expected DATA to propose from, or --check PLAN to judge a plan");
  std::vector<std::string> inputs = arguments.common.data;
  inputs.insert(inputs.end(), {arguments.common.model, arguments.common.machine});
  for (const std::string& output : {arguments.program, arguments.targets})
    ECS_DO(check_output_not_input(output, inputs));
  ECS_TRY(work, model_work(context.console, arguments.common));
  auto diagnosis = model::diagnose(work.model, work.data);
  if (!diagnosis) return tl::unexpected(in_file(diagnosis.error(), arguments.common.model));
  const model::NextMeasurement next = model::planned_next(work.model, work.data, *diagnosis, times_of(arguments));
  ECS_TRY(written, written_for(next, work.machine, arguments));
  Cell answer = proposals_cell(next, *diagnosis, arguments);
  answer.text += written;
  return outcome_of(answer);
}

// --- the check of a plan

/// Of one reading: from the data where there are any, else as given.
Result<double> noise_to_expect(VerbContext& context, const NextArguments& arguments) {
  if (arguments.common.data.empty()) return arguments.noise_um;
  ECS_TRY(work, model_work(context.console, arguments.common));
  const auto fit = model::fit(work.model, work.data);
  if (!fit) return tl::unexpected(in_file(fit.error(), arguments.common.model));
  return fit->noise.noise_um;
}

Cell check_cell(const PlanCheck& check, double noise_um, std::size_t readings) {
  Cell effects{Json::array(), fmt::format("{} {:>15}  unit\n", padded("effect and parameter", 40), "sigma to expect")};
  for (const model::EffectFit& effect : check.effects)
    effects.add(record_cell("{place}  ({readings} readings)\n{parameters}",
                            {{"", {effect_json(effect.effect), ""}},
                             {"place", shown_cell(place_text(effect.effect))},
                             {"parameters", parameters_cell(effect.parameters, "  {name:<38} {sigma:>15}  {unit}\n")},
                             {"readings", count_cell(effect.readings)}}));
  std::string undetermined, assumed;
  for (const std::string& one : check.undetermined) undetermined += paragraph("undetermined: " + one, 0, 2);
  for (const std::string& one : check.assumed) assumed += paragraph("assumed: " + one, 0, 2);
  return record_cell(
      "{determines}\n{readings} readings, noise {noise_um} um, condition {condition}\n\n{effects}"
      "{undetermined}{assumed}",
      {{"determines", yes_cell(check.determines, "The plan determines every parameter of the model.",
                               "The plan does not determine the model.")},
       {"readings", count_cell(readings)},
       {"noise_um", number_cell(noise_um, 3)},
       {"condition", {number_or_null(check.condition), few_digits(check.condition)}},
       {"undetermined", {check.undetermined, undetermined}},
       {"effects", std::move(effects)},
       {"assumed", shown_cell(assumed)}});
}

Result<Outcome> check(VerbContext& context, const NextArguments& arguments) {
  const auto model = model::read_model(arguments.common.model);
  if (!model) return tl::unexpected(model.error());
  ECS_TRY(machine, machine_in(context.console, arguments.common.machine));
  ECS_TRY(plan, plan_in(arguments.check, arguments.common.import));
  ECS_TRY(noise_um, noise_to_expect(context, arguments));
  const model::Observations rows = model::observations_of(plan.set, *model, machine);
  const auto result = model::check_plan(*model, rows, noise_um);
  if (!result) return tl::unexpected(in_file(result.error(), arguments.common.model));
  return outcome_of(check_cell(*result, noise_um, rows.size()), result->determines ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kModelNext =
    verb<NextArguments>("model next", "the measurement that separates rivals best per minute; --check judges a plan",
                        "ecs model next model.toml data.csv --machine machine.toml\n"
                        "  ecs model next model.toml --check plan.csv --machine machine.toml",
                        [](VerbContext& context, const NextArguments& arguments) {
                          return arguments.check.empty() ? propose(context, arguments) : check(context, arguments);
                        });

}  // namespace ecs::app
