// How the model screen looks.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/screens/model/screen.hpp"
#include "app/ui/widgets.hpp"
#include "base/text.hpp"
#include "commissioning/models/plots.hpp"
#include "commissioning/models/view.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::app {
namespace {

constexpr const char* kTitles[] = {"Curves", "Compare", "Missing", "Ladder", "Next", "After"};

constexpr int kCauseNumbers = 39;  ///< columns behind the name of a cause

/// "cyclic:X:EX    4.81 -> 0.55   98.7 %   < 0.5 %   1 rival"
ListRow cause_row(const model::Candidate& candidate, const model::Diagnosis& diagnosis, int name_columns) {
  const std::string rivals = candidate.rivals.empty() ? ""
                                                      : fmt::format("{} rival{}", candidate.rivals.size(),
                                                                    candidate.rivals.size() == 1 ? "" : "s");
  return {fmt::format("{} {:>7.3f} -> {:<7.3f} {:>5.1f} %  {}", in_columns(place_text(candidate.effect), name_columns),
                      diagnosis.rms_um, candidate.rms_after_um, 100.0 * candidate.shown_explained(), rivals),
          candidate.named         ? Tone::strong
          : candidate.in_answer() ? Tone::warning
                                  : Tone::plain};
}

/// Nothing is missing, and nothing is held against that.
bool is_adequate(const model::Diagnosis& diagnosis) {
  return diagnosis.verdict == model::Verdict::adequate && diagnosis.reservation.empty();
}

std::string rung_text(const model::Model& model, const model::LadderStep& step) {
  if (step.effect.empty()) return "start";
  return step.effect.starts_with("without ") ? step.effect : "+ " + name_with_alternatives(model, step.effect);
}

/// "cause             lost motion in the drive", the text in a column of its own.
std::vector<std::string> fact_lines(const std::vector<EffectFact>& facts, int columns) {
  int labels = 0;
  for (const EffectFact& fact : facts) labels = std::max(labels, width_of(fact.label) + 2);
  std::vector<std::string> lines;
  for (const EffectFact& fact : facts) {
    std::string label = fact.label;
    for (const std::string& line : wrapped(fact.text, std::max(10, columns - labels - 1))) {
      lines.push_back(in_columns(label, labels) + line);
      label.clear();
    }
  }
  return lines;
}

}  // namespace

void ModelScreen::draw(Canvas& canvas, const Area& area) const {
  if (prompt_.choosing()) return prompt_.draw(canvas, area, 0);
  draw_tabs(canvas, area.top(1));
  const int state_part = state_rows(area);
  const Area body{area.row + 1, area.column, std::max(0, area.rows - 1 - state_part), area.columns};
  switch (page_) {
    case Page::curves:
      draw_curves(canvas, body);
      break;
    case Page::causes:
      draw_causes(canvas, body);
      break;
    case Page::ladder:
      draw_ladder(canvas, body);
      break;
    case Page::next:
      if (std::ranges::any_of(parts_, [&](const NextPart& part) { return part.draw(canvas, body, scroll_); })) break;
      [[fallthrough]];
    default:
      draw_scrolled(canvas, body, lines_of_page(body.columns - 1), scroll_);
  }
  draw_state(canvas, {area.row + area.rows - state_part, area.column, state_part, area.columns});
  prompt_.draw(canvas, area, area.rows - 1);
  if (draft_)
    draw_question(canvas, area,
                  {"Unsaved work on this model was found. Continue it?",
                   fmt::format("It was kept {}, when the program ended without saving {}.", draft_->kept,
                               controller_->model_file()),
                   "continue", "not now    d delete it"});
  else if (leaving_)
    draw_question(
        canvas, area,
        {"Leave without saving the model?", controller_->model_file() + " remains unchanged.", "leave", "stay"});
  else
    draw_question(canvas, area, asking_);
}

void ModelScreen::draw_tabs(Canvas& canvas, const Area& area) const {
  const bool room = area.columns >= 68;  // else only the page that is seen has its name
  int column = 1;
  for (int p = 0; p < kPages; ++p) {
    const bool here = static_cast<Page>(p) == page_;
    const std::string name = room || here ? fmt::format("{} {}", p + 1, kTitles[p]) : fmt::format("{}", p + 1);
    column +=
        canvas.text(area, 0, column, (here ? "[" : " ") + name + (here ? "]" : " "), here ? Tone::strong : Tone::faint);
  }
  const std::string file = std::filesystem::path(controller_->model_file()).filename().string();
  if (column + width_of(file) + 2 <= area.columns) canvas.text_right(area.left(area.columns - 1), 0, file, Tone::faint);
}

/// What the last rows say while nothing is asked and nothing was told.
std::string ModelScreen::state_text() const {
  const model::Fit& fit = controller_->fit();
  const std::size_t effects = controller_->model().effects.size();
  return fmt::format("{} readings, {} effect{}: rms {:.3f} {}, noise of one reading {}{:.3f} {}",
                     controller_->data().size(), effects, effects == 1 ? "" : "s", fit.rms_um, fit.noise.unit,
                     fit.noise.is_upper_limit() ? "at most " : "", fit.noise.noise_um, fit.noise.unit);
}

int ModelScreen::state_rows(const Area& area) const {
  if (controller_->busy()) return 1;
  if (prompt_.active()) return 2;
  const int most = std::max(1, area.rows / 4);
  if (!controller_->message().text().empty()) return rows_of_message(controller_->message(), area.columns - 2, most);
  return std::min(most, static_cast<int>(wrapped(state_text(), area.columns - 2).size()));
}

void ModelScreen::draw_state(Canvas& canvas, const Area& area) const {
  const Area text = area.between_margins();
  if (controller_->busy()) {
    canvas.paragraph(
        text, 0, fmt::format("{} ... {:.0f} s, Esc cancels", controller_->working_on(), controller_->seconds_working()),
        Tone::warning);
  } else if (!controller_->message().text().empty()) {
    draw_message(canvas, text, controller_->message());
  } else {
    canvas.paragraph(text, 0, state_text());
  }
}

void ModelScreen::draw_curves(Canvas& canvas, const Area& area) const {
  if (controller_->lines().empty()) return;
  const Curves& shown = curves();
  const int upper = std::max(8, area.rows * 3 / 5);
  draw_chart(canvas, area.top(upper), shown.measured, view_);
  if (area.rows - upper >= 6) {
    const std::size_t which = std::min(residual_, shown.residual.size() - 1);
    draw_chart(canvas, area.below(upper), shown.residual[which], which == 0 ? residual_view() : ChartView{});
  }
  canvas.text_right({area.row + upper, area.column, 1, area.columns - 8}, 0,
                    fmt::format("line {} of {}", line_ + 1, controller_->lines().size()), Tone::faint);
}

const ModelScreen::Curves& ModelScreen::curves() const {
  if (curves_.generation == controller_->generation() && curves_.line == line_ && curves_.shown == shown_)
    return curves_;
  const MeasuredLine& line = controller_->lines()[static_cast<std::size_t>(line_)];
  const model::Observations& data = controller_->data();
  const model::Fit& fit = controller_->fit();
  curves_ = {controller_->generation(),
             line_,
             shown_,
             measured_panel(data, fit, line, shown_),
             {residual_panel(data, fit, line, shown_)}};
  for (PlotPanel& panel : residual_panels_of_variables(data, fit, line)) curves_.residual.push_back(std::move(panel));
  return curves_;
}

/// As the curves above it, but on the widest scale since the line was first seen: that the error falls is seen. 0 lets
/// the scale go.
ChartView ModelScreen::residual_view() const {
  PlotRange& widest = widest_[line_];
  for (const PlotSeries& series : curves().residual.front().series)
    for (const PlotPoint& point : series.points) widest.take(point.y);
  ChartView view = view_;
  if (widest.width() > 0.0 && !view.y_from) {
    view.y_from = widest.from;
    view.y_to = widest.to;
  }
  return view;
}

void ModelScreen::draw_causes(Canvas& canvas, const Area& area) const {
  const Area text = area.between_margins();
  if (!controller_->diagnosis()) {
    canvas.paragraph(text, 1,
                     controller_->busy() ? "Every effect of the library is being tried on the residual."
                                         : "Press d to try every effect of the library on the residual and compare it "
                                           "with noise simulated for this data set.");
    return;
  }
  const model::Diagnosis& d = *controller_->diagnosis();
  if (opened_ != Opened::list && !d.candidates.empty()) {
    const model::Candidate& opened = d.candidates[chosen_cause()];
    const bool details = opened_ == Opened::details;
    canvas.text(text, 0, 0, fmt::format("{}: {}", place_text(opened.effect), details ? "details" : "evidence"),
                Tone::strong);
    draw_scrolled(canvas, text.below(2),
                  fact_lines(details ? details_of(opened) : evidence_of(opened, d), text.columns), scroll_);
    return;
  }
  const Tone tone = is_adequate(d) ? Tone::good : Tone::warning;
  const bool idle = d.verdict == model::Verdict::adequate && !d.candidates.empty();
  int row = canvas.paragraph(text, 0, d.headline + (idle ? " The candidates below are not significant." : ""), tone);
  if (d.candidates.empty()) {
    const Area wide{area.row + row, area.column, area.rows - row, area.columns};  // its lines are made for 80 columns
    draw_scrolled(canvas, wide, sentences_wrapped(owned_lines_of(diagnosis_text(d)), wide.columns), scroll_);
    return;
  }
  int names = 24;  // as wide as the longest, where the numbers leave room
  for (const model::Candidate& candidate : d.candidates)
    names = std::max(names, width_of(place_text(candidate.effect)));
  names = std::clamp(text.columns - 2 - kCauseNumbers, 12, names);
  canvas.text(text, row++, 2,
              fmt::format("{:<{}} {:>18} variance explained", "effect:axis:sense", names,
                          fmt::format("rms {}", d.noise.unit == "um/m" ? "um/m" : "um")),
              Tone::faint);
  std::vector<ListRow> rows;
  for (const model::Candidate& candidate : d.candidates) rows.push_back(cause_row(candidate, d, names));
  const int list_rows = std::min(static_cast<int>(rows.size()), std::max(2, (text.rows - row) / 3));
  draw_list(canvas, {text.row + row, text.column, list_rows, text.columns}, rows, cause_);
  row += list_rows + 1;
  const model::Candidate& candidate = d.candidates[chosen_cause()];
  const Area detail{text.row + row, text.column, text.rows - row, text.columns};
  int at = canvas.paragraph(detail, 0, candidate.because);
  at += canvas.paragraph(detail, at, parameters_text(candidate.parameters), Tone::strong);
  std::vector<std::string> rivals;
  for (const model::EffectInstance& rival : candidate.rivals) rivals.push_back(place_text(rival));
  if (!candidate.but.empty())
    at += canvas.paragraph(detail, at,
                           fmt::format("Likely, but not proved: {}. {} to be sure.", candidate.but, candidate.decide),
                           Tone::warning);
  if (!rivals.empty())
    at += canvas.paragraph(
        detail, at, fmt::format("These data cannot distinguish it from: {}.", fmt::join(rivals, ", ")), Tone::warning);
  at += canvas.paragraph(
      detail, at,
      (d.verdict == model::Verdict::adequate ? "To test this effect: " : "Next: ") + candidate.next_measurement,
      Tone::faint);
  std::vector<std::string> left;
  for (const model::LeftProperty& one : d.left)
    if (!one.is.empty()) left.push_back(one.property + " " + one.is);
  if (!left.empty()) at += canvas.paragraph(detail, at, fmt::format("Residual: {}.", fmt::join(left, ", ")));
  if (d.formula)
    canvas.paragraph(detail, at,
                     fmt::format("Press f to add it as a formula: {:.3g} -> {:.3g} {} rms of held-out readings.",
                                 d.formula->held_out_rms_before_um, d.formula->held_out_rms_um, d.noise.unit));
}

void ModelScreen::draw_ladder(Canvas& canvas, const Area& area) const {
  const Area text = area.between_margins();
  const auto& history = controller_->model().history;
  std::vector<std::pair<std::string, double>> rungs;
  if (history.empty()) rungs.emplace_back("present model", controller_->fit().rms_um);
  if (!history.empty() && !history.front().effect.empty()) rungs.emplace_back("before", history.front().rms_before_um);
  for (const model::LadderStep& step : history) rungs.emplace_back(rung_text(controller_->model(), step), step.rms_um);
  double most = controller_->fit().rms_um;
  for (const auto& [name, rms_um] : rungs) most = std::max(most, rms_um);

  constexpr int kNumbers = 10;
  const int names = std::clamp(text.columns / 2, 8, 34);
  const Area bars = text.right_of(names + kNumbers);
  canvas.text(text.left(names - 1), 0, 0, "step", Tone::faint);
  canvas.text(text, 0, names, rms_heading(unit_of_model(controller_->model())), Tone::faint);
  int row = 1;
  const auto rung = [&](const std::string& name, double rms_um, Tone tone, Tone bar) {
    canvas.text(text.left(names - 1), row, 0, name, tone);
    canvas.text(text, row, names, fmt::format("{:.3f}", rms_um), tone == Tone::plain ? Tone::strong : tone);
    draw_bar(canvas, bars, row++, rms_um, most, bar);
  };
  const auto room = static_cast<std::size_t>(std::max(2, area.rows * 2 / 3 - 3));  // the newest, all in the table below
  for (std::size_t k = rungs.size() > room ? rungs.size() - room : 0; k < rungs.size(); ++k)
    rung(rungs[k].first, rungs[k].second, Tone::plain, Tone::forward);
  const auto& noise = controller_->fit().noise;
  rung(noise.is_upper_limit() ? "noise of one reading, at most" : "noise of one reading", noise.noise_um, Tone::faint,
       Tone::faint);
  const Area below = area.below(row + 1);
  int widest = 12;
  for (const model::EffectFit& effect : controller_->fit().effects)
    widest = std::max(widest, width_of(name_with_alternatives(effect.effect)));
  widest = std::min(widest, below.columns / 2);
  std::vector<ListRow> effects;
  for (const model::EffectFit& effect : controller_->fit().effects)
    effects.push_back({fmt::format("{}  {}", in_columns(name_with_alternatives(effect.effect), widest),
                                   parameters_text(effect.parameters)),
                       Tone::plain});
  canvas.text(below.between_margins(), 0, 1, "effects of the model and their values; press x to remove one",
              Tone::faint);
  const auto chosen = static_cast<std::size_t>(std::clamp(effect_.selected, 0, static_cast<int>(effects.size()) - 1));
  const Area list = below.between_margins().below(1);
  const std::string whole = effects.empty() ? "" : parameters_text(controller_->fit().effects[chosen].parameters);
  const int value_rows = widest + 6 + width_of(whole) > list.columns && list.rows > 6
                             ? static_cast<int>(wrapped(whole, list.columns - 2).size())
                             : 0;  // the chosen one's, where its row is too short for them
  draw_list(canvas, list.top(list.rows - value_rows), effects, effect_);
  if (value_rows > 0) canvas.paragraph(list.below(list.rows - value_rows), 0, whole, Tone::strong);
}

std::vector<std::string> ModelScreen::after_lines(int columns) const {
  if (const auto& planned = controller_->planned_map(); planned && !planned->missing.empty()) {
    std::vector<std::string> lines =
        wrapped(fmt::format("The unit needs {} components for which the model has no effect. They can be declared "
                            "zero, with a reason that is saved in the map:",
                            planned->missing.size()),
                columns);
    for (const Component c : planned->missing)
      lines.push_back(fmt::format("  {}  {}", name_of(c), laser::description_of(c)));
    return lines;
  }
  if (!controller_->after().empty()) return sentences_wrapped(controller_->after(), columns + 1);
  return wrapped(
      "Press w to compute the error after compensation by the unit, effect by effect. Press m to build the map of the "
      "model; missing components are shown and can be declared zero. Press t to send the map to the unit and c to "
      "switch the unit to compensation. Press o to open files measured again with the unit compensating and to compare "
      "the achieved error with the predicted one.",
      columns);
}

std::vector<std::string> ModelScreen::lines_of_page(int columns) const {
  if (page_ == Page::fails) return sentences_wrapped(controller_->comparison(), columns + 1);
  if (page_ == Page::after) return after_lines(columns);
  if (!controller_->next())
    return wrapped("Press d first: the next measurement depends on the diagnosis." + said_by_parts(&NextPart::hint),
                   columns);
  std::vector<std::string> lines;
  const auto add = [&](const std::string& text) {
    for (std::string& line : wrapped(text, columns)) lines.push_back(std::move(line));
    lines.emplace_back();
  };
  std::size_t number = 0;
  const auto& diagnosis = controller_->diagnosis();
  if (diagnosis && diagnosis->verdict == model::Verdict::adequate && !controller_->next()->proposals.empty())
    add(is_adequate(*diagnosis) ? "The model explains the readings. These measurements would show smaller causes:"
                                : "The model explains the readings, with the reservation on page 3. These measurements "
                                  "would show other causes:");
  else if (!controller_->next()->rivals.empty())
    add(fmt::format("To distinguish: {}", fmt::join(controller_->next()->rivals, ", ")));
  for (const model::MeasurementProposal& proposal : controller_->next()->proposals) {
    add(fmt::format("{}. {}", ++number, proposal.tells));
    add(proposal.sentence);
  }
  for (const std::string& note : controller_->next()->notes) add(note);
  if (lines.empty()) add("No further measurement is needed to name the cause: it is proved.");
  return lines;
}

}  // namespace ecs::app
