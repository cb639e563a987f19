#include "app/screens/laser_page.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/file.hpp"

namespace ecs::app {

LaserHalves laser_halves(const Area& area) {
  constexpr int kRoomForBoth = 60;
  if (area.columns < kRoomForBoth) return {area, {area.row, area.column, 0, 0}};
  const int list = std::clamp(area.columns / 3, 26, 40);
  return {area.left(list), area.right_of(list + 1)};
}

void draw_nothing_yet(Canvas& canvas, const Area& area, const std::string& how_to_get_it) {
  canvas.paragraph({area.row, area.column + 1, area.rows, area.columns - 2}, 1, how_to_get_it);
}

std::vector<ListRow> rows_of_lines(const LaserWork& work) {
  std::vector<ListRow> rows;
  for (std::size_t k = 0; k < work.lines.size(); ++k) {
    const LaserLine& line = work.lines[k];
    const std::size_t out = count_left_out(work.results[k]->choice, *line.set);
    std::string mark = " ";
    Tone tone = Tone::plain;
    if (!line.suspects.empty()) mark = "?";
    if (out > 0) mark = "-";
    if (!work.results[k]->problem.empty()) {
      mark = "!";
      tone = Tone::bad;
    }
    rows.push_back({fmt::format("{} {:<4} {}", mark, name_of(line.component), line.place), tone});
  }
  return rows;
}

std::size_t place_within(const ListPlace& place, std::size_t count) {
  return std::min(static_cast<std::size_t>(std::max(0, place.selected)), count == 0 ? 0 : count - 1);
}

void LaserHost::ask_parameters() {
  const LaserChoices& now = desk.choices();
  const auto state = state_folder();
  const std::string unit_file =
      ((state ? *state : std::filesystem::temp_directory_path()) / "unit-parameters.toml").string();
  std::vector<LaserField> fields{{"parameters",
                                  "the unit's parameter file; leave it empty to take what the unit holds",
                                  now.params_file,
                                  {},
                                  true},
                                 {"scope",
                                  "what the unit shall correct; empty: as the parameters say",
                                  now.scope,
                                  {"", "linear", "planar", "volumetric"}}};
  fill(LaserForm("parameters of the unit", std::move(fields), [this, unit_file](const std::vector<std::string>& v) {
    if (v[0].empty()) {
      desk.change("the scope", [&](LaserChoices& c) { c.scope = v[1]; });
      desk.receive_parameters(unit_file);
      return std::string();
    }
    std::error_code fault;
    if (!std::filesystem::is_regular_file(v[0], fault)) return fmt::format("there is no file {}", v[0]);
    desk.change("the parameters", [&](LaserChoices& c) {
      c.params_file = v[0];
      c.scope = v[1];
    });
    return std::string();
  }));
}

}  // namespace ecs::app
