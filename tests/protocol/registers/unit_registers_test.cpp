// Typed values through registers and back; the blocks of a bulk write.
#include "protocol/registers/unit_registers.hpp"

#include <limits>

#include <rapidcheck.h>

#include "protocol/registers/register_map.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::protocol;

namespace {

template <class E>
rc::Gen<E> one_of_first(std::uint16_t count) {
  return rc::gen::map(rc::gen::inRange<int>(0, count), [](int n) { return static_cast<E>(n); });
}
double finite() {
  return *rc::gen::suchThat(rc::gen::arbitrary<double>(), [](double x) { return std::isfinite(x); });
}
std::string printable(std::size_t most) {
  auto text = *rc::gen::container<std::string>(rc::gen::inRange<char>(' ', '~'));
  return text.substr(0, most);
}
template <class T>
T any() {
  return *rc::gen::arbitrary<T>();
}
template <class T>
T any_octets() {
  T octets{};
  for (auto& octet : octets) octet = any<std::uint8_t>();
  return octets;
}
Asker any_asker() { return {any<std::uint32_t>(), any<std::uint32_t>()}; }
Approach any_approach() { return static_cast<Approach>(*rc::gen::inRange(-1, 2)); }

Identity any_identity() {
  return {any<std::uint16_t>(),
          any<std::uint16_t>(),
          any<std::uint16_t>(),
          printable(16),
          printable(32),
          any<std::uint16_t>(),
          {any<bool>(), any<bool>(), any<bool>()},
          any<std::uint32_t>(),
          printable(40),
          any<std::uint32_t>()};
}
UnitStatus any_status() {
  UnitStatus s{.mode = *one_of_first<UnitMode>(5),
               .fault = *one_of_first<Fault>(kFaultCount),
               .fault_address = any<std::uint32_t>()};
  if (any<bool>()) s.fault_axis = *one_of_first<Axis>(kAxes);
  s.ram_test = *one_of_first<TestOutcome>(3);
  s.ram_test_address = any<std::uint32_t>();
  s.block_check_expected = any<std::uint32_t>();
  s.block_check_found = any<std::uint32_t>();
  s.active_bank = *one_of_first<Bank>(3);
  s.commit_sequence = any<std::uint32_t>();
  s.image_length_bytes = any<std::uint32_t>();
  s.loop_period_us = finite();
  s.loop_overruns = any<std::uint32_t>();
  s.ticks = any<std::uint64_t>();
  s.uptime_s = any<std::uint32_t>();
  s.watchdog_trips = any<std::uint16_t>();
  for (auto& a : s.axes)
    a = {any<bool>(),
         *one_of_first<DatumStage>(kDatumStageCount),
         *one_of_first<DatumFailure>(kDatumFailureCount),
         finite(),
         any_approach(),
         any<bool>()};
  s.pointers_at_tick = any<std::uint64_t>();
  for (auto& p : s.pointers) p = {any<std::uint32_t>(), any<std::uint32_t>()};
  return s;
}
MonitorSample any_sample() {
  MonitorSample s{.number = any<std::uint32_t>(),
                  .unit_time_us = any<std::uint64_t>(),
                  .mode = *one_of_first<UnitMode>(5),
                  .fault = *one_of_first<Fault>(kFaultCount)};
  for (auto& a : s.axes)
    a = {any<bool>(), finite(),       finite(), any<bool>(),         any<bool>(),
         any<bool>(), any_approach(), finite(), any<std::int32_t>(), any<bool>()};
  return s;
}

}  // namespace

TEST_CASE("every block has the length that the register map gives it") {
  CHECK(registers_of(Identity{}, 0).size() == kIdentity.count);
  CHECK(registers_of(UnitStatus{}, 0).size() == kStatus.count);
  CHECK(pointer_registers_of(UnitStatus{}, 0).size() == kPointers.count);
  CHECK(registers_of(ActiveMap{}, 0).size() == kActiveMap.count);
  CHECK(registers_of(MonitorSample{}, 0).size() == kMonitor.count);
  CHECK(registers_of(LiveInputs{}, 0).size() == kInputs.count);
  CHECK(registers_of(ControlLines{}, 0).size() == kControlLines.count);
  CHECK(registers_of(RotarySample{}, 0).size() == kRotary.count);
  CHECK(registers_of(CommandResult{}, 0).size() == kCommandResult.count);
  CHECK(registers_of(WindowAck{}, 0).size() == kWindowAck.count);
  CHECK(registers_of(Command{}, 0).size() == kCommand.count);
  CHECK(registers_of(WindowOpen{}, 0).size() == kWindowOpen.count);
  CHECK(registers_of(CheckSelect{}, 0).size() == kCheckSelect.count);
  CHECK(registers_of(ReadSelect{}, 0).size() == kReadSelect.count);
  CHECK(registers_of(ResultSelect{}, 0).size() == kResultSelect.count);
  CHECK(registers_of(SessionOpen{}, 0).size() == kSessionOpen.count);
  CHECK(registers_of(SessionState{}, 0).size() == kSession.count);
  CHECK(registers_of(EchoAsk{}, 0).size() == kEcho.count);
  CHECK(registers_of(ArmShare{}, 0).size() == kArmShare.count);
  CHECK(registers_of(ArmConfirm{}, 0).size() == kArmConfirm.count);
  CHECK(registers_of(ArmAnswer{}, 0).size() == kArmAnswer.count);
}

TEST_CASE("the live inputs come back from their registers as they were") {
  LiveInputs live;
  live.stored_age_s = 4711;
  live.rows = 5;
  live.thermal_um = {-12.5, 0.25, 1e-3};
  live.inputs[0] = {InputState::good, 23.75, 0, true};
  live.inputs[15] = {InputState::stuck, -4.5, 3, true};
  live.inputs[kLoadInput] = {InputState::missing, 0.0, 65535, false};
  CHECK(must(value_in<LiveInputs>(registers_of(live, 9))) == live);
  Command command{.code = CommandCode::set_input, .input = 16, .input_value = 812.5};
  CHECK(must(value_in<Command>(registers_of(command, 9))) == command);
  Registers registers = registers_of(command, 9);
  registers[11] = 18;  // the first argument
  CHECK(contains(must_fail(value_in<Command>(registers)).message, "input: expected a number below 18"));
}

TEST_CASE("the lines to the control and the commands on tools come back from their registers as they were") {
  ControlLines lines;
  lines.tool = 4711;
  lines.tool_state = ToolState::changing;
  lines.tool_offset_mm = {0.125, -3.5, 151.0625};
  lines.squareness_um_per_m = {-12.25, 0.0, 1e-4};
  lines.tools = 64;
  lines.battery = BatteryState::low;
  lines.battery_age_s = 315'360'000;
  lines.deviation = {InputState::missing, -1.75, 12, true};
  for (bool* const flag : {&lines.tool_wired, &lines.control_on_wired, &lines.control_on, &lines.compensating_out,
                           &lines.fault_out, &lines.deviation.wired}) {
    *flag = !*flag;
    CHECK(must(value_in<ControlLines>(registers_of(lines, 9))) == lines);
  }
  for (const CommandCode code : {CommandCode::select_tool, CommandCode::remove_tool}) {
    const Command command{.code = code, .tool = 9999};
    CHECK(must(value_in<Command>(registers_of(command, 9))) == command);
  }
  const Command set{.code = CommandCode::set_tool, .tool = 12, .tool_offset_mm = {-2.5, 0.0, 150.0}};
  CHECK(must(value_in<Command>(registers_of(set, 9))) == set);
  const Command tried{.code = CommandCode::try_squareness, .squareness_um_per_m = {-12.3457, 0.0, 9999.5}};
  const Vector3 back_um_per_m = must(value_in<Command>(registers_of(tried, 9))).squareness_um_per_m;
  for (std::size_t i = 0; i < kAxes; ++i) CHECK(back_um_per_m[i] == Approx(tried.squareness_um_per_m[i]));
  const Command fine{.code = CommandCode::set_tool, .tool = 12, .tool_offset_mm = {0.12344, 0.0, -9999.99996}};
  const Vector3 back_mm = must(value_in<Command>(registers_of(fine, 9))).tool_offset_mm;
  CHECK(back_mm[0] == Approx(0.1234));
  CHECK(back_mm[2] == Approx(-10'000.0));
}

TEST_CASE("the rotary axes come back from their registers as they were, and no other letter is accepted") {
  RotarySample sample;
  sample.compensation_um = {-12.5, 0.25, 1e-3};
  sample.axes = {{{'A', true, -30.0005, Approach::reverse}, {'C', false, 0.0, Approach::unknown}}};
  Registers registers = registers_of(sample, 9);
  CHECK(must(value_in<RotarySample>(registers)) == sample);
  registers[13] = 'D';
  CHECK(contains(must_fail(value_in<RotarySample>(registers)).message, "rotary axis: expected A, B, C or 0, got 68"));
}

TEST_CASE("blocks do not overlap; those of answers fit one read, that of a window one write") {
  const std::array all{kEcho,         kReadSelect, kWindowOpen, kCommand, kSessionOpen,  kEventSelect,   kToken,
                       kBlockWrite,   kIdentity,   kStatus,     kMonitor, kPointers,     kCommandResult, kWindowAck,
                       kMemory,       kChecks,     kEvents,     kSession, kActiveMap,    kArmAnswer,     kCheckSelect,
                       kResultSelect, kArmShare,   kArmConfirm, kInputs,  kControlLines, kRotary};
  for (std::size_t i = 0; i + 1 < all.size(); ++i) CHECK(all[i].end() <= all[i + 1].first);
  CHECK(all.back().end() <= kRegisterSpace);
  for (const auto& block : {kIdentity, kStatus, kMonitor, kPointers, kCommandResult, kWindowAck, kMemory, kChecks,
                            kEvents, kSession, kActiveMap, kInputs})
    CHECK(block.count <= kMostRead);
  CHECK(kBlockWrite.count <= kMostWrite);
}

TEST_CASE("typed values survive the way through registers") {
  CHECK(rc::check("identity", [] {
    const auto value = any_identity();
    RC_ASSERT(value_in<Identity>(registers_of(value, any<std::uint16_t>())).value() == value);
  }));
  CHECK(rc::check("active map", [] {
    const ActiveMap value{any_identity().serial_number, any<std::uint32_t>(), any<std::uint32_t>(),
                          *one_of_first<Bank>(3),       any<std::uint32_t>(), any<std::uint32_t>(),
                          any_octets<ImageDigest>()};
    RC_ASSERT(value_in<ActiveMap>(registers_of(value, any<std::uint16_t>())).value() == value);
  }));
  CHECK(rc::check("status with its pointers", [] {
    const auto value = any_status();
    auto back = value_in<UnitStatus>(registers_of(value, 1)).value();
    RC_ASSERT(take_pointers(pointer_registers_of(value, 2), back).has_value());
    RC_ASSERT(back == value);
  }));
  CHECK(rc::check("monitor", [] {
    const auto value = any_sample();
    RC_ASSERT(value_in<MonitorSample>(registers_of(value, 1)).value() == value);
  }));
  CHECK(rc::check("command result", [] {
    const CommandResult value{any<std::uint32_t>(),
                              *one_of_first<CommandState>(5),
                              *one_of_first<UnitError>(kUnitErrorCount),
                              any<std::uint16_t>(),
                              any<std::uint32_t>(),
                              printable(80),
                              any<std::uint32_t>(),
                              any<std::uint32_t>()};
    RC_ASSERT(value_in<CommandResult>(registers_of(value, 1)).value() == value);
  }));
  CHECK(rc::check("window and acknowledgement", [] {
    const WindowAck ack{any<std::uint32_t>(), *one_of_first<UnitError>(kUnitErrorCount),
                        any<std::uint32_t>(), any<std::uint32_t>(),
                        any<std::uint64_t>(), any<std::uint32_t>()};
    RC_ASSERT(value_in<WindowAck>(registers_of(ack, 1)).value() == ack);
    const WindowOpen open{any<std::uint32_t>(), any<std::uint32_t>(), any<std::uint32_t>(),
                          any<std::uint32_t>(), any<bool>(),          any_asker()};
    RC_ASSERT(value_in<WindowOpen>(registers_of(open, 1)).value() == open);
    const CheckSelect select{any_asker(), any<std::uint32_t>(), any<std::uint32_t>(), any<std::uint16_t>()};
    RC_ASSERT(value_in<CheckSelect>(registers_of(select, 1)).value() == select);
  }));
  CHECK(rc::check("sessions", [] {
    const SessionOpen open{any<std::uint32_t>(), any<std::uint16_t>(), any<std::uint64_t>(),
                           any<std::uint32_t>(), any<std::uint32_t>(), printable(16)};
    RC_ASSERT(value_in<SessionOpen>(registers_of(open, 1)).value() == open);
    const SessionState state{any<std::uint16_t>(), *one_of_first<UnitError>(kUnitErrorCount),
                             any<std::uint32_t>(), any<std::uint32_t>(),
                             any<std::uint32_t>(), any<std::uint32_t>(),
                             any<std::uint16_t>(), any<std::uint32_t>(),
                             any<std::uint16_t>(), any<bool>(),
                             any<std::uint64_t>()};
    RC_ASSERT(value_in<SessionState>(registers_of(state, 1)).value() == state);
    const ResultSelect select{any_asker(), any<std::uint32_t>()};
    RC_ASSERT(value_in<ResultSelect>(registers_of(select, 1)).value() == select);
    const ArmAnswer answer{*one_of_first<UnitError>(kUnitErrorCount), any<std::uint16_t>(), any_octets<Share>(),
                           any_octets<Confirmation>(), any<std::uint32_t>()};
    RC_ASSERT(value_in<ArmAnswer>(registers_of(answer, 1)).value() == answer);
    const ArmShare share{any<std::uint32_t>(), any<std::uint16_t>(), any_octets<Share>()};
    RC_ASSERT(value_in<ArmShare>(registers_of(share, 1)).value() == share);
    const ArmConfirm confirm{any<std::uint32_t>(), any_octets<Confirmation>()};
    RC_ASSERT(value_in<ArmConfirm>(registers_of(confirm, 1)).value() == confirm);
  }));
  CHECK(rc::check("bytes", [] {
    const auto bytes = any<std::vector<std::uint8_t>>();
    RC_ASSERT(unpacked(packed(bytes), bytes.size()) == bytes);
  }));
}

TEST_CASE("each command carries the arguments that its code names") {
  Command c{.sequence = 9,
            .code = CommandCode::output_compensation,
            .axis = Axis::Z,
            .output_um = -12.25,
            .relay_on = true,
            .asker = {0x12345678, 0x9ABCDEF0},
            .clock_ms = 70'000,
            .stops = 3};
  CHECK(value_in<Command>(registers_of(c, 1)).value() == c);
  Command commit{
      .code = CommandCode::commit_staged, .length = 70'000, .digest = 0xDEADBEEFDEADBEEF, .token = 0x12345678};
  CHECK(value_in<Command>(registers_of(commit, 1)).value() == commit);
  Command user{.code = CommandCode::run_user_software, .address = 0x040100, .argument = 0x12345678};
  CHECK(value_in<Command>(registers_of(user, 1)).value() == user);
  Command position{.code = CommandCode::set_axis_position, .axis = Axis::Y, .position_mm = 0.1};
  CHECK(value_in<Command>(registers_of(position, 1)).value() == position);
}

TEST_CASE("numbers go high word first and doubles as the 64 bits of IEEE 754") {
  const auto identity = registers_of(Identity{1, 2, 3, "AB", "", 1, {true, false, true}, 0x00012345}, 0xBEEF);
  CHECK(identity[0] == 0xBEEF);
  CHECK(identity[4] == 0x4142);
  CHECK(identity[29] == 0b101);
  CHECK(identity[30] == 0x0001);
  CHECK(identity[31] == 0x2345);
  CHECK(identity.size() == 54);
  UnitStatus status;
  status.loop_period_us = 1000.0;  // 0x408F400000000000
  const auto registers = registers_of(status, 0);
  CHECK(registers[18] == 0x408F);
  CHECK(registers[19] == 0x4000);
  CHECK(registers[20] == 0);
}

TEST_CASE("a block that makes no sense is refused with the name of the field") {
  auto status = registers_of(UnitStatus{}, 0);
  status[1] = 77;
  REQUIRE_FALSE(value_in<UnitStatus>(status).has_value());
  CHECK(contains(value_in<UnitStatus>(status).error().message, "mode"));
  UnitStatus nan;
  nan.loop_period_us = std::numeric_limits<double>::quiet_NaN();
  CHECK(contains(value_in<UnitStatus>(registers_of(nan, 0)).error().message, "loop period"));
  CHECK_FALSE(value_in<UnitStatus>(Registers(5, 0)).has_value());
  CHECK_FALSE(value_in<Identity>(registers_of(Identity{1, 0, 0, "a\x1b[2J", "", 1, {}, 0}, 0)).has_value());
}

TEST_CASE("text longer than its field is cut, never inside a character") {
  CommandResult result;
  result.text = std::string(79, 'x') + "\xC2\xB5m";  // µ would need bytes 80 and 81
  CHECK(value_in<CommandResult>(registers_of(result, 0)).value().text == std::string(79, 'x'));
}

TEST_CASE("a window has as many blocks of 234 bytes as its bytes need, the last one shorter") {
  CHECK(blocks_in(0) == 0);
  CHECK(blocks_in(1) == 1);
  CHECK(blocks_in(234) == 1);
  CHECK(blocks_in(235) == 2);
  CHECK(bytes_in_block(235, 0) == 234);
  CHECK(bytes_in_block(235, 1) == 1);
  CHECK(bytes_in_block(235, 2) == 0);
}

TEST_CASE("the bytes of all blocks are the bytes of the window") {
  for (const std::uint32_t length : {1U, 233U, 234U, 1000U, static_cast<std::uint32_t>(kWindowBytes)}) {
    std::size_t sum = 0;
    for (std::size_t number = 0; number < blocks_in(length); ++number) sum += bytes_in_block(length, number);
    CHECK(sum == length);
  }
}
