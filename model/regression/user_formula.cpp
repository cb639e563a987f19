#include "model/regression/user_formula.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <muParser.h>

#include "base/parser_message.hpp"
#include "base/text.hpp"

namespace ecs::model {
namespace {

/// One formula: its parser, and the columns that it reads.
constexpr std::size_t kRowNumbers = 7;
/// Of readings of linear and of rotary axes.
constexpr std::array<std::array<const char*, kRowNumbers>, 2> kRowNames{
    {{"x_mm", "y_mm", "z_mm", "p_mm", "approach", "run", "compensated"},
     {"a_deg", "b_deg", "c_deg", "p_deg", "approach", "run", "compensated"}}};

std::map<std::string, const Column*> optional_columns_of(const Observations& data) {
  std::map<std::string, const Column*> columns;
  const auto add = [&](const std::string& name, const Column& column) {
    if (!column.empty()) columns[name] = &column;
  };
  add("time_s", data.time_s);
  add("feed_mm_min", data.feed_mm_min);
  add("load_kg", data.load_kg);
  add("travel_since_reversal_mm", data.travel_since_reversal_mm);
  add("pressure_hPa", data.pressure_hPa);
  add("humidity_pct", data.humidity_pct);
  for (const auto& [name, column] : data.sensors_degC) add(name, column);
  for (const auto& [name, column] : data.extras) add(name, column);
  return columns;
}

std::vector<std::string> names_of(const std::map<std::string, const Column*>& columns, bool rotary) {
  std::vector<std::string> names(kRowNames[rotary].begin(), kRowNames[rotary].end());
  for (const auto& each : columns) names.push_back(each.first);
  return names;
}

/// @param character  of the formula, from 1; 0: all of it
Problem bad_formula(const std::string& effect, const UserFormula& formula, const std::string& what,
                    std::size_t character = 0) {
  const std::string place = character == 0 ? std::string() : fmt::format(", character {}", character);
  return problem(ProblemKind::bad_input, "effect \"{}\", formula \"{}\"{}: {}", effect, formula.text, place, what)
      .value();
}

}  // namespace

struct UserFormulas::Parts {
  struct Compiled {
    UserFormula formula;
    std::unique_ptr<mu::Parser> parser;
    std::vector<std::pair<double*, const Column*>> optional_columns;
  };

  const Observations* data = nullptr;
  std::string effect;
  std::vector<double> parameters;
  std::array<double, kRowNumbers> row{};
  std::map<std::string, double> cells;
  std::vector<Compiled> formulas;

  void load(std::size_t k) {
    for (std::size_t a = 0; a < kAxes; ++a) row[a] = data->position_mm[k][a];
    row[3] = data->p_mm(k, data->axis[k]);
    row[4] = data->approach[k];
    row[5] = data->run[k];
    row[6] = data->compensated[k] ? 1.0 : 0.0;
  }

  /// Nothing where a cell is missing.
  std::optional<double> value(const Compiled& compiled, std::size_t k) {
    load(k);
    for (const auto& [cell, column] : compiled.optional_columns)
      *cell = (*column)[k] + (column == &data->time_s ? data->first_since_s : 0.0);
    const bool complete =
        std::ranges::none_of(compiled.optional_columns, [](const auto& each) { return std::isnan(*each.first); });
    return complete ? std::optional(compiled.parser->Eval()) : std::nullopt;
  }
};

UserFormulas::UserFormulas(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
UserFormulas::UserFormulas(UserFormulas&&) noexcept = default;
UserFormulas& UserFormulas::operator=(UserFormulas&&) noexcept = default;
UserFormulas::~UserFormulas() = default;

double start_of(const UserParameter& parameter) {
  if (parameter.value) return *parameter.value;
  if (parameter.start) return *parameter.start;
  if (parameter.least && parameter.greatest) return 0.5 * (*parameter.least + *parameter.greatest);
  return 1.0;
}

Result<UserFormulas> UserFormulas::compile(const EffectInstance& effect, const Observations& data) {
  auto parts = std::make_unique<Parts>();
  parts->data = &data;
  parts->effect = effect.name;
  for (const UserParameter& parameter : effect.user) parts->parameters.push_back(start_of(parameter));
  const auto columns = optional_columns_of(data);
  for (const auto& each : columns) parts->cells[each.first] = 0.0;
  std::vector<Problem> problems;
  for (const UserFormula& formula : effect.formulas) {
    if (assigns(formula.text)) {
      problems.push_back(bad_formula(effect.name, formula, "expected a value, got an assignment; == compares"));
      continue;
    }
    Parts::Compiled compiled{formula, std::make_unique<mu::Parser>(), {}};
    mu::Parser& parser = *compiled.parser;
    try {
      for (std::size_t i = 0; i < effect.user.size(); ++i) parser.DefineVar(effect.user[i].name, &parts->parameters[i]);
      for (std::size_t i = 0; i < kRowNumbers; ++i) parser.DefineVar(kRowNames[data.rotary][i], &parts->row[i]);
      for (auto& [name, cell] : parts->cells) parser.DefineVar(name, &cell);
      parser.DefineConst("pi", std::numbers::pi);
      parser.SetExpr(formula.text);
      static_cast<void>(parser.Eval());
      for (const auto& used : parser.GetUsedVar()) {
        const auto column = columns.find(used.first);
        if (column != columns.end()) compiled.optional_columns.emplace_back(&parts->cells[used.first], column->second);
      }
    } catch (const mu::ParserError& error) {
      problems.push_back(bad_formula(effect.name, formula,
                                     fmt::format("{} The data have the columns {}", without_position(error.GetMsg()),
                                                 fmt::join(names_of(columns, data.rotary), ", ")),
                                     static_cast<std::size_t>(error.GetPos()) + 1));
    }
    parts->formulas.push_back(std::move(compiled));
  }
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return UserFormulas(std::move(parts));
}

std::vector<double> UserFormulas::values(const std::vector<double>& parameters) const {
  Parts& parts = *parts_;
  std::ranges::copy(parameters, parts.parameters.begin());
  std::vector<double> values(parts.data->size(), 0.0);
  for (std::size_t k = 0; k < values.size(); ++k) {
    for (const Parts::Compiled& compiled : parts.formulas) {
      if (compiled.formula.sense != parts.data->sense[k]) continue;
      const double value = parts.value(compiled, k).value_or(kNotMeasured);
      values[k] += std::isfinite(value) ? value : kNotMeasured;
    }
  }
  return values;
}

Result<void> UserFormulas::finite_at(const std::vector<double>& parameters) const {
  Parts& parts = *parts_;
  std::ranges::copy(parameters, parts.parameters.begin());
  for (const Parts::Compiled& compiled : parts.formulas)
    for (std::size_t k = 0; k < parts.data->size(); ++k) {
      if (compiled.formula.sense != parts.data->sense[k]) continue;
      const auto value = parts.value(compiled, k);
      if (!value || std::isfinite(*value)) continue;
      return tl::unexpected(bad_formula(
          parts.effect, compiled.formula,
          fmt::format("expected a finite value at every reading, got {} at reading {} (x_mm {}, y_mm {}, z_mm {}); "
                      "exclude such places with condition ? value : 0",
                      *value, k + 1, parts.row[0], parts.row[1], parts.row[2])));
    }
  return {};
}

std::vector<std::string> UserFormulas::optional_columns() const {
  std::vector<std::string> names;
  for (const auto& [name, cell] : parts_->cells) {
    const auto reads = [&cell = cell](const Parts::Compiled& formula) {
      return std::ranges::any_of(formula.optional_columns, [&](const auto& column) { return column.first == &cell; });
    };
    if (std::ranges::any_of(parts_->formulas, reads)) names.push_back(name);
  }
  return names;
}

std::vector<ValueRange> UserFormulas::ranges_read() const {
  Parts& parts = *parts_;
  std::map<const double*, ValueRange> ranges;
  for (const Parts::Compiled& compiled : parts.formulas) {
    std::vector<const double*> cells;
    for (const auto& [name, cell] : compiled.parser->GetUsedVar()) {
      const auto& names = kRowNames[parts.data->rotary];
      const auto position = std::ranges::find(names, name);  // before approach, run and compensated
      if (position - names.begin() <= static_cast<std::ptrdiff_t>(kAxes) || parts.cells.contains(name))
        cells.push_back(cell);
    }
    for (std::size_t k = 0; k < parts.data->size(); ++k) {
      if (compiled.formula.sense != parts.data->sense[k] || !parts.value(compiled, k)) continue;
      for (const double* cell : cells) {
        ValueRange& range = ranges.try_emplace(cell, ValueRange{*cell, *cell}).first->second;
        range = {std::min(range.least, *cell), std::max(range.greatest, *cell)};
      }
    }
  }
  std::vector<ValueRange> out;
  for (const auto& [cell, range] : ranges)
    if (range.greatest > range.least) out.push_back(range);
  return out;
}

std::vector<bool> UserFormulas::linear_parameters(const std::vector<double>& start) const {
  // affine in the parameter at several settings of the others, and its slope does not depend on other linear ones
  const auto at = [&](const std::vector<double>& parameters) { return values(parameters); };
  std::vector<double> other = start;
  for (double& value : other) value = 1.3 * value + 0.7;
  struct Setting {
    std::vector<double> base;
    double step = 1.0;
  };
  std::vector<Setting> settings{{start}, {other}};
  for (const auto& [least, greatest] : ranges_read()) {  // far from these a formula may have reached its limit
    const double width = greatest - least;
    settings.push_back({std::vector<double>(start.size(), std::midpoint(least, greatest)), 0.2 * width});
    settings.push_back({std::vector<double>(start.size(), 0.3 * width), 0.2 * width});
  }
  std::vector<bool> linear(start.size(), true);
  const auto equal = [](double a, double b, double size) { return std::abs(a - b) <= 1e-7 * (std::abs(size) + 1e-12); };
  for (std::size_t j = 0; j < start.size(); ++j) {
    for (const auto& [base, step] : settings) {
      std::vector<double> one = base, two = base, three = base;
      one[j] += 0.5 * step;
      two[j] += step;
      three[j] += 2.5 * step;
      const auto v0 = at(base), v1 = at(one), v2 = at(two), v3 = at(three);
      for (std::size_t k = 0; k < v0.size() && linear[j]; ++k) {
        if (std::isnan(v0[k]) || std::isnan(v3[k])) continue;
        const double slope = v2[k] - v0[k];
        const double size = std::abs(v0[k]) + std::abs(v3[k]);
        linear[j] = equal(v1[k], v0[k] + 0.5 * slope, size) && equal(v3[k], v0[k] + 2.5 * slope, size);
      }
    }
  }
  // a product of two parameters is a line in each, but not in both: the later one becomes nonlinear
  for (std::size_t i = 0; i < start.size(); ++i) {
    for (std::size_t j = i + 1; j < start.size(); ++j) {
      if (!linear[i] || !linear[j]) continue;
      std::vector<double> both = start, first = start, second = start;
      first[i] += 1.0;
      second[j] += 1.0;
      both[i] += 1.0;
      both[j] += 1.0;
      const auto v0 = at(start), v1 = at(first), v2 = at(second), v3 = at(both);
      for (std::size_t k = 0; k < v0.size() && linear[j]; ++k) {
        if (std::isnan(v0[k]) || std::isnan(v3[k])) continue;
        const double size = std::abs(v0[k]) + std::abs(v1[k]) + std::abs(v2[k]) + std::abs(v3[k]);
        linear[j] = equal(v3[k], v1[k] + v2[k] - v0[k], size);
      }
    }
  }
  return linear;
}

}  // namespace ecs::model
