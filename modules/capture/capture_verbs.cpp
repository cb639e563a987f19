// `ecs laser capture`: guides through the targets of a measurement and takes its readings. `ecs laser devices`: which
// HID devices are plugged in, udev rules for them, learning a trigger, trying a description.

#include <chrono>
#include <thread>

#include <fmt/format.h>

#include "app/cli/module.hpp"
#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/process.hpp"
#include "modules/capture/capture.hpp"
#include "modules/capture/description.hpp"
#include "modules/capture/port.hpp"

namespace ecs::app {
namespace {

Cell end_cell(const CaptureEnd& end) {
  const auto& readings = end.result.readings;
  std::size_t doubts = 0;
  std::string remarks;
  for (const auto& [key, value] : end.result.metadata) {
    doubts += key == "in doubt" ? 1U : 0U;
    if (key == "left out" || key == "in doubt") remarks += fmt::format("  {}: {}\n", key, value);
  }
  return record_cell(end.complete ? "{readings} of {targets} planned readings written to {output}\n{remarks}"
                                  : "ended early: {kept}\n",
                     "complete"_is(end.complete), "output"_is(text_cell(end.file)),
                     "part"_is(end.complete || readings.empty() ? null_cell() : Cell{end.part, {}}),
                     "targets"_is(end.targets, fmt::format("{}", end.targets)), "readings"_is(readings.size()),
                     "left_out"_is(end.skipped), "in_doubt"_is(doubts), "runs"_is(end.runs),
                     "duration_s"_is(readings.empty() ? null_cell() : Cell{number_or_null(readings.back().time_s), {}}),
                     "unplugged"_is(end.unplugged), "remarks"_shown(remarks), "kept"_shown(end.kept));
}

Result<Outcome> capture_verb(VerbContext& context, const CaptureChoice& choice) {
  ECS_TRY(end, capture(context.console, context.console.keyboard(), choice));
  return outcome_of(end_cell(end), end.complete ? kDone : kDoesNotHold);
}

constexpr std::chrono::milliseconds kWatchStep{20};

struct DevicesRequest : LearnChoice {
  std::vector<std::string> descriptions;
  bool learn = false, udev = false;
  std::string output, trying, describe;
  int count = 1;
  static Fields<DevicesRequest> fields() {
    using R = DevicesRequest;
    return {{"DESCRIPTION", &R::descriptions, "device descriptions for which --udev also prints rules"},
            {"--learn", &R::learn, "find the bit that changes while a trigger is pressed"},
            {"-o,--output", &R::output, "description to write (--learn)", Is::output},
            {"--device", &R::device, "use only this path, serial number or vendor:product (--learn)"},
            {"--name", &R::name, "name of the device (--learn)"},
            {"--presses", &R::presses, "number of presses (--learn)", Range{2, 20}},
            {"--try", &R::trying, "show the data of a device: DEVICE.toml[@SERIAL], or temper"},
            {"--count", &R::count, "number of values or presses (--try)", Range{1, 1'000'000}},
            {"--timeout", &R::timeout_s, "time limit [s] (--learn and --try)", Range{0.1, 86400.0}},
            {"--describe", &R::describe, "print a description included with the program, as TOML"},
            {"--udev", &R::udev, "print udev rules that permit access, to be saved as /etc/udev/rules.d/70-ecs.rules"}};
  }
};

std::string hex(std::uint16_t value) { return fmt::format("0x{:04x}", value); }

std::string builtin_for(const devices::HidIdentity& identity) {
  for (const devices::DeviceDescription& device : devices::builtin_devices())
    if (devices::matching(device, {identity})) return device.name;
  return {};
}

Json lengths(const std::map<std::uint8_t, std::size_t>& reports) {
  Json out = Json::object();
  for (const auto& [number, bytes] : reports) out[std::to_string(number)] = bytes;
  return out;
}

Cell device_cell(const devices::HidIdentity& one) {
  const auto opened = devices::HidDevice::open(one);
  const std::string known = builtin_for(one);
  std::string inputs;
  for (const auto& [number, bytes] : one.reports.input)
    inputs += number == 0 ? fmt::format(", input reports of {} bytes", bytes)
                          : fmt::format(", input report {} of {} bytes", number, bytes);
  return record_cell(
      "{path}\n  usage page {usage_page}, usage {usage}{input_reports}\n{described_by}{hindrance}",
      "path"_is(one.path, devices::to_text(one)), "vendor_id"_is(hex(one.vendor_id)),
      "product_id"_is(hex(one.product_id)), "serial"_is(text_cell(one.serial)),
      "manufacturer"_is(text_cell(one.manufacturer)), "product"_is(text_cell(one.product)),
      "interface"_is(one.interface >= 0 ? cell_of(one.interface) : null_cell()), "usage_page"_is(hex(one.usage_page)),
      "usage"_is(hex(one.usage)), "input_reports"_is(lengths(one.reports.input), inputs),
      "feature_reports"_is(lengths(one.reports.feature)),
      "described_by"_is(text_or_null(known), known.empty() ? "" : fmt::format("  known: --environment {}\n", known)),
      "usable"_is(opened.has_value()),
      "hindrance"_is(opened ? null_cell()
                            : Cell{opened.error().message, fmt::format("  {}\n", opened.error().message)}));
}

Result<Outcome> list() {
  ECS_TRY(present, devices::hid_devices());
  Cell list = list_cell(present, device_cell);
  if (present.empty()) list.text = "no HID device is plugged in (or the kernel has no hidraw)\n";
  return outcome_of(record_cell("{devices}", "devices"_is(list)));
}

Result<Outcome> rules(const DevicesRequest& request) {
  std::vector<devices::DeviceDescription> devices = devices::builtin_devices();
  for (const std::string& file : request.descriptions) {
    ECS_TRY(more, described(file));
    devices.insert(devices.end(), more.begin(), more.end());
  }
  const std::string text = devices::udev_rules(devices);
  return Outcome{text, one_line(object_of("rules"_is(text), "file"_is("/etc/udev/rules.d/70-ecs.rules"))), kDone};
}

Result<Outcome> learn(VerbContext& context, const DevicesRequest& request) {
  if (request.output.empty())
    return problem(ProblemKind::usage, "-o FILE.toml is missing: the file for the description");
  ECS_TRY(found, learn_device(context.console, context.console.keyboard(), request));
  const std::string toml = devices::to_toml(found.description);
  ECS_DO(write_file(request.output, toml));
  const devices::TriggerLayout& trigger = found.description.trigger;
  return outcome_of(record_cell("{toml}\nwritten to {output}; longest bounce seen {bounce_ms} ms\n", "toml"_shown(toml),
                                "output"_is(request.output), "name"_is(found.description.name), "byte"_is(trigger.byte),
                                "mask"_is(trigger.mask), "active"_is(trigger.active_high ? "high" : "low"),
                                "debounce_ms"_is(trigger.debounce_ms), "bounce_ms"_is(found.bounce_ms, 0)));
}

Result<Outcome> try_trigger(VerbContext& context, const DevicesRequest& request, devices::DevicePort port) {
  devices::Trigger trigger(std::move(port));
  context.console.note(
      fmt::format("press {} {} time{}", trigger.port().device().name, request.count, request.count == 1 ? "" : "s"));
  const double begin_s = steady_s();
  int seen = 0;
  while (seen < request.count && !interrupted() && steady_s() - begin_s < request.timeout_s) {
    if (trigger.pressed(kWatchStep, steady_s()))
      context.console.note(fmt::format("press {} after {:.2f} s", ++seen, steady_s() - begin_s));
    if (trigger.look(steady_s()) == devices::PortChange::lost)
      return problem(ProblemKind::link, "{} was unplugged", name_of(trigger.port()));
  }
  if (seen < request.count)
    return problem(ProblemKind::refused,

                   "{} of {} presses were seen within {} s: check [trigger]; `ecs laser devices --learn` finds the bit",
                   seen, request.count, request.timeout_s);
  return outcome_of(record_cell("{presses} presses\n", "presses"_is(seen)));
}

Json values_json(const devices::Values& values) {
  Json out = Json::object();
  for (const auto& [quantity, value] : values) out[std::string(devices::name_of(quantity))] = number_or_null(value);
  return out;
}

Result<Outcome> try_sensor(VerbContext& context, const DevicesRequest& request, devices::DevicePort port) {
  constexpr double kPause_s = 1.0;
  devices::Sensor sensor(std::move(port), kPause_s);
  const double begin_s = steady_s();
  int seen = 0;
  Json answers = Json::array();
  std::string text;
  while (seen < request.count && !interrupted() && steady_s() - begin_s < request.timeout_s) {
    sensor.attend(steady_s());
    if (sensor.look(steady_s()) == devices::PortChange::lost)
      return problem(ProblemKind::link, "{} was unplugged", name_of(sensor.port()));
    if (sensor.answers() > seen) {
      seen = sensor.answers();
      const devices::Values values = sensor.values(steady_s(), kPause_s);
      answers.push_back(values_json(values));
      text += around_text(values) + "\n";
      context.console.note(around_text(values));
    }
    std::this_thread::sleep_for(kWatchStep);
  }
  if (seen < request.count)
    return problem(ProblemKind::refused,

                   "{} gave a value {} times of {} within {} s: check its description and that its probe is plugged in",
                   name_of(sensor.port()), seen, request.count, request.timeout_s);
  return Outcome{text, one_line(object_of("answers"_is(answers))), kDone};
}

Result<Outcome> try_device(VerbContext& context, const DevicesRequest& request) {
  const auto devices = described(request.trying);
  if (!devices) return tl::unexpected(devices.error());
  const devices::DeviceKind kind = devices->front().kind;
  ECS_TRY(port, opened_device(request.trying, kind));
  return kind == devices::DeviceKind::trigger ? try_trigger(context, request, std::move(port))
                                              : try_sensor(context, request, std::move(port));
}

Result<Outcome> describe(const DevicesRequest& request) {
  const auto devices = devices::builtin_named(request.describe);
  if (devices.empty()) {
    std::string names;
    for (const devices::DeviceDescription& one : devices::builtin_devices())
      names += (names.empty() ? "" : ", ") + one.name;
    return problem(ProblemKind::usage, "--describe: expected one of {}, got \"{}\"", names, request.describe);
  }
  std::string text;
  for (const devices::DeviceDescription& device : devices) {
    text += (text.empty() ? "" : "\n") + devices::to_toml(device);
    for (std::size_t k = 1; k < device.match.ids.size(); ++k)
      text += fmt::format("# the same: vendor_id = 0x{:04x}, product_id = 0x{:04x}\n", device.match.ids[k].vendor_id,
                          device.match.ids[k].product_id);
  }
  return Outcome{text, one_line(object_of("toml"_is(text))), kDone};
}

Result<Outcome> devices(VerbContext& context, const DevicesRequest& request) {
  if (request.udev) return rules(request);
  if (request.learn) return learn(context, request);
  if (!request.trying.empty()) return try_device(context, request);
  if (!request.describe.empty()) return describe(request);
  return list();
}

}  // namespace

const std::vector<Action> kLaserCapturing{
    action("laser capture", "guide through the targets of a measurement, forward and back, and record its readings",
           "ecs laser capture --axis X --sense EX --from 0 --to 500 --step 50 --runs 3 -o exx.csv\n  ecs laser capture "
           "--plan plan.toml --row EYX --trigger foot_switch.toml --gauge gauge.toml --environment temper -o EYX.csv\n "
           " ecs laser capture --resume EXX.csv.part --trigger foot_switch.toml --gauge gauge.toml",
           capture_verb, {.logged = Logged::when_written, .kind = "measurement", .live = true}),
    action("laser devices",
           "list the USB devices (HID) for capture; learn the signal of a trigger, try a device, or write its access "
           "rules (udev)",
           "ecs laser devices\n  ecs laser devices --learn -o foot_switch.toml\n  ecs laser devices --try temper\n  "
           "ecs laser devices --udev foot_switch.toml",
           devices, {.live = true})};

/// Readings taken with the machine, and sensors beside it.
const Module& capture_module() {
  static const Module module{.verbs = {{"laser", &kLaserCapturing}},
                             .synonyms = {{"laser capture", "measure readings record interferometer"}},
                             .surroundings = commissioning::environment_watch};
  return module;
}

}  // namespace ecs::app
