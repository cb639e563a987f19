#include "commissioning/parameters/transfer.hpp"

#include <fmt/format.h>

namespace ecs::commissioning {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kNamed = 4;  ///< differences that a question names
constexpr std::size_t kWarned = 2;

std::string value_or_nothing(const std::string& value) { return value.empty() ? "nothing" : value; }

/// "7 parameters of the unit are overwritten: X deadband 5 > 2.5, … and 3 more."
std::string overwritten(const ParametersController& controller) {
  if (!controller.has_unit_values()) return fmt::format("Nothing is overwritten: {}.", controller.unit()->none_because);
  const auto differing = controller.differs_from_unit();
  std::string text =
      fmt::format("Overwritten there: {} parameter{}:", differing.size(), differing.size() == 1 ? "" : "s");
  for (std::size_t k = 0; k < std::min(kNamed, differing.size()); ++k)
    text += fmt::format("\n- {}: {} > {}", full_label_of(differing[k].key), value_or_nothing(differing[k].unit),
                        value_with_unit(differing[k].key, differing[k].screen));
  if (differing.size() > kNamed) text += fmt::format("\n- and {} more (page Compare)", differing.size() - kNamed);
  return text;
}

std::string warned(const ParametersController& controller) {
  const auto& findings = controller.findings();
  if (findings.empty()) return {};
  std::string text = fmt::format("\n{} warning{}:", findings.size(), findings.size() == 1 ? "" : "s");
  for (std::size_t k = 0; k < std::min(kWarned, findings.size()); ++k)
    text += fmt::format("\n- {}: {}", findings[k].keys.empty() ? "" : full_label_of(findings[k].keys.front()),
                        findings[k].message);
  if (findings.size() > kWarned) text += fmt::format("\n- and {} more (page Findings)", findings.size() - kWarned);
  return text;
}

std::string taken_in_words(const SentParameters& sent, std::size_t differing) {
  std::string text =
      fmt::format("sent to {} and read back: {}; commit {}", title_of(sent.after),
                  differing == 0 ? "no difference" : fmt::format("{} differ", differing), sent.report.commit_sequence);
  if (sent.report.map_kept) text += "; its map fits and stays";
  if (sent.report.map_dropped) text += "; it has no map now";
  return text;
}

}  // namespace

void ParametersTransfer::read(Reading purpose, bool switching) {
  purpose_ = purpose;
  since_ = Clock::now();
  reading_.start([line = line_, switching](JobControl& control) {
    return line->on_line(control, [switching](UnitLink& unit) -> Result<UnitContent> {
      return switching ? switched_to_integration(unit) : unit_content(unit);
    });
  });
}

void ParametersTransfer::receive() { read(Reading::to_receive, false); }

void ParametersTransfer::send(const ParametersController& controller) {
  to_send_ = controller.set();
  read(Reading::to_send, false);
}

void ParametersTransfer::cancel() {
  reading_.cancel();
  sending_.cancel();
}

void ParametersTransfer::look_when_opened() {
  if (looking_.running() || running()) return;
  const WatchedUnit unit = line_->snapshot();
  if (!unit.open || unit.lent || looked_at_ == unit.opened_at) return;
  looked_at_ = unit.opened_at;
  looking_.start([line = line_](JobControl& control) { return line->on_line(control, unit_content); });
}

double ParametersTransfer::seconds_left() const {
  const double seconds = std::chrono::duration<double>(Clock::now() - since_).count();
  return part() > 0.02 ? seconds * (1.0 - part()) / part() : -1.0;
}

bool ParametersTransfer::advance(ParametersController& controller, Message& message) {
  bool changed = running();
  if (auto looked = looking_.take()) {
    if (*looked) controller.know_unit(std::move(**looked));
    changed = true;
  }
  if (auto unit = reading_.take()) take_read(controller, message, std::move(*unit));
  if (auto sent = sending_.take()) take_sent(controller, message, std::move(*sent));
  look_when_opened();
  return changed;
}

void ParametersTransfer::take_read(ParametersController& controller, Message& message, Result<UnitContent> unit) {
  if (!unit) {
    message.say("No exchange with the unit. Nothing was changed here: " + to_text(unit.error()) +
                    ". The link reopens by itself. Try again then.",
                Tone::bad);
    return;
  }
  if (purpose_ == Reading::to_receive) {
    const char* undo = controller.loaded() ? "; u brings back what was here" : "";
    if (auto taken = controller.take_from_unit(*unit); !taken)
      message.say(taken.error());
    else
      message.say(fmt::format("received from {}{}", title_of(*unit), undo));
    return;
  }
  controller.know_unit(*unit);
  if (unit->mode == UnitMode::datuming || unit->mode == UnitMode::compensating) {
    ask_to_switch(*unit);
  } else if (unit->mode != UnitMode::integration) {
    message.say(fmt::format("nothing was sent: {} is {}, it takes parameters only in integration mode; see its status "
                            "under ECS UTILITY",
                            title_of(*unit), ecs::name_of(unit->mode)),
                Tone::bad);
  } else if (controller.has_unit_values() && controller.differs_from_unit().empty()) {
    controller.sent(to_send_, std::move(*unit));
    message.say("nothing to send: the unit holds these parameters already");
  } else {
    ask_to_send(controller);
  }
}

void ParametersTransfer::ask_to_switch(const UnitContent& unit) {
  asking_ = Asking{{fmt::format("Switch {} to integration mode?", title_of(unit)),
                    fmt::format("It is {} now and takes no parameters there. In integration mode it stops "
                                "compensating: outputs go to 0, relays open. The machine must not be cutting.",
                                ecs::name_of(unit.mode)),
                    "switch", "leave it"},
                   [this] { read(Reading::to_send, true); }};
}

void ParametersTransfer::ask_to_send(const ParametersController& controller) {
  const std::string other = other_unit_sentence(to_send_, *controller.unit());
  asking_ =
      Asking{{fmt::format("Send the parameters to {}?", title_of(*controller.unit())),
              (other.empty() ? "" : "ANOTHER UNIT: " + other + "\n") + overwritten(controller) + warned(controller),
              "send", "do not send"},
             [this, owner = other.empty() ? to_send_.identity : params::Identity()] {
               start_sending(owner, UnfitMap::refuse);
             }};
}

void ParametersTransfer::start_sending(const params::Identity& owner, UnfitMap unfit) {
  owner_ = owner;
  since_ = Clock::now();
  sending_.start([line = line_, set = to_send_, owner, unfit](JobControl& control) {
    return line->on_line(control, [&](UnitLink& unit) {
      return sent_to_unit(unit, set.parameters, owner, unfit, [&control](const protocol::Progress& progress) {
        if (progress.bytes_total > 0)
          control.part = static_cast<double>(progress.bytes_done) / static_cast<double>(progress.bytes_total);
      });
    });
  });
}

void ParametersTransfer::take_sent(ParametersController& controller, Message& message, Result<SentParameters> sent) {
  if (sent) {
    const SentParameters report = *sent;
    controller.sent(to_send_, std::move(sent->after));
    message.say(taken_in_words(report, controller.differs_from_unit().size()));
    return;
  }
  const Problem& why = sent.error();
  if (!refused_for_map(why)) {
    message.say("The parameters here are unchanged: " + to_text(why), Tone::bad);
    look();
    return;
  }
  std::string objections;
  for (const Problem& objection : why.also) objections += "\n- " + objection.message;
  message.say("nothing was sent: the map in the unit does not fit these parameters", Tone::warning);
  asking_ = Asking{{"Send them without the map?",
                    "The map in the unit does not fit these parameters and would be dropped: the unit does not "
                    "compensate until a map is sent." +
                        objections,
                    "send, drop the map", "send nothing"},
                   [this] { start_sending(owner_, UnfitMap::drop); }};
}

}  // namespace ecs::commissioning
