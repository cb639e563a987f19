#include "commissioning/utility/axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/unit/transfer.hpp"

namespace ecs::commissioning {

PositionController::PositionController(std::shared_ptr<UnitConnection> connection)
    : connection_(connection), watching_(std::move(connection)) {
  (void)unit_.look(*connection_);
  restarts_ = unit_.restarts;
}

Result<double> PositionController::position_in(const std::string& typed) {
  const auto number = number_in(typed);
  if (!number) return problem(ProblemKind::usage, fmt::format("expected a position in mm, found \"{}\"", typed));
  if (std::abs(*number) > kLargest_mm)
    return problem(ProblemKind::usage,
                   fmt::format("expected a position within +/-{:.0f} mm, found {}", kLargest_mm, typed));
  return *number;
}

Question PositionController::question(Axis axis, double position_mm) const {
  const protocol::AxisSample* now = unit_.axis(axis);
  const std::string shown = now == nullptr ? "" : fmt::format(" It shows {:.4f} mm now.", now->position_mm);
  const std::string reference =
      now != nullptr && now->referenced
          ? " The axis stays marked as referenced, but its positions are yours from now on: reference the machine "
            "again (compensation mode does) before anything relies on them."
          : " The axis does not become referenced by this: only its reference sequence does that.";
  return {fmt::format("Let the unit show {:.4f} mm for axis {}?", position_mm, letter_of(axis)),
          "Nothing moves: only the number changes, and the unit counts on from there." + shown + reference, "set it",
          "leave it"};
}

void PositionController::set(Axis axis, double position_mm) { start(axis, position_mm, false, 0.0); }

void PositionController::undo() {
  if (done_.empty()) {
    message_.say("Nothing to undo: no position was set here.", Tone::warning);
    return;
  }
  const PresetPosition& last = done_.back();
  start(last.axis, 0.0, true, last.before_mm - last.after_mm);
}

/// @param shift_mm  of an undo: the axis may have moved since, so it is shifted from where it stands
void PositionController::start(Axis axis, double position_mm, bool is_undo, double shift_mm) {
  if (busy()) return;
  const auto work = [connection = connection_, axis, position_mm, is_undo, shift_mm](JobControl& control) {
    return connection->with_link(control, [&](UnitLink& link) -> Result<Change> {
      ECS_TRY(before, link.client().monitor());
      const double shown_mm = before.axes[index_of(axis)].position_mm;
      const double wanted_mm = is_undo ? shown_mm + shift_mm : position_mm;
      ECS_DO(link.client().set_axis_position(axis, wanted_mm));
      return Change{{axis, shown_mm, wanted_mm}, is_undo};
    });
  };
  task_.start("setting the position", work, [this](const Result<Change>& change) { take(change); });
}

bool PositionController::advance() {
  bool changed = unit_.look(*connection_);
  if (unit_.restarts != restarts_) {
    restarts_ = unit_.restarts;
    if (!done_.empty())
      message_.say("The unit was restarted: it counts from 0 again, and what was set here is gone.", Tone::warning);
    done_.clear();
    changed = true;
  }
  return task_.advance() || changed;
}

void PositionController::take(const Result<Change>& change) {
  if (!change) return message_.say(change.error());
  const PresetPosition& preset = change->preset;
  if (change->is_undo)
    done_.pop_back();
  else
    done_.push_back(preset);
  note_on_unit(*connection_,
               {"utility", "position", std::string(1, letter_of(preset.axis)), shortest(preset.after_mm)});
  message_.say(fmt::format("Axis {} {} {:.4f} mm; it showed {:.4f} mm.{}", letter_of(preset.axis),
                           change->is_undo ? "is back at" : "now shows", preset.after_mm, preset.before_mm,
                           change->is_undo ? "" : " u takes it back."));
}

namespace {

constexpr std::array<double, 8> kSteps_um{0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0};
constexpr double kLeastMeasured = 0.02;                     ///< of what was put out; less is no movement
constexpr auto kRenewal = std::chrono::seconds(20);         ///< a third of the time that the unit holds a relay
constexpr auto kSettling = std::chrono::milliseconds(100);  ///< from a command to a sample that shows it
constexpr double kScaleHolds = 0.02;                        ///< of the scale; a dial gauge knows no better

}  // namespace

std::string um_text(double um) { return um == 0.0 ? "0 um" : fmt::format("{:+g} um", um); }

Result<ScaleProposal> scale_from(const AxisParameters& axis, Axis name, double um, double measured_um) {
  if (um == 0.0)
    return problem(ProblemKind::usage, "first put a value out with the relay closed: 0 um tells nothing about a scale");
  if (std::abs(measured_um) < kLeastMeasured * std::abs(um))
    return problem(ProblemKind::usage,
                   fmt::format("{} put out and {} measured: the axis does not follow. Check that the relay is closed, "
                               "the connection to the servo, and the D/A converter",
                               um_text(um), um_text(measured_um)));
  ScaleProposal proposal;
  proposal.counts_per_um = axis.output_scale_counts_per_um * std::abs(um / measured_um);
  const bool turned = (um > 0.0) != (measured_um > 0.0);
  proposal.polarity = turned ? -axis.compensation_polarity : axis.compensation_polarity;
  const std::string seen = fmt::format("{} put out moved {} by {}", um_text(um), letter_of(name), um_text(measured_um));
  if (!turned && std::abs(proposal.counts_per_um / axis.output_scale_counts_per_um - 1.0) < kScaleHolds)
    proposal.sentence = seen + ": scale and polarity are right.";
  else
    proposal.sentence = fmt::format(
        "{}: set the compensation output value scaling factor of {} to {:.4g} counts/um (it is {:.4g}){} in E.C.S. "
        "PARAMETERS, send them, and try again.",
        seen, letter_of(name), proposal.counts_per_um, axis.output_scale_counts_per_um,
        turned ? fmt::format(" and its compensation polarity to {:+d}", proposal.polarity) : "");
  return proposal;
}

OutputController::OutputController(std::shared_ptr<UnitConnection> connection)
    : connection_(connection), watching_(std::move(connection)) {
  (void)unit_.look(*connection_);
  restarts_ = unit_.restarts;
  times_lost_ = unit_.watched.times_lost;
  setting_.axis = unit_.axes().empty() ? Axis::X : unit_.axes().front();
  follow_unit();
}

OutputController::~OutputController() {
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
        fmt::format("axis {}: the command to open its relay did not reach the unit. It opens it by itself 60 s after "
                    "it was asked last; until then {:+g} um may act on the axis",
                    letter_of(setting_.axis), setting_.um));
}

/// What another host, or this one before, left switched on; what the unit has ended by itself.
void OutputController::follow_unit() {
  if (busy() || !unit_.fresh || unit_.watched.newest_at < sent_at_ + kSettling) return;
  if (const auto* s = unit_.axis(setting_.axis); s != nullptr && setting_.relay && !s->relay_closed) {
    setting_ = {setting_.axis, 0.0, false};
    message_.say("The unit has opened the relay by itself: a restart, another mode, a fault, or another host.",
                 Tone::warning);
  }
  follow_value();
  if (!setting_.at_rest() || !unit_.integrating()) return;
  for (const Axis a : unit_.axes())
    if (const auto* s = unit_.axis(a); s != nullptr && (s->relay_closed || s->output_counts != 0))
      setting_ = {a, s->compensation_um, s->relay_closed};
}

/// The value that acts is the one shown, and the one that the next step starts from.
void OutputController::follow_value() {
  const auto* s = unit_.axis(setting_.axis);
  if (s == nullptr || setting_.at_rest() || !unit_.integrating()) return;
  const double count_um = 1.0 / std::max(1e-9, std::abs(parameters().output_scale_counts_per_um));
  if (std::abs(s->compensation_um - setting_.um) <= count_um + 1e-6) return;
  setting_.um = s->compensation_um;
  message_.say(fmt::format("Another host has changed the output of axis {}: {} now. o ends it.",
                           letter_of(setting_.axis), um_text(setting_.um)),
               Tone::bad);
}

double OutputController::step_um() const { return kSteps_um[static_cast<std::size_t>(step_)]; }

void OutputController::resize_step(int direction) {
  step_ = std::clamp(step_ + direction, 0, static_cast<int>(kSteps_um.size()) - 1);
}

std::optional<double> OutputController::moved_um() const {
  const auto* now = unit_.axis(setting_.axis);
  if (!rest_mm_ || now == nullptr) return std::nullopt;
  return 1e3 * (now->position_mm - *rest_mm_);
}

Result<double> OutputController::value_in(const std::string& typed) const {
  const auto number = number_in(typed);
  if (!number) return problem(ProblemKind::usage, fmt::format("expected a value in um, found \"{}\"", typed));
  const double limit = parameters().output_limit_um;
  if (std::abs(*number) > limit)
    return problem(
        ProblemKind::usage,
        fmt::format(
            "{} is beyond the output limit of axis {}, {:g} um (a parameter of the unit): the unit would refuse it",
            um_text(*number), letter_of(setting_.axis), limit));
  return *number;
}

Question OutputController::question(double um) const {
  const char axis = letter_of(setting_.axis);
  const double by = um - (setting_.relay ? setting_.um : 0.0);
  return {by == 0.0 ? fmt::format("Close the relay of axis {}?", axis)
                    : fmt::format("Move axis {} by {}?", axis, um_text(by)),
          fmt::format("The relay connects the D/A converter with the servo of {}: the axis moves by about {} at once "
                      "({}), with a wrong output scale by another amount or the other way. From then on + and - move "
                      "it without asking, at most to {:g} um either way. Keep clear of the machine.",
                      axis, um_text(by),
                      by > 0.0   ? "towards larger coordinates"
                      : by < 0.0 ? "towards smaller coordinates"
                                 : "an offset of the converter shows",
                      parameters().output_limit_um),
          "move it", "leave it"};
}

Result<ScaleProposal> OutputController::scale_from_measured(const std::string& typed_um) const {
  const auto measured_um = number_in(typed_um);
  if (!measured_um) return problem(ProblemKind::usage, fmt::format("expected a length in um, found \"{}\"", typed_um));
  return scale_from(parameters(), setting_.axis, setting_.um, *measured_um);
}

void OutputController::choose(Axis axis) {
  if (axis == setting_.axis || busy()) return;
  if (!setting_.at_rest()) {
    message_.say(fmt::format("Axis {} still puts out {}: press o first, one axis at a time.", letter_of(setting_.axis),
                             um_text(setting_.um)),
                 Tone::warning);
    return;
  }
  setting_.axis = axis;
  rest_mm_.reset();
}

void OutputController::start(const std::string& label, std::function<Result<Taken>(JobControl&)> work) {
  task_.start(label, std::move(work), [this](const Result<Taken>& taken) {
    if (taken || !off_wanted_) take(taken);
    if (off_wanted_) off();
  });
}

void OutputController::set(double um, bool relay) {
  if (busy()) return;
  const OutputSetting wanted{setting_.axis, um, relay};
  start("putting out", [connection = connection_, wanted](JobControl& control) {
    return connection->with_link(control, [&](UnitLink& link) -> Result<Taken> {
      ECS_TRY(before, link.client().monitor());
      ECS_DO(link.client().output_compensation(wanted.axis, wanted.um, wanted.relay));
      return Taken{wanted, before};
    });
  });
}

void OutputController::step(int direction) {
  const double limit = parameters().output_limit_um;
  const double wanted = std::round(1e3 * (setting_.um + direction * step_um())) / 1e3;
  if (std::abs(wanted) > limit)
    message_.say(
        fmt::format("Axis {} is at its output limit of {:g} um (a parameter of the unit): no further this way.",
                    letter_of(setting_.axis), limit),
        Tone::warning);
  else
    set(wanted, setting_.relay);
}

void OutputController::off() {
  off_wanted_ = busy();
  if (busy()) return task_.cancel();
  start("switching off", [connection = connection_, axis = setting_.axis](JobControl& control) {
    return connection->with_link_to_any_unit(control, [&](UnitLink& link) -> Result<Taken> {
      ECS_DO(link.client().output_off());
      ECS_TRY(seen, link.client().monitor());
      for (const Axis a : kAllAxes)
        if (seen.axes[index_of(a)].relay_closed)
          return problem(ProblemKind::link, fmt::format("the unit answers that all is off, but shows the relay of {} "
                                                        "closed: press o again; if it stays, use the emergency stop",
                                                        letter_of(a)));
      return Taken{{axis, 0.0, false}, std::nullopt};
    });
  });
}

/// The unit opens a relay 60 s after the last command: what is shown as put out is commanded again in time.
void OutputController::renew() {
  if (!setting_.relay || busy() || std::chrono::steady_clock::now() - sent_at_ < kRenewal) return;
  sent_at_ = std::chrono::steady_clock::now();
  start("holding the output", [connection = connection_, held = setting_](JobControl& control) {
    return connection->with_link(control, [&](UnitLink& link) -> Result<Taken> {
      ECS_DO(link.client().output_compensation(held.axis, held.um, held.relay));
      return Taken{held, std::nullopt};
    });
  });
}

void OutputController::take(const Result<Taken>& taken) {
  if (!taken) {
    message_.say(taken.error());
    return;
  }
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
  if (now.at_rest())
    message_.say("Every output is 0, every relay is open.");
  else
    message_.say(fmt::format("Axis {}: {} put out, relay {}. o ends it.", letter_of(now.axis), um_text(now.um),
                             now.relay ? "closed" : "open"));
}

void OutputController::start_reading_parameters() {
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

bool OutputController::advance() {
  bool changed = unit_.look(*connection_);
  if (!setting_.at_rest() && unit_.watched.times_lost != times_lost_)
    message_.say(
        "The link is lost: the command to open the relay did not reach the unit. It opens every relay by itself when "
        "nothing was asked of it for 60 s; the emergency stop is quicker.",
        Tone::bad);
  times_lost_ = unit_.watched.times_lost;
  if (unit_.restarts != restarts_) {
    restarts_ = unit_.restarts;
    const auto* seen = unit_.axis(setting_.axis);
    if (!setting_.at_rest() && seen != nullptr && !seen->relay_closed)
      message_.say("The unit was restarted: every output is 0, every relay is open.", Tone::warning);
    setting_ = {setting_.axis, 0.0, false};
    rest_mm_.reset();
    changed = true;
  }
  if (changed) follow_unit();
  renew();
  start_reading_parameters();
  changed = reading_.advance() || changed;
  return task_.advance() || changed;
}

}  // namespace ecs::commissioning
