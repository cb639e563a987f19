#include "laser/import/fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/csv_columns.hpp"
#include "laser/findings.hpp"
#include "laser/import/time.hpp"

namespace ecs::laser {
namespace {

constexpr std::string_view kTip = "tip_";

/// Column of the standard uncertainty of the reading.
constexpr std::string_view kUncertaintyField = "u_um";

/// The kind of unit that a field may have; nothing: none.
std::optional<UnitKind> kind_of(const Field& field) {
  if (field.role == Role::position || field.role == Role::measured) return UnitKind::length;
  if (field.role == Role::angle) return UnitKind::angle;
  if (is_sensor_column(field.rule.field)) return UnitKind::temperature;
  if (field.rule.field == "pressure_hPa") return UnitKind::pressure;
  if (field.rule.field == "time_s") return UnitKind::time;
  if (field.rule.field == kUncertaintyField && field.rule.unit && field.rule.unit->kind == UnitKind::angle)
    return UnitKind::angle;
  if (field.rule.field == kUncertaintyField) return UnitKind::length;
  return std::nullopt;
}

/// The cell in the unit used inside, before the rule's own factor and offset.
double converted(const ColumnRule& rule, double value) {
  return rule.unit ? value * rule.unit->factor + rule.unit->offset : value;
}

std::string unit_fault(const Field& field, std::string_view shown, bool fits) {
  if (fits) return {};
  return fmt::format("columns: {}: {} is not one of its units", field.rule.field, shown);
}

std::string units_fault(const Plan& plan) {
  for (const Field& field : plan.fields) {
    if (!field.rule.unit || (is_value(field.role) && field.role != Role::measured) || field.role == Role::target)
      continue;
    const auto kind = kind_of(field);
    if (const std::string fault = unit_fault(field, field.rule.unit->name, kind && *kind == field.rule.unit->kind);
        !fault.empty())
      return fault;
  }
  return {};
}

/// Each measured position needs its nominal one, or the column of its point; those of a ball the angles.
std::string measured_fault(const std::vector<Field>& fields) {
  const auto has = [&](std::string_view name) {
    return std::ranges::any_of(fields, [&](const Field& other) { return other.rule.field == name; });
  };
  for (const Field& field : fields) {
    const auto axis = measured_direction(field.rule.field);
    if (!axis) continue;
    const std::string_view nominal = kPositionColumns[index_of(*axis)];
    if (!is_tip(field.rule.field)) {
      if (!has(nominal) && !has(kPointColumn))
        return fmt::format("columns: {} needs {}, the nominal position, or {}, the number of the point, found none",
                           field.rule.field, nominal, kPointColumn);
      continue;
    }
    if (has(nominal))
      return fmt::format("columns: {} is compared with its mean: expected no {}", field.rule.field, nominal);
    for (const char letter : {'x', 'y', 'z'})
      if (!has(fmt::format("tip_{}_mm", letter)))
        return fmt::format("columns: expected tip_x_mm, tip_y_mm and tip_z_mm, found no tip_{}_mm", letter);
    if (!has_role(fields, Role::angle))
      return "columns: tip_x_mm needs a_deg, b_deg or c_deg, the angles of the rotary axes, found none";
  }
  return {};
}

}  // namespace

std::optional<Pass> pass_named(std::string_view field) {
  for (const auto& [word, approach] : {std::pair<std::string_view, Approach>{"forward", Approach::forward},
                                       std::pair<std::string_view, Approach>{"reverse", Approach::reverse}}) {
    if (!field.starts_with(word)) continue;
    const std::string_view number = field.substr(word.size());
    if (number.empty()) return Pass{approach, 0};
    const auto run = integer_in(number);
    if (run && *run >= 1 && *run <= 1'000'000) return Pass{approach, static_cast<int>(*run)};
  }
  return std::nullopt;
}

std::optional<Axis> measured_direction(std::string_view field) {
  constexpr std::string_view kMeasured = "measured_";
  if (!field.starts_with(kMeasured) && !field.starts_with(kTip)) return std::nullopt;
  for (const Axis axis : kAllAxes)
    if (field.substr(field.find('_') + 1) == kPositionColumns[index_of(axis)]) return axis;
  return std::nullopt;
}

bool is_tip(std::string_view field) { return field.starts_with(kTip) && measured_direction(field); }

Role role_of(std::string_view name) {
  if (std::ranges::find(kPositionColumns, name) != kPositionColumns.end()) return Role::position;
  if (std::ranges::find(kAngleColumns, name) != kAngleColumns.end()) return Role::angle;
  if (measured_direction(name)) return Role::measured;
  if (name == "reading") return Role::error;
  if (sense_named(name)) return Role::own_sense;
  if (pass_named(name)) return Role::pass;
  if (name == "axis") return Role::axis;
  if (name == "target") return Role::target;
  if (name == "sense") return Role::sense;
  if (name == "approach") return Role::approach;
  return name == "date_time" ? Role::date_time : Role::other;
}

bool is_value(Role role) {
  return role == Role::error || role == Role::own_sense || role == Role::pass || role == Role::measured;
}

bool has_role(const std::vector<Field>& fields, Role role) {
  return std::ranges::any_of(fields, [&](const Field& field) { return field.role == role; });
}

std::optional<double> cell_number(const Plan& plan, std::string_view cell) {
  if (plan.decimal == '.') return number_in(cell);
  return number_or_comma(cell);
}

std::string set_error(Reading& reading, const Plan& plan, const Field& field, double cell) {
  const ColumnRule& rule = field.rule;
  if (field.role == Role::measured) {
    const double measured_mm = converted(rule, cell) * rule.factor + rule.offset;
    reading.error = (measured_mm - reading.position_mm[index_of(direction_of(reading.sense))]) * kUmPerMm;
    return {};
  }
  const bool angle = is_rotation(reading.sense);
  if (rule.unit)
    if (const std::string fault =
            unit_fault(field, rule.unit->name, rule.unit->kind == (angle ? UnitKind::angle : UnitKind::length));
        !fault.empty())
      return fault;
  if (plan.values == TableValues::actual_positions) {
    const std::size_t own = index_of(reading.axis) + (reading.rotary ? kAxes : 0);
    if (own != static_cast<std::size_t>(reading.sense))
      return "values are positions: expected a sense along the moving axis";
    if (reading.rotary) {
      const double actual = rule.unit ? converted(rule, cell) : cell * kUmPerMPerDegree;
      reading.error = actual * rule.factor + rule.offset - target_of(reading) * kUmPerMPerDegree;
      return {};
    }
    reading.error = (converted(rule, cell) * rule.factor + rule.offset - target_mm(reading)) * kUmPerMm;
    return {};
  }
  const double inside = converted(rule, cell) * (rule.unit && !angle ? kUmPerMm : 1.0);
  reading.error = (inside * rule.factor + rule.offset) * (plan.values == TableValues::compensations ? -1.0 : 1.0);
  return {};
}

std::string set_common(Reading& reading, const Plan& plan, const Field& field, std::string_view cell) {
  const auto expected = [&](std::string_view what) {
    return fmt::format("{}: expected {}, found {}", field.rule.field, what, in_quotes(cell));
  };
  if (field.role == Role::axis) {
    std::string letter(cell);
    if (letter.size() == 1 && lower(letter) == letter) letter[0] = static_cast<char>(letter[0] - 'a' + 'A');
    const auto named = axis_named(letter);
    if (!named) return expected("X, Y, Z, A, B or C");
    reading.axis = named->axis;
    reading.rotary = named->rotary;
    return {};
  }
  if (field.role == Role::sense) {
    const auto sense = sense_named(cell);
    if (!sense) return expected("EX, EY, EZ, EA, EB or EC");
    reading.sense = *sense;
    return {};
  }
  if (field.role == Role::approach) {
    const auto approach = approach_named(cell);
    if (!approach) return expected("1, -1, 0, forward or reverse");
    reading.approach = *approach;
    return {};
  }
  if (field.role == Role::date_time) {
    const auto seconds = seconds_in(cell);
    if (!seconds) return expected("a date and time (2024-05-06 09:10:11) or a time of day");
    reading.time_s = *seconds;
    return {};
  }
  if (cell.empty() && field.role == Role::other) return {};
  const auto number = cell_number(plan, cell);
  if (!number && (is_known_column(field.rule.field) || field.rule.field == kUncertaintyField))
    return expected("a finite number");
  if (!number) {
    reading.text_extras[field.rule.field] = std::string(cell);
    return {};
  }
  const bool in_angle = field.role == Role::angle && field.rule.unit;
  const double value = (in_angle ? converted(field.rule, *number) / kUmPerMPerDegree : converted(field.rule, *number)) *
                           field.rule.factor +
                       field.rule.offset;
  if (!std::isfinite(value)) return expected("a number that stays finite");
  if (field.rule.field == kUncertaintyField) {
    const bool in_mm = field.rule.unit && field.rule.unit->kind == UnitKind::length;
    const double uncertainty = value * (in_mm ? kUmPerMm : 1.0);
    if (!(uncertainty > 0.0)) return expected("a standard uncertainty above 0");
    reading.extras[field.rule.field] = uncertainty;
    return {};
  }
  if (!is_known_column(field.rule.field)) {
    reading.extras[field.rule.field] = value;
    return {};
  }
  return set_cell(reading, field.rule.field, shortest(value));
}

std::string set_target(Reading& reading, const Plan& plan, const Field& field, std::string_view cell) {
  const ColumnRule& rule = field.rule;
  const auto kind = reading.rotary ? UnitKind::angle : UnitKind::length;
  if (rule.unit && rule.unit->kind != kind) return unit_fault(field, rule.unit->name, false);
  const auto number = cell_number(plan, cell);
  if (!number) return fmt::format("target: expected a finite number, found {}", in_quotes(cell));
  const double in_degrees = reading.rotary && rule.unit ? kUmPerMPerDegree : 1.0;
  const double value = converted(rule, *number) / in_degrees * rule.factor + rule.offset;
  if (!std::isfinite(value)) return "target: expected a number that stays finite";
  return set_cell(reading, target_column(reading.axis, reading.rotary), shortest(value));
}

std::string take_units(Plan& plan, const ImportOptions& options) {
  if (options.target_unit && options.target_unit->kind != (plan.rotary ? UnitKind::angle : UnitKind::length))
    return fmt::format("{} is not a unit of {}", options.target_unit->name, plan.rotary ? "angle" : "length");
  for (Field& field : plan.fields) {
    if (field.rule.unit) continue;
    if (field.role == (plan.rotary ? Role::angle : Role::position) || field.role == Role::measured ||
        field.role == Role::target)
      field.rule.unit = options.target_unit;
    if (field.role == Role::measured) continue;
    if (!is_value(field.role) || !options.reading_unit) continue;
    const Sense own = plan.rotary ? Sense::EA : Sense::EX;
    const Sense sense = sense_named(field.rule.field).value_or(plan.sense.value_or(own));
    const UnitKind kind = is_rotation(sense) ? UnitKind::angle : UnitKind::length;
    if (options.reading_unit->kind != kind && !has_role(plan.fields, Role::sense))
      return fmt::format("{} is not a unit of {}", options.reading_unit->name, name_of(sense));
    field.rule.unit = options.reading_unit;
  }
  return {};
}

namespace {

/// A field that differs from a known one by underscores only is a typing error; any other is kept as a column.
std::string misspelt(const std::vector<Field>& fields) {
  const auto bare = [](std::string_view name) {
    std::string letters = lower(std::string(name));
    std::erase(letters, '_');
    return letters;
  };
  for (const Field& field : fields)
    for (const auto* known : {&kPositionColumns, &kAngleColumns})
      for (const std::string_view name : *known)
        if (field.rule.field != name && bare(field.rule.field) == bare(name))
          return fmt::format("columns: there is no field {}; {} is the target", field.rule.field, name);
  return {};
}

}  // namespace

std::string plan_fault(const Plan& plan) {
  if (std::string fault = misspelt(plan.fields); !fault.empty()) return fault;
  if (std::ranges::none_of(plan.fields, [](const Field& f) { return is_value(f.role); }))
    return "columns: expected one of reading, EX, EY, EZ, EA, EB, EC, forwardN, reverseN or measured_x_mm, found none";
  if (std::string fault = measured_fault(plan.fields); !fault.empty()) return fault;
  if (has_role(plan.fields, Role::measured)) return units_fault(plan);
  if (!has_role(plan.fields, Role::axis) && !plan.axis)
    return "the table does not state which axis moved. Name the column of that axis with --columns, or give the axis "
           "(X, Y or Z; for a rotary axis A, B or C)";
  if (plan.axis && !has_role(plan.fields, Role::axis) && !has_role(plan.fields, Role::date_time) &&
      !plan.parked_stated[index_of(*plan.axis)] && std::ranges::none_of(plan.fields, [&](const Field& f) {
        return f.rule.field == target_column(*plan.axis, plan.rotary) || f.rule.field == "time_s" ||
               f.role == Role::target;
      }))
    return fmt::format(
        "columns: expected {} (the target of the moving axis), found none; one target for all rows is given as "
        "--parked {}=MM",
        target_column(*plan.axis, plan.rotary), lower(std::string(1, letter_of(*plan.axis))));
  return units_fault(plan);
}

namespace {

/// How headings spell units beside their names.
constexpr std::array<std::pair<std::string_view, std::string_view>, 29> kSpellings{{
    {"zoll", "in"},
    {"inches", "in"},
    {"pouce", "in"},
    {"pouces", "in"},
    {"micron", "um"},
    {"microns", "um"},
    {"mikrometer", "um"},
    {"micrometer", "um"},
    {"micrometre", "um"},
    {"millimeter", "mm"},
    {"millimetre", "mm"},
    {"meter", "m"},
    {"metre", "m"},
    {"grad", "deg"},
    {"degree", "deg"},
    {"degrees", "deg"},
    {"\xC2\xB0", "deg"},
    {"\xC2\xB0"
     "c",
     "degC"},
    {"deg c", "degC"},
    {"celsius", "degC"},
    {"\xE2\x84\x83", "degC"},
    {"\xC2\xB0"
     "f",
     "degF"},
    {"fahrenheit", "degF"},
    {"sek", "s"},
    {"sec", "s"},
    {"seconds", "s"},
    {"winkelsekunden", "arcsec"},
    {"c", "degC"},
    {"f", "degF"},
}};

/// Written out, they mean nothing else at the end of a heading.
constexpr std::array<std::string_view, 21> kPlain{"mm",     "um",   "nm",   "cm",   "inch", "mil",  "arcsec",
                                                  "arcmin", "mrad", "urad", "um/m", "mm/m", "degC", "degF",
                                                  "deg",    "hPa",  "mbar", "kPa",  "mmHg", "inHg", "in"};

/// "µ" and "μ" as u.
std::string with_plain_micro(std::string text) {
  for (const std::string_view micro : {"\xC2\xB5", "\xCE\xBC"})
    for (std::size_t at = text.find(micro); at != std::string::npos; at = text.find(micro)) text.replace(at, 2, "u");
  return text;
}

std::optional<Unit> spelt(std::string_view word) {
  const std::string plain = with_plain_micro(lower(trimmed(word)));
  const auto* const found =
      std::ranges::find_if(kSpellings, [&](const auto& spelling) { return spelling.first == plain; });
  return unit_named(found == kSpellings.end() ? std::string_view(plain) : found->second);
}

/// A temperature of one letter needs a heading of temperature: (F) is forward, (C) an axis.
bool is_doubtful(std::string_view word, const Unit& unit, std::string_view heading) {
  if (unit.kind != UnitKind::temperature || trimmed(word).size() != 1) return false;
  return lower(heading).find("temp") == std::string::npos;
}

std::optional<Unit> in_brackets(std::string_view heading) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, {'(', ')'}, {'{', '}'}}) {
    const std::size_t end = heading.rfind(close);
    const std::size_t begin = end == std::string_view::npos ? end : heading.rfind(open, end);
    if (begin == std::string_view::npos) continue;
    std::string_view word = trimmed(heading.substr(begin + 1, end - begin - 1));
    if (lower(word).starts_with("in ")) word.remove_prefix(3);
    if (const auto unit = spelt(word); unit && !is_doubtful(word, *unit, heading)) return unit;
  }
  return std::nullopt;
}

/// At the end, behind a blank, a comma or a slash.
std::optional<Unit> at_end(std::string_view heading) {
  const std::string_view last = heading.substr(heading.find_last_of(" ,:\t") + 1);
  for (const std::string_view word : {last, last.substr(last.rfind('/') + 1)}) {
    if (word.size() == heading.size()) continue;  // the whole heading: a name
    const auto unit = spelt(word);
    const bool is_word = lower(trimmed(word)) == "in";  // "lead in"
    if (unit && !is_word && std::ranges::find(kPlain, unit->name) != kPlain.end()) return unit;
  }
  return std::nullopt;
}

std::optional<Unit> behind_underscore(std::string_view heading) {
  constexpr std::string_view kPer = "_per_";  // "error_um_per_m"
  if (const std::size_t per = lower(heading).rfind(kPer); per != std::string::npos) {
    const std::string_view above = heading.substr(0, per);
    return spelt(std::string(above.substr(above.rfind('_') + 1)) + "/" +
                 std::string(heading.substr(per + kPer.size())));
  }
  const std::size_t at = heading.rfind('_');
  if (at == std::string_view::npos || at == 0) return std::nullopt;
  const std::string_view word = heading.substr(at + 1);
  const std::string plain = lower(word);
  if (plain == "min" || plain == "h" || plain == "f" || plain == "k") return std::nullopt;  // least, height, forward
  return spelt(word);
}

}  // namespace

std::optional<Unit> unit_in_heading(std::string_view heading) {
  const std::string_view text = trimmed(heading);
  if (const auto unit = in_brackets(text)) return unit;
  if (const auto unit = behind_underscore(text)) return unit;
  return at_end(text);
}

}  // namespace ecs::laser
