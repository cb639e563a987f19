// The measured files of one map: each read once, and from it the one curve that a component needs.
// Does not live here: what becomes of the curve (build.hpp).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "laser/analysis/curve.hpp"
#include "laser/analysis/shrinking.hpp"
#include "laser/import/import.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::laser {

/// Which readings a component can be made from: axis moved and sense read.
struct Wanted {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
};

/// A curve with what must be remembered of its file.
struct SourceCurve {
  Curve curve;
  SourceFile source;
  double band = 0.0;  ///< range of the readings used [um, um/m]
  std::size_t readings = 0;
  std::optional<Repeatability> repeatability;
};

class MeasuredFiles {
 public:
  explicit MeasuredFiles(FileReader read) : read_(std::move(read)) {}

  /// The averaged curve of the one measurement line in a file that fits, without the excluded runs. Refused, naming
  /// file and component: no such readings (and what there is), more than one line of them, readings taken with
  /// compensation active, fewer than two targets, an excluded run that is not there.
  [[nodiscard]] Result<SourceCurve> curve(const std::filesystem::path& path, Component component,
                                          const std::vector<Wanted>& wanted, const std::vector<int>& exclude_runs);

  /// Names in the metadata of the files used, each with one file that has it.
  [[nodiscard]] const std::map<std::string, std::string>& machines() const { return machines_; }
  [[nodiscard]] const std::map<std::string, std::string>& serial_numbers() const { return serial_numbers_; }

 private:
  struct Loaded {
    MeasurementSet set;
    std::string sha256;
  };
  [[nodiscard]] Result<const Loaded*> load(const std::filesystem::path& path);

  FileReader read_;
  std::map<std::filesystem::path, Loaded> files_;
  std::map<std::string, std::string> machines_;
  std::map<std::string, std::string> serial_numbers_;
};

/// A refusal that names file and component.
[[nodiscard]] Problem refusal(const std::filesystem::path& file, Component component, const std::string& why);

/// Parked positions closer than this are the same measurement line.
inline constexpr double kSameLine_mm = 0.5;

}  // namespace ecs::laser
