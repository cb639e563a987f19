#include "commissioning/investigation/ledger_view.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ecs::commissioning {
namespace {

constexpr std::size_t kMostBars = 8;

std::string set_text(const InvestigationStep& step) {
  if (step.set.empty()) return std::string(name_of(step.verdict));
  std::vector<std::string> members;
  for (const SetMember& member : step.set) members.push_back(fmt::format("{} {:.2f}", member.name, member.probability));
  return fmt::format("{}", fmt::join(members, ", "));
}

}  // namespace

std::string ledger_numbers_head() {
  return fmt::format("{:>2} {:>6} {:>6} {:>8} {:>4}", "", "min", "in all", "rms um", "left");
}

LedgerView view_of(const InvestigationProgress& progress) {
  LedgerView view;
  double minutes = 0.0;
  for (const InvestigationStep& step : progress.steps) {
    minutes += step.minutes;
    view.rows.push_back({fmt::format("{:>2} {:>6.1f} {:>6.1f} {:>8.3f} {:>4}", view.rows.size() + 1, step.minutes,
                                     minutes, step.rms_um, step.set.size()),
                         step.set.size(), step.set.size() == 1 || step.verdict == model::Verdict::adequate,
                         step.measured});
  }
  if (!progress.steps.empty()) view.set = set_text(progress.steps.back());
  view.doing = progress.doing;
  view.said = progress.said;
  return view;
}

std::vector<std::string> lines_of(const LedgerView& view, std::size_t columns) {
  std::vector<std::string> lines;
  const auto add = [&](std::string line) {
    if (line.size() > columns) line.resize(columns);
    lines.push_back(std::move(line));
  };
  add(fmt::format("{}  {:<{}} measured", ledger_numbers_head(), "", kMostBars));
  for (const LedgerRow& row : view.rows)
    add(fmt::format("{}  {:<{}} {}", row.numbers, std::string(std::min(row.members, kMostBars), '#'), kMostBars,
                    row.measured));
  if (!view.set.empty()) add("   " + view.set);
  if (!view.doing.empty()) add("   " + view.doing);
  return lines;
}

}  // namespace ecs::commissioning
