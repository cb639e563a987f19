// The kinematics modules that Debian's linuxcnc-uspace ships, called directly: the module is loaded as it is, and the
// few functions of HAL that it wants are given by this file. No real-time environment, no LinuxCNC that runs.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/axis.hpp"

namespace ecs::test {

/// Joints and pose as LinuxCNC counts them [mm, deg].
struct LinuxcncPose {
  Vector3 xyz_mm{};
  std::array<double, 3> abc_deg{};
};

class LinuxcncKinematics {
 public:
  /// Nothing if the module is not installed. One module of a name per program: its pins are its own.
  [[nodiscard]] static std::optional<LinuxcncKinematics> load(const std::string& module);

  /// A pin by the end of its name ("pivot-length"). @return whether there is one
  bool set(const std::string& pin, double value) const;
  /// For modules that begin as an identity.
  void switch_to(int type) const;
  [[nodiscard]] LinuxcncPose forward(const std::array<double, 9>& joints) const;

 private:
  void* module_ = nullptr;
  std::string name_;
};

}  // namespace ecs::test
