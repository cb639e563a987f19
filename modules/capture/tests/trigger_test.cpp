#include "modules/capture/port.hpp"
#include "tests/support/test.hpp"

namespace ecs::devices {
namespace {

int presses_of(const std::vector<std::pair<double, bool>>& levels, int debounce_ms = 30) {
  PressFilter filter(debounce_ms);
  int presses = 0;
  for (const auto& [time_s, held] : levels) presses += filter.pressed(held, time_s) ? 1 : 0;
  return presses;
}

TEST_CASE("a contact that bounces at both ends is one press") {
  CHECK(presses_of({{0.0, true}, {0.004, false}, {0.008, true}, {0.5, false}, {0.503, true}, {0.506, false}}) == 1);
}

TEST_CASE("two presses that are further apart than the debounce time are two") {
  CHECK(presses_of({{0.0, true}, {0.1, false}, {0.2, true}, {0.3, false}}) == 2);
  CHECK(presses_of({{0.0, true}, {0.1, false}, {0.2, true}, {0.3, false}}, 150) == 1);
}

TEST_CASE("a device that repeats its state all the while presses once") {
  CHECK(presses_of({{0.0, false}, {0.01, true}, {0.02, true}, {0.03, true}, {0.1, false}, {0.11, false}}) == 1);
}

/// `presses` of 0.3 s, half a second apart; `report` says what is sent while held or not.
template <class Make>
std::vector<TimedReport> pressed(int presses, const Make& report) {
  std::vector<TimedReport> reports;
  for (int k = 0; k < presses; ++k) {
    reports.push_back({k * 0.8, report(true, 2 * k)});
    reports.push_back({k * 0.8 + 0.3, report(false, 2 * k + 1)});
  }
  return reports;
}

TEST_CASE("learning finds the bit, its active level and the length of the report") {
  const auto high = must(learned(pressed(3,
                                         [](bool held, int) {
                                           return Bytes{0, held ? std::uint8_t{8} : std::uint8_t{0}, 7};
                                         }),
                                 3, false));
  CHECK(high.trigger.byte == 1);
  CHECK(high.trigger.mask == 0x08);
  CHECK(high.trigger.active_high);
  CHECK(high.report_bytes == 3);
  const auto low = must(learned(
      pressed(4, [](bool held, int) { return Bytes{held ? std::uint8_t{0xFE} : std::uint8_t{0xFF}}; }), 4, false));
  CHECK(low.trigger.mask == 0x01);
  CHECK(!low.trigger.active_high);
}

TEST_CASE("learning takes a key code of several bits as one mask") {
  const auto key = must(learned(pressed(3,
                                        [](bool held, int) {
                                          return Bytes{0, 0, held ? std::uint8_t{0x05} : std::uint8_t{0}};
                                        }),
                                3, false));
  CHECK(key.trigger.byte == 2);
  CHECK(key.trigger.mask == 0x05);
}

TEST_CASE("learning gives the number of the report and ignores other reports") {
  auto reports = pressed(3, [](bool held, int) { return Bytes{2, held ? std::uint8_t{1} : std::uint8_t{0}}; });
  for (int k = 0; k < 5; ++k) reports.push_back({0.01 * k, Bytes{1, 0x55}});
  std::sort(reports.begin(), reports.end(), [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  const auto found = must(learned(reports, 3, true));
  CHECK(found.report_number == 2);
  CHECK(found.trigger.byte == 1);
}

TEST_CASE("learning counts a bouncing contact once and asks for twice its bounce") {
  std::vector<TimedReport> reports;
  for (int k = 0; k < 3; ++k)
    for (const double begin : {k * 1.0, k * 1.0 + 0.4})
      for (int bounce = 0; bounce < 5; ++bounce) {
        const bool held = (begin == k * 1.0) == (bounce % 2 == 0);
        reports.push_back({begin + bounce * 0.005, Bytes{held ? std::uint8_t{1} : std::uint8_t{0}}});
      }
  const auto found = must(learned(reports, 3, false));
  CHECK(found.trigger.mask == 1);
  CHECK(found.bounce_ms == Approx(20.0));
  CHECK(found.trigger.debounce_ms == 40);
}

TEST_CASE("learning refuses a counter that moves with the button, and says which bits they are") {
  const auto found = must_fail(
      learned(pressed(3,
                      [](bool held, int n) {
                        return Bytes{held ? std::uint8_t{1} : std::uint8_t{0}, static_cast<std::uint8_t>(n + 1)};
                      }),
              3, false));
  CHECK(found.kind == ProblemKind::refused);
  CHECK(found.message.find("bit 0 of byte 0 and bit 0 of byte 1 changed together") == 0);
}

TEST_CASE("learning refuses two buttons that were pressed as often, one after the other") {
  std::vector<TimedReport> reports;
  for (int k = 0; k < 3; ++k) {
    const double at = k * 1.0;
    reports.push_back({at, Bytes{1}});
    reports.push_back({at + 0.2, Bytes{0}});
    reports.push_back({at + 0.5, Bytes{2}});
    reports.push_back({at + 0.7, Bytes{0}});
  }
  CHECK(contains(must_fail(learned(reports, 3, false)).message, "but not together"));
}

TEST_CASE("learning says how often a bit changed when that is not what was asked for") {
  const auto found = must_fail(
      learned(pressed(2, [](bool held, int) { return Bytes{held ? std::uint8_t{1} : std::uint8_t{0}}; }), 3, false));
  CHECK(found.message.find("no bit changed 6 times") == 0);
  CHECK(contains(found.message, "bit 0 of byte 0 4 times"));
  CHECK(learned({}, 3, false).error().message.find("the device sent no data") == 0);
}

}  // namespace
}  // namespace ecs::devices
