#include "commissioning/link/controller.hpp"

#include <fmt/format.h>

#include "commissioning/link/doctor.hpp"
#include "commissioning/session/commands.hpp"

namespace ecs::commissioning {
namespace {

std::vector<FoundPort> survey(const std::string& in_use) {
  std::vector<FoundPort> found;
  for (const std::string& device : serial_ports()) {
    FoundPort port{device, {}, {}};
    if (device == in_use) {
      port.trouble = "in use by this program";
    } else if (const auto trouble = trouble_with(device)) {
      port.trouble = trouble->message;
      port.action = trouble->action;
    }
    found.push_back(std::move(port));
  }
  return found;
}

}  // namespace

LinkController::LinkController(std::shared_ptr<UnitConnection> unit) : unit_(std::move(unit)) {
  if (const auto choice = chosen_link(unit_->link())) form_ = LinkForm(*choice);
  if (const auto stored = stored_link(); stored && *stored) stored_ = **stored;
  look_for_ports();
}

std::vector<std::string> LinkController::port_names() const {
  std::vector<std::string> names;
  for (const FoundPort& port : ports_) names.push_back(port.device);
  return names;
}

DoctorAnswer LinkController::doctor() const {
  const std::lock_guard lock(progress_->mutex);
  return progress_->answer;
}

bool LinkController::advance() {
  bool changed = !working_on().empty();
  changed = task_.advance() || changed;
  std::uint64_t progress = 0;
  {
    const std::lock_guard lock(progress_->mutex);
    progress = progress_->changes;
  }
  const std::uint64_t unit = unit_->changes();
  changed = changed || progress != progress_seen_ || unit != unit_seen_;
  progress_seen_ = progress;
  unit_seen_ = unit;
  return changed;
}

bool LinkController::idle() {
  if (!task_.running()) return true;
  message_.say(fmt::format("still {}: Esc gives it up", working_on()), Tone::warning);
  return false;
}

void LinkController::look_for_ports() {
  if (!idle()) return;
  const auto look = [where = unit_->snapshot().where](JobControl&) { return survey(where); };
  task_.start("looking for serial ports", look, [this](std::vector<FoundPort> found) {
    ports_ = std::move(found);
    ports_known_ = true;
  });
}

std::optional<LinkChoice> LinkController::chosen() {
  auto choice = parsed_link(form_.text(), "LINK");
  if (choice) return std::move(*choice);
  message_.say(choice.error());
  return std::nullopt;
}

// --- trying
bool LinkController::try_it() {
  const auto choice = chosen();
  if (!choice || !idle()) return false;
  const std::string link = to_text(*choice);
  const auto progress = progress_;
  {
    const std::lock_guard lock(progress->mutex);
    progress->answer = {link, "waiting for the link", {}, {}};
    ++progress->changes;
  }
  const auto note = [progress](const std::string& text) {
    const std::lock_guard lock(progress->mutex);
    progress->answer.trying = text;
    ++progress->changes;
  };
  const auto heard = [progress](const DoctorFinding& finding) {
    const std::lock_guard lock(progress->mutex);
    progress->answer.findings.push_back(finding);
    ++progress->changes;
  };
  const auto examine = [unit = unit_, choice = *choice, note, heard](JobControl& control) {
    const auto lent = unit->lend();
    note("asking the unit");
    return diagnosis_of(choice, note, heard, control.cancelled);
  };
  task_.start("trying " + link, examine, [this](const Diagnosis& diagnosis) { ended(diagnosis, task_.cancelled()); });
  return true;
}

void LinkController::ended(const Diagnosis& diagnosis, bool cancelled) {
  std::string link;
  {
    const std::lock_guard lock(progress_->mutex);
    progress_->answer.trying.clear();
    progress_->answer.diagnosis = diagnosis;
    ++progress_->changes;
    link = progress_->answer.link;
  }
  if (cancelled) return message_.say("given up: the setting was not tried to its end", Tone::warning);
  if (diagnosis.works) {
    works_ = link;
    return message_.say(link == unit_->link() || link == unit_->snapshot().link
                            ? fmt::format("{} works", link)
                            : fmt::format("{} works: u uses it now, s stores it", link));
  }
  if (diagnosis.working_link.empty()) return message_.say(fmt::format("{} does not work", link), Tone::bad);
  works_ = diagnosis.working_link;
  asking_.ask({"Use the setting that answers?",
               fmt::format("{} does not answer, {} does.", link, diagnosis.working_link), "use it", "leave it"},
              [this, working = diagnosis.working_link] {
                if (const auto choice = parsed_link(working, "LINK")) form_ = LinkForm(*choice);
                take(working);
              });
}

// --- taking and storing
void LinkController::use() {
  if (const auto choice = chosen()) take(to_text(*choice));
}

void LinkController::take(const std::string& link) {
  if (!idle()) return;
  const auto choose = [unit = unit_, link](JobControl&) {
    unit->choose(link);
    return link;
  };
  task_.start("changing the link", choose, [this](const std::string& chosen) {
    note_remark(fmt::format("from here on over the link {}", chosen));
    message_.say(fmt::format("{} is in use now; s stores it for the next start", chosen));
  });
}

void LinkController::store() {
  const auto choice = chosen();
  if (!choice) return;
  const std::string link = to_text(*choice);
  const WatchedUnit now = unit_->snapshot();
  if (link == works_ || (now.open && now.link == link)) return store_now(link);
  asking_.ask({"Store a link that has not answered?",
               fmt::format("{} was not tried with success. t tries it first.", link), "store it", "not now"},
              [this, link] { store_now(link); });
}

void LinkController::store_now(const std::string& link) {
  if (const auto done = store_link(link); !done) return message_.say(done.error());
  stored_ = link;
  if (link == works_ || unit_->snapshot().link == link)
    note_command({"doctor", "--link", link, "--save"});
  else
    note_remark(fmt::format("{} was stored as the link without an answer; `{}` stores it when it works", link,
                            shell_command({"ecs", "doctor", "--link", link, "--save"})));
  message_.say(
      fmt::format("{} stored in {}: used from now on where no --link is given", link, configuration_file().string()));
}

}  // namespace ecs::commissioning
