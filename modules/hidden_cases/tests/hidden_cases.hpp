// Hidden cases as the tests ask for them.
#pragma once

#include "modules/hidden_cases/case.hpp"
#include "tests/support/test.hpp"

namespace ecs::emulator::test {

inline HiddenCaseRequest request_for(std::uint64_t seed, CaseKind kind, std::string_view effect = {}) {
  HiddenCaseRequest request{.seed = seed, .kind = kind, .effect = effect_named(effect), .readings = 150};
  return request;
}

inline HiddenCase case_of(const HiddenCaseRequest& request) { return must(draw_hidden_case(request)); }

}  // namespace ecs::emulator::test
