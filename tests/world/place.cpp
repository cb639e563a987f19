#include "tests/world/place.hpp"

#include <utility>

#include "base/random.hpp"
#include "core/bytes.hpp"
#include "core/memory_image.hpp"

namespace ecs::world {
namespace {

using protocol::Registers;

constexpr std::uint8_t kRead = 3, kReadInput = 4, kWriteOne = 6, kWriteMany = 16, kWriteAndRead = 23;
constexpr std::uint8_t kIllegalFunction = 1, kIllegalValue = 3;
const std::filesystem::path kBattery = "battery";
/// A changed memory is on disk at the latest after so long (ecs_emulator/workshop/serve.cpp).
constexpr std::chrono::milliseconds kKeepDelay{500};

std::uint16_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

std::optional<Registers> words(std::span<const std::uint8_t> pdu, std::size_t count_at) {
  const std::size_t count = word_at(pdu, count_at);
  if (count == 0 || pdu.size() != count_at + 3 + 2 * count || pdu[count_at + 2] != 2 * count) return std::nullopt;
  Registers values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(word_at(pdu, count_at + 3 + 2 * i));
  return values;
}

}  // namespace

Bytes answered(std::span<const std::uint8_t> pdu, protocol::RegisterHandler& handler) {
  const auto refused = [&](std::uint8_t code) { return Bytes{static_cast<std::uint8_t>(pdu[0] | 0x80U), code}; };
  const auto read = [&](std::uint16_t first, std::uint16_t count) {
    if (count == 0 || count > protocol::kMostRead) return refused(kIllegalValue);
    const auto values = handler.read(first, count);
    if (!values) return refused(static_cast<std::uint8_t>(values.error()));
    Bytes reply{pdu[0], static_cast<std::uint8_t>(2 * count)};
    for (const std::uint16_t value : *values) {
      reply.push_back(static_cast<std::uint8_t>(value >> 8));
      reply.push_back(static_cast<std::uint8_t>(value & 0xFF));
    }
    return reply;
  };
  if (pdu.empty()) return {};
  const std::size_t least = pdu[0] == kWriteAndRead ? 12 : pdu[0] == kWriteMany ? 8 : 5;
  if (pdu.size() < least) return refused(kIllegalFunction);
  switch (pdu[0]) {
    case kRead:
    case kReadInput:
      return read(word_at(pdu, 1), word_at(pdu, 3));
    case kWriteOne: {
      const std::uint16_t value = word_at(pdu, 3);
      const auto done = handler.write(word_at(pdu, 1), std::span(&value, 1));
      return done ? Bytes(pdu.begin(), pdu.begin() + 5) : refused(static_cast<std::uint8_t>(done.error()));
    }
    case kWriteMany: {
      const auto values = words(pdu, 3);
      if (!values) return refused(kIllegalValue);
      const auto done = handler.write(word_at(pdu, 1), *values);
      return done ? Bytes(pdu.begin(), pdu.begin() + 5) : refused(static_cast<std::uint8_t>(done.error()));
    }
    case kWriteAndRead: {
      const auto values = words(pdu, 7);
      if (!values) return refused(kIllegalValue);
      const auto done = handler.write(word_at(pdu, 5), *values);
      return done ? read(word_at(pdu, 1), word_at(pdu, 3)) : refused(static_cast<std::uint8_t>(done.error()));
    }
    default:
      return refused(kIllegalFunction);
  }
}

Result<std::string> Disk::content(const std::filesystem::path& path) {
  if (now_) return *now_;
  return problem_at(path.string(), 0, 0, "no such file");
}

bool Disk::process_goes_on() {
  if (!ends_after) return true;
  if (*ends_after > 0) {
    --*ends_after;
    return true;
  }
  ends_after = -1;
  return false;
}

Result<void> Disk::may_write(const std::filesystem::path& path) {
  if (writes_fail == 0) return {};
  --writes_fail;
  return problem(ProblemKind::output, path.string() + ": cannot write: No space left on device");
}

Result<void> Disk::keeps_name(const std::filesystem::path& path) {
  if (!process_goes_on()) return {};
  if (names_fail > 0) {
    --names_fail;
    return problem(ProblemKind::output, path.string() + ": cannot write: Input/output error");
  }
  if (!lies) lasting_ = now_;
  return {};
}

void Disk::was_written(const std::filesystem::path&, std::string_view content) {
  if (process_goes_on()) now_ = content;
}

bool Disk::lose_power(Random& random) {
  torn_ = false;
  bool taken_back = false;
  if (now_ == lasting_) return false;
  if (lies && now_ && lasting_ && now_->size() == lasting_->size()) {
    constexpr std::size_t kSector = 512;
    for (std::size_t at = 0; at < now_->size(); at += kSector)
      if (chance(random, 0.5)) now_->replace(at, kSector, *lasting_, at, kSector);
    torn_ = true;
  } else if (chance(random, 0.5)) {
    now_ = lasting_;
    taken_back = true;
    torn_ = lies;  // taken back beyond what anybody was told, as far as to a memory without a map
  }
  lasting_ = now_;
  return taken_back;
}

/// Between the register server and the unit.
class Place::Port final : public protocol::UnitPort {
 public:
  explicit Port(Place& place) : place_(place) {}
  protocol::Identity identity() override { return unit().identity(); }
  protocol::UnitStatus status() override { return unit().status(); }
  protocol::MonitorSample monitor() override { return unit().monitor(); }
  protocol::UnitClock clock() override { return unit().clock(); }
  void host_armed() override { unit().host_armed(); }
  void show_code(const std::string& code) override { place_.code_ = code; }
  protocol::ImageDigest active_digest() override { return unit().active_digest(); }
  std::optional<std::uint64_t> take_outputs_ended() override { return unit().take_outputs_ended(); }
  protocol::UnitError read_memory(Address address, std::span<std::uint8_t> out) override {
    return unit().read_memory(address, out);
  }
  protocol::UnitError may_write(Address address, std::uint32_t bytes) override {
    return unit().may_write(address, bytes);
  }
  protocol::UnitError write_memory(Address address, std::span<const std::uint8_t> bytes) override {
    place_.looks_.before_write(address, bytes);
    return unit().write_memory(address, bytes);
  }
  protocol::CommandResult begin(const protocol::Command& command) override {
    place_.looks_.before_command(command);
    protocol::Command taken = command;
    if (place_.broken_ == UnitBreak::commits_unchecked && command.code == protocol::CommandCode::commit_staged)
      agree_with_memory(taken);
    auto result = unit().begin(taken);
    place_.looks_.after_command(command, result);
    return result;
  }
  protocol::CommandResult progress() override { return unit().progress(); }

 private:
  emulator::Unit& unit() { return *place_.unit_; }
  /// The unit then commits whatever it holds: the digest of the command and the check of the image are made to agree.
  void agree_with_memory(protocol::Command& command) {
    emulator::UnitMemory& memory = unit().memory();
    const Address bank = emulator::inactive_bank(memory);
    if (!memory.exists(bank, command.length) || command.length < kPrefixBytes) return;
    const ByteView staged = memory.view(bank, command.length);
    Bytes image(staged.begin(), staged.end());
    if (load_big<std::uint32_t>(image, prefix_at::magic) == kImageMagic &&
        load_big<std::uint32_t>(image, prefix_at::total_bytes) == image.size()) {
      seal_image(image);
      memory.write(bank, image);
    }
    command.digest = protocol::short_digest(protocol::digest_of(image));
  }
  Place& place_;
};

Place::Place(Schedule& schedule, Random& random, Looks looks, UnitBreak broken, std::string code, bool automatic)
    : schedule_(schedule),
      random_(random),
      looks_(std::move(looks)),
      broken_(broken),
      code_(std::move(code)),
      automatic_(automatic) {
  start_process();
}
Place::~Place() = default;

Bytes Place::active() const {
  if (unit_ == nullptr) return {};
  const auto image = emulator::active_image(unit_->memory());
  if (!image) return {};
  const ByteView bytes = unit_->memory().view(image->first, image->commit.image_bytes);
  return {bytes.begin(), bytes.end()};
}

std::uint32_t Place::commit() const {
  if (unit_ == nullptr) return 0;
  const auto image = emulator::active_image(unit_->memory());
  return image ? image->commit.sequence : 0;
}

std::uint64_t Place::version() const { return unit_ == nullptr ? 0 : unit_->memory().version(); }

void Place::catch_up() {
  if (!running()) return;
  const double until_s = std::chrono::duration<double>(schedule_.now() - on_since_).count();
  while (passed_s_ < until_s && running()) {
    drives_ = unit_->tick({});
    passed_s_ += unit_->period_s();
  }
  if (unit_->memory().changed() && schedule_.now() - kept_ > kKeepDelay) {
    kept_ = schedule_.now();
    (void)keep(unit_->memory(), kBattery);
  }
}

Bytes Place::take(std::span<const std::uint8_t> pdu, std::uint64_t connection, const std::string& origin) {
  if (!running()) return {};
  catch_up();
  server_->arrives_on(connection, origin);
  Bytes reply = answered(pdu, *server_);
  if (!running() || disk.process_ended()) reply.clear();
  return reply;
}

void Place::supply(bool on) {
  if (unit_ == nullptr) return;
  catch_up();
  unit_->power(on);
  drives_ = {};
  on_since_ = schedule_.now();
  passed_s_ = 0.0;
}

void Place::keep_battery() { (void)keep(unit_->memory(), kBattery); }

bool Place::end_process(bool power) {
  server_.reset();
  port_.reset();
  unit_.reset();
  drives_ = {};
  disk.ends_after.reset();
  return power && disk.lose_power(random_);
}

bool Place::start_process() {
  emulator::UnitSettings settings;
  settings.link = automatic_ ? emulator::LinkSense::automatic : emulator::LinkSense::integrate;
  unit_ = std::make_unique<emulator::Unit>(settings);
  unit_->on_commit([this] {
    if (looks_.before_keep) looks_.before_keep();
    return broken_ == UnitBreak::answers_unkept || keep(unit_->memory(), kBattery).has_value();
  });
  const bool restored = restore(unit_->memory(), kBattery).has_value();
  if (!restored) disk.remove();
  // `ecs-emulator serve` does not start where the file cannot be written; then somebody starts it again.
  while (!keep(unit_->memory(), kBattery)) {
  }
  kept_ = schedule_.now();
  port_ = std::make_unique<Port>(*this);
  server_ = std::make_unique<protocol::RegisterServer>(*port_, protocol::ArmCode{code_, true});
  supply(true);
  return restored;
}

}  // namespace ecs::world
