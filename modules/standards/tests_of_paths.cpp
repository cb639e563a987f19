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
#include "modules/standards/circle_work.hpp"

namespace ecs::app {
namespace {

struct CircleRequest {
  std::string file, machine, plot;
  bool draw = false;
  static Fields<CircleRequest> fields() {
    using R = CircleRequest;
    return {{"FILE", &R::file, "radial deviations: angle_deg,deviation_um,direction,run", Need::required},
            {"--machine", &R::machine, "machine file, for the pitches of its axes"},
            {"--draw", &R::draw, "the polar plot in characters"},
            {"--plot", &R::plot, "the polar plot: OUT.svg or OUT.png", Is::output}};
  }
};

Cell centre_cell(const std::array<double, 2>& centre_um) {
  return {{centre_um[0], centre_um[1]}, fmt::format("({:.2f}, {:.2f})", centre_um[0], centre_um[1])};
}

Cell pass_cell(const laser::CirclePass& pass) {
  return record_cell("  {direction:<4} {run:>4} {G_um:>9} {F_max_um:>9} {F_min_um:>9} {mean_um:>9}   {centre_um}\n",
                     {{"direction", word_cell(laser::contouring_name(pass.clockwise))},
                      {"run", integer_cell(pass.run)},
                      {"G_um", number_cell(pass.G_um, 2)},
                      {"F_max_um", number_cell(pass.F_max_um, 2)},
                      {"F_min_um", number_cell(pass.F_min_um, 2)},
                      {"mean_um", number_cell(pass.mean_um, 2)},
                      {"centre_um", centre_cell(pass.centre_um)}});
}

Cell pair_cell(const laser::CirclePair& pair) {
  return record_cell(
      "  both, run {counter_clockwise_run} ccw and {clockwise_run} cw: G(b) {G_um} um, D {D_um} um, hysteresis H "
      "{H_um} "
      "um at {H_at_deg} deg, all about the centre {centre_um} um\n",
      {{"counter_clockwise_run", integer_cell(pair.counter_clockwise_run)},
       {"clockwise_run", integer_cell(pair.clockwise_run)},
       {"G_um", number_cell(pair.G_um, 2)},
       {"D_um", number_cell(pair.D_um, 2)},
       {"H_um", number_cell(pair.H_um, 2)},
       {"H_at_deg", number_cell(pair.H_at_deg, 0)},
       {"centre_um", centre_cell(pair.centre_um)}});
}

Cell fault_cell(const model::CircleFaultFound& fault) {
  std::string rivals;
  if (!fault.indistinguishable_from.empty())
    rivals =
        fmt::format("          these readings cannot tell it from {}\n", fmt::join(fault.indistinguishable_from, ", "));
  const std::string decay = fault.nonlinear_sigma_mm ? fmt::format(", decay {:.3g} +- {:.2g} mm", fault.nonlinear_mm,
                                                                   *fault.nonlinear_sigma_mm)
                                                     : std::string();
  return record_cell("  {share:>6} {rms_um:>8} {range_um:>8}  {title}: {value} +- {sigma} {unit}{decay}\n{rivals}",
                     {{"name", word_cell(fault.name)},
                      {"title", word_cell(fault.title)},
                      {"share", {number_or_null(fault.share), fmt::format("{:.1f} %", 100.0 * fault.share)}},
                      {"rms_um", number_cell(fault.rms_um, 2)},
                      {"range_um", number_cell(fault.range_um, 2)},
                      {"value", number_cell(fault.value, 2)},
                      {"sigma", number_cell(fault.sigma, 2)},
                      {"unit", word_cell(fault.unit)},
                      {"decay", shown_cell(decay)},
                      {"component", {fault.component.empty() ? Json() : Json(fault.component), {}}},
                      {"nonlinear_mm", {fault.nonlinear_mm > 0.0 ? Json(fault.nonlinear_mm) : Json(), {}}},
                      {"nonlinear_sigma_mm", {number_or_null(fault.nonlinear_sigma_mm), {}}},
                      {"false_naming", {number_or_null(std::exp(fault.ln_p)), {}}},
                      {"indistinguishable_from", {fault.indistinguishable_from, {}}},
                      {"rivals", shown_cell(rivals)}});
}

Cell diagnosis_cell(const model::CircleDiagnosis& diagnosis) {
  const std::string heading = diagnosis.faults.empty()
                                  ? std::string("  no fault of the library stands out of the noise\n")
                                  : fmt::format("  {:>8} {:>8} {:>8}  {}\n", "share", "rms [um]", "G [um]", "cause");
  return record_cell(
      "causes: deviations {rms_um} um rms about the centre, noise {noise_um} um{from}, {left_um} um rms left\n"
      "{faults}{notes}",
      {{"rms_um", number_cell(diagnosis.rms_um, 3)},
       {"noise_um", number_cell(diagnosis.noise_um, 3)},
       {"noise_from_repeats", {diagnosis.noise_from_repeats, {}}},
       {"from", shown_cell(diagnosis.noise_from_repeats ? " (from repeats)" : " (from neighbouring readings)")},
       {"left_um", number_cell(diagnosis.left_um, 3)},
       {"explained", {number_or_null(diagnosis.explained), {}}},
       {"lack_of_fit_p", {number_or_null(std::exp(diagnosis.lack_of_fit_ln_p)), {}}},
       {"faults", list_cell(diagnosis.faults, fault_cell, heading)},
       {"notes", lines_cell(diagnosis.notes, "  note: ")}});
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
  if (!request.plot.empty()) ECS_DO(write_plot(request.plot, polar_figure(test, values)));
  return outcome_of(
      record_cell("{file}: plane {plane}, radius {radius_mm} mm\n"
                  "  {heading}\n{passes}{pairs}{causes}{drawn}{plot}",
                  {{"file", word_cell(request.file)},
                   {"plane", word_cell(laser::plane_name(test.plane))},
                   {"radius_mm", plain_cell(test.radius_mm)},
                   {"feed_mm_min", {number_or_null(test.feed_mm_min), {}}},
                   {"heading", shown_cell(fmt::format("{:<4} {:>4} {:>9} {:>9} {:>9} {:>9}   {}", "", "run", "G [um]",
                                                      "Fmax [um]", "Fmin [um]", "mean [um]", "centre [um]"))},
                   {"passes", list_cell(values.passes, pass_cell)},
                   {"pairs", list_cell(values.pairs, pair_cell)},
                   {"causes", diagnosis_cell(work.diagnosis)},
                   {"drawn", shown_cell(request.draw ? polar_text(values) : "")},
                   {"plot", written_cell("plot", request.plot)}}));
}

struct DiagonalRequest {
  std::string file;
  static Fields<DiagonalRequest> fields() {
    using R = DiagonalRequest;
    return {{"FILE", &R::file, "deviations along diagonals: diagonal,position_mm,deviation_um,approach,run",
             Need::required}};
  }
};

Cell diagonal_cell(const laser::DiagonalValues& values) {
  const laser::Iso230& iso = values.iso;
  return record_cell(
      "  {name:<8} {length_mm:>10} {E:>8} {R:>8} {A:>8} {B:>8} {M:>8} {growth_um_per_m:>9} +- "
      "{growth_sigma}\n",
      {{"name", word_cell(values.name)},
       {"length_mm", number_cell(values.length_mm, 1)},
       {"E", number_cell(iso.E, 2)},
       {"R", number_cell(iso.R, 2)},
       {"A", number_cell(iso.A, 2)},
       {"B", number_cell(iso.B, 2)},
       {"M", number_cell(iso.M, 2)},
       {"growth_um_per_m", number_cell(values.growth_um_per_m, 2)},
       {"growth_sigma", number_cell(values.growth_sigma, 2)}});
}

Cell squareness_cell(const laser::DiagonalSquareness& squareness) {
  return record_cell("  squareness {name}: {um_per_m} +- {sigma} um/m\n",
                     {{"name", word_cell(squareness.name)},
                      {"um_per_m", number_cell(squareness.um_per_m, 2)},
                      {"sigma", number_cell(squareness.sigma, 2)}});
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
  return {{{"name", diagonal.name}, {"um", std::move(axes)}}, text + "\n"};
}

std::string body_text(const laser::DiagonalResults& results) {
  if (!results.body_difference_um) return {};
  return fmt::format("  body diagonals: largest E {} um, largest B {} um, difference of their growth {:.2f} um\n",
                     number_cell(results.E_body_um, 2).text, number_cell(results.B_body_um, 2).text,
                     *results.body_difference_um);
}

Result<Outcome> diagonals(VerbContext&, const DiagonalRequest& request) {
  ECS_TRY(text, read_file_of(FileKind::diagonal_test, request.file));
  ECS_TRY(test, laser::parse_diagonals(text, request.file));
  ECS_TRY(results, laser::diagonal_results_of(test));
  Cell moving{Json::array(), {}};
  if (test.steps)
    for (const laser::DiagonalReadings& diagonal : test.diagonals) moving.add(moving_cell(diagonal));
  const std::string heading = fmt::format("  {:<8} {:>10} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9}\n", "diagonal",
                                          "length mm", "E [um]", "R", "A", "B", "M", "um/m");
  return outcome_of(record_cell("{file}: {kind}\n{diagonals}{body}{squareness}{while_moving}{notes}",
                                {{"file", word_cell(request.file)},
                                 {"kind", word_cell(test.steps ? "step diagonals" : "diagonals")},
                                 {"diagonals", list_cell(results.diagonals, diagonal_cell, heading)},
                                 {"body", shown_cell(body_text(results))},
                                 {"E_body_um", {number_or_null(results.E_body_um), {}}},
                                 {"B_body_um", {number_or_null(results.B_body_um), {}}},
                                 {"body_difference_um", {number_or_null(results.body_difference_um), {}}},
                                 {"squareness", list_cell(results.squareness, squareness_cell)},
                                 {"while_moving", moving},
                                 {"notes", lines_cell(results.notes, "  note: ")}}));
}

}  // namespace

extern const std::vector<Action> kTestsOfPaths{
    action("test circle", "ISO 230-4: circular deviations G, F and D, and their causes by share",
           "ecs test circle circle.csv --machine machine.toml --plot circle.svg", circle,
           {.logged = Logged::always, .kind = "test"}),
    action("test diagonals", "ISO 230-6: body and face diagonals, step diagonals with their warning",
           "ecs test diagonals diagonals.csv --json", diagonals, {.logged = Logged::always, .kind = "test"})};

}  // namespace ecs::app
