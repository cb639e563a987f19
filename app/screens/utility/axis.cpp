// SET AXIS POSITION: the axes with what the unit shows for them, live; a position is typed, asked for, set. OUTPUT
// COMPENSATION VALUE: axis, value, relay shown big, what moved beside it; steps, everything off on one key.
#include "commissioning/utility/axis.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"

namespace ecs::app {
namespace {

constexpr int kPositionAxisRow = 2;
constexpr int kPositionPromptRow = 7;
constexpr const char* kPositionExplained =
    "The unit adds up the counts of an axis's transducer. Here the number it shows for an axis is set to any value, "
    "and it counts on from there. Set an axis to 0, move it by a known distance and compare: a wrong sign is the "
    "wiring or the sign of the position feedback scaling factor, a wrong length its size, a number that does not "
    "change the transducer or its module. Nothing moves by this, and no axis becomes referenced.";

class PositionScreen final : public DrivingScreen<PositionController> {
 public:
  using DrivingScreen::DrivingScreen;

  [[nodiscard]] std::string title() const override { return "SET AXIS POSITION"; }
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_unit_row(canvas, inside, 0, controller_.unit());
    draw_axis_rows(canvas, inside, kPositionAxisRow, controller_.unit(), chosen());
    if (!prompt_.active())
      canvas.text(inside, kPositionPromptRow, 0,
                  controller_.busy() ? "Sending ..."
                  : driver_.running()
                      ? "The emulated machine moves; Esc stops it."
                      : fmt::format("Enter sets what the unit shows for axis {}.", letter_of(chosen())));
    int row = kPositionPromptRow + 2;
    row += canvas.paragraph(inside, row, kPositionExplained, Tone::faint) + 1;
    const auto& done = controller_.done();
    if (!done.empty()) canvas.text(inside, row++, 0, "Set here, newest first (u takes the first back):", Tone::faint);
    for (auto it = done.rbegin(); it != done.rend() && row < inside.rows - 3; ++it)
      canvas.text(inside, row++, 2,
                  fmt::format("{}  {:>13.4f} mm, was {:.4f} mm", letter_of(it->axis), it->after_mm, it->before_mm));
    draw_message(canvas, {inside.row + inside.rows - 2, inside.column, 2, inside.columns}, controller_.message());
  }

  void on_command(const Key& key) override {
    if (choose_axis(place_, key, controller_.unit().axes(), kPositionAxisRow + 2)) return;
    if (key.name == Key::Name::enter && !controller_.busy() && unit_integrates()) type();
    if (is_letter(key, U'j')) ask_to_drive();
    if (is_letter(key, U'u') || (key.name == Key::Name::control && key.letter == U'z')) controller_.undo();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (asking_.active()) return {{"y", "set it"}, {"n", "leave it"}};
    if (prompt_.active()) return prompt_.keys();
    return with_driver({{"Enter", "set the position"}, {"up/down x y z", "axis"}, {"u", "undo"}, {"Esc", "back"}}, 2);
  }

  [[nodiscard]] std::string help() const override {
    return std::string(kPositionExplained) +
           " The unit takes it in integration mode only. u undoes what was set last: the axis is shifted back by the "
           "same amount, also if it has moved since. With the bundled emulator j drives its machine.";
  }

 private:
  [[nodiscard]] int prompt_row(const Area& /*inside*/) const override { return kPositionPromptRow; }

  void type() {
    const Axis axis = chosen();
    prompt_.ask(fmt::format("New position of {}, mm:", letter_of(axis)), Prompt::Kind::number, "",
                [this, axis](const std::string& typed) {
                  const auto position = PositionController::position_in(typed);
                  if (!position) return position.error().message;
                  asking_.ask(controller_.question(axis, *position),
                              [this, axis, mm = *position] { controller_.set(axis, mm); });
                  return std::string();
                });
  }
};

}  // namespace

std::unique_ptr<Screen> position_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<PositionScreen>(std::move(connection));
}

namespace {

constexpr int kOutputAxisRow = 2;
constexpr int kBoxRow = 7;
constexpr int kOutputPromptRow = 13;  ///< a proposal or an explanation follows
constexpr const char* kScaleExplained =
    "To set the output scale: put a dial gauge on the axis and zero it, close the relay (r), step the value to the "
    "size of your largest error, press m and type what the gauge shows. The scale and polarity that follow are "
    "proposed here. The converter alone is tested with the relay open: measure its voltage.";

/// What the box says, and how.
ListRow relay_row(const OutputController& controller) {
  const OutputSetting& now = controller.setting();
  const char axis = letter_of(now.axis);
  const std::string um = um_text(now.um);
  if (!controller.unit().fresh)
    return {now.at_rest() ? std::string("RELAY NOT KNOWN  no answer: what the unit puts out is not known")
                          : fmt::format("RELAY NOT KNOWN  no answer; axis {} was sent {}, relay {}", axis, um,
                                        now.relay ? "closed" : "open"),
            Tone::bad};
  if (now.relay) return {fmt::format("RELAY CLOSED     axis {} is moved by {}", axis, um), Tone::bad};
  if (now.um != 0.0)
    return {fmt::format("RELAY OPEN       {} at the converter of {}, nothing moves", um, axis), Tone::warning};
  return {"RELAY OPEN       nothing is put out, nothing moves", Tone::good};
}

void draw_relay_box(Canvas& canvas, const Area& box, const OutputController& controller) {
  const ListRow row = relay_row(controller);
  canvas.frame(box, {}, row.tone);
  canvas.text({box.row + 1, box.column + 2, 1, box.columns - 4}, 0, 0, row.text, row.tone);
}

class OutputScreen final : public UtilityScreen<OutputController> {
 public:
  using UtilityScreen::UtilityScreen;

  [[nodiscard]] std::string title() const override { return "OUTPUT COMPENSATION VALUE"; }
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_unit_row(canvas, inside, 0, controller_.unit());
    draw_axis_rows(canvas, inside, kOutputAxisRow, controller_.unit(), controller_.axis());
    draw_relay_box(canvas, {inside.row + kBoxRow, inside.column, 3, inside.columns}, controller_);
    const auto* seen = controller_.unit().axis(controller_.axis());
    const auto moved = controller_.moved_um();
    canvas.text(
        inside, kBoxRow + 3, 0,
        fmt::format("put out    {:>12}  {:>8}    step {:g} um (< > another step)", um_text(controller_.setting().um),
                    seen == nullptr ? "" : fmt::format("{} counts", seen->output_counts), controller_.step_um()));
    canvas.text(inside, kBoxRow + 4, 0,
                moved ? fmt::format("moved      {:>+9.2f} um  since the output was at rest, by the transducer of {}",
                                    *moved, letter_of(controller_.axis()))
                      : std::string("moved              -      shown from the first value on"));
    canvas.text(
        inside, kBoxRow + 5, 0,
        fmt::format("at most    {:>9g} um  output scale {:g} counts/um, polarity {:+d}{}",
                    controller_.parameters().output_limit_um, controller_.parameters().output_scale_counts_per_um,
                    static_cast<int>(controller_.parameters().compensation_polarity),
                    controller_.parameters_known() ? "" : " (default)"));
    if (!prompt_.active() && controller_.busy()) canvas.text(inside, kOutputPromptRow, 0, "Sending ...");
    canvas.paragraph({inside.row, inside.column, inside.rows - 3, inside.columns}, kOutputPromptRow + 1,
                     proposal_.empty() ? kScaleExplained : proposal_, proposal_.empty() ? Tone::faint : Tone::strong);
    draw_message(canvas, {inside.row + inside.rows - 3, inside.column, 3, inside.columns}, controller_.message());
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (asking_.active()) return {{"y", "the axis may move"}, {"n", "leave it"}};
    if (prompt_.active()) return prompt_.keys();
    return {{"o", "ALL OFF"},
            {"Enter", "value"},
            {"+ -", "step"},
            {"r", controller_.setting().relay ? "open relay" : "relay"},
            {"x y z", "axis"},
            {"m", "measured"},
            {"< >", "step size"},
            {"Esc", controller_.setting().at_rest() ? "back" : "all off"},
            {"Space", "ALL OFF as well"}};
  }

  [[nodiscard]] std::string help() const override {
    return std::string(
               "A value in um is put on the D/A converter of one axis; with the relay closed the axis moves by it. One "
               "axis at a time; the relay is asked for, and so is every typed value while it is closed. o, Space, and "
               "Esc switch everything off; a second Esc leaves. If the link is lost the unit opens its relays by "
               "itself after 60 s without a question. ") +
           kScaleExplained;
  }

 private:
  [[nodiscard]] int prompt_row(const Area& /*inside*/) const override { return kOutputPromptRow; }

  [[nodiscard]] Step leave() override {
    if (!controller_.busy() && (controller_.setting().at_rest() || !controller_.unit().fresh)) return back();
    controller_.off();
    return stay();
  }

  void on_command(const Key& key) override {
    if (is_letter(key, U'o') || is_letter(key, U' ')) return controller_.off();
    if (key.name == Key::Name::up || key.name == Key::Name::down) choose_next(key.name == Key::Name::down ? 1 : -1);
    if (const auto axis = axis_of_key(key)) controller_.choose(*axis);
    const auto axes = controller_.unit().axes();
    if (const auto k = axis_clicked(key, kOutputAxisRow + 2, static_cast<int>(axes.size())))
      controller_.choose(axes[static_cast<std::size_t>(*k)]);
    if (key.name == Key::Name::enter && unit_integrates()) type_value();
    if (is_letter(key, U'+') || is_letter(key, U'=')) controller_.step(1);
    if (is_letter(key, U'-')) controller_.step(-1);
    if (is_letter(key, U'>') || is_letter(key, U'.')) controller_.resize_step(1);
    if (is_letter(key, U'<') || is_letter(key, U',')) controller_.resize_step(-1);
    if (is_letter(key, U'r') && unit_integrates()) toggle_relay();
    if (is_letter(key, U'm')) type_measured();
  }

  void type_value() {
    prompt_.ask(fmt::format("Value for {}, um:", letter_of(controller_.axis())), Prompt::Kind::number, "",
                [this](const std::string& typed) {
                  const auto um = controller_.value_in(typed);
                  if (!um) return um.error().message;
                  if (controller_.setting().relay)
                    asking_.ask(controller_.question(*um), [this, um = *um] { controller_.set(um, true); });
                  else
                    controller_.set(*um, false);
                  return std::string();
                });
  }

  void type_measured() {
    const auto moved = controller_.moved_um();
    if (controller_.setting().um == 0.0 || !controller_.setting().relay) {
      controller_.message().say(
          "Close the relay (r) and put a value out (Enter, + -) first: then measure what the axis does.",
          Tone::warning);
      return;
    }
    prompt_.ask(fmt::format("Measured movement of {}, um:", letter_of(controller_.axis())), Prompt::Kind::number,
                moved ? fmt::format("{:.2f}", *moved) : "", [this](const std::string& typed) {
                  const auto proposal = controller_.scale_from_measured(typed);
                  if (!proposal) return proposal.error().message;
                  proposal_ = proposal->sentence;
                  return std::string();
                });
  }

  void toggle_relay() {
    const OutputSetting now = controller_.setting();
    if (now.relay)
      controller_.set(now.um, false);
    else
      asking_.ask(controller_.question(now.um), [this, um = now.um] { controller_.set(um, true); });
  }

  void choose_next(int by) {
    const auto axes = controller_.unit().axes();
    const auto at = std::find(axes.begin(), axes.end(), controller_.axis());
    if (at == axes.end()) return;
    const auto k = std::clamp(static_cast<int>(at - axes.begin()) + by, 0, static_cast<int>(axes.size()) - 1);
    controller_.choose(axes[static_cast<std::size_t>(k)]);
  }

  std::string proposal_;  ///< from the last measurement
};

}  // namespace

std::unique_ptr<Screen> output_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<OutputScreen>(std::move(connection));
}

}  // namespace ecs::app
