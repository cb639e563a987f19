// LINK: the setting as a form with the ports there are, the doctor at work, the counts of the link.
#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "app/screens/files/keyed_screen.hpp"
#include "app/screens/unit/screens.hpp"
#include "commissioning/link/doctor.hpp"
#include "commissioning/session/commands.hpp"

namespace ecs::app {
namespace {

constexpr double kFar = 20.0;   ///< times the mean
constexpr double kMuch = 0.01;  ///< of the requests: more than this is worth a look at the cable

std::string count(std::uint64_t n) { return fmt::format("{}", n); }

double share(std::uint64_t n, std::uint64_t of) {
  return of == 0 ? 0.0 : static_cast<double>(n) / static_cast<double>(of);
}

StatisticsRow trouble(const char* name, std::uint64_t n, std::uint64_t of, const char* meaning) {
  return {name, count(n), meaning, n == 0 ? Tone::good : (share(n, of) > kMuch ? Tone::bad : Tone::warning)};
}

}  // namespace

std::vector<StatisticsRow> statistics_rows(const WatchedUnit& unit) {
  const protocol::LinkStatistics& s = unit.statistics;
  return {{"requests", count(s.requests), "sent since the link was opened", Tone::plain},
          {"replies", count(s.replies), "valid answers to them", Tone::plain},
          trouble("retries", s.retries, s.requests, "requests sent again, for a cause below"),
          trouble("time-outs", s.timeouts, s.requests, "no answer: plugs, cable, unit off or busy"),
          trouble("CRC errors", s.crc_errors, s.requests, "garbled answers: shield, ground, length, parity"),
          trouble("stale replies", s.stale_replies, s.requests, "answers to an earlier request: slow converter"),
          trouble("exceptions", s.exceptions, s.requests, "requests that the unit refused: see MESSAGES"),
          {"bytes sent", count(s.bytes_sent), "", Tone::plain},
          {"bytes received", count(s.bytes_received), "", Tone::plain},
          {"mean round trip", s.replies == 0 ? "-" : fmt::format("{:.1f} ms", s.mean_round_trip_ms()), "", Tone::plain},
          {"worst round trip", s.replies == 0 ? "-" : fmt::format("{:.1f} ms", s.worst_round_trip_ms),
           s.replies > 0 && s.worst_round_trip_ms > kFar * s.mean_round_trip_ms()
               ? "far above the mean: retries or a busy computer"
               : "",
           Tone::plain},
          {"samples a second", fmt::format("{:.1f}", unit.per_second), "while this page is open, at the highest rate",
           Tone::plain},
          trouble("times lost", unit.times_lost, 0, "lost and reopened: unit off or plug pulled?")};
}

StatisticsRow judgement(const WatchedUnit& unit) {
  const protocol::LinkStatistics& s = unit.statistics;
  if (unit.lent) return {"", "", "the link test or a verb is using the link", Tone::warning};
  if (!unit.open) return {"", "", unit.problem.empty() ? "no link open yet" : unit.problem, Tone::bad};
  if (s.requests < 20) return {"", "", "too few requests to judge the link yet", Tone::faint};
  for (const auto& [much, what] :
       {std::pair{s.crc_errors, "garbled answers: check shield, ground, length of the cable, and the parity"},
        {s.foreign_replies, "answers to another host's requests: one host at a time may use the link"},
        {s.stale_replies, "late answers: a slow converter or network; lower the latency timer of a USB adapter"},
        {s.timeouts, "requests without an answer: check plugs and cable"}})
    if (share(much, s.requests) > kMuch) return {"", "", fmt::format("many {}", what), Tone::bad};
  if (s.retries > 0) return {"", "", "a good link: a few requests had to be repeated, none was lost", Tone::good};
  return {"", "", "a good link: every request was answered at once", Tone::good};
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

/// A serial port of this computer.
struct FoundPort {
  std::string device;
  std::string trouble;  ///< why it cannot be opened; empty: it can
  std::string action;   ///< what to do about it
};

/// Why a port cannot be opened, whole, and what helps.
std::string what_to_do(const FoundPort& port) {
  if (port.trouble.empty()) return port.action;
  return port.action.empty() ? port.trouble : port.trouble + ": " + port.action;
}

std::vector<FoundPort> survey(const std::string& in_use) {
  std::vector<FoundPort> found;
  for (const std::string& device : serial_ports()) {
    FoundPort port{device, {}, {}};
    if (device == in_use) {
      port.trouble = "in use by this program";
    } else if (const auto trouble = trouble_with(device)) {
      port.trouble = trouble->message;
      port.action = trouble->action;
    }
    found.push_back(std::move(port));
  }
  return found;
}

/// What the doctor found so far.
struct DoctorAnswer {
  std::string link{};    ///< that was tried; empty: none yet
  std::string trying{};  ///< what is being tried now; empty: it has ended
  std::vector<DoctorFinding> findings{};
  std::optional<Diagnosis> diagnosis{};  ///< at the end
};

void add_wrapped(std::vector<ListRow>& lines, const std::string& text, int columns, const std::string& first,
                 const std::string& then, Tone tone) {
  bool begun = false;
  for (const std::string& line : wrapped(text, std::max(10, columns - std::max(width_of(first), width_of(then))))) {
    lines.push_back({(begun ? then : first) + line, tone});
    begun = true;
  }
}

class LinkScreen final : public KeyedScreen {
 public:
  explicit LinkScreen(std::shared_ptr<UnitConnection> unit) : unit_(std::move(unit)) {
    const auto page = [this](Page to) { return [this, to] { to_page(to); }; };
    keys_ = {{"Enter", "edit"},
             {"< >", "choose"},
             {"t", "try", [this] { try_it(); }},
             {"u", "use now",
              [this] {
                if (const auto choice = chosen()) take(to_text(*choice));
              }},
             {"s", "store", [this] { store(); }},
             {"Tab 1 2 3", "page"},
             {"Tab", "", [this] { to_page(static_cast<Page>((static_cast<int>(page_) + 1) % 3)); }},
             {"1", "", page(Page::setting)},
             {"2", "", page(Page::doctor)},
             {"3", "", page(Page::statistics)},
             {"r", "look for ports again", [this] { look_for_ports(); }}};
    if (const auto choice = chosen_link(unit_->link())) form_ = LinkForm(*choice);
    if (const auto stored = stored_link(); stored && *stored) stored_ = **stored;
    look_for_ports();
  }

  [[nodiscard]] std::string title() const override { return "LINK"; }
  void draw(Canvas& canvas, const Area& area) const override {
    if (area.rows < 1 || area.columns < 10) return;
    draw_top(canvas, area.top(2));
    const std::string why = message_.text().empty() ? unit_->snapshot().problem : std::string();
    const int columns = area.columns - 2;
    const int why_rows = why.empty() ? 0 : std::min(area.rows / 3, static_cast<int>(wrapped(why, columns).size()));
    const int message_part = std::max({2, rows_of_message(message_, columns, area.rows / 3), why_rows});
    const Area body{area.row + 2, area.column + 1, std::max(0, area.rows - 2 - message_part), area.columns - 2};
    if (page_ == Page::setting) draw_setting(canvas, body);
    if (page_ == Page::doctor) draw_doctor(canvas, body);
    if (page_ == Page::statistics) draw_statistics(canvas, body);
    const Area bottom{area.row + area.rows - message_part, area.column + 1, message_part, area.columns - 2};
    if (area.rows > 4) {
      if (!task_.label().empty() && message_.text().empty())
        canvas.text(bottom, 0, 0, fmt::format("{} ... {:.0f} s, Esc cancels", task_.label(), task_.seconds()),
                    Tone::warning);
      else if (!message_.text().empty())
        draw_message(canvas, bottom, message_);
      else if (!why.empty() && page_ != Page::doctor)
        canvas.paragraph(bottom, 0, why, Tone::bad);
      else if (page_ == Page::setting && body.rows < static_cast<int>(fields().size()) + 3)
        canvas.paragraph(bottom, 0, help_here(), Tone::faint);
    }
    draw_question(canvas, area, asking_);
  }

  [[nodiscard]] std::string help() const override {
    return "The connection to the unit. Set the fields, then press t to test them: each step is shown with its result "
           "and remedy (the test only reads). Press u to use the setting in all screens now, s to store it for the "
           "next start. If another setting answers, it is offered. The statistics count the events on the link since "
           "it was opened.";
  }

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

  void on_other_key(const Key& key) override {
    if (page_ == Page::setting)
      on_setting_key(key);
    else
      (void)scroll_.on_key(key);
  }

  void on_setting_key(const Key& key) {
    const auto rows = fields();
    const auto count = static_cast<int>(rows.size());
    if (key.name == Key::Name::mouse && key.row >= first_row_ && key.row < first_row_ + count)
      row_.selected = key.row - first_row_;
    if (row_.on_key(key, count + static_cast<int>(ports_.size()))) return;
    if (row_.selected >= count) {
      if (key.name == Key::Name::enter) take_port();
      return;
    }
    const bool forward = key.name == Key::Name::right || is_letter(key, U' ');
    if (forward || key.name == Key::Name::left) {
      form_.step(row_.selected, forward ? 1 : -1, port_names());
    } else if (key.name == Key::Name::enter && row_.selected == 0) {
      form_.step(0, 1, port_names());
    } else if (key.name == Key::Name::enter) {
      text_.set(rows[static_cast<std::size_t>(row_.selected)].value);
      editing_ = true;
    }
  }

  [[nodiscard]] bool edits() const override { return editing_; }
  void on_edit_key(const Key& key) override {
    if (key.name == Key::Name::escape) {
      editing_ = false;
    } else if (key.name == Key::Name::enter || key.name == Key::Name::up || key.name == Key::Name::down) {
      form_.set(row_.selected, text_.text());
      editing_ = false;
    } else {
      (void)text_.on_key(key);
    }
  }

  void take_port() {
    const int at = row_.selected - static_cast<int>(fields().size());
    if (at < 0 || at >= static_cast<int>(ports_.size())) return;
    if (form_.kind() != LinkKind::serial) form_.set(0, "serial line");
    form_.set(1, ports_[static_cast<std::size_t>(at)].device);
    row_.selected = 1;
  }

  [[nodiscard]] std::vector<LinkField> fields() const { return form_.fields(port_names()); }

  void draw_top(Canvas& canvas, const Area& area) const {
    const WatchedUnit unit = unit_->snapshot();
    const Area text = area.between_margins();
    const std::string link = unit.link.empty() ? unit_->link() : unit.link;
    std::string state = "opening ...";
    Tone tone = Tone::warning;
    if (unit.lent) {
      state = task_.label().starts_with("trying") ? "in use by the test" : "in use by a command";
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
    draw_tabs(canvas, text, 1, kTitles, static_cast<int>(page_));
  }

  /// Of the row under the cursor.
  [[nodiscard]] std::string help_here() const {
    const auto rows = fields();
    const auto at = static_cast<std::size_t>(std::max(0, row_.selected));
    return at < rows.size() ? rows[at].help : "Enter copies this port to the form";
  }

  void draw_setting(Canvas& canvas, const Area& area) const {
    const auto rows = fields();
    const auto ports = static_cast<int>(ports_.size());
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
    const std::string made = form_.text();
    row += canvas.paragraph(text, row, fmt::format("resulting link: {}{}", made, stored_ == made ? " (stored)" : ""),
                            Tone::strong);
    row += canvas.paragraph(
        text, row, stored_.empty() ? "stored: none; without --link the bundled emulator is used" : "stored: " + stored_,
        Tone::faint);
    if (row + 2 < area.rows) draw_ports(canvas, {area.row + row + 1, area.column, area.rows - row - 1, area.columns});
  }

  void draw_ports(Canvas& canvas, const Area& area) const {
    canvas.text(area, 0, 2, "serial ports of this computer", Tone::faint);
    if (ports_.empty()) {
      canvas.text(area, 1, 2,
                  ports_known_ ? "none: plug in the adapter, then press r; `dmesg` shows whether it is detected"
                               : "looking ...");
      return;
    }
    std::vector<ListRow> rows;
    for (const FoundPort& port : ports_)
      rows.push_back({port.trouble.empty() ? fmt::format("{:<24} can be opened", port.device)
                                           : fmt::format("{:<24} {}", port.device, port.trouble),
                      port.trouble.empty() ? Tone::good : Tone::warning});
    const int before = static_cast<int>(fields().size());
    ListPlace place;
    place.selected = std::max(0, row_.selected - before);
    const bool here = row_.selected >= before;
    const std::string action = here && place.selected < static_cast<int>(rows.size())
                                   ? what_to_do(ports_[static_cast<std::size_t>(place.selected)])
                                   : "";
    const int list = std::min(static_cast<int>(rows.size()), area.rows - 1 - (action.empty() ? 0 : 2));
    draw_list(canvas, {area.row + 1, area.column, std::max(1, list), area.columns}, rows, place, here);
    if (!action.empty()) canvas.paragraph(area.right_of(2), 1 + list, action, Tone::warning);
  }

  void draw_lines(Canvas& canvas, const Area& area, const std::vector<ListRow>& lines) const {
    const int count = static_cast<int>(lines.size());
    scroll_.first = std::clamp(scroll_.first, 0, std::max(0, count - area.rows));
    for (int r = 0; r < std::min(area.rows, count - scroll_.first); ++r) {
      const ListRow& line = lines[static_cast<std::size_t>(scroll_.first + r)];
      canvas.text(area, r, 0, line.text, line.tone);
    }
    draw_scroll_marks(canvas, area, scroll_.first, count);
  }

  void draw_doctor(Canvas& canvas, const Area& area) const {
    const int columns = area.columns - 1;  // the last one is for the scroll marks
    const DoctorAnswer answer = doctor_->now();
    std::vector<ListRow> lines;
    if (answer.link.empty()) {
      add_wrapped(lines,
                  "Press t to test the setting of page 1: port, permission, answer, echo, other unit numbers, other "
                  "speeds and parities. The test only reads. Its findings appear here with the remedies.",
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
    draw_lines(canvas, area, lines);
  }

  void draw_statistics(Canvas& canvas, const Area& area) const {
    const WatchedUnit unit = unit_->snapshot();
    const StatisticsRow verdict = judgement(unit);
    const int row = std::min(std::max(1, area.rows / 3),
                             canvas.paragraph(area.top(area.rows / 3), 0, verdict.meaning, verdict.tone));
    std::vector<ListRow> lines;
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
    draw_lines(canvas, area.below(row + 1), lines);
  }

  // --- what is done
  [[nodiscard]] bool look() override {
    bool changed = task_.running();
    changed = task_.advance() || changed;
    changed = std::exchange(doctor_seen_, doctor_->changes()) != doctor_seen_ || changed;
    return std::exchange(unit_seen_, unit_->changes()) != unit_seen_ || changed;
  }

  [[nodiscard]] Step leave() override {
    if (!task_.label().starts_with("trying")) return back();
    task_.cancel();
    return stay();
  }

  [[nodiscard]] std::vector<std::string> port_names() const {
    std::vector<std::string> names;
    for (const FoundPort& port : ports_) names.push_back(port.device);
    return names;
  }

  [[nodiscard]] bool idle() {
    if (!task_.running()) return true;
    message_.say(fmt::format("still {}: press Esc to cancel", task_.label()), Tone::warning);
    return false;
  }

  void look_for_ports() {
    if (!idle()) return;
    const auto look = [where = unit_->snapshot().where](JobControl&) { return survey(where); };
    task_.start("looking for serial ports", look, [this](std::vector<FoundPort> found) {
      ports_ = std::move(found);
      ports_known_ = true;
    });
  }

  /// By the form; nothing where that is wrong.
  [[nodiscard]] std::optional<LinkChoice> chosen() {
    auto choice = parsed_link(form_.text(), "LINK");
    if (choice) return std::move(*choice);
    message_.say(choice.error());
    return std::nullopt;
  }

  /// The doctor tries what the form says; the unit's link is lent to it meanwhile.
  void try_it() {
    const auto choice = chosen();
    if (!choice || !idle()) return;
    to_page(Page::doctor);
    const std::string link = to_text(*choice);
    const auto tell = [doctor = doctor_](const std::string& text) {
      doctor->change([&](DoctorAnswer& answer) { answer.trying = text; });
    };
    const auto found = [doctor = doctor_](const DoctorFinding& finding) {
      doctor->change([&](DoctorAnswer& answer) { answer.findings.push_back(finding); });
    };
    doctor_->change([&](DoctorAnswer& answer) { answer = {link, "waiting for the link"}; });
    const auto examine = [unit = unit_, choice = *choice, tell, found](JobControl& control) {
      const auto lent = unit->lend();
      tell("asking the unit");
      return diagnosis_of(choice, tell, found, control.cancelled);
    };
    task_.start("trying " + link, examine,
                [this, link](const Diagnosis& diagnosis) { ended(link, diagnosis, task_.cancelled()); });
  }

  void ended(const std::string& link, const Diagnosis& diagnosis, bool cancelled) {
    doctor_->change([&](DoctorAnswer& answer) {
      answer.trying.clear();
      answer.diagnosis = diagnosis;
    });
    if (cancelled) return message_.say("cancelled: the test was not completed", Tone::warning);
    if (diagnosis.works) {
      works_ = link;
      return message_.say(link == unit_->link() || link == unit_->snapshot().link
                              ? fmt::format("{} works", link)
                              : fmt::format("{} works: press u to use it now, s to store it", link));
    }
    if (diagnosis.working_link.empty()) return message_.say(fmt::format("{} does not work", link), Tone::bad);
    works_ = diagnosis.working_link;
    asking_.ask({"Use the setting that answers?",
                 fmt::format("{} does not answer, {} does.", link, diagnosis.working_link), "use it", "cancel"},
                [this, working = diagnosis.working_link] {
                  if (const auto choice = parsed_link(working, "LINK")) form_ = LinkForm(*choice);
                  take(working);
                });
  }

  /// From now on this link, in all screens.
  void take(const std::string& link) {
    if (!idle()) return;
    const auto choose = [unit = unit_, link](JobControl&) {
      unit->choose(link);
      return link;
    };
    task_.start("changing the link", choose, [this](const std::string& chosen) {
      note_remark(fmt::format("now using the link {}", chosen));
      message_.say(fmt::format("{} is in use now; press s to store it for the next start", chosen));
    });
  }

  /// For the next start; asks first if it has not answered.
  void store() {
    const auto choice = chosen();
    if (!choice) return;
    const std::string link = to_text(*choice);
    const WatchedUnit now = unit_->snapshot();
    if (link == works_ || (now.open && now.link == link)) return store_now(link);
    asking_.ask(
        {"Store a link that has not answered?",
         fmt::format("{} has not been tested successfully. Press t to test it first.", link), "store it", "not now"},
        [this, link] { store_now(link); });
  }

  void store_now(const std::string& link) {
    if (const auto done = store_link(link); !done) return message_.say(done.error());
    stored_ = link;
    if (link == works_ || unit_->snapshot().link == link)
      note_command({"doctor", "--link", link, "--save"});
    else
      note_remark(fmt::format("{} was stored without an answer; `{}` stores it once it works", link,
                              shell_command({"ecs", "doctor", "--link", link, "--save"})));
    message_.say(
        fmt::format("{} stored in {}: used from now on where no --link is given", link, configuration_file().string()));
  }

  std::shared_ptr<UnitConnection> unit_;
  LinkForm form_;
  std::vector<FoundPort> ports_;
  bool ports_known_ = false;
  std::string stored_;  ///< as read at the beginning; empty: none
  std::string works_;   ///< a link that the doctor found to work
  std::shared_ptr<Reported<DoctorAnswer>> doctor_ = std::make_shared<Reported<DoctorAnswer>>();
  std::uint64_t doctor_seen_ = 0;
  std::uint64_t unit_seen_ = 0;
  Page page_ = Page::setting;
  ListPlace row_;              ///< of the fields, then of the ports
  mutable int first_row_ = 0;  ///< of the fields on the canvas
  bool editing_ = false;
  TextLine text_;
  ScrollPlace scroll_;
  std::optional<UnitConnection::Watching> watching_;  ///< while the statistics are shown
  TaskRunner task_;
};

}  // namespace

std::unique_ptr<Screen> link_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<LinkScreen>(std::move(connection));
}

}  // namespace ecs::app
