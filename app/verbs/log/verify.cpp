// `ecs log verify` and `ecs log replay`: whether the logbook is as it was written, and whether the active map follows
// from it.
#include <fmt/format.h>

#include "app/cli/verb_unit.hpp"
#include "app/verbs/log/log_source.hpp"
#include "base/answer_table.hpp"
#include "commissioning/logbook/view.hpp"
#include "commissioning/unit/transfer.hpp"

namespace ecs::app {
namespace {

struct VerifyLogArguments : LogArguments {
  const std::string& hash = text("--hash", "an entry must have it: as a report or certificate states it");
};

Result<Outcome> verify_log(VerbContext& context, const VerifyLogArguments& arguments) {
  const auto book = chosen_logbook(context, arguments);
  LogVerdict verdict;
  std::string path = arguments.log;
  if (book) {
    verdict = book->verified(arguments.hash);
    path = book->path().string();
  } else if (book.error().kind == ProblemKind::bad_input && !arguments.log.empty() &&
             is_damaged_logbook(arguments.log)) {
    verdict.first = 1;
    verdict.why = fmt::format("the file cannot be read as a logbook: it {}", book.error().message);
  } else {
    return tl::unexpected(book.error());
  }
  return outcome_of(verdict_cell(verdict, path), verdict.whole() ? kDone : kDoesNotHold);
}

struct ReplayArguments : LogArguments {
  const bool& unit = flag("--unit", "compare with the image that the connected unit holds");
  const Access access = uses_link();
};

/// Refused where the unit is another machine's.
Result<std::string> image_of_unit(VerbContext& context, const ReplayArguments& arguments, const Logbook& book) {
  ECS_TRY(unit, open_unit(context, arguments.access));
  ECS_TRY(identity, unit.client().identity());
  ECS_TRY(owner, book.owner());
  if (const LogOwner of{identity.machine, identity.serial_number}; !belongs(owner, of))
    return problem(ProblemKind::refused, fmt::format("{} is the logbook of {}; the unit is that of {}",
                                                     book.path().string(), in_words(owner), in_words(of)));
  const auto image = read_active_image(unit.client(), progress_bar(context, "image"));
  context.console.end_progress();
  if (!image) return tl::unexpected(image.error());
  if (!*image) return problem(ProblemKind::refused, "the unit holds no image");
  return std::string((*image)->begin(), (*image)->end());
}

Result<Outcome> replay_log(VerbContext& context, const ReplayArguments& arguments) {
  ECS_TRY(book, chosen_logbook(context, arguments));
  std::string active;
  if (arguments.unit) {
    ECS_TRY(image, image_of_unit(context, arguments, book));
    active = std::move(image);
  }
  ECS_TRY(replay, replayed(book, run_again(), active));
  return outcome_of(replay_cell(replay), replay.same ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kLogVerify = verb<VerifyLogArguments>(
    "log verify", "every entry against its hash and the one before; exit 1 names the first that does not fit",
    "ecs log verify --hash 3f0c…", verify_log);

extern const VerbDefinition kLogReplay =
    verb<ReplayArguments>("log replay", "the active map derived again from the raw readings, compared bit for bit",
                          "ecs log replay --json", replay_log);

}  // namespace ecs::app
