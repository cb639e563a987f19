#include "commissioning/link/unit_connection.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "commissioning/session/message.hpp"
#include "commissioning/unit/transfer.hpp"

namespace ecs::commissioning {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kBetweenFastLooks = 25ms;  ///< forty a second where the link is fast enough
constexpr auto kBetweenSlowLooks = 1s;
constexpr auto kBeforeNextTry = 1s;
constexpr auto kLeastBetweenInputs = 500ms, kMostBetweenInputs = 5000ms;
constexpr int kRestPerInputs = 20;  ///< they cost a twentieth of the line, as far as they are not too old then
constexpr auto kGlance = 5ms;       ///< how soon a cancel and a wish for the link are seen
constexpr int kFailuresToLose = 3;

std::string where_of(const protocol::UnitClient& client) {
  const auto& line = client.link().address().endpoint;
  if (const auto* serial = std::get_if<protocol::SerialPort>(&line)) return serial->device;
  return "";
}

}  // namespace

UnitConnection::UnitConnection(std::string link) : link_(std::move(link)) {
  guard_ = std::jthread([this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      {
        const std::lock_guard lock(control_mutex_);
        cancelled_ = leaving_ || (control_ != nullptr && control_->cancelled);
      }
      std::this_thread::sleep_for(kGlance);
    }
    cancelled_ = true;
  });
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

UnitConnection::~UnitConnection() {
  leaving_ = true;
  thread_.request_stop();
  thread_.join();
  guard_.request_stop();
  guard_.join();
}

SampledUnit UnitConnection::now() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

WatchedUnit UnitConnection::snapshot() const {
  const std::lock_guard lock(mutex_);
  const WatchedUnit& without_samples = state_;
  return without_samples;
}

std::optional<protocol::MonitorSample> UnitConnection::newest() const {
  const std::lock_guard lock(mutex_);
  if (!state_.open || state_.samples.empty() || state_.newest_at < state_.opened_at) return std::nullopt;
  return state_.samples.back();
}

std::string UnitConnection::link() const {
  const std::lock_guard lock(mutex_);
  return link_;
}

void UnitConnection::know_code(const std::string& code) {
  const std::lock_guard lock(mutex_);
  arm_code_ = code;
  state_.wants_code = false;
  ++changes_;
}

void UnitConnection::choose(const std::string& link) {
  JobControl control;
  const Turn turn(*this, control);
  close();
  emulator_.reset();
  next_try_ = {};
  const std::lock_guard lock(mutex_);
  link_ = link;
  arm_code_.clear();
  state_ = {};
  arrivals_.clear();
  ++changes_;
}

UnitConnection::Turn::Turn(UnitConnection& connection, JobControl& control) : connection_(&connection) {
  ++connection.waiting_;
  link_lock_ = std::unique_lock(connection.link_mutex_, std::defer_lock);
  while (!link_lock_.try_lock() && !control.cancelled) std::this_thread::sleep_for(kGlance);
  --connection.waiting_;
  if (!link_lock_.owns_lock()) return;
  const std::lock_guard lock(connection.control_mutex_);
  connection.control_ = &control;
  connection.cancelled_ = connection.leaving_ || control.cancelled;
}

Problem UnitConnection::link_was_busy() {
  return {ProblemKind::refused, "cancelled while the link to the unit was in use", {}, 0, 0, {}};
}

UnitConnection::Turn::~Turn() {
  if (!link_lock_.owns_lock()) return;
  const std::lock_guard lock(connection_->control_mutex_);
  connection_->control_ = nullptr;
  connection_->cancelled_ = connection_->leaving_.load();
}

UnitConnection::Lent::Lent(UnitConnection& connection) : connection_(&connection) {
  ++connection.waiting_;
  link_lock_ = std::unique_lock(connection.link_mutex_);
  --connection.waiting_;
  connection.close();
  const std::lock_guard lock(connection.mutex_);
  connection.state_.lent = true;
  ++connection.changes_;
}

UnitConnection::Lent::~Lent() {
  connection_->next_try_ = {};
  const std::lock_guard lock(connection_->mutex_);
  connection_->state_.lent = false;
  ++connection_->changes_;
}

void UnitConnection::run(const std::stop_token& stop) {
  auto next = Clock::now();
  while (!stop.stop_requested()) {
    const bool fast = watchers_ > 0;
    if (waiting_ == 0 && (Clock::now() >= next || (fast && next - Clock::now() > kBetweenFastLooks))) {
      look();
      next = Clock::now() + (watchers_ > 0 ? Clock::duration(kBetweenFastLooks) : Clock::duration(kBetweenSlowLooks));
    }
    std::this_thread::sleep_for(kGlance);
  }
  const std::lock_guard lock(link_mutex_);
  close();
}

void UnitConnection::look() {
  const std::lock_guard link_lock(link_mutex_);
  if (!unit_link_ && Clock::now() < next_try_) return;
  if (const auto line = opened(); !line) return;
  if (const auto sample = unit_link_->client().monitor()) {
    failures_ = 0;
    take(*sample);
    if (watchers_ > 0 && wants_system_.exchange(false)) look_at_measurement_system();
    const bool inputs_due = watchers_ > 0 && Clock::now() >= next_inputs_;
    if (inputs_due || (watchers_ > 0 && any_axis(state_.rotary))) look_at_rotary();
    if (inputs_due) look_at_inputs();
  } else {
    ++failures_;
    lost(sample.error());
  }
  settle();
}

void UnitConnection::look_at_inputs() {
  const auto started = Clock::now();
  const auto inputs = unit_link_->client().live_inputs();
  const auto lines = unit_link_->client().control_lines();
  const auto now = Clock::now();
  next_inputs_ =
      now + std::clamp<Clock::duration>(kRestPerInputs * (now - started), kLeastBetweenInputs, kMostBetweenInputs);
  const std::lock_guard lock(mutex_);
  state_.inputs_at = now;
  state_.inputs = inputs ? std::optional(*inputs) : std::nullopt;
  state_.lines = lines ? std::optional(*lines) : std::nullopt;
  ++changes_;
}

void UnitConnection::look_at_rotary() {
  const auto rotary = unit_link_->client().rotary(*state_.identity);
  const std::lock_guard lock(mutex_);
  state_.rotary = rotary.value_or(protocol::RotarySample{});
  ++changes_;
}

/// A unit without parameters, or with a corrupt memory, shows mm.
void UnitConnection::look_at_measurement_system() {
  const auto parameters = receive_parameters(unit_link_->client());
  const std::lock_guard lock(mutex_);
  state_.measurement_system = parameters ? parameters->measurement_system : MeasurementSystem::metric;
  ++changes_;
}

/// Opens the link if there is none. @pre the link is ours
Result<void> UnitConnection::opened() {
  if (unit_link_) return {};
  auto choice = chosen_link(link());
  if (choice) {
    const std::lock_guard lock(mutex_);
    choice->arm_code = arm_code_;
    choice->shares = true;
  }
  auto line = choice ? open_link(*choice, cancelled_) : tl::unexpected(choice.error());
  auto identity = line ? line->client().identity() : tl::unexpected(line.error());
  next_try_ = Clock::now() + kBeforeNextTry;
  if (!identity) {
    if (!cancelled_) lost(identity.error());
    return tl::unexpected(identity.error());
  }
  emulator_ = line->emulator();
  unit_link_ = std::move(*line);
  failures_ = 0;
  next_inputs_ = {};
  wants_system_ = true;
  const std::lock_guard lock(mutex_);
  state_.link = unit_link_->name();
  state_.where = where_of(unit_link_->client());
  state_.open = true;
  state_.emulator = unit_link_->is_emulator();
  state_.workshop = unit_link_->workshop();
  state_.identity = *identity;
  state_.opened_at = Clock::now();
  if (!state_.problem.empty()) log_event(Tone::plain, fmt::format("{} answers again", state_.link));
  state_.problem.clear();
  ++changes_;
  return {};
}

/// A gateway, or a cable put elsewhere, may lead to another unit than the one that the screens speak of.
Result<void> UnitConnection::same_unit(const std::optional<protocol::Identity>& shown) {
  const auto now = unit_link_->client().identity();
  if (!now) {
    ++failures_;
    if (!cancelled_) lost(now.error());
    settle();
    return tl::unexpected(now.error());
  }
  if (!shown || now->serial_number == shown->serial_number) return {};
  const auto other = problem(ProblemKind::refused,
                             "another unit answers on this link: {} instead of {}; the command was not "
                             "carried out. Check this unit and its contents, then repeat the command",
                             now->serial_number, shown->serial_number);
  log_event(Tone::bad, other.value().message);
  close();  // whoever shows the unit takes it for a new link, and reads everything again
  next_try_ = {};
  const std::lock_guard lock(mutex_);
  state_.identity = *now;
  ++state_.times_lost;
  ++changes_;
  return other;
}

void UnitConnection::close() {
  unit_link_.reset();
  const std::lock_guard lock(mutex_);
  state_.open = false;
}

/// After a look or a piece of work: what the link counted, and whether it is to be given up.
void UnitConnection::settle() {
  if (!unit_link_) return;
  const bool gone =
      !unit_link_->client().link().connected() || (unit_link_->emulator() && !unit_link_->emulator()->running());
  {
    const std::lock_guard lock(mutex_);
    state_.statistics = unit_link_->client().link().statistics();
    if (unit_link_->client().take_wants_code()) {
      state_.wants_code = true;
      ++changes_;
    }
    if (gone || failures_ >= kFailuresToLose) {
      ++state_.times_lost;
      ++changes_;
    }
  }
  if (!gone && failures_ < kFailuresToLose) return;
  close();
  next_try_ = Clock::now() + kBeforeNextTry;
}

void UnitConnection::take(const protocol::MonitorSample& sample) {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  arrivals_.push_back(now);
  while (now - arrivals_.front() > 2s) arrivals_.pop_front();
  state_.per_second = static_cast<double>(arrivals_.size()) / 2.0;
  state_.samples.push_back(sample);
  if (state_.samples.size() > kKept) state_.samples.pop_front();
  state_.newest_at = now;
  state_.problem.clear();
  ++state_.received;
  ++changes_;
}

void UnitConnection::lost(const Problem& why) {
  const std::lock_guard lock(mutex_);
  if (state_.problem.empty() && !leaving_) log_event(Tone::bad, to_text(why));  // once, not at every look
  state_.problem = to_text(why);
  ++state_.failed;
  ++changes_;
}

protocol::ProgressCallback progress_into(JobControl& control) {
  return [&control](const protocol::Progress& progress) {
    if (progress.bytes_total > 0)
      control.part = static_cast<double>(progress.bytes_done) / static_cast<double>(progress.bytes_total);
    control.seconds_left = progress.seconds_left;
  };
}

std::vector<std::string> words_on_unit(const UnitConnection& unit, std::vector<std::string> words) {
  words.insert(words.begin(), "ecs");
  const std::string link = unit.snapshot().link.empty() ? unit.link() : unit.snapshot().link;
  if (!link.empty()) words.insert(words.end(), {"--link", link});
  return words;
}

void note_on_unit(const UnitConnection& unit, std::vector<std::string> words, int exit_code) {
  NotedCommand command;
  command.words = words_on_unit(unit, std::move(words));
  command.exit_code = exit_code;
  note(std::move(command));
}

void note_form(const UnitConnection& unit, std::vector<std::string> words, int exit_code) {
  const auto option = std::find(words.begin(), words.end(), "--link");
  if (option != words.end() && option + 1 != words.end()) {
    if (*(option + 1) != unit.link()) return static_cast<void>(note_command(std::move(words), exit_code));
    words.erase(option, option + 2);
  }
  note_on_unit(unit, std::move(words), exit_code);
}

}  // namespace ecs::commissioning
