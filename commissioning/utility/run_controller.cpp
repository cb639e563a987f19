#include "commissioning/utility/run_controller.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/numbers.hpp"
#include "base/text.hpp"
#include "commissioning/link/unit_commands.hpp"

namespace ecs::commissioning {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kLongest_s = 3600.0;
constexpr Address kLastStart = kSystemRam.first + kSystemRam.size - 2;

Result<RunController::Ended> run_in(UnitLink& link, const UserProgram& program) {
  const auto since = Clock::now();
  const auto value = link.client().run_user_software(
      program.address, program.argument, std::chrono::milliseconds(static_cast<long long>(program.wait_s * 1000.0)));
  const bool line_holds = link.client().link().last_failure() == protocol::LinkFailure::none;
  if (!value && (!line_holds || link.client().link().cancelled())) return tl::unexpected(value.error());
  RunController::Ended ended{program, std::nullopt, {}, {}, seconds_since(since)};
  if (value)
    ended.returned = *value;
  else
    ended.why = to_text(value.error());
  if (auto registers = kept_registers(link.client())) ended.registers = std::move(*registers);
  return ended;
}

}  // namespace

Result<UserProgram> program_in(const std::string& address, const std::string& argument, const std::string& wait_s) {
  std::vector<Problem> problems;
  UserProgram program;
  const auto start = whole_number(address, "start address");
  if (!start)
    problems.push_back(start.error());
  else if (*start % 2 != 0 || *start < kUserPrograms || *start > kLastStart)
    problems.push_back(
        problem(ProblemKind::usage,
                fmt::format("start address: expected an even address from 0x{:06X} to 0x{:06X}, found {}",
                            kUserPrograms, kLastStart, address))
            .value());
  else
    program.address = *start;
  const auto given = whole_number(argument, "argument");
  if (!given)
    problems.push_back(given.error());
  else
    program.argument = *given;
  const auto wait = number_in(wait_s);
  if (!wait || !(*wait > 0.0) || *wait > kLongest_s)
    problems.push_back(
        problem(ProblemKind::usage,
                fmt::format("time limit: expected seconds above 0, at most {:.0f}, found \"{}\"", kLongest_s, wait_s))
            .value());
  else
    program.wait_s = *wait;
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return program;
}

std::vector<ProgramRegion> program_regions() {
  Region programs = kSystemRam;
  programs.first = kUserPrograms;
  programs.size = kSystemRam.first + kSystemRam.size - kUserPrograms;
  return {{programs, "your programs, data and stack", true},
          {kEprom, "the firmware: read only", false},
          {{kSystemRam.first, kUserRegisterBytes, false, kSystemRam.name}, "registers after a run", false},
          {kMachineInputs, "periods, positions, axes: read only", false},
          {kCommitRecords, "which bank is active: read only", false},
          {kBankA, "error map and parameters", false},
          {kBankB, "error map and parameters", false}};
}

RunController::RunController(std::shared_ptr<UnitConnection> connection) : connection_(std::move(connection)) {
  (void)unit_.look(*connection_);
}

void RunController::prepare(const UserProgram& program) {
  if (busy()) return;
  program_ = program;
  const auto peek = [connection = connection_, address = program.address](JobControl& control) {
    const std::size_t bytes = std::min<std::size_t>(kPeekBytes, kSystemRam.first + kSystemRam.size - address);
    return connection->with_link(control, [&](UnitLink& link) { return link.client().read_memory(address, bytes); });
  };
  peeking_.start("reading the program", peek, [this](const Result<Bytes>& bytes) {
    if (bytes) return ask(*bytes);
    say_failed(message_, bytes.error(), peeking_.cancelled());
  });
}

std::optional<Question> RunController::take_question() {
  std::optional<Question> question;
  question.swap(question_);
  return question;
}

void RunController::run() {
  if (busy()) return;
  ended_.reset();
  const auto work = [connection = connection_, program = program_](JobControl& control) {
    return connection->with_link(control, [&](UnitLink& link) { return run_in(link, program); });
  };
  running_.start("running the program", work, [this](Result<Ended> ended) { take(std::move(ended)); });
}

void RunController::cancel() {
  peeking_.cancel();
  running_.cancel();
}

double RunController::running_s() const { return running() ? running_.seconds() : 0.0; }

void RunController::ask(const Bytes& first) {
  std::string words;
  for (std::size_t k = 0; k + 1 < first.size(); k += 2) words += fmt::format(" {:02X}{:02X}", first[k], first[k + 1]);
  const bool empty = std::all_of(first.begin(), first.end(), [](std::uint8_t byte) { return byte == 0; });
  question_ = Question{
      fmt::format("Run the program at 0x{:06X}?", program_.address),
      (empty ? std::string("NO PROGRAM lies there, only zeros: MEMORY ACCESS writes one. ")
             : fmt::format("It begins with{}. ", words)) +
          fmt::format("D0 is given {} (0x{:08X}). It may write to all RAM of the unit, the error map included, and is "
                      "stopped after {:g} s; leaving its memory is a fault that the unit keeps.",
                      program_.argument, program_.argument, program_.wait_s),
      "run it", "leave it"};
}

void RunController::take(Result<Ended> ended) {
  if (!ended)
    say_failed(message_, ended.error(), running_.cancelled());
  else
    ended_ = std::move(*ended);
  if (ended && ended_->returned) {
    const UserProgram& program = ended_->program;
    note_on_unit(*connection_, {"utility", "run", fmt::format("0x{:06X}", program.address), "--argument",
                                fmt::format("{}", program.argument), "--wait", shortest(program.wait_s), "--yes"});
  } else if (ended) {
    note_remark(fmt::format("the program at 0x{:06X} was run and failed", ended_->program.address));
  }
  if (ended_ && ended_->returned)
    message_.say(fmt::format("The program at 0x{:06X} ended after {:.1f} s.", ended_->program.address, ended_->took_s));
  else if (ended_)
    message_.say(ended_->why, Tone::bad);
}

bool RunController::advance() {
  bool changed = unit_.look(*connection_);
  changed = peeking_.advance() || changed;
  changed = running_.advance() || changed;
  const int seconds = static_cast<int>(running_s());
  changed = changed || seconds != shown_s_;
  shown_s_ = seconds;
  return changed;
}

}  // namespace ecs::commissioning
