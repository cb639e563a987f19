// A log of several channels, each with a clock of its own, as measurements: one channel gives the rows, the others are
// joined to it by time.
// Does not live here: how a log is written (columns.cpp, json_lines.cpp).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/import/import.hpp"

namespace ecs::laser {

struct ChannelSample {
  double time_s = 0.0;  ///< since 1970, or of any other clock that all channels share
  double value = 0.0;
  int line = 0;  ///< of the file, from 1
};

struct ChannelLog {
  std::map<std::string, std::vector<ChannelSample>, std::less<>> channels;  ///< by name; any order in time
  std::size_t left_out = 0;                                                 ///< values that are no numbers
};

/// "z (1402 values), btemp (141 values)"
[[nodiscard]] std::string channels_text(const ChannelLog& log);

/// Reads the log by `options.channels`, whose headings are names of channels. The first field that gives a reading is
/// the clock: each of its values is a row. Rows without a position, axis or second reading within the greatest gap are
/// left out, a sensor without a value there is absent in the row; the notes count both.
/// @pre options.channels
[[nodiscard]] Result<MeasurementSet> read_channels(ChannelLog log, const std::string& file_name,
                                                   const ImportOptions& options);

}  // namespace ecs::laser
