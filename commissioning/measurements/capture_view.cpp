#include "commissioning/measurements/capture_view.hpp"

#include <fmt/format.h>

namespace ecs::commissioning {
namespace {

void add(std::string& text, const std::string& part) { text += (text.empty() ? "" : ", ") + part; }

std::string start_of_pass(const laser::Reading& stop) {
  const bool forward = stop.approach == Approach::forward;
  return fmt::format("; start {} it, so that it is approached {}", forward ? "below" : "above",
                     forward ? "forward (rising)" : "in reverse (falling)");
}

}  // namespace

std::string due_text(const devices::CaptureRecord& record) {
  const laser::Reading* stop = record.due();
  if (stop == nullptr) return {};
  const auto place = record.place();
  return fmt::format("next: {} {} to {} mm ({} of {}, run {} of {}, {} of {} in all){}", letter_of(stop->axis),
                     stop->approach == Approach::forward ? "forward" : "reverse", laser::target_mm(*stop), place.number,
                     place.of, stop->run, record.runs(), record.next() + 1, record.plan().stops.size(),
                     place.first_of_pass ? start_of_pass(*stop) : "");
}

std::string around_text(const devices::Values& values) {
  std::string text;
  for (const auto& [quantity, value] : values) switch (quantity) {
      case devices::Quantity::air_degC:
        add(text, fmt::format("air {:.2f} degC", value));
        break;
      case devices::Quantity::material_degC:
        add(text, fmt::format("material {:.2f} degC", value));
        break;
      case devices::Quantity::pressure_hPa:
        add(text, fmt::format("{:.1f} hPa", value));
        break;
      case devices::Quantity::humidity_pct:
        add(text, fmt::format("{:.1f} %RH", value));
        break;
      case devices::Quantity::reading_um:
        add(text, fmt::format("{:.2f} um", value));
        break;
    }
  return text;
}

std::string around_text(const laser::Reading& reading) {
  devices::Values values;
  const auto put = [&](devices::Quantity quantity, const char* column) {
    if (const auto found = reading.sensors_degC.find(column); found != reading.sensors_degC.end())
      values[quantity] = found->second;
  };
  put(devices::Quantity::air_degC, "t_air_degC");
  put(devices::Quantity::material_degC, "t_material_degC");
  if (reading.pressure_hPa) values[devices::Quantity::pressure_hPa] = *reading.pressure_hPa;
  if (reading.humidity_pct) values[devices::Quantity::humidity_pct] = *reading.humidity_pct;
  return around_text(values);
}

std::string taken_text(const devices::CaptureRecord& record) {
  const laser::Reading& last = record.taken().back();
  const std::string around = around_text(last);
  return fmt::format("{:.2f} {} at {} {} mm ({:.1f} s{})", last.error, laser::unit_of(last.sense), letter_of(last.axis),
                     laser::target_mm(last), last.time_s.value_or(0.0), around.empty() ? "" : ", " + around);
}

}  // namespace ecs::commissioning
