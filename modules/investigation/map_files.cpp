#include "modules/investigation/map_files.hpp"

#include <chrono>

#include <fmt/format.h>

#include "commissioning/maps/from_model.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/unit/status.hpp"
#include "commissioning/unit/utility_work.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::chrono::milliseconds kPoll{100};
constexpr const char* kNotInvestigated = "not part of the model that was investigated";

/// Components of the machine that the map of the model does not hold.
std::vector<std::string> declared_zero(const MapFromModel& built, const params::Machine& machine) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < kComponents; ++i) {
    const auto component = static_cast<Component>(i);
    const auto moving = axis_of(name_of(component).back());
    if (moving && machine.axes[index_of(*moving)] && !built.effects.contains(component))
      words.push_back(fmt::format("{}={}", name_of(component), kNotInvestigated));
  }
  return words;
}

}  // namespace

Result<ModelMapFiles> write_map_files(MessageSink& messages, const model::Model& model, const MapSources& sources,
                                      const std::filesystem::path& folder) {
  const ModelMapFiles files{folder / "model.toml", folder / "map.csv", folder / "parameters.toml"};
  ECS_DO(model::write_model(files.model, model));
  ECS_TRY(machine, machine_in(messages, sources.machine));
  FromModelArguments arguments;
  arguments.model = files.model;
  arguments.machine = sources.machine;
  arguments.params = sources.params;
  NoMessages silent;
  ECS_TRY(first, map_from_model(silent, arguments));
  arguments.zero = declared_zero(first, *machine);
  arguments.output = files.map;
  arguments.params_out = files.params;
  ECS_DO(map_from_model(messages, arguments));
  return files;
}

Result<void> send_map_files(protocol::UnitClient& client, const ModelMapFiles& files) {
  ECS_TRY(map, prepared_map(files.map, files.params));
  ECS_TRY(status, client.status());
  if (status.mode != UnitMode::integration) ECS_DO(client.enter_integration());
  ECS_DO(send_map(client, map, files.map, false));
  return begin_compensation(client);
}

Result<void> wait_for_compensation(protocol::UnitClient& client, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    ECS_TRY(status, client.status());
    if (status.mode == UnitMode::compensating) return {};
    if (status.fault != Fault::none) return problem(ProblemKind::link, fault_sentence(status));
    if (status.mode == UnitMode::integration)
      return problem(ProblemKind::link, "the unit went back to integration mode");
    if (std::chrono::steady_clock::now() >= end)
      return problem(ProblemKind::link, "the unit does not compensate: not every axis has been referenced");
    if (!client.link().pause(kPoll)) return problem(ProblemKind::link, "stopped while the axes were being referenced");
  }
}

}  // namespace ecs::commissioning
