// The candidate set of a designed experiment (Fedorov 1972): each condition that a person can set, one at a time,
// beside the line as it is measured now. Does not live here: their worth (separation.cpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "base/moved_targets.hpp"
#include "model/data/curve_basis.hpp"
#include "model/fit/statistics.hpp"
#include "model/planning/questions.hpp"

namespace ecs::model {
namespace {

/// Targets of a coarse line, a choice: 7 show a line and a bow.
constexpr std::size_t kFewTargets = 7;
/// How much a machine is warmed, and the least worth waiting for [degC]: 4 degC are 47 um/m on a steel scale
/// (11.7 um/m/degC), far above the noise of a laser; a workshop reaches them in an hour or two.
constexpr double kWarmer_degC = 4.0, kLeastWarmer_degC = 2.0;
/// Another day's air [hPa], and the pressure that decides in which direction: 15 hPa are 4 um/m of refraction (Ciddor
/// 1996), and weather does that.
constexpr double kOtherPressure_hPa = 15.0, kMeanPressure_hPa = 1000.0;
/// Targets are micrometres apart, as a control takes them.
constexpr double kSameTarget_mm = 1e-3;
/// The overrun takes at most this share of the travel at either end.
constexpr double kMostOverrun = 0.02;
/// Overrun of a pilgrim step [mm], at most: short against any distance of targets.
constexpr double kPilgrimOverrun_mm = 2.0;
/// Feeds worth trying: a quarter of the present one, twice it; higher only where the machine allows a fifth more.
constexpr double kSlowFeed = 0.25, kFastFeed = 2.0, kLeastFaster = 1.2;
/// Waits [min] that show a drift: half an hour, two hours and a shift.
constexpr std::array kWaits_minutes{30.0, 120.0, 480.0};
/// Another line is worth its set-up where it is this share of the travel away, and the travel at least this long [mm].
constexpr double kFarLine = 0.2, kLeastTravel_mm = 1.0;

/// Median of a column over some rows; nothing where none of them has it.
std::optional<double> median_of(const Column& column, const std::vector<std::size_t>& rows) {
  std::vector<double> values;
  for (const std::size_t k : rows)
    if (!column.empty() && !std::isnan(column[k])) values.push_back(column[k]);
  if (values.empty()) return std::nullopt;
  return upper_median(std::move(values));
}

/// The last measured value: what is so now.
std::optional<double> last_of(const Column& column, const std::vector<std::size_t>& rows) {
  for (auto k = rows.rbegin(); k != rows.rend() && !column.empty(); ++k)
    if (!std::isnan(column[*k])) return column[*k];
  return std::nullopt;
}

std::vector<double> thinned(const std::vector<double>& values, std::size_t most) {
  if (values.size() <= most) return values;
  std::vector<double> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(values[i * (values.size() - 1) / (most - 1)]);
  return kept;
}

/// A target as people type it: in tenths of a millimetre where its neighbours leave room, else in micrometres.
double readable_mm(double mm, double room_mm) {
  constexpr double kRoom_mm = 10.0, kPerMm = 10.0;
  return room_mm >= kRoom_mm ? std::round(mm * kPerMm) / kPerMm : to_micrometre(mm);
}

/// Inside the range, the overrun left free at both ends; no two closer than a micrometre.
std::vector<double> with_room(std::vector<double> targets, const Range& range, double overrun_mm) {
  const double least = range[0] + overrun_mm, greatest = range[1] - overrun_mm;
  if (least > greatest) return {};
  for (double& target : targets) target = std::clamp(target, least, greatest);
  return distinct(std::move(targets), kSameTarget_mm);
}

MeasurementProposal as_now(const Observations& data, Axis axis, Sense sense, const std::vector<std::size_t>& rows,
                           const MeasuringTimes& times) {
  MeasurementProposal now;
  now.condition = "with the present set-up";
  now.axis = axis;
  now.sense = sense;
  now.parked_mm = data.position_mm[rows.front()];
  now.parked_mm[index_of(axis)] = 0.0;
  now.first_run = 1 + *std::ranges::max_element(data.run);
  now.set_up_minutes = times.start_minutes;
  now.own_zero = times.zeroed_each_run;
  std::vector<double> targets;
  bool forward = false, reverse = false;
  for (const std::size_t k : rows) {
    targets.push_back(data.position_mm[k][index_of(axis)]);
    forward = forward || data.approach[k] > 0;
    reverse = reverse || data.approach[k] < 0;
    if (data.map) now.compensated = data.compensated[k];
  }
  now.targets_mm = distinct(std::move(targets), kSameTarget_mm);
  now.approach = reverse && !forward ? -1 : 1;
  now.feed_mm_min = std::max(1.0, median_of(data.feed_mm_min, rows).value_or(now.feed_mm_min));
  now.load_kg = median_of(data.load_kg, rows);
  now.pressure_hPa = last_of(data.pressure_hPa, rows);
  now.humidity_pct = last_of(data.humidity_pct, rows);
  if (const auto column = data.extras.find("set_up"); column != data.extras.end())
    now.set_up = static_cast<int>(last_of(column->second, rows).value_or(1.0));
  const bool against_artefact = !is_rotation(sense) && direction_of(sense) != axis;
  if (const auto column = data.extras.find("reversed"); against_artefact && column != data.extras.end())
    now.reversed = last_of(column->second, rows).value_or(0.0) != 0.0;
  for (const auto& [sensor, column] : data.sensors_degC)
    if (const auto degC = last_of(column, rows)) now.temperatures_degC[sensor] = *degC;
  const Range range = range_of(data, axis);
  now.overrun_mm = std::min(now.overrun_mm, kMostOverrun * (range[1] - range[0]));
  const std::vector<double> read_mm = now.targets_mm;
  now.targets_mm = with_room(read_mm, range, now.overrun_mm);
  now.ends_moved = now.targets_mm != read_mm;
  return now;
}

/// How far all these sensors may be moved, up first; 0 where the sensible range allows none.
double temperature_change(const MeasurementProposal& now, const std::vector<std::string>& sensors, double sign,
                          const MeasuringTimes& times) {
  double margin = kWarmer_degC;
  for (const std::string& sensor : sensors) {
    const double degC = now.temperatures_degC.at(sensor);
    margin = std::min(margin, sign > 0.0 ? times.greatest_degC - degC : degC - times.least_degC);
  }
  return sensors.empty() || margin < kLeastWarmer_degC ? 0.0 : sign * margin;
}

/// The conditions of a line, each as a changed copy of how it is measured now.
class Conditions {
 public:
  Conditions(const Observations& data, const MeasurementProposal& now, const MeasuringTimes& times)
      : data_(data), now_(now), times_(times) {}

  std::vector<MeasurementProposal> all() {
    add(std::string(kAnotherRun), [](MeasurementProposal&) {});
    motion();
    temperatures();
    time_and_air();
    set_up();
    lines();
    return std::move(list_);
  }

 private:
  void add(std::string condition, const std::function<void(MeasurementProposal&)>& change) {
    MeasurementProposal one = now_;
    one.condition = std::move(condition);
    change(one);
    list_.push_back(std::move(one));
  }

  void motion() {
    add("with the present set-up, targets between the present ones", [](MeasurementProposal& p) {
      std::vector<double> between;
      for (std::size_t i = 0; i + 1 < p.targets_mm.size(); ++i)
        between.push_back(
            readable_mm(0.5 * (p.targets_mm[i] + p.targets_mm[i + 1]), p.targets_mm[i + 1] - p.targets_mm[i]));
      if (!between.empty()) p.targets_mm = std::move(between);
    });
    if (!data_.feed_mm_min.empty()) {
      const double fast = std::min(kFastFeed * now_.feed_mm_min, times_.greatest_feed_mm_min);
      const double slow = kSlowFeed * now_.feed_mm_min;
      add("at a quarter of the feed", [&](MeasurementProposal& p) { p.feed_mm_min = slow; });
      if (fast > kLeastFaster * now_.feed_mm_min) {
        add("at a higher feed", [&](MeasurementProposal& p) { p.feed_mm_min = fast; });
        add("at two feeds, a quarter of the present one and a higher one", [&](MeasurementProposal& p) {
          p.feed_mm_min = slow;
          p.second_feed_mm_min = fast;
        });
      }
    }
    if (!data_.travel_since_reversal_mm.empty())
      add("reversing shortly before each target (pilgrim step)", [&](MeasurementProposal& p) {
        p.overrun_mm = std::min(kPilgrimOverrun_mm, p.overrun_mm);
        p.short_overrun = true;
      });
  }

  void move_sensors(const std::string& condition, const std::vector<std::string>& sensors, double sign,
                    double minutes) {
    const double change = temperature_change(now_, sensors, sign, times_);
    if (change == 0.0) return;
    add(fmt::format(fmt::runtime(condition), std::abs(change)), [&](MeasurementProposal& p) {
      for (const std::string& sensor : sensors) p.temperatures_degC[sensor] += change;
      p.wait_minutes = minutes > 0.0 ? minutes * std::abs(change) : times_.cold_minutes;
    });
  }

  void temperatures() {
    std::vector<std::string> all, of_machine;
    for (const auto& each : now_.temperatures_degC) {
      all.push_back(each.first);
      if (each.first != "t_air_degC") of_machine.push_back(each.first);
    }
    move_sensors("after the machine has been warmed by {:.0f} degC by moving its axes", of_machine, 1.0,
                 times_.warm_minutes_per_degC);
    if (all.size() > of_machine.size())
      move_sensors("after workshop and machine have been warmed by {:.0f} degC", all, 1.0,
                   times_.room_minutes_per_degC);
    move_sensors("after the workshop and the machine have cooled by {:.0f} degC overnight", all, -1.0, 0.0);
    if (of_machine.size() > 1)
      for (const std::string& sensor : of_machine)
        move_sensors(fmt::format("after the part with sensor {} alone has been warmed by {{:.0f}} degC", sensor),
                     {sensor}, 1.0, times_.warm_minutes_per_degC);
  }

  void time_and_air() {
    if (!data_.time_s.empty())
      for (const double minutes : kWaits_minutes)
        add(minutes < kMinutesAnHour ? "half an hour later"
                                     : fmt::format("{:.0f} hours later", minutes / kMinutesAnHour),
            [&](MeasurementProposal& p) { p.wait_minutes = minutes; });
    if (now_.pressure_hPa)
      add("on a day with a different air pressure", [&](MeasurementProposal& p) {
        *p.pressure_hPa += *p.pressure_hPa < kMeanPressure_hPa ? kOtherPressure_hPa : -kOtherPressure_hPa;
        p.wait_minutes = times_.weather_minutes;
      });
  }

  void set_up() {
    if (now_.load_kg)
      add(*now_.load_kg > 0.0 ? "without load" : "with a load", [&](MeasurementProposal& p) {
        p.load_kg = *now_.load_kg > 0.0 ? 0.0 : kTypicalLoad_kg;
        p.set_up_minutes += times_.load_minutes;
      });
    if (data_.map && now_.compensated.value_or(false))
      add("with compensation switched off", [&](MeasurementProposal& p) {
        p.compensated = false;
        p.set_up_minutes += times_.map_minutes;
      });
    if (now_.reversed)
      add(kTurnedOver, [&](MeasurementProposal& p) {
        p.reversed = !*now_.reversed;
        p.set_up_minutes += times_.align_minutes;
      });
    if (!is_rotation(now_.sense) && direction_of(now_.sense) == now_.axis)
      add("after aligning the beam and setting the readout to zero with the optics close together",
          [&](MeasurementProposal& p) {
            p.new_set_up = true;
            p.set_up = next_set_up();
            p.set_up_minutes += times_.align_minutes;
          });
  }

  void lines() {
    std::vector<Vector3> places;
    Vector3 both = now_.parked_mm;
    for (const Axis other : kAllAxes) {
      if (other == now_.axis) continue;
      const Range range = range_of(data_, other);
      if (range[1] - range[0] < kLeastTravel_mm) continue;
      const std::size_t o = index_of(other);
      for (const double end : range) {
        Vector3 one = now_.parked_mm;
        one[o] = end;
        if (std::abs(end - now_.parked_mm[o]) > kFarLine * (range[1] - range[0])) places.push_back(one);
      }
      both[o] = std::abs(range[0] - both[o]) > std::abs(range[1] - both[o]) ? range[0] : range[1];
    }
    if (places.size() > 1) places.push_back(both);
    for (const Vector3& place : places)
      add(line_name(place), [&](MeasurementProposal& p) {
        p.parked_mm = place;
        p.other_line = p.new_set_up = true;
        p.set_up = next_set_up();
        p.set_up_minutes = times_.line_minutes;
      });
  }

  [[nodiscard]] int next_set_up() const {
    double last = 1.0;
    if (const auto column = data_.extras.find("set_up"); column != data_.extras.end())
      for (const double number : column->second)
        if (number > last) last = number;
    return 1 + static_cast<int>(last);
  }

  [[nodiscard]] std::string line_name(const Vector3& place) const {
    std::string text = "on another line, parked at";
    for (const Axis a : kAllAxes)
      if (a != now_.axis && place[index_of(a)] != now_.parked_mm[index_of(a)])
        text += fmt::format(" {} {:g} mm", letter_of(a), place[index_of(a)]);
    return text;
  }

  const Observations& data_;
  const MeasurementProposal& now_;
  const MeasuringTimes& times_;
  std::vector<MeasurementProposal> list_;
};

}  // namespace

Range range_of(const Observations& data, Axis axis) {
  if (const auto& facts = data.machine.axes[index_of(axis)]) return facts->travel_mm;
  Range range{kBeyondAll, -kBeyondAll};
  for (const Vector3& position : data.position_mm) {
    range[0] = std::min(range[0], position[index_of(axis)]);
    range[1] = std::max(range[1], position[index_of(axis)]);
  }
  return range;
}

std::vector<PresentLine> present_lines(const Observations& data, const MeasuringTimes& times) {
  std::map<std::pair<Axis, Sense>, std::map<Vector3, std::vector<std::size_t>>> places;
  for (std::size_t k = 0; k < data.size(); ++k) {
    Vector3 parked = data.position_mm[k];
    parked[index_of(data.axis[k])] = 0.0;
    places[{data.axis[k], data.sense[k]}][parked].push_back(k);
  }
  std::vector<PresentLine> lines;
  for (const auto& [pair, parked] : places) {
    const auto most = std::ranges::max_element(
        parked, [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    std::vector<std::size_t> all;  // of scattered poses no line has readings enough: their axis and sense count
    for (const auto& each : parked) all.insert(all.end(), each.second.begin(), each.second.end());
    const bool scattered = most->second.size() < kFewTargets && parked.size() > 1;
    PresentLine line{pair.first, pair.second,
                     as_now(data, pair.first, pair.second, scattered ? all : most->second, times), all.size()};
    if (!line.now.targets_mm.empty()) lines.push_back(std::move(line));
  }
  std::ranges::stable_sort(lines, [](const PresentLine& a, const PresentLine& b) { return a.readings > b.readings; });
  return lines;
}

bool is_even_between_ends(const std::vector<double>& targets_mm) {
  constexpr std::size_t kFewestWithin = 3;
  if (targets_mm.size() < kFewestWithin + 2) return even_step_mm(targets_mm).has_value();
  return even_step_mm({targets_mm.begin() + 1, targets_mm.end() - 1}).has_value();
}

namespace {

/// An error of one turn of the screw has the same value at all of them.
bool are_whole_pitches_apart(const std::vector<double>& targets_mm, std::optional<double> pitch_mm) {
  constexpr double kInStep = 0.02;
  return pitch_mm && std::ranges::all_of(targets_mm, [&](double target_mm) {
           const double turns = (target_mm - targets_mm.front()) / *pitch_mm;
           return std::abs(turns - std::round(turns)) <= kInStep;
         });
}

}  // namespace

std::vector<double> off_equal_steps(const std::vector<double>& present_mm, std::vector<double> chosen_mm,
                                    std::optional<double> pitch_mm) {
  if (!is_even_between_ends(present_mm) && !are_whole_pitches_apart(chosen_mm, pitch_mm)) return chosen_mm;
  std::vector<double> moved = moved_targets(std::move(chosen_mm));
  for (std::size_t i = 1; i + 1 < moved.size(); ++i) moved[i] = readable_mm(moved[i], moved[i + 1] - moved[i - 1]);
  return moved;
}

std::optional<MeasurementProposal> over_the_travel(const Observations& data, const PresentLine& line,
                                                   const MeasuringTimes& times) {
  constexpr int kTwice = 2;  // what repeats is the machine's
  const Range range = range_of(data, line.axis);
  if (line.now.targets_mm.size() > 1 || range[1] - range[0] < kLeastTravel_mm) return std::nullopt;
  MeasurementProposal over = line.now;
  const double room = (range[1] - range[0] - 2.0 * over.overrun_mm) / static_cast<double>(kFewTargets - 1);
  over.targets_mm.clear();
  for (std::size_t i = 0; i < kFewTargets; ++i)
    over.targets_mm.push_back(readable_mm(range[0] + over.overrun_mm + room * static_cast<double>(i), room));
  over.targets_mm = off_equal_steps(over.targets_mm, with_room(over.targets_mm, range, over.overrun_mm));
  over.condition = "over the travel";
  over.bidirectional = true;
  over.runs = kTwice;
  over.minutes = minutes_of(over, times);
  over.tells = fmt::format("would show errors that depend on position, which readings at one target cannot: {}",
                           minutes_text(over));
  over.sentence = sentence_of(over);
  return over;
}

std::vector<MeasurementProposal> measuring_options(const Observations& data, const PresentLine& line,
                                                   const MeasuringTimes& times, bool of_approach, bool on_the_fly) {
  std::vector<MeasurementProposal> options;
  const auto& facts = data.machine.axes[index_of(line.axis)];
  const std::optional<double> pitch_mm = facts ? facts->screw_pitch_mm : std::nullopt;
  for (const MeasurementProposal& condition : Conditions(data, line.now, times).all())
    for (const std::size_t most : {kManyTargets, kFewTargets})
      for (const bool both : {true, false}) {
        MeasurementProposal one = condition;
        one.targets_mm = off_equal_steps(condition.targets_mm, thinned(condition.targets_mm, most), pitch_mm);
        if (most == kManyTargets && condition.targets_mm.size() <= kFewTargets) continue;
        if (of_approach && !both) continue;
        one.bidirectional = both;
        if (on_the_fly) one.dwell_s = 0.0;
        options.push_back(std::move(one));
      }
  return options;
}

}  // namespace ecs::model
