// What a run of a fleet leaves on the disc: the answer for one machine and the line of JSON that holds it, the results
// file that grows a line at a time and can be gone on with after any end of the program, and which machines were under
// way then: a machine whose files end the program is found by the next run, which leaves it for last and in the end
// gives it up. That last file is the lock of the results.
// Results files of one fleet, from one host or many, together (merge.cpp): which names hold with the false-discovery
// rate controlled over all machines, what changed since last time, and which type or batch shares a cause. Does not
// live here: the diagnosis of one machine (run.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/process.hpp"
#include "base/result.hpp"

namespace ecs::commissioning {

/// A cause in the answer for one machine.
struct FleetCause {
  std::string name;  ///< "effect:axis:sense-or-code"
  double probability = 0.0;
  std::optional<double> e_value;  ///< divided by the number of candidates tried; absent: no split shows it
  double false_naming = 1.0;
  std::optional<double> p_value{};    ///< beside the other causes, for having been chosen; absent: older results
  std::string standing = "proved";    ///< or "likely"
  std::vector<std::string> rivals{};  ///< that the data cannot distinguish from it; also empty: older results

  friend bool operator==(const FleetCause&, const FleetCause&) = default;
};

struct FleetResult {
  std::string id;
  std::string hash;                ///< SHA-256 of what was read; empty with an error
  std::string verdict;             ///< of model/diagnosis/diagnose.hpp
  std::vector<FleetCause> causes;  ///< proved ones, then likely ones
  std::string type, batch;
  double processor_s = 0.0;
  std::string error;                ///< not diagnosed, and why; empty: diagnosed
  bool doubled = false;             ///< the error is that another row has the id already; the answer for that one holds
  std::optional<double> p_value{};  ///< that nothing is missing; absent: older results

  friend bool operator==(const FleetResult&, const FleetResult&) = default;
};

/// {"id", "hash", "verdict", "p_value", "causes", "type", "batch", "processor_s"} or {"id", "error"} ("doubled" where
/// it is), without the end of the line.
[[nodiscard]] std::string to_line(const FleetResult& result);
/// Nothing where the line is no such object.
[[nodiscard]] std::optional<FleetResult> result_in(std::string_view line);

/// A line is one write() at the end of the file, so that a killed program leaves whole lines and at most one that was
/// cut; it reaches the disc at sync(). Lines may be appended from several threads.
class ResultsFile {
 public:
  /// Reads what is there. Cut lines, errors and answers that a later line of the same machine replaces are left out,
  /// and the file is replaced by what remains. Refuses a file whose first line is no result (`usage`).
  [[nodiscard]] static Result<ResultsFile> open(const std::string& path);

  enum class Held { no, other_labels, yes };
  /// Whether the file opened holds the answer for this content; or holds it under another type or batch.
  [[nodiscard]] Held holds(const FleetResult& labels, const std::string& hash) const;
  /// That answer. @pre holds() it under other labels
  [[nodiscard]] Result<FleetResult> held(const std::string& id) const;
  [[nodiscard]] std::size_t size() const { return held_.size(); }

  [[nodiscard]] Result<void> append(const FleetResult& result);
  /// All that was appended is on the disc.
  [[nodiscard]] Result<void> sync();

 private:
  /// Enough to know an answer again, and to find it.
  struct Known {
    std::array<std::uint8_t, 32> hash{};
    std::size_t labels = 0;
    std::uint64_t offset = 0;
    std::uint32_t length = 0;
  };
  ResultsFile() = default;
  [[nodiscard]] Problem failed(const char* what) const;

  std::string path_;
  Descriptor handle_;
  std::unordered_map<std::string, Known> held_;
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
  bool synced_ = true;
};

/// Every line of a text; those that are no result are counted. @return of an id its last line, in the order of the file
struct ResultLines {
  struct One {
    std::uint64_t offset = 0;
    std::uint32_t length = 0;
    FleetResult result;
  };
  std::vector<One> results;
  std::size_t errors = 0, unreadable = 0, replaced = 0;
  int first_unreadable = 0;  ///< line
};
/// @param keep_errors  they are results too; false: left out
[[nodiscard]] ResultLines result_lines(std::string_view text, bool keep_errors);

/// Ends of the program without warning while a machine was under way, after which it is given up: a power cut or a kill
/// hits the same machine three times only by great misfortune.
inline constexpr int kMostUncleanEnds = 3;

/// The file stays unless remove() is called.
class UnderWay {
 public:
  /// Takes `path`, and reads what a run that did not end in good order left there. `refused` while another run has it.
  [[nodiscard]] static Result<UnderWay> open(const std::string& path, int threads);
  /// Machines that were under way when the program ended, and how often.
  [[nodiscard]] const std::map<std::string, int>& ends() const { return ends_; }
  /// Each thread has a place of its own.
  void begin(int thread, const std::string& id) const;
  void finish(int thread) const;
  /// The run ends in good order.
  void remove();

 private:
  UnderWay() = default;
  void put(int place, const std::string& text) const;

  std::string path_;
  Descriptor handle_;
  std::map<std::string, int> ends_;
};

/// q-values of p-values, one hypothesis each: the smallest rate at which the procedure of Benjamini and Hochberg (1995,
/// J. R. Statist. Soc. B 57, 289) rejects it. At most that share of the rejected ones is false on average, if the
/// p-values of the true hypotheses are independent of one another and of the others, or depend positively on each
/// (Benjamini and Yekutieli 2001, Annals of Statistics 29, 1165).
[[nodiscard]] std::vector<double> q_values_of(const std::vector<double>& p_values);

struct NamedMachine {
  std::string id;
  std::string cause;
  std::optional<double> q_value;  ///< absent: no evidence that counts among many machines
  std::string type, batch;
  std::vector<std::string> rivals{};  ///< as of FleetCause
};

/// A type or batch that shares a cause.
struct SharedCause {
  std::string by;     ///< "type" or "batch"
  std::string value;  ///< of it
  std::string cause;
  std::size_t machines = 0;  ///< of it, with the cause
  std::size_t of = 0;        ///< of it, all that were diagnosed
  double p_value = 1.0;      ///< that so many of it have the cause by chance (Fisher's exact test, one-sided)
  double p_holm = 1.0;       ///< for all types, batches and causes together (Holm 1979)
};
/// A group is listed up to this p_holm: a choice, the usual one.
inline constexpr double kSharedLevel = 0.05;

struct FleetNames {
  std::size_t machines = 0;               ///< with an answer
  std::vector<NamedMachine> named;        ///< by falling evidence
  std::vector<NamedMachine> unconfirmed;  ///< named for themselves; among so many machines that may be chance
  std::vector<std::string> unexplained;   ///< structure that no effect explains
  std::vector<SharedCause> groups;        ///< by rising p_holm
};

/// The hypothesis of a machine: its readings are what its model says, and noise. Its p-value is that of its results;
/// one without names has the p-value 1, whatever its readings: that makes no p-value smaller. Where older results have
/// none it is 1/e of the largest e-value (Markov). Of the causes of a named machine the surest is named, a further one
/// where its own p-value is as small as a machine's must be.
/// @param results  one a machine; those with errors take no part  @param rate  of false discoveries, 0 … 1
[[nodiscard]] FleetNames fleet_names(const std::vector<FleetResult>& results, double rate);

struct FleetChange {
  std::string id;
  std::string cause;
  bool is_new = true;  ///< false: gone
};
struct FleetChanges {
  std::vector<FleetChange> machines;  ///< in the order of the ids
  struct Count {
    std::string cause;
    std::size_t is_new = 0, gone = 0;
  };
  std::vector<Count> causes;  ///< the most frequent first
};
/// Names that are there now and were not, or the other way round.
/// @param absent_now  ids without an answer now: nothing is said of them
[[nodiscard]] FleetChanges changes_between(const std::vector<NamedMachine>& before,
                                           const std::vector<NamedMachine>& now,
                                           const std::vector<std::string>& absent_now);

struct GatheredResults {
  std::vector<FleetResult> results;     ///< one a machine, errors included, in the order of the files
  std::vector<std::string> conflicts;   ///< a machine with other contents in another file, told by line
  std::vector<std::string> unreadable;  ///< cut lines, told by file
};

/// Within a file the last line of a machine counts. Of a machine in several files an answer counts before an error; two
/// answers for different contents are a conflict, and the one of the file named last counts. Refuses a file without any
/// result.
[[nodiscard]] Result<GatheredResults> gathered_results(const std::vector<std::string>& files);

/// What was named last time: from results (the same rate is used), or from the answer of `ecs fleet merge --json`.
[[nodiscard]] Result<std::vector<NamedMachine>> previously_named(const std::string& file, double rate);

/// The results as one file.
[[nodiscard]] Result<void> write_results(const std::string& path, const std::vector<FleetResult>& results);

}  // namespace ecs::commissioning
