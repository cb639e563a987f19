// DISPLAY ECS STATUS: state with the fault in plain words, address pointers, axes; read again and again, or out of a
// file; memory test, fault, mode. And the menu ECS UTILITY.
#include "commissioning/unit/status.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include <fmt/format.h>

#include "app/screens/forms/rows.hpp"
#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"
#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "commissioning/files/known_files.hpp"
#include "commissioning/memory/decode.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/unit/utility_work.hpp"
#include "core/fault.hpp"
#include "core/mode_word.hpp"

namespace ecs::app {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
constexpr auto kBetweenReadings = 1s;
constexpr int kRestPerReading = 3;  ///< a slow link is left to others for this many times as long as a reading took
constexpr const char* kTitles[] = {"State", "Address pointers", "Axes", "Memory of the dump"};
constexpr int kNameColumns = 13;

std::string duration_text(std::uint32_t seconds) {
  if (seconds < 60) return fmt::format("{} s", seconds);
  if (seconds < 3600) return fmt::format("{} min {} s", seconds / 60, seconds % 60);
  return fmt::format("{} h {} min", seconds / 3600, seconds / 60 % 60);
}

/// What a mode is, in one sentence; in the order of UnitMode.
constexpr const char* kMeanings[] = {"the unit has just been switched on and waits for a host",
                                     "every relay is open; the unit accepts commands from the screens",
                                     "waits until the machine's control has referenced every axis; then it compensates",
                                     "relays closed: the machine is being corrected",
                                     "a fatal fault: every relay is open; switch the unit off and on"};

std::string_view meaning_of(UnitMode mode) {
  const auto k = static_cast<std::size_t>(mode);
  return k < std::size(kMeanings) ? kMeanings[k] : "a mode this program does not know: update ecs";
}

/// Why a file shows no state; empty: as far as a look at it says, it does.
std::string neither_status_nor_dump(const std::string& path) {
  const FileKind kind = looked_at(path).kind;
  if (kind == FileKind::status || kind == FileKind::memory) return {};
  return fmt::format("{} is neither a saved status nor a memory dump.",
                     std::filesystem::path(path).filename().string());
}

class StatusScreen final : public KeyedScreen {
 public:
  StatusScreen(std::shared_ptr<UnitConnection> connection, const std::string& file)
      : connection_(std::move(connection)), watched_(connection_->snapshot()) {
    keys_ = key_table();
    if (!file.empty()) open(file);
  }

  [[nodiscard]] std::string title() const override { return "DISPLAY ECS STATUS"; }
  [[nodiscard]] std::string help() const override {
    return "The state of the unit: mode, fault with its remedy, memory tests with their addresses, the loop, the "
           "address pointers (for each curve, the value last selected and its address) and the axes. It is "
           "read every second. Press t to test every location of the axis memory; its contents are preserved. Press m "
           "to change between integration and compensation mode; the question states which motion will follow. Press s "
           "to "
           "save everything with the raw registers. Press o to open such a file or a memory dump, also without a unit. "
           "With the bundled emulator, press g to reference its machine.";
  }

 private:
  enum class Page { state, pointers, axes, memory };
  struct Read {
    StatusSnapshot snapshot;
    std::string workshop;
  };

  // --- what is shown
  /// Of the file while one is open, else of the unit.
  [[nodiscard]] const StatusSnapshot* snapshot() const {
    if (file_) return file_->snapshot ? &*file_->snapshot : nullptr;
    return read_ ? &read_->snapshot : nullptr;
  }
  [[nodiscard]] double age_s() const { return std::chrono::duration<double>(Clock::now() - read_at_).count(); }
  /// Why none comes; empty: they come.
  [[nodiscard]] std::string lack() const { return !watched_.problem.empty() ? watched_.problem : problem_; }
  [[nodiscard]] bool integrating() const { return read_ && read_->snapshot.status.mode == UnitMode::integration; }
  [[nodiscard]] int pages() const { return file_ && !file_->memory.empty() ? 4 : 3; }
  /// that can be shown now
  [[nodiscard]] Page page() const {
    if (file_ && snapshot() == nullptr) return Page::memory;
    return static_cast<int>(page_) < pages() ? page_ : Page::state;
  }

  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_source(canvas, inside);
    draw_tabs(canvas, inside, 1, std::span(kTitles).first(static_cast<std::size_t>(pages())), static_cast<int>(page()));
    const Area body{inside.row + 3, inside.column, std::max(0, inside.rows - 6), inside.columns};
    const StatusSnapshot* s = snapshot();
    if (page() == Page::memory)
      draw_scrolled(canvas, body, file_->memory, scroll_);
    else if (s == nullptr)
      canvas.paragraph(body, 0,
                       "No data yet. Without a unit, press o to open a status file (saved by s on this screen or by "
                       "`ecs utility status --save`) or a memory dump (`ecs memory dump`).",
                       Tone::faint);
    else if (page() == Page::state)
      draw_state(canvas, body);
    else
      draw_scrolled(canvas, body, owned_lines_of(page() == Page::pointers ? pointers_text(*s) : axes_text(*s)),
                    scroll_);
    const Area last = last_rows(inside, 3);
    if (work_.running())
      draw_progress(canvas, last, 2, work_.label(), work_.part());
    else if (message_.text().empty() && !file_)
      canvas.paragraph(last, 0, lack(), Tone::bad);
    else
      draw_message(canvas, last, message_);
  }

  void draw_source(Canvas& canvas, const Area& area) const {
    const StatusSnapshot* s = snapshot();
    if (file_)
      return static_cast<void>(canvas.text(
          area, 0, 0,
          s == nullptr ? "FILE " + file_->name
                       : fmt::format("FILE {}: unit {}, {}", file_->name, s->identity.serial_number, s->taken),
          Tone::warning));
    if (!lack().empty())
      canvas.text(area, 0, 0, read_ ? fmt::format("NO ANSWER, the data are {:.0f} s old", age_s()) : "NO ANSWER",
                  Tone::bad);
    else if (s == nullptr)
      canvas.text(area, 0, 0, "The unit's state is being read ...", Tone::warning);
    else
      canvas.text(area, 0, 0, fmt::format("unit {} ({})", s->identity.serial_number, s->identity.unit_name),
                  Tone::strong);
    if (read_ && lack().empty())
      canvas.text_right(area, 0, age_s() < 3.0 ? "live" : fmt::format("read {:.0f} s ago", age_s()),
                        age_s() < 3.0 ? Tone::good : Tone::warning);
  }

  void draw_state(Canvas& canvas, const Area& area) const {
    const protocol::UnitStatus& s = snapshot()->status;
    const protocol::Identity& unit = snapshot()->identity;
    int row = 0;
    const auto add = [&](const std::string& name, const std::string& text, Tone tone = Tone::plain) {
      canvas.text(area, row, 0, name, Tone::faint);
      row += canvas.paragraph(area.right_of(kNameColumns), row, text, tone);
    };
    add("mode", fmt::format("{}: {}", word_of(s.mode), meaning_of(s.mode)),
        s.mode == UnitMode::halted ? Tone::bad : Tone::strong);
    if (s.mode == UnitMode::datuming)
      for (const Axis a : kAllAxes)
        if (unit.axis_present[index_of(a)])
          add("", fmt::format("{}: {}", letter_of(a), ecs::name_of(s.axes[index_of(a)].datum_stage)));
    const bool sound = s.fault == Fault::none;
    add("fault", sound ? "none" : fault_sentence(s), sound ? Tone::good : Tone::bad);
    for (const Axis a : kAllAxes)
      if (const DatumFailure why = s.axes[index_of(a)].datum_failure; why != DatumFailure::none)
        add("cause", fmt::format("axis {}: {}. What to do: {}", letter_of(a), ecs::name_of(why), advice_for(why)),
            Tone::bad);
    ++row;
    for (const std::string& line : owned_lines_of(memory_text(s))) {
      const bool wrong = line.find("failed") != std::string::npos || line.find("differ") != std::string::npos;
      add(line.substr(0, kNameColumns), line.substr(std::min<std::size_t>(kNameColumns, line.size())),
          wrong ? Tone::bad : Tone::plain);
    }
    if (const auto& lines = snapshot()->lines) {
      add("battery", battery_cell(*lines).text,
          lines->battery == protocol::BatteryState::low ? Tone::warning : Tone::plain);
      if (lines->control_on_wired)
        add("control", control_cell(*lines).text, lines->control_on ? Tone::plain : Tone::warning);
    }
    ++row;
    add("loop period", fmt::format("{:g} us; {} periods since power-up, in every mode", s.loop_period_us, s.ticks));
    if (s.loop_overruns == 0)
      add("overruns", "none");
    else
      add("overruns", fmt::format("{} periods were late: lengthen the loop iteration time", s.loop_overruns),
          Tone::warning);
    if (s.watchdog_trips == 0)
      add("watchdog", "never tripped");
    else
      add("watchdog", fmt::format("tripped {} times", s.watchdog_trips), Tone::bad);
    add("up for", fmt::format("{}; firmware {}.{}, {} memory module{}", duration_text(s.uptime_s), unit.firmware_major,
                              unit.firmware_minor, unit.memory_modules, unit.memory_modules == 1 ? "" : "s"));
  }

  // --- keys
  [[nodiscard]] std::vector<KeyRow> key_table() {
    const auto under_way = [this] { return work_.running(); };
    const auto of_file = [this] { return !work_.running() && file_; };
    const auto of_unit = [this] { return !work_.running() && !file_; };
    const auto datuming = [this, of_unit] {
      return of_unit() && watched_.emulator && read_ && read_->snapshot.status.mode == UnitMode::datuming;
    };
    const auto choose = [this] { choose_file(); };
    return {{"Esc", "cancel", {}, under_way},
            {"Tab 1 2 3", "page", {}, of_file},
            {"l", "back to the unit", [this] { file_.reset(); }, of_file, true},
            {"up/down", "scroll", {}, of_file},
            {"o", "another file", choose, of_file},
            {"Esc", "close the file", {}, of_file},
            {"g", "reference", [this] { reference(); }, datuming, true},
            {"Tab", "page", {}, of_unit},
            {"m", "mode", [this] { ask_for_mode(); }, of_unit, true},
            {"t", "memory test", [this] { test_memory(); }, of_unit, true},
            {"c", "clear fault", [this] { ask_to_clear(); }, of_unit, true},
            {"s", "save", [this] { ask_to_save(); }, of_unit, true},
            {"o", "open", choose, of_unit, true},
            {"Esc", "back", {}, of_unit}};
  }

  void on_other_key(const Key& key) override {
    const int count = pages();
    const bool by_number =
        key.name == Key::Name::letter && key.letter >= U'1' && key.letter < U'1' + static_cast<char32_t>(count);
    const bool forward = key.name == Key::Name::tab;
    if (!by_number && !forward && key.name != Key::Name::back_tab) return static_cast<void>(scroll_.on_key(key));
    page_ = static_cast<Page>(by_number ? static_cast<int>(key.letter - U'1')
                                        : (static_cast<int>(page()) + (forward ? 1 : count - 1)) % count);
    scroll_ = {};
  }

  [[nodiscard]] Step leave() override {
    if (work_.running()) {
      work_.cancel();
      reference_.cancel();
      return stay();
    }
    if (!file_) return back();
    file_.reset();
    return stay();
  }

  /// Nothing is done while a file is shown or something is under way; says why not.
  [[nodiscard]] bool may_act() {
    if (file_)
      message_.say("A file is shown: press l to return to the unit first.", Tone::warning);
    else if (!read_)
      message_.say("The unit has not answered yet.", Tone::warning);
    else if (work_.running())
      message_.say(work_.label() + " is running: press Esc to cancel.", Tone::warning);
    else
      return true;
    return false;
  }
  /// The unit is in integration mode too; says why not.
  [[nodiscard]] bool may_change(std::string_view what) {
    if (!may_act()) return false;
    const std::string why = refusal_in(read_->snapshot.status.mode, what, "Press m to switch.");
    if (!why.empty()) message_.say(why, Tone::warning);
    return why.empty();
  }

  // --- what is done
  /// @param words  of the command that does the same
  /// @param work  on the unit: what there is to say of it
  void start(const std::string& working_on, const std::vector<std::string>& words,
             const std::function<Result<std::string>(UnitLink&, JobControl&)>& work) {
    work_.start(
        working_on,
        [connection = connection_, work](JobControl& control) {
          return connection->with_link(control, [&](UnitLink& link) { return work(link, control); });
        },
        [this, words](const Result<std::string>& done) {
          const bool refused = !done && done.error().kind == ProblemKind::refused;  // a memory test that failed
          if (done || (refused && words.back() == "ramtest")) note_on_unit(*connection_, words, done ? 0 : 1);
          say_done(done, work_.cancelled());
        });
  }

  void say_done(const Result<std::string>& done, bool given_up) {
    at_once_ = true;
    acted_at_ = Clock::now();
    if (done)
      message_.say(*done);
    else
      say_failed(message_, done.error(), given_up);
  }

  void test_memory() {
    if (!may_change("The memory can be tested")) return;
    start("memory test", {"utility", "ramtest"}, [](UnitLink& link, JobControl& control) -> Result<std::string> {
      ECS_TRY(result, link.client().run_ram_test(
                          [&control](const protocol::CommandResult& busy) { control.part = busy.per_mille / 1000.0; }));
      if (result.value == protocol::kUnused)
        return std::string("Every location of the axis memory stores the written value.");
      return problem(
          ProblemKind::refused,
          "The memory test failed at 0x{:06X}: replace the axis memory module that contains this address, then "
          "send parameters and map again.",
          result.value);
    });
  }

  void ask_to_clear() {
    if (!may_act()) return;
    const bool is_read_since = read_begun_at_ >= acted_at_;  // a command may just have brought a fault
    if (is_read_since && read_->snapshot.status.fault == Fault::none)
      return message_.say("There is no fault to clear.", Tone::warning);
    if (!may_change("A fault can be cleared")) return;
    asking_.ask({"Clear the fault of the unit?",
                 "Fault, axis and address will be lost; press s first to save them in a file. The cause is not "
                 "removed, and the mode does not change.",
                 "clear it", "keep it"},
                [this] {
                  start("clearing the fault", {"utility", "clear"}, [](UnitLink& link, JobControl&) {
                    return link.client().clear_fault().map([] { return std::string("The fault is cleared."); });
                  });
                });
  }

  void ask_for_mode() {
    if (!may_act()) return;
    if (integrating())
      asking_.ask(
          {"Go to compensation mode?",
           "The unit tests its memory and map and clears the references. Then the machine's control must "
           "reference every axis. When the last one is referenced, every relay closes, and THE MACHINE IS MOVED "
           "by the compensation of each axis from then on. Keep clear of it.",
           "compensate", "stay"},
          [this] { compensate(); });
    else
      asking_.ask({"Go to integration mode?",
                   "Every relay opens at once and the loop ends: the present compensation is removed" +
                       moved_by_leaving() + "Do it while no workpiece is being cut.",
                   "integrate", "stay"},
                  [this] { integrate(); });
  }

  [[nodiscard]] std::string moved_by_leaving() const {
    std::string moved;
    if (const auto sample = connection_->newest(); sample && sample->mode == UnitMode::compensating)
      for (const Axis a : kAllAxes)
        if (const auto& axis = sample->axes[index_of(a)]; axis.present)
          moved += fmt::format("{}{} {:+.1f} um", moved.empty() ? "" : ", ", letter_of(a), -axis.compensation_um);
    return moved.empty() ? ". " : ", so THE MACHINE MOVES by about " + moved + ". ";
  }

  void compensate() {
    start("compensation mode", {"utility", "mode", "compensate", "--wait", "0"}, [](UnitLink& link, JobControl&) {
      return begin_compensation(link.client()).map([&link] {
        return fmt::format("Reference every axis of the machine now{}.",
                           link.is_emulator() ? ": press g to reference the emulated machine" : ", at its own control");
      });
    });
  }

  void integrate() {
    start("integration mode", {"utility", "mode", "integrate"}, [](UnitLink& link, JobControl&) {
      return link.client().enter_integration().map(
          [] { return std::string("Integration mode: every relay is open."); });
    });
  }

  /// The bundled emulator's machine references all its axes.
  void reference() {
    if (!may_act()) return;
    if (read_->workshop.empty())
      return message_.say("Only the bundled emulator can be referenced here. Reference the axes at the control.",
                          Tone::warning);
    if (reference_.running()) return;
    message_.say("The emulated machine references its axes ...");
    reference_machine(reference_, read_->workshop, {}, message_);
  }

  // --- files
  void choose_file() {
    prompt_.choose("Open the saved state of a unit, or a dump of its memory", {{FileKind::status, FileKind::memory}},
                   [this](const std::string& path) {
                     std::string refusal = neither_status_nor_dump(path);
                     if (refusal.empty()) open(path);
                     return refusal;
                   });
  }

  void open(const std::string& path) {
    if (opening_.running()) return;
    const auto work = [path](JobControl&) { return read_status_file(path); };
    opening_.start("opening", work, [this, path](Result<StatusFile> opened) {
      if (!opened) return message_.say(opened.error());
      file_ = std::move(*opened);
      opened_ = path;
    });
  }

  void ask_to_save() {
    if (snapshot() == nullptr) return message_.say("No data to save yet.", Tone::warning);
    ask_where_to_save("Save as:", file_name_now("status", ".json"), [this](const std::string& path) { save(path); });
  }

  void save(const std::string& path) {
    if (snapshot() == nullptr || writing_.running()) return;
    const auto work = [path, snapshot = *snapshot()](JobControl&) -> Result<std::string> {
      ECS_DO(write_snapshot(path, snapshot));
      return "written: " + path;
    };
    writing_.start("writing", work, [this, path, of_file = file_.has_value()](const Result<std::string>& done) {
      if (done && of_file)
        note_command({"utility", "status", "--from", path_word(opened_), "--save", path_word(path)});
      else if (done)
        note_on_unit(*connection_, {"utility", "status", "--save", path_word(path)});
      say_done(done, false);
    });
  }

  // --- reading
  void start_reading() {
    if (file_ || work_.running() || reading_.running()) return;
    const auto rest = std::max<Clock::duration>(kBetweenReadings, kRestPerReading * took_);
    if (!at_once_ && Clock::now() - std::max(read_at_, asked_at_) < rest) return;
    at_once_ = false;
    asked_at_ = Clock::now();
    const auto work = [connection = connection_](JobControl& control) {
      return connection->with_link(control, [](UnitLink& link) -> Result<Read> {
        ECS_TRY(snapshot, take_snapshot(link.client(), link.name(), protocol::kEventsInBlock));
        return Read{std::move(snapshot), link.workshop()};
      });
    };
    reading_.start("reading", work, [this](Result<Read> read) {
      took_ = Clock::now() - asked_at_;
      problem_ = read ? "" : to_text(read.error());
      if (!read) return;
      read_ = std::move(*read);
      read_at_ = Clock::now();
      read_begun_at_ = asked_at_;
    });
  }

  [[nodiscard]] bool look() override {
    bool changed = std::exchange(watched_, connection_->snapshot()).problem != watched_.problem;
    start_reading();
    for (TaskRunner* task : {&reading_, &work_, &writing_, &opening_}) changed = task->advance() || changed;
    if (reference_.advance()) {
      changed = at_once_ = true;
      if (!message_.is_problem())
        message_.say(integrating() ? "The emulated machine was referenced. The unit follows this only in compensation "
                                     "mode, so its axes on page 3 have not changed. Press m to switch, then g."
                                   : "The emulated machine was referenced: the unit's answer is above.");
    }
    const int age = read_ ? static_cast<int>(age_s()) : 0;
    return std::exchange(shown_age_, age) != age || changed || work_.running();
  }

  std::shared_ptr<UnitConnection> connection_;
  WatchedUnit watched_;
  std::optional<Read> read_;
  Clock::time_point read_at_{}, read_begun_at_{};
  Clock::time_point acted_at_{};  ///< the last command ended
  Clock::time_point asked_at_{};
  Clock::duration took_{};
  int shown_age_ = 0;
  bool at_once_ = true;  ///< the next reading comes without waiting
  std::string problem_;
  std::optional<StatusFile> file_;
  std::string opened_;  ///< path of `file_`
  Page page_ = Page::state;
  ScrollPlace scroll_;
  TaskRunner reference_;
  TaskRunner work_;
  TaskRunner reading_;
  TaskRunner opening_;
  TaskRunner writing_;
};

}  // namespace

std::unique_ptr<Screen> status_screen(std::shared_ptr<UnitConnection> connection, const std::string& file) {
  return std::make_unique<StatusScreen>(std::move(connection), file);
}

std::vector<MenuChoice> utility_choices(const std::shared_ptr<UnitConnection>& connection) {
  return {
      {"SET AXIS POSITION", "displayed position of an axis; nothing moves",
       [connection] { return position_screen(connection); }},
      {"OUTPUT COMPENSATION VALUE", "output value of one axis; its relay",
       [connection] { return output_screen(connection); }},
      {"RECORD DATUM SEQUENCE", "ten seconds of an axis being referenced",
       [connection] { return datum_record_screen(connection); }},
      {"DISPLAY DATUM SEQUENCE", "a record as a graph; two records overlaid", [] { return datum_view_screen(); }},
      {"TEST DATUM ROUTINE", "the unit's datum routine, stage by stage",
       [connection] { return datum_test_screen(connection); }},
      {"DISPLAY ECS STATUS", "mode and fault; change mode, clear, test memory",
       [connection] { return status_screen(connection); }},
      {"RUN USER SOFTWARE", "machine code in the unit's memory",
       [connection] { return form_titled("RUN USER SOFTWARE", connection); }},
      {"TOOLS", "table of tools: select, set, remove, send a file", [connection] { return tools_screen(connection); }},
  };
}

}  // namespace ecs::app
