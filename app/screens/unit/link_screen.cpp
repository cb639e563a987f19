// LINK: the setting as a form with the ports there are, the doctor at work, the counts of the link.
#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "app/screens/unit/screens.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/link/controller.hpp"

namespace ecs::app {
namespace {

constexpr double kFar = 20.0;   ///< times the mean
constexpr double kMuch = 0.01;  ///< of the requests: more than this is worth a look at the cable

std::string count(std::uint64_t n) { return fmt::format("{}", n); }

double share(std::uint64_t n, std::uint64_t of) {
  return of == 0 ? 0.0 : static_cast<double>(n) / static_cast<double>(of);
}

StatisticsRow trouble(const char* name, std::uint64_t n, std::uint64_t of, const char* meaning) {
  return {name, count(n), n == 0 ? "" : meaning,
          n == 0 ? Tone::good : (share(n, of) > kMuch ? Tone::bad : Tone::warning)};
}

}  // namespace

std::vector<StatisticsRow> statistics_rows(const WatchedUnit& unit) {
  const protocol::LinkStatistics& s = unit.statistics;
  return {{"requests", count(s.requests), "", Tone::plain},
          {"replies", count(s.replies), "", Tone::plain},
          trouble("retries", s.retries, s.requests, "asked again: see the rows below for why"),
          trouble("time-outs", s.timeouts, s.requests, "no answer came: plugs, cable, unit off or busy"),
          trouble("CRC errors", s.crc_errors, s.requests, "garbled: shield, ground, cable length, parity"),
          trouble("stale replies", s.stale_replies, s.requests, "too late: slow converter or network"),
          trouble("exceptions", s.exceptions, s.requests, "the unit refused a request: LOG has its words"),
          {"bytes sent", count(s.bytes_sent), "", Tone::plain},
          {"bytes received", count(s.bytes_received), "", Tone::plain},
          {"mean round trip", s.replies == 0 ? "-" : fmt::format("{:.1f} ms", s.mean_round_trip_ms()), "", Tone::plain},
          {"worst round trip", s.replies == 0 ? "-" : fmt::format("{:.1f} ms", s.worst_round_trip_ms),
           s.replies > 0 && s.worst_round_trip_ms > kFar * s.mean_round_trip_ms()
               ? "far above the mean: retries or a busy computer"
               : "",
           Tone::plain},
          {"samples a second", fmt::format("{:.1f}", unit.per_second), "while this page is open, as fast as it goes",
           Tone::plain},
          trouble("times lost", unit.times_lost, 0, "was opened again: unit off or plug pulled?")};
}

StatisticsRow judgement(const WatchedUnit& unit) {
  const protocol::LinkStatistics& s = unit.statistics;
  if (unit.lent) return {"", "", "the link is in use by the doctor or a verb", Tone::warning};
  if (!unit.open) return {"", "", unit.problem.empty() ? "no link is open yet" : unit.problem, Tone::bad};
  if (s.requests < 20) return {"", "", "too few requests to judge the link yet", Tone::faint};
  if (share(s.crc_errors, s.requests) > kMuch)
    return {"", "", "many garbled answers: check shield, ground, length of the cable, and the parity", Tone::bad};
  if (share(s.foreign_replies, s.requests) > kMuch)
    return {"", "", "many answers to another host's requests: one host at a time may use the link", Tone::bad};
  if (share(s.stale_replies, s.requests) > kMuch)
    return {"", "", "many late answers: a slow converter or network; lower the latency timer of a USB adapter",
            Tone::bad};
  if (share(s.timeouts, s.requests) > kMuch)
    return {"", "", "many requests without an answer: check plugs and cable", Tone::bad};
  if (s.retries > 0) return {"", "", "a good link: a few requests had to be repeated, nothing was lost", Tone::good};
  return {"", "", "a clean link: every request was answered at once", Tone::good};
}

namespace {

constexpr const char* kTitles[] = {"Setting", "Doctor", "Statistics"};
constexpr int kNameColumns = 10;

std::string sign_of(FindingState state) {
  if (state == FindingState::ok) return "ok     ";
  return state == FindingState::note ? "note   " : "PROBLEM";
}

Tone tone_of(FindingState state) {
  if (state == FindingState::ok) return Tone::good;
  return state == FindingState::note ? Tone::warning : Tone::bad;
}

/// Why a port cannot be opened, whole, and what helps.
std::string what_to_do(const FoundPort& port) {
  if (port.trouble.empty()) return port.action;
  return port.action.empty() ? port.trouble : port.trouble + ": " + port.action;
}

struct ToneLine {
  std::string text;
  Tone tone = Tone::plain;
};

void add_wrapped(std::vector<ToneLine>& lines, const std::string& text, int columns, const std::string& first,
                 const std::string& then, Tone tone) {
  bool begun = false;
  for (const std::string& line : wrapped(text, std::max(10, columns - std::max(width_of(first), width_of(then))))) {
    lines.push_back({(begun ? then : first) + line, tone});
    begun = true;
  }
}

class LinkScreen final : public Screen {
 public:
  explicit LinkScreen(std::shared_ptr<UnitConnection> unit) : unit_(unit), controller_(std::move(unit)) {}

  [[nodiscard]] std::string title() const override { return "LINK"; }
  void draw(Canvas& canvas, const Area& area) const override {
    if (area.rows < 1 || area.columns < 10) return;
    draw_top(canvas, area.top(2));
    const std::string why = controller_.message().text().empty() ? controller_.unit().problem : std::string();
    const int columns = area.columns - 2;
    const int why_rows = why.empty() ? 0 : std::min(area.rows / 3, static_cast<int>(wrapped(why, columns).size()));
    const int message_part = std::max({2, rows_of_message(controller_.message(), columns, area.rows / 3), why_rows});
    const Area body{area.row + 2, area.column + 1, std::max(0, area.rows - 2 - message_part), area.columns - 2};
    if (page_ == Page::setting) draw_setting(canvas, body);
    if (page_ == Page::doctor) draw_doctor(canvas, body);
    if (page_ == Page::statistics) draw_statistics(canvas, body);
    const Area bottom{area.row + area.rows - message_part, area.column + 1, message_part, area.columns - 2};
    if (area.rows > 4) {
      if (!controller_.working_on().empty() && controller_.message().text().empty())
        canvas.text(
            bottom, 0, 0,
            fmt::format("{} ... {:.0f} s, Esc gives it up", controller_.working_on(), controller_.seconds_working()),
            Tone::warning);
      else if (!controller_.message().text().empty())
        draw_message(canvas, bottom, controller_.message());
      else if (!why.empty() && page_ != Page::doctor)
        canvas.paragraph(bottom, 0, why, Tone::bad);
      else if (page_ == Page::setting && body.rows < static_cast<int>(fields().size()) + 3)
        canvas.paragraph(bottom, 0, help_here(), Tone::faint);
    }
    draw_question(canvas, area, controller_.asking());
  }

  [[nodiscard]] Step on_key(const Key& key) override {
    if (answers(controller_.asking(), key)) return stay();
    if (editing_) {
      on_edit_key(key);
      return stay();
    }
    if (key.name == Key::Name::escape || is_letter(key, U'q')) {
      if (!controller_.working_on().starts_with("trying")) return back();
      controller_.cancel();
      return stay();
    }
    if (key.name == Key::Name::resized) return stay();
    controller_.message().clear();
    if (key.name == Key::Name::tab)
      to_page(static_cast<Page>((static_cast<int>(page_) + 1) % 3));
    else if (is_letter(key, U'1') || is_letter(key, U'2') || is_letter(key, U'3'))
      to_page(static_cast<Page>(key.letter - U'1'));
    else if (is_letter(key, U't')) {
      if (controller_.try_it()) to_page(Page::doctor);
    } else if (is_letter(key, U'u'))
      controller_.use();
    else if (is_letter(key, U's'))
      controller_.store();
    else if (is_letter(key, U'r'))
      controller_.look_for_ports();
    else if (page_ == Page::setting)
      on_setting_key(key);
    else
      (void)scroll_.on_key(key);
    return stay();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (editing_) return {{"Enter", "take it"}, {"Esc", "leave it"}};
    return {{"Enter", "edit"},
            {"< >", "choose"},
            {"t", "try"},
            {"u", "use now"},
            {"s", "store"},
            {"Tab 1 2 3", "page"},
            {"r", "look for ports again"}};
  }

  [[nodiscard]] std::string help() const override {
    return "How the unit is reached. Set the fields, t lets the doctor try them and says step by step what it finds "
           "and what to do (it only reads), u uses the setting now in all screens, s stores it for the next start. If "
           "another setting answers, it is offered. The statistics count what happened on the link since it was "
           "opened.";
  }

  [[nodiscard]] bool advance() override { return controller_.advance(); }
  [[nodiscard]] bool typing() const override { return editing_; }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    if (!editing_) return {-1, -1};
    const int columns = std::max(1, area.columns - 2 - kNameColumns - 2);
    return {area.row + 2 + row_.selected, area.column + 1 + kNameColumns + 2 + text_.cursor_column(columns)};
  }

 private:
  enum class Page { setting, doctor, statistics };
  void to_page(Page page) {
    page_ = page;
    scroll_ = {};
    watching_.reset();
    if (page == Page::statistics) watching_.emplace(unit_);
  }

  void on_setting_key(const Key& key) {
    const auto rows = fields();
    const auto count = static_cast<int>(rows.size());
    if (key.name == Key::Name::mouse && key.row >= first_row_ && key.row < first_row_ + count)
      row_.selected = key.row - first_row_;
    if (row_.on_key(key, count + static_cast<int>(controller_.ports().size()))) return;
    if (row_.selected >= count) {
      if (key.name == Key::Name::enter) take_port();
      return;
    }
    const bool forward = key.name == Key::Name::right || is_letter(key, U' ');
    if (forward || key.name == Key::Name::left) {
      controller_.form().step(row_.selected, forward ? 1 : -1, controller_.port_names());
    } else if (key.name == Key::Name::enter && row_.selected == 0) {
      controller_.form().step(0, 1, controller_.port_names());
    } else if (key.name == Key::Name::enter) {
      text_.set(rows[static_cast<std::size_t>(row_.selected)].value);
      editing_ = true;
    }
  }

  void on_edit_key(const Key& key) {
    if (key.name == Key::Name::escape) {
      editing_ = false;
    } else if (key.name == Key::Name::enter || key.name == Key::Name::up || key.name == Key::Name::down) {
      controller_.form().set(row_.selected, text_.text());
      editing_ = false;
    } else {
      (void)text_.on_key(key);
    }
  }

  void take_port() {
    const int at = row_.selected - static_cast<int>(fields().size());
    if (at < 0 || at >= static_cast<int>(controller_.ports().size())) return;
    if (controller_.form().kind() != LinkKind::serial) controller_.form().set(0, "serial line");
    controller_.form().set(1, controller_.ports()[static_cast<std::size_t>(at)].device);
    row_.selected = 1;
  }

  [[nodiscard]] std::vector<LinkField> fields() const { return controller_.form().fields(controller_.port_names()); }

  void draw_top(Canvas& canvas, const Area& area) const {
    const WatchedUnit unit = controller_.unit();
    const Area text = area.between_margins();
    const std::string link = unit.link.empty() ? unit_->link() : unit.link;
    std::string state = "opening ...";
    Tone tone = Tone::warning;
    if (unit.lent) {
      state = "lent";
    } else if (!unit.problem.empty()) {
      state = "NO ANSWER";
      tone = Tone::bad;
    } else if (unit.open) {
      state = unit.identity ? fmt::format("unit {} answers", unit.identity->serial_number) : "open";
      tone = Tone::good;
    }
    canvas.text({text.row, text.column, 1, text.columns - width_of(state) - 1}, 0, 0,
                fmt::format("in use: {}", link.empty() ? "the bundled emulator" : link), Tone::strong);
    canvas.text_right(text, 0, state, tone);
    int column = 0;
    for (int p = 0; p < 3; ++p) {
      const bool here = static_cast<Page>(p) == page_;
      column +=
          canvas.text(text, 1, column, fmt::format("{}{} {}{}", here ? "[" : " ", p + 1, kTitles[p], here ? "]" : " "),
                      here ? Tone::strong : Tone::faint);
    }
  }

  /// Of the row under the cursor.
  [[nodiscard]] std::string help_here() const {
    const auto rows = fields();
    const auto at = static_cast<std::size_t>(std::max(0, row_.selected));
    return at < rows.size() ? rows[at].help : "Enter takes this port into the form";
  }

  void draw_setting(Canvas& canvas, const Area& area) const {
    const auto rows = fields();
    const auto ports = static_cast<int>(controller_.ports().size());
    first_row_ = area.row;
    const int selected = std::clamp(row_.selected, 0, static_cast<int>(rows.size()) + ports - 1);
    for (int r = 0; r < std::min(area.rows, static_cast<int>(rows.size())); ++r) {
      const LinkField& field = rows[static_cast<std::size_t>(r)];
      const bool here = r == selected;
      canvas.text(area, r, 0, here ? ">" : " ", Tone::strong);
      canvas.text(area, r, 2, field.name, Tone::faint);
      const int columns = area.columns - kNameColumns - 2;
      if (here && editing_)
        text_.draw(canvas, area, r, kNameColumns + 2, std::max(1, columns), true);
      else
        canvas.text(area, r, kNameColumns + 2,
                    field.choices.empty() || width_of(field.value) + 6 > columns ? field.value : field.value + "   < >",
                    here ? Tone::selected : Tone::plain);
    }
    int row = static_cast<int>(rows.size()) + 1;
    if (row + 1 >= area.rows) return;
    const Area text = area.right_of(2);
    row += canvas.paragraph(text, row, help_here(), Tone::faint);
    const std::string made = controller_.form().text();
    row += canvas.paragraph(text, row, fmt::format("makes {}{}", made, controller_.stored() == made ? " (stored)" : ""),
                            Tone::strong);
    row += canvas.paragraph(text, row,
                            controller_.stored().empty() ? "stored: none; without --link the bundled emulator is used"
                                                         : "stored: " + controller_.stored(),
                            Tone::faint);
    if (row + 2 < area.rows) draw_ports(canvas, {area.row + row + 1, area.column, area.rows - row - 1, area.columns});
  }

  void draw_ports(Canvas& canvas, const Area& area) const {
    canvas.text(area, 0, 2, "serial ports of this computer", Tone::faint);
    if (controller_.ports().empty()) {
      canvas.text(area, 1, 2,
                  controller_.ports_known()
                      ? "none: plug the adapter in, then r looks again; `dmesg` tells what it sees"
                      : "looking ...");
      return;
    }
    std::vector<ListRow> rows;
    for (const FoundPort& port : controller_.ports())
      rows.push_back({port.trouble.empty() ? fmt::format("{:<24} can be opened", port.device)
                                           : fmt::format("{:<24} {}", port.device, port.trouble),
                      port.trouble.empty() ? Tone::good : Tone::warning});
    const int before = static_cast<int>(fields().size());
    ListPlace place;
    place.selected = std::max(0, row_.selected - before);
    const bool here = row_.selected >= before;
    const std::string action = here && place.selected < static_cast<int>(rows.size())
                                   ? what_to_do(controller_.ports()[static_cast<std::size_t>(place.selected)])
                                   : "";
    const int list = std::min(static_cast<int>(rows.size()), area.rows - 1 - (action.empty() ? 0 : 2));
    draw_list(canvas, {area.row + 1, area.column, std::max(1, list), area.columns}, rows, place, here);
    if (!action.empty()) canvas.paragraph(area.right_of(2), 1 + list, action, Tone::warning);
  }

  void draw_doctor(Canvas& canvas, const Area& area) const {
    const int columns = area.columns - 1;  // the last one is for the scroll marks
    const DoctorAnswer answer = controller_.doctor();
    std::vector<ToneLine> lines;
    if (answer.link.empty()) {
      add_wrapped(lines,
                  "t tries the setting of page 1: port, permission, answer, echo, other unit numbers, other speeds and "
                  "parities. It only reads. What it finds appears here with what to do.",
                  columns, "", "", Tone::plain);
    } else {
      add_wrapped(lines, "tried: " + answer.link, columns, "", "  ", Tone::strong);
      for (const DoctorFinding& finding : answer.findings) {
        add_wrapped(lines, fmt::format("{}: {}", finding.check, finding.message), columns,
                    sign_of(finding.state) + "  ", "         ", tone_of(finding.state));
        if (!finding.action.empty()) add_wrapped(lines, finding.action, columns, "      -> ", "         ", Tone::plain);
      }
      if (!answer.trying.empty()) lines.push_back({answer.trying + " ...", Tone::warning});
      if (answer.diagnosis)
        lines.push_back({answer.diagnosis->works ? "the link works" : "the link does not work",
                         answer.diagnosis->works ? Tone::good : Tone::bad});
    }
    const int count = static_cast<int>(lines.size());
    scroll_.first = std::clamp(scroll_.first, 0, std::max(0, count - area.rows));
    for (int r = 0; r < std::min(area.rows, count - scroll_.first); ++r) {
      const ToneLine& line = lines[static_cast<std::size_t>(scroll_.first + r)];
      canvas.text(area, r, 0, line.text, line.tone);
    }
    draw_scroll_marks(canvas, area, scroll_.first, count);
  }

  void draw_statistics(Canvas& canvas, const Area& area) const {
    const WatchedUnit unit = controller_.unit();
    const StatisticsRow verdict = judgement(unit);
    const int row = std::min(std::max(1, area.rows / 3),
                             canvas.paragraph(area.top(area.rows / 3), 0, verdict.meaning, verdict.tone));
    std::vector<ToneLine> lines;
    const auto add = [&](const StatisticsRow& one) {
      const Tone tone = one.tone == Tone::good ? Tone::plain : one.tone;
      std::string line = fmt::format("{:<17}{:>12}  ", one.name, one.value);
      if (area.columns < 70) {  // the meaning below
        lines.push_back({line, tone});
        if (!one.meaning.empty()) add_wrapped(lines, one.meaning, area.columns - 1, "  ", "  ", tone);
      } else {
        add_wrapped(lines, one.meaning, area.columns - 1, line, std::string(line.size(), ' '), tone);
      }
    };
    for (const StatisticsRow& one : statistics_rows(unit)) add(one);
    const double open_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - unit.opened_at).count();
    if (unit.open) add({"open for", fmt::format("{:.0f} s", open_s), "", Tone::plain});
    const Area list = area.below(row + 1);
    const int count = static_cast<int>(lines.size());
    scroll_.first = std::clamp(scroll_.first, 0, std::max(0, count - list.rows));
    for (int r = 0; r < std::min(list.rows, count - scroll_.first); ++r) {
      const ToneLine& line = lines[static_cast<std::size_t>(scroll_.first + r)];
      canvas.text(list, r, 0, line.text, line.tone);
    }
    draw_scroll_marks(canvas, list, scroll_.first, count);
  }

  std::shared_ptr<UnitConnection> unit_;
  LinkController controller_;
  Page page_ = Page::setting;
  ListPlace row_;              ///< of the fields, then of the ports
  mutable int first_row_ = 0;  ///< of the fields on the canvas
  bool editing_ = false;
  TextLine text_;
  ScrollPlace scroll_;
  std::optional<UnitConnection::Watching> watching_;  ///< while the statistics are shown
};

}  // namespace

std::unique_ptr<Screen> link_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<LinkScreen>(std::move(connection));
}

}  // namespace ecs::app
