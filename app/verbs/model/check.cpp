// `ecs model check`: whether a kept diagnosis holds on its data, without the search.
#include "app/cli/verb.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/answer_table.hpp"
#include "commissioning/models/answer_check.hpp"

namespace ecs::app {
namespace {

struct CheckArguments : VerbArguments {
  const std::string& answer = text("ANSWER", "saved answer of `ecs model diagnose --json`", Need::required);
  const std::vector<std::string>& data =
      texts("DATA", "the measurement files that it was made from, in the same order", Need::required);
  const std::string& machine = text("--machine", "a machine (.toml) in place of that of the answer");
  ImportOptions import{*this};
};

Result<Outcome> check(VerbContext& context, const CheckArguments& arguments) {
  const auto checked =
      check_answer(context.console, arguments.answer, arguments.data, arguments.machine, arguments.import);
  if (!checked) return tl::unexpected(checked.error());
  return outcome_of(check_cell(*checked), checked->holds() ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kModelCheck =
    verb<CheckArguments>("model check", "recomputes a saved diagnosis from its data; exit 1 if it does not hold",
                         "ecs model check answer.json data.csv", check);

}  // namespace ecs::app
