// Readers of the folders that `ecs-emulator hide` writes.
#include "diagnose_case.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "base/sealed.hpp"
#include "model/effects/definition.hpp"

namespace ecs::bench {
namespace {

using nlohmann::json;

constexpr std::array<std::string_view, 5> kKinds{"single", "pair", "blank", "out_of_library", "confounded"};

std::string word(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

double number(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : 0.0;
}

std::vector<std::string> words(const json& object, const char* key) {
  std::vector<std::string> list;
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array()) return list;
  for (const json& each : *found)
    if (each.is_string()) list.push_back(each.get<std::string>());
  return list;
}

HiddenEffect effect_of(const json& object) {
  HiddenEffect effect;
  effect.name = word(object, "name");
  if (word(object, "effect") == "measurement_line" && !word(object, "sense").empty())  // whoever names it by its code
    effect.name = "measurement_line:" + word(object, "axis") + ":" + word(object, "sense");
  effect.approach = word(object, "approach");
  effect.sensor = word(object, "sensor");
  effect.snr = number(object, "snr");
  const auto parameters = object.find("parameters");
  if (parameters != object.end() && parameters->is_object())
    for (const auto& [name, value] : parameters->items())
      if (value.is_number()) effect.parameters[name] = value.get<double>();
  return effect;
}

Result<std::string> truth_text(const std::filesystem::path& folder) {
  const std::filesystem::path plain = folder / "truth.json", sealed = folder / "truth.sealed";
  if (std::filesystem::exists(plain)) return read_file(plain);
  ECS_TRY(text, read_file(sealed));
  return unsealed(text, sealed.string());
}

Truth truth_of(const json& object) {
  Truth truth;
  const auto effects = object.find("effects");
  if (effects != object.end() && effects->is_array())
    for (const json& each : *effects) truth.effects.push_back(effect_of(each));
  truth.group = words(object, "group");
  truth.group_optional = words(object, "group_optional");
  truth.variables = words(object, "variables");
  truth.text = word(object, "text");
  truth.noise_law = word(object, "noise_law");
  truth.noise_um = number(object, "noise_um");
  truth.true_model_rms_um = number(object, "true_model_rms_um");
  truth.snr = number(object, "snr");
  for (const HiddenEffect& effect : truth.effects)
    truth.snr = truth.snr > 0.0 ? std::min(truth.snr, effect.snr) : effect.snr;
  return truth;
}

}  // namespace

std::string_view name_of(CaseKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

std::vector<std::string> free_in_base(const Case& one) {
  constexpr std::array<std::string_view, 4> kCounted{"cyclic", "progressive", "warm_up", "reversal_spike"};
  std::vector<std::string> found;
  for (const std::string_view id : kCounted)
    if (std::any_of(one.model.effects.begin(), one.model.effects.end(), [id](const model::EffectInstance& effect) {
          const std::string searched(effect.definition().searched_parameter());
          return effect.definition().id == id && (searched.empty() || !effect.parameters.contains(searched));
        }))
      found.emplace_back(id);
  return found;
}

std::vector<std::filesystem::path> case_folders(const std::filesystem::path& root) {
  std::vector<std::filesystem::path> folders;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root))
    if (entry.path().filename() == "data.csv") folders.push_back(entry.path().parent_path());
  std::sort(folders.begin(), folders.end());
  return folders;
}

Result<Case> read_case(const std::filesystem::path& folder) {
  ECS_TRY(machine, params::read_machine(folder / "machine.toml"));
  ECS_TRY(model, model::read_model(folder / "model.toml"));
  ECS_TRY(data, laser::read_measurement_set(folder / "data.csv"));
  ECS_TRY(text, truth_text(folder));
  const json truth = json::parse(text, nullptr, false);
  const auto kind = std::find(kKinds.begin(), kKinds.end(), truth.is_object() ? word(truth, "kind") : "");
  if (kind == kKinds.end())
    return problem(ProblemKind::bad_input,
                   fmt::format("{}: the truth has no kind, one of {}", folder.string(), fmt::join(kKinds, ", ")));
  Case one;
  one.kind = static_cast<CaseKind>(kind - kKinds.begin());
  one.machine = std::move(machine.machine);
  one.model = std::move(model);
  one.data = std::move(data);
  one.truth = truth_of(truth);
  std::vector<std::string> names;
  for (const HiddenEffect& effect : one.truth.effects) names.push_back(effect.name);
  one.name = names.empty() ? std::string(name_of(one.kind)) : fmt::format("{}", fmt::join(names, " + "));
  return one;
}

}  // namespace ecs::bench
