#include "app/screens/volume/screen.hpp"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/plot/gnuplot.hpp"
#include "app/screens/files/prompt.hpp"
#include "app/ui/chart.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/volume/controller.hpp"

namespace ecs::app {
namespace {

constexpr int kFields = 5;
constexpr std::array<const char*, kFields> kNames{"map", "parameters", "errors", "machine", "rotary axes"};
constexpr std::array<const char*, kFields> kHelp{
    "Error map (.csv).", "Parameters (.toml) that the map goes with. A machine.toml beside them gives the travels.",
    "Errors file of an emulated machine (.toml): its true errors in place of the map's. May be left empty.",
    "Machine file (.toml) that is not beside the parameters, such as one with rotary axes. May be left empty.",
    "Errors of the rotary axes of the machine file (.csv), which the unit does not compensate. May be left empty."};
constexpr int kColumn = 13;
constexpr std::size_t kFirstDiagonals = 4;  ///< panel of the figure

/// The files; with an answer its pages.
class VolumeScreen final : public Screen {
 public:
  [[nodiscard]] std::string title() const override { return "VOLUME"; }

  void draw(Canvas& canvas, const Area& area) const override {
    if (shows_answer()) return draw_answer(canvas, area);
    const Area inside = area.between_margins();
    if (files_.active()) return files_.draw(canvas, inside, 0);
    canvas.text(inside, 0, 0, "How large is the error in the working volume?", Tone::strong);
    for (int k = 0; k < kFields; ++k) {
      const auto i = static_cast<std::size_t>(k);
      canvas.text(inside, 2 + k, 0, fmt::format("{} {}", k == field_ ? ">" : " ", kNames[i]),
                  k == field_ ? Tone::strong : Tone::plain);
      fields_[i].draw(canvas, inside, 2 + k, kColumn, inside.columns - kColumn, k == field_);
    }
    const int row = 3 + kFields;
    const int below = row + 1 + canvas.paragraph(inside, row, kHelp[static_cast<std::size_t>(field_)], Tone::faint);
    if (controller_.running())
      canvas.text(inside, below, 0, "computing ... Esc goes back", Tone::warning);
    else if (!controller_.message().text().empty())
      canvas.paragraph(inside, below, controller_.message().text(), controller_.message().tone());
    else
      canvas.paragraph(inside, below, hint_, Tone::faint);
  }

  [[nodiscard]] Step on_key(const Key& key) override {
    if (files_.on_key(key)) return stay();
    if (shows_answer()) return on_answer_key(key);
    if (key.name == Key::Name::escape) return back();
    if (!controller_.running()) on_field_key(key);
    return stay();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (files_.active()) return files_.keys();
    if (shows_answer())
      return {{"1", "sizes"}, {"2", "before"}, {"3", "after"}, {"w", "write picture"}, {"Esc", "files"}};
    return {{"Enter", "next field, then compute"}, {"Tab", "choose a file, or complete its path"}, {"Esc", "back"}};
  }

  [[nodiscard]] std::string help() const override {
    return "The length of the error vector over the whole working volume, before compensation and after it, with a 95 "
           "% "
           "bound from the uncertainty of the map. Page 1 has the sizes and a slice as numbers, pages 2 and 3 the "
           "error "
           "along the body diagonals. w writes the wire cube, the slice with arrows and the diagonals as SVG and PNG. "
           "`ecs volume` does the same with more options: tool, one place, the uncertainty of every value. With a "
           "machine file that has rotary axes the sizes are those at every "
           "angle, slice and pictures those at the angles of the largest error, which page 1 names.";
  }

  [[nodiscard]] bool advance() override {
    const bool looked = files_.advance();
    if (!controller_.advance()) return looked;
    hidden_ = false;
    return true;
  }

  [[nodiscard]] bool typing() const override { return files_.active() || !shows_answer(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    if (files_.active()) return files_.cursor(area.between_margins(), 0);
    if (shows_answer()) return {-1, -1};
    const TextLine& field = fields_[static_cast<std::size_t>(field_)];
    return {area.row + 2 + field_, area.column + 1 + kColumn + field.cursor_column(area.columns - 2 - kColumn)};
  }

 private:
  [[nodiscard]] bool shows_answer() const { return controller_.view().has_value() && !hidden_; }

  void draw_answer(Canvas& canvas, const Area& area) const {
    const VolumeView& view = *controller_.view();
    const std::string& said = controller_.message().text();
    const Area above = said.empty() ? area : area.top(area.rows - 1);
    const std::size_t panel = kFirstDiagonals + static_cast<std::size_t>(page_ == 3);
    if (page_ == 1 || panel >= view.figure.panels.size())
      draw_scrolled(canvas, above, view.lines, scroll_);
    else
      draw_chart(canvas, above, view.figure.panels[panel], {});
    if (!said.empty()) canvas.text(area.below(area.rows - 1), 0, 1, said, controller_.message().tone());
  }

  Step on_answer_key(const Key& key) {
    if (key.name == Key::Name::escape) {
      hidden_ = true;
    } else if (is_letter(key, U'w')) {
      controller_.export_picture(write_plot);
    } else if (is_letter(key, U'1') || is_letter(key, U'2') || is_letter(key, U'3')) {
      page_ = static_cast<int>(key.letter - U'0');
    } else {
      (void)scroll_.on_key(key);
    }
    return stay();
  }

  void choose() {
    constexpr std::array<FileKind, kFields> kKinds{FileKind::map, FileKind::parameters, FileKind::machine,
                                                   FileKind::machine, FileKind::other};
    const auto field = static_cast<std::size_t>(field_);
    files_.choose(kNames[field], {{kKinds[field]}, false}, [this, field](const std::string& path) {
      fields_[field].set(path);
      field_ = std::min(kFields - 1, static_cast<int>(field) + 1);
    });
  }

  void compute() {
    for (int k = 0; k < 2; ++k)
      if (fields_[static_cast<std::size_t>(k)].text().empty()) {
        field_ = k;
        hint_ = fmt::format("The file of the {} is needed.", kNames[static_cast<std::size_t>(k)]);
        return;
      }
    VolumeArguments arguments;
    arguments.map = fields_[0].text();
    arguments.params = fields_[1].text();
    arguments.errors = fields_[2].text();
    arguments.machine = fields_[3].text();
    arguments.rotary = fields_[4].text();
    arguments.plane = kLongestPlane;
    controller_.compute(arguments);
  }

  void on_field_key(const Key& key) {
    TextLine& field = fields_[static_cast<std::size_t>(field_)];
    if (key.name == Key::Name::enter) {
      if (field_ + 1 < kFields)
        ++field_;
      else
        compute();
    } else if (key.name == Key::Name::up) {
      field_ = std::max(0, field_ - 1);
    } else if (key.name == Key::Name::down) {
      field_ = std::min(kFields - 1, field_ + 1);
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

  VolumeController controller_;
  std::array<TextLine, kFields> fields_;
  int field_ = 0;
  int page_ = 1;
  bool hidden_ = false;  ///< the files again, the answer stays
  ScrollPlace scroll_;
  Prompt files_;
  std::string hint_;
};

}  // namespace

std::unique_ptr<Screen> volume_screen() { return std::make_unique<VolumeScreen>(); }

}  // namespace ecs::app
