// Diagnosing the machines of a manifest on all cores, gone on with where a former run ended; the files of one machine:
// their content as one hash, and their diagnosis. Does not live here: what the answers of all machines together mean
// (merge.hpp).
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "modules/fleet/manifest.hpp"
#include "modules/fleet/result.hpp"

namespace ecs::commissioning {

/// A row of the manifest; paths are complete.
struct MachineSet {
  std::string id, model, data, machine, type, batch;
};

/// id, model, data; machine, type and batch may be absent.
[[nodiscard]] const ManifestColumns& fleet_columns();
[[nodiscard]] MachineSet machine_set_of(const Manifest& manifest, const ManifestRow& row);

/// SHA-256 of what the answer depends on: model, its map, data, machine, and the number of noise replicates. Where the
/// files lie and what they are called does not matter. Refuses what is no regular file, and more than 8 MiB of data
/// (about 130,000 readings): many such sets at once would not fit into memory.
[[nodiscard]] Result<std::string> content_hash(const MachineSet& set, std::size_t noise_replicates);

/// The diagnosis of `ecs model diagnose` on these files. Safe to call from several threads; the answer does not depend
/// on how many.
/// @param hash  content_hash()  @param cancelled  set by another thread: `refused`, soon
[[nodiscard]] Result<FleetResult> diagnosed(const MachineSet& set, const std::string& hash,
                                            std::size_t noise_replicates, const std::atomic<bool>* cancelled);

/// A share of the rows, for one host of many: row number - 1, and every of-th from there on.
struct FleetPart {
  std::size_t number = 1, of = 1;
};
/// "3/16"; a `usage` problem where it is none.
[[nodiscard]] Result<FleetPart> fleet_part(std::string_view text);

struct FleetOptions {
  int threads = 0;                     ///< 0: as many as the process may use cores
  std::size_t noise_replicates = 200;  ///< of each diagnosis, as `ecs model diagnose`
  double most_s = 300.0;               ///< for one machine, by the clock; then it is an error and the others go on
  FleetPart part{};
};
inline constexpr int kMostThreads = 256;

struct FleetProgress {
  std::size_t done = 0, machines = 0;
  double seconds_left = 0.0;  ///< from the mean speed of those diagnosed so far
};

/// A row of the manifest that has no answer.
struct FleetError {
  int line = 0;
  std::string id;  ///< "" where the row has none
  std::string message;
};

struct FleetReport {
  std::size_t machines = 0;                     ///< rows of the manifest, of its part
  std::size_t diagnosed = 0;                    ///< in this run
  std::size_t skipped = 0;                      ///< done by a former run
  std::vector<FleetError> errors;               ///< in the order of the manifest
  std::map<std::string, std::size_t> verdicts;  ///< of those diagnosed in this run
  double processor_s = 0.0;                     ///< of all threads, skipped machines included
  double seconds = 0.0;                         ///< by the clock
  bool stopped = false;                         ///< by a signal: the results can be gone on with
};

struct FleetWatch {
  std::function<void(const FleetProgress&)> progress;  ///< by the calling thread, several times a second
  std::function<void(const FleetError&)> error;        ///< by the calling thread too
};

/// A line for each machine is added to `output` (result.hpp) as soon as its answer is there; machines whose
/// content is in it already are skipped. A row that cannot be read or diagnosed becomes a line with its error; of rows
/// with the same id the first is diagnosed, and the lines of the others come last. Beside `output` a file `.work`
/// exists during the run. Stops in good order on a signal. Refuses an output that is no results file or belongs to
/// another run; `output` problem where nothing can be written.
[[nodiscard]] Result<FleetReport> run_fleet(const Manifest& manifest, const std::string& output,
                                            const FleetOptions& options, const FleetWatch& watch = {});

}  // namespace ecs::commissioning
