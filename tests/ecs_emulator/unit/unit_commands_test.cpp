#include "ecs_emulator/unit/unit.hpp"
#include "protocol/registers/register_map.hpp"
#include "tests/ecs_emulator/support/emulated_unit.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

TEST_CASE_FIXTURE(Bench, "a compensating unit answers reads and refuses every write and command but integrate") {
  compensate();
  std::vector<std::uint8_t> bytes(16);
  CHECK(unit.read_memory(kBankA.first, bytes) == UnitError::none);
  CHECK(load_big<std::uint32_t>(bytes, 0) == kImageMagic);
  CHECK(unit.write_memory(kSystemRam.first, bytes) == UnitError::not_in_integration_mode);
  for (std::uint16_t code = 2; code < protocol::kCommandCount; ++code) {
    if (const auto c = static_cast<CommandCode>(code);
        c == CommandCode::stop || c == CommandCode::set_input || c == CommandCode::select_tool ||
        c == CommandCode::set_tool || c == CommandCode::remove_tool || c == CommandCode::try_squareness ||
        c == CommandCode::begin_tools || c == CommandCode::stage_tool || c == CommandCode::commit_tools)
      continue;  // inputs and tools are no writes to the map (live_inputs_test.cpp, tools_test.cpp)
    CHECK(tell(static_cast<CommandCode>(code)).error == UnitError::not_in_integration_mode);
  }
  CHECK(unit.mode() == UnitMode::compensating);
  CHECK(tell(CommandCode::enter_integration).state == CommandState::done);
  simulation.tick();
  CHECK(all_relays(*this, false));
}

TEST_CASE_FIXTURE(Bench, "memory is protected region by region") {
  const std::vector<std::uint8_t> bytes(4, 0x5A);
  CHECK(unit.write_memory(kEprom.first, bytes) == UnitError::address_protected);
  CHECK(unit.write_memory(kCommitRecords.first, bytes) == UnitError::address_protected);
  CHECK(unit.write_memory(kSystemRam.first, bytes) == UnitError::none);
  CHECK(unit.write_memory(kSystemRam.first + kSystemRam.size - 2, bytes) == UnitError::address_unknown);
  CHECK(unit.write_memory(kBankA.first + bank_bytes(1), bytes) == UnitError::address_unknown);
  std::vector<std::uint8_t> eprom(21);
  REQUIRE(unit.read_memory(kEprom.first + 0x400, eprom) == UnitError::none);
  CHECK(std::string(eprom.begin(), eprom.end()) == "ECS UNIT FIRMWARE 1.2");
}

TEST_CASE_FIXTURE(Bench, "axis memory takes writes only beside the active map, and only while a map is staged") {
  const std::vector<std::uint8_t> bytes(4, 0x5A);
  const auto image = flat_image(1.0);
  for (const Address bank : {kBankA.first, kBankB.first})
    CHECK(unit.write_memory(bank, bytes) == UnitError::no_staging);
  REQUIRE(stage_and_commit(image).state == CommandState::done);  // bank A is active now
  CHECK(unit.write_memory(kBankA.first, bytes) == UnitError::address_protected);
  CHECK(unit.write_memory(kBankB.first, bytes) == UnitError::no_staging);
  REQUIRE(tell(CommandCode::begin_staging).value == kBankB.first);
  CHECK(unit.write_memory(kBankA.first + 0x200, bytes) == UnitError::address_protected);
  CHECK(unit.may_write(kBankA.first + bank_bytes(1) - 1, 1) == UnitError::address_protected);
  CHECK(unit.write_memory(kBankB.first, bytes) == UnitError::none);
  const ByteView held = unit.memory().view(kBankA.first, static_cast<std::uint32_t>(image.size()));
  CHECK(std::equal(held.begin(), held.end(), image.begin(), image.end()));
}

TEST_CASE_FIXTURE(Bench,
                  "the status computes the checksum of the active map while nothing else has the processor's time") {
  REQUIRE(stage_and_commit(flat_image(1.0)).value == 1);
  const auto sound = unit.status();
  CHECK(sound.block_check_found == sound.block_check_expected);
  unit.memory().corrupt(kBankA.first + 600, 0x10);
  const auto spoilt = unit.status();
  CHECK(spoilt.block_check_expected == sound.block_check_expected);
  CHECK(spoilt.block_check_found != spoilt.block_check_expected);
}

TEST_CASE_FIXTURE(Bench, "a commit that cannot be kept in the battery memory fails, and the old map stays active") {
  bool disk_full = false;
  unit.on_commit([&] { return !disk_full; });
  const auto old_image = flat_image(1.0);
  REQUIRE(stage_and_commit(old_image).value == 1);
  disk_full = true;
  const auto result = stage_and_commit(flat_image(2.0));
  CHECK(result.state == CommandState::failed);
  CHECK(contains(result.text, "the old map stays active"));
  CHECK(result.text.size() <= protocol::kResultTextBytes);
  CHECK(unit.status().commit_sequence == 1);
  CHECK(unit.status().active_bank == protocol::Bank::A);
  disk_full = false;
  CHECK(stage_and_commit(old_image).value == 2);
}

TEST_CASE_FIXTURE(Bench,
                  "a commit that is taken back leaves the battery as it was, and a supply that fails meanwhile a map") {
  const auto old_image = flat_image(1.0);
  const auto new_image = flat_image(2.0);
  for (std::uint64_t cut = 0; cut <= 4 * kCommitSlotBytes; ++cut) {
    CAPTURE(cut);
    Bench other;
    REQUIRE(other.stage_and_commit(old_image).value == 1);
    int kept = 0;
    std::optional<std::uint32_t> kept_last;
    other.unit.on_commit([&] {
      kept_last = active_image(other.unit.memory())->commit.sequence;
      return ++kept > 1;  // the first time the battery may be written, but its name is not sure
    });
    REQUIRE(other.unit.write_memory(other.tell(CommandCode::begin_staging).value, new_image) == UnitError::none);
    other.unit.memory().power_fails_after(cut);
    const auto result = other.tell(Command{.code = CommandCode::commit_staged,
                                           .length = static_cast<std::uint32_t>(new_image.size()),
                                           .digest = protocol::short_digest(protocol::digest_of(new_image))});
    if (cut == 4 * kCommitSlotBytes) {
      CHECK(result.state == CommandState::failed);
      CHECK(kept == 2);
      CHECK(kept_last == 1);
    }
    other.unit.power(false);
    other.unit.memory().power_back();
    other.unit.power(true);
    const auto active = must(active_image(other.unit.memory()));
    const auto& expected = active.commit.sequence == 1 ? old_image : new_image;
    const ByteView held = other.unit.memory().view(active.first, static_cast<std::uint32_t>(expected.size()));
    CHECK(std::equal(held.begin(), held.end(), expected.begin()));
  }
}

TEST_CASE_FIXTURE(Bench, "a unit whose supply failed within a commit stays off until its battery memory can be kept") {
  bool disk_full = true;
  unit.on_commit([&] { return !disk_full; });
  const auto image = flat_image(1.0);
  REQUIRE(unit.write_memory(tell(CommandCode::begin_staging).value, image) == UnitError::none);
  unit.memory().power_fails_after(kCommitSlotBytes);  // the new record is whole
  (void)tell(Command{.code = CommandCode::commit_staged,
                     .length = static_cast<std::uint32_t>(image.size()),
                     .digest = protocol::short_digest(protocol::digest_of(image))});
  unit.power(false);
  unit.power(true);
  CHECK_FALSE(unit.powered());
  disk_full = false;
  unit.power(true);
  CHECK(unit.powered());
  CHECK(unit.status().commit_sequence == 1);
}

TEST_CASE_FIXTURE(Bench,
                  "a damaged record of an answered commit isolates the unit and never brings the map before back") {
  REQUIRE(stage_and_commit(flat_image(1.0)).value == 1);
  REQUIRE(stage_and_commit(flat_image(2.0)).value == 2);
  for (std::uint32_t byte = 0; byte < 24; ++byte) {
    CAPTURE(byte);
    const Address at = kCommitRecords.first + kCommitSlotBytes + byte;
    unit.memory().corrupt(at, 0x04);
    unit.power(false);
    unit.power(true);
    simulation.tick();
    CHECK(unit.status().fault == Fault::commit_record);
    CHECK(unit.status().fault_address == kCommitRecords.first + kCommitSlotBytes);
    CHECK(unit.status().active_bank == protocol::Bank::none);
    CHECK(tell(CommandCode::enter_compensation).state == CommandState::failed);
    CHECK(unit.mode() == UnitMode::integration);
    unit.memory().corrupt(at, 0x04);
  }
}

TEST_CASE_FIXTURE(Bench,
                  "a damaged record beside a sound one is reported until a map is committed, and prevents nothing") {
  const auto image = flat_image(1.0);
  REQUIRE(stage_and_commit(image).value == 1);
  unit.memory().corrupt(kCommitRecords.first + kCommitSlotBytes + 5, 0x04);
  CHECK(tell(CommandCode::enter_compensation).state == CommandState::done);
  CHECK(tell(CommandCode::enter_integration).state == CommandState::done);
  CHECK(unit.fault() == Fault::commit_record);
  REQUIRE(stage_and_commit(image).value == 2);
  CHECK(unit.fault() == Fault::none);
}

TEST_CASE_FIXTURE(Bench, "a map takes the fault away that the lack of one was") {
  REQUIRE(tell(CommandCode::enter_compensation).state == CommandState::failed);
  REQUIRE(unit.fault() == Fault::no_map);
  REQUIRE(stage_and_commit(flat_image(1.0)).value == 1);
  CHECK(unit.fault() == Fault::none);
}

TEST_CASE_FIXTURE(Bench, "an image that is not what was announced, or no image, is refused and the old map stays") {
  const auto image = flat_image(1.0);
  REQUIRE(stage_and_commit(image).value == 1);
  auto other = image;
  other[100] ^= 1;  // parameters: the checksum inside the image no longer agrees
  const auto result = stage_and_commit(other);
  CHECK(result.error == UnitError::image_refused);
  CHECK(!result.text.empty());
  REQUIRE(tell(CommandCode::begin_staging).value == kBankB.first);
  REQUIRE(unit.write_memory(kBankB.first, image) == UnitError::none);
  CHECK(tell(Command{.code = CommandCode::commit_staged,
                     .length = static_cast<std::uint32_t>(image.size()),
                     .digest = protocol::short_digest(protocol::digest_of(image)) + 1})
            .error == UnitError::check_mismatch);
  CHECK(unit.status().commit_sequence == 1);
  CHECK(tell(CommandCode::abandon_staged).state == CommandState::done);
  CHECK(tell(Command{.code = CommandCode::commit_staged, .length = 10}).error == UnitError::no_staging);
}

TEST_CASE_FIXTURE(Bench,
                  "an image for another unit, machine or configuration is refused by name, and the old map stays") {
  const auto image = flat_image(1.0);
  REQUIRE(stage_and_commit(image).value == 1);
  const auto own = *ImageView(image).identity();
  const auto addressed_to = [&](const ImageIdentity& identity) {
    auto other = image;
    write_identity(other, identity);
    seal_image(other);
    return stage_and_commit(other);
  };
  CHECK(addressed_to({"OTHER-2", own.machine, own.configuration}).error == UnitError::other_machine);
  CHECK(addressed_to({own.serial_number, "another", own.configuration}).error == UnitError::other_machine);
  const auto refused = addressed_to({own.serial_number, own.machine, own.configuration + 1});
  CHECK(refused.error == UnitError::other_machine);
  CHECK(refused.text == "the image is for another configuration than the active map");
  CHECK(unit.status().commit_sequence == 1);
  CHECK(unit.identity().machine == own.machine);
  CHECK(unit.identity().configuration == own.configuration);
  CHECK(addressed_to(own).value == 2);
}

TEST_CASE_FIXTURE(Bench, "power lost at any byte of a transfer leaves the complete old map or the new one") {
  const auto old_image = flat_image(1.0);
  const auto new_image = flat_image(2.0);
  REQUIRE(stage_and_commit(old_image).state == CommandState::done);
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
                             .digest = protocol::short_digest(protocol::digest_of(new_image))});
    other.unit.power(false);
    other.unit.memory().power_back();
    other.unit.power(true);
    other.simulation.tick();
    const auto active = must(active_image(other.unit.memory()));
    const auto& expected = cut >= staged + 24 ? new_image : old_image;
    const ByteView held = other.unit.memory().view(active.first, static_cast<std::uint32_t>(expected.size()));
    CHECK(std::equal(held.begin(), held.end(), expected.begin()));
    CHECK(other.tell(CommandCode::enter_compensation).state == CommandState::done);
  }
}

TEST_CASE_FIXTURE(Bench, "entering integration mode opens a relay that a host has closed in that mode") {
  REQUIRE(tell(Command{.code = CommandCode::output_compensation, .axis = Axis::X, .output_um = 50.0, .relay_on = true})
              .state == CommandState::done);
  simulation.tick();
  REQUIRE(unit.monitor().axes[0].relay_closed);
  CHECK(tell(CommandCode::enter_integration).state == CommandState::done);
  simulation.tick();
  CHECK(all_relays(*this, false));
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
  CHECK(bench.simulation.machine().axis(Axis::X).position_mm() - before == Approx(0.055).epsilon(1e-6));
  CHECK(bench.unit.monitor().axes[0].output_counts == 500);
  REQUIRE(bench.tell(CommandCode::output_off).state == CommandState::done);
  REQUIRE(bench.simulation.run_for(1.0));
  CHECK(bench.simulation.machine().axis(Axis::X).position_mm() == Approx(before));
  command.output_um = 501.0;
  CHECK(bench.tell(command).error == UnitError::bad_argument);
}

TEST_CASE_FIXTURE(Bench,
                  "the monitor shows what the host's output asks for, whatever polarity and scale turn it into") {
  parameters.axes[0].compensation_polarity = -1;
  parameters.axes[0].output_scale_counts_per_um = 4.0;
  REQUIRE(stage_and_commit(flat_image(0.0)).state == CommandState::done);
  Command command{.code = CommandCode::output_compensation, .axis = Axis::X, .output_um = 400.0, .relay_on = true};
  REQUIRE(tell(command).state == CommandState::done);
  CHECK(unit.monitor().axes[0].output_counts == -1600);
  CHECK(unit.monitor().axes[0].compensation_um == Approx(400.0));
  CHECK(unit.monitor().axes[1].compensation_um == 0.0);
  REQUIRE(tell(CommandCode::output_off).state == CommandState::done);
  CHECK(unit.monitor().axes[0].compensation_um == 0.0);
}

TEST_CASE_FIXTURE(Bench, "an output with its relay closed ends when no command has come for a minute, whoever reads") {
  Command command{.code = CommandCode::output_compensation, .axis = Axis::X, .output_um = 40.0, .relay_on = true};
  REQUIRE(tell(command).state == CommandState::done);
  REQUIRE(simulation.run_for(59.0));
  CHECK(unit.monitor().axes[0].relay_closed);
  SUBCASE("the same command again restarts the minute") {
    REQUIRE(tell(command).state == CommandState::done);
    REQUIRE(simulation.run_for(59.0));
    CHECK(unit.monitor().axes[0].output_counts == 400);
    CHECK(unit.monitor().axes[0].relay_closed);
  }
  SUBCASE("reads do not keep it closed") {
    REQUIRE(simulation.run_for(0.5));
    CHECK(unit.status().axes[0].relay_closed);
    REQUIRE(simulation.run_for(1.0));
    CHECK(!unit.status().axes[0].relay_closed);
  }
  SUBCASE("silence opens the relays") {
    REQUIRE(simulation.run_for(1.5));
    CHECK(unit.monitor().axes[0].output_counts == 0);
    CHECK(!unit.monitor().axes[0].relay_closed);
    CHECK(unit.mode() == UnitMode::integration);
    CHECK(unit.fault() == Fault::none);
  }
}

TEST_CASE_FIXTURE(Bench, "silence is no reason to end compensation, nor an output that moves nothing") {
  Command command{.code = CommandCode::output_compensation, .axis = Axis::X, .output_um = 40.0};
  REQUIRE(tell(command).state == CommandState::done);
  REQUIRE(simulation.run_for(61.0));
  CHECK(unit.monitor().axes[0].output_counts == 400);
  compensate();
  REQUIRE(simulation.run_for(61.0));
  CHECK(all_relays(*this, true));
}

TEST_CASE_FIXTURE(Bench, "a position that no machine has is refused") {
  Command command{.code = CommandCode::set_axis_position, .axis = Axis::Y, .position_mm = 1e6};
  CHECK(tell(command).state == CommandState::done);
  for (const double impossible : {1.0001e6, -1e300, std::nan(""), HUGE_VAL}) {
    command.position_mm = impossible;
    CHECK(tell(command).error == UnitError::bad_argument);
  }
  CHECK(unit.monitor().axes[1].position_mm == Approx(1e6));
}

TEST_CASE("the reason why an image or a map is refused fits into the text of a result") {
  constexpr std::size_t kAround = std::string_view("the image  (table 36)").size();
  for (int f = 0; f <= static_cast<int>(ImageFault::over_capacity); ++f)
    CHECK(text_of(static_cast<ImageFault>(f)).size() + kAround <= protocol::kResultTextBytes);
  for (int f = 0; f < kFaultCount; ++f)
    CHECK(text_of(static_cast<Fault>(f)).meaning.size() <= protocol::kResultTextBytes);
  Bench bench;
  auto image = bench.flat_image(1.0);
  TableEntry entry = ImageView(image).entry(2);
  entry.increment_mm = 0.0;
  write_entry(image, 2, entry);
  seal_image(image);
  CHECK(bench.stage_and_commit(image).text == "the image has a table of impossible numbers (table 3)");
}

TEST_CASE_FIXTURE(Bench, "a position set by the host is shown and follows the axis") {
  REQUIRE(tell(Command{.code = CommandCode::set_axis_position, .axis = Axis::Y, .position_mm = 123.0}).state ==
          CommandState::done);
  Vector3 target = simulation.machine().command_mm();
  target[1] -= 10.0;
  REQUIRE(simulation.move_to(target, 3000.0));
  CHECK(unit.monitor().axes[1].position_mm == Approx(113.0));
}

TEST_CASE_FIXTURE(Bench, "a recorded datum sequence shows switch, marker and motion") {
  REQUIRE(unit.begin(Command{.code = CommandCode::record_datum, .axis = Axis::X}).state == CommandState::busy);
  REQUIRE(reference(simulation, {Axis::X}).has_value());
  REQUIRE(simulation.run_for(10.0));
  const auto result = unit.progress();
  REQUIRE(result.state == CommandState::done);
  CHECK(result.value == kDatumRecordAddress);
  const auto header = must(decode_datum_header(unit.memory().view(kDatumRecordAddress, kDatumRecordHeaderBytes)));
  CHECK(header.samples == 10'000);
  CHECK(header.sample_period_us == 1000.0);
  std::int32_t marker_after_switch = 0;
  std::int32_t first_on_switch = 0, last_on_switch = 0;
  int closed = 0;
  for (std::uint32_t i = 0; i < header.samples; ++i) {
    const auto sample = decode_datum_sample(unit.memory().view(datum_sample_address(i), kDatumSampleBytes));
    if (sample.switch_closed && closed++ == 0) first_on_switch = sample.counts;
    if (sample.switch_closed) last_on_switch = sample.counts;
    if (closed > 0 && !sample.switch_closed && sample.marker && marker_after_switch == 0)
      marker_after_switch = sample.counts;
  }
  CHECK(last_on_switch - first_on_switch == Approx(10'000.0).epsilon(0.002));  // 10 mm of switch,
  CHECK(closed == Approx(2000.0).epsilon(0.06));                               // nearly all at 300 mm/min
  CHECK(marker_after_switch == Approx(44'000.0).epsilon(0.001));               // from 44 mm before the datum marker
}

TEST_CASE_FIXTURE(Bench, "the datum routine can be tested without compensating") {
  REQUIRE(unit.begin(Command{.code = CommandCode::test_datum, .axis = Axis::Z}).state == CommandState::busy);
  REQUIRE(reference(simulation, {Axis::Z}).has_value());
  CHECK(unit.progress().state == CommandState::done);
  CHECK(unit.mode() == UnitMode::integration);
  CHECK(unit.status().axes[2].referenced);
  CHECK(unit.status().axes[2].position_mm == Approx(0.0).epsilon(1e-3));
}

TEST_CASE_FIXTURE(Bench, "address pointers name the value that was used last") {
  compensate([](Component c, double p, Approach) { return c == Component::EXX ? -0.01 * p : 0.0; });
  REQUIRE(simulation.move_to({-234.0, 0.0, 0.0}, 6000.0));
  const auto status = unit.status();
  const auto pointer = status.pointers[index_of(Component::EXX)];
  CHECK(pointer.index == 26);  // -500 + 26 · 10 = -240, the value below
  const auto value = static_cast<std::int16_t>(load_big<std::uint16_t>(unit.memory().view(pointer.address, 2), 0));
  CHECK(value == 240);  // +2.40 um
}
