// A workshop that works by itself: part programs, virtual laser, waiting, warming up, load and realigned optics as
// requests over its socket (docs/emulator.md); only the requests are known here, nothing of the program behind them.
// And which workshop an investigation works in: opened by the socket or the folder that was named (watched_folder.hpp).
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "commissioning/link/unit_link.hpp"
#include "commissioning/session/message.hpp"
#include "modules/investigation/map_files.hpp"
#include "modules/investigation/workshop.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

/// A link to a unit that this program holds open already: nobody can open its port a second time.
struct OpenUnit {
  std::string port;      ///< serial device; empty: none
  std::string workshop;  ///< socket of the emulated machine behind it; empty: none
  /// Does work with the link to itself; empty: no link is open.
  std::function<Result<void>(const std::function<Result<void>(protocol::UnitClient&)>&)> with_unit{};
};

struct SocketWorkshopOptions {
  std::filesystem::path socket;
  std::string link;  ///< to the unit, as --link takes it; empty: the one that the workshop names
  MapSources sources;
  params::Machine machine;
  bool map_is_modelled = false;  ///< the model names the map that is active: it stays so
  std::string arm_code{};        ///< that the unit shows; empty: the workshop is asked
  OpenUnit open_unit{};          ///< used where it is the unit of the workshop
};

class SocketWorkshop final : public Workshop {
 public:
  /// A unit that compensates is switched to integration mode, unless the model names its map. `link` problem where no
  /// workshop listens.
  [[nodiscard]] static Result<std::unique_ptr<SocketWorkshop>> open(MessageSink& messages,
                                                                    SocketWorkshopOptions options,
                                                                    const std::atomic<bool>& cancelled);
  ~SocketWorkshop() override;  ///< removes its temporary folder

  [[nodiscard]] Result<RunReadings> measure(const RequestedRun& run) override;
  [[nodiscard]] Result<void> activate(const model::Model& model) override;
  void keep(const InvestigationStep&) override {}

  [[nodiscard]] const std::string& link() const { return options_.link; }

 private:
  class Hands;
  SocketWorkshop(MessageSink& messages, SocketWorkshopOptions options, const std::atomic<bool>& cancelled);
  /// Does work on the unit: over the link that is open, else over one of its own.
  [[nodiscard]] Result<void> with_unit(const std::function<Result<void>(protocol::UnitClient&)>& work) const;
  [[nodiscard]] bool has_open_link() const;
  [[nodiscard]] Result<void> stop_compensation() const;
  [[nodiscard]] Result<laser::MeasurementSet> readings_of(const model::MeasurementProposal& proposal);
  void complete(laser::MeasurementSet& set, const model::MeasurementProposal& proposal) const;

  MessageSink& messages_;
  SocketWorkshopOptions options_;
  const std::atomic<bool>& cancelled_;
  std::unique_ptr<Hands> hands_;
  std::filesystem::path folder_;
  double load_kg_ = 0.0;
  std::map<std::pair<Axis, Sense>, int> set_ups_;  ///< number of the last set-up of each line
};

struct WorkshopChoice {
  std::string socket;   ///< of a running workshop
  std::string folder;   ///< to watch, where no socket is named
  std::string link;     ///< to the unit; empty: the one that the workshop names, or a person sends the map
  std::string model;    ///< file
  std::string machine;  ///< file
  std::string params;   ///< file; empty: parameters.toml beside the machine, else those that fit it
  bool map_is_modelled = false;
  std::string arm_code{};  ///< that the unit shows; empty: that which the workshop names, or $ECS_ARM_CODE
  OpenUnit open_unit{};    ///< a link that is open already
};

struct OpenedWorkshop {
  std::unique_ptr<Workshop> workshop;
  std::string link;  ///< that the workshop names; empty: none
};

/// @param messages, cancelled  outlive the workshop
[[nodiscard]] Result<OpenedWorkshop> open_workshop(MessageSink& messages, const WorkshopChoice& choice,
                                                   const params::Machine& machine, const std::atomic<bool>& cancelled);

}  // namespace ecs::commissioning
