// One action on a machine without a unit.
#include <nlohmann/json.hpp>

#include "ecs_emulator/verbs/interrupt.hpp"
#include "ecs_emulator/verbs/machine_arguments.hpp"
#include "ecs_emulator/verbs/request_verb.hpp"
#include "ecs_emulator/workshop/serve.hpp"
#include "ecs_emulator/workshop/workshop.hpp"

namespace ecs::emulator {
namespace {

struct AloneArguments {
  MachineArguments machine;
  nlohmann::json request;
};

Result<Outcome> act_alone(const AloneArguments& arguments) {
  const auto& [machine, errors, seed] = arguments.machine;
  nlohmann::json request = arguments.request;
  const bool force = force_in(request);
  ECS_DO(spared_by(request, force));
  ECS_TRY(simulation, simulation_for(machine, errors, seed));
  stop_on_signals();
  simulation.on_pause([] { return stop_requested() == 0; });
  return printed(perform({&simulation, nullptr, nullptr}, request.dump(), show_progress));
}

VerbDefinition without_unit(const std::string& name, std::string help, const std::string& example,
                            void (*declare)(RequestVerb)) {
  return {name, std::move(help), "ecs-emulator " + name + " --machine machine.toml " + example,
          [name, declare](Verb& verb) -> Action {
            const auto arguments = std::make_shared<AloneArguments>();
            arguments->request["action"] = name;
            arguments->machine.declare(verb);
            declare(RequestVerb(verb, arguments->request));
            return [arguments](VerbContext& /*context*/) { return act_alone(*arguments); };
          }};
}

}  // namespace

const std::vector<VerbDefinition>& verbs_without_unit() {
  static const std::vector<VerbDefinition> verbs{
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

}  // namespace ecs::emulator
