// A small unit for the tests of the link: two banks, staging, commands; and a thread that serves it on a real line.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "base/file.hpp"
#include "core/memory_image.hpp"
#include "protocol/client/client.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "protocol/server/register_server.hpp"
#include "protocol/server/server.hpp"

namespace ecs::protocol {

/// Another content with the same CRC-32: the generator of that CRC is added to it, 33 bits from byte `at` on.
inline void forge(std::vector<std::uint8_t>& image, std::size_t at) {
  for (const std::uint8_t bits : std::initializer_list<std::uint8_t>{0x41, 0x06, 0x71, 0xDB, 0x01}) image[at++] ^= bits;
}

class UnitModel : public UnitPort {
 public:
  static constexpr std::uint32_t kSize = 0x12000;
  UnitMode mode = UnitMode::integration;
  std::vector<std::uint8_t> bank_a = std::vector<std::uint8_t>(kSize, 0);
  std::vector<std::uint8_t> bank_b = std::vector<std::uint8_t>(kSize, 0);
  Bank active = Bank::none;
  bool staging = false;
  std::uint32_t commits = 0;
  std::uint32_t image_length = 0;
  int commands_begun = 0;
  int busy_polls_left = 0;  ///< test_datum stays busy for this many questions
  bool busy = false;
  std::vector<CommandCode> log;
  std::string serial_number = "ECS-0042";
  std::uint16_t protocol_version = kProtocolVersion;
  std::array<std::uint16_t, 2> firmware{2, 7};
  RotarySample turning{};
  int rotary_asked = 0;  ///< so often the rotary axes were read
  std::uint32_t samples = 0;
  std::function<void()> on_commit;   ///< called before the commit is carried out
  std::function<void()> on_abandon;  ///< called before what is staged is abandoned
  bool takes_commits = true;         ///< false: a commit fails
  bool spoils_commits = false;       ///< another host changes the map as soon as it is active
  int replies_to_lose = 0;           ///< carried out, but not answered
  int replies_left = -1;             ///< after this many the unit is silent; -1: never
  bool names_active_bank = false;    ///< as the one to write
  bool knows_tables = true;          ///< of tools, replaced as a whole
  std::function<void()> after_commit;
  UnitClock unit_clock{1, 5'000};
  int starts_on_arming = 0;     ///< so often it starts as soon as it has answered that a host is armed
  bool starts_on_look = false;  ///< it starts as soon as it has answered to an armed host how long it is armed
  std::optional<std::uint64_t> outputs_ended_ms;
  int windows_to_spoil =
      0;                    ///< into this many windows a block of another program comes before the next one of the host
  int foreign_replies = 0;  ///< this many of the next identity and monitor blocks are as if another host had asked

  Identity identity() override {
    return {protocol_version, firmware[0], firmware[1], serial_number, "small mill", 1, {true, true, false}, 32'000};
  }
  UnitStatus status() override {
    UnitStatus status;
    status.mode = mode;
    status.active_bank = active;
    status.commit_sequence = commits;
    status.image_length_bytes = image_length;
    if (active != Bank::none) {
      const ImageVerdict verdict = check_image(active == Bank::B ? bank_b : bank_a);
      status.block_check_expected = verdict.check_expected;
      status.block_check_found = verdict.check_found;
    }
    status.ticks = ++samples;
    status.pointers_at_tick = status.ticks;
    status.axes[1].position_mm = -12.5;
    status.pointers[3] = {17, 0x100022};
    return status;
  }
  MonitorSample monitor() override {
    MonitorSample sample;
    sample.number = ++samples;
    sample.mode = mode;
    sample.unit_time_us = 1'000ull * samples;
    sample.axes[0].present = true;
    sample.axes[0].position_mm = samples;
    return sample;
  }
  RotarySample rotary() override {
    ++rotary_asked;
    return turning;
  }
  UnitClock clock() override { return unit_clock; }
  ImageDigest active_digest() override { return active == Bank::none ? ImageDigest{} : digest_of(active_image()); }
  void show_code(const std::string& code) override { shown_code = code; }
  std::string shown_code;  ///< since the first one
  void host_armed() override { just_armed = true; }
  /// Its last answer is on the line.
  void answered() {
    if (std::exchange(just_armed, false) && starts_on_arming > 0) {
      --starts_on_arming;
      ++unit_clock.starts;
    }
    if (std::exchange(just_looked, false) && std::exchange(starts_on_look, false)) ++unit_clock.starts;
  }
  bool just_armed = false;
  bool just_looked = false;
  std::optional<std::uint64_t> take_outputs_ended() override { return std::exchange(outputs_ended_ms, std::nullopt); }
  UnitError read_memory(Address address, std::span<std::uint8_t> out) override {
    auto* bank = bank_at(address, out.size());
    if (bank == nullptr) return UnitError::address_unknown;
    std::copy_n(bank->begin() + static_cast<std::ptrdiff_t>(offset_of(address)), out.size(), out.begin());
    return UnitError::none;
  }
  UnitError may_write(Address address, std::uint32_t bytes) override {
    if (mode != UnitMode::integration) return UnitError::not_in_integration_mode;
    return bank_at(address, bytes) == nullptr ? UnitError::address_unknown : UnitError::none;
  }
  UnitError write_memory(Address address, std::span<const std::uint8_t> bytes) override {
    auto* bank = bank_at(address, bytes.size());
    if (bank == nullptr) return UnitError::address_unknown;
    std::copy(bytes.begin(), bytes.end(), bank->begin() + static_cast<std::ptrdiff_t>(offset_of(address)));
    return UnitError::none;
  }
  CommandResult begin(const Command& command) override {
    ++commands_begun;
    log.push_back(command.code);
    last = command;
    if (mode != UnitMode::integration && command.code != CommandCode::enter_integration)
      return refused(UnitError::not_in_integration_mode);
    switch (command.code) {
      case CommandCode::enter_integration:
        mode = UnitMode::integration;
        return done();
      case CommandCode::enter_compensation:
        mode = UnitMode::compensating;
        return done();
      case CommandCode::begin_staging:
        staging = true;
        if (command.staging_from != StagingFrom::kept) {
          auto& spare = active == Bank::A ? bank_b : bank_a;
          if (command.staging_from == StagingFrom::active)
            spare = active == Bank::B ? bank_b : bank_a;
          else
            std::fill(spare.begin(), spare.end(), std::uint8_t{0});
        }
        return done(names_active_bank ? address_of_active() : address_of_spare());
      case CommandCode::abandon_staged:
        if (on_abandon) on_abandon();
        if (!staging) return refused(UnitError::no_staging);
        staging = false;
        return done();
      case CommandCode::commit_staged:
        return commit(command);
      case CommandCode::test_datum:
        busy = true;
        return {0, CommandState::busy, UnitError::none, 0, 0, "move the axis"};
      case CommandCode::stop:
        busy = false;
        return done();
      case CommandCode::begin_tools:
        return knows_tables ? done() : refused(UnitError::unknown_command);
      default:
        return done();
    }
  }
  CommandResult progress() override {
    if (!busy) return {0, CommandState::failed, UnitError::stopped, 0, 0, {}};
    if (busy_polls_left-- > 0) return {0, CommandState::busy, UnitError::none, 500, 0, "move the axis"};
    busy = false;
    return done(99);
  }
  [[nodiscard]] std::vector<std::uint8_t> active_image() const {
    const auto& bank = active == Bank::B ? bank_b : bank_a;
    return {bank.begin(), bank.begin() + image_length};
  }
  /// What is staged becomes the active image.
  void switch_banks(std::uint32_t length) {
    staging = false;
    ++commits;
    active = active == Bank::A ? Bank::B : Bank::A;
    image_length = length;
  }
  void install(const std::vector<std::uint8_t>& image) {
    std::copy(image.begin(), image.end(), bank_a.begin());
    active = Bank::A;
    image_length = static_cast<std::uint32_t>(image.size());
  }
  Command last;

 private:
  static CommandResult done(std::uint32_t value = 0) { return {0, CommandState::done, UnitError::none, 0, value, {}}; }
  static CommandResult refused(UnitError error) { return {0, CommandState::refused, error, 0, 0, {}}; }
  [[nodiscard]] Address address_of_active() const { return active == Bank::B ? kBankB.first : kBankA.first; }
  [[nodiscard]] Address address_of_spare() const { return active == Bank::A ? kBankB.first : kBankA.first; }
  std::vector<std::uint8_t>* bank_at(Address address, std::size_t bytes) {
    auto& bank = address >= kBankB.first ? bank_b : bank_a;
    const bool inside = address >= kBankA.first && offset_of(address) + bytes <= kSize;
    return inside ? &bank : nullptr;
  }
  static std::size_t offset_of(Address address) {
    return address - (address >= kBankB.first ? kBankB.first : kBankA.first);
  }
  CommandResult commit(const Command& command) {
    if (on_commit) on_commit();
    if (!staging) return refused(UnitError::no_staging);
    if (!takes_commits)
      return {0, CommandState::failed, UnitError::unit_fault, 0, 0, "the commit record could not be stored"};
    auto& spare = active == Bank::A ? bank_b : bank_a;
    if (command.length > kSize || short_digest(digest_of(std::span(spare).first(command.length))) != command.digest)
      return refused(UnitError::check_mismatch);
    switch_banks(command.length);
    if (spoils_commits) spare.front() ^= 0xFF;
    if (after_commit) after_commit();
    return done(commits);
  }
};

/// A host that writes the registers of a server itself, and seals what it writes where it is armed.
class RegisterHost {
 public:
  explicit RegisterHost(RegisterServer& server, std::uint32_t key = 1, std::uint32_t number = 0) : server_(&server) {
    self_.key = key;
    self_.number = number;
    self_.host = "host " + std::to_string(key);
    if (!look().needs_code) (void)arm("");
  }
  SessionState look() {
    ++self_.challenge;
    (void)server_->write(kSessionOpen.first, registers_of(self_, 0));
    state_ = value_in<SessionState>(server_->read(kSession.first, kSession.count).value()).value();
    if (state_.armed_s == 0) secret_.reset();
    return state_;
  }
  /// The answer to the exchange, or to the half of it that is refused.
  ArmAnswer arm(std::string_view code, std::uint16_t minutes = 30) {
    const auto identity = value_in<Identity>(server_->read(kIdentity.first, kIdentity.count).value()).value();
    const ExchangeTerms terms = exchange_terms(code, identity.serial_number, session(), minutes);
    const HalfExchange own = half_exchange(terms);
    const ArmAnswer shared = ask(kArmShare, ArmShare{session(), minutes, own.share});
    if (shared.error != UnitError::none) return shared;
    const SharedKey key = shared_key(terms, End::host, own, shared.share).value();
    const ArmAnswer answer = ask(kArmConfirm, ArmConfirm{session(), confirmation_of(terms, End::host, key, own.share)});
    if (answer.error == UnitError::none) secret_ = secret_from(key);
    return answer;
  }
  /// Uses what another program of this host has agreed on.
  void share_with(const RegisterHost& other) { secret_ = other.secret_; }
  /// Of the session as it is now; nothing: this host was never armed.
  [[nodiscard]] std::optional<Secret> key() const {
    return secret_ ? std::optional(session_key(*secret_, state_.session, state_.nonce)) : std::nullopt;
  }
  /// The next command of this session, as given at the last look.
  [[nodiscard]] Command next(Command command) {
    command.asker = {state_.session, 1};
    command.sequence = ++state_.sequence;
    command.clock_ms = state_.clock_ms;
    command.stops = state_.stops;
    return command;
  }
  [[nodiscard]] Registers sealed_registers(const Command& command) const {
    return sealed(registers_of(command, 0), Keyed::command, key());
  }
  [[nodiscard]] Registers sealed_registers(const WindowOpen& window) const {
    return sealed(registers_of(window, 0), Keyed::window, key());
  }
  CommandResult send(const Command& command) {
    (void)server_->write(kCommand.first, sealed_registers(command));
    return result();
  }
  CommandResult give(const Command& command) {
    (void)look();
    return send(next(command));
  }
  WindowAck open(const WindowOpen& window) {
    (void)server_->write(kWindowOpen.first, sealed_registers(window));
    return value_in<WindowAck>(server_->read(kWindowAck.first, kWindowAck.count).value()).value();
  }
  [[nodiscard]] CommandResult result() const {
    return value_in<CommandResult>(server_->read(kCommandResult.first, kCommandResult.count).value()).value();
  }
  [[nodiscard]] std::uint32_t session() const { return state_.session; }

 private:
  template <class T>
  ArmAnswer ask(const Block& block, const T& value) {
    (void)server_->write(block.first, registers_of(value, 0));
    return value_in<ArmAnswer>(server_->read(kArmAnswer.first, kArmAnswer.count).value()).value();
  }
  RegisterServer* server_;
  SessionOpen self_;
  SessionState state_;
  std::optional<Secret> secret_;
};

/// A block of a window as its host sends it.
inline Registers block_registers(const std::optional<Secret>& key, const WindowOpen& window, std::uint16_t number,
                                 std::span<const std::uint8_t> content) {
  Registers registers(kBlockHeaderRegisters, 0);
  registers[0] = window.tag();
  registers[1] = number;
  const Registers payload = packed(content);
  put_check(registers, block_check(key, window, number,
                                   window.coded ? unpacked(payload, 2 * payload.size())
                                                : std::vector<std::uint8_t>(content.begin(), content.end())));
  registers.insert(registers.end(), payload.begin(), payload.end());
  return registers;
}

/// Serves the registers of a model that may lose its replies from a certain command on.
class LosingServer : public RegisterServer {
 public:
  LosingServer(UnitModel& model, const std::string& code) : RegisterServer(model, {code, true}), model_(&model) {}
  [[nodiscard]] tl::expected<Registers, ModbusException> read(std::uint16_t first, std::uint16_t count) override {
    auto block = RegisterServer::read(first, count);
    const bool asked_often = first == kMonitor.first || first == kIdentity.first;
    if (block && asked_often && model_->foreign_replies > 0) {
      --model_->foreign_replies;
      block->front() = static_cast<std::uint16_t>(block->front() + 5000);
    }
    if (block && first == kSession.first) model_->just_looked = value_in<SessionState>(*block).value().armed_s > 0;
    return block;
  }
  [[nodiscard]] tl::expected<void, ModbusException> write(std::uint16_t first,
                                                          std::span<const std::uint16_t> values) override {
    if (first == kBlockWrite.first && model_->windows_to_spoil > 0 && values.front() != spoilt_) {
      --model_->windows_to_spoil;
      spoilt_ = values.front();
      Registers guessed(values.begin(), values.end());
      ++guessed[2];
      (void)RegisterServer::write(first, guessed);
    }
    return RegisterServer::write(first, values);
  }
  [[nodiscard]] bool silent() const override {
    model_->answered();
    if (model_->replies_left == 0) return true;
    if (model_->replies_left > 0) --model_->replies_left;
    return model_->replies_to_lose > 0 && model_->replies_to_lose-- > 0;
  }

 private:
  UnitModel* model_;
  std::uint32_t spoilt_ = 0x10000;  ///< tag of the window into which a wrong block has come
};

/// Serves a model from a thread of its own. What tests change goes through `in_server`.
class Workshop {
 public:
  static constexpr const char* kKnownCode = "161803";
  /// @param arm_code  that the unit shows; empty: one that every client knows
  explicit Workshop(ModbusServer made, const std::string& arm_code = {})
      : server_(std::move(made)),
        address_(server_.address()),
        arm_code_(arm_code.empty() ? kKnownCode : arm_code),
        known_code_(arm_code.empty() ? arm_code_ : std::string()) {
    thread_ = std::thread([this] { run(); });
  }
  static Workshop on_pty(bool paced = false, int baud = 115'200) {
    return Workshop(ModbusServer::on_pty({{}, baud, paced, 1}).value());
  }
  static Workshop on_tcp() { return Workshop(ModbusServer::on_tcp({}).value()); }
  Workshop(const Workshop&) = delete;
  ~Workshop() {
    ended_ = true;
    thread_.join();
  }

  /// Runs `task` between two steps of the server.
  template <class Task>
  auto in_server(Task task) {
    using Answer = decltype(task(server_, model_));
    auto job = std::make_shared<std::packaged_task<Answer()>>([this, task] { return task(server_, model_); });
    auto answer = job->get_future();
    {
      const std::lock_guard lock(mutex_);
      job_ = [job] { (*job)(); };
    }
    return answer.get();
  }
  /// The same, of the model only.
  template <class Task>
  auto in_model(Task task) {
    return in_server([task](ModbusServer&, UnitModel& model) { return task(model); });
  }
  void fault(LinkFault fault, std::uint32_t transactions) {
    in_server([=](ModbusServer& server, UnitModel&) { server.faults().next(fault, transactions); });
  }
  void fault_often(LinkFault fault, double probability) {
    in_server([=](ModbusServer& server, UnitModel&) { server.faults().with_probability(fault, probability); });
  }
  /// Pulls the plug: the line is closed, the unit lives on at another one that nobody knows.
  void cut_line() {
    in_server([](ModbusServer& server, UnitModel&) { server = ModbusServer::on_pty({}).value(); });
  }
  [[nodiscard]] const LinkAddress& address() const { return address_; }

  /// Patience that fits a test: short, but longer than a busy computer needs.
  [[nodiscard]] LinkOptions options(const std::atomic<bool>* cancelled = nullptr) const {
    using namespace std::chrono_literals;
    LinkTiming timing = timing_of(address_);
    timing.response_timeout = 150ms + 512 * timing.byte_time;
    timing.quiet_time = 200ms;
    return {cancelled, timing};
  }
  [[nodiscard]] UnitClient client(const std::atomic<bool>* cancelled = nullptr) const {
    return UnitClient(Link::open(address_, options(cancelled)).value(), {0, {}, known_code_});
  }
  [[nodiscard]] UnitClient client_of_tries(int tries) const {
    auto patience = options();
    patience.timing->tries = tries;
    return UnitClient(Link::open(address_, patience).value(), {0, {}, known_code_});
  }

 private:
  void run() {
    LosingServer losing(model_, arm_code_);
    while (!ended_) {
      std::function<void()> job;
      {
        const std::lock_guard lock(mutex_);
        job.swap(job_);
      }
      if (job) job();
      server_.serve_ready(losing, std::chrono::milliseconds(5));
    }
  }
  ModbusServer server_;
  LinkAddress address_;
  std::string arm_code_;
  std::string known_code_;  ///< of its clients
  UnitModel model_;
  std::mutex mutex_;
  std::function<void()> job_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

/// Whether it is a problem whose message holds these words.
template <class T>
bool says(const Result<T>& result, std::string_view words) {
  return !result && result.error().message.find(words) != std::string::npos;
}

/// Bytes without a pattern that a shifted or doubled block could hide in.
inline std::vector<std::uint8_t> noise_image(std::size_t size, std::uint32_t seed = 7) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> image(size);
  for (auto& byte : image) byte = static_cast<std::uint8_t>(random());
  return image;
}

}  // namespace ecs::protocol
