// The E.C.S. unit: firmware around core/, as the thesis describes it (5.3) and docs/unit.md says in detail.
// Does not live here: the line it answers on (protocol/server/server.hpp), the machine it is at
// (ecs_emulator/machine/machine_tool.hpp).
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/thermal.hpp"
#include "core/tick.hpp"
#include "ecs_emulator/machine/simulation.hpp"
#include "ecs_emulator/unit/datum_watch.hpp"
#include "ecs_emulator/unit/memory.hpp"
#include "ecs_emulator/unit/rotary_inputs.hpp"
#include "ecs_emulator/unit/user_software.hpp"
#include "protocol/server/register_server.hpp"

namespace ecs::emulator {

/// How the unit decides at power-up whether a host is connected.
enum class LinkSense : std::uint8_t {
  automatic,   ///< the command `enter_integration` within kLinkWait_s; who only reads does not count
  integrate,   ///< always integration mode
  compensate,  ///< always compensation mode
};

inline constexpr double kLinkWait_s = 0.5;
/// This many periods in a row that are not finished in time isolate the unit; fewer are counted.
inline constexpr int kMostLatePeriods = 3;
/// Longest time at the output limit before `compensation_output`.
inline constexpr double kOutputLimit_s = 1.0;
/// No axis moves faster: 120 m/min.
inline constexpr double kFastest_mm_s = 2000.0;
/// The watchdog isolates a processor that does not serve it for so long.
inline constexpr double kWatchdog_s = 0.1;
/// Longest wait of the command `test_datum`.
inline constexpr double kDatumTest_s = 600.0;
/// An output that the host has set with its relay closed holds no longer than this without a command.
inline constexpr double kOutputHold_s = 60.0;
/// Largest position that the host can set: no machine is longer than a kilometre.
inline constexpr double kLargestPosition_mm = 1e6;
/// The state of the lags goes to the battery-backed memory so often.
inline constexpr double kThermalStored_s = 60.0;
/// Range of the D/A converter.
inline constexpr double kMostDacCounts = 32767.0;

struct UnitSettings {
  std::string serial_number = "EMULATOR-1";
  std::uint8_t memory_modules = 1;
  AxisModules axis_modules{Transducer::encoder, Transducer::encoder, Transducer::encoder};
  LinkSense link = LinkSense::automatic;
  /// The machine's sensor at each temperature input, "t_spindle_degC"; empty: none is wired.
  std::array<std::string, kTemperatureInputs> sensors{};
};

/// What can be wrong with a wired sensor, or its cable.
enum class SensorFailure : std::uint8_t { none, open, stuck, shifted };

class Unit final : public protocol::UnitPort, public Compensator {
 public:
  /// A rack with power off.
  explicit Unit(const UnitSettings& settings);

  /// Stays off where battery memory that changed before the supply failed cannot be kept: no host may read a map that
  /// the next end of the process would take back.
  void power(bool on);
  [[nodiscard]] bool powered() const { return powered_; }
  /// Called when a new map has become the active one, before the host is answered. False: the battery memory could not
  /// be written; the commit is taken back, and it is called once more.
  void on_commit(std::function<bool()> keep) { on_commit_ = std::move(keep); }

  [[nodiscard]] Drives tick(const Signals& signals) override;
  [[nodiscard]] double period_s() const override { return parameters_.loop_period_us * 1e-6; }
  [[nodiscard]] bool quiet() const override;
  [[nodiscard]] bool senses() const override;
  void sense(const std::vector<NamedTemperature>& shown, double seconds) override;
  void control(const ControlWires& wires) override;
  void turned(const RotaryWires& wires) override;

  [[nodiscard]] UnitMemory& memory() { return memory_; }
  [[nodiscard]] const UnitSettings& settings() const { return settings_; }
  [[nodiscard]] UnitMode mode() const { return mode_; }
  [[nodiscard]] Fault fault() const { return fault_; }

  // what can be wrong with the processor
  /// The work of a period takes longer. @param periods  this many; 0: from now on
  void slow_down(double extra_us_per_period, std::uint64_t periods = 0) {
    extra_us_ = extra_us_per_period;
    slow_periods_ = periods;
  }
  void hang() { hung_ = true; }
  /// @param input  0 … 15  @param by_degC  of `shifted`
  void fail_sensor(std::size_t input, SensorFailure failure, double by_degC = 0.0) {
    failures_[input] = {failure, by_degC, inputs_[input].value};
  }

  /// The battery is nearly empty, or a new one.
  void battery(protocol::BatteryState state) { battery_ = state; }

  // protocol::UnitPort
  [[nodiscard]] protocol::Identity identity() override;
  [[nodiscard]] protocol::UnitStatus status() override;
  [[nodiscard]] protocol::MonitorSample monitor() override;
  [[nodiscard]] protocol::LiveInputs live_inputs() override;
  [[nodiscard]] protocol::ControlLines control_lines() override;
  [[nodiscard]] protocol::RotarySample rotary() override;
  void host_armed() override {
    if (powered_ && mode_ == UnitMode::starting) enter_integration();
  }
  void show_code(const std::string& code) override { shown_code_ = code; }
  [[nodiscard]] const std::string& shown_code() const { return shown_code_; }
  [[nodiscard]] protocol::ImageDigest active_digest() override;
  [[nodiscard]] std::optional<std::uint64_t> take_outputs_ended() override {
    return std::exchange(outputs_ended_ms_, std::nullopt);
  }
  [[nodiscard]] protocol::UnitClock clock() override { return {starts_, static_cast<std::uint64_t>(uptime_s_ * 1e3)}; }
  [[nodiscard]] protocol::UnitError read_memory(Address address, std::span<std::uint8_t> out) override;
  [[nodiscard]] protocol::UnitError may_write(Address address, std::uint32_t bytes) override;
  [[nodiscard]] protocol::UnitError write_memory(Address address, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] protocol::CommandResult begin(const protocol::Command& command) override;
  [[nodiscard]] protocol::CommandResult progress() override;

 private:
  /// The counter's origin of one axis.
  struct Origin {
    std::int64_t counts = 0;
    double position_mm = 0.0;
    bool referenced = false;
  };
  struct DatumTest {
    Axis axis = Axis::X;
    DatumWatch watch;
    double waited_s = 0.0;
  };

  // modes
  void start_up();
  void enter_integration();
  void enter_compensation();
  void raise(Fault fault, std::optional<Axis> axis = std::nullopt, Address address = 0);
  void isolate();
  void watch_supply();
  void tidy_commit_records();
  void report_damaged_records();
  void watch_host();
  void hang_step();
  void wait_for_link();
  void datum_step();
  void begin_compensating();
  void compensate_step();
  [[nodiscard]] bool late();
  [[nodiscard]] bool transducers_sound();
  void command_step();
  [[nodiscard]] bool has_rotary() const { return map_->rotary.arrangement != RotaryWorking::Arrangement::none; }
  void begin_rotary();
  [[nodiscard]] bool go_to_tool(double most_um);
  void begin_thermal();
  void report_doubtful_input();
  [[nodiscard]] protocol::InputStatus input_status(std::size_t input) const;
  void store_thermal();
  [[nodiscard]] const Tool* usable_tool() const;
  [[nodiscard]] bool knows_tool() const;
  void select_tool();
  void control_lost();
  void report_unknown_tool();
  [[nodiscard]] double unknown_input_um() const;
  void watch_unknown_inputs();
  void store_tools();
  void reload_parameters();
  [[nodiscard]] TestVerdict block_check_now() const;
  [[nodiscard]] double mm_per_count(Axis axis) const;
  [[nodiscard]] double position_mm(Axis axis) const;
  [[nodiscard]] bool present(Axis axis) const;
  /// What the D/A converter asks of the axis [um].
  [[nodiscard]] double output_um(Axis axis) const;

  // commands (commands.cpp)
  [[nodiscard]] protocol::CommandResult begin_in_integration(const protocol::Command& command);
  [[nodiscard]] protocol::CommandResult begin_on_axis(const protocol::Command& command);
  [[nodiscard]] protocol::CommandResult begin_staging(protocol::StagingFrom from);
  [[nodiscard]] protocol::CommandResult commit(std::uint32_t length, std::uint64_t digest);
  [[nodiscard]] protocol::CommandResult commit_refused(std::uint32_t length, std::uint64_t digest);
  void take_over(const Commit& commit);
  [[nodiscard]] protocol::CommandResult output(const protocol::Command& command);
  [[nodiscard]] protocol::CommandResult set_input(const protocol::Command& command);
  [[nodiscard]] protocol::CommandResult change_tools(const protocol::Command& command);
  [[nodiscard]] protocol::CommandResult gather_tools(const protocol::Command& command);
  [[nodiscard]] protocol::CommandResult put_in_force(const ToolTable& tools);
  [[nodiscard]] protocol::CommandResult try_squareness(const Vector3& um_per_m);
  [[nodiscard]] protocol::CommandResult run_user_software(Address start, std::uint32_t argument);
  [[nodiscard]] protocol::CommandResult user_software_step();
  [[nodiscard]] protocol::CommandResult stop();

  UnitSettings settings_;
  UnitMemory memory_;
  std::unique_ptr<CompiledMap> map_;
  UnitParameters parameters_{};
  bool powered_ = false;
  UnitMode mode_ = UnitMode::starting;
  Fault fault_ = Fault::none;
  Address fault_address_ = 0;
  std::optional<Axis> fault_axis_;
  protocol::TestOutcome ram_test_ = protocol::TestOutcome::not_run;
  Address ram_test_address_ = 0;
  TestVerdict map_test_{};
  PerAxis<AxisModule> modules_{};
  PerAxis<Origin> origins_{};
  PerAxis<DatumWatch> watches_{};
  PerAxis<double> at_limit_s_{};
  TickState tick_{};
  RotaryTickState rotary_{};
  RotaryInputs rotary_inputs_;
  PerRotary<RotaryAxis> rotary_axes_{};  ///< of the active map, in its order
  ThermalState thermal_{};
  InputValues inputs_{};
  struct FailedSensor {
    SensorFailure failure = SensorFailure::none;
    double by_degC = 0.0;
    double stuck_at = 0.0;
  };
  std::array<FailedSensor, kTemperatureInputs> failures_{};
  ControlWires wires_{};
  bool deviation_wired_ = false;
  ToolTable tools_{};
  std::optional<ToolTable> staged_tools_;  ///< that a host gathers; gone without power
  bool tools_lost_ = false;  ///< their record is damaged, one slot of it or both, and no host has changed it since
  bool tool_known_ = true;   ///< the selected number is in the table, or none is selected
  bool tool_changes_ = false;
  bool squareness_changes_ = false;
  Vector3 squareness_target_um_per_m_{};
  Vector3 tool_target_mm_{};  ///< offset of the tool that was known last
  protocol::BatteryState battery_ = protocol::BatteryState::good;
  double clock_s_ = 0.0;   ///< that the battery keeps running, of the workshop
  double stored_s_ = 0.0;  ///< of that clock, when the thermal state was stored last
  Drives drives_{};
  std::uint32_t starts_ = 0;
  std::uint64_t ticks_ = 0;
  double uptime_s_ = 0.0;
  double silent_s_ = 0.0;  ///< since the last command
  std::optional<std::uint64_t> outputs_ended_ms_;
  std::uint32_t overruns_ = 0;
  std::uint16_t watchdog_trips_ = 0;
  std::uint32_t samples_ = 0;

  bool staging_ = false;
  bool entering_compensation_ = false;  ///< the command is given, the tests come with the next period
  bool restart_ = false;
  std::optional<DatumTest> datum_test_;
  std::optional<DatumRecorder> recorder_;
  std::optional<UserSoftware> user_software_;
  std::uint64_t user_software_since_ = 0;  ///< tick
  protocol::CommandResult result_;
  std::string shown_code_;
  protocol::ImageDigest digest_{};  ///< of the active image, at digest_version_ of memory
  std::optional<std::uint64_t> digest_version_;

  std::function<bool()> on_commit_;
  double extra_us_ = 0.0;
  std::uint64_t slow_periods_ = 0;
  int late_in_a_row_ = 0;
  bool hung_ = false;
  double hung_s_ = 0.0;
};

}  // namespace ecs::emulator
