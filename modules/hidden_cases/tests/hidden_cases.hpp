// Hidden cases as the tests ask for them.
#pragma once

#include <string_view>

#include <doctest/doctest.h>

#include "ecs_emulator/effects/definition.hpp"
#include "modules/hidden_cases/case.hpp"

namespace ecs::emulator::test {

inline HiddenCaseRequest request_for(std::uint64_t seed, CaseKind kind, std::string_view effect = {}) {
  HiddenCaseRequest request;
  request.seed = seed;
  request.kind = kind;
  request.effect = effect_named(effect);
  request.readings = 150;
  return request;
}

inline HiddenCase case_of(const HiddenCaseRequest& request) {
  auto made = draw_hidden_case(request);
  REQUIRE_MESSAGE(made.has_value(), (made ? "" : to_text(made.error())));
  return *made;
}

}  // namespace ecs::emulator::test
