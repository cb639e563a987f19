#include "app/screens/parameters/view.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

namespace ecs::app {
namespace {

constexpr int kMarks = 2;  ///< column of the marks
constexpr int kNames = 6;
constexpr int kSideBySide = 74;  ///< columns from which on a row has room for a note

struct Columns {
  int value = 0;
  int note = 0;  ///< 0: none
  int end = 0;
};

Columns columns_of(const Area& area) {
  if (area.columns < kSideBySide) return {kNames + std::max(8, (area.columns - kNames) / 2), 0, area.columns - 1};
  return {kNames + 27, kNames + 45, area.columns - 1};
}

std::string counted(std::size_t count, std::string_view word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

/// "1 value differs"
std::string differing(std::size_t count) {
  return count == 1 ? "1 value differs" : fmt::format("{} values differ", count);
}

bool has_error(const std::vector<const params::Finding*>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const params::Finding* f) { return f->severity == params::Severity::error; });
}

/// "error, was 5, unit 7"
std::string note_of(const ParametersController& controller, const std::string& key) {
  std::vector<std::string> parts;
  if (const auto found = controller.findings_of(key); !found.empty())
    parts.push_back(has_error(found) ? "error" : "warning");
  if (const auto was = controller.was(key)) parts.push_back("was " + (was->empty() ? std::string("empty") : *was));
  if (controller.differs_from_unit(key)) parts.push_back("unit " + value_of(key, {*controller.unit()->parameters, {}}));
  std::string note;
  for (const std::string& part : parts) note += (note.empty() ? "" : ", ") + part;
  return note;
}

void draw_row(Canvas& canvas, const Area& area, int r, const ParametersController& controller, const ParameterRow& row,
              bool here, const ValueEdit* edit, CellPosition& cursor) {
  if (row.key.empty()) {
    canvas.text(area, r, kMarks, row.label, Tone::strong);
    return;
  }
  const Columns at = columns_of(area);
  const bool selected = here && edit == nullptr;
  const Tone tone = selected ? Tone::selected : Tone::plain;
  if (selected) canvas.fill({area.row + r, area.column, 1, area.columns - 1}, U' ', Tone::selected);
  if (here) canvas.text(area, r, 0, ">", tone);
  const auto findings = controller.findings_of(row.key);
  const bool changed = controller.was(row.key).has_value();
  const Tone finding_tone = has_error(findings) ? Tone::bad : Tone::warning;
  if (!findings.empty()) canvas.text(area, r, kMarks, "!", selected ? tone : finding_tone);
  if (changed) canvas.text(area, r, kMarks + 1, "*", tone);
  if (controller.differs_from_unit(row.key)) canvas.text(area, r, kMarks + 2, "u", tone);
  canvas.text(area.left(at.value - 1), r, kNames, row.label, tone);
  if (edit != nullptr) {
    if (edit->choosing) {
      canvas.text(area, r, at.value, "< " + edit->text.text() + " >", Tone::strong);
    } else {
      const int room = std::max(6, at.end - at.value);
      edit->text.draw(canvas, area, r, at.value, room, true);
      cursor = {area.row + r, area.column + at.value + edit->text.cursor_column(room)};
    }
    return;
  }
  const std::string note = at.note == 0 ? "" : note_of(controller, row.key);
  const std::string value = value_with_unit(row.key, value_of(row.key, controller.set()));
  canvas.text(area.left(note.empty() ? at.end : at.note - 1), r, at.value, value.empty() ? "(not stated)" : value,
              selected ? tone : (value.empty() ? Tone::faint : Tone::strong));
  if (!note.empty())
    canvas.text(area.left(at.end), r, at.note, note, selected ? tone : (findings.empty() ? Tone::plain : finding_tone));
}

/// The selected row and its heading in sight.
void keep_in_sight(const ListPlace& place, int rows, int count) {
  const int selected = std::clamp(place.selected, 0, std::max(0, count - 1));
  place.first = std::clamp(place.first, std::max(0, selected - rows + 1), selected);
  if (selected <= 1) place.first = 0;
  place.first = std::clamp(place.first, 0, std::max(0, count - rows));
}

}  // namespace

std::string about(const ParametersController& controller, int columns) {
  std::string name = controller.file().empty() ? "not saved in a file" : controller.file();
  std::string rest = controller.changes() > 0 ? ", " + counted(controller.changes(), "change") : "";
  if (controller.unsaved()) rest += " not saved";
  if (const std::size_t other = controller.differs_from_file(); !controller.unsaved() && other > 0)
    rest += fmt::format(", {} there", differing(other));
  std::vector<std::string> more;
  if (controller.has_unit_values()) {
    const std::size_t other = controller.differs_from_unit().size();
    more.push_back(other == 0 ? "the unit has the same values" : differing(other) + " in the unit");
  } else if (controller.unit()) {
    more.push_back("the unit has no parameters");
  }
  if (!controller.machine().empty()) more.push_back("checked for " + controller.machine());
  for (const std::string& part : more)
    if (std::min(width_of(name), 30) + width_of(rest + "; " + part) <= columns) rest += "; " + part;
  if (width_of(name) + width_of(rest) > columns && !controller.file().empty())
    name = std::filesystem::path(controller.file()).filename().string();
  return name + rest;
}

CellPosition draw_parameters(Canvas& canvas, const Area& area, const ParametersController& controller,
                             const std::vector<ParameterRow>& rows, const ListPlace& place,
                             const std::optional<ValueEdit>& edit) {
  CellPosition cursor{-1, -1};
  if (area.rows < 2) return cursor;
  const Columns at = columns_of(area);
  canvas.text(area.left(at.value - 1), 0, kNames, "parameter", Tone::faint);
  canvas.text(area, 0, at.value, "value", Tone::faint);
  if (at.note > 0) canvas.text(area.left(at.end), 0, at.note, "! see below * changed", Tone::faint);
  const Area list = area.below(1);
  const int count = static_cast<int>(rows.size());
  keep_in_sight(place, list.rows, count);
  for (int r = 0; r < std::min(list.rows, count - place.first); ++r) {
    const ParameterRow& row = rows[static_cast<std::size_t>(place.first + r)];
    const bool here = place.first + r == place.selected;
    draw_row(canvas, list, r, controller, row, here, here && edit && edit->key == row.key ? &*edit : nullptr, cursor);
  }
  draw_scroll_marks(canvas, list, place.first, count);
  return cursor;
}

void draw_panel(Canvas& canvas, const Area& area, const std::string& title, const std::vector<PanelText>& texts) {
  if (area.rows <= 0) return;
  canvas.fill({area.row, area.column, 1, area.columns}, U'─', Tone::faint);
  if (!title.empty()) canvas.text(area, 0, 2, " " + title + " ", Tone::strong);
  const Area inside{area.row + 1, area.column + 1, area.rows - 1, std::max(1, area.columns - 2)};
  int row = 0;
  for (const PanelText& part : texts) row += canvas.paragraph(inside, row, part.text, part.tone);
}

void draw_key_panel(Canvas& canvas, const Area& area, const ParametersController& controller, const std::string& key,
                    const std::string& refusal) {
  const KeyWords words = words_of(key);
  std::vector<PanelText> texts;
  if (!refusal.empty()) texts.push_back({"Refused: " + refusal, Tone::bad});
  for (const params::Finding* finding : controller.findings_of(key))
    texts.push_back({fmt::format("! {}: {}", params::name_of(finding->severity), finding->message),
                     finding->severity == params::Severity::error ? Tone::bad : Tone::warning});
  texts.push_back({fmt::format("Accepts {}{}.", words.accepts,
                               words.default_value.empty() ? "" : "; default " + words.default_value),
                   Tone::strong});
  texts.push_back({words.help, Tone::plain});
  if (!words.thesis_name.empty()) texts.push_back({"Thesis 5.3: " + words.thesis_name, Tone::faint});
  draw_panel(canvas, area, key, texts);
}

void draw_findings(Canvas& canvas, const Area& area, const ParametersController& controller, const ListPlace& place) {
  const auto& findings = controller.findings();
  if (findings.empty()) {
    canvas.paragraph({area.row + 1, area.column + 2, area.rows - 1, area.columns - 4}, 0,
                     "No findings for these parameters." +
                         std::string(controller.machine().empty() ? " Press m to check them against a machine file too."
                                                                  : " They were checked against the machine as well."),
                     Tone::good);
    return;
  }
  std::vector<ListRow> rows;
  for (const params::Finding& finding : findings) {
    const bool error = finding.severity == params::Severity::error;
    rows.push_back({fmt::format("{:<8} {:<25} {}", params::name_of(finding.severity),
                                finding.keys.empty() ? "" : full_label_of(finding.keys.front()), finding.message),
                    error ? Tone::bad : Tone::warning});
  }
  draw_list(canvas, area, rows, place);
}

void draw_finding_panel(Canvas& canvas, const Area& area, const ParametersController& controller,
                        const ListPlace& place) {
  if (controller.findings().empty()) return draw_panel(canvas, area, "", {});
  const auto k = std::min(static_cast<std::size_t>(std::max(0, place.selected)), controller.findings().size() - 1);
  const params::Finding& finding = controller.findings()[k];
  std::vector<PanelText> texts{{finding.message, Tone::plain}};
  for (const std::string& key : finding.keys)
    texts.push_back({fmt::format("{} = {}", key, value_with_unit(key, value_of(key, controller.set()))), Tone::strong});
  texts.push_back({controller.errors() > 0 ? "Parameters with errors cannot be sent. Press Enter to go to the field."
                                           : "Warnings may be intended. Press Enter to go to the field.",
                   Tone::faint});
  draw_panel(canvas, area,
             fmt::format("{} {} of {}", params::name_of(finding.severity), k + 1, controller.findings().size()), texts);
}

namespace {

/// What a side holds, `=` where it is what the screen holds.
std::string side(bool known, const std::string& value, const std::string& screen) {
  if (!known) return "-";
  if (value == screen) return "=";
  return value.empty() ? "empty" : value;
}

std::string nothing_differs(const ParametersController& controller) {
  const std::string unit = controller.unit() ? "the unit has no parameters" : "no unit has answered yet";
  if (controller.has_file_values() && controller.has_unit_values()) return "Screen, file and unit agree.";
  if (controller.has_file_values()) return "The file agrees with the screen; " + unit + ".";
  if (controller.has_unit_values()) return "The unit agrees with the screen. The parameters are not saved in a file.";
  return "No comparison is possible: these parameters are not saved in a file, and " + unit + ".";
}

bool unit_known(const ParametersController& controller, const std::string& key) {
  return controller.has_unit_values() && params::field_named(key) != nullptr;
}

}  // namespace

void draw_compared(Canvas& canvas, const Area& area, const ParametersController& controller, const ListPlace& place) {
  if (area.rows < 2) return;
  const auto& compared = controller.compared();
  if (compared.empty()) {
    canvas.paragraph({area.row + 1, area.column + 2, area.rows - 1, area.columns - 4}, 0, nothing_differs(controller),
                     controller.has_file_values() || controller.has_unit_values() ? Tone::good : Tone::plain);
    return;
  }
  const int names = area.columns >= 60 ? 28 : std::max(8, area.columns - 32);
  const int width = std::max(6, (area.columns - names - 4) / 3);
  const auto line = [&](const std::string& name, const std::string& screen, const std::string& file,
                        const std::string& unit) {
    const auto cell = [](const std::string& text, int columns) { return in_columns(text, columns - 1) + " "; };
    return cell(name, names) + cell(screen, width) + cell(file, width) + cell(unit, width);
  };
  canvas.text(area, 0, 2,
              line("= as on the screen", "screen", controller.has_file_values() ? "file" : "no file",
                   controller.has_unit_values() ? "unit" : "unit unknown"),
              Tone::faint);
  std::vector<ListRow> rows;
  for (const ComparedKey& row : compared)
    rows.push_back({line(full_label_of(row.key), row.screen.empty() ? "empty" : row.screen,
                         side(controller.has_file_values(), row.file, row.screen),
                         side(unit_known(controller, row.key), row.unit, row.screen))});
  draw_list(canvas, area.below(1), rows, place);
}

void draw_compared_panel(Canvas& canvas, const Area& area, const ParametersController& controller,
                         const ListPlace& place) {
  const auto& compared = controller.compared();
  if (compared.empty()) return draw_panel(canvas, area, "", {});
  const auto k = std::min(static_cast<std::size_t>(std::max(0, place.selected)), compared.size() - 1);
  const ComparedKey& row = compared[k];
  std::string sides = "Screen " + value_with_unit(row.key, row.screen);
  if (controller.has_file_values())
    sides += "; file " + (row.file.empty() ? "empty" : value_with_unit(row.key, row.file));
  if (unit_known(controller, row.key)) sides += "; unit " + value_with_unit(row.key, row.unit);
  std::string takes = "Press Enter to go to the field.";
  if (controller.has_file_values() && row.file != row.screen) takes += " Press f to use the file's value.";
  if (unit_known(controller, row.key) && row.unit != row.screen) takes += " Press g to use the unit's value.";
  draw_panel(canvas, area, fmt::format("{}, {} of {}", row.key, k + 1, compared.size()),
             {{sides + ".", Tone::strong}, {takes, Tone::plain}, {words_of(row.key).help, Tone::faint}});
}

}  // namespace ecs::app
