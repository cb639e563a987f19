// Monitor samples as CSV, one row for each axis and sample, on disc as they come.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "devices/description.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::commissioning {

/// The header row, with its line end.
inline constexpr std::string_view kMonitorColumns =
    "time_s,mode,fault,axis,position_mm,speed_mm_min,referenced,switch,marker,approach,compensation_um,output_counts,"
    "relay_closed,t_air_degC,t_material_degC\n";

/// @param surroundings  as a sensor gave them last; a temperature that is not among them leaves its field empty
[[nodiscard]] std::string monitor_rows(const protocol::MonitorSample& sample, const devices::Values& surroundings = {});

/// A recording under way. Samples go into FILE.part as they come and are on disc within a second; at the end FILE.part
/// becomes FILE, and only then is a former FILE gone. After a crash FILE.part holds what was recorded. A device or FIFO
/// is written into.
class MonitorRecording {
 public:
  /// An `output` problem: nothing can be written there, FILE is a folder, or FILE.part is there already (a recording
  /// that was broken off, or one that still runs).
  [[nodiscard]] static Result<MonitorRecording> begun(const std::string& file);

  MonitorRecording(const MonitorRecording&) = delete;
  MonitorRecording& operator=(const MonitorRecording&) = delete;
  MonitorRecording(MonitorRecording&& from) noexcept;
  MonitorRecording& operator=(MonitorRecording&&) = delete;
  ~MonitorRecording();  ///< ends it

  [[nodiscard]] Result<void> add(const protocol::MonitorSample& sample, const devices::Values& surroundings);
  /// FILE.part becomes FILE; without a sample it is removed, and FILE stays as it was.
  [[nodiscard]] Result<void> end();

  [[nodiscard]] bool runs() const { return handle_ >= 0; }  ///< false: ended, or broken by a write error
  [[nodiscard]] std::size_t samples() const { return samples_; }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  MonitorRecording() = default;
  [[nodiscard]] Result<void> write(std::string_view text);
  /// Closes it: what was recorded stays in FILE.part.
  [[nodiscard]] Result<void> broken(int error);

  std::string name_;              ///< FILE as it was given
  std::filesystem::path target_;  ///< where a symbolic link leads
  std::filesystem::path part_;    ///< empty: written into `target_` itself
  int handle_ = -1;
  std::size_t samples_ = 0;
  std::chrono::steady_clock::time_point on_disc_at_{};
};

}  // namespace ecs::commissioning
