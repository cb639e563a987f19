#include "devices/sensor.hpp"

namespace ecs::devices {
namespace {

constexpr std::chrono::milliseconds kAtOnce{0};
constexpr int kMostAtOnce = 256;  ///< reports taken in one go, however fast a device sends

}  // namespace

void Sensor::take(const std::vector<Bytes>& replies, double now_s) {
  const Values values = values_in(port_.device(), replies);
  if (values.empty()) return;
  values_ = values;
  taken_s_ = now_s;
  ++answers_;
}

/// A device that sends by itself: its last report counts.
void Sensor::listen(double now_s) {
  for (int k = 0; k < kMostAtOnce; ++k) {
    const auto report = port_.read(kAtOnce);
    if (!report) return;
    take({*report}, now_s);
  }
}

void Sensor::ask(double now_s) {
  for (int k = 0; k < kMostAtOnce && port_.read(kAtOnce); ++k) continue;  // replies that came too late
  due_s_ = now_s + every_s_;
  replies_.clear();
  if (port_.device().report.feature) {
    if (!port_.device().report.poll.empty() && !port_.poll()) return;
    if (auto report = port_.feature()) replies_.push_back(std::move(*report));
    return finish(now_s);
  }
  if (!port_.poll()) return;
  waiting_ = true;
  give_up_s_ = now_s + port_.device().report.timeout_ms * 1e-3;
}

void Sensor::collect(double now_s) {
  const ReportLayout& layout = port_.device().report;
  while (auto reply = port_.read(kAtOnce)) {
    replies_.push_back(std::move(*reply));
    give_up_s_ = now_s + layout.timeout_ms * 1e-3 / 4.0;
    if (static_cast<int>(replies_.size()) >= layout.replies) return finish(now_s);
  }
  if (now_s >= give_up_s_) finish(now_s);
}

void Sensor::finish(double now_s) {
  waiting_ = false;
  const int before = answers_;
  take(replies_, now_s);
  silent_ = answers_ == before ? silent_ + 1 : 0;
}

void Sensor::attend(double now_s) {
  if (!port_.present()) return;
  if (!polled()) return listen(now_s);
  if (!waiting_ && now_s >= due_s_) ask(now_s);
  if (waiting_) collect(now_s);
}

PortChange Sensor::look(double now_s) {
  const PortChange change = port_.look(now_s);
  if (change == PortChange::lost) values_.clear();
  if (change == PortChange::back) {
    waiting_ = false;
    due_s_ = -1e9;
  }
  return change;
}

Values Sensor::values(double now_s, double most_age_s) const {
  return now_s - taken_s_ <= most_age_s ? values_ : Values();
}

}  // namespace ecs::devices
