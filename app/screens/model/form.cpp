// Which model, which measurements, which machine: asked before the MODEL screen opens.
#include "app/screens/model/form.hpp"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/catalogue.hpp"
#include "app/screens/files/prompt.hpp"
#include "app/screens/model/screen.hpp"
#include "app/ui/widgets.hpp"
#include "base/file.hpp"
#include "commissioning/files/known_files.hpp"
#include "commissioning/model_session/controller.hpp"
#include "commissioning/session/remembered.hpp"

namespace ecs::app {
namespace {

constexpr std::array<const char*, 3> kNames{"model", "data", "machine"};
constexpr std::array<const char*, 3> kHelp{
    "Model file (.toml): the effects assumed so far. If the file does not exist or the field is empty, a new model is "
    "created from the "
    "measurements.",
    "Measured files, separated by spaces: any format that PROCESS LASER DATA reads.",
    "Machine file (.toml): datum, travels, lever arms, pitches. May be empty."};
constexpr int kColumn = 12;
constexpr const char* kHeading = "Choose the model and the measurements to compare.";

/// Of the first field, below the heading.
int first_row(int columns) { return static_cast<int>(wrapped(kHeading, columns).size()) + 1; }

class ModelForm final : public Screen {
 public:
  ModelForm(std::shared_ptr<UnitConnection> unit, const ModelFormFiles& files) : unit_(std::move(unit)) {
    fields_[0].set(files.model);
    for (const std::string& path : files.data) add_data(path);
    fields_[2].set(files.machine);
    fill_from_folder();
    if (!files.data.empty()) open();
  }
  [[nodiscard]] std::string title() const override { return "open"; }
  void draw(Canvas& canvas, const Area& area) const override {
    const Area inside = area.between_margins();
    const int first = first_row(inside.columns);
    canvas.paragraph(inside, 0, kHeading, Tone::strong);
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      canvas.text(inside, first + k, 0, fmt::format("{} {}", k == field_ ? ">" : " ", kNames[i]),
                  k == field_ ? Tone::strong : Tone::plain);
      fields_[i].draw(canvas, inside, first + k, kColumn, inside.columns - kColumn, k == field_);
    }
    fields_row_ = inside.row + first;
    const int below =
        first + 5 + canvas.paragraph(inside, first + 4, kHelp[static_cast<std::size_t>(field_)], Tone::faint);
    if (opening_.running()) canvas.text(inside, below, 0, "reading and fitting ... Esc goes back", Tone::warning);
    if (!hint_.empty()) canvas.paragraph(inside, below, hint_, problem_ ? Tone::bad : Tone::faint);
    files_.draw(canvas, inside, 0);
    draw_question(canvas, area, asking_);
  }

  [[nodiscard]] Step on_key(const Key& key) override {
    if (answers(asking_, key) || files_.on_key(key)) return stay();
    if (key.name == Key::Name::escape) return back();
    if (!opening_.running()) on_field_key(key);
    return stay();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (const auto& asked = asking_.question()) return {{"y", asked->yes}, {"n", asked->no}};
    if (files_.active()) return files_.keys();
    return {{"Enter", "next field, then open"}, {"Tab", "choose a file, or complete its path"}, {"Esc", "back"}};
  }

  [[nodiscard]] std::string help() const override {
    return "The measurements are CSV files or files of a laser. The model file contains the effects "
           "assumed so far. If you have none, enter a new name or no name: a model of offset, slope and backlash is "
           "created, and the screen finds the missing effects from the measurements. The machine file gives lever arms "
           "and pitches; without it fewer causes can be distinguished. Measurements and machine file in the folder of "
           "the model are filled in. Typing replaces them.";
  }

  [[nodiscard]] bool advance() override {
    const bool looked = files_.advance();
    return opening_.advance() || opening_.running() || looked;
  }

  [[nodiscard]] std::unique_ptr<Screen> opens_by_itself() override {
    if (!ready_) return nullptr;
    return std::make_unique<ModelScreen>(std::move(ready_));
  }

  [[nodiscard]] bool typing() const override { return !asking_.active(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    if (asking_.active()) return {-1, -1};
    if (files_.active()) return files_.cursor(area.between_margins(), 0);
    return {area.row + first_row(area.columns - 2) + field_,
            area.column + 1 + kColumn +
                fields_[static_cast<std::size_t>(field_)].cursor_column(area.columns - 2 - kColumn)};
  }

 private:
  void add_data(const std::string& path) {
    const std::string quoted = path.find(' ') == std::string::npos ? path : '"' + path + '"';
    const std::string before = fields_[1].text();
    fields_[1].set(before.empty() ? quoted : before + " " + quoted);
  }

  /// What nobody has typed is proposed from the folder of the model, else of the measurements.
  void fill_from_folder() {
    const auto data = split_words(fields_[1].text());
    const std::string model = fields_[0].text().empty() && !data.empty() ? data.front() : fields_[0].text();
    if (model.empty()) return;
    const commissioning::FilesBeside beside = commissioning::files_beside(model);
    if (fields_[2].is_untouched()) fields_[2].propose(beside.machine);
    if (!fields_[1].is_untouched()) return;
    fields_[1].set("");
    for (const std::string& path : beside.data) add_data(path);
    fields_[1].propose(fields_[1].text());
  }

  void choose() {
    constexpr std::array<FileKind, 3> kKinds{FileKind::model, FileKind::measurements, FileKind::machine};
    constexpr std::array<const char*, 3> kLabels{"The model file", "Measured files", "The machine file"};
    const auto field = static_cast<std::size_t>(field_);
    files_.choose(kLabels[field], {{kKinds[field]}, field == 1}, [this, field](const std::string& path) {
      if (field == 1)
        add_data(path);
      else
        fields_[field].set(path);
      field_ = std::min(2, static_cast<int>(field) + 1);
      fill_from_folder();
    });
  }

  void open() {
    hint_.clear();
    ModelArguments named = files();
    if (named.data.empty()) {
      hint_ = "at least one measurement file is required";
      problem_ = true;
      field_ = 1;
      return;
    }
    if (disc::is_file(named.machine))
      if (hint_ = commissioning::refusal_as(FileKind::machine, named.machine); !hint_.empty()) {
        problem_ = true;
        return;
      }
    const bool proposed = named.model.empty();
    if (proposed) {
      const std::filesystem::path data(named.data.front());
      named.model = (data.parent_path() / (data.stem().string() + ".model.toml")).string();
      fields_[0].set(named.model);
    }
    if (disc::exists(named.model)) {
      if (!proposed) return start(false);
      hint_ = fmt::format("{} exists: Enter opens it; another name creates a new model", named.model);
      problem_ = false;
      field_ = 0;
      return;
    }
    asking_.ask(
        {"Begin a new model?",
         fmt::format("{} does not exist yet. A new model begins with offset, slope and backlash of each measured "
                     "curve. Then press d to find the missing effects and a to add one.",
                     named.model),
         "create it", "another file"},
        [this] { start(true); }, [this] { field_ = 0; });
  }

  void start(bool anew) {
    const auto open = [files = files(), unit = unit_, anew](JobControl&) {
      return anew ? ModelController::begin_new(files, unit) : ModelController::open(files, unit);
    };
    opening_.start("opening", open, [this](Result<std::unique_ptr<ModelController>> controller) {
      if (controller) {
        for (const std::string& path : files().data) remember_file(path);
        for (const std::string& path : {files().machine, files().model}) remember_file(path);
        ready_ = std::move(*controller);
      } else {
        hint_ = to_text(controller.error());
        problem_ = true;
      }
    });
  }

  [[nodiscard]] ModelArguments files() const {
    ModelArguments files;
    files.model = fields_[0].text();
    files.data = split_words(fields_[1].text());
    files.machine = fields_[2].text();
    return files;
  }

  void on_field_key(const Key& key) {
    TextLine& field = fields_[static_cast<std::size_t>(field_)];
    if (key.name == Key::Name::enter) {
      if (field_ == 2) return open();
      fill_from_folder();
      ++field_;
    } else if (key.name == Key::Name::up) {
      field_ = std::max(0, field_ - 1);
    } else if (key.name == Key::Name::down) {
      fill_from_folder();
      field_ = std::min(2, field_ + 1);
    } else if (key.name == Key::Name::mouse) {
      if (key.row >= fields_row_ && key.row < fields_row_ + 3) field_ = key.row - fields_row_;
    } else if (key.name == Key::Name::tab && field.text().empty()) {
      choose();
    } else if (key.name == Key::Name::tab) {
      const PathCompletion found = field_ == 1 ? completed_paths(field.text()) : completed_path(field.text());
      field.set(found.completed);
      hint_ = fmt::format("{}", fmt::join(found.choices, "  "));
      problem_ = false;
    } else {
      (void)field.on_key(key);
    }
  }

  std::shared_ptr<UnitConnection> unit_;
  std::array<TextLine, 3> fields_;
  int field_ = 0;
  Prompt files_;
  std::string hint_;
  bool problem_ = false;
  Asking asking_;               ///< whether the model begins in a new file
  mutable int fields_row_ = 0;  ///< of the canvas, as drawn last
  TaskRunner opening_;
  std::unique_ptr<ModelController> ready_;
};

}  // namespace

std::unique_ptr<Screen> model_form(std::shared_ptr<UnitConnection> unit, const ModelFormFiles& files) {
  return std::make_unique<ModelForm>(std::move(unit), files);
}

}  // namespace ecs::app
