// `ecs monitor`: what the unit sees of the axes, sample by sample.
#include <chrono>
#include <optional>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "commissioning/measurements/environment_watch.hpp"
#include "commissioning/unit/monitor_record.hpp"
#include "commissioning/unit/status_view.hpp"
#include "core/fault.hpp"

namespace ecs::app {
namespace {

using protocol::AxisSample;
using protocol::MonitorSample;

constexpr double kEnvironment_s = 1.0;  ///< between two readings of the surroundings

struct MonitorArguments : VerbArguments {
  const int& count = integer("--count", "samples to show; 0: until stopped", 0, 0, 100'000'000);  ///< 0: until stopped
  const int& interval_ms = integer("--interval", "milliseconds between samples", 500, 1, 3'600'000);
  const std::string& environment = text(
      "--environment", "temper, or DEVICE.toml[@SERIAL]: air and material beside the axes");  ///< a device; empty: none
  const std::string& record =
      text("--record", "CSV to write, a row for each axis and sample; FILE.part until the end, which a crash leaves");
  const Access access = uses_link();
};

double time_s(const MonitorSample& sample) { return static_cast<double>(sample.unit_time_us) * 1e-6; }

struct SampledAxis {
  Axis axis = Axis::X;
  AxisSample sample;
};

const AnswerTable<SampledAxis>& axes_table() {
  static const AnswerTable<SampledAxis> table(
      "{axis:<4} {position_mm:>11} {speed_mm_min:>14} {referenced:<3} {switch:<6} {marker:<6} {approach:<8} "
      "{compensation_um:>7} {output_counts:>6} {relay_closed}",
      {{"axis", "axis", [](const SampledAxis& a) { return shown_cell(std::string(1, letter_of(a.axis))); }},
       {"position_mm", "position/mm", [](const SampledAxis& a) { return number_cell(a.sample.position_mm, 4); }},
       {"speed_mm_min", "speed/(mm/min)", [](const SampledAxis& a) { return number_cell(a.sample.speed_mm_min, 1); }},
       {"referenced", "ref", [](const SampledAxis& a) { return yes_cell(a.sample.referenced, "yes", "no"); }},
       {"switch", "switch", [](const SampledAxis& a) { return yes_cell(a.sample.switch_active, "on", "off"); }},
       {"marker", "marker", [](const SampledAxis& a) { return yes_cell(a.sample.marker, "seen", "-"); }},
       {"approach", "approach", [](const SampledAxis& a) { return word_cell(name_of(a.sample.approach)); }},
       {"compensation_um", "comp/um", [](const SampledAxis& a) { return number_cell(a.sample.compensation_um, 2); }},
       {"output_counts", "D/A",
        [](const SampledAxis& a) {
          return Cell{a.sample.output_counts, fmt::format("{}", a.sample.output_counts)};
        }},
       {"relay_closed", "relay",
        [](const SampledAxis& a) { return yes_cell(a.sample.relay_closed, "closed", "open"); }}});
  return table;
}

std::vector<SampledAxis> sampled_axes(const MonitorSample& sample) {
  std::vector<SampledAxis> rows;
  for (const Axis axis : kAllAxes)
    if (const AxisSample& one = sample.axes[index_of(axis)]; one.present) rows.push_back({axis, one});
  return rows;
}

Json surroundings_json(const Surroundings& surroundings) {
  Json object{{"device", text_or_null(surroundings.device)}, {"problem", text_or_null(surroundings.problem)}};
  for (const auto& [quantity, value] : surroundings.values)
    object[std::string(devices::name_of(quantity))] = number_or_null(value);
  return object;
}

Json sample_json(const MonitorSample& sample, const std::string& link) {
  Json axes = Json::object();
  for (const SampledAxis& row : sampled_axes(sample))
    axes[std::string(1, letter_of(row.axis))] = axes_table().object(row);
  return Json{{"number", sample.number},
              {"time_s", time_s(sample)},
              {"mode", ecs::name_of(sample.mode)},
              {"fault", ecs::text_of(sample.fault).name},
              {"axes", axes},
              {"link", link}};
}

std::string sample_text(const MonitorSample& sample) {
  return fmt::format(
             "{:.3f} s, {}{}\n", time_s(sample), ecs::name_of(sample.mode),
             sample.fault == Fault::none ? std::string() : fmt::format(", fault {}", ecs::text_of(sample.fault).name)) +
         axes_table().text(sampled_axes(sample));
}

/// Samples until the count is reached, a signal comes or the link is lost.
Result<void> watch(VerbContext& context, UnitLink& unit, const MonitorArguments& arguments,
                   std::optional<MonitorRecording>& recording) {
  std::optional<EnvironmentWatch> environment;
  if (!arguments.environment.empty()) environment.emplace(arguments.environment, kEnvironment_s);
  for (int i = 0; arguments.count == 0 || i < arguments.count; ++i) {
    if (i > 0 && !unit.client().link().pause(std::chrono::milliseconds(arguments.interval_ms))) return {};
    const auto sample = unit.client().monitor();
    if (!sample) return tl::unexpected(sample.error());
    Json object = sample_json(*sample, unit.name());
    std::string text = sample_text(*sample);
    const Surroundings surroundings = environment ? environment->now() : Surroundings();
    if (environment) {
      object["environment"] = surroundings_json(surroundings);
      text += to_text(surroundings) + "\n";
    }
    context.console.print(text);
    context.console.print_json(one_line(object));
    if (recording)
      if (auto added = recording->add(*sample, surroundings.values); !added) return added;
    if (!context.console.output_is_whole()) return problem(ProblemKind::output, "stdout could not be written");
  }
  return {};
}

Result<Outcome> monitor(VerbContext& context, const MonitorArguments& arguments) {
  std::optional<MonitorRecording> recording;
  if (!arguments.record.empty()) {
    auto begun = MonitorRecording::begun(arguments.record);
    if (!begun) return tl::unexpected(begun.error());
    recording.emplace(std::move(*begun));
  }
  auto unit = open_unit(context, Access::reads);
  if (!unit) return tl::unexpected(unit.error());
  const auto watched = watch(context, *unit, arguments, recording);
  if (recording && recording->runs() && recording->samples() > 0) {
    if (auto ended = recording->end(); !ended) return tl::unexpected(ended.error());
    context.console.note(fmt::format("{} samples written to {}", recording->samples(), arguments.record));
  }
  if (!watched) return tl::unexpected(watched.error());
  return Outcome{};
}

}  // namespace

extern const VerbDefinition kMonitor = verb<MonitorArguments>(
    "monitor", "ON LINE MONITOR: positions, speeds, reference switch and marker of the axes",
    "ecs monitor --count 10 --interval 200 --record axes.csv\n  ecs monitor --json --count 1", monitor);

}  // namespace ecs::app
