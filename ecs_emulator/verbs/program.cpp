#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "ecs_emulator/part_programs/writer.hpp"
#include "ecs_emulator/verbs/requests.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr RequestOption kPlanOptions[]{
    {"--axis", OptionKind::word, "moving axis"},
    {"--sense", OptionKind::word, "measured component (positioning)"},
    {"--instrument", OptionKind::word, "instrument stated in the head of the program"},
    {"--from", OptionKind::number, "first target [mm]"},
    {"--to", OptionKind::number, "last target [mm]"},
    {"--step", OptionKind::number, "step between targets [mm]"},
    {"--targets", OptionKind::numbers,
     "target positions, separated by commas, instead of --from, --to and --step [mm]"},
    {"--runs", OptionKind::integer, "number of runs, there and back (3)"},
    {"--unidirectional", OptionKind::flag, "measure in one direction only"},
    {"--feed", OptionKind::number, "feed [mm/min] (2000)"},
    {"--dwell", OptionKind::number, "dwell before each reading [s] (2)"},
    {"--overrun", OptionKind::number, "travel beyond the end targets [mm] (5)"},
};

struct ProgramRequest {
  std::string plan, output, machine;
  bool even = false, force = false;
  Json request = Json::object();
  static Fields<ProgramRequest> fields() {
    using R = ProgramRequest;
    return {
        {"PLAN", &R::plan, "plan file (TOML): one program for each row"},
        request_fields(&R::request, kPlanOptions),
        {"--even", &R::even, "keep the targets at equal steps; by default they are displaced, as ISO 230-2 requires"},
        {"--machine", &R::machine, "machine file, to park the other axes and check the travel"},
        {"-o,--output", &R::output, "program file to write; with a plan, a folder", cli::Is::output, Need::required},
        {"--force", &R::force, "overwrite existing files"}};
  }
};

Result<Outcome> write_all(const fs::path& folder, const std::vector<ProgramFile>& files, bool force) {
  std::vector<std::string> names;
  for (const ProgramFile& file : files) names.push_back((folder / file.name).string());
  ECS_DO(spared(names, force));
  disc::make_folders(folder);
  for (const ProgramFile& file : files) ECS_DO(write_file(folder / file.name, file.text));
  return Outcome{
      fmt::format("{} program{} written to the folder {}", files.size(), files.size() == 1 ? "" : "s", folder.string()),
      {}};
}

Result<Outcome> write_one(const ProgramRequest& arguments, const std::optional<fs::path>& machine) {
  const fs::path output = arguments.output;
  Json request = arguments.request;
  request["action"] = "measure";
  if (!arguments.even && !request.contains("targets")) request["moved"] = true;
  if (!request.contains("sense") && request.contains("axis"))
    request["sense"] = "E" + request["axis"].get<std::string>();
  ECS_TRY(file, program_of_request(request.dump(), output.filename().string(), machine));
  const auto written = write_file(output, file.text);
  return written ? Result<Outcome>(Outcome{}) : tl::unexpected(written.error());
}

Result<Outcome> write_programs(VerbContext& /*context*/, const ProgramRequest& arguments) {
  const auto machine = arguments.machine.empty() ? std::nullopt : std::optional<fs::path>(arguments.machine);
  if (arguments.plan.empty()) return write_one(arguments, machine);
  if (!arguments.request.empty())
    return problem(ProblemKind::usage, "expected a plan file or --axis, --from, …, got both");
  const auto files = programs_of_plan(arguments.plan, machine, arguments.even);
  return files ? write_all(arguments.output, *files, arguments.force) : tl::unexpected(files.error());
}

}  // namespace

extern const Action kProgram =
    action("program", "write the part program that carries out a plan of measurements (thesis appendix B)",
           "ecs-emulator program plan.toml --machine machine.toml -o programs\n"
           "  ecs-emulator program --axis X --from 0 --to -4100 --step 50 --runs 3 --dwell 2 --overrun 5 -o exx.nc",
           write_programs);

}  // namespace ecs::emulator
