// Monitor samples as CSV, one row for each axis and sample. Does not live here: taking them (protocol/client.hpp).
#pragma once

#include <string>
#include <string_view>

#include "protocol/unit_data.hpp"

namespace ecs::app {

/// The header row, with its line end.
inline constexpr std::string_view kMonitorColumns =
    "time_s,mode,fault,axis,position_mm,speed_mm_min,referenced,switch,marker,approach,compensation_um,output_counts,"
    "relay_closed\n";

[[nodiscard]] std::string monitor_rows(const protocol::MonitorSample& sample);

}  // namespace ecs::app
