// Step 7: who made the map, when, for which machine.
#include <array>

#include <fmt/format.h>

#include "app/screens/laser/page.hpp"
#include "base/date.hpp"

namespace ecs::app {
namespace {

struct HeaderField {
  const char* name;
  const char* help;
  std::string LaserHeaderChoice::*value;
};
constexpr std::array<HeaderField, 6> kFields{{
    {"customer", "whose machine it is", &LaserHeaderChoice::customer},
    {"machine", "its type; empty: as the files or the parameters say", &LaserHeaderChoice::machine},
    {"serial number", "of the machine; a map goes only into the unit with this number",
     &LaserHeaderChoice::serial_number},
    {"engineer", "who measured and commissioned", &LaserHeaderChoice::engineer},
    {"date", "year-month-day, as in 2026-03-12; preset: of the measurement", &LaserHeaderChoice::date},
    {"remarks", "anything worth knowing; a line of the header", &LaserHeaderChoice::remarks},
}};

class HeaderPage final : public LaserPage {
 public:
  explicit HeaderPage(LaserHost& host) : LaserPage(host) {}

  void draw(Canvas& canvas, const Area& area) const override {
    canvas.text(area, 0, 1, "The header travels with the map into the unit.", Tone::faint);
    const LaserHeaderChoice shown = in_effect();
    for (std::size_t k = 0; k < kFields.size(); ++k) {
      const int row = static_cast<int>(k) + 2;
      const bool here = k == at();
      canvas.text(area, row, 1, here ? ">" : " ", Tone::strong);
      canvas.text(area, row, 3, kFields[k].name, here ? Tone::strong : Tone::plain);
      const std::string& chosen = controller().choices().header.*kFields[k].value;
      const std::string& value = shown.*kFields[k].value;
      if (editing_ && here) {
        line_.draw(canvas, area, row, kValues, std::max(1, area.columns - kValues - 1), true);
      } else if (value.empty()) {
        canvas.text(area, row, kValues, k + 1 == kFields.size() ? "-" : "not stated", Tone::warning);
      } else {
        const int used = canvas.text(area, row, kValues, value, chosen.empty() ? Tone::faint : Tone::plain);
        if (chosen.empty()) canvas.text(area, row, kValues + used + 2, "(from the files)", Tone::faint);
      }
    }
    canvas.text(area, static_cast<int>(kFields.size()) + 3, 3, kFields[at()].help, Tone::faint);
    draw_rest(canvas, area.below(static_cast<int>(kFields.size()) + 5));
  }

  bool on_key(const Key& key) override {
    if (editing_) return on_edit_key(key);
    if (place_.on_key(key, static_cast<int>(kFields.size()))) return true;
    if (key.name != Key::Name::enter) return false;
    begin_edit();
    return true;
  }

  bool typing() const override { return editing_; }
  bool holds_keys() const override { return editing_; }
  CellPosition cursor(const Area& area) const override {
    if (!editing_) return {-1, -1};
    const int columns = std::max(1, area.columns - kValues - 1);
    return {area.row + 2 + static_cast<int>(at()), area.column + kValues + line_.cursor_column(columns)};
  }
  std::vector<KeyHelp> keys() const override {
    if (editing_) return {{"Enter", "take it"}, {"Tab", "take it, edit the next"}, {"Esc", "leave it as it was"}};
    return {{"up/down", "field"}, {"Enter", "edit"}, {"u", "undo"}};
  }
  std::string help() const override {
    return "Step 7: the header of the map. Enter edits the field under the cursor, Tab goes on to the next one. Faint "
           "values come from the files. Which files were used and what was done to them is added by itself.";
  }

 private:
  static constexpr int kValues = 20;
  [[nodiscard]] std::size_t at() const { return place_within(place_, kFields.size()); }

  [[nodiscard]] LaserHeaderChoice in_effect() const {
    LaserHeaderChoice shown = header_with_files(controller().choices().header, controller().work().lines);
    const LaserMapWork& map = controller().work().map;
    if (map.parameters && shown.machine.empty()) shown.machine = map.parameters->identity.machine;
    if (map.parameters && shown.serial_number.empty()) shown.serial_number = map.parameters->identity.serial_number;
    return shown;
  }

  void draw_rest(Canvas& canvas, const Area& area) const {
    const LaserMapWork& map = controller().work().map;
    if (!map.made || area.rows < 2) return;
    canvas.text(area, 0, 1,
                fmt::format("added by itself: {} source files, {} steps of processing",
                            map.made->map.map.header.sources.size(), map.made->map.map.header.processing.size()),
                Tone::faint);
    int row = 1;
    for (const std::string& step : map.made->map.map.header.processing)
      if (row < area.rows) canvas.text(area, row++, 3, step, Tone::faint);
  }

  void begin_edit() {
    line_ = TextLine(in_effect().*kFields[at()].value);
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
    if (field.value == &LaserHeaderChoice::date)
      if (const auto wrong = wrong_date(value)) {
        controller().message().say("date: " + *wrong, Tone::bad);
        return true;
      }
    if (value != in_effect().*field.value)
      controller().change(std::string("the ") + field.name, [&](LaserChoices& c) { c.header.*field.value = value; });
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
