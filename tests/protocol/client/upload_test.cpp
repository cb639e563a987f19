// A map sent to a unit: whole or not at all, whatever the line does.
#include "core/memory_image.hpp"
#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

using namespace ecs;
using namespace ecs::protocol;
using namespace std::chrono_literals;

namespace {

const std::vector<std::uint8_t> kOldImage = noise_image(3000, 1);

/// A sound image with a smooth table of this many values.
std::vector<std::uint8_t> sealed_image(std::uint32_t values) {
  const ImagePlan plan{1, values, 0};
  std::vector<std::uint8_t> image(image_bytes(plan));
  begin_image(image, plan);
  write_parameters(image, UnitParameters{});
  write_entry(image, 0, {Component::EXX, Approach::unknown, false, 0, values, 0.0, 10.0, 0.01});
  for (std::uint32_t i = 0; i < values; ++i)
    write_value(image, i, static_cast<std::int16_t>(std::lround(2000.0 * std::sin(0.02 * i))));
  seal_image(image);
  return image;
}

enum class Over { pty, tcp };

struct UnitWithMap : Workshop {
  /// @param held  the active map; empty: none
  explicit UnitWithMap(Over line, const std::vector<std::uint8_t>& held = kOldImage, const std::string& arm_code = {})
      : Workshop(line == Over::tcp ? ModbusServer::on_tcp({}).value()
                                   : ModbusServer::on_pty({{}, 115'200, false, 1}).value(),
                 arm_code) {
    if (!held.empty()) in_model([&](UnitModel& model) { model.install(held); });
  }
  std::vector<std::uint8_t> active_image() {
    return in_model([](UnitModel& model) { return model.active_image(); });
  }
  bool staging() {
    return in_model([](UnitModel& model) { return model.staging; });
  }
};

/// What becomes of an upload when `then` happens as soon as this many bytes of it have travelled.
Result<UploadReport> sent_while(UnitClient& unit, const std::vector<std::uint8_t>& image, std::size_t after,
                                const std::function<void()>& then) {
  bool happened = false;
  return unit.upload_image(image, [&](const Progress& progress) {
    if (happened || progress.bytes_done <= after) return;
    happened = true;
    then();
  });
}
Result<UploadReport> sent_while(Workshop& shop, const std::function<void(UnitModel&)>& then) {
  auto unit = shop.client();
  return sent_while(unit, noise_image(20'000), 5'000, [&] { shop.in_model(then); });
}

#define CHECK_SENT(sent) CHECK_MESSAGE((sent).has_value(), ((sent) ? "" : (sent).error().message))

/// An upload whose line has three faults after this many bytes; it arrives whole. @return bytes that the host has sent
std::size_t bytes_sent_under(LinkFault fault, const std::vector<std::uint8_t>& image, std::size_t after) {
  CAPTURE(name_of(fault));
  UnitWithMap shop(Over::pty);
  auto unit = shop.client();
  bool struck = false;
  const auto sent = sent_while(unit, image, after, [&] {
    shop.fault(fault, 3);
    struck = true;
  });
  CHECK_SENT(sent);
  CHECK(struck);
  CHECK(shop.active_image() == image);
  return unit.link().statistics().bytes_sent;
}

}  // namespace

TEST_CASE("64 KB arrive complete under every fault of the link") {
  const auto image = noise_image(65'536);
  for (std::size_t i = 0; i < kLinkFaults; ++i)
    CHECK(bytes_sent_under(static_cast<LinkFault>(i), image, 30'000) > image.size());
}

TEST_CASE("a map survives a link that corrupts one frame in fifty, in every way") {
  const auto image = noise_image(20'000);
  UnitWithMap shop(Over::pty);
  for (std::size_t i = 0; i < kLinkFaults; ++i) shop.fault_often(static_cast<LinkFault>(i), 0.0025);
  auto unit = shop.client();
  const auto sent = unit.upload_image(image);
  CHECK(shop.active_image() == (sent ? image : kOldImage));
}

TEST_CASE("only missing blocks are sent again") {
  const auto image = noise_image(kWindowBytes);
  auto shop = Workshop::on_tcp();
  auto unit = shop.client();
  bool struck = false;
  REQUIRE(unit.begin_staging(StagingFrom::cleared).has_value());
  const auto begun = unit.link().statistics().requests;
  CHECK(unit.write_memory(kBankA.first, image,
                          [&](const Progress& progress) {
                            if (!struck && progress.bytes_done > 2000) shop.fault(LinkFault::lost_request, 1);
                            struck = struck || progress.bytes_done > 2000;
                          })
            .has_value());
  CHECK(unit.link().statistics().timeouts == 1);
  // open, 64 blocks, acknowledgement, the one block again, acknowledgement, check command
  CHECK(unit.link().statistics().requests - begun == 1 + 64 + 1 + 1 + 1 + 1);
}

TEST_CASE("progress rises to the end and gives the time left") {
  const auto image = noise_image(20'000);
  auto shop = Workshop::on_pty();
  auto unit = shop.client();
  std::size_t last = 0;
  const auto sent = unit.upload_image(image, [&](const Progress& progress) {
    CHECK(progress.bytes_done >= last);
    CHECK(progress.bytes_total == image.size());
    CHECK(progress.seconds_left >= 0.0);
    last = progress.bytes_done;
  });
  CHECK(sent.has_value());
  CHECK(last == image.size());
}

TEST_CASE("a link cut in the middle is an error and leaves the old map active and complete") {
  const auto image = noise_image(65'536);
  for (const Over line : {Over::pty, Over::tcp}) {
    UnitWithMap shop(line);
    auto unit = shop.client();
    CHECK(must_fail(sent_while(unit, image, 20'000, [&] { shop.cut_line(); })).kind == ProblemKind::link);
    CHECK(unit.link().last_failure() == LinkFailure::disconnected);
    CHECK(shop.active_image() == kOldImage);
    CHECK(shop.in_model([](UnitModel& model) { return model.commits; }) == 0);
  }
}

TEST_CASE("a cancelled upload is abandoned and leaves the old map active and complete") {
  std::atomic<bool> cancelled{false};
  UnitWithMap shop(Over::pty);
  auto unit = shop.client(&cancelled);
  const auto sent = unit.upload_image(noise_image(30'000),
                                      [&](const Progress& progress) { cancelled = progress.bytes_done > 10'000; });
  CHECK(says(sent, "cancelled"));
  CHECK(shop.active_image() == kOldImage);
  CHECK_FALSE(shop.staging());
  CHECK(shop.in_model([](UnitModel& model) { return model.log; }).back() == CommandCode::abandon_staged);
}

TEST_CASE("a unit that falls silent in the middle is reported, and the old map stays") {
  UnitWithMap shop(Over::pty);
  auto unit = shop.client_of_tries(2);
  const auto sent = unit.upload_image(noise_image(30'000), [&](const Progress& progress) {
    if (progress.bytes_done > 10'000) shop.fault_often(LinkFault::lost_request, 1.0);
  });
  CHECK(says(sent, "no answer"));
  CHECK(shop.active_image() == kOldImage);
}

TEST_CASE("memory that does not hold what is written is found before the commit") {
  UnitWithMap shop(Over::tcp);
  const auto sent = sent_while(shop, [](UnitModel& model) { model.bank_b[100] ^= 1; });
  CHECK(says(sent, "differs from the written data"));
  CHECK(shop.active_image() == kOldImage);
}

TEST_CASE("a unit that compensates refuses a map and keeps its own") {
  UnitWithMap shop(Over::pty);
  shop.in_model([](UnitModel& model) { model.mode = UnitMode::compensating; });
  auto unit = shop.client();
  CHECK(must_fail(unit.upload_image(noise_image(1000))).kind == ProblemKind::refused);
  CHECK(shop.active_image() == kOldImage);
}

namespace {

/// From the moment the unit carries out the commit, this many of its replies are lost.
void lose_replies_at_commit(Workshop& shop, int replies, std::atomic<bool>* then_cancel = nullptr) {
  shop.in_model([=](UnitModel& model) {
    model.on_commit = [=, &model] {
      model.replies_to_lose = replies;
      if (then_cancel != nullptr) *then_cancel = true;
    };
  });
}

}  // namespace

TEST_CASE("a commit whose every reply was lost counts as done once the unit says that it has taken the map") {
  const auto image = noise_image(4000);
  UnitWithMap shop(Over::pty);
  auto unit = shop.client_of_tries(2);
  lose_replies_at_commit(shop, 2);
  const auto sent = unit.upload_image(image);
  CHECK_SENT(sent);
  CHECK(shop.active_image() == image);
}

TEST_CASE("a commit without a reply on a silent link is reported as in doubt, never as not taken") {
  const auto image = noise_image(4000);
  UnitWithMap shop(Over::pty);
  auto unit = shop.client_of_tries(2);
  lose_replies_at_commit(shop, 1'000);
  const auto sent = unit.upload_image(image);
  REQUIRE_FALSE(sent.has_value());
  CHECK(shop.active_image() == image);
  CHECK(says(sent, "may have accepted the new map"));
  CHECK(!contains(sent.error().message, "old map is active"));
}

TEST_CASE("a commit that the unit does not carry out is reported as not taken, and what was staged is abandoned") {
  for (const bool had_map : {true, false}) {
    UnitWithMap shop(Over::tcp, had_map ? kOldImage : std::vector<std::uint8_t>());
    shop.in_model([](UnitModel& model) { model.takes_commits = false; });
    auto unit = shop.client();
    const auto sent = must_fail(unit.upload_image(noise_image(4000)));
    CHECK((contains(sent.message, "the old map is active")) == had_map);
    CHECK((contains(sent.message, "contains no map, as before")) != had_map);
    CHECK_FALSE(shop.staging());
  }
}

TEST_CASE("a cancel while the reply to the commit is awaited says that the new map is active") {
  std::atomic<bool> cancelled{false};
  const auto image = noise_image(4000);
  UnitWithMap shop(Over::pty);
  auto unit = shop.client(&cancelled);
  lose_replies_at_commit(shop, 1, &cancelled);
  const auto sent = unit.upload_image(image);
  REQUIRE_FALSE(sent.has_value());
  CHECK(shop.active_image() == image);
  CHECK(says(sent, "cancelled"));
  CHECK(says(sent, "already accepted the new map: it is active (commit no. 1)"));
}

TEST_CASE("of an image that differs from the active one in a byte only that piece is sent") {
  UnitWithMap shop(Over::tcp, noise_image(30'000));
  auto image = noise_image(30'000);
  image[20'005] ^= 0xFF;
  auto unit = shop.client();
  const auto sent = unit.upload_image(image);
  CHECK_SENT(sent);
  REQUIRE(sent.has_value());
  CHECK(sent->bytes_sent == 600);
  CHECK(shop.active_image() == image);
  CHECK(unit.link().statistics().bytes_sent < 1600);
}

TEST_CASE("a map that is active already is not sent again, and nothing is committed") {
  auto shop = Workshop::on_tcp();
  auto unit = shop.client();
  const auto image = sealed_image(2000);
  REQUIRE(unit.upload_image(image)->commit_sequence == 1);
  const auto requests = unit.link().statistics().requests;
  const auto again = must(unit.upload_image(image));
  CHECK(again.already_held);
  CHECK(again.bytes_sent == 0);
  CHECK(again.commit_sequence == 1);
  CHECK(unit.link().statistics().requests - requests == 1);
}

TEST_CASE("that a map is active already counts only with a keyed check: a host that is not armed is refused") {
  UnitWithMap shop(Over::tcp, sealed_image(2000), "271828");
  auto unit = shop.client();
  const auto refused = must_fail(unit.upload_image(sealed_image(2000)));
  CHECK(refused.kind == ProblemKind::refused);
  check_holds(refused.message, {"this computer is not armed", "the old map is active"});
  unit.know_code("271828");
  CHECK(must(unit.upload_image(sealed_image(2000))).already_held);
}

/// As the programs of one user share it.
struct SharedSecret : SecretStore {
  std::optional<Secret> secret;
  std::optional<Secret> secret_of(const std::string&) override { return secret; }
  void keep(const std::string&, const Secret& kept) override { secret = kept; }
};

TEST_CASE("after a restart of the unit a host that cannot be armed again does not name the active map") {
  UnitWithMap shop(Over::tcp, kOldImage, "271828");
  const auto secrets = std::make_shared<SharedSecret>();
  const auto program = [&] {
    return UnitClient(Link::open(shop.address(), shop.options()).value(), {7, {}, {}, secrets});
  };
  REQUIRE(program().arm("271828").has_value());
  shop.in_model([](UnitModel& model) {
    model.after_commit = [&model] {
      model.replies_to_lose = 1;
      ++model.unit_clock.starts;
    };
  });
  auto unit = program();
  CHECK(says(unit.upload_image(noise_image(4000)), "it is not known which map is active"));
}

TEST_CASE("a host whose secret is not the unit's any more is refused at once, without asking again and again") {
  UnitWithMap shop(Over::tcp, kOldImage, "271828");
  const auto of_same_host = [&](const std::string& code) {
    return UnitClient(Link::open(shop.address(), shop.options()).value(), {7, {}, code});
  };
  auto armed = of_same_host("271828");
  REQUIRE(armed.begin_staging(StagingFrom::cleared).has_value());
  auto other = of_same_host("");
  CHECK(must_fail(other.begin_staging(StagingFrom::cleared)).kind == ProblemKind::refused);
  CHECK(other.link().statistics().requests < 10);
}

TEST_CASE("a content with the same CRC-32 does not count as held, and where nothing does the whole image is sent") {
  const auto image = sealed_image(2000);
  auto forged = image;
  forge(forged, 900);
  REQUIRE(crc32_of(forged) == crc32_of(image));
  UnitWithMap shop(Over::tcp, forged);
  auto unit = shop.client();
  const auto sent = must(unit.upload_image(image));
  CHECK_FALSE(sent.already_held);
  CHECK(sent.bytes_sent < 1000);
  CHECK(shop.active_image() == image);
  CHECK(must(unit.upload_image(image, {}, Held::nothing)).bytes_sent == image.size());
  CHECK(shop.active_image() == image);
}

TEST_CASE("an upload that was cancelled goes on with the pieces that have not arrived") {
  UnitWithMap shop(Over::tcp);
  const auto image = noise_image(60'000, 5);
  std::atomic<bool> cancelled{false};
  auto first = shop.client(&cancelled);
  REQUIRE_FALSE(first.upload_image(image, [&](const Progress& progress) { cancelled = progress.bytes_done > 40'000; }));
  REQUIRE(cancelled);
  CHECK(shop.active_image() == kOldImage);
  auto again = shop.client();
  std::size_t begun_at = 0;
  const auto sent = again.upload_image(image, [&](const Progress& progress) {
    if (begun_at == 0) begun_at = progress.bytes_done;
  });
  CHECK_SENT(sent);
  REQUIRE(sent.has_value());
  CHECK(sent->bytes_sent < 25'000);
  CHECK(begun_at > 35'000);
  CHECK(shop.active_image() == image);
}

TEST_CASE("a smooth map arrives in coded blocks, complete under every fault of the link") {
  const auto image = sealed_image(9000);
  for (std::size_t i = 0; i < kLinkFaults; ++i) {
    const auto sent_bytes = bytes_sent_under(static_cast<LinkFault>(i), image, 5'000);
    if (i == 0) CHECK(sent_bytes * 2 < image.size());
  }
}

TEST_CASE("two hosts on one unit each get the result of their own command") {
  auto shop = Workshop::on_tcp();
  auto one = shop.client();
  auto other = shop.client();
  for (int k = 0; k < 20; ++k) {
    REQUIRE(one.clear_fault());
    REQUIRE(other.abandon_staged().has_value() == false);  // nothing is staged: refused, but a command
    REQUIRE(one.output_off());
    CHECK(shop.in_model([](UnitModel& model) { return model.log.back(); }) == CommandCode::output_off);
  }
}

TEST_CASE("a commit after which another map is active is reported as such") {
  UnitWithMap shop(Over::tcp);
  auto unit = shop.client();
  shop.in_model([](UnitModel& model) { model.spoils_commits = true; });
  const auto sent = unit.upload_image(noise_image(3000, 2));
  REQUIRE(!sent);
  CHECK(says(sent, "the active map has changed"));
}

/// Just before our commit another host makes a map of its own active, from the same staging.
void another_host_commits_first(Workshop& shop, const std::vector<std::uint8_t>& image) {
  shop.in_model([image](UnitModel& model) {
    model.on_commit = [image, &model] {
      auto& spare = model.active == Bank::A ? model.bank_b : model.bank_a;
      std::copy(image.begin(), image.end(), spare.begin());
      model.active = model.active == Bank::A ? Bank::B : Bank::A;
      model.image_length = static_cast<std::uint32_t>(image.size());
      ++model.commits;
      model.staging = false;
    };
  });
}

TEST_CASE("a refused commit is never reported as done, whatever another host has made active meanwhile") {
  const auto ours = noise_image(4000, 1);
  for (const std::size_t length : {std::size_t{5000}, std::size_t{4000}}) {
    UnitWithMap shop(Over::tcp);
    another_host_commits_first(shop, noise_image(length, 2));
    auto unit = shop.client();
    const auto sent = unit.upload_image(ours);
    REQUIRE_FALSE(sent.has_value());
    CHECK(sent.error().kind == ProblemKind::refused);
    CHECK(says(sent, "the active map has changed"));
  }
  UnitWithMap shop(Over::tcp);
  another_host_commits_first(shop, ours);
  auto unit = shop.client();
  const auto sent = unit.upload_image(ours);
  CHECK(says(sent, "another host has sent the same map"));
}

TEST_CASE("a commit that arrives late, between the status and the abandon, is reported as done") {
  const auto image = noise_image(4000);
  UnitWithMap shop(Over::tcp);
  shop.in_model([&](UnitModel& model) {
    model.takes_commits = false;
    model.on_abandon = [&model, length = static_cast<std::uint32_t>(image.size())] { model.switch_banks(length); };
  });
  auto unit = shop.client();
  REQUIRE(unit.upload_image(image).has_value());
  CHECK(shop.active_image() == image);
}

TEST_CASE("a commit that the unit carried out before it was restarted is not given again and counts as done") {
  const auto image = noise_image(4000);
  UnitWithMap shop(Over::pty);
  shop.in_model([](UnitModel& model) {
    model.after_commit = [&model] {
      model.replies_to_lose = 1;
      ++model.unit_clock.starts;
    };
  });
  auto unit = shop.client();
  REQUIRE(unit.upload_image(image).has_value());
  const auto log = shop.in_model([](UnitModel& model) { return model.log; });
  CHECK(std::count(log.begin(), log.end(), CommandCode::commit_staged) == 1);
}

TEST_CASE("a commit whose replies were lost while another host committed is not taken for ours") {
  UnitWithMap shop(Over::pty);
  auto unit = shop.client_of_tries(2);
  another_host_commits_first(shop, noise_image(4000, 2));
  shop.in_model([](UnitModel& model) {
    model.on_commit = [before = model.on_commit, &model] {
      before();
      model.replies_to_lose = 2;
    };
  });
  const auto sent = unit.upload_image(noise_image(4000, 1));
  CHECK(says(sent, "the active map has changed"));
}

TEST_CASE("a command that acts on the machine and is not answered may have been carried out, and that is reported") {
  auto shop = Workshop::on_pty();
  auto unit = shop.client_of_tries(2);
  REQUIRE(unit.output_compensation(Axis::X, 5.0, true));
  shop.in_model([](UnitModel& model) { model.replies_to_lose = 1'000; });
  const auto output = unit.output_compensation(Axis::X, 6.0, true);
  CHECK(
      says(output, "The command may have been carried out. The relay of X may be closed, and 6 um may act. The unit"));
  CHECK(says(output, "Cause: "));
  CHECK(says(output, "no answer"));
  const auto off = unit.output_off();
  CHECK(says(off, "a closed relay is still closed"));
  CHECK(says(off, "60 s"));
}

TEST_CASE("a unit that names the bank of its active map to be written is not written to") {
  UnitWithMap shop(Over::tcp);
  shop.in_model([](UnitModel& model) { model.names_active_bank = true; });
  const auto sent = shop.client().upload_image(noise_image(20'000));
  CHECK(says(sent, "the inactive bank"));
  CHECK(says(sent, "old map is active"));
  CHECK(shop.active_image() == kOldImage);
}

TEST_CASE("a map that another host commits meanwhile stays active, and the message names it") {
  UnitWithMap shop(Over::tcp);
  const auto sent = sent_while(shop, [](UnitModel& model) {
    model.commits = 7;
    model.active = Bank::B;
  });
  CHECK(says(sent, "another host"));
  CHECK(says(sent, "commit no. 7"));
  CHECK(!says(sent, "old map is active"));
  CHECK(shop.in_model([](UnitModel& model) { return model.commits; }) == 7);
}

TEST_CASE("a host that was paused while another one sent its map is refused, and says that this transfer has ended") {
  for (const bool other_commits : {true, false}) {
    CAPTURE(other_commits);
    UnitWithMap shop(Over::tcp);
    auto paused = shop.client();
    auto other = shop.client();
    const auto others = noise_image(9'000, 3);
    const auto sent = sent_while(paused, noise_image(20'000), 5'000, [&] {
      if (other_commits)
        REQUIRE(other.upload_image(others).has_value());
      else
        REQUIRE(other.begin_staging(StagingFrom::cleared).has_value());
    });
    CHECK(says(sent, "this transfer has ended: another host has started one or sent a map"));
    CHECK(says(sent, other_commits ? "the active map has changed (9000 bytes, commit no. 1)" : "old map is active"));
    CHECK(shop.active_image() == (other_commits ? others : kOldImage));
    CHECK(shop.staging() != other_commits);
  }
}

TEST_CASE("a map is not committed in another unit that the cable has been moved to") {
  UnitWithMap shop(Over::tcp);
  const auto sent = sent_while(shop, [](UnitModel& model) { model.serial_number = "ECS-0043"; });
  CHECK(says(sent, "unit ECS-0043 answers on this link now, unit ECS-0042 did before"));
  CHECK(shop.in_model([](UnitModel& model) { return model.commits; }) == 0);
  CHECK(shop.active_image() == kOldImage);
}

TEST_CASE("a host whose arming ends within a transfer is armed again if it knows the code, otherwise it says so") {
  for (const bool knows_code : {true, false}) {
    CAPTURE(knows_code);
    const std::string code = "271828";
    UnitWithMap shop(Over::tcp, kOldImage, code);
    auto unit = shop.client();
    REQUIRE(unit.arm(code, 1));
    if (knows_code) unit.know_code(code);
    const auto sent = sent_while(unit, noise_image(40'000), 5'000,
                                 [&] { shop.in_model([](UnitModel& model) { model.unit_clock.ms += 60'000; }); });
    CHECK(sent.has_value() == knows_code);
    CHECK((shop.active_image() == noise_image(40'000)) == knows_code);
    if (knows_code) continue;
    CHECK(says(sent, "the time for which this host was armed has ended"));
    CHECK(says(sent, "old map is active"));
  }
}

TEST_CASE("whatever ends an upload before its commit, the message names the old map as the active one") {
  for (const bool had_map : {true, false}) {
    UnitWithMap shop(Over::tcp, had_map ? kOldImage : std::vector<std::uint8_t>());
    const auto sent = sent_while(shop, [](UnitModel& model) { model.bank_b[100] ^= model.bank_a[100] ^= 1; });
    CHECK(says(sent, had_map ? "old map is active" : "contains no map, as before"));
  }
}

TEST_CASE("a line that dies after the commit was answered leaves no doubt that the new map is active") {
  for (const int answered : {1, 2}) {
    CAPTURE(answered);
    UnitWithMap shop(Over::pty);
    auto unit = shop.client_of_tries(1);
    shop.in_model([=](UnitModel& model) { model.on_commit = [=, &model] { model.replies_left = answered; }; });
    const auto sent = unit.upload_image(noise_image(4000));
    CHECK(sent.has_value() == (answered == 2));  // the second answer names the active image by its SHA-256
    if (!sent) CHECK(says(sent, "it is active (commit no. 1)"));
  }
}

TEST_CASE("a cancel after the commit was answered does not hide that the map is active and verified") {
  std::atomic<bool> cancelled{false};
  UnitWithMap shop(Over::pty);
  auto unit = shop.client(&cancelled);
  shop.in_model([&](UnitModel& model) { model.after_commit = [&cancelled] { cancelled = true; }; });
  const auto sent = unit.upload_image(noise_image(4000));
  const bool told = sent.has_value() || says(sent, "it is active (commit no. 1)");
  CHECK(told);
}

TEST_CASE("wrong checks of another program on a serial line close windows, and many of them end the upload") {
  for (const int wrong : {3, 4}) {
    CAPTURE(wrong);
    UnitWithMap shop(Over::pty);
    auto unit = shop.client();
    const auto image = noise_image(20'000);
    // one before each window that is opened again
    const auto sent = sent_while(unit, image, 3'000,
                                 [&] { shop.in_model([&](UnitModel& model) { model.windows_to_spoil = wrong; }); });
    CHECK(sent.has_value() == (wrong == 3));
    CHECK(shop.active_image() == (wrong == 3 ? image : kOldImage));
    if (wrong == 3) continue;
    CHECK(says(sent, "another program writes on this link"));
    CHECK(says(sent, "old map is active"));
    CHECK_FALSE(shop.staging());
  }
}
