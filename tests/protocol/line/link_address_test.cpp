// Link addresses and the times of a line.
#include "protocol/line/link_address.hpp"

#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::protocol;

TEST_CASE("a serial address names device, baud, format and unit, with defaults") {
  CHECK(link_address_of("rtu:/dev/ttyUSB0:115200").value() ==
        LinkAddress{SerialPort{"/dev/ttyUSB0", 115'200, 'N', 1}, 1});
  CHECK(link_address_of("rtu:/dev/ttyS1:9600:8E1:17").value() ==
        LinkAddress{SerialPort{"/dev/ttyS1", 9600, 'E', 1}, 17});
  CHECK(link_address_of("rtu:/dev/ttyS1:9600:8o2").value() == LinkAddress{SerialPort{"/dev/ttyS1", 9600, 'O', 2}, 1});
  CHECK(link_address_of("rtu:/dev/serial/by-path/pci-0000:00:14.0-port0:19200").value() ==
        LinkAddress{SerialPort{"/dev/serial/by-path/pci-0000:00:14.0-port0", 19'200, 'N', 1}, 1});
}

TEST_CASE("a TCP address names host, port and unit") {
  CHECK(link_address_of("tcp:shopfloor:1502").value() == LinkAddress{TcpPeer{"shopfloor", 1502}, 1});
  CHECK(link_address_of("tcp:10.0.0.7:502:9").value() == LinkAddress{TcpPeer{"10.0.0.7", 502}, 9});
  CHECK(link_address_of("tcp:[::1]:502:2").value() == LinkAddress{TcpPeer{"::1", 502}, 2});
}

TEST_CASE("the full text of an address reads back as the same address") {
  for (const char* text : {"rtu:/dev/ttyUSB0:115200:8N1:1", "rtu:/dev/a:b:9600:8E2:247", "tcp:host:502:3",
                           "tcp:[::1]:502:1", "tcp:host:502:1?token=a/b.token"})
    CHECK(to_text(link_address_of(text).value()) == text);
}

TEST_CASE("a wrong address is a usage problem that says what was expected") {
  const auto says = [](const char* text, const char* word) {
    const auto address = link_address_of(text);
    REQUIRE_FALSE_MESSAGE(address.has_value(), text);
    CHECK(address.error().kind == ProblemKind::usage);
    CHECK_MESSAGE(contains(address.error().message, word), address.error().message);
  };
  says("rtu:/dev/ttyUSB0", "baud rate is missing");
  says("rtu:/dev/ttyUSB0:12345", "115200");
  says("rtu:/dev/ttyUSB0:fast", "\"fast\"");
  says("rtu::9600", "device");
  says("rtu:/dev/ttyUSB0:9600:7E1", "8 data bits");
  says("rtu:/dev/ttyUSB0:9600:8N3", "stop bits");
  says("rtu:/dev/ttyUSB0:9600:8N1:248", "1 to 247");
  says("rtu:/dev/ttyUSB0:9600:8N1:0", "1 to 247");
  says("tcp:host", "port");
  says("tcp:host:502?tok=x", "?token=FILE");
  says("tcp:host:502?token=", "?token=FILE");
  says("tcp:host:99999", "99999");
  says("tcp:host:502:x", "unit");
  says("tcp::502", "host");
  says("/dev/ttyUSB0", "rtu:");
  says("", "rtu:");
}

TEST_CASE("times follow from the speed: 3.5 characters up to 19200 baud, 1.75 ms above") {
  using namespace std::chrono_literals;
  const auto at = [](int baud) { return timing_of({SerialPort{"/dev/x", baud, 'N', 1}, 1}); };
  CHECK(at(9600).byte_time == 1'041'667ns);
  CHECK(at(9600).frame_gap == 3'645'833ns);
  CHECK(at(19'200).frame_gap == 1'822'917ns);
  CHECK(at(38'400).frame_gap == 1'750'000ns);
  for (const int baud : {1200, 9600, 115'200}) {
    CHECK(at(baud).byte_timeout >= 20ms);
    CHECK(at(baud).byte_timeout <= 50ms);
    CHECK(at(baud).byte_timeout < at(baud).response_timeout);
    CHECK(at(baud).response_timeout > 2 * 256 * at(baud).byte_time);
  }
}
