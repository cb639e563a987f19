// RECORD DATUM SEQUENCE: which axis, ten seconds with what the unit sees meanwhile, then the graph opens. TEST DATUM
// ROUTINE: the axes with the stage in which each stands, live; what failed and what to do next.
#include "commissioning/utility/datum.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"

namespace ecs::app {
namespace {

constexpr int kDatumRecordAxisRow = 2;
constexpr int kProgressRow = 7;
constexpr const char* kDatumRecordExplained =
    "Ten seconds of one axis are recorded: speed, reference switch and marker. The unit only watches: the machine must "
    "be referenced by its own control while the bar runs, from some travel away from the switch and slowly enough that "
    "switch and marker come within the ten seconds. The graph opens by itself; the datuming parameters are read off "
    "there.";

class DatumRecordScreen final : public DrivingScreen<DatumRecordController> {
 public:
  using DrivingScreen::DrivingScreen;

  [[nodiscard]] std::string title() const override { return "RECORD DATUM SEQUENCE"; }
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_unit_row(canvas, inside, 0, controller_.unit());
    const bool busy = controller_.busy();
    draw_axis_rows(canvas, inside, kDatumRecordAxisRow, controller_.unit(), busy ? controller_.axis() : chosen());
    const char axis = letter_of(busy ? controller_.axis() : chosen());
    int row = kProgressRow + 2;
    if (controller_.phase() == DatumRecordController::Phase::recording) {
      draw_progress(canvas, inside, kProgressRow, fmt::format("recording axis {}", axis), controller_.part(),
                    controller_.seconds_left());
      canvas.text(
          inside, kProgressRow + 1, 0,
          fmt::format("so far: switch {}, marker {} (the record sees all in between)",
                      controller_.switch_seen() ? "seen" : "not yet", controller_.marker_seen() ? "seen" : "not yet"));
      row += canvas.paragraph(inside, row + 1,
                              controller_.referencing() ? "The emulated machine is being referenced ..."
                                                        : call_to_reference(controller_.axis()),
                              Tone::warning) +
             2;
    } else if (controller_.phase() == DatumRecordController::Phase::starting) {
      canvas.text(inside, kProgressRow, 0, "Sending ...");
    } else if (busy) {
      draw_progress(canvas, inside, kProgressRow, "fetching the record", controller_.part(),
                    controller_.seconds_left());
    } else {
      canvas.text(inside, kProgressRow, 0, fmt::format("Enter records axis {}.", axis));
    }
    canvas.paragraph(inside, row + 1, kDatumRecordExplained, Tone::faint);
    draw_message(canvas, {inside.row + inside.rows - 2, inside.column, 2, inside.columns}, controller_.message());
  }

  void on_command(const Key& key) override {
    if (is_letter(key, U'g')) controller_.reference();
    if (is_letter(key, U'j')) ask_to_drive();
    if (controller_.busy()) return;
    if (choose_axis(place_, key, controller_.unit().axes(), kDatumRecordAxisRow + 2)) return;
    if (key.name == Key::Name::enter && unit_integrates())
      asking_.ask(controller_.question(chosen()), [this, axis = chosen()] { controller_.start(axis); });
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (asking_.active()) return {{"y", "record"}, {"n", "not now"}};
    if (prompt_.active()) return prompt_.keys();
    if (controller_.busy()) return keys_while_referencing();
    return with_driver({{"Enter", "record"}, {"up/down x y z", "axis"}, {"Esc", "back"}}, 2);
  }

  [[nodiscard]] std::string help() const override { return kDatumRecordExplained; }

  [[nodiscard]] std::unique_ptr<Screen> opens_by_itself() override {
    auto record = controller_.take();
    return record ? datum_view_screen(std::move(record)) : nullptr;
  }
};

}  // namespace

std::unique_ptr<Screen> datum_record_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<DatumRecordScreen>(std::move(connection));
}

namespace {

using TestState = DatumTestController::TestState;
constexpr int kRowsRow = 2;
constexpr int kCallRow = 7;
constexpr const char* kDatumTestExplained =
    "The unit goes through its datum routine, axis after axis, while the machine is referenced by its own control: it "
    "waits for the motion, looks for the switch, then for the marker. An axis that does not fit its datuming "
    "parameters fails with the reason and what to do.";

std::string word_for(const DatumTestController::AxisRow& row) {
  switch (row.state) {
    case TestState::not_chosen:
      return "not tested";
    case TestState::chosen:
      return "to be tested";
    case TestState::under_way:
      return row.stage == DatumStage::failed ? "FAILED, ending" : std::string(ecs::name_of(row.stage)) + " ...";
    case TestState::passed:
      return "DATUM FOUND";
    case TestState::failed:
      return "FAILED";
    case TestState::given_up:
      return "given up";
  }
  return {};
}

Tone tone_for(TestState state) {
  if (state == TestState::passed) return Tone::good;
  if (state == TestState::failed) return Tone::bad;
  return state == TestState::under_way ? Tone::strong : Tone::plain;
}

class DatumTestScreen final : public DrivingScreen<DatumTestController> {
 public:
  using DrivingScreen::DrivingScreen;

  [[nodiscard]] std::string title() const override { return "TEST DATUM ROUTINE"; }
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_unit_row(canvas, inside, 0, controller_.unit());
    draw_rows(canvas, inside.below(kRowsRow));
    canvas.text(inside, kCallRow, 0, call(), controller_.busy() ? Tone::warning : Tone::plain);
    int row = kCallRow + 2;
    for (const auto& axis : controller_.rows())
      if (!axis.message.empty())
        row += canvas.paragraph(inside, row, fmt::format("{}: {}", letter_of(axis.axis), axis.message), Tone::bad);
    if (row == kCallRow + 2) canvas.paragraph(inside, row, kDatumTestExplained, Tone::faint);
    draw_message(canvas, {inside.row + inside.rows - 2, inside.column, 2, inside.columns}, controller_.message());
  }

  void on_command(const Key& key) override {
    if (is_letter(key, U'g')) controller_.reference();
    if (is_letter(key, U'j')) ask_to_drive();
    if (controller_.busy()) return;
    const auto& rows = controller_.rows();
    if (place_.on_key(key, static_cast<int>(rows.size()))) return;
    if (const auto axis = axis_of_key(key)) controller_.toggle(*axis);
    if (is_letter(key, U' ') && !rows.empty())
      controller_.toggle(
          rows[static_cast<std::size_t>(std::clamp(place_.selected, 0, static_cast<int>(rows.size()) - 1))].axis);
    if (const auto k = axis_clicked(key, kRowsRow + 2, static_cast<int>(rows.size()))) place_.selected = *k;
    if (key.name == Key::Name::enter && unit_integrates())
      asking_.ask(controller_.question(), [this] { controller_.start(); });
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (asking_.active()) return {{"y", "test"}, {"n", "not now"}};
    if (prompt_.active()) return prompt_.keys();
    if (controller_.busy()) return keys_while_referencing();
    return with_driver({{"Enter", "test"}, {"Space x y z", "choose axes"}, {"up/down", "axis"}, {"Esc", "back"}}, 3);
  }

  [[nodiscard]] std::string help() const override {
    return std::string(kDatumTestExplained) +
           " With the bundled emulator g references its machine, the axis under test first and the others when their "
           "turn comes. An axis that is never referenced is waited for ten minutes; Esc gives up.";
  }

 private:
  void draw_rows(Canvas& canvas, const Area& area) const {
    canvas.text(area, 0, 0,
                fmt::format("  {:<10} {:<18} {:>13} {:>10}  {:<8}{:<8}", "axis", "stage", "position mm", "mm/min",
                            "switch", "marker"),
                Tone::faint);
    int r = 0;
    for (const auto& row : controller_.rows()) {
      ++r;
      const auto* s = controller_.unit().axis(row.axis);
      const bool here = r - 1 == place_.selected && !controller_.busy();
      if (here) canvas.fill({area.row + r, area.column, 1, area.columns}, U' ', Tone::selected);
      const Tone tone = here ? Tone::selected : tone_for(row.state);
      canvas.text(area, r, 0,
                  fmt::format("{} [{}] {:<6} {:<18}", here || controller_.under_test() == row.axis ? ">" : " ",
                              row.state == TestState::not_chosen ? " " : "x", letter_of(row.axis), word_for(row)),
                  tone);
      if (s != nullptr)
        canvas.text(area, r, 32,
                    fmt::format("{:>13.4f} {:>10.1f}  {:<8}{:<8}", s->position_mm, s->speed_mm_min,
                                s->switch_active ? "on" : "off", s->marker ? "seen" : "-"),
                    here ? Tone::selected : Tone::plain);
    }
  }

  [[nodiscard]] std::string call() const {
    if (!controller_.busy()) return "Enter begins the test of the axes marked x.";
    if (!controller_.under_test()) return "Sending ...";
    const auto& rows = controller_.rows();
    if (std::any_of(rows.begin(), rows.end(), [this](const auto& row) {
          return row.axis == *controller_.under_test() && row.stage == DatumStage::failed;
        }))
      return "The routine of this axis has failed: the unit ends it, then says why.";
    if (controller_.referencing())
      return fmt::format("The emulated machine references axis {} ...", letter_of(*controller_.under_test()));
    return call_to_reference(*controller_.under_test());
  }
};

}  // namespace

std::unique_ptr<Screen> datum_test_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<DatumTestScreen>(std::move(connection));
}

}  // namespace ecs::app
