// `ecs test circle`: a circular test by ISO 230-4, and its causes ranked by their share. `ecs test diagonals`: body,
// face and step diagonals by ISO 230-6.

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/file_kind.hpp"
#include "laser/standards/circle.hpp"
#include "laser/standards/diagonals.hpp"
#include "modules/standards/ball_bar.hpp"
#include "modules/standards/circle_work.hpp"

namespace ecs::app {
namespace {

struct CircleRequest {
  std::string file, machine, other, plot;
  bool draw = false;
  static Fields<CircleRequest> fields() {
    using R = CircleRequest;
    return {{"FILE", &R::file, "file of radial deviations: angle_deg,deviation_um,direction,run", Need::required},
            {"--machine", &R::machine, "machine file with the pitches of its axes"},
            {"--other", &R::other, "result of a ball bar (.b5r) to compare with these causes"},
            {"--draw", &R::draw, "show the polar plot in characters"},
            {"--plot", &R::plot, "polar plot to write: OUT.svg or OUT.png", Is::output}};
  }
};

Cell centre_cell(const std::array<double, 2>& centre_um) {
  return {{centre_um[0], centre_um[1]},
          fmt::format("({}, {})", number_cell(centre_um[0], 2).text, number_cell(centre_um[1], 2).text)};
}

Cell pass_cell(const laser::CirclePass& pass) {
  return record_cell("  {direction:<4} {run:>4} {G_um:>9} {F_max_um:>9} {F_min_um:>9} {mean_um:>9}   {centre_um}\n",
                     "direction"_is(laser::contouring_name(pass.clockwise)), "run"_is(pass.run),
                     "G_um"_is(pass.G_um, 2), "F_max_um"_is(pass.F_max_um, 2), "F_min_um"_is(pass.F_min_um, 2),
                     "mean_um"_is(pass.mean_um, 2), "centre_um"_is(centre_cell(pass.centre_um)));
}

Cell pair_cell(const laser::CirclePair& pair) {
  return record_cell(
      "  both directions, run {counter_clockwise_run} ccw with run {clockwise_run} cw: G(b) {G_um} um, mean radial "
      "deviation D {D_um} um, hysteresis H {H_um} um at {H_at_deg} deg, all about the centre {centre_um} um\n",
      "counter_clockwise_run"_is(pair.counter_clockwise_run), "clockwise_run"_is(pair.clockwise_run),
      "G_um"_is(pair.G_um, 2), "D_um"_is(pair.D_um, 2), "H_um"_is(pair.H_um, 2), "H_at_deg"_is(pair.H_at_deg, 0),
      "centre_um"_is(centre_cell(pair.centre_um)));
}

Cell part_cell(const laser::CirclePass& pass, const laser::CirclePart& part) {
  const std::string from =
      pass.common == 0 ? std::string("fitted with the centre: no angles in common")
                       : fmt::format("from {} reading{} at common angles{}", pass.common, pass.common == 1 ? "" : "s",
                                     part.sigma_um ? fmt::format(", u = {:.2f} um", *part.sigma_um) : std::string());
  return record_cell(
      "  {direction:<4} run {run}, part {part}: zero {zero_um} um relative to the first part of its run ({from})\n",
      "direction"_is(laser::contouring_name(pass.clockwise)), "run"_is(pass.run), "part"_is(part.part),
      "zero_um"_is(part.zero_um, 2), "sigma_um"_is(part.sigma_um, 2), "from"_shown(from),
      "common_readings"_is(pass.common));
}

/// Of passes that were measured in parts, and what such passes cannot show.
Cell parts_cell(const laser::CircleValues& values) {
  Cell parts{Json::array(), {}};
  bool fitted = false;
  for (const laser::CirclePass& pass : values.passes)
    for (std::size_t i = 1; i < pass.parts.size(); ++i) {
      parts.add(part_cell(pass, pass.parts[i]));
      fitted = fitted || pass.common == 0;
    }
  if (values.with_other_zeros)
    parts.text +=
        "  note: the directions have no zero in common (their numbers in the column `part` differ): G(b), D and H are "
        "not "
        "determined\n";
  if (fitted)
    parts.text +=
        "  note: the parts have no angle in common, so only the assumption of a circle separates eccentricity and "
        "difference of zeros. G, F, H and the centre do not include errors that are constant within a part. Measure "
        "each part a "
        "few degrees beyond its end\n";
  return parts;
}

Cell fault_cell(const model::CircleFaultFound& fault) {
  std::string rivals;
  if (!fault.indistinguishable_from.empty())
    rivals = fmt::format("          these readings cannot distinguish it from {}\n",
                         fmt::join(fault.indistinguishable_from, ", "));
  const std::string decay = fault.nonlinear_sigma_mm ? fmt::format(", decay {:.3g} +- {:.2g} mm", fault.nonlinear_mm,
                                                                   *fault.nonlinear_sigma_mm)
                                                     : std::string();
  return record_cell("  {share:>6} {rms_um:>8} {range_um:>8}  {title}: {value} +- {sigma} {unit}{decay}\n{rivals}",
                     "name"_is(fault.name), "title"_is(fault.title),
                     "share"_is(fault.share, fmt::format("{:.1f} %", 100.0 * fault.share)),
                     "rms_um"_is(fault.rms_um, 2), "range_um"_is(fault.range_um, 2), "value"_is(fault.value, 2),
                     "sigma"_is(fault.sigma, 2), "unit"_is(fault.unit), "decay"_shown(decay),
                     "component"_is(fault.component.empty() ? Json() : Json(fault.component)),
                     "nonlinear_mm"_is(fault.nonlinear_mm > 0.0 ? Json(fault.nonlinear_mm) : Json()),
                     "nonlinear_sigma_mm"_is(fault.nonlinear_sigma_mm), "false_naming"_is(std::exp(fault.ln_p)),
                     "indistinguishable_from"_is(fault.indistinguishable_from), "rivals"_shown(rivals));
}

Cell diagnosis_cell(const model::CircleDiagnosis& diagnosis) {
  const std::string heading =
      diagnosis.faults.empty()
          ? std::string("  none of the known causes exceeds the noise\n")
          : fmt::format(
                "  share: mean square of this cause, as a percentage of the sum for all causes and the residual\n"
                "  {:>8} {:>8} {:>8}  {}\n",
                "share", "rms [um]", "G [um]", "cause, with its size +- standard uncertainty (k = 1)");
  return record_cell(
      "causes: deviations {rms_um} um rms from the best-fitting circle of each pass; noise {noise_um} um{from}, "
      "residual "
      "{left_um} um "
      "rms\n{faults}{notes}",
      "rms_um"_is(diagnosis.rms_um, 3), "noise_um"_is(diagnosis.noise_um, 3),
      "noise_from_repeats"_is(diagnosis.noise_from_repeats),
      "from"_shown(diagnosis.noise_from_repeats ? " (from repeats)" : " (from neighbouring readings)"),
      "left_um"_is(diagnosis.left_um, 3), "explained"_is(diagnosis.explained),
      "lack_of_fit_p"_is(std::exp(diagnosis.lack_of_fit_ln_p)),
      "faults"_is(list_cell(diagnosis.faults, fault_cell, heading)),
      "notes"_is(lines_cell(diagnosis.notes, "  note: ")));
}

Cell ball_bar_cause_cell(const BallBarCause& cause) {
  return record_cell("  {title:<36} {theirs:>10} {ours:>10} {difference:>10}  {unit}\n", "name"_is(cause.name),
                     "title"_is(cause.title), "theirs"_is(cause.theirs, 2), "ours"_is(cause.ours, 2),
                     "ours_sigma"_is(cause.ours_sigma, 2), "difference"_is(cause.difference, 2), "unit"_is(cause.unit),
                     "features"_is(cause.features));
}

/// What the ball bar's own program says of the same circle, next to our causes.
Result<Cell> other_cell(const std::string& file, const CircleWork& work) {
  if (file.empty()) return null_cell();
  ECS_TRY(xml, read_file_of(FileKind::ball_bar, file));
  ECS_TRY(theirs, parse_ball_bar(xml, file));
  ECS_TRY(compared, compared_with(work, theirs));
  const std::string heading = fmt::format("  {:<36} {:>10} {:>10} {:>10}\n", "cause", "ball bar", "here", "difference");
  std::string of;
  for (const auto& [name, value] :
       {std::pair{"test", &theirs.test}, std::pair{"machine", &theirs.machine}, std::pair{"date", &theirs.date},
        std::pair{"ball bar", &theirs.serial_number}, std::pair{"calibrated", &theirs.calibrated}})
    if (!value->empty()) of += fmt::format(", {} {}", name, *value);
  return record_cell(
      "compared with the ball bar's own result, {file}: plane {plane}{of}\n{causes}{not_compared}{notes}",
      "file"_is(file), "plane"_is(laser::plane_name(theirs.plane)), "of"_shown(of), "test"_is(text_cell(theirs.test)),
      "machine"_is(text_cell(theirs.machine)), "date"_is(text_cell(theirs.date)),
      "serial_number"_is(text_cell(theirs.serial_number)), "calibrated"_is(text_cell(theirs.calibrated)),
      "causes"_is(list_cell(compared.causes, ball_bar_cause_cell, heading)),
      "not_compared"_is(lines_cell(compared.not_compared, "  not compared: ")),
      "notes"_is(lines_cell(compared.notes, "  note: ")));
}

Result<Outcome> circle(VerbContext&, const CircleRequest& request) {
  std::optional<params::Machine> machine;
  if (!request.machine.empty()) {
    ECS_TRY(file, params::read_machine(request.machine));
    machine = file.machine;
  }
  ECS_TRY(work, circle_work(request.file, machine ? &*machine : nullptr));
  const laser::CircleTest& test = work.test;
  const laser::CircleValues& values = work.values;
  ECS_TRY(other, other_cell(request.other, work));
  if (!request.plot.empty()) ECS_DO(write_plot(request.plot, polar_figure(test, values)));
  return outcome_of(record_cell(
      "{file}: plane {plane}, radius {radius_mm} mm\n"
      "  {heading}\n{passes}  mean: radius of the least-squares circle minus the nominal "
      "radius\n{parts}{pairs}{causes}{other}{drawn}{plot}",
      "file"_is(request.file), "plane"_is(laser::plane_name(test.plane)), "radius_mm"_is(test.radius_mm),
      "feed_mm_min"_is(test.feed_mm_min),
      "heading"_shown(fmt::format("{:<4} {:>4} {:>9} {:>9} {:>9} {:>9}   {}", "", "run", "G [um]", "Fmax [um]",
                                  "Fmin [um]", "mean [um]", "centre [um]")),
      "passes"_is(list_cell(values.passes, pass_cell)), "parts"_is(parts_cell(values)),
      "pairs"_is(list_cell(values.pairs, pair_cell)), "causes"_is(diagnosis_cell(work.diagnosis)), "other"_is(other),
      "drawn"_shown(request.draw ? polar_text(values) : ""), "plot"_is(written_cell("plot", request.plot))));
}

struct DiagonalRequest {
  std::string file;
  static Fields<DiagonalRequest> fields() {
    using R = DiagonalRequest;
    return {{"FILE", &R::file,
             "CSV file with the columns diagonal, position_mm (along the diagonal), deviation_um, approach (1, -1) and "
             "run; "
             "diagonal is named by the direction of X, Y and Z along it: P with the axis, N against it, 0 axis at rest "
             "(PPP, NPP, PNP and PPN of the volume, PP0 and NP0 of the XY face)",
             Need::required}};
  }
};

Cell diagonal_cell(const laser::DiagonalValues& values) {
  const laser::Iso230& iso = values.iso;
  return record_cell(
      "  {name:<8} {length_mm:>10} {E:>8} {R:>8} {A:>8} {B:>8} {M:>8} {growth_um_per_m:>9} +- "
      "{growth_sigma}\n",
      "name"_is(values.name), "length_mm"_is(values.length_mm, 1), "E"_is(iso.E, 2), "R"_is(iso.R, 2), "A"_is(iso.A, 2),
      "B"_is(iso.B, 2), "M"_is(iso.M, 2), "growth_um_per_m"_is(values.growth_um_per_m, 2),
      "growth_sigma"_is(values.growth_sigma, 2));
}

Cell squareness_cell(const laser::DiagonalSquareness& squareness) {
  return record_cell("  squareness {name}: {um_per_m} +- {sigma} um/m (k = 1)\n", "name"_is(squareness.name),
                     "um_per_m"_is(squareness.um_per_m, 2), "sigma"_is(squareness.sigma, 2));
}

/// Of step diagonals: what came while one axis moved.
Cell moving_cell(const laser::DiagonalReadings& diagonal) {
  Json axes = Json::object();
  std::string text = fmt::format("  {:<8} while", diagonal.name);
  for (const Axis axis : kAllAxes)
    if (const auto& sum_um = diagonal.while_moving_um[index_of(axis)]) {
      axes[std::string(1, letter_of(axis))] = number_or_null(*sum_um);
      text += fmt::format("  {} moved {:+.2f} um", letter_of(axis), *sum_um);
    }
  if (axes.empty()) return {Json(), {}};
  return {object_of("name"_is(diagonal.name), "um"_is(std::move(axes))), text + "\n"};
}

std::string body_text(const laser::DiagonalResults& results) {
  if (!results.body_difference_um) return {};
  return fmt::format(
      "  body diagonals: largest E {} um, largest B {} um, largest difference of their slopes, times the "
      "length of the diagonal, {:.2f} um\n",
      number_cell(results.E_body_um, 2).text, number_cell(results.B_body_um, 2).text, *results.body_difference_um);
}

Result<Outcome> diagonals(VerbContext&, const DiagonalRequest& request) {
  ECS_TRY(text, read_file_of(FileKind::diagonal_test, request.file));
  ECS_TRY(test, laser::parse_diagonals(text, request.file));
  ECS_TRY(results, laser::diagonal_results_of(test));
  Cell moving{Json::array(), {}};
  if (test.steps)
    for (const laser::DiagonalReadings& diagonal : test.diagonals) moving.add(moving_cell(diagonal));
  const std::string heading = fmt::format("  {:<8} {:>10} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9}\n", "diagonal",
                                          "length mm", "E [um]", "R", "A", "B", "M", "slope um/m (k = 1)");
  return outcome_of(record_cell("{file}: {kind}\n{diagonals}{body}{squareness}{while_moving}{notes}",
                                "file"_is(request.file), "kind"_is(test.steps ? "step diagonals" : "diagonals"),
                                "diagonals"_is(list_cell(results.diagonals, diagonal_cell, heading)),
                                "body"_shown(body_text(results)), "E_body_um"_is(results.E_body_um),
                                "B_body_um"_is(results.B_body_um), "body_difference_um"_is(results.body_difference_um),
                                "squareness"_is(list_cell(results.squareness, squareness_cell)),
                                "while_moving"_is(moving), "notes"_is(lines_cell(results.notes, "  note: "))));
}

}  // namespace

extern const std::vector<Action> kTestsOfPaths{
    action("test circle", "ISO 230-4: circular deviations G, F and D, and their causes with their shares",
           "ecs test circle circle.csv --machine machine.toml --plot circle.svg", circle,
           {.logged = Logged::always, .kind = "test"}),
    action("test diagonals",
           "ISO 230-6: errors along the diagonals of the working volume or of a face, and the squareness that follows",
           "ecs test diagonals diagonals.csv --json", diagonals, {.logged = Logged::always, .kind = "test"})};

}  // namespace ecs::app
