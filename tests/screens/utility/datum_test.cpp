// Datum sequences recorded, tested and shown.
#include "app/screens/utility/screens.hpp"
#include "base/file.hpp"
#include "commissioning/unit/transfer.hpp"
#include "commissioning/utility/datum_view.hpp"
#include "tests/screens/support/utility_bench.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

/// The parameters of the sample mill in the unit.
void send_mill(const UnitBench& bench) {
  const auto file = must(params::read_parameters("samples/mill/parameters.toml"));
  REQUIRE(bench.with_link([&](UnitLink& link) { return send_parameters(link.client(), file.parameters, {}); }));
}

TEST_CASE("ten seconds are recorded while the emulated machine references the axis, and the graph opens") {
  const BenchOf bench(datum_record_screen);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)picture(screen);
  CHECK(contains(after(screen, "\n"), "Record axis X for 10 seconds?"));
  REQUIRE(shows_after(screen, "y", "REFERENCE AXIS X NOW: press g"));
  (void)picture(screen);
  (void)letter(screen, 'g');
  std::unique_ptr<Screen> graph;
  for (int k = 0; k < 3000 && !graph; ++k) {
    (void)screen.advance();
    graph = screen.opens_by_itself();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  REQUIRE(graph);
  const std::string seen = picture(*graph);
  CHECK(contains(seen, "Axis X, just recorded, unit MCM-0107"));
  const std::string events = after(*graph, "\t");
  check_holds(events,
              {"switch closes", "direction: forward", "contact was open at the last marker", "Datum type fanuc"});
}

TEST_CASE("a record is cancelled by Esc, and the next one works") {
  const BenchOf bench(datum_record_screen);
  Screen& screen = *bench.screen;
  REQUIRE(shows_after(screen, "z\ny", "REFERENCE AXIS Z NOW"));
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::stay);
  REQUIRE(shows(screen, "Cancelled."));
  REQUIRE(shows_after(screen, "\ny", "REFERENCE AXIS Z NOW"));
}

TEST_CASE("kill -9 of the emulator while it records: it is said, and recording works when it is back") {
  const BenchOf bench(datum_record_screen);
  Screen& screen = *bench.screen;
  REQUIRE(shows_after(screen, "\ny", "REFERENCE AXIS X NOW"));
  CHECK(kill_emulators() == 1);
  REQUIRE(shows(screen, "Press Enter to record axis X."));
  (void)picture(screen);
  REQUIRE(shows(screen, "MCM-0107, integration"));
  REQUIRE(shows_after(screen, "\ny", "REFERENCE AXIS X NOW"));
}

TEST_CASE("every axis finds its datum with the parameters of the mill, stage by stage") {
  const BenchOf bench(datum_test_screen);
  send_mill(bench);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)picture(screen);
  CHECK(contains(after(screen, "\n"), "Test the datum routine of X, Y, Z?"));
  REQUIRE(shows_after(screen, "y", "REFERENCE AXIS X NOW"));
  REQUIRE(shows(screen, "waiting ..."));
  REQUIRE(shows_after(screen, "g", "Every axis that was tested found its datum."));
  CHECK(contains(picture(screen), "[x] Z      DATUM FOUND"));
}

TEST_CASE("an axis that fails says what to do, the others go on") {
  const BenchOf bench(datum_test_screen);  // without parameters Y is looked for in the wrong direction
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  CHECK(contains(after(screen, "x\n"), "Test the datum routine of Y, Z?"));
  REQUIRE(shows_after(screen, "y", "REFERENCE AXIS Y NOW"));
  REQUIRE(shows_after(screen, "g", "One axis failed"));
  const std::string seen = picture(screen);
  check_holds(seen, {"[ ] X      not tested", "[x] Y      FAILED",
                     "Y: wrong direction. What to do: change the approach direction"});
}

TEST_CASE("kill -9 of the emulator under a datum test: it is said, and the test works when it is back") {
  const BenchOf bench(datum_test_screen);
  send_mill(bench);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  REQUIRE(shows_after(screen, "\ny", "waiting ..."));
  CHECK(kill_emulators() == 1);
  REQUIRE(shows(screen, "cancelled"));
  (void)picture(screen);
  REQUIRE(shows(screen, "MCM-0107, integration"));
  REQUIRE(shows_after(screen, "\ny", "REFERENCE AXIS X NOW"));
  REQUIRE(shows_after(screen, "g", "Every axis that was tested found its datum."));
}

/// Ten seconds at 1 kHz: from `start_s` on 1000 mm/min, switch closed for a second from the second after on, 300 mm/min
/// from there, a marker a second after the switch opened, standing from then on. 1 um a count.
DatumRecording sequence(double start_s, double sign = 1.0) {
  DatumRecording r{.axis = Axis::Y, .taken = "2026-05-04T14:05:09Z", .serial_number = "MILL-1"};
  double mm = 0.0;
  for (int k = 0; k < 10'000; ++k) {
    const double t = k * 1e-3 - start_s;
    const double mm_min = t < 0.0 || t >= 3.0 ? 0.0 : (t < 1.0 ? 1000.0 : 300.0);
    mm += sign * mm_min / 60.0 * 1e-3;
    DatumSample sample{.counts = static_cast<std::int32_t>(std::lround(mm * 1e3)),
                       .switch_closed = t >= 1.0 && t < 2.0,
                       .marker = k == static_cast<int>((start_s + 2.999) * 1e3)};
    r.samples.push_back(sample);
  }
  return r;
}

/// Its graph.
struct ViewCase : StateFolder {
  std::unique_ptr<Screen> screen = datum_view_screen(sequence(2.0));
};

std::string line_with(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part);
  if (at == std::string::npos) return {};
  const std::size_t begin = text.rfind('\n', at) + 1;
  return text.substr(begin, text.find('\n', at) - begin);
}

void advance_for_half_a_second(Screen& screen) {
  for (int k = 0; k < 100; ++k) {
    (void)screen.advance();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

TEST_CASE(
    "the switch fills its lane for as long as it is closed, the marker shows even where it is one sample of ten "
    "thousand") {
  const ViewCase one;
  Screen& screen = *one.screen;
  const std::string seen = picture(screen, 24, 80, Glyphs::ascii);
  check_holds(seen, {"Axis Y, just recorded, unit MILL-1, 2026-05-04 14:05 UTC, NOT SAVED", "mm/min"});
  const std::string switches = line_with(seen, "switch");
  CHECK(count_of(switches, '#') >= 6);  // a tenth of 69 columns
  CHECK(count_of(switches, '#') <= 8);
  const std::string markers = line_with(seen, "marker");
  CHECK(count_of(markers, '|') == 1);
  // lanes stand below the time at which they belong: the switch closes at 3 s of 10 s
  CHECK(switches.find('#') == Approx(1 + 9 + 0.3 * 69).epsilon(0.05));
}

TEST_CASE("the cursor reads time, speed, position, switch and marker") {
  const StateFolder folder;
  const ShownRecord record = shown(sequence(2.0), "");
  CHECK(read_out_at(record, 3.5) == "3.500 s  Y 300.0 mm/min  19.1720 mm  switch closed");
  CHECK(contains(read_out_at(record, 4.999), "switch open  MARKER"));
  CHECK(contains(read_out_at(record, 11.0), "nothing recorded"));
  const auto screen_made = datum_view_screen(sequence(2.0));
  Screen& screen = *screen_made;
  (void)press(screen, Key::Name::right);
  CHECK(contains(picture(screen), " s  Y "));
  (void)press(screen, Key::Name::left);
  CHECK(contains(picture(screen), "4.856 s  Y 300.0 mm/min"));
}

TEST_CASE("zoom halves what is seen around the cursor, 0 shows all") {
  const StateFolder folder;
  SeenTime seen;
  seen.show_all(shown(sequence(2.0), ""), nullptr);
  CHECK(seen.to_s == Approx(9.999));
  seen.go_to(3.0);
  seen.zoom(0.5);
  CHECK(seen.from_s == Approx(0.5).epsilon(0.01));
  CHECK(seen.to_s == Approx(5.5).epsilon(0.01));
  seen.zoom(0.5);
  CHECK(seen.to_s - seen.from_s == Approx(2.5).epsilon(0.01));
  const auto screen_made = datum_view_screen(sequence(2.0));
  Screen& screen = *screen_made;
  const std::string all = picture(screen);
  (void)press(screen, Key::Name::right);
  CHECK(after(screen, "+") != all);
  CHECK(after(screen, "0") == all);
}

TEST_CASE("the record says what it means for the datuming parameters") {
  const StateFolder folder;
  const auto hints = datuming_hints(shown(sequence(2.0, -1.0), ""));
  REQUIRE(hints.size() == 4);
  CHECK(contains(hints[0], "direction: reverse"));
  CHECK(contains(hints[1], "contact was open before"));
  CHECK(contains(hints[2], "contact was open at the last marker, 4.999 s"));
  CHECK(contains(hints[3], "Datum type fanuc"));
  DatumRecording standing = sequence(2.0);
  for (DatumSample& sample : standing.samples) sample.counts = 0;
  CHECK(contains(datuming_hints(shown(standing, "")).front(), "did not move"));
}

TEST_CASE("a record is saved, opened again, and a second is laid over it; the two differ without colour") {
  const ViewCase one;
  const std::string file = one / "first.csv", other = one / "other.csv";
  REQUIRE(write_file(other, to_csv(sequence(4.0))));
  Screen& screen = *one.screen;
  CHECK_FALSE(screen.unsaved().empty());
  type(screen, "s");
  replace_line(screen, file);
  REQUIRE(shows(screen, "written: "));
  CHECK(screen.unsaved().empty());
  CHECK(read_recording_file(file)->samples == sequence(2.0).samples);
  REQUIRE(shows_after(screen, "v" + other + "\n", "other.csv is the second"));
  const std::string seen = picture(screen, 24, 80, Glyphs::ascii);
  check_holds(seen, {"switch 2", "marker 2", "^", "v"});
  CHECK(contains(after(screen, "a"), "shifted by -2.000 s"));
  (void)press(screen, Key::Name::right);
  CHECK(contains(picture(screen), "2: "));
  CHECK_FALSE(contains(after(screen, "x"), "switch 2"));
}

TEST_CASE("an unsaved record is offered again") {
  const StateFolder folder;
  {
    const auto screen_made = datum_view_screen(sequence(2.0));
    Screen& screen = *screen_made;
    advance_for_half_a_second(screen);
    CHECK(press(screen, Key::Name::escape).kind == Step::Kind::stay);
    CHECK(press(screen, Key::Name::escape).kind == Step::Kind::back);
  }
  const auto again_made = datum_view_screen();
  Screen& again = *again_made;
  CHECK(contains(picture(again), "Unsaved record of"));
  CHECK(contains(after(again, "\n"), "NOT SAVED"));
  const auto once_more_made = datum_view_screen();
  Screen& once_more = *once_more_made;
  CHECK(contains(after(once_more, "dn"), "Unsaved record of"));
  CHECK_FALSE(contains(after(once_more, "dy"), "Unsaved record of"));
  CHECK(unsaved_record_of().empty());
}

TEST_CASE("a file that is not a record is refused and nothing is lost") {
  const ViewCase one;
  REQUIRE(write_file(one / "bad.csv", "hello\n"));
  Screen& screen = *one.screen;
  REQUIRE(shows_after(screen, "v" + (one / "bad.csv") + "\n", "expected the columns"));
  CHECK(contains(picture(screen), "Axis Y, just recorded"));
}

TEST_CASE("no size of the terminal breaks the picture") {
  const ViewCase one;
  Screen& screen = *one.screen;
  for (const auto& [rows, columns] : {std::pair{3, 10}, {12, 40}, {24, 80}, {40, 120}}) {
    (void)picture_of(screen, "", {}, Canvas(rows, columns), false);
    (void)press(screen, Key::Name::tab);
    (void)picture_of(screen, "", {}, Canvas(rows, columns), true);
  }
}

}  // namespace
}  // namespace ecs::app
