// Guide logs of telescopes (PHD2, and programs that write its form): the error of the polar axis without guiding. What
// a log holds is what guiding left; the distances plus all pulses given before are what the mount alone would have
// done.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/time.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

constexpr double kSiderealDay_s = 86164.0905;
constexpr double kSidereal_deg_s = 360.0 / kSiderealDay_s;  ///< 15.041 arcsec/s
constexpr double kDegPerHour = 15.0;                        ///< of hour angle
constexpr double kArcsecPerDegree = 3600.0;
constexpr double kMsPerSecond = 1000.0;
/// Logs of early versions have px/ms: no mount is as slow in px/s.
constexpr double kSlowest_px_s = 0.05;
/// Nearer to the pole a pixel is too large an angle of the axis.
constexpr double kMostDeclination_deg = 85.0;
/// The move of the lock position and the amount of a dither are rounded, and the camera's angle to 0.1 deg.
constexpr double kSameMove_px = 0.1;
/// Share by which the pulses of a section may differ from its rate: they are whole milliseconds.
constexpr double kSameRate = 0.1;
/// Limits of numbers in a log, far beyond those of any mount.
constexpr double kMost_px = 1e5, kMost_ms = 1e6, kMost_s = 1e6;

/// The number behind `key` in a line of `KEY = NUMBER unit, …`.
std::optional<double> stated_in(std::string_view line, std::string_view key) {
  const std::size_t at = line.find(key);
  if (at == std::string_view::npos) return std::nullopt;
  const auto words = blank_words(split(line.substr(at + key.size()), ',').front());
  return words.empty() ? std::nullopt : number_in(words.front());
}

std::optional<double> within(std::optional<double> number, double least, double greatest) {
  return number && *number >= least && *number <= greatest ? number : std::nullopt;
}

/// Of the camera.
struct Pixel {
  double x_px = 0.0, y_px = 0.0;
};

/// "…, new lock pos = 80.807, 203.220".
std::optional<Pixel> pixel_in(std::string_view line, std::string_view key) {
  const std::size_t at = line.find(key);
  if (at == std::string_view::npos) return std::nullopt;
  const auto parts = split(line.substr(at + key.size()), ',');
  if (parts.size() < 2) return std::nullopt;
  const auto x = within(number_in(parts[0]), -kMost_px, kMost_px), y = within(number_in(parts[1]), -kMost_px, kMost_px);
  return x && y ? std::optional(Pixel{*x, *y}) : std::nullopt;
}

/// Of a table of frames, in the order of `kFrameColumns`.
enum FrameColumn : std::size_t { kTime, kMount, kRaw, kGuided, kDuration, kDirection, kErrorCode };
constexpr std::array<std::string_view, 7> kFrameColumns{"Time",       "mount",       "RARawDistance", "RAGuideDistance",
                                                        "RADuration", "RADirection", "ErrorCode"};
using FramePlaces = std::array<std::size_t, kFrameColumns.size()>;

struct Frame {
  double time_s = 0.0;
  double raw_px = 0.0;            ///< of the star from the lock position, positive where a pulse to the west follows
  double guided_px = 0.0;         ///< by which the pulse moves the star
  double pulse_ms = 0.0;          ///< to the west; negative to the east
  bool star_was_measured = true;  ///< else the frame was dropped
};

/// From "Guiding Begins" to "Guiding Ends".
struct GuidedSection {
  int line = 0;
  double start_s = 0.0;  ///< since the start of 1970
  std::optional<double> scale_arcsec_px, rate_px_s, declination_deg, hour_angle_h, camera_angle_deg;
  bool is_rate_per_ms = false;
  bool moves_east = false;  ///< a pulse to the west does: parity Odd
  std::optional<Pixel> lock;
  std::optional<FramePlaces> places;
  std::vector<double> seen_rates_px_s;  ///< of each pulse, positive to the west where the star is west
};

class GuideLogReader {
 public:
  GuideLogReader(const std::string& file_name, const ImportOptions& options, Axis axis)
      : options_(options), axis_(axis), findings_(file_name) {
    set_.source = file_name;
  }

  void take(int number, std::string_view line) {
    if (line.starts_with("Guiding Begins at ")) {
      begin(number, line.substr(line.find(" at ") + 4));
    } else if (line.starts_with("Guiding Ends") || line.starts_with("Calibration Begins") ||
               line.starts_with("Log closed")) {
      end();
    } else if (section_ && line.starts_with("Frame,")) {
      take_columns(number, line);
    } else if (section_ && !section_->places) {
      take_head(line);
    } else if (section_ && line.starts_with("INFO: ")) {
      take_event(number, line.substr(6));
    } else if (section_ && !line.empty() && line.front() >= '0' && line.front() <= '9') {
      take_frame(number, line);
    }
  }

  Result<MeasurementSet> result() {
    end();
    if (findings_.empty() && set_.readings.empty())
      findings_.add(0, 0,
                    "expected frames in a section Guiding Begins, found none: guide for some periods of the worm");
    if (!findings_.empty()) return tl::unexpected(findings_.as_problem());
    add_notes();
    if (set_.readings.back().run > 1)
      for (Reading& reading : set_.readings) reading.extras["set_up"] = reading.run;
    number_rows(set_);
    return std::move(set_);
  }

 private:
  void begin(int number, std::string_view date) {
    end();
    const auto start = seconds_in(trimmed(date));
    if (!start || date_time_text(*start).empty())
      findings_.add(number, 1, "expected a date as in 2021-03-05 22:10:00, found {}", in_quotes(date));
    section_.emplace().line = number;
    section_->start_s = start.value_or(0.0);
    is_settling_ = is_dithered_ = has_moved_ = is_head_checked_ = is_usable_ = false;
    begin_run();
  }

  void end() {
    if (section_ && !section_->seen_rates_px_s.empty()) check_rate();
    section_.reset();
  }

  /// With a zero of its own.
  void begin_run() {
    run_ = set_.readings.empty() ? 1 : set_.readings.back().run + 1;
    unguided_px_ = 0.0;
  }

  void take_head(std::string_view line) {
    GuidedSection& section = *section_;
    if (line.starts_with("Pixel scale = ")) {
      section.scale_arcsec_px = within(stated_in(line, "Pixel scale = "), 1e-3, 1e3);
    } else if (line.starts_with("Mount = ")) {
      section.rate_px_s = within(stated_in(line, ", xRate = "), 1e-6, 1e4);
      section.is_rate_per_ms = section.rate_px_s && *section.rate_px_s < kSlowest_px_s;
      if (section.is_rate_per_ms) *section.rate_px_s *= kMsPerSecond;
      section.camera_angle_deg = within(stated_in(line, ", xAngle = "), -360.0, 360.0);
      section.moves_east = line.find("parity = Odd") != std::string_view::npos ||  // written "-" by versions before
                           line.find("parity = -") != std::string_view::npos;
    } else if (line.find("Hour angle = ") != std::string_view::npos) {
      section.declination_deg = within(stated_in(line, "Dec = "), -kMostDeclination_deg, kMostDeclination_deg);
      section.hour_angle_h = within(stated_in(line, "Hour angle = "), -24.0, 24.0);
    } else if (line.starts_with("Lock position = ")) {
      section.lock = pixel_in(line, "Lock position = ");
    }
  }

  void take_columns(int number, std::string_view line) {
    const auto names = split(line, ',');
    FramePlaces places{};
    for (std::size_t i = 0; i < kFrameColumns.size(); ++i) {
      const auto at = std::ranges::find_if(
          names, [&](std::string_view name) { return lower(trimmed(name)) == lower(kFrameColumns[i]); });
      if (at == names.end()) return findings_.add(number, 1, "expected a column {}, found none", kFrameColumns[i]);
      places[i] = static_cast<std::size_t>(at - names.begin());
    }
    section_->places = places;
  }

  /// What the section needs before its first frame is used.
  void check_head() {
    const GuidedSection& section = *section_;
    is_head_checked_ = true;
    const std::size_t before = findings_.count();
    if (!section.scale_arcsec_px)
      findings_.add(section.line, 1,
                    "expected a line Pixel scale = NUMBER arc-sec/px in this section, found none: add it from focal "
                    "length and pixel size");
    if (!section.rate_px_s)
      findings_.add(section.line, 1,
                    "expected a line Mount = ... with xRate = NUMBER in this section, found none: calibrate the mount "
                    "before guiding");
    if (!section.declination_deg)
      findings_.add(section.line, 1,
                    "expected a line Dec = NUMBER deg, Hour angle = ... with at most {:g} deg, found none: add the "
                    "declination of the star",
                    kMostDeclination_deg);
    is_usable_ = findings_.count() == before;
    if (!is_usable_) return;
    settings_.insert(fmt::format("{} arc-sec/px, {} px/s{} at {} deg", shortest(*section.scale_arcsec_px),
                                 shortest(*section.rate_px_s), section.is_rate_per_ms ? " (stated per ms)" : "",
                                 shortest(*section.declination_deg)));
    const double rate_at_equator =
        *section.rate_px_s * *section.scale_arcsec_px / std::cos(*section.declination_deg * std::numbers::pi / 180.0);
    rates_arcsec_s_.insert(rate_at_equator);
    if (!section.hour_angle_h) ++without_hour_angle_;
    if (!first_s_) first_s_ = section.start_s;
  }

  /// Dithers and other moves of the lock position.
  void take_event(int number, std::string_view event) {
    if (event.starts_with("DITHER by ")) {
      take_dither(event);
    } else if (event.starts_with("SET LOCK POSITION") || event.starts_with("MOVE LOCK POSITION")) {
      has_moved_ = true;  // by a dither, whose line follows, or else by an unknown amount
    } else if (event.starts_with("LOCK SHIFT, enabled = 1")) {
      findings_.add(number, 1, "expected a lock position at rest, found LOCK SHIFT: guide on a star without it");
    } else if (event.find("Settling started") != std::string_view::npos) {
      is_settling_ = is_dithered_;
    } else if (event.find("Settling ") != std::string_view::npos) {
      is_settling_ = false;
    }
  }

  /// The star follows the lock position: what guiding adds is no error. Near the edge of the picture a dither may go
  /// the other way than it says: the lock position says which.
  void take_dither(std::string_view event) {
    const auto to = pixel_in(event, "new lock pos = ");
    const auto by_px = stated_in(event, "DITHER by ");
    const GuidedSection& section = *section_;
    std::optional<double> move_px;
    if (to && by_px && section.lock && section.camera_angle_deg) {
      const double angle_rad = *section.camera_angle_deg * std::numbers::pi / 180.0;
      move_px =
          (to->x_px - section.lock->x_px) * std::cos(angle_rad) + (to->y_px - section.lock->y_px) * std::sin(angle_rad);
      if (std::abs(std::abs(*move_px) - std::abs(*by_px)) > kSameMove_px) move_px.reset();
    }
    section_->lock = to;
    is_dithered_ = true;
    has_moved_ = !move_px;
    if (!move_px) return;
    unguided_px_ += *move_px;
    ++dithers_;
  }

  std::optional<Frame> frame_in(int number, std::string_view line) {
    const auto cells = split(line, ',');
    const FramePlaces& places = *section_->places;
    const std::size_t needed = *std::ranges::max_element(places) + 1;
    if (cells.size() < needed) {
      if (!options_.accept_truncated)
        findings_.add(number, 1, "expected at least {} columns as in the heading, found {}: delete this incomplete row",
                      needed, cells.size());
      return std::nullopt;
    }
    const auto cell = [&](FrameColumn column) { return trimmed(cells[places[column]]); };
    bool is_valid = true;
    const auto value = [&](FrameColumn column, double most) {
      if (cell(column).empty()) return 0.0;
      const auto number_found = within(number_in(cell(column)), -most, most);
      if (!number_found) {
        findings_.add(number, column_of(line, cell(column)), "{}: expected a number of at most {:g}, found {}",
                      kFrameColumns[column], most, in_quotes(cell(column)));
        is_valid = false;
      }
      return number_found.value_or(0.0);
    };
    Frame frame{.time_s = value(kTime, kMost_s),
                .raw_px = value(kRaw, kMost_px),
                .guided_px = value(kGuided, kMost_px),
                .pulse_ms = value(kDuration, kMost_ms)};
    const double code = value(kErrorCode, kMost_ms);
    frame.star_was_measured = cell(kMount) != "\"DROP\"" && !cell(kRaw).empty() && (code == 0.0 || code == 1.0);
    if (cell(kMount) == "\"AO\"") {
      findings_.add(number, 1,
                    "expected frames of the mount, found AO: its corrections are not pulses. Guide without it");
      is_valid = false;
    }
    const bool to_east = cell(kDirection) == "E";
    if (frame.pulse_ms != 0.0 && !to_east && cell(kDirection) != "W") {
      findings_.add(number, 1, "RADirection: expected E or W, found {}", in_quotes(cell(kDirection)));
      is_valid = false;
    }
    if (to_east) frame.pulse_ms = -frame.pulse_ms;
    return is_valid ? std::optional(frame) : std::nullopt;
  }

  void take_frame(int number, std::string_view line) {
    if (!is_head_checked_) check_head();
    const auto frame = frame_in(number, line);
    if (!frame || !is_usable_) return;
    if (has_moved_) {
      begin_run();
      ++moves_;
    }
    has_moved_ = is_dithered_ = false;
    if (!frame->star_was_measured)
      ++dropped_;
    else if (is_settling_)
      ++settling_;
    else
      add_reading(number, *frame);
    if (frame->pulse_ms == 0.0) return;
    ++pulses_;
    unguided_px_ += frame->pulse_ms / kMsPerSecond * *section_->rate_px_s;
    if (frame->star_was_measured && frame->guided_px != 0.0)
      section_->seen_rates_px_s.push_back(frame->guided_px / frame->pulse_ms * kMsPerSecond);
  }

  /// The star west of its place: the axis is behind.
  void add_reading(int number, const Frame& frame) {
    const GuidedSection& section = *section_;
    const double axis_arcsec = (frame.raw_px + unguided_px_) * *section.scale_arcsec_px /
                               std::cos(*section.declination_deg * std::numbers::pi / 180.0);
    Reading reading;
    reading.line = number;
    reading.axis = axis_;
    reading.rotary = true;
    reading.position_mm = options_.parked_mm;
    reading.angle_deg[index_of(axis_)] =
        section.hour_angle_h.value_or(0.0) * kDegPerHour + kSidereal_deg_s * frame.time_s;
    reading.sense = static_cast<Sense>(kAxes + index_of(axis_));
    reading.error = (section.moves_east ? axis_arcsec : -axis_arcsec) * kUmPerMPerDegree / kArcsecPerDegree;
    reading.approach = Approach::forward;
    reading.run = run_;
    reading.time_s = section.start_s - *first_s_ + frame.time_s;
    set_.readings.push_back(std::move(reading));
  }

  /// A pulse is as long as the program expects for its move: another rate than that of the heading is doubtful.
  void check_rate() {
    auto& seen = section_->seen_rates_px_s;
    const auto middle = seen.begin() + static_cast<std::ptrdiff_t>(seen.size() / 2);
    std::nth_element(seen.begin(), middle, seen.end());
    if (*middle < 0.0)
      findings_.add(section_->line, 1,
                    "expected pulses to the west where RAGuideDistance is positive, as PHD2 writes them, found the "
                    "opposite: their sign is not known");
    else if (std::abs(*middle / *section_->rate_px_s - 1.0) > kSameRate)
      set_.notes.push_back(
          fmt::format("line {}: xRate is {:.3g} px/s, but RAGuideDistance / RADuration is {:.3g} px/s. xRate is used",
                      section_->line, *section_->rate_px_s, *middle));
  }

  void add_notes() {
    auto& notes = set_.notes;
    const auto note = [&](int count, std::string_view what) {
      if (count > 0) notes.push_back(fmt::format("{}: {}", what, count));
    };
    notes.push_back(fmt::format(
        "error without guiding: all earlier pulses in right ascension are added to the distances. Pulses: {}",
        pulses_));
    notes.push_back(fmt::format("pixel scale, xRate and declination: {}", fmt::join(settings_, "; ")));
    if (*rates_arcsec_s_.rbegin() > (1.0 + kSameRate / 2.0) * *rates_arcsec_s_.begin())
      notes.push_back(
          fmt::format("xRate / cos(Dec) is from {:.3g} to {:.3g} arcsec/s in these sections: PHD2 did not "
                      "convert xRate to the declination in each of them",
                      *rates_arcsec_s_.begin(), *rates_arcsec_s_.rbegin()));
    note(dropped_, "dropped frames that are omitted");
    note(settling_, "frames omitted because guiding settled after a dither");
    note(dithers_, "dithers corrected by the move of the lock position");
    note(moves_, "moves of the lock position by an unknown amount, each followed by a new run");
    if (set_.readings.back().run > 1) notes.push_back("each run has a zero of its own: it is a set-up of its own");
    note(without_hour_angle_, "sections that state no hour angle, whose targets start at 0 deg");
    notes.push_back("the distances in declination are not read: the polar axis does not correct them");
    set_.metadata.push_back({std::string(kBegun), date_time_text(*first_s_)});
  }

  const ImportOptions& options_;
  Axis axis_;
  Findings findings_;
  MeasurementSet set_;
  std::optional<GuidedSection> section_;
  std::optional<double> first_s_;    ///< when the first section with frames began, since the start of 1970
  std::set<std::string> settings_;   ///< of the sections, in words
  std::set<double> rates_arcsec_s_;  ///< of the axis, of the sections
  double unguided_px_ = 0.0;         ///< pulses and moves of the lock position since the zero of the run
  int run_ = 1;
  bool is_head_checked_ = false, is_usable_ = false;  ///< the head of the section
  bool is_dithered_ = false;                          ///< since the last frame
  bool is_settling_ = false;                          ///< after a dither
  bool has_moved_ = false;                            ///< the reference, by an unknown amount
  int pulses_ = 0, dropped_ = 0, settling_ = 0, dithers_ = 0, moves_ = 0, without_hour_angle_ = 0;
};

/// The polar axis in degrees of hour angle, C unless the options say otherwise.
Result<MeasurementSet> read_guide_log(std::string_view text, const std::string& file_name,
                                      const ImportOptions& options) {
  const Axis axis = options.axis.value_or(Axis::Z);
  const auto about = static_cast<Sense>(kAxes + index_of(axis));
  if (options.axis && !options.rotary)
    return problem_at(file_name, 0, 0, "expected the polar axis, a rotary one, found {}: give --axis A, B or C",
                      letter_of(axis));
  if (options.sense.value_or(about) != about)
    return problem_at(file_name, 0, 0, "expected angles of the polar axis, {}, found the sense {}: omit --sense",
                      ecs::name_of(about), ecs::name_of(*options.sense));
  GuideLogReader reader(file_name, options, axis);
  for (const auto& [number, line] : numbered_lines_of(text)) reader.take(number, trimmed(line));
  return reader.result();
}

Recognition recognises_guide_log(const FileStart& file) {
  return file.has("log enabled at") && (file.has("guiding begins at") || file.has("calibration begins at"))
             ? Recognition::certain
             : Recognition::no;
}

}  // namespace

extern const FileFormat kGuideLog{
    .id = "guide_log",
    .title = "guide log of a telescope (PHD2)",
    .sample = "guide.txt",
    .recognises = recognises_guide_log,
    .read = read_guide_log,
    .units = ErrorUnits::fixed,
    .states_place = {true, true, true},
};

}  // namespace ecs::laser
