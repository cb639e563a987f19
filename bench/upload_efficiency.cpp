// How much of a serial link an upload uses: bytes of the image ÷ (baud/10 × time), from the first look at the unit to
// the map confirmed as active, on a pseudo-terminal paced like a wire: 10 bits a byte both ways and the silent gaps.
// The yardstick is plain function 16 with 123 registers: 255 + 8 bytes and two gaps for 246 bytes of payload.
//   upload_efficiency [--short]    exit code 1 if an aim is missed; --short: at 9,600 baud only, less noise, and the
// time that bytes and gaps take on the wire instead of the clock's, so that a busy computer changes nothing
#include <atomic>
#include <cstring>
#include <random>
#include <thread>
#include <vector>

#include <fmt/core.h>

#include "base/file.hpp"
#include "ecs_emulator/unit/unit.hpp"
#include "laser/map/image.hpp"
#include "protocol/client/client.hpp"
#include "protocol/server/server.hpp"

namespace {

using namespace ecs;
using namespace ecs::protocol;
using Image = std::vector<std::uint8_t>;

constexpr const char* kSerialNumber = "MCM-0107";
constexpr const char* kCode = "271828";
constexpr std::uint8_t kModules = 2;  ///< a module holds 32,000 values, 64 KiB of them a few more
constexpr const char* kMillMap = "tests/data/memory/mill_format_1.image";

/// What the programs of a host share.
class SharedSecret : public SecretStore {
 public:
  std::optional<Secret> secret_of(const std::string&) override { return secret_; }
  void keep(const std::string&, const Secret& secret) override { secret_ = secret; }

 private:
  std::optional<Secret> secret_;
};

/// A unit in integration mode on a paced line, served by a thread of its own; the host was armed before.
class Bench {
 public:
  Bench(int baud, bool by_clock)
      : by_clock_(by_clock), server_(ModbusServer::on_pty({{}, baud, true, 1}).value()), address_(server_.address()) {
    thread_ = std::thread([this] {
      emulator::UnitSettings settings;
      settings.serial_number = kSerialNumber;
      settings.memory_modules = kModules;
      settings.link = emulator::LinkSense::integrate;
      emulator::Unit unit(settings);
      unit.power(true);
      while (unit.mode() != UnitMode::integration) static_cast<void>(unit.tick({}));
      RegisterServer registers(unit, {kCode, true});
      while (!ended_) server_.serve_ready(registers, std::chrono::milliseconds(20));
    });
    auto client = UnitClient::connect(address_, {}, {1, "bench", {}, secret_});
    if (!client || !client->arm(kCode)) fmt::print(stderr, "the unit was not armed\n");
  }
  Bench(const Bench&) = delete;
  ~Bench() {
    ended_ = true;
    thread_.join();
  }

  struct Sent {
    double seconds = 0.0;
    bool done = false;
    UploadReport report;
    LinkStatistics statistics;
  };
  /// @param cut_at  the transfer is cancelled when so much of the image has arrived; above 1: never
  Sent send(const Image& image, double cut_at = 2.0) const {
    std::atomic<bool> cancelled{false};
    LinkOptions options;
    options.cancelled = &cancelled;
    const auto begun = std::chrono::steady_clock::now();
    auto client = UnitClient::connect(address_, options, {1, "bench", kCode, secret_});
    const auto done = client.and_then([&](UnitClient& unit) {
      return unit.upload_image(image, [&](const Progress& progress) {
        if (static_cast<double>(progress.bytes_done) >= cut_at * static_cast<double>(progress.bytes_total))
          cancelled = true;
      });
    });
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun;
    const LinkStatistics statistics = client ? client->link().statistics() : LinkStatistics{};
    if (!done && cut_at > 1.0) fmt::print("{}\n", to_text(done.error()));
    const double seconds = by_clock_ ? spent.count() : wire_seconds(statistics);
    return {seconds, done.has_value(), done.value_or(UploadReport{}), statistics};
  }
  [[nodiscard]] const LinkAddress& address() const { return address_; }

 private:
  [[nodiscard]] double wire_seconds(const LinkStatistics& of) const {
    const LinkTiming timing = timing_of(address_);
    const std::chrono::duration<double> byte_s = timing.byte_time;
    const std::chrono::duration<double> gap_s = timing.frame_gap;
    return static_cast<double>(of.bytes_sent + of.bytes_received) * byte_s.count() +
           2.0 * static_cast<double>(of.requests) * gap_s.count();
  }
  bool by_clock_;
  ModbusServer server_;
  LinkAddress address_;
  std::shared_ptr<SecretStore> secret_ = std::make_shared<SharedSecret>();
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

double plain_efficiency(const LinkTiming& timing) {
  constexpr double kPayload = 246.0;
  constexpr double kWireBytes = 255.0 + 8.0;
  const std::chrono::duration<double> byte_s = timing.byte_time;
  const std::chrono::duration<double> gap_s = timing.frame_gap;
  return kPayload * byte_s.count() / (kWireBytes * byte_s.count() + 2.0 * gap_s.count());
}

/// One line of the answer; false if the aim is missed.
bool say(int baud, const char* what, const Bench::Sent& sent, double ratio, const char* aim, bool good) {
  const LinkStatistics& of = sent.statistics;
  fmt::print(
      "{:>7} baud  {:<21} {:>6} of {:>6} bytes {:>7.2f} s  {:>6.3f}  aim {}{}  ({} requests, {} bytes on the wire)\n",
      baud, what, sent.report.bytes_sent, sent.report.bytes, sent.seconds, ratio, aim, good ? "" : "  MISSED",
      of.requests, of.bytes_sent + of.bytes_received);
  std::fflush(stdout);
  return good;
}

Image mill_map() {
  const auto content = read_file(kMillMap);
  if (!content) return {};
  const Image old(content->begin(), content->end());
  const auto parameters = ImageView(old).parameters();
  const auto image = laser::with_identity(
      old, {kSerialNumber, "moving column mill", parameters ? configuration_hash(*parameters) : 0});
  return image.value_or(Image{});
}

/// A map of this many bytes whose every value is noise.
Image noise_map(std::uint32_t bytes) {
  const std::uint32_t values = (bytes - 1024) / 2;
  const ImagePlan plan{1, values, bytes - directory_offset() - kEntryBytes - 2 * values};
  Image image(image_bytes(plan));
  std::mt19937 random(1);
  begin_image(image, plan);
  UnitParameters parameters;
  parameters.memory_modules = kModules;
  write_parameters(image, parameters);
  write_identity(image, {kSerialNumber, "noise", configuration_hash(parameters)});
  write_entry(image, 0, {Component::EXX, Approach::unknown, false, 0, values, 0.0, 1.0, 0.01});
  for (std::uint32_t i = 0; i < values; ++i) write_value(image, i, static_cast<std::int16_t>(random()));
  write_header(image, std::string(plan.header_bytes, '#'));
  seal_image(image);
  return image;
}

Image one_value_changed(Image image) {
  const std::uint32_t middle = ImageView(image).value_count() / 2;
  write_value(image, middle, static_cast<std::int16_t>(ImageView(image).value_counts(middle) + 1));
  seal_image(image);
  return image;
}

bool measure(int baud, std::uint32_t noise_bytes, bool by_clock) {
  const Image map = mill_map(), noise = noise_map(noise_bytes);
  if (map.empty()) {
    fmt::print("{}: no map to send; run it in the folder of the sources\n", kMillMap);
    return false;
  }
  const Bench bench(baud, by_clock);
  const double plain = plain_efficiency(timing_of(bench.address()));
  const auto efficiency = [&](const Image& image, const Bench::Sent& sent) {
    return static_cast<double>(image.size()) / (baud / 10.0 * sent.seconds) / plain;
  };
  const auto first = bench.send(map);
  bool good = say(baud, "first send", first, efficiency(map, first), ">= 1.3 of plain FC16",
                  first.done && efficiency(map, first) >= 1.3);
  const auto part = [&](const char* what, const Bench::Sent& sent, double most) {
    const double ratio = sent.seconds / first.seconds;
    good =
        say(baud, what, sent, ratio, fmt::format("<= {} of first", most).c_str(), sent.done && ratio <= most) && good;
  };
  part("the same again", bench.send(map), 0.1);
  part("one value changed", bench.send(one_value_changed(map)), 0.3);
  const Bench other(baud, by_clock);
  static_cast<void>(other.send(map, 0.5));
  part("cut at half, resumed", other.send(map), 0.65);
  const auto random = Bench(baud, by_clock).send(noise);
  good = say(baud, "noise", random, efficiency(noise, random), ">= 0.85 of plain FC16",
             random.done && efficiency(noise, random) >= 0.85) &&
         good;
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "--short") == 0) return measure(9600, 16'384, false) ? 0 : 1;
  bool good = true;
  for (const int baud : {9600, 38'400, 115'200}) good = measure(baud, 65'536, true) && good;
  return good ? 0 : 1;
}
