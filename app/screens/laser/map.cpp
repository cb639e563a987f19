// Step 6: the components that the scope needs, present or missing, the findings, the tables as curves. Step 7: who made
// the map, when, for which machine.
#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "app/screens/laser/screen.hpp"
#include "base/clock.hpp"
#include "base/text.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/plot/curves.hpp"
#include "params/fields.hpp"

namespace ecs::app {
namespace {

const char* word_for(ComponentState state) {
  switch (state) {
    case ComponentState::present:
      return "present";
    case ComponentState::in_parameters:
      return "set";
    case ComponentState::zero:
      return "zero";
    case ComponentState::refused:
      return "REFUSED";
    case ComponentState::missing:
      break;
  }
  return "MISSING";
}

class MapPage final : public LaserPage {
 public:
  explicit MapPage(LaserHost& host) : LaserPage(host) {
    const auto change_side = [this] { in_findings_ = !in_findings_; };
    const auto declare = [this] { declare_zero(controller().work().map.components[at()]); };
    rows_ = {{"p", "parameters, scope"},
             {"z", "declare zero", declare},
             {"Enter", "details", [this] { explain(controller().work().map.components[at()]); }},
             {"up/down", "component"},
             {"Tab", "findings", change_side},
             {"Shift-Tab", "", change_side},
             {"u", "undo"},
             {"left/right", "cursor"},
             {"+ - 0", "zoom"},
             {"e", "picture", [this] { export_table(); }}};
  }

  void draw(Canvas& canvas, const Area& area) const override {
    const LaserMapWork& map = controller().work().map;
    if (!map.parameters) {
      draw_nothing_yet(canvas, area,
                       map.parameters_problem.empty()
                           ? (controller().choices().params_file.empty()
                                  ? "The parameters of the unit determine which components the map needs. Press p to "
                                    "choose their file or to receive them from the unit."
                                  : "The parameters are being read ...")
                           : map.parameters_problem);
      return;
    }
    canvas.text(area, 0, 1, state_text(map), map.complete() && map.findings().empty() ? Tone::good : Tone::warning);
    const LaserHalves halves = laser_halves(area.below(1));
    std::vector<ListRow> rows;
    for (const LaserComponent& one : map.components) rows.push_back(row_of(one));
    draw_list(canvas, halves.list, rows, place_, !in_findings_);
    if (halves.rest.columns == 0 || map.components.empty()) return;
    const auto text = findings_of(map, halves.rest.columns - 1);
    const int most = in_findings_ ? halves.rest.rows * 2 / 3 : halves.rest.rows / 4;
    const int below = text.empty() ? 0 : std::min(static_cast<int>(text.size()) + 1, most);
    draw_component(canvas, halves.rest.top(halves.rest.rows - below), map, map.components[at()]);
    if (below < 2) return;
    const Area lower = halves.rest.below(halves.rest.rows - below);
    canvas.text(lower, 0, 0, in_findings_ ? "> findings" : "findings (Tab)", Tone::faint);
    draw_scrolled(canvas, lower.below(1), text, scroll_);
  }

  bool on_key(const Key& key) override {
    const LaserMapWork& map = controller().work().map;
    if (!map.parameters || map.components.empty()) return false;
    if (in_findings_ && is_letter(key, U'z')) {
      controller().message().say("Press Tab first, then choose the component to declare zero.", Tone::warning);
      return true;
    }
    if (in_findings_ && key.name != Key::Name::tab && key.name != Key::Name::back_tab) return scroll_.on_key(key, 5);
    if (act_on(rows_, key)) return true;
    if (place_.on_key(key, static_cast<int>(map.components.size()))) {
      view_ = {};
      return true;
    }
    const auto panel = panel_of_component(map, map.components[at()].component);
    return panel && on_chart_key(key, *panel, view_);
  }

 private:
  [[nodiscard]] std::size_t at() const { return place_within(place_, controller().work().map.components.size()); }

  /// In a narrow terminal the list has all the room, and this is the only place that says so.
  void explain(const LaserComponent& one) {
    controller().message().say(
        fmt::format("{}, {}: {}", name_of(one.component), laser::description_of(one.component), detail_of(one)));
  }

  void declare_zero(const LaserComponent& one) {
    if (one.state != ComponentState::present) return host().fill(zero_form(one));
    host().ask({fmt::format("{} is measured. Declare it zero nevertheless?", name_of(one.component)),
                "Its measurement is then not used for the map.", "declare it zero", "keep the measurement"},
               [this, one] { host().fill(zero_form(one)); });
  }

  void export_table() {
    const LaserMapWork& map = controller().work().map;
    const Component component = map.components[at()].component;
    const std::string code(name_of(component));
    if (const auto panel = panel_of_component(map, component))
      host().export_picture({"compensation " + code, {*panel}, 1, true}, "map-" + code);
  }

  std::string state_text(const LaserMapWork& map) const {
    const UnitParameters& p = map.parameters->parameters;
    const std::string name = std::filesystem::path(controller().choices().params_file).filename().string();
    std::string text =
        fmt::format("{} ({}, {}): {} needed", name, configuration_of(p),
                    params::text_of(*params::field_named("compensation.scope"), p), map.components.size());
    if (map.missing() > 0) return text + fmt::format(", {} still missing", map.missing());
    if (!map.complete()) return text + ", see the findings";
    text += ", complete";
    return map.findings().empty() ? text : text + ", " + remarks_counted(map.findings().size());
  }

  static ListRow row_of(const LaserComponent& one) {
    const bool lacks = one.state == ComponentState::missing || one.state == ComponentState::refused;
    return {fmt::format("{:<4} {}", name_of(one.component), word_for(one.state)),
            lacks ? Tone::bad : (one.state == ComponentState::zero ? Tone::warning : Tone::plain)};
  }

  static std::optional<PlotPanel> panel_of_component(const LaserMapWork& map, Component component) {
    if (!map.made || is_squareness(component)) return std::nullopt;
    PlotFigure figure = figure_of(map.made->map.map, component, "");
    if (figure.panels.empty()) return std::nullopt;
    figure.panels.front().title = "in the map";
    figure.panels.front().x_label = fmt::format("{} [mm]", letter_of(moving_axis(component)));
    return figure.panels.front();
  }

  static std::string detail_of(const LaserComponent& one) {
    switch (one.state) {
      case ComponentState::missing:
        return one.detail.empty() ? "Not measured: add its file (step 1), or press z to declare it zero."
                                  : fmt::format(
                                        "Measured, but not used: {}. Press c in step 2 to correct a wrong "
                                        "position, or z to declare the component zero.",
                                        one.detail);
      case ComponentState::zero:
        return "declared zero: " + one.detail;
      case ComponentState::present:
        return "from " + one.detail;
      case ComponentState::in_parameters:
      case ComponentState::refused:
        break;
    }
    return one.detail;
  }

  void draw_component(Canvas& canvas, const Area& area, const LaserMapWork& map, const LaserComponent& one) const {
    int row = canvas.paragraph(
        area, 0, fmt::format("{}  {}", name_of(one.component), laser::description_of(one.component)), Tone::strong);
    row += canvas.paragraph(area, row, detail_of(one));
    if (map.made)
      for (const laser::ComponentOutcome& outcome : map.made->map.outcomes)
        if (outcome.component == one.component) row += draw_outcome(canvas, area.below(row), map.made->map, outcome);
    constexpr int kLeastRows = 6;  // of a curve; none where the findings have the room
    if (const auto panel = panel_of_component(map, one.component); panel && area.rows - row >= kLeastRows)
      draw_chart(canvas, area.below(row), *panel, view_);
  }

  static int draw_outcome(Canvas& canvas, const Area& area, const laser::BuiltMap& built,
                          const laser::ComponentOutcome& outcome) {
    const auto name = name_of(outcome.component);
    std::string text = fmt::format("largest {:.2f} {}, {} points a table", outcome.largest, unit_of(outcome.component),
                                   outcome.points);
    if (is_squareness(outcome.component))
      for (const std::string& step : built.map.header.processing)
        if (step.starts_with(name)) text = step;
    for (const std::string& note : outcome.notes) text += "; " + note;
    return canvas.paragraph(area, 0, text);
  }

  static std::vector<std::string> findings_of(const LaserMapWork& map, int columns) {
    std::vector<std::string> lines;
    const auto add = [&](const std::string& text) {
      for (std::string& line : wrapped(text, std::max(10, columns))) lines.push_back(std::move(line));
    };
    for (const std::string& refusal : map.refusals) add("refused: " + refusal);
    for (const laser::MapFinding& finding : map.findings())
      add((finding.objection ? "prevents sending: " : "remark: ") + finding_on_screen(finding.message));
    if (map.made)
      for (const std::string& note : map.made->map.notes) add("note: " + note);
    for (const std::string& unused : map.suggested.unused) add("not used: " + unused);
    return lines;
  }

  LaserForm zero_form(const LaserComponent& one) const {
    const std::string code(name_of(one.component));
    const std::string now = one.state == ComponentState::zero ? one.detail : "";
    return LaserForm(
        fmt::format("declare {} zero: {}", code, laser::description_of(one.component)),
        {{"reason", "reason for assuming zero; saved in the map's header. Empty: it is not declared zero", now}},
        [this, code, of = one.component](const std::vector<std::string>& v) {
          controller().change(code + (v[0].empty() ? " no longer declared zero" : " declared zero"),
                              [&](LaserChoices& c) { laser::declare_zero(c.recipe, of, std::string(trimmed(v[0]))); });
          return std::string();
        });
  }

  ListPlace place_;
  ScrollPlace scroll_;
  ChartView view_;
  bool in_findings_ = false;
};

}  // namespace

std::unique_ptr<LaserPage> laser_map_page(LaserHost& host) { return std::make_unique<MapPage>(host); }

namespace {

struct HeaderField {
  const char* name;
  const char* help;
  std::string laser::MapRecipe::*value;
};
constexpr std::array<HeaderField, 6> kFields{{
    {"customer", "owner of the machine", &laser::MapRecipe::customer},
    {"machine", "machine type; empty: as in the files or the parameters", &laser::MapRecipe::machine},
    {"serial number", "serial number of the machine; only the unit with this number accepts the map",
     &laser::MapRecipe::serial_number},
    {"engineer", "engineer who measured and commissioned", &laser::MapRecipe::engineer},
    {"date", "year-month-day, as in 2026-03-12; preset: date of the measurement, or today", &laser::MapRecipe::date},
    {"remarks", "any remark; a line of the header", &laser::MapRecipe::remark},
}};

class HeaderPage final : public LaserPage {
 public:
  explicit HeaderPage(LaserHost& host) : LaserPage(host) {
    rows_ = {{"up/down", "field"}, {"Enter", "edit", [this] { begin_edit(); }}, {"u", "undo"}};
  }

  void draw(Canvas& canvas, const Area& area) const override {
    canvas.text(area, 0, 1, "The header is sent to the unit with the map.", Tone::faint);
    const laser::MapRecipe shown = in_effect();
    for (std::size_t k = 0; k < kFields.size(); ++k) {
      const int row = static_cast<int>(k) + 2;
      const bool here = k == at();
      canvas.text(area, row, 1, here ? ">" : " ", Tone::strong);
      canvas.text(area, row, 3, kFields[k].name, here ? Tone::strong : Tone::plain);
      const std::string& chosen = controller().choices().recipe.*kFields[k].value;
      const std::string& value = shown.*kFields[k].value;
      if (editing_ && here) {
        line_.draw(canvas, area, row, kValues, std::max(1, area.columns - kValues - 1), true);
      } else if (value.empty()) {
        canvas.text(area, row, kValues, k + 1 == kFields.size() ? "-" : "not stated", Tone::warning);
      } else {
        const int used = canvas.text(area, row, kValues, value, chosen.empty() ? Tone::faint : Tone::plain);
        if (chosen.empty()) canvas.text(area, row, kValues + used + 2, origin_of(kFields[k]), Tone::faint);
      }
    }
    canvas.text(area, static_cast<int>(kFields.size()) + 3, 3, kFields[at()].help, Tone::faint);
    draw_rest(canvas, area.below(static_cast<int>(kFields.size()) + 5));
  }

  bool on_key(const Key& key) override {
    if (editing_) return on_edit_key(key);
    return place_.on_key(key, static_cast<int>(kFields.size())) || act_on(rows_, key);
  }

  bool typing() const override { return editing_; }
  bool holds_keys() const override { return editing_; }
  CellPosition cursor(const Area& area) const override {
    if (!editing_) return {-1, -1};
    const int columns = std::max(1, area.columns - kValues - 1);
    return {area.row + 2 + static_cast<int>(at()), area.column + kValues + line_.cursor_column(columns)};
  }
  std::vector<KeyHelp> keys() const override {
    if (editing_) return {{"Enter", "accept"}, {"Tab", "accept, edit the next"}, {"Esc", "cancel"}};
    return helps_of(rows_);
  }

 private:
  static constexpr int kValues = 20;
  [[nodiscard]] std::size_t at() const { return place_within(place_, kFields.size()); }

  [[nodiscard]] laser::MapRecipe in_effect() const {
    laser::MapRecipe shown = header_with_files(controller().choices().recipe, controller().work().lines);
    const LaserMapWork& map = controller().work().map;
    if (map.parameters && shown.machine.empty()) shown.machine = map.parameters->identity.machine;
    if (map.parameters && shown.serial_number.empty()) shown.serial_number = map.parameters->identity.serial_number;
    return shown;
  }

  /// Of a value that was not typed.
  [[nodiscard]] std::string_view origin_of(const HeaderField& field) const {
    const auto& lines = controller().work().lines;
    if ((header_with_files({}, lines).*field.value).empty()) return "(from the parameters)";
    if (field.value == &laser::MapRecipe::date && !states_date(lines)) return "(today; no file states a date)";
    return "(from the files)";
  }

  void draw_rest(Canvas& canvas, const Area& area) const {
    const LaserMapWork& map = controller().work().map;
    if (!map.made || area.rows < 2) return;
    canvas.text(area, 0, 1,
                fmt::format("added automatically: {} source files, {} steps of processing",
                            map.made->map.map.header.sources.size(), map.made->map.map.header.processing.size()),
                Tone::faint);
    int row = 1;
    for (const std::string& step : map.made->map.map.header.processing)
      if (row < area.rows) canvas.text(area, row++, 3, step, Tone::faint);
  }

  void begin_edit() {
    line_.propose(in_effect().*kFields[at()].value);
    editing_ = true;
  }

  bool on_edit_key(const Key& key) {
    if (key.name == Key::Name::escape) {
      editing_ = false;
      return true;
    }
    if (key.name != Key::Name::enter && key.name != Key::Name::tab) {
      (void)line_.on_key(key);
      return true;
    }
    const HeaderField& field = kFields[at()];
    const std::string value = line_.text();
    if (field.value == &laser::MapRecipe::date)
      if (const auto wrong = wrong_date(value)) {
        controller().message().say("date: " + *wrong, Tone::bad);
        return true;
      }
    if (value != in_effect().*field.value)
      controller().change(std::string("the ") + field.name, [&](LaserChoices& c) { c.recipe.*field.value = value; });
    editing_ = false;
    if (key.name == Key::Name::tab && at() + 1 < kFields.size()) {
      ++place_.selected;
      begin_edit();
    }
    return true;
  }

  ListPlace place_;
  TextLine line_;
  bool editing_ = false;
};

}  // namespace

std::unique_ptr<LaserPage> laser_header_page(LaserHost& host) { return std::make_unique<HeaderPage>(host); }

}  // namespace ecs::app
