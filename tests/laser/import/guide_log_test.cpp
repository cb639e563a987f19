// Guide logs of telescopes: distances and pulses to the error without guiding, moves of the lock position, dropped
// frames, and what a section needs. A whole night with its diagnosis: tests/model/diagnosis/telescope_test.cpp.
#include <numbers>

#include <fmt/format.h>

#include "tests/laser/support/import_options.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

constexpr double kArcsecOfAxis = 1e6 * std::numbers::pi / 180.0 / 3600.0;  // in um/m

const std::string kLogStart = "PHD2 version 2.6.10 [Windows], Log version 2.5. Log enabled at 2021-03-05 22:00:00\n\n";
const std::string kSectionBegins = "Guiding Begins at 2021-03-05 22:10:00\n";
const std::string kPixelScale = "Pixel scale = 2.00 arc-sec/px, Binning = 1, Focal length = 400 mm\n";
const std::string kMountLine =
    "Mount = EQ6, connected, guiding enabled, xAngle = 90.0, xRate = 4.000, yAngle = 0.0, yRate = 4.1, parity = "
    "Even/Odd\n";
const std::string kPointingLine =
    "RA = 7.21 hr, Dec = 60.0 deg, Hour angle = -2.00 hr, Pier side = West, Alt = 60.0 deg\n";
const std::string kFrameHeading =
    "Lock position = 400.000, 300.000, Star position = 400.1, 300.2, HFD = 3.10 px\n"
    "Frame,Time,mount,dx,dy,RARawDistance,DECRawDistance,RAGuideDistance,DECGuideDistance,RADuration,RADirection,"
    "DECDuration,DECDirection,XStep,YStep,StarMass,SNR,ErrorCode\n";
const std::string kSectionHead = kSectionBegins + kPixelScale + kMountLine + kPointingLine + kFrameHeading;

/// A pulse moves the star by 4 px/s.
std::string guide_frame(int number, double raw_px, int pulse_ms = 0, const char* direction = "") {
  return fmt::format("{},{:.3f},\"Mount\",0.1,0.2,{:.3f},9.9,{:.3f},0.0,{},{},300,N,,,4000,30.10,0\n", number,
                     240.0 * number, raw_px, (direction[0] == 'E' ? -0.004 : 0.004) * pulse_ms, pulse_ms, direction);
}

ImportOptions of_telescope() {
  ImportOptions options;
  options.takes_rotary = true;
  return options;
}

MeasurementSet read_log(const std::string& text) {
  const auto read = must(parse_any(kLogStart + text, "guide.txt", of_telescope()));
  CHECK(read.format->id == "guide_log");
  return read.set;
}

/// Errors in px of the camera, positive where the star is west of its place. At 60 deg a pixel is 4 arcsec of the axis.
std::vector<double> star_px(const MeasurementSet& set) {
  std::vector<double> all;
  for (const Reading& reading : set.readings)
    all.push_back(std::round(-1000.0 * reading.error / kArcsecOfAxis / 4.0) / 1000.0);
  return all;
}

std::string refused_log(const std::string& text, const ImportOptions& options = of_telescope()) {
  return to_text(must_fail(parse_any(kLogStart + text, "guide.txt", options)));
}

std::string notes_of(const MeasurementSet& set) { return fmt::format("{}", fmt::join(set.notes, "\n")); }

}  // namespace

TEST_CASE("a guide log becomes the error of the polar axis with the pulses given before each frame") {
  const auto set =
      read_log(kSectionHead + guide_frame(1, 0.5, 100, "W") + guide_frame(2, 0.2, 50, "E") + guide_frame(3, 0.3));
  CHECK(star_px(set) == std::vector{0.5, 0.6, 0.5});
  const Reading& last = set.readings.back();
  CHECK(last.rotary);
  CHECK(last.axis == Axis::Z);
  CHECK(last.sense == Sense::EC);
  CHECK(last.angle_deg[2] == Approx(-30.0 + 720.0 * 15.041067 / 3600.0).epsilon(1e-7));
  CHECK(*last.time_s == 720.0);
  CHECK(last.approach == Approach::forward);
  CHECK(metadata_value(set, "begun") == "2021-03-05 22:10:00.000");
  CHECK(contains(notes_of(set), "pulses in right ascension are added to the distances. Pulses: 2"));
  CHECK(contains(notes_of(set), "2 arc-sec/px, 4 px/s at 60 deg"));
  CHECK_FALSE(contains(notes_of(set), "dropped"));
}

TEST_CASE("a mount whose pulses go the other way round has the opposite error") {
  const auto set = read_log(replaced(kSectionHead, "Even/Odd", "Odd/Odd") + guide_frame(1, 0.5));
  CHECK(star_px(set) == std::vector{-0.5});
  CHECK(star_px(read_log(replaced(kSectionHead, "Even/Odd", "-/+") + guide_frame(1, 0.5))) == std::vector{-0.5});
}

TEST_CASE("calibration, dropped frames and lost stars are no readings, but their pulses count") {
  const std::string calibration =
      "Calibration Begins at 2021-03-05 22:05:00\nPixel scale = 9.00 arc-sec/px\nDirection,Step,dx,dy,x,y,Dist\n"
      "West,1,0.000,0.000,1335.000,901.000,0.000\nCalibration complete, mount = EQ6.\n\n";
  const std::string lost = replaced(guide_frame(3, 0.7, 100, "W"), "30.10,0", "2.10,7");
  const auto set = read_log(calibration + kSectionHead + guide_frame(1, 0.5) +
                            "2,480.000,\"DROP\",,,,,,,,,,,,,40,2.10,2,\"Star lost - low SNR\"\n" + lost +
                            guide_frame(4, 0.1) + "Guiding Ends at 2021-03-05 23:10:00\n\nLog closed at 2021-03-05\n");
  CHECK(star_px(set) == std::vector{0.5, 0.5});
  CHECK(contains(notes_of(set), "dropped frames that are omitted: 2"));
}

TEST_CASE("a dither is corrected by the move of the lock position, and frames while it settles are omitted") {
  const auto set = read_log(kSectionHead + guide_frame(1, 0.5) +
                            "INFO: SET LOCK POSITION, new lock pos = 400.000, 300.000\n"
                            "INFO: DITHER by 2.000, 1.000, new lock pos = 399.000, 302.000\n"
                            "INFO: SETTLING STATE CHANGE, Settling started\n" +
                            guide_frame(2, -1.5, 250, "E") + "INFO: SETTLING STATE CHANGE, Settling complete\n" +
                            guide_frame(3, -0.5));
  CHECK(star_px(set) == std::vector{0.5, 0.5});
  CHECK(set.readings.back().run == 1);
  CHECK(contains(notes_of(set), "frames omitted because guiding settled after a dither: 1"));
  CHECK(contains(notes_of(set), "dithers corrected by the move of the lock position: 1"));
}

TEST_CASE("a lock position that moves by an unknown amount begins a new run with a zero of its own") {
  for (const char* const move : {"INFO: SET LOCK POSITION, new lock pos = 410.000, 320.000\n",
                                 "INFO: DITHER by 2.000, 1.000, new lock pos = 399.000, 304.000\n"}) {
    const auto set = read_log(kSectionHead + guide_frame(1, 0.5, 100, "W") + move + guide_frame(2, 0.25));
    CHECK(star_px(set) == std::vector{0.5, 0.25});
    CHECK(set.readings.back().run == 2);
    CHECK(contains(notes_of(set), "by an unknown amount, each followed by a new run: 1"));
    CHECK(set.readings.front().extras.at("set_up") == 1.0);
    CHECK(set.readings.back().extras.at("set_up") == 2.0);
  }
}

TEST_CASE("every section has its own declination, zero, start and run") {
  const std::string other =
      replaced(replaced(kSectionHead, "Dec = 60.0", "Dec = 0.0"), "05 22:10:00", "06 00:10:00") + guide_frame(1, 0.5);
  const auto set = read_log(kSectionHead + guide_frame(1, 0.5, 100, "W") + replaced(other, "-2.00 hr", "N/A hr"));
  CHECK(star_px(set) == std::vector{0.5, 0.25});
  CHECK(set.readings.back().run == 2);
  CHECK(*set.readings.back().time_s == 7200.0 + 240.0);
  CHECK(set.readings.back().angle_deg[2] == Approx(240.0 * 15.041067 / 3600.0).epsilon(1e-7));
  CHECK(contains(notes_of(set), "xRate / cos(Dec) is from 8 to 16 arcsec/s in these sections"));
  CHECK(contains(notes_of(set), "sections that state no hour angle, whose targets start at 0 deg: 1"));
}

TEST_CASE("rates of early logs are px/ms, and pulses that do not fit the rate are noted") {
  const auto early =
      read_log(replaced(kSectionHead, "4.000", "0.004") + guide_frame(1, 0.5, 100, "W") + guide_frame(2, 0.1));
  CHECK(star_px(early) == std::vector{0.5, 0.5});
  CHECK(contains(notes_of(early), "4 px/s (stated per ms) at 60 deg"));
  const auto doubtful =
      read_log(replaced(kSectionHead, "4.000", "8.000") + guide_frame(1, 0.5, 100, "W") + guide_frame(2, 0.1));
  CHECK(contains(notes_of(doubtful), "line 3: xRate is 8 px/s, but RAGuideDistance / RADuration is 4 px/s"));
}

TEST_CASE("a section without scale, rate or declination is refused with its line and the remedy") {
  const std::string frames = kFrameHeading + guide_frame(1, 0.5);
  const std::string none = refused_log(kSectionBegins + frames);
  CHECK(contains(none, "guide.txt:3:1: expected a line Pixel scale = NUMBER arc-sec/px"));
  CHECK(contains(none, "guide.txt:3:1: expected a line Mount = ... with xRate = NUMBER"));
  CHECK(contains(none, "guide.txt:3:1: expected a line Dec = NUMBER deg"));
  CHECK(contains(refused_log(kSectionBegins + kPixelScale +
                             "Mount = EQ6, connected, guiding enabled, not calibrated, \n" + kPointingLine + frames),
                 "calibrate the mount before guiding"));
  CHECK(
      contains(refused_log(replaced(kSectionHead, "60.0 deg,", "88.0 deg,") + guide_frame(1, 0.5)), "at most 85 deg"));
  CHECK(star_px(read_log(kSectionBegins + kFrameHeading + "Guiding Ends at 2021-03-05 22:11:00\n\n" + kSectionHead +
                         guide_frame(1, 0.5)))
            .size() == 1);
}

TEST_CASE("frames that cannot be read are refused with line, column and remedy") {
  CHECK(contains(refused_log(kSectionHead + guide_frame(1, 0.5) + "2,480.000,\"Mount\",0.1"),
                 "guide.txt:10:1: expected at least 18 columns as in the heading, found 4"));
  ImportOptions cut = of_telescope();
  cut.accept_truncated = true;
  CHECK(
      must(parse_any(kLogStart + kSectionHead + guide_frame(1, 0.5) + "2,48", "guide.txt", cut)).set.readings.size() ==
      1);
  CHECK(contains(refused_log(kSectionHead + replaced(guide_frame(1, 0.5), "0.500", "west")),
                 "guide.txt:9:27: RARawDistance: expected a number of at most 100000, found \"west\""));
  CHECK(
      contains(refused_log(kSectionHead + guide_frame(1, 0.5, 100, "N")), "RADirection: expected E or W, found \"N\""));
  CHECK(contains(refused_log(kSectionHead + replaced(guide_frame(1, 0.5), "Mount", "AO")),
                 "its corrections are not pulses"));
  CHECK(contains(refused_log(kSectionHead + "INFO: LOCK SHIFT, enabled = 1 RA,Dec rate (1,1)\n"), "found LOCK SHIFT"));
  CHECK(contains(refused_log(replaced(kSectionHead, "RADuration", "Duration")),
                 "expected a column RADuration, found none"));
  CHECK(contains(refused_log(replaced(kSectionHead, "22:10:00", "soon") + guide_frame(1, 0.5)), "expected a date"));
  CHECK(contains(refused_log(kSectionHead + replaced(guide_frame(1, 0.5, 100, "W"), "0.400", "-0.400")),
                 "guide.txt:3:1: expected pulses to the west where RAGuideDistance is positive"));
  CHECK(contains(refused_log(kSectionHead), "expected frames in a section Guiding Begins, found none"));
}

TEST_CASE("a guide log is of a rotary axis, C unless another is given") {
  const std::string text = kSectionHead + guide_frame(1, 0.5);
  ImportOptions options = of_telescope();
  options.axis = Axis::X;
  CHECK(contains(refused_log(text, options), "give --axis A, B or C"));
  options.rotary = true;
  const auto set = must(parse_any(kLogStart + text, "guide.txt", options)).set;
  CHECK(curve_name(set.readings[0].sense, set.readings[0].axis, true) == "EAA");
  options.sense = Sense::EC;
  CHECK(contains(refused_log(text, options), "expected angles of the polar axis, EA, found the sense EC"));
}
