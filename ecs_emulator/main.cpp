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

#include "ecs_emulator/hide_files.hpp"
#include "ecs_emulator/plan_file.hpp"
#include "ecs_emulator/program_verb.hpp"
#include "ecs_emulator/rig_verb.hpp"
#include "ecs_emulator/serve.hpp"
#include "ecs_emulator/workshop.hpp"
#include "ecs_emulator/workshop_socket.hpp"

namespace {

using Json = nlohmann::json;
using namespace ecs::emulator;

volatile std::sig_atomic_t stop_requested = 0;
extern "C" void on_stop(int /*signal*/) { stop_requested = 1; }

int told(const ecs::Problem& problem) {
  fmt::print(stderr, "{}\n", ecs::to_text(problem));
  return static_cast<int>(problem.kind) + 1;
}

/// Prints the answer of the workshop; the exit code that goes with it.
int shown(const std::string& answer) {
  const Json parsed = Json::parse(answer, nullptr, false);
  if (parsed.is_object() && parsed.value("ok", false)) {
    fmt::print("{}\n", answer);
    return 0;
  }
  if (!parsed.is_object() || !parsed.contains("error")) {
    fmt::print(stderr, "the workshop answered nonsense: {}\n", answer);
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

/// "y=-700,z=0" → {"Y": -700, "Z": 0}
Json coordinates(const std::vector<std::string>& texts) {
  Json place = Json::object();
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    std::string name = text.substr(0, equals);
    for (char& letter : name) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    const Json value = equals == std::string::npos ? Json() : Json::parse(text.substr(equals + 1), nullptr, false);
    place[name] = value.is_discarded() ? Json(text.substr(equals + 1)) : value;
  }
  return place;
}

std::optional<LinkSense> link_sense_named(std::string_view name) {
  if (name == "auto") return LinkSense::automatic;
  if (name == "compensate") return LinkSense::compensate;
  if (name == "integrate") return LinkSense::integrate;
  return std::nullopt;
}

std::string absolute(const std::string& path) { return std::filesystem::absolute(path).string(); }

/// The verbs of the workshop, each with its options, writing themselves into one request.
class WorkshopVerbs {
 public:
  explicit WorkshopVerbs(Json& request) : request_(request) {}

  void add_all(CLI::App& app) {
    add(app, "state", "where everything stands");
    jog(add(app, "jog", "move axes: jog --x -100 --y 50 [--feed 2000]"));
    list(add(app, "reference", "run the controller's reference sequence, all axes or --axes X"), "--axes", "axes");
    measure(add(app, "measure", "measure: measure --axis X --sense EX --from 0 --to -4100 --step 50 -o exx.csv"));
    add_run_options(*add(app, "run", "run a part program: run exx.nc --axis X --sense EX -o exx.csv"), request_);
    add_mdi_options(*add(app, "mdi", "one block of a part program: mdi \"G01 X-100 F2000\""), request_);
    capture(add(app, "capture", "the display at a constant rate: capture --axis X --sense EX --seconds 10 -o run.rtx"));
    survey(add(app, "survey", "true volumetric error: corners and grid"));
    word(add(app, "power", "the unit's mains switch: power off | on | cycle"), "state", "state")->required();
    number(add(app, "wait", "let simulated time pass: wait 3600"), "seconds", "seconds")->required();
    whole(add(app, "tick", "run so many periods of the unit's loop: tick 1000"), "count", "count")->required();
    number(add(app, "load", "put a workpiece on the table: load 500"), "kg", "kg")->required();
    fault(add(app, "fault", "provoke a fault by its name: fault ram_stuck --address 0x100000 --bit 3"));
  }

  void measure(CLI::App* verb) {
    word(verb, "--axis", "axis")->required();
    word(verb, "--sense", "sense")->required();
    number(verb, "--from", "from");
    number(verb, "--to", "to");
    number(verb, "--step", "step");
    verb->add_option_function<std::vector<double>>("--targets", [this](const auto& v) { request_["targets"] = v; })
        ->delimiter(',');
    whole(verb, "--runs", "runs");
    flag(verb, "--unidirectional", "unidirectional");
    verb->add_option_function<std::vector<std::string>>(
            "--parked", [this](const auto& v) { request_["parked"] = coordinates(v); }, "for example y=-700,z=0")
        ->delimiter(',');
    number(verb, "--feed", "feed");
    number(verb, "--dwell", "dwell");
    number(verb, "--overrun", "overrun");
    flag(verb, "--on-the-fly", "on_the_fly");
    word(verb, "--instrument", "instrument");
    setting(verb);
    whole(verb, "--beam-broken-at", "beam_broken_at")->description("somebody steps into the beam before this reading");
    word(verb, "--date", "date");
    word(verb, "--engineer", "engineer");
    word(verb, "--plan-name", "plan_name");
    outputs(verb, "files: .csv, .rtl, .rta, .rts, .ren, .pos, .dat, .env.pos");
  }

  void capture(CLI::App* verb) {
    word(verb, "--axis", "axis")->required();
    word(verb, "--sense", "sense")->required();
    number(verb, "--rate", "rate")->description("Hz (1000)");
    number(verb, "--seconds", "seconds")->description("(10)");
    number(verb, "--to", "to")->description("mm; the axis starts to move there");
    number(verb, "--feed", "feed");
    word(verb, "--instrument", "instrument");
    setting(verb);
    word(verb, "--date", "date");
    word(verb, "--engineer", "engineer");
    outputs(verb, "files: .csv, .rtx");
  }

  void survey(CLI::App* verb) {
    number(verb, "--step", "step");
    whole(verb, "--approach", "approach");
    flag(verb, "--with-scatter", "with_scatter");
    verb->add_option_function<std::string>("-o,--output",
                                           [this](const std::string& v) { request_["output"] = absolute(v); });
  }

  CLI::App* add(CLI::App& app, const std::string& name, const std::string& help) {
    CLI::App* verb = app.add_subcommand(name, help);
    verb->callback([this, name] { request_["action"] = name; });
    return verb;
  }

 private:
  CLI::Option* number(CLI::App* verb, const std::string& option, const std::string& key) {
    return verb->add_option_function<double>(option, [this, key](double v) { request_[key] = v; });
  }
  CLI::Option* whole(CLI::App* verb, const std::string& option, const std::string& key) {
    return verb->add_option_function<long long>(option, [this, key](long long v) { request_[key] = v; });
  }
  CLI::Option* word(CLI::App* verb, const std::string& option, const std::string& key) {
    return verb->add_option_function<std::string>(option, [this, key](const std::string& v) { request_[key] = v; });
  }
  void list(CLI::App* verb, const std::string& option, const std::string& key) {
    verb->add_option_function<std::vector<std::string>>(option, [this, key](const auto& v) { request_[key] = v; })
        ->delimiter(',');
  }
  void flag(CLI::App* verb, const std::string& option, const std::string& key) {
    verb->add_flag_function(option, [this, key](auto) { request_[key] = true; });
  }
  void jog(CLI::App* verb) {
    number(verb, "--x,-x", "X");
    number(verb, "--y,-y", "Y");
    number(verb, "--z,-z", "Z");
    number(verb, "--feed", "feed");
  }
  void outputs(CLI::App* verb, const std::string& help) {
    verb->add_option_function<std::vector<std::string>>(
        "-o,--output",
        [this](const auto& v) {
          request_["output"] = Json::array();
          for (const auto& path : v) request_["output"].push_back(absolute(path));
        },
        help);
  }
  void setting(CLI::App* verb) {
    word(verb, "--air", "air")->description("off, manual or automatic");
    word(verb, "--material", "material")->description("off, manual or automatic");
    number(verb, "--material-temperature", "material_temperature")->description("entered, degC");
    number(verb, "--dead-path", "dead_path")->description("m");
    number(verb, "--misalignment", "misalignment")->description("between beam and axis, mrad");
    number(verb, "--trigger-latency", "trigger_latency")->description("of readings on the fly, s");
  }
  void fault(CLI::App* verb) {
    word(verb, "name", "name")->required();
    whole(verb, "--address", "address");
    whole(verb, "--bit", "bit");
    whole(verb, "--level", "level");
    whole(verb, "--bits", "bits");
    word(verb, "--axis", "axis");
    flag(verb, "--back", "back");
    number(verb, "--us", "us");
    whole(verb, "--count", "count");
    number(verb, "--probability", "probability");
    number(verb, "--slow-ms", "slow_ms");
  }

  Json& request_;
};

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_stop;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

/// Ends with the process that started this one.
bool bound_to_parent(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  return getppid() == parent;
}

int run_server(const ServeOptions& options) {
  catch_signals();
  const auto served = serve(options, stop_requested, [](const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
  });
  return served ? 0 : told(served.error());
}

int ask(const std::string& socket, const Json& request) {
  const auto answer = ask_workshop(socket, request.dump(), show_progress);
  return answer ? shown(*answer) : told(answer.error());
}

/// Every measurement of a plan, one after the other; the first that fails ends it.
int follow_plan(const std::string& socket, const std::string& plan, PlanChoice choice) {
  choice.folder = std::filesystem::absolute(choice.folder);
  std::error_code error;
  std::filesystem::create_directories(choice.folder, error);
  const auto requests = requests_of(plan, choice);
  if (!requests) return told(requests.error());
  for (const std::string& request : *requests)
    if (const int code = ask(socket, Json::parse(request)); code != 0) return code;
  return 0;
}

/// A machine without a unit, for one action.
int act_alone(const std::string& machine, const std::string& errors, std::optional<std::uint64_t> seed,
              const Json& request) {
  auto simulation = simulation_for(machine, errors, seed);
  if (!simulation) return told(simulation.error());
  catch_signals();
  simulation->on_pause([] { return stop_requested == 0; });
  return shown(perform({&*simulation, nullptr, nullptr}, request.dump(), show_progress));
}

/// What `hide` is asked for.
struct HideOptions {
  HideRequest request;
  int count = 1;
  std::string folder;
};

CLI::App* add_hide(CLI::App& app, HideOptions& options) {
  CLI::App* verb = app.add_subcommand("hide", "measurements with a secret: a machine whose model lacks something");
  HideRequest& request = options.request;
  verb->add_option("--seed", request.seed, "the same seed gives the same files (1)");
  verb->add_option("-o,--output", options.folder, "folder that does not exist yet or is empty")->required();
  verb->add_option_function<std::string>(
          "--kind", [&](const std::string& name) { request.kind = case_kind_named(name); },
          "what is hidden; drawn where absent")
      ->option_text("blank|single|pair|out-of-library|confounded")
      ->check([](const std::string& name) {
        return case_kind_named(name) ? std::string()
                                     : std::string("expected blank, single, pair, out-of-library or confounded");
      });
  verb->add_option_function<std::string>(
          "--effect", [&](const std::string& name) { request.effect = effect_kind_named(name); },
          "the effect to hide, as docs/physics.md names it; of a pair, one of the two")
      ->option_text("NAME")
      ->check([](const std::string& name) {
        return effect_kind_named(name) ? std::string()
                                       : std::string("expected one of the 25 effects of docs/physics.md");
      });
  verb->add_option("--snr", request.snr, "rms of what the base model cannot absorb / sigma of one reading");
  verb->add_option("--readings", request.readings, "about so many readings, 100 to 20000");
  verb->add_option("--count", options.count, "so many cases, seeds counting up, into DIR/0001 …")
      ->check(CLI::Range(1, 9999));
  verb->add_option_function<std::string>(
          "--case", [&](const std::string&) { request.xytz = true; },
          "xytz: the XYTZ machine under the thesis's printed equation (27)")
      ->option_text("xytz")
      ->check(CLI::IsMember({"xytz"}));
  verb->footer(
      "Examples:\n  ecs-emulator hide --seed 7 -o case\n"
      "  ecs-emulator hide --seed 1 --kind single --effect cyclic --snr 3 -o cyclic\n"
      "  ecs-emulator hide --seed 1000 --count 300 --kind blank -o blanks\n"
      "  ecs-emulator hide --case xytz -o xytz\n"
      "Then diagnose DIR/data.csv, and: ecs model reveal DIR");
  return verb;
}

int hide_and_tell(const HideOptions& options) {
  const auto told_lines = hide(options.request, options.count, options.folder);
  if (!told_lines) return told(told_lines.error());
  for (const std::string& line : *told_lines) fmt::print("{}\n", line);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const pid_t parent = getppid();
  CLI::App app("The virtual workshop: a machine tool with its E.C.S. unit and a laser to measure it.", "ecs-emulator");
  app.require_subcommand(1);
  app.footer("Example: ecs-emulator serve --machine mill.toml --workshop /tmp/shop --memory battery.bin");

  ServeOptions options;
  std::string machine, errors, socket;
  std::optional<std::uint64_t> seed;
  bool with_parent = false;
  Json request = Json::object();
  int exit_code = 0;

  const auto add_machine = [&](CLI::App* verb) {
    verb->add_option("--machine", machine, "machine file (TOML)")->required();
    verb->add_option("--errors", errors, "errors file (TOML); default: the one that the machine file names");
    verb->add_option("--seed", seed, "seed of everything random");
  };

  CLI::App* server = app.add_subcommand("serve", "the unit on a line, the machine behind it");
  add_machine(server);
  auto* pty = server->add_option("--pty", options.pty, "make this symbolic link to the pseudo-terminal (RTU)");
  server->add_option("--tcp", options.tcp, "serve Modbus TCP on this port of 127.0.0.1; 0: any free one")
      ->excludes(pty);
  server->add_option("--unit", options.unit, "Modbus unit number")->check(CLI::Range(1, 247));
  server->add_option("--serial-number", options.serial_number)->check([](const std::string& text) {
    return text.size() <= 16 ? std::string() : std::string("at most 16 characters");
  });
  server->add_option("--memory", options.memory, "file that stands for the battery of the axis memory");
  server->add_option("--workshop", options.workshop, "socket for `ecs-emulator workshop`");
  server->add_option("--pace", options.pace_baud, "make the line as slow as this baud rate")
      ->check(CLI::Range(300, 921600));
  server->add_option("--modules", options.memory_modules, "axis memory modules in the rack")->check(CLI::Range(1, 5));
  server
      ->add_option_function<std::string>(
          "--mode", [&](const std::string& name) { options.mode = *link_sense_named(name); },
          "what the unit finds on its socket at power-up (auto)")
      ->option_text("auto|compensate|integrate")
      ->check([](const std::string& name) {
        return link_sense_named(name) ? std::string() : std::string("expected auto, compensate or integrate");
      });
  server->add_flag("--real-time", options.real_time, "simulated time goes by the clock; `state` counts missed periods");
  server->add_flag("--with-parent", with_parent, "end when the parent process ends");
  server->callback([&] {
    options.machine = machine;
    options.errors = errors;
    options.seed = seed;
    exit_code = with_parent && !bound_to_parent(parent) ? 0 : run_server(options);
  });

  WorkshopVerbs verbs(request);
  CLI::App* workshop = app.add_subcommand("workshop", "what a person in the workshop does, at a running server");
  workshop->add_option("socket", socket, "the server's --workshop socket")->required();
  verbs.add_all(*workshop);
  std::string plan_path;
  PlanChoice choice;
  CLI::App* plan =
      workshop->add_subcommand("plan", "every measurement of a plan: plan PLAN.toml --phase before -o DIR");
  plan->add_option("PLAN", plan_path, "plan file (TOML)")->required();
  plan->add_option("--phase", choice.phase, "rows of this phase, and of both")
      ->required()
      ->check(CLI::IsMember({"before", "after"}));
  plan->add_option("-o,--output", choice.folder, "folder for the files")->required();
  plan->add_option("--date", choice.date);
  plan->add_option("--engineer", choice.engineer);
  workshop->require_subcommand(1);
  CLI::App* measure = verbs.add(app, "measure", "measure a machine without a unit");
  add_machine(measure);
  verbs.measure(measure);
  CLI::App* capture =
      verbs.add(app, "capture", "an instrument's display at a constant rate, on a machine without a unit");
  add_machine(capture);
  verbs.capture(capture);
  CLI::App* survey = verbs.add(app, "survey", "true volumetric error of a machine without a unit");
  add_machine(survey);
  verbs.survey(survey);
  CLI::App* run = verbs.add(app, "run", "run a part program on a machine without a unit");
  add_machine(run);
  add_run_options(*run, request);
  add_program_verb(app, exit_code);
  add_rig_verb(app, exit_code);
  HideOptions secret;
  const CLI::App* hiding = add_hide(app, secret);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (hiding->parsed()) return hide_and_tell(secret);
  if (plan->parsed()) return follow_plan(socket, plan_path, choice);
  if (workshop->parsed()) return ask(socket, request);
  if (measure->parsed() || capture->parsed() || run->parsed() || survey->parsed())
    return act_alone(machine, errors, seed, request);
  return exit_code;
}
