#include "commissioning/measurements/capture_targets.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "commissioning/measurements/files.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {
namespace {

constexpr int kUsualRuns = 3;

tl::unexpected<Problem> wrong_usage(std::string message) { return problem(ProblemKind::usage, std::move(message)); }

/// One row of a plan, as far as it says how to measure; the workshop and the table read the same file.
class PlanRow {
 public:
  explicit PlanRow(const std::string& file) : reader_(file) {}

  Result<devices::CapturePlan> read(std::string_view text, const std::string& name, devices::CaptureLine& line) {
    ECS_TRY(table, reader_.parsed(text));
    const auto rows = reader_.children(table, "measure");
    std::string names;
    for (const toml::table* row : rows) {
      const std::string its_name = reader_.word(*row, "name").value_or("");
      names += (names.empty() ? "" : ", ") + its_name;
      if (its_name != name) continue;
      take(table, *row, line);
      if (!reader_.clean()) return tl::unexpected(reader_.all());
      devices::CapturePlan plan;
      plan.metadata = {{"measurement", its_name}};
      if (const auto title = reader_.word(*row, "title")) plan.metadata.push_back({"title", *title});
      if (const auto of = reader_.word(table, "name")) plan.metadata.push_back({"plan", *of});
      return plan;
    }
    return wrong_usage(
        fmt::format("--row: {} holds no measurement \"{}\"; there are: {}", reader_.file(), name, names));
  }

 private:
  void take(const toml::table& all, const toml::table& row, devices::CaptureLine& line) {
    const std::string axis = reader_.word(row, "axis").value_or("");
    const std::string sense = reader_.word(row, "sense").value_or("");
    const auto moved = axis.size() == 1 ? axis_of(axis[0]) : std::nullopt;
    const auto read = sense_named(sense);
    if (!moved) reader_.complain(row, fmt::format("axis: expected X, Y or Z, found \"{}\"", axis));
    if (!read) reader_.complain(row, fmt::format("sense: expected EX EY EZ EA EB or EC, found \"{}\"", sense));
    line.axis = moved.value_or(Axis::X);
    line.sense = read.value_or(Sense::EX);
    line.from_mm = needed(row, "from_mm");
    line.to_mm = needed(row, "to_mm");
    line.step_mm = needed(row, "step_mm");
    line.feed_mm_min = reader_.number(all, "feed_mm_min");
    if (const auto runs = reader_.number(all, "runs"))
      line.runs = static_cast<int>(std::clamp<double>(*runs, 1.0, kMostRuns));
    const toml::table* parked = reader_.child(row, "parked_mm");
    for (const Axis other : kAllAxes) {
      const std::string key(1, static_cast<char>(letter_of(other) - 'X' + 'x'));
      if (parked != nullptr) line.parked_mm[index_of(other)] = reader_.number(*parked, key).value_or(0.0);
    }
  }
  double needed(const toml::table& row, std::string_view key) {
    const auto value = reader_.number(row, key);
    if (!value && !row.contains(key)) reader_.complain(row, fmt::format("{} is missing", key));
    return value.value_or(0.0);
  }

  TomlReader reader_;
};

/// What the command line says wins over the plan's row.
Result<void> override_line(const CaptureTargets& arguments, devices::CaptureLine& line) {
  ImportArguments words;
  words.axis = arguments.axis;
  words.sense = arguments.sense;
  words.parked = arguments.parked;
  ECS_TRY(given, import_options(words));
  if (given.axis) line.axis = *given.axis;
  if (given.sense) line.sense = *given.sense;
  if (!arguments.parked.empty()) line.parked_mm = given.parked_mm;
  if (arguments.from_mm) line.from_mm = *arguments.from_mm;
  if (arguments.to_mm) line.to_mm = *arguments.to_mm;
  if (arguments.step_mm) line.step_mm = *arguments.step_mm;
  if (arguments.runs > 0) line.runs = arguments.runs;
  if (arguments.feed_mm_min) line.feed_mm_min = arguments.feed_mm_min;
  line.moved = arguments.moved;
  line.one_way = arguments.one_way;
  return {};
}

std::string lacking(const CaptureTargets& arguments) {
  std::string names;
  const auto need = [&names](bool given, const char* name) {
    if (!given) names += std::string(names.empty() ? "" : ", ") + name;
  };
  need(!arguments.axis.empty(), "--axis");
  need(!arguments.sense.empty(), "--sense");
  need(arguments.from_mm.has_value(), "--from");
  need(arguments.to_mm.has_value(), "--to");
  need(arguments.step_mm.has_value(), "--step");
  return names;
}

Result<devices::CapturePlan> plan_of_list(const CaptureTargets& arguments) {
  if (arguments.from_mm || arguments.to_mm || arguments.step_mm || arguments.runs > 0 || !arguments.plan.empty())
    return wrong_usage("--targets gives the whole list: leave out --plan, --from, --to, --step and --runs");
  ECS_TRY(targets, laser::read_measurement_set(arguments.targets));
  ECS_TRY(stops, devices::stops_of_targets(targets));
  devices::CapturePlan plan{{{"targets", arguments.targets}}, std::move(stops)};
  for (const laser::MetadataEntry& entry : targets.metadata)
    if (entry.key != "content") plan.metadata.push_back(entry);
  return plan;
}

Result<devices::CapturePlan> plan_of_line(const CaptureTargets& arguments) {
  devices::CaptureLine line;
  line.runs = kUsualRuns;
  devices::CapturePlan plan;
  if (!arguments.plan.empty()) {
    if (arguments.row.empty()) return wrong_usage("--plan needs --row NAME: which of its measurements");
    ECS_TRY(text, read_file(arguments.plan));
    ECS_TRY(read, PlanRow(arguments.plan).read(text, arguments.row, line));
    plan = std::move(read);
  } else if (const std::string names = lacking(arguments); !names.empty()) {
    return wrong_usage(
        fmt::format("what is to be measured? Missing: {}; or give --plan PLAN.toml --row NAME, or --targets FILE.csv, "
                    "or --resume FILE.part",
                    names));
  }
  ECS_DO(override_line(arguments, line));
  ECS_TRY(stops, devices::stops_of(line));
  plan.stops = std::move(stops);
  return plan;
}

}  // namespace

cli::Fields<CaptureTargets> CaptureTargets::fields() {
  using A = CaptureTargets;
  using cli::Words;
  return {{"--axis", &A::axis, "the axis that moves", Words{"X", "Y", "Z"}},
          {"--sense", &A::sense, "what is measured", Words{"EX", "EY", "EZ", "EA", "EB", "EC"}},
          {"--from", &A::from_mm, "first target [mm]"},
          {"--to", &A::to_mm, "last target [mm]"},
          {"--step", &A::step_mm, "from target to target [mm]"},
          {"--moved", &A::moved, "targets off equal steps, as ISO 230-2 asks: no period hides behind the step"},
          {"--runs", &A::runs, "forward and back so many times (3)", cli::Range{0, kMostRuns}},
          {"--one-way", &A::one_way, "no readings on the way back"},
          {"--parked", &A::parked, "positions of the other axes, as in y=-1400,z=0 [mm]"},
          {"--feed", &A::feed_mm_min, "feed between the targets [mm/min], for the record"},
          {"--targets", &A::targets, "a target list (CSV), as `ecs model next --targets` writes it"},
          {"--plan", &A::plan, "plan with [[measure]] rows, as `laser table` reads it"},
          {"--row", &A::row, "with --plan: the name of the measurement"},
          {"--machine", &A::machine, "machine file: its name goes into the record"},
          {"--compensated", &A::compensated, "whether the error map is active, for the record", Words{"yes", "no"}},
          {"--note", &A::notes, "KEY=VALUE for the record, as in operator=AB; several"}};
}

Result<devices::CapturePlan> capture_plan(const CaptureTargets& arguments) {
  auto plan = arguments.targets.empty() ? plan_of_line(arguments) : plan_of_list(arguments);
  if (!plan) return plan;
  std::vector<laser::MetadataEntry> first;
  if (!arguments.machine.empty()) {
    ECS_TRY(machine, params::read_machine(arguments.machine));
    first.push_back({"machine", machine.machine.name});
  }
  for (const std::string& note : arguments.notes) {
    const std::size_t equals = note.find('=');
    const std::string key(trimmed(std::string_view(note).substr(0, equals)));
    if (equals == std::string::npos || key.empty() || key.find(':') != std::string::npos || key.starts_with("capture"))
      return wrong_usage(fmt::format("--note: expected KEY=VALUE, as in operator=AB, got \"{}\"", note));
    first.push_back({key, std::string(trimmed(std::string_view(note).substr(equals + 1)))});
  }
  plan->metadata.insert(plan->metadata.begin(), first.begin(), first.end());
  if (!arguments.compensated.empty())
    for (laser::Reading& stop : plan->stops) stop.compensated = arguments.compensated == "yes";
  return plan;
}

}  // namespace ecs::commissioning
