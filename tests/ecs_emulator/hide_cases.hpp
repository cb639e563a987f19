// Cases of the proving ground as its tests ask for them.
#pragma once

#include <optional>

#include <doctest/doctest.h>

#include "ecs_emulator/hidden_cases/files.hpp"

namespace ecs::emulator::test {

inline HideRequest request_for(std::uint64_t seed, CaseKind kind, std::optional<EffectKind> effect = {}) {
  HideRequest request;
  request.seed = seed;
  request.kind = kind;
  request.effect = effect;
  request.readings = 150;
  return request;
}

inline HiddenCase case_of(const HideRequest& request) {
  auto made = hide_case(request);
  REQUIRE_MESSAGE(made.has_value(), (made ? "" : to_text(made.error())));
  return *made;
}

}  // namespace ecs::emulator::test
