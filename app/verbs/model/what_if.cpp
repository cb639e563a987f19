// `ecs model what-if`: the error that compensation would leave; measured again, predicted against achieved. `repair`:
// repair or compensate, cause by cause. `reveal`: opens what was hidden in a case and scores the diagnosis, of one case
// or a folder of them.

#include "commissioning/models/what_if.hpp"

#include <algorithm>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/models/reveal.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/volume/repair.hpp"

namespace ecs::app {
namespace {

struct WhatIfRequest {
  ModelArguments common;
  std::vector<std::string> after;
  static Fields<WhatIfRequest> fields() {
    using R = WhatIfRequest;
    return {&R::common, {"--after", &R::after, "the same measured again with the unit compensating"}};
  }
};

Result<Outcome> what_if(VerbContext& context, const WhatIfRequest& request) {
  ECS_TRY(work, model_work(context.console, request.common));
  ECS_TRY(answer, what_if_answer(context.console, work, request.common.model, request.after, request.common.import));
  return outcome_of(what_if_cell(answer));
}

struct RepairRequest {
  ModelArguments common;
  int points = 1331;
  static Fields<RepairRequest> fields() {
    using R = RepairRequest;
    return {&R::common,
            {"--points", &R::points, "places in the volume, at most, and more for a wave and beside a step",
             Range{8, 100'000}}};
  }
};

Result<Outcome> repair(VerbContext& context, const RepairRequest& request) {
  ECS_TRY(work, model_work(context.console, request.common));
  ECS_TRY(answer, repair_answer(work, request.common.model, static_cast<std::size_t>(request.points)));
  return outcome_of(repair_cell(answer));
}

struct RevealRequest {
  std::string folder, diagnosis, machine;
  int blanks = static_cast<int>(model::DiagnoseOptions{}.noise_replicates);
  static Fields<RevealRequest> fields() {
    using R = RevealRequest;
    return {{"DIR", &R::folder, "a case of `ecs-emulator hide`, or a folder of such cases", Need::required},
            {"--diagnosis", &R::diagnosis, "saved JSON of `ecs model diagnose --json`; without it, one is made now"},
            {"--blanks", &R::blanks, "as for `ecs model diagnose`", Range{50, 20'000}},
            {"--machine", &R::machine, "another machine than machine.toml of the case"}};
  }
};

struct Revealed {
  std::string folder;
  HiddenTruth truth;
  FoundAnswer answer;
  Score score;
};

std::string inside(const std::string& folder, const char* name) {
  return (std::filesystem::path(folder) / name).string();
}

bool is_case(const std::string& folder) {
  std::error_code error;
  return std::filesystem::exists(inside(folder, "truth.sealed"), error) ||
         std::filesystem::exists(inside(folder, "truth.json"), error);
}

/// A case that cannot be diagnosed counts as wrong among others.
Revealed failed(const std::string& folder, HiddenTruth truth, const Problem& why) {
  return {folder, std::move(truth), {"", {}, {}, {}}, {false, to_text(why), {}, {}}};
}

/// The folders of cases in a folder, by name; the folder itself if it is one.
std::vector<std::string> cases_in(const std::string& folder) {
  if (is_case(folder)) return {folder};
  std::vector<std::string> list;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (is_case(entry.path().string())) list.push_back(entry.path().string());
  std::sort(list.begin(), list.end());
  return list;
}

Result<FoundAnswer> answer_of(VerbContext& context, const std::string& folder, const RevealRequest& request) {
  if (!request.diagnosis.empty()) {
    ECS_TRY(text, read_file(request.diagnosis));
    return answer_in(text, request.diagnosis);
  }
  ModelArguments inputs{inside(folder, "model.toml"), {inside(folder, "data.csv")}, request.machine, {}};
  if (inputs.machine.empty()) inputs.machine = inside(folder, "machine.toml");
  ECS_TRY(work, model_work(context.console, inputs));
  model::DiagnoseOptions options;
  options.noise_replicates = static_cast<std::size_t>(request.blanks);
  ECS_TRY(diagnosis, in_file(model::diagnose(work.model, work.data, options), inputs.model));
  return answer_in(one_line(diagnosis_cell(diagnosis).json), folder);
}

Result<Revealed> revealed(VerbContext& context, const std::string& folder, const RevealRequest& request, bool alone) {
  ECS_TRY(truth, truth_of(folder));
  auto answer = answer_of(context, folder, request);
  if (!answer && !alone) return failed(folder, std::move(truth), answer.error());
  if (!answer) return tl::unexpected(answer.error());
  Score score = score_of(truth, *answer);
  return Revealed{folder, std::move(truth), std::move(*answer), std::move(score)};
}

// --- one case

std::string hidden_text(const HiddenTruth& truth) {
  const std::string said = truth.text.empty() ? std::string(name_of(truth.kind)) : truth.text;
  std::string text = paragraph(said.starts_with("Hidden: ") ? said : "Hidden: " + said, 0, 2);
  for (const HiddenEffect& effect : truth.effects)
    text += fmt::format("  {}: rms {:.3f} um, {:.1f} times the noise of {:.3f} um\n", effect.name, effect.rms_um,
                        effect.snr, truth.noise_um);
  if (!truth.group.empty())
    text += paragraph(fmt::format("these data cannot distinguish: {}", fmt::join(truth.group, ", ")), 2, 4);
  if (!truth.variables.empty())
    text += paragraph(fmt::format("it depends on: {}", fmt::join(truth.variables, " or ")), 2, 4);
  return text;
}

std::vector<std::string> found_names(const FoundAnswer& answer) {
  std::vector<std::string> names;
  for (const FoundEffect& one : answer.candidates) {
    if (!one.named) continue;
    std::string name = place_text(one.effect);
    if (!one.group.empty()) name += fmt::format(" (or {})", fmt::join(one.group, ", "));
    names.push_back(std::move(name));
  }
  return names;
}

std::string found_text(const FoundAnswer& answer) {
  const auto names = found_names(answer);
  std::string text = "Found: " + answer.verdict;
  if (!names.empty()) text += fmt::format(": {}", fmt::join(names, "; "));
  if (answer.verdict == "unexplained_structure" && !answer.where.empty())
    text += fmt::format("; it depends on {}", fmt::join(answer.where, ", "));
  return paragraph(text, 0, 2);
}

Cell scores_cell(const std::vector<ParameterScore>& scores) {
  Cell list{Json::array(),
            fmt::format("{:<32} {:>12} {:>12} {:>10} {:>8}\n", "parameter", "hidden", "found", "sigma", "off by")};
  for (const ParameterScore& p : scores) {
    const auto off = p.sigmas_off();
    list.add(record_cell("{name:<32} {truth:>12} {found:>12} {sigma:>10} {sigmas_off:>8}\n",
                         {{"effect", word_cell(p.effect)},
                          {"name", {p.name, fmt::format("{} {}", p.effect, p.name)}},
                          {"truth", {number_or_null(p.hidden), few_digits(p.hidden, 5)}},
                          {"found", {number_or_null(p.found), few_digits(p.found, 5)}},
                          {"sigma", {number_or_null(p.sigma), p.sigma ? few_digits(*p.sigma, 2) : "-"}},
                          {"sigmas_off", {number_or_null(off), off ? fmt::format("{:+.1f} s", *off) : "-"}}}));
  }
  return list;
}

std::string case_text(const Revealed& r) {
  std::string text = hidden_text(r.truth) + found_text(r.answer);
  if (!r.score.parameters.empty()) text += "\n" + scores_cell(r.score.parameters).text;
  text += "\n";
  text += paragraph(fmt::format("{}: {}", r.score.right ? "RIGHT" : "WRONG", r.score.why), 0, 2);
  if (r.score.rms_ratio)
    text += fmt::format("rms after adding what is named: {:.3f} times that of the true model\n", *r.score.rms_ratio);
  return text;
}

Json case_json(const Revealed& r) {
  return {{"case", r.folder},
          {"kind", name_of(r.truth.kind)},
          {"right", r.score.right},
          {"why", r.score.why},
          {"truth", Json::parse(r.truth.json)},
          {"found", found_names(r.answer)},
          {"verdict", r.answer.verdict},
          {"where", r.answer.where},
          {"parameters", scores_cell(r.score.parameters).json},
          {"rms_after_um", number_or_null(r.answer.rms_after_um)},
          {"true_model_rms_um", r.truth.true_model_rms_um > 0.0 ? Json(r.truth.true_model_rms_um) : Json(nullptr)},
          {"rms_ratio", number_or_null(r.score.rms_ratio)}};
}

// --- a folder of cases

struct Tally {
  std::size_t right = 0;
  std::size_t of = 0;
};

std::string line_of(const Revealed& r) {
  return paragraph_after(fmt::format("{:<5} {:<14} {} ", r.score.right ? "right" : "WRONG", name_of(r.truth.kind),
                                     padded(std::filesystem::path(r.folder).filename().string(), 8)),
                         r.score.why);
}

Outcome summed_up(const std::vector<Revealed>& all) {
  std::map<std::string, Tally, std::less<>> kinds;
  Tally total;
  Json cases = Json::array(), by_kind = Json::object();
  std::string text;
  for (const Revealed& one : all) {
    for (Tally* tally : {&total, &kinds[std::string(name_of(one.truth.kind))]}) {
      ++tally->of;
      if (one.score.right) ++tally->right;
    }
    text += line_of(one);
    cases.push_back(case_json(one));
  }
  text += "\n";
  for (const auto& [kind, tally] : kinds) {
    text += fmt::format("{:<16} {:>4} of {} right\n", kind, tally.right, tally.of);
    by_kind[kind] = {{"right", tally.right}, {"of", tally.of}};
  }
  text += fmt::format("{:<16} {:>4} of {} right\n", "all", total.right, total.of);
  const bool right = total.right == total.of;
  return {text,
          one_line(Json{{"right", right},
                        {"right_cases", total.right},
                        {"of", total.of},
                        {"kinds", std::move(by_kind)},
                        {"cases", std::move(cases)}}),
          right ? kDone : kDoesNotHold};
}

Result<Outcome> reveal(VerbContext& context, const RevealRequest& request) {
  const auto folders = cases_in(request.folder);
  if (folders.empty())
    return tl::unexpected(
        Problem{ProblemKind::bad_input,
                "no hidden case: expected truth.sealed or truth.json in this folder or in its folders",
                request.folder,
                0,
                0,
                {}});
  if (folders.size() > 1 && !request.diagnosis.empty())
    return problem(ProblemKind::usage, "--diagnosis belongs to one case: name its folder");
  std::vector<Revealed> all;
  for (const std::string& folder : folders) {
    context.console.progress("cases", static_cast<double>(all.size()) / static_cast<double>(folders.size()), 0.0);
    ECS_TRY(one, revealed(context, folder, request, folders.size() == 1));
    all.push_back(std::move(one));
  }
  context.console.end_progress();
  if (all.size() > 1) return summed_up(all);
  return Outcome{case_text(all.front()), one_line(case_json(all.front())),
                 all.front().score.right ? kDone : kDoesNotHold};
}

}  // namespace

extern const std::vector<Action> kModelJudgement{
    action("model what-if", "the error that compensation would leave; predicted against achieved",
           "ecs model what-if model.toml before.csv --machine machine.toml --after measured_again.csv", what_if),
    action("model repair", "repair or compensate: what each cause leaves in readings, volume and circle",
           "ecs model repair model.toml data.csv --machine machine.toml", repair),
    action("model reveal", "what was hidden in a case, and whether the diagnosis found it",
           "ecs model reveal case7\n  ecs model reveal case7 --diagnosis answer.json", reveal)};

}  // namespace ecs::app
