#include "app/screens/forms/form_fields.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commissioning/files/known_files.hpp"

namespace ecs::app {
namespace {

/// What an argument of this name holds; empty: any file.
std::vector<FileKind> kinds_for(const std::string& argument) {
  static const std::map<std::string, FileKind> kKinds{
      {"MODEL", FileKind::model},       {"--from-model", FileKind::model},  {"--machine", FileKind::machine},
      {"MACHINE", FileKind::machine},   {"DATA", FileKind::measurements},   {"--data", FileKind::measurements},
      {"PARAMS", FileKind::parameters}, {"--params", FileKind::parameters}, {"MAP", FileKind::map},
      {"DUMP", FileKind::memory},       {"LENGTHS", FileKind::lengths}};
  const auto found = kKinds.find(argument);
  return found == kKinds.end() ? std::vector<FileKind>{} : std::vector{found->second};
}

std::string in_quotes(const std::string& path) { return path.find(' ') == std::string::npos ? path : '"' + path + '"'; }

/// Without the option that a question answers, those that the row names first.
VerbEntry in_order_of(VerbEntry verb, const FormRow& row) {
  std::erase_if(verb.options, [&row](const VerbOption& option) { return option.name == row.confirmed; });
  const auto place = [&row](const VerbOption& option) {
    return std::find(row.fields.begin(), row.fields.end(), option.name) - row.fields.begin();
  };
  std::stable_sort(verb.options.begin(), verb.options.end(),
                   [&place](const VerbOption& a, const VerbOption& b) { return place(a) < place(b); });
  return verb;
}

}  // namespace

FormFields::FormFields(const FormRow& row, VerbEntry verb, const std::string& link, const FormValues& given)
    : verb_(in_order_of(std::move(verb), row)), offers_(row.offers) {
  for (const VerbOption& option : verb_.options) {
    values_.emplace_back(option.name == "--link" ? link : option.value);
    if (const auto preset = row.preset.find(option.name); preset != row.preset.end())
      values_.back().propose(preset->second);
    if (const auto typed = given.find(option.name); typed != given.end()) values_.back().set(typed->second);
  }
}

bool FormFields::takes(std::string_view option) const {
  return std::any_of(verb_.options.begin(), verb_.options.end(),
                     [option](const VerbOption& one) { return one.name == option; });
}

bool FormFields::writes() const {
  return std::any_of(verb_.options.begin(), verb_.options.end(), [](const VerbOption& one) { return one.output; });
}

FormValues FormFields::typed() const {
  FormValues all;
  for (std::size_t k = 0; k < size(); ++k) all[option(k).name] = text(k);
  return all;
}

std::string FormFields::lacking() const {
  for (std::size_t k = 0; k < size(); ++k)
    if (option(k).required && text(k).empty()) return option(k).name;
  return {};
}

/// The field that takes a file of this kind; null: none.
TextLine* FormFields::field_for(FileKind kind) {
  for (std::size_t k = 0; k < size(); ++k)
    if (const auto kinds = kinds_for(option(k).name); !option(k).output && !kinds.empty() && kinds.front() == kind)
      return &values_[k];
  return nullptr;
}

bool FormFields::fill_from_folder() {
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
  for (const std::string& file : beside.data) data += (data.empty() ? "" : " ") + in_quotes(file);
  propose(FileKind::measurements, data);
  propose(FileKind::machine, beside.machine);
  propose(FileKind::parameters, beside.parameters);
  return filled;
}

std::string FormFields::on_key(const Key& key, Prompt& prompt) {
  using Name = Key::Name;
  if (values_.empty()) return {};
  if (key.name == Name::tab) return on_tab(prompt);
  const bool steps = is_letter(key, U' ') || key.name == Name::left || key.name == Name::right;
  if (key.name == Name::up || key.name == Name::down) {
    if (&value() == field_for(FileKind::model)) (void)fill_from_folder();
    (void)place_.on_key(key, static_cast<int>(size()));
  } else if (key.name == Name::mouse) {
    place_.selected = place_.clicked(key).value_or(place_.selected);
  } else if (option().flag) {
    if (is_letter(key, U' ')) value().set(value().text().empty() ? "yes" : "");
  } else if (!option().choices.empty() && steps) {
    next_of(option().choices, key.name == Name::left ? -1 : 1);
  } else {
    (void)value().on_key(key);
  }
  return {};
}

std::string FormFields::on_tab(Prompt& prompt) {
  if (const auto offered = offers_.find(option().name); offered != offers_.end()) {
    next_of(offered->second, 1);
    return {};
  }
  if (value().text().empty() && !option().output && option().choices.empty() && !option().flag) {
    choose_file(prompt);
    return {};
  }
  const PathCompletion found = option().many ? completed_paths(value().text()) : completed_path(value().text());
  value().set(found.completed);
  return fmt::format("{}", fmt::join(found.choices, "  "));
}

void FormFields::choose_file(Prompt& prompt) {
  const auto at = static_cast<std::size_t>(place_.selected);
  prompt.choose(option().help, {kinds_for(option().name), option().many}, [this, at](const std::string& path) {
    const std::string word = option(at).many ? in_quotes(path) : path;
    set(at, text(at).empty() ? word : text(at) + " " + word);
    (void)fill_from_folder();
  });
}

void FormFields::next_of(const std::vector<std::string>& words, int by) {
  const auto at = std::find(words.begin(), words.end(), value().text());
  const auto count = static_cast<int>(words.size());
  const int now = at == words.end() ? (by > 0 ? -1 : 0) : static_cast<int>(at - words.begin());
  value().set(words[static_cast<std::size_t>((now + by + count) % count)]);
}

// --- the picture
int FormFields::name_columns() const {
  int most = 4;
  for (const VerbOption& option : verb_.options)
    most = std::max(most, width_of(option.name) + (option.required ? 2 : 0));
  return std::min(most + 3, 24);
}

std::string FormFields::help_here() const {
  if (values_.empty()) return {};
  std::string help = option().help;
  if (!option().choices.empty()) help += fmt::format(" ({})", fmt::join(option().choices, ", "));
  if (option().flag) help += " (Space: yes or no)";
  if (offers_.contains(option().name)) help += " (Tab: usual values)";
  return help;
}

void FormFields::draw(Canvas& canvas, const Area& area) const {
  if (values_.empty()) return static_cast<void>(canvas.text(area, 0, 0, "Press Enter to run it.", Tone::faint));
  const int names = name_columns();
  const int count = static_cast<int>(size());
  place_.first = std::clamp(place_.first, std::max(0, place_.selected - area.rows + 1), std::max(0, place_.selected));
  place_.seen = area.top(count - place_.first);
  for (int r = 0; r < place_.seen.rows; ++r) {
    const auto k = static_cast<std::size_t>(place_.first + r);
    const bool here = place_.first + r == place_.selected;
    canvas.text(area, r, 0, here ? ">" : " ", Tone::strong);
    canvas.text(area.left(names - 1), r, 2, option(k).name + (option(k).required ? " *" : ""),
                here ? Tone::strong : Tone::plain);
    values_[k].draw(canvas, area, r, names, std::max(8, area.columns - names - 1), here);
  }
  if (place_.first > 0) canvas.put(area.row, area.column + area.columns - 1, U'↑', Tone::faint);
  if (place_.first + area.rows < count)
    canvas.put(area.row + area.rows - 1, area.column + area.columns - 1, U'↓', Tone::faint);
}

CellPosition FormFields::cursor(const Area& area) const {
  if (values_.empty()) return {-1, -1};
  const int names = name_columns();
  const TextLine& here = values_[static_cast<std::size_t>(place_.selected)];
  return {area.row + place_.selected - place_.first,
          area.column + names + here.cursor_column(std::max(8, area.columns - names - 1))};
}

}  // namespace ecs::app
