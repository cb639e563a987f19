// SET AXIS POSITION: the axes with what the unit shows for them, live; a position is typed, asked for, set, taken back.
// OUTPUT COMPENSATION VALUE: one axis's value and relay shown big, what moved by it; steps, everything off on one key.
// Whoever leaves it leaves the unit at rest as far as the link allows.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"
#include "base/text.hpp"
#include "commissioning/unit/transfer.hpp"
#include "commissioning/unit/utility_work.hpp"

namespace ecs::app {
namespace {

constexpr double kLargest_mm = 1e6;  ///< as the unit takes them
constexpr const char* kPositionExplained =
    "The unit counts the pulses of an axis's transducer. This screen sets the displayed position of an axis to any "
    "value, from which counting continues. Set an axis to 0, move it by a known distance and compare. If the sign is "
    "wrong, check the wiring or the sign of the position scale (E.C.S. PARAMETERS, page 1). If the length is wrong, "
    "check the size of the position scale. If the position does not change, check the transducer or its module. "
    "Nothing moves, and no axis becomes referenced.";

/// A position that was preset; positions as the unit showed them.
struct PresetPosition {
  Axis axis = Axis::X;
  double before_mm = 0.0;
  double after_mm = 0.0;
};

class PositionScreen final : public AxesScreen {
 public:
  explicit PositionScreen(std::shared_ptr<UnitConnection> connection) : AxesScreen(std::move(connection)) {
    const auto take_back = [this] { undo(); };
    keys_ = {{"Enter", "set the position", [this] { type(); }},
             {"up/down x y z", "axis"},
             drive_row(),
             {"u", "undo", take_back},
             {"Ctrl-Z", "", take_back},
             {"Esc", "back"}};
  }

  [[nodiscard]] std::string title() const override { return "SET AXIS POSITION"; }
  [[nodiscard]] std::string help() const override {
    return std::string(kPositionExplained) +
           " The unit accepts this in integration mode only. Press u to undo the last setting: the display is shifted "
           "back by the same amount, even if the axis has moved since. With the bundled emulator, press j to drive its "
           "machine.";
  }

 private:
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_unit_row(canvas, inside);
    draw_axis_rows(canvas, inside, chosen());
    if (!prompt_.active())
      canvas.text(inside, kCallRow, 0,
                  busy() ? "Sending ..."
                  : driver_.running()
                      ? "The emulated machine is moving; press Esc to stop."
                      : fmt::format("Press Enter to set the displayed position of axis {}.", letter_of(chosen())));
    int row = kCallRow + 2;
    row += canvas.paragraph(inside, row, kPositionExplained, Tone::faint) + 1;
    if (!done_.empty())
      canvas.text(inside, row++, 0, "Set here, newest first (press u to undo the newest):", Tone::faint);
    for (auto it = done_.rbegin(); it != done_.rend() && row < inside.rows - 3; ++it)
      canvas.text(inside, row++, 2,
                  fmt::format("{}  {:>13} {}, was {}", letter_of(it->axis), shown_in().position(it->after_mm),
                              shown_in().length, shown_in().with_unit(it->before_mm)));
    draw_message(canvas, last_rows(inside, 2), message_);
  }

  void on_other_key(const Key& key) override { (void)choose_axis(key); }
  [[nodiscard]] int prompt_row(const Area& /*inside*/) const override { return kCallRow; }

  void restarted() override {
    if (!done_.empty())
      message_.say("The unit was restarted: it counts from 0 again, and the positions set here are lost.",
                   Tone::warning);
    done_.clear();
  }

  void type() {
    if (busy() || !unit_integrates()) return;
    const Axis axis = chosen();
    prompt_.ask(fmt::format("New position of {}, {}:", letter_of(axis), shown_in().length), Prompt::Kind::number, "",
                [this, axis, &unit = shown_in()](const std::string& typed) -> std::string {
                  const auto number = number_in(typed);
                  if (!number) return fmt::format("expected a position in {}, found \"{}\"", unit.length, typed);
                  const double mm = *number * unit.mm;
                  if (std::abs(mm) > kLargest_mm)
                    return fmt::format("expected a position within +/-{:.0f} {}, found {}", kLargest_mm / unit.mm,
                                       unit.length, typed);
                  asking_.ask(question(axis, mm), [this, axis, mm] { start(axis, mm, std::nullopt); });
                  return {};
                });
  }

  [[nodiscard]] Question question(Axis axis, double position_mm) const {
    const protocol::AxisSample* now = unit_.axis(axis);
    const std::string shown =
        now == nullptr ? "" : fmt::format(" It shows {} now.", shown_in().with_unit(now->position_mm));
    const std::string reference =
        now != nullptr && now->referenced
            ? " The axis stays marked as referenced, but its positions are no longer machine coordinates: reference "
              "the machine again before relying on them (compensation mode waits for this)."
            : " The axis does not become referenced by this: only its reference sequence does that.";
    return {fmt::format("Show {} for axis {}?", shown_in().with_unit(position_mm), letter_of(axis)),
            "Nothing moves: only the number changes, and the unit continues counting from there." + shown + reference,
            "set it", "cancel"};
  }

  void undo() {
    if (done_.empty()) return message_.say("Nothing to undo: no position has been set here.", Tone::warning);
    const PresetPosition& last = done_.back();
    start(last.axis, 0.0, last.before_mm - last.after_mm);
  }

  /// @param shift_mm  of an undo: the axis may have moved since, so it is shifted from where it stands
  void start(Axis axis, double position_mm, std::optional<double> shift_mm) {
    if (busy()) return;
    const auto work = [connection = connection_, axis, position_mm, shift_mm](JobControl& control) {
      return connection->with_link(control, [&](UnitLink& link) -> Result<PresetPosition> {
        ECS_TRY(before, link.client().monitor());
        const double shown_mm = before.axes[index_of(axis)].position_mm;
        const double wanted_mm = shift_mm ? shown_mm + *shift_mm : position_mm;
        ECS_DO(link.client().set_axis_position(axis, wanted_mm));
        return PresetPosition{axis, shown_mm, wanted_mm};
      });
    };
    task_.start("setting the position", work,
                [this, is_undo = shift_mm.has_value()](const Result<PresetPosition>& set) {
                  if (!set) return message_.say(set.error());
                  if (is_undo)
                    done_.pop_back();
                  else
                    done_.push_back(*set);
                  note_on_unit(*connection_,
                               {"utility", "position", std::string(1, letter_of(set->axis)), shortest(set->after_mm)});
                  message_.say(fmt::format("Axis {} {} {}; it showed {}.{}", letter_of(set->axis),
                                           is_undo ? "is back at" : "now shows", shown_in().with_unit(set->after_mm),
                                           shown_in().with_unit(set->before_mm), is_undo ? "" : " Press u to undo."));
                });
  }

  std::vector<PresetPosition> done_;  ///< that can be undone, newest last
};

constexpr int kOutputPromptRow = 13;  ///< a proposal or an explanation follows
constexpr std::array<double, 8> kSteps_um{0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0};
constexpr auto kRenewal = std::chrono::seconds(20);         ///< a third of the time that the unit holds a relay
constexpr auto kSettling = std::chrono::milliseconds(100);  ///< from a command to a sample that shows it
constexpr const char* kScaleExplained =
    "To set the output scale: mount a dial gauge on the axis and zero it. Close the relay (r) and step the value to "
    "the size of your largest error. Press m and type the gauge reading. The resulting scale and polarity are proposed "
    "here. To test the converter alone, keep the relay open and measure its voltage.";

/// What the unit puts out.
struct OutputSetting {
  Axis axis = Axis::X;
  double um = 0.0;
  bool relay = false;
  [[nodiscard]] bool at_rest() const { return um == 0.0 && !relay; }
  friend bool operator==(const OutputSetting&, const OutputSetting&) = default;
};

class OutputScreen final : public AxesScreen {
 public:
  explicit OutputScreen(std::shared_ptr<UnitConnection> connection) : AxesScreen(std::move(connection)) {
    setting_.axis = chosen();
    follow_unit();
    const auto all_off = [this] { off(); };
    const auto at_rest = [this] { return setting_.at_rest(); };
    keys_ = {{"o", "ALL OFF", all_off},
             {"Enter", "value", [this] { type_value(); }},
             {"+ -", "step"},
             {"+ =", "", [this] { step(1); }},
             {"-", "", [this] { step(-1); }},
             {"r", "relay", [this] { toggle_relay(); }, [this] { return !setting_.relay; }},
             {"r", "open relay", [this] { toggle_relay(); }, [this] { return setting_.relay; }},
             {"x y z", "axis"},
             {"m", "measured", [this] { type_measured(); }},
             {"< >", "step size"},
             {"> .", "", [this] { step_ = std::min(step_ + 1, kSteps_um.size() - 1); }},
             {"< ,", "", [this] { step_ -= step_ > 0 ? 1 : 0; }},
             {"Esc", "back", {}, at_rest},
             {"Esc", "all off", {}, [at_rest] { return !at_rest(); }},
             {"Space", "ALL OFF as well", all_off}};
  }
  OutputScreen(const OutputScreen&) = delete;
  OutputScreen& operator=(const OutputScreen&) = delete;
  ~OutputScreen() override;  ///< waits until the unit has heard that everything is off, if there is a link

  [[nodiscard]] std::string title() const override { return "OUTPUT COMPENSATION VALUE"; }
  [[nodiscard]] std::string help() const override {
    return std::string(
               "Outputs a value in um at the D/A converter of one axis. With the relay closed, the axis moves by this "
               "value. Only one axis at a time. Closing the relay needs confirmation, and so does every value typed "
               "while "
               "it is closed. Press o, Space or Esc to switch everything off; a second Esc closes the screen. If the "
               "link is lost, the unit opens its relays after 60 s without a request. ") +
           kScaleExplained;
  }

 private:
  // --- the picture
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_unit_row(canvas, inside);
    draw_axis_rows(canvas, inside, setting_.axis);
    const ListRow relay = relay_row();
    canvas.frame({inside.row + kCallRow, inside.column, 3, inside.columns}, {}, relay.tone);
    canvas.text({inside.row + kCallRow + 1, inside.column + 2, 1, inside.columns - 4}, 0, 0, relay.text, relay.tone);
    const auto* seen = unit_.axis(setting_.axis);
    const auto moved = moved_um();
    canvas.text(inside, kCallRow + 3, 0,
                fmt::format("output     {:>12}  {:>8}    step {:g} um (< > another step)", um_text(acting_um()),
                            seen == nullptr ? "" : fmt::format("{} counts", seen->output_counts), kSteps_um[step_]));
    canvas.text(inside, kCallRow + 4, 0,
                moved ? fmt::format("moved      {:>+9.2f} um  since the output was 0, by the transducer of {}", *moved,
                                    letter_of(setting_.axis))
                      : std::string("moved              -      shown after the first value"));
    canvas.text(
        inside, kCallRow + 5, 0,
        fmt::format("at most    {:>9g} um  output scale {:g} counts/um, polarity {:+d}{}", parameters().output_limit_um,
                    parameters().output_scale_counts_per_um, static_cast<int>(parameters().compensation_polarity),
                    parameters_known_ ? "" : " (default)"));
    if (!prompt_.active() && busy()) canvas.text(inside, kOutputPromptRow, 0, "Sending ...");
    canvas.paragraph({inside.row, inside.column, inside.rows - 3, inside.columns}, kOutputPromptRow + 1,
                     proposal_.empty() ? kScaleExplained : proposal_, proposal_.empty() ? Tone::faint : Tone::strong);
    draw_message(canvas, last_rows(inside, 3), message_);
  }

  /// The relay of the newest sample, not the one that was commanded: another mode closes it too.
  [[nodiscard]] ListRow relay_row() const {
    const char axis = letter_of(setting_.axis);
    const std::string um = um_text(acting_um());
    const auto* seen = unit_.axis(setting_.axis);
    if (!unit_.fresh || seen == nullptr)
      return {setting_.at_rest() ? std::string("RELAY NOT KNOWN  no answer: the output of the unit is not known")
                                 : fmt::format("RELAY NOT KNOWN  no answer; axis {} was sent {}, relay {}", axis, um,
                                               setting_.relay ? "closed" : "open"),
              Tone::bad};
    if (seen->relay_closed)
      return {fmt::format("RELAY CLOSED     axis {} is moved by {}{}", axis, um,
                          unit_.integrating() ? "" : ", its compensation"),
              Tone::bad};
    if (setting_.um != 0.0)
      return {fmt::format("RELAY OPEN       {} at the converter of {}, nothing moves", um, axis), Tone::warning};
    return {"RELAY OPEN       no output, nothing moves", Tone::good};
  }

  /// The value that was commanded, else that of the unit: its compensation in another mode than integration.
  [[nodiscard]] double acting_um() const {
    const auto* seen = unit_.axis(setting_.axis);
    return seen == nullptr || !setting_.at_rest() ? setting_.um : seen->compensation_um;
  }
  [[nodiscard]] int prompt_row(const Area& /*inside*/) const override { return kOutputPromptRow; }
  [[nodiscard]] const AxisParameters& parameters() const { return parameters_.axes[index_of(setting_.axis)]; }
  /// The axis's transducer since the output was at rest; nothing before anything was put out.
  [[nodiscard]] std::optional<double> moved_um() const {
    const auto* now = unit_.axis(setting_.axis);
    if (!rest_mm_ || now == nullptr) return std::nullopt;
    return 1e3 * (now->position_mm - *rest_mm_);
  }

  // --- keys
  [[nodiscard]] Step leave() override {
    if (!busy() && (setting_.at_rest() || !unit_.fresh)) return back();
    off();
    return stay();
  }

  void on_other_key(const Key& key) override {
    place_.selected = static_cast<int>(index_among_axes());
    if (choose_axis(key)) choose(chosen());
  }

  [[nodiscard]] std::ptrdiff_t index_among_axes() const {
    const auto axes = unit_.axes();
    return std::find(axes.begin(), axes.end(), setting_.axis) - axes.begin();
  }

  /// Only at rest: otherwise the message says what to do.
  void choose(Axis axis) {
    if (axis == setting_.axis || busy()) return;
    if (!setting_.at_rest())
      return message_.say(fmt::format("Axis {} still has an output of {}: press o first, one axis at a time.",
                                      letter_of(setting_.axis), um_text(setting_.um)),
                          Tone::warning);
    setting_.axis = axis;
    rest_mm_.reset();
  }

  void type_value() {
    if (!unit_integrates()) return;
    prompt_.ask(
        fmt::format("Value for {}, um:", letter_of(setting_.axis)), Prompt::Kind::number, "",
        [this](const std::string& typed) -> std::string {
          const auto um = number_in(typed);
          if (!um) return fmt::format("expected a value in um, found \"{}\"", typed);
          if (std::abs(*um) > parameters().output_limit_um)
            return fmt::format(
                "{} is beyond the output limit of axis {}, {:g} um (a parameter of the unit): the unit would refuse it",
                um_text(*um), letter_of(setting_.axis), parameters().output_limit_um);
          put_out(*um, setting_.relay);
          return {};
        });
  }

  void type_measured() {
    const auto moved = moved_um();
    if (setting_.um == 0.0 || !setting_.relay)
      return message_.say(
          "First close the relay (r) and output a value (Enter, + -), then measure the motion of the axis.",
          Tone::warning);
    prompt_.ask(fmt::format("Measured movement of {}, um:", letter_of(setting_.axis)), Prompt::Kind::number,
                moved ? fmt::format("{:.2f}", *moved) : "", [this](const std::string& typed) -> std::string {
                  const auto measured_um = number_in(typed);
                  if (!measured_um) return fmt::format("expected a length in um, found \"{}\"", typed);
                  const auto proposal = scale_from(parameters(), setting_.axis, setting_.um, *measured_um);
                  if (!proposal) return proposal.error().message;
                  proposal_ = proposal->sentence;
                  return {};
                });
  }

  void toggle_relay() {
    if (unit_integrates()) put_out(setting_.um, !setting_.relay);
  }

  /// Asks first where the relay is closed by it, or is closed already.
  void put_out(double um, bool relay) {
    if (!relay) return set(um, false);
    asking_.ask(question(um), [this, um] { set(um, true); });
  }

  /// What closing the relay with this value, or this value with the relay closed, moves.
  [[nodiscard]] Question question(double um) const {
    const char axis = letter_of(setting_.axis);
    const double by = um - (setting_.relay ? setting_.um : 0.0);
    return {by == 0.0 ? fmt::format("Close the relay of axis {}?", axis)
                      : fmt::format("Move axis {} by {}?", axis, um_text(by)),
            fmt::format(
                "The relay connects the D/A converter with the servo of {}: the axis moves by about {} at once{}. "
                "With a wrong output scale it moves by another amount, with a wrong polarity the other way. After "
                "that, + and - move it without confirmation, at most to {:g} um either way. Keep clear of the machine.",
                axis, um_text(by),
                by > 0.0   ? " (towards larger coordinates)"
                : by < 0.0 ? " (towards smaller coordinates)"
                           : ", plus the zero offset of the D/A converter, if it has one",
                parameters().output_limit_um),
            "move it", "cancel"};
  }

  void step(int direction) {
    const double limit = parameters().output_limit_um;
    const double wanted = std::round(1e3 * (setting_.um + direction * kSteps_um[step_])) / 1e3;
    if (std::abs(wanted) <= limit) return set(wanted, setting_.relay);
    message_.say(
        fmt::format("Axis {} is at its output limit of {:g} um (a parameter of the unit): no further this way.",
                    letter_of(setting_.axis), limit),
        Tone::warning);
  }

  // --- work
  struct Taken {
    OutputSetting setting;
    std::optional<protocol::MonitorSample> before{};  ///< just before the command
  };

  template <class Work>
  void start(const std::string& label, Work work) {
    task_.start(label, std::move(work), [this](const Result<Taken>& taken) {
      if (taken || !off_wanted_) take(taken);
      if (off_wanted_) off();
    });
  }

  void set(double um, bool relay) {
    if (!busy()) send("setting the output", {setting_.axis, um, relay});
  }

  void send(const std::string& label, const OutputSetting& wanted) {
    start(label, [connection = connection_, wanted](JobControl& control) {
      return connection->with_link(control, [&](UnitLink& link) -> Result<Taken> {
        ECS_TRY(before, link.client().monitor());
        ECS_DO(link.client().output_compensation(wanted.axis, wanted.um, wanted.relay));
        return Taken{wanted, before};
      });
    });
  }

  /// Every output 0, every relay open; what is under way is given up for it.
  void off() {
    off_wanted_ = busy();
    if (busy()) return task_.cancel();
    start("switching off", [connection = connection_, axis = setting_.axis](JobControl& control) {
      return connection->with_link_to_any_unit(control, [&](UnitLink& link) -> Result<Taken> {
        ECS_DO(link.client().output_off());
        ECS_TRY(seen, link.client().monitor());
        for (const Axis a : kAllAxes)
          if (seen.axes[index_of(a)].relay_closed)
            return problem(ProblemKind::link,
                           "the unit answers that all is off, but shows the relay of {} closed: press o again; if it "
                           "stays, use the emergency stop",
                           letter_of(a));
        return Taken{{axis, 0.0, false}};
      });
    });
  }

  void take(const Result<Taken>& taken) {
    if (!taken) return message_.say(taken.error());
    sent_at_ = std::chrono::steady_clock::now();
    const OutputSetting& now = taken->setting;
    if (now == setting_ && now.relay) return;  // renewed
    if (setting_.at_rest() && taken->before) rest_mm_ = taken->before->axes[index_of(now.axis)].position_mm;
    setting_ = now;
    std::vector<std::string> words{"utility", "output"};
    if (now.at_rest())
      words.emplace_back("--off");
    else
      words.insert(words.end(), {std::string(1, letter_of(now.axis)), shortest(now.um)});
    if (now.relay) words.insert(words.end(), {"--relay", "--yes"});
    note_on_unit(*connection_, std::move(words));
    message_.say(now.at_rest() ? std::string("Every output is 0, every relay is open.")
                               : fmt::format("Axis {}: output {}, relay {}. Press o to end.", letter_of(now.axis),
                                             um_text(now.um), now.relay ? "closed" : "open"));
  }

  /// The unit opens a relay 60 s after the last command: what is shown as put out is commanded again in time.
  void renew() {
    if (!setting_.relay || busy() || std::chrono::steady_clock::now() - sent_at_ < kRenewal) return;
    sent_at_ = std::chrono::steady_clock::now();
    send("keeping the output", setting_);
  }

  // --- what the unit shows
  [[nodiscard]] bool look() override {
    bool changed = AxesScreen::look();
    if (changed) follow_unit();
    renew();
    start_reading_parameters();
    changed = reading_.advance() || changed;
    return changed;
  }

  void lost() override {
    if (!setting_.at_rest())
      message_.say(
          "The link is lost: the command to open the relay did not reach the unit. It opens every relay after 60 s "
          "without a request; the emergency stop is quicker.",
          Tone::bad);
  }

  void restarted() override {
    const auto* seen = unit_.axis(setting_.axis);
    if (!setting_.at_rest() && seen != nullptr && !seen->relay_closed)
      message_.say("The unit was restarted: every output is 0, every relay is open.", Tone::warning);
    setting_ = {setting_.axis, 0.0, false};
    rest_mm_.reset();
  }

  /// What another host, or this one before, left switched on; what the unit has ended on its own.
  void follow_unit() {
    if (busy() || !unit_.fresh || unit_.watched.newest_at < sent_at_ + kSettling) return;
    if (const auto* s = unit_.axis(setting_.axis); s != nullptr && setting_.relay && !s->relay_closed) {
      setting_ = {setting_.axis, 0.0, false};
      message_.say("The unit has opened the relay: a restart, another mode, a fault, or another host.", Tone::warning);
    }
    follow_value();
    if (!setting_.at_rest() || !unit_.integrating()) return;
    for (const Axis a : unit_.axes())
      if (const auto* s = unit_.axis(a); s != nullptr && (s->relay_closed || s->output_counts != 0))
        setting_ = {a, s->compensation_um, s->relay_closed};
  }

  /// The value that acts is the one shown, and the one that the next step starts from.
  void follow_value() {
    const auto* s = unit_.axis(setting_.axis);
    if (s == nullptr || setting_.at_rest() || !unit_.integrating()) return;
    const double count_um = 1.0 / std::max(1e-9, std::abs(parameters().output_scale_counts_per_um));
    if (std::abs(s->compensation_um - setting_.um) <= count_um + 1e-6) return;
    setting_.um = s->compensation_um;
    message_.say(fmt::format("Another host has changed the output of axis {}: {} now. Press o to end.",
                             letter_of(setting_.axis), um_text(setting_.um)),
                 Tone::bad);
  }

  void start_reading_parameters() {
    if (reading_.running() || busy() || !unit_.watched.open || unit_.watched.opened_at == parameters_of_) return;
    parameters_of_ = unit_.watched.opened_at;
    const auto read = [connection = connection_](JobControl& control) {
      return connection->with_link(control, [](UnitLink& link) { return receive_parameters(link.client()); });
    };
    reading_.start("reading the parameters", read, [this](const Result<UnitParameters>& parameters) {
      parameters_known_ = parameters.has_value();
      parameters_ = parameters.value_or(UnitParameters{});
    });
  }

  OutputSetting setting_;  ///< as the unit took it last
  std::size_t step_ = 2;   ///< place in the row of steps
  std::optional<double> rest_mm_;
  std::string proposal_;  ///< from the last measurement
  UnitParameters parameters_;
  bool parameters_known_ = false;                          ///< read from the unit; else its defaults
  std::chrono::steady_clock::time_point parameters_of_{};  ///< the link that they were asked on
  std::chrono::steady_clock::time_point sent_at_{};        ///< when the unit took `setting_`
  bool off_wanted_ = false;
  TaskRunner reading_;  ///< the unit's parameters
};

OutputScreen::~OutputScreen() {
  task_.cancel();
  task_.finish();
  if (setting_.at_rest()) return;
  JobControl control;
  const bool off =
      connection_->snapshot().open &&
      connection_->with_link_to_any_unit(control, [](UnitLink& link) { return link.client().output_off(); })
          .has_value();
  if (off) note_on_unit(*connection_, {"utility", "output", "--off"});
  if (!off && setting_.relay)
    leave_word(
        fmt::format("axis {}: the command to open its relay did not reach the unit. It opens it 60 s after the last "
                    "request; until then {:+g} um may act on the axis",
                    letter_of(setting_.axis), setting_.um));
}

}  // namespace

std::unique_ptr<Screen> position_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<PositionScreen>(std::move(connection));
}

std::unique_ptr<Screen> output_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<OutputScreen>(std::move(connection));
}

}  // namespace ecs::app
