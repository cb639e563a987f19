#include "modules/controllers/corrected_program.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/tick.hpp"
#include "laser/findings.hpp"
#include "modules/controllers/curve.hpp"

namespace ecs::controllers {
namespace {

constexpr double kSameWord = 1e-9;        ///< words that differ by less are the same number
constexpr int kFirstOffset = 54;          ///< G54 acts where the program names none
constexpr double kArcMismatch_mm = 0.02;  ///< of the two radii of an arc; a tenth of a thou is 0.0025 mm
constexpr double kFarthest_mm = 1e6;
constexpr double kSmallestRadius_mm = 1e-3;
constexpr double kLeastDirectionChange_mm = 0.001;  ///< path behind a turn on which the approach changes, at least
constexpr double kOutsideTravel_mm = 1.0;           ///< beyond it a work offset is probably wrong
constexpr std::size_t kMostSamples = 2'000'000;     ///< of one move
constexpr double kSamplesOfSagitta = 8.0;  ///< a sample of an arc is off its chord by this part of the tolerance

Vector3 sum_of(const Vector3& a, const Vector3& b, double weight = 1.0) {
  return {a[0] + weight * b[0], a[1] + weight * b[1], a[2] + weight * b[2]};
}
double length_of(const Vector3& v) { return std::hypot(v[0], v[1], v[2]); }
/// Sums of incremental words stay what a hand would add up, in inches too (1e-6 in is 2.54e-5 mm).
double without_noise(double mm) { return std::round(mm * 1e8) / 1e8; }

// --- the path of one move

struct ArcPath {
  std::size_t u = 0, v = 1, w = 2;  ///< axes of the plane, from u to v is counterclockwise, and the one across
  double centre_u = 0.0, centre_v = 0.0;
  double radius_from = 0.0, radius_to = 0.0;
  double angle = 0.0, sweep = 0.0;  ///< of the start from u, and from there to the end, counterclockwise positive [rad]
};

/// Between nominal points, machine coordinates.
struct NominalPath {
  Vector3 from_mm{}, to_mm{};
  std::optional<ArcPath> arc{};

  [[nodiscard]] Vector3 at(double s) const {
    if (s >= 1.0) return to_mm;
    Vector3 place = sum_of(from_mm, sum_of(to_mm, from_mm, -1.0), s);
    if (!arc || s <= 0.0) return place;
    const double radius = std::lerp(arc->radius_from, arc->radius_to, s);
    place[arc->u] = arc->centre_u + radius * std::cos(arc->angle + s * arc->sweep);
    place[arc->v] = arc->centre_v + radius * std::sin(arc->angle + s * arc->sweep);
    return place;
  }
  [[nodiscard]] double length_mm() const {
    if (!arc) return length_of(sum_of(to_mm, from_mm, -1.0));
    return std::hypot(std::abs(arc->sweep) * arc->radius_from, to_mm[arc->w] - from_mm[arc->w]);
  }
  /// Ends of the stretches on which every axis goes one way: 0, those of quarters of a circle, 1.
  [[nodiscard]] std::vector<double> turns() const {
    std::vector<double> at{0.0, 1.0};
    if (!arc) return at;
    constexpr double kQuarter = std::numbers::pi / 2.0;
    const double low = std::min(arc->angle, arc->angle + arc->sweep), high = low + std::abs(arc->sweep);
    for (int quarter = static_cast<int>(std::ceil(low / kQuarter)); quarter * kQuarter < high; ++quarter) {
      const double s = (quarter * kQuarter - arc->angle) / arc->sweep;
      if (s > 1e-9 && s < 1.0 - 1e-9) at.push_back(s);
    }
    std::sort(at.begin(), at.end());
    return at;
  }
};

/// How an axis came to where it is.
struct AxisSense {
  Approach approach = Approach::unknown;
  std::optional<double> extreme_mm;  ///< absent: it has been nowhere yet

  void arrive(double position_mm, double deadband_mm) {
    if (!extreme_mm) {
      extreme_mm = position_mm;
    } else if (approach != Approach::unknown) {
      approach = sensed_approach(approach, position_mm, deadband_mm, *extreme_mm);
    } else if (std::abs(position_mm - *extreme_mm) > deadband_mm) {
      approach = position_mm > *extreme_mm ? Approach::forward : Approach::reverse;
      extreme_mm = position_mm;
    }
  }
};

struct PathSample {
  double s = 1.0;  ///< part of the way
  MachinePlace place;
};

/// Numbers of the points of a path, the last among them, between which straight lines miss none by more than the
/// tolerance (D. Douglas, T. Peucker, Cartographica 10 (1973) 112): split where the line is furthest off.
/// @param s  part of the way at each point, ascending
std::vector<std::size_t> ends_of_pieces(const std::vector<Vector3>& points, const std::vector<double>& s,
                                        double tolerance_mm) {
  std::vector<std::size_t> ends;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, points.size() - 1}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    std::size_t worst = a;
    double most_mm = tolerance_mm;
    for (std::size_t i = a + 1; i < b; ++i) {
      const double part = s[b] > s[a] ? (s[i] - s[a]) / (s[b] - s[a]) : 0.0;
      const Vector3 on_line = sum_of(points[a], sum_of(points[b], points[a], -1.0), part);
      const double off_mm = length_of(sum_of(points[i], on_line, -1.0));
      if (off_mm > most_mm) most_mm = off_mm, worst = i;
    }
    if (worst == a) {
      ends.push_back(b);
      continue;
    }
    open.emplace_back(worst, b);
    open.emplace_back(a, worst);
  }
  return ends;
}

// --- what the words of a block ask for

/// A G code in tenths: 541 of G54.1.
int code_of(const ProgramWord& word) { return static_cast<int>(std::lround(word.value * 10.0)); }

bool is_one_of(int code, std::initializer_list<int> codes) {
  return std::find(codes.begin(), codes.end(), code) != codes.end();
}

bool is_cycle(int code) { return is_one_of(code, {730, 740, 810, 820, 830, 840, 850, 860, 890}); }

/// Why a G code is refused; empty: it is known.
std::string_view refusal_of(int code) {
  if (is_one_of(code, {0,   10,  20,  30,  40,  80,  90,  150, 170, 180, 190, 200, 210, 280, 300,
                       400, 430, 440, 490, 500, 530, 540, 550, 560, 570, 580, 590, 610, 611, 620,
                       640, 690, 700, 710, 800, 900, 910, 911, 930, 940, 950, 960, 970, 980, 990}) ||
      is_cycle(code))
    return {};
  if (is_one_of(code, {410, 411, 420, 421}))
    return "tool radius compensation cannot be corrected, because the control computes the path; output the path of "
           "the tool centre";
  if (is_one_of(code, {100, 520, 920, 921, 922, 923}))
    return "it changes the zero point of the program; use G54 to G59";
  if (is_one_of(code, {160, 510, 511, 680, 681}))
    return "polar coordinates, rotation, scaling and mirroring cannot be corrected; output plain coordinates";
  if (is_one_of(code, {320, 330, 331, 332, 760})) return "threads cannot be corrected: their pieces would not join";
  if (is_one_of(code, {650, 660, 661, 670}))
    return "macros cannot be corrected; write the moves one by one (CAM systems have such an option)";
  if (is_one_of(code, {870, 880})) return "this cycle cannot be corrected; write its moves one by one";
  if (code == 901) return "absolute centres of arcs are not supported; use centres counted from the start (G91.1)";
  return "not known here: positions behind it would be uncertain";
}

bool is_before_motion(const ProgramWord& m) { return is_one_of(code_of(m), {30, 40, 60, 70, 80}); }
bool is_behind_motion(const ProgramWord& m) { return is_one_of(code_of(m), {0, 10, 20, 50, 90, 300, 600}); }

struct BlockOfWords {
  PerAxis<const ProgramWord*> axis{}, centre{};
  const ProgramWord* radius = nullptr;
  const ProgramWord* feed = nullptr;
  const ProgramWord* motion = nullptr;   ///< G0 … G3, or a cycle
  const ProgramWord* tool = nullptr;     ///< H
  const ProgramWord* repeats = nullptr;  ///< L or K of a cycle, P or L of an arc
  std::vector<const ProgramWord*> g, m;

  [[nodiscard]] bool has(int code) const {
    return std::any_of(g.begin(), g.end(), [&](const ProgramWord* one) { return code_of(*one) == code; });
  }
  [[nodiscard]] bool names_axis() const { return axis[0] || axis[1] || axis[2]; }
  [[nodiscard]] bool has_centre() const { return centre[0] || centre[1] || centre[2]; }
};

/// One line with words replaced, removed and added.
class LineEdit {
 public:
  /// @param spaced  blanks go between words
  LineEdit(const ProgramLine& line, bool spaced) : line_(line), spaced_(spaced) {}
  [[nodiscard]] bool spaced() const { return spaced_; }
  [[nodiscard]] bool changed() const { return !edits_.empty(); }
  void replace(const ProgramWord& word, std::string text) {
    if (text != line_.text_of(word)) edits_.push_back({word.at, word.size, std::move(text)});
  }
  /// With the blanks behind it.
  void remove(const ProgramWord& word) {
    std::size_t end = word.at + word.size;
    while (end < line_.text.size() && line_.text[end] == ' ') ++end;
    edits_.push_back({word.at, end - word.at, ""});
  }
  void add_behind(const ProgramWord& word, const std::string& text) {
    edits_.push_back({word.at + word.size, 0, (spaced_ ? " " : "") + text});
  }
  void add_before(const ProgramWord& word, const std::string& text) {
    edits_.push_back({word.at, 0, text + (spaced_ ? " " : "")});
  }
  [[nodiscard]] std::string text() {
    std::stable_sort(edits_.begin(), edits_.end(), [](const Edit& a, const Edit& b) { return a.at < b.at; });
    std::string made;
    std::size_t done = 0;
    for (const Edit& edit : edits_) {
      const std::size_t at = std::max(edit.at, done);
      made += line_.text.substr(done, at - done) + edit.text;
      done = std::max(done, edit.at + edit.size);
    }
    made += line_.text.substr(done);
    if (!line_.text.ends_with(' ')) made.erase(made.find_last_not_of(' ') + 1);
    return made;
  }

 private:
  struct Edit {
    std::size_t at, size;
    std::string text;
  };
  const ProgramLine& line_;
  std::vector<Edit> edits_;
  bool spaced_;
};

// --- the program, block after block

class ProgramCorrector {
 public:
  ProgramCorrector(const PartProgram& program, const ProgramSettings& settings, const CompensationAt& compensation,
                   const std::function<void(const ProgramSample&)>& seen)
      : program_(program), settings_(settings), compensation_(compensation), seen_(seen), findings_(program.file) {
    for (std::size_t a = 0; a < kAxes; ++a) {
      nominal_[a] = actual_[a] = settings.present[a] ? settings.start_mm[a] : std::optional(0.0);
      if (nominal_[a]) sense_[a].extreme_mm = nominal_[a];
    }
    if (const auto at = settings.work_offset_mm.find(kFirstOffset); at != settings.work_offset_mm.end())
      zero_point_mm_ = at->second;
  }

  Result<CorrectedProgram> corrected(const std::string& comment) {
    bool headed = comment.empty();
    for (const ProgramLine& line : program_.lines) {
      if (!headed && !is_head(line)) {
        const std::string end = line.end.empty() ? "\n" : line.end;
        made_.text += fmt::format("{}{}{}{}", program_.semicolon_comments ? "; " : "(", comment,
                                  program_.semicolon_comments ? "" : ")", end);
        headed = true;
      }
      ECS_DO(take(line));
    }
    if (!findings_.empty()) return tl::unexpected(findings_.as_problem());
    if (whole_numbers_in_ > 0)
      made_.notes.push_back(
          fmt::format("words without a decimal point count as whole mm (inches), first in line {}: on a control that "
                      "counts them in its smallest increment the correction would be wrong",
                      whole_numbers_in_));
    return std::move(made_);
  }

 private:
  /// Lines that stay in front of the comment: %, the number of the program.
  static bool is_head(const ProgramLine& line) {
    const std::size_t first = line.text.find_first_not_of(" \t");
    return first == std::string::npos || line.text[first] == '%' || line.text[first] == ':' ||
           (!line.words.empty() && line.words.front().letter == 'O');
  }

  void complain(const ProgramLine& line, const ProgramWord& word, std::string_view message) {
    findings_.add(line.number, static_cast<int>(word.at) + 1, fmt::format("{}: {}", line.text_of(word), message));
  }
  void keep(const ProgramLine& line) { made_.text += line.text + line.end; }
  void tell_uncorrected(const ProgramLine& line, std::string_view why) {
    auto at = std::find_if(made_.uncorrected.begin(), made_.uncorrected.end(),
                           [&](const UncorrectedLines& one) { return one.why == why; });
    if (at == made_.uncorrected.end()) at = made_.uncorrected.insert(at, {std::string(why), {}});
    at->lines.push_back(line.number);
  }

  [[nodiscard]] double frame_mm(std::size_t axis) const { return zero_point_mm_[axis] + (axis == 2 ? tool_mm_ : 0.0); }
  [[nodiscard]] Vector3 program_mm(const Vector3& machine_mm) const {
    return {machine_mm[0] - frame_mm(0), machine_mm[1] - frame_mm(1), machine_mm[2] - frame_mm(2)};
  }
  /// The first axis whose position is not known.
  [[nodiscard]] std::optional<Axis> unknown_axis() const {
    for (const Axis axis : kAllAxes)
      if (!nominal_[index_of(axis)]) return axis;
    return std::nullopt;
  }
  [[nodiscard]] Vector3 nominal_mm() const {
    return {nominal_[0].value_or(0.0), nominal_[1].value_or(0.0), nominal_[2].value_or(0.0)};
  }
  [[nodiscard]] Vector3 actual_mm() const {
    return {actual_[0].value_or(0.0), actual_[1].value_or(0.0), actual_[2].value_or(0.0)};
  }
  [[nodiscard]] PerAxis<Approach> approaches() const {
    return {sense_[0].approach, sense_[1].approach, sense_[2].approach};
  }
  void arrive(const Vector3& place_mm) {
    for (std::size_t a = 0; a < kAxes; ++a)
      if (nominal_[a]) sense_[a].arrive(place_mm[a], settings_.deadband_mm[a]);
  }

  /// Words by what they mean; what is refused is complained about.
  BlockOfWords words_of(const ProgramLine& line) {
    BlockOfWords block;
    const auto set = [&](const ProgramWord*& place, const ProgramWord& word) {
      if (place) complain(line, word, fmt::format("a second {} in one block", word.letter));
      place = &word;
    };
    const bool dwell = std::any_of(line.words.begin(), line.words.end(),
                                   [](const ProgramWord& w) { return w.letter == 'G' && code_of(w) == 40; });
    for (const ProgramWord& word : line.words) {
      switch (word.letter) {
        case 'G':
          block.g.push_back(&word);
          if (code_of(word) <= 30 || is_cycle(code_of(word))) set(block.motion, word);
          break;
        case 'M':
          block.m.push_back(&word);
          break;
        case 'X':
        case 'Y':
        case 'Z':
          if (!dwell) set(block.axis[static_cast<std::size_t>(word.letter - 'X')], word);
          break;
        case 'I':
        case 'J':
        case 'K':
          if (word.letter == 'K' && in_cycle(block))
            set(block.repeats, word);
          else
            set(block.centre[static_cast<std::size_t>(word.letter - 'I')], word);
          break;
        case 'R':
          set(block.radius, word);
          break;
        case 'F':
          set(block.feed, word);
          break;
        case 'H':
          block.tool = &word;
          break;
        case 'L':
          block.repeats = &word;
          break;
        case 'A':
        case 'B':
        case 'C':
        case 'U':
        case 'V':
        case 'W':
          if (!dwell) complain(line, word, "rotary and secondary axes cannot be corrected; the map has X, Y and Z");
          break;
        default:
          break;
      }
      if (!word.has_point && word.value != 0.0 &&
          std::string_view("XYZIJKR").find(word.letter) != std::string_view::npos && whole_numbers_in_ == 0 && !dwell)
        whole_numbers_in_ = line.number;
    }
    return block;
  }

  [[nodiscard]] bool in_cycle(const BlockOfWords& block) const {
    return is_cycle(block.motion ? code_of(*block.motion) : motion_);
  }

  /// False: something was complained about.
  bool check(const ProgramLine& line, const BlockOfWords& block) {
    bool good = true;
    const auto refuse = [&](const ProgramWord& word, std::string_view why) {
      complain(line, word, why);
      good = false;
    };
    for (const ProgramWord* g : block.g)
      if (const std::string_view why = refusal_of(code_of(*g)); !why.empty()) refuse(*g, why);
    for (const ProgramWord* m : block.m)
      if (is_one_of(code_of(*m), {960, 970, 980, 990, 1980}))
        refuse(*m, "subprograms cannot be corrected; write their moves one by one (CAM systems have such an option)");
    for (const Axis axis : kAllAxes)
      if (const ProgramWord* word = block.axis[index_of(axis)]; word && !settings_.present[index_of(axis)])
        refuse(*word, fmt::format("the machine of the parameters has no axis {}", letter_of(axis)));
    if (block.has(500) && block.names_axis())
      refuse(*block.g.front(), "G50 with coordinates changes the zero point or the scale; use G54 to G59");
    if (ended_ && (block.names_axis() || !block.g.empty()))
      refuse(line.words.front(), fmt::format("expected nothing behind the end of the program in line {}", ended_));
    if (line.optional && (block.names_axis() || block.has_centre() || !block.g.empty()))
      refuse(line.words.front(),
             "an optional block (/) with a motion: it is not known whether it is executed; remove "
             "the \"/\" or the block");
    return good;
  }

  Result<void> take(const ProgramLine& line) {
    if (line.words.empty()) return keep(line), Result<void>();
    const BlockOfWords block = words_of(line);
    if (!check(line, block)) return {};
    if (block.has(40)) return keep(line), Result<void>();
    if (!remember(line, block)) return {};
    const bool round = motion_ == 20 || motion_ == 30;
    if (block.has(280) || block.has(300)) {
      go_to_reference(line, block);
    } else if (block.has(530) && block.names_axis()) {
      go_in_machine_coordinates(line, block);
    } else if (is_cycle(motion_) && (block.names_axis() || block.motion)) {
      ECS_DO(drill(line, block));
    } else if (block.names_axis() || (round && (block.has_centre() || block.radius))) {
      ECS_DO(move(line, block));
    } else {
      if (block.motion) written_motion_ = motion_;
      keep(line);
    }
    for (const ProgramWord* m : block.m)
      if (is_one_of(code_of(*m), {20, 300})) ended_ = line.number;
    return {};
  }

  /// Modal words. False: something was complained about.
  bool remember(const ProgramLine& line, const BlockOfWords& block) {
    for (const ProgramWord* g : block.g) {
      const int code = code_of(*g);
      if (is_one_of(code, {170, 180, 190})) plane_ = code / 10;
      if (is_one_of(code, {200, 700})) unit_mm_ = 25.4;
      if (is_one_of(code, {210, 710})) unit_mm_ = 1.0;
      if (is_one_of(code, {900, 910})) incremental_ = code == 910;
      if (is_one_of(code, {930, 940, 950})) inverse_time_ = code == 930;
      if (is_one_of(code, {980, 990})) to_initial_ = code == 980;
      if (code == 800) motion_ = written_motion_ = -1;
      if (code == 490) tool_mm_ = 0.0;
      if (code >= 540 && code <= 590 && !use_offset(line, *g)) return false;
      if ((code == 430 || code == 440) && !use_tool(line, *g, block)) return false;
    }
    if (block.motion) {
      motion_ = code_of(*block.motion);
      if (is_cycle(motion_)) cycle_ = {};
    }
    return true;
  }

  bool use_offset(const ProgramLine& line, const ProgramWord& word) {
    const auto at = settings_.work_offset_mm.find(code_of(word) / 10);
    if (at == settings_.work_offset_mm.end()) {
      complain(line, word,
               fmt::format("its zero point is not given; give --work-offset G{}:x=..,y=..,z=.. in machine "
                           "coordinates",
                           code_of(word) / 10));
      return false;
    }
    zero_point_mm_ = at->second;
    return true;
  }

  bool use_tool(const ProgramLine& line, const ProgramWord& word, const BlockOfWords& block) {
    const int number = block.tool ? static_cast<int>(std::lround(block.tool->value)) : -1;
    const auto at = settings_.tool_length_mm.find(number);
    if (number != 0 && at == settings_.tool_length_mm.end()) {
      complain(line, word,
               number < 0
                   ? std::string("expected the number H of a tool length in the same block")
                   : fmt::format("the length of tool H{0} is not given; give --tool-length {0}=LENGTH in mm, 0 if "
                                 "the work offset contains it",
                                 number));
      return false;
    }
    tool_mm_ = number == 0 ? 0.0 : (code_of(word) == 430 ? 1.0 : -1.0) * at->second;
    return true;
  }

  /// From here on the positions of these axes are not known.
  void go_to_reference(const ProgramLine& line, const BlockOfWords& block) {
    for (std::size_t a = 0; a < kAxes; ++a) {
      if ((block.names_axis() && !block.axis[a]) || !settings_.present[a]) continue;
      nominal_[a].reset();
      actual_[a].reset();
      sense_[a] = {};
    }
    tell_uncorrected(line, "a reference position (G28, G30): where it is, is not known here");
    if (block.motion) written_motion_ = motion_;
    keep(line);
  }

  void go_in_machine_coordinates(const ProgramLine& line, const BlockOfWords& block) {
    if (incremental_) return complain(line, line.words.front(), "G53 is not known with G91; expected G90 with it");
    for (std::size_t a = 0; a < kAxes; ++a)
      if (block.axis[a]) nominal_[a] = actual_[a] = block.axis[a]->value * unit_mm_;
    arrive(nominal_mm());
    ++made_.moves;
    tell_uncorrected(line, "machine coordinates (G53)");
    LineEdit edit(line, program_.spaced);
    write_motion_word(line, block, edit, motion_);
    made_.text += edit.text() + line.end;
  }

  /// Where the named axes are sent; complains where that is not known.
  std::optional<PerAxis<std::optional<double>>> target_of(const ProgramLine& line, const BlockOfWords& block) {
    PerAxis<std::optional<double>> target_mm = nominal_;
    bool good = true;
    for (const Axis axis : kAllAxes) {
      const std::size_t a = index_of(axis);
      const ProgramWord* word = block.axis[a];
      if (!word) continue;
      if (incremental_ && !nominal_[a]) {
        complain(line, *word,
                 fmt::format("the position of {} before this incremental word is not known; begin with an absolute "
                             "word (G90), or give --start",
                             letter_of(axis)));
        good = false;
        continue;
      }
      const double from_mm = incremental_ ? *nominal_[a] : frame_mm(a);
      target_mm[a] = without_noise(from_mm + word->value * unit_mm_);
      if (std::abs(*target_mm[a]) > kFarthest_mm) {
        complain(line, *word, "no machine goes that far");
        good = false;
        continue;
      }
      note_outside_travel(line, axis, *target_mm[a]);
    }
    return good ? std::optional(target_mm) : std::nullopt;
  }

  void note_outside_travel(const ProgramLine& line, Axis axis, double place_mm) {
    const std::size_t a = index_of(axis);
    const auto& travel = settings_.travel_mm[a];
    if (!travel || outside_[a]) return;
    if (place_mm > (*travel)[0] - kOutsideTravel_mm && place_mm < (*travel)[1] + kOutsideTravel_mm) return;
    outside_[a] = true;
    made_.notes.push_back(fmt::format(
        "line {}: {} goes to {:.6g} mm in machine coordinates, outside {:.6g} to {:.6g} mm: check --work-offset",
        line.number, letter_of(axis), place_mm, (*travel)[0], (*travel)[1]));
  }

  /// Complains where the words make no arc.
  std::optional<ArcPath> arc_of(const ProgramLine& line, const BlockOfWords& block, const NominalPath& path) {
    ArcPath arc;
    if (plane_ == 18) arc.u = 2, arc.v = 0, arc.w = 1;
    if (plane_ == 19) arc.u = 1, arc.v = 2, arc.w = 0;
    const ProgramWord& at = block.motion ? *block.motion : line.words.front();
    const auto refuse = [&](std::string_view why) {
      complain(line, at, why);
      return std::nullopt;
    };
    if (block.has_centre() == (block.radius != nullptr))
      return refuse(block.radius ? "expected the centre of the arc (I, J, K) or its radius (R), found both"
                                 : "expected the centre of the arc (I, J, K) or its radius (R), found none");
    if (block.centre[arc.w]) return refuse("expected the centre of the arc in its plane (G17 I J, G18 I K, G19 J K)");
    if (block.repeats) return refuse("arcs of several turns are not supported; write the turns one by one");
    const bool clockwise = motion_ == 20;
    const double along = path.to_mm[arc.u] - path.from_mm[arc.u], across = path.to_mm[arc.v] - path.from_mm[arc.v];
    const double chord_mm = std::hypot(along, across);
    if (block.radius) {
      const double radius_mm = block.radius->value * unit_mm_;
      const double short_by_mm = 0.5 * chord_mm - std::abs(radius_mm);
      if (chord_mm < kSmallestRadius_mm) return refuse("a radius alone does not define a full circle; use I, J, K");
      if (short_by_mm > kArcMismatch_mm)
        return refuse(fmt::format("a radius of {:.6g} mm cannot span {:.6g} mm", std::abs(radius_mm), chord_mm));
      const double height = std::sqrt(std::max(0.0, radius_mm * radius_mm - 0.25 * chord_mm * chord_mm));
      const double left = clockwise == (radius_mm > 0.0) ? -1.0 : 1.0;
      arc.centre_u = path.from_mm[arc.u] + 0.5 * along - left * height * across / chord_mm;
      arc.centre_v = path.from_mm[arc.v] + 0.5 * across + left * height * along / chord_mm;
    } else {
      const auto offset_mm = [&](std::size_t a) { return block.centre[a] ? block.centre[a]->value * unit_mm_ : 0.0; };
      arc.centre_u = path.from_mm[arc.u] + offset_mm(arc.u);
      arc.centre_v = path.from_mm[arc.v] + offset_mm(arc.v);
    }
    const auto angle_at = [&](const Vector3& p) {
      return std::atan2(p[arc.v] - arc.centre_v, p[arc.u] - arc.centre_u);
    };
    const auto radius_at = [&](const Vector3& p) {
      return std::hypot(p[arc.v] - arc.centre_v, p[arc.u] - arc.centre_u);
    };
    arc.radius_from = radius_at(path.from_mm);
    arc.radius_to = radius_at(path.to_mm);
    if (arc.radius_from < kSmallestRadius_mm || std::abs(arc.radius_from - arc.radius_to) > kArcMismatch_mm)
      return refuse(
          fmt::format("the start of the arc is {:.4f} mm from its centre, its end {:.4f} mm; expected the "
                      "same radius within {} mm",
                      arc.radius_from, arc.radius_to, kArcMismatch_mm));
    if (arc.radius_from > kFarthest_mm) return refuse("no machine moves on so large an arc");
    arc.angle = angle_at(path.from_mm);
    arc.sweep = angle_at(path.to_mm) - arc.angle;
    constexpr double kTurn = 2.0 * std::numbers::pi;
    if (chord_mm < kSmallestRadius_mm) arc.sweep = 0.0;
    if (clockwise)
      arc.sweep -= arc.sweep >= 0.0 ? kTurn : 0.0;
    else
      arc.sweep += arc.sweep <= 0.0 ? kTurn : 0.0;
    return arc;
  }

  /// Where the axes go in the corrected program, each with the mean of both approaches: a reversal is sensed on this
  /// path, so that its own correction does not turn the axis.
  Result<std::vector<Vector3>> mean_path(const NominalPath& path, const std::vector<double>& at) {
    std::vector<PathSample> samples;
    for (const double s : at)
      samples.push_back({s, {path.at(s), {Approach::unknown, Approach::unknown, Approach::unknown}}});
    ECS_TRY(found, compensation_along(samples));
    std::vector<Vector3> places_mm;
    for (std::size_t i = 0; i < samples.size(); ++i)
      places_mm.push_back(sum_of(samples[i].place.position_mm, found[i].value_or(Vector3{}), 1e-3));
    return places_mm;
  }

  /// Where, from 0 to 1 of a straight stretch, the approach of an axis changes; nothing: it does not.
  [[nodiscard]] std::optional<double> change_of_approach(std::size_t axis, double from_mm, double to_mm) const {
    const auto changed = [&](double part) {
      AxisSense sense = sense_[axis];
      sense.arrive(std::lerp(from_mm, to_mm, part), settings_.deadband_mm[axis]);
      return sense.approach != sense_[axis].approach;
    };
    if (!changed(1.0)) return std::nullopt;
    double before = 0.0, behind = 1.0;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (before + behind);
      (changed(middle) ? behind : before) = middle;
    }
    return behind;
  }

  /// Even steps, and the turns of the axes.
  [[nodiscard]] std::vector<double> steps_along(const NominalPath& path, double length_mm) const {
    double step_mm = settings_.sample_mm;
    if (path.arc)
      step_mm =
          std::min(step_mm, std::sqrt(8.0 / kSamplesOfSagitta * path.arc->radius_from * 1e-3 * settings_.tolerance_um));
    const double steps = std::clamp(std::ceil(length_mm / step_mm), 2.0, static_cast<double>(kMostSamples));
    std::vector<double> at = path.turns();
    for (std::size_t i = 1; i < static_cast<std::size_t>(steps); ++i) at.push_back(static_cast<double>(i) / steps);
    std::sort(at.begin(), at.end());
    at.erase(std::unique(at.begin(), at.end()), at.end());
    return at;
  }

  /// Places along a path, its start first; every axis is sensed to the end of it.
  Result<std::vector<PathSample>> sampled(const NominalPath& path) {
    const double length_mm = path.length_mm();
    const std::vector<double> steps = steps_along(path, length_mm);
    ECS_TRY(mean_mm, mean_path(path, steps));
    std::vector<PathSample> all{{0.0, {path.from_mm, approaches()}}};
    for (std::size_t k = 1; k < steps.size(); ++k) {
      const double from = steps[k - 1], length = steps[k] - from;
      std::vector<double> at{steps[k]};
      for (std::size_t a = 0; a < kAxes; ++a)
        if (const auto part = change_of_approach(a, mean_mm[k - 1][a], mean_mm[k][a])) {
          const double ramp_mm = std::max(2.0 * settings_.deadband_mm[a], kLeastDirectionChange_mm);
          const double change = std::max(from + *part * length, from + kLeastDirectionChange_mm / length_mm);
          at.push_back(std::min(change, steps[k]));
          at.push_back(std::max(from, change - ramp_mm / length_mm));
        }
      std::sort(at.begin(), at.end());
      for (const double s : at) {
        if (s <= all.back().s) continue;
        arrive(sum_of(mean_mm[k - 1], sum_of(mean_mm[k], mean_mm[k - 1], -1.0), (s - from) / length));
        all.push_back({s, {path.at(s), approaches()}});
      }
    }
    return all;
  }

  Result<std::vector<std::optional<Vector3>>> compensation_along(const std::vector<PathSample>& samples) {
    std::vector<ProgramPlace> places;
    places.reserve(samples.size() + 1);
    for (const PathSample& sample : samples) places.push_back({sample.place, program_mm(sample.place.position_mm)});
    if (settings_.zero_at_mm) {
      ProgramPlace zero{{{}, {Approach::unknown, Approach::unknown, Approach::unknown}}, *settings_.zero_at_mm};
      for (std::size_t a = 0; a < kAxes; ++a) zero.machine.position_mm[a] = zero.program_mm[a] + frame_mm(a);
      places.push_back(zero);
    }
    ECS_TRY(found, compensation_(places));
    if (!settings_.zero_at_mm) return std::move(found);
    if (!found.back()) return problem(ProblemKind::usage, "--zero-at: the compensation is not known there");
    const Vector3 zero_um = *found.back();
    found.pop_back();
    for (auto& one : found)
      if (one) one = sum_of(*one, zero_um, -1.0);
    return std::move(found);
  }

  /// One move along its nominal path, with what is aimed at there.
  struct AimedMove {
    std::vector<PathSample> samples;       ///< the start first, unless it is not known
    std::vector<Vector3> compensation_um;  ///< at each
    std::vector<std::size_t> ends;         ///< of the pieces
    std::vector<Vector3> command_mm;       ///< at each of these
  };

  Result<void> move(const ProgramLine& line, const BlockOfWords& block) {
    if (motion_ < 0) {
      complain(line, line.words.front(), "expected G0, G1, G2, G3 or a cycle before the first motion");
      return {};
    }
    const bool start_known = !unknown_axis();
    NominalPath path{nominal_mm(), {}, {}};
    const auto target_mm = target_of(line, block);
    if (!target_mm) return {};
    const bool round = motion_ == 20 || motion_ == 30;
    if (round && !start_known) {
      complain(line, line.words.front(),
               fmt::format("the position of {} at the start of this arc is not known; name the axis in an absolute "
                           "block before it, or give --start",
                           letter_of(*unknown_axis())));
      return {};
    }
    nominal_ = *target_mm;
    path.to_mm = nominal_mm();
    if (round) {
      path.arc = arc_of(line, block, path);
      if (!path.arc) return {};
    }
    ++made_.moves;
    if (const auto axis = unknown_axis()) {
      arrive(path.to_mm);
      tell_uncorrected(line, fmt::format("the position of {} is not known yet (--start gives that before the first "
                                         "block)",
                                         letter_of(*axis)));
      write(line, block, {aim_at_nominal(block, path.to_mm)}, {1.0}, motion_);
      return {};
    }
    const bool feed = motion_ != 0 && start_known && path.length_mm() > 0.0;
    return feed ? feed_along(line, block, path) : go_to_end(line, block, path);
  }

  /// The axes that are named at their nominal places, the others stay.
  [[nodiscard]] Vector3 aim_at_nominal(const BlockOfWords& block, const Vector3& to_mm) const {
    Vector3 aim_mm = actual_mm();
    for (std::size_t a = 0; a < kAxes; ++a)
      if (block.axis[a]) aim_mm[a] = to_mm[a];
    return aim_mm;
  }

  static constexpr std::string_view kNotKnownThere =
      "the compensation is not known along the whole move (no measured deviation near enough)";

  /// A rapid, or a first feed move: its end alone.
  Result<void> go_to_end(const ProgramLine& line, const BlockOfWords& block, const NominalPath& path) {
    ECS_TRY(mean_mm, mean_path(path, {1.0}));
    arrive(mean_mm.front());
    const PathSample end{1.0, {path.to_mm, approaches()}};
    ECS_TRY(found, compensation_along({end}));
    if (!found.front()) tell_uncorrected(line, kNotKnownThere);
    const Vector3 aim_mm = found.front() ? sum_of(path.to_mm, *found.front(), 1e-3) : aim_at_nominal(block, path.to_mm);
    write(line, block, {aim_mm}, {1.0}, motion_);
    if (found.front()) note_correction(*found.front());
    if (motion_ != 0 && found.front()) see(end, *found.front(), actual_mm());
    return {};
  }

  Result<void> feed_along(const ProgramLine& line, const BlockOfWords& block, const NominalPath& path) {
    AimedMove move;
    const Vector3 shift_mm = sum_of(actual_mm(), path.from_mm, -1.0);
    ECS_TRY(samples, sampled(path));
    move.samples = std::move(samples);
    ECS_TRY(found, compensation_along(move.samples));
    const bool known = std::all_of(found.begin() + 1, found.end(), [](const auto& one) { return one.has_value(); });
    if (!known) tell_uncorrected(line, kNotKnownThere);
    for (const auto& one : found) move.compensation_um.push_back(known && one ? *one : Vector3{});
    if (path.arc && !known) move.compensation_um.assign(found.size(), Vector3{});
    const double tolerance_mm = settings_.tolerance_um * 1e-3;
    const bool constant =
        std::all_of(move.compensation_um.begin() + 1, move.compensation_um.end(),
                    [&](const Vector3& one) { return length_of(sum_of(shift_mm, one, -1e-3)) <= tolerance_mm; });
    const bool keeps_arc = path.arc && constant;
    if (keeps_arc) {
      move.ends = {move.samples.size() - 1};
      move.command_mm = {sum_of(path.to_mm, shift_mm)};
    } else if (!path.arc && !known) {
      move.ends = {move.samples.size() - 1};
      move.command_mm = {aim_at_nominal(block, path.to_mm)};
    } else {
      divide(move, tolerance_mm);
    }
    if (!may_divide(line, block, move, path)) return {};
    if (path.arc) ++(keeps_arc ? made_.arcs_kept : made_.arcs_divided);
    if (known)
      for (const std::size_t end : move.ends)
        note_correction(keeps_arc ? sum_of({}, shift_mm, 1e3) : move.compensation_um[end]);
    const Vector3 start_mm = actual_mm();
    std::vector<double> shares;
    for (std::size_t k = 0; k < move.ends.size(); ++k)
      shares.push_back(move.samples[move.ends[k]].s - (k > 0 ? move.samples[move.ends[k - 1]].s : 0.0));
    const auto reached = write(line, block, move.command_mm, shares, path.arc && !keeps_arc ? 10 : motion_);
    if (known) see_along(move, start_mm, reached, keeps_arc);
    return {};
  }

  void divide(AimedMove& move, double tolerance_mm) const {
    std::vector<Vector3> points{actual_mm()};
    std::vector<double> s{0.0};
    for (std::size_t i = 1; i < move.samples.size(); ++i) {
      points.push_back(sum_of(move.samples[i].place.position_mm, move.compensation_um[i], 1e-3));
      s.push_back(move.samples[i].s);
    }
    move.ends = ends_of_pieces(points, s, tolerance_mm);
    for (const std::size_t end : move.ends) move.command_mm.push_back(points[end]);
  }

  /// Whether the words of the block allow its move to be divided; straight moves stay whole where they do not.
  bool may_divide(const ProgramLine& line, const BlockOfWords& block, AimedMove& move, const NominalPath& path) {
    if (move.ends.size() < 2 && !path.arc) return true;
    if (inverse_time_ && !block.feed) {
      complain(line, line.words.front(), "G93: expected F in every block with a feed move");
      return false;
    }
    for (const ProgramWord* m : block.m) {
      if (is_before_motion(*m) || is_behind_motion(*m) || move.ends.size() < 2) continue;
      if (path.arc) {
        complain(line, *m,
                 "the arc has to be divided, and when this M code acts is not known; write it into a block of "
                 "its own");
        return false;
      }
      move.ends = {move.ends.back()};
      move.command_mm = {move.command_mm.back()};
      tell_uncorrected(line, "not divided, the end alone is corrected: when its M code acts is not known");
    }
    return true;
  }

  void note_correction(const Vector3& compensation_um) {
    for (std::size_t a = 0; a < kAxes; ++a)
      made_.largest_um[a] = std::max(made_.largest_um[a], std::abs(compensation_um[a]));
  }

  void see(const PathSample& sample, const Vector3& compensation_um, const Vector3& command_mm) {
    if (!seen_) return;
    const Vector3 off_um = sum_of({}, sum_of(command_mm, sample.place.position_mm, -1.0), 1e3);
    seen_({{sample.place, program_mm(sample.place.position_mm)}, off_um, compensation_um});
  }

  /// Every sample but the start, on the lines between the points that were reached.
  void see_along(const AimedMove& move, const Vector3& start_mm, const std::vector<Vector3>& reached_mm, bool arc) {
    Vector3 from_mm = start_mm;
    std::size_t first = 0;
    const auto shift_mm = [&](std::size_t i, const Vector3& at_mm) {
      return sum_of(at_mm, move.samples[i].place.position_mm, -1.0);
    };
    for (std::size_t k = 0; k < move.ends.size(); ++k) {
      const std::size_t last = move.ends[k];
      const double whole = move.samples[last].s - move.samples[first].s;
      for (std::size_t i = first + 1; i <= last; ++i) {
        const double part = (move.samples[i].s - move.samples[first].s) / whole;
        Vector3 command_mm = sum_of(from_mm, sum_of(reached_mm[k], from_mm, -1.0), part);
        if (arc)
          command_mm = sum_of(move.samples[i].place.position_mm,
                              sum_of(shift_mm(first, from_mm),
                                     sum_of(shift_mm(last, reached_mm[k]), shift_mm(first, from_mm), -1.0), part));
        see(move.samples[i], move.compensation_um[i], command_mm);
      }
      from_mm = reached_mm[k];
      first = last;
    }
  }

  /// The digits of a corrected word.
  [[nodiscard]] int digits_of(const ProgramWord* original) const {
    return std::max(settings_.decimals + (unit_mm_ == 1.0 ? 0 : 1), original ? original->decimals : 0);
  }

  /// The word that sends an axis there, and where it then is; nothing: an axis that is not named stays.
  /// @param actual_mm  where the control has it
  std::optional<std::string> coordinate(const ProgramLine& line, Axis axis, double aim_mm, const ProgramWord* original,
                                        std::optional<double>& actual_mm) {
    const int digits = digits_of(original);
    const double grid_mm = std::pow(10.0, -digits) * unit_mm_;
    if (!original && actual_mm && std::abs(aim_mm - *actual_mm) <= 0.5001 * grid_mm) return std::nullopt;
    const double from_mm = incremental_ ? actual_mm.value_or(0.0) : frame_mm(index_of(axis));
    const double scale = std::pow(10.0, digits);
    const double value = std::round((aim_mm - from_mm) / unit_mm_ * scale) / scale;
    const bool same = original && std::abs(value - original->value) < kSameWord;
    actual_mm = without_noise(from_mm + (same ? original->value : value) * unit_mm_);
    made_.rounding_um[index_of(axis)] =
        std::max(made_.rounding_um[index_of(axis)], std::abs(*actual_mm - aim_mm) * 1e3);
    if (same) return std::string(line.text_of(*original));
    const bool small = !line.words.empty() && std::islower(static_cast<unsigned char>(line.text[line.words.back().at]));
    return fmt::format("{}{}", small ? small_letter_of(axis) : letter_of(axis), fixed_text(value, digits));
  }

  /// The motion word of a block in which the control would not have the motion that it needs.
  void write_motion_word(const ProgramLine& line, const BlockOfWords& block, LineEdit& edit, int motion) {
    if (block.motion && code_of(*block.motion) != motion) {
      std::string text(line.text_of(*block.motion));
      text[text.find_first_of("23")] = '1';  // an arc as lines
      edit.replace(*block.motion, text);
    } else if (!block.motion && written_motion_ != motion && motion >= 0) {
      const auto moves = [](const ProgramWord& word) {
        return std::string_view("XYZIJKR").find(word.letter) != std::string_view::npos;
      };
      edit.add_before(*std::find_if(line.words.begin(), line.words.end(), moves), fmt::format("G{}", motion / 10));
    }
    written_motion_ = motion;
  }

  /// Words of axes that are not named go behind those that are, else behind the last G word, else in front.
  static void add_word(const ProgramLine& line, const BlockOfWords& block, LineEdit& edit, const std::string& word) {
    const ProgramWord* behind = nullptr;
    for (const ProgramWord* one : block.axis)
      if (one && (!behind || one->at > behind->at)) behind = one;
    if (behind) return edit.add_behind(*behind, word);
    const auto centre = std::find_if(line.words.begin(), line.words.end(), [](const ProgramWord& one) {
      return std::string_view("IJKR").find(one.letter) != std::string_view::npos;
    });
    if (centre != line.words.end()) return edit.add_before(*centre, word);
    edit.add_behind(block.g.empty() ? line.words.back() : *block.g.back(), word);
  }

  /// Writes a block and the pieces behind it. @return where the control has the axes behind each piece
  std::vector<Vector3> write(const ProgramLine& line, const BlockOfWords& block, const std::vector<Vector3>& aims_mm,
                             const std::vector<double>& shares, int motion) {
    LineEdit edit(line, program_.spaced);
    write_motion_word(line, block, edit, motion);
    if (motion != motion_) {
      for (const ProgramWord* one : block.centre)
        if (one) edit.remove(*one);
      if (block.radius) edit.remove(*block.radius);
    }
    for (const Axis axis : kAllAxes) {
      const std::size_t a = index_of(axis);
      const ProgramWord* original = block.axis[a];
      if (!original && !actual_[a]) continue;
      const auto word = coordinate(line, axis, aims_mm.front()[a], original, actual_[a]);
      if (word && original)
        edit.replace(*original, *word);
      else if (word)
        add_word(line, block, edit, *word);
    }
    std::vector<Vector3> reached{actual_mm()};
    std::vector<std::string> pieces;
    for (std::size_t k = 1; k < aims_mm.size(); ++k) {
      pieces.push_back(piece_to(line, aims_mm[k], edit.spaced()));
      reached.push_back(actual_mm());
      if (pieces.back().empty())
        pieces.pop_back();
      else if (inverse_time_ && block.feed)
        pieces.back() += (edit.spaced() ? " " : "") + feed_word(*block.feed, shares[k]);
    }
    if (!pieces.empty()) {
      if (inverse_time_ && block.feed) edit.replace(*block.feed, feed_word(*block.feed, shares.front()));
      move_to_last_piece(line, block, edit, pieces.back());
    }
    if (edit.changed()) ++made_.corrected;
    const std::string end = line.end.empty() && !pieces.empty() ? "\n" : line.end;
    made_.text += edit.text() + end;
    for (std::size_t k = 0; k < pieces.size(); ++k) made_.text += pieces[k] + (k + 1 < pieces.size() ? end : line.end);
    made_.blocks_added += pieces.size();
    return reached;
  }

  /// Empty: no axis moves by as much as its last digit.
  std::string piece_to(const ProgramLine& line, const Vector3& aim_mm, bool spaced) {
    std::string words;
    for (const Axis axis : kAllAxes)
      if (actual_[index_of(axis)])
        if (const auto word = coordinate(line, axis, aim_mm[index_of(axis)], nullptr, actual_[index_of(axis)]))
          words += (spaced && !words.empty() ? " " : "") + *word;
    return words;
  }

  /// G93: F is one over the time of the block.
  static std::string feed_word(const ProgramWord& feed, double share) {
    return fmt::format("F{}", fixed_text(feed.value / share, std::max(feed.decimals, 3)));
  }

  /// What acts at the end of the whole move: a stop, an exact stop.
  static void move_to_last_piece(const ProgramLine& line, const BlockOfWords& block, LineEdit& edit,
                                 std::string& last) {
    const auto move = [&](const ProgramWord& word, bool in_front) {
      const std::string text(line.text_of(word));
      const std::string blank = edit.spaced() ? " " : "";
      last = in_front ? text + blank + last : last + blank + text;
      edit.remove(word);
    };
    for (const ProgramWord* m : block.m)
      if (is_behind_motion(*m)) move(*m, false);
    for (const ProgramWord* g : block.g)
      if (code_of(*g) == 90) move(*g, true);
  }

  struct DrillingCycle {
    std::optional<double> bottom_mm, retract_mm;  ///< machine coordinates
    std::optional<double> initial_mm, initial_actual_mm;
    std::optional<double> written_mm;  ///< the bottom as the control has it
  };

  /// One hole of a cycle: its place and its bottom are corrected, the plane R is kept.
  Result<void> drill(const ProgramLine& line, const BlockOfWords& block) {
    const auto refuse = [&](std::string_view why) -> Result<void> {
      complain(line, block.motion ? *block.motion : line.words.front(), why);
      return {};
    };
    if (incremental_) return refuse("cycles with G91 are not supported; use G90");
    if (plane_ != 17) return refuse("cycles in another plane than G17 are not supported");
    if (block.repeats && block.repeats->value != 1.0) return refuse("repeated holes (L, K) are not supported");
    const auto target_mm = target_of(line, block);
    if (!target_mm || unknown_axis()) {
      if (target_mm)
        return refuse(
            fmt::format("the position of {} before this cycle is not known; name the axis in an absolute "
                        "block before it, or give --start",
                        letter_of(*unknown_axis())));
      return {};
    }
    if (!cycle_.initial_mm) cycle_.initial_mm = nominal_[2], cycle_.initial_actual_mm = actual_[2];
    if (block.axis[2]) cycle_.bottom_mm = (*target_mm)[2];
    if (block.radius) cycle_.retract_mm = without_noise(frame_mm(2) + block.radius->value * unit_mm_);
    if (!cycle_.bottom_mm || !cycle_.retract_mm) return refuse("expected the bottom Z and the plane R of the cycle");
    ++made_.moves;
    const Vector3 hole_mm{*(*target_mm)[0], *(*target_mm)[1], *cycle_.bottom_mm};
    nominal_[0] = hole_mm[0];
    nominal_[1] = hole_mm[1];
    arrive(hole_mm);
    const PathSample end{1.0, {hole_mm, approaches()}};
    ECS_TRY(found, compensation_along({end}));
    if (!found.front()) tell_uncorrected(line, kNotKnownThere);
    if (found.front()) note_correction(*found.front());
    const Vector3 aim_mm = sum_of(hole_mm, found.front().value_or(Vector3{}), 1e-3);
    LineEdit edit(line, program_.spaced);
    written_motion_ = motion_;
    for (const Axis axis : kAllAxes) {
      const std::size_t a = index_of(axis);
      const auto word =
          coordinate(line, axis, aim_mm[a], block.axis[a], axis == Axis::Z ? cycle_.written_mm : actual_[a]);
      if (word && block.axis[a])
        edit.replace(*block.axis[a], *word);
      else if (word)
        add_word(line, block, edit, *word);
    }
    if (edit.changed()) ++made_.corrected;
    made_.text += edit.text() + line.end;
    if (found.front()) see(end, *found.front(), {*actual_[0], *actual_[1], *cycle_.written_mm});
    nominal_[2] = to_initial_ ? cycle_.initial_mm : cycle_.retract_mm;
    actual_[2] = to_initial_ ? cycle_.initial_actual_mm : cycle_.retract_mm;
    arrive(nominal_mm());
    return {};
  }

  const PartProgram& program_;
  const ProgramSettings& settings_;
  const CompensationAt& compensation_;
  const std::function<void(const ProgramSample&)>& seen_;
  laser::Findings findings_;
  CorrectedProgram made_;
  // modal
  int motion_ = -1;          ///< in tenths, as code_of(); below 0: none yet
  int written_motion_ = -1;  ///< that the control has in the corrected program
  int plane_ = 17;
  double unit_mm_ = 1.0;
  bool incremental_ = false, inverse_time_ = false, to_initial_ = true;
  Vector3 zero_point_mm_{};
  double tool_mm_ = 0.0;
  DrillingCycle cycle_;
  int ended_ = 0;  ///< line of M2 or M30
  // the axes, machine coordinates
  PerAxis<std::optional<double>> nominal_{}, actual_{};  ///< programmed; as the control has it in the corrected program
  PerAxis<AxisSense> sense_{};
  // for the notes
  int whole_numbers_in_ = 0;
  PerAxis<bool> outside_{};
};

}  // namespace

Result<CorrectedProgram> corrected_program(const PartProgram& program, const ProgramSettings& settings,
                                           const CompensationAt& compensation, const std::string& comment,
                                           const std::function<void(const ProgramSample&)>& seen) {
  return ProgramCorrector(program, settings, compensation, seen).corrected(comment);
}

}  // namespace ecs::controllers
