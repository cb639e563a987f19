// The thesis's single-axis test rig (3.1, 3.5): controller, servo drive, slide with a worn screw, and the prototype
// compensation unit, whose loop is core/; calibrated as 3.5.2 does (BS 4656: linear cycle, five runs each way, ±3σ),
// with compensation tables made from it. Figures 3.3, 3.5 and 3.9 to 3.12 from it, their numbers beside the printed
// ones. Does not live here: the servo (ecs_emulator/drive/servo_drive.hpp), their drawing (figures.cpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "core/tick.hpp"
#include "ecs_emulator/drive/servo_drive.hpp"
#include "ecs_emulator/random/random.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::emulator {

/// What the screw makes of the nut: the slide stands within [forward, reverse] of the place where a perfect screw would
/// put it, at the lower end while it is pushed forward, at the upper end while it is pulled back.
struct SlideErrors {
  double datum_mm = 450.0;          ///< extreme of travel where the optics are reset (3.5.2.2); no error there
  double progressive_um = 0.0;      ///< forward, at the other end of the travel
  double lost_motion_um = 0.0;      ///< at the datum
  double lost_motion_end_um = 0.0;  ///< at the other end: "varies quite markedly over the length of axis travel"
  double cyclic_um = 0.0;           ///< amplitude, in reverse only
  double cyclic_period_mm = 8.0;    ///< the pitch of the screw
  double linear_um_per_mm = 0.0;    ///< idealised progressive error of 3.4
  double scatter_um = 0.0;          ///< of a stop, standard deviation

  [[nodiscard]] double forward_um(double nut_mm) const;
  [[nodiscard]] double reverse_um(double nut_mm) const;
};

/// The errors that give the bands of figures 3.9 and 3.10.
[[nodiscard]] SlideErrors rig_slide_errors();

/// Error tables of one axis for both approaches [um of compensation], values at equal steps.
struct RigTables {
  double start_mm = 0.0;
  double increment_mm = 1.0;
  std::vector<double> forward_um;
  std::vector<double> reverse_um;
};

/// Where the compensation enters the position loop (thesis 3.3, figure 3.1).
enum class Injection : std::uint8_t {
  velocity_command,   ///< a voltage beside the control's, as fine as its D/A converter; the thesis's choice
  control_registers,  ///< whole pulses, each time the control exchanges data with the unit
  feedback,           ///< whole pulses added to those of the transducer
};

class Rig {
 public:
  static constexpr double kPulse_um = 2.0;  ///< resolution of the encoder
  Rig(const ServoParameters& servo, const SlideErrors& errors, double start_mm, std::uint64_t seed);

  /// Puts the unit to work, as referenced where the axis stands now. Values are stored to the resolution of the
  /// encoder.
  /// @param loop_gain  of the control and its D/A converter, as a share of what the unit was told
  void compensate_with(const RigTables& tables, Approach approach, Injection injection = Injection::velocity_command,
                       double loop_gain = 1.0);

  /// Pulses for a move at a constant feed, then `dwell_s` more.
  template <class Each>
  void move_to(double target_mm, double feed_mm_min, double dwell_s, const Each& each) {
    const double from_mm = asked_mm_;
    const double length_mm = target_mm - from_mm;
    const double speed_mm_s = feed_mm_min / 60.0;
    const double moving_s = std::abs(length_mm) / speed_mm_s;
    const auto steps = static_cast<std::uint64_t>(std::ceil((moving_s + dwell_s) / drive_.parameters().step_s));
    for (std::uint64_t k = 1; k <= steps; ++k) {
      const double part = std::min(1.0, static_cast<double>(k) * drive_.parameters().step_s / std::max(moving_s, 1e-9));
      asked_mm_ = part >= 1.0 ? target_mm : from_mm + length_mm * part;
      step();
      each();
    }
  }
  void move_to(double target_mm, double feed_mm_min, double dwell_s) {
    move_to(target_mm, feed_mm_min, dwell_s, [] {});
  }

  /// Slide less target, as the laser shows it, with the scatter of a stop [um].
  [[nodiscard]] double reading_um(double target_mm);

  [[nodiscard]] double asked_mm() const { return asked_mm_; }
  [[nodiscard]] double slide_mm() const { return slide_mm_; }
  [[nodiscard]] double compensation_um() const { return unit_ ? unit_->state.compensation_um[0] : 0.0; }
  [[nodiscard]] const ServoDrive& drive() const { return drive_; }

 private:
  struct Unit {
    CompiledMap map;
    TickState state;
    double added_V_per_count = 0.0;
    Injection injection = Injection::velocity_command;
    double pulses = 0.0;  ///< of compensation, where it does not enter as a voltage
  };
  void step();
  [[nodiscard]] bool begins_period(double period_s) const;
  void move_slide();
  [[nodiscard]] double nut_mm() const { return start_mm_ + drive_.nut_mm(); }

  ServoDrive drive_;
  SlideErrors errors_;
  Random random_;
  double start_mm_ = 0.0;
  double asked_mm_ = 0.0;
  double slide_mm_ = 0.0;
  std::unique_ptr<Unit> unit_;
  std::uint64_t steps_ = 0;
};

/// Position loop gain Kv of a servo [1/s].
[[nodiscard]] double position_loop_gain_per_s(const ServoParameters& servo);

struct RigPlan {
  double from_mm = 450.0;  ///< the datum of the calibration
  double to_mm = 0.0;
  double step_mm = 4.0;
  int runs = 5;
  double feed_mm_min = 3000.0;
  double dwell_s = 0.6;
  double overrun_mm = 4.0;  ///< beyond either end, so that every target is reached from the right side
};

[[nodiscard]] laser::MeasurementSet calibrated(Rig& rig, const RigPlan& plan, bool compensated);

/// One target in one direction.
struct RigTarget {
  double position_mm = 0.0;
  Approach approach = Approach::forward;
  double mean_um = 0.0;
  double sigma_um = 0.0;  ///< n − 1
};
/// The numbers in the heads of figures 3.9 to 3.12.
struct RigBand {
  double error_band_um = 0.0;         ///< largest mean + 3σ less smallest mean − 3σ, whatever the direction
  double non_repeatability_um = 0.0;  ///< largest 6σ
  double largest_reading_um = 0.0;    ///< largest size of a single reading
  std::vector<RigTarget> targets;
};
[[nodiscard]] RigBand band_of(const laser::MeasurementSet& set);

/// Minus the means, at the targets. @pre the targets are `plan`'s
[[nodiscard]] RigTables tables_of(const RigBand& band, const RigPlan& plan);

/// One number of a figure.
struct RigNumber {
  std::string figure;  ///< "3.9"
  std::string name;
  std::string unit;
  std::optional<double> thesis;  ///< as printed; absent: not given
  double here = 0.0;
};

/// A step of the servo: D/A output against time (figures 3.3, 3.4).
struct ServoStep {
  std::vector<double> time_s;
  std::vector<double> dac_V;
  double steady_V = 0.0;
  double rise_s = 0.0;        ///< 10 to 90 % of the steady level
  double falls_from_s = 0.0;  ///< last time before the fall at which it stood at the steady level
  double largest_V = 0.0;
};
[[nodiscard]] ServoStep servo_step(const ServoParameters& servo, double distance_mm, double feed_mm_min,
                                   double length_s);

/// Error of the moving slide with and without compensation (figure 3.5), the motion itself taken off.
struct MovingError {
  std::vector<double> desired_mm;
  std::vector<double> uncompensated_um;
  std::vector<double> compensated_um;
  std::vector<double> compensation_um;  ///< what the unit adds
};
[[nodiscard]] MovingError moving_error(double feed_mm_min, Injection injection = Injection::velocity_command);

/// The ±3σ band of a rig whose compensation enters there.
[[nodiscard]] RigBand band_with(const RigTables& tables, const RigPlan& plan, Injection injection, double loop_gain,
                                std::uint64_t seed);

/// Runs all experiments; writes each figure's data as CSV and, where gnuplot is installed, its picture as SVG.
/// @return the numbers
[[nodiscard]] Result<std::vector<RigNumber>> draw_rig_figures(const std::filesystem::path& folder, std::uint64_t seed);

/// The files that draw_rig_figures writes into a folder, pictures too.
[[nodiscard]] std::vector<std::string> rig_files(const std::filesystem::path& folder);

/// The numbers as a table for a terminal.
[[nodiscard]] std::string table_of(const std::vector<RigNumber>& numbers);

}  // namespace ecs::emulator
