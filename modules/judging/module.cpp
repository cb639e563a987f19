// What the module brings: `ecs model freeze` and `ecs model judge`.
#include "app/cli/module.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "commissioning/models/view.hpp"
#include "modules/judging/judging.hpp"

namespace ecs::commissioning {

cli::Fields<FreezeArguments> FreezeArguments::fields() {
  using M = ModelArguments;
  using R = FreezeArguments;
  const cli::Fields<M> of{{"MODEL", &M::model, "model file (.toml), fitted", cli::Need::required},
                          {"--data", &M::data, "measurement files to which the model was fitted", cli::Need::required},
                          {"--machine", &M::machine, kMachineHelp},
                          &M::import};
  return {{&R::of, of},
          {"--limits", &R::limits,
           "acceptance limits for each group of held-out readings, such as a run (.toml; modules/judging/README.md has "
           "an example)",
           cli::Need::required},
          {"-o,--output", &R::output, "file for the frozen model, data and limits (.json)", cli::Need::required,
           cli::Is::output}};
}

}  // namespace ecs::commissioning

namespace ecs::app {
namespace {

using namespace commissioning;

Cell file_cell(const FrozenFile& one) {
  if (one.file.empty()) return null_cell();
  return {object_of("file"_is(one.file), "sha256"_is(one.sha256)), one.sha256};
}

Result<Outcome> freeze_verb(VerbContext& context, const FreezeArguments& request) {
  ECS_TRY(frozen, freeze(context.console, request));
  std::vector<std::string> to_prove;
  for (const ModelWithout& one : frozen.without) to_prove.push_back(one.effect);
  return outcome_of(record_cell(
      "frozen: residual {rms_um} um rms (um/m for rotations), {readings} readings; model {model:.12}, program "
      "{program_sha256:.12}\n{to_prove}"
      "frozen model written to {freeze}\nnext: ecs model judge {freeze} HELD_OUT...\n",
      "freeze"_is(request.output), "time"_is(frozen.time), "program"_is(frozen.program),
      "program_sha256"_is(frozen.program_sha256), "model"_is(file_cell(frozen.model)),
      "machine"_is(file_cell(frozen.machine)), "map"_is(file_cell(frozen.map)),
      "data"_is(list_cell(frozen.data, file_cell)), "limits"_is(file_cell(frozen.limits)),
      "readings"_is(frozen.readings), "rms_um"_is(frozen.rms_um, 3),
      "to_prove"_is(
          to_prove,
          to_prove.empty()
              ? ""
              : paragraph(fmt::format("with each of these effects, the model must predict better than without it: {}",
                                      fmt::join(to_prove, "; ")),
                          0, 2))));
}

struct JudgeRequest {
  std::string freeze;
  std::vector<std::string> held_out;
  ImportArguments import;
  static Fields<JudgeRequest> fields() {
    using R = JudgeRequest;
    return {{"FREEZE", &R::freeze, "file written by `ecs model freeze` (.json)", Need::required},
            {"HELD_OUT", &R::held_out, "measurement files that were not used for the fit", Need::required},
            &R::import};
  }
};

constexpr const char* kNotShown =
    "These readings do not show that every effect predicts better than the model without it. Two stretches of "
    "readings are needed, and four runs or more are better.";

std::string group_name(const JudgedGroup& one) {
  if (one.by == "half" && one.value.size() > 2) return one.value.substr(2) + " half of " + one.value.substr(0, 1);
  return one.by == one.value ? one.by : one.by + " " + one.value;
}

Cell group_cell(const JudgedGroup& one, std::size_t width) {
  std::string why;
  for (const std::string& condition : one.conditions) why += paragraph(condition, 4, 6);
  return record_cell(
      "{group}{kind:<8}{readings:>8}{rms_um:>10.3f}{limit_um:>10.3f}{max_um:>10.3f}{max_limit_um:>10.3f}  "
      "{holds}\n{why}",
      "by"_is(one.by), "value"_is(one.value), "group"_shown(padded(group_name(one), width)),
      "kind"_is(one.beyond ? "beyond" : "inside"), "rms_um"_is(one.rms_um), "limit_um"_is(one.limit.rms_um),
      "holds"_is(one.holds(), "holds", "FAILS"), "readings"_is(one.readings), "max_um"_is(one.max_um),
      "max_limit_um"_is(one.limit.max_um), "beyond"_is(one.conditions, ""), "why"_shown(why));
}

Cell judged_effect_cell(const JudgedEffect& one) {
  const bool acts = one.readings > 0;
  const char* const shown = !acts          ? "does not act here"
                            : !one.p_value ? "TOO FEW STRETCHES"
                            : one.better() ? "better"
                            : one.helps()  ? "NOT SHOWN"
                                           : "NOT BETTER";
  return record_cell("{name}{rms_without_um:>10.3f}{rms_um:>10.3f}{stretches:>11}{p_value:>10.2g}  {better}\n",
                     "effect"_is(one.effect), "name"_shown(padded(one.effect, 30)),
                     "rms_without_um"_is(acts ? std::optional(one.rms_without_um) : std::nullopt),
                     "rms_um"_is(acts ? std::optional(one.rms_um) : std::nullopt), "readings"_is(one.readings),
                     "stretches"_is(one.stretches), "p_value"_is(one.p_value),
                     "better"_is(acts ? Json(one.better()) : Json(), shown));
}

Cell use_cell(const RecordedUse& one, const Judgement& judgement) {
  const auto file = judgement.file_of.find(one.sha256);
  const std::string name = file == judgement.file_of.end() ? "" : file->second;
  const std::string by = one.verb.empty() ? one.kind : one.verb;
  return {
      object_of("file"_is(text_cell(name)), "number"_is(one.number), "time"_is(one.time), "by"_is(by)),
      paragraph(fmt::format("{}{} (entry {}, {})", name.empty() ? "" : name + ": ", by, one.number, one.time), 2, 4)};
}

std::string opened_text(const Judgement& judgement) {
  if (!judgement.openings)
    return paragraph(
        "No logbook is kept of this machine: it cannot be checked whether these held-out readings were judged before, "
        "or used before the freeze.",
        0, 2);
  std::string text;
  if (judgement.openings->empty()) {
    text = "The held-out readings are judged for the first time.\n";
  } else {
    text = paragraph(fmt::format("This is judgement {} with this freeze or these files, so it is not independent. "
                                 "Earlier judgements:",
                                 judgement.openings->size() + 1),
                     0, 2);
    for (const RecordedUse& one : *judgement.openings) text += use_cell(one, judgement).text;
  }
  if (judgement.seen->empty()) return text + "The logbook records no use of these files before the freeze.\n";
  text += "Used before the freeze:\n";
  for (const RecordedUse& one : *judgement.seen) text += use_cell(one, judgement).text;
  return text;
}

Json uses_json(const std::optional<std::vector<RecordedUse>>& uses, const Judgement& judgement) {
  if (!uses) return {};
  return list_cell(*uses, [&](const RecordedUse& one) { return use_cell(one, judgement); }).json;
}

Cell judgement_cell(const Judgement& judgement) {
  const std::string unit = judgement.unit;
  std::size_t width = 20;
  for (const JudgedGroup& one : judgement.groups) width = std::max(width, columns_of(group_name(one)) + 2);
  Cell groups = list_cell(
      judgement.groups, [width](const JudgedGroup& one) { return group_cell(one, width); },
      fmt::format("{:<{}}{:<8}{:>8}{:>10}{:>10}{:>10}{:>10}\n", "group [" + unit + "]", width, "kind", "readings",
                  "rms", "limit", "largest", "limit"));
  groups.text +=
      paragraph("kind: inside: conditions within the range of the fitted readings; beyond: outside it", 2, 2);
  Cell effects{Json::array(), ""};
  if (!judgement.effects.empty()) {
    effects = list_cell(judgement.effects, judged_effect_cell,
                        fmt::format("\n{:<30}{:>10}{:>10}{:>11}{:>10}\n", "effect [" + unit + "]", "without", "with",
                                    "stretches", "p-value"));
    effects.text += paragraph(
        "without, with: rms of the model without and with the effect; stretches: runs, or parts of runs, that are "
        "compared (TOO FEW STRETCHES: fewer than two); p-value: probability of such a result if the effect did not "
        "improve "
        "the prediction",
        2, 2);
  }
  const bool undecided =
      !judgement.holds() && std::ranges::all_of(judgement.groups, [](const JudgedGroup& one) { return one.holds(); }) &&
      std::ranges::all_of(judgement.effects,
                          [](const JudgedEffect& one) { return one.readings == 0 || one.better() || one.helps(); });
  const std::string beside =
      fmt::format(" by the held-out readings{}.\n", judgement.zero_of_each_run ? " (about the mean of each run)" : "");
  const auto number = judgement.openings ? Json(judgement.openings->size() + 1) : Json();
  return record_cell("{holds}{zero}\n{groups}{effects}\n{opened}{notes}", "opened"_is(number, opened_text(judgement)),
                     "groups"_is(groups),
                     "holds"_is(judgement.holds(), "The model is confirmed",
                                undecided ? "Every limit is met" : "The model is not confirmed"),
                     "zero"_shown(beside + (undecided ? paragraph(kNotShown, 0, 0) : "")), "effects"_is(effects),
                     "openings"_is(uses_json(judgement.openings, judgement)),
                     "seen"_is(uses_json(judgement.seen, judgement)),
                     "frozen"_is(object_of("time"_is(judgement.frozen.time), "model"_is(judgement.frozen.model.file),
                                           "rms_um"_is(judgement.frozen.rms_um))),
                     "notes"_is(judgement.notes, notes_text(judgement.notes)));
}

Result<Outcome> judge_verb(VerbContext& context, const JudgeRequest& request) {
  ECS_TRY(judgement, judge(context.console, request.freeze, request.held_out, request.import));
  return outcome_of(judgement_cell(judgement), judgement.holds() ? kDone : kDoesNotHold);
}

const std::vector<Action> kJudging{
    action("model freeze", "freeze a model with its acceptance limits, before it is tested on held-out readings",
           "ecs model freeze model.toml --data data.csv --machine machine.toml --limits limits.toml -o frozen.json",
           freeze_verb, {.logged = Logged::always, .kind = "model"}),
    action(kJudgeVerb, "test a frozen model on readings that were not used for its fit",
           "ecs model judge frozen.json held_out.csv", judge_verb, {.logged = Logged::always, .kind = "test"})};

}  // namespace

const Module& judging_module() {
  static const Module module{.verbs = {{"model diagnose", &kJudging}},
                             .synonyms = {{"model judge", "hold-out holdout validation acceptance test unseen"}}};
  return module;
}

}  // namespace ecs::app
