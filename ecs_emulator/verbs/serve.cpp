// `ecs-emulator serve`, and the signals that end a verb.
#include "ecs_emulator/workshop/serve.hpp"

#include <csignal>
#include <cstdio>

#include <fmt/format.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "ecs_emulator/verbs/verb.hpp"

namespace ecs::emulator {
namespace {

std::atomic<int> stop = 0;
static_assert(std::atomic<int>::is_always_lock_free);  // a signal handler writes it
extern "C" void on_stop(int /*signal*/) { stop = 1; }
volatile pid_t parent_process = 0;
extern "C" void on_parent_thread_gone(int /*signal*/) {
  if (getppid() != parent_process) stop = 1;
}

void on_signal(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(signal, &action, nullptr);
}

}  // namespace

const std::atomic<int>& stop_requested() { return stop; }

void stop_on_signals() {
  on_signal(SIGTERM, on_stop);
  on_signal(SIGINT, on_stop);
  std::signal(SIGPIPE, SIG_IGN);
}

bool stop_with_parent(pid_t parent) {
  parent_process = parent;
  on_signal(SIGUSR1, on_parent_thread_gone);
  prctl(PR_SET_PDEATHSIG, SIGUSR1);
  return getppid() == parent;
}

namespace {

constexpr std::size_t kLongestSerialNumber = 16;

/// A whole number that no plain field takes.
Fields<ServeOptions> whole_number(const char* name, void (*take)(ServeOptions&, long long), const char* help,
                                  cli::Range range) {
  cli::Argument argument{name, {}, help};
  say(argument, range);
  return {argument, [take](ServeOptions& options) -> cli::Argument::Target {
            return cli::OnInteger([&options, take](long long value) { take(options, value); });
          }};
}

struct ServeRequest {
  MachineArguments machine;
  std::string memory, workshop;
  int memory_modules = 5;
  std::string mode = "auto";
  bool with_parent = false;
  ServeOptions options;
  static Fields<ServeRequest> fields() {
    using R = ServeRequest;
    using O = ServeOptions;
    const auto pty = [](O& options) -> cli::Argument::Target {
      return cli::OnText([&options](const std::string& link) { options.pty = link; });
    };
    const Fields<O> of_line{
        {{"--pty", {}, "serve Modbus RTU on a pseudo-terminal; hosts open it by this symbolic link"}, pty},
        whole_number("--tcp", [](O& o, long long port) { o.tcp = static_cast<std::uint16_t>(port); },
                     "serve Modbus TCP on this port of 127.0.0.1, instead of --pty; 0: any free port", {0, 65535}),
        {"--also-tcp", &O::also_tcp,
         "also serve Modbus TCP on a free port of 127.0.0.1, for a second host (`second_link` in the first line of "
         "output)"},
        {"--tcp-host", &O::tcp_host, "address of another interface for --tcp; needs --token"},
        {"--token", &O::token_file, "file with the token that a TCP host must show first"},
        {"--unit", &O::unit, "Modbus unit number, 1 to 247", cli::Range{1, 247}},
        {"--serial-number", &O::serial_number, "serial number of the unit, at most 16 characters"}};
    const Fields<O> pace = whole_number("--pace", [](O& o, long long baud) { o.pace_baud = static_cast<int>(baud); },
                                        "slow the line down to this baud rate, 300 to 921600", {300, 921600});
    return {
        &R::machine,
        {&R::options, of_line},
        {"--memory", &R::memory, "file for the battery-backed axis memory"},
        {"--workshop", &R::workshop, "socket for `ecs-emulator workshop`"},
        {&R::options, pace},
        {"--modules", &R::memory_modules, "axis memory modules in the rack, 1 to 5", cli::Range{1, 5}},
        {"--mode", &R::mode,
         "mode after power-up; auto: integration if a host requests it or arms itself within 0.5 s, else compensation",
         Words{"auto", "compensate", "integrate"}},
        {&R::options,
         Fields<O>{{"--arm-code", &O::arm_code, "arming code shown by the unit; six random digits if not given"},
                   {"--real-time", &O::real_time,
                    "run in real time; `ecs-emulator workshop SOCKET state` shows the missed periods"}}},
        {"--with-parent", &R::with_parent,
         "end when the process that started the emulator ends, for example a script"}};
  }
};

LinkSense link_sense_named(std::string_view name) {
  if (name == "compensate") return LinkSense::compensate;
  return name == "integrate" ? LinkSense::integrate : LinkSense::automatic;
}

Result<Outcome> run_server(VerbContext& context, const ServeRequest& arguments) {
  ServeOptions options = arguments.options;
  if (options.pty && options.tcp) return problem(ProblemKind::usage, "--tcp excludes --pty");
  if (options.also_tcp && options.tcp) return problem(ProblemKind::usage, "--also-tcp excludes --tcp");
  if (options.serial_number.size() > kLongestSerialNumber)
    return problem(ProblemKind::usage, "--serial-number: at most 16 characters");
  options.machine = arguments.machine.machine;
  options.errors = arguments.machine.errors;
  options.seed = arguments.machine.seed;
  options.memory = arguments.memory;
  options.workshop = arguments.workshop;
  options.memory_modules = static_cast<std::uint8_t>(arguments.memory_modules);
  options.mode = link_sense_named(arguments.mode);
  if (arguments.with_parent && !stop_with_parent(context.parent)) return Outcome{};
  stop_on_signals();
  const auto served = serve(options, stop_requested(), [](const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
  });
  return served ? Result<Outcome>(Outcome{}) : tl::unexpected(served.error());
}

}  // namespace

extern const Action kServe =
    action("serve", "serve the emulated unit, with its machine, on a link",
           "ecs-emulator serve --machine mill.toml --workshop /tmp/shop --memory battery.bin", run_server);

}  // namespace ecs::emulator
