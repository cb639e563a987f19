// `ecs monitor`: what the unit sees of the axes, sample by sample.
#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "app/cli/module.hpp"
#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "app/verbs/utility/shown.hpp"
#include "base/answer_table.hpp"
#include "commissioning/unit/monitor_record.hpp"
#include "commissioning/unit/status.hpp"
#include "core/fault.hpp"
#include "core/mode_word.hpp"
#include "params/position_unit.hpp"

namespace ecs::app {
namespace {

using protocol::AxisSample;
using protocol::MonitorSample;

constexpr double kEnvironment_s = 1.0;  ///< between two readings of the surroundings

struct MonitorRequest {
  int count = 0;  ///< 0: until stopped
  int interval_ms = 500;
  std::string environment;  ///< a device; empty: none
  std::string record;
  static Fields<MonitorRequest> fields() {
    using R = MonitorRequest;
    return {{"--count", &R::count, "number of samples to show; 0: until stopped", Range{0, 100'000'000}},
            {"--interval", &R::interval_ms, "time between samples [ms]", Range{1, 3'600'000}},
            {"--environment", &R::environment,
             "thermometer for air and material temperature: temper (a USB thermometer TEMPer), or a device file "
             "DEVICE.toml[@SERIAL]"},
            {"--record", &R::record,
             "CSV file to write, one row per axis and sample; FILE.part until complete, kept if the program stops "
             "unexpectedly",
             Is::output}};
  }
};

double time_s(const MonitorSample& sample) { return static_cast<double>(sample.unit_time_us) * 1e-6; }

Cell axis_cell(Axis axis, const AxisSample& a, const params::PositionUnit& unit) {
  return record_cell(
      "{axis:<4} {position_mm:>11} {speed_mm_min:>14} {referenced:<3} {switch:<6} {marker:<6} {approach:<8} "
      "{compensation_um:>7} {output_counts:>6} {relay_closed}\n",
      "axis"_shown(std::string(1, letter_of(axis))), "position_mm"_is(a.position_mm, unit.position(a.position_mm)),
      "speed_mm_min"_is(a.speed_mm_min, unit.speed_of(a.speed_mm_min)), "referenced"_is(a.referenced, "yes", "no"),
      "switch"_is(a.switch_active, "on", "off"), "marker"_is(a.marker, "seen", "-"),
      "approach"_is(approach_cell(a.approach)), "compensation_um"_is(a.compensation_um, 2),
      "output_counts"_is(a.output_counts), "relay_closed"_is(a.relay_closed, "closed", "open"));
}

Cell axes_cell(const MonitorSample& sample, const params::PositionUnit& unit) {
  Cell axes{Json::object(), fmt::format("axis position/{} speed/({}) ref switch marker approach comp/um    D/A relay\n",
                                        unit.length, unit.speed)};
  for (const Axis axis : kAllAxes) {
    if (!sample.axes[index_of(axis)].present) continue;
    const Cell one = axis_cell(axis, sample.axes[index_of(axis)], unit);
    axes.json[std::string(1, letter_of(axis))] = one.json;
    axes.text += one.text;
  }
  if (const std::string remark = unreferenced_text(sample); !remark.empty()) axes.text += remark + "\n";
  return axes;
}

Json surroundings_json(const Surroundings& surroundings) {
  Json object =
      object_of("device"_is(text_or_null(surroundings.device)), "problem"_is(text_or_null(surroundings.problem)));
  for (const auto& [quantity, value] : surroundings.values) object[quantity] = number_or_null(value);
  return object;
}

Cell sample_cell(const MonitorSample& sample, const std::string& link, const params::PositionUnit& unit) {
  const std::string_view fault = ecs::text_of(sample.fault).name;
  return record_cell("{time_s} s, {mode}{fault}\n{axes}", "number"_is(sample.number), "time_s"_is(time_s(sample), 3),
                     "mode"_is(ecs::name_of(sample.mode), std::string(word_of(sample.mode))),
                     "fault"_is(fault, sample.fault == Fault::none ? std::string() : fmt::format(", fault {}", fault)),
                     "axes"_is(axes_cell(sample, unit)), "link"_is(link));
}

void add_rotary(Cell& shown, const protocol::RotarySample& rotary, UnitMode mode) {
  const Cell axes = rotary_axes_cell(rotary), added = rotary_compensation_cell(rotary, mode);
  shown.json["rotary_axes"] = axes.json;
  shown.json["rotary_compensation_um"] = added.json;
  shown.text += axes.text + added.text;
}

/// Samples until the count is reached, a signal comes, the link is lost or nobody reads them.
Result<void> watch(VerbContext& context, UnitLink& unit, const MonitorRequest& request,
                   std::optional<MonitorRecording>& recording) {
  std::unique_ptr<SurroundingsWatch> environment;
  if (!request.environment.empty()) {
    environment = watched_surroundings(request.environment, kEnvironment_s);
    if (!environment)
      return problem(ProblemKind::usage, "--environment: this program was built without device support");
  }
  const params::PositionUnit& shown_in = position_unit_for(context, unit);
  ECS_TRY(identity, unit.client().identity());
  ECS_TRY(first_rotary, unit.client().rotary(identity));
  for (int i = 0; request.count == 0 || i < request.count; ++i) {
    if (i > 0 && !unit.client().link().pause(std::chrono::milliseconds(request.interval_ms))) return {};
    ECS_TRY(sample, unit.client().monitor());
    Cell shown = sample_cell(sample, unit.name(), shown_in);
    if (any_axis(first_rotary)) {
      ECS_TRY(rotary, unit.client().rotary(identity));
      add_rotary(shown, rotary, sample.mode);
    }
    const Surroundings surroundings = environment ? environment->now() : Surroundings();
    if (environment) {
      shown.json["environment"] = surroundings_json(surroundings);
      shown.text += surroundings.text + "\n";
    }
    context.console.print(shown.text);
    context.console.print_json(one_line(shown.json));
    if (recording)
      if (auto added = recording->add(sample, surroundings); !added) return added;
    if (!context.console.output_is_whole()) return {};  // whoever ends the verb says why
  }
  return {};
}

Result<Outcome> monitor(VerbContext& context, const MonitorRequest& request) {
  std::optional<MonitorRecording> recording;
  if (!request.record.empty()) {
    ECS_TRY(begun, MonitorRecording::begun(request.record));
    recording.emplace(std::move(begun));
  }
  ECS_TRY(unit, open_unit(context));
  const auto watched = watch(context, unit, request, recording);
  if (recording && recording->runs() && recording->samples() > 0) {
    ECS_DO(recording->end());
    context.console.note(recording->summary());
  }
  if (!watched) return tl::unexpected(watched.error());
  return Outcome{};
}

}  // namespace

extern const std::vector<Action> kMonitoring{
    action("monitor", "ON LINE MONITOR: positions, speeds, reference switches and markers of the axes",
           "ecs monitor --count 10 --interval 200 --record axes.csv\n  ecs monitor --json --count 1", monitor,
           {.link = Link::reads})};

}  // namespace ecs::app
