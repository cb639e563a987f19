// How the parameters screen puts its parts together.
#include <algorithm>

#include <fmt/format.h>

#include "app/screens/parameters/screen.hpp"

namespace ecs::app {
namespace {

void draw_transfer(Canvas& canvas, const Area& area, const ParametersTransfer& transfer) {
  const TaskRunner& task = transfer.task();
  if (transfer.sending())
    draw_progress(canvas, area, 0, task.label() + "; Esc cancels", task.part(), task.seconds_left());
  else if (task.running())
    canvas.text(area, 0, 0, task.label() + " ... Esc cancels", Tone::warning);
}

constexpr std::array<const char*, 5> kTitles{"Configuration", "Compensation", "Datuming", "Findings", "Compare"};
constexpr int kWide = 118;  ///< columns from which on the panel stands beside the list

/// Rows for the panel below the list.
int panel_rows(const Area& area) { return std::clamp(area.rows * 2 / 5, 3, 9); }

std::string unit_words(const WatchedUnit& unit) {
  const std::string name = unit.emulator ? "EMULATOR" : unit.link;
  if (unit.open && unit.identity) return fmt::format("{}, unit {} answers", name, unit.identity->serial_number);
  if (!unit.problem.empty()) return "no unit answers: " + unit.problem;
  return "the link to the unit is being opened";
}

}  // namespace

void ParametersScreen::draw(Canvas& canvas, const Area& area) const {
  cursor_ = {-1, -1};
  if (area.rows < 4 || area.columns < 16) {
    canvas.text(area, 0, 0, "the terminal is too small");
    return;
  }
  const Area inside = area.between_margins();
  if (prompt_.choosing()) {
    prompt_.draw(canvas, inside, 0);
    cursor_ = prompt_.cursor(inside, 0);
    return;
  }
  if (!controller_.loaded()) {
    draw_start(canvas, area);
  } else {
    canvas.text(area.left(area.columns - 1), 0, 1, about(controller_, area.columns - 2),
                controller_.unsaved() ? Tone::warning : Tone::plain);
    draw_tabs(canvas, {area.row + 1, area.column, 1, area.columns});
    const Area body{area.row + 2, area.column, area.rows - 3, area.columns};
    if (area.columns >= kWide && !nothing_listed()) {
      const int list = std::max(area.columns * 3 / 5, 78);
      draw_page(canvas, body.left(list));
      draw_below(canvas, body.right_of(list + 1));
    } else {
      const int below = nothing_listed() ? 0 : panel_rows(area);
      draw_page(canvas, body.top(body.rows - below));
      draw_below(canvas, body.below(body.rows - below));
    }
    draw_bottom(canvas, {area.row + area.rows - 1, area.column + 1, 1, area.columns - 2});
  }
  if (prompt_.active()) {
    prompt_.draw(canvas, inside, inside.rows - 1);
    cursor_ = prompt_.cursor(inside, inside.rows - 1);
  }
  if (asking_.active()) cursor_ = {-1, -1};
  draw_question(canvas, area, asking_);
}

/// The page has one sentence instead of rows, and nothing is told below it.
bool ParametersScreen::nothing_listed() const {
  if (!message_.text().empty()) return false;
  return (page_ == Page::findings && controller_.findings().empty()) ||
         (page_ == Page::compare && controller_.compared().empty());
}

void ParametersScreen::draw_start(Canvas& canvas, const Area& area) const {
  const Area inside = area.between_margins();
  if (draft_) {
    const std::string of = ParametersController::owner_of(*draft_);
    int row = canvas.paragraph(
        inside, 0, fmt::format("Unsaved work of {} was found{}{}.", draft_->kept, of.empty() ? "" : ": ", of),
        Tone::strong);
    std::vector<ListRow> rows{{"Enter  continue it"},
                              {"d      delete it"},
                              {"b      begin with other parameters; it is kept and offered again later"}};
    if (const std::size_t aside = drafts_aside(kParametersDraft); aside > 0)
      rows.push_back({fmt::format("o      another one: {} more", aside)});
    const int count = static_cast<int>(rows.size());
    draw_list(canvas, {inside.row + row + 1, inside.column, count, inside.columns}, rows, start_);
    row += count + 2;
    row += canvas.paragraph(inside, row, "It was neither saved to a file nor sent to a unit.", Tone::faint);
    draw_message(canvas, inside.below(row + 1), message_);
    return;
  }
  int row = canvas.paragraph(inside, 0, "No parameters yet. Choose their source.", Tone::strong);
  draw_list(canvas, {inside.row + row + 1, inside.column, 3, inside.columns},
            {{"r  receive from the unit"}, {"o  open a file"}, {"n  new from a machine file"}}, start_);
  row += 5;
  const char* help[] = {"Reads the parameters from the unit. The unit is not changed.",
                        "A parameter file (.toml) saved by this screen or by `ecs params receive`.",
                        "Chain, axes, transducers, scales and datum positions from a machine file (.toml); the other "
                        "parameters have their defaults and must be set."};
  canvas.paragraph(inside, row, help[static_cast<std::size_t>(std::clamp(start_.selected, 0, 2))], Tone::faint);
  row += 3;
  const WatchedUnit unit = transfer_.connection().snapshot();
  const std::string words = unit_words(unit);
  row += canvas.paragraph(inside.top(row + 4), row, "Line: " + words, unit.open ? Tone::good : Tone::warning);
  row = std::min(row + 1, area.rows - 2);
  if (transfer_.task().running())
    draw_transfer(canvas, inside.below(row), transfer_);
  else
    draw_message(canvas, inside.below(row), message_);
}

void ParametersScreen::draw_tabs(Canvas& canvas, const Area& area) const {
  const bool room = area.columns >= 76;
  int column = 0;
  for (int p = 0; p < kPages; ++p) {
    const bool here = static_cast<Page>(p) == page_;
    const bool finds = static_cast<Page>(p) == Page::findings;
    const std::size_t count = finds ? controller_.findings().size()
                                    : (static_cast<Page>(p) == Page::compare ? controller_.compared().size() : 0);
    std::string name = fmt::format("{}", p + 1);
    if (room || here) name += std::string(" ") + kTitles[static_cast<std::size_t>(p)];
    if (count > 0) name += fmt::format(" {}", count);
    const Tone tone = finds && count > 0 ? (controller_.errors() > 0 ? Tone::bad : Tone::warning) : Tone::faint;
    column += canvas.text(area, 0, column, fmt::format("{}{}{}", here ? "[" : " ", name, here ? "]" : " "),
                          here ? Tone::strong : tone);
    column += room ? 1 : 0;
  }
}

void ParametersScreen::draw_page(Canvas& canvas, const Area& area) const {
  list_area_ = area;
  if (on_group()) {
    cursor_ = draw_parameters(canvas, area, controller_, rows(), place(), edit_);
    list_area_ = area.below(1);
  } else if (page_ == Page::findings) {
    draw_findings(canvas, area, controller_, place());
  } else {
    draw_compared(canvas, area, controller_, place());
    list_area_ = area.below(1);
  }
}

void ParametersScreen::draw_below(Canvas& canvas, const Area& area) const {
  if (message_.is_problem() && !message_.text().empty()) {
    draw_panel(canvas, area, "", {{message_.text(), Tone::bad}});
  } else if (width_of(message_.text()) > area.columns - 2) {
    draw_panel(canvas, area, "", {{message_.text(), Tone::strong}});
  } else if (on_group()) {
    draw_key_panel(canvas, area, controller_, key_here(), edit_ ? edit_->refusal : "");
  } else if (page_ == Page::findings) {
    draw_finding_panel(canvas, area, controller_, place());
  } else {
    draw_compared_panel(canvas, area, controller_, place());
  }
}

void ParametersScreen::draw_bottom(Canvas& canvas, const Area& area) const {
  if (transfer_.task().running()) {
    draw_transfer(canvas, area, transfer_);
  } else if (seeking_) {
    canvas.text(area, 0, 0, "find:", Tone::strong);
    const int room = std::clamp(area.columns - 40, 8, 30);
    seeking_->text.draw(canvas, area, 0, 6, room, true);
    cursor_ = {area.row, area.column + 6 + seeking_->text.cursor_column(room)};
    const std::string found = seeking_->text.text().empty() ? "a part of a name or of its help"
                              : seeking_->found.empty()
                                  ? "no such parameter"
                                  : fmt::format("{} of {}; up, down: others", seeking_->at + 1, seeking_->found.size());
    canvas.text(area, 0, 6 + room + 2, found, seeking_->found.empty() ? Tone::warning : Tone::faint);
  } else if (!message_.is_problem() && width_of(message_.text()) <= area.columns) {
    draw_message(canvas, area, message_);
  }
}

CellPosition ParametersScreen::cursor(const Area& /*area*/) const { return cursor_; }

std::vector<KeyHelp> ParametersScreen::keys() const {
  if (const auto& asked = asking_.question()) return {{"y", asked->yes}, {"n", asked->no}};
  if (prompt_.active()) return prompt_.keys();
  if (seeking_) return {{"Enter", "stay there"}, {"up/down", "other match"}, {"Esc", "back to the previous field"}};
  if (edit_ && edit_->choosing) return {{"Space left/right", "choose"}, {"Enter", "accept"}, {"Esc", "cancel"}};
  if (edit_) return {{"Enter", "accept"}, {"Esc", "cancel"}, {"Ctrl-U", "clear"}};
  if (transfer_.task().running()) return {{"Esc", "cancel"}, {"up/down", "move"}, {"Tab", "page"}};
  if (!controller_.loaded() && draft_)
    return {{"Enter", "continue"}, {"d", "delete"}, {"b", "begin others"}, {"Esc", "back"}};
  if (!controller_.loaded())
    return {{"Enter", "do it"}, {"r", "receive"}, {"o", "open"}, {"n", "new"}, {"Esc", "back"}};
  return helps_of(keys_);
}

std::string ParametersScreen::help() const {
  return "The parameters that adapt a unit to its machine, in the groups of thesis 5.3. Marks: ! finding on the value, "
         "* changed, u the unit has another value. Errors must be corrected before sending. Unsaved changes survive a "
         "crash and are offered again.";
}

}  // namespace ecs::app
