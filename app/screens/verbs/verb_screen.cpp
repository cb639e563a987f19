// A verb as a form: its options as fields with their help, Enter runs it, the answer scrolls below.
#include "app/screens/verbs/verb_screen.hpp"

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/catalogue.hpp"
#include "app/screens/files/prompt.hpp"
#include "app/screens/verbs/live_screen.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "app/verbs/registry.hpp"
#include "base/interrupt.hpp"
#include "base/text.hpp"
#include "commissioning/files/beside.hpp"
#include "commissioning/link/unit_commands.hpp"
#include "commissioning/session/event_log.hpp"
#include "commissioning/session/measured_phases.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::app {
namespace {

/// What an argument of this name holds; empty: any file.
std::vector<FileKind> kinds_for(const std::string& argument) {
  static const std::map<std::string, FileKind> kKinds{
      {"MODEL", FileKind::model},       {"--from-model", FileKind::model},  {"--machine", FileKind::machine},
      {"MACHINE", FileKind::machine},   {"DATA", FileKind::measurements},   {"--data", FileKind::measurements},
      {"PARAMS", FileKind::parameters}, {"--params", FileKind::parameters}, {"MAP", FileKind::map},
      {"DUMP", FileKind::memory}};
  const auto found = kKinds.find(argument);
  return found == kKinds.end() ? std::vector<FileKind>{} : std::vector{found->second};
}

/// How a verb ended, before its answer. @param answered  it has answered on stdout
std::string ending_of(int exit_code, bool answered) {
  switch (exit_code) {
    case 0:
      return "done";
    case 1:
      return answered ? "done; something does not hold, see below" : "not done: see below why";
    case 2:
      return "not run: see below what to change";
    case 3:
      return "a file cannot be used: see below";
    case 4:
      return "no success on the link: see below";
    default:
      return exit_code > 128 ? "stopped" : "not done: see below why";
  }
}

class VerbScreen final : public Screen {
 public:
  /// The connection's link is filled in where the verb takes one; the connection lends the line while it runs.
  VerbScreen(VerbEntry verb, std::shared_ptr<UnitConnection> connection)
      : verb_(std::move(verb)), connection_(std::move(connection)) {
    for (const VerbOption& option : verb_.options)
      values_.emplace_back(option.name == "--link" ? connection_->link() : option.value);
    if (verb_.name() == "laser table") fill_table();
  }

  ~VerbScreen() override {
    if (task_.running()) ask_to_stop();
  }

  [[nodiscard]] std::string title() const override { return verb_.name(); }
  void draw(Canvas& canvas, const Area& area) const override {
    if (reading_) return draw_answer(canvas, area);
    const Area inside = area.between_margins();
    if (files_.active()) return files_.draw(canvas, inside, 0);
    int row = canvas.paragraph(inside, 0, verb_.help, Tone::strong);
    const int fields = field_rows(area);
    if (values_.empty())
      canvas.text(inside, row, 0, "Enter runs it.", Tone::faint);
    else
      draw_fields(canvas, {inside.row + row, inside.column, fields, inside.columns});
    fields_row_ = inside.row + row;
    seen_fields_ = fields;
    row += std::max(1, fields);
    std::string hint = hint_;
    if (hint.empty() && !values_.empty()) {
      const VerbOption& option = verb_.options[static_cast<std::size_t>(field_.selected)];
      hint = option.help;
      if (!option.choices.empty()) hint += fmt::format(" ({})", fmt::join(option.choices, ", "));
      if (option.flag) hint += " (Space: yes or no)";
    }
    canvas.paragraph({inside.row + row, inside.column, std::min(2, inside.rows - row), inside.columns}, 0, hint,
                     refused_ ? Tone::bad : Tone::faint);
    row += 2;
    draw_answer(canvas, {area.row + row, area.column, area.rows - row, area.columns});  // answers have 80 columns
  }

  [[nodiscard]] Step on_key(const Key& key) override {
    if (key.name == Key::Name::resized || files_.on_key(key)) return stay();
    hint_.clear();
    refused_ = false;
    if (key.name == Key::Name::escape) {
      if (task_.running()) {
        ask_to_stop();
        hint_ = "asked to stop";
        return stay();
      }
      if (!reading_) return back();
      reading_ = false;
      return stay();
    }
    if (task_.running()) return stay();
    if (key.name == Key::Name::function && key.number == 5) return run();
    if (on_answer_key(key)) return stay();
    if (key.name == Key::Name::enter) return run();
    return on_field_key(key);
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (files_.active()) return files_.keys();
    if (task_.running()) return {{"Esc", "stop it"}};
    if (reading_)
      return {{"up/down", "read"},   {"left/right", "sideways"}, {"PgUp/PgDn", "page"},
              {"Home", "beginning"}, {"Esc", "to the fields"},   {"F5", "run again"}};
    std::vector<KeyHelp> keys{
        {"Enter", "run"}, {"up/down", "field"}, {"Tab", "choose a file, complete"}, {"Space", "choose"}};
    if (answer_) keys.insert(keys.begin() + 1, {"PgDn", "read the answer"});
    keys.push_back({"Esc", "back"});
    return keys;
  }

  [[nodiscard]] std::string help() const override {
    return verb_.help + ". The fields are the options of the verb `ecs " + verb_.name() +
           "`; those with * are needed. " +
           "Tab in an empty field chooses a file. Several files are separated by blanks. Measurements, machine file "
           "and parameters in the folder of the model are filled in; typing replaces them. " +
           verb_.example +
           "\nPgDn goes to the answer: up and down scroll it, left and right move a wide table sideways with its "
           "headings (< and > at the edges mark where it goes on), Home is its beginning, Esc goes back to the fields.";
  }

  [[nodiscard]] bool advance() override {
    const bool looked = files_.advance();
    return task_.advance() || task_.running() || looked;
  }

  [[nodiscard]] bool typing() const override { return !reading_; }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    if (files_.active()) return files_.cursor(area.between_margins(), 0);
    if (reading_ || values_.empty()) return {-1, -1};
    const int names = name_columns();
    const int heading = static_cast<int>(wrapped(verb_.help, area.columns - 2).size());
    const int columns = std::max(8, area.columns - 2 - names - 1);
    return {area.row + heading + field_.selected - field_.first,
            area.column + 1 + names + values_[static_cast<std::size_t>(field_.selected)].cursor_column(columns)};
  }

 private:
  struct Answer {
    std::vector<std::string> lines;
    int exit_code = 0;
    bool answered = false;  ///< on stdout
  };
  [[nodiscard]] int field_rows(const Area& area) const {
    const int all = static_cast<int>(verb_.options.size());
    return std::min(all, answer_ || task_.running() ? std::max(3, area.rows / 3) : std::max(3, area.rows - 6));
  }

  [[nodiscard]] int name_columns() const {
    int most = 4;
    for (const VerbOption& option : verb_.options)
      most = std::max(most, width_of(option.name) + (option.required ? 2 : 0));
    return std::min(most + 3, 24);
  }

  [[nodiscard]] std::string lacking() const {
    for (std::size_t k = 0; k < values_.size(); ++k)
      if (verb_.options[k].required && values_[k].text().empty()) return verb_.options[k].name;
    return {};
  }

  /// The field that takes a file of this kind; null: none.
  [[nodiscard]] TextLine* field_for(FileKind kind) {
    for (std::size_t k = 0; k < values_.size(); ++k)
      if (const auto kinds = kinds_for(verb_.options[k].name);
          !verb_.options[k].output && !kinds.empty() && kinds.front() == kind)
        return &values_[k];
    return nullptr;
  }

  /// What nobody has typed is proposed from the folder of the model. @return whether anything was
  bool fill_from_folder() {
    const TextLine* model = field_for(FileKind::model);
    if (model == nullptr || model->text().empty()) return false;
    const FilesBeside beside = files_beside(model->text());
    bool filled = false;
    const auto propose = [&](FileKind kind, const std::string& text) {
      TextLine* field = field_for(kind);
      if (field == nullptr || !field->is_untouched() || field->text() == text) return;
      field->propose(text);
      filled = true;
    };
    std::string data;
    for (const std::string& file : beside.data) data += (data.empty() ? "" : " ") + quoted(file);
    propose(FileKind::measurements, data);
    propose(FileKind::machine, beside.machine);
    propose(FileKind::parameters, beside.parameters);
    return filled;
  }

  /// With what was measured last before and after compensation.
  void fill_table() {
    const MeasuredPhases phases = measured_phases();
    for (std::size_t k = 0; k < values_.size(); ++k) {
      const std::string& name = verb_.options[k].name;
      if (name == "PLAN") values_[k].propose(phases.plan);
      if (name == "--before") values_[k].propose(phases.before);
      if (name == "--after") values_[k].propose(phases.after);
    }
  }

  static std::string quoted(const std::string& path) {
    return path.find(' ') == std::string::npos ? path : '"' + path + '"';
  }

  [[nodiscard]] bool uses_line() const {
    return std::any_of(verb_.options.begin(), verb_.options.end(),
                       [](const VerbOption& option) { return option.name == "--link"; });
  }

  void draw_fields(Canvas& canvas, const Area& area) const {
    const int names = name_columns();
    const int count = static_cast<int>(values_.size());
    field_.first = std::clamp(field_.first, std::max(0, field_.selected - area.rows + 1), std::max(0, field_.selected));
    for (int r = 0; r < std::min(area.rows, count - field_.first); ++r) {
      const auto k = static_cast<std::size_t>(field_.first + r);
      const VerbOption& option = verb_.options[k];
      const bool here = !reading_ && field_.first + r == field_.selected;
      canvas.text(area, r, 0, here ? ">" : " ", Tone::strong);
      canvas.text({area.row, area.column, area.rows, names - 1}, r, 2, option.name + (option.required ? " *" : ""),
                  here ? Tone::strong : Tone::plain);
      values_[k].draw(canvas, area, r, names, std::max(8, area.columns - names - 1), here);
    }
    if (field_.first > 0) canvas.put(area.row, area.column + area.columns - 1, U'↑', Tone::faint);
    if (field_.first + area.rows < count)
      canvas.put(area.row + area.rows - 1, area.column + area.columns - 1, U'↓', Tone::faint);
  }

  void draw_answer(Canvas& canvas, const Area& area) const {
    if (task_.running()) {
      canvas.text(area, 0, 0, fmt::format("running, {} s; Esc stops it", static_cast<int>(task_.seconds())),
                  Tone::warning);
      return;
    }
    if (!answer_) return;
    const Tone tone = answer_->exit_code == 0 ? Tone::good : (answer_->exit_code == 1 ? Tone::warning : Tone::bad);
    const std::string ending = ending_of(answer_->exit_code, answer_->answered);
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
      whole = wide ? "PgDn, then left and right: read all of it" : "PgDn: read all of it";
    }
    canvas.text_right(area, 0, width_of(whole) + width_of(ending) + 2 > area.columns ? brief : whole, Tone::strong);
  }

  /// The answer in lines for the width it is shown in.
  [[nodiscard]] const std::vector<std::string>& answer_lines(int columns) const {
    if (lines_for_ == columns) return lines_;
    lines_for_ = columns;
    lines_ = sentences_wrapped(answer_->lines, columns);
    return lines_;
  }

  /// Keys that go to the answer. @return whether it was one
  [[nodiscard]] bool on_answer_key(const Key& key) {
    if (!answer_) return false;
    const bool wheel = key.name == Key::Name::wheel_up || key.name == Key::Name::wheel_down;
    if (!reading_ && !wheel && key.name != Key::Name::page_down && key.name != Key::Name::page_up) return false;
    if (reading_ && (key.name == Key::Name::back_tab || key.name == Key::Name::tab || is_letter(key, U'e'))) {
      reading_ = false;
      return true;
    }
    if (reading_) (void)scroll_.on_key(key, answer_rows_);
    reading_ = true;  // the first key gives the answer the whole screen
    return true;
  }

  [[nodiscard]] Step on_field_key(const Key& key) {
    const int count = static_cast<int>(values_.size());
    if (count == 0) return stay();
    if (key.name == Key::Name::up || key.name == Key::Name::down) {
      if (&values_[static_cast<std::size_t>(field_.selected)] == field_for(FileKind::model)) (void)fill_from_folder();
      (void)field_.on_key(key, count);
      return stay();
    }
    if (key.name == Key::Name::mouse) {
      const int clicked = field_.first + key.row - fields_row_;
      if (key.row >= fields_row_ && clicked < count && clicked < field_.first + seen_fields_) field_.selected = clicked;
      return stay();
    }
    const VerbOption& option = verb_.options[static_cast<std::size_t>(field_.selected)];
    TextLine& value = values_[static_cast<std::size_t>(field_.selected)];
    if (key.name == Key::Name::tab) {
      if (value.text().empty() && !option.output && option.choices.empty() && !option.flag)
        choose_file();
      else
        complete();
    } else if (option.flag) {
      if (is_letter(key, U' ')) value.set(value.text().empty() ? "yes" : "");
    } else if (!option.choices.empty() &&
               (is_letter(key, U' ') || key.name == Key::Name::left || key.name == Key::Name::right)) {
      next_choice(key.name == Key::Name::left ? -1 : 1);
    } else {
      (void)value.on_key(key);
    }
    return stay();
  }

  [[nodiscard]] std::vector<std::string> words() const {
    std::vector<std::string> values;
    for (const TextLine& value : values_) values.push_back(value.text());
    return command_line(verb_, values);
  }

  [[nodiscard]] Step run() {
    if (!lacking().empty() && fill_from_folder() && lacking().empty()) {
      hint_ = "Filled in from the folder of the model. Enter runs it.";
      return stay();
    }
    if (const std::string name = lacking(); !name.empty()) {
      hint_ = fmt::format("{} is needed", name);
      refused_ = true;
      return stay();
    }
    if (runs_live(verb_.name())) return opened(live_screen(verb_.name(), words()));
    answer_.reset();
    lines_for_ = -1;
    reading_ = false;
    scroll_ = {};
    words_ = words();
    const auto work = [words = words_, connection = uses_line() ? connection_ : nullptr](JobControl&) {
      std::optional<UnitConnection::Lent> lent;
      if (connection) lent.emplace(*connection);
      std::ostringstream out, messages;
      const int code = run_program(words, out, messages);
      Answer answer{owned_lines_of(messages.str()), code, !out.str().empty()};
      for (std::string& line : owned_lines_of(out.str())) answer.lines.push_back(std::move(line));
      return answer;
    };
    task_.start("running", work, [this](Answer answer) { take(std::move(answer)); });
    return stay();
  }

  void take(Answer answer) {
    stop_asking();
    answer_ = std::move(answer);
    if (answer_->exit_code <= 1 && uses_line())
      note_form(*connection_, words_, answer_->exit_code);
    else if (answer_->exit_code <= 1)
      note_command(words_, answer_->exit_code);
    for (const std::string& line : answer_->lines)
      if (answer_->exit_code > 1) log_event(Tone::bad, verb_.name() + ": " + line);
  }

  void choose_file() {
    const auto at = static_cast<std::size_t>(field_.selected);
    const VerbOption& option = verb_.options[at];
    files_.choose(option.help, {kinds_for(option.name), option.many}, [this, at](const std::string& path) {
      const std::string word = verb_.options[at].many ? quoted(path) : path;
      values_[at].set(values_[at].text().empty() ? word : values_[at].text() + " " + word);
      (void)fill_from_folder();
    });
  }

  void complete() {
    TextLine& value = values_[static_cast<std::size_t>(field_.selected)];
    const bool many = verb_.options[static_cast<std::size_t>(field_.selected)].many;
    const PathCompletion found = many ? completed_paths(value.text()) : completed_path(value.text());
    value.set(found.completed);
    hint_ = fmt::format("{}", fmt::join(found.choices, "  "));
  }

  void next_choice(int by) {
    const VerbOption& option = verb_.options[static_cast<std::size_t>(field_.selected)];
    TextLine& value = values_[static_cast<std::size_t>(field_.selected)];
    const auto at = std::find(option.choices.begin(), option.choices.end(), value.text());
    const auto count = static_cast<int>(option.choices.size());
    const int now = at == option.choices.end() ? (by > 0 ? -1 : 0) : static_cast<int>(at - option.choices.begin());
    value.set(option.choices[static_cast<std::size_t>((now + by + count) % count)]);
  }

  VerbEntry verb_;
  std::shared_ptr<UnitConnection> connection_;
  std::vector<TextLine> values_;
  ListPlace field_;
  Prompt files_;
  mutable int fields_row_ = 0;   ///< of the canvas, as drawn last
  mutable int seen_fields_ = 0;  ///< rows of them
  bool reading_ = false;         ///< the keys scroll the answer
  ScrollPlace scroll_;
  mutable int answer_rows_ = 10;  ///< that are seen of it
  mutable int lines_for_ = -1;    ///< columns for which `lines_` were made
  mutable std::vector<std::string> lines_;
  std::string hint_;
  bool refused_ = false;  ///< the hint says why
  std::optional<Answer> answer_;
  std::vector<std::string> words_;  ///< that run, or ran last
  TaskRunner task_;
};

}  // namespace

std::unique_ptr<Screen> verb_screen(VerbEntry verb, std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<VerbScreen>(std::move(verb), std::move(connection));
}

}  // namespace ecs::app
