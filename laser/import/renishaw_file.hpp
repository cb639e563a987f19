// A Renishaw run file (.rtl .rta .rts) as it stands: sections, keys, targets and points, nothing interpreted.
// Does not live here: what the numbers mean (renishaw_run.cpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// One line of DEVIATIONS.
struct RunPoint {
  int line = 0;
  int run = 0;     ///< single pass, from 1
  int target = 0;  ///< from 1
  double deviation = 0.0;
};

struct RunFile {
  std::vector<MetadataEntry> header;  ///< HEADER and the keys of TARGET DATA but the targets
  std::vector<MetadataEntry> user_text;
  std::vector<MetadataEntry> equipment;  ///< newer software: instruments and optics
  std::vector<MetadataEntry> environment;
  std::vector<double> targets;  ///< mm (degrees for rotary axes), in file order
  std::optional<long long> target_count;
  std::optional<long long> run_count;  ///< single passes
  std::vector<long long> flags;
  std::vector<RunPoint> points;
  bool has_end = false;  ///< the EOF section stands
};

/// Reads the sections; every line that cannot be read is a finding. Checks that the counts agree with what stands
/// there.
/// @param accept_truncated  missing points and a missing end are no fault
[[nodiscard]] Result<RunFile> run_file_in(std::string_view text, const std::string& file_name, bool accept_truncated);

/// The value of a key, case ignored; nothing if there is none or it is empty.
[[nodiscard]] std::optional<std::string> value_of(const std::vector<MetadataEntry>& entries, std::string_view key);

/// The numbers of a text, separated by blanks, decimal point or comma; what is no number is left out.
[[nodiscard]] std::vector<double> numbers_of(std::string_view text);

}  // namespace ecs::laser
