#include "commissioning/models/answer_check.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/models/view.hpp"
#include "laser/map/csv.hpp"

namespace ecs::commissioning {
namespace {

using model::Candidate;
using model::Claim;

constexpr std::size_t kWidestName = 40;

/// Values of an object by key; the first that is missing or of another kind is the problem.
class AnswerReader {
 public:
  AnswerReader(const std::string& file, std::optional<Problem>& problem) : file_(file), problem_(problem) {}

  double number(const Json& object, const char* key) {
    const Json* value = of(object, key, "a number", [](const Json& one) { return one.is_number(); });
    return value ? value->get<double>() : 0.0;
  }
  std::optional<double> number_if_any(const Json& object, const char* key) {
    const Json* value =
        of(object, key, "a number or null", [](const Json& one) { return one.is_number() || one.is_null(); });
    return value && value->is_number() ? std::optional(value->get<double>()) : std::nullopt;
  }
  std::size_t count(const Json& object, const char* key) {
    const Json* value = of(object, key, "a count", [](const Json& one) { return one.is_number_unsigned(); });
    return value ? value->get<std::size_t>() : 0;
  }
  bool flag(const Json& object, const char* key) {
    const Json* value = of(object, key, "true or false", [](const Json& one) { return one.is_boolean(); });
    return value && value->get<bool>();
  }
  std::string word(const Json& object, const char* key) {
    const Json* value = of(object, key, "a text", [](const Json& one) { return one.is_string(); });
    return value ? value->get<std::string>() : std::string();
  }
  std::optional<std::string> word_if_any(const Json& object, const char* key) {
    const Json* value =
        of(object, key, "a text or null", [](const Json& one) { return one.is_string() || one.is_null(); });
    return value && value->is_string() ? std::optional(value->get<std::string>()) : std::nullopt;
  }
  Json list(const Json& object, const char* key) {
    const Json* value = of(object, key, "a list", [](const Json& one) { return one.is_array(); });
    return value ? *value : Json::array();
  }
  Json object(const Json& object, const char* key) {
    const Json* value = of(object, key, "an object", [](const Json& one) { return one.is_object(); });
    return value ? *value : Json::object();
  }
  void refuse(const std::string& why) {
    if (!problem_) problem_ = Problem{ProblemKind::bad_input, why, file_, 0, 0, {}};
  }

 private:
  template <class Is>
  const Json* of(const Json& object, const char* key, const char* expected, Is is) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    if (found != object.end() && is(*found)) return &*found;
    refuse(fmt::format("{}: expected {}, as written by `ecs model diagnose --json`", key, expected));
    return nullptr;
  }
  const std::string& file_;
  std::optional<Problem>& problem_;
};

Candidate candidate_in(const Json& object, AnswerReader& reader) {
  Candidate candidate;
  auto effect = object.is_object() ? effect_in(object) : std::nullopt;
  if (!effect) {
    reader.refuse("effect: expected one of the library, as written by `ecs model diagnose --json`");
    return candidate;
  }
  candidate.effect = std::move(*effect);
  candidate.named = reader.flag(object, "named");
  const auto standing = object.find("standing");  // answers of former programs have none
  if (standing != object.end() && *standing == Json(model::name_of(model::Standing::likely)))
    candidate.standing = model::Standing::likely;
  candidate.found = reader.flag(object, "found");
  candidate.rms_after_um = reader.number(object, "rms_after_um");
  candidate.explained = reader.number(object, "explained");
  candidate.explainable_share = reader.number(object, "explainable_share");
  candidate.e_value = reader.number_if_any(object, "e_value");
  candidate.held_out_rms_um = reader.number_if_any(object, "held_out_rms_um");
  candidate.held_out_rms_before_um = reader.number_if_any(object, "held_out_rms_before_um");
  const Json tried_at = reader.object(object, "tried_at");
  candidate.tried_at.value = reader.number(tried_at, "value");
  for (const Json& one : reader.list(tried_at, "coefficients"))
    candidate.tried_at.coefficients.push_back(reader.count(Json{{"coefficients", one}}, "coefficients"));
  if (object.contains("apart")) candidate.apart = reader.word(object, "apart");
  const Json parameters = reader.object(object, "parameters");
  for (const auto& [name, value] : parameters.items())
    if (value.is_number())
      candidate.parameters.push_back(
          {model::library_name(name, candidate.effect), "", value.get<double>(), {}, false, false});
  return candidate;
}

Claim claim_in(const Json& object, AnswerReader& reader) {
  Claim claim;
  claim.observations = reader.count(object, "observations");
  claim.rms_um = reader.number(object, "rms_um");
  claim.rms_after_um = reader.number(object, "rms_after_um");
  claim.candidates_tried = reader.count(object, "candidates_tried");
  claim.plain = reader.flag(object, "plain");
  for (const Json& one : reader.list(object, "own_terms"))
    claim.own_terms.push_back({reader.count(one, "effect"), reader.number(one, "value")});
  if (object.contains("apart"))
    for (const Json& one : reader.list(object, "apart"))
      claim.apart.push_back(reader.word(Json{{"apart", one}}, "apart"));
  for (const Json& one : reader.list(object, "candidates")) claim.candidates.push_back(candidate_in(one, reader));
  return claim;
}

/// Everything of an answer that a check reads.
struct KeptAnswer {
  Claim claim;
  std::string data_sha256;
  model::Model model;
  std::optional<params::Machine> machine;
};

Result<KeptAnswer> read_kept_answer(const std::string& file) {
  ECS_TRY(text, read_file(file));
  const Json object = Json::parse(text, nullptr, false);
  std::optional<Problem> problem;
  AnswerReader reader(file, problem);
  if (!object.is_object()) reader.refuse("expected one JSON object, as written by `ecs model diagnose --json`");
  KeptAnswer kept;
  kept.claim = claim_in(object, reader);
  kept.data_sha256 = reader.word(object, "data_sha256");
  const std::string model_text = reader.word(object, "model");
  const auto map_text = reader.word_if_any(object, "map"), machine_text = reader.word_if_any(object, "machine");
  if (problem) return tl::unexpected(std::move(*problem));
  ECS_TRY(model, model::parse_model(model_text, file + ": model", {}));
  kept.model = std::move(model);
  if (map_text) {
    ECS_TRY(map, laser::parse_map_csv(*map_text, file + ": map"));
    kept.model.map = std::move(map);
  }
  if (machine_text) {
    ECS_TRY(machine, params::parse_machine(*machine_text, file + ": machine"));
    kept.machine = std::move(machine.machine);
  }
  return kept;
}

std::string shown(const std::optional<double>& value) { return value ? fmt::format("{:.6g}", *value) : "-"; }

}  // namespace

Result<void> add_check_inputs(Cell& answer, const ModelArguments& arguments, const ModelWork& work, bool plain) {
  Json machine;
  if (!arguments.machine.empty()) {
    ECS_TRY(text, read_file(arguments.machine));
    machine = text;
  }
  model::Model model = work.model;
  model.map_file.clear();
  model.history.clear();
  answer.json["data_sha256"] = work.data_sha256;
  answer.json["plain"] = plain;
  answer.json["model"] = to_toml(model);
  answer.json["map"] = work.model.map ? Json(laser::to_map_csv(*work.model.map)) : Json();
  answer.json["machine"] = machine;
  return {};
}

Result<model::Check> check_answer(MessageSink& messages, const std::string& answer_file,
                                  const std::vector<std::string>& data, const std::string& machine,
                                  const ImportArguments& import) {
  ECS_TRY(kept, read_kept_answer(answer_file));
  std::string hash;
  ECS_TRY(set, measured_in(messages, data, import, &hash));
  if (hash != kept.data_sha256)
    return problem(ProblemKind::bad_input, "expected the data of {} in the same order, SHA-256 {}, got {}", answer_file,
                   kept.data_sha256, hash);
  if (!machine.empty()) {
    ECS_TRY(other, machine_in(messages, machine));
    kept.machine = std::move(other);
  }
  return model::checked(kept.model, model::observations_of(set, kept.model, kept.machine), kept.claim);
}

Cell check_cell(const model::Check& check) {
  Cell numbers{Json::array(), {}};
  for (const model::CheckedNumber& one : check.numbers)
    numbers.add(
        record_cell("{name} {claimed:>14} {recomputed:>14}  {holds}\n",
                    "name"_is(one.name, padded(one.name, kWidestName)), "claimed"_is(one.claimed, shown(one.claimed)),
                    "recomputed"_is(one.recomputed, shown(one.recomputed)), "holds"_is(one.holds, "holds", "DIFFERS")));
  std::string objections;
  for (const std::string& one : check.objections) objections += paragraph(one, 0, 2);
  const bool has_effects = std::ranges::any_of(
      check.numbers, [](const model::CheckedNumber& one) { return one.name.ends_with("explainable_share"); });
  const std::string meanings = paragraph(
      "explained: the share of the mean square of the residual that the effect removes; explainable_share: the same of "
      "the part above the noise; e_value: how much more probable held-out readings are with the effect than without it",
      0, 2);
  const bool holds = check.holds();
  return record_cell("{holds}\n" + fmt::format("{:<{}} {:>14} {:>14}\n", "", kWidestName, "claimed", "recomputed") +
                         "{checked}{meanings}{objections}",
                     "holds"_is(holds, "The answer holds.", "The answer does not hold."), "checked"_is(numbers),
                     "meanings"_shown(has_effects ? meanings : ""), "objections"_is(check.objections, objections));
}

}  // namespace ecs::commissioning
