// A recorded datum sequence on the host: out of the unit's memory, as a CSV file, and what happened in it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/result.hpp"
#include "core/datum.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

struct DatumRecording {
  Axis axis = Axis::X;
  double sample_period_us = 1000.0;  ///< above 0
  double um_per_count = 1.0;
  std::string taken;          ///< ISO 8601; empty: unknown
  std::string serial_number;  ///< of the unit; empty: unknown
  std::vector<DatumSample> samples;

  [[nodiscard]] double time_s(std::size_t i) const { return static_cast<double>(i) * sample_period_us * 1e-6; }
  /// From where the record began.
  [[nodiscard]] double position_mm(std::size_t i) const { return samples[i].counts * um_per_count * 1e-3; }
};

/// Speed at each sample [mm/min], signed, over a window of about 20 ms.
[[nodiscard]] std::vector<double> speeds_mm_min(const DatumRecording& recording);

/// Reads the record that the unit holds at `address`.
[[nodiscard]] Result<DatumRecording> read_recording(protocol::UnitClient& client, Address address,
                                                    const protocol::ProgressCallback& progress = {});
/// Ten seconds of an axis, which the control of the machine references meanwhile, and what the unit has kept of them.
[[nodiscard]] Result<DatumRecording> record_datum(protocol::UnitClient& client, Axis axis,
                                                  const protocol::CommandCallback& busy,
                                                  const protocol::ProgressCallback& fetching);

/// `# key: value` lines, then time_s,counts,position_mm,speed_mm_min,switch_closed,marker.
[[nodiscard]] std::string to_csv(const DatumRecording& recording);
/// Reads what to_csv() writes; every bad row at once. time, position and speed follow from the counts.
[[nodiscard]] Result<DatumRecording> parse_recording(std::string_view text, const std::string& name);
[[nodiscard]] Result<DatumRecording> read_recording_file(const std::filesystem::path& path);

/// Something that happened while recording.
struct DatumEvent {
  std::string what;  ///< "switch closes", "switch opens", "marker", "motion begins", "motion ends"
  double time_s = 0.0;
  double position_mm = 0.0;
  double speed_mm_min = 0.0;
};
[[nodiscard]] std::vector<DatumEvent> events_of(const DatumRecording& recording);
/// In the text a row below kEventHeading.
[[nodiscard]] Cell datum_event_cell(const DatumEvent& event);
inline constexpr std::string_view kEventHeading = "  time/s  position/mm  speed/(mm/min)  event";

/// The velocity-time graph of thesis figure 5.5 in text, with the switch and the marker below.
[[nodiscard]] std::string graph_of(const DatumRecording& recording);

}  // namespace ecs::commissioning
