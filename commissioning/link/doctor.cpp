#include "commissioning/link/doctor.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <grp.h>
#include <poll.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/link/unit_link.hpp"
#include "commissioning/unit/status.hpp"
#include "protocol/line/modbus_link.hpp"
#include "protocol/registers/register_map.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// A built-in port without a chip has the driver serial8250's "type" 0.
bool has_hardware(const std::string& name) {
  const fs::path entry = fs::path("/sys/class/tty") / name;
  if (!disc::exists(entry / "device")) return false;
  std::array<char, 8> type{};
  const Descriptor file(::open((entry / "type").c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) return true;
  return ::read(file.get(), type.data(), type.size() - 1) <= 0 || type[0] != '0';
}

/// Joining a group helps only if that group may read and write, and nobody should join root.
std::string way_to_permission(const std::string& device) {
  struct stat file {};
  const group* owner = ::stat(device.c_str(), &file) == 0 ? ::getgrgid(file.st_gid) : nullptr;
  const bool group_may = (file.st_mode & (S_IRGRP | S_IWGRP)) == (S_IRGRP | S_IWGRP);
  if (owner != nullptr && file.st_gid != 0 && group_may)
    return fmt::format("run `sudo usermod -aG {} $USER`, then log out and in again", owner->gr_name);
  return fmt::format(
      "no group may use this port: as root write `KERNEL==\"{}\", GROUP=\"dialout\", MODE=\"0660\"` into "
      "/etc/udev/rules.d/90-ecs.rules, run `udevadm control --reload` and `udevadm trigger`, and join the group with "
      "`usermod -aG dialout` and your name",
      fs::path(device).filename().string());
}

speed_t speed_of(int baud) {
  constexpr std::array<std::pair<int, speed_t>, 8> kSpeeds{{{1200, B1200},
                                                            {2400, B2400},
                                                            {4800, B4800},
                                                            {9600, B9600},
                                                            {19200, B19200},
                                                            {38400, B38400},
                                                            {57600, B57600},
                                                            {115200, B115200}}};
  for (const auto& [number, speed] : kSpeeds)
    if (number == baud) return speed;
  return B115200;
}

void make_raw(int fd, const protocol::SerialPort& line) {
  termios mode{};
  if (::tcgetattr(fd, &mode) != 0) return;
  ::cfmakeraw(&mode);
  mode.c_cflag |= CLOCAL | CREAD;
  if (line.parity != 'N') mode.c_cflag |= PARENB;
  if (line.parity == 'O') mode.c_cflag |= PARODD;
  if (line.stop_bits == 2) mode.c_cflag |= CSTOPB;
  ::cfsetspeed(&mode, speed_of(line.baud));
  ::tcsetattr(fd, TCSANOW, &mode);
  ::tcflush(fd, TCIOFLUSH);
}

/// Function 3 on the identity block.
std::vector<std::uint8_t> read_request(int unit) {
  constexpr auto first = protocol::kIdentity.first;
  std::vector<std::uint8_t> frame{static_cast<std::uint8_t>(unit), 3, first >> 8, first & 0xFF, 0, 2};
  const std::uint16_t crc = protocol::crc16_of(frame);
  frame.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}

}  // namespace

std::vector<std::string> serial_ports() {
  std::vector<std::string> ports;
  for (const std::string& name : names_in("/dev")) {
    const bool adapter = name.starts_with("ttyUSB") || name.starts_with("ttyACM") || name.starts_with("rfcomm");
    const bool built_in = (name.starts_with("ttyS") || name.starts_with("ttyAMA")) && has_hardware(name);
    if (adapter || built_in) ports.push_back("/dev/" + name);
  }
  for (const std::string& name : names_in("/dev/serial/by-id")) ports.push_back("/dev/serial/by-id/" + name);
  return ports;
}

std::optional<PortTrouble> trouble_with(const std::string& device) {
  const auto lock = protocol::lock_port(device);
  if (lock) return std::nullopt;
  PortTrouble trouble{lock.error().problem.message, {}};
  const auto ports = serial_ports();
  switch (lock.error().failure) {
    case protocol::LinkFailure::no_such_port:
      trouble.action = ports.empty()
                           ? std::string("this computer has no serial port now: plug in the adapter and check `dmesg`")
                           : fmt::format("available ports: {}", fmt::join(ports, ", "));
      break;
    case protocol::LinkFailure::no_permission:
      trouble.action = way_to_permission(device);
      break;
    case protocol::LinkFailure::not_a_serial_port:
      trouble.action = ports.empty() ? std::string("give the name of a serial port, such as /dev/ttyUSB0")
                                     : fmt::format("available serial ports: {}", fmt::join(ports, ", "));
      break;
    case protocol::LinkFailure::port_in_use:
      trouble.action = "only one program at a time can use a port";
      break;
    default:
      trouble.action = "check the messages about this port in `dmesg`";
  }
  return trouble;
}

bool PortAnswer::is_echo() const {
  return received.size() >= sent.size() && std::equal(sent.begin(), sent.end(), received.begin());
}

namespace {

Result<PortAnswer> raw_answer(const protocol::SerialPort& line, int unit) {
  const Descriptor port(::open(line.device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (port.get() < 0) return problem(ProblemKind::link, "{}: {}", line.device, std::strerror(errno));
  make_raw(port.get(), line);
  PortAnswer answer{read_request(unit), {}};
  if (::write(port.get(), answer.sent.data(), answer.sent.size()) != static_cast<ssize_t>(answer.sent.size()))
    return problem(ProblemKind::link, "{}: cannot write: {}", line.device, std::strerror(errno));
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
  while (std::chrono::steady_clock::now() < end && answer.received.size() < 256) {
    pollfd readable{port.get(), POLLIN, 0};
    if (::poll(&readable, 1, 50) <= 0) continue;
    std::array<std::uint8_t, 256> piece{};
    const ssize_t length = ::read(port.get(), piece.data(), piece.size());
    if (length <= 0) break;
    answer.received.insert(answer.received.end(), piece.begin(), piece.begin() + length);
  }
  return answer;
}

using protocol::Link;
using protocol::LinkAddress;
using protocol::LinkFailure;
using protocol::SerialPort;
using protocol::UnitClient;

constexpr int kQualityReads = 20;
constexpr std::array<int, 5> kBauds{115'200, 38'400, 19'200, 9'600, 57'600};
constexpr std::array<char, 3> kParities{'N', 'E', 'O'};
constexpr int kMostUnit = 10;

/// One examination under way.
struct Examination {
  const DoctorNote& note;
  const FindingCallback& on_finding;
  const std::atomic<bool>& cancelled;
  Diagnosis diagnosis;
};

void add(Examination& work, std::string check, FindingState state, std::string message, std::string action = {}) {
  work.diagnosis.findings.push_back({std::move(check), state, std::move(message), std::move(action)});
  if (work.on_finding) work.on_finding(work.diagnosis.findings.back());
}

/// True: another host's answers arrive on this link.
bool judge_other_hosts(const UnitClient& client, Examination& work) {
  const auto foreign = client.link().statistics().foreign_replies;
  if (foreign == 0) return false;
  add(work, "another host", FindingState::problem, fmt::format("{} answers were to another host's requests", foreign),
      "end the other program or disconnect it: only one host at a time may use the link");
  return true;
}

/// Reads again and again, and says how good the link is.
void judge_quality(UnitClient& client, Examination& work) {
  int answered = 0;
  for (int i = 0; i < kQualityReads && !work.cancelled; ++i) answered += client.identity().has_value() ? 1 : 0;
  const auto& s = work.diagnosis.statistics = client.link().statistics();
  add(work, "line", FindingState::ok,
      fmt::format("{} of {} reads answered, {:.1f} ms a read, slowest {:.1f} ms", answered, kQualityReads,
                  s.mean_round_trip_ms(), s.worst_round_trip_ms));
  static_cast<void>(judge_other_hosts(client, work));
  if (s.stale_replies > 0)
    add(work, "late answers", FindingState::problem,
        fmt::format("{} answers came after the time-out of the request", s.stale_replies),
        "check for a slow converter or network between this computer and the unit; lower the latency timer of a USB "
        "adapter");
  if (s.crc_errors > 0)
    add(work, "disturbed", FindingState::problem, fmt::format("{} answers were garbled", s.crc_errors),
        client.link().address().is_serial() ? "check shield, ground and length of the cable, and the parity"
                                            : "make sure that no other program listens at this port");
  if (s.timeouts > 0)
    add(work, "lost answers", FindingState::problem, fmt::format("{} requests had no answer", s.timeouts),
        "check plugs and cable");
}

/// Asked once more where nothing answered: the answers of another host's requests explain it.
bool heard_another_host(const LinkAddress& address, Examination& work) {
  auto link = Link::open(address, {&work.cancelled, std::nullopt});
  if (!link) return false;
  UnitClient client(std::move(*link));
  static_cast<void>(client.identity());
  return judge_other_hosts(client, work);
}

/// The battery that keeps the map, and whether the control is on.
void judge_supplies(UnitClient& client, Examination& work) {
  const auto lines = client.control_lines();
  if (!lines) return;
  work.diagnosis.lines = *lines;
  const bool low = lines->battery == protocol::BatteryState::low;
  add(work, "battery", low ? FindingState::problem : FindingState::ok, battery_cell(*lines).text);
  if (lines->control_on_wired)
    add(work, "control", lines->control_on ? FindingState::ok : FindingState::note, control_cell(*lines).text);
}

bool greet(Result<UnitClient>& client, Examination& work) {
  const auto identity = client->identity();
  if (!identity) {
    add(work, "link", FindingState::problem, identity.error().message, "try again");
    return false;
  }
  work.diagnosis.identity = *identity;
  work.diagnosis.works = true;
  add(work, "link", FindingState::ok,
      fmt::format("unit {} ({}) answers, firmware {}.{}", identity->serial_number, identity->unit_name,
                  identity->firmware_major, identity->firmware_minor));
  judge_quality(*client, work);
  judge_supplies(*client, work);
  return true;
}

/// One quick question at another setting.
bool answers(const LinkAddress& address, const std::atomic<bool>& cancelled) {
  if (cancelled) return false;
  protocol::LinkTiming timing = protocol::timing_of(address);
  timing.tries = 1;
  return UnitClient::connect(address, {&cancelled, timing}).has_value();
}

bool found_elsewhere(const LinkAddress& address, const char* check, const std::string& what, Examination& work) {
  if (!answers(address, work.cancelled)) return false;
  work.diagnosis.working_link = to_text(address);
  add(work, check, FindingState::problem, what, fmt::format("use --link {}", work.diagnosis.working_link));
  return true;
}

/// Of this many quick questions of which none is answered.
int most_seconds(const LinkAddress& address, std::size_t questions) {
  const protocol::LinkTiming timing = protocol::timing_of(address);
  const std::chrono::duration<double> one = timing.response_timeout + timing.quiet_time;
  return static_cast<int>(std::ceil(one.count() * static_cast<double>(questions)));
}

bool other_unit_number(LinkAddress address, Examination& work) {
  work.note(fmt::format("trying unit numbers 1 to {}, at most {} s", kMostUnit, most_seconds(address, kMostUnit)));
  const int given = address.unit;
  for (address.unit = 1; address.unit <= kMostUnit; ++address.unit)
    if (address.unit != given &&
        found_elsewhere(address, "unit number", fmt::format("unit {} answers, unit {} does not", address.unit, given),
                        work))
      return true;
  return false;
}

bool other_speed(LinkAddress address, Examination& work) {
  const SerialPort given = std::get<SerialPort>(address.endpoint);
  for (const char parity : kParities) {
    const auto parities_left =
        static_cast<std::size_t>(kParities.end() - std::find(kParities.begin(), kParities.end(), parity));
    work.note(fmt::format("trying {} to {} baud with parity {}, at most {} s for all parities left", 9'600, 115'200,
                          parity, most_seconds(address, kBauds.size() * parities_left)));
    for (const int baud : kBauds) {
      SerialPort line = given;
      line.baud = baud;
      line.parity = parity;
      if (line == given) continue;
      address.endpoint = line;
      if (found_elsewhere(address, "speed",
                          fmt::format("the unit answers at {} baud, parity {}, not at {} baud, parity {}", baud, parity,
                                      given.baud, given.parity),
                          work))
        return true;
    }
  }
  return false;
}

/// What came back to a question without an answer; an echo explains everything.
bool is_echo(const PortAnswer& raw, Examination& work) {
  if (raw.is_echo())
    add(work, "echo", FindingState::problem, "the link echoes the sent bytes",
        "switch the local echo of the RS-485 converter off; with RS-232, check that pins 2 and 3 are not bridged");
  else if (!raw.received.empty())
    add(work, "noise", FindingState::note,
        fmt::format("{} bytes were received that are not an answer", raw.received.size()),
        "speed or parity is wrong, or another device is on this link");
  return raw.is_echo();
}

void examine_serial(const LinkAddress& address, Examination& work) {
  const SerialPort& line = std::get<SerialPort>(address.endpoint);
  if (const auto trouble = trouble_with(line.device)) {
    add(work, "port", FindingState::problem, trouble->message, trouble->action);
    return;
  }
  add(work, "port", FindingState::ok, fmt::format("{} can be opened", line.device));
  auto client = UnitClient::connect(address, {&work.cancelled, std::nullopt});
  if (client && greet(client, work)) return;
  if (!client) add(work, "link", FindingState::problem, client.error().message);
  if (work.cancelled || heard_another_host(address, work)) return;
  const auto raw = raw_answer(line, address.unit);
  if (raw && is_echo(*raw, work)) return;
  if (other_unit_number(address, work) || other_speed(address, work) || work.cancelled) return;
  if (raw && raw->received.empty())  // at the given setting: advice only where no other setting is answered
    add(work, "silence", FindingState::note, "no byte was received",
        "check that the unit is on, that the cable is crossed (null modem) and that the port is right");
  add(work, "unit", FindingState::problem, "no unit answers at any of the usual speeds, parities and unit numbers",
      "check power and cable; make sure that no other program uses the link");
}

void examine_tcp(const LinkAddress& address, Examination& work) {
  auto client = UnitClient::connect(address, {&work.cancelled, std::nullopt});
  if (client) {
    static_cast<void>(greet(client, work));
    return;
  }
  const auto link = Link::open(address, {&work.cancelled, std::nullopt});
  if (!link) {
    add(work, "link", FindingState::problem, client.error().message,
        "check host and port; `ping` the host; a firewall may be in between");
    return;
  }
  add(work, "connection", FindingState::ok, "host and port are right: the connection is accepted");
  add(work, "link", FindingState::problem, client.error().message, "check that the unit is on, and its unit number");
  static_cast<void>(other_unit_number(address, work));
}

void examine_emulator(const LinkChoice& choice, Examination& work) {
  auto link = open_link(choice, work.cancelled);
  if (!link) {
    add(work, "link", FindingState::problem, link.error().message,
        "install `ecs-emulator` in the folder of `ecs`, or give another --link");
    return;
  }
  const auto identity = link->client().identity();
  if (!identity) return add(work, "link", FindingState::problem, identity.error().message);
  work.diagnosis.works = true;
  work.diagnosis.identity = *identity;
  add(work, "link", FindingState::ok, fmt::format("the bundled emulator answers as unit {}", identity->serial_number));
  judge_quality(link->client(), work);
  judge_supplies(link->client(), work);
}

}  // namespace

std::string_view name_of(FindingState state) {
  if (state == FindingState::ok) return "ok";
  return state == FindingState::note ? "note" : "problem";
}

Diagnosis diagnosis_of(const LinkChoice& choice, const DoctorNote& note, const FindingCallback& on_finding,
                       const std::atomic<bool>& cancelled) {
  Examination work{note, on_finding, cancelled, {}};
  if (choice.is_emulator()) {
    examine_emulator(choice, work);
    return std::move(work.diagnosis);
  }
  const auto& address = std::get<LinkAddress>(choice.link);
  if (address.is_serial())
    examine_serial(address, work);
  else
    examine_tcp(address, work);
  return std::move(work.diagnosis);
}

Problem why_not(const Diagnosis& diagnosis) {
  Problem why{ProblemKind::link, "the link does not work", {}, 0, 0, {}};
  for (const DoctorFinding& finding : diagnosis.findings) {
    if (finding.state != FindingState::problem) continue;
    why.message = finding.message + (finding.action.empty() ? "" : "; " + finding.action);
    break;
  }
  return why;
}

namespace {

bool on_path(const char* program) {
  const char* path = std::getenv("PATH");
  for (const std::string_view folder : split(path == nullptr ? "" : path, ':'))
    if (::access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

DoctorFinding emulator_finding() {
  if (const auto program = emulator_program()) return {"emulator", FindingState::ok, program->string(), {}};
  return {"emulator", FindingState::note, "the bundled emulator `ecs-emulator` is not found",
          "install it in the folder of `ecs`; only --link emulator needs it"};
}

DoctorFinding sample_finding() {
  if (const auto machine = sample_machine()) return {"sample machine", FindingState::ok, machine->string(), {}};
  return {"sample machine", FindingState::note, "samples/mill/machine.toml is not found",
          "set ECS_SAMPLES to the folder `samples`, or give --link emulator:machine.toml"};
}

DoctorFinding gnuplot_finding() {
  if (on_path("gnuplot")) return {"gnuplot", FindingState::ok, "gnuplot is installed", {}};
  return {"gnuplot", FindingState::note, "gnuplot is not found: no plots as SVG or PNG",
          "install the package gnuplot-nox"};
}

DoctorFinding terminal_finding() {
  const char* kind = std::getenv("TERM");
  if (::isatty(STDOUT_FILENO) == 1 && kind != nullptr && std::string_view(kind) != "dumb")
    return {"terminal", FindingState::ok, fmt::format("a terminal of kind {}", kind), {}};
  return {"terminal",
          FindingState::note,
          "the output does not go to a terminal window, or its type (the variable TERM) is unknown: no screens, no "
          "progress bar",
          {}};
}

}  // namespace

std::vector<DoctorFinding> surroundings() {
  return {emulator_finding(), sample_finding(), gnuplot_finding(), terminal_finding()};
}

}  // namespace ecs::commissioning
