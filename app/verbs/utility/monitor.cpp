// `ecs monitor`: what the unit sees of the axes, sample by sample.
#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "app/cli/menus.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/json.hpp"
#include "commissioning/measurements/environment_watch.hpp"
#include "commissioning/unit/monitor_record.hpp"
#include "commissioning/unit/status_view.hpp"
#include "core/fault.hpp"

namespace ecs::app {
namespace {

using protocol::AxisSample;
using protocol::MonitorSample;

constexpr double kEnvironment_s = 1.0;  ///< between two readings of the surroundings

struct MonitorArguments {
  int count = 0;  ///< 0: until stopped
  int interval_ms = 500;
  std::string record;
  std::string environment;  ///< a device; empty: none
};

double time_s(const MonitorSample& sample) { return static_cast<double>(sample.unit_time_us) * 1e-6; }

Json json_of(const AxisSample& axis) {
  return Json{{"position_mm", number_or_null(axis.position_mm)},
              {"speed_mm_min", number_or_null(axis.speed_mm_min)},
              {"referenced", axis.referenced},
              {"switch", axis.switch_active},
              {"marker", axis.marker},
              {"approach", name_of(axis.approach)},
              {"compensation_um", number_or_null(axis.compensation_um)},
              {"output_counts", axis.output_counts},
              {"relay_closed", axis.relay_closed}};
}

Json json_of(const Surroundings& surroundings) {
  Json object{{"device", text_or_null(surroundings.device)}, {"problem", text_or_null(surroundings.problem)}};
  for (const auto& [quantity, value] : surroundings.values)
    object[std::string(name_of(quantity))] = number_or_null(value);
  return object;
}

Json json_of(const MonitorSample& sample, const std::string& link) {
  Json axes = Json::object();
  for (const Axis axis : kAllAxes)
    if (sample.axes[index_of(axis)].present)
      axes[std::string(1, letter_of(axis))] = json_of(sample.axes[index_of(axis)]);
  return Json{{"number", sample.number},
              {"time_s", time_s(sample)},
              {"mode", ecs::name_of(sample.mode)},
              {"fault", ecs::text_of(sample.fault).name},
              {"axes", axes},
              {"link", link}};
}

std::string text_of(const MonitorSample& sample) {
  std::string text = fmt::format(
      "{:.3f} s, {}{}\naxis position/mm speed/(mm/min) ref switch marker approach comp/um    D/A relay\n",
      time_s(sample), ecs::name_of(sample.mode),
      sample.fault == Fault::none ? std::string() : fmt::format(", fault {}", ecs::text_of(sample.fault).name));
  for (const Axis axis : kAllAxes) {
    const AxisSample& a = sample.axes[index_of(axis)];
    if (!a.present) continue;
    text += fmt::format("{:<4} {:>11.4f} {:>14.1f} {:<3} {:<6} {:<6} {:<8} {:>7.2f} {:>6} {}\n", letter_of(axis),
                        a.position_mm, a.speed_mm_min, a.referenced ? "yes" : "no", a.switch_active ? "on" : "off",
                        a.marker ? "seen" : "-", name_of(a.approach), a.compensation_um, a.output_counts,
                        a.relay_closed ? "closed" : "open");
  }
  return text;
}

/// Samples until the count is reached, a signal comes or the line is lost.
Result<void> watch(VerbContext& context, UnitLink& unit, const MonitorArguments& arguments,
                   std::optional<MonitorRecording>& recording) {
  std::optional<EnvironmentWatch> environment;
  if (!arguments.environment.empty()) environment.emplace(arguments.environment, kEnvironment_s);
  for (int i = 0; arguments.count == 0 || i < arguments.count; ++i) {
    if (i > 0 && !unit.client().link().pause(std::chrono::milliseconds(arguments.interval_ms))) return {};
    const auto sample = unit.client().monitor();
    if (!sample) return tl::unexpected(sample.error());
    Json object = json_of(*sample, unit.name());
    std::string text = text_of(*sample);
    const Surroundings surroundings = environment ? environment->now() : Surroundings();
    if (environment) {
      object["environment"] = json_of(surroundings);
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

void add_monitor_verb(Menu& root) {
  const auto arguments = std::make_shared<MonitorArguments>();
  root.verb("monitor", "ON LINE MONITOR: positions, speeds, reference switch and marker of the axes",
            "ecs monitor --count 10 --interval 200 --record axes.csv\n  ecs monitor --json --count 1")
      .integer("--count", arguments->count, "samples to show; 0: until stopped", 0, 100'000'000)
      .integer("--interval", arguments->interval_ms, "milliseconds between samples", 1, 3'600'000)
      .text("--environment", arguments->environment,
            "temper, or DEVICE.toml[@SERIAL]: air and material beside the axes")
      .text("--record", arguments->record,
            "CSV to write, a row for each axis and sample; FILE.part until the end, which a crash leaves")
      .uses_link()
      .runs([arguments](VerbContext& context) { return monitor(context, *arguments); });
}

}  // namespace ecs::app
