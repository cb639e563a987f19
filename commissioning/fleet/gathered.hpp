// Results files of one fleet, from one host or many, as one list; and what an earlier night named.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "commissioning/fleet/merge.hpp"
#include "commissioning/fleet/result.hpp"

namespace ecs::commissioning {

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
