// `ecs log verify` and `replay`: whether the logbook is as it was written, and whether the active map follows from it.
// `instrument`: the instrument that measures, from its own calibration certificate or a file of ours.

#include <filesystem>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/overwriting.hpp"
#include "base/text.hpp"
#include "commissioning/unit/transfer.hpp"
#include "modules/logbook/certificate.hpp"
#include "modules/logbook/instrument.hpp"
#include "modules/logbook/log_source.hpp"
#include "modules/logbook/view.hpp"

namespace ecs::app {
namespace {

struct VerifyLogRequest {
  LogChoice book;
  std::string hash;
  static Fields<VerifyLogRequest> fields() {
    using R = VerifyLogRequest;
    return {&R::book, {"--hash", &R::hash, "an entry must have it: as a report or certificate states it"}};
  }
};

Result<Outcome> verify_log(VerbContext& context, const VerifyLogRequest& request) {
  const auto book = chosen_logbook(context, request.book);
  LogVerdict verdict;
  std::string path = request.book.log;
  if (book) {
    verdict = book->verified(request.hash);
    path = book->path().string();
  } else if (book.error().kind == ProblemKind::bad_input && !request.book.log.empty() &&
             is_damaged_logbook(request.book.log)) {
    verdict.first = 1;
    verdict.why = fmt::format("the file cannot be read as a logbook: it {}", book.error().message);
  } else {
    return tl::unexpected(book.error());
  }
  return outcome_of(verdict_cell(verdict, path), verdict.whole() ? kDone : kDoesNotHold);
}

struct ReplayRequest {
  LogChoice book;
  bool unit = false;
  static Fields<ReplayRequest> fields() {
    using R = ReplayRequest;
    return {&R::book, {"--unit", &R::unit, "compare with the image that the connected unit holds"}};
  }
};

/// Refused where the unit is another machine's.
Result<std::string> image_of_unit(VerbContext& context, const Logbook& book) {
  ECS_TRY(unit, open_unit(context));
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

Result<Outcome> replay_log(VerbContext& context, const ReplayRequest& request) {
  ECS_TRY(book, chosen_logbook(context, request.book));
  std::string active;
  if (request.unit) {
    ECS_TRY(image, image_of_unit(context, book));
    active = std::move(image);
  }
  ECS_TRY(replay, replayed(book, run_again(), active));
  return outcome_of(replay_cell(replay), replay.same ? kDone : kDoesNotHold);
}

struct InstrumentRequest {
  std::string file;
  bool use = false, force = false;
  int interval = 0;
  static Fields<InstrumentRequest> fields() {
    using R = InstrumentRequest;
    return {
        {"FILE", &R::file, "its Digital Calibration Certificate (.xml), or an instrument file (.toml); none: show it"},
        {"--use", &R::use, "keep it as the instrument in use: entries of measurements name it from then on"},
        {"--interval-days", &R::interval, "from one calibration to the next; 0: as the file says", Range{0, 36'500}},
        {"--force", &R::force, "replace the instrument in use"}};
  }
};

Result<Instrument> read_instrument(const std::string& file) {
  ECS_TRY(content, read_file(file));
  return trimmed(content).starts_with('<') ? instrument_in_dcc(content, file) : parse_instrument(content, file);
}

Result<Outcome> instrument(VerbContext&, const InstrumentRequest& request) {
  const std::string in_use = instrument_file();
  if (request.file.empty() && request.use) return problem(ProblemKind::usage, "--use: give the file");
  ECS_TRY(found, read_instrument(request.file.empty() ? in_use : request.file));
  if (request.interval > 0) found.calibration_interval_days = request.interval;
  if (request.use) {
    ECS_DO(spared({in_use}, request.force, {request.file}));
    std::error_code error;
    std::filesystem::create_directories(std::filesystem::path(in_use).parent_path(), error);
    ECS_DO(write_file(in_use, to_toml(found)));
  }
  const Json object = Json::parse(instrument_json(found, now_utc()), nullptr, false);
  std::string text;
  if (object.is_object())
    for (const auto& [key, value] : object.items())
      if (!value.is_null())
        text += fmt::format("{:<26} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
  if (request.use) text += fmt::format("kept in {}\n", in_use);
  return outcome_of({Json{{"instrument", object}, {"file", request.use ? Json(in_use) : Json(nullptr)}}, text});
}

}  // namespace

extern const std::vector<Action> kLogVerification{
    action("log verify", "every entry against its hash and the one before; exit 1 names the first that does not fit",
           "ecs log verify --hash 3f0c…", verify_log),
    action("log replay", "the active map derived again from the raw readings, compared bit for bit",
           "ecs log replay --json", replay_log, {.link = Link::reads}),
    action("log instrument", "the measuring instrument and its calibration, from its own certificate",
           "ecs log instrument laser-certificate.xml --use --interval-days 365", instrument)};

}  // namespace ecs::app
