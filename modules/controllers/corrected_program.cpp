#include "modules/controllers/corrected_program.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "modules/controllers/program_blocks.hpp"
#include "modules/controllers/program_path.hpp"

namespace ecs::controllers {
namespace {

constexpr double kOutsideTravel_mm = 1.0;  ///< beyond it a work offset is probably wrong

class ProgramCorrector {
 public:
  ProgramCorrector(const PartProgram& program, const ProgramSettings& settings, const CompensationAt& compensation,
                   const std::function<void(const ProgramSample&)>& seen)
      : program_(program),
        settings_(settings),
        compensation_(compensation),
        seen_(seen),
        reader_(program, settings),
        writer_(program, settings, modal_, made_) {
    for (std::size_t a = 0; a < kAxes; ++a) {
      nominal_[a] = settings.present[a] ? settings.start_mm[a] : std::optional(0.0);
      writer_.set_actual(a, nominal_[a]);
      if (nominal_[a]) sense_[a].extreme_mm = nominal_[a];
    }
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
    if (!reader_.findings().empty()) return tl::unexpected(reader_.findings().as_problem());
    if (const int line = reader_.whole_numbers_in(); line > 0)
      made_.notes.push_back(fmt::format(
          "words without a decimal point, the first in line {}, are read as whole mm (inches). If the control "
          "reads them in its smallest increment, the correction is wrong",
          line));
    return std::move(made_);
  }

 private:
  /// Lines that stay in front of the comment: %, the number of the program.
  static bool is_head(const ProgramLine& line) {
    const std::size_t first = line.text.find_first_not_of(" \t");
    return first == std::string::npos || line.text[first] == '%' || line.text[first] == ':' ||
           (!line.words.empty() && line.words.front().letter == 'O');
  }

  void tell_uncorrected(const ProgramLine& line, std::string_view why) {
    auto at = std::find_if(made_.uncorrected.begin(), made_.uncorrected.end(),
                           [&](const UncorrectedLines& one) { return one.why == why; });
    if (at == made_.uncorrected.end()) at = made_.uncorrected.insert(at, {std::string(why), {}});
    at->lines.push_back(line.number);
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
  void arrive(const Vector3& place_mm) {
    for (std::size_t a = 0; a < kAxes; ++a)
      if (nominal_[a]) sense_[a].arrive(place_mm[a], settings_.deadband_mm[a]);
  }

  Result<void> take(const ProgramLine& line) {
    if (line.words.empty()) return writer_.keep(line), Result<void>();
    const bool in_cycle = is_cycle(modal_.motion);
    const auto read = reader_.read(line);
    if (!read) return {};
    const BlockOfWords& block = *read;
    if (block.has(40)) return writer_.keep(line), Result<void>();
    if (block.has(800)) writer_.forget_motion();
    if (block.motion && is_cycle(modal_.motion)) begin_cycle(in_cycle);
    if (block.has(280) || block.has(300)) {
      go_to_reference(line, block);
    } else if (block.has(530) && block.names_axis()) {
      go_in_machine_coordinates(line, block);
    } else if (is_cycle(modal_.motion) && (block.names_axis() || block.motion)) {
      ECS_DO(drill(line, block));
    } else if (block.names_axis() || (modal_.goes_round() && (block.has_centre() || block.radius))) {
      ECS_DO(move(line, block));
    } else {
      writer_.keep(line, block);
    }
    return {};
  }

  /// From here on the positions of these axes are not known.
  void go_to_reference(const ProgramLine& line, const BlockOfWords& block) {
    for (std::size_t a = 0; a < kAxes; ++a) {
      if ((block.names_axis() && !block.axis[a]) || !settings_.present[a]) continue;
      nominal_[a].reset();
      writer_.set_actual(a, std::nullopt);
      sense_[a] = {};
    }
    tell_uncorrected(line, "a reference position (G28, G30): where it is, is not known here");
    writer_.keep(line, block);
  }

  void go_in_machine_coordinates(const ProgramLine& line, const BlockOfWords& block) {
    if (modal_.incremental)
      return reader_.complain(line, line.words.front(), "G53 is not known with G91; expected G90 with it");
    for (std::size_t a = 0; a < kAxes; ++a) {
      if (!block.axis[a]) continue;
      nominal_[a] = block.axis[a]->value * modal_.unit_mm;
      writer_.set_actual(a, nominal_[a]);
    }
    arrive(nominal_mm());
    ++made_.moves;
    tell_uncorrected(line, "machine coordinates (G53)");
    writer_.keep_in_motion(line, block);
  }

  /// Where the named axes are sent; complains where that is not known.
  std::optional<PerAxis<std::optional<double>>> target_of(const ProgramLine& line, const BlockOfWords& block) {
    PerAxis<std::optional<double>> target_mm = nominal_;
    bool good = true;
    for (const Axis axis : kAllAxes) {
      const std::size_t a = index_of(axis);
      const ProgramWord* word = block.axis[a];
      if (!word) continue;
      if (modal_.incremental && !nominal_[a]) {
        reader_.complain(
            line, *word,
            fmt::format("the position of {} before this incremental word is not known; begin with an absolute "
                        "word (G90), or give --start",
                        letter_of(axis)));
        good = false;
        continue;
      }
      const double from_mm = modal_.incremental ? *nominal_[a] : modal_.frame_mm(a);
      target_mm[a] = without_noise(from_mm + word->value * modal_.unit_mm);
      if (std::abs(*target_mm[a]) > kFarthest_mm) {
        reader_.complain(line, *word, "no machine goes that far");
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

  /// Places along a path, its start first; every axis is sensed to the end of it.
  Result<std::vector<PathSample>> sampled(const NominalPath& path) {
    const std::vector<double> steps = steps_along(path, settings_);
    ECS_TRY(mean_mm, mean_path(path, steps));
    SensedPath sensed = sensed_along(path, steps, mean_mm, sense_, settings_.deadband_mm);
    sense_ = sensed.at_end;
    return std::move(sensed.samples);
  }

  Result<std::vector<std::optional<Vector3>>> compensation_along(const std::vector<PathSample>& samples) {
    std::vector<ProgramPlace> places;
    places.reserve(samples.size() + 1);
    for (const PathSample& sample : samples)
      places.push_back({sample.place, modal_.program_mm(sample.place.position_mm)});
    if (settings_.zero_at_mm) {
      ProgramPlace zero{{{}, {Approach::unknown, Approach::unknown, Approach::unknown}}, *settings_.zero_at_mm};
      for (std::size_t a = 0; a < kAxes; ++a) zero.machine.position_mm[a] = zero.program_mm[a] + modal_.frame_mm(a);
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
    if (modal_.motion < 0) {
      reader_.complain(line, line.words.front(), "expected G0, G1, G2, G3 or a cycle before the first motion");
      return {};
    }
    const bool start_known = !unknown_axis();
    NominalPath path{nominal_mm(), {}, {}};
    const auto target_mm = target_of(line, block);
    if (!target_mm) return {};
    if (modal_.goes_round() && !start_known) {
      reader_.complain(
          line, line.words.front(),
          fmt::format("the position of {} at the start of this arc is not known; name the axis in an absolute "
                      "block before it, or give --start",
                      letter_of(*unknown_axis())));
      return {};
    }
    nominal_ = *target_mm;
    path.to_mm = nominal_mm();
    if (modal_.goes_round()) {
      const auto arc = arc_of(block, modal_, path);
      if (!arc) {
        reader_.complain(line, block.motion ? *block.motion : line.words.front(), arc.error().message);
        return {};
      }
      path.arc = *arc;
    }
    ++made_.moves;
    if (const auto axis = unknown_axis()) {
      arrive(path.to_mm);
      tell_uncorrected(line, fmt::format("the position of {} is not known yet (--start gives that before the first "
                                         "block)",
                                         letter_of(*axis)));
      writer_.write(line, block, {aim_at_nominal(block, path.to_mm)}, {1.0}, modal_.motion);
      return {};
    }
    const bool feed = modal_.motion != 0 && start_known && path.length_mm() > 0.0;
    return feed ? feed_along(line, block, path) : go_to_end(line, block, path);
  }

  /// The axes that are named at their nominal places, the others stay.
  [[nodiscard]] Vector3 aim_at_nominal(const BlockOfWords& block, const Vector3& to_mm) const {
    Vector3 aim_mm = writer_.place_mm();
    for (std::size_t a = 0; a < kAxes; ++a)
      if (block.axis[a]) aim_mm[a] = to_mm[a];
    return aim_mm;
  }

  static constexpr std::string_view kNotKnownThere =
      "the compensation of some part of the move is not known (no measured deviation near enough)";

  /// A rapid, or a first feed move: its end alone.
  Result<void> go_to_end(const ProgramLine& line, const BlockOfWords& block, const NominalPath& path) {
    ECS_TRY(mean_mm, mean_path(path, {1.0}));
    arrive(mean_mm.front());
    const PathSample end{1.0, {path.to_mm, approaches_of(sense_)}};
    ECS_TRY(found, compensation_along({end}));
    if (!found.front()) tell_uncorrected(line, kNotKnownThere);
    const Vector3 aim_mm = found.front() ? sum_of(path.to_mm, *found.front(), 1e-3) : aim_at_nominal(block, path.to_mm);
    writer_.write(line, block, {aim_mm}, {1.0}, modal_.motion);
    if (found.front()) note_correction(*found.front());
    if (modal_.motion != 0 && found.front()) see(end, *found.front(), writer_.place_mm());
    return {};
  }

  Result<void> feed_along(const ProgramLine& line, const BlockOfWords& block, const NominalPath& path) {
    AimedMove move;
    const Vector3 shift_mm = sum_of(writer_.place_mm(), path.from_mm, -1.0);
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
    const Vector3 start_mm = writer_.place_mm();
    std::vector<double> shares;
    for (std::size_t k = 0; k < move.ends.size(); ++k)
      shares.push_back(move.samples[move.ends[k]].s - (k > 0 ? move.samples[move.ends[k - 1]].s : 0.0));
    const auto reached =
        writer_.write(line, block, move.command_mm, shares, path.arc && !keeps_arc ? 10 : modal_.motion);
    if (known) see_along(move, start_mm, reached, keeps_arc);
    return {};
  }

  void divide(AimedMove& move, double tolerance_mm) const {
    std::vector<Vector3> points{writer_.place_mm()};
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
    if (modal_.inverse_time && !block.feed) {
      reader_.complain(line, line.words.front(), "G93: expected F in every block with a feed move");
      return false;
    }
    for (const ProgramWord* m : block.m) {
      if (is_before_motion(*m) || is_behind_motion(*m) || move.ends.size() < 2) continue;
      if (path.arc) {
        reader_.complain(line, *m,
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
    seen_({{sample.place, modal_.program_mm(sample.place.position_mm)}, off_um, compensation_um});
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

  struct DrillingCycle {
    std::optional<double> bottom_mm, retract_mm;  ///< machine coordinates
    std::optional<double> initial_mm, initial_actual_mm;
    std::optional<double> written_mm;  ///< the bottom as the control has it
  };

  /// The initial level is that before the first of the cycles that follow each other (LinuxCNC, G98).
  void begin_cycle(bool follows_another) {
    DrillingCycle next;
    if (follows_another) next.initial_mm = cycle_.initial_mm, next.initial_actual_mm = cycle_.initial_actual_mm;
    cycle_ = next;
  }

  /// One hole of a cycle: its place and its bottom are corrected, the plane R is kept.
  Result<void> drill(const ProgramLine& line, const BlockOfWords& block) {
    const auto refuse = [&](std::string_view why) -> Result<void> {
      reader_.complain(line, block.motion ? *block.motion : line.words.front(), why);
      return {};
    };
    if (modal_.incremental) return refuse("cycles with G91 are not supported; use G90");
    if (modal_.plane != 17) return refuse("cycles in another plane than G17 are not supported");
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
    if (!cycle_.initial_mm) cycle_.initial_mm = nominal_[2], cycle_.initial_actual_mm = writer_.actual_mm()[2];
    if (block.axis[2]) cycle_.bottom_mm = (*target_mm)[2];
    if (block.radius) cycle_.retract_mm = without_noise(modal_.frame_mm(2) + block.radius->value * modal_.unit_mm);
    if (!cycle_.bottom_mm || !cycle_.retract_mm) return refuse("expected the bottom Z and the plane R of the cycle");
    ++made_.moves;
    const Vector3 hole_mm{*(*target_mm)[0], *(*target_mm)[1], *cycle_.bottom_mm};
    nominal_[0] = hole_mm[0];
    nominal_[1] = hole_mm[1];
    arrive(hole_mm);
    const PathSample end{1.0, {hole_mm, approaches_of(sense_)}};
    ECS_TRY(found, compensation_along({end}));
    if (!found.front()) tell_uncorrected(line, kNotKnownThere);
    if (found.front()) note_correction(*found.front());
    const Vector3 aim_mm = sum_of(hole_mm, found.front().value_or(Vector3{}), 1e-3);
    writer_.write_hole(line, block, aim_mm, cycle_.written_mm);
    if (found.front()) see(end, *found.front(), {writer_.place_mm()[0], writer_.place_mm()[1], *cycle_.written_mm});
    nominal_[2] = modal_.to_initial ? cycle_.initial_mm : cycle_.retract_mm;
    writer_.set_actual(2, modal_.to_initial ? cycle_.initial_actual_mm : cycle_.retract_mm);
    arrive(nominal_mm());
    return {};
  }

  const PartProgram& program_;
  const ProgramSettings& settings_;
  const CompensationAt& compensation_;
  const std::function<void(const ProgramSample&)>& seen_;
  CorrectedProgram made_;
  BlockReader reader_;
  const ModalState& modal_ = reader_.modal();
  BlockWriter writer_;
  DrillingCycle cycle_;
  PerAxis<std::optional<double>> nominal_{};  ///< as programmed, machine coordinates
  PerAxis<AxisSense> sense_{};
  PerAxis<bool> outside_{};  ///< said of this axis
};

}  // namespace

Result<CorrectedProgram> corrected_program(const PartProgram& program, const ProgramSettings& settings,
                                           const CompensationAt& compensation, const std::string& comment,
                                           const std::function<void(const ProgramSample&)>& seen) {
  return ProgramCorrector(program, settings, compensation, seen).corrected(comment);
}

}  // namespace ecs::controllers
