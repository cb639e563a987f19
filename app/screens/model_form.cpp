#include "app/screens/model_form.hpp"

#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/screens/model_screen.hpp"
#include "app/screens/verb_catalogue.hpp"

namespace ecs::app {
namespace {

constexpr std::array<const char*, 3> kNames{"model", "data", "machine"};
constexpr std::array<const char*, 3> kHelp{
    "model file (.toml): the effects that are believed so far",
    "measured files, separated by blanks; any that `ecs laser import` reads",
    "machine file (.toml): datum, travels, lever arms, pitches; may be left empty"};
constexpr int kColumn = 12;
constexpr int kFirstRow = 2;

}  // namespace

void ModelForm::draw(Canvas& canvas, const Area& area) const {
  const Area inside{area.row, area.column + 1, area.rows, area.columns - 2};
  canvas.text(inside, 0, 0, "Which measurements shall be put beside which model?", Tone::strong);
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    canvas.text(inside, kFirstRow + k, 0, fmt::format("{} {}", k == field_ ? ">" : " ", kNames[i]),
                k == field_ ? Tone::strong : Tone::plain);
    fields_[i].draw(canvas, inside, kFirstRow + k, kColumn, inside.columns - kColumn, k == field_);
  }
  canvas.paragraph(inside, kFirstRow + 4, kHelp[static_cast<std::size_t>(field_)], Tone::faint);
  if (opening_.running()) canvas.text(inside, kFirstRow + 6, 0, "reading and fitting ...", Tone::warning);
  if (!hint_.empty()) canvas.paragraph(inside, kFirstRow + 6, hint_, problem_ ? Tone::bad : Tone::faint);
}

Place ModelForm::cursor(const Area& area) const {
  return {
      area.row + kFirstRow + field_,
      area.column + 1 + kColumn + fields_[static_cast<std::size_t>(field_)].cursor_column(area.columns - 2 - kColumn)};
}

void ModelForm::open() {
  ModelArguments files;
  files.model = fields_[0].text();
  files.data = split_words(fields_[1].text());
  files.machine = fields_[2].text();
  if (files.model.empty() || files.data.empty()) {
    hint_ = "a model and at least one file of measurements are needed";
    problem_ = true;
    return;
  }
  hint_.clear();
  opening_.start([files](JobSigns&) -> Opened {
    std::ostringstream out, messages;
    Face face(out, messages);
    Session session{face, {}, {}};
    return ModelDesk::open(session, files);
  });
}

Step ModelForm::on_key(const Key& key) {
  if (key.name == Key::Name::escape) return back();
  if (opening_.running()) return stay();
  TextLine& field = fields_[static_cast<std::size_t>(field_)];
  if (key.name == Key::Name::enter) {
    if (field_ < 2)
      ++field_;
    else
      open();
  } else if (key.name == Key::Name::up) {
    field_ = std::max(0, field_ - 1);
  } else if (key.name == Key::Name::down) {
    field_ = std::min(2, field_ + 1);
  } else if (key.name == Key::Name::tab) {
    const PathCompletion found = field_ == 1 ? completed_paths(field.text()) : completed_path(field.text());
    field.set(found.completed);
    hint_ = fmt::format("{}", fmt::join(found.choices, "  "));
    problem_ = false;
  } else {
    (void)field.on_key(key);
  }
  return stay();
}

bool ModelForm::advance() {
  auto opened_desk = opening_.take();
  if (!opened_desk) return opening_.running();
  if (*opened_desk) {
    ready_ = std::move(**opened_desk);
  } else {
    hint_ = to_text(opened_desk->error());
    problem_ = true;
  }
  return true;
}

std::unique_ptr<Screen> ModelForm::opens_by_itself() {
  if (!ready_) return nullptr;
  return std::make_unique<ModelScreen>(std::move(ready_));
}

std::vector<KeyHelp> ModelForm::keys() const {
  return {{"Enter", "next field, then open"}, {"Tab", "complete a path"}, {"Esc", "back"}};
}

std::string ModelForm::help() const {
  return "The model file holds the effects that are believed so far; an empty file is a model without any. The data "
         "are "
         "measurement sets (CSV) or files of a laser.";
}

}  // namespace ecs::app
