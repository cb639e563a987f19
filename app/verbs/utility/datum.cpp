// `ecs utility datum record, show, test`: setting up the datuming parameters.
#include <chrono>

#include <fmt/format.h>

#include "app/cli/axis_argument.hpp"
#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "commissioning/unit/datum_recording.hpp"
#include "commissioning/unit/utility_work.hpp"

namespace ecs::app {
namespace {

using std::chrono::milliseconds;

milliseconds in_ms(double seconds) { return milliseconds(static_cast<long long>(seconds * 1000.0)); }

Json recording_json(const DatumRecording& recording) {
  Json events = Json::array();
  for (const DatumEvent& event : events_of(recording))
    events.push_back({{"what", event.what},
                      {"time_s", number_or_null(event.time_s)},
                      {"position_mm", number_or_null(event.position_mm)},
                      {"speed_mm_min", number_or_null(event.speed_mm_min)}});
  return Json{{"axis", std::string(1, letter_of(recording.axis))},
              {"taken", text_or_null(recording.taken)},
              {"serial_number", text_or_null(recording.serial_number)},
              {"samples", recording.samples.size()},
              {"sample_period_us", number_or_null(recording.sample_period_us)},
              {"um_per_count", number_or_null(recording.um_per_count)},
              {"events", events}};
}

/// The events, with a long row of markers cut to its first and last.
std::string events_text(const std::vector<DatumEvent>& events) {
  const auto is_marker = [&](std::size_t i) { return i < events.size() && events[i].what == "marker"; };
  std::string text;
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (i > 0 && is_marker(i - 1) && is_marker(i) && is_marker(i + 1)) {
      ++left_out;
      continue;
    }
    if (left_out > 0) text += fmt::format("{:>8} {:>12} {:>15}  {} more markers\n", "", "", "", left_out);
    left_out = 0;
    text += fmt::format("{:>8.3f} {:>12.4f} {:>15.1f}  {}\n", events[i].time_s, events[i].position_mm,
                        events[i].speed_mm_min, events[i].what);
  }
  return text;
}

std::string recording_text(const DatumRecording& recording) {
  return fmt::format("axis {}, {} samples every {} us\n\n{}\n  time/s  position/mm  speed/(mm/min)  event\n{}",
                     letter_of(recording.axis), recording.samples.size(), recording.sample_period_us,
                     graph_of(recording), events_text(events_of(recording)));
}

// --- record
struct RecordArguments : VerbArguments {
  const std::string& axis = choice("AXIS", {"X", "Y", "Z"}, "axis", Need::required);
  const std::string& output = text("-o,--output", "CSV file to write");
  const Access access = writes_to_unit();
};

Result<Outcome> record(VerbContext& context, const RecordArguments& arguments) {
  const auto axis = axis_named(arguments.axis);
  if (!axis) return tl::unexpected(axis.error());
  auto unit = open_unit(context, arguments.access);
  if (!unit) return tl::unexpected(unit.error());
  const auto identity = unit->client().identity();
  if (!identity) return tl::unexpected(identity.error());
  context.console.note(fmt::format("recording for {} s", kDatumRecord_s));
  ask_to_reference(context, *unit, "axis " + arguments.axis);
  const auto result =
      unit->client().record_datum(*axis, in_ms(3.0 * kDatumRecord_s), [&context](const protocol::CommandResult& busy) {
        const double done = busy.per_mille / 1000.0;
        context.console.progress("recording", done, (1.0 - done) * kDatumRecord_s);
      });
  if (!result) return tl::unexpected(result.error());
  auto recording = read_recording(unit->client(), result->value, progress_bar(context, "transfer"));
  if (!recording) return tl::unexpected(recording.error());
  recording->taken = now_utc();
  recording->serial_number = identity->serial_number;
  if (!arguments.output.empty()) {
    if (auto written = write_file(arguments.output, to_csv(*recording)); !written)
      return tl::unexpected(written.error());
    context.console.note(fmt::format("record written to {}", arguments.output));
  }
  return Outcome{recording_text(*recording), one_line(recording_json(*recording)), kDone};
}

// --- show
struct ShowArguments : VerbArguments {
  const std::string& file = text("FILE", "CSV file of `datum record`", Need::required);
};

Result<Outcome> show(VerbContext&, const ShowArguments& arguments) {
  const auto recording = read_recording_file(arguments.file);
  if (!recording) return tl::unexpected(recording.error());
  return Outcome{recording_text(*recording), one_line(recording_json(*recording)), kDone};
}

// --- test
struct TestArguments : VerbArguments {
  const std::vector<std::string>& axes = texts("AXIS", "axes; none: all that the unit has");
  const double& wait_s = number("--wait", "seconds to wait for each axis", 60.0, Need::optional, 0.1, 86400.0);
  const Access access = writes_to_unit();
};

Result<std::vector<Axis>> axes_to_test(const std::vector<std::string>& names, const protocol::Identity& identity) {
  std::vector<Axis> axes;
  for (const std::string& name : names) {
    const auto axis = axis_named(name);
    if (!axis) return tl::unexpected(axis.error());
    axes.push_back(*axis);
  }
  for (const Axis axis : kAllAxes)
    if (names.empty() && identity.axis_present[index_of(axis)]) axes.push_back(axis);
  return axes;
}

Result<Outcome> test(VerbContext& context, const TestArguments& arguments) {
  auto unit = open_unit(context, arguments.access);
  if (!unit) return tl::unexpected(unit.error());
  const auto identity = unit->client().identity();
  if (!identity) return tl::unexpected(identity.error());
  const auto axes = axes_to_test(arguments.axes, *identity);
  if (!axes) return tl::unexpected(axes.error());
  Json list = Json::array();
  std::string text;
  bool all_passed = true;
  for (const Axis axis : *axes) {
    ask_to_reference(context, *unit, fmt::format("axis {}", letter_of(axis)));
    const auto one = test_datum_of(unit->client(), axis, in_ms(arguments.wait_s));
    if (!one) return tl::unexpected(one.error());
    all_passed = all_passed && one->passed;
    text += fmt::format("axis {}: {}\n", letter_of(axis), one->passed ? "datum found" : one->message);
    list.push_back(
        {{"axis", std::string(1, letter_of(axis))}, {"passed", one->passed}, {"message", text_or_null(one->message)}});
  }
  return Outcome{text, one_line(Json{{"passed", all_passed}, {"axes", list}}), all_passed ? kDone : kDoesNotHold};
}

}  // namespace

extern const VerbDefinition kUtilityDatumRecord =
    verb<RecordArguments>("utility datum record", "record ten seconds of an axis: speed, reference switch, marker",
                          "ecs utility datum record X -o x_datum.csv", record);

extern const VerbDefinition kUtilityDatumShow =
    verb<ShowArguments>("utility datum show", "a recorded sequence as velocity-time graph and events",
                        "ecs utility datum show x_datum.csv", show);

extern const VerbDefinition kUtilityDatumTest = verb<TestArguments>(
    "utility datum test", "run the unit's datum routine, axis by axis", "ecs utility datum test X Y --wait 120", test);

}  // namespace ecs::app
