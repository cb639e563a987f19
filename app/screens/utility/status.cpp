// DISPLAY ECS STATUS: state with the fault in plain words, address pointers, axes; live or from a file. And the menu
// ECS UTILITY.
#include "commissioning/unit/status.hpp"

#include <fmt/format.h>

#include "app/screens/forms/rows.hpp"
#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"
#include "base/text.hpp"
#include "commissioning/utility/status_controller.hpp"
#include "core/fault.hpp"

namespace ecs::app {
namespace {

constexpr const char* kTitles[] = {"State", "Address pointers", "Axes", "Memory of the dump"};
constexpr int kNameColumns = 13;

std::string duration_text(std::uint32_t seconds) {
  if (seconds < 60) return fmt::format("{} s", seconds);
  if (seconds < 3600) return fmt::format("{} min {} s", seconds / 60, seconds % 60);
  return fmt::format("{} h {} min", seconds / 3600, seconds / 60 % 60);
}

/// A name in its column, its text beside it over as many rows as it needs. @return rows used
int draw_entry(Canvas& canvas, const Area& area, int row, const std::string& name, const std::string& text, Tone tone) {
  canvas.text(area, row, 0, name, Tone::faint);
  return canvas.paragraph({area.row, area.column + kNameColumns, area.rows, area.columns - kNameColumns}, row, text,
                          tone);
}

class StatusScreen final : public UtilityScreen<StatusController> {
 public:
  StatusScreen(std::shared_ptr<UnitConnection> connection, const std::string& file)
      : UtilityScreen(std::move(connection)) {
    if (!file.empty()) controller_.open(file);
  }

  [[nodiscard]] std::string title() const override { return "DISPLAY ECS STATUS"; }
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_source(canvas, inside);
    draw_tabs(canvas, inside.below(1));
    const Area body{inside.row + 3, inside.column, std::max(0, inside.rows - 6), inside.columns};
    const StatusSnapshot* s = controller_.snapshot();
    if (page() == Page::memory)
      draw_scrolled(canvas, body, controller_.file()->memory, scroll_);
    else if (s == nullptr)
      canvas.paragraph(body, 0,
                       "Nothing was read yet. Without a unit, o opens a status file (s of this screen, `ecs utility "
                       "status --save`) or a memory dump (`ecs memory dump`): both decode here.",
                       Tone::faint);
    else if (page() == Page::state)
      draw_state(canvas, body);
    else
      draw_scrolled(canvas, body, owned_lines_of(page() == Page::pointers ? pointers_text(*s) : axes_text(*s)),
                    scroll_);
    const Area last{inside.row + inside.rows - 3, inside.column, 3, inside.columns};
    if (controller_.busy())
      draw_progress(canvas, last, 2, controller_.working_on(), controller_.part());
    else if (controller_.message().text().empty() && controller_.file() == nullptr)
      canvas.paragraph(last, 0, controller_.lack(), Tone::bad);
    else
      draw_message(canvas, last, controller_.message());
  }

  [[nodiscard]] Step leave() override {
    if (controller_.busy() || controller_.file() == nullptr) return UtilityScreen::leave();
    controller_.close_file();
    return stay();
  }

  void on_command(const Key& key) override {
    const int count = pages();
    if (key.name == Key::Name::tab || key.name == Key::Name::back_tab) {
      page_ = static_cast<Page>((static_cast<int>(page()) + (key.name == Key::Name::tab ? 1 : count - 1)) % count);
      scroll_ = {};
    } else if (key.name == Key::Name::letter && key.letter >= U'1' &&
               key.letter < U'1' + static_cast<char32_t>(count)) {
      page_ = static_cast<Page>(key.letter - U'1');
      scroll_ = {};
    } else if (!scroll_.on_key(key)) {
      on_letter(key);
    }
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (asking_.active()) return {{"y", "yes"}, {"n", "no"}};
    if (prompt_.active()) return prompt_.keys();
    if (controller_.busy()) return {{"Esc", "give up"}};
    if (controller_.file() != nullptr)
      return {{"Tab 1 2 3", "page"},
              {"l", "back to the unit"},
              {"up/down", "scroll"},
              {"o", "another file"},
              {"Esc", "close the file"}};
    std::vector<KeyHelp> keys{{"Tab", "page"}, {"m", "mode"}, {"t", "memory test"}, {"c", "clear fault"},
                              {"s", "save"},   {"o", "open"}, {"Esc", "back"}};
    if (const auto* s = controller_.snapshot();
        controller_.emulator() && s != nullptr && s->status.mode == UnitMode::datuming)
      keys.insert(keys.begin(), {"g", "reference"});
    return keys;
  }

  [[nodiscard]] std::string help() const override {
    return "The state of the unit: mode, fault in plain words with what to do next, memory tests with their addresses, "
           "the loop; the address pointers (which value of every curve was selected last, and where it lies); the "
           "axes. It is read again every second. t tests every location of the axis memory, its contents stay. m "
           "changes between integration and compensation mode and says first what moves. s saves everything with the "
           "registers as they came; o opens such a file, or a memory dump, also without a unit. With the bundled "
           "emulator g references its machine.";
  }

 private:
  enum class Page { state, pointers, axes, memory };
  [[nodiscard]] int pages() const {
    return controller_.file() != nullptr && !controller_.file()->memory.empty() ? 4 : 3;
  }

  /// that can be shown now
  [[nodiscard]] Page page() const {
    if (controller_.file() != nullptr && controller_.snapshot() == nullptr) return Page::memory;
    return static_cast<int>(page_) < pages() ? page_ : Page::state;
  }

  void draw_source(Canvas& canvas, const Area& area) const {
    const StatusSnapshot* s = controller_.snapshot();
    if (controller_.file() != nullptr) {
      canvas.text(area, 0, 0,
                  s == nullptr ? "FILE " + controller_.file()->name
                               : fmt::format("FILE {}: unit {}, {}", controller_.file()->name,
                                             s->identity.serial_number, s->taken),
                  Tone::warning);
      return;
    }
    const auto age_s = controller_.age_s();
    if (!controller_.lack().empty())
      canvas.text(area, 0, 0, age_s ? fmt::format("NO ANSWER, what is shown is {:.0f} s old", *age_s) : "NO ANSWER",
                  Tone::bad);
    else if (s == nullptr)
      canvas.text(area, 0, 0, "The unit's state is being read ...", Tone::warning);
    else
      canvas.text(area, 0, 0, fmt::format("unit {} ({})", s->identity.serial_number, s->identity.unit_name),
                  Tone::strong);
    if (age_s && controller_.lack().empty())
      canvas.text_right(area, 0, *age_s < 3.0 ? "live" : fmt::format("read {:.0f} s ago", *age_s),
                        *age_s < 3.0 ? Tone::good : Tone::warning);
  }

  void draw_tabs(Canvas& canvas, const Area& area) const {
    int column = 0;
    for (int p = 0; p < pages(); ++p) {
      const bool here = static_cast<Page>(p) == page();
      column +=
          canvas.text(area, 0, column, fmt::format("{}{} {}{} ", here ? "[" : " ", p + 1, kTitles[p], here ? "]" : " "),
                      here ? Tone::strong : Tone::faint);
    }
  }

  void draw_state(Canvas& canvas, const Area& area) const {
    const protocol::UnitStatus& s = controller_.snapshot()->status;
    int row = draw_entry(canvas, area, 0, "mode", fmt::format("{}: {}", ecs::name_of(s.mode), meaning_of(s.mode)),
                         s.mode == UnitMode::halted ? Tone::bad : Tone::strong);
    if (s.mode == UnitMode::datuming)
      for (const Axis a : kAllAxes)
        if (controller_.snapshot()->identity.axis_present[index_of(a)])
          row += draw_entry(canvas, area, row, "",
                            fmt::format("{}: {}", letter_of(a), ecs::name_of(s.axes[index_of(a)].datum_stage)),
                            Tone::plain);
    row += s.fault == Fault::none ? draw_entry(canvas, area, row, "fault", "none", Tone::good)
                                  : draw_entry(canvas, area, row, "fault", fault_sentence(s), Tone::bad);
    for (const Axis a : kAllAxes)
      if (const DatumFailure why = s.axes[index_of(a)].datum_failure; why != DatumFailure::none)
        row += draw_entry(canvas, area, row, "cause",
                          fmt::format("axis {}: {}. What to do: {}", letter_of(a), ecs::name_of(why), advice_for(why)),
                          Tone::bad);
    ++row;
    for (const std::string& line : owned_lines_of(memory_text(s))) {
      const bool wrong = line.find("failed") != std::string::npos || line.find("differ") != std::string::npos;
      row += draw_entry(canvas, area, row, line.substr(0, kNameColumns),
                        line.substr(std::min<std::size_t>(kNameColumns, line.size())), wrong ? Tone::bad : Tone::plain);
    }
    ++row;
    row += draw_entry(canvas, area, row, "loop period",
                      fmt::format("{:g} us, {} periods since power-up", s.loop_period_us, s.ticks), Tone::plain);
    row += draw_entry(canvas, area, row, "overruns",
                      s.loop_overruns == 0
                          ? std::string("none")
                          : fmt::format("{} periods were late: lengthen the loop iteration time", s.loop_overruns),
                      s.loop_overruns == 0 ? Tone::plain : Tone::warning);
    row += draw_entry(
        canvas, area, row, "watchdog",
        s.watchdog_trips == 0 ? std::string("never tripped") : fmt::format("tripped {} times", s.watchdog_trips),
        s.watchdog_trips == 0 ? Tone::plain : Tone::bad);
    const protocol::Identity& unit = controller_.snapshot()->identity;
    draw_entry(canvas, area, row, "up for",
               fmt::format("{}; firmware {}.{}, {} memory module{}", duration_text(s.uptime_s), unit.firmware_major,
                           unit.firmware_minor, unit.memory_modules, unit.memory_modules == 1 ? "" : "s"),
               Tone::plain);
  }

  void on_letter(const Key& key) {
    if (is_letter(key, U't') && controller_.may_act() && controller_.may_change()) controller_.test_memory();
    if (is_letter(key, U'c') && controller_.may_act() && controller_.may_change())
      asking_.ask(controller_.clear_question(), [this] { controller_.clear_fault(); });
    if (is_letter(key, U'm') && controller_.may_act())
      asking_.ask(controller_.mode_question(), [this] { controller_.change_mode(); });
    if (is_letter(key, U'g') && controller_.may_act()) controller_.reference();
    if (is_letter(key, U's')) ask_save();
    if (is_letter(key, U'l')) controller_.close_file();
    if (is_letter(key, U'o'))
      prompt_.choose("Open the saved state of a unit, or a dump of its memory", {{FileKind::status, FileKind::memory}},
                     [this](const std::string& path) { controller_.open(path); });
  }

  void ask_save() {
    if (controller_.snapshot() == nullptr) {
      controller_.message().say("There is nothing to save yet.", Tone::warning);
      return;
    }
    ask_where_to_save(StatusController::proposed_name());
  }

  Page page_ = Page::state;
  ScrollPlace scroll_;
};

}  // namespace

std::unique_ptr<Screen> status_screen(std::shared_ptr<UnitConnection> connection, const std::string& file) {
  return std::make_unique<StatusScreen>(std::move(connection), file);
}

std::vector<MenuChoice> utility_choices(const std::shared_ptr<UnitConnection>& connection) {
  return {
      {"SET AXIS POSITION", "what the unit shows for an axis; nothing moves",
       [connection] { return position_screen(connection); }},
      {"OUTPUT COMPENSATION VALUE", "a value on one axis's D/A converter; the relay",
       [connection] { return output_screen(connection); }},
      {"RECORD DATUM SEQUENCE", "ten seconds of an axis being referenced",
       [connection] { return datum_record_screen(connection); }},
      {"DISPLAY DATUM SEQUENCE", "such a record as a graph; two over each other", [] { return datum_view_screen(); }},
      {"TEST DATUM ROUTINE", "the unit's datum routine, stage by stage",
       [connection] { return datum_test_screen(connection); }},
      {"DISPLAY ECS STATUS", "mode and fault; change the mode, clear, test memory",
       [connection] { return status_screen(connection); }},
      {"RUN USER SOFTWARE", "machine code in the unit's memory",
       [connection] { return form_titled("RUN USER SOFTWARE", connection); }},
  };
}

}  // namespace ecs::app
