#include "tests/world/world.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/random.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "tests/world/forger.hpp"
#include "tests/world/line.hpp"
#include "tests/world/rules.hpp"
#include "tests/world/seed.hpp"

namespace ecs::world {
namespace {

using namespace std::chrono_literals;
using protocol::Command;
using protocol::CommandCode;
using protocol::CommandResult;
using protocol::CommandState;
using protocol::UnitError;

const std::string kCode = "271828";
constexpr Span kLongestNoise = 4h;
/// When faults have stopped, a map sent again and again is active within this time.
constexpr Span kCalmLimit = 3min;
constexpr Span kBetweenSends = 5s;

// --- hosts
class Secrets final : public protocol::SecretStore {
 public:
  std::optional<protocol::Secret> secret_of(const std::string&) override { return secret_; }
  void keep(const std::string&, const protocol::Secret& secret) override { secret_ = secret; }
  void lose() { secret_.reset(); }

 private:
  std::optional<protocol::Secret> secret_;
};

struct Host {
  bool knows_code = true;
  bool gives_code = true;  ///< to every program; otherwise only to one that arms, and the others find the secret
  std::uint64_t key = 0;
  std::shared_ptr<Secrets> secrets = std::make_shared<Secrets>();
  std::atomic<bool> cancelled = false;
  std::unique_ptr<Program> program{};
  bool wants_arming = true;  ///< this time `ecs unit arm` comes before
  Attempt attempt{};         ///< the last one
};

/// What happens when the unit is asked for something, or writes.
enum class Action : std::uint8_t { supply, process, power, battery, bit, silence, cancel, kill, cut, sessions };
struct Moment {
  CommandCode at = CommandCode::none;  ///< none: at a write to memory
  int which = 1;
  Action action = Action::supply;
};

class World {
 public:
  World(std::uint64_t seed, const Breaks& breaks, const std::function<void(const std::string&)>& say);
  Report run();

 private:
  [[nodiscard]] std::uint32_t draw(std::uint32_t count) { return one_of(random_, count); }
  [[nodiscard]] Span draw(Span from, Span to) {
    return from + Span(static_cast<Span::rep>(uniform(random_) * double((to - from).count())));
  }
  [[nodiscard]] bool now_and_then(double probability) { return chance(random_, probability); }

  void begin();
  void draw_faults();
  void install(std::size_t image);
  void hear(int from, int to, const Bytes& frame);
  void hear_unit(int to, const Bytes& pdu);
  void before_command(const Command& command);
  void before_write(Address address, std::span<const std::uint8_t> bytes);
  void before_keep();
  void strike(Action action);
  void look();
  void restart(bool power, Span off);
  [[nodiscard]] Host& join(std::string name, bool knows_code);
  [[nodiscard]] Result<protocol::UnitClient> connected(Host& host);
  void send(Host& host, std::size_t image);
  void uploads(Host& host);
  void operates(Host& host);
  void give_rare_command(protocol::UnitClient& client);
  void tries_without_code(Host& host);
  void calm();

  Breaks breaks_;
  SeededChance chance_;
  Random random_;
  Random line_random_;
  Schedule schedule_;
  Record record_;
  std::vector<std::unique_ptr<Host>> hosts_;
  std::vector<std::unique_ptr<Program>> dead_programs_;  ///< events may still name them
  std::map<int, Host*> host_at_;
  std::unique_ptr<Place> place_;
  std::optional<Rules> rules_;
  std::unique_ptr<Line> line_;
  std::unique_ptr<Forger> forger_;
  std::vector<Moment> moments_;
  std::map<CommandCode, int> commands_;
  int writes_ = 0;
  // of the request at hand
  bool ends_process_ = false, ends_power_ = false;
  CommandCode last_command_ = CommandCode::none;
  bool supply_comes_back_ = false;
  bool calm_ = false, ended_ = false;
};

World::World(std::uint64_t seed, const Breaks& breaks, const std::function<void(const std::string&)>& say)
    : breaks_(breaks),
      chance_(seed * 3 + 1),
      random_(seed * 3 + 2),
      line_random_(seed * 3 + 3),
      record_(schedule_, say) {}

void World::install(std::size_t image) {
  emulator::UnitMemory& memory = place_->unit().memory();
  const Bytes& bytes = images()[image];
  memory.write(kBankA.first, bytes);
  std::array<std::uint8_t, kCommitSlotBytes> record{};
  encode_commit({1, 0, static_cast<std::uint32_t>(bytes.size()), ImageView(bytes).check()}, record);
  memory.write(kCommitRecords.first, record);
}

/// Which faults are possible in this world, and how often they strike: most worlds have few kinds, so that each meets
/// the others in every mixture and uploads get far enough.
void World::draw_faults() {
  if (now_and_then(0.15)) return;
  const double often = std::array{0.003, 0.01, 0.03, 0.1}[draw(4)];
  for (std::size_t fault = 0; fault < kFaults; ++fault) {
    if (!now_and_then(0.3)) continue;
    const auto which = static_cast<LineFault>(fault);
    const bool heavy = which == LineFault::silence || (which == LineFault::cut && !line_->shared());
    line_->probability[fault] = heavy ? std::min(often, 0.01) : often;
  }
}

void World::begin() {
  const bool shared = now_and_then(0.6);
  place_ = std::make_unique<Place>(
      schedule_, random_,
      Looks{[this](const Command& command) { before_command(command); },
            [this](const Command& command, const CommandResult& result) { rules_->after_command(command, result); },
            [this](Address address, std::span<const std::uint8_t> bytes) { before_write(address, bytes); },
            [this] { before_keep(); }},
      breaks_.unit, kCode, now_and_then(0.1));
  place_->disk.lies = now_and_then(0.1);
  rules_.emplace(record_, schedule_, *place_, images(), place_->disk.lies);
  line_ = std::make_unique<Line>(schedule_, line_random_, *place_, shared,
                                 std::array{9'600, 115'200, 115'200, 921'600}[draw(4)]);
  line_->turnaround = now_and_then(0.2) ? draw(1ms, 200ms) : Span(1ms);
  line_->heard = [this](int from, int to, const Bytes& frame) { hear(from, to, frame); };
  line_->arrives = [this](int /*from*/, const Bytes& pdu) { rules_->arrives(pdu); };
  if (now_and_then(0.9)) install(draw(kImages));
  if (now_and_then(0.5)) {  // what an earlier transfer has left
    const Bytes& left = images()[draw(kImages)];
    const std::size_t most = left.size() / (1 + draw(3));
    place_->unit().memory().write(emulator::inactive_bank(place_->unit().memory()), ByteView(left).first(most));
  }
  place_->keep_battery();
  place_->supply(false);
  place_->supply(true);
  look();
  draw_faults();
  Host& sender = join("sender", true);
  sender.gives_code = now_and_then(0.7);
  sender.program = std::make_unique<Program>(schedule_, [this, &sender] { uploads(sender); });
  if (now_and_then(0.25)) {
    Host& second = join("second sender", true);
    if (now_and_then(0.3)) second.key = sender.key, second.secrets = sender.secrets;
    second.program = std::make_unique<Program>(schedule_, [this, &second] { uploads(second); });
  }
  for (std::uint32_t left = now_and_then(0.25) ? 1 + draw(2) : 0; left > 0; --left) {
    Host& other = join(left == 1 ? "operator" : "second operator", true);
    if (now_and_then(0.3)) other.key = sender.key, other.secrets = sender.secrets;
    other.program = std::make_unique<Program>(schedule_, [this, &other] { operates(other); });
  }
  if (now_and_then(0.25)) {
    Host& other = join("stranger", false);
    other.program = std::make_unique<Program>(schedule_, [this, &other] { tries_without_code(other); });
  }
  if (now_and_then(0.3)) forger_ = std::make_unique<Forger>(schedule_, random_, *line_);
  for (std::uint32_t left = draw(3); left > 0; --left) {
    Moment moment;
    moment.action = static_cast<Action>(draw(10));
    moment.at = std::array{CommandCode::commit_staged, CommandCode::commit_staged, CommandCode::begin_staging,
                           CommandCode::none}[draw(4)];
    moment.which = moment.at == CommandCode::none ? 1 + static_cast<int>(draw(40)) : 1 + static_cast<int>(draw(2));
    moments_.push_back(moment);
  }
  if (now_and_then(0.15)) schedule_.after(draw(0s, 10s), [this] { strike(static_cast<Action>(draw(10))); });
}

Host& World::join(std::string name, bool knows_code) {
  hosts_.push_back(std::make_unique<Host>());
  Host& host = *hosts_.back();
  host.attempt.host = std::move(name);
  host.knows_code = knows_code;
  host.key = random_() | 1U;
  return host;
}

void World::hear(int from, int to, const Bytes& frame) {
  const auto at_us = (schedule_.now() - Time{}).count();
  record_.trace(&at_us, sizeof at_us);
  record_.trace(&from, sizeof from);
  record_.trace(frame.data(), frame.size());
  if (record_.is_heard()) {
    const auto host = host_at_.find(from == kUnitEnd ? to : from);
    const std::string who = host == host_at_.end() ? "forger" : host->second->attempt.host;
    std::string bytes;
    for (std::size_t i = 1; i < std::min<std::size_t>(frame.size(), 26); ++i) bytes += fmt::format("{:02X}", frame[i]);
    record_.say("{} {} {} bytes: {}", from == kUnitEnd ? "  unit to" : "to unit from", who, frame.size(), bytes);
  }
  if (forger_ && !calm_) forger_->hear(from, to, frame);
  if (from == kUnitEnd) return hear_unit(to, Line::unframed(frame));
  const auto found = host_at_.find(from);
  if (found == host_at_.end()) return;
  Host& host = *found->second;
  const Bytes pdu = Line::unframed(frame);
  const Bytes meaning = meaning_of(pdu);
  if (meaning.size() < 2) return;
  const std::size_t first = std::size_t{meaning[0]} << 8 | meaning[1];
  if (host.knows_code) rules_->meant(pdu);
  constexpr std::size_t kCodeAt = 2 + 2 * 6 + 1;
  if (first == protocol::kArmConfirm.first) host.attempt.armed_in_it = true;
  if (first == protocol::kResultSelect.first && host.attempt.commit_sent) {
    host.attempt.settles = true;
    record_.reached(Sometimes::commit_answer_lost);
  }
  if (first != protocol::kCommand.first || meaning.size() <= kCodeAt) return;
  const auto code = static_cast<CommandCode>(meaning[kCodeAt]);
  if (code == CommandCode::begin_staging) host.attempt.staging = true, host.attempt.armed_in_it = false;
  if (code == CommandCode::commit_staged) host.attempt.commit_sent = true;
}

/// What the unit refuses, and why.
void World::hear_unit(int to, const Bytes& pdu) {
  const auto host = host_at_.find(to);
  constexpr std::size_t kResult = 2 + 2 * protocol::kCommandResult.count, kAck = 2 + 2 * protocol::kWindowAck.count,
                        kArm = 2 + 2 * protocol::kArmAnswer.count;
  if (host != host_at_.end() && pdu.size() == kArm && (pdu[6] != 0 || pdu[7] != 0))  // "try again in … s"
    record_.reached(Sometimes::code_delayed);
  if (host == host_at_.end() || (pdu.size() != kResult && pdu.size() != kAck)) return;
  const auto error = static_cast<UnitError>(pdu[pdu.size() == kResult ? 15 : 9]);
  if (pdu.size() == kAck && error == UnitError::check_mismatch) record_.reached(Sometimes::window_closed_by_forger);
  if (error == UnitError::wrong_key) record_.reached(Sometimes::wrong_key_refused);
  if (pdu.size() == kResult && error == UnitError::late) record_.reached(Sometimes::late_refused);
  if (pdu.size() == kResult && error == UnitError::overtaken) record_.reached(Sometimes::overtaken_refused);
}

void World::before_command(const Command& command) {
  rules_->before_command(command);
  const int which = ++commands_[command.code];
  last_command_ = command.code;
  for (const Moment& moment : moments_)
    if (moment.at == command.code && moment.which == which) strike(moment.action);
}

void World::before_write(Address address, std::span<const std::uint8_t> bytes) {
  rules_->before_write(address, bytes);
  ++writes_;
  for (const Moment& moment : moments_)
    if (moment.at == CommandCode::none && moment.which == writes_) strike(moment.action);
}

void World::before_keep() {
  const Disk& disk = place_->disk;
  if (disk.writes_fail > 0 || disk.names_fail > 0) record_.reached(Sometimes::battery_not_written);
  if (!disk.ends_after) return;
  record_.reached(
      std::array{Sometimes::process_ended_before_battery, Sometimes::process_ended_before_name,
                 Sometimes::process_ended_after_battery}[static_cast<std::size_t>(std::max(0, *disk.ends_after))]);
}

void World::strike(Action action) {
  if (calm_ || !place_->running()) return;
  const auto some_host = [this]() -> Host& { return *hosts_[draw(static_cast<std::uint32_t>(hosts_.size()))]; };
  switch (action) {
    case Action::supply:
      record_.say("the supply fails within the next bytes");
      place_->unit().memory().power_fails_after(draw(140));
      return;
    case Action::power:
      ends_power_ = true;
      [[fallthrough]];
    case Action::process:
      record_.say("the process of the unit ends");
      place_->disk.ends_after = static_cast<int>(draw(3));
      ends_process_ = true;
      schedule_.after(1ms, [this] { look(); });
      return;
    case Action::battery:
      record_.say("the battery file cannot be written");
      place_->disk.writes_fail = static_cast<int>(draw(3));
      place_->disk.names_fail = 1 + static_cast<int>(draw(2));
      if (now_and_then(0.3)) schedule_.after(draw(1ms, 600ms), [this] { strike(Action::process); });
      return;
    case Action::bit: {
      const Address bank = emulator::inactive_bank(place_->unit().memory());
      const Address at = bank + draw(static_cast<std::uint32_t>(images()[3].size()));
      record_.say("a bit of {:06X} flips", at);
      if (commands_[CommandCode::commit_staged] > 0) record_.reached(Sometimes::staged_bit_flipped);
      place_->unit().memory().corrupt(at, static_cast<std::uint8_t>(1U << draw(8)));
      return;
    }
    case Action::silence:
      record_.say("the line is dead");
      line_->dead_until = schedule_.now() + draw(100ms, 20s);
      return;
    case Action::cancel: {
      Host& host = some_host();
      record_.say("{} is cancelled", host.attempt.host);
      schedule_.after(draw(0ms, 50ms), [this, &host] {
        if (calm_) return;
        host.cancelled = true;
        host.program->wake();
      });
      return;
    }
    case Action::kill: {
      Host& host = some_host();
      schedule_.after(draw(0ms, 50ms), [this, &host] {
        if (host.program->ended() || calm_) return;
        record_.say("{} is killed", host.attempt.host);
        if (host.attempt.staging) record_.reached(Sometimes::host_killed_while_staging);
        const bool sends = holds(host.attempt.host, "sender");
        host.program->kill();
        host.attempt.sends = false;
        dead_programs_.push_back(std::move(host.program));
        host.program = std::make_unique<Program>(schedule_, [this, &host, sends] {
          if (sends) uploads(host);
        });
      });
      return;
    }
    case Action::cut:
      line_->cut_all();
      return;
    case Action::sessions:
      if (forger_) forger_->open_sessions();
      return;
  }
}

/// After everything that happens.
void World::look() {
  if (ended_) return;
  if (ends_process_ || place_->disk.process_ended()) {
    if (!place_->process_runs()) return;
    if (!place_->disk.process_ended()) rules_->look_at_map();
    restart(ends_power_, draw(1ms, 5s));
    return;
  }
  if (!place_->process_runs()) return;
  if (!place_->unit().powered() && !supply_comes_back_) {
    record_.say("no supply");
    record_.reached(last_command_ == CommandCode::commit_staged ? Sometimes::supply_lost_in_record
                                                                : Sometimes::supply_lost_while_staging);
    supply_comes_back_ = true;
    schedule_.after(calm_ ? Span(1ms) : draw(1ms, 5s), [this] {
      supply_comes_back_ = false;
      if (!place_->process_runs()) return;
      place_->supply(true);
      record_.say("supply is back{}", place_->running() ? "" : "; the unit does not start without its battery file");
      look();
    });
    rules_->look_at_map();
    return;
  }
  rules_->look_at_map();
  rules_->look_at_outputs();
}

void World::restart(bool power, Span off) {
  record_.say("the unit's process has ended{}", power ? ", with the power of its computer" : "");
  ends_process_ = ends_power_ = false;
  if (place_->end_process(power)) record_.reached(Sometimes::file_taken_back_by_power);
  schedule_.after(calm_ ? Span(1ms) : off, [this] {
    if (place_->process_runs()) return;
    if (!place_->start_process()) {
      record_.reached(Sometimes::torn_file_refused_or_isolated);
      if (!place_->disk.torn()) record_.violated("the battery file is refused");
    }
    rules_->unit_started();
    record_.say("the unit has started");
    look();
  });
}

Result<protocol::UnitClient> World::connected(Host& host) {
  protocol::LinkOptions options;
  options.cancelled = &host.cancelled;
  options.line = [this, &host] {
    auto end = std::make_unique<HostEnd>(*line_, host.attempt.answered_since);
    host_at_[end->number()] = &host;
    return end;
  };
  return protocol::UnitClient::connect(
      line_->address(), options,
      {host.key, host.attempt.host, host.knows_code && host.gives_code ? kCode : std::string(), host.secrets});
}

/// `ecs map send`, from opening the link on.
void World::send(Host& host, std::size_t image) {
  host.attempt.begun = host.attempt.answered_since = schedule_.now();
  host.attempt.sends = true;
  host.attempt.image = image;
  host.attempt.staging = host.attempt.commit_sent = host.attempt.armed_in_it = host.attempt.settles = false;
  record_.say("{} sends map {}", host.attempt.host, image);
  rules_->begins(host.attempt);
  Result<commissioning::SentMap> sent = tl::unexpected(Problem{});
  {
    auto client = connected(host);
    if (!client) {
      sent = tl::unexpected(client.error());
    } else {
      if (!host.gives_code && host.wants_arming) host.wants_arming = !client->arm(kCode);
      const auto status = client->status();
      if (status && status->mode != UnitMode::integration) (void)client->enter_integration();
      commissioning::PreparedMap map;
      map.header.machine = kMachine;
      map.header.serial_number = kSerialNumber;
      map.header.configuration = "TXYZ";
      map.image.bytes = images()[image];
      sent = commissioning::send_map(*client, map, "map.csv", false);
    }
  }
  host.attempt.sends = false;
  if (breaks_.host == HostBreak::believes_commits && !sent && host.attempt.commit_sent)
    sent = commissioning::SentMap{{}, {}, 0, {}, 0.0};
  host.wants_arming = host.wants_arming || !sent;
  std::vector<const Attempt*> others;
  for (const auto& other : hosts_)
    if (other->attempt.sends) others.push_back(&other->attempt);
  rules_->ends(host.attempt, sent, host.cancelled, others);
}

void World::uploads(Host& host) {
  schedule_.wait_until(schedule_.now() + draw(0ms, 300ms));
  const std::array two{draw(kImages), draw(kImages)};
  for (std::uint32_t left = 1 + draw(4); left > 0; --left) {
    send(host, two[draw(2)]);
    if (now_and_then(0.1)) host.secrets->lose();
    host.cancelled = false;
    const Time until = schedule_.now() + (now_and_then(0.02)   ? draw(1790s, 1802s)  // a host is armed for 30 min
                                          : now_and_then(0.05) ? draw(1s, 90s)
                                                               : draw(1ms, 2s));
    schedule_.wait_until(until);
  }
}

void World::give_rare_command(protocol::UnitClient& client) {
  switch (draw(12)) {
    case 0:
      (void)client.enter_compensation();
      break;
    case 1:
      (void)client.reset_unit();
      break;
    case 2:
    case 3:
      (void)client.disarm();
      break;
    case 4:
      (void)client.enter_integration();
      break;
    case 5:
      (void)client.set_tool({static_cast<std::uint16_t>(1 + draw(3)), {}});
      break;
    case 6:
      (void)client.select_tool(static_cast<std::uint16_t>(draw(4)));
      break;
    case 7:
      (void)client.remove_tool(static_cast<std::uint16_t>(1 + draw(3)));
      break;
    default:
      (void)client.set_axis_position(Axis::X, 1.0);
      break;
  }
}

/// Gives commands that act, and some that switch off.
void World::operates(Host& host) {
  schedule_.wait_until(schedule_.now() + draw(0ms, 3s));
  for (std::uint32_t connections = 1 + draw(2); connections > 0; --connections) {
    auto client = connected(host);
    if (!client) continue;
    (void)client->enter_integration();
    for (std::uint32_t left = 1 + draw(8); left > 0 && !host.cancelled; --left) {
      const auto axis = static_cast<Axis>(draw(3));
      switch (draw(9)) {
        case 0:
        case 1:
        case 2:
        case 3:
          (void)client->output_compensation(axis, uniform(random_) * 100.0, now_and_then(0.7));
          break;
        case 4:
        case 5:
          (void)client->output_off();
          break;
        case 6:
          (void)client->write_memory(kSystemRam.first + 0x2000, images()[0]);
          break;
        case 7:
          (void)client->monitor();
          break;
        default:
          give_rare_command(*client);
          break;
      }
      host.cancelled = false;
      schedule_.wait_until(schedule_.now() + (now_and_then(0.05) ? draw(50s, 70s) : draw(1ms, 1s)));
    }
  }
  host.cancelled = false;
}

void World::tries_without_code(Host& host) {
  schedule_.wait_until(schedule_.now() + draw(0ms, 3s));
  auto client = connected(host);
  for (std::uint32_t left = 1 + draw(8); client && left > 0 && !host.cancelled; --left) {
    Result<void> done;
    switch (draw(6)) {
      case 0:
        done = client->output_compensation(Axis::X, 50.0, true);
        break;
      case 1:
        if (client->output_off() && place_->running()) record_.reached(Sometimes::output_opened_by_stranger);
        break;
      case 2:
        done = client->arm(fmt::format("{:06}", draw(100'000)));
        break;
      case 3:
        done = client->begin_staging(protocol::StagingFrom::cleared).map([](Address) {});
        break;
      case 4:
        done = client->write_memory(kSystemRam.first, images()[0]);
        break;
      default:
        (void)client->status();
        break;
    }
    if (!done && done.error().kind == ProblemKind::refused) record_.reached(Sometimes::stranger_refused);
    schedule_.wait_until(schedule_.now() + draw(1ms, 2s));
  }
}

/// The faults stop: the map is sent again until it is active.
void World::calm() {
  calm_ = true;
  line_->quiet();
  if (forger_) forger_->fall_silent();
  line_->turnaround = 1ms;
  place_->disk.writes_fail = place_->disk.names_fail = 0;
  place_->disk.lies = false;
  if (place_->process_runs()) place_->unit().memory().power_back();
  for (const auto& host : hosts_) {
    if (!host->program->ended()) host->program->kill();
    host->cancelled = false;
    host->attempt.sends = false;
  }
  const Time begun = schedule_.now();
  Host& host = *hosts_.front();
  const std::size_t image = draw(kImages);
  bool active = false;
  dead_programs_.push_back(std::move(host.program));
  host.program = std::make_unique<Program>(schedule_, [&] {
    for (int sends = 0; !active; ++sends) {
      if (sends == 1) record_.reached(Sometimes::needed_second_send_when_calm);
      const auto right_before = record_.report.endings["right"] + record_.report.endings["right, already held"];
      send(host, image);
      active = record_.report.endings["right"] + record_.report.endings["right, already held"] > right_before;
      if (!active) schedule_.wait_until(schedule_.now() + kBetweenSends);
    }
  });
  look();
  while (!host.program->ended() && record_.report.violations.empty() && schedule_.now() < begun + kCalmLimit)
    if (schedule_.step(begun + kCalmLimit)) look();
  record_.report.calm_s = std::chrono::duration<double>(schedule_.now() - begun).count();
  if (!active && record_.report.violations.empty())
    record_.violated("{} s after the faults have stopped map {} is not active", record_.report.calm_s, image);
  if (active && place_->active() != images()[image]) record_.violated("map {} is not active at the end", image);
}

Report World::run() {
  begin();
  Host& sender = *hosts_.front();
  const Time end = schedule_.now() + kLongestNoise;
  while (!sender.program->ended() && record_.report.violations.empty() && schedule_.now() < end)
    if (schedule_.step(end)) look();
  if (!sender.program->ended() && record_.report.violations.empty())
    record_.violated("{} has not ended", sender.attempt.host);
  if (record_.report.violations.empty()) calm();
  ended_ = true;
  for (const auto& host : hosts_)
    if (!host->program->ended()) host->program->kill();
  record_.report.frames = line_->frames;
  for (const auto struck : line_->struck) record_.report.faults += struck;
  if (line_->collisions > 0) record_.reached(Sometimes::collision);
  if (line_->struck[static_cast<std::size_t>(LineFault::flip_agreeing)] > 0)
    record_.reached(Sometimes::spoilt_frame_taken);
  record_.report.virtual_s = std::chrono::duration<double>(schedule_.now() - Time{1h}).count();
  return std::move(record_.report);
}

}  // namespace

Report run_world(std::uint64_t seed, const Breaks& breaks, const std::function<void(const std::string&)>& say) {
  World world(seed, breaks, say);
  return world.run();
}

}  // namespace ecs::world
