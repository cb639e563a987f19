#include "modules/standards/ball_bar.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "base/xml/xml.hpp"
#include "laser/findings.hpp"

namespace ecs::commissioning {
namespace {

using Features = std::vector<BallBarFeature>;

constexpr double kMostOfFeature = 1e9;  ///< in any unit

struct BallBarUnit {
  std::string_view data_type, unit;
};
constexpr BallBarUnit kBallBarUnits[] = {
    {"UT_LENGTH_UM", "um"},      {"UT_LENGTH_MM", "mm"},    {"UT_LENGTH_M", "m"},      {"UT_SQUARENESS", "um/m"},
    {"UT_SERVO_MISMATCH", "ms"}, {"UT_SCALE_ERROR", "ppm"}, {"UT_FEEDRATE", "mm/min"}, {"UT_ANGLE", "deg"},
    {"UT_PERCENT", "%"},         {"UT_SPEED", "mm/s"}};

std::string unit_of_type(std::string_view data_type) {
  const auto at = std::ranges::find(kBallBarUnits, data_type, &BallBarUnit::data_type);
  return at == std::end(kBallBarUnits) ? std::string() : std::string(at->unit);
}

/// A cause by the names of its features; {} is A or B.
struct KnownCause {
  std::string_view effect;  ///< as in CircleFaultFound::name, before the colon
  std::string_view title;
  std::string_view unit;  ///< of the comparison
  std::vector<std::string_view> names;
  bool of_axis = false;       ///< once for each axis
  bool same_quantity = true;  ///< else both are shown without a difference
};

const std::vector<KnownCause>& known_causes() {
  static const std::vector<KnownCause> kCauses{
      {"circular_deviation", "circular deviation", "um", {"AF_CIRCULARITY"}},
      {"scale_mismatch", "scale mismatch", "um/m", {"AF_SCALE_MISMATCH"}},
      {"squareness", "squareness", "um/m", {"AF_SQUARENESS"}},
      {"servo_mismatch", "servo mismatch", "ms", {"AF_SERVO_MISMATCH"}},
      {"backlash", "backlash of", "um", {"AF_BACKLASH_{}_POS", "AF_BACKLASH_{}_NEG"}, true},
      {"reversal_spike", "reversal spikes of", "um", {"AF_REVERSAL_SPIKES_{}_POS", "AF_REVERSAL_SPIKES_{}_NEG"}, true},
      {"lateral_play", "lateral play of", "um", {"AF_LATERAL_PLAY_{}_POS", "AF_LATERAL_PLAY_{}_NEG"}, true},
      {"cyclic", "periodic error of", "um", {"AF_CYCLIC_ERROR_{}_FWD"}, true, false},
      {"straightness", "straightness of", "um", {"AF_STRAIGHTNESS_{}"}, true, false}};
  return kCauses;
}

std::string feature_name(std::string_view form, std::size_t axis) {
  return fmt::format(fmt::runtime(form), axis == 0 ? 'A' : 'B');
}

/// The cause that a feature belongs to; null: none.
const KnownCause* cause_of(std::string_view name) {
  for (const KnownCause& cause : known_causes())
    for (const std::string_view form : cause.names)
      for (const std::size_t axis : {0U, 1U})
        if (name == feature_name(form, axis)) return &cause;
  return nullptr;
}

bool unit_fits(const KnownCause& cause, std::string_view unit) {
  const bool is_length = unit == "um" || unit == "mm";
  if (cause.effect == "scale_mismatch") return is_length || unit == "ppm";
  return cause.unit == "um" ? is_length : unit == cause.unit;
}

std::string expected_types(const KnownCause& cause) {
  if (cause.effect == "scale_mismatch") return "UT_LENGTH_UM, UT_LENGTH_MM or UT_SCALE_ERROR";
  if (cause.unit == "um") return "UT_LENGTH_UM or UT_LENGTH_MM";
  return cause.unit == "ms" ? "UT_SERVO_MISMATCH" : "UT_SQUARENESS";
}

std::optional<std::array<Axis, 2>> plane_in(std::string_view text) {
  const std::string name = upper(trimmed(text));
  if (name.size() != 2 || name[0] == name[1]) return std::nullopt;
  const auto first = axis_of(name[0]), second = axis_of(name[1]);
  if (!first || !second) return std::nullopt;
  return std::array<Axis, 2>{*first, *second};
}

/// Goes through all elements, wherever they are.
class BallBarReader {
 public:
  explicit BallBarReader(const std::string& file) : findings(file) { result.source = file; }

  void take(const XmlElement& element) {
    if (element.name == "PLANE") plane(element);
    if (element.name == "FEATURE") feature(element);
    if (element.name == "TEST_SPEC" && result.test.empty()) result.test = attribute_of(element, "NAME");
    named("DATE_STARTED", element, result.date);
    named("MACHINE_TESTED", element, result.machine);
    named("SERIAL_NUMBER", element, result.serial_number);
    named("LAST_CALIBRATED", element, result.calibrated);
    for (const XmlElement& child : element.children) take(child);
  }

  void finish() {
    if (!findings.empty()) return;
    if (!has_plane_)
      findings.add(0, 0,
                   "expected the result of a ball bar, with <PLANE TEST_PLANE=\"XY\">; found another XML document");
    else if (std::ranges::none_of(result.features, [](const auto& one) { return cause_of(one.name) != nullptr; }))
      findings.add(0, 0,
                   "no known value: expected elements such as <FEATURE NAME=\"AF_SQUARENESS\" DT=\"UT_SQUARENESS\">");
  }

  BallBarResult result;
  laser::Findings findings;

 private:
  /// An element, or an attribute of one.
  static void named(std::string_view name, const XmlElement& element, std::string& value) {
    if (!value.empty()) return;
    value = element.name == name ? element.text : std::string(attribute_of(element, name));
  }

  void plane(const XmlElement& element) {
    const std::string_view text = attribute_of(element, "TEST_PLANE");
    const auto plane = plane_in(text);
    if (!plane)
      findings.add(element.line, 0, "TEST_PLANE: expected two axes such as XY, YZ or ZX, found {}",
                   laser::in_quotes(text));
    else if (has_plane_ && *plane != result.plane)
      findings.add(element.line, 0, "TEST_PLANE: {} after {}: expected one test in a file", laser::plane_name(*plane),
                   laser::plane_name(result.plane));
    else
      result.plane = *plane;
    has_plane_ = true;
  }

  void feature(const XmlElement& element) {
    const std::string name = upper(attribute_of(element, "NAME"));
    const std::string type = upper(attribute_of(element, "DT"));
    BallBarFeature one{name, number_in(element.text).value_or(0.0), unit_of_type(type)};
    const bool is_number = number_in(element.text) && std::abs(one.value) <= kMostOfFeature;
    const KnownCause* cause = cause_of(name);
    if (cause != nullptr && !is_number)
      return findings.add(element.line, 0, "{}: expected a number, found {}", name, laser::in_quotes(element.text));
    if (cause != nullptr && !unit_fits(*cause, one.unit))
      return findings.add(element.line, 0, "{}: expected DT {}, found {}", name, expected_types(*cause),
                          laser::in_quotes(type));
    if (!is_number || !name.starts_with("AF_")) return;
    if (one.unit == "mm") one = {name, one.value * kUmPerMm, "um"};
    const bool there = std::ranges::any_of(
        result.features, [&](const auto& other) { return other.name == name && other.value == one.value; });
    if (!there) result.features.push_back(std::move(one));
  }

  bool has_plane_ = false;
};

std::string feature_text(const BallBarFeature& feature) {
  return fmt::format("{} {:.6g}{}{}", feature.name, feature.value, feature.unit.empty() ? "" : " ", feature.unit);
}

/// Their value of a cause in its unit; nothing where the file has none, or several of one name.
std::optional<double> their_value(const Features& features, const KnownCause& cause, double radius_mm) {
  if (features.empty()) return std::nullopt;
  double sum = 0.0;
  for (const BallBarFeature& one : features) {
    if (std::ranges::count(features, one.name, &BallBarFeature::name) > 1) return std::nullopt;
    // The difference of both travels, which are diameters; ppm are um/m.
    const bool of_diameter = cause.effect == "scale_mismatch" && one.unit == "um";
    sum += of_diameter ? one.value / (2.0 * radius_mm / kMmPerM) : one.value;
  }
  return sum / static_cast<double>(features.size());
}

/// um of the radial deviation for each ms by which one axis lags more than the other: the way at this feed.
double um_per_ms(double feed_mm_min) {
  constexpr double kMsPerMin = 60'000.0;
  return feed_mm_min * kUmPerMm / kMsPerMin;
}

/// "2026-05-04" of "2026-05-04T09:30"; nothing of a date in another order, which could be misread.
std::optional<std::string_view> iso_day(std::string_view text) {
  constexpr std::string_view kForm = "dddd-dd-dd";
  if (text.size() < kForm.size()) return std::nullopt;
  for (std::size_t i = 0; i < kForm.size(); ++i)
    if (kForm[i] == '-' ? text[i] != '-' : text[i] < '0' || text[i] > '9') return std::nullopt;
  return text.substr(0, kForm.size());
}

class BallBarComparer {
 public:
  BallBarComparer(const CircleWork& work, const BallBarResult& theirs) : work_(work), theirs_(theirs) {}

  [[nodiscard]] BallBarComparison compared() {
    for (const KnownCause& cause : known_causes())
      for (std::size_t axis = 0; axis < (cause.of_axis ? 2U : 1U); ++axis) add(cause, axis);
    for (const model::CircleFaultFound& fault : work_.diagnosis.faults)
      if (std::ranges::find(used_, &fault) == used_.end())
        made_.causes.push_back({fault.name, fault.title, fault.unit, {}, fault.value, fault.sigma, {}, {}});
    for (const BallBarFeature& feature : theirs_.features)
      if (cause_of(feature.name) == nullptr) made_.not_compared.push_back(feature_text(feature));
    add_notes();
    return std::move(made_);
  }

 private:
  void add(const KnownCause& cause, std::size_t axis) {
    const std::string where =
        cause.of_axis ? std::string(1, letter_of(theirs_.plane[axis])) : laser::plane_name(theirs_.plane);
    BallBarCause row{fmt::format("{}:{}", cause.effect, where),
                     fmt::format("{} {}", cause.title, where),
                     std::string(cause.unit),
                     {},
                     {},
                     {},
                     {},
                     {}};
    Features features;
    for (const std::string_view form : cause.names)
      for (const BallBarFeature& one : theirs_.features)
        if (one.name == feature_name(form, axis)) {
          features.push_back(one);
          row.features.push_back(feature_text(one));
        }
    row.theirs = their_value(features, cause, work_.test.radius_mm);
    if (!features.empty() && !row.theirs)
      made_.notes.push_back(fmt::format("{}: the file has several values of one name ({}); none was chosen", row.title,
                                        fmt::join(row.features, ", ")));
    ours(cause, where, row);
    if (row.theirs && row.ours && cause.same_quantity) row.difference = std::abs(*row.theirs) - std::abs(*row.ours);
    without_difference_ = without_difference_ || (row.theirs && row.ours && !cause.same_quantity);
    if (!features.empty() || row.ours) made_.causes.push_back(std::move(row));
  }

  void ours(const KnownCause& cause, const std::string& where, BallBarCause& row) {
    if (cause.effect == "circular_deviation") {
      double largest_um = 0.0;
      for (const laser::CirclePass& pass : work_.values.passes) largest_um = std::max(largest_um, pass.G_um);
      row.ours = largest_um;
      return;
    }
    const model::CircleFaultFound* fault = fault_of(cause, where);
    if (fault == nullptr) return;
    used_.push_back(fault);
    row.title = fault->title;
    row.ours = fault->value;
    row.ours_sigma = fault->sigma;
    if (cause.unit != "ms") return;
    if (const auto& feed_mm_min = work_.test.feed_mm_min) {
      row.ours = fault->value / um_per_ms(*feed_mm_min);
      row.ours_sigma = fault->sigma / um_per_ms(*feed_mm_min);
    } else {
      row.ours = row.ours_sigma = std::nullopt;
      made_.notes.push_back(fmt::format("{}: {:.2f} um here, which needs feed_mm_min in the trace to become ms",
                                        row.title, fault->value));
    }
  }

  /// The largest of that cause; of both axes in whichever order the trace names them.
  [[nodiscard]] const model::CircleFaultFound* fault_of(const KnownCause& cause, const std::string& where) const {
    const model::CircleFaultFound* largest = nullptr;
    for (const model::CircleFaultFound& fault : work_.diagnosis.faults) {
      const bool here = cause.of_axis ? fault.name == fmt::format("{}:{}", cause.effect, where)
                                      : fault.name.starts_with(fmt::format("{}:", cause.effect));
      if (here && (largest == nullptr || std::abs(fault.value) > std::abs(largest->value))) largest = &fault;
    }
    return largest;
  }

  void add_notes() {
    made_.notes.push_back(
        "the values of this file were identified by the names that an open-source program uses for them. This was "
        "never tested on a file of a real ball bar: compare the values with the report of the ball bar's own program");
    made_.notes.push_back(
        "difference: absolute value of the ball bar minus absolute value here, because the signs of the ball bar's "
        "values are not documented");
    if (without_difference_)
      made_.notes.push_back(
          "periodic error and straightness have no difference: whether the ball bar's values are amplitudes or peak to "
          "peak is not documented. The values here are amplitudes");
    if (std::ranges::any_of(made_.causes,
                            [](const auto& row) { return row.name.starts_with("scale_mismatch") && row.theirs; }))
      made_.notes.push_back(
          fmt::format("the ball bar's scale mismatch is the difference of the travels of both axes, divided by the "
                      "diameter of {:g} mm",
                      2.0 * work_.test.radius_mm));
    add_date_note();
  }

  void add_date_note() {
    const std::string date = laser::metadata_value(work_.test.metadata, "date").value_or("");
    if (date.empty() || theirs_.date.empty()) return;
    const auto ours = iso_day(date), day = iso_day(theirs_.date);
    if (!ours || !day)
      made_.notes.push_back(
          fmt::format("the dates are not compared: {} of the trace, {} of the ball bar test", date, theirs_.date));
    else if (*ours != *day)
      made_.notes.push_back(fmt::format(
          "the trace is dated {}, the ball bar test {}: the machine may have changed in between", *ours, *day));
  }

  const CircleWork& work_;
  const BallBarResult& theirs_;
  BallBarComparison made_;
  std::vector<const model::CircleFaultFound*> used_;
  bool without_difference_ = false;
};

}  // namespace

Result<BallBarResult> parse_ball_bar(std::string_view xml, const std::string& file) {
  ECS_TRY(root, parsed_xml(xml, file));
  BallBarReader reader(file);
  reader.take(root);
  reader.finish();
  if (!reader.findings.empty()) return tl::unexpected(reader.findings.as_problem());
  return std::move(reader.result);
}

Result<BallBarComparison> compared_with(const CircleWork& work, const BallBarResult& theirs) {
  const auto& ours = work.test.plane;
  const bool same = std::is_permutation(ours.begin(), ours.end(), theirs.plane.begin());
  if (!same)
    return problem_at(
        theirs.source, 0, 0,
        "the ball bar test is in the plane {}, but {} in the plane {}: give a ball bar test of the same circle",
        laser::plane_name(theirs.plane), work.test.source, laser::plane_name(ours));
  return BallBarComparer(work, theirs).compared();
}

}  // namespace ecs::commissioning
