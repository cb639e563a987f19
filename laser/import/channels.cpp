#include "laser/import/channels.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/groups.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/rows.hpp"
#include "laser/import/set_up.hpp"

namespace ecs::laser {
namespace {

using Samples = std::vector<ChannelSample>;

constexpr double kUsualIntervals = 5.0;  ///< the greatest gap, where none is given

double usual_interval_s(const Samples& samples) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < samples.size(); ++i) intervals.push_back(samples[i].time_s - samples[i - 1].time_s);
  return median_of(std::move(intervals));
}

/// A channel that is joined to the clock of another.
class JoinedChannel {
 public:
  JoinedChannel(std::string name, const Samples& samples, const ImportOptions& options)
      : name_(std::move(name)), samples_(samples), joining_(options.joining) {
    limit_s_ =
        options.greatest_gap_s.value_or(joining_ == Joining::previous ? std::numeric_limits<double>::infinity()
                                                                      : kUsualIntervals * usual_interval_s(samples));
  }

  /// Nothing if there is no value within the greatest gap.
  std::optional<double> at(double time_s) {
    const auto after = std::lower_bound(samples_.begin(), samples_.end(), time_s,
                                        [](const ChannelSample& sample, double t) { return sample.time_s < t; });
    if (after != samples_.end() && after->time_s == time_s) return after->value;
    const ChannelSample* const next = after == samples_.end() ? nullptr : &*after;
    const ChannelSample* const last = after == samples_.begin() ? nullptr : &*(after - 1);
    switch (joining_) {
      case Joining::linear:
        if (!last || !next || !fits(next->time_s - last->time_s)) return std::nullopt;
        return last->value + (next->value - last->value) * (time_s - last->time_s) / (next->time_s - last->time_s);
      case Joining::nearest: {
        const bool is_next = next && (!last || next->time_s - time_s < time_s - last->time_s);
        const ChannelSample* const near = is_next ? next : last;
        if (!near || !fits(std::abs(near->time_s - time_s))) return std::nullopt;
        return near->value;
      }
      case Joining::previous:
        if (!last || !fits(time_s - last->time_s)) return std::nullopt;
        return last->value;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::string note() const {
    const char* const how = joining_ == Joining::linear    ? "linear between its values"
                            : joining_ == Joining::nearest ? "the nearest value"
                                                           : "the value before";
    return fmt::format("{}: joined by time, {}; largest gap {:.3g} s{}", name_, how, greatest_s_,
                       std::isfinite(limit_s_) ? fmt::format(" (--max-gap allows {:.3g} s)", limit_s_) : "");
  }

 private:
  bool fits(double gap_s) {
    if (gap_s > limit_s_) return false;
    greatest_s_ = std::max(greatest_s_, gap_s);
    return true;
  }

  std::string name_;
  const Samples& samples_;
  Joining joining_;
  double limit_s_ = 0.0;
  double greatest_s_ = 0.0;  ///< gap over which a value was taken
};

/// The name as the log has it; a `usage` problem that lists the channels.
Result<std::string> channel_named(const ChannelLog& log, const ColumnRule& rule, const std::string& file_name) {
  for (const auto& [name, samples] : log.channels)
    if (lower(name) == lower(trimmed(rule.heading))) return name;
  return tl::unexpected(usage(file_name, fmt::format("channels: {}: no channel {} in the log; it has {}", rule.field,
                                                     in_quotes(rule.heading), channels_text(log))));
}

bool is_needed(Role role) { return role != Role::other && role != Role::own_sense && role != Role::pass; }

/// The rows of the clock's channel with what was joined to them.
struct JoinedRows {
  std::deque<std::string> cells;  ///< what the rows refer to
  std::vector<TableRow> rows;
  std::vector<std::string> notes;
};

Result<JoinedRows> joined_rows(const ChannelLog& log, const Plan& plan, const std::string& file_name,
                               const ImportOptions& options) {
  std::vector<JoinedChannel> channels;
  std::optional<std::size_t> clock;
  std::vector<std::string> names;
  for (std::size_t i = 1; i < plan.fields.size(); ++i) {
    ECS_TRY(name, channel_named(log, plan.fields[i].rule, file_name));
    names.push_back(name);
    if (!clock && is_value(plan.fields[i].role)) clock = i;
    channels.emplace_back(name, log.channels.at(name), options);
  }
  if (!clock) return tl::unexpected(usage(file_name, plan_fault(plan)));
  JoinedRows joined;
  int without = 0;
  for (const ChannelSample& sample : log.channels.at(names[*clock - 1])) {
    TableRow row;
    row.number = sample.line;
    row.cells.push_back(joined.cells.emplace_back(shortest(sample.time_s)));
    bool whole = true;
    for (std::size_t i = 1; i < plan.fields.size(); ++i) {
      const auto value = i == *clock ? std::optional(sample.value) : channels[i - 1].at(sample.time_s);
      whole = whole && (value || !is_needed(plan.fields[i].role));
      row.cells.push_back(value ? std::string_view(joined.cells.emplace_back(shortest(*value))) : std::string_view());
    }
    if (whole)
      joined.rows.push_back(std::move(row));
    else
      ++without;
  }
  for (std::size_t i = 1; i < plan.fields.size(); ++i)
    if (i != *clock) joined.notes.push_back(channels[i - 1].note());
  if (without > 0)
    joined.notes.push_back(
        fmt::format("{} values of {} without values of the other channels within the largest gap are ignored", without,
                    names[*clock - 1]));
  return joined;
}

}  // namespace

std::string channels_text(const ChannelLog& log) {
  std::vector<std::string> names;
  for (const auto& [name, samples] : log.channels)
    names.push_back(fmt::format("{} ({} value{})", name, samples.size(), samples.size() == 1 ? "" : "s"));
  return fmt::format("{}", fmt::join(names, ", "));
}

Result<MeasurementSet> read_channels(ChannelLog log, const std::string& file_name, const ImportOptions& options) {
  for (auto& [name, samples] : log.channels)
    std::ranges::stable_sort(samples,
                             [](const ChannelSample& a, const ChannelSample& b) { return a.time_s < b.time_s; });
  std::vector<ColumnRule> rules(1);
  rules.front().field = "time_s";
  rules.insert(rules.end(), options.channels->rules.begin(), options.channels->rules.end());
  Plan plan{fields_of(rules),  options.axis,          options.rotary, options.sense, options.channels->values, '.',
            options.parked_mm, options.parked_stated, false};
  for (std::size_t i = 0; i < plan.fields.size(); ++i) plan.fields[i].index = i;
  take_mapped_axis(plan);
  std::string fault = take_units(plan, options);
  if (fault.empty()) fault = plan_fault(plan);
  if (!fault.empty()) return tl::unexpected(usage(file_name, fault));
  ECS_TRY(joined, joined_rows(log, plan, file_name, options));
  MeasurementSet set;
  set.source = file_name;
  Findings findings(file_name);
  for (const TableRow& row : joined.rows) static_cast<void>(take_row(set, plan, row, 1, findings));
  if (findings.empty() && set.readings.empty())
    findings.add(0, 0,
                 "expected values of all requested channels at the same time, found none: give a larger --max-gap");
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  set.notes = joined.notes;
  if (log.left_out > 0) set.notes.push_back(fmt::format("{} values that are not numbers are ignored", log.left_out));
  begin_at_zero(set);
  finish(set, *options.channels, plan);
  if (!options.at_rest_mm && !options.average) take_speed(set, kIntervalOfScan_s);
  return set;
}

}  // namespace ecs::laser
