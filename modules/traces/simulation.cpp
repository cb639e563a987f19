// The reader of the [drive] table, and the exact integration of the piecewise linear servo axis (thesis 3.2.1, appendix
// A): matrix exponential by scaling and squaring (Moler and Van Loan 2003, method 3), events by the false position with
// bisection (Dowell and Jarratt 1971). Does not live here: comparing it with a recording (fit.cpp).
#include "modules/traces/simulation.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <string>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"

namespace ecs::model {
namespace {

using enum DriveConstant;

constexpr std::array<DriveConstantInfo, kDriveConstants> kInfo{{
    {Kd, "Kd", "Kd_V_per_pulse", "V/pulse", 0.0099734, "gain of the D/A converter after the position error counter"},
    {K, "K", "K", "", 1.0 / 3.0, "scaling of the velocity command before the amplifier"},
    {Ka, "Ka", "Ka_A_per_V", "A/V", 30.06, "proportional gain of the PI velocity regulator"},
    {Ti, "Ti", "Ti_s", "s", 0.0204, "integral action time of the PI velocity regulator"},
    {Tc, "Tc", "Tc_s", "s", 0.0003, "time constant of the current regulator"},
    {Kt, "Kt", "Kt_Nm_per_A", "Nm/A", 0.5, "torque constant of the motor"},
    {Jm, "Jm", "Jm_kgm2", "kg m2", 0.00023, "moment of inertia of the motor"},
    {J1, "J1", "J1_kgm2", "kg m2", 0.000517711, "moment of inertia of the load at the motor"},
    {T1, "T1", "T1_Nm", "Nm", 0.02538878, "friction torque of the load at the motor"},
    {Kw, "Kw", "Kw_V_s_per_rad", "V s/rad", 0.632298, "gain of the tacho generator"},
    {Ke, "Ke", "Ke_pulses_per_rad", "pulses/rad", 636.62, "pulses of the encoder per radian of the motor"},
    {Ks, "Ks", "Ks_mm_per_rad", "mm/rad", 1.2773, "travel of the slide per radian of the motor"},
    {pitch, "pitch", "pitch_mm", "mm", 8.0, "travel that the controller assumes for one turn of the encoder"},
    {dac_limit, "dac_limit", "dac_limit_V", "V", 10.0, "largest output of the D/A converter, either sign"},
}};

/// The tables that a model file may hold; here only their spelling is of interest.
const std::vector<std::string> kTables{"drive", "effect",  "candidate", "map",
                                       "known", "history", "name",      "compensated_readings"};

void take(TomlReader& reader, const toml::table& table, const DriveConstantInfo& info, DriveParameters& into) {
  const bool both = info.key != info.name && table.contains(info.key) && table.contains(info.name);
  if (both)
    return reader.complain(*table.get(info.name), "expected {} or {}, found both: omit one", info.name, info.key);
  const std::string_view key = table.contains(info.key) ? info.key : info.name;
  const auto value = reader.number(table, key);
  if (!value) return;
  if (!std::isfinite(*value) || *value <= 0.0)
    return reader.complain(*table.get(key), "{}: expected a positive number{}{}, found {}", key,
                           info.unit.empty() ? "" : " in ", info.unit, *value);
  into[info.id] = *value;
}

}  // namespace

const std::array<DriveConstantInfo, kDriveConstants>& drive_constants() { return kInfo; }

const DriveConstantInfo& info_of(DriveConstant constant) { return kInfo[index_of(constant)]; }

DriveParameters::DriveParameters() : value{} {
  for (const DriveConstantInfo& info : kInfo) value[index_of(info.id)] = info.printed;
}

Result<DriveParameters> parse_drive(std::string_view text, const std::string& file_name) {
  TomlReader reader(file_name);
  ECS_TRY(root, reader.parsed(text));
  reader.only(root, kTables, "model");
  DriveParameters drive;
  if (const toml::table* table = reader.child(root, "drive")) {
    std::vector<std::string> known;
    for (const DriveConstantInfo& info : kInfo)
      for (const std::string_view key : {info.key, info.name}) known.emplace_back(key);
    reader.only(*table, known, "drive");
    for (const DriveConstantInfo& info : kInfo) take(reader, *table, info, drive);
  }
  if (!reader.clean()) return tl::unexpected(reader.all());
  return drive;
}

Result<DriveParameters> read_drive(const std::filesystem::path& path) {
  ECS_TRY(text, read_file(path));
  return parse_drive(text, path.string());
}

namespace {

constexpr std::array<DriveSignalInfo, kDriveSignals> kSignals{{
    {DriveSignal::dac, "dac_V", "V", "output of the D/A converter"},
    {DriveSignal::tacho, "tacho_V", "V", "voltage of the tacho generator"},
    {DriveSignal::current, "motor_current_A", "A", "current of the motor"},
    {DriveSignal::speed, "motor_speed_rad_s", "rad/s", "speed of the motor"},
    {DriveSignal::slide, "slide_mm", "mm", "position of the slide"},
}};

/// State of the axis and a constant one, so that the equations are a matrix.
enum StateIndex : std::size_t { kError, kIntegral, kCurrent, kSpeed, kAngle, kOne };
constexpr std::size_t kSize = 6;
using State = std::array<double, kSize>;
using Matrix = std::array<State, kSize>;

State operator*(const Matrix& a, const State& x) {
  State y{};
  for (std::size_t i = 0; i < kSize; ++i)
    for (std::size_t j = 0; j < kSize; ++j) y[i] += a[i][j] * x[j];
  return y;
}

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < kSize; ++i)
    for (std::size_t k = 0; k < kSize; ++k)
      for (std::size_t j = 0; j < kSize; ++j) c[i][j] += a[i][k] * b[k][j];
  return c;
}

Matrix unit() {
  Matrix m{};
  for (std::size_t i = 0; i < kSize; ++i) m[i][i] = 1.0;
  return m;
}

/// Scaling: a norm below a quarter, where ten terms of the series leave 0.25^11/11! = 6e-15.
constexpr double kScaledNorm = 0.25;
constexpr int kTerms = 10;
/// A span below this share of a step is over.
constexpr double kOver = 1e-12;
/// Speed [rad/s] and current [A] beyond which the loop is unstable: a thousand times what any motor does.
constexpr double kRunawaySpeed = 1e6, kRunawayCurrent = 1e8;
/// Guards, in shares of what decides: beyond by rounding is not beyond; the converter leaves its limit later than it
/// reached it, so that it does not chatter.
constexpr double kBeyond = 1e-12, kHysteresis = 1e-9;
/// A crossing is found where the guard is above 0 by at most this, or the span that holds it is below this; every third
/// try halves, sixty tries end it in any case.
constexpr double kFound = 1e-11, kNarrow = 1e-13;
constexpr int kMostTries = 60, kHalvingEvery = 3;
constexpr double kSecondsAMinute = 60.0;

/// e^(a·t): Taylor series of a fraction small enough, squared back.
Matrix exponential(const Matrix& a, double t) {
  double norm = 0.0;
  for (const State& row : a) {
    double sum = 0.0;
    for (const double x : row) sum += std::abs(x * t);
    norm = std::max(norm, sum);
  }
  const int halvings = norm > kScaledNorm ? static_cast<int>(std::ceil(std::log2(norm / kScaledNorm))) : 0;
  const double part = std::ldexp(t, -halvings);
  Matrix sum = unit(), term = unit();
  for (int n = 1; n <= kTerms; ++n) {
    term = a * term;
    for (State& row : term)
      for (double& x : row) x *= part / n;
    for (std::size_t i = 0; i < kSize; ++i)
      for (std::size_t j = 0; j < kSize; ++j) sum[i][j] += term[i][j];
  }
  for (int n = 0; n < halvings; ++n) sum = sum * sum;
  return sum;
}

/// What the nonlinear elements are doing.
struct Mode {
  bool demanding = true;
  int limited = 0;   ///< D/A converter at its upper (1) or lower (-1) limit
  int friction = 0;  ///< sense of the motion it acts against; 0: the motor is at rest
  auto operator<=>(const Mode&) const = default;
};

class ServoAxis {
 public:
  ServoAxis(const DriveParameters& drive, const DriveMove& move, double step_s)
      : drive_(drive),
        demand_pulses_s_(std::copysign(move.feed_mm_min, move.distance_mm) / kSecondsAMinute *
                         drive[DriveConstant::Ke] * 2.0 * std::numbers::pi / drive[DriveConstant::pitch]),
        demand_s_(move.duration_s()),
        step_s_(step_s) {
    state_[kOne] = 1.0;
  }

  /// One step further; false: it ran away.
  bool advance() {
    double left = step_s_;
    constexpr int kMostEvents = 40;  // beyond them the rest of the step goes without
    for (int events = 0; left > kOver * step_s_; ++events) {
      double span = left;
      if (mode_.demanding) span = std::min(span, demand_s_ - time_s_);
      if (span <= kOver * step_s_) {
        mode_.demanding = false;
        continue;
      }
      State next = (span == step_s_ ? whole_step() : exponential(equations(mode_), span)) * state_;
      if (events < kMostEvents && guard(next) > 0.0) {
        span *= crossing(span);
        next = exponential(equations(mode_), span) * state_;
        state_ = next;
        switch_mode();
      } else {
        state_ = next;
      }
      time_s_ += span;
      left -= span;
      if (mode_.demanding && demand_s_ - time_s_ <= kOver * step_s_) mode_.demanding = false;
    }
    return std::abs(state_[kSpeed]) < kRunawaySpeed && std::abs(state_[kCurrent]) < kRunawayCurrent;
  }

  [[nodiscard]] std::array<double, kDriveSignals> signals() const {
    return {dac_V(state_), drive_[DriveConstant::Kw] * state_[kSpeed], state_[kCurrent], state_[kSpeed],
            drive_[DriveConstant::Ks] * state_[kAngle]};
  }

 private:
  [[nodiscard]] double limit() const { return drive_[DriveConstant::dac_limit]; }
  [[nodiscard]] double dac_V(const State& x) const {
    return std::clamp(drive_[DriveConstant::Kd] * x[kError], -limit(), limit());
  }

  /// dx/dt = A·x while the mode lasts.
  [[nodiscard]] Matrix equations(const Mode& mode) const {
    using enum DriveConstant;
    Matrix a{};
    a[kError][kSpeed] = -drive_[Ke];
    a[kError][kOne] = mode.demanding ? demand_pulses_s_ : 0.0;
    State velocity_error{};  // K·u − Kw·ω
    if (mode.limited == 0)
      velocity_error[kError] = drive_[K] * drive_[Kd];
    else
      velocity_error[kOne] = drive_[K] * mode.limited * limit();
    velocity_error[kSpeed] = -drive_[Kw];
    a[kIntegral] = velocity_error;
    for (std::size_t j = 0; j < kSize; ++j) a[kCurrent][j] = drive_[Ka] * velocity_error[j] / drive_[Tc];
    a[kCurrent][kIntegral] = drive_[Ka] / (drive_[Ti] * drive_[Tc]);
    a[kCurrent][kCurrent] = -1.0 / drive_[Tc];
    if (mode.friction != 0) {
      const double inertia = drive_[Jm] + drive_[J1];
      a[kSpeed][kCurrent] = drive_[Kt] / inertia;
      a[kSpeed][kOne] = -mode.friction * drive_[T1] / inertia;
    }
    a[kAngle][kSpeed] = 1.0;
    return a;
  }

  const Matrix& whole_step() {
    const auto [at, fresh] = steps_.try_emplace(mode_);
    if (fresh) at->second = exponential(equations(mode_), step_s_);
    return at->second;
  }

  /// Above 0 once the state has left its mode, in shares of the quantity that decides.
  [[nodiscard]] double limit_guard(const State& x) const {
    const double share = drive_[DriveConstant::Kd] * x[kError] / limit();
    return mode_.limited == 0 ? std::abs(share) - 1.0 - kBeyond : 1.0 - kHysteresis - mode_.limited * share;
  }
  [[nodiscard]] double friction_guard(const State& x) const {
    if (mode_.friction != 0) return -mode_.friction * x[kSpeed] - kBeyond;
    return std::abs(x[kCurrent]) * drive_[DriveConstant::Kt] / drive_[DriveConstant::T1] - 1.0 - kBeyond;
  }
  [[nodiscard]] double guard(const State& x) const { return std::max(limit_guard(x), friction_guard(x)); }

  /// Share of `span` after which the guard fails, just beyond.
  [[nodiscard]] double crossing(double span) const {
    const Matrix a = equations(mode_);
    double before = 0.0, after = 1.0;
    double g_before = guard(state_), g_after = guard(exponential(a, span) * state_);
    for (int n = 0; n < kMostTries && after - before > kNarrow; ++n) {
      double at = g_before < 0.0 ? before + (after - before) * g_before / (g_before - g_after) : 0.5 * (before + after);
      if (n % kHalvingEvery == kHalvingEvery - 1) at = 0.5 * (before + after);
      const double g = guard(exponential(a, at * span) * state_);
      (g > 0.0 ? after : before) = at;
      (g > 0.0 ? g_after : g_before) = g;
      if (g > 0.0 && g < kFound) break;
    }
    return after;
  }

  void switch_mode() {
    if (limit_guard(state_) > 0.0) mode_.limited = mode_.limited == 0 ? (state_[kError] > 0.0 ? 1 : -1) : 0;
    if (friction_guard(state_) <= 0.0) return;
    const double torque = drive_[DriveConstant::Kt] * state_[kCurrent];
    state_[kSpeed] = 0.0;
    mode_.friction = std::abs(torque) > drive_[DriveConstant::T1] ? (torque > 0.0 ? 1 : -1) : 0;
  }

  const DriveParameters& drive_;
  double demand_pulses_s_;
  double demand_s_;
  double step_s_;
  double time_s_ = 0.0;
  State state_{};
  Mode mode_;
  std::map<Mode, Matrix> steps_;
};

}  // namespace

const std::array<DriveSignalInfo, kDriveSignals>& drive_signals() { return kSignals; }

const DriveSignalInfo& info_of(DriveSignal signal) { return kSignals[index_of(signal)]; }

double DriveResponse::at(DriveSignal which, double time_s) const {
  const std::vector<double>& values = signal[index_of(which)];
  const double place = time_s / step_s;
  if (!(place > 0.0)) return values.front();
  const auto below = static_cast<std::size_t>(place);
  if (below + 1 >= values.size()) return values.back();
  return std::lerp(values[below], values[below + 1], place - static_cast<double>(below));
}

DriveResponse simulated(const DriveParameters& drive, const DriveMove& move, double duration_s, double step_s) {
  DriveResponse response;
  response.step_s = step_s;
  const auto steps = static_cast<std::size_t>(std::ceil(duration_s / step_s));
  for (auto& values : response.signal) values.reserve(steps + 1);
  ServoAxis axis(drive, move, step_s);
  for (std::size_t n = 0; n <= steps; ++n) {
    const auto now = axis.signals();
    for (std::size_t s = 0; s < kDriveSignals; ++s) response.signal[s].push_back(now[s]);
    if (n < steps && !axis.advance()) {
      response.bounded = false;
      break;
    }
  }
  return response;
}

}  // namespace ecs::model
