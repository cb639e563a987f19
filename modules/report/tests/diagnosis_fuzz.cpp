// Saved answers of a diagnosis (tests/fuzz/text_fuzz.cpp says how).
#include <array>

#include "modules/report/diagnosis.hpp"
#include "tests/fuzz/parsers.hpp"

namespace ecs::fuzz {

const AddedParsers kReport("diagnosis", [](std::string_view text) {
  const auto read = app::parse_diagnosis(text, kFile);
  if (!was_read(read)) return;
  check(!read->headline.empty());
  all_finite(std::array{read->rms_um, read->noise_um});
  check_finite(read->rms_after_um);
  for (const app::ReportedEffect& one : read->effects)
    all_finite(std::array{one.rms_after_um, one.explained, one.held_out_before_um, one.held_out_after_um});
  for (const app::ReportedDependence& one : read->where) check_finite(one.strength);
});

}  // namespace ecs::fuzz
