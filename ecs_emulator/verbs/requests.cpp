// Requests as verbs: their options, of a machine without a unit, and to a running server (docs/emulator.md).
#include "ecs_emulator/verbs/requests.hpp"

#include <cctype>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/outcome.hpp"
#include "ecs_emulator/instruments/files.hpp"
#include "ecs_emulator/unit/workshop_socket.hpp"
#include "ecs_emulator/workshop/serve.hpp"
#include "ecs_emulator/workshop/workshop.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;
using enum OptionKind;

const RequestOption kForceOption{"--force", flag, "overwrite existing output files"};
const RequestOption kReversedOption{"--reversed", integer,
                                    "square or straight edge: 1 turned over, 0 not; written as a column"};
/// Of the instrument.
const std::vector<RequestOption> kSettings{
    {"--air", word, "correction for air: off, manual or automatic"},
    {"--material", word, "correction for material temperature: off, manual or automatic"},
    {"--material-temperature", number, "material temperature entered at the laser [degC]"},
    {"--dead-path", number, "dead path [m]"},
    {"--misalignment", number, "angle between beam and axis [mrad]"},
    {"--trigger-latency", number, "latency of the trigger for readings on the fly [s]"},
};

std::vector<RequestOption> with_settings(std::vector<RequestOption> before, const std::vector<RequestOption>& after) {
  for (const auto& more : {kSettings, after}) before.insert(before.end(), more.begin(), more.end());
  return before;
}

const std::vector<RequestOption> kMeasureOptions = with_settings(
    {
        {"--axis", word, "moving axis", Need::required},
        {"--sense", word, "measured component", Need::required},
        {"--from", number, "first target [mm]"},
        {"--to", number, "last target [mm]"},
        {"--step", number, "step between targets [mm]"},
        {"--targets", numbers, "target positions, separated by commas [mm]"},
        {"--moved", flag, "space the targets unequally, as ISO 230-2 requires"},
        {"--runs", integer, "number of runs"},
        {"--unidirectional", flag, "measure in one direction only"},
        {"--parked", coordinates, "positions of the other axes, as in y=-700,z=0"},
        {"--feed", number, "feed [mm/min]"},
        {"--dwell", number, "dwell before each reading [s]"},
        {"--overrun", number, "travel beyond the end targets [mm]"},
        {"--on-the-fly", flag, "take readings during the motion"},
        {"--instrument", word, "linear, straightness, angular, level or square"},
    },
    {
        kReversedOption,
        {"--beam-broken-at", integer, "number of the reading before which the beam is interrupted"},
        {"--date", word, "date in the metadata"},
        {"--engineer", word, "engineer in the metadata"},
        {"--plan-name", word, "name of the measurement in the plan, for the metadata"},
        {"-o,--output", paths, "files: .csv, .rtl, .rta, .rts, .ren, .pos, .dat, .env.pos"},
        kForceOption,
    });
const std::vector<RequestOption> kCaptureOptions = with_settings(
    {
        {"--axis", word, "moving axis", Need::required},
        {"--sense", word, "measured component", Need::required},
        {"--rate", number, "sample rate [Hz] (1000)"},
        {"--seconds", number, "duration [s] (10)"},
        {"--to", number, "position to which the axis moves [mm]"},
        {"--feed", number, "feed [mm/min]"},
        {"--instrument", word, "linear, straightness, angular, level or square"},
    },
    {
        {"--date", word, "date in the metadata"},
        {"--engineer", word, "engineer in the metadata"},
        {"-o,--output", paths, "files: .csv, .rtx"},
        kForceOption,
    });
const std::vector<RequestOption> kSurveyOptions{
    {"--step", number, "step of the grid [mm] (250)"},
    {"--approach", integer, "side from which every axis approaches a point: 1 or -1 (1)"},
    {"--with-scatter", flag, "include the scatter"},
    {"-o,--output", path, "CSV file to write"},
    kForceOption,
};
const std::vector<RequestOption> kComponentsOptions{
    {"--x", numbers, "positions of X, separated by commas [mm]"},
    {"--y", numbers, "positions of Y, separated by commas [mm]"},
    {"--z", numbers, "positions of Z, separated by commas [mm]"},
    {"--a", numbers, "angles of A, separated by commas [deg]"},
    {"--b", numbers, "angles of B, separated by commas [deg]"},
    {"--c", numbers, "angles of C, separated by commas [deg]"},
};
const std::vector<RequestOption> kCircleOptions{
    {"--plane", word, "plane: XY, YZ, ZX, or the axes in the other order; the angle rises from the first to the second",
     Need::required},
    {"--centre", coordinates, "centre, as in x=200,y=300; default: the middle of the travel"},
    {"--radius", number, "radius [mm] (100)"},
    {"--feed", number, "feed [mm/min] (1000)"},
    {"--start", number, "start angle [deg] (0)"},
    {"--overlap", number, "overlap before and after each turn [deg] (45)"},
    {"--step", number, "angle between readings [deg] (1)"},
    {"--runs", integer, "number of runs, each one turn in both directions (2)"},
    {"--noise", number, "standard deviation of the ball bar [um] (0.1)"},
    {"-o,--output", path, "circle file (modules/standards/README.md)"},
    kForceOption,
};
const std::vector<RequestOption> kLengthsOptions{
    {"PLAN", path, "plan of lengths (.csv, modules/lengths/README.md)", Need::required},
    {"--noise", number, "standard deviation of a reading [um] (0.2)"},
    {"--scale", number, "standard deviation of the scale of each set-up [um/m] (0.1)"},
    {"--station", number, "standard deviation of each coordinate of a station [mm] (0.2)"},
    {"--tool", number, "standard deviation of each coordinate of the tool offset from that in the plan [mm] (0.05)"},
    {"--zero", number, "standard deviation of the offset of the lengths in each run [um] (100)"},
    {"--bar", number, "standard deviation of a ball bar's length if the plan has bar_um [um] (1)"},
    {"--no-scatter", flag, "omit the non-repeatable part of the machine errors"},
    {"-o,--output", path, "file for the plan with its readings (.csv)"},
    kForceOption,
};
const std::vector<RequestOption> kRunOptions{
    {"PROGRAM", path, "part program (docs/unit.md)", Need::required},
    {"--axis", word, "axis whose component every M08 reads"},
    {"--sense", word, "EX, EY, EZ, EA, EB or EC"},
    {"--instrument", word, "linear, straightness, angular, level or square"},
    kReversedOption,
    {"-o,--output", paths, "file for the readings; the format follows from the name, as with measure"},
    {"--trace", path, "file for the path, sample by sample (.csv)"},
    {"--trace-period", number, "time between samples [s] (0.001); 0: every tick"},
    {"--date", word, "date in the metadata"},
    {"--engineer", word, "engineer in the metadata"},
    kForceOption,
};
const std::vector<RequestOption> kBallOptions{
    {"--ball", numbers, "X,Y,Z at which the linear axes touch the ball, all rotary axes at 0 [mm]"},
    {"--sweep", words, "turning axis from:to:step and position of another axis, as in C=0:330:30/A=-60"},
    {"--tool-offset", numbers, "X,Y,Z from the point to which the errors apply to the ball in the spindle [mm]"},
    {"--off", numbers, "X,Y,Z by which the ball is off its position on the table [um]"},
    {"--tool-off", numbers, "X,Y,Z by which the ball in the spindle is off its position [um]"},
    {"--on-workpiece", flag, "sensors on the workpiece: they turn with the table"},
    {"--runs", integer, "number of runs, each there and back (2)"},
    {"--noise", number, "standard deviation of a reading [um] (0.3)"},
    {"--seconds", number, "time from one pose to the next [s] (5)"},
    {"-o,--output", path, "measurement file to write (.csv); if not given, it is returned as csv"},
    kForceOption,
};
const std::vector<RequestOption> kTurnOptions{
    {"--sweep", word, "turning axis from:to:step [deg], as in C=0:330:30", Need::required},
    {"--sense", word, "EX, EY, EZ (um), EA, EB, EC (um/m)", Need::required},
    {"--runs", integer, "number of runs, each there and back (3)"},
    {"--noise", number, "standard deviation of a reading [um, um/m] (0.3)"},
    {"--seconds", number, "time from one target to the next [s] (5)"},
    {"-o,--output", path, "measurement file to write (.csv); if not given, it is returned as csv"},
    kForceOption,
};
const std::vector<RequestOption> kJogOptions{
    {"--x,-x", number, "position to which X moves, machine coordinates [mm]", Need::optional, "X"},
    {"--y,-y", number, "position to which Y moves, machine coordinates [mm]", Need::optional, "Y"},
    {"--z,-z", number, "position to which Z moves, machine coordinates [mm]", Need::optional, "Z"},
    {"--a", number, "angle to which A turns [deg]", Need::optional, "A"},
    {"--b", number, "angle to which B turns [deg]", Need::optional, "B"},
    {"--c", number, "angle to which C turns [deg]", Need::optional, "C"},
    {"--feed", number, "feed [mm/min]; default: rapid traverse"},
};
const std::vector<RequestOption> kFaultOptions{
    {"NAME", word,
     "ram_stuck, corrupt, overrun, hang, power_fails or battery (unit); sensor (a temperature input) or deviation (the "
     "instrument that shows the unit a deviation gives no signal); transducer, marker, switch or miscount (axis); "
     "no_reply, lost_request, bad_crc, slow_reply, garbage_before, drop_byte, cut_tail or "
     "stale_reply (line); clear: remove every fault",
     Need::required},
    {"--address", integer, "address in the unit's memory, for ram_stuck and corrupt"},
    {"--bit", integer, "stuck bit, 0 to 7, for ram_stuck (0)"},
    {"--level", integer, "level of the stuck bit or switch, 0 or 1, for ram_stuck and switch (1)"},
    {"--bits", integer, "mask of the inverted bits, 1 to 255, for corrupt (1)"},
    {"--axis", word, "axis, for transducer, marker, switch and miscount"},
    {"--back", flag, "remove the fault again, for transducer, marker, switch, sensor, deviation and battery"},
    {"--us", number, "additional time in each period, for overrun [us] (1000000)"},
    {"--input", integer, "temperature input, from 1 on, for sensor (1)"},
    {"--how", word, "failure of the sensor: open, stuck or shifted"},
    {"--by", number, "shift of the sensor, for shifted [degC] (0)"},
    {"--count", integer,
     "number of faulty transactions (line), of slow periods (overrun; 0: all), of additional counts (miscount), or of "
     "bytes that are still written to axis memory (power_fails)"},
    {"--probability", number, "probability of a fault in each transaction of the line, 0 to 1, instead of --count"},
    {"--slow-ms", number, "delay of each slow_reply [ms]"},
};

Json coordinates_in(const std::vector<std::string>& texts) {
  Json place = Json::object();
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    std::string name = text.substr(0, equals);
    for (char& letter : name) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    const Json value = equals == std::string::npos ? Json() : Json::parse(text.substr(equals + 1), nullptr, false);
    place[name] = value.is_discarded() ? Json(text.substr(equals + 1)) : value;
  }
  return place;
}

std::string absolute(const std::string& path) { return std::filesystem::absolute(path).string(); }

/// "-o,--output" → output
std::string key_of(const RequestOption& option) {
  if (option.key != nullptr) return option.key;
  std::string name(option.option);
  name.erase(0, name.rfind(',') + 1);
  name.erase(0, name.find_first_not_of('-'));
  for (char& c : name) c = c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

/// The kind of problem that ends the program with this code.
ProblemKind kind_of(int exit_code) {
  for (const ProblemKind kind : {ProblemKind::refused, ProblemKind::usage, ProblemKind::bad_input, ProblemKind::link})
    if (exit_code_of(kind) == exit_code) return kind;
  return ProblemKind::output;
}

/// Whether --force was given; the request itself does not hold it any more.
bool force_in(Json& request) { return request.erase("force") > 0; }

/// A `usage` problem if the request writes to a file that is there, unless `force`.
Result<void> spared_by(const Json& request, bool force) {
  std::vector<std::string> files;
  for (const char* key : {"output", "trace"}) {
    if (!request.contains(key)) continue;
    if (request[key].is_string()) files.push_back(request[key]);
    if (request[key].is_array())
      for (const Json& file : request[key]) files.push_back(file);
  }
  return spared(files, force);
}

/// Prints the answer of a workshop on stdout; what it refused is the problem.
Result<Outcome> printed(const std::string& answer) {
  const Json parsed = Json::parse(answer, nullptr, false);
  if (parsed.is_object() && parsed.value("ok", false)) {
    fmt::print("{}\n", answer);
    return Outcome{};
  }
  if (!parsed.is_object() || !parsed.contains("error"))
    return problem(ProblemKind::link, "expected one JSON object from the workshop, got {}", answer);
  return problem(kind_of(parsed.value("exit", 5)), parsed["error"].value("message", answer));
}

/// Draws the progress of a request on a terminal. @param line  {"progress": 0.25}
void show_progress(const std::string& line) {
  if (isatty(STDERR_FILENO) == 0) return;
  const Json parsed = Json::parse(line, nullptr, false);
  const double part = parsed.is_object() ? parsed.value("progress", 0.0) : 0.0;
  const int at = parsed.is_object() ? parsed.value("line", 0) : 0;
  fmt::print(stderr, "\r{:3.0f} %{}{}", part * 100.0, at > 0 ? fmt::format("  line {:<8}", at) : "",
             part >= 1.0 ? "\n" : "");
}

struct AloneRequest {
  MachineArguments machine;
  Json request;
};

Result<Outcome> act_alone(const std::string& name, const AloneRequest& asked) {
  const auto& [machine, errors, seed] = asked.machine;
  Json request = asked.request;
  request["action"] = name;
  const bool force = force_in(request);
  ECS_DO(spared_by(request, force));
  ECS_TRY(simulation, simulation_for(machine, errors, seed));
  stop_on_signals();
  simulation.on_pause([] { return stop_requested() == 0; });
  return printed(perform({&simulation, nullptr, nullptr}, request.dump(), show_progress));
}

Action without_unit(const std::string& name, std::string help, const std::string& example,
                    const std::vector<RequestOption>& options) {
  return cli::action<VerbContext, AloneRequest, Outcome>(
      name, std::move(help), "ecs-emulator " + name + " --machine machine.toml " + example,
      [name](VerbContext& /*context*/, const AloneRequest& asked) { return act_alone(name, asked); }, {},
      [options] {
        return Fields<AloneRequest>{&AloneRequest::machine, request_fields(&AloneRequest::request, options)};
      });
}

}  // namespace

const std::vector<Action>& verbs_without_unit() {
  static const std::vector<Action> verbs{
      without_unit("measure", "measure a machine without a unit",
                   "--axis X --sense EX --from 0 --to -4100 --step 50 -o exx.csv", kMeasureOptions),
      without_unit("capture", "record an instrument's display at a constant rate, on a machine without a unit",
                   "--axis X --sense EX --seconds 10 -o run.rtx", kCaptureOptions),
      without_unit("survey", "compute the true volumetric error of a machine; no unit is needed",
                   "--step 500 -o survey.csv", kSurveyOptions),
      without_unit("components", "compute the true error components along the axes of a machine; no unit is needed",
                   "--x 0,500,1000 --y 0,100", kComponentsOptions),
      without_unit("circle", "make a circular test (ISO 230-4) of a machine without a unit",
                   "--plane XY --radius 100 --feed 1000 -o circle.csv", kCircleOptions),
      without_unit("lengths", "measure the lengths of a plan: from stations to the tool, or along lines",
                   "plan.csv -o lengths.csv", kLengthsOptions),
      without_unit("ball", "measure a ball on the table of a machine with rotary axes, without a unit",
                   "--ball 750,300,-500 -o ball.csv", kBallOptions),
      without_unit("turn", "measure one error motion of a rotary axis, without a unit",
                   "--sweep C=0:345:15 --sense EC -o ecc.csv", kTurnOptions),
      without_unit("run", "run a part program on a machine without a unit", "exx.nc --axis X --sense EX -o exx.csv",
                   kRunOptions),
  };
  return verbs;
}

namespace {

Result<Outcome> ask(const VerbContext& context, const std::string& request) {
  const auto answer = ask_workshop(context.workshop, request, show_progress);
  return answer ? printed(*answer) : tl::unexpected(answer.error());
}

/// A verb that sends one request: its name is the action.
struct WorkshopRequest {
  Json request;
};
Action request(const std::string& name, std::string help, const std::string& example,
               const std::vector<RequestOption>& options) {
  return cli::action<VerbContext, WorkshopRequest, Outcome>(
      "workshop " + name, std::move(help), "ecs-emulator workshop shop.sock " + example,
      [name](VerbContext& context, const WorkshopRequest& asked) -> Result<Outcome> {
        Json request = asked.request;
        request["action"] = name;
        const bool force = force_in(request);
        ECS_DO(spared_by(request, force));
        return ask(context, request.dump());
      },
      {}, [options] { return request_fields(&WorkshopRequest::request, options); });
}

struct PlanRequest {
  std::string plan, folder;
  bool force = false;
  PlanChoice choice;
  static Fields<PlanRequest> fields() {
    using R = PlanRequest;
    using C = PlanChoice;
    const auto of_choice = [](const char* name, auto C::*member, const char* help, auto... more) {
      return Fields<R>(&R::choice, Fields<C>(name, member, help, more...));
    };
    return {{"PLAN", &R::plan, "plan file (TOML)", Need::required},
            of_choice("--phase", &C::phase, "measure the rows of this phase and those of both",
                      Words{"before", "after"}, Need::required),
            {"-o,--output", &R::folder, "folder for the files", Need::required},
            {"--force", &R::force, "overwrite existing files"},
            of_choice("--moved", &C::moved, "space the targets unequally, as ISO 230-2 requires"),
            of_choice("--date", &C::date, "date in the metadata"),
            of_choice("--engineer", &C::engineer, "engineer in the metadata")};
  }
};

/// Every measurement of a plan, one after the other; the first that fails ends it.
Result<Outcome> follow_plan(VerbContext& context, const PlanRequest& arguments) {
  PlanChoice choice = arguments.choice;
  choice.folder = std::filesystem::absolute(arguments.folder);
  disc::make_folders(choice.folder);
  ECS_TRY(requests, requests_of(arguments.plan, choice));
  for (const std::string& request : requests)  // all of them before the first is measured
    ECS_DO(spared_by(Json::parse(request), arguments.force));
  for (const std::string& request : requests)
    if (auto answered = ask(context, request); !answered) return answered;
  return Outcome{};
}

}  // namespace

const std::vector<Action>& workshop_verbs() {
  static const std::vector<Action> verbs{
      request("state", "show positions, unit, time and counters", "state", {}),
      request("jog", "move axes", "jog --x -100 --y 50 --feed 2000", kJogOptions),
      request("reference", "run the reference sequence of the control for all axes, or for --axes",
              "reference --axes X", {{"--axes", words, "axes, separated by commas; default: all"}}),
      request("measure", "measure a line", "measure --axis X --sense EX --from 0 --to -4100 --step 50 -o exx.csv",
              kMeasureOptions),
      request("run", "run a part program", "run exx.nc --axis X --sense EX -o exx.csv", kRunOptions),
      request("mdi", "run one block of a part program", "mdi \"G01 X-100 F2000\"",
              {{"BLOCK", word, "one block: \"G01 X-100 F2000\"", Need::required}}),
      request("capture", "record the display at a constant rate", "capture --axis X --sense EX --seconds 10 -o run.rtx",
              kCaptureOptions),
      request("circle", "make a circular test (ISO 230-4) with a ball bar",
              "circle --plane XY --radius 100 -o circle.csv", kCircleOptions),
      request("ball",
              "measure a ball on the table of a machine with rotary axes, with machine and unit as they are now",
              "ball --ball 750,300,-500 -o ball.csv", kBallOptions),
      request("survey", "compute the true volumetric error at the corners and on a grid",
              "survey --step 500 -o survey.csv", kSurveyOptions),
      request("tool", "show the true error of the tool now, against its commanded position", "tool", {}),
      request("power", "operate the mains switch of the unit: off, on or cycle", "power cycle",
              {{"STATE", word, "off, on or cycle", Need::required}}),
      request("wait", "advance the simulated time", "wait 3600",
              {{"SECONDS", number, "simulated time [s]", Need::required}}),
      request("tick", "run a number of periods of the unit's loop", "tick 1000",
              {{"COUNT", integer, "number of periods", Need::required}}),
      request("load", "load a workpiece on the table", "load 500",
              {{"KG", number, "mass of the workpiece [kg]", Need::required}}),
      request("change-tool", "put a tool from the magazine into the spindle", "change-tool 3",
              {{"NUMBER", integer, "number of the tool; 0: none", Need::required}}),
      request("control", "switch the control and its drives on or off", "control off",
              {{"STATE", word, "on or off", Need::required}}),
      request("arm-code", "show the arming code of the unit", "arm-code", {}),
      request("fault", "cause the fault with this name", "fault ram_stuck --address 0x100000 --bit 3", kFaultOptions),
  };
  return verbs;
}

extern const Action kPlan = action("workshop plan", "make every measurement of a plan",
                                   "ecs-emulator workshop shop.sock plan PLAN.toml --phase before -o DIR", follow_plan);

cli::Argument argument_of(const RequestOption& option) {
  cli::Argument argument{option.option, {}, option.help, option.need};
  argument.by_commas = option.kind == numbers || option.kind == words || option.kind == coordinates;
  return argument;
}

cli::Argument::Target target_of(Json& request, const RequestOption& option) {
  const auto take = [&request, key = key_of(option)](const auto& value) { request[key] = value; };
  switch (option.kind) {
    case number:
      return cli::OnNumber(take);
    case integer:
      return cli::OnInteger(take);
    case word:
      return cli::OnText(take);
    case flag:
      return cli::OnFlag([take] { take(true); });
    case numbers:
      return cli::OnNumbers(take);
    case words:
      return cli::OnTexts(take);
    case coordinates:
      return cli::OnTexts([take](const auto& texts) { take(coordinates_in(texts)); });
    case path:
      return cli::OnText([take](const auto& text) { take(absolute(text)); });
    case paths:
      break;
  }
  return cli::OnTexts([take](const auto& texts) {
    Json list = Json::array();
    for (const std::string& text : texts) list.push_back(absolute(text));
    take(list);
  });
}

}  // namespace ecs::emulator
