#include <cmath>

#include <doctest/doctest.h>

#include "ecs_emulator/unit/unit.hpp"
#include "protocol/registers/register_map.hpp"
#include "tests/ecs_emulator/support/emulated_unit.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

TEST_CASE("a compensating unit answers reads and refuses every write and command but integrate") {
  Bench bench;
  bench.compensate();
  std::vector<std::uint8_t> bytes(16);
  CHECK(bench.unit.read_memory(kBankA.first, bytes) == UnitError::none);
  CHECK(load_big<std::uint32_t>(bytes, 0) == kImageMagic);
  CHECK(bench.unit.write_memory(kSystemRam.first, bytes) == UnitError::not_in_integration_mode);
  for (std::uint16_t code = 2; code < protocol::kCommandCount; ++code) {
    if (static_cast<CommandCode>(code) == CommandCode::stop) continue;
    CHECK(bench.tell(static_cast<CommandCode>(code)).error == UnitError::not_in_integration_mode);
  }
  CHECK(bench.unit.mode() == UnitMode::compensating);
  CHECK(bench.tell(CommandCode::enter_integration).state == CommandState::done);
  bench.simulation.tick();
  CHECK(all_relays(bench, false));
}

TEST_CASE("memory is protected region by region") {
  Bench bench;
  const std::vector<std::uint8_t> bytes(4, 0x5A);
  CHECK(bench.unit.write_memory(kEprom.first, bytes) == UnitError::address_protected);
  CHECK(bench.unit.write_memory(kCommitRecords.first, bytes) == UnitError::address_protected);
  CHECK(bench.unit.write_memory(kSystemRam.first, bytes) == UnitError::none);
  CHECK(bench.unit.write_memory(kSystemRam.first + kSystemRam.size - 2, bytes) == UnitError::address_unknown);
  CHECK(bench.unit.write_memory(kBankA.first + bank_bytes(1), bytes) == UnitError::address_unknown);
  std::vector<std::uint8_t> eprom(21);
  REQUIRE(bench.unit.read_memory(kEprom.first + 0x400, eprom) == UnitError::none);
  CHECK(std::string(eprom.begin(), eprom.end()) == "ECS UNIT FIRMWARE 1.0");
}

TEST_CASE("axis memory takes writes only beside the active map, and only while a map is staged") {
  Bench bench;
  const std::vector<std::uint8_t> bytes(4, 0x5A);
  const auto image = bench.image([](Component, double, Approach) { return 1.0; });
  for (const Address bank : {kBankA.first, kBankB.first})
    CHECK(bench.unit.write_memory(bank, bytes) == UnitError::no_staging);
  REQUIRE(bench.stage_and_commit(image).state == CommandState::done);  // bank A is active now
  CHECK(bench.unit.write_memory(kBankA.first, bytes) == UnitError::address_protected);
  CHECK(bench.unit.write_memory(kBankB.first, bytes) == UnitError::no_staging);
  REQUIRE(bench.tell(CommandCode::begin_staging).value == kBankB.first);
  CHECK(bench.unit.write_memory(kBankA.first + 0x200, bytes) == UnitError::address_protected);
  CHECK(bench.unit.may_write(kBankA.first + bank_bytes(1) - 1, 1) == UnitError::address_protected);
  CHECK(bench.unit.write_memory(kBankB.first, bytes) == UnitError::none);
  const ByteView held = bench.unit.memory().view(kBankA.first, static_cast<std::uint32_t>(image.size()));
  CHECK(std::equal(held.begin(), held.end(), image.begin(), image.end()));
}

TEST_CASE("the status computes the block check of the active map while nothing else has the processor's time") {
  Bench bench;
  REQUIRE(bench.stage_and_commit(bench.image([](Component, double, Approach) { return 1.0; })).value == 1);
  const auto sound = bench.unit.status();
  CHECK(sound.block_check_found == sound.block_check_expected);
  bench.unit.memory().corrupt(kBankA.first + 600, 0x10);
  const auto spoilt = bench.unit.status();
  CHECK(spoilt.block_check_expected == sound.block_check_expected);
  CHECK(spoilt.block_check_found != spoilt.block_check_expected);
}

TEST_CASE("a commit that cannot be kept in the battery memory fails, and the map before stays active") {
  Bench bench;
  bool disk_full = false;
  bench.unit.on_commit([&] { return !disk_full; });
  const auto old_image = bench.image([](Component, double, Approach) { return 1.0; });
  REQUIRE(bench.stage_and_commit(old_image).value == 1);
  disk_full = true;
  const auto result = bench.stage_and_commit(bench.image([](Component, double, Approach) { return 2.0; }));
  CHECK(result.state == CommandState::failed);
  CHECK(result.text.find("the map before stays active") != std::string::npos);
  CHECK(result.text.size() <= protocol::kResultTextBytes);
  CHECK(bench.unit.status().commit_sequence == 1);
  CHECK(bench.unit.status().active_bank == protocol::Bank::A);
  disk_full = false;
  CHECK(bench.stage_and_commit(old_image).value == 2);
}

TEST_CASE("a damaged record of an answered commit isolates the unit and never brings the map before back") {
  Bench bench;
  REQUIRE(bench.stage_and_commit(bench.image([](Component, double, Approach) { return 1.0; })).value == 1);
  REQUIRE(bench.stage_and_commit(bench.image([](Component, double, Approach) { return 2.0; })).value == 2);
  for (std::uint32_t byte = 0; byte < 24; ++byte) {
    CAPTURE(byte);
    const Address at = kCommitRecords.first + kCommitSlotBytes + byte;
    bench.unit.memory().corrupt(at, 0x04);
    bench.unit.power(false);
    bench.unit.power(true);
    bench.simulation.tick();
    CHECK(bench.unit.status().fault == Fault::commit_record);
    CHECK(bench.unit.status().fault_address == kCommitRecords.first + kCommitSlotBytes);
    CHECK(bench.unit.status().active_bank == protocol::Bank::none);
    CHECK(bench.tell(CommandCode::enter_compensation).state == CommandState::failed);
    CHECK(bench.unit.mode() == UnitMode::integration);
    bench.unit.memory().corrupt(at, 0x04);
  }
}

TEST_CASE("a damaged record beside a sound one is reported until a map is committed, and prevents nothing") {
  Bench bench;
  const auto image = bench.image([](Component, double, Approach) { return 1.0; });
  REQUIRE(bench.stage_and_commit(image).value == 1);
  bench.unit.memory().corrupt(kCommitRecords.first + kCommitSlotBytes + 5, 0x04);
  CHECK(bench.tell(CommandCode::enter_compensation).state == CommandState::done);
  CHECK(bench.tell(CommandCode::enter_integration).state == CommandState::done);
  CHECK(bench.unit.fault() == Fault::commit_record);
  REQUIRE(bench.stage_and_commit(image).value == 2);
  CHECK(bench.unit.fault() == Fault::none);
}

TEST_CASE("a map takes the fault away that the lack of one was") {
  Bench bench;
  REQUIRE(bench.tell(CommandCode::enter_compensation).state == CommandState::failed);
  REQUIRE(bench.unit.fault() == Fault::no_map);
  REQUIRE(bench.stage_and_commit(bench.image([](Component, double, Approach) { return 1.0; })).value == 1);
  CHECK(bench.unit.fault() == Fault::none);
}

TEST_CASE("an image that is not what was announced, or no image, is refused and the old map stays") {
  Bench bench;
  const auto image = bench.image([](Component, double, Approach) { return 1.0; });
  REQUIRE(bench.stage_and_commit(image).value == 1);
  auto other = image;
  other[100] ^= 1;  // parameters: the block check inside the image no longer agrees
  const auto result = bench.stage_and_commit(other);
  CHECK(result.error == UnitError::image_refused);
  CHECK(!result.text.empty());
  REQUIRE(bench.tell(CommandCode::begin_staging).value == kBankB.first);
  REQUIRE(bench.unit.write_memory(kBankB.first, image) == UnitError::none);
  CHECK(bench
            .tell(Command{.code = CommandCode::commit_staged,
                          .length = static_cast<std::uint32_t>(image.size()),
                          .crc = crc32_of(image) + 1})
            .error == UnitError::check_mismatch);
  CHECK(bench.unit.status().commit_sequence == 1);
  CHECK(bench.tell(CommandCode::abandon_staged).state == CommandState::done);
  CHECK(bench.tell(Command{.code = CommandCode::commit_staged, .length = 10}).error == UnitError::no_staging);
}

TEST_CASE("an image for another unit, machine or configuration is refused by name, and the old map stays") {
  Bench bench;
  const auto image = bench.image([](Component, double, Approach) { return 1.0; });
  REQUIRE(bench.stage_and_commit(image).value == 1);
  const auto own = *ImageView(image).identity();
  const auto addressed_to = [&](const ImageIdentity& identity) {
    auto other = image;
    write_identity(other, identity);
    seal_image(other);
    return bench.stage_and_commit(other);
  };
  CHECK(addressed_to({"OTHER-2", own.machine, own.configuration}).error == UnitError::other_machine);
  CHECK(addressed_to({own.serial_number, "another", own.configuration}).error == UnitError::other_machine);
  const auto refused = addressed_to({own.serial_number, own.machine, own.configuration + 1});
  CHECK(refused.error == UnitError::other_machine);
  CHECK(refused.text == "the image is for another configuration than the active map");
  CHECK(bench.unit.status().commit_sequence == 1);
  CHECK(bench.unit.identity().machine == own.machine);
  CHECK(bench.unit.identity().configuration == own.configuration);
  CHECK(addressed_to(own).value == 2);
}

TEST_CASE("power lost at any byte of a transfer leaves the complete old map or the new one") {
  Bench bench;
  const auto old_image = bench.image([](Component, double, Approach) { return 1.0; });
  const auto new_image = bench.image([](Component, double, Approach) { return 2.0; });
  REQUIRE(bench.stage_and_commit(old_image).state == CommandState::done);
  const std::uint64_t staged = bank_bytes(1) + new_image.size();
  std::vector<std::uint64_t> cuts;
  for (std::uint64_t cut = 0; cut < staged; cut += 4999) cuts.push_back(cut);
  for (std::uint64_t cut = staged; cut <= staged + kCommitSlots * kCommitSlotBytes; ++cut) cuts.push_back(cut);
  for (const std::uint64_t cut : cuts) {
    CAPTURE(cut);
    Bench other;
    REQUIRE(other.stage_and_commit(old_image).state == CommandState::done);
    other.unit.memory().power_fails_after(cut);
    (void)other.unit.write_memory(other.tell(CommandCode::begin_staging).value, new_image);
    (void)other.tell(Command{.code = CommandCode::commit_staged,
                             .length = static_cast<std::uint32_t>(new_image.size()),
                             .crc = crc32_of(new_image)});
    other.unit.power(false);
    other.unit.memory().power_back();
    other.unit.power(true);
    other.simulation.tick();
    const auto active = active_image(other.unit.memory());
    REQUIRE(active.has_value());
    const auto& expected = cut >= staged + 24 ? new_image : old_image;
    const ByteView held = other.unit.memory().view(active->first, static_cast<std::uint32_t>(expected.size()));
    CHECK(std::equal(held.begin(), held.end(), expected.begin()));
    CHECK(other.tell(CommandCode::enter_compensation).state == CommandState::done);
  }
}

TEST_CASE("an output set by the host moves the axis through the machine's own gain, and only with its relay closed") {
  Bench bench("", small_machine() + "[emulator.axis.X]\ndrive = \"ideal\"\ndac_um_per_count = 0.11\n");
  const double before = bench.simulation.machine().axis(Axis::X).position_mm();
  Command command{.code = CommandCode::output_compensation, .axis = Axis::X, .output_um = 50.0};
  REQUIRE(bench.tell(command).state == CommandState::done);
  REQUIRE(bench.simulation.run_for(1.0));
  CHECK(bench.simulation.machine().axis(Axis::X).position_mm() == before);
  command.relay_on = true;
  REQUIRE(bench.tell(command).state == CommandState::done);
  REQUIRE(bench.simulation.run_for(1.0));
  CHECK(bench.simulation.machine().axis(Axis::X).position_mm() - before == doctest::Approx(0.055).epsilon(1e-6));
  CHECK(bench.unit.monitor().axes[0].output_counts == 500);
  REQUIRE(bench.tell(CommandCode::output_off).state == CommandState::done);
  REQUIRE(bench.simulation.run_for(1.0));
  CHECK(bench.simulation.machine().axis(Axis::X).position_mm() == doctest::Approx(before));
  command.output_um = 501.0;
  CHECK(bench.tell(command).error == UnitError::bad_argument);
}

TEST_CASE("the monitor shows what the host's output asks for, whatever polarity and scale turn it into") {
  Bench bench;
  bench.parameters.axes[0].compensation_polarity = -1;
  bench.parameters.axes[0].output_scale_counts_per_um = 4.0;
  REQUIRE(bench.stage_and_commit(bench.image([](Component, double, Approach) { return 0.0; })).state ==
          CommandState::done);
  Command command{.code = CommandCode::output_compensation, .axis = Axis::X, .output_um = 400.0, .relay_on = true};
  REQUIRE(bench.tell(command).state == CommandState::done);
  CHECK(bench.unit.monitor().axes[0].output_counts == -1600);
  CHECK(bench.unit.monitor().axes[0].compensation_um == doctest::Approx(400.0));
  CHECK(bench.unit.monitor().axes[1].compensation_um == 0.0);
  REQUIRE(bench.tell(CommandCode::output_off).state == CommandState::done);
  CHECK(bench.unit.monitor().axes[0].compensation_um == 0.0);
}

TEST_CASE("an output with its relay closed ends when no command has come for a minute, whoever reads") {
  Bench bench;
  Command command{.code = CommandCode::output_compensation, .axis = Axis::X, .output_um = 40.0, .relay_on = true};
  REQUIRE(bench.tell(command).state == CommandState::done);
  REQUIRE(bench.simulation.run_for(59.0));
  CHECK(bench.unit.monitor().axes[0].relay_closed);
  SUBCASE("the same command again begins the minute anew") {
    REQUIRE(bench.tell(command).state == CommandState::done);
    REQUIRE(bench.simulation.run_for(59.0));
    CHECK(bench.unit.monitor().axes[0].output_counts == 400);
    CHECK(bench.unit.monitor().axes[0].relay_closed);
  }
  SUBCASE("reads do not keep it closed") {
    REQUIRE(bench.simulation.run_for(0.5));
    CHECK(bench.unit.status().axes[0].relay_closed);
    REQUIRE(bench.simulation.run_for(1.0));
    CHECK(!bench.unit.status().axes[0].relay_closed);
  }
  SUBCASE("silence opens the relays") {
    REQUIRE(bench.simulation.run_for(1.5));
    CHECK(bench.unit.monitor().axes[0].output_counts == 0);
    CHECK(!bench.unit.monitor().axes[0].relay_closed);
    CHECK(bench.unit.mode() == UnitMode::integration);
    CHECK(bench.unit.fault() == Fault::none);
  }
}

TEST_CASE("silence is no reason to end compensation, nor an output that moves nothing") {
  Bench bench;
  Command command{.code = CommandCode::output_compensation, .axis = Axis::X, .output_um = 40.0};
  REQUIRE(bench.tell(command).state == CommandState::done);
  REQUIRE(bench.simulation.run_for(61.0));
  CHECK(bench.unit.monitor().axes[0].output_counts == 400);
  bench.compensate();
  REQUIRE(bench.simulation.run_for(61.0));
  CHECK(all_relays(bench, true));
}

TEST_CASE("a position that no machine has is refused") {
  Bench bench;
  Command command{.code = CommandCode::set_axis_position, .axis = Axis::Y, .position_mm = 1e6};
  CHECK(bench.tell(command).state == CommandState::done);
  for (const double impossible : {1.0001e6, -1e300, std::nan(""), HUGE_VAL}) {
    command.position_mm = impossible;
    CHECK(bench.tell(command).error == UnitError::bad_argument);
  }
  CHECK(bench.unit.monitor().axes[1].position_mm == doctest::Approx(1e6));
}

TEST_CASE("the reason why an image or a map is refused fits into the text of a result") {
  constexpr std::size_t kAround = std::string_view("the image  (table 36)").size();
  for (int f = 0; f <= static_cast<int>(ImageFault::over_capacity); ++f)
    CHECK(text_of(static_cast<ImageFault>(f)).size() + kAround <= protocol::kResultTextBytes);
  for (int f = 0; f < kFaultCount; ++f)
    CHECK(text_of(static_cast<Fault>(f)).meaning.size() <= protocol::kResultTextBytes);
  Bench bench;
  auto image = bench.image([](Component, double, Approach) { return 1.0; });
  TableEntry entry = ImageView(image).entry(2);
  entry.increment_mm = 0.0;
  write_entry(image, 2, entry);
  seal_image(image);
  CHECK(bench.stage_and_commit(image).text == "the image has a table of impossible numbers (table 3)");
}

TEST_CASE("a position set by the host is shown and follows the axis") {
  Bench bench;
  REQUIRE(bench.tell(Command{.code = CommandCode::set_axis_position, .axis = Axis::Y, .position_mm = 123.0}).state ==
          CommandState::done);
  Vector3 target = bench.simulation.machine().command_mm();
  target[1] -= 10.0;
  REQUIRE(bench.simulation.move_to(target, 3000.0));
  CHECK(bench.unit.monitor().axes[1].position_mm == doctest::Approx(113.0));
}

TEST_CASE("a recorded datum sequence shows switch, marker and motion") {
  Bench bench;
  REQUIRE(bench.unit.begin(Command{.code = CommandCode::record_datum, .axis = Axis::X}).state == CommandState::busy);
  REQUIRE(reference(bench.simulation, {Axis::X}).has_value());
  REQUIRE(bench.simulation.run_for(10.0));
  const auto result = bench.unit.progress();
  REQUIRE(result.state == CommandState::done);
  CHECK(result.value == kDatumRecordAddress);
  const auto header = decode_datum_header(bench.unit.memory().view(kDatumRecordAddress, kDatumRecordHeaderBytes));
  REQUIRE(header.has_value());
  CHECK(header->samples == 10'000);
  CHECK(header->sample_period_us == 1000.0);
  std::int32_t marker_after_switch = 0;
  std::int32_t first_on_switch = 0, last_on_switch = 0;
  int closed = 0;
  for (std::uint32_t i = 0; i < header->samples; ++i) {
    const auto sample = decode_datum_sample(bench.unit.memory().view(datum_sample_address(i), kDatumSampleBytes));
    if (sample.switch_closed && closed++ == 0) first_on_switch = sample.counts;
    if (sample.switch_closed) last_on_switch = sample.counts;
    if (closed > 0 && !sample.switch_closed && sample.marker && marker_after_switch == 0)
      marker_after_switch = sample.counts;
  }
  CHECK(last_on_switch - first_on_switch == doctest::Approx(10'000.0).epsilon(0.002));  // 10 mm of switch,
  CHECK(closed == doctest::Approx(2000.0).epsilon(0.06));                               // nearly all at 300 mm/min
  CHECK(marker_after_switch == doctest::Approx(44'000.0).epsilon(0.001));  // from 44 mm before the datum marker
}

TEST_CASE("the datum routine can be tested without compensating") {
  Bench bench;
  REQUIRE(bench.unit.begin(Command{.code = CommandCode::test_datum, .axis = Axis::Z}).state == CommandState::busy);
  REQUIRE(reference(bench.simulation, {Axis::Z}).has_value());
  CHECK(bench.unit.progress().state == CommandState::done);
  CHECK(bench.unit.mode() == UnitMode::integration);
  CHECK(bench.unit.status().axes[2].referenced);
  CHECK(bench.unit.status().axes[2].position_mm == doctest::Approx(0.0).epsilon(1e-3));
}

TEST_CASE("address pointers name the value that was used last") {
  Bench bench;
  bench.compensate([](Component c, double p, Approach) { return c == Component::EXX ? -0.01 * p : 0.0; });
  REQUIRE(bench.simulation.move_to({-234.0, 0.0, 0.0}, 6000.0));
  const auto status = bench.unit.status();
  const auto pointer = status.pointers[index_of(Component::EXX)];
  CHECK(pointer.index == 26);  // -500 + 26 · 10 = -240, the value below
  const auto value =
      static_cast<std::int16_t>(load_big<std::uint16_t>(bench.unit.memory().view(pointer.address, 2), 0));
  CHECK(value == 240);  // +2.40 um
}
