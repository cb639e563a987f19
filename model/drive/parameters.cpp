// The constants of thesis appendix A and the reader of the [drive] table. Does not live here: the equations.
#include "model/drive/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"

namespace ecs::model {
namespace {

using enum DriveConstant;

constexpr std::array<DriveConstantInfo, kDriveConstants> kInfo{{
    {Kd, "Kd", "Kd_V_per_pulse", "V/pulse", 0.0099734, "gain of the D/A converter behind the position error counter"},
    {K, "K", "K", "", 1.0 / 3.0, "scaling of the velocity command in front of the amplifier"},
    {Ka, "Ka", "Ka_A_per_V", "A/V", 30.06, "proportional gain of the PI velocity regulator"},
    {Ti, "Ti", "Ti_s", "s", 0.0204, "integral action time of the PI velocity regulator"},
    {Tc, "Tc", "Tc_s", "s", 0.0003, "time constant of the current regulator"},
    {Kt, "Kt", "Kt_Nm_per_A", "Nm/A", 0.5, "torque constant of the motor"},
    {Jm, "Jm", "Jm_kgm2", "kg m2", 0.00023, "moment of inertia of the motor"},
    {J1, "J1", "J1_kgm2", "kg m2", 0.000517711, "moment of inertia of the load at the motor"},
    {T1, "T1", "T1_Nm", "Nm", 0.02538878, "friction torque of the load at the motor"},
    {Kw, "Kw", "Kw_V_s_per_rad", "V s/rad", 0.632298, "gain of the tacho generator"},
    {Ke, "Ke", "Ke_pulses_per_rad", "pulses/rad", 636.62, "pulses of the encoder per radian of the motor"},
    {Ks, "Ks", "Ks_mm_per_rad", "mm/rad", 1.2773, "travel of the slide per radian of the motor"},
    {pitch, "pitch", "pitch_mm", "mm", 8.0, "travel that the controller takes for one turn of the encoder"},
    {dac_limit, "dac_limit", "dac_limit_V", "V", 10.0, "greatest output of the D/A converter, either sign"},
}};

/// The tables that a model file may hold; here only their spelling is of interest.
const std::vector<std::string> kTables{"drive", "effect",  "candidate", "map",
                                       "known", "history", "name",      "compensated_readings"};

void take(TomlReader& reader, const toml::table& table, const DriveConstantInfo& info, DriveParameters& into) {
  const bool both = info.key != info.name && table.contains(info.key) && table.contains(info.name);
  if (both)
    return reader.complain(*table.get(info.name),
                           fmt::format("expected {} or {}, found both: leave one out", info.name, info.key));
  const std::string_view key = table.contains(info.key) ? info.key : info.name;
  const auto value = reader.number(table, key);
  if (!value) return;
  if (!std::isfinite(*value) || *value <= 0.0)
    return reader.complain(*table.get(key), fmt::format("{}: expected a positive number{}{}, found {}", key,
                                                        info.unit.empty() ? "" : " in ", info.unit, *value));
  into[info.id] = *value;
}

}  // namespace

const std::array<DriveConstantInfo, kDriveConstants>& drive_constants() { return kInfo; }

const DriveConstantInfo& info_of(DriveConstant constant) { return kInfo[index_of(constant)]; }

std::optional<DriveConstant> drive_constant_named(std::string_view name) {
  const auto* const found =
      std::find_if(kInfo.begin(), kInfo.end(), [&](const auto& info) { return info.name == name || info.key == name; });
  if (found == kInfo.end()) return std::nullopt;
  return found->id;
}

DriveParameters::DriveParameters() : value{} {
  for (const DriveConstantInfo& info : kInfo) value[index_of(info.id)] = info.printed;
}

Result<DriveParameters> parse_drive(std::string_view text, const std::string& file_name) {
  TomlReader reader(file_name);
  ECS_TRY(root, reader.parsed(text));
  reader.only(root, kTables, "model");
  DriveParameters drive;
  if (const toml::table* table = reader.child(root, "drive")) {
    std::vector<std::string> known;
    for (const DriveConstantInfo& info : kInfo)
      for (const std::string_view key : {info.key, info.name}) known.emplace_back(key);
    reader.only(*table, known, "drive");
    for (const DriveConstantInfo& info : kInfo) take(reader, *table, info, drive);
  }
  if (!reader.clean()) return tl::unexpected(reader.all());
  return drive;
}

Result<DriveParameters> read_drive(const std::filesystem::path& path) {
  ECS_TRY(text, read_file(path));
  return parse_drive(text, path.string());
}

}  // namespace ecs::model
