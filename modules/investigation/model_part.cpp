// The investigation on the page Next of the MODEL screen: its keys, and its ledger in place of the next measurement.
#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "app/screens/model/screen.hpp"
#include "app/ui/widgets.hpp"
#include "base/text.hpp"
#include "modules/investigation/controller.hpp"

namespace ecs::app {
namespace {

using commissioning::InvestigationController;

/// The place, then the minutes.
void ask_investigation(InvestigationController& investigation, Prompt& prompt) {
  if (!investigation.may_begin()) return;
  const std::string emulated = investigation.emulated_workshop();
  const std::string before = investigation.place();
  const auto take = [&investigation, &prompt](const std::string& typed) {
    const auto place = investigation.place_of(typed);
    if (place)
      prompt.ask("minutes that the runs may take:", Prompt::Kind::number, fmt::format("{:g}", investigation.minutes()),
                 [&investigation, place = *place](const std::string& most) { investigation.start(place, most); });
  };
  prompt
      .ask("workshop socket, or folder for readings:", Prompt::Kind::path, before == emulated ? "" : before, take,
           emulated.empty() ? "" : "empty: the emulated machine of this link")
      .or_nothing();
}

/// A row a run, a bar as long as causes are still possible; below it the set, the run under way, what was said.
void draw_ledger(Canvas& canvas, const Area& area, const InvestigationController& investigation,
                 const ScrollPlace& scroll) {
  constexpr int kBar = 8;
  const commissioning::LedgerView view = investigation.view();
  const Area text = area.between_margins();
  const int numbers = width_of(commissioning::ledger_numbers_head()) + 2;
  canvas.text(text, 0, 0, commissioning::ledger_numbers_head(), Tone::faint);
  canvas.text(text, 0, numbers + kBar + 1, "measured", Tone::faint);
  std::vector<std::string> below;
  const auto add = [&](const std::string& paragraph) {
    for (std::string& line : wrapped(paragraph, text.columns)) below.push_back(std::move(line));
  };
  if (!view.set.empty()) add(view.set);
  if (!view.doing.empty()) add(view.doing);
  if (investigation.found())
    for (std::string& line :
         sentences_wrapped(owned_lines_of(commissioning::summary_text(*investigation.found())), text.columns))
      below.push_back(std::move(line));
  for (auto said = view.said.rbegin(); said != view.said.rend(); ++said) add(*said);  // newest first
  const auto least = static_cast<std::size_t>(std::max(1, area.rows / 3));  // the newest rows of a long ledger
  const auto room = static_cast<std::size_t>(std::max(2, area.rows - 2)) - std::min(below.size(), least);
  int row = 1;
  for (std::size_t k = view.rows.size() > room ? view.rows.size() - room : 0; k < view.rows.size(); ++k, ++row) {
    const commissioning::LedgerRow& step = view.rows[k];
    canvas.text(text, row, 0, step.numbers);
    draw_bar(canvas, {text.row, text.column + numbers, text.rows, kBar}, row, static_cast<double>(step.members), kBar,
             step.settled ? Tone::good : Tone::forward);
    canvas.text(text, row, numbers + kBar + 1, step.measured, step.settled ? Tone::good : Tone::plain);
  }
  draw_scrolled(canvas, text.below(row + 1), below, scroll);
}

}  // namespace

NextPart investigation_part(ModelController& model, Prompt& prompt) {
  const auto investigation = std::make_shared<InvestigationController>(model);
  const auto write_found = [investigation, &model, &prompt] {
    prompt.ask("write the model to:", Prompt::Kind::path,
               std::filesystem::path(model.model_file()).replace_extension(".found.toml").string(),
               [investigation](const std::string& file) { investigation->write_model(file); });
  };
  return {
      {{"f", "write what was found", write_found, [investigation] { return investigation->found().has_value(); }},
       {"i", "investigate", [investigation, &prompt] { ask_investigation(*investigation, prompt); }}},
      [investigation](Canvas& canvas, const Area& area, const ScrollPlace& scroll) {
        if (investigation->was_begun()) draw_ledger(canvas, area, *investigation, scroll);
        return investigation->was_begun();
      },
      "Or i: measure, diagnose and take the next run, one after the other, until one cause is left; in the workshop "
      "of an emulator, or with files that you bring.",
      "On the page Next i investigates: a workshop is asked for one run after the other (with the bundled emulator "
      "it is the emulated machine of the link) until one cause is left; the ledger shows minutes, error and the "
      "causes still possible. Esc stops it, i goes on where it was, f writes the model with what was found."};
}

}  // namespace ecs::app
