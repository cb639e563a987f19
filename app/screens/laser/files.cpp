// Step 1: which files. Steps 2 and 5: what was measured under which conditions; accuracy and repeatability by ISO
// 230-2.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "app/screens/files/prompt.hpp"
#include "app/screens/laser/screen.hpp"
#include "app/ui/widgets.hpp"
#include "base/file.hpp"
#include "commissioning/measurements/fields.hpp"
#include "commissioning/session/remembered.hpp"
#include "commissioning/utility/unit_view.hpp"

namespace ecs::app {
namespace {

class FilesPage final : public LaserPage {
 public:
  explicit FilesPage(LaserHost& host) : LaserPage(host) {
    const auto choose = [this] {
      files_.choose("Measured files, or an error map", {{FileKind::measurements, FileKind::map}, true},
                    [this](const std::vector<std::string>& taken) { take(taken); });
    };
    const auto answer = [this, choose] {
      if (const auto& files = controller().choices().files; files.empty())
        choose();
      else
        this->host().ask_answers(files[place_within(place_, files.size())].path);
    };
    const auto take_off = [this] { this->take_off(); };
    rows_ = {{"a", "add files", choose},
             {"e", "measure", [this] { ask_to_measure(); }, [this] { return emulated(); }, true},
             {"Enter", "missing data of a file", answer},
             {"x", "remove", take_off},
             {"Del", "", take_off},
             {"p", "parameters"},
             {"r", "read again", [this] { controller().read_again(); }}};
  }

  void draw(Canvas& canvas, const Area& area) const override {
    if (files_.active()) return files_.draw(canvas, area, 0);
    if (measuring_.running()) {
      draw_progress(canvas, area.between_margins(), 0, measuring_.label() + " (press Esc to stop)", measuring_.part(),
                    measuring_.seconds_left());
      return;
    }
    const LaserWork& work = controller().work();
    if (const std::string& map = controller().choices().opened_map; !map.empty()) {
      canvas.paragraph(area.between_margins(), 0,
                       fmt::format("The map {} is loaded unchanged. Step 6 shows its components, step 8 sends it. "
                                   "Press a to open measurement files instead.",
                                   map));
      return;
    }
    if (controller().choices().files.empty()) {
      const std::string begin = fmt::format(
          "No measurement files yet. Press a to choose files from a folder (an error map is loaded unchanged){}. Then "
          "go step by step (a digit goes to that step, n to the next one):",
          emulated() ? "; press e to measure the emulated machine by a plan" : "");
      draw_nothing_yet(canvas, area, begin);
      int row = 2 + static_cast<int>(wrapped(begin, area.columns - 2).size());
      for (int k = 0; k < kLaserSteps; ++k)
        canvas.text(area, row++, 3, fmt::format("{} {:<10} {}", k + 1, kLaserStepRows[k].name, kLaserStepRows[k].what),
                    Tone::faint);
      return;
    }
    const int below = std::min(4, area.rows / 3);
    canvas.text(area, 0, 2, fmt::format("{:<28} {:<26} {}", "file", "read as", "contents"), Tone::faint);
    std::vector<ListRow> rows;
    for (const LaserFileChoice& choice : controller().choices().files) rows.push_back(row_of(work, choice));
    draw_list(canvas, {area.row + 1, area.column, std::max(0, area.rows - 1 - below), area.columns}, rows, place_);
    draw_selected(canvas, {area.row + area.rows - below, area.column + 1, below, area.columns - 2});
  }

  bool on_key(const Key& key) override {
    return files_.on_key(key) || place_.on_key(key, static_cast<int>(controller().choices().files.size())) ||
           act_on(rows_, key);
  }

  bool advance() override {
    const bool measured = measuring_.advance() || measuring_.running();
    return files_.advance() || measured;
  }
  bool on_escape() override {
    const bool measures = measuring_.running();
    measuring_.cancel();
    return measures;
  }
  bool typing() const override { return files_.active(); }
  bool holds_keys() const override { return files_.active(); }
  CellPosition cursor(const Area& area) const override { return files_.cursor(area, 0); }
  std::vector<KeyHelp> keys() const override { return files_.active() ? files_.keys() : helps_of(rows_); }

 private:
  [[nodiscard]] bool emulated() const {
    const WatchedUnit unit = controller().unit().snapshot();
    return unit.emulator && !unit.workshop.empty();
  }

  void take_off() {
    const auto& files = controller().choices().files;
    if (files.empty()) return;
    const auto at = static_cast<std::ptrdiff_t>(place_within(place_, files.size()));
    controller().change("file removed", [&](LaserChoices& c) { c.files.erase(c.files.begin() + at); });
    place_.selected = static_cast<int>(place_within(place_, files.size()));
  }

  /// The emulated laser measures what a plan asks for; the files are added.
  void ask_to_measure() {
    if (!emulated()) {
      controller().message().say("This is a real machine: measure it with its laser, then press a to add the files.",
                                 Tone::warning);
      return;
    }
    const std::string link = controller().unit().snapshot().link;  // emulator:MACHINE
    const std::filesystem::path machine = link.substr(std::min(link.size(), link.find(':') + 1));
    const std::filesystem::path plan = machine.parent_path() / "plan.toml";
    const auto newest = controller().unit().newest();
    const std::string phase = newest && newest->mode == UnitMode::compensating ? "after" : "before";
    const std::string beside = disc::is_file(plan) ? plan.string() : "";
    host().fill(LaserForm(
        "measure the emulated machine",
        {{"plan",
          "lines, targets and runs (.toml, docs/emulator.md); empty: the positions of every axis",
          beside,
          {},
          true},
         {"phase", "measurements planned before compensation, or after it", phase, {"before", "after"}},
         {"folder", "folder for the files; existing files are not overwritten", phase, {}, true}},
        [this, machine](const std::vector<std::string>& v) {
          if (!v[0].empty() && !disc::is_file(v[0])) return fmt::format("there is no plan {}", v[0]);
          if (v[2].empty()) return std::string("a folder is required");
          measure_by_plan(measuring_, controller().unit().snapshot().workshop, {v[0], machine.string(), v[1], v[2]},
                          [this, v](const Result<std::vector<std::string>>& files) { take_measured(files, v); });
          return std::string();
        }));
  }

  /// What was measured with compensation is of no use for a map: it is compared with what was measured before.
  /// @param asked  plan, phase and folder
  void take_measured(const Result<std::vector<std::string>>& files, const std::vector<std::string>& asked) {
    if (!files)
      return controller().message().say(fmt::format("{}. Press e to try again.", to_text(files.error())), Tone::bad);
    for (const std::string& path : *files) remember_file(path);
    if (asked[1] == "after") {
      remember_phases(*files, asked[0]);
      return controller().message().say(fmt::format(
          "{} lines measured into {}. Press o on page After of MODEL to compare them with the prediction{}.",
          files->size(), asked[2],
          asked[0].empty() ? "" : "; F3, laser table compares them with those measured before"));
    }
    controller().change(fmt::format("{} files measured", files->size()), [&](LaserChoices& c) {
      c.opened_map.clear();
      for (const std::string& path : *files) c.files.push_back({path, {}});
    });
    controller().message().say(
        fmt::format("{} lines measured; press p to choose the parameters, then follow the steps", files->size()));
  }

  /// For `laser table`, which needs a plan: those measured before are the files of this work.
  void remember_phases(const std::vector<std::string>& after, const std::string& plan) {
    if (plan.empty() || after.empty()) return;
    const auto folder_of = [](const std::string& file) { return std::filesystem::path(file).parent_path().string(); };
    const auto& before = controller().choices().files;
    remember_measured_phases({plan, before.empty() ? "" : folder_of(before.front().path), folder_of(after.front())});
  }

  static ListRow row_of(const LaserWork& work, const LaserFileChoice& choice) {
    const std::string name = std::filesystem::path(choice.path).filename().string();
    const LaserFile* file = file_read(work.files, choice);
    if (file == nullptr) return {fmt::format("{:<28} reading ...", name), Tone::faint};
    if (!file->set)
      return {fmt::format("{:<28} {}", name,
                          file->wants_columns   ? "table: press Enter to assign its columns"
                          : file->wants_answers ? "incomplete: press Enter to add data"
                                                : "cannot be read"),
              Tone::bad};
    return {fmt::format("{:<28} {:<26} {}", name, file->format, file->summary), Tone::plain};
  }

  void draw_selected(Canvas& canvas, const Area& area) const {
    const LaserChoices& choices = controller().choices();
    const std::string unit =
        choices.params_file.empty()
            ? "Parameters: none yet. Press p to choose a file or receive those of the unit"
            : "Parameters: " + choices.params_file + (choices.scope.empty() ? "" : ", scope " + choices.scope);
    const std::string& wrong = controller().work().map.parameters_problem;
    canvas.text(area, area.rows - 1, 0, wrong.empty() ? unit : wrong, wrong.empty() ? Tone::plain : Tone::bad);
    const LaserFileChoice& choice = choices.files[place_within(place_, choices.files.size())];
    const Area text{area.row, area.column, area.rows - 1, area.columns};
    const LaserFile* file = file_read(controller().work().files, choice);
    if (file != nullptr && !file->problem.empty()) {
      canvas.paragraph(text, 0, problem_on_screen(file->problem), Tone::bad);
      return;
    }
    const int row = canvas.paragraph(text, 0, choice.path, Tone::faint);
    if (file == nullptr) return;
    std::string remarks;
    for (const LaserLine& line : controller().work().lines)
      if (remarks.empty() && std::find(line.files.begin(), line.files.end(), choice.path) != line.files.end())
        remarks = missing_place_of(line);
    const bool asks_for_place = !remarks.empty();
    for (const std::string& note : file->set->notes)
      if (!asks_for_place || !note.starts_with(laser::kPlaceNotStated))
        remarks += (remarks.empty() ? "note: " : "; ") + note;
    if (!remarks.empty()) canvas.paragraph(text, row, remarks);
  }

  void take(const std::vector<std::string>& taken) {
    if (taken.size() == 1 && read_laser_file({taken.front(), {}}).is_map) return controller().open_map(taken.front());
    controller().change(
        fmt::format("{} file{} added", taken.size(), taken.size() == 1 ? "" : "s"), [&](LaserChoices& c) {
          if (!c.opened_map.empty()) c.map_file = LaserChoices{}.map_file;
          c.opened_map.clear();
          for (const std::string& path : taken)
            if (std::none_of(c.files.begin(), c.files.end(), [&](const auto& f) { return f.path == path; }))
              c.files.push_back({path, {}});
        });
    host().ask_columns(taken);
  }

  ListPlace place_;
  Prompt files_;
  TaskRunner measuring_;
};

}  // namespace

std::unique_ptr<LaserPage> laser_files_page(LaserHost& host) { return std::make_unique<FilesPage>(host); }

namespace {

constexpr const char* kNoLines = "No measured lines yet: add files in step 1.";

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
  explicit LinesPage(LaserHost& host) : LaserPage(host) {
    const auto answer = [this] {
      this->host().ask_answers(file_to_ask(controller().work(), line()), line().place_unknown.empty() ? "" : "parked");
    };
    rows_ = {{"up/down", "line"},
             {"Enter", "missing data", answer},
             {"c", "correct position", [this] { ask_place(line()); }},
             {"PgUp/PgDn", "details of the line"}};
  }

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
      rows.push_back(summary_row(work.lines[k], work.results[k], places));
    const int list_rows = std::max(1, std::min(static_cast<int>(rows.size()), (area.rows - 1) / 2));
    draw_list(canvas, {area.row + 1, area.column, list_rows, area.columns}, rows, place_);
    const int top = 2 + list_rows;
    const Area below{area.row + top, area.column + 1, std::max(0, area.rows - top), area.columns - 2};
    draw_scrolled(canvas, below, details_of(line(), below.columns - 1), scroll_);
  }
  bool on_key(const Key& key) override {
    if (key.name == Key::Name::page_down || key.name == Key::Name::page_up) return scroll_.on_key(key, 4);
    const auto& lines = controller().work().lines;
    if (!lines.empty() && act_on(rows_, key)) return true;
    if (!place_.on_key(key, static_cast<int>(lines.size()))) return false;
    scroll_ = {};
    return true;
  }

 private:
  /// @pre there are lines
  [[nodiscard]] const LaserLine& line() const {
    return controller().work().lines[place_within(place_, controller().work().lines.size())];
  }

  /// Where the other axes stood, as the file states it or as it was corrected before.
  void ask_place(const LaserLine& line) {
    std::string now;
    for (const Axis a : kAllAxes)
      if (a != line.group.axis)
        now += fmt::format("{}{}={:.9g}", now.empty() ? "" : ",", static_cast<char>(letter_of(a) - 'A' + 'a'),
                           line.group.parked_mm[index_of(a)]);
    host().fill(LaserForm("position of the other axes: " + name_of_line(line),
                          {{"parked", "mm, as in y=-1400,z=0; empty: as in the file. The file is not changed", now}},
                          [this, line](const std::vector<std::string>& v) {
                            LaserChoices tried = controller().choices();
                            if (const auto done = correct_place(tried, line, v[0]); !done) return to_text(done.error());
                            controller().change(fmt::format("position of {} corrected", name_of_line(line)),
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
  explicit IsoPage(LaserHost& host) : LaserPage(host) {
    rows_ = {{"up/down", "line"}, {"PgUp/PgDn", "more values and notes"}};
  }

  void draw(Canvas& canvas, const Area& area) const override {
    const LaserWork& work = controller().work();
    if (work.lines.empty()) return draw_nothing_yet(canvas, area, kNoLines);
    const LaserHalves halves = laser_halves(area, 7);
    draw_list(canvas, halves.list, rows_of_lines(work), place_);
    if (halves.rest.columns == 0) return;
    const std::size_t at = place_within(place_, work.lines.size());
    const LaserLine& line = work.lines[at];
    canvas.text(halves.rest, 0, 0, fmt::format("{}, {}", name_of_line(line), line.place), Tone::strong);
    draw_scrolled(canvas, halves.rest.below(1), text_of(line, work.results[at], halves.rest.columns - 1), scroll_);
  }
  bool on_key(const Key& key) override {
    if (key.name == Key::Name::page_down || key.name == Key::Name::page_up) return scroll_.on_key(key, 6);
    if (!place_.on_key(key, static_cast<int>(controller().work().lines.size()))) return false;
    scroll_ = {};
    return true;
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
    text.push_back(fmt::format("{:<7}{:>8.2f} {:<4} largest minus smallest reading", "range", result.iso->range, unit));
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
