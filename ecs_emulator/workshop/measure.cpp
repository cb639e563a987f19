#include "ecs_emulator/workshop/measure.hpp"

#include "ecs_emulator/instruments/measurement_files.hpp"
#include "ecs_emulator/instruments/measurement_request.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;
using Answer = Result<Json>;

Answer handed_out(const laser::MeasurementSet& set, const std::vector<std::string>& outputs) {
  for (const std::string& output : outputs)
    if (auto written = write_measurement(output, set); !written) return tl::unexpected(written.error());
  Json answer{
      {"readings", set.readings.size()}, {"output", outputs}, {"time_s", set.readings.back().time_s.value_or(0.0)}};
  if (outputs.empty()) answer["csv"] = laser::to_csv(set);
  return answer;
}

}  // namespace

Answer measure_machine(const Workshop& workshop, Arguments& arguments,
                       const std::function<void(const std::string&)>& report) {
  const auto plan = plan_in(arguments);
  const auto outputs = arguments.words("output");
  if (auto right = arguments.checked(); !right) return tl::unexpected(right.error());
  std::size_t percent = 0;
  const auto progress = [&](const MeasurementProgress& at) {
    const std::size_t now = at.readings_done * 100 / at.readings_total;
    if (now == percent || !report) return;
    percent = now;
    report(Json{{"progress", static_cast<double>(now) / 100.0}}.dump());
  };
  const auto set = measure(*workshop.simulation, *plan, progress);
  if (!set) return tl::unexpected(set.error());
  return handed_out(*set, outputs);
}

Answer capture_machine(const Workshop& workshop, Arguments& arguments) {
  const auto plan = capture_in(arguments);
  const auto outputs = arguments.words("output");
  if (auto right = arguments.checked(); !right) return tl::unexpected(right.error());
  const auto set = capture(*workshop.simulation, *plan);
  if (!set) return tl::unexpected(set.error());
  return handed_out(*set, outputs);
}

}  // namespace ecs::emulator
