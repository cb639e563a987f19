// `ecs model investigate`: measure, diagnose, measure what separates, until one cause is left; then compensate and
// measure again.
#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/interrupt.hpp"
#include "base/json.hpp"
#include "commissioning/investigation/investigation.hpp"
#include "commissioning/investigation/socket_workshop.hpp"
#include "commissioning/investigation/watched_folder.hpp"
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
  const std::string& output = text("-o,--output", "the model with the causes found; may be MODEL itself");
  const Access access = uses_link();
};

/// Prints the ledger while it grows.
class PrintedWorkshop final : public commissioning::Workshop {
 public:
  PrintedWorkshop(Console& console, commissioning::Workshop& workshop) : console_(console), workshop_(workshop) {}
  Result<commissioning::RunReadings> measure(const commissioning::RequestedRun& run) override {
    return workshop_.measure(run);
  }
  Result<void> activate(const model::Model& model) override {
    console_.note("making the map of the model active");
    return workshop_.activate(model);
  }
  void keep(const commissioning::InvestigationStep& step) override {
    workshop_.keep(step);
    if (steps_ == 0) console_.print(commissioning::ledger_head());
    minutes_ += step.minutes;
    console_.print(commissioning::ledger_line(++steps_, step, minutes_));
  }

 private:
  Console& console_;
  commissioning::Workshop& workshop_;
  std::size_t steps_ = 0;
  double minutes_ = 0.0;
};

/// --params, else parameters.toml beside the machine, else none: those that fit the machine.
std::string params_of(const InvestigateArguments& arguments) {
  if (!arguments.params.empty()) return arguments.params;
  const auto beside = std::filesystem::path(arguments.machine).replace_filename("parameters.toml");
  std::error_code error;
  return std::filesystem::exists(beside, error) ? beside.string() : std::string();
}

Result<std::unique_ptr<commissioning::Workshop>> workshop_for(VerbContext& context,
                                                              const InvestigateArguments& arguments,
                                                              const model::Model& model,
                                                              const params::Machine& machine) {
  const commissioning::MapSources sources{arguments.machine, params_of(arguments)};
  if (!arguments.workshop.empty()) {
    auto opened = commissioning::SocketWorkshop::open(
        context.console, {arguments.workshop, context.link_option, sources, machine, model.map.has_value()},
        interrupted());
    if (!opened) return tl::unexpected(opened.error());
    context.link_name = (*opened)->link();
    return std::move(*opened);
  }
  const auto pause = [](std::chrono::milliseconds time) {
    std::this_thread::sleep_for(time);
    return !interrupted();
  };
  auto opened = commissioning::WatchedFolder::open(
      context.console, {arguments.watch, arguments.model, context.link_option, sources, machine, pause}, interrupted());
  if (!opened) return tl::unexpected(opened.error());
  return std::move(*opened);
}

Result<Outcome> investigate(VerbContext& context, const InvestigateArguments& arguments) {
  if (arguments.workshop.empty() == arguments.watch.empty())
    return problem(ProblemKind::usage, "expected either --workshop SOCKET or --watch FOLDER");
  for (const std::string& input : {arguments.machine, arguments.params})
    if (const auto distinct = check_output_not_input(arguments.output, {input}); !distinct)
      return tl::unexpected(distinct.error());
  const auto model = model::read_model(arguments.model);
  if (!model) return tl::unexpected(model.error());
  const auto machine = machine_in(context.console, arguments.machine);
  if (!machine) return tl::unexpected(machine.error());
  auto workshop = workshop_for(context, arguments, *model, **machine);
  if (!workshop) return tl::unexpected(workshop.error());
  PrintedWorkshop printed(context.console, **workshop);
  commissioning::InvestigationOptions options;
  options.minutes = arguments.minutes;
  if (!arguments.workshop.empty()) options.times = commissioning::workshop_times();
  options.cancelled = &interrupted();
  const auto investigation = commissioning::investigate(*model, **machine, printed, options);
  if (!investigation) return tl::unexpected(in_file(investigation.error(), arguments.model));
  std::string text = commissioning::summary_text(*investigation);
  if (!arguments.output.empty()) {
    if (const auto kept = keep_model(arguments.output, investigation->model, arguments.model); !kept)
      return tl::unexpected(kept.error());
    text += fmt::format("model written to {}\n", arguments.output);
  }
  return Outcome{text, one_line(commissioning::json_of(*investigation)), kDone};
}

}  // namespace

extern const VerbDefinition kModelInvestigate = verb<InvestigateArguments>(
    "model investigate", "measure and diagnose until one cause is left, then compensate and measure again",
    "ecs model investigate model.toml --machine machine.toml --workshop /tmp/shop --minutes 120 -o found.toml\n"
    "  ecs model investigate model.toml --machine machine.toml --watch readings --minutes 240",
    investigate);

}  // namespace ecs::app
