#include "volume/rotary_errors.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "laser/csv_table.hpp"
#include "laser/groups.hpp"
#include "volume/field.hpp"

namespace ecs::volume {
namespace {

using kinematics::Joint;
using kinematics::JointChain;

constexpr double kTurn_deg = 360.0;
constexpr double kFurthestAngle_deg = 3600.0;
constexpr double kLargestError = 32'000.0;  ///< as in a map: more is a wrong unit
constexpr std::array<std::string_view, 4> kRotaryColumns{"component", "approach", "p_deg", "error"};

/// True where a table goes round: what is missing to a turn is no longer than twice its mean step.
bool closes(const RotaryTable& table) {
  if (table.p_deg.size() < 3) return false;
  const double span = table.p_deg.back() - table.p_deg.front();
  return span >= kTurn_deg - 2.0 * span / static_cast<double>(table.p_deg.size() - 1);
}

struct RotaryComponent {
  Joint joint = Joint::C;
  bool is_location = false;
  std::size_t sense = 0;  ///< X, Y, Z, A, B, C
};

std::optional<RotaryComponent> component_in(std::string_view name) {
  if (name.size() != 3) return std::nullopt;
  const auto joint = kinematics::joint_of(name[2]);
  if (!joint || !kinematics::is_rotary(*joint)) return std::nullopt;
  if (const auto sense = sense_named(name.substr(0, 2)))
    return RotaryComponent{*joint, false, static_cast<std::size_t>(*sense)};
  const std::size_t sense = std::string_view("XYZABC").find(name[0]);
  if (name[1] != 'O' || sense == std::string_view::npos) return std::nullopt;
  return RotaryComponent{*joint, true, sense};
}

/// The rows of one file.
class RotaryReader {
 public:
  RotaryReader(laser::TableReader& row, const JointChain& chain) : row_(row), chain_(chain) {}

  void take() {
    const auto component = component_in(row_.text("component"));
    if (!component) return row_.wrong("component", "an error of a rotary axis, such as EXC, EAB or XOC");
    if (!chain_.has(component->joint))
      return row_.wrong("component", fmt::format("an axis of the machine ({}), which has no {}",
                                                 kinematics::iso_notation(chain_), letter_of(component->joint)));
    const auto error = number_in(row_.text("error"));
    if (!error || std::abs(*error) > kLargestError) return row_.wrong("error", "a number of um or um/m within 32000");
    std::optional<double> u;
    if (row_.has("u") && !row_.text("u").empty()) {
      u = number_in(row_.text("u"));
      if (!u || *u < 0.0 || *u > kLargestError)
        return row_.wrong("u", "a standard uncertainty in um or um/m, 0 or more");
    }
    if (row_.has("with") && !row_.text("with").empty() && !take_ties(*component)) return;
    component->is_location ? take_location(*component, *error, u) : take_motion(*component, *error, u);
  }

  RotaryErrors finish() {
    for (RotaryTable& table : errors_.tables) sort_by_angle(table);
    return std::move(errors_);
  }

 private:
  void take_location(const RotaryComponent& component, double error, std::optional<double> u) {
    if (!row_.text("p_deg").empty())
      return row_.wrong("p_deg", "nothing: a location error is a constant of the axis line");
    if (!row_.text("approach").empty() && row_.text("approach") != "0")
      return row_.wrong("approach", "0 or nothing: a location error has no approach");
    const std::size_t rotary = index_of(component.joint) - kAxes;
    if (const std::pair key{rotary, component.sense}; std::ranges::find(given_, key) == given_.end())
      given_.push_back(key);
    else
      return row_.refuse("p_deg", fmt::format("component: {}O{} occurs twice, found {}", "XYZABC"[component.sense],
                                              letter_of(component.joint), laser::in_quotes(row_.text("p_deg"))));
    errors_.location[rotary][component.sense] = error;
    errors_.location_u[rotary][component.sense] = u;
    errors_.location_given[rotary][component.sense] = true;
  }

  bool take_ties(const RotaryComponent& component) {
    if (!component.is_location) {
      row_.wrong("with", "nothing: only location errors are stated with others");
      return false;
    }
    for (const std::string_view one : split(row_.text("with"), ' ')) {
      const auto colon = std::min(one.find(':'), one.size());
      const auto other = component_in(one.substr(0, colon));
      const auto by = number_in(one.substr(std::min(colon + 1, one.size())));
      if (!other || !other->is_location || !chain_.has(other->joint) || !by || std::abs(*by) > kLargestError ||
          place_of(*other) == place_of(component)) {
        row_.wrong("with", "another location error of the machine and a factor, such as YOC:-1");
        return false;
      }
      errors_.ties.push_back({place_of(component), place_of(*other), *by});
    }
    return true;
  }

  static std::array<std::size_t, 2> place_of(const RotaryComponent& location) {
    return {index_of(location.joint) - kAxes, location.sense};
  }

  void take_motion(const RotaryComponent& component, double error, std::optional<double> u) {
    const auto p_deg = number_in(row_.text("p_deg"));
    if (!p_deg || std::abs(*p_deg) > kFurthestAngle_deg) return row_.wrong("p_deg", "an angle within 3600 deg of 0");
    const auto side = row_.text("approach").empty() ? std::optional(0.0) : number_in(row_.text("approach"));
    if (!side || (*side != 0.0 && *side != 1.0 && *side != -1.0)) return row_.wrong("approach", "1, -1 or 0");
    RotaryTable& table = table_for(component, static_cast<Approach>(static_cast<int>(*side)));
    if (std::ranges::find(table.p_deg, *p_deg) != table.p_deg.end())
      return row_.wrong("p_deg", "each angle once in a component and approach");
    table.p_deg.push_back(*p_deg);
    table.error.push_back(error);
    if (u ? table.u.size() + 1 != table.error.size() : !table.u.empty())
      return row_.refuse(
          "p_deg", "u: expected a standard uncertainty at every angle of a component and approach or at none, found " +
                       laser::in_quotes(row_.text("p_deg")));
    if (u) table.u.push_back(*u);
  }

  RotaryTable& table_for(const RotaryComponent& component, Approach approach) {
    const auto sense = static_cast<Sense>(component.sense);
    for (RotaryTable& table : errors_.tables)
      if (table.joint == component.joint && table.sense == sense && table.approach == approach) return table;
    return errors_.tables.emplace_back(RotaryTable{component.joint, sense, approach, {}, {}, {}});
  }

  static void sort_by_angle(RotaryTable& table) {
    std::vector<std::tuple<double, double, double>> points;
    for (std::size_t i = 0; i < table.p_deg.size(); ++i)
      points.emplace_back(table.p_deg[i], table.error[i], table.u.empty() ? 0.0 : table.u[i]);
    std::ranges::sort(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::tie(table.p_deg[i], table.error[i], std::ignore) = points[i];
      if (!table.u.empty()) table.u[i] = std::get<2>(points[i]);
    }
  }

  laser::TableReader& row_;
  const JointChain& chain_;
  std::vector<std::pair<std::size_t, std::size_t>> given_;
  RotaryErrors errors_;
};

}  // namespace

TableWeights weights_in(const RotaryTable& table, double angle_deg) {
  const auto& p = table.p_deg;
  const auto between = [](std::size_t below, std::size_t above, double part) {
    return TableWeights{{below, above}, {1.0 - part, part}};
  };
  double angle = angle_deg;
  if (closes(table)) {
    angle = p.front() + std::fmod(angle_deg - p.front(), kTurn_deg);
    if (angle < p.front()) angle += kTurn_deg;
    const double rest = p.front() + kTurn_deg - p.back();
    if (angle > p.back()) return between(p.size() - 1, 0, rest > 0.0 ? (angle - p.back()) / rest : 0.0);
  }
  if (angle <= p.front()) return {};
  if (angle >= p.back()) return {{p.size() - 1, 0}, {1.0, 0.0}};
  const auto next = static_cast<std::size_t>(std::upper_bound(p.begin(), p.end(), angle) - p.begin());
  return between(next - 1, next, (angle - p[next - 1]) / (p[next] - p[next - 1]));
}

double value_at(const RotaryTable& table, double angle_deg) {
  if (table.p_deg.empty()) return 0.0;
  const TableWeights at = weights_in(table, angle_deg);
  return at.weight[0] * table.error[at.value[0]] + at.weight[1] * table.error[at.value[1]];
}

const RotaryTable* table_of(const RotaryErrors& errors, Joint joint, Sense sense, Approach side) {
  for (const RotaryTable& table : errors.tables)
    if (table.joint == joint && table.sense == sense && (table.approach == side || table.approach == Approach::unknown))
      return &table;
  return nullptr;
}

kinematics::JointValues rotary_values(const RotaryErrors& errors, const kinematics::Angles& angles_deg, Approach side) {
  kinematics::JointValues values;
  for (std::size_t r = 0; r < kAxes; ++r) values.curve[kAxes + r] = errors.location[r];
  for (const RotaryTable& table : errors.tables) {
    const std::size_t joint = index_of(table.joint);
    if (&table == table_of(errors, table.joint, table.sense, side))
      values.curve[joint][static_cast<std::size_t>(table.sense)] += value_at(table, angles_deg[joint - kAxes]);
  }
  return values;
}

RotaryErrors rotary_errors_in(const laser::MapHeader& header, double factor) {
  RotaryErrors errors;
  errors.bending = header.bending;
  for (auto* const sizes : {&errors.bending.of_machine, &errors.bending.of_tool})
    for (double& size : *sizes) size *= factor;
  for (const laser::MapRotaryAxis& one : header.rotary) {
    const Joint joint = *kinematics::joint_of(one.axis.letter);
    for (std::size_t s = 0; s < kSenseNames.size(); ++s) {
      errors.location[index_of(joint) - kAxes][s] = factor * one.axis.location[s];
      errors.location_given[index_of(joint) - kAxes][s] = true;
      for (std::size_t side = 0; side < kSides.size(); ++side) {
        RotaryTable table{joint, static_cast<Sense>(s), kSides[side], {}, {}, {}};
        for (const double compensation : one.compensation[side][s]) {
          table.p_deg.push_back(one.start_deg + one.increment_deg * static_cast<double>(table.p_deg.size()));
          table.error.push_back(-factor * compensation);
        }
        if (!table.p_deg.empty()) errors.tables.push_back(std::move(table));
      }
    }
  }
  return errors;
}

std::string rotary_name(Joint joint, Sense sense) {
  return fmt::format("{}{}", name_of(sense), kinematics::letter_of(joint));
}

std::string location_name(std::size_t rotary, std::size_t sense) {
  return fmt::format("{}O{}", "XYZABC"[sense], "ABC"[rotary]);
}

Result<RotaryErrors> parse_rotary_errors(std::string_view text, const std::string& file_name, const JointChain& chain) {
  laser::Findings findings(file_name);
  ECS_TRY(table, laser::parse_csv_table(text, file_name, kRotaryColumns, findings));
  laser::TableReader row_reader(table, findings);
  RotaryReader reader(row_reader, chain);
  for (const laser::CsvRow& row : table.rows) {
    row_reader.take(row);
    reader.take();
  }
  RotaryErrors errors = reader.finish();
  if (table.rows.empty() && findings.empty()) findings.add(table.header_line, 0, "expected rows below the header");
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return errors;
}

Result<RotaryErrors> read_rotary_errors(const std::filesystem::path& file, const JointChain& chain) {
  ECS_TRY(text, read_file_of(FileKind::rotary_errors, file));
  return parse_rotary_errors(text, file.string(), chain);
}

namespace {

kinematics::Joint rotary_joint(Axis about) { return static_cast<kinematics::Joint>(kAxes + index_of(about)); }

void add_means(RotaryErrors& errors, const laser::MeasurementSet& set, const laser::Group& group, Approach approach,
               const std::vector<double> laser::TargetReadings::*readings) {
  RotaryTable table{rotary_joint(group.axis), group.sense, approach, {}, {}, {}};
  double squares = 0.0, freedom = 0.0;
  std::vector<double> share;
  for (const laser::TargetReadings& target : targets_of(set, group, target_tolerance_mm(set, group)))
    if (const auto mean = laser::mean_of(target.*readings)) {
      table.p_deg.push_back(target.position_mm);
      table.error.push_back(*mean);
      const double count = static_cast<double>((target.*readings).size());
      if (const auto deviation = laser::deviation_of(target.*readings)) {
        squares += *deviation * *deviation * (count - 1.0);
        freedom += count - 1.0;
      }
      share.push_back(1.0 / std::sqrt(count));
    }
  if (freedom > 0.0)  // the scatter of all targets together: a few readings at one tell theirs badly
    for (const double one : share) table.u.push_back(one * std::sqrt(squares / freedom));
  if (!table.p_deg.empty()) errors.tables.push_back(std::move(table));
}

}  // namespace

Result<RotaryErrors> measured_rotary_errors(const laser::MeasurementSet& set) {
  for (const laser::Reading& reading : set.readings)
    if (!reading.rotary)
      return problem_at(set.source, std::max(1, reading.line), 0,
                        "expected readings of rotary axes as in the rows before, found the linear axis {}: use a "
                        "separate map for linear axes",
                        ecs::letter_of(reading.axis));
  RotaryErrors errors;
  for (const laser::Group& group : groups_of(set)) {
    const std::string name = rotary_name(rotary_joint(group.axis), group.sense);
    for (const RotaryTable& table : errors.tables)
      if (table.joint == rotary_joint(group.axis) && table.sense == group.sense)
        return problem_at(set.source, std::max(1, set.readings[group.readings.front()].line), 0,
                          "expected {} at one position of the other axes, found a second", name);
    if (has_known_approach(set, group)) {
      add_means(errors, set, group, Approach::forward, &laser::TargetReadings::forward);
      add_means(errors, set, group, Approach::reverse, &laser::TargetReadings::reverse);
    } else {
      add_means(errors, set, group, Approach::unknown, &laser::TargetReadings::undirected);
    }
  }
  return errors;
}

std::string rotary_csv(const RotaryErrors& errors, const std::string& machine) {
  std::string text = machine.empty() ? "" : fmt::format("# machine: {}\n", shown_line(machine));
  text += errors.ties.empty() ? "component,approach,p_deg,error,u\n" : "component,approach,p_deg,error,u,with\n";
  const auto u_text = [](const std::optional<double>& u) { return u ? fmt::format("{:.4f}", *u) : std::string(); };
  const auto with_text = [&](std::size_t r, std::size_t s) {
    std::string with;
    for (const LocationTie& tie : errors.ties)
      if (tie.of == std::array{r, s})
        with += fmt::format("{}{}:{:.6g}", with.empty() ? "" : " ", location_name(tie.other[0], tie.other[1]), tie.by);
    return errors.ties.empty() ? with : "," + with;
  };
  for (std::size_t r = 0; r < kAxes; ++r)
    for (std::size_t s = 0; s < kSenseNames.size(); ++s)
      if (errors.location[r][s] != 0.0 || errors.location_given[r][s])
        text += fmt::format("{},,,{:.4f},{}{}\n", location_name(r, s), errors.location[r][s],
                            u_text(errors.location_u[r][s]), with_text(r, s));
  for (const RotaryTable& table : errors.tables)
    for (std::size_t i = 0; i < table.p_deg.size(); ++i)
      text += fmt::format("{},{},{:.6g},{:.4f},{}{}\n", rotary_name(table.joint, table.sense),
                          static_cast<int>(table.approach), table.p_deg[i], table.error[i],
                          u_text(table.u.empty() ? std::nullopt : std::optional(table.u[i])),
                          errors.ties.empty() ? "" : ",");
  return text;
}

}  // namespace ecs::volume
