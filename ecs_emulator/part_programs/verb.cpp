#include "ecs_emulator/part_programs/verb.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
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

void path(CLI::App& verb, Json& request, const char* option, const char* key, const char* help) {
  verb.add_option_function<std::string>(
      option, [&request, key](const std::string& v) { request[key] = fs::absolute(v).string(); }, help);
}
void word(CLI::App& verb, Json& request, const char* option, const char* key, const char* help) {
  verb.add_option_function<std::string>(
      option, [&request, key](const std::string& v) { request[key] = v; }, help);
}
void number(CLI::App& verb, Json& request, const char* option, const char* key, const char* help) {
  verb.add_option_function<double>(
      option, [&request, key](double v) { request[key] = v; }, help);
}

void add_plan_options(CLI::App& verb, Json& request) {
  word(verb, request, "--axis", "axis", "moving axis");
  word(verb, request, "--sense", "sense", "what is measured (positioning)");
  word(verb, request, "--instrument", "instrument", "said in the head of the program");
  number(verb, request, "--from", "from", "first target, mm");
  number(verb, request, "--to", "to", "last target, mm");
  number(verb, request, "--step", "step", "mm");
  verb.add_option_function<std::vector<double>>(
          "--targets", [&request](const auto& v) { request["targets"] = v; }, "in place of from, to and step")
      ->delimiter(',');
  verb.add_option_function<long long>(
      "--runs", [&request](long long v) { request["runs"] = v; }, "there and back (3)");
  verb.add_flag_function(
      "--unidirectional", [&request](auto) { request["unidirectional"] = true; }, "one way only");
  number(verb, request, "--feed", "feed", "mm/min (2000)");
  number(verb, request, "--dwell", "dwell", "before each reading, s (2)");
  number(verb, request, "--overrun", "overrun", "mm (5)");
}

int exit_code_after(const Problem& problem) {
  fmt::print(stderr, "{}\n", to_text(problem));
  return static_cast<int>(problem.kind) + 1;
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

void add_run_options(CLI::App& verb, Json& request) {
  verb.add_option_function<std::string>(
          "PROGRAM", [&request](const std::string& v) { request["program"] = fs::absolute(v).string(); },
          "part program (docs/part_programs.md)")
      ->required();
  word(verb, request, "--axis", "axis", "axis whose component every M08 reads");
  word(verb, request, "--sense", "sense", "EX, EY, EZ, EA, EB or EC");
  word(verb, request, "--instrument", "instrument", "linear, straightness, angular, level or square");
  verb.add_option_function<std::vector<std::string>>(
      "-o,--output",
      [&request](const auto& v) {
        request["output"] = Json::array();
        for (const auto& file : v) request["output"].push_back(fs::absolute(file).string());
      },
      "readings; the form follows the name, as with measure");
  path(verb, request, "--trace", "trace", "the track, sample by sample (.csv)");
  number(verb, request, "--trace-period", "trace_period", "between samples, s (0.001); 0: every tick");
  word(verb, request, "--date", "date", "into the metadata");
  word(verb, request, "--engineer", "engineer", "into the metadata");
}

void add_mdi_options(CLI::App& verb, Json& request) {
  verb.add_option_function<std::string>(
          "BLOCK", [&request](const std::string& v) { request["block"] = v; }, "one block: \"G01 X-100 F2000\"")
      ->required();
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
