// `ecs test diagonals`: body, face and step diagonals by ISO 230-6.
#include "laser/standards/diagonals.hpp"

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file_kind.hpp"

namespace ecs::app {
namespace {

struct DiagonalArguments : VerbArguments {
  const std::string& file =
      text("FILE", "deviations along diagonals: diagonal,position_mm,deviation_um,approach,run", Need::required);
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

Result<Outcome> diagonals(VerbContext&, const DiagonalArguments& arguments) {
  ECS_TRY(text, read_file_of(FileKind::diagonal_test, arguments.file));
  ECS_TRY(test, laser::parse_diagonals(text, arguments.file));
  ECS_TRY(results, laser::diagonal_results_of(test));
  Cell moving{Json::array(), {}};
  if (test.steps)
    for (const laser::DiagonalReadings& diagonal : test.diagonals) moving.add(moving_cell(diagonal));
  const std::string heading = fmt::format("  {:<8} {:>10} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9}\n", "diagonal",
                                          "length mm", "E [um]", "R", "A", "B", "M", "um/m");
  return outcome_of(record_cell("{file}: {kind}\n{diagonals}{body}{squareness}{while_moving}{notes}",
                                {{"file", word_cell(arguments.file)},
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

extern const VerbDefinition kTestDiagonals =
    verb<DiagonalArguments>("test diagonals", "ISO 230-6: body and face diagonals, step diagonals with their warning",
                            "ecs test diagonals diagonals.csv --json", diagonals);

}  // namespace ecs::app
