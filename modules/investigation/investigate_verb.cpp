// `ecs model investigate`: measure, diagnose, measure what separates, until one cause is left; then compensate and
// measure again.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "commissioning/models/work.hpp"
#include "modules/investigation/investigation.hpp"
#include "modules/investigation/workshops.hpp"

namespace ecs::app {
namespace {

constexpr double kMostMinutes = 100'000.0;

struct InvestigateRequest : commissioning::WorkshopChoice {
  std::string output, ball_output;
  double minutes = 0.0;
  static Fields<InvestigateRequest> fields() {
    using R = InvestigateRequest;
    return {{"MODEL", &R::model, "model file (.toml)", Need::required},
            {"--machine", &R::machine, "machine file (.toml): travels, lever arms, pitches", Need::required},
            {"--params", &R::params,
             "parameters of the unit; default: parameters.toml in the folder of the machine file, else parameters made "
             "from it"},
            {"--workshop", &R::socket,
             "path where a running `ecs-emulator serve` listens, as in /tmp/shop: its emulated workshop makes the "
             "measurements, and its emulated unit is used in place of --link"},
            {"--watch", &R::folder,
             "folder in which a person places the readings; accepted files are listed in its ledger.json"},
            {"--minutes", &R::minutes, "time available for the runs, including set-up and waiting [min]",
             Need::required, Range{0.0, kMostMinutes}},
            {"-o,--output", &R::output, "model file to write, with the causes found; may be MODEL itself", Is::output},
            {"--ball-model", &R::ball_output,
             "file for the model of the ball readings, with their causes (machines with rotary axes)", Is::output}};
  }
};

/// Lines of the ledger as they come; on a terminal the whole ledger, drawn again with every change.
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

Result<Outcome> investigate(VerbContext& context, const InvestigateRequest& request) {
  if (request.socket.empty() == request.folder.empty())
    return problem(ProblemKind::usage, "expected either --workshop SOCKET or --watch FOLDER");
  for (const std::string& input : {request.machine, request.params})
    ECS_DO(check_output_not_input(request.output, {input}));
  ECS_DO(check_output_not_input(request.ball_output, {request.model, request.machine, request.params}));
  const auto model = model::read_model(request.model);
  if (!model) return tl::unexpected(model.error());
  ECS_TRY(machine, machine_in(context.console, request.machine));
  commissioning::WorkshopChoice choice = request;
  choice.link = context.link_option;
  choice.map_is_modelled = model->map.has_value();
  choice.arm_code = context.arm_code;
  ECS_TRY(opened, commissioning::open_workshop(context.console, choice, *machine, interrupted()));
  if (!opened.link.empty()) context.link_name = opened.link;
  commissioning::InvestigationOptions options;
  options.minutes = request.minutes;
  if (!request.socket.empty()) options.times = commissioning::workshop_times();
  options.cancelled = &interrupted();
  commissioning::FollowedInvestigation followed;
  ShownLedger ledger(context.console);
  commissioning::FollowedWorkshop workshop(followed, *opened.workshop, [&] { ledger.show(followed.progress()); });
  const auto investigation = commissioning::investigate(*model, *machine, workshop, options);
  ledger.end(followed.progress());
  if (!investigation) return tl::unexpected(in_file(investigation.error(), request.model));
  ecs::Cell answer = commissioning::investigation_cell(*investigation);
  if (!request.output.empty()) ECS_DO(model::write_model(request.output, investigation->model, request.model));
  answer.text += written_cell("model", request.output).text;
  if (!request.ball_output.empty() && investigation->ball_model) {
    ECS_DO(model::write_model(request.ball_output, *investigation->ball_model, request.model));
    answer.text += written_cell("model of the ball", request.ball_output).text;
  } else if (!request.ball_output.empty()) {
    answer.text += fmt::format("{} was not written: no ball was measured\n", request.ball_output);
  }
  return outcome_of(answer);
}

}  // namespace

extern const std::vector<Action> kModelInvestigation{
    action("model investigate", "measure and diagnose until one cause remains, then compensate and measure again",
           "ecs model investigate model.toml --machine machine.toml --workshop /tmp/shop --minutes 120 -o found.toml\n"
           "  ecs model investigate model.toml --machine machine.toml --watch readings --minutes 240",
           investigate, {.link = Link::may_write, .logged = Logged::always, .kind = "investigation"})};

}  // namespace ecs::app
