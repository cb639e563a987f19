#include "commissioning/investigation/map_files.hpp"

#include <chrono>

#include <fmt/format.h>

#include "commissioning/maps/from_model.hpp"
#include "commissioning/maps/prepared_map.hpp"
#include "commissioning/maps/sent.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/unit/status_view.hpp"
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
  if (const auto written = model::write_model(files.model, model); !written) return tl::unexpected(written.error());
  const auto machine = machine_in(messages, sources.machine);
  if (!machine) return tl::unexpected(machine.error());
  FromModelArguments arguments;
  arguments.model = files.model;
  arguments.machine = sources.machine;
  arguments.params = sources.params;
  NoMessages silent;
  const auto first = map_from_model(silent, arguments);
  if (!first) return tl::unexpected(first.error());
  arguments.zero = declared_zero(*first, **machine);
  arguments.output = files.map;
  arguments.params_out = files.params;
  const auto built = map_from_model(messages, arguments);
  if (!built) return tl::unexpected(built.error());
  return files;
}

Result<void> send_map_files(protocol::UnitClient& client, const ModelMapFiles& files) {
  const auto map = prepared_map(files.map, files.params);
  if (!map) return tl::unexpected(map.error());
  const auto status = client.status();
  if (!status) return tl::unexpected(status.error());
  if (status->mode != UnitMode::integration)
    if (const auto open = client.enter_integration(); !open) return tl::unexpected(open.error());
  const auto sent = send_map(client, *map, files.map, false);
  if (!sent) return tl::unexpected(sent.error());
  return begin_compensation(client);
}

Result<void> wait_for_compensation(protocol::UnitClient& client, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    const auto status = client.status();
    if (!status) return tl::unexpected(status.error());
    if (status->mode == UnitMode::compensating) return {};
    if (status->fault != Fault::none) return problem(ProblemKind::link, fault_sentence(*status));
    if (status->mode == UnitMode::integration)
      return problem(ProblemKind::link, "the unit went back to integration mode");
    if (std::chrono::steady_clock::now() >= end)
      return problem(ProblemKind::link, "the unit does not compensate: not every axis has been referenced");
    if (!client.link().pause(kPoll)) return problem(ProblemKind::link, "stopped while the axes were being referenced");
  }
}

}  // namespace ecs::commissioning
