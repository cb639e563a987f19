// Monitor samples as CSV, one row for each axis and sample. Does not live here: taking them (protocol/client.hpp), the
// sensor beside them (environment_watch.hpp).
#pragma once

#include <string>
#include <string_view>

#include "laser/device_description.hpp"
#include "protocol/unit_data.hpp"

namespace ecs::app {

/// The header row, with its line end.
inline constexpr std::string_view kMonitorColumns =
    "time_s,mode,fault,axis,position_mm,speed_mm_min,referenced,switch,marker,approach,compensation_um,output_counts,"
    "relay_closed,t_air_degC,t_material_degC\n";

/// @param surroundings  as a sensor gave them last; a temperature that is not among them leaves its field empty
[[nodiscard]] std::string monitor_rows(const protocol::MonitorSample& sample, const laser::Values& surroundings = {});

}  // namespace ecs::app
