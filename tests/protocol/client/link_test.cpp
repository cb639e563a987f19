// The client against a unit on a real pseudo-terminal and on TCP, with the faults of a line.
#include <algorithm>

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

using namespace ecs;
using namespace ecs::protocol;
using namespace std::chrono_literals;

namespace {

void check_everyday_use(Workshop& shop) {
  auto unit = shop.client();
  const auto identity = must(unit.identity());
  CHECK(identity.serial_number == "ECS-0042");
  CHECK(identity.axis_present == PerAxis<bool>{true, true, false});
  const auto status = must(unit.status());
  CHECK(status.axes[1].position_mm == -12.5);
  CHECK(status.pointers[3] == CurvePointer{17, 0x100022});
  CHECK(status.pointers[4].index == kUnused);
  const auto first = unit.monitor();
  CHECK(must(unit.monitor()).number == first->number + 1);
  CHECK(unit.enter_compensation().has_value());
  CHECK(unit.status()->mode == UnitMode::compensating);
  const auto refused = unit.set_axis_position(Axis::X, 1.0);
  REQUIRE_FALSE(refused.has_value());
  CHECK(refused.error().kind == ProblemKind::refused);
  CHECK(says(refused, "utility mode integrate"));
  CHECK(must_fail(unit.write_memory(kBankA.first, noise_image(100))).kind == ProblemKind::refused);
  CHECK(unit.enter_integration().has_value());
  CHECK(unit.set_axis_position(Axis::Y, -1.5).has_value());
  shop.in_model([](UnitModel& model) {
    CHECK(model.last.axis == Axis::Y);
    CHECK(model.last.position_mm == -1.5);
  });
  const auto image = noise_image(5001);
  REQUIRE(unit.begin_staging(StagingFrom::cleared).has_value());
  CHECK(unit.write_memory(kBankA.first + 7, image).has_value());
  CHECK(unit.read_memory(kBankA.first + 7, image.size()).value() == image);
  CHECK(unit.check_memory(kBankA.first + 7, 5001).value() == crc32_of(image));
  const auto nowhere = unit.read_memory(0x900000, 16);
  CHECK(says(nowhere, "no such registers or memory"));
  CHECK(unit.link().statistics().retries == 0);
}

}  // namespace

TEST_CASE("identity, status, monitor, commands and memory work over a pseudo-terminal") {
  auto shop = Workshop::on_pty();
  check_everyday_use(shop);
}

TEST_CASE("identity, status, monitor, commands and memory work over TCP") {
  auto shop = Workshop::on_tcp();
  check_everyday_use(shop);
}

TEST_CASE("a unit is asked for its rotary axes from firmware 1.2 on, before it has none") {
  auto shop = Workshop::on_tcp();
  auto unit = shop.client();
  const RotarySample turning{{0.5, 0.0, -2.0}, {{{'B', true, 45.0, Approach::forward}, {}}}};
  shop.in_model([&](UnitModel& model) { model.turning = turning; });
  for (const auto& [firmware, shows] :
       {std::pair{std::array<std::uint16_t, 2>{1, 1}, false}, std::pair{std::array<std::uint16_t, 2>{0, 9}, false},
        std::pair{std::array<std::uint16_t, 2>{1, 2}, true}, std::pair{std::array<std::uint16_t, 2>{2, 0}, true}}) {
    shop.in_model([&](UnitModel& model) { model.firmware = firmware; });
    CHECK(must(unit.rotary(must(unit.identity()))) == (shows ? turning : RotarySample{}));
  }
  shop.in_model([](UnitModel& model) { CHECK(model.rotary_asked == 2); });
}

TEST_CASE("under every fault of the link a reading is right or a clear error, and the link recovers") {
  for (std::size_t i = 0; i < kLinkFaults; ++i) {
    const auto fault = static_cast<LinkFault>(i);
    CAPTURE(name_of(fault));
    auto shop = Workshop::on_pty();
    auto unit = shop.client();
    std::uint32_t last = unit.monitor().value().number;
    shop.fault(fault, 2);
    for (int n = 0; n < 4; ++n) {
      const auto sample = must(unit.monitor());
      CHECK(sample.number > last);
      CHECK(sample.axes[0].position_mm == sample.number);
      last = sample.number;
    }
    const auto& counts = unit.link().statistics();
    if (fault != LinkFault::slow_reply) CHECK(counts.retries >= 1);
  }
}

TEST_CASE("a late reply is never taken for the reply to a later request") {
  auto shop = Workshop::on_pty();
  const auto image = noise_image(2400);
  shop.in_server([&](ModbusServer& server, UnitModel& model) {
    std::copy(image.begin(), image.end(), model.bank_a.begin());
    server.faults().with_probability(LinkFault::stale_reply, 0.4);
  });
  auto unit = shop.client();
  // pieces of one length: only the echo tells their replies apart
  for (std::uint32_t n = 0; n < 10; ++n) {
    const auto piece = unit.read_memory(kBankA.first + n * 240, 240);
    if (!piece) continue;
    CHECK(std::equal(piece->begin(), piece->end(), image.begin() + n * 240));
  }
  CHECK(unit.link().statistics().stale_replies > 0);
}

TEST_CASE("a reply later than the response time-out is discarded as late") {
  auto shop = Workshop::on_pty();
  shop.in_server([](ModbusServer& server, UnitModel&) {
    server.faults().slow_ms = 230.0;
    server.faults().next(LinkFault::slow_reply, 1);
  });
  auto unit = shop.client();
  const auto sample = must(unit.monitor());
  CHECK(sample.number == 2);  // the first sample was the late one
  CHECK(unit.link().statistics().timeouts == 1);
}

TEST_CASE("late replies over TCP are recognised too") {
  auto shop = Workshop::on_tcp();
  auto unit = shop.client();
  shop.fault(LinkFault::stale_reply, 1);
  for (std::uint32_t n = 0; n < 3; ++n) {
    const auto sample = must(unit.monitor());
    CHECK(sample.number == n + 3);  // the first was late, and the second came behind it
  }
}

TEST_CASE("a repeated command is carried out once") {
  auto shop = Workshop::on_pty();
  auto unit = shop.client();
  CHECK(unit.output_off().has_value());
  shop.fault(LinkFault::no_reply, 2);
  CHECK(unit.clear_fault().has_value());
  const auto log = shop.in_model([](UnitModel& model) { return model.log; });
  CHECK(log == std::vector{CommandCode::output_off, CommandCode::clear_fault});
}

TEST_CASE("a long command is followed to its end, and stopped when its time is over or it is cancelled") {
  std::atomic<bool> cancelled{false};
  auto shop = Workshop::on_pty();
  auto unit = shop.client(&cancelled);
  shop.in_model([](UnitModel& model) { model.busy_polls_left = 3; });
  int seen = 0;
  CHECK(must(unit.test_datum(Axis::X, 10s, [&](const CommandResult& busy) {
          ++seen;
          CHECK(busy.text == "move the axis");
        })).value == 99);
  CHECK(seen >= 3);

  shop.in_model([](UnitModel& model) { model.busy_polls_left = 1'000'000; });
  const auto late = unit.test_datum(Axis::X, 100ms);
  CHECK(says(late, "not finished in time"));
  CHECK_FALSE(shop.in_model([](UnitModel& model) { return model.busy; }));

  const auto given_up = unit.test_datum(Axis::X, 10s, [&](const CommandResult&) { cancelled = true; });
  CHECK(says(given_up, "cancelled"));
  CHECK_FALSE(shop.in_model([](UnitModel& model) { return model.busy; }));
}

TEST_CASE("while a command is busy another one is refused and the first goes on") {
  auto shop = Workshop::on_tcp();
  shop.in_model([](UnitModel& model) { model.busy_polls_left = 1'000'000; });
  auto other = shop.client();
  auto unit = shop.client();
  std::optional<Problem> refusal;
  const auto result = unit.test_datum(Axis::X, 10s, [&](const CommandResult&) {
    if (refusal) return;
    refusal = other.clear_fault().error();
    shop.in_model([](UnitModel& model) { model.busy_polls_left = 0; });
  });
  REQUIRE(refusal.has_value());
  CHECK(contains(refusal->message, "another command is running"));
  REQUIRE(result.has_value());  // though another host has asked meanwhile
  CHECK(result->value == 99);
}

TEST_CASE("an absent unit and a wrong unit number give no answer on a serial line, a clear exception on TCP") {
  auto shop = Workshop::on_pty();
  auto address = shop.address();
  address.unit = 9;
  auto options = shop.options();
  options.timing->tries = 2;
  const auto wrong = UnitClient::connect(address, options);
  CHECK(says(wrong, "no answer"));
  CHECK(says(wrong, "2 tries"));
  CHECK(says(wrong, "unit number"));
  auto tcp_shop = Workshop::on_tcp();
  address = tcp_shop.address();
  address.unit = 9;
  const auto wrong_tcp = UnitClient::connect(address, tcp_shop.options());
  CHECK(says(wrong_tcp, "no unit with this number"));
}

TEST_CASE("a link that corrupts every reply is reported as such") {
  auto shop = Workshop::on_pty();
  auto unit = shop.client();
  shop.fault_often(LinkFault::bad_crc, 1.0);
  const auto sample = unit.monitor();
  CHECK(says(sample, "garbled"));
  CHECK(unit.link().statistics().crc_errors == 4);
}

TEST_CASE("each way a port cannot be opened has its own message") {
  const auto opened = [](const std::string& text) { return Link::open(link_address_of(text).value()); };
  CHECK(says(opened("rtu:/dev/no_such_port:9600"), "no such port"));
  CHECK(says(opened("rtu:/tmp:9600"), "folder"));
  CHECK(says(opened("rtu:/dev/null:9600"), "not a serial port"));
  CHECK(says(opened("tcp:no-such-host.invalid:502"), "no such host"));
  CHECK(says(opened("tcp:127.0.0.1:1"), "cannot connect"));
}

TEST_CASE("a port without permission says so") {
  auto server = ModbusServer::on_pty({}).value();
  const auto device = std::get<SerialPort>(server.address().endpoint).device;
  REQUIRE(::chmod(device.c_str(), 0) == 0);
  const bool root = ::geteuid() == 0;
  constexpr uid_t kNobody = 65'534;
  if (root) REQUIRE(::seteuid(kNobody) == 0);
  const auto link = Link::open(server.address());
  if (root) REQUIRE(::seteuid(0) == 0);
  CHECK(says(link, "permission"));
}

TEST_CASE("a port in use is refused with its user; it is free again after closing") {
  auto shop = Workshop::on_pty();
  {
    auto unit = shop.client();
    const auto second = Link::open(shop.address());
    REQUIRE_FALSE(second.has_value());
    CHECK(says(second, "in use by pid " + std::to_string(::getpid())));
    CHECK(unit.identity().has_value());
  }
  CHECK(Link::open(shop.address()).has_value());
}

TEST_CASE("a link that disappears is an error at once, and every later call too") {
  for (const bool tcp : {false, true}) {
    auto shop = tcp ? Workshop::on_tcp() : Workshop::on_pty();
    auto unit = shop.client();
    REQUIRE(unit.identity().has_value());
    shop.cut_line();
    std::this_thread::sleep_for(50ms);
    const auto begun = std::chrono::steady_clock::now();
    for (int n = 0; n < 3; ++n) {
      const auto sample = unit.monitor();
      CHECK(says(sample, "the connection is lost"));
      CHECK(unit.link().last_failure() == LinkFailure::disconnected);
    }
    CHECK(std::chrono::steady_clock::now() - begun < 5s);
    CHECK_FALSE(unit.link().reconnect().has_value());
    CHECK_FALSE(unit.monitor().has_value());
  }
}

TEST_CASE("a cancel ends the wait for a reply") {
  std::atomic<bool> cancelled{false};
  auto shop = Workshop::on_pty();
  auto options = shop.options(&cancelled);
  options.timing->response_timeout = 60s;
  UnitClient unit(Link::open(shop.address(), options).value());
  shop.fault(LinkFault::no_reply, 1);
  std::thread later([&] {
    std::this_thread::sleep_for(100ms);
    cancelled = true;
  });
  const auto begun = std::chrono::steady_clock::now();
  const auto sample = unit.monitor();
  later.join();
  REQUIRE_FALSE(sample.has_value());
  CHECK(unit.link().last_failure() == LinkFailure::cancelled);
  CHECK(std::chrono::steady_clock::now() - begun < 10s);
}

namespace {

/// A peer that answers every request with bytes of no end, one every few milliseconds.
class Dripping {
 public:
  /// @param head  what comes first, at once
  explicit Dripping(const std::string& head = {"\0\1\0\0\0\170\1\27\164", 9})
      : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof place;
    auto* const general = reinterpret_cast<sockaddr*>(&place);
    REQUIRE(::bind(listener_, general, size) == 0);
    REQUIRE(::listen(listener_, 1) == 0);
    REQUIRE(::getsockname(listener_, general, &size) == 0);
    port = ntohs(place.sin_port);
    thread_ = std::jthread([this, head](const std::stop_token& stop) {
      const int peer = ::accept(listener_, nullptr, nullptr);
      (void)::send(peer, head.data(), head.size(), MSG_NOSIGNAL);
      while (!stop.stop_requested()) {
        const char byte = 'x';
        if (::send(peer, &byte, 1, MSG_NOSIGNAL) < 0) break;
        std::this_thread::sleep_for(20ms);
      }
      ::close(peer);
    });
  }
  Dripping(const Dripping&) = delete;
  Dripping& operator=(const Dripping&) = delete;
  ~Dripping() {
    thread_.request_stop();
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }
  std::uint16_t port = 0;

 private:
  int listener_;
  std::jthread thread_;
};

}  // namespace

TEST_CASE("a cancel takes effect at once behind a peer that drips bytes") {
  Dripping peer;
  std::atomic<bool> cancelled{false};
  UnitClient unit(Link::open({TcpPeer{"127.0.0.1", peer.port}, 1}, {&cancelled, std::nullopt}).value());
  std::jthread later([&] {
    std::this_thread::sleep_for(300ms);
    cancelled = true;
  });
  const auto begun = std::chrono::steady_clock::now();
  CHECK_FALSE(unit.upload_image(noise_image(1000)).has_value());
  CHECK(std::chrono::steady_clock::now() - begun < 3s);
}

TEST_CASE("answers to another host's requests do not count as late ones") {
  auto shop = Workshop::on_pty();
  auto unit = shop.client();
  REQUIRE(unit.monitor().has_value());
  shop.in_model([](UnitModel& model) { model.foreign_replies = 1; });
  const auto sample = unit.monitor();
  CHECK(sample.has_value());
  CHECK(unit.link().statistics().foreign_replies == 1);
  CHECK(unit.link().statistics().stale_replies == 0);
  shop.in_model([](UnitModel& model) { model.foreign_replies = 100; });
  const auto none = unit.monitor();
  CHECK(says(none, "end the other program, or disconnect it"));
}

TEST_CASE("a TCP peer that is no unit is distinguished from a disturbed line: there is no CRC on TCP") {
  Dripping peer("HTTP/1.0 400 Bad Request\r\n\r\n");
  const LinkAddress address{TcpPeer{"127.0.0.1", peer.port}, 1};
  LinkTiming timing = timing_of(address);
  timing.tries = 1;
  UnitClient unit(Link::open(address, {nullptr, timing}).value());
  const auto answer = unit.identity();
  CHECK(says(answer, "not answers of a unit"));
  CHECK_FALSE(says(answer, "CRC"));
}

TEST_CASE("a TCP unit that asks for a token answers only who shows it first") {
  const Folder folder;
  const std::string right = folder.with("right", "four words of chance\n");
  const std::string wrong = folder.with("wrong", "four other words\n");
  TcpOptions asking;
  asking.token_file = right;
  Workshop shop(ModbusServer::on_tcp(asking).value());
  auto address = shop.address();
  CHECK(UnitClient::connect(address, shop.options()).has_value());
  auto& peer = std::get<TcpPeer>(address.endpoint);
  peer.token_file = wrong;
  const auto refused = UnitClient::connect(address, shop.options());
  CHECK(says(refused, "does not accept the token"));
  peer.token_file.clear();
  CHECK_FALSE(UnitClient::connect(address, shop.options()).has_value());
  peer.token_file = folder / "none";
  CHECK_FALSE(UnitClient::connect(address, shop.options()).has_value());
  auto open_shop = Workshop::on_tcp();
  address = open_shop.address();
  std::get<TcpPeer>(address.endpoint).token_file = right;
  const auto superfluous = UnitClient::connect(address, open_shop.options());
  CHECK(says(superfluous, "requires no token"));
}

TEST_CASE("TCP beyond this computer needs a token at both ends") {
  TcpOptions everywhere;
  everywhere.host = "0.0.0.0";
  const auto server = ModbusServer::on_tcp(everywhere);
  CHECK(says(server, "a token is required"));
  const auto client = UnitClient::connect({TcpPeer{"192.0.2.1", 502}, 1});
  CHECK(says(client, "?token=FILE"));
}

TEST_CASE("a unit that starts between arm and begin is armed again by a host that knows the code") {
  Workshop shop(ModbusServer::on_tcp({}).value(), "271828");
  auto unit = shop.client();
  unit.know_code("271828");
  shop.in_model([](UnitModel& model) { model.starts_on_arming = 2; });
  CHECK(unit.begin_staging(StagingFrom::cleared).has_value());
  CHECK(shop.in_model([](UnitModel& model) { return model.unit_clock.starts; }) == 3);
  shop.in_model([](UnitModel& model) { model.starts_on_arming = 100; });
  REQUIRE(unit.disarm());
  const auto hopeless = unit.begin_staging(StagingFrom::cleared);
  CHECK(says(hopeless, "restarts each time"));
}

TEST_CASE("a unit that starts between the look at the session and begin begins all the same") {
  Workshop shop(ModbusServer::on_tcp({}).value(), "271828");
  auto unit = shop.client();
  unit.know_code("271828");
  REQUIRE(unit.begin_staging(StagingFrom::cleared));
  shop.in_model([](UnitModel& model) { model.starts_on_look = true; });
  CHECK(unit.armed_s().value() > 0);
  CHECK(unit.begin_staging(StagingFrom::cleared).has_value());
  CHECK(shop.in_model([](UnitModel& model) { return model.unit_clock.starts; }) == 2);
}

TEST_CASE(
    "a host without the code whose time has ended is told so at begin, though it has looked at its session before") {
  Workshop shop(ModbusServer::on_tcp({}).value(), "271828");
  auto unit = shop.client();
  REQUIRE(unit.arm("271828", 1));
  REQUIRE(unit.begin_staging(StagingFrom::cleared));
  shop.in_model([](UnitModel& model) { model.unit_clock.ms += 60'000; });
  const auto late = unit.begin_staging(StagingFrom::cleared);
  CHECK(says(late, "the time for which this host was armed has ended; this computer is not armed"));
}

TEST_CASE("begin staging of an armed host is one request: the clock need not be looked at") {
  Workshop shop(ModbusServer::on_tcp({}).value(), "271828");
  auto unit = shop.client();
  REQUIRE(unit.arm("271828"));
  const auto before = unit.link().statistics().requests;
  REQUIRE(unit.begin_staging(StagingFrom::cleared));
  CHECK(unit.link().statistics().requests - before == 1);
}

TEST_CASE("a host without the code says whether its time has ended or the unit was restarted since it was armed") {
  Workshop shop(ModbusServer::on_tcp({}).value(), "271828");
  auto unit = shop.client();
  REQUIRE(unit.arm("271828", 1));
  REQUIRE(unit.clear_fault());
  shop.in_model([](UnitModel& model) { model.unit_clock.ms += 60'000; });
  const auto late = unit.clear_fault();
  CHECK(says(late, "the time for which this host was armed has ended; this computer is not armed"));
  REQUIRE(unit.arm("271828", 1));
  REQUIRE(unit.clear_fault());
  shop.in_model([](UnitModel& model) { ++model.unit_clock.starts; });
  const auto restarted = unit.clear_fault();
  CHECK(says(restarted, "the unit was restarted since this host was armed"));
  CHECK(unit.take_wants_code());
}

TEST_CASE("a host arms a unit that was restarted since the host opened its session") {
  Workshop shop(ModbusServer::on_pty({}).value(), "271828");
  auto unit = shop.client();
  REQUIRE(unit.armed_s().value() == 0);
  shop.in_model([](UnitModel& model) { return ++model.unit_clock.starts; });
  CHECK(unit.arm("271828", 30).has_value());
  CHECK(unit.armed_s().value() == 1800);
}

TEST_CASE("a host whose time has ended goes on reading, armed again where it knows the code") {
  for (const bool knows_code : {false, true}) {
    CAPTURE(knows_code);
    Workshop shop(ModbusServer::on_tcp({}).value(), "271828");
    auto unit = shop.client();
    REQUIRE(unit.arm("271828", 1));
    if (knows_code) unit.know_code("271828");
    shop.in_model([](UnitModel& model) { model.unit_clock.ms += 60'000; });
    CHECK(must(unit.read_memory(kBankA.first, 500)).size() == 500);
    CHECK(unit.active_map().has_value());
    CHECK((unit.armed_s().value() > 0) == knows_code);
  }
}

TEST_CASE("the newest events are read, the oldest of them first") {
  auto shop = Workshop::on_tcp();
  auto unit = shop.client();
  CHECK(unit.event_blocks(0)->empty());
  CHECK(unit.event_blocks(8)->empty());
  for (int k = 0; k < 7; ++k) REQUIRE(unit.set_axis_position(Axis::X, k));
  std::vector<std::uint32_t> numbers;
  const auto blocks = unit.event_blocks(5).value();
  for (const Registers& block : blocks) {
    const auto page = value_in<EventPage>(block).value();
    for (const HostEvent& event : page.events)
      if (event.number != 0) numbers.push_back(event.number);
  }
  CHECK(numbers == std::vector<std::uint32_t>{4, 5, 6, 7, 8});  // the first one: this host was armed
}

TEST_CASE("every command of a host reaches the unit as it was given") {
  auto shop = Workshop::on_tcp();
  auto unit = shop.client();
  CHECK(unit.record_datum(Axis::Y, 1s).has_value());
  CHECK(unit.run_ram_test().has_value());
  CHECK(unit.reset_unit().has_value());
  CHECK(unit.run_user_software(0x041000, 77, 1s).has_value());
  const auto [log, last] = shop.in_model([](UnitModel& model) { return std::pair(model.log, model.last); });
  CHECK(log == std::vector{CommandCode::record_datum, CommandCode::run_ram_test, CommandCode::reset_unit,
                           CommandCode::run_user_software});
  CHECK(last.address == 0x041000);
  CHECK(last.argument == 77);
  CHECK(unit.link().address() == shop.address());
}

TEST_CASE("a unit of another protocol version is refused, and both versions are named") {
  auto shop = Workshop::on_tcp();
  shop.in_model([](UnitModel& model) { return model.protocol_version = 7; });
  const auto unit = UnitClient::connect(shop.address(), shop.options());
  CHECK(says(unit, "the unit speaks protocol version 7, this program version 3"));
}

TEST_CASE("a whole table goes as one replacement, with its number of tools and their digest") {
  auto shop = Workshop::on_tcp();
  UnitClient client = shop.client();
  const std::vector<Tool> tools{{9, {0.0, 0.0, -80.12344}}, {3, {1.0, 2.0, 3.0}}};
  REQUIRE(client.replace_tools(tools).has_value());
  ToolTable table;
  for (const Tool& tool : {Tool{3, {1.0, 2.0, 3.0}}, Tool{9, in_tool_steps({0.0, 0.0, -80.1234})}})
    REQUIRE(put_tool(table, tool));
  shop.in_server([&](ModbusServer&, UnitModel& model) {
    CHECK(model.log == std::vector<CommandCode>{CommandCode::begin_tools, CommandCode::stage_tool,
                                                CommandCode::stage_tool, CommandCode::commit_tools});
    CHECK(model.last.length == 2);
    CHECK(model.last.digest == tools_digest(table));
    return true;
  });
}

TEST_CASE("a unit that cannot replace a whole table refuses, and the message says what it can do") {
  auto shop = Workshop::on_tcp();
  shop.in_server([](ModbusServer&, UnitModel& model) { return model.knows_tables = false; });
  UnitClient client = shop.client();
  const std::vector<Tool> tools{{9, {0.0, 0.0, -80.0}}};
  const Problem why = must_fail(client.replace_tools(tools));
  CHECK(why.kind == ProblemKind::refused);
  check_holds(why.message, {"the unit does not know this command; its firmware may be older",
                            "Set its tools one after the other: `ecs utility tool N --offset X,Y,Z`"});
}
