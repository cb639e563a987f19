// Reader of recorded steps; the noise of a recorder from second differences (Gasser, Sroka and Jennen-Steinmetz 1986),
// the larger ones trimmed; its clipping. The figures that a person reads off the curve of a step: level, rise, fall,
// end of the plateau; transition durations between 10 % and 90 % of the level (IEC 60469:2013; IEEE Std 181-2011).
#include "modules/traces/trace.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "laser/csv_table.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
/// Samples of a step from which level, rise and noise can be told: a choice.
constexpr std::size_t kFewestTraceSamples = 20;
/// Bytes looked through for the header row of a recording.
constexpr std::size_t kHeadBytes = 65'536;
/// Values closer than this share of the span are equal: rounding.
constexpr double kSameValue = 1e-9;
/// Var(y[i] - 2·y[i-1] + y[i-2]) = 6σ² for independent noise.
constexpr double kSecondDifference = 6.0;
/// The lower share of squares used, and what mean they have there for χ² of one degree: ∫ of x·f(x) up to its quantile
/// of 0.8, over 0.8.
constexpr double kKeptShare = 0.8, kShareOfVariance = 0.4377;
/// Rounding to a step q makes noise of variance q²/12.
constexpr double kVarianceOfStep = 12.0;
/// No recorder is better than this share of the span.
constexpr double kLeastNoise = 1e-5;
/// A flat end is one sample in this many, at least, and this many noises high; rest is the median of one in this many
/// samples. Choices.
constexpr std::size_t kSamplesAFlat = 20, kSamplesATraceRest = 50;
constexpr double kFlatHeight = 20.0;
/// Samples within this many steps of the converter are at the top: more than half a step.
constexpr double kAtTop = 0.6;
/// Shares of the height: the last fifth of a clipped rise takes no more than twice the fifth below its middle.
constexpr double kLastFifth = 0.8, kMiddleFrom = 0.5, kMiddleTo = 0.7;
/// The edge of a given full scale is at least this share of it below: rounding in the file.
constexpr double kFullScaleEdge = 1e-6;

std::optional<DriveSignal> signal_named(std::string_view name) {
  for (const DriveSignalInfo& info : drive_signals())
    if (info.name == name) return info.id;
  return std::nullopt;
}

/// `# key: value`, without the '#'.
std::optional<std::pair<std::string, std::string>> metadata_in(std::string_view line) {
  line = trimmed(line.substr(line.find_first_not_of('#') == line.npos ? line.size() : line.find_first_not_of('#')));
  const std::size_t colon = line.find(':');
  if (colon == line.npos) return std::nullopt;
  return std::pair(std::string(trimmed(line.substr(0, colon))), std::string(trimmed(line.substr(colon + 1))));
}

class TraceReader {
 public:
  TraceReader(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  Result<DriveTrace> read() {
    trace_.source = file_;
    if (text_.starts_with(kByteOrderMark)) text_.remove_prefix(kByteOrderMark.size());
    for (const std::string_view line : lines_of(text_)) {
      ++line_;
      const std::string_view content = trimmed(line);
      if (content.empty()) continue;
      if (content.front() == '#')
        metadata(content);
      else if (columns_.empty())
        header(content);
      else
        sample(content);
      if (no_header_) break;
    }
    finish();
    if (!problems_.empty()) return tl::unexpected(folded(std::move(problems_)));
    return std::move(trace_);
  }

 private:
  void complain(int line, int column, std::string message) {
    constexpr std::size_t kMostProblems = 50;
    if (problems_.size() < kMostProblems)
      problems_.push_back(problem_at(file_, line, column, std::move(message)).value());
  }

  void metadata(std::string_view line) {
    const auto entry = metadata_in(line);
    if (!entry) return;
    const auto& [key, value] = *entry;
    std::optional<double>* const into = key == "feed_mm_min"    ? &feed_
                                        : key == "distance_mm"  ? &distance_
                                        : key == "full_scale_V" ? &full_scale_
                                                                : nullptr;
    if (into == nullptr) return;
    const auto number = number_in(value);
    const bool good = number && *number != 0.0 && (*number > 0.0 || into == &distance_);
    if (!good)
      return complain(
          line_, 1,
          fmt::format("{}: expected a {}number, found \"{}\"", key, into == &distance_ ? "" : "positive ", value));
    *into = number;
  }

  void header(std::string_view line) {
    const std::size_t before = problems_.size();
    columns(line);
    no_header_ = problems_.size() > before;
  }

  void columns(std::string_view line) {
    for (const laser::CsvField& field : laser::csv_fields(line).fields) {
      if (std::ranges::find(columns_, field.text) != columns_.end())
        return complain(line_, field.column, fmt::format("expected every column once, found {} twice", field.text));
      columns_.push_back(field.text);
      if (field.text == "time_s" || signal_named(field.text)) continue;
      trace_.notes.push_back(fmt::format("column {} is not a signal of the axis: ignored", field.text));
    }
    for (const char* needed : {"time_s", "dac_V"})
      if (std::ranges::find(columns_, needed) == columns_.end())
        complain(line_, 1,
                 fmt::format("expected a column {} in the header row, found {}", needed, fmt::join(columns_, ", ")));
    for (const DriveSignalInfo& info : drive_signals())
      if (std::ranges::find(columns_, info.name) != columns_.end()) {
        trace_.signals.emplace_back();
        trace_.signals.back().id = info.id;
      }
  }

  void sample(std::string_view line) {
    const laser::CsvLine cut = laser::csv_fields(line);
    if (!cut.fault.empty()) return complain(line_, cut.fault_column, cut.fault);
    if (cut.fields.size() != columns_.size())
      return complain(
          line_, 1,
          fmt::format("expected {} fields as in the header row, found {}", columns_.size(), cut.fields.size()));
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const auto signal = signal_named(columns_[i]);
      if (!signal && columns_[i] != "time_s") continue;
      const auto number = number_in(cut.fields[i].text);
      if (!number)
        return complain(line_, cut.fields[i].column,
                        fmt::format("{}: expected a number, found \"{}\"", columns_[i], cut.fields[i].text));
      if (!signal) {
        if (!trace_.time_s.empty() && *number <= trace_.time_s.back())
          return complain(line_, cut.fields[i].column,
                          fmt::format("time_s: expected more than {} of the sample before, found {}",
                                      trace_.time_s.back(), *number));
        time_ = *number;
      } else {
        for (RecordedSignal& s : trace_.signals)
          if (s.id == *signal) pending_[index_of(s.id)] = *number;
      }
    }
    trace_.time_s.push_back(time_);
    for (RecordedSignal& s : trace_.signals) s.value.push_back(pending_[index_of(s.id)]);
  }

  void finish();

  std::string_view text_;
  std::string file_;
  DriveTrace trace_;
  std::vector<Problem> problems_;
  std::vector<std::string> columns_;
  std::optional<double> feed_, distance_, full_scale_;
  std::array<double, kDriveSignals> pending_{};
  double time_ = 0.0;
  int line_ = 0;
  bool no_header_ = false;
};

/// The step of the recorder's converter: smallest distance of two different values, where many samples share values.
double quantum_of(const std::vector<double>& value) {
  std::vector<double> sorted = value;
  std::ranges::sort(sorted);
  const double tolerance = kSameValue * std::max(1.0, sorted.back() - sorted.front());
  std::vector<double> gaps;
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (sorted[i] - sorted[i - 1] > tolerance) gaps.push_back(sorted[i] - sorted[i - 1]);
  if (gaps.empty() || gaps.size() * 2 > sorted.size()) return 0.0;
  return *std::ranges::min_element(gaps);
}

/// From second differences, whose larger half a curve of few changes leaves untouched; at least what rounding makes.
double noise_of(const std::vector<double>& value, double quantum) {
  std::vector<double> squares;
  for (std::size_t i = 2; i < value.size(); ++i) {
    const double bend = value[i] - 2.0 * value[i - 1] + value[i - 2];
    squares.push_back(bend * bend / kSecondDifference);
  }
  std::ranges::sort(squares);
  // the mean of the lower ones, corrected for what a normal distribution has there
  const auto kept = static_cast<std::size_t>(kKeptShare * static_cast<double>(squares.size()));
  double sum = 0.0;
  for (std::size_t i = 0; i < kept; ++i) sum += squares[i];
  const double spread = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(kept, 1)) / kShareOfVariance);
  const double span = *std::ranges::max_element(value) - *std::ranges::min_element(value);
  return std::max({spread, quantum / std::sqrt(kVarianceOfStep), kLeastNoise * span});
}

/// A top (sense 1) or bottom (-1) that the curve runs into at full slope and stays at: the recorder's, not the axis's.
std::optional<double> clipped_at(const RecordedSignal& signal, int sense) {
  std::vector<double> v;
  for (const double x : signal.value) v.push_back(sense * x);
  const double top = *std::ranges::max_element(v);
  const double base =
      upper_median(std::vector(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / kSamplesATraceRest + 1)));
  const double height = top - base;
  const double close = std::max(kAtTop * signal.quantum, kSameValue * std::abs(top));
  const auto flat = static_cast<std::size_t>(std::ranges::count_if(v, [&](double x) { return x > top - close; }));
  if (flat * kSamplesAFlat < v.size() || height < kFlatHeight * signal.noise) return std::nullopt;
  const auto first_above = [&](double share) {
    return std::ranges::find_if(v, [&](double x) { return x > base + share * height; }) - v.begin();
  };
  const auto arrival = std::ranges::find_if(v, [&](double x) { return x > top - close; }) - v.begin();
  const auto last_fifth = arrival - first_above(kLastFifth), middle = first_above(kMiddleTo) - first_above(kMiddleFrom);
  if (last_fifth > 2 * middle + 2) return std::nullopt;
  // once there, it is to stay: noise would lift a true plateau above its first sample
  std::size_t run = 0, longest = 0;
  for (const double x : v) longest = std::max(longest, run = x > top - close ? run + 1 : 0);
  return longest * 2 > flat ? std::optional(sense * (top - close)) : std::nullopt;
}

void TraceReader::finish() {
  if (columns_.empty() && problems_.empty())
    return complain(0, 0, "expected a header row with time_s and dac_V, found none");
  if (!feed_) complain(1, 1, "expected a line \"# feed_mm_min: 1200\" with the demanded feed, found none");
  if (!distance_) complain(1, 1, "expected a line \"# distance_mm: 10\" with the demanded move, found none");
  if (!problems_.empty()) return;
  if (trace_.time_s.size() < kFewestTraceSamples)
    return complain(line_, 1,
                    fmt::format("expected at least {} samples, found {}", kFewestTraceSamples, trace_.time_s.size()));
  trace_.move = {*feed_, *distance_};
  for (RecordedSignal& s : trace_.signals) {
    const auto [least, most] = std::ranges::minmax_element(s.value);
    if (*most - *least <= 0.0) {
      complain(line_, 1,
               fmt::format("{}: expected a signal that changes, found {} in every sample", info_of(s.id).name, *most));
      continue;
    }
    s.quantum = quantum_of(s.value);
    s.noise = noise_of(s.value, s.quantum);
    if (full_scale_ && info_of(s.id).unit == "V") {
      const double edge = *full_scale_ - std::max(s.quantum, kFullScaleEdge * *full_scale_);
      s.clipped_above = edge;
      s.clipped_below = -edge;
    } else {
      s.clipped_above = clipped_at(s, 1);
      s.clipped_below = clipped_at(s, -1);
    }
    for (const auto& edge : {s.clipped_above, s.clipped_below})
      if (edge && !full_scale_)
        trace_.notes.push_back(
            fmt::format("{} is clipped at {:.3g} {}: assumed to be a limit of the recorder or of the converter; "
                        "samples there are lower bounds",
                        info_of(s.id).name, *edge, info_of(s.id).unit));
  }
}

}  // namespace

bool is_drive_trace(std::string_view text) {
  for (const std::string_view line : lines_of(text.substr(0, kHeadBytes))) {
    std::string_view content = trimmed(line);
    if (content.starts_with(kByteOrderMark)) content.remove_prefix(kByteOrderMark.size());
    if (content.empty() || content.front() == '#') continue;
    bool time = false, dac = false;
    for (const laser::CsvField& field : laser::csv_fields(content).fields) {
      time = time || field.text == "time_s";
      dac = dac || field.text == "dac_V";
    }
    return time && dac;
  }
  return false;
}

Result<DriveTrace> parse_trace(std::string_view text, const std::string& file_name) {
  if (auto why = why_no_text(text, file_name)) return tl::unexpected(std::move(*why));
  return TraceReader(text, file_name).read();
}

Result<DriveTrace> read_trace(const std::filesystem::path& path) {
  ECS_TRY(text, read_file(path));
  return parse_trace(text, path.string());
}

namespace {

/// Noise, as a share of the span of the curve, below which nothing is smoothed; below which three samples do, else
/// five. Choices.
constexpr double kQuiet = 0.002, kNoisy = 0.01;
/// The level is looked for among the samples of the upper tenth below this quantile: overshoot and glitches are above.
constexpr double kTopQuantile = 0.98;
/// 10 % and 90 % of the level, and where the straight parts of rise and fall are carried back from.
constexpr double kLow = 0.1, kHigh = 0.9, kLowFurther = 0.3, kHighFurther = 0.7;
/// Samples without which there is no curve; rest is the median of one in this many at either end; a curve is at least
/// this many noises high.
constexpr std::size_t kFewestSamples = 3, kSamplesARest = 100;
constexpr double kLeastHeight = 5.0;

/// Means over a few samples where the noise asks for it.
std::vector<double> smoothed(const std::vector<double>& value, double noise) {
  const double span = *std::ranges::max_element(value) - *std::ranges::min_element(value);
  if (noise < kQuiet * span) return value;
  const std::ptrdiff_t reach = noise < kNoisy * span ? 1 : 2, n = std::ssize(value);
  std::vector<double> mean;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t half = std::min({reach, i, n - 1 - i});
    double sum = 0.0;
    for (std::ptrdiff_t j = i - half; j <= i + half; ++j) sum += value[static_cast<std::size_t>(j)];
    mean.push_back(sum / static_cast<double>(2 * half + 1));
  }
  return mean;
}

/// Median of the upper tenth of the height.
double level_of(const std::vector<double>& v, double base) {
  std::vector<double> sorted = v;
  std::ranges::sort(sorted);
  const double high = sorted[static_cast<std::size_t>(kTopQuantile * static_cast<double>(sorted.size() - 1))];
  std::vector<double> upper;
  for (const double x : v)
    if (x - base >= kHigh * (high - base)) upper.push_back(x);
  return upper.empty() ? high : upper_median(upper);
}

using Times = std::vector<double>;

/// When the curve first crosses `level` upward (`from` 0) or last crosses it downward; nothing where it does not.
std::optional<double> first_rise(const Times& t, const std::vector<double>& v, double level) {
  for (std::size_t i = 1; i < v.size(); ++i)
    if (v[i - 1] < level && v[i] >= level) return std::lerp(t[i - 1], t[i], (level - v[i - 1]) / (v[i] - v[i - 1]));
  return std::nullopt;
}
std::optional<double> last_fall(const Times& t, const std::vector<double>& v, double level) {
  for (std::size_t i = v.size() - 1; i > 0; --i)
    if (v[i - 1] >= level && v[i] < level) return std::lerp(t[i - 1], t[i], (v[i - 1] - level) / (v[i - 1] - v[i]));
  return std::nullopt;
}

std::optional<double> difference(std::optional<double> later, std::optional<double> earlier) {
  if (!later || !earlier) return std::nullopt;
  return *later - *earlier;
}

/// The straight line through two crossings, carried on by half their distance in level.
std::optional<double> carried_back(std::optional<double> near, std::optional<double> far) {
  if (!near || !far) return std::nullopt;
  return *near - 0.5 * (*far - *near);
}

}  // namespace

StepShape shape_of(const Times& time_s, const std::vector<double>& value, double noise) {
  StepShape shape;
  if (value.size() < kFewestSamples) return shape;
  std::vector<double> v = smoothed(value, noise);
  const auto [least, most] = std::ranges::minmax_element(v);
  const double sense = std::abs(*least) > std::abs(*most) ? -1.0 : 1.0;
  for (double& x : v) x *= sense;
  // at rest before the move, or after it where the recorder came too late
  const auto few = static_cast<std::ptrdiff_t>(v.size() / kSamplesARest + 1);
  const double before = upper_median({v.begin(), v.begin() + few}), after = upper_median({v.end() - few, v.end()});
  const double top = *std::ranges::max_element(v);
  const double base = std::min(before, after);
  if (base > 0.5 * top) return shape;
  const double level = level_of(v, base), height = level - base;
  if (height < kLeastHeight * noise) return shape;
  shape.steady = sense * level;
  const auto at = [&](double share) { return base + share * height; };
  const auto up10 = first_rise(time_s, v, at(kLow));
  shape.rise_s = difference(first_rise(time_s, v, at(kHigh)), up10);
  shape.start_s = carried_back(up10, first_rise(time_s, v, at(kLowFurther)));
  const auto down90 = last_fall(time_s, v, at(kHigh));
  shape.fall_s = difference(last_fall(time_s, v, at(kLow)), down90);
  shape.decay_start_s = difference(carried_back(down90, last_fall(time_s, v, at(kHighFurther))), shape.start_s);
  return shape;
}

}  // namespace ecs::model
