// `ecs export program`: from where the compensation of a part program comes, the program corrected by it, and what
// becomes of the error of the part. Does not live here: the correction itself (corrected_program.hpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/verbs/map/unit.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/maps/machine_map.hpp"
#include "commissioning/measurements/files.hpp"
#include "laser/map/csv.hpp"
#include "modules/controllers/corrected_program.hpp"
#include "modules/controllers/curve.hpp"
#include "modules/controllers/export.hpp"
#include "modules/controllers/format.hpp"
#include "modules/controllers/part_deviations.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

struct ProgramRequest {
  std::string program;
  ExportArguments from;
  std::string deviations;
  double reach_mm = 20.0;
  std::vector<std::string> work_offset;  ///< "x=10,y=20,z=30", "G55:x=10"
  std::string tool_length;               ///< "1=120.5,2=88"
  std::string start, zero_at;            ///< "x=10,y=20,z=30"
  double tolerance_um = 1.0;
  int decimals = 4;

  static Fields<ProgramRequest> fields() {
    using R = ProgramRequest;
    return {
        {"PROGRAM", &R::program, "part program (ISO 6983, DIN 66025)", Need::required},
        {&R::from, ExportArguments::fields("corrected program")},
        {"--deviations", &R::deviations, "measured deviations of a part cut with the program (CSV), in place of a map"},
        {"--reach", &R::reach_mm, "distance in mm from a measured point up to which its deviation counts",
         Range{0.001, 1e6}},
        {"--work-offset", &R::work_offset,
         "zero point of the program in machine coordinates, mm: x=..,y=..,z=.. for G54; G55:x=.. and so on for other "
         "work offsets"},
        {"--tool-length", &R::tool_length, "tool lengths for G43 by H number [mm]: 1=120.5,2=88"},
        {"--start", &R::start, "axis positions before the first block, machine coordinates: x=..,y=..,z=.."},
        {"--zero-at", &R::zero_at,
         "place in program coordinates, x=..,y=..,z=.., at which the work offset was found on this machine: the "
         "correction is zero there"},
        {"--tolerance", &R::tolerance_um, "largest distance of a straight segment from the corrected path, um",
         Range{0.01, 1000.0}},
        {"--decimals", &R::decimals, "minimum number of decimals in a corrected word in mm; one more in inches",
         Range{1, 6}}};
  }
};

// --- options

/// "x=10,y=20": absent where an axis is not named.
Result<PerAxis<std::optional<double>>> place_in(std::string_view text, std::string_view option) {
  PerAxis<std::optional<double>> place_mm{};
  for (const auto& [axis, value] : controllers::axis_pairs(text)) {
    const auto number = axis ? number_in(value) : std::nullopt;
    if (!number || std::abs(*number) > 1e6 || place_mm[index_of(*axis)])
      return problem(ProblemKind::usage, "{}: expected x=..,y=..,z=.. in mm, each axis once, got \"{}\"", option, text);
    place_mm[index_of(*axis)] = *number;
  }
  return place_mm;
}

Vector3 or_zero(const PerAxis<std::optional<double>>& place_mm) {
  return {place_mm[0].value_or(0.0), place_mm[1].value_or(0.0), place_mm[2].value_or(0.0)};
}

Result<std::map<int, Vector3>> work_offsets(const std::vector<std::string>& given) {
  std::map<int, Vector3> offsets;
  for (const std::string& one : given) {
    const std::size_t colon = one.find(':');
    const auto code = colon == std::string::npos         ? std::optional<long long>(54)
                      : (one[0] == 'G' || one[0] == 'g') ? integer_in(one.substr(1, colon - 1))
                                                         : std::nullopt;
    if (!code || *code < 54 || *code > 59)
      return problem(ProblemKind::usage,
                     "--work-offset: expected x=..,y=..,z=.. with G54: to G59: before it, got \"{}\"", one);
    ECS_TRY(place, place_in(one.substr(colon == std::string::npos ? 0 : colon + 1), "--work-offset"));
    if (!offsets.try_emplace(static_cast<int>(*code), or_zero(place)).second)
      return problem(ProblemKind::usage, "--work-offset: G{} is given twice", *code);
  }
  return offsets;
}

Result<std::map<int, double>> tool_lengths(const std::string& given) {
  constexpr double kNoLength = 1e5;  ///< no tool is so long
  std::map<int, double> lengths;
  if (given.empty()) return lengths;
  for (const std::string_view pair : split(given, ',')) {
    const auto words = split(pair, '=');
    const auto number = integer_in(words.front());
    const double length_mm = words.size() == 2 ? number_in(words.back()).value_or(kNoLength) : kNoLength;
    if (!number || *number < 1 || *number > 9999 || std::abs(length_mm) >= kNoLength)
      return problem(ProblemKind::usage, "--tool-length: expected NUMBER=LENGTH pairs such as 1=120.5, got \"{}\"",
                     pair);
    lengths[static_cast<int>(*number)] = length_mm;
  }
  return lengths;
}

/// Half the smallest distance between points of the map, so that no bend of a table is passed over.
double sample_distance_mm(const laser::ErrorMap& map) {
  constexpr double kLeast = 0.05, kMost = 25.0;
  double distance_mm = kMost;
  for (const laser::MapTable& table : map.tables)
    for (std::size_t i = 1; i < table.position_mm.size(); ++i)
      distance_mm = std::min(distance_mm, 0.5 * (table.position_mm[i] - table.position_mm[i - 1]));
  return std::max(distance_mm, kLeast);
}

// --- where the compensation comes from

/// Must stay where it is: what it computes refers to it.
struct ProgramSource {
  std::optional<ExportWork> work;  ///< absent: measured deviations
  controllers::PartDeviations deviations;
  double reach_mm = 0.0;
  std::string name;  ///< "map.csv", "the unit"
  std::string sha256;
  std::vector<std::string> notes, inputs;
  UnitParameters parameters;

  [[nodiscard]] controllers::CompensationAt compensation() const {
    if (!work)
      return [this](const std::vector<controllers::ProgramPlace>& places) {
        std::vector<std::optional<Vector3>> found;
        for (const controllers::ProgramPlace& place : places) {
          found.push_back(deviations.at(place.program_mm, reach_mm));
          if (found.back())
            for (double& value : *found.back()) value = -value;
        }
        return found;
      };
    return [errors = controllers::errors_of_map(work->source)](
               const std::vector<controllers::ProgramPlace>& places) -> Result<std::vector<std::optional<Vector3>>> {
      std::vector<MachinePlace> at;
      for (const controllers::ProgramPlace& place : places) at.push_back(place.machine);
      ECS_TRY(error, errors(at));
      std::vector<std::optional<Vector3>> found;
      for (const Vector3& one : error) found.push_back(Vector3{-one[0], -one[1], -one[2]});
      return found;
    };
  }
};

Result<void> read_deviations(const ProgramRequest& request, ProgramSource& source) {
  if (!request.from.model.empty())
    return problem(ProblemKind::usage, "--model predicts for a map; it is not used with --deviations");
  ECS_TRY(text, read_file(request.deviations));
  ECS_TRY(deviations, controllers::parse_part_deviations(text, request.deviations));
  source.deviations = std::move(deviations);
  source.reach_mm = request.reach_mm;
  source.name = request.deviations;
  source.sha256 = sha256_hex(text);
  source.notes = source.deviations.notes;
  source.inputs = {request.deviations};
  if (request.from.params.empty()) return {};
  ECS_TRY(file, params::read_parameters(request.from.params));
  source.parameters = file.parameters;
  source.inputs.push_back(request.from.params);
  return {};
}

Result<void> read_source(VerbContext& context, const ProgramRequest& request, ProgramSource& source) {
  const ExportArguments& from = request.from;
  if (!request.deviations.empty()) {
    if (!from.map.empty() || from.unit)
      return problem(ProblemKind::usage, "expected a map, --unit or --deviations, got several of them");
    return read_deviations(request, source);
  }
  if (!from.model.empty() && from.machine.empty())
    return problem(ProblemKind::usage,
                   "--model needs --machine: positions in the model count from the datum of each axis, which the "
                   "machine file states");
  ECS_TRY(found, found_map(context, from.map, from.unit));
  source.sha256 = sha256_hex(laser::to_map_csv(found.map));
  if (!from.map.empty()) {
    ECS_TRY(bytes, read_file(from.map));
    source.sha256 = sha256_hex(bytes);
  }
  ECS_TRY(work, export_work(context.console, from, std::move(found)));
  source.name = work.map_name;
  source.notes = work.notes;
  for (std::string& note : left_to_machine(work.source.map.header)) source.notes.push_back(std::move(note));
  source.inputs = work.inputs;
  source.parameters = work.source.parameters;
  source.work = std::move(work);
  return {};
}

Result<controllers::ProgramSettings> settings_of(const ProgramRequest& request, ProgramSource& source) {
  controllers::ProgramSettings settings;
  ECS_TRY(offsets, work_offsets(request.work_offset));
  settings.work_offset_mm = std::move(offsets);
  ECS_TRY(lengths, tool_lengths(request.tool_length));
  settings.tool_length_mm = std::move(lengths);
  ECS_TRY(start, place_in(request.start, "--start"));
  settings.start_mm = start;
  if (!request.zero_at.empty()) {
    ECS_TRY(zero, place_in(request.zero_at, "--zero-at"));
    settings.zero_at_mm = or_zero(zero);
  }
  settings.present = source.parameters.axis_present;
  for (std::size_t a = 0; a < kAxes; ++a) settings.deadband_mm[a] = source.parameters.axes[a].deadband_um * 1e-3;
  settings.tolerance_um = request.tolerance_um;
  settings.decimals = request.decimals;
  settings.sample_mm = source.work ? sample_distance_mm(source.work->source.map) : request.reach_mm / 20.0;
  if (source.work) settings.travel_mm = source.work->source.travel_mm;
  if (source.work && settings.work_offset_mm.empty())
    source.notes.emplace_back(
        "without --work-offset: program coordinates are used as machine coordinates; G54 to G59 are refused");
  return settings;
}

// --- the error of the part

/// Sums over places of the error as programmed and as corrected.
class PredictedPart {
 public:
  /// @param error_um  of the machine there
  void add(const controllers::ProgramSample& sample, const Vector3& error_um) {
    add(before_, error_um);
    add(after_, {sample.off_um[0] + error_um[0], sample.off_um[1] + error_um[1], sample.off_um[2] + error_um[2]});
    ++places_;
  }
  [[nodiscard]] Cell cell() const {
    if (places_ == 0) return {nullptr, "no feed move was corrected: no error is predicted\n"};
    Cell rows{Json::object(), fmt::format("{:<8} {:>18} {:>18}\n", "", "as programmed", "corrected")};
    for (std::size_t d = 0; d <= kAxes; ++d) {
      const std::string direction = d == kAxes ? "length" : std::string(1, letter_of(kAllAxes[d]));
      const Cell before = size(before_, d), after = size(after_, d);
      rows.json[direction] = object_of("as_programmed"_is(before), "corrected"_is(after));
      rows.text += fmt::format("{:<8} {:>18} {:>18}\n", d == kAxes ? "vector" : direction, before.text, after.text);
    }
    return {object_of("places"_is(places_), "by_direction"_is(rows)), rows.text};
  }

 private:
  struct Sums {
    std::array<double, kAxes + 1> largest_um{}, squares{};
  };
  static void add(Sums& sums, const Vector3& error_um) {
    for (std::size_t d = 0; d <= kAxes; ++d) {
      const double size = d == kAxes ? std::hypot(error_um[0], error_um[1], error_um[2]) : std::abs(error_um[d]);
      sums.largest_um[d] = std::max(sums.largest_um[d], size);
      sums.squares[d] += size * size;
    }
  }
  [[nodiscard]] Cell size(const Sums& sums, std::size_t d) const {
    return record_cell("{largest_um} /{rms_um:>8.2f}", "largest_um"_is(sums.largest_um[d], 2),
                       "rms_um"_is(std::sqrt(sums.squares[d] / static_cast<double>(places_)), 2));
  }
  Sums before_, after_;
  std::size_t places_ = 0;
};

/// With the errors of a model, relative to the place at which the correction is zero.
Result<PredictedPart> predicted_by_model(const ErrorsAt& errors, const controllers::ProgramSettings& settings,
                                         const std::vector<controllers::ProgramSample>& samples) {
  std::vector<MachinePlace> places;
  for (const controllers::ProgramSample& sample : samples) places.push_back(sample.place.machine);
  MachinePlace zero{settings.zero_at_mm.value_or(Vector3{}), {Approach::unknown, Approach::unknown, Approach::unknown}};
  if (const auto at = settings.work_offset_mm.find(54); at != settings.work_offset_mm.end())
    for (std::size_t a = 0; a < kAxes; ++a) zero.position_mm[a] += at->second[a];
  places.push_back(zero);
  ECS_TRY(found, errors(places));
  const Vector3 from_um = settings.zero_at_mm ? found.back() : Vector3{};
  PredictedPart part;
  for (std::size_t i = 0; i < samples.size(); ++i)
    part.add(samples[i], {found[i][0] - from_um[0], found[i][1] - from_um[1], found[i][2] - from_um[2]});
  return part;
}

// --- the answer

struct ProgramAnswer {
  const ProgramRequest& request;
  const ProgramSource& source;
  controllers::CorrectedProgram made;
  PredictedPart part;
  std::vector<WrittenFile> written;
};

Cell by_axis_cell(const Vector3& values_um, int decimals) {
  Json json = Json::object();
  std::string text;
  for (const Axis axis : kAllAxes) {
    const Cell value = number_cell(values_um[index_of(axis)], decimals);
    json[std::string(1, letter_of(axis))] = value.json;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", letter_of(axis), value.text);
  }
  return {json, text + " um"};
}

/// "3, 7, 9 and 12 more"
std::string lines_in_short(const std::vector<int>& lines) {
  constexpr std::size_t kShown = 12;
  if (lines.size() <= kShown) return fmt::format("{}", fmt::join(lines, ", "));
  return fmt::format("{} and {} more", fmt::join(lines.begin(), lines.begin() + kShown, ", "), lines.size() - kShown);
}

Cell uncorrected_cell(const std::vector<controllers::UncorrectedLines>& all) {
  Cell cell = list_cell(
      all,
      [](const controllers::UncorrectedLines& one) {
        return record_cell({}, "why"_is(one.why), "lines"_is(Json(one.lines)));
      },
      all.empty() ? "" : "NOT CORRECTED\n");
  for (const controllers::UncorrectedLines& one : all)
    cell.text += paragraph(
        fmt::format("{}: {} {}", one.why, one.lines.size() == 1 ? "line" : "lines", lines_in_short(one.lines)), 2, 4);
  return cell;
}

Cell program_cell(const ProgramAnswer& answer) {
  const controllers::CorrectedProgram& made = answer.made;
  Cell written = written_files_cell(answer.written);
  if (answer.written.empty()) written.text = "not saved: give -o FILE to save it\n";
  const std::string from =
      answer.source.work ? answer.source.work->errors_from : std::string("the measured deviations");
  std::vector<std::string> notes = made.notes;
  notes.insert(notes.end(), answer.source.notes.begin(), answer.source.notes.end());
  notes.emplace_back(
      "before this program is run, switch off the compensation by the unit and by tables in the control that correct "
      "the same errors: both together would correct them twice");
  return record_cell(
      "{program} {done} by {map}\n\nmoves       {moves}, of these changed {corrected}; blocks added "
      "{blocks_added}\narcs        {arcs_kept} kept as arcs, {arcs_divided} divided into lines\ncorrection  at most "
      "{largest_correction_um}\nrounding    of the words in the program: at most {rounding_um}\n\nerror along feed "
      "moves, predicted from {from}: "
      "largest / rms, um\n{predicted}\n{not_corrected}{notes}{written}",
      "program"_is(answer.request.program), "map"_is(answer.source.name), "sha256"_is(answer.source.sha256),
      "done"_shown(made.corrected > 0 ? "corrected" : "not changed"), "moves"_is(made.moves),
      "corrected"_is(made.corrected), "blocks_added"_is(made.blocks_added), "arcs_kept"_is(made.arcs_kept),
      "arcs_divided"_is(made.arcs_divided), "largest_correction_um"_is(by_axis_cell(made.largest_um, 2)),
      "rounding_um"_is(by_axis_cell(made.rounding_um, 3)), "from"_is(from), "predicted"_is(answer.part.cell()),
      "not_corrected"_is(uncorrected_cell(made.uncorrected)), "notes"_is(paragraphs_cell(notes, "note: ")),
      "written"_is(written), "replaced"_is(replaced_files_cell(answer.written)));
}

/// The comment for the first line: the name of the map as a comment of a control may have it.
std::string comment_for(const ProgramSource& source) {
  std::string name = std::filesystem::path(source.name).filename().string();
  for (char& c : name)
    if (c < ' ' || c > '~' || c == '(' || c == ')' || c == ';') c = '_';
  return fmt::format("{} for {}, sha256 {}", controllers::kCorrectedBy, name, source.sha256.substr(0, 16));
}

Result<Outcome> export_program(VerbContext& context, const ProgramRequest& request) {
  const std::string& output = request.from.output;
  ECS_TRY(text, read_file(request.program));
  ECS_TRY(program, controllers::parse_part_program(text, request.program));
  ProgramSource source;
  ECS_DO(read_source(context, request, source));
  source.inputs.push_back(request.program);
  ECS_DO(check_output_not_input(output, source.inputs));
  if (!output.empty()) ECS_DO(spared({output}, request.from.force));
  ECS_TRY(settings, settings_of(request, source));
  PredictedPart part;
  std::vector<controllers::ProgramSample> samples;
  const bool by_model = !request.from.model.empty();
  const auto seen = [&](const controllers::ProgramSample& sample) {
    const Vector3& c = sample.compensation_um;
    if (by_model)
      samples.push_back(sample);
    else
      part.add(sample, {-c[0], -c[1], -c[2]});
  };
  ECS_TRY(made, controllers::corrected_program(program, settings, source.compensation(), comment_for(source), seen));
  if (by_model) {
    ECS_TRY(errors, errors_for(context.console, request.from, *source.work));
    ECS_TRY(predicted, predicted_by_model(errors, settings, samples));
    part = predicted;
  }
  std::vector<WrittenFile> written;
  if (!output.empty()) {
    ECS_TRY(files, write_together({{output, made.text}}));
    written = std::move(files);
  }
  return outcome_of(program_cell({request, source, std::move(made), part, std::move(written)}));
}

}  // namespace

extern const std::vector<Action> kProgramExport{action(
    "export program", "a part program corrected in advance, for a machine without a compensation unit",
    "ecs export program part.nc map.csv --params mill.toml --work-offset x=-300,y=-200,z=-150 -o part_ecs.nc\n  ecs "
    "export program part.nc --deviations measured.csv -o part_ecs.nc",
    export_program, {.link = Link::reads, .logged = Logged::when_written, .kind = "export", .logged_as = "export"})};

}  // namespace ecs::app
