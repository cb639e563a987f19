// A workshop that needs no person: part programs, virtual laser, waiting, warming up, load and realigned optics as
// requests over its socket (docs/emulator.md); only the requests are known here, nothing of the program behind them.
// A workshop where a person measures: each run is asked for in words, with its part program and target list as files,
// and the readings are taken from a folder. What was given is kept in a ledger there, from which the same command goes
// on. Which of them an investigation works in: opened by the socket or the folder that was named. The map of an
// investigated model with the parameters it goes with, as files for `map send`: what the model does not speak of is
// declared zero, with the reason. Does not live here: which run is asked for (investigation.hpp), compiling the model
// (commissioning/maps/from_model.hpp), sending (commissioning/maps/map_in_unit.hpp).
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "commissioning/link/choice.hpp"
#include "commissioning/link/unit_link.hpp"
#include "commissioning/session/message.hpp"
#include "model/fit/model_file.hpp"
#include "modules/investigation/investigation.hpp"
#include "params/machine.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

struct MapSources {
  std::string machine;  ///< file
  std::string params;   ///< file; empty: those that fit the machine
};

struct ModelMapFiles {
  std::string model;   ///< model.toml of the folder
  std::string map;     ///< map.csv
  std::string params;  ///< parameters.toml
};

/// Writes the three files into the folder. Refused where no effect of the model can be carried by a map.
[[nodiscard]] Result<ModelMapFiles> write_map_files(MessageSink& messages, const model::Model& model,
                                                    const MapSources& sources, const std::filesystem::path& folder);

/// Sends them, whole or not at all, and asks the unit to compensate: it waits then for its axes to be referenced.
[[nodiscard]] Result<void> send_map_files(protocol::UnitClient& client, const ModelMapFiles& files);

/// Waits until the unit compensates. Problems: its fault, a link that is lost, `seconds` without success.
[[nodiscard]] Result<void> wait_for_compensation(protocol::UnitClient& client, double seconds);

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
  [[nodiscard]] Result<RunReadings> measured_ball(const model::MeasurementProposal& proposal) const;
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

struct WatchedFolderOptions {
  std::filesystem::path folder;
  std::filesystem::path model;  ///< the file that the investigation began with
  std::string link;             ///< to the unit; empty: the person sends the map
  MapSources sources;
  params::Machine machine;
  /// Waits so long, or until it is to stop: false then. Tests put files into the folder meanwhile.
  std::function<bool(std::chrono::milliseconds)> pause;
  std::string arm_code{};  ///< that the unit shows; empty: that of $ECS_ARM_CODE
};

/// One run that was given.
struct GivenRun {
  int number = 0;
  std::string asked;
  std::string file;    ///< name in the folder
  std::string sha256;  ///< of its bytes
  double minutes = 0.0;
};

/// Refused for a run, named, left where they are and asked for again: a file half written (it grows, it cannot be read,
/// its last line has no end, or it holds fewer readings than were asked for and no empty file NAME.complete lies beside
/// it), one of another axis, sense, line or approach, one that was given before, and any file
/// while the model is not the one that the investigation began with.
class WatchedFolder final : public Workshop {
 public:
  /// Makes the folder where there is none. A ledger there is gone on with. `bad_input` if it cannot be read.
  [[nodiscard]] static Result<std::unique_ptr<WatchedFolder>> open(MessageSink& messages, WatchedFolderOptions options,
                                                                   const std::atomic<bool>& cancelled);

  [[nodiscard]] Result<RunReadings> measure(const RequestedRun& run) override;
  [[nodiscard]] Result<void> activate(const model::Model& model) override;
  void keep(const InvestigationStep& step) override;

  [[nodiscard]] std::filesystem::path ledger_file() const { return options_.folder / "ledger.json"; }

 private:
  /// What a file looked like when it was examined.
  struct Seen {
    std::uintmax_t bytes = 0;
    std::filesystem::file_time_type written{};
    bool complete = false;  ///< it is said that no more will come
    bool refused = false;
    [[nodiscard]] bool is_as(const Seen& other) const {
      return bytes == other.bytes && written == other.written && complete == other.complete;
    }
  };
  WatchedFolder(MessageSink& messages, WatchedFolderOptions options, const std::atomic<bool>& cancelled);
  [[nodiscard]] Result<void> read_ledger();
  [[nodiscard]] Result<void> write_ledger() const;
  [[nodiscard]] Result<void> make_active(const model::Model& model);
  [[nodiscard]] Result<RunReadings> given_before(const RequestedRun& run, GivenRun& given);
  [[nodiscard]] Result<void> ask_for(const RequestedRun& run) const;
  [[nodiscard]] Result<RunReadings> wait_for(const RequestedRun& run);
  [[nodiscard]] bool model_is_the_same();
  [[nodiscard]] std::vector<std::filesystem::path> settled_files();
  /// Why the file is none for this run; its readings otherwise.
  [[nodiscard]] Result<laser::MeasurementSet> taken(const std::filesystem::path& file, const std::string& content,
                                                    const RequestedRun& run) const;

  MessageSink& messages_;
  WatchedFolderOptions options_;
  const std::atomic<bool>& cancelled_;
  std::string model_sha256_;
  bool model_named_ = false;  ///< that it was changed
  bool map_active_ = false;   ///< activate() was done, now or before this ledger was gone on with
  std::vector<GivenRun> given_;
  std::vector<std::string> steps_;  ///< of the investigation, JSON objects
  std::map<std::string, Seen> seen_;
};

}  // namespace ecs::commissioning
