#include "commissioning/measurements/environment_watch.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "commissioning/measurements/device_choice.hpp"
#include "devices/port.hpp"

namespace ecs::commissioning {
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
std::pair<const char*, const char*> words_of(devices::Quantity quantity) {
  switch (quantity) {
    case devices::Quantity::air_degC:
      return {"air", "degC"};
    case devices::Quantity::material_degC:
      return {"material", "degC"};
    case devices::Quantity::pressure_hPa:
      return {"pressure", "hPa"};
    case devices::Quantity::humidity_pct:
      return {"humidity", "%"};
    default:
      return {"gauge", "um"};
  }
}

}  // namespace

EnvironmentWatch::EnvironmentWatch(std::string device, double every_s) {
  thread_ = std::jthread(
      [this, device = std::move(device), every_s](const std::stop_token& stop) { run(stop, device, every_s); });
}

EnvironmentWatch::~EnvironmentWatch() {
  thread_.request_stop();
  thread_.join();
}

Surroundings EnvironmentWatch::now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void EnvironmentWatch::tell(Surroundings now) {
  const std::lock_guard lock(mutex_);
  now_ = std::move(now);
}

void EnvironmentWatch::run(const std::stop_token& stop, const std::string& device, double every_s) {
  while (!stop.stop_requested()) {
    auto port = opened_device(device, devices::DeviceKind::environment);
    if (!port) {
      tell({"", {}, ecs::to_text(port.error())});
      pause(stop, kBeforeNextTry);
      continue;
    }
    const std::string name = name_of(*port);
    devices::Sensor sensor(std::move(*port), every_s);
    while (!stop.stop_requested()) {
      (void)sensor.look(steady_s());
      sensor.attend(steady_s());
      Surroundings now{name, sensor.values(steady_s(), std::max(kOldest_s, 3.0 * every_s)), {}};
      if (!sensor.port().present()) now = {name, {}, name + " was unplugged; it is read again once it is back"};
      tell(std::move(now));
      pause(stop, kStep);
    }
  }
}

std::string to_text(const Surroundings& surroundings) {
  if (!surroundings.problem.empty()) return surroundings.problem;
  if (surroundings.values.empty())
    return surroundings.device.empty() ? "looking for the sensor" : surroundings.device + ": no value yet";
  std::string text;
  for (const auto& [quantity, value] : surroundings.values) {
    const auto [what, unit] = words_of(quantity);
    text += fmt::format("{}{} {:.2f} {}", text.empty() ? "" : ", ", what, value, unit);
  }
  return text;
}

}  // namespace ecs::commissioning
