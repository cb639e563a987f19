#include "laser/map/build.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/units.hpp"
#include "laser/analysis/curve.hpp"
#include "laser/analysis/pipeline.hpp"
#include "laser/analysis/shrinking.hpp"
#include "laser/groups.hpp"

namespace ecs::laser {
namespace {

/// Which readings a component can be made from: axis moved and sense read.
struct Wanted {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
};

/// A curve with what must be remembered of its file.
struct SourceCurve {
  Curve curve;
  SourceFile source;
  double band = 0.0;  ///< range of the readings used [um, um/m]
  std::size_t readings = 0;
  std::optional<Repeatability> repeatability;
};

/// A refusal that names file and component.
Problem refusal(const std::filesystem::path& file, Component component, const std::string& why) {
  return Problem{ProblemKind::refused, fmt::format("{}: {}", name_of(component), why), file.string(), 0, 0, {}};
}

std::string parked_text(const Group& group) {
  std::string text;
  for (const Axis a : kAllAxes)
    if (a != group.axis)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", letter_of(a), group.parked_mm[index_of(a)]);
  return text;
}

std::string contents_of(const MeasurementSet& set) {
  std::string text;
  for (const Group& group : groups_of(set))
    text += fmt::format("{}{} along {} at {}", text.empty() ? "" : "; ", name_of(group.sense), letter_of(group.axis),
                        parked_text(group));
  return text.empty() ? "no readings" : text;
}

std::string text_of(const std::vector<Wanted>& wanted) {
  std::string text;
  for (const Wanted& want : wanted)
    text += fmt::format("{}{} along {}", text.empty() ? "" : " or ", name_of(want.sense), letter_of(want.axis));
  return text;
}

Result<Group> group_in(const MeasurementSet& set, const std::filesystem::path& path, Component component,
                       const std::vector<Wanted>& wanted) {
  std::vector<Group> fitting;
  for (const Group& group : groups_of(set))
    for (const Wanted& want : wanted)
      if (group.axis == want.axis && group.sense == want.sense) fitting.push_back(group);
  if (fitting.empty())
    return tl::unexpected(
        refusal(path, component, fmt::format("expected readings of {}, found {}", text_of(wanted), contents_of(set))));
  for (const Group& group : fitting)
    if (group.compensated.value_or(false))
      return tl::unexpected(refusal(path, component,
                                    "the readings were taken with compensation active (compensated = 1): a map needs "
                                    "the uncompensated error; switch the unit to integration mode and measure again"));
  if (fitting.size() > 1)
    return tl::unexpected(refusal(path, component,
                                  fmt::format("expected one measurement line of {}, found {}: split the file",
                                              text_of(wanted), contents_of(set))));
  return fitting.front();
}

double range_of(const MeasurementSet& set, const Group& group) {
  double lowest = set.readings[group.readings.front()].error;
  double highest = lowest;
  for (const std::size_t i : group.readings) {
    lowest = std::min(lowest, set.readings[i].error);
    highest = std::max(highest, set.readings[i].error);
  }
  return highest - lowest;
}

/// The readings of all other runs; refused if the file has no such run.
Result<Selection> without_runs(const MeasurementSet& set, const std::vector<int>& runs) {
  std::vector<Exclusion> exclusions;
  for (const int run : runs) exclusions.emplace_back().run = run;
  Selection selection = selected(set, exclusions);
  std::set<int> there;
  for (const Reading& reading : set.readings) there.insert(reading.run);
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (selection.left_out[i] == 0)
      return problem(ProblemKind::refused,
                     fmt::format("run {} cannot be excluded: the file has runs {}", runs[i], fmt::join(there, ", ")));
  return selection;
}

void remember(std::map<std::string, std::string>& seen, const std::string& value, const std::filesystem::path& path) {
  if (!value.empty()) seen.emplace(value, path.filename().string());
}

class MeasuredFiles {
 public:
  explicit MeasuredFiles(FileReader read) : read_(std::move(read)) {}

  /// The averaged curve of the one measurement line in a file that fits, without the excluded runs. Refused, naming
  /// file and component: no such readings (and what there is), more than one line of them, readings taken with
  /// compensation active, fewer than two targets, an excluded run that is not there.
  Result<SourceCurve> curve(const std::filesystem::path& path, Component component, const std::vector<Wanted>& wanted,
                            const std::vector<int>& exclude_runs) {
    ECS_TRY(loaded, load(path));
    const auto selection = without_runs(loaded->set, exclude_runs);
    if (!selection) return tl::unexpected(refusal(path, component, selection.error().message));
    ECS_TRY(group, group_in(selection->chosen, path, component, wanted));
    auto curve = averaged(selection->chosen, group);
    if (!curve) return tl::unexpected(refusal(path, component, curve.error().message));
    if (curve->points.size() < 2)
      return tl::unexpected(refusal(path, component, "expected at least two targets, found one"));
    SourceCurve source;
    source.curve = std::move(*curve);
    source.source = {std::string(name_of(component)), path.filename().string(), loaded->sha256};
    source.band = range_of(selection->chosen, group);
    source.readings = group.readings.size();
    source.repeatability = repeatability_of(selection->chosen, group);
    return source;
  }

  /// Kept for the curves.
  Result<void> read(const std::filesystem::path& path) {
    ECS_DO(load(path));
    return {};
  }

  /// Names in the metadata of the files used, each with one file that has it.
  [[nodiscard]] const std::map<std::string, std::string>& machines() const { return machines_; }
  [[nodiscard]] const std::map<std::string, std::string>& serial_numbers() const { return serial_numbers_; }

 private:
  struct Loaded {
    MeasurementSet set;
    std::string sha256;
  };
  Result<const Loaded*> load(const std::filesystem::path& path) {
    if (const auto known = files_.find(path); known != files_.end()) return &known->second;
    ECS_TRY(imported, read_(path));
    Loaded loaded{std::move(imported.set), std::move(imported.sha256)};
    const MeasuredMachine machine = measured_machine(loaded.set.metadata);
    remember(machines_, machine.name, path);
    remember(serial_numbers_, machine.serial_number, path);
    return &files_.emplace(path, std::move(loaded)).first->second;
  }

  FileReader read_;
  std::map<std::filesystem::path, Loaded> files_;
  std::map<std::string, std::string> machines_;
  std::map<std::string, std::string> serial_numbers_;
};

/// Squareness as the contract measures it: C0Y = E_X along Y, B0Z = E_X along Z, A0Z = E_Y along Z; also the other way
/// round, with the axes exchanged.
std::array<Wanted, 2> squares_for(Component c) {
  if (c == Component::C0Y) return {{{Axis::Y, Sense::EX}, {Axis::X, Sense::EY}}};
  if (c == Component::B0Z) return {{{Axis::Z, Sense::EX}, {Axis::X, Sense::EZ}}};
  return {{{Axis::Z, Sense::EY}, {Axis::Y, Sense::EZ}}};
}

/// The translation whose change along a parallel line shows a rotation (thesis 6.3.2.3): any but along the turning
/// axis.
std::vector<Wanted> translations_for(Component rotation) {
  std::vector<Wanted> wanted;
  for (const Axis direction : kAllAxes)
    if (direction != direction_of(sense_of(rotation)))
      wanted.push_back({moving_axis(rotation), static_cast<Sense>(direction)});
  return wanted;
}

/// Measurements are in ISO signs. The equations printed in the thesis take rotations about X and Z, and the squareness
/// of Y and of Z to Y, with the other sign.
double printed_sign(Component c) {
  const bool flipped = is_squareness(c) ? c != Component::B0Z : sense_of(c) == Sense::EA || sense_of(c) == Sense::EC;
  return flipped ? -1.0 : 1.0;
}

class Builder {
 public:
  Builder(const MapRecipe& recipe, const UnitParameters& parameters, const FileReader& read)
      : recipe_(recipe), needed_(components_needed(parameters)), files_(read) {
    built_.parameters = parameters;
  }

  Result<BuiltMap> build() {
    const auto chain = chain_of(built_.parameters);
    if (!chain) return problem(ProblemKind::refused, "the parameters describe no machine: run `ecs params check`");
    std::vector<Problem> problems;
    std::set<std::filesystem::path> unread;  // each is said once, also the second one of a component
    for (const ComponentRecipe& one : recipe_.components) {
      for (const std::filesystem::path& path : one.files)
        if (auto read = files_.read(path); !read && unread.insert(path).second)
          problems.push_back(std::move(read.error()));
      if (std::ranges::any_of(one.files, [&](const auto& path) { return unread.contains(path); })) continue;
      if (auto done = add(one); !done) problems.push_back(std::move(done.error()));
    }
    if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
    ECS_DO(fill_header());
    std::ranges::stable_sort(built_.map.tables, [](const MapTable& a, const MapTable& b) {
      if (a.component != b.component) return a.component < b.component;
      return static_cast<int>(a.approach) > static_cast<int>(b.approach);
    });
    return std::move(built_);
  }

 private:
  Result<void> add(const ComponentRecipe& one) {
    if (!needed_.contains(one.component))
      return tl::unexpected(refusal({}, one.component,
                                    fmt::format("a {} machine does not use it in this scope: remove it from the recipe",
                                                configuration_of(built_.parameters))));
    outcome_ = ComponentOutcome{};
    stated_ = {};
    lever_mm_ = kMmPerM;
    outcome_.component = one.component;
    auto done = is_squareness(one.component) ? add_squareness(one) : add_curve(one);
    if (done) built_.outcomes.push_back(outcome_);
    return done;
  }

  /// The curve of one file, its source and numbers kept.
  Result<Curve> curve_from(const std::filesystem::path& path, const ComponentRecipe& one,
                           const std::vector<Wanted>& wanted) {
    ECS_TRY(found, files_.curve(path, one.component, wanted, one.exclude_runs));
    outcome_.band = std::max(outcome_.band, found.band);
    outcome_.readings += found.readings;
    built_.map.header.sources.push_back(std::move(found.source));
    Curve curve = std::move(found.curve);
    if (found.repeatability) take_repeatability(*found.repeatability, curve, one.component);
    return curve;
  }

  /// The first file's, or that of the sum of two.
  void take_repeatability(const Repeatability& of_file, Curve& curve, Component component) {
    const double means = std::sqrt(std::max(1.0, of_file.repeats));
    stated_.value = std::hypot(stated_.value, of_file.reading / means);
    stated_.pass = std::hypot(stated_.pass, of_file.pass / means);
    stated_.degrees_of_freedom = stated_.degrees_of_freedom == 0
                                     ? of_file.pass_freedom
                                     : std::min(stated_.degrees_of_freedom, of_file.pass_freedom);
    if (!recipe_.shrink || is_squareness(component)) return;
    Shrunk less = shrunk(curve, of_file);
    note_step(component,
              fmt::format("shrunk according to its noise: {:.2f} {} rms removed, {:.0f} % of the freedom kept",
                          less.removed_rms, unit_of(curve.sense), 100.0 * less.kept));
    curve = std::move(less.curve);
  }

  /// @param factor  of the readings that became the component
  void state_uncertainty(Component component, double factor = 1.0) {
    if (stated_.value == 0.0 && stated_.pass == 0.0) return;
    built_.map.header.uncertainty.push_back(
        {component, factor * stated_.value, factor * stated_.pass, stated_.degrees_of_freedom});
  }

  // --- curves --------------------------------------------------------------------------------------------------------

  Result<void> add_curve(const ComponentRecipe& one) {
    ECS_TRY(measured, one.files.size() == 2 ? rotation_curve(one)
                                            : curve_from(one.files.front(), one,
                                                         {{moving_axis(one.component), sense_of(one.component)}}));
    if (!is_angular(one.component))
      if (auto off = off_line(measured)) return tl::unexpected(refusal(one.files.front(), one.component, *off));
    auto processed = process(measured, one);
    if (!processed) return tl::unexpected(refusal(one.files.front(), one.component, processed.error().message));
    put_tables(*processed, one.component);
    state_uncertainty(one.component, kMmPerM / lever_mm_);
    return {};
  }

  Result<Curve> rotation_curve(const ComponentRecipe& one) {
    auto first = curve_from(one.files[0], one, translations_for(one.component));
    if (!first) return first;
    auto second = curve_from(one.files[1], one, {{first->axis, first->sense}});
    if (!second) return second;
    auto rotation = rotation_from(*first, *second);
    if (!rotation) return tl::unexpected(refusal(one.files[1], one.component, rotation.error().message));
    if (rotation->sense != sense_of(one.component))
      return tl::unexpected(
          refusal(one.files[1], one.component,
                  fmt::format("the two lines differ so that they show {}, not {}",
                              name_of(curve_of(rotation->sense, rotation->axis)), name_of(one.component))));
    outcome_.band = band_of(*rotation);
    lever_mm_ = std::hypot(first->parked_mm[0] - second->parked_mm[0], first->parked_mm[1] - second->parked_mm[1],
                           first->parked_mm[2] - second->parked_mm[2]);
    note_step(one.component, fmt::format("from two runs of {} along {} on parallel lines", name_of(first->sense),
                                         letter_of(first->axis)));
    return rotation;
  }

  /// Why a translation curve was not measured where the parameters' lever arms begin.
  std::optional<std::string> off_line(const Curve& curve) const {
    const Vector3& line = built_.parameters.measurement_lines_mm[index_of(curve.axis)];
    for (const Axis a : kAllAxes) {
      if (a == curve.axis || !built_.parameters.axis_present[index_of(a)]) continue;
      const double parked_mm = curve.parked_mm[index_of(a)];
      if (std::abs(parked_mm - line[index_of(a)]) > kSameLine_mm)
        return fmt::format(
            "measured at {} {}, but the parameters' measurement line of {} is at {} {}: the angular terms would "
            "be counted from the wrong line; measure there or set axis.{}.measurement_line_mm",
            letter_of(a), parked_mm, letter_of(curve.axis), letter_of(a), line[index_of(a)], letter_of(curve.axis));
    }
    return std::nullopt;
  }

  /// Slope, smoothing, datum, grid: in this order, each step named in the header.
  Result<Curve> process(const Curve& curve, const ComponentRecipe& one) {
    const SlopeMethod method = one.slope.value_or(default_slope(one.component));
    ECS_TRY(steps, processed(curve, {method, one.smoothing_mm}));
    if (steps.smoothing_fault) return tl::unexpected(*steps.smoothing_fault);
    if (method != SlopeMethod::none) {
      outcome_.slope_um_per_m = steps.level.removed.slope_per_m;
      note_step(one.component, fmt::format("slope {:.2f} {}/m removed by {}", outcome_.slope_um_per_m,
                                           unit_of(one.component), name_of(method)));
    }
    if (steps.smooth) note_smoothing(*steps.smooth, one);
    ECS_TRY(zero_mm, zero_position_mm(one.component));
    ECS_TRY(zero, zeroed_at(steps.curve(), zero_mm));
    return on_grid(std::move(zero.curve), one);
  }

  /// Where a curve is zero. Translations: at the datum. A rotation: where its axis stood while the axes it levers were
  /// measured, for what it did there is inside their curves and squareness already.
  [[nodiscard]] Result<double> zero_position_mm(Component component) const {
    const std::size_t b = index_of(moving_axis(component));
    const auto terms = terms_of(built_.parameters);
    if (!terms) return problem(ProblemKind::refused, "the parameters describe no machine");
    std::optional<double> zero_mm;
    for (const Term& term : *terms) {
      if (term.component != component || !term.uses_coordinate) continue;
      const double line_mm = built_.parameters.measurement_lines_mm[index_of(term.lever)][b];
      if (zero_mm && std::abs(*zero_mm - line_mm) > kSameLine_mm)
        return problem(
            ProblemKind::refused,
            fmt::format("it acts over two levers whose axes were measured at {0} {1} and {0} {2}: the angle cannot "
                        "be zero at both; measure them with {0} at one position",
                        letter_of(moving_axis(component)), *zero_mm, line_mm));
      zero_mm = line_mm;
    }
    return zero_mm.value_or(built_.parameters.axes[b].datum.reference_position_mm);
  }

  void note_smoothing(const Smoothed& smooth, const ComponentRecipe& one) {
    outcome_.smoothed_rms = smooth.removed_rms;
    note_step(one.component, fmt::format("smoothed by a local quadratic over {} mm, {:.2f} {} rms removed",
                                         one.smoothing_mm, smooth.removed_rms, unit_of(one.component)));
    if (smooth.taken == Taken::signal)
      outcome_.notes.push_back(
          fmt::format("smoothing over {} mm also removes the shape of the curve (F {:.1f}): use a narrower window",
                      one.smoothing_mm, smooth.F.value_or(0.0)));
  }

  static Result<Curve> on_grid(Curve curve, const ComponentRecipe& one) {
    if (!one.increment_mm) return curve;
    const double first_mm = curve.points.front().position_mm;
    const double length_mm = curve.points.back().position_mm - first_mm;
    const Grid grid{first_mm, *one.increment_mm,
                    static_cast<int>(std::floor(length_mm / *one.increment_mm + 1e-9)) + 1};
    return resampled(curve, grid, Beyond::refuse);
  }

  void put_tables(const Curve& curve, Component component) {
    MapTable forward{component, Approach::forward, {}, {}};
    MapTable reverse{component, Approach::reverse, {}, {}};
    const bool both = curve.approach_known &&
                      std::ranges::any_of(curve.points, [](const CurvePoint& p) { return p.forward && p.reverse; });
    const double sign = unit_sign(component);
    for (const CurvePoint& p : curve.points) {
      if (both) {
        add_point(forward, p.position_mm, p.forward, sign);
        add_point(reverse, p.position_mm, p.reverse, sign);
      } else {
        add_point(forward, p.position_mm, mean_of(p), sign);
      }
    }
    if (!both) {
      forward.approach = Approach::unknown;
      outcome_.notes.push_back("measured from one side: the same table is used for both approaches");
    }
    outcome_.points = forward.position_mm.size();
    built_.map.tables.push_back(std::move(forward));
    if (both) built_.map.tables.push_back(std::move(reverse));
  }

  /// Sign in which the unit's equations take this component; said in the header where it is not the measured one.
  double unit_sign(Component component) {
    const bool printed = built_.parameters.convention == Convention::as_printed;
    const double sign = printed ? printed_sign(component) : 1.0;
    if (sign < 0.0) note_step(component, "in the sign of the equations printed in the thesis");
    return sign;
  }

  void add_point(MapTable& table, double position_mm, std::optional<double> error, double sign) {
    if (!error) return;
    table.position_mm.push_back(position_mm);
    table.compensation.push_back(0.0 - sign * *error);
    outcome_.largest = std::max(outcome_.largest, std::abs(*error));
  }

  // --- squareness ----------------------------------------------------------------------------------------------------

  Result<void> add_squareness(const ComponentRecipe& one) {
    const auto squares = squares_for(one.component);
    ECS_TRY(curve, curve_from(one.files.front(), one, {squares.begin(), squares.end()}));
    const auto square = squareness_of(curve);
    if (!square) return tl::unexpected(refusal(one.files.front(), one.component, square.error().message));
    double& value = squareness_um_per_m(built_.parameters, one.component);
    value = unit_sign(one.component) * square->um_per_m;
    outcome_.largest = std::abs(square->um_per_m);
    const double length_m = std::abs(curve.points.back().position_mm - curve.points.front().position_mm) / kMmPerM;
    // The straight line of a pass: a quarter of its mean square (volume/curve_covariance.hpp), over the length
    // measured.
    stated_.value = std::hypot(square->std_error_um_per_m.value_or(0.0), std::sqrt(3.0) * stated_.pass / length_m);
    stated_.pass = 0.0;
    state_uncertainty(one.component);
    outcome_.slope_um_per_m = square->indicator_slope_um_per_m;
    outcome_.points = curve.points.size();
    note_step(one.component, fmt::format("{:.2f} um/m, in the parameters", value));
    return {};
  }

  // --- header --------------------------------------------------------------------------------------------------------

  void note_step(Component component, const std::string& what) {
    built_.map.header.processing.push_back(fmt::format("{} {}", name_of(component), what));
  }

  Result<void> fill_header() {
    MapHeader& header = built_.map.header;
    header.customer = recipe_.customer;
    header.engineer = recipe_.engineer;
    header.date = recipe_.date;
    header.configuration = configuration_of(built_.parameters);
    header.declared_zero = recipe_.declared_zero;
    ECS_TRY(machine, only_one(recipe_.machine, files_.machines(), "machine"));
    ECS_TRY(serial_number, only_one(recipe_.serial_number, files_.serial_numbers(), "serial_number"));
    header.machine = std::move(machine);
    header.serial_number = std::move(serial_number);
    return {};
  }

  /// What the recipe states, else the one name that all files agree on.
  static Result<std::string> only_one(const std::string& stated, const std::map<std::string, std::string>& seen,
                                      std::string_view key) {
    if (!stated.empty()) return stated;
    if (seen.size() > 1)
      return problem(ProblemKind::refused, fmt::format("the files come from more than one machine: {} is {} in {} and "
                                                       "{} in {}; remove the wrong file, or state {} in the recipe",
                                                       key, seen.begin()->first, seen.begin()->second,
                                                       seen.rbegin()->first, seen.rbegin()->second, key));
    return seen.empty() ? std::string() : seen.begin()->first;
  }

  const MapRecipe& recipe_;
  ComponentSet needed_;
  BuiltMap built_;
  ComponentOutcome outcome_;
  StatedUncertainty stated_;   ///< of the readings of the component under way
  double lever_mm_ = kMmPerM;  ///< distance of its two lines
  MeasuredFiles files_;
};

}  // namespace

Result<BuiltMap> build_map(const MapRecipe& recipe, const UnitParameters& parameters, const FileReader& read) {
  auto built = Builder(recipe, parameters, read).build();
  if (built && !recipe.remark.empty()) built->map.header.processing.push_back("remark: " + recipe.remark);
  return built;
}

}  // namespace ecs::laser
