// Air and temperatures over time, as an environment log holds them, line by line. Does not live here: reading one,
// joining it to measurements (laser/import/readers.hpp), writing one (laser/writers/writers.hpp).
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/axis.hpp"

namespace ecs::laser {

struct EnvironmentRecord {
  Vector3 stage_mm{};
  Vector3 air_degC{};  ///< at the X, Y and Z interferometer
  double pressure_hPa = 0.0;
  double humidity_pct = 0.0;
  double sample_degC = 0.0;
  friend bool operator==(const EnvironmentRecord&, const EnvironmentRecord&) = default;
};

struct EnvironmentRow {
  std::optional<double> time_s;
  std::vector<std::optional<double>> values;  ///< one for each column; absent: not measured
};

struct EnvironmentSeries {
  /// Names of the measurement CSV: t_air_degC, pressure_hPa, …; x_mm y_mm z_mm where the log says where a stage stood.
  std::vector<std::string> columns;
  std::vector<EnvironmentRow> rows;
  bool has_dates = false;          ///< the times count from 1970
  std::vector<std::string> notes;  ///< what a reader had to assume

  [[nodiscard]] std::optional<double> value(std::size_t row, std::string_view column) const {
    const auto at = std::ranges::find(columns, column);
    return at == columns.end() ? std::nullopt : rows[row].values[static_cast<std::size_t>(at - columns.begin())];
  }
};

}  // namespace ecs::laser
