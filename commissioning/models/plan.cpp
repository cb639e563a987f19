#include "commissioning/models/plan.hpp"

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

bool is_header(std::string_view line) { return !trimmed(line).empty() && !trimmed(line).starts_with("#"); }

/// The header row names an axis and a sense, but no reading.
bool lacks_readings(std::string_view text) {
  for (const std::string_view line : lines_of(text)) {
    if (!is_header(line)) continue;
    bool axis = false, sense = false, reading = false;
    for (const std::string_view field : split(line, ',')) {
      axis = axis || trimmed(field) == "axis";
      sense = sense || trimmed(field) == "sense";
      reading = reading || trimmed(field) == "reading";
    }
    return axis && sense && !reading;
  }
  return false;
}

/// The same rows with a last column `reading` of zeros.
std::string with_readings(std::string_view text) {
  std::string out;
  bool header = true;
  for (const std::string_view line : lines_of(text)) {
    out += line;
    if (is_header(line)) {
      out += header ? ",reading" : ",0";
      header = false;
    }
    out += '\n';
  }
  return out;
}

}  // namespace

Result<Plan> plan_in(const std::string& file, const ImportArguments& import) {
  ECS_TRY(text, read_file(file));
  if (lacks_readings(text)) {
    ECS_TRY(set, laser::parse_measurement_set(with_readings(text), file));
    std::erase(set.columns, "reading");
    return Plan{std::move(set), false};
  }
  ImportArguments any_axis = import;
  any_axis.takes_rotary = true;
  ECS_TRY(imported, read_measurements(file, any_axis));
  return Plan{std::move(imported.set), true};
}

}  // namespace ecs::commissioning
