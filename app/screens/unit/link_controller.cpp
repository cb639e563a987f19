#include "app/screens/unit/link_controller.hpp"

#include <fmt/format.h>

#include "commissioning/link/port_survey.hpp"

namespace ecs::app {
namespace {

using Clock = std::chrono::steady_clock;

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
  const std::lock_guard lock(told_->mutex);
  return told_->answer;
}

double LinkController::seconds_working() const { return std::chrono::duration<double>(Clock::now() - begun_).count(); }

bool LinkController::advance() {
  bool changed = !label_.empty();
  if (auto landing = job_.take()) {
    label_.clear();
    (*landing)(*this);
    changed = true;
  }
  std::uint64_t told = 0;
  {
    const std::lock_guard lock(told_->mutex);
    told = told_->changes;
  }
  const std::uint64_t unit = unit_->changes();
  changed = changed || told != told_seen_ || unit != unit_seen_;
  told_seen_ = told;
  unit_seen_ = unit;
  return changed;
}

bool LinkController::begin(std::string label, Job<Landing>::Work work) {
  if (job_.running()) {
    message_.say(fmt::format("still {}: Esc gives it up", label_.empty() ? "looking" : label_), Tone::warning);
    return false;
  }
  label_ = std::move(label);
  begun_ = Clock::now();
  job_.start(std::move(work));
  return true;
}

void LinkController::look_for_ports() {
  (void)begin("looking for serial ports", [where = unit_->standing().where](JobControl&) -> Landing {
    const auto found = survey(where);
    return [found](LinkController& connection) {
      connection.ports_ = found;
      connection.ports_known_ = true;
    };
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
  if (!choice) return false;
  const std::string link = to_text(*choice);
  const auto told = told_;
  const auto note = [told](const std::string& text) {
    const std::lock_guard lock(told->mutex);
    told->answer.trying = text;
    ++told->changes;
  };
  const auto heard = [told](const DoctorFinding& finding) {
    const std::lock_guard lock(told->mutex);
    told->answer.findings.push_back(finding);
    ++told->changes;
  };
  const bool begun =
      begin("trying " + link, [unit = unit_, choice = *choice, note, heard](JobControl& control) -> Landing {
        const auto lent = unit->lend();
        note("asking the unit");
        const Diagnosis diagnosis = diagnosis_of(choice, note, heard, control.cancelled);
        return [diagnosis, cancelled = control.cancelled.load()](LinkController& connection) {
          connection.ended(diagnosis, cancelled);
        };
      });
  if (!begun) return false;
  const std::lock_guard lock(told->mutex);
  told->answer = {link, "waiting for the line", {}, {}};
  ++told->changes;
  return true;
}

void LinkController::ended(const Diagnosis& diagnosis, bool cancelled) {
  std::string link;
  {
    const std::lock_guard lock(told_->mutex);
    told_->answer.trying.clear();
    told_->answer.diagnosis = diagnosis;
    ++told_->changes;
    link = told_->answer.link;
  }
  if (cancelled) return message_.say("given up: the setting was not tried to its end", Tone::warning);
  if (diagnosis.works) {
    works_ = link;
    return message_.say(link == unit_->link() || link == unit_->standing().link
                            ? fmt::format("{} works", link)
                            : fmt::format("{} works: u uses it now, s stores it", link));
  }
  if (diagnosis.working_link.empty()) return message_.say(fmt::format("{} does not work", link), Tone::bad);
  works_ = diagnosis.working_link;
  question_ = Question{"Use the setting that answers?",
                       fmt::format("{} does not answer, {} does.", link, diagnosis.working_link), "use it", "leave it"};
  if_yes_ = [this, working = diagnosis.working_link] {
    if (const auto choice = parsed_link(working, "LINK")) form_ = LinkForm(*choice);
    take(working);
  };
}

// --- taking and storing
void LinkController::use() {
  if (const auto choice = chosen()) take(to_text(*choice));
}

void LinkController::take(const std::string& link) {
  (void)begin("changing the link", [unit = unit_, link](JobControl&) -> Landing {
    unit->choose(link);
    return [link](LinkController& connection) {
      connection.message_.say(fmt::format("{} is in use now; s stores it for the next start", link));
    };
  });
}

void LinkController::store() {
  const auto choice = chosen();
  if (!choice) return;
  const std::string link = to_text(*choice);
  const WatchedUnit now = unit_->standing();
  if (link == works_ || (now.open && now.link == link)) return store_now(link);
  question_ = Question{"Store a link that has not answered?",
                       fmt::format("{} was not tried with success. t tries it first.", link), "store it", "not now"};
  if_yes_ = [this, link] { store_now(link); };
}

void LinkController::store_now(const std::string& link) {
  if (const auto done = store_link(link); !done) return message_.say(done.error());
  stored_ = link;
  message_.say(
      fmt::format("{} stored in {}: used from now on where no --link is given", link, configuration_file().string()));
}

void LinkController::answer(bool yes) {
  question_.reset();
  const auto act = std::move(if_yes_);
  if_yes_ = {};
  if (yes && act) act();
}

void LinkController::cancel() { job_.cancel(); }

}  // namespace ecs::app
