// A form as a screen: it runs the verb, shows its progress and questions, then the answer. Does not live here: the
// fields.
#include <algorithm>
#include <deque>
#include <sstream>
#include <streambuf>

#include <fmt/format.h>

#include "app/screens/forms/form_fields.hpp"
#include "app/screens/forms/rows.hpp"
#include "app/ui/chart.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "app/verbs/registry.hpp"
#include "base/file.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::app {
namespace {

constexpr std::string_view kNext = "next: ";
constexpr const char* kLeave = "q";

/// Between the verb, which runs beside the screen, and the screen: what it says, what is typed to it.
struct Wire {
  Reported<std::string> said;
  Reported<std::deque<std::string>> typed;

  class Mouth final : public std::streambuf {
   public:
    explicit Mouth(Wire& wire) : wire_(&wire) {}

   protected:
    int_type overflow(int_type c) override {
      const char one = traits_type::to_char_type(c);
      if (!traits_type::eq_int_type(c, traits_type::eof())) xsputn(&one, 1);
      return traits_type::not_eof(c);
    }
    std::streamsize xsputn(const char* text, std::streamsize count) override {
      wire_->said.change([&](std::string& said) { said.append(text, static_cast<std::size_t>(count)); });
      return count;
    }

   private:
    Wire* wire_;
  };

  class Keys final : public Keyboard {
   public:
    Keys(Wire& wire, JobControl& control) : wire_(&wire), control_(&control) {}
    std::optional<std::string> line() override {
      if (control_->cancelled) return kLeave;
      std::optional<std::string> first;
      wire_->typed.change([&](std::deque<std::string>& lines) {
        if (lines.empty()) return;
        first = std::move(lines.front());
        lines.pop_front();
      });
      return first;
    }
    [[nodiscard]] bool ended() const override { return false; }

   private:
    Wire* wire_;
    JobControl* control_;
  };

  void type(const std::string& line) {
    typed.change([&](std::deque<std::string>& lines) { lines.push_back(line); });
  }

  /// What was said since, whole lines of it, or with `all` the rest as well.
  std::string heard(bool all) {
    std::string text;
    said.change([&](std::string& waiting) {
      text = waiting.substr(0, all ? waiting.size() : waiting.rfind('\n') + 1);
      waiting.erase(0, text.size());
    });
    return text;
  }
};

/// How a verb ended, before its answer. @param answered  it has answered on stdout
std::string ending_of(int exit_code, bool answered) {
  static constexpr const char* kEndings[] = {"done", "finished: a check failed, see below",
                                             "not run: see below for the correction",
                                             "a file cannot be used: see below", "link or unit failed: see below"};
  if (exit_code > 128) return "stopped";
  const auto code = static_cast<std::size_t>(exit_code);
  return code >= std::size(kEndings) || (code == 1 && !answered) ? "not done: the reason is shown below"
                                                                 : kEndings[code];
}

/// What a verb answered.
struct FormAnswer {
  std::vector<std::string> lines;
  int exit_code = 0;
  bool answered = false;  ///< on stdout
};

class FormScreen final : public Screen {
 public:
  FormScreen(FormRow row, VerbEntry verb, std::shared_ptr<UnitConnection> connection, const FormValues& values,
             bool at_once)
      : row_(std::move(row)),
        connection_(std::move(connection)),
        fields_(row_, std::move(verb), connection_->link(), values) {
    if (at_once && fields_.lacking().empty()) run();
  }

  ~FormScreen() override {
    if (!task_.running()) return;
    stop();
    task_.finish();
  }

  [[nodiscard]] std::string title() const override { return row_.title.empty() ? verb().name() : row_.title; }

  void draw(Canvas& canvas, const Area& area) const override {
    const Area inside = area.between_margins();
    if (prompt_.choosing()) return prompt_.draw(canvas, inside, 0);
    if (reading_) {
      draw_answer(canvas, area);
    } else {
      const int row = canvas.paragraph(inside, 0, asks(), Tone::strong);
      const Area fields = inside.below(row).top(field_rows(area));
      fields_.draw(canvas, fields);
      const int hint = row + fields.rows;
      canvas.paragraph({inside.row + hint, inside.column, std::min(2, inside.rows - hint), inside.columns}, 0,
                       hint_.empty() ? fields_.help_here() : hint_, refused_ ? Tone::bad : Tone::faint);
      draw_answer(canvas, {area.row + hint + 2, area.column, area.rows - hint - 2, area.columns});  // 80 columns
    }
    prompt_.draw(canvas, inside, inside.rows - 1);
    draw_question(canvas, area, asking_);
  }

  [[nodiscard]] Step on_key(const Key& key) override {
    if (key.name == Key::Name::resized || answers(asking_, key) || prompt_.on_key(key)) return stay();
    hint_.clear();
    refused_ = false;
    if (key.name == Key::Name::escape) return on_escape();
    if (row_.leaves_when_done && key.name == Key::Name::enter && answer_ && answer_->exit_code == 0) return back();
    if (task_.running())
      on_running_key(key);
    else if (!act_on(keys_, key) && !on_answer_key(key))
      hint_ = fields_.on_key(key, prompt_);
    return stay();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (const auto& asked = asking_.question()) return {{"y", asked->yes}, {"n", asked->no}};
    if (prompt_.active()) return prompt_.keys();
    return helps_of(keys_);
  }

  [[nodiscard]] std::string help() const override {
    return (row_.about.empty() ? verb().help + "." : row_.about) + " The fields are the options of the verb `ecs " +
           verb().name() +
           "`; those with * are needed. Tab in an empty field chooses a file. Several files are separated by spaces. "
           "Files of the required kinds in the folder of the first file are filled in. Typing replaces "
           "them. " +
           verb().example +
           "\nPress PgDn to read the answer. Up and down scroll it, left and right move a wide table sideways with its "
           "headings (< and > at the edges mark hidden columns). Home goes to its beginning. Press s to choose output "
           "files and run the verb again. Press Esc to return to the fields." +
           (verb().live ? " While it runs, the upper row shows the next step and the rows below show its messages, "
                          "newest first. Type a value or a command and press Enter: u to undo the last reading, s to "
                          "skip a target, q to quit. Where readings come from a device, an empty line is a trigger. "
                          "Esc quits: the readings so far are saved in a .part file, and --resume continues with it."
                        : "");
  }

  [[nodiscard]] bool advance() override {
    bool changed = prompt_.advance();
    changed = task_.advance() || task_.running() || changed;
    return drawing_.advance() || hear() || changed;
  }

  [[nodiscard]] bool typing() const override {
    if (asking_.active()) return false;
    return prompt_.active() || !reading_ || (task_.running() && verb().live);
  }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    const Area inside = area.between_margins();
    if (prompt_.active()) return prompt_.cursor(inside, prompt_.choosing() ? 0 : inside.rows - 1);
    if (asking_.active()) return {-1, -1};
    if (reading_ && task_.running() && verb().live) {
      const int rows = std::max<int>(1, static_cast<int>(wrapped(next(), inside.columns).size()));
      return {area.row + rows, area.column + 3 + line_.cursor_column(std::max(8, inside.columns - 2))};
    }
    if (reading_) return {-1, -1};
    return fields_.cursor(inside.below(static_cast<int>(wrapped(asks(), inside.columns).size())));
  }

 private:
  using Name = Key::Name;
  [[nodiscard]] const std::string& asks() const { return row_.asks.empty() ? verb().help : row_.asks; }
  [[nodiscard]] const VerbEntry& verb() const { return fields_.verb(); }
  [[nodiscard]] int field_rows(const Area& area) const {
    const int all = std::max(1, static_cast<int>(fields_.size()));
    const bool shares = answer_ || task_.running() || !row_.idle.empty();
    return std::min(all, shares ? std::max(3, area.rows / 3) : std::max(3, area.rows - 6));
  }

  // --- keys
  [[nodiscard]] std::vector<KeyRow> key_table() {
    const auto talking = [this] { return task_.running() && verb().live; };
    const auto reading = [this] { return !task_.running() && reading_; };
    const auto filling = [this] { return !task_.running() && !reading_; };
    std::vector<KeyRow> rows{{"Enter", "take a reading, or send the typed text", {}, talking},
                             {"u", "undo the last reading", {}, talking},
                             {"s", "skip", {}, talking},
                             {"Esc", "quit; readings are saved", {}, talking},
                             {"Esc", "stop it", {}, [this] { return task_.running() && !verb().live; }},
                             {"Enter", "run", [this] { run(); }, filling},
                             {"PgDn", "read the answer", {}, [this, filling] { return filling() && answer_; }},
                             {"up/down", "field", {}, filling},
                             {"Tab", "choose a file, complete", {}, filling},
                             {"Space", "choose", {}, filling},
                             {"Esc", "back", {}, filling}};
    if (!row_.panels.empty()) rows.push_back({"1", "answer", [this] { panel_.reset(); }, reading});
    for (std::size_t k = 0; k < row_.panels.size(); ++k)
      rows.push_back({fmt::format("{}", k + 2), row_.panels[k].first, [this, k] { show_panel(k); }, reading});
    const std::vector<KeyRow> of_answer{
        {"s", "save", [this] { ask_output(0); }, [this, reading] { return reading() && fields_.writes(); }},
        {"up/down", "read", {}, reading},
        {"left/right", "sideways", {}, reading},
        {"PgUp/PgDn", "page", {}, reading},
        {"Home", "beginning", {}, reading},
        {"Esc", "to the fields", {}, reading},
        {"F5", "run again", [this] { run(); }, reading},
        {"F5", "", [this] { run(); }}};
    rows.insert(rows.end(), of_answer.begin(), of_answer.end());
    return rows;
  }

  [[nodiscard]] Step on_escape() {
    if (task_.running()) {
      stop();
      hint_ = "stopping";
      return stay();
    }
    if (!reading_) return back();
    reading_ = false;
    return stay();
  }

  void stop() {
    task_.cancel();
    if (!verb().live) ask_to_stop();
  }

  void on_running_key(const Key& key) {
    if (!verb().live) return;
    if (key.name != Name::enter) return static_cast<void>(line_.on_key(key));
    wire_->type(line_.text());
    line_.set("");
  }

  /// Keys that go to the answer. @return whether it was one
  [[nodiscard]] bool on_answer_key(const Key& key) {
    if (!answer_) return false;
    const bool wheel = key.name == Name::wheel_up || key.name == Name::wheel_down;
    if (!reading_ && !wheel && key.name != Name::page_down && key.name != Name::page_up) return false;
    if (reading_ && (key.name == Name::back_tab || key.name == Name::tab || is_letter(key, U'e'))) {
      reading_ = false;
      return true;
    }
    if (reading_) (void)scroll_.on_key(key, answer_rows_);
    reading_ = true;  // the first key gives the answer the whole screen
    return true;
  }

  // --- running
  void run() {
    if (task_.running()) return;
    if (!fields_.lacking().empty() && fields_.fill_from_folder() && fields_.lacking().empty()) {
      hint_ = "Filled in from the folder of the model. Press Enter to run it.";
      return;
    }
    if (const std::string name = fields_.lacking(); !name.empty()) {
      hint_ = fmt::format("{} is required", name);
      refused_ = true;
      return;
    }
    ask_to_overwrite(0);
  }

  /// For each file that the verb would overwrite, from the `k`-th option on; then what the row asks.
  void ask_to_overwrite(std::size_t k) {
    const FormValues all = fields_.typed();
    for (; k < fields_.size(); ++k) {
      const std::string file(trimmed(fields_.text(k)));
      const bool changed_in_place =
          std::count_if(all.begin(), all.end(), [&file](const auto& one) { return one.second == file; }) > 1;
      if (!fields_.option(k).output || file.empty() || changed_in_place || !would_overwrite(file)) continue;
      const auto forced = all.find("--force");
      if (forced == all.end() || !forced->second.empty()) continue;
      return asking_.ask(
          {"Overwrite " + file + "?", "The file exists. Its contents will be overwritten.", "overwrite", "keep it"},
          [this, k] {
            force_ = true;
            ask_to_overwrite(k + 1);
          });
    }
    if (row_.question)
      ask_first();
    else
      start();
  }

  void ask_first() {
    const auto work = [question = row_.question, connection = connection_, all = fields_.typed()](JobControl& control) {
      return question(*connection, control, all);
    };
    answer_.reset();
    task_.start("looking", work, [this](Result<Question> question) {
      stop_asking();
      if (question) return asking_.ask(std::move(*question), [this] { start(); });
      hint_ = to_text(question.error());
      refused_ = true;
    });
  }

  void start() {
    std::vector<std::string> values;
    for (std::size_t k = 0; k < fields_.size(); ++k) values.push_back(fields_.text(k));
    words_ = command_line(verb(), values);
    if (!row_.confirmed.empty()) words_.push_back(row_.confirmed);
    if (std::exchange(force_, false)) words_.emplace_back("--force");
    answer_.reset();
    lines_for_ = -1;
    panel_.reset();
    figure_.reset();
    said_.clear();
    scroll_ = {};
    reading_ = verb().live;
    wire_ = std::make_shared<Wire>();
    const auto connection = fields_.takes("--link") ? connection_ : nullptr;
    const auto work = [row = row_, live = verb().live, words = words_, all = fields_.typed(), wire = wire_,
                       connection](JobControl& control) {
      std::optional<std::string> text = row.instead ? row.instead(all) : std::nullopt;
      if (text) return FormAnswer{owned_lines_of(*text), 0, true};
      FormAnswer answer;
      std::ostringstream out;
      {
        std::optional<UnitConnection::Lent> lent;
        if (connection) lent.emplace(*connection);
        Wire::Mouth mouth(*wire);
        std::ostream messages(&mouth);
        ConsoleOptions options;
        if (live) options.keyboard = std::make_shared<Wire::Keys>(*wire, control);
        answer.exit_code = run_program(words, out, messages, options);
      }
      answer.answered = !out.str().empty();
      std::string said = out.str();
      if (row.more && connection) said += row.more(*connection, control, answer.exit_code);
      answer.lines = owned_lines_of(said);
      return answer;
    };
    task_.start("running", work, [this](FormAnswer answer) { take(std::move(answer)); });
  }

  void take(FormAnswer answer) {
    stop_asking();
    (void)hear();
    answer.lines.insert(verb().live ? answer.lines.end() : answer.lines.begin(), said_.begin(), said_.end());
    answer_ = std::move(answer);
    if (row_.done) row_.done(*connection_, fields_.typed(), answer_->exit_code);
    if (answer_->exit_code > 1) {
      for (const std::string& line : answer_->lines) log_event(Tone::bad, verb().name() + ": " + line);
      return;
    }
    if (verb().live) note_remark("input requested: type the answer");
    if (fields_.takes("--link"))
      note_form(*connection_, words_, answer_->exit_code);
    else
      note_command(words_, answer_->exit_code);
  }

  /// Takes whole lines that the verb said. @return whether there were any
  bool hear() {
    if (!wire_) return false;
    const std::string text = wire_->heard(!task_.running());
    for (std::string& line : owned_lines_of(text)) said_.push_back(std::move(line));
    return !text.empty();
  }

  // --- files that the verb writes
  /// One after the other from the `k`-th option on; then it is run again.
  void ask_output(std::size_t k) {
    while (k < fields_.size() && !fields_.option(k).output) ++k;
    if (k == fields_.size()) return run();
    prompt_.ask(fields_.option(k).name + ":", Prompt::Kind::path, fields_.text(k), [this, k](const std::string& path) {
      fields_.set(k, path);
      ask_output(k + 1);
    });
  }

  // --- the answer
  [[nodiscard]] std::string next() const {
    const auto found =
        std::find_if(said_.rbegin(), said_.rend(), [](const std::string& line) { return line.starts_with(kNext); });
    return found == said_.rend() ? std::string() : *found;
  }

  void show_panel(std::size_t k) {
    panel_ = row_.panels[k].second;
    if (figure_ || drawing_.running()) return;
    const auto work = [figure = row_.figure, all = fields_.typed()](JobControl&) { return figure(all); };
    drawing_.start("drawing", work, [this](Result<PlotFigure> figure) { figure_ = std::move(figure); });
  }

  void draw_running(Canvas& canvas, const Area& area) const {
    int row = 0;
    if (verb().live) {
      const Area inside = area.between_margins();
      row += std::max(1, canvas.paragraph(inside, row, next().empty() ? "running ..." : next(), Tone::strong));
      canvas.text(inside, row, 0, ">", Tone::strong);
      line_.draw(canvas, inside, row, 2, std::max(8, inside.columns - 2), true);
      row += 2;
    } else {
      canvas.text(area, row++, 0, fmt::format("running, {} s; press Esc to stop", static_cast<int>(task_.seconds())),
                  Tone::warning);
    }
    for (auto line = said_.rbegin(); line != said_.rend() && row < area.rows; ++line) {
      if (line->starts_with(kNext)) continue;
      row += canvas.paragraph(area.between_margins(), row, *line,
                              line->starts_with("warning:") ? Tone::warning : Tone::plain);
    }
  }

  void draw_answer(Canvas& canvas, const Area& area) const {
    if (task_.running()) return draw_running(canvas, area);
    if (!answer_) {
      for (std::size_t k = 0; k < row_.idle.size(); ++k)
        canvas.text(area, static_cast<int>(k), 1, row_.idle[k], k == 0 ? Tone::faint : Tone::plain);
      return;
    }
    if (reading_ && panel_) return draw_panel(canvas, area);
    const Tone tone = answer_->exit_code == 0 ? Tone::good : (answer_->exit_code == 1 ? Tone::warning : Tone::bad);
    const std::string ending = verb().live && answer_->exit_code != 0
                                   ? "not finished: see below"
                                   : ending_of(answer_->exit_code, answer_->answered);
    canvas.text(area, 0, 0, ending, tone);
    const Area body = area.below(1);
    const auto& lines = answer_lines(body.columns);
    answer_rows_ = std::max(1, body.rows);
    const bool wide =
        std::any_of(lines.begin(), lines.end(), [&](const std::string& line) { return width_of(line) > body.columns; });
    draw_scrolled(canvas, body, lines, scroll_);
    const int count = static_cast<int>(lines.size());
    const std::string where =
        count > body.rows ? fmt::format("{}-{} of {} lines; ", scroll_.first + 1, scroll_.first + body.rows, count)
                          : "";
    std::string brief, whole;
    if (reading_) {
      brief = where + "Esc: fields";
      whole = where + (wide ? "up, down, left, right; Esc to the fields" : "up, down; Esc to the fields");
    } else if (wide || count > body.rows) {
      brief = "PgDn reads";
      whole = wide ? "PgDn, then left and right: read all" : "PgDn: read all";
    }
    canvas.text_right(area, 0, width_of(whole) + width_of(ending) + 2 > area.columns ? brief : whole, Tone::strong);
  }

  void draw_panel(Canvas& canvas, const Area& area) const {
    if (!figure_)
      canvas.text(area, 0, 1, "drawing ...", Tone::warning);
    else if (!*figure_ || *panel_ >= (*figure_)->panels.size())
      canvas.paragraph(area.between_margins(), 0,
                       *figure_ ? "This answer has no such picture." : to_text(figure_->error()), Tone::warning);
    else
      draw_chart(canvas, area, (*figure_)->panels[*panel_], {});
  }

  /// The answer in lines for the width it is shown in.
  [[nodiscard]] const std::vector<std::string>& answer_lines(int columns) const {
    if (lines_for_ == columns) return lines_;
    lines_for_ = columns;
    lines_ = sentences_wrapped(answer_->lines, columns);
    return lines_;
  }

  FormRow row_;
  std::vector<KeyRow> keys_ = key_table();
  std::shared_ptr<UnitConnection> connection_;
  FormFields fields_;
  Prompt prompt_;
  Asking asking_;
  bool reading_ = false;  ///< the keys go to the answer
  ScrollPlace scroll_;
  mutable int answer_rows_ = 10;  ///< that are seen of it
  mutable int lines_for_ = -1;    ///< columns for which `lines_` were made
  mutable std::vector<std::string> lines_;
  std::string hint_;
  bool refused_ = false;  ///< the hint says why
  bool force_ = false;    ///< the question whether to overwrite was answered with yes
  std::optional<FormAnswer> answer_;
  std::vector<std::string> words_;    ///< that run, or ran last
  std::vector<std::string> said_;     ///< by the verb while it runs
  std::shared_ptr<Wire> wire_;        ///< to the verb that runs
  TextLine line_;                     ///< typed to it
  std::optional<std::size_t> panel_;  ///< shown in place of the answer
  std::optional<Result<PlotFigure>> figure_;
  TaskRunner task_;
  TaskRunner drawing_;
};

}  // namespace

std::unique_ptr<Screen> form_screen(FormRow row, VerbEntry verb, std::shared_ptr<UnitConnection> connection,
                                    const FormValues& values, bool at_once) {
  return std::make_unique<FormScreen>(std::move(row), std::move(verb), std::move(connection), values, at_once);
}

}  // namespace ecs::app
