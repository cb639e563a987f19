#include "app/screens/laser/page.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "app/plot/gnuplot.hpp"
#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::app {

LaserHalves laser_halves(const Area& area, int least_rows) {
  constexpr int kRoomForBoth = 60;
  if (area.columns >= kRoomForBoth) {
    const int list = std::clamp(area.columns / 3, 26, 40);
    return {area.left(list), area.right_of(list + 1)};
  }
  if (area.rows < least_rows) return {area, {area.row, area.column, 0, 0}};
  return {area.top(area.rows / 3), area.below(area.rows / 3)};
}

void draw_nothing_yet(Canvas& canvas, const Area& area, const std::string& how_to_get_it) {
  canvas.paragraph(area.between_margins(), 1, how_to_get_it);
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

void LaserHost::ask_answers(const std::string& path, const std::string& field) {
  const auto& files = controller.choices().files;
  const auto choice = std::find_if(files.begin(), files.end(), [&](const auto& file) { return file.path == path; });
  if (choice == files.end()) return;
  const auto given = given_answers(choice->answers);
  std::vector<LaserField> fields;
  for (const commissioning::AnswerField& one : answer_fields()) {
    const auto value = given.find(one.name);
    fields.push_back({one.name, one.help, value == given.end() ? "" : value->second, one.choices,
                      one.kind == commissioning::AnswerField::Kind::path});
  }
  const std::string name = std::filesystem::path(path).filename().string();
  LaserForm form("what " + name + " does not say", std::move(fields), [this, path](const std::vector<std::string>& v) {
    ImportArguments answers;
    for (std::size_t k = 0; k < v.size(); ++k) {
      const commissioning::AnswerField& asked = answer_fields()[k];
      if (asked.kind == commissioning::AnswerField::Kind::number && !v[k].empty() && !number_in(v[k]))
        return fmt::format("{}: expected a number, found \"{}\"", asked.name, v[k]);
      set_answer(answers, asked.name, v[k]);
    }
    if (const auto sound = import_options(answers); !sound) return to_text(sound.error());
    controller.change("answers for a file", [&](LaserChoices& c) {
      for (LaserFileChoice& file : c.files)
        if (file.path == path) file.answers = answers;
    });
    return std::string();
  });
  if (!field.empty()) form.go_to(field);
  fill(std::move(form));
}

void LaserHost::export_picture(PlotFigure figure, const std::string& stem) {
  commissioning::export_picture(drawing_, std::move(figure), stem, write_plot, controller.message());
}

void LaserHost::ask_parameters() {
  const LaserChoices& now = controller.choices();
  const auto state = state_folder();
  const std::string unit_file =
      ((state ? *state : std::filesystem::temp_directory_path()) / "unit-parameters.toml").string();
  std::vector<LaserField> fields{{"parameters",
                                  "the unit's parameter file; leave it empty to take what the unit holds",
                                  now.params_file,
                                  {},
                                  true,
                                  {{FileKind::parameters}}},
                                 {"scope",
                                  "what the unit shall correct; empty: as the parameters say",
                                  now.scope,
                                  {"", "linear", "planar", "volumetric"}}};
  fill(LaserForm("parameters of the unit", std::move(fields), [this, unit_file](const std::vector<std::string>& v) {
    if (v[0].empty()) {
      controller.change("the scope", [&](LaserChoices& c) { c.scope = v[1]; });
      controller.receive_parameters(unit_file);
      return std::string();
    }
    std::error_code fault;
    if (!std::filesystem::is_regular_file(v[0], fault)) return fmt::format("there is no file {}", v[0]);
    controller.change("the parameters", [&](LaserChoices& c) {
      c.params_file = v[0];
      c.scope = v[1];
    });
    return std::string();
  }));
}

}  // namespace ecs::app
