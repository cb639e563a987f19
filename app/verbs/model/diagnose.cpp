// `ecs model diagnose`: which effect is missing from a model, with the evidence. `check`: whether a kept diagnosis
// holds on its data, without the search. `next`: the measurement that separates the rivals, and whether a planned one
// can determine a model.

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/models/answer_check.hpp"
#include "commissioning/models/plots.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/session/commands.hpp"
#include "model/planning/next_measurement.hpp"
#include "model/planning/questions.hpp"

namespace ecs::app {
namespace {

struct DiagnoseRequest {
  ModelArguments common;
  int blanks = static_cast<int>(model::DiagnoseOptions{}.noise_replicates);
  bool plain = false;
  std::string plot;
  static Fields<DiagnoseRequest> fields() {
    using R = DiagnoseRequest;
    return {
        &R::common,
        {"--blanks", &R::blanks,
         "largest number of simulated noise-only data sets with which each finding is compared; fewer are made if "
         "the measured readings clearly show only noise",
         Range{50, 20'000}},
        {"--plain", &R::plain, "use ordinary least squares: no reading is treated as an outlier"},
        {"--plot", &R::plot, "plot of measured and modelled values and of the residual, as .svg or .png", Is::output}};
  }
};

Result<void> draw(const ModelWork& work, const model::Diagnosis& diagnosis, const DiagnoseRequest& request) {
  ECS_TRY(figure, diagnosis_figure(work.model, work.data, diagnosis, request.plain));
  return write_plot(request.plot, figure);
}

/// The command that adds the first effect of the answer, with the rivals that the readings do not exclude; "" where the
/// answer names none.
std::string add_text(const model::Diagnosis& diagnosis, const ModelArguments& files) {
  const auto first = std::ranges::find_if(diagnosis.candidates, &model::Candidate::in_answer);
  if (first == diagnosis.candidates.end()) return {};
  const model::EffectInstance& effect = first->effect;
  std::vector<std::string> words{"ecs", "model", "add", files.model, to_text(effect)};
  words.insert(words.end(), files.data.begin(), files.data.end());
  const auto option = [&words](const char* name, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {name, value});
  };
  if (effect.approach != model::ApproachMode::both) option("--approach", std::string(name_of(effect.approach)));
  option("--sensor", effect.sensor);
  option("--sensor2", effect.sensor2);
  for (const model::EffectInstance& rival : first->open_rivals()) option("--or", place_text(rival));
  option("--machine", files.machine);
  for (const std::string& word : import_words(files.import))
    words.push_back(word == "--sense" ? "--reading-sense" : word);
  option("-o", files.model);
  const bool several = std::ranges::count_if(diagnosis.candidates, &model::Candidate::in_answer) > 1;
  return fmt::format("\nTo add {}{}{} to the model:\n  {}\n", several ? "the first effect, " : "", place_text(effect),
                     several ? "," : "", shell_command(words));
}

Result<Outcome> diagnose(VerbContext& context, const DiagnoseRequest& request) {
  if (!request.plot.empty()) ECS_DO(plot_format_of(request.plot));
  ECS_TRY(work, model_work(context.console, request.common));
  model::DiagnoseOptions options;
  options.noise_replicates = static_cast<std::size_t>(request.blanks);
  options.plain = request.plain;
  options.cancelled = &interrupted();
  ECS_TRY(diagnosis, in_file(model::diagnose(work.model, work.data, options), request.common.model));
  (void)model::planned_next(work.model, work.data, diagnosis);  // the proposal of `ecs model next`
  Cell answer = diagnosis_cell(diagnosis);
  ECS_DO(add_check_inputs(answer, request.common, work, request.plain));
  answer.text += add_text(diagnosis, request.common);
  if (!request.plot.empty()) {
    ECS_DO(draw(work, diagnosis, request));
    answer.text += "\nplot written to " + request.plot + "\n";
  }
  return outcome_of(answer);
}

struct CheckRequest {
  std::string answer, machine;
  std::vector<std::string> data;
  ImportArguments import;
  static Fields<CheckRequest> fields() {
    using R = CheckRequest;
    return {{"ANSWER", &R::answer, "saved answer of `ecs model diagnose --json`", Need::required},
            {"DATA", &R::data, "measurement files from which the answer was made, in the same order", Need::required},
            {"--machine", &R::machine, "machine file (.toml) to use instead of that named in the answer"},
            &R::import};
  }
};

Result<Outcome> check_saved(VerbContext& context, const CheckRequest& request) {
  ECS_TRY(checked, check_answer(context.console, request.answer, request.data, request.machine, request.import));
  return outcome_of(check_cell(checked), checked.holds() ? kDone : kDoesNotHold);
}

using model::MeasurementProposal;
using model::PlanCheck;

struct NextRequest {
  ModelArguments common;
  std::string check, program, targets;
  int proposal = 1;
  bool ball_bar = false;
  std::optional<double> noise_um;
  static Fields<NextRequest> fields() {
    using R = NextRequest;
    return {{&R::common, ModelArguments::fields(Need::optional)},
            {"--check", &R::check,
             "planned measurement file (its readings are ignored): exit 1 if it cannot determine MODEL"},
            {"--proposal", &R::proposal, "number of the proposal to write with --program and --targets", Range{1, 100}},
            {"--program", &R::program, "file for the part program of the proposal", Is::output},
            {"--targets", &R::targets, "file for the target list of the proposal, a measurement file without readings",
             Is::output},
            {"--ball-bar", &R::ball_bar,
             "a ball bar is available: propose circles too; default where DATA contain circles"},
            {"--noise", &R::noise_um, "noise of one reading for --check without DATA [um]; default: 0.5",
             Range{1e-6, 1e6}}};
  }
};

// --- proposals

Json ball_json(const model::BallSet& ball) {
  Json sweeps = Json::array();
  for (const model::BallSet::Sweep& one : ball.sweeps)
    sweeps.push_back(object_of("axis"_is(axis_json(one.axis, true)), "targets_deg"_is(one.targets_deg),
                               "parked_deg"_is(position_json(one.parked_deg, true))));
  return object_of("place_mm"_is(position_json(ball.place_mm)), "tool_mm"_is(position_json(ball.tool_mm)),
                   "sweeps"_is(std::move(sweeps)), "why"_is(ball.why));
}

Cell proposal_cell(const MeasurementProposal& one, std::size_t number) {
  Json pairs = Json::array();
  for (const model::PairSeparation& pair : one.pairs)
    pairs.push_back(object_of("truth"_is(pair.truth), "rival"_is(text_cell(pair.rival)), "sigma"_is(pair.sigma)));
  Json separation;  // null: a repetition separates nothing on its own
  if (!one.pairs.empty()) separation = number_or_null(one.separation_sigma);
  AnswerFields fields = described(
      "tells"_is(one.tells, paragraph(fmt::format("{}. {}", number, one.tells), 0, 3)),
      "axis"_is(axis_json(one.axis, one.ball.has_value())), "sense"_is(name_of(one.sense)),
      "targets_mm"_is(one.targets_mm), "parked_mm"_is(position_json(one.parked_mm)),
      "bidirectional"_is(one.bidirectional), "approach"_is(one.approach), "runs"_is(one.runs),
      "feed_mm_min"_is(one.feed_mm_min), "second_feed_mm_min"_is(one.second_feed_mm_min), "dwell_s"_is(one.dwell_s),
      "new_set_up"_is(one.new_set_up), "temperatures_degC"_is(one.temperatures_degC),
      "pressure_hPa"_is(one.pressure_hPa), "humidity_pct"_is(one.humidity_pct), "load_kg"_is(one.load_kg),
      "compensated"_is(one.compensated ? Json(*one.compensated) : Json(nullptr)),
      "reversed"_is(one.reversed ? Json(*one.reversed) : Json(nullptr)), "condition"_is(one.condition),
      "wait_minutes"_is(one.wait_minutes), "set_up_minutes"_is(one.set_up_minutes), "minutes"_is(one.minutes),
      "separation_sigma"_is(std::move(separation)), "pairs"_is(std::move(pairs)),
      "sentence"_is(one.sentence, paragraph(one.sentence, 3)));
  if (one.circle)
    fields.push_back("circle"_is(object_of("path"_is(to_text(*one.circle)), "step_deg"_is(one.circle_step_deg))));
  if (one.ball) fields.push_back("ball"_is(ball_json(*one.ball)));
  return record_cell("\n{tells}{sentence}", fields);
}

/// Those of an adequate model are in a note below, with their size.
std::string rivals_text(const model::NextMeasurement& next, const model::Diagnosis& diagnosis) {
  const std::vector<std::string>& rivals = next.rivals;
  const auto separates_causes = [](const MeasurementProposal& one) {
    return std::ranges::any_of(one.pairs, [](const model::PairSeparation& pair) { return !pair.rival.empty(); });
  };
  if (diagnosis.verdict == model::Verdict::adequate && std::ranges::none_of(next.proposals, separates_causes))
    return next.proposals.empty() ? "" : "No measurement is needed. To exclude small effects:\n";
  if (rivals.empty()) return {};
  if (diagnosis.verdict == model::Verdict::unexplained_structure)
    return diagnosis.different_run ? "Before another run, look for an event between the runs named above.\n" : "";
  return paragraph(
      fmt::format("{}: {}", rivals.size() > 1 ? "to be separated" : "to be confirmed", fmt::join(rivals, ", ")), 0, 2);
}

Cell proposals_cell(const model::NextMeasurement& next, const model::Diagnosis& diagnosis, const NextRequest& request) {
  Cell proposals{Json::array(), {}};
  for (const MeasurementProposal& one : next.proposals) proposals.add(proposal_cell(one, proposals.json.size() + 1));
  if (proposals.json.size() > 1 && !next.proposals.front().pairs.empty())
    proposals.text += "\n" + paragraph(fmt::format(
                                 "Proposal 1 {} best for the time it takes (more than {:g} sigma are treated as {:g}).",
                                 next.rivals.size() > 1 ? "distinguishes these causes" : "shows this cause",
                                 model::kEnoughSigma, model::kEnoughSigma));
  if (std::ranges::any_of(next.proposals, [](const MeasurementProposal& one) { return !one.pairs.empty(); }))
    proposals.text +=
        "\n" + paragraph("N sigma: the expected effect or difference is N times its standard uncertainty");
  std::vector<std::string> notes = next.notes;  // in the text without those that the headline contains
  std::erase_if(notes, [&](const std::string& note) {
    return !note.empty() && diagnosis.headline.find(note.substr(1)) != std::string::npos;
  });
  return record_cell("{verdict}{rivals}{proposals}{notes}",
                     "verdict"_is(name_of(diagnosis.verdict), paragraph(diagnosis.headline)),
                     "rivals"_is(next.rivals, rivals_text(next, diagnosis)), "proposals"_is(std::move(proposals)),
                     "program"_is(text_cell(request.program)), "targets"_is(text_cell(request.targets)),
                     "notes"_is(next.notes, notes_text(notes)));
}

/// Part program and target list of the chosen proposal; says what was written.
Result<std::string> written_for(const model::NextMeasurement& next, const std::optional<params::Machine>& machine,
                                const NextRequest& request) {
  std::string text;
  if (request.program.empty() && request.targets.empty()) return text;
  if (!request.program.empty() && !machine)
    return problem(ProblemKind::usage, "--program needs --machine: all motion must stay within its travels");
  const auto place = static_cast<std::size_t>(request.proposal - 1);
  if (next.proposals.empty())
    return problem(ProblemKind::refused, "no file was written, because no measurement is proposed. {}",
                   fmt::join(next.notes, "; "));
  if (place >= next.proposals.size())
    return problem(ProblemKind::refused, "there is no proposal {}, the last one is {}: no file was written",
                   request.proposal, next.proposals.size());
  const MeasurementProposal& proposal = next.proposals[place];
  if (!request.program.empty()) {
    text += fmt::format("\npart program of proposal {} written to {}", request.proposal, request.program);
    ECS_DO(write_file(request.program, part_program(proposal, *machine)));
  }
  if (!request.targets.empty()) {
    text += fmt::format("\ntarget list of proposal {} written to {}", request.proposal, request.targets);
    ECS_DO(write_file(request.targets, target_list(proposal)));
  }
  return text + "\n";
}

model::MeasuringTimes times_of(const NextRequest& request) {
  model::MeasuringTimes times;
  times.ball_bar = request.ball_bar;
  return times;
}

Result<Outcome> propose(VerbContext& context, const NextRequest& request) {
  if (request.common.data.empty())
    return problem(ProblemKind::usage, "expected DATA to propose from, or --check PLAN to judge a plan");
  std::vector<std::string> inputs = request.common.data;
  inputs.insert(inputs.end(), {request.common.model, request.common.machine});
  for (const std::string& output : {request.program, request.targets}) ECS_DO(check_output_not_input(output, inputs));
  ECS_TRY(work, model_work(context.console, request.common));
  ECS_TRY(diagnosis, in_file(model::diagnose(work.model, work.data), request.common.model));
  const model::NextMeasurement next = model::planned_next(work.model, work.data, diagnosis, times_of(request));
  ECS_TRY(written, written_for(next, work.machine, request));
  Cell answer = proposals_cell(next, diagnosis, request);
  answer.text += written;
  return outcome_of(answer);
}

// --- the check of a plan

/// Of one reading: from the data where there are any, else as given, else assumed.
Result<double> noise_to_expect(VerbContext& context, const NextRequest& request) {
  constexpr double kAssumed_um = 0.5;
  if (request.common.data.empty()) return request.noise_um.value_or(kAssumed_um);
  ECS_TRY(work, model_work(context.console, request.common));
  ECS_TRY(fit, in_file(model::fit(work.model, work.data), request.common.model));
  return fit.noise.noise_um;
}

Cell check_cell(const PlanCheck& check, double noise_um, bool noise_is_assumed, std::size_t readings) {
  Cell effects{Json::array(), fmt::format("{} {:>15}  unit\n", padded("effect and parameter", 40), "expected sigma")};
  for (const model::EffectFit& effect : check.effects)
    effects.add(record_cell("{place}  ({readings} readings)\n{parameters}", inlined({effect_json(effect.effect), ""}),
                            "place"_shown(place_text(effect.effect)),
                            "parameters"_is(parameters_cell(effect, "  {label:<38} {sigma:>15}  {unit}\n")),
                            "readings"_is(effect.readings)));
  std::string undetermined, assumed;
  for (const std::string& one : check.undetermined) undetermined += paragraph("undetermined: " + one, 0, 2);
  for (const std::string& one : check.assumed) assumed += paragraph("assumed: " + one, 0, 2);
  return record_cell(
      "{determines}\n{readings} readings, noise {noise_um} um{noise_of}{condition}\n\n{effects}"
      "{undetermined}{assumed}",
      "determines"_is(check.determines, "The plan determines every parameter of the model.",
                      "The plan does not determine the model."),
      "readings"_is(readings), "noise_um"_is(noise_um, 3),
      "noise_of"_shown(noise_is_assumed ? " (assumed: give DATA or --noise)" : ""),
      "condition"_is(check.condition, check.determines ? ", " + separation_text(check.condition) : std::string()),
      "undetermined"_is(check.undetermined, undetermined), "effects"_is(std::move(effects)), "assumed"_shown(assumed));
}

Result<Outcome> check_planned(VerbContext& context, const NextRequest& request) {
  const auto model = model::read_model(request.common.model);
  if (!model) return tl::unexpected(model.error());
  ECS_TRY(machine, machine_in(context.console, request.common.machine));
  ECS_TRY(plan, plan_in(request.check, request.common.import));
  ECS_TRY(noise_um, noise_to_expect(context, request));
  const model::Observations rows = model::observations_of(plan.set, *model, machine);
  ECS_TRY(result, in_file(model::check_plan(*model, rows, noise_um), request.common.model));
  return outcome_of(check_cell(result, noise_um, request.common.data.empty() && !request.noise_um, rows.size()),
                    result.determines ? kDone : kDoesNotHold);
}

Result<Outcome> next(VerbContext& context, const NextRequest& request) {
  return request.check.empty() ? propose(context, request) : check_planned(context, request);
}

}  // namespace

extern const std::vector<Action> kModelDiagnosis{
    action("model diagnose", "find which effect is missing from a model, with its evidence and rivals",
           "ecs model diagnose model.toml data.csv --machine machine.toml --plot residual.svg", diagnose,
           {.logged = Logged::always, .kind = "diagnosis"}),
    action("model check", "recompute a saved diagnosis from its data; exit 1 if the result differs",
           "ecs model check answer.json data.csv", check_saved),
    action(
        "model next",
        "propose the measurement that separates the possible causes best for the time it takes; --check tests a plan",
        "ecs model next model.toml data.csv --machine machine.toml\n"
        "  ecs model next model.toml --check plan.csv --machine machine.toml",
        next)};

}  // namespace ecs::app
