// mbpoll, which shares no code with this project, talks to the server.
#include <doctest/doctest.h>
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
  CHECK(mbpoll("-r 20000 -c 1").text.find("Illegal data address") != std::string::npos);
}
