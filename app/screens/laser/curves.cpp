// Step 3: runs and readings left out and taken back, with the curve. Step 4: slope and smoothing of every curve, before
// and after.
#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "app/screens/laser/screen.hpp"
#include "base/text.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::app {
namespace {

/// A row of the tree: a run, or one of its readings.
struct TreeRow {
  int run = 0;
  std::optional<std::size_t> reading;  ///< by its place in the line
};

class LeaveOutPage final : public LaserPage {
 public:
  explicit LeaveOutPage(LaserHost& host) : LaserPage(host) {
    const auto lines = [this] { return !in_tree_; };
    const auto tree = [this] { return in_tree_; };
    const auto change_side = [this] { in_tree_ = !in_tree_; };
    const auto to_runs_first = [this] {
      controller().message().say("Press Enter first to go to the runs of this line.", Tone::warning);
    };
    rows_ = {{"up/down", "line", {}, lines},
             {"Enter", "runs of the line", change_side, lines},
             {"Space w", "", to_runs_first, lines},
             {"Space", "out or in", [this] { toggle(line(), row()); }, tree},
             {"Enter", "readings of a run", [this] { open_or_close(row()); }, tree},
             {"w", "why", [this] { ask_reason(line(), row()); }, tree},
             {"o", "next outlier", [this] { to_next_suspect(line()); }},
             {"Tab", "lines", change_side, tree, true},
             {"Shift-Tab", "", change_side},
             {"u", "undo"},
             {"left/right", "cursor", {}, lines},
             {"+ - 0", "zoom", {}, lines},
             {"e", "picture", [this] { export_line(line(), controller().work().results[at()]); }, lines, true}};
  }

  void draw(Canvas& canvas, const Area& area) const override {
    const LaserWork& work = controller().work();
    if (work.lines.empty()) return draw_nothing_yet(canvas, area, "No measured lines yet: add files in step 1.");
    const LaserHalves halves = laser_halves(area);
    const LaserLine& line = this->line();
    const auto tree = tree_of(line);
    const int tree_rows = std::min(static_cast<int>(tree.size()) + 1, halves.list.rows / 2);
    const int upper = std::min(static_cast<int>(work.lines.size()), halves.list.rows - tree_rows);
    draw_list(canvas, halves.list.top(upper), rows_of_lines(work), line_, !in_tree_);
    std::vector<ListRow> rows;
    for (const TreeRow& row : tree) rows.push_back(picture_of(line, row));
    const Area lower = halves.list.below(upper);
    if (lower.rows > 1) {
      canvas.text(lower, 0, 0, fmt::format("{}, {}", name_of_line(line), line.place), Tone::faint);
      draw_list(canvas, lower.below(1), rows, tree_, in_tree_);
    }
    if (halves.rest.columns == 0) return;
    const LaserLineResult& result = work.results[at()];
    ChartView view = view_;
    if (in_tree_ && place_within(tree_, tree.size()) < tree.size())
      if (const auto& reading = tree[place_within(tree_, tree.size())].reading)
        view.cursor_x = laser::target_mm(line.set->readings[*reading]);
    const std::string text = text_about(line, result);
    const int text_rows = std::clamp(static_cast<int>(wrapped(text, halves.rest.columns).size()), 2, 4);
    draw_laser_chart(canvas, halves.rest.top(halves.rest.rows - text_rows), result.panel, result.left_out, view);
    const Tone tone = !result.problem.empty() ? Tone::bad : (result.left_out.empty() ? Tone::plain : Tone::warning);
    canvas.paragraph(halves.rest.below(halves.rest.rows - text_rows), 0, text, tone);
  }

  bool on_key(const Key& key) override {
    const LaserWork& work = controller().work();
    if (work.lines.empty()) return false;
    if (act_on(rows_, key)) return true;
    if (in_tree_) {
      if (tree_.on_key(key, static_cast<int>(tree_of(line()).size()))) return true;
    } else if (line_.on_key(key, static_cast<int>(work.lines.size()))) {
      tree_ = {};
      open_.clear();
      view_ = {};
      return true;
    }
    return on_laser_chart_key(key, work.results[at()].panel, work.results[at()].left_out, view_);
  }

  bool on_escape() override { return std::exchange(in_tree_, false); }

 private:
  /// "18 of 54 readings left out (x); 1 stands out (?): o goes there"
  [[nodiscard]] std::string text_about(const LaserLine& line, const LaserLineResult& result) const {
    const std::size_t out = count_left_out(choice_of(line), *line.set);
    std::string text = result.problem;
    const auto add = [&text](const std::string& more) { text += (text.empty() ? "" : "; ") + more; };
    if (out == 0)
      add("no readings excluded");
    else if (out != result.left_out.size())
      add(fmt::format("{} of {} readings excluded, computing", out, line.set->readings.size()));
    else
      add(fmt::format("{} of {} readings excluded (x)", out, line.set->readings.size()));
    const std::string beyond = beyond_text(result.panel, result.left_out, laser::unit_of(line.group.sense));
    if (!beyond.empty()) add(beyond);
    const LaserLineChoice choice = choice_of(line);
    const auto suspects = std::count_if(line.suspects.begin(), line.suspects.end(),
                                        [&](std::size_t i) { return !left_out(choice, *line.set, i); });
    if (suspects > 0) add(fmt::format("{} differ{} from the repeats (?): press o", suspects, suspects == 1 ? "s" : ""));
    return text;
  }

  [[nodiscard]] std::size_t at() const { return place_within(line_, controller().work().lines.size()); }
  /// @pre there are lines
  [[nodiscard]] const LaserLine& line() const { return controller().work().lines[at()]; }
  [[nodiscard]] TreeRow row() const {
    const auto tree = tree_of(line());
    return tree[place_within(tree_, tree.size())];
  }

  /// As chosen now, also while the curves are still worked out.
  [[nodiscard]] LaserLineChoice choice_of(const LaserLine& line) const {
    return choice_for_line(controller().choices(), line);
  }

  [[nodiscard]] std::vector<TreeRow> tree_of(const LaserLine& line) const {
    std::set<int> runs;
    for (const laser::Reading& reading : line.set->readings) runs.insert(reading.run);
    std::vector<TreeRow> tree;
    for (const int run : runs) {
      tree.push_back({run, std::nullopt});
      if (!open_.contains(run)) continue;
      for (std::size_t i = 0; i < line.set->readings.size(); ++i)
        if (line.set->readings[i].run == run) tree.push_back({run, i});
    }
    return tree;
  }

  [[nodiscard]] ListRow picture_of(const LaserLine& line, const TreeRow& row) const {
    const LaserLineChoice choice = choice_of(line);
    if (!row.reading) {
      const auto out = choice.runs.find(row.run);
      const bool suspect = std::any_of(line.suspects.begin(), line.suspects.end(),
                                       [&](std::size_t i) { return line.set->readings[i].run == row.run; });
      return {fmt::format("{} {}run {} {}", out == choice.runs.end() ? "in " : "OUT", suspect ? '?' : ' ', row.run,
                          out == choice.runs.end() ? "" : out->second),
              out == choice.runs.end() ? Tone::plain : Tone::warning};
    }
    const laser::Reading& reading = line.set->readings[*row.reading];
    const bool out = left_out(choice, *line.set, *row.reading);
    const bool suspect = std::binary_search(line.suspects.begin(), line.suspects.end(), *row.reading);
    const char* way =
        reading.approach == Approach::forward ? "fwd" : (reading.approach == Approach::reverse ? "rev" : "");
    return {fmt::format(" {}{}{:>7.6g} {:<3}{:>7.2f}", out ? "OUT" : "in ", suspect ? '?' : ' ',
                        laser::target_mm(reading), way, reading.error),
            out ? Tone::warning : Tone::plain};
  }

  void open_or_close(const TreeRow& row) {
    if (!row.reading && open_.erase(row.run) == 0) open_.insert(row.run);
  }

  void export_line(const LaserLine& line, const LaserLineResult& result) {
    host().export_picture({name_of_line(line) + ", " + line.place,
                           {with_left_out(result.panel, result.left_out, laser::unit_of(line.group.sense))},
                           1,
                           true},
                          std::string(name_of(line.component)));
  }

  void toggle(const LaserLine& line, const TreeRow& row) {
    if (row.reading && choice_of(line).runs.contains(row.run))
      return controller().message().say(
          fmt::format("the whole run {} is excluded: press Space on the run to include it", row.run), Tone::warning);
    const bool is_out =
        row.reading ? choice_of(line).readings.contains(*row.reading) : choice_of(line).runs.contains(row.run);
    const std::string what = row.reading ? fmt::format("a reading of {}", name_of_line(line))
                                         : fmt::format("run {} of {}", row.run, name_of_line(line));
    controller().change(what + (is_out ? " included again" : " excluded"), [&](LaserChoices& c) {
      LaserLineChoice& choice = c.lines[line.key];
      if (row.reading && is_out) choice.readings.erase(*row.reading);
      if (row.reading && !is_out) choice.readings.emplace(*row.reading, "");
      if (!row.reading && is_out) choice.runs.erase(row.run);
      if (!row.reading && !is_out) choice.runs.emplace(row.run, "");
    });
  }

  void ask_reason(const LaserLine& line, const TreeRow& row) {
    const LaserLineChoice choice = choice_of(line);
    const bool is_out = row.reading ? choice.readings.contains(*row.reading) : choice.runs.contains(row.run);
    if (!is_out) return controller().message().say("exclude it first (Space), then enter the reason", Tone::warning);
    const std::string now = row.reading ? choice.readings.at(*row.reading) : choice.runs.at(row.run);
    host().fill(LaserForm("reason for excluding it",
                          {{"reason", "saved with the map: cold machine, beam broken, ...", now}},
                          [this, key = line.key, row](const std::vector<std::string>& v) {
                            controller().change("a reason", [&](LaserChoices& c) {
                              if (row.reading)
                                c.lines[key].readings[*row.reading] = v[0];
                              else
                                c.lines[key].runs[row.run] = v[0];
                            });
                            return std::string();
                          }));
  }

  /// The next reading of this line that stands out, its run opened.
  void to_next_suspect(const LaserLine& line) {
    if (line.suspects.empty()) return controller().message().say("No reading of this line differs from its repeats.");
    const auto before = tree_of(line);
    const std::size_t here = place_within(tree_, before.size());
    const std::size_t from = in_tree_ && here < before.size() && before[here].reading ? *before[here].reading + 1 : 0;
    auto next = std::lower_bound(line.suspects.begin(), line.suspects.end(), from);
    if (next == line.suspects.end()) next = line.suspects.begin();
    open_.insert(line.set->readings[*next].run);
    const auto tree = tree_of(line);
    for (std::size_t k = 0; k < tree.size(); ++k)
      if (tree[k].reading == *next) tree_.selected = static_cast<int>(k);
    in_tree_ = true;
  }

  ListPlace line_, tree_;
  std::set<int> open_;  ///< runs whose readings are shown
  bool in_tree_ = false;
  ChartView view_;
};

}  // namespace

std::unique_ptr<LaserPage> laser_leave_out_page(LaserHost& host) { return std::make_unique<LeaveOutPage>(host); }

namespace {

std::string words_for(laser::SlopeMethod method) {
  if (method == laser::SlopeMethod::none) return "slope kept";
  return method == laser::SlopeMethod::end_points ? "slope by end points" : "slope by least squares";
}

const char* words_for(laser::Taken taken) {
  if (taken == laser::Taken::noise) return "noise, by the repeats";
  if (taken == laser::Taken::signal) return "part of the shape: use less";
  return "no repeats to judge it by";
}

/// "least", "end", "-": what stands in the list.
std::string short_words(laser::SlopeMethod method) {
  if (method == laser::SlopeMethod::none) return "-";
  return method == laser::SlopeMethod::end_points ? "ends" : "lsq";
}

Tone curve_tone(const LaserCurve& curve) {
  if (!curve.problem.empty()) return Tone::bad;
  return curve.doubtful() ? Tone::warning : Tone::plain;
}

class CurvesPage final : public LaserPage {
 public:
  explicit CurvesPage(LaserHost& host) : LaserPage(host) {
    rows_ = {{"Space", "slope", [this] { next_slope(curve()); }},
             {"Enter", "smoothing, slope, grid", [this] { this->host().fill(form_for(curve())); }},
             {"up/down", "curve"},
             {"v", "before, after, both", [this] { shown_ = static_cast<Shown>((static_cast<int>(shown_) + 1) % 3); }},
             {"u", "undo"},
             {"+ - 0", "zoom"},
             {"left/right", "cursor"},
             {"e", "picture", [this] { export_curve(curve()); }}};
  }

  void draw(Canvas& canvas, const Area& area) const override {
    const LaserWork& work = controller().work();
    if (work.curves.empty())
      return draw_nothing_yet(
          canvas, area,
          work.lines.empty()
              ? "No measured lines yet: add files in step 1."
              : "None of the measured lines is a component of the chosen scope. Step 6 lists the required components.");
    const LaserHalves halves = laser_halves(area);
    const std::string hint =
        work.map.parameters ? "" : "press p to choose the parameters; rows then show components of the map";
    const int hint_rows = hint.empty() ? 0 : std::min(3, halves.list.rows / 4);
    const std::string heading = work.map.parameters
                                    ? fmt::format("{:<4} {:<4} {:>6} {:>6}", "", "slp.", "smooth", "band")
                                    : "line, parked [mm]";
    canvas.text(halves.list, 0, 2, heading, Tone::faint);
    std::vector<ListRow> rows;
    for (const LaserCurve& curve : work.curves) rows.push_back(row_of(work, curve));
    draw_list(
        canvas,
        {halves.list.row + 1, halves.list.column, std::max(0, halves.list.rows - 1 - hint_rows), halves.list.columns},
        rows, place_);
    if (hint_rows > 0)
      canvas.paragraph(
          {halves.list.row + halves.list.rows - hint_rows, halves.list.column, hint_rows, halves.list.columns}, 0, hint,
          Tone::faint);
    if (halves.rest.columns > 0) draw_curve(canvas, halves.rest, work, work.curves[at()]);
  }

  bool on_key(const Key& key) override {
    const auto& curves = controller().work().curves;
    if (curves.empty()) return false;
    if (place_.on_key(key, static_cast<int>(curves.size()))) {
      view_ = {};
      return true;
    }
    return act_on(rows_, key) || on_laser_chart_key(key, curve().before, curve().left_out, view_);
  }

 private:
  [[nodiscard]] std::size_t at() const { return place_within(place_, controller().work().curves.size()); }
  /// @pre there are curves
  [[nodiscard]] const LaserCurve& curve() const { return controller().work().curves[at()]; }

  void next_slope(const LaserCurve& curve) {
    const auto next = static_cast<laser::SlopeMethod>((static_cast<int>(curve.slope) + 1) % 3);
    controller().change(fmt::format("{} of {}", words_for(next), name_of(curve.component)), [&](LaserChoices& c) {
      laser::settings_in(c.recipe, curve.component).slope =
          next == curve.recommended ? std::nullopt : std::optional(next);
    });
  }

  void export_curve(const LaserCurve& curve) {
    const std::string code(name_of(curve.component));
    PlotFigure figure{fmt::format("{}  {}", code, laser::description_of(curve.component)),
                      {with_left_out(curve.before, curve.left_out, unit_of(curve.component))},
                      1,
                      false};
    if (!curve.unchanged) figure.panels.push_back(curve.after);
    host().export_picture(std::move(figure), code);
  }

  /// The choice of now, while the curve may still be that of before.
  [[nodiscard]] laser::ComponentRecipe choice_of(const LaserCurve& curve) const {
    return laser::settings_of(controller().choices().recipe, curve.component);
  }

  /// Without parameters a row is a line, and several may measure the same component: the place tells them apart.
  [[nodiscard]] ListRow row_of(const LaserWork& work, const LaserCurve& curve) const {
    const laser::ComponentRecipe choice = choice_of(curve);
    const std::string smooth = choice.smoothing_mm > 0.0 ? shortest(choice.smoothing_mm) : "-";
    const char* mark = curve.doubtful() ? "!" : "";
    if (!work.map.parameters)
      return {fmt::format("{:<4} {}{}", name_of(curve.component), work.lines[curve.lines.front()].place, mark),
              curve_tone(curve)};
    return {fmt::format("{:<4} {:<4} {:>6} {:>6.1f}{}", name_of(curve.component),
                        short_words(choice.slope.value_or(curve.recommended)), smooth, curve.band_after, mark),
            curve_tone(curve)};
  }

  static std::string text_about(const LaserCurve& curve) {
    if (!curve.problem.empty()) return curve.problem;
    const auto unit = unit_of(curve.component);
    std::string text = curve.unchanged
                           ? fmt::format("band {:.2f} {}", curve.band_before, unit)
                           : fmt::format("band {:.2f} {}, after {:.2f}", curve.band_before, unit, curve.band_after);
    text += fmt::format("; {}", words_for(curve.slope));
    if (curve.slope != laser::SlopeMethod::none) text += fmt::format(" {:.2f} {}/m", curve.removed_per_m, unit);
    if (curve.slope != curve.recommended) text += fmt::format(" (recommended: {})", laser::name_of(curve.recommended));
    if (curve.smoothed)
      text += fmt::format("; smoothing removed {:.2f} {} rms: {}", curve.smoothed->removed_rms, unit,
                          words_for(curve.smoothed->taken));
    if (curve.lines.size() > 1 && curve.left_out_of_lines > 0)
      text += fmt::format("; {} readings excluded", curve.left_out_of_lines);
    return text;
  }

  /// "Y -1400, Z 0"; of two lines what differs of the second: "Y -1400, Z 0 and Z -1000".
  static std::string place_of(const LaserWork& work, const LaserCurve& curve) {
    const std::string& first = work.lines[curve.lines.front()].place;
    std::string text = first;
    if (curve.lines.size() < 2) return text;
    text += " and";
    const auto parts = split(first, ',');
    for (const std::string_view part : split(work.lines[curve.lines[1]].place, ','))
      if (std::find(parts.begin(), parts.end(), part) == parts.end()) text += fmt::format(" {}", trimmed(part));
    return text;
  }

  void draw_curve(Canvas& canvas, const Area& area, const LaserWork& work, const LaserCurve& curve) const {
    const std::string name = fmt::format("{}  {}", name_of(curve.component), laser::description_of(curve.component));
    const std::string place = place_of(work, curve);
    const bool beside = width_of(name) + 2 + width_of(place) <= area.columns;  // else it begins the text below
    const std::string text = (beside ? "" : "at " + place + "; ") + text_about(curve);
    canvas.text(area, 0, 0, name, Tone::strong);
    if (beside) canvas.text_right(area, 0, place);
    const int text_rows = std::min(3, static_cast<int>(wrapped(text, area.columns).size()));
    canvas.paragraph({area.row + 1, area.column, text_rows, area.columns}, 0, text, curve_tone(curve));
    const Area charts = area.below(1 + text_rows);
    if (curve.before.series.empty()) return;
    if (shown_ == Shown::before || curve.unchanged) return draw_before(canvas, charts, curve);
    if (shown_ == Shown::after) return draw_laser_chart(canvas, charts, curve.after, {}, view_);
    const int upper = (charts.rows + 1 + (curve.left_out.empty() ? 0 : 1)) / 2;
    draw_before(canvas, charts.top(upper), curve);
    if (!curve.after.series.empty()) draw_laser_chart(canvas, charts.below(upper), curve.after, {}, view_);
  }

  /// What is left out stays visible, with a legend of its own.
  void draw_before(Canvas& canvas, const Area& area, const LaserCurve& curve) const {
    draw_laser_chart(canvas, area.top(area.rows - (curve.left_out.empty() ? 0 : 1)), curve.before, curve.left_out,
                     view_);
    if (curve.left_out.empty()) return;
    canvas.text(area, area.rows - 1, 0, left_out_legend(curve.before, curve.left_out, unit_of(curve.component)),
                Tone::warning);
  }

  LaserForm form_for(const LaserCurve& curve) const {
    const std::string code(name_of(curve.component));
    const laser::ComponentRecipe now = choice_of(curve);
    const auto number = [](double value) { return value > 0.0 ? shortest(value) : std::string(); };
    std::vector<LaserField> fields{
        {"smoothing [mm]", "length over which a parabola is fitted to smooth the curve; empty: no smoothing",
         number(now.smoothing_mm)},
        {"slope",
         fmt::format("empty: as recommended, {}", laser::name_of(curve.recommended)),
         now.slope ? std::string(laser::name_of(*now.slope)) : "",
         {"", "none", "end_points", "least_squares"}},
        {"grid [mm]", "spacing of the points in the map; empty: spacing of the targets",
         number(now.increment_mm.value_or(0.0))}};
    return LaserForm(fmt::format("{}  {}", code, laser::description_of(curve.component)), std::move(fields),
                     [this, of = curve.component](const std::vector<std::string>& v) { return take_form(of, v); });
  }

  std::string take_form(Component component, const std::vector<std::string>& v) const {
    const auto smoothing = v[0].empty() ? std::optional(0.0) : number_in(v[0]);
    const auto grid = v[2].empty() ? std::optional(0.0) : number_in(v[2]);
    if (!smoothing || *smoothing < 0.0) return "smoothing: a width in mm, as in 100, or nothing";
    if (!grid || *grid < 0.0) return "grid: a spacing in mm, as in 50, or nothing";
    controller().change(fmt::format("slope, smoothing and grid of {}", name_of(component)), [&](LaserChoices& c) {
      laser::ComponentRecipe& choice = laser::settings_in(c.recipe, component);
      choice.smoothing_mm = *smoothing;
      choice.slope = laser::slope_method_named(v[1]);
      choice.increment_mm = *grid > 0.0 ? grid : std::nullopt;
    });
    return {};
  }

  enum class Shown { both, before, after };
  ListPlace place_;
  ChartView view_;
  Shown shown_ = Shown::both;
};

}  // namespace

std::unique_ptr<LaserPage> laser_curves_page(LaserHost& host) { return std::make_unique<CurvesPage>(host); }

}  // namespace ecs::app
