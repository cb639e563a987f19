#include "ecs_emulator/settings/emulator.hpp"

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/toml_reader.hpp"
#include "ecs_emulator/settings/reader.hpp"

namespace ecs::emulator {
namespace {

void serial_number_into(TomlReader& reader, const toml::table& table, std::string& serial_number) {
  const auto word = reader.word(table, "serial_number");
  if (!word) return;
  if (word->empty() || word->size() > 16)
    reader.complain(*table.get("serial_number"),
                    fmt::format("serial_number: expected 1 to 16 characters, got {}", word->size()));
  else
    serial_number = *word;
}

void seed_into(TomlReader& reader, const toml::table& table, std::uint64_t& seed) {
  constexpr double kGreatest = 9007199254740992.0;  // 2^53: every whole number up to it is a double
  double number = static_cast<double>(seed);
  number_into(reader, table, "seed", Sign::not_negative, number);
  if (number <= kGreatest)
    seed = static_cast<std::uint64_t>(number);
  else
    reader.complain(*table.get("seed"), fmt::format("seed: expected at most {:.0f}, got {}", kGreatest, number));
}

EmulatorSettings settings_of(TomlReader& reader, const toml::table& table, const std::filesystem::path& folder) {
  EmulatorSettings settings;
  reader.only(table, {"serial_number", "seed", "errors", "load_kg", "tool_offset_mm", "axis", "laser"}, "emulator");
  serial_number_into(reader, table, settings.serial_number);
  seed_into(reader, table, settings.seed);
  number_into(reader, table, "load_kg", Sign::not_negative, settings.load_kg);
  if (const auto* offset = reader.child(table, "tool_offset_mm")) {
    Vector3& to = settings.tool_offset_mm;
    numbers_into(reader, *offset, "tool_offset_mm", {{"x", &to[0]}, {"y", &to[1]}, {"z", &to[2]}});
  }
  if (const auto errors = reader.word(table, "errors")) settings.errors = folder / *errors;
  if (const auto* laser = reader.child(table, "laser")) settings.laser = read_laser_settings(reader, *laser);
  if (const auto* axes = reader.child(table, "axis")) {
    reader.only(*axes, {"X", "Y", "Z"}, "emulator.axis");
    for (const Axis a : kAllAxes)
      if (const auto* axis = reader.child(*axes, std::string(1, letter_of(a))))
        settings.axes[index_of(a)] = read_axis_settings(reader, *axis);
  }
  return settings;
}

/// A switch stands at the end where the datum is, and the axis comes to it from the other: what a control does unless
/// the file says otherwise.
void reference_towards_datum(const toml::table& file, WorkshopMachine& workshop) {
  for (const Axis a : kAllAxes) {
    const auto& axis = workshop.machine.axes[index_of(a)];
    const std::string name(1, letter_of(a));
    if (!axis || file["emulator"]["axis"][name]["reference_direction"]) continue;
    const bool at_lower_end = axis->datum_mm < 0.5 * (axis->travel_mm[0] + axis->travel_mm[1]);
    workshop.settings.axes[index_of(a)].reference_direction = at_lower_end ? Approach::reverse : Approach::forward;
  }
}

}  // namespace

Result<WorkshopMachine> parse_workshop_machine(std::string_view text, const std::string& file,
                                               const std::filesystem::path& folder) {
  ECS_TRY(machine, params::parse_machine(text, file));
  TomlReader reader(file);
  ECS_TRY(table, reader.parsed(text));
  WorkshopMachine workshop{std::move(machine.machine), {}};
  for (const Axis a : kAllAxes) {
    const auto& axis = workshop.machine.axes[index_of(a)];
    if (axis && (axis->datum_mm < axis->travel_mm[0] || axis->datum_mm > axis->travel_mm[1]))
      reader.complain(1,
                      fmt::format("axis.{}: expected datum_mm within travel_mm, or the control cannot go there, got {}",
                                  letter_of(a), axis->datum_mm));
  }
  if (const auto* own = reader.child(table, "emulator")) workshop.settings = settings_of(reader, *own, folder);
  reference_towards_datum(table, workshop);
  if (!reader.clean()) return tl::unexpected(reader.all());
  return workshop;
}

Result<WorkshopMachine> load_workshop_machine(const std::filesystem::path& path) {
  ECS_TRY(text, read_file(path));
  return parse_workshop_machine(text, path.string(), path.parent_path());
}

}  // namespace ecs::emulator
