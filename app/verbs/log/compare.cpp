// `ecs log compare`: what has worn between two days.
#include "commissioning/logbook/compare.hpp"

#include "app/verbs/log/log_source.hpp"
#include "base/answer_table.hpp"
#include "commissioning/logbook/view.hpp"

namespace ecs::app {
namespace {

struct CompareLogArguments : LogArguments {
  const std::string& from = text("FROM", "a day: 2025-03-12", Need::required);
  const std::string& to = text("TO", "a later day", Need::required);
};

Result<Outcome> compare_log(VerbContext& context, const CompareLogArguments& arguments) {
  ECS_TRY(book, chosen_logbook(context, arguments));
  ECS_TRY(comparison, compared(book, arguments.from, arguments.to, run_again()));
  return outcome_of(comparison_of_log_cell(comparison));
}

}  // namespace

extern const VerbDefinition kLogCompare =
    verb<CompareLogArguments>("log compare", "what has worn between two days: curves, causes and volume side by side",
                              "ecs log compare 2025-03-12 2026-03-12", compare_log);

}  // namespace ecs::app
