#include "commissioning/parameters/transfer.hpp"

#include <fmt/format.h>

#include "commissioning/link/not_armed.hpp"
#include "commissioning/parameters/controller.hpp"
#include "core/mode_word.hpp"

namespace ecs::commissioning {

std::string title_of(const UnitContent& unit) {
  return unit.identity.serial_number.empty() ? unit.name
                                             : fmt::format("{}, unit {}", unit.name, unit.identity.serial_number);
}

Result<UnitContent> unit_content(UnitLink& link) {
  UnitContent unit;
  unit.name = link.is_emulator() ? "EMULATOR" : link.name();
  ECS_TRY(identity, link.client().identity());
  unit.identity = std::move(identity);
  ECS_TRY(status, link.client().status());
  unit.mode = status.mode;
  auto parameters = receive_parameters(link.client());
  if (parameters) {
    unit.parameters = *parameters;
  } else if (parameters.error().kind == ProblemKind::refused) {
    unit.none_because =
        status.active_bank == protocol::Bank::none ? "it contains no parameters yet" : to_text(parameters.error());
  } else {
    return tl::unexpected(parameters.error());
  }
  return unit;
}

Result<UnitContent> switched_to_integration(UnitLink& link) {
  ECS_DO(link.client().enter_integration());
  return unit_content(link);
}

Result<SentParameters> sent_to_unit(UnitLink& link, const UnitParameters& parameters, const params::Identity& owner,
                                    UnfitMap unfit, const protocol::ProgressCallback& progress) {
  ECS_TRY(report, send_parameters(link.client(), parameters, owner, unfit, progress));
  auto after = unit_content(link);
  if (!after) {
    after.error().message =
        "the unit has accepted the parameters, but reading it afterwards failed: " + after.error().message;
    return tl::unexpected(std::move(after.error()));
  }
  return SentParameters{std::move(report), std::move(*after)};
}

bool refused_for_map(const Problem& why) {
  return why.kind == ProblemKind::refused &&
         (why.message.starts_with(kUnfitMap) || why.message.starts_with(kNoValidMap));
}

std::string other_unit_sentence(const ParameterSet& set, const UnitContent& unit) {
  if (other_unit(set.identity, unit.identity.serial_number).empty()) return {};
  return fmt::format("These parameters are for unit {}, but this is unit {}.", set.identity.serial_number,
                     unit.identity.serial_number);
}

namespace {

constexpr const char* kReading = "reading the unit";
constexpr const char* kSending = "sending to the unit";
constexpr std::size_t kNamed = 4;  ///< differences that a question names
constexpr std::size_t kWarned = 2;

std::string value_or_nothing(const std::string& value) { return value.empty() ? "nothing" : value; }

/// "7 parameters of the unit are overwritten: X deadband: 5 -> 2.5, … and 3 more."
std::string overwritten(const ParametersController& controller) {
  if (!controller.has_unit_values())
    return fmt::format("No parameters will be overwritten: {}.", controller.unit()->none_because);
  const auto differing = controller.differs_from_unit();
  std::string text =
      fmt::format("{} parameter{} will be overwritten:", differing.size(), differing.size() == 1 ? "" : "s");
  for (std::size_t k = 0; k < std::min(kNamed, differing.size()); ++k)
    text += fmt::format("\n- {}: {} -> {}", full_label_of(differing[k].key), value_or_nothing(differing[k].unit),
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
      fmt::format("sent to {} and read back: {}; commit no. {}", title_of(sent.after),
                  differing == 0 ? "no difference" : fmt::format("{} differ", differing), sent.report.commit_sequence);
  if (sent.report.map_kept) text += "; its map fits and is kept";
  if (sent.report.map_dropped) text += "; it now has no map";
  return text;
}

}  // namespace

void ParametersTransfer::receive() {
  const auto read = [connection = connection_](JobControl& control) {
    return connection->with_link(control, unit_content);
  };
  task_.start(kReading, read, [this](const Result<UnitContent>& unit) {
    if (!unit) return say_no_exchange(unit.error());
    const char* undo = controller_->loaded() ? "; press u to restore the previous parameters" : "";
    if (auto taken = controller_->take_from_unit(*unit); !taken) return message_->say(taken.error());
    note_on_unit(*connection_, {"params", "receive", "-o", controller_->file_between_commands()});
    message_->say(fmt::format("received from {}{}", title_of(*unit), undo));
  });
}

void ParametersTransfer::send() {
  to_send_ = controller_->set();
  read_to_send(false);
}

void ParametersTransfer::read_to_send(bool switching) {
  const auto read = [connection = connection_, switching, parameters = to_send_.parameters](JobControl& control) {
    return connection->with_link(control, [&](UnitLink& link) -> Result<UnitContent> {
      ECS_TRY(unit, switching ? switched_to_integration(link) : unit_content(link));
      unit.tools_beyond = tools_beyond_range(link.client(), parameters);
      return unit;
    });
  };
  task_.start(kReading, read, [this, switching](Result<UnitContent> unit) {
    if (!unit) return say_no_exchange(unit.error());
    if (switching) note_on_unit(*connection_, {"utility", "mode", "integrate"});
    take_read_to_send(std::move(*unit));
  });
}

void ParametersTransfer::look_when_opened() {
  if (looking_.running() || task_.running()) return;
  const WatchedUnit unit = connection_->snapshot();
  if (!unit.open || unit.lent || looked_at_ == unit.opened_at) return;
  looked_at_ = unit.opened_at;
  const auto look = [connection = connection_](JobControl& control) {
    return connection->with_link(control, unit_content);
  };
  looking_.start(kReading, look, [this](Result<UnitContent> content) {
    if (content) controller_->know_unit(std::move(*content));
  });
}

bool ParametersTransfer::sending() const { return task_.label() == kSending; }

bool ParametersTransfer::advance() {
  const bool changed = task_.running();
  const bool looked = looking_.advance();
  (void)task_.advance();
  look_when_opened();
  return changed || looked;
}

void ParametersTransfer::say_no_exchange(const Problem& why) {
  message_->say("No exchange with the unit. The parameters here are unchanged: " + to_text(why) +
                    ". The link reopens automatically. Try again then.",
                Tone::bad);
}

void ParametersTransfer::take_read_to_send(UnitContent unit) {
  controller_->know_unit(unit);
  if (unit.mode == UnitMode::datuming || unit.mode == UnitMode::compensating) {
    ask_to_switch(unit);
  } else if (unit.mode != UnitMode::integration) {
    message_->say(
        fmt::format(
            "not sent: {} is {} and accepts parameters only in integration mode; see its status under ECS UTILITY",
            title_of(unit), word_of(unit.mode)),
        Tone::bad);
  } else if (controller_->has_unit_values() && controller_->differs_from_unit().empty()) {
    controller_->sent(to_send_, std::move(unit));
    message_->say("not sent: the unit already has these parameters");
  } else {
    ask_to_send();
  }
}

void ParametersTransfer::ask_to_switch(const UnitContent& unit) {
  asking_.ask({fmt::format("Switch {} to integration mode?", title_of(unit)),
               fmt::format("It is {} now and accepts no parameters in this mode. In integration mode it stops "
                           "compensating: outputs go to 0, relays open. The machine must not be cutting.",
                           word_of(unit.mode)),
               "switch", "cancel"},
              [this] { read_to_send(true); });
}

void ParametersTransfer::ask_to_send() {
  const std::string other = other_unit_sentence(to_send_, *controller_->unit());
  const std::string& beyond = controller_->unit()->tools_beyond;
  asking_.ask(
      {fmt::format("Send the parameters to {}?", title_of(*controller_->unit())),
       (other.empty() ? "" : "ANOTHER UNIT: " + other + "\n") + (beyond.empty() ? "" : "TOOLS: " + beyond + ".\n") +
           overwritten(*controller_) + warned(*controller_),
       "send", "do not send"},
      [this, owner = other.empty() ? to_send_.identity : params::Identity()] {
        start_sending(owner, UnfitMap::refuse);
      });
}

void ParametersTransfer::start_sending(const params::Identity& owner, UnfitMap unfit) {
  owner_ = owner;
  drops_map_ = unfit == UnfitMap::drop;
  const auto send = [connection = connection_, set = to_send_, owner, unfit](JobControl& control) {
    return connection->with_link(control, [&](UnitLink& link) {
      return sent_to_unit(link, set.parameters, owner, unfit, progress_into(control));
    });
  };
  task_.start(kSending, send, [this](Result<SentParameters> sent) { take_sent(std::move(sent)); });
}

void ParametersTransfer::take_sent(Result<SentParameters> sent) {
  if (sent) {
    const SentParameters report = *sent;
    std::vector<std::string> words{"params", "send", controller_->file_for_commands(to_send_)};
    if (drops_map_) words.emplace_back("--force");
    if (owner_ != to_send_.identity) words.emplace_back("--other-machine");
    note_on_unit(*connection_, std::move(words));
    controller_->sent(to_send_, std::move(sent->after));
    message_->say(taken_in_words(report, controller_->differs_from_unit().size()));
    return;
  }
  const Problem& why = sent.error();
  if (!refused_for_map(why)) {
    message_->say(is_not_armed(why) ? std::string(kNotArmed) + " Press t to try again."
                                    : "The parameters here are unchanged: " + to_text(why),
                  Tone::bad);
    look();
    return;
  }
  std::string objections;
  for (const Problem& objection : why.also) objections += "\n- " + objection.message;
  const bool unfit = why.message.starts_with(kUnfitMap);
  message_->say(fmt::format("not sent: {}", unfit ? kUnfitMap : kNoValidMap), Tone::warning);
  asking_.ask({"Send them without the map?",
               (unfit ? "The map in the unit does not fit these parameters and will be deleted: the unit does not "
                        "compensate until a map is sent."
                      : "The unit contains no valid map, and does not compensate until one is sent.") +
                   objections,
               unfit ? "send, delete the map" : "send", "do not send"},
              [this] { start_sending(owner_, UnfitMap::drop); });
}

}  // namespace ecs::commissioning
