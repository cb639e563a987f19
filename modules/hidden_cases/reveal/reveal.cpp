// `ecs model reveal`: opens what was hidden in a case, and scores the diagnosis, of one case or a folder of them. What
// the module brings to `ecs`.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/module.hpp"
#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/sealed.hpp"
#include "base/text.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/models/work.hpp"

namespace ecs::app {
namespace {

/// One hidden effect. Text parts are empty, the approach absent, where the truth does not give them.
struct HiddenEffect {
  std::string name;  ///< "cyclic:X:EX"
  std::optional<model::ApproachMode> approach;
  std::string sensor, sensor2;
  std::map<std::string, double> parameters;
  double rms_um = 0.0, snr = 0.0;
};

constexpr std::array<std::string_view, 5> kKinds{"blank", "single", "pair", "out_of_library", "confounded"};

struct HiddenTruth {
  std::string kind;  ///< one of kKinds
  double noise_um = 0.0;
  std::vector<HiddenEffect> effects;
  std::vector<std::string> group;      ///< of a confounded case
  std::vector<std::string> variables;  ///< of structure outside the library
  double true_model_rms_um = 0.0;      ///< 0: not known
  Json json;                           ///< as the file has it; `text` names its sizes in words
};

/// A candidate as a diagnosis tells it.
struct FoundEffect {
  model::EffectInstance effect;
  bool named = true;               ///< or likely
  std::vector<std::string> group;  ///< indistinguishable_from
  std::map<std::string, double> parameters, sigma;
};
struct FoundAnswer {
  std::string verdict;
  std::vector<FoundEffect> candidates;
  std::vector<std::string> where;
  std::optional<double> rms_after_um;
};

struct Judged {
  bool right = false;
  std::string why;  ///< in words
};

struct Revealed {
  std::string folder;
  HiddenTruth truth;
  FoundAnswer answer;
  Judged judged;
};

// --- the truth and the answer, read

Problem not_of_form(const std::string& file, const std::string& why) {
  return {ProblemKind::bad_input, why, file, 0, 0, {}};
}

Result<Json> object_in(std::string_view text, const std::string& file) {
  Json object = Json::parse(text, nullptr, false);
  if (object.is_object()) return object;
  return tl::unexpected(not_of_form(file, "expected one JSON object"));
}

Json list_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_array() ? *found : Json::array();
}

std::vector<std::string> words_at(const Json& object, const char* key) {
  std::vector<std::string> list;
  for (const Json& one : list_at(object, key))
    if (one.is_string()) list.push_back(one.get<std::string>());
  return list;
}

std::map<std::string, double> numbers_at(const Json& object, const char* key) {
  std::map<std::string, double> values;
  if (const auto found = object.find(key); found != object.end() && found->is_object())
    for (const auto& [name, value] : found->items())
      if (value.is_number()) values[name] = value.get<double>();
  return values;
}

HiddenEffect hidden_effect(const Json& object) {
  HiddenEffect effect{.name = text_at(object, "name"),
                      .approach = model::approach_mode_named(text_at(object, "approach")),
                      .sensor = text_at(object, "sensor"),
                      .sensor2 = text_at(object, "sensor2"),
                      .parameters = numbers_at(object, "parameters"),
                      .rms_um = number_at(object, "rms_um").value_or(0.0),
                      .snr = number_at(object, "snr").value_or(0.0)};
  if (const auto place = effect_in(object); place && effect.name.empty()) effect.name = to_text(*place);
  return effect;
}

/// "amplitude_um 11.1" of an effect as "amplitude 11.1 um".
std::string with_spoken_names(std::string text, const Json& object) {
  const auto effect = effect_in(object);
  if (!effect) return text;
  for (const model::ParameterDefinition& parameter : effect->definition().parameters) {
    const std::string name = shown_name(parameter.name, *effect), unit = unit_of(*effect, parameter);
    const std::string words = model::spoken_name(name, unit);
    for (const std::string_view before : {"(", ", "}) {
      const std::string written = fmt::format("{}{} ", before, name);
      const std::size_t at = text.find(written), end = text.find_first_of(",)", at + written.size());
      if (at == std::string::npos || end == std::string::npos) continue;
      const std::string value = text.substr(at + written.size(), end - at - written.size());
      text.replace(
          at, end - at,
          fmt::format("{}{}{}{}{}{}", before, words, words.empty() ? "" : " ", value, unit.empty() ? "" : " ", unit));
    }
  }
  return text;
}

Result<HiddenTruth> truth_in(const std::string& text, const std::string& file) {
  ECS_TRY(object, object_in(text, file));
  HiddenTruth truth{.kind = text_at(object, "kind"),
                    .noise_um = number_at(object, "noise_um").value_or(0.0),
                    .effects = {},
                    .group = words_at(object, "group"),
                    .variables = words_at(object, "variables"),
                    .true_model_rms_um = number_at(object, "true_model_rms_um").value_or(0.0),
                    .json = object};
  if (std::find(kKinds.begin(), kKinds.end(), truth.kind) == kKinds.end())
    return tl::unexpected(
        not_of_form(file, fmt::format("kind: expected {}, got \"{}\"", fmt::join(kKinds, ", "), truth.kind)));
  for (const Json& one : list_at(object, "effects")) {
    truth.effects.push_back(hidden_effect(one));
    if (!text_at(object, "text").empty()) truth.json["text"] = with_spoken_names(text_at(truth.json, "text"), one);
  }
  const std::size_t needed = truth.kind == "single" ? 1 : truth.kind == "pair" ? 2 : 0;
  if (truth.effects.size() < needed)
    return tl::unexpected(
        not_of_form(file, fmt::format("effects: expected {}, found {}", needed, truth.effects.size())));
  if (truth.kind == "confounded" && truth.group.empty())
    return tl::unexpected(not_of_form(file, "group: expected the effects that do the same, found none"));
  return truth;
}

std::string inside(const std::string& folder, const char* name) {
  return (std::filesystem::path(folder) / name).string();
}

/// @pre is_case(folder)
Result<HiddenTruth> truth_of(const std::string& folder) {
  const bool is_sealed = disc::exists(inside(folder, "truth.sealed"));
  const std::string file = inside(folder, is_sealed ? "truth.sealed" : "truth.json");
  ECS_TRY(text, read_file(file));
  if (!is_sealed) return truth_in(text, file);
  ECS_TRY(opened, unsealed(text, file));
  return truth_in(opened, file);
}

/// @param text  the JSON of `ecs model diagnose --json` (docs/verbs.md) @param file  as problems name it
Result<FoundAnswer> answer_in(std::string_view text, const std::string& file) {
  ECS_TRY(object, object_in(text, file));
  FoundAnswer answer{.verdict = text_at(object, "verdict"),
                     .candidates = {},
                     .where = {},
                     .rms_after_um = number_at(object, "rms_after_um")};
  if (answer.verdict.empty())
    return tl::unexpected(not_of_form(file, "expected the JSON of `ecs model diagnose --json`, found no verdict"));
  const Json candidates = list_at(object, "candidates");
  for (const Json& one : candidates) {
    const auto effect = one.is_object() ? effect_in(one) : std::nullopt;
    if (!effect) return tl::unexpected(not_of_form(file, "candidates: expected effects of the library"));
    const auto named = one.find("named");
    const bool likely = text_at(one, "standing") == "likely";
    answer.candidates.push_back({*effect, likely || named == one.end() || !named->is_boolean() || named->get<bool>(),
                                 words_at(one, "indistinguishable_from"), numbers_at(one, "parameters"),
                                 numbers_at(one, "sigma")});
  }
  for (const Json& one : list_at(object, "where"))
    if (one.is_object()) answer.where.push_back(text_at(one, "variable"));
  if (!answer.rms_after_um && !candidates.empty()) answer.rms_after_um = number_at(candidates.front(), "rms_after_um");
  return answer;
}

// --- right or wrong

/// What the truth says of approach and sensor agrees with the candidate.
bool details_agree(const HiddenEffect& hidden, const FoundEffect& found) {
  if (hidden.approach && *hidden.approach != found.effect.approach) return false;
  if (hidden.sensor2.empty()) return hidden.sensor.empty() || hidden.sensor == found.effect.sensor;
  const std::set<std::string> pair{found.effect.sensor, found.effect.sensor2};  // the sign is in the coefficient
  return pair == std::set<std::string>{hidden.sensor, hidden.sensor2};
}

bool lists(const FoundEffect& found, const std::string& name) {
  return std::find(found.group.begin(), found.group.end(), name) != found.group.end();
}

bool is_answer(const HiddenEffect& hidden, const FoundEffect& found) {
  return (to_text(found.effect) == hidden.name && details_agree(hidden, found)) || lists(found, hidden.name);
}

bool named_somewhere(const HiddenEffect& hidden, const FoundAnswer& answer) {
  return std::any_of(answer.candidates.begin(), answer.candidates.end(),
                     [&](const FoundEffect& one) { return one.named && is_answer(hidden, one); });
}

/// As other verbs state it: "the residual is more than noise".
std::string verdict_in_words(const FoundAnswer& answer) {
  using model::Verdict;
  for (const Verdict one : {Verdict::adequate, Verdict::missing_effect, Verdict::partly_explained,
                            Verdict::unexplained_structure, Verdict::likely_effect, Verdict::cannot_tell})
    if (name_of(one) == answer.verdict) return std::string(title_of(one));
  return answer.verdict;
}

std::string first_name(const FoundAnswer& answer) {
  return answer.candidates.empty() ? "nothing" : to_text(answer.candidates.front().effect);
}

/// What is named, or likely, leaves noise or is the first thought.
bool says_all(const FoundAnswer& answer) {
  return answer.verdict == "missing_effect" || answer.verdict == "likely_effect";
}

Judged judged_single(const HiddenTruth& truth, const FoundAnswer& answer) {
  const HiddenEffect& hidden = truth.effects.front();
  if (!says_all(answer) || answer.candidates.empty())
    return {false,
            fmt::format("{} {} (verdict: {})", hidden.name,
                        named_somewhere(hidden, answer) ? "is listed only as a possibility, not named as the cause"
                                                        : "was not named",
                        verdict_in_words(answer))};
  const FoundEffect& first = answer.candidates.front();
  if (lists(first, hidden.name) && to_text(first.effect) != hidden.name)
    return {true, fmt::format("{} is named as a rival of {}", hidden.name, to_text(first.effect))};
  if (is_answer(hidden, first)) return {true, hidden.name + " is named first"};
  if (to_text(first.effect) == hidden.name) {
    const bool other_approach = hidden.approach && *hidden.approach != first.effect.approach;
    return {false, fmt::format("{} is named, but with the wrong {}: {}", hidden.name,
                               other_approach ? "approach" : "sensor", place_text(first.effect))};
  }
  return {false, fmt::format("{} was hidden, {} is named first", hidden.name, to_text(first.effect))};
}

Judged judged_pair(const HiddenTruth& truth, const FoundAnswer& answer) {
  std::vector<std::string> missed;
  for (const HiddenEffect& hidden : truth.effects)
    if (!named_somewhere(hidden, answer)) missed.push_back(hidden.name);
  if (!says_all(answer)) return {false, "verdict: " + verdict_in_words(answer)};
  if (missed.empty()) return {true, "both are named"};
  return {false, fmt::format("not named: {}", fmt::join(missed, ", "))};
}

Judged judged_confounded(const HiddenTruth& truth, const FoundAnswer& answer) {
  if (answer.candidates.empty()) return {false, "nothing is named (verdict: " + verdict_in_words(answer) + ")"};
  std::vector<std::string> found = answer.candidates.front().group, wanted = truth.group;
  found.push_back(first_name(answer));
  for (auto* names : {&found, &wanted}) {
    std::sort(names->begin(), names->end());
    names->erase(std::unique(names->begin(), names->end()), names->end());
  }
  if (found == wanted) return {true, fmt::format("the whole group and nothing else: {}", fmt::join(wanted, ", "))};
  return {false, fmt::format("the group is {}, named are {}", fmt::join(wanted, ", "), fmt::join(found, ", "))};
}

/// blank: verdict adequate. single: missing_effect or likely_effect, and the first candidate is the effect or lists it.
/// pair: both among the named candidates or in their groups. out_of_library: unexplained_structure. confounded: the
/// first candidate with its group is exactly the group. Approach and sensor must agree where the truth gives one.
Judged judged(const HiddenTruth& truth, const FoundAnswer& answer) {
  if (truth.kind == "single") return judged_single(truth, answer);
  if (truth.kind == "pair") return judged_pair(truth, answer);
  if (truth.kind == "confounded") return judged_confounded(truth, answer);
  const bool blank = truth.kind == "blank";
  if (answer.verdict == (blank ? "adequate" : "unexplained_structure"))
    return {true, blank ? "nothing hidden and nothing named" : "structure outside the library is reported as such"};
  return {false,
          fmt::format("{}, but the verdict is: {} ({})", blank ? "nothing was hidden" : "structure outside the library",
                      verdict_in_words(answer), first_name(answer))};
}

/// Phases count modulo one turn: within half a turn of zero, as a diagnosis states them.
double without_turns(const std::string& name, double value) {
  return name.ends_with("_rad") ? std::remainder(value, 2.0 * std::numbers::pi) : value;
}

double nearest_value(const std::string& name, double found, double hidden) {
  return name.ends_with("_rad") ? hidden + without_turns(name, found - hidden) : found;
}

/// The numbers of an effect that was hidden beside those found.
void add_scores(Cell& list, const HiddenEffect& hidden, const FoundEffect& found) {
  // The other order of a pair of sensors turns the sign of their difference.
  const double sign = !hidden.sensor2.empty() && hidden.sensor != found.effect.sensor ? -1.0 : 1.0;
  for (const auto& [name, stated] : hidden.parameters) {
    const auto estimate = found.parameters.find(name);
    if (estimate == found.parameters.end()) continue;
    const double truth = without_turns(name, stated);
    const double value = nearest_value(name, sign * estimate->second, truth);
    const auto given = found.sigma.find(name);
    const auto sigma = given != found.sigma.end() ? std::optional(given->second) : std::nullopt;
    const auto off = sigma && *sigma > 0.0 ? std::optional((value - truth) / *sigma) : std::nullopt;
    list.add(record_cell("{name:<32} {truth:>12} {found:>12} {sigma:>10} {sigmas_off:>11}\n", "effect"_is(hidden.name),
                         "name"_is(name, fmt::format("{} {}", hidden.name, name)),
                         "truth"_is(truth, few_digits(truth, 5)), "found"_is(value, few_digits(value, 5)),
                         "sigma"_is(sigma, sigma ? few_digits(*sigma, 2) : "-"),
                         "sigmas_off"_is(off, off ? fmt::format("{:+.1f}", *off) : "-")));
  }
}

Cell scores_cell(const Revealed& r) {
  Cell list{Json::array(),
            fmt::format("sigma: standard uncertainty that the diagnosis states; -: none, because the\nvalue was fixed "
                        "or the readings do not determine it (for example the position of a step between two "
                        "targets)\n{:<32} {:>12} {:>12} "
                        "{:>10} {:>11}\n",
                        "parameter", "hidden", "found", "sigma", "sigmas off")};
  for (const HiddenEffect& hidden : r.truth.effects)
    for (const FoundEffect& found : r.answer.candidates)
      if (found.named && to_text(found.effect) == hidden.name && details_agree(hidden, found))
        add_scores(list, hidden, found);
  const bool turned = std::ranges::any_of(r.truth.effects, [](const HiddenEffect& hidden) {
    return std::ranges::any_of(hidden.parameters,
                               [](const auto& one) { return without_turns(one.first, one.second) != one.second; });
  });
  if (turned && !list.json.empty())
    list.text += paragraph(
        "amplitude2, phase2: second harmonic. A phase is listed within half a turn of zero: 2 pi rad more is the same "
        "phase.",
        0, 2);
  return list;
}

/// rms after ÷ rms of the true model
std::optional<double> rms_ratio(const Revealed& r) {
  if (!(r.truth.true_model_rms_um > 0.0) || !r.answer.rms_after_um) return std::nullopt;
  return *r.answer.rms_after_um / r.truth.true_model_rms_um;
}

// --- one case

std::string hidden_text(const HiddenTruth& truth) {
  std::string said = text_at(truth.json, "text");
  if (said.empty()) said = truth.kind;
  std::string text = paragraph(said.starts_with("Hidden: ") ? said : "Hidden: " + said, 0, 2);
  for (const HiddenEffect& effect : truth.effects)
    text += fmt::format(
        "  {} adds {:.3f} um rms over all readings, including those on which it does not act.\n"
        "  Once the initial model has been fitted, {:.3f} um rms of it remains, {:.1f} times the noise of {:.3f} um\n",
        effect.name, effect.rms_um, effect.snr * truth.noise_um, effect.snr, truth.noise_um);
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
  const bool unexplained = answer.verdict == "unexplained_structure";
  std::string text = "Found: ";
  if (unexplained || names.empty()) text += verdict_in_words(answer) + (names.empty() ? "" : ": ");
  text += fmt::format("{}", fmt::join(names, "; "));
  if (unexplained && !answer.where.empty()) text += fmt::format("; it depends on {}", fmt::join(answer.where, ", "));
  return paragraph(text, 0, 2);
}

std::string case_text(const Revealed& r) {
  std::string text = hidden_text(r.truth) + found_text(r.answer);
  if (const Cell scores = scores_cell(r); !scores.json.empty()) text += "\n" + scores.text;
  text += "\n";
  text += paragraph(fmt::format("{}: {}", r.judged.right ? "RIGHT" : "WRONG", r.judged.why), 0, 2);
  if (const auto ratio = rms_ratio(r))
    text += fmt::format("rms after adding the named effects: {:.3f} times that of the true model\n", *ratio);
  return text;
}

Json case_json(const Revealed& r) {
  return object_of(
      "case"_is(r.folder), "kind"_is(r.truth.kind), "right"_is(r.judged.right), "why"_is(r.judged.why),
      "truth"_is(r.truth.json), "found"_is(found_names(r.answer)), "verdict"_is(r.answer.verdict),
      "where"_is(r.answer.where), "parameters"_is(scores_cell(r).json), "rms_after_um"_is(r.answer.rms_after_um),
      "true_model_rms_um"_is(r.truth.true_model_rms_um > 0.0 ? Json(r.truth.true_model_rms_um) : Json(nullptr)),
      "rms_ratio"_is(rms_ratio(r)));
}

// --- a folder of cases

struct Tally {
  std::size_t right = 0;
  std::size_t of = 0;
};

std::string line_of(const Revealed& r) {
  return paragraph_after(fmt::format("{:<5} {:<14} {} ", r.judged.right ? "right" : "WRONG", r.truth.kind,
                                     padded(std::filesystem::path(r.folder).filename().string(), 8)),
                         r.judged.why);
}

Outcome summed_up(const std::vector<Revealed>& all) {
  std::map<std::string, Tally, std::less<>> kinds;
  Tally total;
  Json cases = Json::array(), by_kind = Json::object();
  std::string text;
  for (const Revealed& one : all) {
    for (Tally* tally : {&total, &kinds[one.truth.kind]}) {
      ++tally->of;
      if (one.judged.right) ++tally->right;
    }
    text += line_of(one);
    cases.push_back(case_json(one));
  }
  text += "\n";
  for (const auto& [kind, tally] : kinds) {
    text += fmt::format("{:<16} {:>4} of {} right\n", kind, tally.right, tally.of);
    by_kind[kind] = object_of("right"_is(tally.right), "of"_is(tally.of));
  }
  text += fmt::format("{:<16} {:>4} of {} right\n", "all", total.right, total.of);
  const bool right = total.right == total.of;
  return {text,
          one_line(object_of("right"_is(right), "right_cases"_is(total.right), "of"_is(total.of),
                             "kinds"_is(std::move(by_kind)), "cases"_is(std::move(cases)))),
          right ? kDone : kDoesNotHold};
}

// --- the verb

struct RevealRequest {
  std::string folder, diagnosis, machine;
  int blanks = static_cast<int>(model::DiagnoseOptions{}.noise_replicates);
  static Fields<RevealRequest> fields() {
    using R = RevealRequest;
    return {{"DIR", &R::folder, "a case made by `ecs-emulator hide`, or a folder of such cases", Need::required},
            {"--diagnosis", &R::diagnosis,
             "saved JSON of `ecs model diagnose --json`; if not given, the diagnosis is made now"},
            {"--blanks", &R::blanks, "number of simulated noise-only data sets, as for `ecs model diagnose`",
             Range{50, 20'000}},
            {"--machine", &R::machine, "machine file to use instead of machine.toml of the case"}};
  }
};

bool is_case(const std::string& folder) {
  return disc::exists(inside(folder, "truth.sealed")) || disc::exists(inside(folder, "truth.json"));
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

/// A case that cannot be diagnosed counts as wrong among others.
Result<Revealed> revealed(VerbContext& context, const std::string& folder, const RevealRequest& request, bool alone) {
  ECS_TRY(truth, truth_of(folder));
  auto answer = answer_of(context, folder, request);
  if (!answer && alone) return tl::unexpected(answer.error());
  if (!answer) return Revealed{folder, std::move(truth), {}, {false, to_text(answer.error())}};
  Judged score = judged(truth, *answer);
  return Revealed{folder, std::move(truth), std::move(*answer), std::move(score)};
}

Result<Outcome> reveal(VerbContext& context, const RevealRequest& request) {
  const auto folders = cases_in(request.folder);
  if (folders.empty())
    return tl::unexpected(
        Problem{ProblemKind::bad_input,
                "not a hidden case: expected truth.sealed or truth.json in this folder or its subfolders",
                request.folder,
                0,
                0,
                {}});
  if (folders.size() > 1 && !request.diagnosis.empty())
    return problem(ProblemKind::usage, "--diagnosis applies to one case: give its folder");
  std::vector<Revealed> all;
  for (const std::string& folder : folders) {
    context.console.progress("cases", static_cast<double>(all.size()) / static_cast<double>(folders.size()), 0.0);
    ECS_TRY(one, revealed(context, folder, request, folders.size() == 1));
    all.push_back(std::move(one));
  }
  context.console.end_progress();
  if (all.size() > 1) return summed_up(all);
  return Outcome{case_text(all.front()), one_line(case_json(all.front())),
                 all.front().judged.right ? kDone : kDoesNotHold};
}

const std::vector<Action> kReveal{action(
    "model reveal", "show the effect hidden in a case made by `ecs-emulator hide`, and whether the diagnosis found it",
    "ecs model reveal case7\n  ecs model reveal case7 --diagnosis answer.json", reveal)};

}  // namespace

const Module& hidden_cases_module() {
  static const Module module{.verbs = {{"model", &kReveal}}};
  return module;
}

}  // namespace ecs::app
