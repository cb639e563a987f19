#include "commissioning/lengths/work.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "commissioning/maps/declared_zero.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::commissioning {
namespace {

/// Signs of the printed equations of the thesis: rotations about X and Z, and squareness but B0Z, are turned
/// (docs/physics.md).
double sign_of(Component c, Convention convention) {
  if (convention == Convention::iso) return 1.0;
  const bool turned = is_squareness(c) ? c != Component::B0Z : sense_of(c) == Sense::EA || sense_of(c) == Sense::EC;
  return turned ? -1.0 : 1.0;
}

Result<void> measured_there(const model::LengthTest& test, const params::Machine& machine, const std::string& file) {
  const auto other = laser::other_machine({test.machine, ""}, {machine.name, ""}, "the machine file is of");
  if (!other) return {};
  return tl::unexpected(Problem{ProblemKind::refused, *other, file, 0, 0, {}});
}

Result<void> same_machine(const params::ParametersFile& unit, const params::Machine& machine, const std::string& file) {
  const UnitParameters& parameters = unit.parameters;
  const auto refuse = [&](std::string message) {
    return tl::unexpected(Problem{ProblemKind::bad_input, std::move(message), file, 0, 0, {}});
  };
  if (!unit.identity.machine.empty() && !machine.name.empty() && unit.identity.machine != machine.name)
    return refuse(fmt::format("expected the parameters of the machine \"{}\", found those of \"{}\"", machine.name,
                              unit.identity.machine));
  if (configuration_of(parameters) != machine.configuration)
    return refuse(fmt::format("expected the parameters of a machine {}, found {}", machine.configuration,
                              configuration_of(parameters)));
  const MeasurementLines lines = params::measurement_lines_of(machine);
  for (const Axis axis : kAllAxes)
    for (const Axis other : kAllAxes) {
      const double expected = lines[index_of(axis)][index_of(other)];
      const double found = parameters.measurement_lines_mm[index_of(axis)][index_of(other)];
      if (axis != other && expected != found)
        return refuse(fmt::format("axis.{}.measurement_line_mm: expected {} {:g} as in the machine file, found {:g}",
                                  letter_of(axis), letter_of(other), expected, found));
    }
  return {};
}

/// A header counts whole ones.
int freedom_in_map(double freedom) { return std::max(1, static_cast<int>(freedom)); }

laser::ErrorMap map_of(const LengthsWork& work, const LengthsArguments& arguments, const std::string& sha256,
                       const params::Machine& machine) {
  laser::ErrorMap map;
  laser::MapHeader& header = map.header;
  header.customer = arguments.customer;
  header.engineer = arguments.engineer;
  header.date = arguments.date;
  header.machine = work.unit->identity.machine.empty() ? machine.name : work.unit->identity.machine;
  header.serial_number = work.unit->identity.serial_number;
  header.configuration = machine.configuration;
  header.declared_zero = work.zero;
  const std::string file = std::filesystem::path(arguments.file).filename().string();
  const Convention convention = work.unit->parameters.convention;
  for (const model::IdentifiedCurve& curve : work.found.curves) {
    if (!curve.determined) continue;
    const double compensation = -sign_of(curve.component, convention);
    for (const bool forward : {true, false}) {
      laser::MapTable table{curve.component, forward ? Approach::forward : Approach::reverse, curve.position_mm, {}};
      for (const double value : forward ? curve.forward : curve.reverse)
        table.compensation.push_back(compensation * value);
      map.tables.push_back(std::move(table));
    }
    header.sources.push_back({std::string(name_of(curve.component)), file, sha256});
    header.uncertainty.push_back({curve.component, curve.value, curve.pass, freedom_in_map(curve.degrees_of_freedom)});
  }
  for (const model::IdentifiedSquareness& square : work.found.squareness) {
    if (!square.determined) continue;
    header.sources.push_back({std::string(name_of(square.component)), file, sha256});
    header.uncertainty.push_back({square.component, square.u_um_per_m, 0.0, freedom_in_map(square.degrees_of_freedom)});
  }
  header.processing.push_back(
      fmt::format("identified from {} lengths of {} set-ups: {} unknowns, knots {:.0f}, {:.0f}, {:.0f} mm, reversal of "
                  "degree {}, {} readings left out, residual {:.3f} um",
                  work.found.readings, work.test.set_ups.size(), work.found.unknowns, work.found.knots_mm[0],
                  work.found.knots_mm[1], work.found.knots_mm[2], arguments.reversal_degree, work.found.outliers.size(),
                  work.found.residual_um));
  header.processing.insert(header.processing.end(), work.found.contradictions.begin(), work.found.contradictions.end());
  return map;
}

}  // namespace

cli::Fields<LengthsArguments> LengthsArguments::fields() {
  using A = LengthsArguments;
  using cli::Is, cli::Need, cli::Range;
  return {{"LENGTHS", &A::file, "measured lengths (.csv, docs/identification.md)", Need::required},
          {"--machine", &A::machine, "machine file: chain, travels, datum", Need::required},
          {"--params", &A::params, "parameters of the unit that the map is for"},
          {"-o,--output", &A::output, "map CSV to write; needs --params", Is::output},
          {"--params-out", &A::params_out, "parameters to write, with the squareness that was found", Is::output},
          {"--knots", &A::knots,
           "spacing of the curves' knots X,Y,Z [mm]; by default as the file says, else twice the "
           "spacing of its coordinates"},
          {"--reversal-degree", &A::reversal_degree,
           "of the reversal error as a polynomial; -1: the approach does not matter", Range{-1, 6}},
          {"--scale", &A::scale_um_per_m, "of each set-up (air, wavelength), standard uncertainty [um/m]; 0: none",
           Range{0.0}},
          {"--zero", &A::zero, "declare a component zero: EBY=\"too small to measure\""},
          {"--keep-outliers", &A::keep_outliers, "leave no reading out"},
          {"--customer", &A::customer, "for the header"},
          {"--engineer", &A::engineer, "for the header"},
          {"--date", &A::date, "for the header, as in 2026-03-12"}};
}

Result<PerAxis<std::optional<double>>> three_lengths_in(const std::string& text, std::string_view option) {
  PerAxis<std::optional<double>> out{};
  if (text.empty()) return out;
  const auto words = split(text, ',');
  for (std::size_t a = 0; a < kAxes && words.size() == kAxes; ++a) {
    out[a] = number_in(trimmed(words[a]));
    if (!out[a] || !(*out[a] > 0.0)) break;
    if (a + 1 == kAxes) return out;
  }
  return problem(
      ProblemKind::usage,
      fmt::format("{}: expected three lengths X,Y,Z above 0 in mm, such as 100,50,50, got \"{}\"", option, text));
}

Result<LengthsWork> lengths_work(const LengthsArguments& arguments) {
  ECS_TRY(knots, three_lengths_in(arguments.knots, "--knots"));
  model::IdentifySettings settings;
  settings.knots_mm = knots;
  settings.reversal_degree = arguments.reversal_degree;
  settings.scale_um_per_m = arguments.scale_um_per_m;
  settings.keep_outliers = arguments.keep_outliers;
  LengthsWork work;
  for (const std::string& word : arguments.zero) {
    ECS_TRY(zero, declared_zero_in(word));
    settings.zero[index_of(zero.component)] = true;
    work.zero.push_back(zero);
  }
  ECS_TRY(text, read_file_of(FileKind::lengths, arguments.file));
  ECS_TRY(test, model::parse_lengths(text, arguments.file));
  ECS_TRY(machine, params::read_machine(arguments.machine));
  ECS_DO(measured_there(test, machine.machine, arguments.file));
  work.machine_name = machine.machine.name;
  if (!arguments.params.empty()) {
    ECS_TRY(unit, params::read_whole_parameters(arguments.params));
    ECS_DO(same_machine(unit, machine.machine, arguments.params));
    work.unit = std::move(unit);
  }
  ECS_TRY(found, model::identify(test, machine.machine, settings));
  work.test = std::move(test);
  work.found = std::move(found);
  if (!work.unit || !work.found.whole()) return work;
  for (const model::IdentifiedSquareness& square : work.found.squareness)
    if (square.determined)
      squareness_um_per_m(work.unit->parameters, square.component) =
          sign_of(square.component, work.unit->parameters.convention) * square.um_per_m;
  work.map = map_of(work, arguments, sha256_hex(text), machine.machine);
  return work;
}

}  // namespace ecs::commissioning
