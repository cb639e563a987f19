// `ecs utility datum record, show, test`: setting up the datuming parameters. `ecs utility status`: the unit's state
// and faults, live or from a file.

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/unit/datum_recording.hpp"
#include "commissioning/unit/status.hpp"
#include "commissioning/unit/utility_work.hpp"

namespace ecs::app {
namespace {

using std::chrono::milliseconds;

milliseconds in_ms(double seconds) { return milliseconds(static_cast<long long>(seconds * 1000.0)); }

/// In the text a long row of markers is cut to its first and last.
Cell events_cell(const std::vector<DatumEvent>& events) {
  const auto is_marker = [&](std::size_t i) { return i < events.size() && events[i].what == "marker"; };
  Cell list{Json::array(), fmt::format("{}\n", kEventHeading)};
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Cell event = datum_event_cell(events[i]);
    if (i > 0 && is_marker(i - 1) && is_marker(i) && is_marker(i + 1)) {
      ++left_out;
      list.json.push_back(event.json);
      continue;
    }
    if (left_out > 0)
      list.text +=
          fmt::format("{:>8} {:>12} {:>15}  {} more marker{}\n", "", "", "", left_out, left_out == 1 ? "" : "s");
    left_out = 0;
    list.add(event);
  }
  return list;
}

Cell recording_cell(const DatumRecording& recording) {
  return record_cell("axis {axis}, {samples} samples every {sample_period_us} us\n\n{graph}\n{events}",
                     "axis"_is(std::string(1, letter_of(recording.axis))), "taken"_is(text_cell(recording.taken)),
                     "serial_number"_is(text_cell(recording.serial_number)), "samples"_is(recording.samples.size()),
                     "sample_period_us"_is(recording.sample_period_us), "um_per_count"_is(recording.um_per_count),
                     "graph"_shown(graph_of(recording)), "events"_is(events_cell(events_of(recording))));
}

/// Asks to reference the axis once the unit is busy with the command: it waits for the axis now.
protocol::CommandCallback ask_when_accepted(VerbContext& context, const UnitLink& unit, Axis axis) {
  return [&context, &unit, axis, asked = false](const protocol::CommandResult&) mutable {
    if (!std::exchange(asked, true)) ask_to_reference(context, unit, fmt::format("axis {}", letter_of(axis)));
  };
}

// --- record
struct RecordRequest {
  std::string axis, output;
  static Fields<RecordRequest> fields() {
    using R = RecordRequest;
    return {{"AXIS", &R::axis, "axis", Words{"X", "Y", "Z"}, Need::required},
            {"-o,--output", &R::output, "CSV file to write", Is::output}};
  }
};

Result<Outcome> record(VerbContext& context, const RecordRequest& request) {
  ECS_TRY(axis, axis_named(request.axis));
  ECS_TRY(unit, open_unit(context));
  const auto recording_bar = [&, ask = ask_when_accepted(context, unit, axis)](const protocol::CommandResult& busy) {
    ask(busy);
    const double done = busy.per_mille / 1000.0;
    context.console.progress("recording", done, (1.0 - done) * kDatumRecord_s);
  };
  ECS_TRY(recording, record_datum(unit.client(), axis, recording_bar, progress_bar(context, "transfer")));
  if (!request.output.empty()) {
    ECS_DO(write_file(request.output, to_csv(recording)));
    context.console.note(fmt::format("record written to {}", request.output));
  }
  const bool moved = !events_of(recording).empty();
  if (!moved)
    context.console.warn(
        fmt::format("axis {} did not move during these {} s. Record again, and start the reference movement in time",
                    request.axis, kDatumRecord_s));
  return outcome_of(recording_cell(recording), moved ? kDone : kDoesNotHold);
}

// --- show
struct ShowRequest {
  std::string file;
  static Fields<ShowRequest> fields() {
    using R = ShowRequest;
    return {{"FILE", &R::file, "CSV file of `datum record`", Need::required}};
  }
};

Result<Outcome> show(VerbContext&, const ShowRequest& request) {
  ECS_TRY(recording, read_recording_file(request.file));
  return outcome_of(recording_cell(recording));
}

// --- test
struct TestRequest {
  std::vector<std::string> axes;
  double wait_s = 60.0;
  static Fields<TestRequest> fields() {
    using R = TestRequest;
    return {{"AXIS", &R::axes, "axes to test; default: all axes of the unit"},
            {"--wait", &R::wait_s, "time to wait for each axis [s]", Range{0.1, 86400.0}}};
  }
};

Result<std::vector<Axis>> axes_to_test(const std::vector<std::string>& names, const protocol::Identity& identity) {
  std::vector<Axis> axes;
  for (const std::string& name : names) {
    ECS_TRY(axis, axis_named(name));
    axes.push_back(axis);
  }
  for (const Axis axis : kAllAxes)
    if (names.empty() && identity.axis_present[index_of(axis)]) axes.push_back(axis);
  return axes;
}

Result<Outcome> test(VerbContext& context, const TestRequest& request) {
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(identity, unit.client().identity());
  ECS_TRY(axes, axes_to_test(request.axes, identity));
  Cell list{Json::array(), {}};
  bool all_passed = true;
  for (const Axis axis : axes) {
    const std::string letter(1, letter_of(axis));
    ECS_TRY(one, test_datum_of(unit.client(), axis, in_ms(request.wait_s), ask_when_accepted(context, unit, axis)));
    all_passed = all_passed && one.passed;
    list.add(record_cell("axis {axis}: {passed}\n", "axis"_is(letter),
                         "passed"_is(one.passed, "datum found", one.message), "message"_is(text_cell(one.message))));
  }
  return outcome_of(record_cell("{axes}", "passed"_is(all_passed), "axes"_is(list)), all_passed ? kDone : kDoesNotHold);
}

struct StatusRequest {
  std::string save;
  std::vector<std::string> from;
  static Fields<StatusRequest> fields() {
    using R = StatusRequest;
    return {{"--save", &R::save, "file for the decoded values and raw registers", Is::output},
            {"--from", &R::from, "decode a saved file instead of reading the unit"}};
  }
};

Result<StatusSnapshot> snapshot_of_unit(VerbContext& context) {
  ECS_TRY(unit, open_unit(context));
  return take_snapshot(unit.client(), unit.name(), protocol::kKeptEvents);
}

Result<Outcome> show_status(VerbContext& context, const StatusRequest& request) {
  if (request.from.size() > 1) return problem(ProblemKind::usage, "utility status: --from accepts one file");
  ECS_TRY(snapshot, request.from.empty() ? snapshot_of_unit(context) : read_snapshot(request.from.front()));
  if (!request.save.empty()) {
    ECS_DO(write_snapshot(request.save, snapshot));
    context.console.note(fmt::format("status written to {}", request.save));
  }
  return outcome_of(status_cell(snapshot));
}

}  // namespace

extern const std::vector<Action> kUtilityDatum{
    action("utility datum record", "record speed, switch and marker of an axis for ten seconds while it is referenced",
           "ecs utility datum record X -o x_datum.csv", record, {.link = Link::writes}),
    action("utility datum show", "show a recorded sequence as a velocity-time graph and a list of events",
           "ecs utility datum show x_datum.csv", show),
    action("utility datum test", "run the unit's datum routine, axis by axis", "ecs utility datum test X Y --wait 120",
           test, {.link = Link::writes}),
    action("utility status",
           "show mode, fault and remedy, memory tests, the table values used last (address pointers) and relays",
           "ecs utility status --save status.json\n  ecs utility status --from status.json", show_status,
           {.link = Link::reads})};

}  // namespace ecs::app
