// A serial port for one program at a time.
#include <cstdlib>

#include <fcntl.h>
#include <unistd.h>

#include "protocol/line/modbus_link.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::protocol;

namespace {

/// Both ends of a pseudo-terminal.
struct Terminal {
  int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  std::string device;
  Terminal() {
    REQUIRE(::grantpt(master) == 0);
    REQUIRE(::unlockpt(master) == 0);
    device = ::ptsname(master);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal() { ::close(master); }
};

}  // namespace

TEST_CASE("a port is taken once, and free again when the lock is gone") {
  const Terminal terminal;
  {
    const auto first = must(lock_port(terminal.device));
    const auto second = must_fail(lock_port(terminal.device));
    CHECK(second.failure != LinkFailure::none);
    CHECK_FALSE(second.problem.message.empty());
  }
  CHECK(lock_port(terminal.device));
}

TEST_CASE("a missing device and a file that is not a serial port are refused") {
  CHECK_FALSE(lock_port("/dev/no-such-port"));
  CHECK_FALSE(lock_port("/dev/null"));
}
