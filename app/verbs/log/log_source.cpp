#include "app/verbs/log/log_source.hpp"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "app/cli/around_verb.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "commissioning/logbook/place.hpp"

namespace ecs::app {
namespace {

bool is_of(const LogOwner& owner, const std::string& machine, const LogOwner& in_file) {
  if (!in_file.machine.empty() || !in_file.serial_number.empty()) return belongs(owner, in_file);
  return owner.machine == machine || owner.serial_number == machine;
}

tl::unexpected<Problem> none_found(const LogbookSetting& setting, const std::string& machine) {
  const std::string where = setting.file.empty() ? setting.folder.string() : setting.file.string();
  return tl::unexpected(Problem{ProblemKind::bad_input,
                                machine.empty()
                                    ? "no logbook yet: verbs and screens begin one when they work on a machine "
                                      "(docs/logbook.md)"
                                    : fmt::format("no logbook of {} there", machine),
                                where,
                                0,
                                0,
                                {}});
}

}  // namespace

Result<Logbook> chosen_logbook(VerbContext& context, const LogArguments& arguments) {
  LogOwner wanted;
  if (const auto content = arguments.machine.empty() ? problem(ProblemKind::usage, "") : read_file(arguments.machine))
    wanted = owner_in(*content);
  std::vector<std::filesystem::path> files{arguments.log};
  LogbookSetting setting;
  if (arguments.log.empty()) {
    ECS_TRY(set, logbook_setting());
    if (set.off)
      return problem(ProblemKind::usage,
                     "no logbook is kept (ECS_LOGBOOK or the setting says off): name one with --log");
    setting = set;
    files = logbooks(setting);
  }
  std::vector<std::string> others;
  std::optional<Logbook> chosen;
  for (const auto& file : files) {
    auto book = Logbook::open_to_read(file);
    if (!book && files.size() == 1) return book;
    const auto owner = book ? book->owner() : tl::unexpected(book.error());
    if (!owner) {
      context.console.warn(to_text(owner.error()));
      continue;
    }
    if (!arguments.machine.empty() && !is_of(*owner, arguments.machine, wanted)) {
      if (!arguments.log.empty())
        return tl::unexpected(
            Problem{ProblemKind::bad_input,
                    fmt::format("is the logbook of {}, not of {}", in_words(*owner), arguments.machine),
                    arguments.log,
                    0,
                    0,
                    {}});
      continue;
    }
    if (!chosen)
      chosen = std::move(*book);
    else
      others.push_back(in_words(*owner));
  }
  if (!chosen) return none_found(setting, arguments.machine);
  if (!others.empty() && arguments.machine.empty())
    context.console.note(fmt::format("{} is the logbook written last of {}: --machine chooses another one",
                                     chosen->path().string(), others.size() + 1));
  return std::move(*chosen);
}

RunVerb run_again() {
  return [](const std::vector<std::string>& words) -> Result<std::string> {
    std::vector<std::string> with_json = words;
    with_json.emplace_back("--json");
    std::ostringstream out, messages;
    const int code = run_same_program(with_json, out, messages);
    if (code <= kDoesNotHold) return out.str();
    const Json answer = Json::parse(out.str(), nullptr, false);
    const auto error = answer.is_object() ? answer.find("error") : answer.end();
    const bool has = answer.is_object() && error != answer.end() && error->is_object() && error->contains("message");
    return problem(ProblemKind::refused, has ? (*error)["message"].get<std::string>() : messages.str());
  };
}

}  // namespace ecs::app
