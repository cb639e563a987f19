// A measurement that is taken by hand: its stops (which target comes when, from which side), what is due, what has been
// read, what looks like a doubled or a missed trigger, and the file from which it goes on after an interruption.
// Does not live here: triggers and displays (capture.hpp), people (capture_verbs.cpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"
#include "modules/capture/description.hpp"

namespace ecs::devices {

/// A line of evenly spaced targets, measured forward and back as often as there are runs.
struct CaptureLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  double from_mm = 0.0;
  double to_mm = 0.0;
  double step_mm = 0.0;  ///< its sign does not matter; a last short step ends at `to_mm`
  int runs = 3;
  bool moved = false;    ///< targets moved off equal steps (base/moved_targets.hpp)
  bool one_way = false;  ///< back to the first target without readings
  Vector3 parked_mm{};   ///< where the other axes stand
  std::optional<double> feed_mm_min;
};

struct CapturePlan {
  std::vector<laser::MetadataEntry> metadata;
  std::vector<laser::Reading> stops;  ///< in the order of measuring; `error` and `time_s` mean nothing yet
};

/// @pre nothing. A `usage` problem says what is wrong with step, range or runs.
[[nodiscard]] Result<std::vector<laser::Reading>> stops_of(const CaptureLine& line);

/// The rows of a target list (`ecs model next --targets`) in file order. `bad_input` where a row names no approach.
[[nodiscard]] Result<std::vector<laser::Reading>> stops_of_targets(const laser::MeasurementSet& targets);

/// Stops belong to one pass where axis, sense, run and approach are the same.
[[nodiscard]] bool same_pass(const laser::Reading& a, const laser::Reading& b);

/// What a display shows.
enum class Shows {
  error,     ///< actual − target, times `scale` in um (um/m)
  position,  ///< where the axis stands [mm]: what is shown tells which target it belongs to
};

struct CaptureRules {
  Shows shows = Shows::error;
  double scale = 1.0;           ///< of a shown error; of a shown position to mm
  double min_interval_s = 0.5;  ///< a trigger sooner after the last reading is none
  double missed_factor = 1.8;   ///< a reading that took this many times the usual is asked about
};

/// What became of a trigger.
struct Verdict {
  bool taken = false;
  int missed = 0;       ///< targets left out because the display was already beyond them
  std::string warning;  ///< why it was not taken, or what to look at; empty: all is well
};

class CaptureRecord {
 public:
  CaptureRecord(CapturePlan plan, CaptureRules rules) : plan_(std::move(plan)), rules_(rules) {}

  /// The stop that is due; nothing when all are done.
  [[nodiscard]] const laser::Reading* due() const;
  [[nodiscard]] std::size_t next() const { return next_; }
  [[nodiscard]] const std::vector<laser::Reading>& taken() const { return taken_; }
  [[nodiscard]] const CapturePlan& plan() const { return plan_; }
  [[nodiscard]] const CaptureRules& rules() const { return rules_; }
  [[nodiscard]] std::size_t skipped() const { return next_ - taken_.size(); }
  /// Number of the due target, from 1 in the order of the first pass, and the number of targets in its pass.
  struct Place {
    std::size_t number = 0;
    std::size_t of = 0;
    bool first_of_pass = false;
  };
  [[nodiscard]] Place place() const;
  /// Highest run number of the plan.
  [[nodiscard]] int runs() const;

  /// Why a trigger at this moment is a doubled one; empty: it is none. Ask before a display is read that gives each
  /// reading once.
  [[nodiscard]] std::string doubled(double at_s) const;
  /// A trigger with what the display showed. @param at_s  seconds since the measurement began
  /// @param around  values of the surroundings; reading_um among them means nothing
  [[nodiscard]] Verdict offer(double shown, double at_s, const Values& around);
  /// The measurement stood still: how long the next reading takes says nothing.
  void pause() { judged_ = false; }
  /// Takes back what was done last: the stops left out, else the last reading. False: there is nothing.
  bool undo();
  /// Leaves the due stop without a reading. False: nothing is due.
  bool skip();

  /// The readings so far as a measurement file; a note for every doubt that was not taken back.
  [[nodiscard]] laser::MeasurementSet result() const;

  /// The same, with all that is needed to go on: still a measurement CSV that every verb reads.
  [[nodiscard]] laser::MeasurementSet part() const;
  /// What part() made. Refuses another file, or one that was changed so that it does not hold together.
  [[nodiscard]] static Result<CaptureRecord> from_part(const laser::MeasurementSet& part);
  /// How far a source that is read from its beginning has been read, for part().
  void read_lines(const std::string& source, std::size_t lines) { source_ = source, lines_ = lines; }
  /// Of that source; 0 where another one was read.
  [[nodiscard]] std::size_t lines_read(const std::string& source) const { return source == source_ ? lines_ : 0; }
  /// Metadata of the plan may be added to.
  void note(const std::string& key, const std::string& value);
  [[nodiscard]] std::optional<std::string> noted(std::string_view key) const;

 private:
  [[nodiscard]] Verdict take(double error, double at_s, double shown, const Values& around);
  [[nodiscard]] Verdict by_position(double shown, double at_s, const Values& around);
  [[nodiscard]] double window_mm(std::size_t stop) const;
  [[nodiscard]] std::optional<double> usual_interval_s() const;
  [[nodiscard]] std::string doubt(double at_s, double shown) const;

  CapturePlan plan_;
  CaptureRules rules_;
  std::size_t next_ = 0;
  std::vector<laser::Reading> taken_;
  std::vector<std::size_t> stop_of_;  ///< of each reading taken
  std::vector<std::string> doubts_;   ///< of each reading taken; empty: none
  std::vector<double> shown_;         ///< of each reading taken
  bool judged_ = false;               ///< the time since the last reading means something
  std::string source_;                ///< that `lines_` were read of
  std::size_t lines_ = 0;
};

}  // namespace ecs::devices
