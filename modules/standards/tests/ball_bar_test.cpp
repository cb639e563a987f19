// Results of ball bars, made by hand from the names that a public reader uses: no real file was available.
#include "modules/standards/ball_bar.hpp"

#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::commissioning;

namespace {

std::string feature(const std::string& name, const std::string& type, const std::string& value) {
  return "<FEATURE NAME=\"" + name + "\" DT=\"" + type + "\">" + value + "</FEATURE>\n";
}

std::string ball_bar_xml(const std::string& features, const std::string& plane = "XY") {
  return "<?xml version=\"1.0\"?>\n<BALLBAR>\n<TEST_SPEC NAME=\"100 mm, 360 deg\"/>\n<PLANE TEST_PLANE=\"" + plane +
         "\"/>\n<DATE_STARTED>2026-05-04T09:30:00</DATE_STARTED>\n<MACHINE_TESTED>mill</MACHINE_TESTED>\n" + features +
         "</BALLBAR>\n";
}

BallBarResult result_of(const std::string& features, const std::string& plane = "XY") {
  return must(parse_ball_bar(ball_bar_xml(features, plane), "b.b5r"));
}

/// A circle of 100 mm with these causes.
CircleWork circle_with(std::vector<model::CircleFaultFound> faults) {
  CircleWork work;
  work.test.source = "circle.csv";
  work.test.radius_mm = 100.0;
  work.test.feed_mm_min = 1200.0;
  work.values.passes.resize(2);
  work.values.passes[0].G_um = 6.0;
  work.values.passes[1].G_um = 7.0;
  work.diagnosis.faults = std::move(faults);
  return work;
}

model::CircleFaultFound fault(const std::string& name, double value, const std::string& unit) {
  model::CircleFaultFound found;
  found.name = found.title = name;
  found.value = value;
  found.sigma = 0.1;
  found.unit = unit;
  return found;
}

const BallBarCause& cause_named(const BallBarComparison& compared, const std::string& name) {
  const auto at = std::find_if(compared.causes.begin(), compared.causes.end(),
                               [&](const BallBarCause& cause) { return cause.name == name; });
  REQUIRE_MESSAGE(at != compared.causes.end(), name);
  return *at;
}

bool notes_say(const BallBarComparison& compared, std::string_view words) {
  return std::any_of(compared.notes.begin(), compared.notes.end(),
                     [&](const std::string& note) { return contains(note, words); });
}

const std::string kSquare = feature("AF_SQUARENESS", "UT_SQUARENESS", "-20.5");

std::string refused_result(const std::string& xml) { return to_text(must_fail(parse_ball_bar(xml, "b.b5r"))); }

}  // namespace

TEST_CASE("plane, test, date, machine and values are read wherever they are in the file") {
  const auto result = result_of("<X><Y SERIAL_NUMBER=\"B1\">" + kSquare + "</Y></X>" +
                                    feature("AF_BACKLASH_A_POS", "UT_LENGTH_MM", "0.0031") +
                                    feature("AF_BEST_RUN", "UT_RANKING", "two"),
                                "ZX");
  CHECK(result.plane == std::array<Axis, 2>{Axis::Z, Axis::X});
  CHECK(result.test == "100 mm, 360 deg");
  CHECK(result.date == "2026-05-04T09:30:00");
  CHECK(result.machine == "mill");
  CHECK(result.serial_number == "B1");
  CHECK(result.calibrated.empty());
  REQUIRE(result.features.size() == 2);
  CHECK(result.features[0].value == -20.5);
  CHECK(result.features[0].unit == "um/m");
  CHECK(result.features[1].value == Approx(3.1));
  CHECK(result.features[1].unit == "um");
}

TEST_CASE("each cause has both values in one unit, and the difference of their sizes") {
  auto scale = fault("scale_mismatch:XY", 23.0, "um/m"), servo = fault("servo_mismatch:XY", 10.0, "um");
  const auto work = circle_with({scale, servo, fault("squareness:XY", 19.5, "um/m"), fault("backlash:Y", 2.0, "um"),
                                 fault("reversal_spike:X", -4.0, "um")});
  const auto compared =
      must(compared_with(work, result_of(kSquare + feature("AF_SCALE_MISMATCH", "UT_LENGTH_UM", "5.0") +
                                         feature("AF_SERVO_MISMATCH", "UT_SERVO_MISMATCH", "-0.4") +
                                         feature("AF_BACKLASH_B_POS", "UT_LENGTH_UM", "2.0") +
                                         feature("AF_BACKLASH_B_NEG", "UT_LENGTH_UM", "3.0") +
                                         feature("AF_REVERSAL_SPIKES_A_POS", "UT_LENGTH_UM", "5.0") +
                                         feature("AF_CIRCULARITY", "UT_LENGTH_UM", "7.5"))));
  const auto& squareness = cause_named(compared, "squareness:XY");
  CHECK(squareness.theirs == -20.5);
  CHECK(squareness.ours == 19.5);
  CHECK(squareness.ours_sigma == 0.1);
  CHECK(*squareness.difference == Approx(1.0));
  CHECK(only(squareness.features) == "AF_SQUARENESS -20.5 um/m");
  CHECK(*cause_named(compared, "scale_mismatch:XY").theirs == Approx(25.0));  // 5 um over a diameter of 0.2 m
  CHECK(*cause_named(compared, "scale_mismatch:XY").difference == Approx(2.0));
  const auto& lag = cause_named(compared, "servo_mismatch:XY");  // 1200 mm/min are 20 um a ms
  CHECK(*lag.ours == Approx(0.5));
  CHECK(*lag.ours_sigma == Approx(0.005));
  CHECK(*lag.difference == Approx(-0.1));
  CHECK(*cause_named(compared, "backlash:Y").theirs == Approx(2.5));
  CHECK(*cause_named(compared, "backlash:Y").difference == Approx(0.5));
  CHECK(cause_named(compared, "backlash:Y").features.size() == 2);
  CHECK(*cause_named(compared, "reversal_spike:X").difference == Approx(1.0));
  CHECK(*cause_named(compared, "circular_deviation:XY").ours == 7.0);
  CHECK(compared.not_compared.empty());
  CHECK(notes_say(compared, "never tested on a file of a real ball bar"));
  CHECK(notes_say(compared, "the signs of the ball bar's values are not documented"));
  CHECK(notes_say(compared, "divided by the diameter of 200 mm"));
}

TEST_CASE("a scale mismatch in ppm is one in um/m") {
  const auto compared =
      must(compared_with(circle_with({}), result_of(feature("AF_SCALE_MISMATCH", "UT_SCALE_ERROR", "12"))));
  CHECK(cause_named(compared, "scale_mismatch:XY").theirs == 12.0);
}

TEST_CASE("a side without a cause is empty, and values without a cause of ours are listed") {
  const auto compared = must(compared_with(circle_with({fault("straightness_s:X", 1.5, "um")}),
                                           result_of(kSquare + feature("AF_LATERAL_PLAY_A_POS", "UT_LENGTH_UM", "0.5") +
                                                     feature("AF_CYCLIC_ERROR_A_REV", "UT_LENGTH_UM", "0.8"))));
  const auto& theirs_alone = cause_named(compared, "squareness:XY");
  CHECK_FALSE(theirs_alone.ours);
  CHECK_FALSE(theirs_alone.difference);
  CHECK(cause_named(compared, "lateral_play:X").theirs == 0.5);
  const auto& ours_alone = cause_named(compared, "straightness_s:X");
  CHECK_FALSE(ours_alone.theirs);
  CHECK(ours_alone.ours == 1.5);
  CHECK(compared.causes.size() == 4);  // and the circular deviation
  CHECK(only(compared.not_compared) == "AF_CYCLIC_ERROR_A_REV 0.8 um");
}

TEST_CASE("periodic error and straightness are shown without a difference, the largest wave of an axis first") {
  const auto compared = must(compared_with(
      circle_with({fault("cyclic:X", 1.0, "um"), fault("cyclic:X", -2.5, "um"), fault("straightness:Y", 1.0, "um")}),
      result_of(feature("AF_CYCLIC_ERROR_A_FWD", "UT_LENGTH_UM", "5") +
                feature("AF_STRAIGHTNESS_B", "UT_LENGTH_UM", "2"))));
  CHECK(cause_named(compared, "cyclic:X").ours == -2.5);
  CHECK(cause_named(compared, "cyclic:X").theirs == 5.0);
  CHECK_FALSE(cause_named(compared, "cyclic:X").difference);
  CHECK_FALSE(cause_named(compared, "straightness:Y").difference);
  CHECK(notes_say(compared, "periodic error and straightness have no difference"));
  CHECK(compared.causes.size() == 4);  // the other wave too
}

TEST_CASE("without a feed our servo mismatch stays in um, in a note") {
  auto work = circle_with({fault("servo_mismatch:XY", 10.0, "um")});
  work.test.feed_mm_min.reset();
  const auto compared = must(compared_with(work, result_of(feature("AF_SERVO_MISMATCH", "UT_SERVO_MISMATCH", "0.4"))));
  CHECK_FALSE(cause_named(compared, "servo_mismatch:XY").ours);
  CHECK(notes_say(compared, "10.00 um here, which needs feed_mm_min"));
}

TEST_CASE("the axes of a plane may come in either order, another plane is refused with both named") {
  auto work = circle_with({fault("backlash:Z", 3.0, "um"), fault("squareness:XZ", 5.0, "um/m")});
  work.test.plane = {Axis::X, Axis::Z};
  const auto compared =
      must(compared_with(work, result_of(kSquare + feature("AF_BACKLASH_A_POS", "UT_LENGTH_UM", "3"), "ZX")));
  CHECK(cause_named(compared, "backlash:Z").theirs == 3.0);
  CHECK(cause_named(compared, "squareness:ZX").ours == 5.0);
  const auto other = result_of(kSquare, "YZ");
  CHECK(to_text(must_fail(compared_with(work, other))) ==
        "b.b5r: the ball bar test is in the plane YZ, but circle.csv in the plane XZ: give a ball bar test of the same "
        "circle");
}

TEST_CASE("dates that differ are named, dates in another order are not interpreted") {
  auto work = circle_with({});
  const auto theirs = result_of(kSquare);
  CHECK_FALSE(notes_say(must(compared_with(work, theirs)), "date"));
  work.test.metadata = {{"date", "2026-05-04"}};
  CHECK_FALSE(notes_say(must(compared_with(work, theirs)), "date"));
  work.test.metadata = {{"date", "2026-05-01"}};
  CHECK(notes_say(must(compared_with(work, theirs)), "the trace is dated 2026-05-01, the ball bar test 2026-05-04"));
  work.test.metadata = {{"date", "04/05/2026"}};
  CHECK(notes_say(must(compared_with(work, theirs)), "the dates are not compared"));
}

TEST_CASE("several values under one name are not chosen from") {
  const auto compared = must(
      compared_with(circle_with({}), result_of(kSquare + kSquare + feature("AF_BACKLASH_A_POS", "UT_LENGTH_UM", "3") +
                                               feature("AF_BACKLASH_A_POS", "UT_LENGTH_UM", "4"))));
  CHECK(cause_named(compared, "squareness:XY").theirs == -20.5);  // the same twice is one value
  CHECK_FALSE(cause_named(compared, "backlash:X").theirs);
  CHECK(notes_say(compared, "several values of one name (AF_BACKLASH_A_POS 3 um, AF_BACKLASH_A_POS 4 um)"));
}

TEST_CASE("broken results are refused with line, all at once") {
  const std::string said = refused_result(ball_bar_xml(feature("AF_SQUARENESS", "UT_SQUARENESS", "1,5") +
                                                           feature("AF_CIRCULARITY", "UT_ANGLE", "3") +
                                                           feature("AF_BACKLASH_A_POS", "UT_LENGTH_UM", "1e30"),
                                                       "XX"));
  check_holds(said, {"b.b5r:4: TEST_PLANE: expected two axes such as XY, YZ or ZX, found \"XX\"",
                     "b.b5r:7: AF_SQUARENESS: expected a number, found \"1,5\"",
                     "b.b5r:8: AF_CIRCULARITY: expected DT UT_LENGTH_UM or UT_LENGTH_MM, found \"UT_ANGLE\"",
                     "b.b5r:9: AF_BACKLASH_A_POS: expected a number, found \"1e30\""});
  CHECK(contains(refused_result(ball_bar_xml(kSquare + "<PLANE TEST_PLANE=\"YZ\"/>")), "expected one test in a file"));
  CHECK(contains(refused_result("<a/>"), "expected the result of a ball bar"));
  CHECK(contains(refused_result(ball_bar_xml(feature("AF_OTHER", "UT_LENGTH_UM", "3"))), "no known value"));
  CHECK(contains(refused_result("<!DOCTYPE a [<!ENTITY e \"1\">]>" + ball_bar_xml(kSquare)), "not XML"));
  CHECK(contains(refused_result("<!DOCTYPE BALLBAR [<!ENTITY e \"1\">]><BALLBAR/>"), "a document type declaration"));
}
