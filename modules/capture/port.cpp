#include "modules/capture/port.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

namespace ecs::devices {
namespace {

constexpr double kLookEvery_s = 0.5;

bool fits(const DeviceMatch& match, const HidIdentity& one) {
  const bool id = std::ranges::any_of(match.ids, [&](const DeviceMatch::Ids& ids) {
    return ids.vendor_id == one.vendor_id && ids.product_id == one.product_id;
  });
  return id && (!match.serial || *match.serial == one.serial) && (!match.path || *match.path == one.path) &&
         (!match.interface || one.interface < 0 || *match.interface == one.interface) &&
         (!match.usage_page || one.usage_page == 0 || *match.usage_page == one.usage_page);
}

std::string list_of(const std::vector<HidIdentity>& devices) {
  std::string text;
  for (const HidIdentity& one : devices) text += (text.empty() ? "" : "; ") + to_text(one);
  return text;
}

std::string wanted(const DeviceDescription& device) {
  std::string ids;
  for (const DeviceMatch::Ids& one : device.match.ids)
    ids += fmt::format("{}{:04x}:{:04x}", ids.empty() ? "" : " or ", one.vendor_id, one.product_id);
  if (device.match.serial) ids += ", serial " + *device.match.serial;
  if (device.match.path) ids += ", " + *device.match.path;
  if (device.match.interface) ids += fmt::format(", interface {}", *device.match.interface);
  return fmt::format("{} ({})", device.name, ids);
}

/// Length of the input reports to read: as described, else as the descriptor says, else the usual packet.
std::size_t bytes_of(const DeviceDescription& device, const HidIdentity& identity) {
  if (device.report.bytes != 0) return device.report.bytes;
  const auto own = identity.reports.input.find(device.report.number);
  if (own != identity.reports.input.end() && device.report.number == 0) return own->second;
  std::size_t longest = 0;
  for (const auto& entry : identity.reports.input) longest = std::max(longest, entry.second);
  return longest == 0 ? 64 : longest;
}

}  // namespace

Result<HidIdentity> matching(const DeviceDescription& device, const std::vector<HidIdentity>& present) {
  std::vector<HidIdentity> found;
  std::copy_if(present.begin(), present.end(), std::back_inserter(found),
               [&](const HidIdentity& one) { return fits(device.match, one); });
  if (found.size() == 1) return found.front();
  if (found.empty())
    return problem(ProblemKind::link, "{} is not plugged in; {}", wanted(device),
                   present.empty() ? "there is no HID device: plug it in, then check with `ecs laser devices`"
                                   : "available: " + list_of(present));
  return problem(ProblemKind::link,
                 "{} devices match {}: {}. Choose one: write its serial (or path, or interface) under "
                 "[match], or add it to the name, as in FILE.toml@SERIAL or FILE.toml@/dev/hidraw3",
                 found.size(), wanted(device), list_of(found));
}

Result<DevicePort> DevicePort::open(DeviceDescription device) {
  DevicePort port(std::move(device));
  ECS_DO(port.connect());
  return port;
}

Result<void> DevicePort::connect() {
  ECS_TRY(present, hid_devices());
  ECS_TRY(identity, matching(device_, present));
  ECS_TRY(opened, HidDevice::open(identity));
  identity_ = std::move(identity);
  report_bytes_ = bytes_of(device_, identity_);
  open_.emplace(std::move(opened));
  return {};
}

void DevicePort::lose() {
  open_.reset();
  loss_told_ = false;
  hindrance_.clear();
}

PortChange DevicePort::look(double now_s) {
  if (open_) return PortChange::none;
  if (!loss_told_) {
    loss_told_ = true;
    looked_s_ = now_s;
    return PortChange::lost;
  }
  if (now_s - looked_s_ < kLookEvery_s) return PortChange::none;
  looked_s_ = now_s;
  const auto present = hid_devices();
  if (!present || std::none_of(present->begin(), present->end(),
                               [&](const HidIdentity& one) { return fits(device_.match, one); })) {
    hindrance_.clear();
    return PortChange::none;
  }
  const auto connected = connect();
  hindrance_ = connected ? "" : connected.error().message;
  return connected ? PortChange::back : PortChange::none;
}

std::optional<Bytes> DevicePort::read(std::chrono::milliseconds timeout) {
  if (!open_) return std::nullopt;
  auto report = open_->read(report_bytes_, timeout);
  if (!report) {
    lose();
    return std::nullopt;
  }
  if (*report && device_.report.number != 0 && (**report)[0] != device_.report.number) return std::nullopt;
  return std::move(*report);
}

bool DevicePort::poll() {
  if (open_ && !open_->write(device_.report.poll_number, device_.report.poll)) lose();
  return open_.has_value();
}

std::optional<Bytes> DevicePort::feature() {
  if (!open_) return std::nullopt;
  auto report = open_->feature(device_.report.number, report_bytes_);
  if (report) return std::move(*report);
  lose();
  return std::nullopt;
}

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

/// A device that sends on its own: its last report counts.
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

bool PressFilter::pressed(bool held, double now_s) {
  const bool before = level_.value_or(false);
  level_ = held;
  if (before && !held) let_go_s_ = now_s;
  return held && !before && now_s - let_go_s_ >= debounce_s_;
}

bool Trigger::pressed(std::chrono::milliseconds timeout, double now_s) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  auto left = timeout;
  do {
    const auto report = port_.read(left);
    if (!report) return false;
    const double at_s = now_s + std::chrono::duration<double>(Clock::now() - begin).count();
    const auto held = held_in(port_.device(), *report);
    if (held && filter_.pressed(*held, at_s)) return true;
    left = timeout - std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin);
  } while (left.count() > 0);
  return false;
}

PortChange Trigger::look(double now_s) {
  const PortChange change = port_.look(now_s);
  if (change == PortChange::back) filter_.forget();
  return change;
}

namespace {

constexpr double kBounce_s = 0.06;  ///< two changes closer than this are one contact bouncing
constexpr int kLeastDebounce_ms = 20;

struct BitPlace {
  std::uint8_t number = 0;
  std::size_t byte = 0;
  int bit = 0;
  friend auto operator<=>(const BitPlace&, const BitPlace&) = default;
};

struct Step {
  double time_s = 0.0;
  bool level = false;
};

/// What one bit did: its steps with the bounces taken out, and the longest bounce.
struct Behaviour {
  bool rest = false;  ///< its last level
  std::vector<Step> steps;
  double bounce_s = 0.0;
};

std::string text_of(const BitPlace& at) {
  return at.number == 0 ? fmt::format("bit {} of byte {}", at.bit, at.byte)
                        : fmt::format("bit {} of byte {} of report {}", at.bit, at.byte, at.number);
}

std::vector<Step> raw_steps(const std::vector<Step>& levels, bool rest) {
  std::vector<Step> steps;
  bool level = rest;
  for (const Step& each : levels) {
    if (each.level == level) continue;
    level = each.level;
    steps.push_back(each);
  }
  return steps;
}

/// A burst of close steps counts by where it began and ended: an odd number is one step, an even number none.
Behaviour behaviour_of(const std::vector<Step>& levels) {
  Behaviour out;
  out.rest = levels.back().level;
  const std::vector<Step> raw = raw_steps(levels, out.rest);
  for (std::size_t begin = 0; begin < raw.size();) {
    std::size_t end = begin + 1;
    while (end < raw.size() && raw[end].time_s - raw[end - 1].time_s < kBounce_s) ++end;
    if (end - begin > 1) out.bounce_s = std::max(out.bounce_s, raw[end - 1].time_s - raw[begin].time_s);
    if ((end - begin) % 2 == 1) out.steps.push_back({raw[begin].time_s, raw[end - 1].level});
    begin = end;
  }
  return out;
}

using Bits = std::map<BitPlace, Behaviour>;

/// Every bit that ever changed.
Bits changing_bits(const std::vector<TimedReport>& reports, bool numbered) {
  std::map<BitPlace, std::vector<Step>> levels;
  for (const TimedReport& report : reports) {
    if (report.bytes.empty()) continue;
    const std::uint8_t number = numbered ? report.bytes[0] : std::uint8_t{0};
    for (std::size_t byte = numbered ? 1 : 0; byte < report.bytes.size(); ++byte)
      for (int bit = 0; bit < 8; ++bit)
        levels[{number, byte, bit}].push_back({report.time_s, (report.bytes[byte] >> bit & 1) != 0});
  }
  Bits bits;
  for (const auto& [place, steps] : levels) {
    const bool first = steps.front().level;
    if (std::ranges::all_of(steps, [&](const Step& s) { return s.level == first; })) continue;
    bits.emplace(place, behaviour_of(steps));
  }
  return bits;
}

/// The same steps at the same moments, whichever way round.
bool move_together(const Behaviour& a, const Behaviour& b) {
  if (a.steps.size() != b.steps.size()) return false;
  for (std::size_t k = 0; k < a.steps.size(); ++k)
    if (std::abs(a.steps[k].time_s - b.steps[k].time_s) > kBounce_s) return false;
  return true;
}

std::string what_changed(const Bits& bits) {
  constexpr std::size_t kMost = 8;
  std::string text;
  std::size_t shown = 0;
  for (const auto& [place, behaviour] : bits) {
    if (++shown > kMost) return text + fmt::format(", and {} more", bits.size() - kMost);
    text += fmt::format("{}{} {} times", text.empty() ? "" : ", ", text_of(place), behaviour.steps.size());
  }
  return text;
}

Result<Learned> layout_of(const std::vector<std::pair<BitPlace, Behaviour>>& found,
                          const std::vector<TimedReport>& reports, bool numbered) {
  Learned out;
  const BitPlace& first = found.front().first;
  out.report_number = first.number;
  out.trigger.byte = first.byte;
  out.trigger.active_high = !found.front().second.rest;
  out.trigger.mask = 0;
  for (const auto& [place, behaviour] : found) {
    out.bounce_ms = std::max(out.bounce_ms, behaviour.bounce_s * 1e3);
    if (behaviour.rest != out.trigger.active_high)
      out.trigger.mask = static_cast<std::uint8_t>(out.trigger.mask | 1U << place.bit);
  }
  for (const TimedReport& report : reports)
    if (!report.bytes.empty() && (!numbered || report.bytes[0] == first.number))
      out.report_bytes = std::max(out.report_bytes, report.bytes.size());
  out.trigger.debounce_ms = std::max(kLeastDebounce_ms, static_cast<int>(std::lround(2.0 * out.bounce_ms)));
  return out;
}

}  // namespace

int presses_seen(const std::vector<TimedReport>& reports, bool numbered) {
  std::size_t most = 0;
  for (const auto& entry : changing_bits(reports, numbered)) most = std::max(most, entry.second.steps.size());
  return static_cast<int>(most / 2);
}

Result<Learned> learned(const std::vector<TimedReport>& reports, int presses, bool numbered) {
  const Bits bits = changing_bits(reports, numbered);
  const auto wanted = static_cast<std::size_t>(2 * presses);
  if (reports.empty())
    return problem(ProblemKind::refused,
                   "the device sent no data: check that it is the right one and that it is pressed firmly");
  std::vector<std::pair<BitPlace, Behaviour>> found;
  for (const auto& entry : bits)
    if (entry.second.steps.size() == wanted) found.emplace_back(entry);
  if (found.empty())
    return problem(ProblemKind::refused,
                   bits.empty() ? fmt::format("{} reports were received, but no bit changed", reports.size())
                                : fmt::format("no bit changed {} times, as {} presses and releases do; seen: {}. Press "
                                              "and release exactly {} times, with half a second between",
                                              wanted, presses, what_changed(bits), presses));
  const BitPlace& first = found.front().first;
  for (const auto& [place, behaviour] : found) {
    if (!move_together(behaviour, found.front().second))
      return problem(ProblemKind::refused,
                     "{} and {} both changed {} times, but not together: the bit of the button is "
                     "ambiguous. Use only the trigger on the device, and learn again",
                     text_of(first), text_of(place), wanted);
    if (place.number != first.number || place.byte != first.byte)
      return problem(ProblemKind::refused,
                     "{} and {} changed together with every press: the bit of the button is ambiguous. "
                     "Write the right one into a description manually",
                     text_of(first), text_of(place));
  }
  return layout_of(found, reports, numbered);
}

}  // namespace ecs::devices
