// The unit's 19 inch sub-rack (thesis 5.2): which module sits in which slots, and an axis module as its registers show
// it: counter, speed, switch, latched marker. Does not live here: what the positions mean (unit.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/axis.hpp"
#include "core/parameters.hpp"
#include "ecs_emulator/machine/machine_tool.hpp"

namespace ecs::emulator {

class AxisModule {
 public:
  /// The counter begins at 0 wherever the axis stands.
  void power_up() { *this = AxisModule(); }

  /// One period.
  void take(const AxisSignals& signals);

  [[nodiscard]] std::int64_t counts() const { return signals_.counts - base_; }
  [[nodiscard]] std::int64_t marker_counts() const { return signals_.marker_counts - base_; }
  [[nodiscard]] bool marker() const { return signals_.marker; }
  [[nodiscard]] bool switch_closed() const { return signals_.switch_closed; }
  [[nodiscard]] bool transducer_ok() const { return signals_.transducer_ok; }
  /// Change in the last period.
  [[nodiscard]] std::int64_t step() const { return step_; }
  /// Counts per period, mean of the last eight.
  [[nodiscard]] double speed() const;
  /// A marker passed since this was last asked.
  [[nodiscard]] bool take_marker();

 private:
  static constexpr std::size_t kWindow = 8;
  AxisSignals signals_;
  bool begun_ = false;
  std::int64_t base_ = 0;
  std::int64_t step_ = 0;
  std::array<std::int64_t, kWindow> steps_{};
  std::size_t next_ = 0;
  bool marker_seen_ = false;
};

/// The axis modules of the rack by the transducer that they decode; nothing: no module for this axis.
using AxisModules = PerAxis<std::optional<Transducer>>;

/// Slots of 4 HP in a rack of 84 HP. The thesis gives 8 encoder or 5 resolver modules and 5 axis memory modules; that
/// they have ten and five slots of their own is our reading.
inline constexpr int kRackSlots = 21;

struct RackModule {
  std::string name;  ///< "microprocessor", "axis memory 1", "resolver axis X", …
  int first_slot = 1;
  int slots = 1;  ///< a resolver module is two boards, piggy-backed
};

/// Every module from the left. @pre 1 … 5 axis memory modules
[[nodiscard]] std::vector<RackModule> rack_of(std::uint8_t memory_modules, const AxisModules& axis_modules);

}  // namespace ecs::emulator
