// The constants of a servo axis as thesis appendix A names them, with the values printed there, and their TOML form.
// Does not live here: what the axis does with them (simulation.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "base/result.hpp"

namespace ecs::model {

enum class DriveConstant : std::uint8_t { Kd, K, Ka, Ti, Tc, Kt, Jm, J1, T1, Kw, Ke, Ks, pitch, dac_limit };
inline constexpr std::size_t kDriveConstants = 14;
[[nodiscard]] constexpr std::size_t index_of(DriveConstant constant) { return static_cast<std::size_t>(constant); }

struct DriveConstantInfo {
  DriveConstant id = DriveConstant::Kd;
  std::string_view name;     ///< the thesis's symbol: "Kw"
  std::string_view key;      ///< of the [drive] table: "Kw_V_s_per_rad"; the bare symbol is taken too
  std::string_view unit;     ///< "V s/rad"
  double printed = 0.0;      ///< appendix A; pitch: section 3.5 with figure 3.10
  std::string_view meaning;  ///< plain words
};
[[nodiscard]] const std::array<DriveConstantInfo, kDriveConstants>& drive_constants();
[[nodiscard]] const DriveConstantInfo& info_of(DriveConstant constant);
[[nodiscard]] std::optional<DriveConstant> drive_constant_named(std::string_view name);

/// Every constant is positive, in the unit of its info.
struct DriveParameters {
  std::array<double, kDriveConstants> value;
  DriveParameters();  ///< as printed
  [[nodiscard]] double operator[](DriveConstant c) const { return value[index_of(c)]; }
  [[nodiscard]] double& operator[](DriveConstant c) { return value[index_of(c)]; }
  friend bool operator==(const DriveParameters&, const DriveParameters&) = default;
};

/// Reads the [drive] table of a model file; absent keys, and a file without the table, mean "as printed". The other
/// tables of a model file are left to its own reader. Refuses unknown keys and values that are not positive.
[[nodiscard]] Result<DriveParameters> parse_drive(std::string_view text, const std::string& file_name);
[[nodiscard]] Result<DriveParameters> read_drive(const std::filesystem::path& path);

}  // namespace ecs::model
