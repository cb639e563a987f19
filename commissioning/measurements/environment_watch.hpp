// A thermometer or another sensor of the surroundings, watched beside a monitor: a thread of its own opens it, reads
// it, and opens it again when it was pulled out. No TaskRunner runs it: it has neither an end nor a result.
#pragma once

#include <mutex>
#include <string>
#include <thread>

#include "devices/description.hpp"

namespace ecs::commissioning {

/// What is known of the surroundings at one moment.
struct Surroundings {
  std::string device;      ///< empty: not open yet
  devices::Values values;  ///< at most some seconds old; empty: none
  std::string problem;     ///< why there are none; empty: there are, or the first are awaited
};

class EnvironmentWatch {
 public:
  /// @param device  as --environment takes it: "temper", "room.toml@SERIAL"
  /// @param every_s  between two readings
  EnvironmentWatch(std::string device, double every_s);
  ~EnvironmentWatch();
  EnvironmentWatch(const EnvironmentWatch&) = delete;
  EnvironmentWatch& operator=(const EnvironmentWatch&) = delete;

  [[nodiscard]] Surroundings now() const;

 private:
  void run(const std::stop_token& stop, const std::string& device, double every_s);
  void tell(Surroundings now);

  mutable std::mutex mutex_;
  Surroundings now_;
  std::jthread thread_;
};

/// "air 20.50 degC, material 19.25 degC", or why there is nothing to say.
[[nodiscard]] std::string to_text(const Surroundings& surroundings);

}  // namespace ecs::commissioning
