// The server on a real pseudo-terminal and on TCP: its symbolic link, and which request it answers when.
#include "protocol/server/server.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/process.hpp"
#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

using namespace ecs;
using namespace ecs::protocol;
using namespace std::chrono_literals;

namespace {

/// A TCP connection that waits for nothing.
class RawConnection {
 public:
  explicit RawConnection(const LinkAddress& address) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    place.sin_port = htons(std::get<TcpPeer>(address.endpoint).port);
    REQUIRE(::connect(socket_.get(), reinterpret_cast<sockaddr*>(&place), sizeof place) == 0);
  }
  /// Asks so often for the first register of the identity.
  void ask(int times = 1) const {
    const std::string request{"\0\1\0\0\0\6\1\3\1\0\0\1", 12};
    std::string all;
    for (int k = 0; k < times; ++k) all += request;
    REQUIRE(::send(socket_.get(), all.data(), all.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(all.size()));
  }
  /// How many bytes have come; 0: the unit has closed the connection, -1: none yet.
  [[nodiscard]] ssize_t heard() const {
    std::array<char, 64> bytes{};
    return ::recv(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  }

 private:
  Descriptor socket_;
};

/// Notes whose request comes when.
struct NotedOrder : RegisterHandler {
  std::vector<std::uint64_t> connections;
  void arrives_on(std::uint64_t connection, const std::string&) override { connections.push_back(connection); }
  tl::expected<Registers, ModbusException> read(std::uint16_t, std::uint16_t count) override {
    return Registers(count, 0);
  }
  tl::expected<void, ModbusException> write(std::uint16_t, std::span<const std::uint16_t>) override { return {}; }
};

}  // namespace

TEST_CASE("the server makes its symbolic link, replaces a stale one and removes it at the end") {
  const auto path = std::filesystem::temp_directory_path() / ("ecs-link-" + std::to_string(::getpid()));
  std::filesystem::create_symlink("/dev/gone", path);
  {
    auto server = ModbusServer::on_pty({path, 9600, false, 1}).value();
    CHECK(to_text(server.address()) == "rtu:" + path.string() + ":9600:8N1:1");
    CHECK(std::filesystem::is_character_file(path));
  }
  CHECK_FALSE(std::filesystem::exists(std::filesystem::symlink_status(path)));
}

TEST_CASE("the symbolic link of a server leads through its own process, and nowhere once that has ended") {
  const auto path = std::filesystem::temp_directory_path() / ("ecs-left-" + std::to_string(::getpid()));
  const auto server = ModbusServer::on_pty({path, 9600, false, 1}).value();
  CHECK(std::filesystem::canonical(path).string().starts_with("/dev/pts/"));
  CHECK(std::filesystem::read_symlink(path).string().starts_with("/proc/" + std::to_string(::getpid()) + "/fd/"));
}

TEST_CASE("a symbolic link that leads to a server which lives is not taken from it, and its process is named") {
  const auto path = std::filesystem::temp_directory_path() / ("ecs-held-" + std::to_string(::getpid()));
  const auto server = ModbusServer::on_pty({path, 9600, false, 1}).value();
  const auto second = ModbusServer::on_pty({path, 9600, false, 1});
  CHECK(says(second, "this link points to /dev/pts/"));
  CHECK(says(second, "pid "));
  CHECK_FALSE(ModbusServer::on_pty({"/proc/nowhere/line", 9600, false, 1}).has_value());
  CHECK(std::filesystem::is_character_file(path));
}

TEST_CASE("a port that cannot be listened at is named, and what is no address") {
  const auto server = ModbusServer::on_tcp({}).value();
  TcpOptions taken;
  taken.port = std::get<TcpPeer>(server.address().endpoint).port;
  const auto second = ModbusServer::on_tcp(taken);
  CHECK(says(second, "cannot listen on"));
  TcpOptions word;
  word.host = "localhost";
  const auto named = ModbusServer::on_tcp(word);
  CHECK(says(named, "expected an IPv4 address"));
}

TEST_CASE("connections beyond the places are answered all the same, and the one idle for longest makes room") {
  TcpOptions options;
  options.most_connections = 2;
  options.most_newcomers = 4;
  auto server = ModbusServer::on_tcp(options).value();
  NotedOrder handler;
  std::vector<std::unique_ptr<RawConnection>> hosts;
  const auto answers = [&](const RawConnection& host) {
    host.ask();
    for (int k = 0; k < 3; ++k) server.serve_ready(handler, 0ms);
    return host.heard() > 0;
  };
  for (int k = 0; k < 6; ++k) CHECK(answers(*hosts.emplace_back(std::make_unique<RawConnection>(server.address()))));
  CHECK(answers(*hosts[2]));  // the first without a place; the next one is idle for longest now
  RawConnection newcomer(server.address());
  CHECK(answers(newcomer));
  CHECK(hosts[3]->heard() == 0);
  for (const int k : {0, 1, 2, 4, 5}) CHECK(answers(*hosts[static_cast<std::size_t>(k)]));
}

TEST_CASE("many requests at once on one connection do not keep another one waiting") {
  auto server = ModbusServer::on_tcp({}).value();
  NotedOrder handler;
  const RawConnection greedy(server.address()), other(server.address());
  server.serve_ready(handler, 0ms);
  constexpr int kMany = 300;
  greedy.ask(kMany);
  other.ask();
  while (std::ssize(handler.connections) <= kMany) server.serve_ready(handler, 0ms);
  const auto& order = handler.connections;
  const auto its = std::find(order.begin(), order.end(), std::max(order.front(), order[1]));
  CHECK(std::count(order.begin(), order.end(), *its) == 1);
  CHECK(its - order.begin() <= 1);
}

TEST_CASE("a request on a serial line is answered with its last byte, whatever came before it") {
  auto server = ModbusServer::on_pty({}).value();
  const std::string device = std::get<SerialPort>(server.address().endpoint).device;
  const Descriptor line(::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  NotedOrder handler;
  const std::string request{"\1\3\1\0\0\1\x85\xF6", 8};
  std::string long_one{"\1\20\0\200\0\173\366", 7};  // the beginning of a block of 255 bytes
  for (const std::string& before : {std::string(), std::string("x"), std::string(300, '\1'), long_one,
                                    request.substr(0, 7) + "?", long_one + request.substr(0, 5)}) {
    const std::string all = before + request;
    REQUIRE(::write(line.get(), all.data(), all.size()) == static_cast<ssize_t>(all.size()));
    CHECK(server.serve_ready(handler, 1s) == 1);  // with what has come, not after a silence
    std::array<char, 16> reply{};
    CHECK(::read(line.get(), reply.data(), reply.size()) == 7);
  }
}
