// `ecs lengths fit`: the 21 components from lengths, the map and the squareness.
#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/date.hpp"
#include "base/file.hpp"
#include "commissioning/lengths/view.hpp"
#include "commissioning/lengths/work.hpp"
#include "commissioning/measurements/files.hpp"
#include "laser/map/csv.hpp"

namespace ecs::app {
namespace {

struct LengthsFitArguments : VerbArguments {
  const std::string& file = text("LENGTHS", "measured lengths (.csv, docs/identification.md)", Need::required);
  const std::string& machine = text("--machine", "machine file: chain, travels, datum", Need::required);
  const std::string& params = text("--params", "parameters of the unit that the map is for");
  const std::string& output = output_file("-o,--output", "map CSV to write; needs --params");
  const std::string& params_out =
      output_file("--params-out", "parameters to write, with the squareness that was found");
  const std::string& knots =
      text("--knots",
           "spacing of the curves' knots X,Y,Z [mm]; by default as the file says, else twice the "
           "spacing of its coordinates");
  const int& reversal =
      integer("--reversal-degree", "of the reversal error as a polynomial; -1: the approach does not matter", 1, -1, 6);
  const double& scale = number("--scale", "of each set-up (air, wavelength), standard uncertainty [um/m]; 0: none", 0.1,
                               Need::optional, 0.0);
  const std::vector<std::string>& zero = texts("--zero", "declare a component zero: EBY=\"too small to measure\"");
  const bool& keep_outliers = flag("--keep-outliers", "leave no reading out");
  const std::string& customer = text("--customer", "for the header");
  const std::string& engineer = text("--engineer", "for the header");
  const std::string& date = text("--date", "for the header, as in 2026-03-12");

  [[nodiscard]] LengthsArguments arguments() const {
    return {file, machine, params, knots, zero, reversal, scale, keep_outliers, customer, engineer, date};
  }
};

Result<Outcome> fit_lengths(VerbContext&, const LengthsFitArguments& a) {
  if (const auto wrong = wrong_date(a.date)) return problem(ProblemKind::usage, "--date: " + *wrong);
  if ((!a.output.empty() || !a.params_out.empty()) && a.params.empty())
    return problem(ProblemKind::usage, "--params is required for a map: the parameters of the unit that it is for");
  for (const std::string& output : {a.output, a.params_out})
    ECS_DO(check_output_not_input(output, {a.file, a.machine, a.params}));
  ECS_TRY(work, lengths_work(a.arguments()));
  const bool writes = work.map.has_value();
  if (writes && !a.output.empty()) ECS_DO(write_file(a.output, laser::to_map_csv(*work.map)));
  if (writes && !a.params_out.empty())
    ECS_DO(params::write_parameters(a.params_out, work.unit->parameters, work.unit->identity));
  return outcome_of(lengths_cell(work, writes ? a.output : "", writes ? a.params_out : ""),
                    work.found.whole() ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kLengthsFit = verb<LengthsFitArguments>(
    "lengths fit", "the 21 components from lengths alone, with uncertainties; which are determined and which are not",
    "ecs lengths fit lengths.csv --machine machine.toml --params parameters.toml -o map.csv --params-out "
    "measured.toml",
    fit_lengths);

}  // namespace ecs::app
