// A manifest: a table (CSV) with one machine or unit a line, each with an id of its own. Diagnosing its machines on all
// cores, gone on with where a former run ended; the files of one machine: their content as one hash, and their
// diagnosis. Does not live here: what the answers of all machines together mean (result.hpp), units that are written
// (batch.hpp).
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "modules/fleet/result.hpp"

namespace ecs::commissioning {

/// The columns that a manifest may have, in the order in which rows give their cells.
struct ManifestColumns {
  std::vector<std::string> needed;    ///< the first of them is the id
  std::vector<std::string> optional;  ///< their cells are empty where the column is absent
};

struct ManifestRow {
  int line = 0;
  std::vector<std::string> cells;  ///< of the needed columns, then of the optional ones
  [[nodiscard]] const std::string& id() const { return cells.front(); }
};

/// Keeps the text of the file and where its rows begin: a row is cut into cells when it is asked for, so that a hundred
/// thousand rows take little more memory than the file. Safe to read from several threads.
class Manifest {
 public:
  /// Refuses a table without rows or without a needed column. Other columns are left alone, unless the name looks like
  /// that of a missing one. Lines that begin with '#' and empty lines count only for line numbers.
  [[nodiscard]] static Result<Manifest> parse(std::string text, const std::string& name, std::filesystem::path folder,
                                              const ManifestColumns& columns);
  [[nodiscard]] static Result<Manifest> read(const std::filesystem::path& path, const ManifestColumns& columns);

  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  /// A problem with its line where the row has another number of cells than the header, an open quote, no id or one of
  /// more than kLongestId bytes, or an empty needed cell.
  [[nodiscard]] Result<ManifestRow> row(std::size_t i) const;
  /// The line of the first row with the same id; nothing for that row itself.
  [[nodiscard]] std::optional<int> doubles_line(std::size_t i) const;

  /// A path of a cell, from the folder of the manifest; "" stays "".
  [[nodiscard]] std::string from_folder(const std::string& path) const;
  [[nodiscard]] const std::string& name() const { return name_; }

  static constexpr std::size_t kLongestId = 200;  ///< a choice; it stands in every line of the results

 private:
  struct Place {
    std::size_t begin = 0;
    std::uint32_t length = 0;
    int line = 0;
  };
  std::string text_, name_;
  std::filesystem::path folder_;
  std::vector<std::string> columns_;                  ///< names, in the order of the cells of a row
  std::vector<std::optional<std::size_t>> field_of_;  ///< of each of them
  std::size_t needed_ = 0, fields_ = 0;
  std::vector<Place> rows_;
  std::map<std::size_t, int> doubled_;  ///< row to line of the first
};

/// A row of the manifest; paths are complete.
struct MachineSet {
  std::string id, model, data, machine, type, batch;
};

/// id, model, data; machine, type and batch may be absent.
[[nodiscard]] const ManifestColumns& fleet_columns();

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
