#include "app/screens/laser/screen.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ecs::app {

const LaserStepRow kLaserStepRows[kLaserSteps] = {
    {"Files", "files of any instrument, several or a whole folder",
     "Step 1: add the instrument's files, of any format, several at once or a whole folder. Each file is read and "
     "identified. An error map is loaded unchanged, with the parameters saved in its folder. If a file does not state "
     "its axis or sense, press Enter to supply these data. A plain table of columns is shown with its first rows: give "
     "each column a role and a unit, or accept the proposal with Enter. The program then offers to read other files "
     "with the same headings in the same way. Press p to choose the parameter file, or to receive the parameters of "
     "the unit: they determine the components that the map needs.",
     laser_files_page},
    {"Lines", "measured lines, their positions and conditions",
     "Step 2: every measured line: component and axis, position of the other axes, targets, runs, approaches. Below "
     "are the conditions stated in the file. A ? marks an unknown position of a parked axis: 0 is assumed until you "
     "enter it with Enter. Press c to correct a position that a file states wrongly. A line that was measured with "
     "compensation active cannot be used for a map.",
     laser_lines_page},
    {"Exclude", "exclude or include runs and readings",
     "Step 3: exclude a run or a single reading. Press Space to exclude it or to include it again. Files are never "
     "changed, and every later step is computed again. Excluded readings stay visible as x, but are not used. Readings "
     "far outside "
     "are drawn at the edge of the chart with their value. ? marks readings that differ from their repeats by more "
     "than five times the usual scatter: a suggestion only. Press w to note the reason. Marks before a line: - "
     "readings are excluded, ? readings differ from their repeats, ! no curve can be computed.",
     laser_leave_out_page},
    {"Slope", "slope and smoothing, before and after",
     "Step 4: processing of each curve before it becomes part of the map. The slope of a straightness curve comes from "
     "the alignment of the optics, so least squares removes it; positioning and angles keep their slope. Smoothing "
     "fits a local parabola over the window; the scatter of the repeats shows whether noise or shape was removed. The "
     "band is the range of all readings; for a curve that is smoothed or comes from two lines, the range of the curve.",
     laser_curves_page},
    {"ISO 230", "accuracy and repeatability by ISO 230-2",
     "Step 5: accuracy and repeatability of every line by ISO 230-2:2014, with the symbols of the standard. All "
     "readings that are not excluded are used as measured; slope removal and smoothing apply to the map only. Notes "
     "list the conditions of the standard that are not met.",
     laser_iso_page},
    {"Map", "parameters of the unit; present and missing components",
     "Step 6: the components required by the scope of the parameters. Measure a missing component, or declare it zero "
     "with a reason; an incomplete map cannot be sent. Curves show compensation: minus the error. Squareness is stored "
     "in the parameters; measured values are written into the parameter file saved with the map.",
     laser_map_page},
    {"Header", "customer, machine, engineer, date",
     "Step 7: the header of the map. Press Enter to edit the field under the cursor and Tab to go to the next one. "
     "Faint values come from the files. The source files and their processing are added automatically.",
     laser_header_page},
    {"Send", "save to disc, check, send to the unit",
     "Step 8: the map is saved to disc, checked by the rules of the unit, and sent. It becomes active only as a whole: "
     "after a broken link, a power cut or cancelling, the old map stays active. The unit checks every byte in its "
     "memory.",
     laser_send_page},
    {"Verify", "read back and compare",
     "Step 9: the map is read back from the unit and compared with the file, table by table and value by value, to the "
     "resolution of the unit's memory. The parameters are compared too. Then the next actions are shown. While this "
     "step is open, the unit is queried every few seconds. If it was restarted, or another map became active, the "
     "comparison is no longer valid.",
     laser_verify_page}};

namespace {

constexpr int kRoomForNames = 78;

char sign_of(LaserMark mark) {
  if (mark == LaserMark::done) return '+';
  return mark == LaserMark::doubtful ? '!' : '.';
}

Tone tone_of(LaserMark mark) {
  if (mark == LaserMark::done) return Tone::good;
  return mark == LaserMark::doubtful ? Tone::warning : Tone::faint;
}

/// The first file that gives nothing, and what helps.
std::string unread_file(const std::vector<LaserFile>& files) {
  const auto unread = std::ranges::find_if(files, [](const LaserFile& file) { return !file.set; });
  if (unread == files.end()) return {};
  const bool can_be_completed = unread->wants_columns || unread->wants_answers;
  return fmt::format("Step 1: {} {}", std::filesystem::path(unread->choice.path).filename().string(),
                     can_be_completed ? "is incomplete: press Enter on it to add data, or x to remove it."
                                      : "cannot be read: press x to remove it.");
}

/// What to do next, in one line; empty: everything is done.
std::string next_to_do(const LaserController& controller) {
  const auto is = [&](LaserStep step, LaserMark mark) { return controller.mark(step) == mark; };
  const LaserMapWork& map = controller.work().map;
  if (is(LaserStep::files, LaserMark::open)) return {};
  if (is(LaserStep::files, LaserMark::doubtful)) return unread_file(controller.work().files);
  if (!controller.mismatch().empty())
    return controller.mismatch() + " Press p to choose the parameters of this machine.";
  if (is(LaserStep::map, LaserMark::open)) return "Next: choose the parameters of the unit: p in step 1, 4 or 6.";
  if (is(LaserStep::leave_out, LaserMark::doubtful)) return "Step 3: readings differ from their repeats (o).";
  if (is(LaserStep::curves, LaserMark::doubtful)) return "Step 4: check the curve marked !.";
  if (map.missing() > 0) {
    std::string missing = fmt::format("Step 6: {} of {} components are missing.", map.missing(), map.components.size());
    for (const LaserComponent& one : map.components)
      if (one.state == ComponentState::missing && !one.detail.empty()) {
        missing += fmt::format(" {} is measured, but not used: see step 6.", name_of(one.component));
        break;
      }
    const auto& lines = controller.work().lines;
    const auto placeless =
        std::count_if(lines.begin(), lines.end(), [](const LaserLine& line) { return !line.place_unknown.empty(); });
    return placeless == 0 ? missing : fmt::format("{} Step 2: {} without parked position.", missing, placeless);
  }
  if (is(LaserStep::map, LaserMark::doubtful)) return "Step 6: see the findings on this map.";
  if (is(LaserStep::header, LaserMark::doubtful))
    return fmt::format("Step 7: not stated in the header: {}.",
                       fmt::join(laser::missing_in(map.made->map.map.header), ", "));
  if (controller.verdict() && !controller.stale().empty())
    return "Step 9: the unit has changed since the comparison: verify again.";
  if (controller.verified()) return {};
  if (controller.sent_is_current() && controller.verdict() && !controller.verdict()->same())
    return "Step 9: this map is not in the unit: send it again in step 8.";
  if (!controller.sent_is_current()) return "Next: save, check and send the map in step 8.";
  return "Next: read the map back and compare in step 9.";
}

}  // namespace

LaserScreen::LaserScreen(std::shared_ptr<UnitConnection> unit) : host_(std::make_unique<LaserHost>(std::move(unit))) {
  for (std::size_t k = 0; k < pages_.size(); ++k) pages_[k] = kLaserStepRows[k].page(*host_);
}

/// Two, or as many as a long message needs: it is to be read whole.
int LaserScreen::message_rows(const Area& area) const {
  const LaserController& controller = host_->controller;
  if (controller.busy()) return 2;
  const int rows = controller.message().text().empty()
                       ? static_cast<int>(wrapped(bottom_text(), area.columns - 2).size())
                       : rows_of_message(controller.message(), area.columns - 2, area.rows / 2);
  return std::clamp(rows, 2, std::max(2, area.rows / 2));
}

Area LaserScreen::body_of(const Area& area) const {
  return {area.row + 1, area.column, std::max(0, area.rows - 1 - message_rows(area)), area.columns};
}

std::array<LaserScreen::Tab, kLaserSteps> LaserScreen::tabs(int columns) const {
  std::array<Tab, kLaserSteps> tabs;
  int column = 0;
  for (std::size_t k = 0; k < tabs.size(); ++k) {
    const bool here = static_cast<LaserStep>(k) == step_;
    tabs[k] = {column, columns >= kRoomForNames || here ? kLaserStepRows[k].name : ""};
    column += 3 + width_of(tabs[k].name) + (here ? 1 : 0);
  }
  return tabs;
}

void LaserScreen::draw_tabs(Canvas& canvas, const Area& area) const {
  drawn_ = area;
  const auto all = tabs(area.columns);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const LaserMark mark = host_->controller.mark(static_cast<LaserStep>(k));
    const bool here = static_cast<LaserStep>(k) == step_;
    const Tone tone = here ? Tone::strong : Tone::plain;
    canvas.text(area, 0, all[k].column, fmt::format("{}{}", here ? '[' : ' ', k + 1), tone);
    canvas.text(area, 0, all[k].column + 2, std::string(1, sign_of(mark)), tone_of(mark));
    canvas.text(area, 0, all[k].column + 3, all[k].name + (here ? "]" : ""), tone);
  }
}

/// A click on a tab goes there.
void LaserScreen::click(const Key& key) {
  if (key.row != drawn_.row) return;
  const auto all = tabs(drawn_.columns);
  for (std::size_t k = all.size(); k-- > 0;)
    if (key.column >= drawn_.column + all[k].column) return go(static_cast<int>(k));
}

/// What to do next, and that the unit belongs to another machine.
std::string LaserScreen::bottom_text() const {
  const LaserController& controller = host_->controller;
  const std::string next = next_to_do(controller);
  return next + (next.empty() || controller.other_unit().empty() ? "" : " ") + controller.other_unit();
}

void LaserScreen::draw_bottom(Canvas& canvas, const Area& area) const {
  const LaserController& controller = host_->controller;
  if (controller.busy())
    draw_progress(canvas, {area.row, area.column + 1, 1, area.columns - 2}, 0,
                  controller.task().label() + " (press Esc to stop)", controller.task().part(),
                  controller.task().seconds_left());
  else if (!controller.message().text().empty())
    draw_message(canvas, area.between_margins(), controller.message());
  else if (controller.working())
    canvas.text(area, 0, 1, "computing the results ...", Tone::faint);
  else
    canvas.paragraph(area.between_margins(), 0, bottom_text(), controller.mismatch().empty() ? Tone::faint : Tone::bad);
}

void LaserScreen::draw(Canvas& canvas, const Area& area) const {
  draw_tabs(canvas, area.top(1));
  const Area body = body_of(area);
  page().draw(canvas, body);
  const int rows = message_rows(area);
  if (area.rows > rows) draw_bottom(canvas, {area.row + area.rows - rows, area.column, rows, area.columns});
  if (const auto& draft = host_->controller.offered(); draft && !host_->asking_.active()) {
    const std::size_t aside = host_->controller.drafts_aside();
    const std::string& of = host_->controller.offered_of();
    const std::string& saved = host_->controller.offered_saved();
    draw_question(canvas, area,
                  {fmt::format("{} of {} found{}{}{}", saved.empty() ? "Unsaved work" : "Work", draft->kept,
                               of.empty() ? "" : ": ", of, saved.empty() ? "" : fmt::format(" ({})", saved)),
                   "It contains the files, exclusions, slopes, smoothing and header. Press b to begin new work: this "
                   "work is kept and offered again later." +
                       (aside == 0 ? "" : fmt::format(" Press o for another one: {} more.", aside)),
                   "continue it (or Enter)", "not now    b start again    d delete it"});
  }
  if (host_->mapping_) host_->mapping_->draw(canvas, area);
  if (host_->form_) host_->form_->draw(canvas, area);
  draw_question(canvas, area, host_->asking_);
}

CellPosition LaserScreen::cursor(const Area& area) const {
  if (host_->asking_.active() || host_->controller.offered()) return {-1, -1};
  if (host_->mapping_) return host_->mapping_->cursor(area);
  return host_->form_ ? host_->form_->cursor(area) : page().cursor(body_of(area));
}

std::vector<KeyRow> LaserScreen::offered_table() {
  LaserController& controller = host_->controller;
  const auto take_up = [&controller] { controller.take_up_offered(); };
  const auto drop = [this, &controller] {
    host_->ask({"Delete the work?", fmt::format("The choices made at {} will be lost.", controller.offered()->kept),
                "drop", "keep it"},
               [&controller] { controller.drop_offered(); });
  };
  return {{"Enter", "continue", take_up},
          {"y Y", "", take_up},
          {"b", "start again, keep it", [&controller] { controller.set_offered_aside(); }},
          {"o", "another", [&controller] { controller.offer_another(); }},
          {"d", "delete", drop},
          {"Esc", "back"}};
}

/// What lies over the step gets every key. @return whether something did
bool LaserScreen::on_lying_over(const Key& key) {
  if (answers(host_->asking_, key)) return true;
  if (host_->controller.offered()) {
    (void)act_on(offered_keys_, key);
    return true;
  }
  if (host_->mapping_) {
    if (!host_->mapping_->on_key(key)) host_->after_mapping(key.name == Key::Name::enter);
    return true;
  }
  if (host_->form_) {
    if (!host_->form_->on_key(key)) host_->form_.reset();
    return true;
  }
  return false;
}

void LaserScreen::go(int step) { step_ = static_cast<LaserStep>((step + kLaserSteps) % kLaserSteps); }

void LaserScreen::open(const std::vector<std::string>& paths, FileKind kind, const std::string& parameters) {
  LaserController& controller = host_->controller;
  if (controller.offered()) controller.set_offered_aside();
  if (kind == FileKind::map) return controller.open_map(paths.front(), parameters);
  controller.change(fmt::format("{} files", paths.size()), [&](LaserChoices& choices) {
    for (const std::string& path : paths) choices.files.push_back({path, {}});
    if (!parameters.empty()) choices.params_file = parameters;
  });
  host_->ask_columns(paths);
}

std::vector<KeyRow> LaserScreen::key_table() {
  const auto step = [this](int by) { return [this, by] { go(static_cast<int>(step_) + by); }; };
  return {{"n", "next step", step(1)},
          {"y", "redo", [this] { host_->controller.redo(); }},
          {"s", "save the map", [this] { host_->unless_there([this] { host_->controller.save(); }); }},
          {"Tab", "", step(1)},
          {"Shift-Tab", "", step(-1)},
          {"u Ctrl-Z", "", [this] { host_->controller.undo(); }},
          {"p", "", [this] { host_->ask_parameters(); }}};
}

Step LaserScreen::on_key(const Key& key) {
  LaserController& controller = host_->controller;
  if (controller.offered() && !host_->asking_.active() && reply_to(key) == Reply::no) return back();
  if (on_lying_over(key)) return leaving_ ? back() : stay();
  if (controller.busy() && key.name == Key::Name::escape) {
    controller.cancel();
    return stay();
  }
  if (!controller.busy()) controller.message().clear();
  if (page().holds_keys()) {
    (void)page().on_key(key);
    return stay();
  }
  if (key.name == Key::Name::escape && page().on_escape()) return stay();
  if (key.name == Key::Name::escape) {
    if (controller.unsaved().empty()) return back();
    host_->ask({"Leave? The map is not saved.", "The choices are kept and offered again next time.", "leave", "stay"},
               [this] { leaving_ = true; });
  } else if (key.name == Key::Name::mouse) {
    click(key);
  } else if (key.name == Key::Name::letter && key.letter >= U'1' && key.letter < U'1' + kLaserSteps) {
    go(static_cast<int>(key.letter - U'1'));
  } else if (!page().on_key(key)) {
    (void)act_on(keys_, key);
  }
  return stay();
}

bool LaserScreen::advance() {
  bool changed = host_->controller.advance();
  changed = host_->drawing_.advance() || changed;
  changed = page().advance() || changed;
  if (host_->form_) changed = host_->form_->advance() || changed;
  return changed;
}

std::vector<KeyHelp> LaserScreen::keys() const {
  if (host_->asking_.active()) return {{"y", "yes"}, {"n", "no"}};
  if (host_->controller.offered()) return helps_of(offered_keys_);
  if (host_->mapping_) return host_->mapping_->keys();
  if (host_->form_) return {{"Enter", "accept"}, {"up/down", "field"}, {"Esc", "cancel"}};
  std::vector<KeyHelp> keys = page().keys();
  if (page().holds_keys()) return keys;
  keys.insert(keys.begin() + std::min<std::ptrdiff_t>(3, std::ssize(keys)), {"1-9", "step"});
  for (KeyHelp& own : helps_of(keys_)) keys.push_back(std::move(own));
  return keys;
}

std::string LaserScreen::help() const {
  return std::string(kLaserStepRows[static_cast<std::size_t>(step_)].help) +
         " Marks: + done; ! needs attention; . not done yet. Press a digit to go to that step at any time. A change "
         "in one step updates all later steps.";
}

}  // namespace ecs::app
