// RECORD DATUM SEQUENCE: which axis, ten seconds with what the unit sees meanwhile, then the graph opens. TEST DATUM
// ROUTINE: the unit's own routine, axis after axis, with the stage in which each is; what failed and what to do next.
#include <algorithm>

#include <fmt/format.h>

#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/unit/utility_work.hpp"
#include "commissioning/utility/datum_view.hpp"

namespace ecs::app {
namespace {

/// What work on the link tells its screen while it has the link to itself.
struct DatumSeen {
  std::optional<protocol::MonitorSample> sample;
  std::optional<protocol::UnitStatus> status;
  std::vector<AxisTest> tests;  ///< that have ended
  std::string workshop;         ///< socket; empty: no emulator
  std::optional<Axis> axis;     ///< worked on
  bool running = false;         ///< the unit has answered that it is at it
  bool fetching = false;        ///< the command is done, its result is read out of the memory
};
using DatumLive = Reported<DatumSeen>;

void begin(DatumLive& live, const UnitLink& link, Axis axis) {
  live.change([&](DatumSeen& seen) {
    seen = {seen.sample, seen.status, std::move(seen.tests), link.workshop(), axis};
  });
}

/// One look over the link; what fails is left to the command that is under way.
void look_at(DatumLive& live, UnitLink& link, bool with_status) {
  const auto sample = link.client().monitor();
  std::optional<protocol::UnitStatus> status;
  if (with_status)
    if (auto read = link.client().status()) status = *read;
  live.change([&](DatumSeen& seen) {
    if (sample) seen.sample = *sample;
    if (status) seen.status = *status;
    seen.running = true;
  });
}

/// Work on the datum of axes while the control of the machine, or g the emulated one, references them.
class DatumScreen : public AxesScreen {
 protected:
  /// @param does, act  of Enter  @param chooses  the rows of keys that choose
  DatumScreen(std::shared_ptr<UnitConnection> connection, const char* does, std::function<Question()> asks,
              std::function<void()> starts, const std::vector<KeyRow>& chooses)
      : AxesScreen(std::move(connection)) {
    const auto idle = [this] { return !busy(); };
    const auto under_way = [this] { return busy(); };
    const auto ask = [this, asks = std::move(asks), starts = std::move(starts)] {
      if (unit_integrates()) asking_.ask(asks(), starts);
    };
    keys_ = {{"g", "reference the emulated machine", [this] { reference(); },
              [this] { return busy() && unit_.watched.emulator; }, true},
             {"Esc", "cancel", {}, under_way},
             {"Enter", does, ask, idle}};
    for (KeyRow row : chooses) {
      row.when = idle;
      keys_.push_back(std::move(row));
    }
    keys_.push_back(drive_row());
    keys_.push_back({"Esc", "back", {}, idle});
  }

  [[nodiscard]] bool look() override {
    const bool changed = AxesScreen::look();
    if (busy() && live_->changes() != live_changes_) {
      live_changes_ = live_->changes();
      const DatumSeen seen = live_->now();
      if (seen.sample) unit_.take(*seen.sample);
      follow(seen);
    }
    return reference_.advance() || changed || busy();
  }
  virtual void follow(const DatumSeen& seen) = 0;
  [[nodiscard]] Step leave() override {
    const bool stays = driver_.running() || busy();
    if (!driver_.stop()) {
      task_.cancel();
      reference_.cancel();
    }
    return stays ? stay() : back();
  }

  /// The bundled emulator's machine references the axis under way; the message says why not.
  void reference() {
    const DatumSeen seen = live_->now();
    if (!busy() || !seen.running || seen.fetching || !seen.axis)
      message_.say("Press Enter first, then g to reference the emulated machine.", Tone::warning);
    else if (seen.workshop.empty())
      message_.say("Only the bundled emulator can be referenced here. Reference the axis at the control.",
                   Tone::warning);
    else
      reference_now(seen);
  }
  virtual void reference_now(const DatumSeen& seen) = 0;

  [[nodiscard]] std::string hint_of_emulator() const {
    return unit_.watched.emulator ? " This is the emulator: press g to reference its machine." : "";
  }
  /// What a person does now.
  [[nodiscard]] std::string call_to_reference(Axis axis) const {
    return fmt::format(
        "REFERENCE AXIS {} NOW{}.", letter_of(axis),
        unit_.watched.emulator ? ": press g to reference the emulated machine" : ", at the machine's control");
  }
  /// The command that does the same, with the machine referenced beside it if that was done.
  [[nodiscard]] NotedCommand command(std::vector<std::string> words, Axis axis, bool referenced) const {
    NotedCommand noted;
    noted.words = words_on_unit(*connection_, std::move(words));
    if (referenced) noted.meanwhile = reference_words(live_->now().workshop, {axis});
    return noted;
  }

  std::shared_ptr<DatumLive> live_ = std::make_shared<DatumLive>();
  std::uint64_t live_changes_ = 0;
  TaskRunner reference_;
};

constexpr const char* kRecordExplained =
    "Records speed, reference switch and marker of one axis for ten seconds. The unit only records: reference the "
    "machine at its control while the progress bar runs. Start clear of the switch, at most about five seconds of "
    "travel away from it, so that switch and marker are passed within the ten seconds. The graph opens at the end and "
    "shows the datuming "
    "parameters.";

class DatumRecordScreen final : public DatumScreen {
 public:
  explicit DatumRecordScreen(std::shared_ptr<UnitConnection> connection)
      : DatumScreen(
            std::move(connection), "record", [this] { return question(); }, [this] { start(chosen()); },
            {{"up/down x y z", "axis"}}) {}

  [[nodiscard]] std::string title() const override { return "RECORD DATUM SEQUENCE"; }
  [[nodiscard]] std::string help() const override { return kRecordExplained; }
  [[nodiscard]] std::unique_ptr<Screen> opens_by_itself() override {
    return recorded_ ? datum_view_screen(std::exchange(recorded_, std::nullopt)) : nullptr;
  }

 private:
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_unit_row(canvas, inside);
    const Axis axis = busy() ? axis_ : chosen();
    draw_axis_rows(canvas, inside, axis);
    int row = kCallRow + 2;
    const DatumSeen seen = live_->now();
    if (!busy()) {
      canvas.text(inside, kCallRow, 0, fmt::format("Press Enter to record axis {}.", letter_of(axis)));
    } else if (seen.fetching) {
      draw_progress(canvas, inside, kCallRow, "fetching the record", task_.part(), task_.seconds_left());
    } else if (!seen.running) {
      canvas.text(inside, kCallRow, 0, "Sending ...");
    } else {
      draw_progress(canvas, inside, kCallRow, fmt::format("recording axis {}", letter_of(axis)), task_.part(),
                    (1.0 - task_.part()) * kDatumRecord_s);
      canvas.text(inside, kCallRow + 1, 0,
                  fmt::format("so far: {}, {} (the record contains all samples)", switch_seen_ ? "switch" : "no switch",
                              marker_seen_ ? "marker" : "no marker"));
      row += 2 + canvas.paragraph(
                     inside, row + 1,
                     reference_.running() ? "The emulated machine is being referenced ..." : call_to_reference(axis),
                     Tone::warning);
    }
    canvas.paragraph(inside, row + 1, kRecordExplained, Tone::faint);
    draw_message(canvas, last_rows(inside, 2), message_);
  }

  void on_other_key(const Key& key) override {
    if (!busy()) (void)choose_axis(key);
  }

  [[nodiscard]] Question question() const {
    const std::string unsaved = unsaved_record_of();
    return {
        fmt::format("Record axis {} for {:.0f} seconds?", letter_of(chosen()), kDatumRecord_s),
        fmt::format("The unit opens its relays and only records. Reference axis {} at the machine's control as soon as "
                    "the progress bar runs: the whole sequence must fit into the {:.0f} seconds. Start clear of the "
                    "reference switch, at most about five seconds of travel away from it.{}{}",
                    letter_of(chosen()), kDatumRecord_s, hint_of_emulator(),
                    unsaved.empty() ? "" : " The record of " + unsaved + " has not been saved: this one replaces it."),
        "record", "not now"};
  }

  void start(Axis axis) {
    if (busy()) return;
    axis_ = axis;
    switch_seen_ = marker_seen_ = referenced_ = false;
    live_->change([](DatumSeen& seen) { seen = {}; });
    const auto work = [connection = connection_, live = live_, axis](JobControl& control) {
      return connection->with_link(control, [&](UnitLink& link) {
        begin(*live, link, axis);
        const auto watch = [&](const protocol::CommandResult& busy) {
          control.part = busy.per_mille / 1000.0;
          look_at(*live, link, false);
        };
        const auto fetch = [&](const protocol::Progress& progress) {
          live->change([](DatumSeen& seen) { seen.fetching = true; });
          progress_into(control)(progress);
        };
        return record_datum(link.client(), axis, watch, fetch);
      });
    };
    task_.start("recording", work, [this](Result<DatumRecording> recording) {
      if (!recording) return say_failed(message_, recording.error(), task_.cancelled());
      recorded_ = std::move(*recording);
      // saving the record amends it (datum_view.cpp)
      note(command({"utility", "datum", "record", std::string(1, letter_of(axis_))}, axis_, referenced_));
    });
  }

  void follow(const DatumSeen& seen) override {
    if (!seen.sample) return;
    switch_seen_ = switch_seen_ || seen.sample->axes[index_of(axis_)].switch_active;
    marker_seen_ = marker_seen_ || seen.sample->axes[index_of(axis_)].marker;
  }

  void reference_now(const DatumSeen& seen) override {
    reference_machine(reference_, seen.workshop, {axis_}, message_, referenced_ = true);
  }

  Axis axis_ = Axis::X;  ///< recorded now or last
  bool switch_seen_ = false;
  bool marker_seen_ = false;
  bool referenced_ = false;  ///< the emulated machine, while it records
  std::optional<DatumRecording> recorded_;
};

constexpr std::chrono::milliseconds kTestLimit{620'000};  ///< the unit gives up on its own after 600 s
constexpr const char* kTestExplained =
    "The unit runs its datum routine, axis after axis, while the machine is referenced by its control: it waits for "
    "the motion, then for the switch, then for the marker. An axis that does not match its datuming parameters fails; "
    "the reason and the remedy are shown.";

enum class TestState { not_chosen, chosen, under_way, passed, failed, given_up };

struct AxisRow {
  Axis axis = Axis::X;
  TestState state = TestState::chosen;
  DatumStage stage = DatumStage::waiting;  ///< as the unit reported last
  std::string message{};                   ///< of one that failed
};

ListRow picture_of_state(const AxisRow& row) {
  static const ListRow kPictures[] = {{"not tested"},        {"to be tested"},
                                      {"", Tone::strong},    {"DATUM FOUND", Tone::good},
                                      {"FAILED", Tone::bad}, {"cancelled"}};
  ListRow picture = kPictures[static_cast<std::size_t>(row.state)];
  if (row.state == TestState::under_way)
    picture.text = row.stage == DatumStage::failed ? "FAILED, ending" : fmt::format("{} ...", ecs::name_of(row.stage));
  return picture;
}

class DatumTestScreen final : public DatumScreen {
 public:
  explicit DatumTestScreen(std::shared_ptr<UnitConnection> connection)
      : DatumScreen(
            std::move(connection), "test", [this] { return question(); }, [this] { start(); },
            {{"Space x y z", "choose axes"}, {"Space", "", [this] { toggle(chosen()); }}, {"up/down", "axis"}}) {
    fill_rows();
  }

  [[nodiscard]] std::string title() const override { return "TEST DATUM ROUTINE"; }
  [[nodiscard]] std::string help() const override {
    return std::string(kTestExplained) +
           " With the bundled emulator, press g to reference its machine, the axis under test first and then the "
           "others. The unit waits ten minutes for an axis to be referenced; press Esc to cancel.";
  }

 private:
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_unit_row(canvas, inside);
    draw_rows(canvas, inside.below(kAxesRow));
    canvas.text(inside, kCallRow, 0, call(), busy() ? Tone::warning : Tone::plain);
    int row = kCallRow + 2;
    for (const AxisRow& axis : rows_)
      if (!axis.message.empty())
        row += canvas.paragraph(inside, row, fmt::format("{}: {}", letter_of(axis.axis), axis.message), Tone::bad);
    if (row == kCallRow + 2) canvas.paragraph(inside, row, kTestExplained, Tone::faint);
    draw_message(canvas, last_rows(inside, 2), message_);
  }

  void draw_rows(Canvas& canvas, const Area& area) const {
    canvas.text(area, 0, 0,
                fmt::format("  {:<10} {:<18} {:>13} {:>10}  {:<8}{:<8}", "axis", "stage",
                            fmt::format("position {}", shown_in().length), shown_in().speed, "switch", "marker"),
                Tone::faint);
    int r = 0;
    for (const AxisRow& row : rows_) {
      ++r;
      const auto* s = unit_.axis(row.axis);
      const bool here = r - 1 == place_.selected && !busy();
      if (here) canvas.fill({area.row + r, area.column, 1, area.columns}, U' ', Tone::selected);
      const ListRow state = picture_of_state(row);
      canvas.text(area, r, 0,
                  fmt::format("{} [{}] {:<6} {:<18}", here || under_test() == row.axis ? ">" : " ",
                              row.state == TestState::not_chosen ? " " : "x", letter_of(row.axis), state.text),
                  here ? Tone::selected : state.tone);
      if (s != nullptr)
        canvas.text(area, r, 32,
                    fmt::format("{:>13} {:>10}  {:<8}{:<8}", shown_in().position(s->position_mm),
                                shown_in().speed_of(s->speed_mm_min), s->switch_active ? "on" : "off",
                                s->marker ? "seen" : "-"),
                    here ? Tone::selected : Tone::plain);
    }
  }

  [[nodiscard]] std::string call() const {
    const auto under = under_test();
    if (!busy()) return "Press Enter to test the axes marked x.";
    if (!under) return "Sending ...";
    if (std::any_of(rows_.begin(), rows_.end(),
                    [&](const AxisRow& row) { return row.axis == *under && row.stage == DatumStage::failed; }))
      return "The routine of this axis has failed: the unit ends it and reports the reason.";
    if (reference_.running()) return fmt::format("The emulated machine references axis {} ...", letter_of(*under));
    return call_to_reference(*under);
  }

  void on_other_key(const Key& key) override {
    if (busy() || place_.on_key(key, static_cast<int>(rows_.size()))) return;
    if (const auto axis = axis_of_key(key)) toggle(*axis);
    if (const auto k = axis_clicked(key)) place_.selected = *k;
  }

  void fill_rows() {
    const auto axes = unit_.axes();
    if (busy() || axes.size() == rows_.size()) return;
    rows_.clear();
    for (const Axis a : axes) rows_.push_back({a});
  }

  AxisRow* row_of(Axis axis) {
    const auto row = std::find_if(rows_.begin(), rows_.end(), [axis](const AxisRow& r) { return r.axis == axis; });
    return row == rows_.end() ? nullptr : &*row;
  }

  /// Whether it is tested.
  void toggle(Axis axis) {
    AxisRow* row = row_of(axis);
    if (row == nullptr) return;
    row->state = row->state == TestState::not_chosen ? TestState::chosen : TestState::not_chosen;
    row->message.clear();
  }

  [[nodiscard]] Question question() const {
    std::string axes;
    for (const AxisRow& row : rows_)
      if (row.state != TestState::not_chosen)
        axes += fmt::format("{}{}", axes.empty() ? "" : ", ", letter_of(row.axis));
    if (axes.empty()) return {"No axis is chosen", "Press Space to choose the axis under the cursor.", "well", "well"};
    return {fmt::format("Test the datum routine of {}?", axes),
            "The unit opens its relays, clears the reference of each of these axes and finds it again while the "
            "machine's control references it, one axis after the other. The unit does not move the machine." +
                hint_of_emulator(),
            "test", "not now"};
  }

  void start() {
    std::vector<Axis> axes;
    for (AxisRow& row : rows_) {
      if (row.state == TestState::not_chosen) continue;
      row = {row.axis};
      axes.push_back(row.axis);
    }
    if (busy() || axes.empty()) return;
    live_->change([](DatumSeen& seen) { seen = {}; });
    tests_seen_ = 0;
    reference_each_ = false;
    referenced_for_.reset();
    const auto work = [connection = connection_, live = live_, axes](JobControl& control) {
      return connection->with_link(control, [&](UnitLink& link) -> Result<void> {
        for (const Axis axis : axes) {
          begin(*live, link, axis);
          const auto watch = [&](const protocol::CommandResult&) { look_at(*live, link, true); };
          ECS_TRY(test, test_datum_of(link.client(), axis, kTestLimit, watch));
          live->change([&](DatumSeen& seen) {
            seen.tests.push_back(std::move(test));
            seen.running = false;
          });
        }
        return {};
      });
    };
    task_.start("testing", work, [this](const Result<void>& result) { take(result); });
  }

  [[nodiscard]] bool look() override {
    fill_rows();
    const bool changed = DatumScreen::look();
    follow_tests();
    if (const auto under = under_test();
        reference_each_ && under && referenced_for_ != under && !reference_.running()) {
      referenced_for_ = under;
      reference_machine(reference_, live_->now().workshop, {*under}, message_, true);
    }
    return changed;
  }

  [[nodiscard]] std::optional<Axis> under_test() const {
    const DatumSeen seen = live_->now();
    return busy() && seen.running ? seen.axis : std::nullopt;
  }

  void follow(const DatumSeen& seen) override {
    AxisRow* row = seen.running && seen.axis ? row_of(*seen.axis) : nullptr;
    if (row == nullptr) return;
    row->state = TestState::under_way;
    if (seen.status) row->stage = seen.status->axes[index_of(row->axis)].datum_stage;
  }

  void follow_tests() {
    const auto tests = live_->now().tests;
    for (; tests_seen_ < tests.size(); ++tests_seen_) {
      const AxisTest& test = tests[tests_seen_];
      AxisRow* row = row_of(test.axis);
      if (row == nullptr) continue;
      row->state = test.passed ? TestState::passed : TestState::failed;
      row->stage = test.passed ? DatumStage::done : DatumStage::failed;
      NotedCommand noted = command({"utility", "datum", "test", std::string(1, letter_of(test.axis)), "--wait",
                                    fmt::format("{}", kTestLimit.count() / 1000)},
                                   test.axis, referenced_for_ == test.axis);
      noted.exit_code = test.passed ? 0 : 1;
      note(std::move(noted));
      row->message = test.failure == DatumFailure::none
                         ? test.message
                         : fmt::format("{}. What to do: {}.", ecs::name_of(test.failure), advice_for(test.failure));
    }
  }

  void take(const Result<void>& result) {
    follow_tests();
    reference_each_ = false;
    for (AxisRow& row : rows_)
      if (row.state == TestState::under_way) row.state = TestState::given_up;
    if (!result) {
      reference_.cancel();
      return say_failed(message_, result.error(), task_.cancelled());
    }
    const auto failed =
        std::count_if(rows_.begin(), rows_.end(), [](const AxisRow& r) { return r.state == TestState::failed; });
    if (failed == 0) return message_.say("Every axis that was tested found its datum.");
    message_.say(
        fmt::format("{} failed: see the remedy above.", failed == 1 ? "One axis" : fmt::format("{} axes", failed)),
        Tone::bad);
  }

  /// This axis, and each of the following when its turn comes.
  void reference_now(const DatumSeen& /*seen*/) override {
    reference_each_ = true;
    referenced_for_.reset();
  }

  std::vector<AxisRow> rows_;
  std::optional<Axis> referenced_for_;  ///< the axis for which the emulated machine was started last
  bool reference_each_ = false;
  std::size_t tests_seen_ = 0;
};

}  // namespace

std::unique_ptr<Screen> datum_record_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<DatumRecordScreen>(std::move(connection));
}

std::unique_ptr<Screen> datum_test_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<DatumTestScreen>(std::move(connection));
}

}  // namespace ecs::app
