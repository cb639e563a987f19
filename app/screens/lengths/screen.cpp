#include "app/screens/lengths/screen.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/screens/files/prompt.hpp"
#include "app/ui/talk.hpp"
#include "app/ui/widgets.hpp"
#include "base/overwriting.hpp"
#include "base/text.hpp"
#include "commissioning/lengths/controller.hpp"

namespace ecs::app {
namespace {

constexpr int kLengthsFields = 5;
constexpr std::array<const char*, kLengthsFields> kLengthsNames{"lengths", "machine", "parameters", "knots",
                                                                "wanted U"};
constexpr std::array<const char*, kLengthsFields> kLengthsHelp{
    "Measured lengths, or a plan of them (.csv, docs/identification.md). Empty: only a plan is made.",
    "Machine file (.toml): chain, travels, datum.",
    "Parameters (.toml) of the unit that the map is for. Empty: no map.",
    "Spacing of the curves' knots X,Y,Z, mm, such as 100,75,75. Empty: as the file says, of a plan a twelfth of the "
    "travel.",
    "For a plan: expanded uncertainty (k = 2) of the error vector over volume and tools, um. May be left empty."};
constexpr std::size_t kLengthsFile = 0, kMachineFile = 1, kParametersFile = 2, kKnots = 3, kWantedU = 4;
constexpr int kFieldColumn = 13;

/// The files; with an answer its pages.
class LengthsScreen final : public Screen {
 public:
  LengthsScreen(const std::string& lengths, const std::string& machine, const std::string& params) {
    fields_[kLengthsFile].set(lengths);
    fields_[kMachineFile].set(machine);
    fields_[kParametersFile].set(params);
    if (!lengths.empty()) field_ = machine.empty() ? 1 : kLengthsFields - 1;
    if (!lengths.empty() && !machine.empty()) compute();
  }
  [[nodiscard]] std::string title() const override { return "LENGTHS"; }

  void draw(Canvas& canvas, const Area& area) const override {
    if (prompt_.choosing()) return prompt_.draw(canvas, area.between_margins(), 0);
    if (shows_answer())
      draw_answer(canvas, area);
    else
      draw_fields(canvas, area.between_margins());
    draw_question(canvas, area, asking_);
  }

  [[nodiscard]] Step on_key(const Key& key) override {
    if (answers(asking_, key) || prompt_.on_key(key)) return stay();
    if (controller_.running()) {
      if (key.name != Key::Name::escape) return stay();
      controller_.cancel();
      return shows_answer() ? stay() : back();
    }
    if (shows_answer()) return on_answer_key(key);
    if (key.name == Key::Name::escape) return back();
    on_field_key(key);
    return stay();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (const auto& asked = asking_.question()) return {{"y", asked->yes}, {"n", asked->no}};
    if (prompt_.active()) return prompt_.keys();
    if (controller_.running()) return {{"Esc", "stop"}};
    if (shows_answer())
      return {{"1", "components"},  {"2", "not determined"}, {"3", "plan"},
              {"p", "make a plan"}, {"s", "save"},           {"Esc", "files"}};
    return {{"Enter", "next field, then compute"}, {"Tab", "choose a file, or complete its path"}, {"Esc", "back"}};
  }

  [[nodiscard]] std::string help() const override {
    return "All 21 components of a three-axis machine from lengths alone: along the beam of an interferometer, from a "
           "tracking interferometer or the ball of a ball bar. Page 1 has each component with its expanded uncertainty "
           "(95 %), the scatter that was found and the set-ups; page 2 what the lengths do not determine, and which "
           "lengths would. p makes a plan: the set-ups and lengths with the fewest minutes for a wanted uncertainty, "
           "beside single set-ups (page 3). s saves what the page shows: the map with the squareness as parameters, or "
           "the plan. `ecs lengths fit` and `ecs lengths plan` do the same with more options: knots, tools, stations, "
           "what scatters.";
  }

  [[nodiscard]] bool advance() override {
    const bool looked = prompt_.advance();
    if (!controller_.advance()) return controller_.running() || looked;
    hidden_ = false;
    if (controller_.planned() && planning_) page_ = 3;
    if (!planning_) page_ = controller_.view() && controller_.view()->undetermined > 0 ? 2 : 1;
    scroll_ = {};
    return true;
  }

  [[nodiscard]] bool typing() const override {
    if (asking_.active() || controller_.running()) return false;
    return prompt_.active() || !shows_answer();
  }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    if (asking_.active() || controller_.running()) return {-1, -1};
    const Area inside = area.between_margins();
    if (prompt_.active()) return prompt_.cursor(inside, prompt_.choosing() ? 0 : inside.rows - 1);
    if (shows_answer()) return {-1, -1};
    const TextLine& field = fields_[static_cast<std::size_t>(field_)];
    return {inside.row + 2 + field_, inside.column + kFieldColumn + field.cursor_column(inside.columns - kFieldColumn)};
  }

 private:
  [[nodiscard]] bool shows_answer() const {
    return (controller_.view().has_value() || controller_.planned().has_value()) && !hidden_;
  }

  void draw_fields(Canvas& canvas, const Area& inside) const {
    canvas.text(inside, 0, 0, "Which lengths, of which machine?", Tone::strong);
    for (int k = 0; k < kLengthsFields; ++k) {
      const auto i = static_cast<std::size_t>(k);
      canvas.text(inside, 2 + k, 0, fmt::format("{} {}", k == field_ ? ">" : " ", kLengthsNames[i]),
                  k == field_ ? Tone::strong : Tone::plain);
      fields_[i].draw(canvas, inside, 2 + k, kFieldColumn, inside.columns - kFieldColumn, k == field_);
    }
    const int row = 3 + kLengthsFields;
    const int below =
        row + 1 + canvas.paragraph(inside, row, kLengthsHelp[static_cast<std::size_t>(field_)], Tone::faint);
    if (controller_.running())
      canvas.text(inside, below, 0, controller_.label() + " ... Esc stops it", Tone::warning);
    else if (!hint_.empty())
      canvas.paragraph(inside, below, hint_, Tone::warning);
    else
      canvas.paragraph(inside, below, controller_.message().text(), controller_.message().tone());
  }

  /// Rows of the page shown.
  [[nodiscard]] std::vector<std::string> page(int columns) const {
    if (page_ == 3) {
      if (controller_.planned()) return sentences_wrapped(controller_.planned()->lines, columns);
      return {"No plan yet: p asks for the wanted uncertainty and searches the lengths",
              "with the fewest minutes (half a minute)."};
    }
    if (!controller_.view()) return {"Nothing was fitted: Esc, then name measured lengths."};
    const LengthsView& view = *controller_.view();
    if (page_ == 1) return sentences_wrapped(view.lines, columns);
    if (!view.measured) return {"The file is a plan: what it determines is known once it is measured."};
    if (view.missing.empty()) return {"Everything that acts at the tools is determined."};
    std::vector<std::string> out{fmt::format("{} not determined, and what would determine {}:", view.undetermined,
                                             view.undetermined == 1 ? "it" : "them"),
                                 ""};
    for (const std::string& sentence : view.missing)
      for (const std::string& line : wrapped(sentence, columns)) out.push_back(line);
    return out;
  }

  void draw_answer(Canvas& canvas, const Area& area) const {
    const Area inside = area.between_margins();
    const int rows_below = prompt_.active() || controller_.running() ? 1
                           : controller_.message().text().empty()
                               ? 0
                               : rows_of_message(controller_.message(), inside.columns, 4);
    draw_scrolled(canvas, area.top(area.rows - rows_below), page(inside.columns), scroll_);
    const Area last{inside.row + inside.rows - rows_below, inside.column, rows_below, inside.columns};
    if (prompt_.active())
      prompt_.draw(canvas, inside, inside.rows - 1);
    else if (controller_.running())
      canvas.text(last, 0, 0, controller_.label() + " ... Esc stops it", Tone::warning);
    else if (rows_below > 0)
      draw_message(canvas, last, controller_.message());
  }

  Step on_answer_key(const Key& key) {
    if (key.name == Key::Name::escape) {
      hidden_ = true;
    } else if (is_letter(key, U'p')) {
      ask_for_plan();
    } else if (is_letter(key, U's')) {
      save();
    } else if (is_letter(key, U'1') || is_letter(key, U'2') || is_letter(key, U'3')) {
      page_ = static_cast<int>(key.letter - U'0');
      scroll_ = {};
    } else {
      (void)scroll_.on_key(key);
    }
    return stay();
  }

  void choose() {
    constexpr std::array<FileKind, 3> kKinds{FileKind::lengths, FileKind::machine, FileKind::parameters};
    const auto field = static_cast<std::size_t>(field_);
    prompt_.choose(kLengthsNames[field], {{kKinds[field]}, false}, [this, field](const std::string& path) {
      fields_[field].set(path);
      field_ = static_cast<int>(field) + 1;
    });
  }

  [[nodiscard]] std::string text_of(std::size_t field) const { return fields_[field].text(); }

  void compute() {
    hint_.clear();
    if (text_of(kMachineFile).empty()) {
      field_ = kMachineFile;
      hint_ = "The machine file is needed.";
    } else if (!text_of(kLengthsFile).empty()) {
      LengthsArguments arguments;
      arguments.file = text_of(kLengthsFile);
      arguments.machine = text_of(kMachineFile);
      arguments.params = text_of(kParametersFile);
      arguments.knots = text_of(kKnots);
      planning_ = false;
      controller_.fit(arguments);
    } else if (!text_of(kWantedU).empty()) {
      hint_ = begin_plan(text_of(kWantedU));
    } else {
      hint_ = "Measured lengths are needed, or for a plan the wanted uncertainty.";
    }
  }

  /// @return why not; empty: begun
  std::string begin_plan(const std::string& wanted) {
    constexpr double kLeast_um = 0.01, kMost_um = 1e6;
    const auto wanted_um = number_in(trimmed(wanted));
    if (!wanted_um || *wanted_um < kLeast_um || *wanted_um > kMost_um)
      return "expected the wanted uncertainty in um, 0.01 or more, such as 5";
    fields_[kWantedU].set(wanted);
    LengthsPlanAsked asked;
    asked.machine = text_of(kMachineFile);
    asked.volume_um = *wanted_um;
    asked.knots = text_of(kKnots);
    planning_ = true;
    controller_.plan(asked);
    return {};
  }

  void ask_for_plan() {
    prompt_.ask(
        "Wanted U [um]:", Prompt::Kind::number, text_of(kWantedU),
        [this](const std::string& wanted) { return begin_plan(wanted); }, "over volume and tools, k = 2");
  }

  void save() {
    if (page_ == 3) {
      if (!controller_.planned()) return controller_.message().say("There is no plan yet: p makes one.", Tone::warning);
      return prompt_.ask("Plan:", Prompt::Kind::path, "plan.csv", [this](const std::string& path) {
        unless_there({path}, [this, path] { controller_.save_plan(path); });
      });
    }
    if (const std::string why = controller_.no_map(); !why.empty())
      return controller_.message().say(why, Tone::warning);
    const std::filesystem::path lengths(text_of(kLengthsFile));
    const std::string stem = (lengths.parent_path() / lengths.stem()).string();
    prompt_.ask("Map:", Prompt::Kind::path, stem + ".map.csv", [this, stem](const std::string& map) {
      prompt_.ask("Parameters with the squareness:", Prompt::Kind::path, stem + ".parameters.toml",
                  [this, map](const std::string& params) {
                    unless_there({map, params}, [this, map, params] { controller_.save_map(map, params); });
                  });
    });
  }

  void unless_there(const std::vector<std::string>& files, const std::function<void()>& write) {
    for (const std::string& file : files)
      if (would_overwrite(file)) {
        asking_.ask(
            {"Overwrite " + file + "?", "The file exists. Its contents will be overwritten.", "overwrite", "keep it"},
            write);
        return;
      }
    write();
  }

  void on_field_key(const Key& key) {
    TextLine& field = fields_[static_cast<std::size_t>(field_)];
    if (key.name == Key::Name::enter) {
      if (field_ + 1 < kLengthsFields)
        ++field_;
      else
        compute();
    } else if (key.name == Key::Name::up) {
      field_ = std::max(0, field_ - 1);
    } else if (key.name == Key::Name::down) {
      field_ = std::min(kLengthsFields - 1, field_ + 1);
    } else if (key.name == Key::Name::tab && field_ >= static_cast<int>(kKnots)) {
      field_ = (field_ + 1) % kLengthsFields;
    } else if (key.name == Key::Name::tab && field.text().empty()) {
      choose();
    } else if (key.name == Key::Name::tab) {
      const PathCompletion found = completed_path(field.text());
      field.set(found.completed);
      hint_ = fmt::format("{}", fmt::join(found.choices, "  "));
    } else {
      (void)field.on_key(key);
    }
  }

  LengthsController controller_;
  std::array<TextLine, kLengthsFields> fields_;
  int field_ = 0;
  int page_ = 1;
  bool hidden_ = false;    ///< the files again, the answer stays
  bool planning_ = false;  ///< what runs, or ran last, is a plan
  ScrollPlace scroll_;
  Prompt prompt_;
  Asking asking_;
  std::string hint_;
};

}  // namespace

std::unique_ptr<Screen> lengths_screen(const std::string& lengths, const std::string& machine,
                                       const std::string& params) {
  return std::make_unique<LengthsScreen>(lengths, machine, params);
}

}  // namespace ecs::app
