// `ecs map build`: from measured files to map.csv, by a recipe or as the files themselves suggest.
#include "laser/map/build.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "app/verbs/map/rotary.hpp"
#include "base/answer_table.hpp"
#include "base/date.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/maps/build.hpp"
#include "commissioning/maps/declared_zero.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/maps/from_model.hpp"
#include "commissioning/maps/view.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/measurements/given_files.hpp"
#include "commissioning/unit/map_checks.hpp"
#include "laser/map/csv.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

struct BuildArguments : VerbArguments {
  const std::vector<std::string>& files = texts("FILE", "a recipe (.toml), or measurement files");
  const std::string& params =
      text("--params", "parameters of the unit; with --from-model those of the machine by default");
  const std::string& from_model = text("--from-model", "a fitted model (.toml) in place of measured files");
  const std::string& machine = text("--machine",
                                    "the machine (.toml): for --from-model, else for the travels to cover; "
                                    "by default machine.toml beside the parameters");
  const std::optional<double>& increment_mm =
      optional_number("--increment", "of the tables of --from-model [mm]; fine enough if not given");
  const std::string& output = output_file("-o,--output", "map CSV to write");
  const std::string& params_out =
      output_file("--params-out", "parameters to write, with the squareness that was measured");
  const std::vector<std::string>& zero = texts("--zero", "declare a component zero: EBY=\"too small to measure\"");
  const std::string& zero_missing =
      text("--zero-missing", "with --from-model: declare every component that the model lacks zero, for this reason");
  const std::string& customer = text("--customer", "for the header");
  const std::string& engineer = text("--engineer", "for the header");
  const std::string& date = text("--date", "for the header, as in 2026-03-12");
  const bool& shrink =
      flag("--shrink", "shrink every curve below its own noise, as its repeats show it (docs/volume.md)");
  ImportOptions import{*this};

  [[nodiscard]] laser::FileReader reader() const {
    return [this](const std::filesystem::path& file) { return read_measurements(file.string(), import); };
  }
};

struct Recipe {
  laser::MapRecipe recipe;
  std::string file;  ///< empty: suggested by the files
  std::vector<std::string> unused;
};

Result<Recipe> recipe_of(const BuildArguments& arguments, const UnitParameters& parameters) {
  const bool by_recipe = lower(arguments.files.front()).ends_with(".toml");
  if (by_recipe && arguments.files.size() > 1)
    return problem(ProblemKind::usage, "expected one recipe, or measurement files: the recipe names its own files");
  if (by_recipe) {
    ECS_TRY(recipe, laser::read_map_recipe(arguments.files.front()));
    return Recipe{std::move(recipe), arguments.files.front(), {}};
  }
  ECS_TRY(given, given_files(arguments.files));
  ECS_TRY(suggested, laser::suggest_recipe({given.files.begin(), given.files.end()}, parameters, arguments.reader()));
  return Recipe{std::move(suggested.recipe), {}, std::move(suggested.unused)};
}

Result<void> declare_zero(laser::MapRecipe& recipe, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    ECS_TRY(zero, declared_zero_in(word));
    const auto same = [&](const auto& other) { return other.component == zero.component; };
    if (std::any_of(recipe.components.begin(), recipe.components.end(), same) ||
        std::any_of(recipe.declared_zero.begin(), recipe.declared_zero.end(), same))
      return problem(ProblemKind::usage, fmt::format("--zero {}: it is measured or declared zero already: keep one",
                                                     name_of(zero.component)));
    recipe.declared_zero.push_back(zero);
  }
  return {};
}

Result<void> complete(laser::MapRecipe& recipe, const BuildArguments& arguments) {
  if (!arguments.customer.empty()) recipe.customer = arguments.customer;
  if (!arguments.engineer.empty()) recipe.engineer = arguments.engineer;
  if (!arguments.date.empty()) recipe.date = arguments.date;
  recipe.shrink = recipe.shrink || arguments.shrink;
  return declare_zero(recipe, arguments.zero);
}

std::vector<std::string> files_for(const Recipe& recipe, Component component) {
  std::vector<std::string> names;
  for (const laser::ComponentRecipe& one : recipe.recipe.components)
    if (one.component == component)
      for (const auto& file : one.files) names.push_back(file.string());
  return names;
}

/// All that the answer contains.
struct Built {
  Recipe recipe;
  laser::BuiltMap map;
  params::Identity identity;
  std::vector<laser::MapFinding> findings;
  bool complete = false;
};

Result<Built> built(const BuildArguments& arguments) {
  ECS_TRY(parameters, arguments.params_out.empty() ? params::read_parameters(arguments.params)
                                                   : params::read_whole_parameters(arguments.params));
  ECS_TRY(recipe, recipe_of(arguments, parameters.parameters));
  ECS_DO(complete(recipe.recipe, arguments));
  auto travels = travels_beside(arguments.params, parameters);
  if (!arguments.machine.empty()) {
    ECS_TRY(machine, params::read_machine(arguments.machine));
    travels = travels_of(machine.machine);
  }
  ECS_TRY(made, made_map(recipe.recipe, parameters, travels, arguments.reader()));
  const bool complete = made.complete();
  return Built{std::move(recipe), std::move(made.map), parameters.identity, std::move(made.findings), complete};
}

Cell outcome_cell(const Built& b, const laser::ComponentOutcome& one) {
  const auto files = files_for(b.recipe, one.component);
  return record_cell(
      "{component:<4} {description:<38} {unit:<4} {band:>6} {largest:>6} {slope_removed_per_m:>6} {smoothed_rms:>5} "
      "{points:>4}\n     from {files} ({readings} readings)\n{notes}",
      {{"component", word_cell(name_of(one.component))},
       {"description", word_cell(laser::description_of(one.component))},
       {"unit", word_cell(unit_of(one.component))},
       {"files", {files, fmt::format("{}", fmt::join(files, ", "))}},
       {"readings", count_cell(one.readings)},
       {"band", number_cell(one.band, 1)},
       {"largest", number_cell(one.largest, 1)},
       {"slope_removed_per_m", number_cell(one.slope_um_per_m, 1)},
       {"smoothed_rms", number_cell(one.smoothed_rms, 2)},
       {"points", count_cell(one.points)},
       {"notes", lines_cell(one.notes, "     note: ")}});
}

std::string declared_text(const Built& b) {
  std::string text;
  for (const laser::DeclaredZero& z : b.map.map.header.declared_zero)
    text += fmt::format("{:<4} {}\n     declared zero: {}\n", name_of(z.component), laser::description_of(z.component),
                        z.reason);
  return text;
}

Cell squareness_of(const Built& b, const BuildArguments& arguments) {
  std::vector<std::pair<Component, double>> values;
  for (const laser::ComponentOutcome& one : b.map.outcomes)
    if (is_squareness(one.component))
      values.emplace_back(one.component, squareness_um_per_m(b.map.parameters, one.component));
  return squareness_cell(values, "measured", arguments.params_out);
}

Cell built_cell(const Built& b, const BuildArguments& arguments) {
  return record_cell(
      "{components}{declared}band: range of the readings as measured; most: largest compensation; slope:\n"
      "taken away, per m; smth: rms that smoothing removed; n: points per table\n"
      "{unused}{notes}{squareness}{findings}{verdict}{map}{params_out}",
      {{"map", written_cell("map", arguments.output, "nothing written: give -o map.csv to keep it\n")},
       {"params_out", written_cell("parameters", arguments.params_out)},
       {"recipe", text_cell(b.recipe.file)},
       {"complete", yes_cell(b.complete, "", "")},
       {"components", list_cell(
                          b.map.outcomes, [&](const auto& one) { return outcome_cell(b, one); },
                          fmt::format("{:<4} {:<38} {:<4} {:>6} {:>6} {:>6} {:>5} {:>4}\n", "", "component", "unit",
                                      "band", "most", "slope", "smth", "n"))},
       {"declared", shown_cell(declared_text(b))},
       {"squareness", squareness_of(b, arguments)},
       {"missing", lines_cell(objections_in(b.findings), "")},
       {"findings", findings_cell(b.findings)},
       {"verdict", shown_cell(verdict_text(b.findings, !made_for_two_machines(b.map.map.header, b.identity).empty()))},
       {"unused", lines_cell(b.recipe.unused, "not used: ")},
       {"notes", lines_cell(b.map.notes, "note: ")},
       {"header", header_cell(b.map.map.header)}});
}

Result<void> write(const Built& b, const BuildArguments& arguments) {
  if (!arguments.output.empty())
    if (auto done = write_file(arguments.output, laser::to_map_csv(b.map.map)); !done) return done;
  if (!arguments.params_out.empty())
    return params::write_parameters(arguments.params_out, b.map.parameters, b.identity);
  return {};
}

void warn_about_header(VerbContext& context, const Built& b) {
  for (const std::string& objection : made_for_two_machines(b.map.map.header, b.identity))
    context.console.warn(objection);
  const laser::MapHeader& header = b.map.map.header;
  for (const auto& [name, value] :
       {std::pair{"customer", header.customer}, {"engineer", header.engineer}, {"date", header.date}})
    if (value.empty())
      context.console.note(fmt::format("the header has no {0}: give --{0} or state it in the recipe", name));
}

Problem nothing_built(const Built& b) {
  std::vector<Problem> problems{
      {ProblemKind::refused, "no component could be built; nothing was written", {}, 0, 0, {}}};
  for (const std::string& unused : b.recipe.unused)
    problems.push_back({ProblemKind::refused, "not used: " + unused, {}, 0, 0, {}});
  return folded(std::move(problems));
}

Result<Outcome> from_model(VerbContext& context, const BuildArguments& a) {
  if (!a.files.empty())
    return problem(ProblemKind::usage, "expected a recipe, measurement files or --from-model: one of them");
  if (a.shrink) return problem(ProblemKind::usage, "--shrink needs measured files: a model has no repeats");
  const FromModelArguments arguments{a.from_model, a.machine,      a.increment_mm, a.params,   a.output, a.params_out,
                                     a.zero,       a.zero_missing, a.customer,     a.engineer, a.date,   {}};
  ECS_TRY(map, map_from_model(context.console, arguments));
  return outcome_of(from_model_cell(map, arguments));
}

Result<void> enough_given(const BuildArguments& arguments) {
  if (arguments.files.empty())
    return problem(ProblemKind::usage, "expected FILE: a recipe (.toml) or measurement files; or --from-model MODEL");
  if (arguments.params.empty())
    return problem(ProblemKind::usage, "--params is required: the parameters of the unit that the map is for");
  if (!arguments.zero_missing.empty())
    return problem(ProblemKind::usage, "--zero-missing needs --from-model; without a model give --zero for each");
  if (arguments.increment_mm)
    return problem(ProblemKind::usage,
                   "--increment needs --from-model; a recipe gives increment_mm for each component");
  return {};
}

Result<Outcome> build(VerbContext& context, const BuildArguments& arguments) {
  if (const auto wrong = wrong_date(arguments.date)) return problem(ProblemKind::usage, "--date: " + *wrong);
  if (!arguments.from_model.empty()) return from_model(context, arguments);
  if (measures_rotary_axes(arguments.files, arguments.import)) {
    ECS_DO(check_output_not_input(arguments.output, arguments.files));
    return rotary_errors_built(context, arguments.files, arguments.import, arguments.output);
  }
  ECS_DO(enough_given(arguments));
  for (const std::string& output : {arguments.output, arguments.params_out})
    ECS_DO(check_output_not_input(output, arguments.files));
  ECS_TRY(b, built(arguments));
  if (b.map.outcomes.empty() && b.map.map.header.declared_zero.empty()) return tl::unexpected(nothing_built(b));
  ECS_DO(write(b, arguments));
  warn_about_header(context, b);
  return outcome_of(built_cell(b, arguments));
}

}  // namespace

extern const VerbDefinition kMapBuild =
    verb<BuildArguments>("map build", "the error map from measured files, by a recipe or as the files suggest",
                         "ecs map build recipe.toml --params mill.toml -o map.csv --params-out mill-measured.toml\n"
                         "  ecs map build --from-model fitted.toml --machine machine.toml -o map.csv\n"
                         "  ecs map build EXC.csv ECC.csv -o rotary.csv",
                         build);

}  // namespace ecs::app
