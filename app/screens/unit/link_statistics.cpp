#include "app/screens/unit/link_statistics.hpp"

#include <fmt/format.h>

namespace ecs::app {
namespace {

constexpr double kFar = 20.0;   ///< times the mean
constexpr double kMuch = 0.01;  ///< of the requests: more than this is worth a look at the cable

std::string count(std::uint64_t n) { return fmt::format("{}", n); }

double share(std::uint64_t n, std::uint64_t of) {
  return of == 0 ? 0.0 : static_cast<double>(n) / static_cast<double>(of);
}

StatisticsRow trouble(const char* name, std::uint64_t n, std::uint64_t of, const char* meaning) {
  return {name, count(n), n == 0 ? "" : meaning,
          n == 0 ? Tone::good : (share(n, of) > kMuch ? Tone::bad : Tone::warning)};
}

}  // namespace

std::vector<StatisticsRow> statistics_rows(const WatchedUnit& unit) {
  const protocol::LinkStatistics& s = unit.statistics;
  return {{"requests", count(s.requests), "", Tone::plain},
          {"replies", count(s.replies), "", Tone::plain},
          trouble("retries", s.retries, s.requests, "asked again: see the rows below for why"),
          trouble("time-outs", s.timeouts, s.requests, "no answer came: plugs, cable, unit off or busy"),
          trouble("CRC errors", s.crc_errors, s.requests, "garbled: shield, ground, cable length, parity"),
          trouble("stale replies", s.stale_replies, s.requests, "too late: slow converter or network"),
          trouble("exceptions", s.exceptions, s.requests, "the unit refused a request: LOG has its words"),
          {"bytes sent", count(s.bytes_sent), "", Tone::plain},
          {"bytes received", count(s.bytes_received), "", Tone::plain},
          {"mean round trip", s.replies == 0 ? "-" : fmt::format("{:.1f} ms", s.mean_round_trip_ms()), "", Tone::plain},
          {"worst round trip", s.replies == 0 ? "-" : fmt::format("{:.1f} ms", s.worst_round_trip_ms),
           s.replies > 0 && s.worst_round_trip_ms > kFar * s.mean_round_trip_ms()
               ? "far above the mean: retries or a busy computer"
               : "",
           Tone::plain},
          {"samples a second", fmt::format("{:.1f}", unit.per_second), "while this page is open, as fast as it goes",
           Tone::plain},
          trouble("times lost", unit.times_lost, 0, "was opened again: unit off or plug pulled?")};
}

StatisticsRow judgement(const WatchedUnit& unit) {
  const protocol::LinkStatistics& s = unit.statistics;
  if (unit.lent) return {"", "", "the link is in use by the doctor or a verb", Tone::warning};
  if (!unit.open) return {"", "", unit.problem.empty() ? "no link is open yet" : unit.problem, Tone::bad};
  if (s.requests < 20) return {"", "", "too few requests to judge the link yet", Tone::faint};
  if (share(s.crc_errors, s.requests) > kMuch)
    return {"", "", "many garbled answers: check shield, ground, length of the cable, and the parity", Tone::bad};
  if (share(s.foreign_replies, s.requests) > kMuch)
    return {"", "", "many answers to another host's requests: one host at a time may use the link", Tone::bad};
  if (share(s.stale_replies, s.requests) > kMuch)
    return {"", "", "many late answers: a slow converter or network; lower the latency timer of a USB adapter",
            Tone::bad};
  if (share(s.timeouts, s.requests) > kMuch)
    return {"", "", "many requests without an answer: check plugs and cable", Tone::bad};
  if (s.retries > 0) return {"", "", "a good link: a few requests had to be repeated, nothing was lost", Tone::good};
  return {"", "", "a clean link: every request was answered at once", Tone::good};
}

}  // namespace ecs::app
