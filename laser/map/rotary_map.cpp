#include "laser/map/rotary_map.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/findings.hpp"
#include "laser/map/image.hpp"

namespace ecs::laser {
namespace {

using Curves = std::array<std::vector<double>, 6>;

bool all_zero(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double value) { return value == 0.0; });
}

/// Both sides of a curve, for its resolution.
std::vector<double> both_sides(const MapRotaryAxis& axis, std::size_t sense) {
  std::vector<double> values = axis.compensation[0][sense];
  values.insert(values.end(), axis.compensation[1][sense].begin(), axis.compensation[1][sense].end());
  return values;
}

}  // namespace

PackedRotary::PackedRotary(const MapHeader& header) {
  std::copy_n(header.rotary_configuration.begin(),
              std::min(header.rotary_configuration.size(), setup_.configuration.size() - 1),
              setup_.configuration.begin());
  setup_.bending = header.bending;
  for (std::size_t i = 0; i < std::min(header.rotary.size(), kRotaryInputs); ++i) {
    const MapRotaryAxis& from = header.rotary[i];
    setup_.axes[i] = from.axis;
    RotaryCurves& table = setup_.tables[i];
    table.start_deg = from.start_deg;
    table.increment_deg = from.increment_deg;
    table.count = static_cast<std::uint32_t>(from.compensation[0][0].size());
    for (std::size_t s = 0; s < 6; ++s) table.resolution[s] = resolution_for(both_sides(from, s));
    for (std::size_t side = 0; side < 2; ++side) {
      values_[i][side].resize(std::size_t{12} * table.count);
      for (std::size_t s = 0; s < 6; ++s)
        for (std::size_t k = 0; k < table.count; ++k)
          store_big(values_[i][side], 2 * (s * table.count + k),
                    static_cast<std::uint16_t>(std::lround(from.compensation[side][s][k] / table.resolution[s])));
      table.values[side] = values_[i][side];
    }
  }
}

void take_rotary(MapHeader& header, const RotarySetup& setup) {
  header.rotary_configuration = setup.configuration.data();
  header.bending = setup.bending;
  for (std::size_t i = 0; i < kRotaryInputs; ++i) {
    if (setup.axes[i].letter == '\0') continue;
    const RotaryCurves& table = setup.tables[i];
    MapRotaryAxis& axis =
        header.rotary.emplace_back(MapRotaryAxis{setup.axes[i], table.start_deg, table.increment_deg, {}});
    for (std::size_t side = 0; side < 2; ++side)
      for (std::size_t s = 0; s < 6; ++s)
        for (std::size_t k = 0; k < table.count; ++k)
          axis.compensation[side][s].push_back(value_of_counts(
              static_cast<std::int16_t>(load_big<std::uint16_t>(table.values[side], 2 * (s * table.count + k))),
              table.resolution[s]));
  }
}

std::string rotary_curve_name(char letter, std::size_t sense) {
  return fmt::format("{}{}", kSenseNames[sense], letter);
}

std::string rotary_location_name(char letter, std::size_t place) {
  return fmt::format("{}O{}", "XYZABC"[place], letter);
}

std::vector<RotaryPart> parts_of(const MapRotaryAxis& one) {
  std::vector<RotaryPart> parts;
  const auto add = [&](std::string name, double largest, std::size_t place) {
    if (largest != 0.0) parts.push_back({std::move(name), largest, place < kAxes ? "um" : "um/m"});
  };
  for (std::size_t s = 0; s < 6; ++s) add(rotary_location_name(one.axis.letter, s), std::abs(one.axis.location[s]), s);
  for (std::size_t s = 0; s < 6; ++s) {
    double largest = 0.0;
    for (const double value : both_sides(one, s)) largest = std::max(largest, std::abs(value));
    add(rotary_curve_name(one.axis.letter, s), largest, s);
  }
  return parts;
}

std::vector<RotaryPart> parts_of(const RotaryBending& bending) {
  constexpr std::array<std::string_view, 6> kSizes{"x_sin", "y_sin", "z_sin", "x_cos", "y_cos", "z_cos"};
  std::vector<RotaryPart> parts;
  for (std::size_t i = 0; i < kSizes.size(); ++i)
    parts.push_back({fmt::format("machine_bending {}", kSizes[i]), bending.of_machine[i], "um"});
  for (std::size_t i = 0; i < kSizes.size(); ++i)
    parts.push_back({fmt::format("tool_bending {}", kSizes[i]), bending.of_tool[i], "um/m"});
  return parts;
}

std::optional<double> rotary_error_at(const MapRotaryAxis& one, std::size_t side, std::size_t sense, double angle_deg) {
  constexpr double kTurn_deg = 360.0, kSamePlace = 1e-6;
  const std::vector<double>& values = one.compensation[side][sense];
  if (values.empty()) return 0.0;
  const double count = static_cast<double>(values.size());
  const double of_turn = kTurn_deg / one.increment_deg;
  double place = (angle_deg - one.start_deg) / one.increment_deg;
  place -= std::floor(place / of_turn + kSamePlace / of_turn) * of_turn;
  if (std::abs(count - of_turn) > kSamePlace && place > count - 1.0 + kSamePlace) return std::nullopt;
  place = std::max(place, 0.0);
  const auto below = static_cast<std::size_t>(place) % values.size();
  const double error = -std::lerp(values[below], values[(below + 1) % values.size()], place - std::floor(place));
  return error == 0.0 ? 0.0 : error;
}

namespace {

constexpr std::string_view kConfigurationKey = "rotary_configuration", kAxisKey = "rotary_axis",
                           kCurveKey = "rotary_curve", kBendingKey = "rotary_bending";

/// Far beyond every fact of an axis, and as in a table of the map.
constexpr double kMostOfAxis = 1e9, kMostOfCurve = 32'000.0;

/// Places of several numbers.
template <class Values>
auto all(Values& numbers) {
  std::vector<decltype(numbers.data())> places;
  for (auto& number : numbers) places.push_back(&number);
  return places;
}

/// Key and number or numbers of each fact of an axis.
template <class One>
requires requires(One& one) { one.axis; }
auto facts_of(One& one) {
  using Numbers = std::vector<decltype(&one.start_deg)>;
  auto& axis = one.axis;
  return std::array{std::pair<std::string_view, Numbers>{"deg_per_count", {&axis.deg_per_count}},
                    std::pair<std::string_view, Numbers>{"deadband_deg", {&axis.deadband_deg}},
                    std::pair<std::string_view, Numbers>{"zero_deg", {&axis.zero_deg}},
                    std::pair<std::string_view, Numbers>{"direction", all(axis.direction)},
                    std::pair<std::string_view, Numbers>{"pivot_mm", all(axis.pivot_mm)},
                    std::pair<std::string_view, Numbers>{"location", all(axis.location)},
                    std::pair<std::string_view, Numbers>{"start_deg", {&one.start_deg}},
                    std::pair<std::string_view, Numbers>{"increment_deg", {&one.increment_deg}}};
}

/// The same of bending.
template <class Bending>
requires requires(Bending& bending) { bending.of_tool; }
auto facts_of(Bending& bending) {
  using Fact = std::pair<std::string_view, decltype(all(bending.of_tool))>;
  return std::array{Fact{"machine_um", all(bending.of_machine)}, Fact{"tool_um_per_m", all(bending.of_tool)}};
}

/// "0.6,1.99,2.84"
std::string listed(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{}", text.empty() ? "" : ",", shortest(value));
  return text;
}

std::optional<std::vector<double>> numbers_in(std::string_view text, double most) {
  std::vector<double> numbers;
  for (const std::string_view part : split(text, ',')) {
    const auto number = number_in(part);
    if (!number || !(std::abs(*number) <= most)) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

/// Whether every fact is among the words.
template <class One>
bool take_facts(const std::vector<std::string_view>& words, One& one) {
  bool whole = true;
  for (const auto& [key, places] : facts_of(one)) {
    const auto word = std::ranges::find_if(words, [key = key](std::string_view each) {
      return each.starts_with(key) && each.substr(key.size()).starts_with('=');
    });
    const auto numbers = word == words.end() ? std::nullopt : numbers_in(word->substr(key.size() + 1), kMostOfAxis);
    whole = whole && numbers && numbers->size() == places.size();
    for (std::size_t i = 0; whole && i < places.size(); ++i) *places[i] = (*numbers)[i];
  }
  return whole;
}

/// " key=0.6,1.99" of each fact.
template <class One>
std::string facts_text(const One& one) {
  std::string text;
  for (const auto& [key, places] : facts_of(one)) {
    std::vector<double> values;
    for (const double* place : places) values.push_back(*place);
    text += fmt::format(" {}={}", key, listed(values));
  }
  return text;
}

std::string take_axis(MapHeader& header, std::string_view value) {
  const auto words = split(value, ' ');
  MapRotaryAxis one;
  const bool named = !words.empty() && words.front().size() == 1 && header.rotary.size() < kRotaryInputs;
  if (named) one.axis.letter = words.front().front();
  if (!named || !take_facts(words, one))
    return fmt::format(
        "rotary_axis: expected a letter and deg_per_count, deadband_deg, zero_deg, direction, pivot_mm, location, "
        "start_deg, increment_deg, for two axes at most, found {}",
        in_quotes(value));
  header.rotary.push_back(std::move(one));
  return {};
}

std::string take_bending(MapHeader& header, std::string_view value) {
  if (!header.rotary.empty() && take_facts(split(value, ' '), header.bending)) return {};
  return fmt::format(
      "rotary_bending: expected machine_um and tool_um_per_m of x_sin, y_sin, z_sin, x_cos, y_cos, z_cos, below the "
      "lines rotary_axis, found {}",
      in_quotes(value));
}

/// `EXC 1 0.6,1.99`: of both approaches with 0. Curves without a line are zero.
std::string take_curve(MapHeader& header, std::string_view value) {
  const auto words = split(value, ' ');
  const auto refused = [&](std::string_view expected) {
    return fmt::format("rotary_curve: expected {}, found {}", expected, in_quotes(value.substr(0, 60)));
  };
  if (words.size() != 3 || words[0].size() != 3) return refused("a component such as EXC, an approach and values");
  const auto sense = sense_named(words[0].substr(0, 2));
  const auto approach = integer_in(words[1]);
  const auto numbers = numbers_in(words[2], kMostOfCurve);
  const auto axis =
      std::ranges::find_if(header.rotary, [&](const auto& one) { return one.axis.letter == words[0][2]; });
  if (!sense || axis == header.rotary.end()) return refused("a component of a rotary axis named in a line before");
  if (!approach || *approach < -1 || *approach > 1) return refused("the approach 1, -1 or 0 (both)");
  if (!numbers || numbers->size() > RotaryAxisWorking::kMostCells)
    return refused(
        fmt::format("at most {} numbers within {} with commas", +RotaryAxisWorking::kMostCells, kMostOfCurve));
  Curves& reverse = axis->compensation[0];
  if (!reverse[0].empty() && reverse[0].size() != numbers->size())
    return refused(fmt::format("{} values, as in the other curves of {}", reverse[0].size(), words[0][2]));
  for (Curves& side : axis->compensation)
    for (std::vector<double>& curve : side) curve.resize(numbers->size());
  if (*approach <= 0) axis->compensation[0][static_cast<std::size_t>(*sense)] = *numbers;
  if (*approach >= 0) axis->compensation[1][static_cast<std::size_t>(*sense)] = *numbers;
  return {};
}

}  // namespace

std::string rotary_lines(const MapHeader& header) {
  if (header.rotary.empty()) return {};
  std::string text = fmt::format("{}: {}\n", kConfigurationKey, header.rotary_configuration);
  for (const MapRotaryAxis& one : header.rotary) {
    text += fmt::format("{}: {}{}\n", kAxisKey, one.axis.letter, facts_text(one));
    for (std::size_t s = 0; s < 6; ++s) {
      const auto& [reverse, forward] = one.compensation;
      const auto line = [&](int approach, const std::vector<double>& values) {
        text +=
            fmt::format("{}: {} {} {}\n", kCurveKey, rotary_curve_name(one.axis.letter, s), approach, listed(values));
      };
      if (reverse[s] == forward[s]) {
        if (!all_zero(forward[s]) || (s == 0 && !forward[s].empty())) line(0, forward[s]);
      } else {
        line(1, forward[s]);
        line(-1, reverse[s]);
      }
    }
  }
  if (header.bending != RotaryBending{}) text += fmt::format("{}:{}\n", kBendingKey, facts_text(header.bending));
  return text;
}

bool is_rotary_key(std::string_view key) {
  return key == kConfigurationKey || key == kAxisKey || key == kCurveKey || key == kBendingKey;
}

std::string take_rotary_line(MapHeader& header, std::string_view key, std::string_view value) {
  if (key == kAxisKey) return take_axis(header, value);
  if (key == kCurveKey) return take_curve(header, value);
  if (key == kBendingKey) return take_bending(header, value);
  if (value.size() >= RotarySetup{}.configuration.size())
    return fmt::format("rotary_configuration: expected letters such as XYACTZ, found {}", in_quotes(value));
  header.rotary_configuration = value;
  return {};
}

std::string rotary_objection(const MapHeader& header, const UnitParameters& parameters) {
  if (header.rotary.empty()) return {};
  const PackedRotary packed(header);
  const auto working = std::make_unique<RotaryWorking>();
  const RotaryFault fault = compile_rotary_axes(packed.setup(), parameters, *working);
  if (fault == RotaryFault::none) return {};
  return fmt::format("the rotary axes ({}) {}", header.rotary_configuration, text_of(fault));
}

}  // namespace ecs::laser
