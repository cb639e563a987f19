#include "ecs_emulator/workshop/verbs.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "ecs_emulator/command_line/request_verb.hpp"
#include "ecs_emulator/part_programs/verb.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;

void add_jog_options(RequestVerb verb) {
  verb.number("--x,-x", "X");
  verb.number("--y,-y", "Y");
  verb.number("--z,-z", "Z");
  verb.number("--feed", "feed");
}

/// Of the instrument.
void add_settings(RequestVerb& verb) {
  verb.word("--air", "air", "off, manual or automatic");
  verb.word("--material", "material", "off, manual or automatic");
  verb.number("--material-temperature", "material_temperature", "entered, degC");
  verb.number("--dead-path", "dead_path", "m");
  verb.number("--misalignment", "misalignment", "between beam and axis, mrad");
  verb.number("--trigger-latency", "trigger_latency", "of readings on the fly, s");
}

void add_fault_options(RequestVerb verb) {
  verb.word("name", "name")->required();
  verb.whole("--address", "address");
  verb.whole("--bit", "bit");
  verb.whole("--level", "level");
  verb.whole("--bits", "bits");
  verb.word("--axis", "axis");
  verb.flag("--back", "back");
  verb.number("--us", "us");
  verb.whole("--count", "count");
  verb.number("--probability", "probability");
  verb.number("--slow-ms", "slow_ms");
}

}  // namespace

void add_workshop_verbs(CLI::App& app, Json& request) {
  const auto add = [&](const char* name, const char* help) -> CLI::App& {
    return *add_request_verb(app, request, name, help);
  };
  const auto verb = [&](const char* name, const char* help) { return RequestVerb(add(name, help), request); };
  add("state", "where everything stands");
  add_jog_options(verb("jog", "move axes: jog --x -100 --y 50 [--feed 2000]"));
  verb("reference", "run the controller's reference sequence, all axes or --axes X").words("--axes", "axes");
  add_measure_options(add("measure", "measure: measure --axis X --sense EX --from 0 --to -4100 --step 50 -o exx.csv"),
                      request);
  add_run_options(add("run", "run a part program: run exx.nc --axis X --sense EX -o exx.csv"), request);
  add_mdi_options(add("mdi", "one block of a part program: mdi \"G01 X-100 F2000\""), request);
  add_capture_options(
      add("capture", "the display at a constant rate: capture --axis X --sense EX --seconds 10 -o run.rtx"), request);
  add_survey_options(add("survey", "true volumetric error: corners and grid"), request);
  verb("power", "the unit's mains switch: power off | on | cycle").word("state", "state")->required();
  verb("wait", "let simulated time pass: wait 3600").number("seconds", "seconds")->required();
  verb("tick", "run so many periods of the unit's loop: tick 1000").whole("count", "count")->required();
  verb("load", "put a workpiece on the table: load 500").number("kg", "kg")->required();
  add_fault_options(verb("fault", "provoke a fault by its name: fault ram_stuck --address 0x100000 --bit 3"));
}

void add_measure_options(CLI::App& app, Json& request) {
  RequestVerb verb(app, request);
  verb.word("--axis", "axis")->required();
  verb.word("--sense", "sense")->required();
  verb.number("--from", "from");
  verb.number("--to", "to");
  verb.number("--step", "step");
  verb.numbers("--targets", "targets");
  verb.whole("--runs", "runs");
  verb.flag("--unidirectional", "unidirectional");
  verb.coordinates("--parked", "parked", "for example y=-700,z=0");
  verb.number("--feed", "feed");
  verb.number("--dwell", "dwell");
  verb.number("--overrun", "overrun");
  verb.flag("--on-the-fly", "on_the_fly");
  verb.word("--instrument", "instrument");
  add_settings(verb);
  verb.whole("--beam-broken-at", "beam_broken_at", "somebody steps into the beam before this reading");
  verb.word("--date", "date");
  verb.word("--engineer", "engineer");
  verb.word("--plan-name", "plan_name");
  verb.paths("-o,--output", "output", "files: .csv, .rtl, .rta, .rts, .ren, .pos, .dat, .env.pos");
}

void add_capture_options(CLI::App& app, Json& request) {
  RequestVerb verb(app, request);
  verb.word("--axis", "axis")->required();
  verb.word("--sense", "sense")->required();
  verb.number("--rate", "rate", "Hz (1000)");
  verb.number("--seconds", "seconds", "(10)");
  verb.number("--to", "to", "mm; the axis starts to move there");
  verb.number("--feed", "feed");
  verb.word("--instrument", "instrument");
  add_settings(verb);
  verb.word("--date", "date");
  verb.word("--engineer", "engineer");
  verb.paths("-o,--output", "output", "files: .csv, .rtx");
}

void add_survey_options(CLI::App& app, Json& request) {
  RequestVerb verb(app, request);
  verb.number("--step", "step");
  verb.whole("--approach", "approach");
  verb.flag("--with-scatter", "with_scatter");
  verb.path("-o,--output", "output");
}

}  // namespace ecs::emulator
