#include "params/check.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "params/check_rules.hpp"
#include "params/fields.hpp"

namespace ecs::params {
namespace {

void check_ranges(const UnitParameters& parameters, Findings& findings) {
  for (const Field& field : fields()) {
    if (field.axis && !parameters.axis_present[index_of(*field.axis)]) continue;
    const std::string reason = objection(field, parameters);
    if (!reason.empty()) findings.error({field.key}, reason);
  }
}

}  // namespace

std::string_view name_of(Severity severity) { return severity == Severity::error ? "error" : "warning"; }

std::vector<Finding> check(const UnitParameters& parameters, const Machine* machine) {
  Findings findings;
  check_ranges(parameters, findings);
  check_configuration(parameters, findings);
  check_compensation(parameters, findings);
  for (const Axis axis : kAllAxes) {
    if (!parameters.axis_present[index_of(axis)]) continue;
    check_axis_output(parameters, axis, findings);
    check_datum(parameters, axis, findings);
  }
  if (machine != nullptr)
    check_against(parameters, *machine, findings);
  else
    check_spare_letters(parameters, findings);
  std::stable_sort(findings.list.begin(), findings.list.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return findings.list;
}

bool has_errors(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(), [](const Finding& f) { return f.severity == Severity::error; });
}

std::string to_text(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& f : findings)
    text += fmt::format("{}: {}: {}\n", name_of(f.severity), fmt::join(f.keys, ", "), f.message);
  return text;
}

bool rack_holds(int memory_modules, int encoder_modules, int resolver_modules) {
  constexpr int kSlots = 11;
  const bool each = memory_modules <= static_cast<int>(kMostModules) && encoder_modules <= 8 && resolver_modules <= 5;
  return each && memory_modules + encoder_modules + 2 * resolver_modules <= kSlots;
}

}  // namespace ecs::params
