// Requests as verbs: of a machine without a unit, and to a running server (docs/emulator.md).

#include <filesystem>

#include <nlohmann/json.hpp>

#include "ecs_emulator/instruments/files.hpp"
#include "ecs_emulator/unit/workshop_socket.hpp"
#include "ecs_emulator/verbs/request_verb.hpp"
#include "ecs_emulator/verbs/verb.hpp"
#include "ecs_emulator/workshop/serve.hpp"
#include "ecs_emulator/workshop/workshop.hpp"

namespace ecs::emulator {
namespace {

struct AloneRequest {
  MachineArguments machine;
  nlohmann::json request;
};

Result<Outcome> act_alone(const std::string& name, const AloneRequest& asked) {
  const auto& [machine, errors, seed] = asked.machine;
  nlohmann::json request = asked.request;
  request["action"] = name;
  const bool force = force_in(request);
  ECS_DO(spared_by(request, force));
  ECS_TRY(simulation, simulation_for(machine, errors, seed));
  stop_on_signals();
  simulation.on_pause([] { return stop_requested() == 0; });
  return printed(perform({&simulation, nullptr, nullptr}, request.dump(), show_progress));
}

Action without_unit(const std::string& name, std::string help, const std::string& example,
                    void (*declare)(RequestVerb)) {
  return cli::action<VerbContext, AloneRequest, Outcome>(
      name, std::move(help), "ecs-emulator " + name + " --machine machine.toml " + example,
      [name](VerbContext& /*context*/, const AloneRequest& asked) { return act_alone(name, asked); }, {},
      [declare] {
        return Fields<AloneRequest>{&AloneRequest::machine, request_fields(&AloneRequest::request, declare)};
      });
}

}  // namespace

const std::vector<Action>& verbs_without_unit() {
  static const std::vector<Action> verbs{
      without_unit("measure", "measure a machine without a unit",
                   "--axis X --sense EX --from 0 --to -4100 --step 50 -o exx.csv", add_measure_options),
      without_unit("capture", "an instrument's display at a constant rate, on a machine without a unit",
                   "--axis X --sense EX --seconds 10 -o run.rtx", add_capture_options),
      without_unit("survey", "true volumetric error of a machine without a unit", "--step 500 -o survey.csv",
                   add_survey_options),
      without_unit("components", "true error components along the axes of a machine without a unit",
                   "--x 0,500,1000 --y 0,100", add_components_options),
      without_unit("circle", "circular test (ISO 230-4) of a machine without a unit",
                   "--plane XY --radius 100 --feed 1000 -o circle.csv", add_circle_options),
      without_unit("lengths", "lengths from stations or along lines to the tool, as a plan says",
                   "plan.csv -o lengths.csv", add_lengths_options),
      without_unit("ball", "a ball on the table of a machine with rotary axes, without a unit",
                   "--ball 750,300,-500 -o ball.csv", add_ball_options),
      without_unit("turn", "an error motion of a rotary axis by itself, without a unit",
                   "--sweep C=0:345:15 --sense EC -o ecc.csv", add_turn_options),
      without_unit("run", "run a part program on a machine without a unit", "exx.nc --axis X --sense EX -o exx.csv",
                   add_run_options),
  };
  return verbs;
}

namespace {

using Json = nlohmann::json;

Result<Outcome> ask(const VerbContext& context, const std::string& request) {
  const auto answer = ask_workshop(context.workshop, request, show_progress);
  return answer ? printed(*answer) : tl::unexpected(answer.error());
}

/// A verb that sends one request: its name is the action.
struct WorkshopRequest {
  Json request;
};
Action request(const std::string& name, std::string help, const std::string& example, void (*declare)(RequestVerb)) {
  return cli::action<VerbContext, WorkshopRequest, Outcome>(
      "workshop " + name, std::move(help), "ecs-emulator workshop shop.sock " + example,
      [name](VerbContext& context, const WorkshopRequest& asked) -> Result<Outcome> {
        Json request = asked.request;
        request["action"] = name;
        const bool force = force_in(request);
        ECS_DO(spared_by(request, force));
        return ask(context, request.dump());
      },
      {}, [declare] { return request_fields(&WorkshopRequest::request, declare); });
}

void add_jog_options(RequestVerb verb) {
  verb.number("--x,-x", "X");
  verb.number("--y,-y", "Y");
  verb.number("--z,-z", "Z");
  verb.number("--feed", "feed");
}

void add_fault_options(RequestVerb verb) {
  verb.word("NAME", "name", "", Need::required);
  verb.integer("--address", "address");
  verb.integer("--bit", "bit");
  verb.integer("--level", "level");
  verb.integer("--bits", "bits");
  verb.word("--axis", "axis");
  verb.flag("--back", "back");
  verb.number("--us", "us");
  verb.integer("--count", "count");
  verb.number("--probability", "probability");
  verb.number("--slow-ms", "slow_ms");
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
    return {
        {"PLAN", &R::plan, "plan file (TOML)", Need::required},
        of_choice("--phase", &C::phase, "rows of this phase, and of both", Words{"before", "after"}, Need::required),
        {"-o,--output", &R::folder, "folder for the files", Need::required},
        {"--force", &R::force, "overwrites files that are there"},
        of_choice("--moved", &C::moved, "targets off equal steps, as ISO 230-2 asks"),
        of_choice("--date", &C::date, ""),
        of_choice("--engineer", &C::engineer, "")};
  }
};

/// Every measurement of a plan, one after the other; the first that fails ends it.
Result<Outcome> follow_plan(VerbContext& context, const PlanRequest& arguments) {
  PlanChoice choice = arguments.choice;
  choice.folder = std::filesystem::absolute(arguments.folder);
  std::error_code error;
  std::filesystem::create_directories(choice.folder, error);
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
      request("state", "positions, unit, time and counters", "state", [](RequestVerb /*verb*/) {}),
      request("jog", "move axes", "jog --x -100 --y 50 --feed 2000", add_jog_options),
      request("reference", "run the controller's reference sequence, all axes or --axes X", "reference --axes X",
              [](RequestVerb verb) { verb.words("--axes", "axes"); }),
      request("measure", "measure a line", "measure --axis X --sense EX --from 0 --to -4100 --step 50 -o exx.csv",
              add_measure_options),
      request("run", "run a part program", "run exx.nc --axis X --sense EX -o exx.csv", add_run_options),
      request("mdi", "one block of a part program", "mdi \"G01 X-100 F2000\"",
              [](RequestVerb verb) { verb.word("BLOCK", "block", "one block: \"G01 X-100 F2000\"", Need::required); }),
      request("capture", "the display at a constant rate", "capture --axis X --sense EX --seconds 10 -o run.rtx",
              add_capture_options),
      request("circle", "circular test (ISO 230-4) with a ball bar", "circle --plane XY --radius 100 -o circle.csv",
              add_circle_options),
      request("survey", "true volumetric error: corners and grid", "survey --step 500 -o survey.csv",
              add_survey_options),
      request("power", "the unit's mains switch: off, on or cycle", "power cycle",
              [](RequestVerb verb) { verb.word("STATE", "state", "", Need::required); }),
      request("wait", "let simulated time pass", "wait 3600",
              [](RequestVerb verb) { verb.number("SECONDS", "seconds", "", Need::required); }),
      request("tick", "run so many periods of the unit's loop", "tick 1000",
              [](RequestVerb verb) { verb.integer("COUNT", "count", "", Need::required); }),
      request("load", "put a workpiece on the table", "load 500",
              [](RequestVerb verb) { verb.number("KG", "kg", "", Need::required); }),
      request("arm-code", "the code that the unit shows, which a host needs to arm it", "arm-code",
              [](RequestVerb /*verb*/) {}),
      request("fault", "provoke a fault by its name", "fault ram_stuck --address 0x100000 --bit 3", add_fault_options),
  };
  return verbs;
}

extern const Action kPlan = action("workshop plan", "every measurement of a plan",
                                   "ecs-emulator workshop shop.sock plan PLAN.toml --phase before -o DIR", follow_plan);

}  // namespace ecs::emulator
