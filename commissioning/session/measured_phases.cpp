#include "commissioning/session/measured_phases.hpp"

#include <mutex>

namespace ecs::commissioning {
namespace {

std::mutex phases_guard;
MeasuredPhases phases_remembered;

}  // namespace

void remember_measured_phases(const MeasuredPhases& phases) {
  const std::lock_guard lock(phases_guard);
  phases_remembered = phases;
}

MeasuredPhases measured_phases() {
  const std::lock_guard lock(phases_guard);
  return phases_remembered;
}

}  // namespace ecs::commissioning
