// Which files, and what they say: read and checked against each other.
#include "modules/report/content.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/session/records.hpp"
#include "commissioning/unit/transfer.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::app {
namespace {

namespace fs = std::filesystem;

struct UsualName {
  fs::path ReportFiles::*into;
  const char* name;
  bool folder;
};
constexpr UsualName kUsualNames[] = {
    {&ReportFiles::plan, "plan.toml", false},     {&ReportFiles::before, "before", true},
    {&ReportFiles::after, "after", true},         {&ReportFiles::machine, "machine.toml", false},
    {&ReportFiles::map, "map.csv", false},        {&ReportFiles::params, "parameters.toml", false},
    {&ReportFiles::model, "model.toml", false},   {&ReportFiles::diagnosis, "diagnosis.json", false},
    {&ReportFiles::status, "status.json", false},
};

void take_folder(ReportFiles& files, const fs::path& folder) {
  for (const UsualName& usual : kUsualNames) {
    const fs::path path = folder / usual.name;
    // Found, not named: a FIFO that nobody writes into would be waited for.
    if (usual.folder ? disc::is_folder(path) : disc::is_file(path)) files.*(usual.into) = path;
  }
  for (const std::string& name : measurement_names_in(folder / "circles"))
    files.circles.push_back(folder / "circles" / (name + ".csv"));
}

void take_option(fs::path& into, const std::string& given) {
  if (!given.empty()) into = given;
}

}  // namespace

Result<ReportFiles> report_files(const ReportArguments& arguments) {
  ReportFiles files;
  std::vector<Problem> problems;
  for (const std::string& place : arguments.places) {
    if (disc::is_folder(place)) {
      take_folder(files, place);
    } else if (disc::exists(place)) {
      files.plan = place;
    } else {
      problems.push_back({ProblemKind::bad_input, "expected a plan or a folder, found nothing", place, 0, 0, {}});
    }
  }
  for (const auto& [into, given] : {std::pair{&files.before, &arguments.before}, {&files.after, &arguments.after}}) {
    take_option(*into, *given);
    if (!given->empty() && !disc::is_folder(*given))
      problems.push_back({ProblemKind::bad_input, "expected a folder of measurements", *given, 0, 0, {}});
  }
  take_option(files.machine, arguments.machine);
  take_option(files.map, arguments.map);
  take_option(files.params, arguments.params);
  take_option(files.model, arguments.model);
  take_option(files.diagnosis, arguments.diagnosis);
  take_option(files.status, arguments.status);
  if (!arguments.circle.empty()) files.circles.assign(arguments.circle.begin(), arguments.circle.end());
  if (problems.empty() && files.before.empty() && files.after.empty())
    problems.push_back({ProblemKind::bad_input,
                        "expected measurements: a folder that contains before/ or after/, or --before and --after",
                        arguments.places.empty() ? "" : arguments.places.front(),
                        0,
                        0,
                        {}});
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return files;
}

std::vector<std::string> measurement_names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == ".csv" && disc::is_file(entry->path()))
      names.push_back(entry->path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

namespace {

// --- rows

/// What a file without a plan is taken for: its one line; nothing where it holds several.
Result<PlannedMeasurement> unplanned(const std::string& name, const fs::path& file) {
  ECS_TRY(set, laser::read_measurement_set(file));
  const auto groups = laser::groups_of(set);
  if (groups.size() != 1)
    return problem_at(file.string(), 0, 0,
                      "expected one measurement line, found {}: give a plan that selects the line to report",
                      groups.size());
  PlannedMeasurement out;
  out.name = name;
  out.axis = groups.front().axis;
  out.sense = groups.front().sense;
  const auto named = component_of(name);
  const bool square = named && is_squareness(*named);
  out.title = laser::description_of(square ? *named : curve_of(out.sense, out.axis));
  out.slope = square ? laser::SlopeMethod::none : laser::default_slope(curve_of(out.sense, out.axis));
  return out;
}

std::vector<PlannedMeasurement> found_in(const ReportFiles& files, std::vector<Problem>& problems) {
  std::vector<std::string> names = measurement_names_in(files.before);
  for (std::string& name : measurement_names_in(files.after)) names.push_back(std::move(name));
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::vector<PlannedMeasurement> plan;
  for (const std::string& name : names) {
    std::error_code error;
    const fs::path before = files.before / (name + ".csv");
    const bool has_before = !files.before.empty() && fs::is_regular_file(before, error);
    const bool has_after = !files.after.empty() && fs::is_regular_file(files.after / (name + ".csv"), error);
    auto planned = unplanned(name, has_before ? before : files.after / (name + ".csv"));
    if (!planned) {
      problems.push_back(planned.error());
      continue;
    }
    if (!has_after) planned->phase = PlanPhase::before;
    if (!has_before) planned->phase = PlanPhase::after;
    plan.push_back(std::move(*planned));
  }
  return plan;
}

/// A folder that was not given is no file missing from every row.
void restrict_phases(std::vector<PlannedMeasurement>& plan, const ReportFiles& files) {
  for (PlannedMeasurement& one : plan) {
    if (one.phase == PlanPhase::both && files.after.empty()) one.phase = PlanPhase::before;
    if (one.phase == PlanPhase::both && files.before.empty()) one.phase = PlanPhase::after;
  }
  std::erase_if(plan, [&](const PlannedMeasurement& one) {
    return (one.phase == PlanPhase::before && files.before.empty()) ||
           (one.phase == PlanPhase::after && files.after.empty());
  });
}

Result<void> add_rows(const ReportFiles& files, ReportContent& content) {
  std::vector<PlannedMeasurement> plan;
  if (files.plan.empty()) {
    plan = found_in(files, content.problems);
  } else {
    ECS_TRY(read, read_plan(files.plan));
    plan = std::move(read);
  }
  restrict_phases(plan, files);
  content.rows = table_of(plan, files.before, files.after);
  const bool any = std::any_of(content.rows.begin(), content.rows.end(),
                               [](const TableRow& row) { return row.before || row.after; });
  if (any) return {};
  std::vector<Problem> problems = content.problems;
  for (const TableRow& row : content.rows) problems.insert(problems.end(), row.problems.begin(), row.problems.end());
  const fs::path& folder = files.before.empty() ? files.after : files.before;
  if (problems.empty())
    problems.push_back(
        {ProblemKind::bad_input, "expected measurements NAME.csv, found none", folder.string(), 0, 0, {}});
  return tl::unexpected(folded(std::move(problems)));
}

// --- files and identities

Result<void> note_file(ReportContent& content, std::string role, const fs::path& path) {
  if (path.empty()) return {};
  ECS_TRY(bytes, read_file(path));
  content.files.push_back({std::move(role), path.filename().string(), sha256_hex(bytes)});
  return {};
}

Result<void> note_files(const ReportFiles& files, ReportContent& content) {
  std::vector<std::pair<std::string, fs::path>> all{{"plan", files.plan}, {"machine", files.machine}};
  for (const TableRow& row : content.rows) {
    if (row.before) all.emplace_back("before", row.before->file);
    if (row.after) all.emplace_back("after", row.after->file);
  }
  for (const auto& [role, path] : {std::pair{"map", files.map},
                                   {"parameters", files.params},
                                   {"model", files.model},
                                   {"diagnosis", files.diagnosis},
                                   {"unit status", files.status}})
    all.emplace_back(role, path);
  for (const fs::path& file : files.circles) all.emplace_back("circle", file);
  for (auto& [role, path] : all) ECS_DO(note_file(content, role, path));
  return {};
}

/// Who a file says that it belongs to.
struct Owner {
  std::string file;
  std::string machine;
  std::string serial_number;
};

Owner owner_of(const MeasuredPhase& phase) {
  const laser::MeasurementSet& set = phase.readings.before;
  return {phase.file.string(), laser::metadata_value(set, "machine").value_or(""),
          laser::metadata_value(set, "serial_number").value_or("")};
}

std::vector<Owner> owners_in(const ReportFiles& files, const ReportContent& content) {
  std::vector<Owner> owners;
  if (content.map)
    owners.push_back({files.map.string(), content.map->map.header.machine, content.map->map.header.serial_number});
  if (content.parameters)
    owners.push_back({files.params.string(), content.parameters->file.identity.machine,
                      content.parameters->file.identity.serial_number});
  if (content.status) owners.push_back({files.status.string(), "", content.status->identity.serial_number});
  for (const TableRow& row : content.rows)
    for (const auto* phase : {&row.before, &row.after})
      if (*phase) owners.push_back(owner_of(**phase));
  for (const CircleWork& circle : content.circles)
    owners.push_back({circle.file.string(), laser::metadata_value(circle.test.metadata, "machine").value_or(""),
                      laser::metadata_value(circle.test.metadata, "serial_number").value_or("")});
  return owners;
}

/// Each file against the first that states the same thing.
Result<void> of_one_machine(const std::vector<Owner>& owners) {
  std::vector<Problem> problems;
  for (const auto& [member, what] : {std::pair{&Owner::machine, "machine"}, {&Owner::serial_number, "serial number"}}) {
    const Owner* first = nullptr;
    for (const Owner& owner : owners) {
      if ((owner.*member).empty()) continue;
      if (first == nullptr) first = &owner;
      if (owner.*member != first->*member)
        problems.push_back({ProblemKind::refused,
                            fmt::format("{} \"{}\", but {} says \"{}\": a report needs files of one machine", what,
                                        owner.*member, first->file, first->*member),
                            owner.file,
                            0,
                            0,
                            {}});
    }
  }
  if (problems.empty()) return {};
  return tl::unexpected(folded(std::move(problems)));
}

// --- map, parameters, status

Result<void> read_others(VerbContext& context, const ReportFiles& files, ReportContent& content) {
  std::vector<Problem> problems;
  const auto keep = [&problems](const auto& read) {
    if (!read) problems.push_back(read.error());
    return read.has_value();
  };
  if (!files.machine.empty())
    if (auto machine = params::read_machine(files.machine); keep(machine)) {
      for (const Problem& warning : machine->warnings) context.console.warn(to_text(warning));
      content.machine = std::move(machine->machine);
    }
  if (!files.params.empty())
    if (auto file = params::read_parameters(files.params); keep(file)) {
      auto findings = params::check(file->parameters, content.machine ? &*content.machine : nullptr);
      content.parameters = ReportedParameters{std::move(*file), std::move(findings)};
    }
  if (!files.map.empty())
    if (auto map = laser::read_map_csv(files.map); keep(map)) {
      const auto bytes = read_file(files.map);
      content.map = ReportedMap{std::move(*map), bytes ? sha256_hex(*bytes) : "", {}, {}, {}};
    }
  if (!files.status.empty())
    if (auto status = read_snapshot(files.status); keep(status)) content.status = std::move(*status);
  for (const fs::path& file : files.circles)
    if (auto circle = circle_work(file, content.machine ? &*content.machine : nullptr); keep(circle))
      content.circles.push_back(std::move(*circle));
  if (problems.empty()) return {};
  return tl::unexpected(folded(std::move(problems)));
}

void judge_map(ReportContent& content) {
  if (!content.map || !content.parameters) {
    content.no_prediction = !content.map ? "no error map was given" : "no parameters were given";
    return;
  }
  const UnitParameters& parameters = content.parameters->file.parameters;
  content.map->objections = objections_to_map(content.map->map, parameters);
  const laser::Travels travels = content.machine ? travels_of(*content.machine) : laser::Travels{};
  content.map->remarks = remarks_in(laser::findings_for(content.map->map, parameters, travels));
  auto predicted =
      predicted_rows(content.rows, content.map->map, parameters, content.status ? &content.status->identity : nullptr);
  if (!predicted) {
    content.no_prediction = fmt::format("the map cannot be sent with these parameters ({})", predicted.error().message);
    return;
  }
  content.map->check = predicted->check;
  content.predicted = std::move(predicted->rows);
}

Result<ReportedVolume> reported_volume(PreparedVolume prepared) {
  constexpr std::size_t places = kUsualPlaces;  // as `ecs volume`, so that both state the same figures
  ECS_TRY(answer, evaluated(prepared.machine, places));
  const volume::UncertaintySettings settings;
  ECS_TRY(uncertainty, uncertainty_of(prepared.machine, budget_of(prepared.machine, settings), settings, places));
  return ReportedVolume{std::move(prepared), std::move(answer), uncertainty, {}, 0};
}

void predict_volume(ReportContent& content) {
  content.no_volume = content.no_prediction;
  if (content.predicted.empty() || !content.map || !content.parameters) return;
  auto volume = reported_volume(prepared_volume(content.map->map, content.parameters->file.parameters, content.machine,
                                                content.model ? &content.model->fitted : nullptr));
  if (volume) {
    std::set<Component> components;
    for (const laser::DeclaredZero& zero : content.map->map.header.declared_zero)
      volume->declared_zero.push_back(zero.component);
    components.insert(volume->declared_zero.begin(), volume->declared_zero.end());
    for (const laser::MapTable& table : content.map->map.tables) components.insert(table.component);
    for (const Component square : {Component::C0Y, Component::B0Z, Component::A0Z})
      if (squareness_um_per_m(content.parameters->file.parameters, square) != 0.0) components.insert(square);
    volume->components = components.size();
    content.volume = std::move(*volume);
  } else {
    content.no_volume = fmt::format("it cannot be predicted ({})", volume.error().message);
  }
}

// --- header

void put(ReportContent& content, std::string_view key, const std::string& value) {
  if (!value.empty() && header_value(content, key).empty()) content.header.emplace_back(key, value);
}

Result<void> take_given(const ReportArguments& arguments, ReportContent& content) {
  for (const std::string& entry : arguments.header) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos || trimmed(entry.substr(0, equals)).empty())
      return problem(ProblemKind::usage, "--header: expected key=value, got \"{}\"", entry);
    put(content, trimmed(entry.substr(0, equals)), std::string(trimmed(entry.substr(equals + 1))));
  }
  return {};
}

std::string latest(const ReportContent& content, std::string_view key) {
  std::string last;
  for (const TableRow& row : content.rows)
    for (const auto* phase : {&row.before, &row.after})
      if (*phase) last = std::max(last, laser::metadata_value((*phase)->readings.before, key).value_or(""));
  return last;
}

/// Of one file: `date`, else the day of `begun`.
template <class Source>
std::string date_of(const Source& source) {
  if (const auto date = laser::metadata_value(source, "date")) return *date;
  return laser::metadata_value(source, "begun").value_or("");
}

/// Of all that went in; what is no date of ISO 8601 only where nothing else is stated.
std::string last_date(const ReportContent& content) {
  std::vector<std::string> dates;
  for (const TableRow& row : content.rows)
    for (const auto* phase : {&row.before, &row.after})
      if (*phase) dates.push_back(date_of((*phase)->readings.before));
  if (content.map) dates.push_back(content.map->map.header.date);
  for (const CircleWork& circle : content.circles) dates.push_back(date_of(circle.test.metadata));
  if (content.status) dates.push_back(content.status->taken);
  std::string last;
  for (const std::string& date : dates)
    if (is_iso_date(date)) last = std::max(last, date.substr(0, std::string_view("2026-03-12").size()));
  return last.empty() && !dates.empty() ? *std::max_element(dates.begin(), dates.end()) : last;
}

void complete_header(const ReportArguments& arguments, ReportContent& content) {
  if (content.map) {
    const laser::MapHeader& header = content.map->map.header;
    put(content, "customer", header.customer);
    put(content, "engineer", header.engineer);
    put(content, "machine", header.machine);
    put(content, "serial_number", header.serial_number);
  }
  if (content.parameters) {
    put(content, "machine", content.parameters->file.identity.machine);
    put(content, "serial_number", content.parameters->file.identity.serial_number);
  }
  put(content, "machine", latest(content, "machine"));
  put(content, "serial_number", latest(content, "serial_number"));
  if (content.machine) put(content, "machine", content.machine->name);
  content.date = arguments.date;
  if (content.date.empty()) content.date = header_value(content, "date");
  if (content.date.empty()) content.date = last_date(content);
}

}  // namespace

const params::PositionUnit& position_unit_of(const ReportContent& content) {
  return params::position_unit(content.parameters ? content.parameters->file.parameters.measurement_system
                                                  : MeasurementSystem::metric);
}

std::string header_value(const ReportContent& content, std::string_view key) {
  for (const auto& [name, value] : content.header)
    if (name == key) return value;
  return {};
}

Result<ReportContent> report_content(VerbContext& context, const ReportArguments& arguments) {
  ReportContent content;
  ECS_DO(take_given(arguments, content));
  ECS_TRY(files, report_files(arguments));
  content.has_before = !files.before.empty();
  content.has_after = !files.after.empty();
  content.planned = !files.plan.empty();
  context.console.progress("reading the measurements", 0.1, 1.0);
  ECS_DO(read_others(context, files, content));
  ECS_DO(add_rows(files, content));
  ECS_DO(of_one_machine(owners_in(files, content)));
  ECS_DO(note_files(files, content));
  if (const auto end = records_end())
    content.files.push_back({"logbook",
                             fmt::format("{}: hash of entry {}, the last when this was written",
                                         end->path.filename().string(), end->entries),
                             end->last_hash});
  complete_header(arguments, content);
  if (content.date.empty()) context.console.warn("no file states a date, so the report has none: give --date");
  judge_map(content);
  ECS_DO(add_model(context, arguments, files, content));
  predict_volume(content);
  context.console.end_progress();
  return content;
}

}  // namespace ecs::app
