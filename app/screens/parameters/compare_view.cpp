// The page of the parameters screen that puts screen, file and unit side by side.
#include <algorithm>

#include <fmt/format.h>

#include "app/screens/parameters/view.hpp"

namespace ecs::app {
namespace {

/// What a side holds, `=` where it is what the screen holds.
std::string side(bool known, const std::string& value, const std::string& screen) {
  if (!known) return "-";
  if (value == screen) return "=";
  return value.empty() ? "empty" : value;
}

std::string nothing_differs(const ParametersController& controller) {
  const std::string unit = controller.unit() ? "the unit holds no parameters" : "no unit has answered yet";
  if (controller.has_file_values() && controller.has_unit_values()) return "Screen, file and unit hold the same.";
  if (controller.has_file_values()) return "The file holds what the screen shows; " + unit + ".";
  if (controller.has_unit_values()) return "The unit holds what the screen shows; they are in no file yet.";
  return "There is nothing to compare with: these parameters are in no file yet, and " + unit + ".";
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
  std::string takes = "Enter goes to the field.";
  if (controller.has_file_values() && row.file != row.screen) takes += " f takes the value of the file.";
  if (unit_known(controller, row.key) && row.unit != row.screen) takes += " g takes the value of the unit.";
  draw_panel(canvas, area, fmt::format("{}, {} of {}", row.key, k + 1, compared.size()),
             {{sides + ".", Tone::strong}, {takes, Tone::plain}, {words_of(row.key).help, Tone::faint}});
}

}  // namespace ecs::app
