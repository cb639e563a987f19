// `ecs-emulator`: the command line of the virtual workshop. Thin: options in, one call, exit code out.
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/prctl.h>
#include <unistd.h>

#include "ecs_emulator/command_line/request_verb.hpp"
#include "ecs_emulator/hidden_cases/verb.hpp"
#include "ecs_emulator/instruments/plan_file.hpp"
#include "ecs_emulator/part_programs/verb.hpp"
#include "ecs_emulator/rig/verb.hpp"
#include "ecs_emulator/unit/workshop_socket.hpp"
#include "ecs_emulator/workshop/serve.hpp"
#include "ecs_emulator/workshop/verbs.hpp"
#include "ecs_emulator/workshop/workshop.hpp"

namespace {

using Json = nlohmann::json;
using namespace ecs::emulator;

volatile std::sig_atomic_t stop_requested = 0;
extern "C" void on_stop(int /*signal*/) { stop_requested = 1; }
volatile pid_t parent_process = 0;
extern "C" void on_parent_thread_gone(int /*signal*/) {
  if (getppid() != parent_process) stop_requested = 1;
}

/// Prints the answer of the workshop; the exit code that goes with it.
int shown(const std::string& answer) {
  const Json parsed = Json::parse(answer, nullptr, false);
  if (parsed.is_object() && parsed.value("ok", false)) {
    fmt::print("{}\n", answer);
    return 0;
  }
  if (!parsed.is_object() || !parsed.contains("error")) {
    fmt::print(stderr, "expected one JSON object from the workshop, got {}\n", answer);
    return 4;
  }
  fmt::print(stderr, "{}\n", parsed["error"].value("message", answer));
  return parsed.value("exit", 5);
}

void show_progress(const std::string& line) {
  if (isatty(STDERR_FILENO) == 0) return;
  const Json parsed = Json::parse(line, nullptr, false);
  const double part = parsed.is_object() ? parsed.value("progress", 0.0) : 0.0;
  const int at = parsed.is_object() ? parsed.value("line", 0) : 0;
  fmt::print(stderr, "\r{:3.0f} %{}{}", part * 100.0, at > 0 ? fmt::format("  line {:<8}", at) : "",
             part >= 1.0 ? "\n" : "");
}

std::optional<LinkSense> link_sense_named(std::string_view name) {
  if (name == "auto") return LinkSense::automatic;
  if (name == "compensate") return LinkSense::compensate;
  if (name == "integrate") return LinkSense::integrate;
  return std::nullopt;
}

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_stop;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

/// Ends with the process that started this one, not with the thread of it that did: the signal comes for either.
bool bound_to_parent(pid_t parent) {
  parent_process = parent;
  struct sigaction action {};
  action.sa_handler = on_parent_thread_gone;
  sigaction(SIGUSR1, &action, nullptr);
  prctl(PR_SET_PDEATHSIG, SIGUSR1);
  return getppid() == parent;
}

int run_server(const ServeOptions& options) {
  catch_signals();
  const auto served = serve(options, stop_requested, [](const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
  });
  return served ? 0 : exit_code_after(served.error());
}

int ask(const std::string& socket, const Json& request) {
  const auto answer = ask_workshop(socket, request.dump(), show_progress);
  return answer ? shown(*answer) : exit_code_after(answer.error());
}

/// Every measurement of a plan, one after the other; the first that fails ends it.
int follow_plan(const std::string& socket, const std::string& plan, PlanChoice choice) {
  choice.folder = std::filesystem::absolute(choice.folder);
  std::error_code error;
  std::filesystem::create_directories(choice.folder, error);
  const auto requests = requests_of(plan, choice);
  if (!requests) return exit_code_after(requests.error());
  for (const std::string& request : *requests)
    if (const int code = ask(socket, Json::parse(request)); code != 0) return code;
  return 0;
}

/// A machine without a unit, for one action.
int act_alone(const std::string& machine, const std::string& errors, std::optional<std::uint64_t> seed,
              const Json& request) {
  auto simulation = simulation_for(machine, errors, seed);
  if (!simulation) return exit_code_after(simulation.error());
  catch_signals();
  simulation->on_pause([] { return stop_requested == 0; });
  return shown(perform({&*simulation, nullptr, nullptr}, request.dump(), show_progress));
}

/// What the command line asks for.
struct Invocation {
  ServeOptions server;
  bool with_parent = false;
  std::string machine, errors;
  std::optional<std::uint64_t> seed;
  std::string socket;
  std::string plan;
  PlanChoice choice;
  Json request = Json::object();
  int exit_code = 0;  ///< of verbs that run while the command line is read
};

void add_machine_options(CLI::App& verb, Invocation& asked) {
  verb.add_option("--machine", asked.machine, "machine file (TOML)")->required();
  verb.add_option("--errors", asked.errors, "errors file (TOML); default: the one that the machine file names");
  verb.add_option("--seed", asked.seed, "seed of everything random")->check([](const std::string& text) {
    return text.starts_with('-') ? std::string("expected 0 or more") : std::string();
  });
}

void add_serve_options(CLI::App& verb, ServeOptions& options) {
  auto* pty = verb.add_option("--pty", options.pty, "make this symbolic link to the pseudo-terminal (RTU)");
  verb.add_option("--tcp", options.tcp, "serve Modbus TCP on this port of 127.0.0.1; 0: any free one")->excludes(pty);
  verb.add_option("--unit", options.unit, "Modbus unit number")->check(CLI::Range(1, 247));
  verb.add_option("--serial-number", options.serial_number)->check([](const std::string& text) {
    return text.size() <= 16 ? std::string() : std::string("at most 16 characters");
  });
  verb.add_option("--memory", options.memory, "file that stands for the battery of the axis memory");
  verb.add_option("--workshop", options.workshop, "socket for `ecs-emulator workshop`");
  verb.add_option("--pace", options.pace_baud, "make the line as slow as this baud rate")
      ->check(CLI::Range(300, 921600));
  verb.add_option("--modules", options.memory_modules, "axis memory modules in the rack")->check(CLI::Range(1, 5));
  verb.add_option_function<std::string>(
          "--mode", [&](const std::string& name) { options.mode = *link_sense_named(name); },
          "what the unit finds on its socket at power-up (auto)")
      ->option_text("auto|compensate|integrate")
      ->check([](const std::string& name) {
        return link_sense_named(name) ? std::string() : std::string("expected auto, compensate or integrate");
      });
  verb.add_flag("--real-time", options.real_time, "simulated time goes by the clock; `state` counts missed periods");
}

void add_serve_verb(CLI::App& app, Invocation& asked) {
  CLI::App* verb = app.add_subcommand("serve", "the unit on a line, the machine behind it");
  add_machine_options(*verb, asked);
  add_serve_options(*verb, asked.server);
  verb->add_flag("--with-parent", asked.with_parent, "end when the parent process ends");
  verb->callback([&asked, parent = getppid()] {
    asked.server.machine = asked.machine;
    asked.server.errors = asked.errors;
    asked.server.seed = asked.seed;
    asked.exit_code = asked.with_parent && !bound_to_parent(parent) ? 0 : run_server(asked.server);
  });
}

/// @return its verb `plan`, which sends many requests
CLI::App* add_workshop_verb(CLI::App& app, Invocation& asked) {
  CLI::App* workshop = app.add_subcommand("workshop", "what a person in the workshop does, at a running server");
  workshop->add_option("socket", asked.socket, "the server's --workshop socket")->required();
  add_workshop_verbs(*workshop, asked.request);
  CLI::App* plan =
      workshop->add_subcommand("plan", "every measurement of a plan: plan PLAN.toml --phase before -o DIR");
  plan->add_option("PLAN", asked.plan, "plan file (TOML)")->required();
  plan->add_option("--phase", asked.choice.phase, "rows of this phase, and of both")
      ->required()
      ->check(CLI::IsMember({"before", "after"}));
  plan->add_option("-o,--output", asked.choice.folder, "folder for the files")->required();
  plan->add_option("--date", asked.choice.date);
  plan->add_option("--engineer", asked.choice.engineer);
  workshop->require_subcommand(1);
  return plan;
}

/// The verbs of a machine without a unit.
void add_verbs_without_unit(CLI::App& app, Invocation& asked) {
  using AddOptions = void (*)(CLI::App&, Json&);
  const auto add = [&](const char* name, const char* help, AddOptions add_options) {
    CLI::App* verb = add_request_verb(app, asked.request, name, help);
    add_machine_options(*verb, asked);
    add_options(*verb, asked.request);
  };
  add("measure", "measure a machine without a unit", add_measure_options);
  add("capture", "an instrument's display at a constant rate, on a machine without a unit", add_capture_options);
  add("survey", "true volumetric error of a machine without a unit", add_survey_options);
  add("run", "run a part program on a machine without a unit", add_run_options);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The virtual workshop: a machine tool with its E.C.S. unit and a laser to measure it.", "ecs-emulator");
  app.require_subcommand(1);
  app.footer("Example: ecs-emulator serve --machine mill.toml --workshop /tmp/shop --memory battery.bin");
  Invocation asked;
  add_serve_verb(app, asked);
  const CLI::App* plan = add_workshop_verb(app, asked);
  add_verbs_without_unit(app, asked);
  add_program_verb(app, asked.exit_code);
  add_rig_verb(app, asked.exit_code);
  add_hide_verb(app, asked.exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (plan->parsed()) return follow_plan(asked.socket, asked.plan, asked.choice);
  if (app.got_subcommand("workshop")) return ask(asked.socket, asked.request);
  if (!asked.request.empty()) return act_alone(asked.machine, asked.errors, asked.seed, asked.request);
  return asked.exit_code;
}
