// The result of a ball bar by its maker's program (.b5r, XML) beside ours of the same circle: another's verdict, read
// and never judged. Does not live here: the trace and our causes (circle_work.hpp), XML as such (base/xml).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "modules/standards/circle_work.hpp"

namespace ecs::commissioning {

/// A value of the file, under its name.
struct BallBarFeature {
  std::string name;  ///< "AF_BACKLASH_A_POS": A is the first axis of the plane, B the second
  double value = 0;  ///< in `unit`
  std::string unit;  ///< um, um/m, ms, ppm, … by its DT; empty: a DT that is not known
};

struct BallBarResult {
  std::string source;                                          ///< the file
  std::array<Axis, 2> plane{Axis::X, Axis::Y};                 ///< axes A and B
  std::string test, date, machine, serial_number, calibrated;  ///< as in the file; empty: not there
  std::vector<BallBarFeature> features;  ///< in file order, each name once unless its values differ
};

/// `PLANE TEST_PLANE=`, `FEATURE NAME= DT=` with the value as text, `TEST_SPEC NAME=`, DATE_STARTED, MACHINE_TESTED,
/// SERIAL_NUMBER, LAST_CALIBRATED, anywhere below the root: the names that a public reader of such files uses. No real
/// file was available. Refused, all at once: other XML, planes that are none or differ, known features that are no
/// number or in another unit; hostile XML as by base/xml.
[[nodiscard]] Result<BallBarResult> parse_ball_bar(std::string_view xml, const std::string& file);

/// One cause by both. A side that does not have it is empty.
struct BallBarCause {
  std::string name;  ///< as of CircleFaultFound: "backlash:X"; "circular_deviation", "lateral_play:X"
  std::string title;
  std::string unit;              ///< of all three: um, um/m, ms
  std::optional<double> theirs;  ///< the mean where the file has a value for each side
  std::optional<double> ours, ours_sigma;
  std::optional<double> difference;   ///< |theirs| − |ours|, because the signs of theirs are not documented
  std::vector<std::string> features;  ///< theirs as in the file: "AF_BACKLASH_A_POS 3.1 um"
};

struct BallBarComparison {
  std::vector<BallBarCause> causes;
  std::vector<std::string> not_compared;  ///< features without a cause of ours, as `BallBarCause::features`
  std::vector<std::string> notes;         ///< what is assumed, what differs
};

/// Refused (bad_input): a plane of other axes than the trace has.
[[nodiscard]] Result<BallBarComparison> compared_with(const CircleWork& work, const BallBarResult& theirs);

}  // namespace ecs::commissioning
