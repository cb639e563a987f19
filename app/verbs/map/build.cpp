// `ecs map build`: from measured files to map.csv, by a recipe or as the files themselves suggest; from readings of
// rotary axes their error motions over the angle, for `--rotary` of the next map and of `ecs volume`.

#include "laser/map/build.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/maps/from_model.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "commissioning/maps/rotary_part.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/unit/transfer.hpp"
#include "laser/map/csv.hpp"
#include "params/parameters_toml.hpp"
#include "volume/rotary_errors.hpp"

namespace ecs::app {
namespace {

Cell rotary_table_cell(const volume::RotaryTable& table) {
  const auto [least, greatest] = std::minmax_element(table.error.begin(), table.error.end());
  double mean = 0.0;
  for (const double error : table.error) mean += error / static_cast<double>(table.error.size());
  return record_cell(
      "{component:<9} {approach:>8} {unit:<4} {first_deg:>8} {last_deg:>8} {points:>6} {mean:>8} {band:>8}\n",
      "component"_is(volume::rotary_name(table.joint, table.sense)),
      "approach"_is(static_cast<int>(table.approach), fmt::format("{}", static_cast<int>(table.approach))),
      "unit"_is(laser::unit_of(table.sense)), "first_deg"_is(table.p_deg.front(), 1),
      "last_deg"_is(table.p_deg.back(), 1), "points"_is(table.p_deg.size()), "mean"_is(mean, 2),
      "band"_is(*greatest - *least, 2));
}

/// True where the first of these files holds readings of a rotary axis.
bool measures_rotary_axes(const std::vector<std::string>& files, const laser::FileReader& read) {
  if (files.empty() || lower(files.front()).ends_with(".toml")) return false;
  const auto first = read(files.front());
  return first && std::any_of(first->set.readings.begin(), first->set.readings.end(),
                              [](const laser::Reading& reading) { return reading.rotary; });
}

/// Every file read, the table written to `output` if one is given.
Result<Outcome> rotary_errors_built(VerbContext& context, const std::vector<std::string>& files,
                                    const laser::FileReader& read, const std::string& output) {
  std::vector<laser::MeasurementSet> sets;
  for (const std::string& file : files) {
    ECS_TRY(imported, read(file));
    note_what_was_read(context.console, file, imported);
    sets.push_back(std::move(imported.set));
    sets.back().source = file;
  }
  ECS_TRY(set, joined(sets));
  ECS_TRY(errors, volume::measured_rotary_errors(set));
  if (!output.empty())
    ECS_DO(write_file(output, volume::rotary_csv(errors, metadata_value(set, "machine").value_or(""))));
  return outcome_of(record_cell(
      "{tables}These are errors, not compensation. `ecs map build --rotary` adds them to the map of the\nlinear axes; "
      "`ecs volume --rotary` shows their effect at the tool.\n{rotary}",
      "rotary"_is(written_cell("errors of rotary axes", output, "nothing written: give -o rotary.csv to keep it\n")),
      "tables"_is(list_cell(errors.tables, rotary_table_cell,
                            fmt::format("{:<9} {:>8} {:<4} {:>8} {:>8} {:>6} {:>8} {:>8}\n", "", "approach", "unit",
                                        "from deg", "to deg", "points", "mean", "band")))));
}

/// With what the map of a model takes as well.
struct BuildRequest : FromModelArguments {
  std::vector<std::string> files;
  bool shrink = false, accept_resampling = false;
  ImportArguments import;
  static Fields<BuildRequest> fields() {
    using R = BuildRequest;
    return {{"FILE", &R::files,
             "recipe (.toml, docs/laser.md) or measurement files; with --image or --rotary also a map CSV"},
            {"--params", &R::params, "parameters of the unit; default with --from-model: those of `ecs params new`"},
            {"--from-model", &R::model, "fitted model (.toml) to use instead of measurement files"},
            {"--machine", &R::machine,
             "machine file (.toml) for --from-model and for the travels to cover; default: machine.toml in the folder "
             "of the parameters"},
            {"--rotary", &R::rotary,
             "file (.csv) with errors of the rotary axes for the unit to compensate; replaces those of a model; needs "
             "--machine (docs/five_axes.md)"},
            {"--increment", &R::increment_mm,
             "increment of the tables made by --from-model [mm]; chosen automatically if not given"},
            {"-o,--output", &R::output, "map CSV to write", Is::output},
            {"--params-out", &R::params_out, "parameter file to write, with the measured squareness", Is::output},
            {"--image", &R::image, "memory image to write: the bytes that `map send` would transmit", Is::output},
            {"--accept-resampling", &R::accept_resampling,
             "make the image of a map CSV even if resampling to equal increments changes a table by more than its "
             "resolution"},
            {"--zero", &R::zero, "declare a component zero, with a reason: EBY=\"too small to measure\""},
            {"--zero-missing", &R::zero_missing,
             "declare zero, with this reason, every component that the model lacks (needs --from-model)"},
            {"--customer", &R::customer, "customer to state in the map header"},
            {"--engineer", &R::engineer, "engineer to state in the map header"},
            {"--date", &R::date, "date in the map header, as in 2026-03-12"},
            {"--shrink", &R::shrink,
             "smooth every curve according to its noise, which is estimated from the repeats (docs/volume.md)"},
            &R::import};
  }
};

laser::FileReader reader_of_any_axis(const BuildRequest& request) {
  return laser::reading_once(
      [import = request.import.of_any_axis()](const auto& file) { return read_measurements(file.string(), import); });
}

/// Of linear axes only, as the unit's map is.
laser::FileReader linear(const laser::FileReader& read) {
  return [read](const auto& file) -> Result<laser::Imported> {
    ECS_TRY(imported, read(file));
    if (auto refused = laser::all_but_lines_refused(imported.set, file.string()))
      return tl::unexpected(std::move(*refused));
    return imported;
  };
}

bool by_recipe(const BuildRequest& request) { return lower(request.files.front()).ends_with(".toml"); }

/// As its file says, else as the measurement files suggest it. @param notes  on the files
Result<laser::SuggestedRecipe> recipe_of(const BuildRequest& request, const UnitParameters& parameters,
                                         const laser::FileReader& read, std::vector<std::string>& notes) {
  if (by_recipe(request) && request.files.size() > 1)
    return problem(ProblemKind::usage, "expected one recipe, or measurement files: the recipe names its own files");
  if (by_recipe(request)) {
    ECS_TRY(recipe, laser::read_map_recipe(request.files.front()));
    return laser::SuggestedRecipe{std::move(recipe), {}};
  }
  ECS_TRY(given, given_files(request.files));
  notes = given.notes;
  return laser::suggest_recipe({given.files.begin(), given.files.end()}, parameters, read);
}

Result<void> declare_zero(laser::MapRecipe& recipe, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    ECS_TRY(zero, declared_zero_in(word));
    const auto same = [&](const auto& other) { return other.component == zero.component; };
    if (std::any_of(recipe.components.begin(), recipe.components.end(), same) ||
        std::any_of(recipe.declared_zero.begin(), recipe.declared_zero.end(), same))
      return problem(ProblemKind::usage,
                     "--zero {}: this component is already measured or declared zero; keep only one",
                     name_of(zero.component));
    recipe.declared_zero.push_back(zero);
  }
  return {};
}

Result<void> complete(laser::MapRecipe& recipe, const BuildRequest& request) {
  if (!request.customer.empty()) recipe.customer = request.customer;
  if (!request.engineer.empty()) recipe.engineer = request.engineer;
  if (!request.date.empty()) recipe.date = request.date;
  recipe.shrink = recipe.shrink || request.shrink;
  return declare_zero(recipe, request.zero);
}

std::vector<std::string> files_for(const laser::MapRecipe& recipe, Component component) {
  std::vector<std::string> names;
  for (const auto& file : laser::settings_of(recipe, component).files) names.push_back(file.string());
  return names;
}

/// All that the answer contains.
struct Built {
  laser::SuggestedRecipe by;
  MadeMap made;
  params::ParametersFile parameters;  ///< with the measured squareness
  bool enter_squareness = false;      ///< it is in no parameter file yet
  std::vector<std::uint8_t> image;    ///< where it was asked for
};

Result<Built> built(const BuildRequest& request, const laser::FileReader& read) {
  ECS_TRY(parameters, request.params_out.empty() ? params::read_parameters(request.params)
                                                 : params::read_whole_parameters(request.params));
  std::vector<std::string> notes;
  ECS_TRY(recipe, recipe_of(request, parameters.parameters, read, notes));
  ECS_DO(complete(recipe.recipe, request));
  ECS_TRY(travels, travels_given(request.machine, request.params, parameters));
  ECS_TRY(made, made_map(recipe.recipe, parameters, travels, read));
  made.map.notes.insert(made.map.notes.begin(), notes.begin(), notes.end());
  const bool enter_squareness =
      request.params_out.empty() && squareness_differs(parameters.parameters, made.map.parameters);
  parameters.parameters = made.map.parameters;
  ECS_DO(add_rotary(made.map.map.header, request.rotary, request.machine, made.map.notes));
  if (!request.rotary.empty()) made.findings = findings_before_sending(made.map.map, parameters.parameters, travels);
  return Built{std::move(recipe), std::move(made), std::move(parameters), enter_squareness, {}};
}

Cell outcome_cell(const Built& b, const laser::ComponentOutcome& one) {
  const auto files = files_for(b.by.recipe, one.component);
  return record_cell(
      "{component:<4} {description:<37} {unit:<4} {band:>6} {largest:>7} {slope_removed_per_m:>6} {smoothed_rms:>6} "
      "{points:>3}\n     from {files} ({readings} readings)\n{notes}",
      "component"_is(name_of(one.component)), "description"_is(laser::description_of(one.component)),
      "unit"_is(unit_of(one.component)), "files"_is(files, fmt::format("{}", fmt::join(files, ", "))),
      "readings"_is(one.readings), "band"_is(one.band, 1), "largest"_is(one.largest, 1),
      "slope_removed_per_m"_is(one.slope_um_per_m, 1), "smoothed_rms"_is(one.smoothed_rms, 2), "points"_is(one.points),
      "notes"_is(lines_cell(one.notes, "     note: ")));
}

std::string declared_text(const Built& b) {
  std::string text;
  for (const laser::DeclaredZero& z : b.made.map.map.header.declared_zero)
    text += fmt::format("{:<4} {}\n     declared zero: {}\n", name_of(z.component), laser::description_of(z.component),
                        z.reason);
  return text;
}

Cell squareness_of(const Built& b, const BuildRequest& request) {
  std::vector<std::pair<Component, double>> values;
  for (const laser::ComponentOutcome& one : b.made.map.outcomes)
    if (is_squareness(one.component))
      values.emplace_back(one.component, squareness_um_per_m(b.made.map.parameters, one.component));
  return squareness_cell(values, "measured", request.params_out);
}

std::string squareness_rule_text(const Built& b) {
  if (std::ranges::none_of(b.made.map.outcomes, [](const auto& one) { return is_squareness(one.component); }))
    return {};
  return fmt::format("squareness: band in um; largest and slope in um/m. The parameter is {}\n",
                     b.parameters.parameters.convention == Convention::as_printed
                         ? "+slope, in the signs of the equations printed in the thesis"
                         : "-slope for C0Y and A0Z and +slope for B0Z");
}

Cell built_cell(const Built& b, const BuildRequest& request) {
  return record_cell(
      "{components}{declared}{rotary}band: range of the readings as measured; largest: largest compensation\nslope: "
      "slope removed, per m; smooth: rms removed by smoothing; n: points per "
      "table\n{of_squareness}{unused}{notes}{squareness}{findings}{verdict}{map}{params_out}{image}",
      "map"_is(written_cell("map", request.output, "nothing written: give -o map.csv to keep it\n")),
      "params_out"_is(written_cell("parameters", request.params_out)), "image"_is(image_cell(request.image, b.image)),
      "recipe"_is(text_cell(by_recipe(request) ? request.files.front() : "")), "complete"_is(b.made.complete()),
      "components"_is(list_cell(
          b.made.map.outcomes, [&](const auto& one) { return outcome_cell(b, one); },
          fmt::format("{:<4} {:<37} {:<4} {:>6} {:>7} {:>6} {:>6} {:>3}\n", "", "component", "unit", "band", "largest",
                      "slope", "smooth", "n"))),
      "of_squareness"_shown(squareness_rule_text(b)), "declared"_shown(declared_text(b)),
      "rotary"_shown(rotary_cell(b.made.map.map.header).text), "squareness"_is(squareness_of(b, request)),
      "missing"_is(lines_cell(objections_in(b.made.findings), "")), "findings"_is(findings_cell(b.made.findings)),
      "verdict"_shown(verdict_text(b.made.map.map, b.made.findings,
                                   !made_for_two_machines(b.made.map.map.header, b.parameters.identity).empty(),
                                   b.enter_squareness)),
      "unused"_is(lines_cell(b.by.unused, "not used: ")), "notes"_is(lines_cell(b.made.map.notes, "note: ")),
      "header"_is(header_cell(b.made.map.map.header)));
}

void warn_about_header(VerbContext& context, const Built& b) {
  for (const std::string& objection : made_for_two_machines(b.made.map.map.header, b.parameters.identity))
    context.console.warn(objection);
  const laser::MapHeader& header = b.made.map.map.header;
  for (const auto& [name, value] :
       {std::pair{"customer", header.customer}, {"engineer", header.engineer}, {"date", header.date}})
    if (value.empty())
      context.console.note(fmt::format(
          "the header has no {0} (optional: give --{0}, or {0} = \"...\" in a map recipe, docs/laser.md)", name));
}

Problem nothing_built(const Built& b) {
  std::vector<Problem> problems{
      {ProblemKind::refused, "no component could be built; no file was written", {}, 0, 0, {}}};
  for (const std::string& unused : b.by.unused)
    problems.push_back({ProblemKind::refused, "not used: " + unused, {}, 0, 0, {}});
  return folded(std::move(problems));
}

Result<Outcome> from_model(VerbContext& context, const BuildRequest& request) {
  if (!request.files.empty())
    return problem(ProblemKind::usage, "expected exactly one of: a recipe, measurement files, --from-model");
  if (request.shrink) return problem(ProblemKind::usage, "--shrink needs measurement files: a model has no repeats");
  ECS_TRY(map, map_from_model(context.console, request));
  return outcome_of(from_model_cell(map, request));
}

Result<void> enough_given(const BuildRequest& request) {
  if (request.files.empty())
    return problem(ProblemKind::usage, "expected FILE: a recipe (.toml) or measurement files; or --from-model MODEL");
  if (request.params.empty())
    return problem(ProblemKind::usage, "--params is required: the parameters of the unit to be compensated");
  if (!request.zero_missing.empty())
    return problem(ProblemKind::usage, "--zero-missing needs --from-model; without a model give --zero for each");
  if (request.increment_mm)
    return problem(ProblemKind::usage,
                   "--increment needs --from-model; a recipe gives increment_mm for each component");
  return {};
}

/// One file that is a map already.
bool is_map(const std::vector<std::string>& files) {
  if (files.size() != 1) return false;
  const auto content = read_file(files.front());
  return content && kind_of_content(*content) == FileKind::map;
}

/// The image of a map that is in a file, and the map, with rotary axes where they are given.
Result<Outcome> image_of_map(VerbContext& context, const BuildRequest& request) {
  const std::string& map = request.files.front();
  ECS_DO(enough_given(request));
  if (!request.params_out.empty() || (request.rotary.empty() && !request.output.empty()))
    return problem(ProblemKind::usage, "{} is a map already: only --image or --rotary makes a file from it", map);
  for (const std::string& output : {request.output, request.image})
    ECS_DO(check_output_not_input(output, {map, request.params, request.rotary, request.machine}));
  ECS_TRY(whole, laser::read_map_csv(map));
  std::vector<std::string> notes;
  ECS_DO(add_rotary(whole.header, request.rotary, request.machine, notes));
  for (const std::string& note : notes) context.console.note(note);
  ECS_TRY(parameters, params::read_parameters(request.params));
  ECS_TRY(prepared,
          prepared_map(whole, map, parameters, request.params, {.accept_resampling = request.accept_resampling}));
  for (const std::string& note : prepared.image.notes) context.console.note(note);
  for (const std::string& remark : prepared.remarks) context.console.warn(remark);
  ECS_TRY(image, image_for_file(prepared));
  ECS_DO(write_map(request.output, whole, {}, parameters.parameters, parameters.identity));
  ECS_DO(write_image(request.image, image));
  return outcome_of(
      record_cell("{rotary}{output}{image}", "map"_is(map), "rotary"_shown(rotary_cell(whole.header).text),
                  "output"_is(written_cell("map", request.output)), "image"_is(image_cell(request.image, image)),
                  "header"_is(header_cell(prepared.header))));
}

Result<Outcome> build(VerbContext& context, const BuildRequest& request) {
  if (const auto wrong = wrong_date(request.date)) return problem(ProblemKind::usage, "--date: " + *wrong);
  if (!request.model.empty()) return from_model(context, request);
  if ((!request.image.empty() || !request.rotary.empty()) && is_map(request.files))
    return image_of_map(context, request);
  const laser::FileReader read = reader_of_any_axis(request);
  if (measures_rotary_axes(request.files, read)) {
    if (!request.image.empty() || !request.rotary.empty())
      return problem(ProblemKind::usage,
                     "these files measure rotary axes: write them to a file with -o, then give it as --rotary with the "
                     "files of the linear axes");
    ECS_DO(check_output_not_input(request.output, request.files));
    return rotary_errors_built(context, request.files, read, request.output);
  }
  ECS_DO(enough_given(request));
  for (const std::string& output : {request.output, request.params_out, request.image})
    ECS_DO(check_output_not_input(output, request.files));
  ECS_TRY(b, built(request, linear(read)));
  if (b.made.map.outcomes.empty() && b.made.map.map.header.declared_zero.empty())
    return tl::unexpected(nothing_built(b));
  ECS_TRY(image, image_to_write(context.console, request.image, b.made.map.map, b.parameters, request.params));
  b.image = std::move(image);
  ECS_DO(write_map(request.output, b.made.map.map, request.params_out, b.made.map.parameters, b.parameters.identity));
  ECS_DO(write_image(request.image, b.image));
  warn_about_header(context, b);
  return outcome_of(built_cell(b, request));
}

}  // namespace

extern const std::vector<Action> kMapBuilding{action(
    "map build", "build the error map from measurement files, with the settings of a recipe or with proposed ones",
    "ecs map build recipe.toml --params mill.toml -o map.csv --params-out mill-measured.toml\n  ecs map build "
    "map.csv --params mill-measured.toml --image mill.image\n  ecs map build --from-model fitted.toml --machine "
    "machine.toml -o map.csv\n  ecs map build EXC.csv ECC.csv -o rotary.csv\n  ecs map build map.csv --params "
    "mill.toml --rotary rotary.csv --machine machine.toml -o five_axes.csv",
    build, {.logged = Logged::when_written, .kind = "map"})};

}  // namespace ecs::app
