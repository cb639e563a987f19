// Monitor samples as CSV, one row for each axis and sample, on disc as they come; and what a sensor of the surroundings
// says beside them. Does not live here: the sensors.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::commissioning {

/// What is known of the surroundings at one moment.
struct Surroundings {
  std::string device;                                    ///< empty: not open yet
  std::vector<std::pair<std::string, double>> values{};  ///< "air_degC" 20.5; at most some seconds old; empty: none
  std::string problem{};  ///< why there are none; empty: there are, or the first are awaited
  std::string text{};     ///< "air 20.50 degC, material 19.25 degC", or why there is nothing to say
};

/// A sensor that is read as long as this lives.
class SurroundingsWatch {
 public:
  virtual ~SurroundingsWatch() = default;
  [[nodiscard]] virtual Surroundings now() const = 0;
};

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

  /// @param surroundings  a temperature that is not among them leaves its field empty
  [[nodiscard]] Result<void> add(const protocol::MonitorSample& sample, const Surroundings& surroundings);
  /// FILE.part becomes FILE; without a sample it is removed, and FILE stays as it was.
  [[nodiscard]] Result<void> end();

  [[nodiscard]] bool runs() const { return handle_ >= 0; }  ///< false: ended, or broken by a write error
  [[nodiscard]] std::size_t samples() const { return samples_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::string summary() const;  ///< "3 samples written to axes.csv"

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
