// What the engineer chose on the way from laser files to a map: small, kept on disc as a draft, undone by putting an
// older value in its place.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/measurements/files.hpp"
#include "laser/analysis/process.hpp"

namespace ecs::commissioning {

struct LaserFileChoice {
  std::string path;
  ImportArguments answers;  ///< what the file does not say
  /// Where the other axes stood, as in "y=-1400,z=0", where the file states it wrongly; by the line as the file states
  /// it (LaserLine::stated).
  std::map<std::string, std::string> places{};
};

/// Readings left out of one measured line, each with its reason (may be empty). Nothing is removed from any file.
struct LaserLineChoice {
  std::map<int, std::string> runs;
  std::map<std::size_t, std::string> readings;  ///< by their place in the line
  friend bool operator==(const LaserLineChoice&, const LaserLineChoice&) = default;
};

struct LaserComponentChoice {
  std::optional<laser::SlopeMethod> slope;  ///< absent: the method recommended for the component
  double smoothing_mm = 0.0;                ///< window; 0: none
  std::optional<double> increment_mm;       ///< of the tables; absent: the spacing of the targets
  std::string zero_reason;                  ///< why it is declared zero; empty: it is not
  friend bool operator==(const LaserComponentChoice&, const LaserComponentChoice&) = default;
};

struct LaserHeaderChoice {
  std::string customer;
  std::string machine;        ///< empty: from the files, else from the parameters
  std::string serial_number;  ///< the same
  std::string engineer;
  std::string date;
  std::string remarks;
  friend bool operator==(const LaserHeaderChoice&, const LaserHeaderChoice&) = default;
};

struct LaserChoices {
  std::vector<LaserFileChoice> files;
  std::map<std::string, LaserLineChoice> lines;            ///< by LaserLine::key
  std::map<std::string, LaserComponentChoice> components;  ///< by code
  std::string opened_map;  ///< an error map taken as it is, in place of one from the lines; empty: none
  std::string params_file;
  std::string scope;  ///< "linear", "planar", "volumetric"; empty: as in the parameters
  LaserHeaderChoice header;
  std::string map_file = "map.csv";
};

/// JSON; reading it back gives the same choices.
[[nodiscard]] std::string choices_text(const LaserChoices& choices);
/// Nothing if it is no such text.
[[nodiscard]] std::optional<LaserChoices> choices_in(const std::string& text);
[[nodiscard]] inline bool operator==(const LaserChoices& a, const LaserChoices& b) {
  return choices_text(a) == choices_text(b);
}

}  // namespace ecs::commissioning
