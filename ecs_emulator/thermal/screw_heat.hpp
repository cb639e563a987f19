// A ball screw that its nut warms where it travels: local, first order, with slow conduction along the screw.
// Does not live here: the air around it (day.hpp), which axes have one (heat.hpp).
#pragma once

#include <vector>

#include "core/axis.hpp"

namespace ecs::emulator {

/// `[screw.X]`
struct ScrewSettings {
  Axis axis = Axis::X;
  double fixed_bearing_mm = 0.0;            ///< coordinate of the nut at the bearing that holds the screw
  double expansion_um_per_m_degC = 11.5;    ///< steel
  double friction_N = 0.0;                  ///< nut and bearings: force whose work becomes heat
  double friction_N_per_m_min = 0.0;        ///< its part that grows with speed
  double heat_capacity_J_per_m_degC = 0.0;  ///< of a metre of screw; above 0
  double loss_s = 1800.0;                   ///< time constant of the loss to the air; above 0
  double diffusivity_mm2_s = 12.0;          ///< steel
  double cell_mm = 20.0;                    ///< above 0
  bool positions = true;                    ///< the feedback is on the screw: what it grows is error
};

/// Diffusion in explicit steps of one second is stable, and no temperature overshoots, up to this diffusivity / cell².
inline constexpr double kMostDiffusion_per_s = 0.25;

/// Temperature of the screw above that of a screw at rest, in cells along the travel.
class ScrewHeat {
 public:
  /// @param travel_mm  of the axis; the screw reaches from the fixed bearing over all of it
  ScrewHeat(const ScrewSettings& settings, const std::array<double, 2>& travel_mm);

  /// The nut went from … to within `period_s`: what it rubs warms the cell it is in with the next step.
  void moved(double from_mm, double to_mm, double period_s) {
    const double way_mm = to_mm > from_mm ? to_mm - from_mm : from_mm - to_mm;
    if (way_mm == 0.0) return;
    const double m_min = way_mm / period_s * 0.06;
    work_J_[cell_at(to_mm)] += way_mm * 1e-3 * (settings_.friction_N + settings_.friction_N_per_m_min * m_min);
  }
  /// One second passes: dT/dt = work / capacity − T/τ + a ∂²T/∂x², no heat through the ends.
  void step();

  [[nodiscard]] double rise_degC(double at_mm) const { return rise_degC_[cell_at(at_mm)]; }
  /// What the rise and a temperature common to the whole screw add to the place of the nut:
  /// coefficient · ∫ (T − 20 °C) dx from the fixed bearing.
  [[nodiscard]] double growth_um(double at_mm, double common_degC) const;
  [[nodiscard]] const ScrewSettings& settings() const { return settings_; }

 private:
  [[nodiscard]] std::size_t cell_at(double at_mm) const {
    const double place = (at_mm - low_mm_) * cells_per_mm_;
    if (!(place > 0.0)) return 0;
    const auto cell = static_cast<std::size_t>(place);
    return cell < rise_degC_.size() ? cell : rise_degC_.size() - 1;
  }
  /// ∫ of the rise from the low end [mm·degC].
  [[nodiscard]] double integral_to(double at_mm) const;

  ScrewSettings settings_;
  double low_mm_ = 0.0;
  double cell_mm_ = 1.0;
  double cells_per_mm_ = 1.0;
  double kept_ = 1.0;        ///< part of the rise that a second leaves
  double degC_per_J_ = 0.0;  ///< of work spread over one second
  double diffusion_ = 0.0;
  std::vector<double> rise_degC_;
  std::vector<double> work_J_;
};

}  // namespace ecs::emulator
