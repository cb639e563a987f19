// What a parameter file leaves open, whatever its values are.
#include <fmt/format.h>

#include "params/check.hpp"
#include "params/fields.hpp"

namespace ecs::params {
namespace {

Finding no_keys_of(Axis axis) {
  Finding finding;
  for (const Field& field : fields())
    if (field.axis == axis) finding.keys.push_back(field.key);
  finding.message = fmt::format(
      "axis {0} is present, but the file gives nothing of [axis.{0}]: it may have lost its end; give the table, or "
      "remove {0} from configuration.axes",
      letter_of(axis));
  return finding;
}

}  // namespace

std::vector<Finding> check_file(const ParametersFile& file) {
  std::vector<Finding> findings;
  for (const Axis axis : file.axes_without_keys) findings.push_back(no_keys_of(axis));
  if (!file.has_end) findings.push_back({{}, Severity::warning, std::string(kNoParametersEnd)});
  return findings;
}

std::vector<std::string> defaults_taken(const ParametersFile& file) {
  std::vector<std::string> lines;
  for (const std::string& key : file.defaulted) {
    const Field& field = *field_named(key);
    lines.push_back(fmt::format("not given, default: {} = {}{}{}", key, text_of(field, file.parameters),
                                field.unit.empty() ? "" : " ", field.unit));
  }
  return lines;
}

}  // namespace ecs::params
