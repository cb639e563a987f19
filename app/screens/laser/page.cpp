#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/plot/gnuplot.hpp"
#include "app/screens/laser/screen.hpp"
#include "app/ui/chart.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/files/known_files.hpp"
#include "commissioning/maps/findings.hpp"
#include "params/fields.hpp"

namespace ecs::app {

LaserForm::LaserForm(std::string title, std::vector<LaserField> fields, Take take)
    : title_(std::move(title)), fields_(std::move(fields)), take_(std::move(take)) {
  for (const LaserField& field : fields_) lines_.emplace_back().propose(field.value);
}

std::vector<std::string> fields_needed(const std::string& problem) {
  if (problem.find("does not state which error") != std::string::npos) return {"sense"};
  std::vector<std::string> needed;
  for (std::size_t at = problem.find("--"); at != std::string::npos; at = problem.find("--", at + 2)) {
    const std::size_t end = problem.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at + 2);
    std::string name = problem.substr(at + 2, end == std::string::npos ? end : end - at - 2);
    if (std::find(needed.begin(), needed.end(), name) == needed.end()) needed.push_back(std::move(name));
  }
  return needed;
}

namespace {

/// Up to the options of a verb that would help; npos: it names none.
std::size_t end_before_options(const std::string& problem) {
  return std::min(problem.find(" (--"), problem.find(", for example --"));
}

}  // namespace

std::string problem_on_screen(const std::string& problem) {
  const std::size_t options = end_before_options(problem);
  if (options == std::string::npos) return problem;
  return fmt::format("{}. Press Enter and set {}.", problem.substr(0, options),
                     fmt::join(fields_needed(problem), " and "));
}

std::string finding_on_screen(std::string message) {
  const std::size_t at = message.find(kEvenly);
  if (at != std::string::npos)
    message.replace(at, std::string_view(kEvenly).size(), "choose a grid in step 4, or send the map as it is");
  return message;
}

void LaserForm::say(const std::string& problem) {
  hint_ = problem;
  refused_ = !problem.empty();
}

void LaserForm::go_to(const std::string& field) {
  for (std::size_t k = 0; k < fields_.size(); ++k)
    if (fields_[k].name == field) place_.selected = static_cast<int>(k);
}

LaserForm::Layout LaserForm::layout(const Area& area) const {
  constexpr int kHelpRows = 3;
  Layout out;
  const int columns = std::min(area.columns, std::max(60, area.columns - 8));
  out.fields = std::clamp(static_cast<int>(fields_.size()), 1, std::max(1, area.rows - kHelpRows - 2));
  const int rows = std::min(area.rows, out.fields + kHelpRows + 2);
  out.box = {area.row + (area.rows - rows) / 2, area.column + (area.columns - columns) / 2, rows, columns};
  out.inside = {out.box.row + 1, out.box.column + 1, std::max(0, rows - 2), std::max(0, columns - 2)};
  for (const LaserField& field : fields_) out.names = std::max(out.names, width_of(field.name));
  out.names = std::min(out.names + 4, out.inside.columns / 2);
  out.values = std::max(1, out.inside.columns - out.names - 1);
  return out;
}

void LaserForm::draw(Canvas& canvas, const Area& area) const {
  if (files_.active()) return files_.draw(canvas, area, 0);
  const Layout at = layout(area);
  canvas.fill(at.box);
  canvas.frame(at.box, title_, Tone::strong);
  const int count = static_cast<int>(fields_.size());
  place_.first = std::clamp(place_.first, std::max(0, place_.selected - at.fields + 1), place_.selected);
  for (int r = 0; r < std::min(at.fields, count - place_.first); ++r) {
    const auto k = static_cast<std::size_t>(place_.first) + static_cast<std::size_t>(r);
    const bool here = place_.first + r == place_.selected;
    canvas.text(at.inside, r, 0, here ? ">" : " ", Tone::strong);
    canvas.text({at.inside.row, at.inside.column, at.inside.rows, at.names - 1}, r, 2, fields_[k].name,
                here ? Tone::strong : Tone::plain);
    lines_[k].draw(canvas, at.inside, r, at.names, at.values, here);
  }
  if (place_.first > 0) canvas.put(at.box.row + 1, at.box.column + at.box.columns - 1, U'↑', Tone::strong);
  if (place_.first + at.fields < count)
    canvas.put(at.box.row + at.fields, at.box.column + at.box.columns - 1, U'↓', Tone::strong);
  const LaserField& field = fields_[static_cast<std::size_t>(place_.selected)];
  std::string hint = hint_.empty() ? field.help : hint_;
  if (hint_.empty() && !field.choices.empty()) hint += " (Space: next value. Or type how it begins)";
  if (hint_.empty() && field.path) hint += " (Tab chooses or completes)";
  const Area help{at.inside.row + at.fields, at.inside.column + 1, std::max(0, at.inside.rows - at.fields - 1),
                  at.inside.columns - 2};
  canvas.paragraph(help, 0, hint, refused_ ? Tone::bad : Tone::faint);
  canvas.text(at.inside, at.inside.rows - 1, 1, "Enter accepts, Esc cancels", Tone::strong);
}

CellPosition LaserForm::cursor(const Area& area) const {
  if (files_.active()) return files_.cursor(area, 0);
  const Layout at = layout(area);
  const auto k = static_cast<std::size_t>(place_.selected);
  return {at.inside.row + place_.selected - place_.first,
          at.inside.column + at.names + lines_[k].cursor_column(at.values)};
}

void LaserForm::next_choice(int by) {
  const auto k = static_cast<std::size_t>(place_.selected);
  const auto& choices = fields_[k].choices;
  const auto found = std::find(choices.begin(), choices.end(), lines_[k].text());
  const int count = static_cast<int>(choices.size());
  const int now = found == choices.end() ? 0 : static_cast<int>(found - choices.begin());
  lines_[k].set(choices[static_cast<std::size_t>((now + by + count) % count)]);
}

/// The choice that begins with the letters typed so far; the same letter again: the next one that begins with it. A
/// letter after a whole word begins another one. Where there is none, the value before the word stays.
void LaserForm::choose_by_letter(char32_t letter) {
  const auto k = static_cast<std::size_t>(place_.selected);
  const std::string one = lower(utf8_of(letter)), now = lines_[k].text();
  const auto choose = [&](int by, const std::string& begin) {
    next_choice(by);
    for (std::size_t tries = 0; tries < fields_[k].choices.size(); ++tries, next_choice(1))
      if (lower(lines_[k].text()).starts_with(begin)) return true;
    return false;
  };
  if (word_.empty() || word_ == lower(now)) before_word_ = now;
  word_ += one;
  if (choose(0, word_)) return;
  lines_[k].set(now);
  if (word_ == lower(now) + one || word_ == one + one) {
    word_ = one;
    if (choose(1, one)) return;
  }
  lines_[k].set(before_word_);
  refuse_word();
  if (word_ == one) word_.clear();
}

void LaserForm::refuse_word() {
  std::vector<std::string> values = fields_[static_cast<std::size_t>(place_.selected)].choices;
  std::erase(values, "");
  say(fmt::format("No value begins with \"{}\". Values: {}. Backspace clears.", word_, fmt::join(values, ", ")));
}

void LaserForm::type(const Key& key) {
  const auto k = static_cast<std::size_t>(place_.selected);
  const LaserField& field = fields_[k];
  if (!field.choices.empty()) {
    if (is_letter(key, U' ') || key.name == Key::Name::right) next_choice(1);
    if (key.name == Key::Name::left) next_choice(-1);
    if (key.name == Key::Name::letter && key.letter != U' ') return choose_by_letter(key.letter);
    if (key.name == Key::Name::backspace) lines_[k].set("");
    word_.clear();
    return;
  }
  if (key.name == Key::Name::tab && field.path && lines_[k].text().empty()) {
    files_.choose(field.help, field.wish, [this, k](const std::string& path) { lines_[k].set(path); });
    return;
  }
  if (key.name == Key::Name::tab && field.path) {
    const PathCompletion found = completed_path(lines_[k].text());
    lines_[k].set(found.completed);
    hint_ = fmt::format("{}", fmt::join(found.choices, "  "));
    return;
  }
  (void)lines_[k].on_key(key);
}

bool LaserForm::on_key(const Key& key) {
  if (files_.on_key(key)) return true;
  hint_.clear();
  refused_ = false;
  const int count = static_cast<int>(fields_.size());
  if (key.name == Key::Name::escape) return false;
  if (key.name == Key::Name::enter) {
    if (!word_.empty() && !lower(lines_[static_cast<std::size_t>(place_.selected)].text()).starts_with(word_)) {
      refuse_word();
      return true;
    }
    std::vector<std::string> values;
    for (const TextLine& line : lines_) values.push_back(line.text());
    hint_ = take_(values);
    refused_ = !hint_.empty();
    return refused_;
  }
  if (key.name == Key::Name::up || key.name == Key::Name::down) {
    (void)place_.on_key(key, count);
    word_.clear();
  } else if (key.name == Key::Name::tab && !fields_[static_cast<std::size_t>(place_.selected)].path) {
    place_.selected = (place_.selected + 1) % count;
    word_.clear();
  } else {
    type(key);
  }
  return true;
}

namespace {

/// How far the axis reaches beyond the readings that count, in parts of what they spread: they keep a third of it.
constexpr double kReach = 1.0;
constexpr std::size_t kMostToldOneByOne = 3;
constexpr double kSamePlace_mm = 1e-6;

PlotRange x_range(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, const ChartView& view) {
  PlotRange x;
  for (const PlotSeries& series : panel.series)
    for (const PlotPoint& p : series.points) x.take(p.x);
  for (const PlotPoint& p : left_out) x.take(p.x);
  if (view.x_from) x.from = *view.x_from;
  if (view.x_to) x.to = *view.x_to;
  return x;
}

/// Of the readings that count, inside `x`.
PlotRange y_range(const PlotPanel& panel, const PlotRange& x) {
  PlotRange y;
  for (const PlotSeries& series : panel.series)
    for (const PlotPoint& p : series.points)
      if (x.has(p.x)) y.take(p.y);
  return y;
}

PlotRange reach_of(const PlotRange& counting) {
  if (counting.empty()) return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const double width = counting.width() > 0.0 ? counting.width() : std::max(1.0, 0.1 * std::abs(counting.from));
  return {counting.from - kReach * width, counting.to + kReach * width};
}

CellPosition cell_of(const Canvas& canvas, const Area& plot, const PlotRange& x, const PlotRange& y,
                     const PlotPoint& p) {
  const bool ascii = canvas.glyphs() == Glyphs::ascii;  // else 2 × 4 dots in a cell
  const double across = plot.columns - (ascii ? 1.0 : 0.5);
  const double down = plot.rows - (ascii ? 1.0 : 0.25);
  const int row = static_cast<int>((1.0 - std::clamp(y.part(p.y), 0.0, 1.0)) * down);
  const int column = static_cast<int>(x.part(p.x) * across);
  return {plot.row + std::min(row, plot.rows - 1), plot.column + std::min(column, plot.columns - 1)};
}

/// Marks at the upper or lower edge; the value beside each as long as they are few.
void draw_beyond(Canvas& canvas, const Area& plot, int row, const std::vector<PlotPoint>& points, const PlotRange& x,
                 bool with_values) {
  for (const PlotPoint& p : points) {
    const int column = std::min(static_cast<int>(x.part(p.x) * (plot.columns - 0.5)), plot.columns - 1);
    canvas.put(plot.row + row, plot.column + column, U'x', Tone::warning);
    if (!with_values) continue;
    const std::string value = fmt::format("{:.4g}", p.y);
    const int right = column + 2;
    const int at = right + width_of(value) <= plot.columns ? right : column - 1 - width_of(value);
    if (at >= 0) canvas.text(plot, row, at, value, Tone::warning);
  }
}

bool is_mean(Mark mark) { return mark == Mark::forward || mark == Mark::reverse || mark == Mark::both; }

/// Where a cursor at `x` reads: the nearest point of all.
double nearest_place(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, double x) {
  double place = x, least = std::numeric_limits<double>::infinity();
  const auto take = [&](const PlotPoint& p) {
    if (std::abs(p.x - x) >= least) return;
    least = std::abs(p.x - x);
    place = p.x;
  };
  for (const PlotSeries& series : panel.series) std::for_each(series.points.begin(), series.points.end(), take);
  std::for_each(left_out.begin(), left_out.end(), take);
  return place;
}

/// "at -200: forward 1.20, reverse 3.41, x 47.50": means and what is left out, which fits where single runs would not.
std::string means_at(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, double x) {
  const double place = nearest_place(panel, left_out, x);
  const auto here = [place](const PlotPoint& p) { return std::abs(p.x - place) < kSamePlace_mm; };
  std::string text = fmt::format("at {:.6g}:", place);
  const char* before = " ";
  const auto add = [&](const std::string& what, double value) {
    text += fmt::format("{}{} {:.2f}", before, what, value);
    before = ", ";
  };
  for (const PlotSeries& series : panel.series)
    if (const auto p = std::find_if(series.points.begin(), series.points.end(), here);
        is_mean(series.mark) && p != series.points.end())
      add(series.name, p->y);
  for (const PlotPoint& p : left_out)
    if (here(p)) add("x", p.y);
  return text;
}

/// In the row of the legend.
void draw_means_at(Canvas& canvas, const Area& area, const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                   const ChartView& view) {
  const Area plot = plot_area(area);
  if (!view.cursor_x || plot.rows < 2 || plot.columns < 8) return;
  const Area last{area.row + area.rows - 1, area.column, 1, area.columns};
  canvas.fill(last);
  canvas.text(last, 0, 0, means_at(panel, left_out, *view.cursor_x), Tone::strong);
}

/// Over a curve a crowd of marks stands only every this many columns, so that the curve stays seen; beside it all do.
void draw_inside(Canvas& canvas, const Area& plot, const std::vector<PlotPoint>& points, const PlotRange& x,
                 const PlotRange& y) {
  constexpr int kApart = 6;
  const bool crowd = static_cast<int>(points.size()) > plot.columns / 4;
  std::vector<CellPosition> places;
  for (const PlotPoint& p : points) places.push_back(cell_of(canvas, plot, x, y, p));
  std::sort(places.begin(), places.end(), [](const CellPosition& a, const CellPosition& b) {
    return std::pair(a.column, a.row) < std::pair(b.column, b.row);
  });
  int last = -kApart;
  for (const CellPosition& at : places) {
    if (crowd && canvas.at(at.row, at.column).glyph != U' ') {
      if (at.column - last < kApart) continue;
      last = at.column;
    }
    canvas.put(at.row, at.column, U'x', Tone::warning);
  }
}

}  // namespace

LeftOutSeen left_out_seen(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, const ChartView& view) {
  constexpr double kMargin = 0.05;
  constexpr double kMarginForMarks = 0.25;
  LeftOutSeen seen;
  const PlotRange x = x_range(panel, left_out, view);
  const PlotRange counting = y_range(panel, x);
  const PlotRange reach = reach_of(counting);
  PlotRange y = counting;
  for (const PlotPoint& p : left_out) {
    if (!x.has(p.x)) continue;
    if (p.y > reach.to) {
      seen.above.push_back(p);
    } else if (p.y < reach.from) {
      seen.below.push_back(p);
    } else {
      seen.inside.push_back(p);
      y.take(p.y);
    }
  }
  if (y.empty()) y = {0.0, 1.0};
  const double width = y.width() > 0.0 ? y.width() : std::max(1.0, 0.1 * std::abs(y.from));
  seen.view = view;
  seen.view.x_from = x.from;
  seen.view.x_to = x.to;
  if (!view.y_from) seen.view.y_from = y.from - width * (seen.below.empty() ? kMargin : kMarginForMarks);
  if (!view.y_to) seen.view.y_to = y.to + width * (seen.above.empty() ? kMargin : kMarginForMarks);
  return seen;
}

std::string beyond_text(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, std::string_view unit) {
  const LeftOutSeen seen = left_out_seen(panel, left_out, {});
  std::vector<PlotPoint> beyond = seen.above;
  beyond.insert(beyond.end(), seen.below.begin(), seen.below.end());
  if (beyond.empty()) return {};
  if (beyond.size() > kMostToldOneByOne) {
    const auto [least, most] = std::minmax_element(beyond.begin(), beyond.end(),
                                                   [](const PlotPoint& a, const PlotPoint& b) { return a.y < b.y; });
    return fmt::format("{} beyond the edge: {:.4g} to {:.4g} {}", beyond.size(), least->y, most->y, unit);
  }
  std::string text = "beyond the edge:";
  for (std::size_t k = 0; k < beyond.size(); ++k)
    text += fmt::format("{} {:.4g} {} at {:.6g}", k == 0 ? "" : ",", beyond[k].y, unit, beyond[k].x);
  return text;
}

std::string left_out_legend(const PlotPanel& panel, const std::vector<PlotPoint>& left_out, std::string_view unit) {
  const std::string beyond = beyond_text(panel, left_out, unit);
  return fmt::format("x excluded: {}{}{}", left_out.size(), beyond.empty() ? "" : "; ", beyond);
}

void draw_laser_chart(Canvas& canvas, const Area& area, const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                      const ChartView& view) {
  if (left_out.empty()) {
    draw_chart(canvas, area, panel, view);
    return draw_means_at(canvas, area, panel, left_out, view);
  }
  const LeftOutSeen seen = left_out_seen(panel, left_out, view);
  draw_chart(canvas, area, panel, seen.view);
  draw_means_at(canvas, area, panel, left_out, view);
  const Area plot = plot_area(area);
  const PlotRange x{*seen.view.x_from, *seen.view.x_to}, y{*seen.view.y_from, *seen.view.y_to};
  if (plot.rows < 2 || plot.columns < 8 || !(x.width() > 0.0)) return;
  draw_inside(canvas, plot, seen.inside, x, y);
  const bool few = seen.above.size() + seen.below.size() <= kMostToldOneByOne;
  draw_beyond(canvas, plot, 0, seen.above, x, few);
  draw_beyond(canvas, plot, plot.rows - 1, seen.below, x, few);
}

bool on_laser_chart_key(const Key& key, const PlotPanel& panel, const std::vector<PlotPoint>& left_out,
                        ChartView& view) {
  PlotPanel all = panel;
  all.series.push_back({"", Mark::reading, left_out});
  return on_chart_key(key, all, view);
}

PlotPanel with_left_out(PlotPanel panel, const std::vector<PlotPoint>& left_out, std::string_view unit) {
  if (left_out.empty()) return panel;
  const std::string beyond = beyond_text(panel, left_out, unit);
  const bool circles = std::any_of(panel.series.begin(), panel.series.end(),
                                   [](const PlotSeries& one) { return one.mark == Mark::reading; });
  PlotSeries series{"excluded", circles ? Mark::forward_reading : Mark::reading,
                    left_out_seen(panel, left_out, {}).inside};
  panel.title += fmt::format(" ({} excluded{}{})", left_out.size(), beyond.empty() ? "" : ", ", beyond);
  panel.series.insert(panel.series.begin(), std::move(series));
  return panel;
}

LaserHalves laser_halves(const Area& area, int least_rows) {
  constexpr int kRoomForBoth = 60;
  if (area.columns >= kRoomForBoth) {
    const int list = std::clamp(area.columns / 3, 26, 40);
    return {area.left(list), area.right_of(list + 1)};
  }
  if (area.rows < least_rows) return {area, {area.row, area.column, 0, 0}};
  return {area.top(area.rows / 3), area.below(area.rows / 3)};
}

void draw_nothing_yet(Canvas& canvas, const Area& area, const std::string& how_to_get_it) {
  canvas.paragraph(area.between_margins(), 1, how_to_get_it);
}

std::vector<ListRow> rows_of_lines(const LaserWork& work) {
  std::vector<ListRow> rows;
  for (std::size_t k = 0; k < work.lines.size(); ++k) {
    const LaserLine& line = work.lines[k];
    const std::size_t out = count_left_out(work.results[k].choice, *line.set);
    std::string mark = " ";
    Tone tone = Tone::plain;
    if (!line.suspects.empty()) mark = "?";
    if (out > 0) mark = "-";
    if (!work.results[k].problem.empty()) {
      mark = "!";
      tone = Tone::bad;
    }
    rows.push_back({fmt::format("{} {:<4} {}", mark, name_of(line.component), line.place), tone});
  }
  return rows;
}

std::size_t place_within(const ListPlace& place, std::size_t count) {
  return std::min(static_cast<std::size_t>(std::max(0, place.selected)), count == 0 ? 0 : count - 1);
}

void LaserHost::ask_answers(const std::string& path, const std::string& field) {
  const auto& files = controller.choices().files;
  const auto choice = std::find_if(files.begin(), files.end(), [&](const auto& file) { return file.path == path; });
  if (choice == files.end()) return;
  if (auto table = MappedTable::of_file(path, choice->answers)) return fill_mapping(std::move(*table), field);
  fill_answers(path, choice->answers, field);
}

void LaserHost::set_answers(const std::string& path, const ImportArguments& answers) {
  controller.change("missing data of a file", [&](LaserChoices& choices) {
    for (LaserFileChoice& file : choices.files)
      if (file.path == path) file.answers = answers;
  });
}

void LaserHost::fill_answers(const std::string& path, const ImportArguments& known, const std::string& field) {
  auto given = given_answers(known);
  std::vector<LaserField> fields;
  ImportArguments asked;
  for (cli::Argument& option : cli::fields_of<ImportArguments>().arguments_for(asked)) {
    const std::string name = option.name.substr(2);
    if (option.is_flag()) option.choices = {"yes"};
    if (!option.choices.empty()) option.choices.insert(option.choices.begin(), "");
    fields.push_back({name, option.help, given[name], option.choices, name == "environment"});
  }
  const std::string name = std::filesystem::path(path).filename().string();
  const auto take = [this, path, fields](const std::vector<std::string>& v) {
    ImportArguments answers;
    for (std::size_t k = 0; k < v.size(); ++k)
      if (std::string wrong = set_answer(answers, fields[k].name, v[k]); !wrong.empty()) return wrong;
    if (const auto sound = import_options(answers); !sound) return to_text(sound.error());
    set_answers(path, answers);
    return std::string();
  };
  const LaserFile* const file = file_read(controller.work().files, {path, known});
  const std::vector<std::string> needed = fields_needed(file == nullptr ? "" : file->problem);
  LaserForm form(needed.empty() ? "import options of " + name
                                : fmt::format("import options of {} (needed: {})", name, fmt::join(needed, ", ")),
                 fields, take);
  if (file != nullptr) form.say(file->problem.substr(0, end_before_options(file->problem)));
  if (!field.empty() || !needed.empty()) form.go_to(field.empty() ? needed.front() : field);
  fill(std::move(form));
}

void LaserHost::fill_mapping(MappedTable table, const std::string& field) {
  mapping_.emplace(
      std::move(table), [this](const MappedTable& accepted) { take_mapping(accepted); },
      [this](const MappedTable& so_far) { fill_answers(so_far.path(), so_far.answers(), {}); });
  if (field == "parked") mapping_->go_to_parked();
}

void LaserHost::ask_columns(std::vector<std::string> paths) {
  unmapped_ = std::move(paths);
  while (!unmapped_.empty() && !mapping_) {
    const std::string path = unmapped_.front();
    unmapped_.erase(unmapped_.begin());
    if (auto table = MappedTable::of_file(path, {})) fill_mapping(std::move(*table));
  }
}

void LaserHost::after_mapping(bool accepted) {
  mapping_.reset();
  if (!accepted) unmapped_.clear();
  if (!asking_.active()) ask_columns(std::move(unmapped_));
}

/// Keeps it for files with the same headings; those that wait for it are read so if that is confirmed.
void LaserHost::take_mapping(const MappedTable& table) {
  set_answers(table.path(), table.answers());
  remember_mapping(table.path(), table.answers());
  std::vector<MappedTable> alike;
  for (const std::string& path : unmapped_)
    if (auto other = MappedTable::of_file(path, {}); other && other->is_remembered_as(table))
      alike.push_back(std::move(*other));
  if (alike.empty()) return;
  const std::string title =
      fmt::format("Read {} more file{} the same way?", alike.size(), alike.size() == 1 ? "" : "s");
  asking_.ask(
      {title, "The headings are the same. Press n to see each of them first and to change its axis.", "yes", "no"},
      [this, alike] {
        for (const MappedTable& other : alike) {
          set_answers(other.path(), other.answers());
          std::erase(unmapped_, other.path());
        }
        ask_columns(std::move(unmapped_));
      },
      [this] { ask_columns(std::move(unmapped_)); });
}

void LaserHost::unless_there(std::function<void()> save) {
  if (!controller.would_overwrite()) return save();
  ask({fmt::format("Replace {}?", controller.choices().map_file),
       "A file of that name exists. Its parameters and recipe are replaced as well.", "replace", "keep it"},
      std::move(save));
}

void LaserHost::export_picture(PlotFigure figure, const std::string& stem) {
  commissioning::export_picture(drawing_, std::move(figure), stem, write_plot, controller.message());
}

void LaserHost::ask_parameters() {
  const LaserChoices& now = controller.choices();
  const auto state = state_folder();
  const std::string unit_file =
      ((state ? *state : std::filesystem::temp_directory_path()) / "unit-parameters.toml").string();
  std::vector<std::string> scopes = params::field_named("compensation.scope")->choices;
  scopes.insert(scopes.begin(), "");
  std::vector<LaserField> fields{
      {"parameters",
       "the unit's parameter file; empty: receive them from the unit",
       now.params_file,
       {},
       true,
       {{FileKind::parameters}}},
      {"scope", "errors that the unit corrects; empty: as in the parameters", now.scope, scopes}};
  fill(LaserForm("parameters of the unit", std::move(fields), [this, unit_file](const std::vector<std::string>& v) {
    if (v[0].empty()) {
      controller.change("the scope", [&](LaserChoices& c) { c.scope = v[1]; });
      controller.receive_parameters(unit_file);
      return std::string();
    }
    if (std::string refusal = refusal_as(FileKind::parameters, v[0]); !refusal.empty())
      return refusal + " Tab completes the path.";
    controller.change("the parameters", [&](LaserChoices& c) {
      c.params_file = v[0];
      c.scope = v[1];
    });
    return std::string();
  }));
}

}  // namespace ecs::app
