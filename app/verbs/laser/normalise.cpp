// `ecs laser normalise`: errors referred to 20 degC by a coefficient, and back; `ecs laser air`: the index of air.
#include "laser/analysis/normalise.hpp"

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/answer_table.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::app {
namespace {

struct NormaliseArguments : VerbArguments {
  const std::string& file = text("FILE", "measurement file", Need::required);
  const std::optional<double>& coefficient =
      optional_number("--coefficient", "expansion of the result [um per metre and degC]; 0: none");
  const std::optional<double>& instrument = optional_number(
      "--instrument", "what the instrument applied already; from the file if not given (Renishaw Exp coeff)");
  const std::string& sensor =
      text("--material-sensor", "column with the temperature of the material", Need::optional, "t_material_degC");
  const std::optional<double>& material_degC =
      optional_number("--material", "one material temperature for all readings [degC]");
  const double& fixed_mm = number("--fixed", "position that expansion leaves where it is [mm]", 0.0);
  const bool& back = flag("--back", "take it back, to the last digit");
  const std::string& output = output_file("-o,--output", "the CSV to write");
  ImportOptions import{*this};
};

Result<void> written(const std::string& output, const laser::MeasurementSet& set) {
  if (output.empty()) return {};
  return laser::write_measurement_set(output, set);
}

Result<Outcome> taken_back(const NormaliseArguments& arguments, const laser::MeasurementSet& set) {
  ECS_TRY(back, laser::denormalised(set));
  ECS_DO(written(arguments.output, back));
  return outcome_of(record_cell("{readings} readings as they were before they were referred to 20 degC\n",
                                {{"file", word_cell(arguments.file)},
                                 {"readings", count_cell(back.readings.size())},
                                 {"output", text_cell(arguments.output)}}));
}

Result<Outcome> normalise(VerbContext& context, const NormaliseArguments& arguments) {
  if (arguments.back == arguments.coefficient.has_value())
    return problem(
        ProblemKind::usage,
        "expected --coefficient C (um per metre and degC; 0 takes out what the instrument applied) or --back");
  ECS_DO(check_output_not_input(arguments.output, {arguments.file}));
  ECS_TRY(imported, read_with_notes(context, arguments.file, arguments.import));
  if (arguments.back) return taken_back(arguments, imported.set);
  laser::Normalisation how;
  how.coefficient_um_per_m_degC = *arguments.coefficient;
  how.instrument_um_per_m_degC = arguments.instrument;
  how.material_degC = arguments.material_degC;
  how.sensor = arguments.sensor;
  how.fixed_mm = arguments.fixed_mm;
  const auto done = laser::normalised(imported.set, how);
  if (!done) {
    Problem why = done.error();
    why.file = arguments.file;
    return tl::unexpected(why);
  }
  ECS_DO(written(arguments.output, done->set));
  return outcome_of(record_cell(
      "{changed} of {readings} readings referred to 20 degC, changed by up to {largest_um} um\n{notes}{output}",
      {{"file", word_cell(arguments.file)},
       {"coefficient_um_per_m_degC", plain_cell(how.coefficient_um_per_m_degC)},
       {"instrument_um_per_m_degC", plain_cell(done->instrument_um_per_m_degC)},
       {"least_degC", plain_cell(done->least_degC)},
       {"most_degC", plain_cell(done->most_degC)},
       {"fixed_mm", plain_cell(how.fixed_mm)},
       {"changed", count_cell(done->changed)},
       {"readings", count_cell(done->set.readings.size())},
       {"largest_um", number_cell(done->largest_um, 3)},
       {"per_coefficient_um", {number_or_null(done->per_coefficient_um), {}}},
       {"notes", lines_cell(done->notes, "  ")},
       {"output", arguments.output.empty() ? null_cell("nothing written: give -o OUT.csv to keep it\n")
                                           : Cell{arguments.output, fmt::format("written to {}; --back takes it back\n",
                                                                                arguments.output)}}}));
}

struct AirArguments : VerbArguments {
  const double& temperature_degC = number("--temperature", "[degC]", laser::BeamAir{}.temperature_degC);
  const double& pressure_hPa = number("--pressure", "[hPa]", laser::BeamAir{}.pressure_hPa);
  const double& humidity_pct = number("--humidity", "relative [%]", laser::BeamAir{}.humidity_pct);
  const double& co2_ppm = number("--co2", "carbon dioxide [ppm]", laser::BeamAir{}.co2_ppm);
  const double& wavelength_nm = number("--wavelength", "in vacuum [nm]", laser::kRedHeNe_nm);
};

Result<Outcome> air(VerbContext&, const AirArguments& arguments) {
  const laser::BeamAir beam{arguments.temperature_degC, arguments.pressure_hPa, arguments.humidity_pct,
                            arguments.co2_ppm};
  const auto ciddor = laser::refractive_index(beam, arguments.wavelength_nm);
  if (!ciddor) return tl::unexpected(Problem{ProblemKind::usage, ciddor.error().message, {}, 0, 0, {}});
  const auto edlen = laser::refractive_index(beam, arguments.wavelength_nm, laser::AirEquation::modified_edlen);
  const auto standard = laser::refractive_index({}, arguments.wavelength_nm);
  if (!edlen || !standard) return tl::unexpected(edlen ? standard.error() : edlen.error());
  const double against_standard_um_per_m = (*ciddor / *standard - 1.0) * 1e6;
  return outcome_of(
      record_cell("refractive index    {ciddor} (Ciddor)   {modified_edlen} (modified Edlen)\n"
                  "wavelength in air   {wavelength_in_air_nm} nm\n"
                  "against 20 degC, 1013.25 hPa, 50 %: {against_standard_um_per_m} um per metre\n",
                  {{"ciddor", number_cell(*ciddor, 9)},
                   {"modified_edlen", number_cell(*edlen, 9)},
                   {"wavelength_in_air_nm", number_cell(arguments.wavelength_nm / *ciddor, 6)},
                   {"against_standard_um_per_m",
                    {number_or_null(against_standard_um_per_m), fmt::format("{:+.3f}", against_standard_um_per_m)}}}));
}

}  // namespace

extern const VerbDefinition kLaserNormalise = verb<NormaliseArguments>(
    "laser normalise", "positioning errors referred to 20 degC by a coefficient of expansion, and back",
    "ecs laser normalise exx.csv --coefficient 11.7 -o exx20.csv\n"
    "  ecs laser normalise exx20.csv --back -o exx.csv",
    normalise);

extern const VerbDefinition kLaserAir =
    verb<AirArguments>("laser air", "refractive index of air by Ciddor and modified Edlen",
                       "ecs laser air --temperature 21.3 --pressure 992.4 --humidity 42", air);

}  // namespace ecs::app
