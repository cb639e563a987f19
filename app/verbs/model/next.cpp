// `ecs model next`: the measurement that separates the rivals, and whether a planned one can determine a model.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
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

struct NextArguments {
  ModelArguments common;
  std::string check;
  double noise_um = 0.5;
  int proposal = 1;
  std::string program;
  std::string targets;
};

// --- proposals

std::string proposals_text(const model::NextMeasurement& next, const model::Diagnosis& diagnosis) {
  std::string text = paragraph(verdict_sentence(diagnosis));
  if (next.rivals.size() > 1) text += paragraph(fmt::format("to be separated: {}", fmt::join(next.rivals, ", ")), 0, 2);
  if (next.rivals.size() == 1) text += paragraph("to be confirmed: " + next.rivals.front());
  std::size_t number = 0;
  for (const MeasurementProposal& one : next.proposals) {
    text += fmt::format("\n{}. {:.1f} sigma in {:.0f} min\n", ++number, one.separation_sigma, one.minutes);
    text += paragraph(one.sentence, 3);
  }
  return text + notes_text(next.notes);
}

Json pairs_json(const MeasurementProposal& one) {
  Json pairs = Json::array();
  for (const model::PairSeparation& pair : one.pairs)
    pairs.push_back(
        {{"truth", pair.truth}, {"rival", text_or_null(pair.rival)}, {"sigma", number_or_null(pair.sigma)}});
  return pairs;
}

Json proposal_json(const MeasurementProposal& one) {
  return {{"axis", axis_json(one.axis)},
          {"sense", name_of(one.sense)},
          {"targets_mm", one.targets_mm},
          {"parked_mm", position_json(one.parked_mm)},
          {"bidirectional", one.bidirectional},
          {"approach", one.approach},
          {"runs", one.runs},
          {"feed_mm_min", number_or_null(one.feed_mm_min)},
          {"second_feed_mm_min", number_or_null(one.second_feed_mm_min)},
          {"dwell_s", number_or_null(one.dwell_s)},
          {"new_set_up", one.new_set_up},
          {"temperatures_degC", one.temperatures_degC},
          {"pressure_hPa", number_or_null(one.pressure_hPa)},
          {"humidity_pct", number_or_null(one.humidity_pct)},
          {"load_kg", number_or_null(one.load_kg)},
          {"compensated", one.compensated ? Json(*one.compensated) : Json(nullptr)},
          {"condition", one.condition},
          {"wait_minutes", number_or_null(one.wait_minutes)},
          {"set_up_minutes", number_or_null(one.set_up_minutes)},
          {"minutes", number_or_null(one.minutes)},
          {"separation_sigma", number_or_null(one.separation_sigma)},
          {"pairs", pairs_json(one)},
          {"sentence", one.sentence}};
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
    if (const auto done = write_file(arguments.program, part_program(proposal, *machine)); !done)
      return tl::unexpected(done.error());
  }
  if (!arguments.targets.empty()) {
    text += fmt::format("\ntarget list of proposal {} written to {}", arguments.proposal, arguments.targets);
    if (const auto done = write_file(arguments.targets, target_list(proposal)); !done)
      return tl::unexpected(done.error());
  }
  return text + "\n";
}

Result<Outcome> propose(VerbContext& context, const NextArguments& arguments) {
  if (arguments.common.data.empty())
    return problem(ProblemKind::usage, "expected DATA to propose from, or --check PLAN to judge a plan");
  std::vector<std::string> inputs = arguments.common.data;
  inputs.insert(inputs.end(), {arguments.common.model, arguments.common.machine});
  for (const std::string& output : {arguments.program, arguments.targets})
    if (const auto spared = check_output_not_input(output, inputs); !spared) return tl::unexpected(spared.error());
  const auto work = model_work(context.console, arguments.common);
  if (!work) return tl::unexpected(work.error());
  const auto diagnosis = model::diagnose(work->model, work->data);
  if (!diagnosis) return tl::unexpected(in_file(diagnosis.error(), arguments.common.model));
  const model::NextMeasurement next = model::next_measurement(work->model, work->data, *diagnosis);
  const auto written = written_for(next, work->machine, arguments);
  if (!written) return tl::unexpected(written.error());
  Json proposals = Json::array();
  for (const MeasurementProposal& one : next.proposals) proposals.push_back(proposal_json(one));
  return Outcome{proposals_text(next, *diagnosis) + *written,
                 one_line(Json{{"verdict", name_of(diagnosis->verdict)},
                               {"rivals", next.rivals},
                               {"proposals", std::move(proposals)},
                               {"program", text_or_null(arguments.program)},
                               {"targets", text_or_null(arguments.targets)},
                               {"notes", next.notes}}),
                 kDone};
}

// --- the check of a plan

/// Of one reading: from the data where there are any, else as given.
Result<double> noise_to_expect(VerbContext& context, const NextArguments& arguments) {
  if (arguments.common.data.empty()) return arguments.noise_um;
  const auto work = model_work(context.console, arguments.common);
  if (!work) return tl::unexpected(work.error());
  const auto fit = model::fit(work->model, work->data);
  if (!fit) return tl::unexpected(in_file(fit.error(), arguments.common.model));
  return fit->noise.noise_um;
}

std::string check_text(const PlanCheck& check, double noise_um, std::size_t readings) {
  std::string text = paragraph(check.determines ? "The plan determines every parameter of the model."
                                                : "The plan does not determine the model.");
  text +=
      fmt::format("{} readings, noise {:.3f} um, condition {}\n\n", readings, noise_um, few_digits(check.condition));
  text += fmt::format("{} {:>15}  unit\n", padded("effect and parameter", 40), "sigma to expect");
  for (const model::EffectFit& effect : check.effects) {
    text += place_text(effect.effect) + fmt::format("  ({} readings)\n", effect.readings);
    for (const model::ParameterEstimate& one : effect.parameters) {
      std::string sigma = one.sigma ? few_digits(*one.sigma, 2) : "-";
      if (one.held) sigma = "held";
      if (one.undetermined) sigma = "undetermined";
      text += fmt::format("  {} {:>15}  {}\n", padded(one.name, 38), sigma, one.unit);
    }
  }
  for (const std::string& one : check.undetermined) text += paragraph("undetermined: " + one, 0, 2);
  for (const std::string& one : check.assumed) text += paragraph("assumed: " + one, 0, 2);
  return text;
}

Json check_json(const PlanCheck& check, double noise_um, std::size_t readings) {
  Json effects = Json::array();
  for (const model::EffectFit& effect : check.effects) {
    Json object = json_of(effect.effect);
    object["parameters"] = json_of(effect.parameters);
    object["readings"] = effect.readings;
    effects.push_back(std::move(object));
  }
  return {{"determines", check.determines},       {"readings", readings},
          {"noise_um", number_or_null(noise_um)}, {"condition", number_or_null(check.condition)},
          {"undetermined", check.undetermined},   {"effects", std::move(effects)}};
}

Result<Outcome> check(VerbContext& context, const NextArguments& arguments) {
  const auto model = model::read_model(arguments.common.model);
  if (!model) return tl::unexpected(model.error());
  const auto machine = machine_in(context.console, arguments.common.machine);
  if (!machine) return tl::unexpected(machine.error());
  const auto plan = plan_in(arguments.check, arguments.common.import);
  if (!plan) return tl::unexpected(plan.error());
  const auto noise_um = noise_to_expect(context, arguments);
  if (!noise_um) return tl::unexpected(noise_um.error());
  const model::Observations rows = model::observations_of(plan->set, *model, *machine);
  const auto result = model::check_plan(*model, rows, *noise_um);
  if (!result) return tl::unexpected(in_file(result.error(), arguments.common.model));
  return Outcome{check_text(*result, *noise_um, rows.size()), one_line(check_json(*result, *noise_um, rows.size())),
                 result->determines ? kDone : kDoesNotHold};
}

}  // namespace

extern const VerbDefinition kModelNext = verb<NextArguments>(
    "model next", "the measurement that separates rivals best per minute; --check judges a plan",
    "ecs model next model.toml data.csv --machine machine.toml\n"
    "  ecs model next model.toml --check plan.csv --machine machine.toml",
    [](Verb& verb, NextArguments& arguments) {
      take_model_and_data(verb, arguments.common, Need::optional);
      verb.text("--check", arguments.check,
                "a planned measurement set (readings do not count): exit 1 if it cannot determine MODEL")
          .integer("--proposal", arguments.proposal, "which of the proposals --program and --targets are for", 1, 100)
          .text("--program", arguments.program, "part program of the proposal to write")
          .text("--targets", arguments.targets,
                "target list of the proposal to write, a measurement set without readings")
          .number("--noise", arguments.noise_um, "of one reading, for --check without DATA [um]", Need::optional, 1e-6,
                  1e6);
    },
    [](VerbContext& context, const NextArguments& arguments) {
      return arguments.check.empty() ? propose(context, arguments) : check(context, arguments);
    });

}  // namespace ecs::app
