#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "commissioning/unit/monitor_record.hpp"
#include "modules/capture/capture.hpp"
#include "modules/capture/description.hpp"
#include "modules/capture/port.hpp"

namespace ecs::commissioning {
namespace {

struct Named {
  std::string name;
  std::string which;  ///< serial number or path; empty: not said
};

Named parts_of(const std::string& text) {
  const std::size_t at = text.rfind('@');
  if (at == std::string::npos || at == 0 || disc::exists(text)) return {text, {}};
  return {text.substr(0, at), text.substr(at + 1)};
}

void narrow(devices::DeviceDescription& device, const std::string& which) {
  if (which.empty()) return;
  if (which.front() == '/')
    device.match.path = which;
  else
    device.match.serial = which;
}

}  // namespace

Result<std::vector<devices::DeviceDescription>> described(const std::string& text) {
  const Named named = parts_of(text);
  std::vector<devices::DeviceDescription> found = devices::builtin_named(named.name);
  std::error_code error;
  if (found.empty() || std::filesystem::exists(named.name, error)) {
    auto read = devices::read_device(named.name);
    if (!read) {
      Problem why = read.error();
      if (!std::filesystem::exists(named.name, error))
        why.message +=
            "; expected a device description: `ecs laser devices --learn` makes one for a trigger, samples/devices has "
            "one of each kind, \"temper\" is included with the program";
      return tl::unexpected(std::move(why));
    }
    found = {std::move(*read)};
  }
  for (devices::DeviceDescription& device : found) narrow(device, named.which);
  return found;
}

Result<devices::DevicePort> opened_device(const std::string& text, devices::DeviceKind kind) {
  const auto devices = described(text);
  if (!devices) return tl::unexpected(devices.error());
  ECS_TRY(present, devices::hid_devices());
  const devices::DeviceDescription* chosen = &devices->front();
  for (const devices::DeviceDescription& device : *devices) {
    if (device.kind != kind)
      return problem(ProblemKind::usage, "{}: expected a device of kind {}, this is one of kind {}", text,
                     devices::name_of(kind), devices::name_of(device.kind));
    if (devices::matching(device, present)) chosen = &device;
  }
  return devices::DevicePort::open(*chosen);
}

std::string name_of(const devices::DevicePort& port) {
  return fmt::format("{} ({})", port.device().name, devices::to_text(port.identity()));
}

namespace {

using namespace std::chrono_literals;

constexpr auto kStep = 50ms;
constexpr auto kBeforeNextTry = 1s;
constexpr double kOldest_s = 10.0;

void pause(const std::stop_token& stop, std::chrono::milliseconds span) {
  for (const auto end = std::chrono::steady_clock::now() + span;
       !stop.stop_requested() && std::chrono::steady_clock::now() < end;)
    std::this_thread::sleep_for(20ms);
}

/// "t_air_degC" without what everybody knows: "air".
constexpr WordTable<devices::Quantity, 5> kWhat{{"air", "material", "pressure", "humidity", "gauge"}};
constexpr WordTable<devices::Quantity, 5> kUnits{{"degC", "degC", "hPa", "%", "um"}};

/// The values by their names, and in words.
Surroundings surroundings_of(const std::string& device, const devices::Values& values) {
  Surroundings now{device, {}, {}, values.empty() ? device + ": no value yet" : ""};
  for (const auto& [quantity, value] : values) {
    now.values.emplace_back(devices::name_of(quantity), value);
    now.text +=
        fmt::format("{}{} {:.2f} {}", now.text.empty() ? "" : ", ", kWhat.of(quantity), value, kUnits.of(quantity));
  }
  return now;
}

class EnvironmentWatch final : public SurroundingsWatch {
 public:
  EnvironmentWatch(const std::string& device, double every_s)
      : thread_([this, device, every_s](const std::stop_token& stop) { run(stop, device, every_s); }) {}

  [[nodiscard]] Surroundings now() const override {
    const std::lock_guard lock(mutex_);
    return now_;
  }

 private:
  void run(const std::stop_token& stop, const std::string& device, double every_s);
  void tell(Surroundings now) {
    const std::lock_guard lock(mutex_);
    now_ = std::move(now);
  }

  mutable std::mutex mutex_;
  Surroundings now_{"", {}, {}, "looking for the sensor"};
  std::jthread thread_;  ///< its end stops it and waits for it
};

void EnvironmentWatch::run(const std::stop_token& stop, const std::string& device, double every_s) {
  const auto tell_problem = [this](const std::string& name, const std::string& why) { tell({name, {}, why, why}); };
  while (!stop.stop_requested()) {
    auto port = opened_device(device, devices::DeviceKind::environment);
    if (!port) {
      tell_problem("", ecs::to_text(port.error()));
      pause(stop, kBeforeNextTry);
      continue;
    }
    const std::string name = name_of(*port);
    devices::Sensor sensor(std::move(*port), every_s);
    while (!stop.stop_requested()) {
      (void)sensor.look(steady_s());
      sensor.attend(steady_s());
      if (sensor.port().present())
        tell(surroundings_of(name, sensor.values(steady_s(), std::max(kOldest_s, 3.0 * every_s))));
      else
        tell_problem(name, name + " was unplugged; reading continues when it is plugged in");
      pause(stop, kStep);
    }
  }
}

}  // namespace

std::unique_ptr<SurroundingsWatch> environment_watch(const std::string& device, double every_s) {
  return std::make_unique<EnvironmentWatch>(device, every_s);
}

namespace {

constexpr double kQuiet_s = 1.0;  ///< after the last release
constexpr std::size_t kUsualReport = 64;

struct Watched {
  devices::HidIdentity identity;
  devices::HidDevice device;
  std::vector<devices::TimedReport> reports;
  [[nodiscard]] bool numbered() const { return identity.reports.numbered; }
  [[nodiscard]] std::size_t report_bytes() const {
    std::size_t longest = 0;
    for (const auto& entry : identity.reports.input) longest = std::max(longest, entry.second);
    return longest == 0 ? kUsualReport : longest;
  }
};

bool is_meant(const devices::HidIdentity& one, const std::string& device) {
  return device.empty() || one.path == device || one.serial == device ||
         lower(device) == fmt::format("{:04x}:{:04x}", one.vendor_id, one.product_id);
}

Result<std::vector<Watched>> opened(const LearnChoice& choice) {
  ECS_TRY(present, devices::hid_devices());
  std::vector<Watched> watched;
  std::vector<Problem> problems;
  for (const devices::HidIdentity& identity : present) {
    if (!is_meant(identity, choice.device)) continue;
    auto device = devices::HidDevice::open(identity);
    if (device)
      watched.push_back({identity, std::move(*device), {}});
    else
      problems.push_back(device.error());
  }
  if (!watched.empty()) return watched;
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return problem(
      ProblemKind::link,
      present.empty()
          ? "no HID device is plugged in: plug the trigger in, then try again"
          : fmt::format("no HID device matches \"{}\": `ecs laser devices` lists paths, ids and serial numbers",
                        choice.device));
}

/// Reads what is there; false: the device is gone.
bool take_reports(Watched& one) {
  while (true) {
    auto report = one.device.read(one.report_bytes(), std::chrono::milliseconds(0));
    if (!report) return false;
    if (!*report) return true;
    one.reports.push_back({steady_s(), std::move(**report)});
  }
}

int most_presses(const std::vector<Watched>& watched) {
  int most = 0;
  for (const Watched& one : watched) most = std::max(most, devices::presses_seen(one.reports, one.numbered()));
  return most;
}

double last_report_s(const std::vector<Watched>& watched) {
  double last = 0.0;
  for (const Watched& one : watched)
    if (devices::presses_seen(one.reports, one.numbered()) > 0) last = std::max(last, one.reports.back().time_s);
  return last;
}

bool user_left(Keyboard* keyboard) {
  const auto line = keyboard == nullptr ? std::nullopt : keyboard->line();
  return line && lower(trimmed(*line)) == "q";
}

Result<void> watch(MessageSink& messages, Keyboard* keyboard, const LearnChoice& choice,
                   std::vector<Watched>& watched) {
  const double begin_s = steady_s();
  int told = 0;
  while (!interrupted() && steady_s() - begin_s < choice.timeout_s) {
    for (Watched& one : watched)
      if (!take_reports(one))
        return problem(ProblemKind::link, "{} was unplugged during learning: plug it in, then learn again",
                       devices::to_text(one.identity));
    if (user_left(keyboard)) return problem(ProblemKind::refused, "quit: no trigger was learned");
    const int seen = std::min(most_presses(watched), choice.presses);
    if (seen > told) messages.note(fmt::format("{} of {}", told = seen, choice.presses));
    if (seen >= choice.presses && steady_s() - last_report_s(watched) > kQuiet_s) return {};
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return {};
}

/// The one device in which something changed.
Result<const Watched*> pressed_one(const std::vector<Watched>& watched) {
  std::vector<const Watched*> changed;
  for (const Watched& one : watched)
    if (devices::presses_seen(one.reports, one.numbered()) > 0) changed.push_back(&one);
  if (changed.size() == 1) return changed.front();
  if (changed.empty())
    return watched.size() == 1 ? Result<const Watched*>(&watched.front())
                               : problem(ProblemKind::refused,
                                         "no device sent a change: check that the trigger is plugged in; `ecs laser "
                                         "devices` lists the devices");
  std::string names;
  for (const Watched* one : changed) names += (names.empty() ? "" : "; ") + devices::to_text(one->identity);
  return problem(ProblemKind::refused,
                 "several devices sent something: {}. Touch only the trigger, or choose one with --device", names);
}

bool has_twin(const std::vector<Watched>& watched, const Watched& mine) {
  return std::count_if(watched.begin(), watched.end(), [&](const Watched& one) {
           return one.identity.vendor_id == mine.identity.vendor_id &&
                  one.identity.product_id == mine.identity.product_id &&
                  one.identity.interface == mine.identity.interface;
         }) > 1;
}

}  // namespace

Result<LearnedDevice> learn_device(MessageSink& messages, Keyboard* keyboard, const LearnChoice& choice) {
  ECS_TRY(watched, opened(choice));
  messages.note(fmt::format("press and release the trigger {} times, half a second each; {} device{} watched",
                            choice.presses, watched.size(), watched.size() == 1 ? " is" : "s are"));
  ECS_DO(watch(messages, keyboard, choice, watched));
  if (interrupted()) return problem(ProblemKind::refused, "no trigger was learned");
  ECS_TRY(one, pressed_one(watched));
  const devices::HidIdentity& identity = one->identity;
  const auto found = devices::learned(one->reports, choice.presses, one->numbered());
  if (!found) {
    Problem why = found.error();
    why.message = devices::to_text(identity) + ": " + why.message;
    return tl::unexpected(std::move(why));
  }
  LearnedDevice out;
  out.bounce_ms = found->bounce_ms;
  devices::DeviceDescription& device = out.description;
  device.name = !choice.name.empty() ? choice.name : identity.product.empty() ? "trigger" : identity.product;
  device.source =
      fmt::format("learned {} from {} presses of {}", now_utc(), choice.presses, devices::to_text(identity));
  device.kind = devices::DeviceKind::trigger;
  device.match.ids = {{identity.vendor_id, identity.product_id}};
  if (identity.interface >= 0) device.match.interface = identity.interface;
  if (!identity.serial.empty() && has_twin(watched, *one)) device.match.serial = identity.serial;
  device.report.number = found->report_number;
  device.report.bytes = found->report_bytes;
  device.trigger = found->trigger;
  return out;
}

}  // namespace ecs::commissioning
