// `ecs test blocks`: the scale error of an axis and the constant of its tool or probe from lengths of artefacts.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file_kind.hpp"
#include "modules/standards/gauge_block_fit.hpp"

namespace ecs::app {
namespace {

struct BlocksRequest {
  std::string file;
  static Fields<BlocksRequest> fields() {
    return {{"FILE", &BlocksRequest::file,
             "file of lengths: nominal_mm,measured_mm and, where known, touch (outside, inside, step), block, U_um, "
             "t_block_degC, t_machine_degC, from_mm",
             Need::required}};
  }
};

Cell value_cell(const std::optional<laser::BlockValue>& value, std::string_view title, std::string_view unit,
                std::string_view meaning) {
  if (!value) return null_cell();
  const std::string readings = value->u_readings ? fmt::format("{:.2f}", *value->u_readings) : std::string("unknown");
  return record_cell(
      "  {title:<14} {value:>9} +- {U:>7} {unit:<5} (u from the readings: {readings}, from the "
      "calibration: {u_calibration}){meaning}\n",
      "title"_shown(title), "value"_is(value->value, 2), "U"_is(value->U, 2), "unit"_is(unit),
      "readings"_shown(readings), "u_readings"_is(value->u_readings, 2), "u_calibration"_is(value->u_calibration, 2),
      "meaning"_shown(meaning));
}

Cell mean_cell(const laser::BlockMean& mean) {
  return record_cell("  {block:<14} {touch:<8} {nominal_mm:>10} {count:>8} {error_um:>11} {residual_um:>13}\n",
                     "block"_is(mean.block), "touch"_is(name_of(mean.touch)), "nominal_mm"_is(mean.nominal_mm),
                     "count"_is(mean.count), "error_um"_is(mean.error_um, 2), "residual_um"_is(mean.residual_um, 2));
}

/// The factors of both parts of U, which are joined as the root of the sum of their squares.
std::string coverage_text(const laser::BlockFit& fit) {
  if (!fit.noise_um) return "  +-: expanded uncertainty U (95.45 %), k = 2\n";
  return fmt::format(
      "  +-: expanded uncertainty U (95.45 %): k = {:.2f} for the readings ({:g} degree{} of freedom), 2 for the "
      "calibration\n",
      fit.coverage_factor, fit.coverage_degrees, fit.coverage_degrees == 1.0 ? "" : "s");
}

std::string scatter_text(const laser::BlockFit& fit) {
  if (!fit.noise_um) return {};
  return fmt::format("  standard deviation of a reading {:.2f} um ({} with {:g} degree{} of freedom){}\n",
                     *fit.noise_um, fit.noise_from_repeats ? "from repeats" : "about the straight line",
                     fit.degrees_of_freedom, fit.degrees_of_freedom == 1.0 ? "" : "s",
                     fit.lack_of_fit_p ? fmt::format(", lack of fit p = {:.2g}", *fit.lack_of_fit_p) : std::string());
}

Result<Outcome> blocks(VerbContext&, const BlocksRequest& request) {
  ECS_TRY(text, read_file_of(FileKind::gauge_blocks, request.file));
  ECS_TRY(test, laser::parse_gauge_blocks(text, request.file));
  const laser::BlockFit fit = laser::block_fit_of(test);
  const std::string axis(1, letter_of(test.axis));
  const auto of_readings = [&](double value) { return fit.noise_um ? std::optional(value) : std::nullopt; };
  const std::string heading = fmt::format("  {:<14} {:<8} {:>10} {:>8} {:>11} {:>13}\n", "block", "touched",
                                          "length mm", "readings", "error [um]", "residual [um]");
  return outcome_of(record_cell(
      "{file}: {readings} lengths along {axis}, {kind}; error = {error_is}\n{blocks}{scale}"
      "{constant}{error}{coverage}{scatter}{notes}",
      "file"_is(request.file), "axis"_is(axis), "readings"_is(test.readings.size()), "cut"_is(test.cut),
      "kind"_shown(test.cut ? "cut by the machine" : "measured by the machine"),
      "error_is"_shown(
          test.cut
              ? "length cut - programmed length"
              : "true length - length shown by the machine (the sign is opposite to that of an error of indication)"),
      "blocks"_is(list_cell(fit.means, mean_cell, heading)),
      "scale"_is(value_cell(fit.scale_um_per_m, "scale error", "um/m", "")),
      "constant"_is(value_cell(
          fit.constant_um, "constant", "um",
          "\n    It makes the error of outside measurements more negative by this amount, and\n    that of inside ones "
          "more positive. If it is positive, the tool or probe is\n    larger than assumed. It includes the lost "
          "motion.")),
      "error"_is(value_cell(fit.error_um, "error", "um", ", scale and constant together over this length")),
      "coverage_factor"_is(of_readings(fit.coverage_factor)),
      "coverage_degrees_of_freedom"_is(of_readings(fit.coverage_degrees)), "coverage"_shown(coverage_text(fit)),
      "correlation"_is(fit.correlation, 2), "noise_um"_is(fit.noise_um, 3),
      "degrees_of_freedom"_is(fit.degrees_of_freedom), "noise_from_repeats"_is(fit.noise_from_repeats),
      "lack_of_fit_p"_is(fit.lack_of_fit_p), "scatter"_shown(scatter_text(fit)),
      "notes"_is(lines_cell(fit.notes, "  note: "))));
}

}  // namespace

extern const std::vector<Action> kTestsOfLengths{
    action("test blocks",
           "scale error of an axis and the size of its tool or probe, from gauge blocks or lengths cut on the machine",
           "ecs test blocks blocks.csv --json", blocks, {.logged = Logged::always, .kind = "test"})};

}  // namespace ecs::app
