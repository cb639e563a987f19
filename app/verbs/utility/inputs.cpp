// `ecs utility inputs, input`: the live inputs of the unit with the thermal rows that follow them, and one that no
// sensor is wired to.
#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::app {
namespace {

std::string name_of_input(std::size_t input) {
  if (input == kDeviationInput) return "deviation";
  return input == kLoadInput ? "load" : std::to_string(input + 1);
}
std::string_view unit_of_input(std::size_t input) {
  if (input == kDeviationInput) return "um";
  return input == kLoadInput ? "kg" : "degC";
}

Cell input_cell(std::size_t i, const protocol::InputStatus& input) {
  const bool arrived = input.state != InputState::missing || input.value != 0.0;
  return record_cell("{input:>9}  {value:>10} {unit:<5} {state:<13} {faults:>6}  {wired}\n",
                     "input"_is(name_of_input(i)), "value"_is(arrived ? number_cell(input.value, 2) : null_cell("-")),
                     "unit"_is(unit_of_input(i)), "state"_is(name_of(input.state)), "faults"_is(input.faults),
                     "wired"_is(input.wired, "sensor", "host"));
}

Cell inputs_cell(const protocol::LiveInputs& live, const protocol::InputStatus& deviation) {
  Cell list{Json::array(), "    input       value       state         faults  from\n"};
  const auto add = [&](std::size_t i, const protocol::InputStatus& input) {
    if (input.state != InputState::unused || input.wired || input.value != 0.0) list.add(input_cell(i, input));
  };
  for (std::size_t i = 0; i < live.inputs.size(); ++i) add(i, live.inputs[i]);
  add(kDeviationInput, deviation);
  if (list.json.empty()) list.text = "no input has a sensor, a value set manually, or a thermal row in the map\n";
  return list;
}

Cell rows_cell(const protocol::LiveInputs& live) {
  if (live.rows == 0) return {0, "no thermal compensation is active\n"};
  return {
      live.rows,
      fmt::format("thermal compensation by {} row{} of the map is active: X {:+.2f}, Y {:+.2f}, Z {:+.2f} um\n",
                  live.rows, live.rows == 1 ? "" : "s", live.thermal_um[0], live.thermal_um[1], live.thermal_um[2])};
}

Result<Outcome> show_inputs(VerbContext& context, const cli::Nothing&) {
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(live, unit.client().live_inputs());
  ECS_TRY(lines, unit.client().control_lines());
  const bool stored = live.stored_age_s != protocol::kUnused;
  return outcome_of(record_cell(
      "{rows}{stored_age_s}{inputs}", "rows"_is(rows_cell(live)),
      "thermal_um"_is(Cell{Json{{"X", live.thermal_um[0]}, {"Y", live.thermal_um[1]}, {"Z", live.thermal_um[2]}}, {}}),
      "stored_age_s"_is(
          stored ? Cell{live.stored_age_s, fmt::format("they began with a stored state, {} s old\n", live.stored_age_s)}
                 : null_cell()),
      "inputs"_is(inputs_cell(live, lines.deviation))));
}

struct InputRequest {
  std::string input;
  double value = 0.0;
  static Fields<InputRequest> fields() {
    using R = InputRequest;
    return {{"INPUT", &R::input, "number of a temperature input, 1 to 16; load or deviation", Need::required},
            {"VALUE", &R::value, "temperature [degC], load [kg] or deviation [um]", Need::required}};
  }
};

Result<Outcome> set_input(VerbContext& context, const InputRequest& request) {
  const auto number = integer_in(request.input);
  const bool load = request.input == "load", deviation = request.input == "deviation";
  const bool temperature = number && *number >= 1 && *number <= static_cast<long long>(kTemperatureInputs);
  if (!load && !deviation && !temperature)
    return problem(ProblemKind::usage, "INPUT: expected 1 to {}, load or deviation, got {}", kTemperatureInputs,
                   request.input);
  const auto input = static_cast<std::uint16_t>(load        ? static_cast<long long>(kLoadInput)
                                                : deviation ? static_cast<long long>(kDeviationInput)
                                                            : *number - 1);
  ECS_TRY(unit, open_unit(context));
  ECS_DO(unit.client().set_input(input, request.value));
  return outcome_of(record_cell("input {input}: {value} {unit}", "input"_is(request.input), "value"_is(request.value),
                                "unit"_is(unit_of_input(input))));
}

}  // namespace

extern const std::vector<Action> kUtilityInputs{
    action("utility inputs",
           "show the inputs of the unit (temperatures, load, deviation shown by an instrument), their state, and the "
           "thermal compensation",
           "ecs utility inputs --json", show_inputs, {.link = Link::reads}),
    action("utility input",
           "set a temperature, the load or a deviation at an input without a sensor; also while the unit compensates",
           "ecs utility input 3 24.5\n  ecs utility input load 800", set_input, {.link = Link::writes})};

}  // namespace ecs::app
