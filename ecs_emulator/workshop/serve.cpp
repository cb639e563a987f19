#include "ecs_emulator/workshop/serve.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>

#include "base/random.hpp"
#include "ecs_emulator/unit/memory.hpp"
#include "ecs_emulator/unit/workshop_socket.hpp"
#include "ecs_emulator/workshop/workshop.hpp"
#include "protocol/server/server.hpp"

namespace ecs::emulator {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kSlice{10};          ///< of real time, while nobody works
constexpr double kMostCatchUp_s = 0.25;                  ///< lost time beyond this is not made up for
constexpr int kMostPassedOver = 50;                      ///< late periods without an answer: 50 ms at 1 kHz
constexpr std::chrono::milliseconds kBatteryDelay{500};  ///< a changed memory is on disc at the latest after so long

/// The way in for a second host, where one is wanted.
Result<std::optional<protocol::ModbusServer>> open_second_line(const ServeOptions& options) {
  if (!options.also_tcp) return std::optional<protocol::ModbusServer>();
  ECS_TRY(line, protocol::ModbusServer::on_tcp({0, options.unit, 8, "127.0.0.1", options.token_file}));
  return std::optional<protocol::ModbusServer>(std::move(line));
}

Result<protocol::ModbusServer> open_line(const ServeOptions& options) {
  if (options.tcp)
    return protocol::ModbusServer::on_tcp({*options.tcp, options.unit, 8, options.tcp_host, options.token_file});
  const bool paced = options.pace_baud > 0;
  return protocol::ModbusServer::on_pty(
      {options.pty.value_or(std::filesystem::path()), paced ? options.pace_baud : 115'200, paced, options.unit});
}

/// The unit on the line.
class Socket final : public protocol::RegisterHandler {
 public:
  Socket(Unit& unit, protocol::ArmCode code) : unit_(unit), face_(unit, std::move(code)) {}
  void arrives_on(std::uint64_t connection, const std::string& origin) override {
    face_.arrives_on(connection, origin);
  }
  [[nodiscard]] Speaks speaks_on(std::uint64_t connection) override { return face_.speaks_on(connection); }
  tl::expected<protocol::Registers, protocol::ModbusException> read(std::uint16_t first, std::uint16_t count) override {
    if (silent()) return tl::unexpected(protocol::ModbusException::device_failure);
    return face_.read(first, count);
  }
  tl::expected<void, protocol::ModbusException> write(std::uint16_t first,
                                                      std::span<const std::uint16_t> values) override {
    if (silent()) return tl::unexpected(protocol::ModbusException::device_failure);
    return face_.write(first, values);
  }
  /// A unit without power does not answer, also when it loses it in the middle of a request.
  [[nodiscard]] bool silent() const override { return !unit_.powered(); }

 private:
  Unit& unit_;
  protocol::RegisterServer face_;
};

/// The running workshop.
class RunningWorkshop {
 public:
  RunningWorkshop(Simulation simulation, const ServeOptions& options, const std::string& serial_number,
                  protocol::ModbusServer line, std::optional<protocol::ModbusServer> second_line,
                  std::optional<WorkshopSocket> door, const std::atomic<int>& stop)
      : simulation_(std::move(simulation)),
        unit_({serial_number, options.memory_modules, axis_modules(simulation_), options.mode,
               simulation_.description().machine.inputs}),
        socket_(unit_, {options.arm_code, options.fixed_code}),
        line_(std::move(line)),
        second_line_(std::move(second_line)),
        door_(std::move(door)),
        battery_(options.memory),
        real_time_(options.real_time),
        stop_(stop),
        workshop_{&simulation_, &unit_, &line_.faults(), protocol::to_text(line_.address())} {
    unit_.show_code(options.arm_code);
    code_told_ = options.arm_code;
    simulation_.attach(&unit_);
    simulation_.on_pause([this] { return serve_line() && !(door_ && door_->visitor_left()); });
    unit_.on_commit([this] { return keep_memory(); });
  }
  RunningWorkshop(const RunningWorkshop&) = delete;
  RunningWorkshop& operator=(const RunningWorkshop&) = delete;

  Result<void> switch_on() {
    if (!battery_.empty()) {
      ECS_DO(restore(unit_.memory(), battery_));
      ECS_DO(keep(unit_.memory(), battery_));  // a file that cannot be written shows at once
    }
    unit_.power(true);
    simulation_.idle_tick();
    last_ = Clock::now();
    return {};
  }
  Result<void> run() {
    if (real_time_) simulation_.run_in_real_time();
    while (stop_ == 0) {
      if (simulation_.real_time())
        simulation_.idle_tick();
      else
        wait();
      (void)serve_line();
      if (door_) door_->serve_ready([this](const auto& request, const auto& report) { return act(request, report); });
      if (!simulation_.real_time()) catch_up();
      if (unit_.memory().changed() && Clock::now() - kept_ > kBatteryDelay) keep_memory();
    }
    if (unit_.memory().changed()) keep_memory();
    if (battery_problem_) return tl::unexpected(*battery_problem_);
    return {};
  }

 private:
  static AxisModules axis_modules(const Simulation& simulation) {
    AxisModules modules{};
    for (const Axis a : kAllAxes)
      if (simulation.machine().has(a)) modules[index_of(a)] = simulation.machine().axis(a).facts().transducer;
    return modules;
  }

  void wait() {
    std::vector<pollfd> fds = line_.poll_fds();
    auto until = Clock::now() + kSlice;
    if (const auto deadline = line_.next_deadline()) until = std::min(until, *deadline);
    const auto watch = [&fds](const std::vector<pollfd>& more) { fds.insert(fds.end(), more.begin(), more.end()); };
    if (door_) watch(door_->poll_fds());
    if (second_line_) {
      watch(second_line_->poll_fds());
      if (const auto deadline = second_line_->next_deadline()) until = std::min(until, *deadline);
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    ::poll(fds.data(), fds.size(), static_cast<int>(std::max<std::int64_t>(0, left.count())));
  }

  /// Answers what waits on the lines. False once the process is to end. A loop that is late catches up first: each
  /// request that it answered meanwhile would delay the periods after it. Hosts wait for at most so many periods.
  bool serve_line() {
    if (simulation_.is_behind() && ++passed_over_ < kMostPassedOver) return stop_ == 0;
    passed_over_ = 0;
    line_.serve_ready(socket_, std::chrono::milliseconds(0));
    if (second_line_) second_line_->serve_ready(socket_, std::chrono::milliseconds(0));
    if (unit_.shown_code() != code_told_) tell_code();
    return stop_ == 0;
  }

  /// The unit shows another code than at the beginning: a line on stdout, as the first one.
  void tell_code() {
    code_told_ = unit_.shown_code();
    fmt::print("{}\n", nlohmann::json{{"arm_code", code_told_}}.dump());
    (void)std::fflush(stdout);
  }

  std::string act(const std::string& request, const std::function<void(const std::string&)>& report) {
    std::string answer = perform(workshop_, request, report);
    last_ = Clock::now();
    return answer;
  }

  /// Nobody works: the unit runs in real time.
  void catch_up() {
    const auto now = Clock::now();
    owed_s_ = std::min(owed_s_ + std::chrono::duration<double>(now - last_).count(), kMostCatchUp_s);
    last_ = now;
    while (owed_s_ >= simulation_.period_s()) {
      simulation_.idle_tick();
      owed_s_ -= simulation_.period_s();
    }
  }

  /// False: the file could not be written.
  bool keep_memory() {
    kept_ = Clock::now();
    battery_problem_.reset();
    if (battery_.empty()) {
      unit_.memory().kept();
      return true;
    }
    if (auto written = keep(unit_.memory(), battery_); !written) battery_problem_ = written.error();
    return !battery_problem_;
  }

  Simulation simulation_;
  Unit unit_;
  Socket socket_;
  protocol::ModbusServer line_;
  std::optional<protocol::ModbusServer> second_line_;
  std::optional<WorkshopSocket> door_;
  std::filesystem::path battery_;
  bool real_time_ = false;
  std::optional<Problem> battery_problem_;
  const std::atomic<int>& stop_;
  Workshop workshop_;
  Clock::time_point last_{};
  Clock::time_point kept_{};
  double owed_s_ = 0.0;
  int passed_over_ = 0;
  std::string code_told_;
};

/// With the file of the token that a host must show.
std::string second_link_of(protocol::LinkAddress address, const std::string& token_file) {
  if (auto* peer = std::get_if<protocol::TcpPeer>(&address.endpoint)) peer->token_file = token_file;
  return protocol::to_text(address);
}

nlohmann::json ready_line(const protocol::LinkAddress& address, const ServeOptions& options,
                          const std::string& serial_number) {
  nlohmann::json line{{"pty", nullptr}, {"tcp", nullptr}, {"workshop", nullptr}};
  if (const auto* serial = std::get_if<protocol::SerialPort>(&address.endpoint)) line["pty"] = serial->device;
  if (const auto* peer = std::get_if<protocol::TcpPeer>(&address.endpoint))
    line["tcp"] = fmt::format("{}:{}", peer->host, peer->port);
  if (!options.workshop.empty()) line["workshop"] = options.workshop.string();
  line["link"] = protocol::to_text(address);
  line["serial_number"] = serial_number;
  line["unit"] = options.unit;
  line["arm_code"] = options.arm_code;
  return line;
}

}  // namespace

Result<Simulation> simulation_for(const std::filesystem::path& machine, const std::filesystem::path& errors,
                                  std::optional<std::uint64_t> seed, const std::string& serial_number) {
  ECS_TRY(description, load_workshop_machine(machine));
  if (!serial_number.empty()) description.settings.serial_number = serial_number;
  const std::filesystem::path file = errors.empty() ? description.settings.errors : errors;
  ECS_TRY(true_errors, file.empty() ? Result<TrueErrors>(TrueErrors()) : TrueErrors::load(file));
  ECS_DO(true_errors.checked_for(description.machine));
  return Simulation(description, std::move(true_errors), seed.value_or(description.settings.seed));
}

Result<void> serve(const ServeOptions& given, const std::atomic<int>& stop,
                   const std::function<void(const std::string&)>& ready) {
  ServeOptions options = given;
  options.fixed_code = !options.arm_code.empty();
  if (!options.fixed_code) options.arm_code = protocol::code_by_chance();
  ECS_TRY(simulation, simulation_for(options.machine, options.errors, options.seed, options.serial_number));
  if (options.memory_modules < 1 || options.memory_modules > kMostModules)
    return problem(ProblemKind::usage, "memory modules: expected 1 to {}", kMostModules);
  const std::string serial_number = simulation.description().settings.serial_number;
  // What another process may hold is claimed before anything of it can be spoilt: battery, door, then the line's link.
  std::optional<BatteryLock> battery;
  if (!options.memory.empty()) {
    ECS_TRY(lock, BatteryLock::take(options.memory));
    battery.emplace(std::move(lock));
  }
  std::optional<WorkshopSocket> door;
  if (!options.workshop.empty()) {
    ECS_TRY(listening, WorkshopSocket::listen_at(options.workshop));
    door.emplace(std::move(listening));
  }
  ECS_TRY(line, open_line(options));
  ECS_TRY(second_line, open_second_line(options));
  nlohmann::json greeting = ready_line(line.address(), options, serial_number);
  if (second_line) greeting["second_link"] = second_link_of(second_line->address(), options.token_file);
  RunningWorkshop running(std::move(simulation), options, serial_number, std::move(line), std::move(second_line),
                          std::move(door), stop);
  ECS_DO(running.switch_on());
  ready(greeting.dump());
  return running.run();
}

}  // namespace ecs::emulator
