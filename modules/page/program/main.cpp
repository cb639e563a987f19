// The program of the page: one function that runs a command line of `ecs`, or `ecs-emulator hide`, on files in memory,
// and answers as the verb does. Does not live here: what a verb does or says, the page (modules/page/web).
#include <sstream>
#include <string>
#include <vector>

#include "app/cli/module.hpp"
#include "app/cli/program.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/files/known_files.hpp"
#include "ecs_emulator/verbs/module.hpp"

namespace ecs::app {

// The verbs that need no unit.
extern const std::vector<Action> kLaserReading, kLaserStatistics, kMapBuilding, kModelBeginning, kModelFitting,
    kModelDiagnosis, kModelLadder;

const Module& hidden_cases_module();
const Module& report_module();

const std::vector<const Module*>& modules() {
  static const std::vector<const Module*> all{&hidden_cases_module(), &report_module()};
  return all;
}

namespace {

const Registry& verbs_of_page() {
  static const Registry registry = [] {
    Registry all;
    all.menus = {{"laser", "PROCESS LASER DATA: measurements"},
                 {"map", "PROCESS LASER DATA: error maps"},
                 {"model", "MODEL: the error model against measurements"}};
    for (const auto* family : {&kLaserReading, &kLaserStatistics, &kMapBuilding, &kModelBeginning, &kModelFitting,
                               &kModelDiagnosis, &kModelLadder})
      for (const Action& action : *family) all.actions.push_back(&action);
    for (const Module* module : modules()) {
      all.menus.insert(all.menus.end(), module->menus.begin(), module->menus.end());
      for (const auto& family : module->verbs) all.add(family);
    }
    return all;
  }();
  return registry;
}

/// What a command line printed, and how it ended.
struct Printed {
  int exit_code = 0;
  std::string json{}, text{}, messages{};
};

Printed run_host(const std::vector<std::string>& words) {
  Printed printed;
  std::ostringstream out, messages;
  const AroundVerb keep_text = [&printed](VerbContext& context, const Action&, const Action::Run& run) {
    auto result = run(context);
    if (result) printed.text = result->text;
    return result;
  };
  printed.exit_code = run_command_line(verbs_of_page(), words, out, messages, {}, keep_text);
  printed.json = out.str();
  printed.messages = messages.str();
  return printed;
}

/// What each file is: `file`, `kind` (a word of name_of(FileKind)), `what` in a few words, `why_not`.
Printed look_at(const std::vector<std::string>& files) {
  Json looks = Json::array();
  for (const std::string& file : files) {
    FileLook look = looked_at(file);
    if (const auto content = read_file(file); content && look.kind == FileKind::other)
      look.kind = kind_of_content(*content);
    looks.push_back({{"file", file}, {"kind", name_of(look.kind)}, {"what", look.what}, {"why_not", look.why_not}});
  }
  return {.exit_code = kDone, .json = one_line(Json{{"files", looks}})};
}

}  // namespace
}  // namespace ecs::app

namespace ecs::emulator {

const Module& hidden_cases_emulator_module();

namespace {

app::Printed run_emulator(const std::vector<std::string>& words) {
  cli::CommandTree tree("ecs-emulator", {{}, kProgramHelp}, {});
  Action::Run run;
  for (const Action& action : *hidden_cases_emulator_module().verbs.actions) {
    auto bound = action.bound({});
    tree.add_verb(action.path, action.help, action.example, bound.arguments, [&run, made = bound.run] { run = made; });
  }
  const cli::Request request = tree.parsed(words);
  VerbContext context;
  const auto failed = [](const Problem& problem) {
    return app::Printed{.exit_code = exit_code_of(problem.kind),
                        .json = one_line(Json{{"error", problem_json(problem)}})};
  };
  if (!run) return failed({ProblemKind::usage, request.text, {}, 0, 0, {}});
  try {
    const auto result = run(context);
    if (!result) return failed(result.error());
    return {.exit_code = result->exit_code, .json = result->json, .text = result->text};
  } catch (const std::exception& error) {
    return failed({ProblemKind::output, std::string("internal failure: ") + error.what(), {}, 0, 0, {}});
  }
}

}  // namespace
}  // namespace ecs::emulator

/// @param command_line  words, each on a line of its own; the first names the program: "ecs", "ecs-emulator", or is
///                      "look" in front of files
/// @return an object, valid until the next call: `exit_code`, `text` and `messages` of the command line, `json`, its
///         answer with --json as a text
extern "C" const char* ecs_answer(const char* command_line) {
  using namespace ecs;
  static std::string answer;
  std::vector<std::string> words;
  for (const std::string_view line : lines_of(command_line)) words.emplace_back(line);
  const std::string program = words.empty() ? "" : words.front();
  if (!words.empty()) words.erase(words.begin());
  const app::Printed printed = program == "ecs-emulator" ? emulator::run_emulator(words)
                               : program == "look"       ? app::look_at(words)
                                                         : app::run_host(words);
  answer = Json{{"exit_code", printed.exit_code},
                {"json", printed.json},
                {"text", printed.text},
                {"messages", printed.messages}}
               .dump();
  return answer.c_str();
}
