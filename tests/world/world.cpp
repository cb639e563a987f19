#include "tests/world/world.hpp"

#include <algorithm>
#include <charconv>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <sodium.h>

#include "base/random.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "core/memory_image.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "tests/world/forger.hpp"
#include "tests/world/line.hpp"

namespace ecs::world {
namespace {

using namespace std::chrono_literals;
using protocol::Command;
using protocol::CommandCode;
using protocol::CommandResult;
using protocol::CommandState;
using protocol::UnitError;

const std::string kCode = "271828";
constexpr Span kLongestAttempt = 10min;
constexpr Span kLongestNoise = 4h;
/// When faults have stopped, a map sent again and again is active within this time.
constexpr Span kCalmLimit = 3min;
constexpr Span kBetweenSends = 5s;
/// A command that acts is carried out at most so long after it was sent: kMostAge_ms, and a period of the loop.
constexpr Span kMostAge = 2020ms;

// --- the system's source of chance, from the seed
Random* chance_source = nullptr;

std::uint32_t chance_word() { return static_cast<std::uint32_t>((*chance_source)()); }
void chance_bytes(void* out, const std::size_t size) {
  auto* bytes = static_cast<std::uint8_t*>(out);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>((*chance_source)() >> 32);
}
const char* chance_name() { return "seed of a world"; }

/// Until its end every number by chance of protocol and sodium comes from here.
class SeededChance {
 public:
  explicit SeededChance(std::uint64_t seed) : random_(seed) {
    static randombytes_implementation seeded{chance_name, chance_word, nullptr, nullptr, chance_bytes, nullptr};
    static const int ready = ::sodium_init();  // draws numbers itself, once
    (void)ready;
    chance_source = &random_;
    randombytes_set_implementation(&seeded);
  }

 private:
  Random random_;
};

// --- maps
constexpr std::size_t kImages = 4;
const std::string kSerialNumber = "EMULATOR-1", kMachine = "mill";

Bytes an_image(std::uint32_t values, bool rough, std::uint32_t number) {
  const ImagePlan plan{2, values, 0};
  Bytes image(image_bytes(plan));
  UnitParameters parameters;
  parameters.loop_period_us = 20'000.0;
  begin_image(image, plan);
  write_parameters(image, parameters);
  write_entry(image, 0, {Component::EXX, Approach::unknown, false, 0, values / 2, 0.0, 10.0, 0.01});
  write_entry(image, 1, {Component::EYY, Approach::unknown, false, values / 2, values - values / 2, 0.0, 10.0, 0.01});
  std::mt19937 random(number);
  for (std::uint32_t i = 0; i < values; ++i)
    write_value(image, i, static_cast<std::int16_t>(rough ? int(random() % 4000) - 2000 : int(i * (number + 3))));
  write_identity(image, {kSerialNumber, kMachine, configuration_hash(parameters)});
  seal_image(image);
  return image;
}

/// Small, smooth, rough, and rough with the end of another one.
const std::array<Bytes, kImages>& images() {
  static const std::array<Bytes, kImages> all{an_image(40, false, 1), an_image(900, false, 2), an_image(700, true, 3),
                                              an_image(420, true, 4)};
  return all;
}

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
  std::string name;
  bool knows_code = true;
  bool gives_code = true;  ///< to every program; otherwise only to one that arms, and the others find the secret
  std::uint64_t key = 0;
  std::shared_ptr<Secrets> secrets = std::make_shared<Secrets>();
  std::atomic<bool> cancelled = false;
  std::unique_ptr<Program> program{};
  Time answered_since{};
  bool wants_arming = true;  ///< this time `ecs unit arm` comes before
  // of the attempt under way
  Time begun{};
  bool sends = false;
  std::size_t image = 0;
  bool staging = false, commit_sent = false, armed_in_it = false, settles = false;
};

/// The map that was active from then on.
struct Held {
  Time since{};
  std::optional<std::size_t> image;  ///< nothing: none, or a torn one that the unit refuses
  std::uint32_t commit = 0;
};

/// Told to the user at the end of an attempt: that map is not active, and will not become so by this attempt.
struct NotTaken {
  Time since{};
  std::size_t image = 0;
  bool over = false;  ///< somebody has begun to send the same map
};

bool holds(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

/// The number behind `words`; nothing: they are not there.
std::optional<std::uint32_t> number_after(const std::string& text, std::string_view words) {
  const auto at = text.find(words);
  if (at == std::string::npos) return std::nullopt;
  std::uint32_t number = 0;
  const char* const from = text.data() + at + words.size();
  return std::from_chars(from, text.data() + text.size(), number).ec == std::errc() ? std::optional(number)
                                                                                    : std::nullopt;
}

/// A request without what a repeat of it changes: function, first register written, registers behind the echo.
Bytes meaning_of(std::span<const std::uint8_t> pdu) {
  if (pdu.empty() || (pdu[0] != 16 && pdu[0] != 23)) return {};
  const std::size_t at = pdu[0] == 23 ? 5 : 1;
  if (pdu.size() < at + 5) return {};
  Bytes meaning{pdu[at], pdu[at + 1]};
  const bool echoed = (pdu[at] << 8 | pdu[at + 1]) != protocol::kBlockWrite.first;
  const std::size_t from = std::min(pdu.size(), at + (echoed ? 7 : 5));
  meaning.insert(meaning.end(), pdu.begin() + static_cast<std::ptrdiff_t>(from), pdu.end());
  return meaning;
}

std::uint64_t hash_of(std::uint64_t hash, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001B3ULL;
  return hash;
}

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
  template <class... Words>
  void say(fmt::format_string<Words...> format, Words&&... words) {
    if (!say_) return;
    const double s = std::chrono::duration<double>(schedule_.now() - Time{1h}).count();
    say_(fmt::format("{:10.4f} {}", s, fmt::format(format, std::forward<Words>(words)...)));
  }
  template <class... Words>
  void violated(fmt::format_string<Words...> format, Words&&... words) {
    report_.violations.push_back(fmt::format(format, std::forward<Words>(words)...));
    say("VIOLATION {}", report_.violations.back());
  }
  void reached(Sometimes state) { ++report_.reached[static_cast<std::size_t>(state)]; }
  [[nodiscard]] std::uint32_t draw(std::uint32_t count) { return one_of(random_, count); }
  [[nodiscard]] Span draw(Span from, Span to) {
    return from + Span(static_cast<Span::rep>(uniform(random_) * double((to - from).count())));
  }
  [[nodiscard]] bool now_and_then(double probability) { return chance(random_, probability); }
  void trace(const void* data, std::size_t size) { report_.trace = hash_of(report_.trace, data, size); }

  void begin();
  void draw_faults();
  void install(std::size_t image);
  void hear(int from, int to, const Bytes& frame);
  void hear_unit(int to, const Bytes& pdu);
  void before_command(const Command& command);
  void after_command(const Command& command, const CommandResult& result);
  void before_write(Address address, std::span<const std::uint8_t> bytes);
  void before_keep();
  void strike(Action action);
  void look();
  void look_at_map();
  void look_at_outputs();
  void restart(bool power, Span off);
  [[nodiscard]] Host& join(std::string name, bool knows_code);
  [[nodiscard]] Result<protocol::UnitClient> connected(Host& host);
  void send(Host& host, std::size_t image);
  void judge(Host& host, const Result<commissioning::SentMap>& sent, bool cancelled);
  [[nodiscard]] bool was_held(Time from, Time to, const std::function<bool(const Held&)>& held) const;
  void uploads(Host& host);
  void operates(Host& host);
  void give_rare_command(protocol::UnitClient& client);
  void tries_without_code(Host& host);
  void calm();

  std::function<void(const std::string&)> say_;
  Breaks breaks_;
  SeededChance chance_;
  Random random_;
  Random line_random_;
  Schedule schedule_;
  Report report_;
  std::vector<std::unique_ptr<Host>> hosts_;
  std::vector<std::unique_ptr<Program>> dead_programs_;  ///< events may still name them
  std::map<int, Host*> host_at_;
  std::unique_ptr<Place> place_;
  std::unique_ptr<Line> line_;
  std::unique_ptr<Forger> forger_;
  std::vector<Moment> moments_;
  std::map<CommandCode, int> commands_;
  int writes_ = 0;
  // of the request at hand
  bool ends_process_ = false, ends_power_ = false;
  CommandCode last_command_ = CommandCode::none;
  std::set<std::uint64_t> meant_;  ///< by a host that knows the code
  std::map<std::uint64_t, Time> meant_at_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> carried_out_;
  std::set<std::uint64_t> carried_out_meanings_;
  Time stopped_{};  ///< when something was switched off last
  Time opened_{};   ///< when every relay was opened last
  Time output_asked_{};
  std::uint64_t meaning_ = 0;
  emulator::Drives drives_{};
  std::vector<Held> held_;
  std::vector<NotTaken> not_taken_;
  std::uint32_t promised_ = 0;  ///< commit that some host was told to be active
  std::optional<std::uint64_t> seen_version_;
  bool supply_comes_back_ = false, lying_disk_ = false;
  bool calm_ = false, ended_ = false;
};

World::World(std::uint64_t seed, const Breaks& breaks, const std::function<void(const std::string&)>& say)
    : say_(say), breaks_(breaks), chance_(seed * 3 + 1), random_(seed * 3 + 2), line_random_(seed * 3 + 3) {
  report_.trace = 0xCBF29CE484222325ULL;
}

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
            [this](const Command& command, const CommandResult& result) { after_command(command, result); },
            [this](Address address, std::span<const std::uint8_t> bytes) { before_write(address, bytes); },
            [this] { before_keep(); }},
      breaks_.unit, kCode, now_and_then(0.1));
  place_->disk.lies = lying_disk_ = now_and_then(0.1);
  line_ = std::make_unique<Line>(schedule_, line_random_, *place_, shared,
                                 std::array{9'600, 115'200, 115'200, 921'600}[draw(4)]);
  line_->turnaround = now_and_then(0.2) ? draw(1ms, 200ms) : Span(1ms);
  line_->heard = [this](int from, int to, const Bytes& frame) { hear(from, to, frame); };
  line_->arrives = [this](int /*from*/, const Bytes& pdu) {
    const Bytes meaning = meaning_of(pdu);
    meaning_ = hash_of(0, meaning.data(), meaning.size());
    if (carried_out_meanings_.count(meaning_) > 0) reached(Sometimes::replayed_command_ignored);
  };
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
  host.name = std::move(name);
  host.knows_code = knows_code;
  host.key = random_() | 1U;
  return host;
}

void World::hear(int from, int to, const Bytes& frame) {
  const auto at_us = (schedule_.now() - Time{}).count();
  trace(&at_us, sizeof at_us);
  trace(&from, sizeof from);
  trace(frame.data(), frame.size());
  if (say_) {
    const auto host = host_at_.find(from == kUnitEnd ? to : from);
    const std::string who = host == host_at_.end() ? "forger" : host->second->name;
    std::string bytes;
    for (std::size_t i = 1; i < std::min<std::size_t>(frame.size(), 26); ++i) bytes += fmt::format("{:02X}", frame[i]);
    say("{} {} {} bytes: {}", from == kUnitEnd ? "  unit to" : "to unit from", who, frame.size(), bytes);
  }
  if (forger_ && !calm_) forger_->hear(from, to, frame);
  if (from == kUnitEnd) return hear_unit(to, Line::unframed(frame));
  const auto found = host_at_.find(from);
  if (found == host_at_.end()) return;
  Host& host = *found->second;
  const Bytes pdu = Line::unframed(frame);
  const Bytes meaning = meaning_of(pdu);
  if (meaning.size() < 2) return;
  const std::uint64_t hash = hash_of(0, meaning.data(), meaning.size());
  const std::size_t first = std::size_t{meaning[0]} << 8 | meaning[1];
  if (host.knows_code && meant_.insert(hash).second) meant_at_[hash] = schedule_.now();
  constexpr std::size_t kCodeAt = 2 + 2 * 6 + 1;
  if (first == protocol::kArmConfirm.first) host.armed_in_it = true;
  if (first == protocol::kResultSelect.first && host.commit_sent) {
    host.settles = true;
    reached(Sometimes::commit_answer_lost);
  }
  if (first != protocol::kCommand.first || meaning.size() <= kCodeAt) return;
  const auto code = static_cast<CommandCode>(meaning[kCodeAt]);
  if (code == CommandCode::begin_staging) host.staging = true, host.armed_in_it = false;
  if (code == CommandCode::commit_staged) host.commit_sent = true;
}

/// What the unit refuses, and why.
void World::hear_unit(int to, const Bytes& pdu) {
  const auto host = host_at_.find(to);
  constexpr std::size_t kResult = 2 + 2 * protocol::kCommandResult.count, kAck = 2 + 2 * protocol::kWindowAck.count;
  if (host == host_at_.end() || (pdu.size() != kResult && pdu.size() != kAck)) return;
  const auto error = static_cast<UnitError>(pdu[pdu.size() == kResult ? 15 : 9]);
  if (pdu.size() == kAck && error == UnitError::check_mismatch) reached(Sometimes::window_closed_by_forger);
  if (error == UnitError::wrong_key) reached(Sometimes::wrong_key_refused);
  if (pdu.size() == kResult && error == UnitError::late) reached(Sometimes::late_refused);
  if (pdu.size() == kResult && error == UnitError::overtaken) reached(Sometimes::overtaken_refused);
}

/// Only what a host with the code has sent may write, commit or move an output; once, and in time.
void World::before_command(const Command& command) {
  say("the unit is asked for \"{}\", session {:08X}, sequence {}", name_of(command.code), command.asker.session,
      command.sequence);
  if (protocol::needs_arming(command.code)) {
    const auto sent = meant_at_.find(meaning_);
    if (sent == meant_at_.end())
      return violated("\"{}\" was carried out that no host with the code has given", name_of(command.code));
    carried_out_meanings_.insert(meaning_);
    if (!carried_out_.insert({command.asker.session, command.sequence}).second)
      violated("\"{}\" was carried out twice", name_of(command.code));
    if (protocol::acts_at_once(command.code)) {
      if (schedule_.now() - sent->second > kMostAge)
        violated("\"{}\" was carried out {:.3f} s after it was given", name_of(command.code),
                 std::chrono::duration<double>(schedule_.now() - sent->second).count());
      if (stopped_ > sent->second)
        violated("\"{}\" was carried out after something else had switched off", name_of(command.code));
    }
  }
  if (command.code == CommandCode::output_compensation && command.relay_on) output_asked_ = schedule_.now();
  const int which = ++commands_[command.code];
  last_command_ = command.code;
  for (const Moment& moment : moments_)
    if (moment.at == command.code && moment.which == which) strike(moment.action);
}

void World::after_command(const Command& command, const CommandResult& result) {
  if (result.state != CommandState::done && result.state != CommandState::busy) return;
  if (protocol::switches_off(command.code)) stopped_ = schedule_.now();
  if (protocol::switches_off(command.code) && command.code != CommandCode::stop) opened_ = schedule_.now();
}

void World::before_write(Address address, std::span<const std::uint8_t> bytes) {
  if (meant_.count(meaning_) == 0)
    violated("{} bytes at {:06X} were written that no host with the code has sent", bytes.size(), address);
  ++writes_;
  for (const Moment& moment : moments_)
    if (moment.at == CommandCode::none && moment.which == writes_) strike(moment.action);
}

void World::before_keep() {
  const Disk& disk = place_->disk;
  if (disk.writes_fail > 0 || disk.names_fail > 0) reached(Sometimes::battery_not_written);
  if (!disk.ends_after) return;
  reached(std::array{Sometimes::process_ended_before_battery, Sometimes::process_ended_before_name,
                     Sometimes::process_ended_after_battery}[static_cast<std::size_t>(std::max(0, *disk.ends_after))]);
}

void World::strike(Action action) {
  if (calm_ || !place_->running()) return;
  const auto some_host = [this]() -> Host& { return *hosts_[draw(static_cast<std::uint32_t>(hosts_.size()))]; };
  switch (action) {
    case Action::supply:
      say("the supply fails within the next bytes");
      place_->unit().memory().power_fails_after(draw(140));
      return;
    case Action::power:
      ends_power_ = true;
      [[fallthrough]];
    case Action::process:
      say("the process of the unit ends");
      place_->disk.ends_after = static_cast<int>(draw(3));
      ends_process_ = true;
      schedule_.after(1ms, [this] { look(); });
      return;
    case Action::battery:
      say("the battery file cannot be written");
      place_->disk.writes_fail = static_cast<int>(draw(3));
      place_->disk.names_fail = 1 + static_cast<int>(draw(2));
      if (now_and_then(0.3)) schedule_.after(draw(1ms, 600ms), [this] { strike(Action::process); });
      return;
    case Action::bit: {
      const Address bank = emulator::inactive_bank(place_->unit().memory());
      const Address at = bank + draw(static_cast<std::uint32_t>(images()[3].size()));
      say("a bit of {:06X} flips", at);
      if (commands_[CommandCode::commit_staged] > 0) reached(Sometimes::staged_bit_flipped);
      place_->unit().memory().corrupt(at, static_cast<std::uint8_t>(1U << draw(8)));
      return;
    }
    case Action::silence:
      say("the line is dead");
      line_->dead_until = schedule_.now() + draw(100ms, 20s);
      return;
    case Action::cancel: {
      Host& host = some_host();
      say("{} is cancelled", host.name);
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
        say("{} is killed", host.name);
        if (host.staging) reached(Sometimes::host_killed_while_staging);
        const bool sends = holds(host.name, "sender");
        host.program->kill();
        host.sends = false;
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
    if (!place_->disk.process_ended()) look_at_map();
    restart(ends_power_, draw(1ms, 5s));
    return;
  }
  if (!place_->process_runs()) return;
  if (!place_->unit().powered() && !supply_comes_back_) {
    say("no supply");
    reached(last_command_ == CommandCode::commit_staged ? Sometimes::supply_lost_in_record
                                                        : Sometimes::supply_lost_while_staging);
    supply_comes_back_ = true;
    schedule_.after(calm_ ? Span(1ms) : draw(1ms, 5s), [this] {
      supply_comes_back_ = false;
      if (!place_->process_runs()) return;
      place_->supply(true);
      say("supply is back");
      look();
    });
    look_at_map();
    return;
  }
  look_at_map();
  look_at_outputs();
}

void World::look_at_map() {
  if (seen_version_ == place_->version()) return;
  seen_version_ = place_->version();
  const Bytes active = place_->active();
  Held now{schedule_.now(), std::nullopt, place_->commit()};
  const auto found = std::find(images().begin(), images().end(), active);
  if (found != images().end()) now.image = static_cast<std::size_t>(found - images().begin());
  const bool known = held_.empty() ? !now.image && now.commit == 0
                                   : held_.back().image == now.image && held_.back().commit == now.commit;
  if (known && !held_.empty()) return;
  if (!now.image && !held_.empty()) {
    CompiledMap map;
    const bool refused =
        emulator::test_map(place_->unit().memory(), place_->unit().settings().axis_modules, map).fault != Fault::none;
    if (now.commit == 0 && !held_.front().image && promised_ == 0)
      say("the commit is undone, there is no map as before");
    else if (place_->disk.torn() && refused)
      reached(Sometimes::torn_file_refused_or_isolated);
    else if (refused && !place_->running() && place_->unit().status().ram_test == protocol::TestOutcome::failed)
      say("the supply was lost within the RAM test, and the map is refused");
    else
      violated("the active map is none that was sent ({} bytes, commit {})", active.size(), now.commit);
  }
  say("active: map {}, commit {}", now.image ? static_cast<int>(*now.image) : -1, now.commit);
  trace(&now.commit, sizeof now.commit);
  if (!lying_disk_) {
    if (now.commit < promised_) violated("commit {} is active, {} was told before", now.commit, promised_);
    for (const NotTaken& told : not_taken_)
      if (!told.over && now.image == told.image)
        violated("map {} is active, and a host was told that it was not taken", told.image);
  }
  held_.push_back(now);
}

/// A relay that closes, or an output that changes, was asked for just now by a host with the code (before_command()).
void World::look_at_outputs() {
  place_->catch_up();
  const emulator::Drives now = place_->drives();
  for (std::size_t a = 0; a < kAxes; ++a) {
    const bool closed = now[a].relay_closed && !drives_[a].relay_closed;
    if (now[a].relay_closed && place_->unit().mode() == UnitMode::compensating) continue;
    if (closed) reached(Sometimes::output_closed);
    if (now[a].relay_closed && opened_ > output_asked_ && schedule_.now() - opened_ > 40ms)
      violated("a relay is closed after everything was switched off");
    if (!now[a].relay_closed && drives_[a].relay_closed && schedule_.now() - output_asked_ > 59s)
      reached(Sometimes::output_ended_by_silence);
  }
  drives_ = now;
}

void World::restart(bool power, Span off) {
  say("the unit's process has ended{}", power ? ", with the power of its computer" : "");
  ends_process_ = ends_power_ = false;
  if (place_->end_process(power)) reached(Sometimes::file_taken_back_by_power);
  schedule_.after(calm_ ? Span(1ms) : off, [this] {
    if (place_->process_runs()) return;
    if (!place_->start_process()) {
      reached(Sometimes::torn_file_refused_or_isolated);
      if (!place_->disk.torn()) violated("the battery file is refused");
    }
    carried_out_.clear();
    seen_version_.reset();
    drives_ = {};
    say("the unit has started");
    look();
  });
}

Result<protocol::UnitClient> World::connected(Host& host) {
  protocol::LinkOptions options;
  options.cancelled = &host.cancelled;
  options.line = [this, &host] {
    auto end = std::make_unique<HostEnd>(*line_, host.answered_since);
    host_at_[end->number()] = &host;
    return end;
  };
  return protocol::UnitClient::connect(
      line_->address(), options,
      {host.key, host.name, host.knows_code && host.gives_code ? kCode : std::string(), host.secrets});
}

/// `ecs map send`, from opening the link on.
void World::send(Host& host, std::size_t image) {
  host.begun = host.answered_since = schedule_.now();
  host.sends = true;
  host.image = image;
  host.staging = host.commit_sent = host.armed_in_it = host.settles = false;
  say("{} sends map {}", host.name, image);
  for (NotTaken& told : not_taken_) told.over = told.over || told.image == image;
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
  host.sends = false;
  if (breaks_.host == HostBreak::believes_commits && !sent && host.commit_sent)
    sent = commissioning::SentMap{{}, {}, 0, {}, 0.0};
  judge(host, sent, host.cancelled);
}

bool World::was_held(Time from, Time to, const std::function<bool(const Held&)>& held) const {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const bool over = i + 1 < held_.size() && held_[i + 1].since < from;
    if (!over && held_[i].since <= to && held(held_[i])) return true;
  }
  return false;
}

/// What was told against what was so: of the time between the last answer to this host and the end.
void World::judge(Host& host, const Result<commissioning::SentMap>& sent, bool cancelled) {
  const Time now = schedule_.now(), since = host.answered_since;
  const auto is_sent = [&](const Held& held) { return held.image == host.image; };
  const auto end = [&](std::string verdict) {
    say("{}: {}{}", host.name, verdict, sent ? std::string() : ": " + to_text(sent.error()));
    trace(verdict.data(), verdict.size());
    ++report_.endings[std::move(verdict)];
  };
  if (now - host.begun > kLongestAttempt)
    violated("{}: an upload took {} s", host.name,
             std::chrono::duration_cast<std::chrono::seconds>(now - host.begun).count());
  if (sent) {
    if (!was_held(since, now, is_sent))
      return violated("{}: success was told, map {} is not active", host.name, host.image);
    if (sent->report.already_held) reached(Sometimes::already_held);
    if (sent->report.bytes_sent < sent->report.bytes && !sent->report.already_held) reached(Sometimes::resumed);
    if (host.settles) reached(Sometimes::settled_as_active);
    if (host.armed_in_it) reached(Sometimes::armed_again_in_transfer);
    promised_ = std::max(promised_, sent->report.commit_sequence);
    return end(sent->report.already_held ? "right, already held" : "right");
  }
  const std::string& words = sent.error().message;
  host.wants_arming = true;
  trace(words.data(), words.size());
  if (holds(words, "try again in")) reached(Sometimes::code_delayed);
  const bool says_none = holds(words, "the unit contains no map, as before");
  const auto old_commit = number_after(words, "the old map is active (commit ");
  const auto new_commit = number_after(words, "it is active (commit ");
  const bool doubt = holds(words, "it is not known which map is active") ||
                     holds(words, "the active map has changed") || holds(words, "another map is now active") ||
                     holds(words, "the active map in the unit differs") ||
                     holds(words, "unless another host has sent one");
  if (new_commit) {
    if (!was_held(host.begun, now, [&](const Held& held) { return is_sent(held) && held.commit == *new_commit; }))
      return violated("{}: told that the new map is active (commit {}), it was not: {}", host.name, *new_commit, words);
    promised_ = std::max(promised_, *new_commit);
    reached(Sometimes::told_new_with_failure);
    if (cancelled) reached(Sometimes::cancelled_after_commit);
    return end("new, told");
  }
  if (old_commit || says_none) {
    if (!was_held(since, now, [&](const Held& held) { return held.commit == old_commit.value_or(0); }))
      return violated("{}: told that the old map is active, it was not: {}", host.name, words);
    not_taken_.push_back({now, host.image, false});
    for (const auto& other : hosts_)
      if (other.get() != &host && other->sends && other->image == host.image) not_taken_.back().over = true;
    reached(Sometimes::told_old);
    return end("old, told");
  }
  if (doubt) {
    reached(Sometimes::told_in_doubt);
    if (holds(words, "the active map has changed")) reached(Sometimes::another_host_committed);
    return end(was_held(now, now, is_sent) ? "in doubt, new active" : "in doubt, old active");
  }
  if (host.staging) return violated("{}: a failure that does not name the active map: {}", host.name, words);
  end("before staging");
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
        if (client->output_off() && place_->running()) reached(Sometimes::output_opened_by_stranger);
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
    if (!done && done.error().kind == ProblemKind::refused) reached(Sometimes::stranger_refused);
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
    host->sends = false;
  }
  const Time begun = schedule_.now();
  Host& host = *hosts_.front();
  const std::size_t image = draw(kImages);
  bool active = false;
  dead_programs_.push_back(std::move(host.program));
  host.program = std::make_unique<Program>(schedule_, [&] {
    for (int sends = 0; !active; ++sends) {
      if (sends == 1) reached(Sometimes::needed_second_send_when_calm);
      const auto right_before = report_.endings["right"] + report_.endings["right, already held"];
      send(host, image);
      active = report_.endings["right"] + report_.endings["right, already held"] > right_before;
      if (!active) schedule_.wait_until(schedule_.now() + kBetweenSends);
    }
  });
  look();
  while (!host.program->ended() && report_.violations.empty() && schedule_.now() < begun + kCalmLimit)
    if (schedule_.step(begun + kCalmLimit)) look();
  report_.calm_s = std::chrono::duration<double>(schedule_.now() - begun).count();
  if (!active && report_.violations.empty())
    violated("{} s after the faults have stopped map {} is not active", report_.calm_s, image);
  if (active && place_->active() != images()[image]) violated("map {} is not active at the end", image);
}

Report World::run() {
  begin();
  Host& sender = *hosts_.front();
  const Time end = schedule_.now() + kLongestNoise;
  while (!sender.program->ended() && report_.violations.empty() && schedule_.now() < end)
    if (schedule_.step(end)) look();
  if (!sender.program->ended() && report_.violations.empty()) violated("{} has not ended", sender.name);
  if (report_.violations.empty()) calm();
  ended_ = true;
  for (const auto& host : hosts_)
    if (!host->program->ended()) host->program->kill();
  report_.frames = line_->frames;
  for (const auto struck : line_->struck) report_.faults += struck;
  if (line_->collisions > 0) reached(Sometimes::collision);
  if (line_->struck[static_cast<std::size_t>(LineFault::flip_agreeing)] > 0) reached(Sometimes::spoilt_frame_taken);
  report_.virtual_s = std::chrono::duration<double>(schedule_.now() - Time{1h}).count();
  return std::move(report_);
}

}  // namespace

Report run_world(std::uint64_t seed, const Breaks& breaks, const std::function<void(const std::string&)>& say) {
  World world(seed, breaks, say);
  return world.run();
}

}  // namespace ecs::world
