#include "commissioning/utility/unit_view.hpp"

#include <ctime>
#include <filesystem>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "core/fault.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {
namespace {

using Clock = std::chrono::steady_clock;

/// Ages are shown in seconds, below one not at all.
int shown_age(double age_s) { return age_s < 1.0 ? 0 : static_cast<int>(age_s); }

}  // namespace

std::string refusal_in(UnitMode mode) {
  if (mode == UnitMode::integration) return {};
  if (mode == UnitMode::halted) return "The unit is halted after a fatal fault: only switching it off and on helps.";
  return fmt::format("The unit is {} and does this in integration mode only: m in DISPLAY ECS STATUS (F3) switches it.",
                     ecs::name_of(mode));
}

double seconds_since(std::chrono::steady_clock::time_point moment) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - moment).count();
}

bool UnitView::look(const UnitConnection& connection) {
  const int age_before = shown_age(age_s);
  const bool fresh_before = fresh;
  const std::uint64_t now = connection.changes();
  if (now != changes || !sample) {
    watched = connection.snapshot();
    const auto newest = connection.newest();
    fresh = newest.has_value();
    if (newest && watched.newest_at >= taken_at_) take(*newest, watched.newest_at);
  }
  age_s = sample ? seconds_since(taken_at_) : 0.0;
  const bool changed = now != changes || fresh != fresh_before || shown_age(age_s) != age_before;
  changes = now;
  return changed;
}

void UnitView::take(const protocol::MonitorSample& seen) { take(seen, Clock::now()); }

void UnitView::take(const protocol::MonitorSample& seen, Clock::time_point at) {
  const bool was_away = watched.times_lost != times_lost_;  // a busy computer alone makes no unit late
  if (sample && began_anew(*sample, seen, was_away ? at - taken_at_ : Clock::duration::zero())) ++restarts;
  times_lost_ = watched.times_lost;
  sample = seen;
  fresh = true;
  taken_at_ = at;
  age_s = 0.0;
}

bool began_anew(const protocol::MonitorSample& before, const protocol::MonitorSample& after, Clock::duration passed) {
  const auto had_run_us = static_cast<double>(before.unit_time_us);
  const auto now_us = static_cast<double>(after.unit_time_us);
  const double passed_us = std::chrono::duration<double, std::micro>(passed).count();
  return now_us < had_run_us || had_run_us + passed_us - now_us > had_run_us / 2.0;
}

std::vector<Axis> UnitView::axes() const {
  std::vector<Axis> axes;
  for (const Axis a : kAllAxes)
    if (!watched.identity || watched.identity->axis_present[index_of(a)]) axes.push_back(a);
  return axes;
}

const protocol::AxisSample* UnitView::axis(Axis which) const {
  return sample && sample->axes[index_of(which)].present ? &sample->axes[index_of(which)] : nullptr;
}

std::string age_text(double age_s) { return age_s < 1.0 ? "" : fmt::format("seen {} s ago", shown_age(age_s)); }

void say_failed(Message& message, const Problem& problem, bool given_up) {
  const bool unit_knows = problem.message.find(protocol::kStopNotReceived) == std::string::npos;
  if (given_up && unit_knows)
    message.say("Given up.", Tone::warning);
  else
    message.say(problem);
}

std::string file_name_now(const std::string& stem, const std::string& extension) {
  return fmt::format("{}-{:%Y%m%d-%H%M%S}{}", stem, fmt::localtime(std::time(nullptr)), extension);
}

bool file_is_there(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

}  // namespace ecs::commissioning
