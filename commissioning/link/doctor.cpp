#include "commissioning/link/doctor.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "commissioning/link/port_survey.hpp"
#include "commissioning/link/unit_link.hpp"

namespace ecs::commissioning {
namespace {

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
      "end the other program, or take it off the link: one host at a time may use it");
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
        fmt::format("{} answers came after the request had been given up", s.stale_replies),
        "look for a slow converter or network between here and the unit; lower the latency timer of a USB adapter");
  if (s.crc_errors > 0)
    add(work, "disturbed", FindingState::problem, fmt::format("{} answers were garbled", s.crc_errors),
        client.link().address().is_serial() ? "check shield, ground and length of the cable, and the parity"
                                            : "see that no other program listens at this port");
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

/// Of so many quick questions of which none is answered.
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

bool echoes(const LinkAddress& address, Examination& work) {
  const auto raw = raw_answer(std::get<SerialPort>(address.endpoint), address.unit);
  if (!raw) return false;
  if (raw->is_echo()) {
    add(work, "echo", FindingState::problem, "the link returns what is sent",
        "switch the local echo of the RS-485 converter off; with RS-232, check that pins 2 and 3 are not bridged");
    return true;
  }
  if (raw->received.empty())
    add(work, "silence", FindingState::note, "not one byte came back",
        "is the unit on, is the cable crossed (null modem), is it the right port?");
  else
    add(work, "noise", FindingState::note, fmt::format("{} bytes came back that are no answer", raw->received.size()),
        "speed or parity are wrong, or another device is on this link");
  return false;
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
  if (work.cancelled || heard_another_host(address, work) || echoes(address, work)) return;
  if (other_unit_number(address, work) || other_speed(address, work) || work.cancelled) return;
  add(work, "unit", FindingState::problem, "no unit answers at any of the usual speeds, parities and unit numbers",
      "check power and cable; see that no other program uses the link");
}

void examine_tcp(const LinkAddress& address, Examination& work) {
  auto client = UnitClient::connect(address, {&work.cancelled, std::nullopt});
  if (client) {
    static_cast<void>(greet(client, work));
    return;
  }
  add(work, "link", FindingState::problem, client.error().message,
      "check host and port; `ping` the host; a firewall may be in between");
  const auto link = Link::open(address, {&work.cancelled, std::nullopt});
  if (!link) return;
  add(work, "connection", FindingState::ok, "the connection is accepted, only the unit does not answer");
  static_cast<void>(other_unit_number(address, work));
}

void examine_emulator(const LinkChoice& choice, Examination& work) {
  auto link = open_link(choice, work.cancelled);
  if (!link) {
    add(work, "link", FindingState::problem, link.error().message,
        "install `ecs-emulator` beside `ecs`, or give another --link");
    return;
  }
  const auto identity = link->client().identity();
  if (!identity) return add(work, "link", FindingState::problem, identity.error().message);
  work.diagnosis.works = true;
  work.diagnosis.identity = *identity;
  add(work, "link", FindingState::ok, fmt::format("the bundled emulator answers as unit {}", identity->serial_number));
  judge_quality(link->client(), work);
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

}  // namespace ecs::commissioning
