// libFuzzer over the host's end of the link: a unit that answers whatever the input says. Every call of the client
// ends, with a value or with a problem in words; what was read from a block is written back as the same block.

#include "tests/fuzz/fuzzed_bytes.hpp"
#include "tests/support/unit_model.hpp"

namespace {

using namespace ecs;
using namespace ecs::protocol;
using namespace std::chrono_literals;
using fuzz::check;
using fuzz::FuzzedBytes;

template <class T>
void judge(const Result<T>& result) {
  if (!result) check(!result.error().message.empty());
}

/// Answers from the input, mostly with the right echo, and ends the host's patience after this many requests.
class Liar : public RegisterHandler {
 public:
  static constexpr int kPatience = 40;
  FuzzedBytes input{nullptr, 0};
  std::atomic<bool> cancelled{false};
  int requests = 0;

  tl::expected<Registers, ModbusException> read(std::uint16_t first, std::uint16_t count) override {
    if (++requests > kPatience) cancelled = true;
    const std::uint8_t choice = input.byte();
    if (choice == 0xFF) return tl::unexpected(ModbusException::illegal_value);
    if (choice == 0xFE) return model_server_.read(first, count).map([this](Registers words) { return echoed(words); });
    Registers words(count);
    for (auto& word : words) word = (choice & 1) != 0 ? input.byte() : input.word();
    if ((choice & 0x78) != 0x78) words = echoed(std::move(words));
    return words;
  }
  tl::expected<void, ModbusException> write(std::uint16_t first, std::span<const std::uint16_t> values) override {
    if (first < kBlockWrite.first) echo_ = values.front();
    if (first != kBlockWrite.first) (void)model_server_.write(first, values);
    if (input.any() && input.byte() == 0xFF) return tl::unexpected(ModbusException::illegal_value);
    return {};
  }

 private:
  [[nodiscard]] Registers echoed(Registers words) const {
    if (!words.empty()) words.front() = echo_;
    return words;
  }
  std::uint16_t echo_ = 0;
  UnitModel model_;
  RegisterServer model_server_{model_};
};

LinkOptions hurried(const LinkAddress& address, const std::atomic<bool>& cancelled) {
  LinkTiming timing = timing_of(address);
  timing.response_timeout = 100ms;
  timing.byte_timeout = 5ms;
  timing.quiet_time = 0ms;
  timing.tries = 2;
  return {&cancelled, timing};
}

void ask(UnitClient& unit, std::uint8_t choice) {
  switch (choice % 12) {
    case 0:
      return judge(unit.identity());
    case 1:
      return judge(unit.status());
    case 2:
      return judge(unit.monitor());
    case 3:
      return judge(unit.event_blocks(8));
    case 4:
      return judge(unit.read_memory(kBankA.first, 500));
    case 5:
      return judge(unit.upload_image(noise_image(900)));
    case 6:
      return judge(unit.begin_staging(StagingFrom::active));
    case 7:
      return judge(unit.output_compensation(Axis::X, 5.0, true));
    case 8:
      return judge(unit.check_memory(kBankA.first, 100));
    case 9:
      return judge(unit.arm("271828"));
    case 10:
      return judge(unit.write_memory(kSystemRam.first, noise_image(300)));
    default:
      return judge(unit.test_datum(Axis::X, 10ms));
  }
}

void talk(FuzzedBytes input) {
  static ModbusServer server = ModbusServer::on_tcp({}).value();
  Liar liar;
  const std::uint8_t choice = input.byte();
  liar.input = input;
  std::atomic<bool> over{false};
  std::thread unit([&] {
    while (!over) (void)server.serve_ready(liar, 1ms);
  });
  {
    auto link = Link::open(server.address(), hurried(server.address(), liar.cancelled));
    check(link.has_value());
    UnitClient client(std::move(*link), {7, "fuzz", (choice & 0x40) != 0 ? "271828" : ""});
    for (int k = 0; k < 3 && !liar.cancelled; ++k) ask(client, static_cast<std::uint8_t>(choice + 5 * k));
  }
  over = true;
  unit.join();
}

/// @param read, write  of one type, both ways
template <class Read>
void comes_back(const Registers& words, Read read) {
  const auto value = read(words);
  if (!value) return check(!value.error().message.empty());
  const auto again = read(registers_of(*value, words.front()));
  check(again.has_value() && *again == *value);
}

void decode(FuzzedBytes input) {
  const auto words_of = [&](const Block& block) { return input.words(block.count); };
  switch (input.byte() % 13) {
    case 0:
      return comes_back(words_of(kIdentity), value_in<Identity>);
    case 1:
      return comes_back(words_of(kStatus), value_in<UnitStatus>);
    case 2:
      return comes_back(words_of(kMonitor), value_in<MonitorSample>);
    case 3:
      return comes_back(words_of(kCommandResult), value_in<CommandResult>);
    case 4:
      return comes_back(words_of(kWindowAck), value_in<WindowAck>);
    case 5:
      return comes_back(words_of(kSession), value_in<SessionState>);
    case 6:
      return comes_back(words_of(kEvents), value_in<EventPage>);
    case 7:
      return comes_back(words_of(kActiveMap), value_in<ActiveMap>);
    case 8:
      return comes_back(words_of(kWindowOpen), value_in<WindowOpen>);
    case 9:
      return comes_back(words_of(kSessionOpen), value_in<SessionOpen>);
    case 11:
      return comes_back(words_of(kArmAnswer), value_in<ArmAnswer>);
    case 10: {
      UnitStatus status;
      return judge(take_pointers(words_of(kPointers), status));
    }
    default: {
      const auto command = value_in<Command>(words_of(kCommand));
      return judge(command);
    }
  }
}

}  // namespace

/// The first byte chooses between whole calls over a connection, which are slow, and the reading of one block.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedBytes input(data, size);
  if ((input.byte() & 0x1F) == 0)
    talk(input);
  else
    decode(input);
  return 0;
}
