#include "ecs_emulator/part_programs/verb.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "ecs_emulator/command_line/request_verb.hpp"
#include "ecs_emulator/part_programs/files.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

struct ProgramArguments {
  std::string plan;
  std::string output;
  std::optional<fs::path> machine;
  Json request = Json::object();
};

void add_plan_options(CLI::App& app, Json& request) {
  RequestVerb verb(app, request);
  verb.word("--axis", "axis", "moving axis");
  verb.word("--sense", "sense", "what is measured (positioning)");
  verb.word("--instrument", "instrument", "said in the head of the program");
  verb.number("--from", "from", "first target, mm");
  verb.number("--to", "to", "last target, mm");
  verb.number("--step", "step", "mm");
  verb.numbers("--targets", "targets", "in place of from, to and step");
  verb.whole("--runs", "runs", "there and back (3)");
  verb.flag("--unidirectional", "unidirectional", "one way only");
  verb.number("--feed", "feed", "mm/min (2000)");
  verb.number("--dwell", "dwell", "before each reading, s (2)");
  verb.number("--overrun", "overrun", "mm (5)");
}

int write_all(const fs::path& folder, const std::vector<ProgramFile>& files) {
  std::error_code error;
  fs::create_directories(folder, error);
  for (const ProgramFile& file : files)
    if (auto written = write_file(folder / file.name, file.text); !written) return exit_code_after(written.error());
  fmt::print("{} programs in {}\n", files.size(), folder.string());
  return 0;
}

int write_one(ProgramArguments& arguments) {
  Json& request = arguments.request;
  request["action"] = "measure";
  if (!request.contains("sense") && request.contains("axis"))
    request["sense"] = "E" + request["axis"].get<std::string>();
  const fs::path output = arguments.output;
  const auto file = program_of_request(request.dump(), output.filename().string(), arguments.machine);
  if (!file) return exit_code_after(file.error());
  const auto written = write_file(output, file->text);
  return written ? 0 : exit_code_after(written.error());
}

int write_programs(ProgramArguments& arguments) {
  if (arguments.plan.empty()) return write_one(arguments);
  if (!arguments.request.empty())
    return exit_code_after({ProblemKind::usage, "expected a plan file or --axis, --from, …, got both", {}, 0, 0, {}});
  const auto files = programs_of_plan(arguments.plan, arguments.machine);
  return files ? write_all(arguments.output, *files) : exit_code_after(files.error());
}

}  // namespace

void add_run_options(CLI::App& app, Json& request) {
  RequestVerb verb(app, request);
  verb.path("PROGRAM", "program", "part program (docs/part_programs.md)")->required();
  verb.word("--axis", "axis", "axis whose component every M08 reads");
  verb.word("--sense", "sense", "EX, EY, EZ, EA, EB or EC");
  verb.word("--instrument", "instrument", "linear, straightness, angular, level or square");
  verb.paths("-o,--output", "output", "readings; the form follows the name, as with measure");
  verb.path("--trace", "trace", "the track, sample by sample (.csv)");
  verb.number("--trace-period", "trace_period", "between samples, s (0.001); 0: every tick");
  verb.word("--date", "date", "into the metadata");
  verb.word("--engineer", "engineer", "into the metadata");
}

void add_mdi_options(CLI::App& app, Json& request) {
  RequestVerb(app, request).word("BLOCK", "block", "one block: \"G01 X-100 F2000\"")->required();
}

void add_program_verb(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ProgramArguments>();
  CLI::App* verb = app.add_subcommand("program", "write the part program that measures a plan (thesis appendix B)");
  verb->add_option("PLAN", arguments->plan, "plan file (TOML): one program for each row");
  add_plan_options(*verb, arguments->request);
  verb->add_option("--machine", arguments->machine, "machine file: park the other axes, check the travel");
  verb->add_option("-o,--output", arguments->output, "file; with a plan: folder")->required();
  verb->footer(
      "Examples:\n  ecs-emulator program plan.toml --machine machine.toml -o programs\n"
      "  ecs-emulator program --axis X --from 0 --to -4100 --step 50 --runs 3 --dwell 2 --overrun 5 -o exx.nc");
  verb->callback([arguments, &exit_code] { exit_code = write_programs(*arguments); });
}

}  // namespace ecs::emulator
