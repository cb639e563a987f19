// Part programs and deviations of parts (tests/fuzz/text_fuzz.cpp says how).
#include "base/text.hpp"
#include "modules/controllers/corrected_program.hpp"
#include "modules/controllers/part_deviations.hpp"
#include "tests/fuzz/parsers.hpp"

namespace ecs::fuzz {
namespace {

using namespace ecs::controllers;

/// Lines and words give the bytes back; what is corrected by nothing stays as it is, and what is corrected by something
/// is read and understood again.
void part_program(std::string_view text) {
  const auto read = parse_part_program(text, kFile);
  if (!was_read(read)) return;
  std::string again;
  for (const ProgramLine& line : read->lines) {
    again += line.text + line.end;
    for (const ProgramWord& word : line.words) {
      check_finite(word.value);
      check(word.at + word.size <= line.text.size());
    }
  }
  check(again == text);
  ProgramSettings settings;
  for (auto& start : settings.start_mm) start = 0.0;
  for (double& deadband : settings.deadband_mm) deadband = 0.005;
  settings.work_offset_mm[54] = {1.0, 2.0, 3.0};
  settings.tool_length_mm[1] = 50.0;
  settings.tolerance_um = 1000.0;
  settings.sample_mm = 1e5;
  const auto nothing = [](const std::vector<ProgramPlace>& places) {
    return std::vector<std::optional<Vector3>>(places.size(), Vector3{});
  };
  const auto made = corrected_program(*read, settings, nothing, {});
  if (!was_read(made)) return;
  const auto bend = [](const std::vector<ProgramPlace>& places) {
    std::vector<std::optional<Vector3>> found;
    for (const ProgramPlace& place : places) {
      for (const double mm : place.machine.position_mm) check_finite(mm);
      found.push_back(Vector3{place.machine.position_mm[1] > 0.0 ? 2000.0 : -2000.0, 500.0, -500.0});
    }
    return found;
  };
  const auto bent = corrected_program(*read, settings, bend, "x");
  const bool long_feeds = text.find("93") != std::string_view::npos;  // F of a short piece grows without limit
  if (was_read(bent) && !long_feeds) check(was_read(parse_part_program(bent->text, kFile)));
}

void part_deviations(std::string_view text) {
  const auto read = parse_part_deviations(text, kFile);
  if (!was_read(read)) return;
  check(!read->points.empty());
  for (const MeasuredPoint& point : read->points) {
    all_finite(point.nominal_mm);
    all_finite(point.deviation_um);
    const auto there = read->at(point.nominal_mm, 20.0);
    check(there.has_value());
    all_finite(*there);
  }
}

const AddedParsers kPrograms{{"part_program", part_program}, {"part_deviations", part_deviations}};

}  // namespace
}  // namespace ecs::fuzz
