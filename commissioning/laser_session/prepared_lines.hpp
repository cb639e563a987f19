// Measured lines as files that a map can name: joined from several files, without what is left out, with a place
// corrected. The screen writes them beside its map, `ecs laser prepare` by itself.
#pragma once

#include <string>
#include <vector>

#include "commissioning/laser_session/lines.hpp"

namespace ecs::commissioning {

/// The line without what is left out, and said so in its metadata.
[[nodiscard]] laser::MeasurementSet prepared_set(const LaserLine& line, const LaserLineChoice& choice);

/// The options of `ecs laser prepare`.
struct PreparedLineRequest {
  std::vector<std::string> files;
  ImportArguments import;  ///< for all of them
  std::string line;        ///< as a file states it: "EX along X at Y -1400, Z 0"; empty: the only one
  std::string place;       ///< that corrects the stated one, "y=-1400,z=0"; empty: it stays
  LaserLineChoice left_out;
};
/// A `usage` problem where there is no such line, run or reading: it names those that there are.
[[nodiscard]] Result<laser::MeasurementSet> prepared_line(const PreparedLineRequest& request);

/// The words of `ecs laser prepare` for a line of the screen. Nothing where its files have different answers or places.
/// @param files  of the screen, with their answers
[[nodiscard]] std::optional<std::vector<std::string>> prepare_words(const LaserLine& line,
                                                                    const LaserLineChoice& left_out,
                                                                    const std::vector<LaserFileChoice>& files,
                                                                    const std::string& output);

}  // namespace ecs::commissioning
