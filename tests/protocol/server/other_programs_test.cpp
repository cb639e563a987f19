// mbpoll and pymodbus, which share no code with this project, talk to the server.
#include <fmt/format.h>

#include "tests/support/command_output.hpp"
#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

using namespace ecs;
using namespace ecs::protocol;

TEST_CASE("mbpoll reads the identity and writes and reads registers over RTU") {
  SKIP_UNLESS(installed("command -v mbpoll"), "mbpoll is not installed");
  auto shop = Workshop::on_pty();
  const auto device = std::get<SerialPort>(shop.address().endpoint).device;
  const auto mbpoll = [&](std::string_view arguments, std::string_view values = "") {
    return output_of(
        fmt::format("mbpoll -m rtu -a 1 -b 115200 -P none -t 4:hex -0 -1 -o 2 {} {} {}", arguments, device, values));
  };
  const auto identity = mbpoll("-r 256 -c 32");
  CAPTURE(identity.text);
  CHECK(contains(identity.text, "0x4543"));  // "EC" of the serial number
  CHECK(contains(identity.text, "0x532D"));  // "S-"
  CHECK(mbpoll("-r 16", "0x1111 0x0010 0x0000 0x0004").status == 0);
  const auto select = mbpoll("-r 16 -c 4");
  CAPTURE(select.text);
  CHECK(contains(select.text, "0x0010"));
  CHECK(contains(mbpoll("-r 1024 -c 7").text, "0x1111"));
  CHECK(contains(mbpoll("-r 384 -c 58").text, "0x1111"));
  CHECK(contains(mbpoll("-r 20000 -c 1").text, "Illegal data address"));
}

TEST_CASE("pymodbus reads the identity and writes and reads registers over TCP") {
  SKIP_UNLESS(installed("/usr/bin/python3 -c 'import pymodbus.client'"), "python3-pymodbus is not installed");
  auto shop = Workshop::on_tcp();
  const auto port = std::get<TcpPeer>(shop.address().endpoint).port;
  const std::string script = fmt::format(R"(
from pymodbus.client import ModbusTcpClient
c = ModbusTcpClient("127.0.0.1", port={})
assert c.connect()
r = c.read_holding_registers(0x0100, 32, slave=1).registers
print("serial", b"".join(x.to_bytes(2, "big") for x in r[4:12]).rstrip(b"\0").decode())
print("write", c.write_registers(0x0010, [7, 0x0010, 0, 240], slave=1).isError())
print("memory", len(c.read_holding_registers(0x0400, 125, slave=1).registers))
print("input", c.read_input_registers(0x0400, 1, slave=1).registers)
print("both", c.readwrite_registers(read_address=0x0100, read_count=2, write_address=0, write_registers=[99], slave=1).registers)
print("outside", c.read_holding_registers(0x4000, 1, slave=1).exception_code)
c.close()
)",
                                         port);
  const auto output = output_of("/usr/bin/python3 -c '" + script + "'");
  CAPTURE(output.text);
  check_holds(output.text, {"serial ECS-0042", "write False", "memory 125", "input [7]", "both [99, 3]", "outside 2"});
}
