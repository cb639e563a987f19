// Steps 2 and 5: what was measured under which conditions; accuracy and repeatability by ISO 230-2.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "app/screens/laser/page.hpp"
#include "commissioning/measurements/fields.hpp"

namespace ecs::app {
namespace {

constexpr const char* kNoLines = "No measured lines yet: step 1 takes the files.";

void add_wrapped(std::vector<std::string>& lines, const std::string& text, int columns, const std::string& indent) {
  for (const std::string& line : wrapped(text, std::max(10, columns - width_of(indent))))
    lines.push_back(indent + line);
}

/// "Y -1400, Z 0"; what is missing of it with the key that tells it: "Y ?, Z ?: Enter".
std::string place_in_row(const LaserLine& line) {
  return line.place_unknown.empty() ? line.place : line.place + ": Enter";
}

/// What the places need, as far as the other columns leave it.
int place_columns(const LaserWork& work) {
  constexpr int kLeast = 16, kMost = 20;
  int columns = kLeast;
  for (const LaserLine& line : work.lines) columns = std::max(columns, width_of(place_in_row(line)));
  return std::min(columns, kMost);
}

/// "-4100..0", with as many decimals as fit, three at most; whole millimetres are never cut.
std::string extent_of(const LineSummary& line) {
  constexpr int kColumns = 12;
  std::string text;
  for (const double part : {1000.0, 100.0, 10.0, 1.0}) {
    const auto rounded = [&](double mm) { return fmt::format("{:.10g}", std::round(mm * part) / part + 0.0); };
    text = rounded(line.first_mm) + (line.targets < 2 ? "" : ".." + rounded(line.last_mm));
    if (width_of(text) <= kColumns) break;
  }
  return text;
}

/// "Y -1400, Z 0 | -4100 ... 0 every 50 | 83 targets, 3 runs, both"
ListRow summary_row(const LaserLine& line, const LaserLineResult& result, int columns_of_place) {
  const LineSummary& s = line.summary;
  const std::string step = s.targets < 2 ? "-" : (s.step_mm ? fmt::format("{:.5g}", *s.step_mm) : "uneven");
  const char* approaches = s.forward && s.reverse ? "both" : (s.forward ? "forward" : (s.reverse ? "reverse" : "?"));
  const bool compensated = line.group.compensated.value_or(false);
  std::string place = place_in_row(line);
  if (width_of(place) > columns_of_place) place = line.place;  // the details below say what is missing
  std::string text = fmt::format("{:<13} {:<{}} {:<12} {:>6} {:>4} {:>4} {:<7} ", name_of_line(line), place,
                                 columns_of_place, extent_of(s), step, s.targets, s.runs, approaches);
  if (compensated) text += "comp.";
  const bool odd = compensated || !result.problem.empty() || !(s.forward && s.reverse) || !line.place_unknown.empty();
  return {text, odd ? Tone::warning : Tone::plain};
}

std::vector<std::string> details_of(const LaserLine& line, int columns) {
  std::vector<std::string> text;
  if (!line.place_unknown.empty()) add_wrapped(text, missing_place_of(line), columns, "");
  add_wrapped(
      text,
      fmt::format("{} along {} [{}], {} readings; {}", name_of(line.group.sense), letter_of(line.group.axis),
                  laser::unit_of(line.group.sense), line.summary.readings, laser::description_of(line.component)),
      columns, "");
  for (const std::string& file : line.files)
    add_wrapped(text, "file " + std::filesystem::path(file).filename().string(), columns, "");
  for (const std::string& note : line.notes) add_wrapped(text, "note: " + note, columns, "");
  std::string conditions;
  for (const ConditionSummary& one : conditions_in(*line.set)) {
    if (one.name == "time_s" || one.name == "travel_since_reversal_mm") continue;
    conditions += fmt::format("{}{} {:.6g}", conditions.empty() ? "" : ", ", one.name, one.least);
    if (one.most != one.least) conditions += fmt::format(" .. {:.6g}", one.most);
  }
  add_wrapped(text, "conditions: " + (conditions.empty() ? "none in the file" : conditions), columns, "");
  for (const laser::MetadataEntry& entry : line.set->metadata)
    if (!entry.key.empty() && !entry.value.empty()) add_wrapped(text, entry.key + ": " + entry.value, columns, "");
  for (const std::string& note : line.set->notes) add_wrapped(text, "note: " + note, columns, "");
  return text;
}

class LinesPage final : public LaserPage {
 public:
  explicit LinesPage(LaserHost& host) : LaserPage(host) {}

  void draw(Canvas& canvas, const Area& area) const override {
    const LaserWork& work = controller().work();
    if (work.lines.empty()) return draw_nothing_yet(canvas, area, kNoLines);
    const int places = place_columns(work);
    canvas.text(area, 0, 2,
                fmt::format("{:<13} {:<{}} {:<12} {:>6} {:>4} {:>4} {:<7}", "what", "parked [mm]", places, "from..to",
                            "step", "n", "runs", "appr."),
                Tone::faint);
    std::vector<ListRow> rows;
    for (std::size_t k = 0; k < work.lines.size(); ++k)
      rows.push_back(summary_row(work.lines[k], *work.results[k], places));
    const int list_rows = std::max(1, std::min(static_cast<int>(rows.size()), (area.rows - 1) / 2));
    draw_list(canvas, {area.row + 1, area.column, list_rows, area.columns}, rows, place_);
    const int top = 2 + list_rows;
    const Area below{area.row + top, area.column + 1, std::max(0, area.rows - top), area.columns - 2};
    const LaserLine& line = work.lines[place_within(place_, work.lines.size())];
    draw_scrolled(canvas, below, details_of(line, below.columns - 1), scroll_);
  }
  bool on_key(const Key& key) override {
    if (key.name == Key::Name::page_down || key.name == Key::Name::page_up) return scroll_.on_key(key, 4);
    const LaserWork& work = controller().work();
    if (key.name == Key::Name::enter && !work.lines.empty()) {
      const LaserLine& line = work.lines[place_within(place_, work.lines.size())];
      host().ask_answers(file_to_ask(work, line), line.place_unknown.empty() ? "" : "parked");
      return true;
    }
    if (is_letter(key, U'c') && !work.lines.empty()) {
      ask_place(work.lines[place_within(place_, work.lines.size())]);
      return true;
    }
    if (!place_.on_key(key, static_cast<int>(work.lines.size()))) return false;
    scroll_ = {};
    return true;
  }
  std::vector<KeyHelp> keys() const override {
    return {
        {"up/down", "line"}, {"Enter", "what is missing"}, {"c", "correct the place"}, {"PgUp/PgDn", "its details"}};
  }
  std::string help() const override {
    return "Step 2: every line that was measured: what along which axis, where the other axes stood, targets, runs, "
           "approaches; below, the conditions that the file tells. A ? marks what neither the file nor an answer says "
           "where an axis was parked: it is taken as 0, and Enter tells it. c corrects a place that a file states "
           "wrongly. comp.: measured with compensation active, "
           "of no use for a map.";
  }

 private:
  /// Where the other axes stood, as the file states it or as it was corrected before.
  void ask_place(const LaserLine& line) {
    std::string now;
    for (const Axis a : kAllAxes)
      if (a != line.group.axis)
        now += fmt::format("{}{}={:.9g}", now.empty() ? "" : ",", static_cast<char>(letter_of(a) - 'A' + 'a'),
                           line.group.parked_mm[index_of(a)]);
    host().fill(
        LaserForm("where the other axes stood: " + name_of_line(line),
                  {{"parked", "mm, as in y=-1400,z=0; empty: as the file says. The file itself stays as it is", now}},
                  [this, line](const std::vector<std::string>& v) {
                    LaserChoices tried = controller().choices();
                    if (const auto done = correct_place(tried, line, v[0]); !done) return to_text(done.error());
                    controller().change(fmt::format("place of {} corrected", name_of_line(line)),
                                        [&](LaserChoices& c) { c = tried; });
                    return std::string();
                  }));
  }

  /// Of several files of a line the first that leaves its place open.
  static std::string file_to_ask(const LaserWork& work, const LaserLine& line) {
    for (const LaserFile& file : work.files)
      for (const Axis axis : line.place_unknown)
        if (!file.position_known[index_of(axis)] &&
            std::find(line.files.begin(), line.files.end(), file.choice.path) != line.files.end())
          return file.choice.path;
    return line.files.front();
  }

  ListPlace place_;
  ScrollPlace scroll_;
};

/// Columns before the name of a quantity.
constexpr int kNumbers = 21;

/// The name of a quantity, abbreviated where the room is narrow.
std::string fitting(std::string name, int room) {
  constexpr std::pair<const char*, const char*> kShort[] = {{" (BS 4656 Pt 16)", ""},
                                                            {"unidirectional", "unidir."},
                                                            {"bidirectional", "bidir."},
                                                            {"systematic", "syst."},
                                                            {"of the mean", "of mean"}};
  for (const auto& [longer, shorter] : kShort)
    if (const std::size_t at = name.find(longer); width_of(name) > room && at != std::string::npos)
      name.replace(at, std::string(longer).size(), shorter);
  return name;
}

class IsoPage final : public LaserPage {
 public:
  explicit IsoPage(LaserHost& host) : LaserPage(host) {}

  void draw(Canvas& canvas, const Area& area) const override {
    const LaserWork& work = controller().work();
    if (work.lines.empty()) return draw_nothing_yet(canvas, area, kNoLines);
    const LaserHalves halves = laser_halves(area, 7);
    draw_list(canvas, halves.list, rows_of_lines(work), place_);
    if (halves.rest.columns == 0) return;
    const std::size_t at = place_within(place_, work.lines.size());
    const LaserLine& line = work.lines[at];
    canvas.text(halves.rest, 0, 0, fmt::format("{}, {}", name_of_line(line), line.place), Tone::strong);
    draw_scrolled(canvas, halves.rest.below(1), text_of(line, *work.results[at], halves.rest.columns - 1), scroll_);
  }
  bool on_key(const Key& key) override {
    if (key.name == Key::Name::page_down || key.name == Key::Name::page_up) return scroll_.on_key(key, 6);
    if (!place_.on_key(key, static_cast<int>(controller().work().lines.size()))) return false;
    scroll_ = {};
    return true;
  }
  std::vector<KeyHelp> keys() const override {
    return {{"up/down", "line"}, {"PgUp/PgDn", "the rest of the values and notes"}};
  }
  std::string help() const override {
    return "Step 5: accuracy and repeatability of every line by ISO 230-2:2014, under the symbols of the standard, "
           "from the readings that are not left out, as measured (slope and smoothing are for the map). Notes name the "
           "conditions of the standard that are not met.";
  }

 private:
  static std::vector<std::string> text_of(const LaserLine& line, const LaserLineResult& result, int columns) {
    std::vector<std::string> text;
    if (!result.iso) {
      add_wrapped(text, result.problem, columns, "");
      return text;
    }
    const auto unit = laser::unit_of(line.group.sense);
    for (const LaserQuantity& q : kLaserQuantities) {
      const auto& value = *result.iso.*q.value;
      const std::string number = value ? fmt::format("{:.2f}", *value) : "-";
      const int room = columns - kNumbers;
      text.push_back(fmt::format("{:<7}{:>8} {:<4} {}", q.symbol, number, unit, fitting(q.name, room)));
    }
    text.push_back(fmt::format("{:<7}{:>8.2f} {:<4} largest less smallest reading", "range", result.iso->range, unit));
    for (const std::string& note : result.iso->notes) add_wrapped(text, "note: " + note, columns, "");
    return text;
  }
  ListPlace place_;
  ScrollPlace scroll_;
};

}  // namespace

std::unique_ptr<LaserPage> laser_lines_page(LaserHost& host) { return std::make_unique<LinesPage>(host); }
std::unique_ptr<LaserPage> laser_iso_page(LaserHost& host) { return std::make_unique<IsoPage>(host); }

}  // namespace ecs::app
