// What is captured and where its readings come from. Targets as they are typed: along a line, a row of a plan, or a
// target list (the stops that follow are modules/capture/capture_record.hpp). When a trigger says that a reading is
// due: typed, an indicator gauge, a file, what a command says.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/cli/action.hpp"
#include "modules/capture/capture_record.hpp"
#include "modules/capture/port.hpp"

namespace ecs::commissioning {

inline constexpr int kMostRuns = 1000;

/// As typed; empty or absent: not given.
struct CaptureTargets {
  std::string axis;
  std::string sense;
  std::optional<double> from_mm;
  std::optional<double> to_mm;
  std::optional<double> step_mm;
  int runs = 0;
  bool moved = false;
  bool one_way = false;
  std::string parked;
  std::optional<double> feed_mm_min;
  std::string targets;
  std::string plan;
  std::string row;
  std::string machine;
  std::string compensated;
  std::vector<std::string> notes;
  static cli::Fields<CaptureTargets> fields();
};

/// Stops and metadata. What the plan's row says can be overridden one by one.
[[nodiscard]] Result<devices::CapturePlan> capture_plan(const CaptureTargets& arguments);

/// What a display showed when it was asked.
struct Shown {
  enum class Kind {
    value,
    not_yet,  ///< ask again in a moment
    late,     ///< it did not come in time; `why`
    none,     ///< there is nothing to be had; `why`
    ended,    ///< and there never will be; `why`
  };
  Kind kind = Kind::not_yet;
  double value = 0.0;
  std::string why;
};

class ReadingSource {
 public:
  virtual ~ReadingSource() = default;
  /// A trigger came: the next answers belong to it.
  virtual void ask(double now_s) = 0;
  [[nodiscard]] virtual Shown shown(double now_s) = 0;
  /// Keeps up with what comes by itself; returns at once.
  virtual void attend(double) {}
  [[nodiscard]] virtual devices::PortChange look(double) { return devices::PortChange::none; }
  /// Why a lost device cannot be had back yet; empty: it is simply not there.
  [[nodiscard]] virtual std::string hindrance() const { return {}; }
  /// For the metadata: "indicator gauge (…)".
  [[nodiscard]] virtual std::string name() const = 0;
};

/// An indicator gauge: the value that it shows when it is asked; um.
[[nodiscard]] std::unique_ptr<ReadingSource> gauge_source(devices::DevicePort port);
/// Numbers of a file or FIFO, one a line ('#' begins a comment): each trigger takes the next.
[[nodiscard]] Result<std::unique_ptr<ReadingSource>> file_source(const std::string& path);
/// The same, but the last line that is there counts: a display that writes all the while.
[[nodiscard]] Result<std::unique_ptr<ReadingSource>> following_source(const std::string& path);
/// The last number that a shell command prints; it is run at each trigger.
[[nodiscard]] std::unique_ptr<ReadingSource> command_source(std::string command);

/// The last number in a line: "X -50.0012 mm" is -50.0012.
[[nodiscard]] std::optional<double> last_number_in(std::string_view line);

}  // namespace ecs::commissioning
