#include "ecs_emulator/thermal/screw_heat.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::emulator {

ScrewHeat::ScrewHeat(const ScrewSettings& settings, const std::array<double, 2>& travel_mm) : settings_(settings) {
  low_mm_ = std::min(travel_mm[0], settings.fixed_bearing_mm);
  const double length_mm = std::max(travel_mm[1], settings.fixed_bearing_mm) - low_mm_;
  const auto cells = static_cast<std::size_t>(std::max(1.0, std::floor(length_mm / settings.cell_mm)));
  cell_mm_ = std::max(length_mm, settings.cell_mm) / static_cast<double>(cells);
  cells_per_mm_ = 1.0 / cell_mm_;
  kept_ = std::exp(-1.0 / settings.loss_s);
  const double capacity_J_degC = settings.heat_capacity_J_per_m_degC * cell_mm_ * 1e-3;
  degC_per_J_ = -std::expm1(-1.0 / settings.loss_s) * settings.loss_s / capacity_J_degC;
  diffusion_ = settings.diffusivity_mm2_s / (cell_mm_ * cell_mm_);
  rise_degC_.assign(cells, 0.0);
  work_J_.assign(cells, 0.0);
}

void ScrewHeat::step() {
  double before = rise_degC_.front();  // of the cell below, as it was
  for (std::size_t i = 0; i < rise_degC_.size(); ++i) {
    const double here = rise_degC_[i];
    const double above = i + 1 < rise_degC_.size() ? rise_degC_[i + 1] : here;
    rise_degC_[i] = (here + diffusion_ * (before - 2.0 * here + above)) * kept_ + work_J_[i] * degC_per_J_;
    work_J_[i] = 0.0;
    before = here;
  }
}

double ScrewHeat::integral_to(double at_mm) const {
  const double place = std::clamp((at_mm - low_mm_) * cells_per_mm_, 0.0, static_cast<double>(rise_degC_.size()));
  const auto whole = static_cast<std::size_t>(place);
  double sum = 0.0;
  for (std::size_t i = 0; i < whole; ++i) sum += rise_degC_[i];
  if (whole < rise_degC_.size()) sum += rise_degC_[whole] * (place - static_cast<double>(whole));
  return sum * cell_mm_;
}

double ScrewHeat::growth_um(double at_mm, double common_degC) const {
  const double warm_mm_degC = integral_to(at_mm) - integral_to(settings_.fixed_bearing_mm) +
                              (common_degC - 20.0) * (at_mm - settings_.fixed_bearing_mm);
  return settings_.expansion_um_per_m_degC * warm_mm_degC * 1e-3;
}

}  // namespace ecs::emulator
