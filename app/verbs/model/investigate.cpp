// `ecs model investigate`: measure, diagnose, measure what separates, until one cause is left; then compensate and
// measure again.
#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/answer_table.hpp"
#include "base/interrupt.hpp"
#include "base/paragraph.hpp"
#include "commissioning/investigation/followed.hpp"
#include "commissioning/investigation/investigation.hpp"
#include "commissioning/investigation/ledger_view.hpp"
#include "commissioning/investigation/opening.hpp"
#include "commissioning/models/work.hpp"

namespace ecs::app {
namespace {

constexpr double kMostMinutes = 100'000.0;

struct InvestigateArguments : VerbArguments {
  const std::string& model = text("MODEL", "model file (.toml)", Need::required);
  const std::string& machine = text("--machine", "the machine (.toml): travels, lever arms, pitches", Need::required);
  const std::string& params = text(
      "--params", "parameters of the unit; parameters.toml beside the machine if not given, else those that fit it");
  const std::string& workshop = text(
      "--workshop", "socket of a running `ecs-emulator serve`, which measures by itself; it names the link as well");
  const std::string& watch =
      text("--watch", "folder into which a person puts the readings; what was given is kept in its ledger.json");
  const double& minutes = number("--minutes", "that the runs may take, set-up and waiting included", 0.0,
                                 Need::required, 0.0, kMostMinutes);
  const std::string& output = output_file("-o,--output", "the model with the causes found; may be MODEL itself");
  const Access access = may_write_to_unit();
};

/// Lines of the ledger as they come; on a terminal the whole ledger, drawn anew with every change.
class ShownLedger {
 public:
  explicit ShownLedger(Console& console) : console_(console) {}

  void show(const commissioning::InvestigationProgress& progress) {
    if (console_.shows_blocks())
      console_.show_block(commissioning::lines_of(commissioning::view_of(progress), kTerminalColumns - 1));
    else
      print_new(progress);
  }
  /// What stays when the work is done.
  void end(const commissioning::InvestigationProgress& progress) {
    console_.end_block();
    print_new(progress);
  }

 private:
  void print_new(const commissioning::InvestigationProgress& progress) {
    for (; printed_ < progress.steps.size(); ++printed_) {
      if (printed_ == 0) console_.print(commissioning::ledger_head());
      minutes_ += progress.steps[printed_].minutes;
      console_.print(commissioning::ledger_line(printed_ + 1, progress.steps[printed_], minutes_));
    }
  }

  Console& console_;
  std::size_t printed_ = 0;
  double minutes_ = 0.0;
};

Result<Outcome> investigate(VerbContext& context, const InvestigateArguments& arguments) {
  if (arguments.workshop.empty() == arguments.watch.empty())
    return problem(ProblemKind::usage, "expected either --workshop SOCKET or --watch FOLDER");
  for (const std::string& input : {arguments.machine, arguments.params})
    ECS_DO(check_output_not_input(arguments.output, {input}));
  const auto model = model::read_model(arguments.model);
  if (!model) return tl::unexpected(model.error());
  ECS_TRY(machine, machine_in(context.console, arguments.machine));
  commissioning::WorkshopChoice choice;
  choice.socket = arguments.workshop;
  choice.folder = arguments.watch;
  choice.link = context.link_option;
  choice.model = arguments.model;
  choice.machine = arguments.machine;
  choice.params = arguments.params;
  choice.map_is_modelled = model->map.has_value();
  choice.arm_code = context.arm_code;
  ECS_TRY(opened, commissioning::open_workshop(context.console, choice, *machine, interrupted()));
  if (!opened.link.empty()) context.link_name = opened.link;
  commissioning::InvestigationOptions options;
  options.minutes = arguments.minutes;
  if (!arguments.workshop.empty()) options.times = commissioning::workshop_times();
  options.cancelled = &interrupted();
  commissioning::FollowedInvestigation followed;
  ShownLedger ledger(context.console);
  commissioning::FollowedWorkshop workshop(followed, *opened.workshop, [&] { ledger.show(followed.progress()); });
  const auto investigation = commissioning::investigate(*model, *machine, workshop, options);
  ledger.end(followed.progress());
  if (!investigation) return tl::unexpected(in_file(investigation.error(), arguments.model));
  Cell answer = commissioning::investigation_cell(*investigation);
  if (!arguments.output.empty()) ECS_DO(model::write_model(arguments.output, investigation->model, arguments.model));
  answer.text += written_cell("model", arguments.output).text;
  return outcome_of(answer);
}

}  // namespace

extern const VerbDefinition kModelInvestigate = verb<InvestigateArguments>(
    "model investigate", "measure and diagnose until one cause is left, then compensate and measure again",
    "ecs model investigate model.toml --machine machine.toml --workshop /tmp/shop --minutes 120 -o found.toml\n"
    "  ecs model investigate model.toml --machine machine.toml --watch readings --minutes 240",
    investigate);

}  // namespace ecs::app
