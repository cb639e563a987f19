// A workshop where a person measures: each run is asked for in words, with its part program and target list as files,
// and the readings are taken from a folder. What was given is kept in a ledger there, from which the same command goes
// on. Does not live here: which run is asked for (investigation.hpp).
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "commissioning/session/message.hpp"
#include "modules/investigation/map_files.hpp"
#include "modules/investigation/workshop.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

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
