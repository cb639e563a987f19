// `ecs log list` and `ecs log show`: what was done at a machine, and one entry of it whole.
#include <algorithm>

#include <fmt/format.h>

#include "app/verbs/log/log_source.hpp"
#include "base/answer_table.hpp"
#include "base/date.hpp"
#include "commissioning/logbook/view.hpp"

namespace ecs::app {
namespace {

struct ListLogArguments : LogArguments {
  const std::string& kind = text("--kind", "entries of one kind: measurement, map, activation, diagnosis, report …");
  const std::string& since = text("--since", "entries of this day and later: 2026-03-12");
  const int& last = integer("--last", "that many of the last; 0: all", 0, 0, 1'000'000);
};

Result<Outcome> list_log(VerbContext& context, const ListLogArguments& arguments) {
  if (const auto wrong = wrong_date(arguments.since)) return problem(ProblemKind::usage, "--since: " + *wrong);
  ECS_TRY(book, chosen_logbook(context, arguments));
  ECS_TRY(entries, book.entries(true));
  ECS_TRY(owner, book.owner());
  std::erase_if(entries, [&](const LogbookEntry& entry) {
    return (!arguments.kind.empty() && entry.kind != arguments.kind) || entry.time < arguments.since;
  });
  const std::size_t all = entries.size();
  if (const auto last = static_cast<std::size_t>(arguments.last); last > 0 && all > last)
    entries.erase(entries.begin(), entries.end() - static_cast<std::ptrdiff_t>(last));
  return outcome_of(
      record_cell("{owner}\n{entries}",
                  {{"log", word_cell(book.path().string())},
                   {"machine", text_cell(owner.machine)},
                   {"serial_number", text_cell(owner.serial_number)},
                   {"owner", shown_cell(fmt::format("logbook of {}: {}", in_words(owner), book.path().string()))},
                   {"entries", list_cell(entries, log_entry_cell, log_list_head())}}));
}

struct ShowLogArguments : LogArguments {
  const int& number = integer("NUMBER", "of the entry", 0, 1, 1'000'000'000, Need::required);
};

Result<Outcome> show_log(VerbContext& context, const ShowLogArguments& arguments) {
  ECS_TRY(book, chosen_logbook(context, arguments));
  ECS_TRY(entry, book.entry(arguments.number));
  return outcome_of(whole_entry_cell(entry));
}

}  // namespace

extern const VerbDefinition kLogList =
    verb<ListLogArguments>("log list", "what was done at a machine: every entry of its logbook",
                           "ecs log list --machine machine.toml --kind activation", list_log);

extern const VerbDefinition kLogShow = verb<ShowLogArguments>(
    "log show", "one entry whole: files with their hashes, instrument, answer", "ecs log show 12", show_log);

}  // namespace ecs::app
