#include "ecs_emulator/workshop/serve.hpp"

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/file.hpp"
#include "ecs_emulator/unit/workshop_socket.hpp"
#include "protocol/client/client.hpp"
#include "tests/ecs_emulator/support/maps.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;
using Json = nlohmann::json;

namespace {

/// A served workshop in a thread and a folder of its own.
class Served {
 public:
  explicit Served(const std::string& extra = "", bool tcp = false) {
    options.machine = folder.with("machine.toml", small_machine() + extra);
    options.memory = folder / "battery";
    options.workshop = folder / "door";
    options.memory_modules = 1;
    options.mode = LinkSense::integrate;
    if (tcp)
      options.tcp = 0;
    else
      options.pty = folder / "line";
    begin();
  }
  ~Served() { end(); }
  void begin() {
    stop = 0;
    std::promise<std::string> announced;
    auto ready = announced.get_future();
    thread = std::thread([this, &announced] {
      const auto served = serve(options, stop, [&](const std::string& line) { announced.set_value(line); });
      if (!served) announced.set_value(to_text(served.error()));
    });
    const std::string line = ready.get();
    about = Json::parse(line, nullptr, false);
    REQUIRE_MESSAGE(about.is_object(), line);
  }
  void end() {
    stop = 1;
    if (thread.joinable()) thread.join();
  }
  Json ask(const Json& request) const { return Json::parse(must(ask_workshop(options.workshop, request.dump()))); }
  protocol::UnitClient client() const {
    return must(protocol::UnitClient::connect(*protocol::link_address_of(about["link"].get<std::string>()), {},
                                              {0, "test", about["arm_code"].get<std::string>()}));
  }
  std::vector<std::uint8_t> image(double exx_um) const {
    const auto machine = load_workshop_machine(options.machine);
    const auto parameters = params::default_parameters_for(machine->machine);
    return image_of(parameters, machine->machine,
                    [&](Component c, double, Approach) { return c == Component::EXX ? exx_um : 0.0; });
  }

  Folder folder;
  ServeOptions options;
  std::atomic<int> stop = 0;
  std::thread thread;
  Json about;
};

}  // namespace

TEST_CASE("a host loads a map over the line, the machine is referenced in the workshop, the unit compensates") {
  for (const bool tcp : {false, true}) {
    CAPTURE(tcp);
    Served served("", tcp);
    CHECK(served.about[tcp ? "tcp" : "pty"].is_string());
    CHECK(served.about["serial_number"] == "EMULATOR-1");
    auto client = served.client();
    CHECK(client.identity()->serial_number == "EMULATOR-1");
    (void)must(client.upload_image(served.image(12.0)));
    REQUIRE(client.enter_compensation().has_value());
    CHECK(client.status()->mode == UnitMode::datuming);
    CHECK(served.ask({{"action", "reference"}})["unit"]["mode"] == "compensating");
    const auto sample = must(client.monitor());
    CHECK(sample.axes[0].compensation_um == Approx(12.0));
    CHECK(sample.axes[0].relay_closed);
    const Json survey = served.ask({{"action", "survey"}, {"step", 500}});
    CHECK(survey["ok"] == true);
    CHECK(client.status()->mode == UnitMode::compensating);
  }
}

TEST_CASE("a plan is measured as one request, and no file that is there is overwritten") {
  Served served;
  const std::string plan = served.folder.with(
      "plan.toml",
      "[[measure]]\nname = \"EXX\"\naxis = \"X\"\nsense = \"EX\"\nfrom_mm = 0.0\nto_mm = -100.0\nstep_mm = 50.0\n");
  const Json request{{"action", "plan"}, {"plan", plan}, {"phase", "before"}, {"folder", served.folder / "measured"}};
  CHECK(served.ask(request)["output"][0] == served.folder / "measured/EXX.csv");
  CHECK(contains(must(ask_workshop(served.options.workshop, request.dump())), "already exists"));
}

TEST_CASE("a second host reaches the same unit over TCP, with the token") {
  Served served;
  served.end();
  served.options.also_tcp = true;
  served.options.token_file = served.folder.with("token", "a token of this test");
  served.begin();
  auto first = served.client();
  const std::string link = served.about["second_link"];
  auto second = must(protocol::UnitClient::connect(*protocol::link_address_of(link), {}, {0, "test", {}}));
  CHECK(second.identity()->serial_number == first.identity()->serial_number);
  const auto without =
      protocol::UnitClient::connect(*protocol::link_address_of(link.substr(0, link.find('?'))), {}, {0, "test", {}});
  CHECK_FALSE(without.has_value());
}

TEST_CASE("the link is served while a long measurement runs") {
  Served served;
  auto client = served.client();
  auto measurement = std::async(std::launch::async, [&] {
    return served.ask(
        {{"action", "measure"}, {"axis", "X"}, {"sense", "EX"}, {"from", 0}, {"to", -500}, {"step", 1}, {"runs", 20}});
  });
  int answered = 0;
  while (measurement.wait_for(std::chrono::milliseconds(0)) != std::future_status::ready)
    if (client.monitor().has_value()) ++answered;
  CHECK(measurement.get()["ok"] == true);
  CHECK(answered > 10);
}

TEST_CASE("the battery keeps map and commit over a restart of the process") {
  Served served;
  const auto image = served.image(3.0);
  {
    auto client = served.client();
    REQUIRE(client.upload_image(image).has_value());
  }
  served.end();
  served.options.mode = LinkSense::compensate;
  served.begin();
  auto client = served.client();
  CHECK(client.status()->commit_sequence == 1);
  CHECK(client.status()->fault == Fault::none);
  CHECK(client.status()->mode == UnitMode::datuming);
  CHECK(client.read_memory(kBankA.first, image.size()).value() == image);
}

TEST_CASE("faults of link and unit can be provoked by name, and a unit without power is silent") {
  Served served;
  auto client = served.client();
  CHECK(served.ask({{"action", "fault"}, {"name", "bad_crc"}, {"count", 2}})["ok"] == true);
  CHECK(client.monitor().has_value());
  CHECK(client.link().statistics().crc_errors > 0);
  REQUIRE(served.ask({{"action", "fault"}, {"name", "ram_stuck"}, {"address", 0x100010}, {"bit", 2}})["ok"] == true);
  CHECK(client.run_ram_test()->value == 0x100010);
  CHECK(served.ask({{"action", "power"}, {"state", "off"}})["unit"]["powered"] == false);
  CHECK(!client.monitor().has_value());
  CHECK(served.ask({{"action", "power"}, {"state", "on"}})["unit"]["powered"] == true);
  CHECK(client.monitor().has_value());
}

TEST_CASE("a unit whose power fails during a transfer stays silent, whatever the faults of the link") {
  for (const bool tcp : {false, true}) {
    CAPTURE(tcp);
    Served served("", tcp);
    auto client = served.client();
    REQUIRE(served.ask({{"action", "fault"}, {"name", "power_fails"}, {"count", 1000}})["ok"] == true);
    CHECK(!contains(to_text(must_fail(client.upload_image(served.image(2.0)))), "no power"));
    CHECK(served.ask({{"action", "state"}})["unit"]["powered"] == false);
    CHECK(served.ask({{"action", "fault"}, {"name", "clear"}})["ok"] == true);
    CHECK(served.ask({{"action", "fault"}, {"name", "bad_crc"}, {"count", 1}})["ok"] == true);
    CHECK(!client.status().has_value());
    CHECK(served.ask({{"action", "power"}, {"state", "on"}})["unit"]["powered"] == true);
    CHECK(client.status().has_value());
  }
}

TEST_CASE("a second emulator is refused before it changes anything of the first") {
  Served served;
  ServeOptions second = served.options;
  std::string why;
  SUBCASE("the same battery, by another way to its name") {
    second.memory = served.folder / "./battery";
    second.workshop.clear();
    second.pty = served.folder / "other_line";
    why = fmt::format("(pid {}) uses this memory", ::getpid());
  }
  SUBCASE("the same workshop") {
    second.memory.clear();
    why = "another workshop listens here";
  }
  SUBCASE("the same link") {
    second.memory.clear();
    second.workshop.clear();
    why = fmt::format("pid {} (", ::getpid());
  }
  const auto refused = must_fail(serve(second, served.stop, [](const std::string& line) { FAIL(line); }));
  CHECK(refused.kind == ProblemKind::output);
  CHECK_MESSAGE(contains(to_text(refused), why), to_text(refused));
  CHECK(served.client().status().has_value());
  CHECK(served.ask({{"action", "state"}})["ok"] == true);
  CHECK(!std::filesystem::exists(served.folder / "other_line"));
}

TEST_CASE("a dangling link is replaced, a link to a file is not") {
  Served served;
  served.end();
  CHECK(!std::filesystem::is_symlink(served.folder / "line"));
  std::filesystem::create_symlink("/dev/pts/99999", served.folder / "line");
  served.begin();
  CHECK(served.client().status().has_value());
  served.end();
  std::filesystem::create_symlink(served.folder / "machine.toml", served.folder / "line");
  const auto refused = must_fail(serve(served.options, served.stop, [](const std::string& line) { FAIL(line); }));
  CHECK(contains(to_text(refused), "machine.toml; remove it, or give another link"));
  CHECK(std::filesystem::read_symlink(served.folder / "line") == served.folder / "machine.toml");
  CHECK(!std::filesystem::exists(served.folder / "battery.in-use"));
  CHECK(!std::filesystem::exists(served.folder / "door"));
}

TEST_CASE("power that fails during a transfer leaves the old map in force") {
  Served served;
  {
    auto client = served.client();
    REQUIRE(client.upload_image(served.image(1.0)).has_value());
    REQUIRE(served.ask({{"action", "fault"}, {"name", "power_fails"}, {"count", 75'000}})["ok"] == true);
    CHECK(!client.upload_image(served.image(2.0)).has_value());
  }
  CHECK(served.ask({{"action", "state"}})["unit"]["powered"] == false);
  CHECK(served.ask({{"action", "power"}, {"state", "on"}})["unit"]["powered"] == true);
  auto client = served.client();
  CHECK(client.status()->commit_sequence == 1);
  const auto old_image = served.image(1.0);
  CHECK(client.read_memory(kBankA.first, old_image.size()).value() == old_image);
  CHECK(client.upload_image(served.image(2.0)).has_value());
  CHECK(client.status()->commit_sequence == 2);
}

TEST_CASE("a wrong request is answered with what is wrong, and the exit code that goes with it") {
  Served served;
  const Json answer = served.ask({{"action", "jog"}, {"X", "ten"}, {"feeed", 3}});
  CHECK(answer["ok"] == false);
  CHECK(answer["exit"] == 2);
  const auto message = answer["error"]["message"].get<std::string>();
  check_holds(message, {"X: expected a number", "did you mean \"feed\""});
  CHECK(served.ask({{"action", "dance"}})["exit"] == 2);
}

TEST_CASE("the real time between actions does not change what is measured") {
  const auto csv = [](int pause_ms) {
    Served served("[emulator]\nseed = 4\n");
    const Json plan{{"action", "measure"}, {"axis", "Z"}, {"sense", "EZ"}, {"from", 0}, {"to", -300}, {"step", 30}};
    (void)served.ask(plan);
    std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
    return served.ask(plan)["csv"].get<std::string>();
  };
  CHECK(csv(0) == csv(130));
}

TEST_CASE("an axis is not sent beyond its limit switches, nor so slowly that it never arrives") {
  Served served;
  for (const double to_mm : {26.0, -526.0, 1e300}) {
    const Json answer = served.ask({{"action", "jog"}, {"X", to_mm}});
    CHECK(answer["ok"] == false);
    CHECK(answer["exit"] == 2);
  }
  CHECK(served.ask({{"action", "jog"}, {"X", -100.0}, {"feed", 1e-300}})["ok"] == false);
  CHECK(served.ask({{"action", "jog"}, {"X", 25.0}})["ok"] == true);
}

TEST_CASE("a client that leaves during a long action cancels it: the machine stops, the next client is served") {
  Served served;
  served.ask({{"action", "jog"}, {"X", 0.0}});
  {
    const int line = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    served.options.workshop.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
    REQUIRE(::connect(line, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0);
    const std::string slow = "{\"action\": \"jog\", \"X\": -500, \"feed\": 1}\n";  // more than eight hours
    REQUIRE(::send(line, slow.data(), slow.size(), 0) == static_cast<ssize_t>(slow.size()));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ::close(line);
  }
  const Json state = served.ask({{"action", "state"}});
  CHECK(state["ok"] == true);
  CHECK(state["command_mm"]["X"].get<double>() > -499.0);
  CHECK(served.ask({{"action", "jog"}, {"X", -10.0}})["ok"] == true);
}

TEST_CASE("in real time an action takes its simulated time, and late ticks are counted") {
  Served served;
  served.end();
  served.options.real_time = true;
  served.begin();
  const auto began = std::chrono::steady_clock::now();
  const Json answer = served.ask({{"action", "wait"}, {"seconds", 0.5}});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  CHECK(answer["ok"] == true);
  CHECK(took.count() >= 0.5);
  CHECK(answer["real_time"]["periods"].get<double>() + answer["real_time"]["missed"].get<double>() >= 500.0);
}
