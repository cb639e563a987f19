// Step 1: which files.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "app/screens/files/chooser.hpp"
#include "app/screens/laser/page.hpp"
#include "app/ui/talk.hpp"
#include "commissioning/session/measured_phases.hpp"
#include "commissioning/session/recent_files.hpp"
#include "commissioning/utility/emulated_machine.hpp"

namespace ecs::app {
namespace {

constexpr const char* kSteps[] = {"1 Files      of any instrument, several or a whole folder",
                                  "2 Lines      what was measured, where, under which conditions",
                                  "3 Leave out  runs and readings, and back again",
                                  "4 Slope      slope and smoothing, before and after",
                                  "5 ISO 230    accuracy and repeatability by ISO 230-2",
                                  "6 Map        parameters of the unit; what is there, what is missing",
                                  "7 Header     customer, machine, engineer, date",
                                  "8 Send       saved to disc, checked, sent to the unit",
                                  "9 Verify     read back and compared"};

class FilesPage final : public LaserPage {
 public:
  explicit FilesPage(LaserHost& host) : LaserPage(host) {}

  void draw(Canvas& canvas, const Area& area) const override {
    if (chooser_) return chooser_->draw(canvas, area);
    if (measuring_.running()) {
      draw_progress(canvas, area.between_margins(), 0, measuring_.label() + " (Esc stops it)", measuring_.part(),
                    measuring_.seconds_left());
      return;
    }
    const LaserWork& work = controller().work();
    if (const std::string& map = controller().choices().opened_map; !map.empty()) {
      canvas.paragraph(
          area.between_margins(), 0,
          fmt::format("The map {} is taken as it is. Step 6 shows its components, step 8 sends it. a opens "
                      "measured files in its place.",
                      map));
      return;
    }
    if (controller().choices().files.empty()) {
      const std::string begin = fmt::format(
          "No measured files yet: a opens a folder to choose from (an error map is taken as it is){}. Then, "
          "step by step (digits go to a step, n to the next one, and back at any time):",
          emulated() ? "; e measures the emulated machine by a plan" : "");
      draw_nothing_yet(canvas, area, begin);
      int row = 2 + static_cast<int>(wrapped(begin, area.columns - 2).size());
      for (const char* step : kSteps) canvas.text(area, row++, 3, step, Tone::faint);
      return;
    }
    const int below = std::min(4, area.rows / 3);
    canvas.text(area, 0, 2, fmt::format("{:<28} {:<26} {}", "file", "taken for", "holds"), Tone::faint);
    std::vector<ListRow> rows;
    for (const LaserFileChoice& choice : controller().choices().files) rows.push_back(row_of(work, choice));
    draw_list(canvas, {area.row + 1, area.column, std::max(0, area.rows - 1 - below), area.columns}, rows, place_);
    draw_selected(canvas, {area.row + area.rows - below, area.column + 1, below, area.columns - 2});
  }

  bool on_key(const Key& key) override {
    if (chooser_) return on_chooser_key(key);
    const auto& files = controller().choices().files;
    if (place_.on_key(key, static_cast<int>(files.size()))) return true;
    const std::size_t at = place_within(place_, files.size());
    if (is_letter(key, U'a') || (key.name == Key::Name::enter && files.empty())) {
      chooser_.emplace(folder_.empty() ? std::filesystem::current_path() : folder_,
                       FileWish{{FileKind::measurements, FileKind::map}, true});
    } else if (is_letter(key, U'p')) {
      host().ask_parameters();
    } else if (is_letter(key, U'e')) {
      ask_to_measure();
    } else if (is_letter(key, U'r')) {
      controller().read_again();
    } else if (key.name == Key::Name::enter) {
      host().ask_answers(files[at].path);
    } else if (!files.empty() && (is_letter(key, U'x') || key.name == Key::Name::erase)) {
      controller().change("a file taken off",
                          [&](LaserChoices& c) { c.files.erase(c.files.begin() + static_cast<std::ptrdiff_t>(at)); });
      place_.selected = static_cast<int>(place_within(place_, controller().choices().files.size()));
    } else {
      return false;
    }
    return true;
  }

  bool advance() override {
    const bool measured = measuring_.advance() || measuring_.running();
    return (chooser_ && chooser_->advance()) || measured;
  }
  bool on_escape() override {
    const bool measures = measuring_.running();
    measuring_.cancel();
    return measures;
  }
  bool typing() const override { return chooser_ && chooser_->typing(); }
  bool holds_keys() const override { return chooser_.has_value(); }
  CellPosition cursor(const Area& area) const override {
    return chooser_ ? chooser_->cursor(area) : CellPosition{-1, -1};
  }

  std::vector<KeyHelp> keys() const override {
    if (!chooser_) {
      std::vector<KeyHelp> keys{{"a", "add files"},
                                {"Enter", "what a file does not say"},
                                {"x", "take off"},
                                {"p", "parameters"},
                                {"r", "read again"}};
      if (emulated()) keys.insert(keys.begin() + 1, {"e", "measure"});
      return keys;
    }
    std::vector<KeyHelp> keys;
    for (const auto& [name, does] : chooser_->keys()) keys.push_back({name, does});
    return keys;
  }
  std::string help() const override {
    return "Step 1: the files of the instrument, of any format, several at once or a whole folder. Each is read and "
           "named. An error map is taken as it is, with the parameters saved beside it. A file that does not say its "
           "axis or sense, or a table of columns, is asked for with Enter. p "
           "chooses the parameters of the unit: with them the screen knows which components the map needs.";
  }

 private:
  [[nodiscard]] bool emulated() const {
    const WatchedUnit unit = controller().unit().snapshot();
    return unit.emulator && !unit.workshop.empty();
  }

  /// The emulated laser measures what a plan asks for; the files are added.
  void ask_to_measure() {
    if (!emulated()) {
      controller().message().say("This is a real machine: measure it with its laser, then a adds the files.",
                                 Tone::warning);
      return;
    }
    const std::string link = controller().unit().snapshot().link;  // emulator:MACHINE
    const std::filesystem::path machine = link.substr(std::min(link.size(), link.find(':') + 1));
    const std::filesystem::path plan = machine.parent_path() / "plan.toml";
    std::error_code none;
    const auto newest = controller().unit().newest();
    const std::string phase = newest && newest->mode == UnitMode::compensating ? "after" : "before";
    const std::string beside = std::filesystem::is_regular_file(plan, none) ? plan.string() : "";
    host().fill(LaserForm(
        "measure the emulated machine",
        {{"plan",
          "lines, targets and runs (.toml, docs/emulator.md); empty: the positions of every axis",
          beside,
          {},
          true},
         {"phase", "what the plan asks for before compensation, or after it", phase, {"before", "after"}},
         {"folder", "where the files go; none that is there is overwritten", phase, {}, true}},
        [this, machine](const std::vector<std::string>& v) {
          std::error_code fault;
          if (!v[0].empty() && !std::filesystem::is_regular_file(v[0], fault))
            return fmt::format("there is no plan {}", v[0]);
          if (v[2].empty()) return std::string("a folder is needed");
          measure_by_plan(measuring_, controller().unit().snapshot().workshop, {v[0], machine.string(), v[1], v[2]},
                          [this, v](const Result<std::vector<std::string>>& files) { take_measured(files, v); });
          return std::string();
        }));
  }

  /// What was measured with compensation is of no use for a map: it is compared with what was measured before.
  /// @param asked  plan, phase and folder
  void take_measured(const Result<std::vector<std::string>>& files, const std::vector<std::string>& asked) {
    if (!files) return controller().message().say(fmt::format("{}. e asks again.", to_text(files.error())), Tone::bad);
    for (const std::string& path : *files) remember_file(path);
    if (asked[1] == "after") {
      remember_phases(*files, asked[0]);
      return controller().message().say(fmt::format(
          "{} lines measured into {}. o on page After of MODEL puts them beside what was predicted{}.", files->size(),
          asked[2], asked[0].empty() ? "" : "; F3, laser table beside those measured before"));
    }
    controller().change(fmt::format("{} files measured", files->size()), [&](LaserChoices& c) {
      c.opened_map.clear();
      for (const std::string& path : *files) c.files.push_back({path, {}});
    });
    controller().message().say(fmt::format("{} lines measured; p takes the parameters, then the steps", files->size()));
  }

  /// For `laser table`, which needs a plan: those measured before are the files of this work.
  void remember_phases(const std::vector<std::string>& after, const std::string& plan) {
    if (plan.empty() || after.empty()) return;
    const auto folder_of = [](const std::string& file) { return std::filesystem::path(file).parent_path().string(); };
    const auto& before = controller().choices().files;
    remember_measured_phases({plan, before.empty() ? "" : folder_of(before.front().path), folder_of(after.front())});
  }

  static const LaserFile* read(const LaserWork& work, const LaserFileChoice& choice) {
    for (const LaserFile& file : work.files)
      if (file.choice.path == choice.path && given_answers(file.choice.answers) == given_answers(choice.answers))
        return &file;
    return nullptr;
  }

  static ListRow row_of(const LaserWork& work, const LaserFileChoice& choice) {
    const std::string name = std::filesystem::path(choice.path).filename().string();
    const LaserFile* file = read(work, choice);
    if (file == nullptr) return {fmt::format("{:<28} reading ...", name), Tone::faint};
    if (!file->set)
      return {
          fmt::format("{:<28} {}", name, file->wants_answers ? "it does not say enough: Enter answers" : "not read"),
          Tone::bad};
    return {fmt::format("{:<28} {:<26} {}", name, file->format, file->summary), Tone::plain};
  }

  void draw_selected(Canvas& canvas, const Area& area) const {
    const LaserChoices& choices = controller().choices();
    const std::string unit =
        choices.params_file.empty()
            ? "Parameters: none yet, p chooses them"
            : "Parameters: " + choices.params_file + (choices.scope.empty() ? "" : ", scope " + choices.scope);
    const std::string& wrong = controller().work().map.parameters_problem;
    canvas.text(area, area.rows - 1, 0, wrong.empty() ? unit : wrong, wrong.empty() ? Tone::plain : Tone::bad);
    const LaserFileChoice& choice = choices.files[place_within(place_, choices.files.size())];
    const Area text{area.row, area.column, area.rows - 1, area.columns};
    const LaserFile* file = read(controller().work(), choice);
    if (file != nullptr && !file->problem.empty()) {
      canvas.paragraph(text, 0, file->problem, Tone::bad);
      return;
    }
    const int row = canvas.paragraph(text, 0, choice.path, Tone::faint);
    if (file == nullptr) return;
    std::string remarks;
    for (const LaserLine& line : controller().work().lines)
      if (remarks.empty() && std::find(line.files.begin(), line.files.end(), choice.path) != line.files.end())
        remarks = missing_place_of(line);
    for (const std::string& note : file->set->notes) remarks += (remarks.empty() ? "note: " : "; ") + note;
    if (!remarks.empty()) canvas.paragraph(text, row, remarks);
  }

  bool on_chooser_key(const Key& key) {
    const FileChooser::Answer answer = chooser_->on_key(key);
    if (answer == FileChooser::Answer::open) return true;
    folder_ = chooser_->folder();
    const std::vector<std::string> taken =
        answer == FileChooser::Answer::chosen ? chooser_->taken() : std::vector<std::string>{};
    chooser_.reset();
    if (taken.empty()) return true;
    if (taken.size() == 1 && read_laser_file({taken.front(), {}}).is_map) {
      controller().open_map(taken.front());
      return true;
    }
    controller().change(
        fmt::format("{} file{} added", taken.size(), taken.size() == 1 ? "" : "s"), [&](LaserChoices& c) {
          if (!c.opened_map.empty()) c.map_file = LaserChoices{}.map_file;
          c.opened_map.clear();
          for (const std::string& path : taken)
            if (std::none_of(c.files.begin(), c.files.end(), [&](const auto& f) { return f.path == path; }))
              c.files.push_back({path, {}});
        });
    return true;
  }

  ListPlace place_;
  std::optional<FileChooser> chooser_;
  std::filesystem::path folder_;
  TaskRunner measuring_;
};

}  // namespace

std::unique_ptr<LaserPage> laser_files_page(LaserHost& host) { return std::make_unique<FilesPage>(host); }

}  // namespace ecs::app
