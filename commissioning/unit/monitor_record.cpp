#include "commissioning/unit/monitor_record.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/file.hpp"
#include "core/fault.hpp"

namespace ecs::commissioning {

namespace {

namespace fs = std::filesystem;

/// Samples that come faster are brought to the disc together; none is older than a second when the next one comes.
constexpr std::chrono::milliseconds kOnDisc{500};

tl::unexpected<Problem> output_problem(const std::string& file, std::string why) {
  return tl::unexpected(Problem{ProblemKind::output, std::move(why), file, 0, 0, {}});
}

/// The header row, with its line end.
constexpr std::string_view kMonitorColumns =
    "time_s,mode,fault,axis,position_mm,speed_mm_min,referenced,switch,marker,approach,compensation_um,output_counts,"
    "relay_closed,t_air_degC,t_material_degC\n";

std::string field_of(const Surroundings& surroundings, std::string_view name) {
  for (const auto& [quantity, value] : surroundings.values)
    if (quantity == name) return fmt::format("{}", value);
  return {};
}

std::string monitor_rows(const protocol::MonitorSample& sample, const Surroundings& surroundings) {
  const std::string temperatures =
      fmt::format("{},{}", field_of(surroundings, "air_degC"), field_of(surroundings, "material_degC"));
  std::string rows;
  for (const Axis axis : kAllAxes) {
    const protocol::AxisSample& a = sample.axes[index_of(axis)];
    if (!a.present) continue;
    const std::string approach = a.approach == Approach::unknown ? "" : std::to_string(static_cast<int>(a.approach));
    rows += fmt::format("{:.6f},{},{},{},{},{},{:d},{:d},{:d},{},{},{},{:d},{}\n",
                        static_cast<double>(sample.unit_time_us) * 1e-6, ecs::name_of(sample.mode),
                        ecs::text_of(sample.fault).name, letter_of(axis), a.position_mm, a.speed_mm_min, a.referenced,
                        a.switch_active, a.marker, approach, a.compensation_um, a.output_counts, a.relay_closed,
                        temperatures);
  }
  return rows;
}

std::string counted(std::size_t samples) { return fmt::format("{} sample{}", samples, samples == 1 ? "" : "s"); }

}  // namespace

std::string MonitorRecording::summary() const { return fmt::format("{} written to {}", counted(samples_), name_); }

Result<MonitorRecording> MonitorRecording::begun(const std::string& file) {
  MonitorRecording made;
  made.name_ = file;
  made.target_ = led_to(file);
  std::error_code ignored;
  const auto status = fs::status(made.target_, ignored);
  if (fs::is_directory(status)) return output_problem(file, "cannot write: a folder of that name exists");
  const bool device = fs::is_other(status);
  if (!device) made.part_ = made.target_.string() + ".part";
  const int flags = O_WRONLY | O_CLOEXEC | O_NOCTTY | (device ? 0 : O_CREAT | O_EXCL);
  made.handle_ = ::open(device ? made.target_.c_str() : made.part_.c_str(), flags, 0666);
  if (made.handle_ < 0 && errno == EEXIST)
    return output_problem(made.part_.string(),
                          "already exists: another recording is running, or this file contains an interrupted "
                          "recording; rename or remove it");
  if (made.handle_ < 0) return output_problem(file, fmt::format("cannot write: {}", std::strerror(errno)));
  ECS_DO(made.write(kMonitorColumns));
  return made;
}

MonitorRecording::MonitorRecording(MonitorRecording&& from) noexcept
    : name_(std::move(from.name_)),
      target_(std::move(from.target_)),
      part_(std::move(from.part_)),
      handle_(std::exchange(from.handle_, -1)),
      samples_(from.samples_),
      on_disc_at_(from.on_disc_at_) {}

MonitorRecording::~MonitorRecording() { static_cast<void>(end()); }

Result<void> MonitorRecording::broken(int error) {
  if (handle_ >= 0) ::close(std::exchange(handle_, -1));
  const bool kept = !part_.empty() && samples_ > 0;
  if (!part_.empty() && !kept) disc::remove(part_);
  return output_problem(
      name_, fmt::format("cannot write: {}{}", std::strerror(error),
                         kept ? fmt::format("; {} contains {}", part_.string(), counted(samples_)) : std::string()));
}

Result<void> MonitorRecording::write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(handle_, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return broken(written < 0 ? errno : ENOSPC);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> MonitorRecording::add(const protocol::MonitorSample& sample, const Surroundings& surroundings) {
  if (auto written = write(monitor_rows(sample, surroundings)); !written) return written;
  ++samples_;
  const auto now = std::chrono::steady_clock::now();
  if (part_.empty() || now - on_disc_at_ < kOnDisc) return {};
  on_disc_at_ = now;
  if (::fdatasync(handle_) != 0) return broken(errno);
  return {};
}

Result<void> MonitorRecording::end() {
  if (handle_ < 0) return {};
  const bool on_disc = part_.empty() || ::fsync(handle_) == 0;
  const int error = errno;
  ::close(std::exchange(handle_, -1));
  if (part_.empty()) return {};
  std::error_code failed;
  if (samples_ == 0) {
    fs::remove(part_, failed);
    return {};
  }
  if (!on_disc) return broken(error);
  if (fs::exists(target_, failed)) fs::permissions(part_, fs::status(target_, failed).permissions(), failed);
  fs::rename(part_, target_, failed);
  if (failed) return broken(failed.value());
  return {};
}

}  // namespace ecs::commissioning
