// Results files of one fleet, from one host or many, together: which names hold with the false-discovery rate
// controlled over all machines, what changed since last time, and which type or batch shares a cause. Does not live
// here: the lines of a results file (result.hpp), the diagnosis of one machine (run.hpp).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "modules/fleet/result.hpp"

namespace ecs::commissioning {

/// q-values of p-values, one hypothesis each: the smallest rate at which the procedure of Benjamini and Hochberg (1995,
/// J. R. Statist. Soc. B 57, 289) rejects it. At most that share of the rejected ones is false on average, if the
/// p-values of the true hypotheses are independent of one another and of the others, or depend positively on each
/// (Benjamini and Yekutieli 2001, Annals of Statistics 29, 1165).
[[nodiscard]] std::vector<double> q_values_of(const std::vector<double>& p_values);

/// Chance that of `drawn` machines at least `hits` have a cause that `with_cause` of `all` have: the upper tail of the
/// hypergeometric law (Fisher's exact test, one-sided). @pre drawn, with_cause <= all
[[nodiscard]] double shared_by_chance(std::size_t all, std::size_t with_cause, std::size_t drawn, std::size_t hits);

struct NamedMachine {
  std::string id;
  std::string cause;
  std::optional<double> q_value;  ///< absent: no evidence that counts among many machines
  std::string type, batch;
};

/// A type or batch that shares a cause.
struct SharedCause {
  std::string by;     ///< "type" or "batch"
  std::string value;  ///< of it
  std::string cause;
  std::size_t machines = 0;  ///< of it, with the cause
  std::size_t of = 0;        ///< of it, all that were diagnosed
  double p_value = 1.0;      ///< of shared_by_chance()
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
