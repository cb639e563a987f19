#include "ecs_emulator/workshop/measure.hpp"

#include <filesystem>

#include "base/overwriting.hpp"
#include "ecs_emulator/instruments/measurement_files.hpp"
#include "ecs_emulator/instruments/measurement_request.hpp"
#include "ecs_emulator/instruments/plan_file.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;
using Answer = Result<Json>;

Answer handed_out(const laser::MeasurementSet& set, const std::vector<std::string>& outputs) {
  for (const std::string& output : outputs) ECS_DO(write_measurement(output, set));
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
  ECS_DO(arguments.checked());
  std::size_t percent = 0;
  const auto progress = [&](const MeasurementProgress& at) {
    const std::size_t now = at.readings_done * 100 / at.readings_total;
    if (now == percent || !report) return;
    percent = now;
    report(Json{{"progress", static_cast<double>(now) / 100.0}}.dump());
  };
  ECS_TRY(set, measure(*workshop.simulation, *plan, progress));
  return handed_out(set, outputs);
}

Answer follow_plan(const Workshop& workshop, Arguments& arguments,
                   const std::function<void(const std::string&)>& report) {
  const std::string plan = arguments.word("plan");
  PlanChoice choice;
  choice.phase = arguments.word("phase");
  choice.folder = arguments.word("folder");
  choice.moved = arguments.flag("moved");
  if (plan.empty()) arguments.complain("plan: expected the file of a plan");
  if (choice.folder.empty()) arguments.complain("folder: expected where the files go");
  ECS_DO(arguments.checked());
  ECS_TRY(requests, requests_of(plan, choice));
  std::vector<std::string> files;
  for (const std::string& request : requests) files.push_back(Json::parse(request)["output"][0]);
  ECS_DO(none_there(files, "give another folder"));
  std::error_code error;
  std::filesystem::create_directories(choice.folder, error);
  for (std::size_t k = 0; k < requests.size(); ++k) {
    if (report) report(Json{{"progress", static_cast<double>(k) / static_cast<double>(requests.size())}}.dump());
    const Json request = Json::parse(requests[k]);
    Arguments row(request);
    if (auto measured = measure_machine(workshop, row, {}); !measured) return measured;
  }
  return Json{{"output", files}};
}

Answer capture_machine(const Workshop& workshop, Arguments& arguments) {
  const auto plan = capture_in(arguments);
  const auto outputs = arguments.words("output");
  ECS_DO(arguments.checked());
  ECS_TRY(set, capture(*workshop.simulation, *plan));
  return handed_out(set, outputs);
}

}  // namespace ecs::emulator
