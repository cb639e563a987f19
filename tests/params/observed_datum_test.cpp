// The datum type and the switch states that a recorded sequence shows.
#include "params/observed_datum.hpp"

#include "tests/support/test.hpp"

namespace ecs::params {
namespace {

using Lack = ObservedDatum::Lack;

/// One sample a millimetre of travel; `turn` reverses the axis, 0: never.
struct Recorded {
  std::vector<DatumSample> samples;
  std::vector<double> speeds;
  Recorded(int first_closed, int last_closed, int marker, int turn = 0, int length = 40) {
    int mm = 0;
    for (int i = 0; i < length; ++i) {
      const int step = turn > 0 && i >= turn ? -1 : 1;
      samples.push_back({1000 * (mm += step), i >= first_closed && i <= last_closed, i == marker});
      speeds.push_back(600.0 * step);
    }
  }
  [[nodiscard]] ObservedDatum observed(bool moved = true) const {
    return observed_datum({samples, speeds, 1.0, moved});
  }
};

}  // namespace

TEST_CASE("a marker on the switch is siemens, behind it fanuc, on the way back allen_bradley") {
  const auto siemens = Recorded(10, 39, 20).observed();
  CHECK(siemens.lack == Lack::none);
  CHECK(siemens.kind == DatumKind::siemens);
  CHECK(siemens.finally_closed);
  CHECK(Recorded(10, 15, 20).observed().kind == DatumKind::fanuc);
  const auto back = Recorded(10, 25, 30, 18).observed();
  CHECK(back.turned_back);
  CHECK(back.kind == DatumKind::allen_bradley);
}

TEST_CASE("direction, speed and the state of the switch before it are those at its first change") {
  const auto seen = Recorded(10, 39, 20).observed();
  CHECK(seen.forward);
  CHECK(seen.approach_mm_min == 600.0);
  CHECK_FALSE(seen.initially_closed);
  CHECK(seen.marker == 20);
}

TEST_CASE("a record that cannot show the datum type says what it lacks") {
  CHECK(Recorded(10, 39, 20).observed(false).lack == Lack::motion);
  CHECK(Recorded(50, 60, 20).observed().lack == Lack::switch_change);
  CHECK(Recorded(10, 39, 5).observed().lack == Lack::marker);
  Recorded bounced(10, 15, 20);
  bounced.samples[30].switch_closed = true;
  CHECK(bounced.observed().lack == Lack::clear_start);
  CHECK(bounced.observed().switch_changes == 4);
}

TEST_CASE("the words of the datum types are those of parameter files") {
  CHECK(word_of(DatumKind::allen_bradley) == "allen_bradley");
  CHECK(word_of(DatumKind::siemens) == "siemens");
}

}  // namespace ecs::params
