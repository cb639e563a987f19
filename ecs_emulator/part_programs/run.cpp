// A program under way: the track written sample by sample, the instrument that it triggers, the machine that follows.
#include "ecs_emulator/part_programs/run.hpp"

#include <cctype>
#include <cmath>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/result.hpp"
#include "ecs_emulator/machine/simulation.hpp"

namespace ecs::emulator {
namespace {

/// Columns: time_s, line, then for each axis of the machine command_<axis>_mm, position_<axis>_mm (the carriage) and
/// compensation_<axis>_um, then ex_um, ey_um, ez_um: the tool against the workpiece, actual − commanded, and
/// rotation_x_um_per_m and so on: the tool about X, Y, Z, both without scatter. The file appears whole under its name
/// at the end; until then it is `<name>.part`.
class ProgramTrace {
 public:
  /// @param period_s  between samples; 0: every tick
  [[nodiscard]] static Result<ProgramTrace> open(const std::filesystem::path& path, double period_s,
                                                 const Simulation& simulation);
  ProgramTrace(ProgramTrace&& other) noexcept;
  ProgramTrace& operator=(ProgramTrace&&) = delete;
  /// An unfinished file is taken away.
  ~ProgramTrace();

  /// After every tick.
  void sample(Simulation& simulation);
  [[nodiscard]] Result<void> finish();

 private:
  ProgramTrace(std::filesystem::path path, double period_s);

  std::filesystem::path path_;  ///< empty: finished, or moved from
  std::filesystem::path part_;
  std::ofstream file_;
  double period_s_ = 0.0;
  double next_s_ = 0.0;
};

std::string header_of(const MachineTool& machine) {
  std::string text = "time_s,line";
  for (const Axis a : kAllAxes) {
    if (!machine.has(a)) continue;
    const char name = static_cast<char>(std::tolower(letter_of(a)));
    text += fmt::format(",command_{0}_mm,position_{0}_mm,compensation_{0}_um", name);
  }
  return text + ",ex_um,ey_um,ez_um,rotation_x_um_per_m,rotation_y_um_per_m,rotation_z_um_per_m\n";
}

ProgramTrace::ProgramTrace(std::filesystem::path path, double period_s)
    : path_(std::move(path)), part_(path_.string() + ".part"), file_(part_), period_s_(period_s) {}

ProgramTrace::ProgramTrace(ProgramTrace&& other) noexcept
    : path_(std::exchange(other.path_, {})),
      part_(std::move(other.part_)),
      file_(std::move(other.file_)),
      period_s_(other.period_s_),
      next_s_(other.next_s_) {}

ProgramTrace::~ProgramTrace() {
  if (path_.empty()) return;
  file_.close();
  disc::remove(part_);
}

Result<ProgramTrace> ProgramTrace::open(const std::filesystem::path& path, double period_s,
                                        const Simulation& simulation) {
  ProgramTrace trace(path, period_s);
  if (!(trace.file_ << header_of(simulation.machine())))
    return problem(ProblemKind::output, "{}: cannot write", trace.part_.string());
  trace.next_s_ = simulation.machine().time_s();
  return trace;
}

void ProgramTrace::sample(Simulation& simulation) {
  const MachineTool& machine = simulation.machine();
  if (machine.time_s() < next_s_ - 1e-9) return;
  next_s_ = std::max(next_s_ + period_s_, machine.time_s() - period_s_);
  const ToolPose pose = simulation.tool_at(machine.state(), machine.command_mm(), false);
  std::string row = fmt::format("{:.6f},{}", machine.time_s(), machine.path().line());
  for (const Axis a : kAllAxes)
    if (machine.has(a))
      row += fmt::format(",{:.10f},{:.10f},{:.4f}", machine.command_mm()[index_of(a)], machine.axis(a).position_mm(),
                         machine.axis(a).compensation_um());
  for (const Vector3& part : {pose.error_um, pose.rotation_um_per_m})
    row += fmt::format(",{:.4f},{:.4f},{:.4f}", part[0], part[1], part[2]);
  file_ << row << '\n';
}

Result<void> ProgramTrace::finish() {
  file_.close();
  std::error_code error;
  if (file_) std::filesystem::rename(part_, path_, error);
  if (!file_ || error) return problem(ProblemKind::output, "{}: cannot write", path_.string());
  path_.clear();
  return {};
}

constexpr std::size_t kLookAhead = 8192;  ///< pieces that the control plans together
constexpr std::size_t kMostReadings = 1'000'000;
constexpr double kInPosition_s = 0.5;  ///< the longest time that an exact stop waits

tl::unexpected<Problem> stopped_early() {
  return problem(ProblemKind::refused, "part program: stopped before its end");
}
tl::unexpected<Problem> wrong(std::string message) { return problem(ProblemKind::usage, std::move(message)); }

InstrumentSetting setting_of(const ProgramOrder& order) {
  InstrumentSetting setting;
  setting.reversed = order.reversed;
  return setting;
}

/// The instrument with what a program knows about its readings.
class TriggeredPost {
 public:
  TriggeredPost(Simulation& simulation, const ProgramOrder& order, InstrumentKind kind)
      : simulation_(simulation),
        axis_(index_of(*order.axis)),
        approach_(simulation.machine().axis(*order.axis).approach()),
        post_(simulation, *order.axis, *order.sense, kind, setting_of(order)) {
    post_.describe("date", order.date);
    post_.describe("engineer", order.engineer);
  }

  /// The direction in which the axis arrives.
  void sent(const Vector3& from_mm, const PathPiece& piece) {
    double onward = piece.to_mm[axis_] - from_mm[axis_];
    if (piece.arc) onward = arc_between(from_mm, piece.to_mm, *piece.arc).direction(1.0)[axis_];
    if (std::abs(onward) > 1e-12) approach_ = onward > 0.0 ? Approach::forward : Approach::reverse;
  }

  void take() {
    const MachineState state = simulation_.machine().state();
    const Vector3 target_mm = simulation_.machine().command_mm();
    const auto stop = std::pair(std::llround(target_mm[axis_] * 1e6), approach_);
    post_.take(state, {target_mm, approach_, ++runs_[stop], std::nullopt}, simulation_.tool_at(state, target_mm, true));
  }

  [[nodiscard]] MeasuringPost& post() { return post_; }

 private:
  Simulation& simulation_;
  std::size_t axis_;
  Approach approach_;
  MeasuringPost post_;
  std::map<std::pair<long long, Approach>, int> runs_;  ///< readings of a target [nm] in an approach
};

/// One program under way.
class ProgramRunner {
 public:
  ProgramRunner(Simulation& simulation, const Program& program, const ProgramOrder& order, const ProgramHooks& hooks)
      : simulation_(simulation), program_(program), order_(order), hooks_(hooks) {}

  Result<ProgramResult> run() {
    ECS_DO(check());
    if (!order_.trace.empty()) {
      ECS_TRY(trace, ProgramTrace::open(order_.trace, order_.trace_period_s, simulation_));
      trace_.emplace(std::move(trace));
    }
    if (order_.axis && !set_up()) return stopped_early();
    const double start_s = simulation_.machine().time_s();
    if (!follow()) return stopped_early();
    if (trace_) ECS_DO(trace_->finish());
    result_.took_s = simulation_.machine().time_s() - start_s;
    if (post_) result_.readings = post_->post().finished();
    return std::move(result_);
  }

 private:
  Result<void> check() {
    if (order_.axis.has_value() != order_.sense.has_value()) return wrong("expected axis and sense together");
    if (order_.instrument && !order_.axis) return wrong("instrument: expected axis and sense with it");
    if (!(order_.trace_period_s >= 0.0)) return wrong("trace_period: expected 0 s or more");
    const MachineTool& machine = simulation_.machine();
    ECS_TRY(summary, checked_program(program_, machine.command_mm(), range_of(machine)));
    result_.summary = std::move(summary);
    for (const auto& [number, line] : result_.summary.tools)
      if (!simulation_.has_tool(static_cast<std::uint16_t>(number)))
        return problem_at(program_.file, line, 0,
                          "M06: the magazine has no tool {}; see [[emulator.tool]] of the machine file", number);
    if (!order_.axis) return {};
    if (result_.summary.readings == 0) return wrong("expected a program with readings (M08)");
    if (result_.summary.readings > kMostReadings)
      return wrong(
          fmt::format("expected at most {} readings, the program has {}", kMostReadings, result_.summary.readings));
    return MeasuringPost::fits(simulation_, *order_.axis, *order_.sense, kind(), setting_of(order_));
  }

  [[nodiscard]] InstrumentKind kind() const {
    return order_.instrument.value_or(instrument_for(*order_.sense, *order_.axis));
  }

  bool set_up() {
    const Vector3 start_mm = simulation_.machine().command_mm();
    post_.emplace(simulation_, order_, kind());
    if (kind() != InstrumentKind::square) return true;
    return post_->post().null_square(*result_.summary.first_reading_mm) && simulation_.move_to(start_mm, 0.0);
  }

  bool follow() {
    MachineTool& machine = simulation_.machine();
    ProgramInterpreter blocks(program_, machine.command_mm(), range_of(machine), [](int, const std::string&) {});
    Vector3 from_mm = machine.command_mm();
    while (const auto step = blocks.next()) {
      if (hooks_.spindle && step->spindle_rpm && *step->spindle_rpm != 0.0) {
        if (!stand()) return false;
        hooks_.spindle(*step->spindle_rpm);
      }
      if (step->motion) {
        pieces_.push_back(*step->motion);
        if (post_) post_->sent(from_mm, *step->motion);
        from_mm = step->motion->to_mm;
        if (pieces_.size() >= kLookAhead / 2) {
          if (!hand_over()) return false;
          tell(blocks.executed(), step->line);
        }
      }
      if (!ends_standing(*step)) continue;
      if (!stand() || !act(*step)) return false;
      tell(blocks.executed(), step->line);
    }
    if (!stand()) return false;
    tell(result_.summary.blocks, 0);
    return true;
  }

  static bool ends_standing(const ProgramStep& step) {
    return step.exact_stop || step.dwell_s || step.tool || step.trigger != ProgramTrigger::none || step.stop ||
           (step.spindle_rpm && *step.spindle_rpm == 0.0);
  }

  /// Gives the pieces to the control, and waits until it has room for more.
  bool hand_over() {
    simulation_.machine().follow(pieces_);
    pieces_.clear();
    return simulation_.run_while([&] { return simulation_.machine().path().pieces_left() > kLookAhead / 2; }, each_);
  }

  /// To the end of the path, in position.
  bool stand() {
    MachineTool& machine = simulation_.machine();
    machine.follow(pieces_);
    pieces_.clear();
    if (!simulation_.run_while([&] { return !machine.arrived(); }, each_)) return false;
    const double end_s = machine.time_s() + kInPosition_s;
    return simulation_.run_while([&] { return !machine.in_position(kInPosition_mm) && machine.time_s() < end_s; },
                                 each_);
  }

  bool act(const ProgramStep& step) {
    if (step.dwell_s && !simulation_.dwell(*step.dwell_s, each_)) return false;
    if (hooks_.spindle && step.spindle_rpm == 0.0) hooks_.spindle(0.0);
    if (step.tool) simulation_.change_tool(static_cast<std::uint16_t>(*step.tool));
    if (post_ && step.trigger == ProgramTrigger::reading) post_->take();
    return true;
  }

  void tell(std::size_t blocks, int line) {
    if (!hooks_.report) return;
    const std::size_t readings = post_ ? post_->post().set().readings.size() : 0;
    hooks_.report({blocks, result_.summary.blocks, line, readings});
  }

  Simulation& simulation_;
  const Program& program_;
  const ProgramOrder& order_;
  const ProgramHooks& hooks_;
  ProgramResult result_;
  std::optional<ProgramTrace> trace_;
  std::optional<TriggeredPost> post_;
  std::vector<PathPiece> pieces_;  ///< read ahead, not yet with the control
  const std::function<void()> each_ = [this] {
    if (trace_) trace_->sample(simulation_);
    if (hooks_.each) hooks_.each();
  };
};

}  // namespace

ProgramRange range_of(const MachineTool& machine) {
  ProgramRange range{};
  const auto travel_mm = machine.travel_mm();
  for (const Axis a : kAllAxes)
    if (machine.has(a))
      range[index_of(a)] = {travel_mm[index_of(a)][0] - kOvertravel_mm, travel_mm[index_of(a)][1] + kOvertravel_mm};
  return range;
}

Result<ProgramResult> run_program(Simulation& simulation, const Program& program, const ProgramOrder& order,
                                  const ProgramHooks& hooks) {
  return ProgramRunner(simulation, program, order, hooks).run();
}

}  // namespace ecs::emulator
