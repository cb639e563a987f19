// RECORD DATUM SEQUENCE: which axis, ten seconds with what the unit sees meanwhile, then the graph opens.

#include <fmt/format.h>

#include "app/screens/utility/machine_driver.hpp"
#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"
#include "commissioning/utility/datum_record_controller.hpp"

namespace ecs::app {
namespace {

constexpr int kDatumRecordAxisRow = 2;
constexpr int kProgressRow = 7;
constexpr const char* kDatumRecordExplained =
    "Ten seconds of one axis are recorded: speed, reference switch and marker. The unit only watches: the machine must "
    "be referenced by its own control while the bar runs, from some travel away from the switch and slowly enough that "
    "switch and marker come within the ten seconds. The graph opens by itself; the datuming parameters are read off "
    "there.";

class DatumRecordScreen final : public UtilityScreen<DatumRecordController> {
 public:
  using UtilityScreen::UtilityScreen;

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
                              controller_.referencing() ? std::string("The emulated machine is being referenced ...")
                              : controller_.emulator()
                                  ? fmt::format("REFERENCE AXIS {} NOW: g lets the emulated machine do it.", axis)
                                  : fmt::format("REFERENCE AXIS {} NOW, at the machine's own control.", axis),
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

  [[nodiscard]] bool advance() override {
    const bool moved = driver_.advance();
    return UtilityScreen::advance() || moved;
  }
  [[nodiscard]] Step leave() override { return driver_.stop() ? stay() : UtilityScreen::leave(); }

  void on_command(const Key& key) override {
    if (is_letter(key, U'g')) controller_.reference();
    if (is_letter(key, U'j')) driver_.ask(prompt_, controller_.unit().watched, controller_.message());
    if (controller_.busy()) return;
    if (choose_axis(place_, key, controller_.unit().axes(), kDatumRecordAxisRow + 2)) return;
    if (key.name == Key::Name::enter && unit_integrates())
      asking_.ask(controller_.question(chosen()), [this, axis = chosen()] { controller_.start(axis); });
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (asking_.active()) return {{"y", "record"}, {"n", "not now"}};
    if (prompt_.active()) return prompt_.keys();
    const bool drives = MachineDriver::can_drive(controller_.unit().watched);
    if (controller_.busy()) {
      std::vector<KeyHelp> keys{{"Esc", "give up"}};
      if (controller_.emulator()) keys.insert(keys.begin(), {"g", "reference the emulated machine"});
      if (drives) keys.push_back(MachineDriver::key());
      return keys;
    }
    std::vector<KeyHelp> keys{{"Enter", "record"}, {"up/down x y z", "axis"}, {"Esc", "back"}};
    if (drives) keys.insert(keys.begin() + 2, MachineDriver::key());
    return keys;
  }

  [[nodiscard]] std::string help() const override { return kDatumRecordExplained; }

  [[nodiscard]] std::unique_ptr<Screen> opens_by_itself() override {
    auto record = controller_.take();
    return record ? datum_view_screen(std::move(record)) : nullptr;
  }

 private:
  [[nodiscard]] Axis chosen() const { return chosen_axis(place_, controller_.unit().axes()); }

  ListPlace place_;
  MachineDriver driver_;
};

}  // namespace

std::unique_ptr<Screen> datum_record_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<DatumRecordScreen>(std::move(connection));
}

}  // namespace ecs::app
