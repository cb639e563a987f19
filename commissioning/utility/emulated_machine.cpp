#include "commissioning/utility/emulated_machine.hpp"

#include <cctype>
#include <filesystem>

#include <fmt/format.h>

#include "base/overwriting.hpp"
#include "base/text.hpp"
#include "commissioning/link/workshop_client.hpp"
#include "commissioning/session/commands.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {
namespace {

constexpr const char* kHowToDrive =
    "expected axes with their machine coordinates such as X-100 Y50 F2000, a block such as G01 X-100 F2000, or the "
    "file "
    "of a part program";

std::vector<std::string> words_of(const std::string& typed) {
  std::vector<std::string> words;
  for (const std::string_view part : split(typed, ' '))
    if (!trimmed(part).empty()) words.emplace_back(trimmed(part));
  return words;
}

/// "X-100" or "x=-100" into the request; false: it is neither an axis nor a feed.
bool add_coordinate(Json& request, const std::string& word) {
  const char letter = static_cast<char>(std::toupper(static_cast<unsigned char>(word.front())));
  const std::size_t begin = word.size() > 1 && word[1] == '=' ? 2 : 1;
  const auto number = number_in(word.substr(begin));
  if (!number || (letter != 'F' && !axis_of(letter))) return false;
  request[letter == 'F' ? std::string("feed") : std::string(1, letter)] = *number;
  return true;
}

/// A request to the workshop as words of its command.
std::vector<std::string> drive_words(const Json& request) {
  const std::string action = request.value("action", "");
  if (action == "run") return {"run", path_word(request.value("program", ""))};
  if (action == "mdi") return {"mdi", request.value("block", "")};
  std::vector<std::string> words{"jog"};
  for (const auto& [name, option] : {std::pair{"X", "--x"}, {"Y", "--y"}, {"Z", "--z"}, {"feed", "--feed"}})
    if (request.contains(name)) words.insert(words.end(), {option, shortest(request[name].get<double>())});
  return words;
}

std::string place_in(const Json& answer) {
  std::string place;
  if (!answer.contains("position_mm")) return place;
  for (const auto& [axis, mm] : answer["position_mm"].items())
    place += fmt::format("{}{} {:.4f}", place.empty() ? "" : ", ", axis, mm.get<double>());
  return place;
}

}  // namespace

std::vector<std::string> reference_words(const std::string& workshop, const std::vector<Axis>& axes) {
  std::vector<std::string> words{"ecs-emulator", "workshop", workshop, "reference"};
  if (!axes.empty()) words.emplace_back("--axes");
  for (const Axis a : axes) words.emplace_back(1, letter_of(a));
  return words;
}

void reference_machine(TaskRunner& task, const std::string& workshop, std::vector<Axis> axes, Message& failed,
                       bool beside) {
  if (task.running()) return;
  NotedCommand command;
  command.words = reference_words(workshop, axes);
  const auto work = [workshop, axes = std::move(axes)](JobControl& control) -> Result<void> {
    Json request{{"action", "reference"}};
    for (const Axis a : axes) request["axes"].push_back(std::string(1, letter_of(a)));
    const auto done = WorkshopClient(workshop, control.cancelled).ask(request);
    if (done || control.cancelled) return {};
    return problem(ProblemKind::link, fmt::format("the emulated machine was not referenced: {}", done.error().message));
  };
  task.start("referencing", work, [&failed, &task, beside, command = std::move(command)](const Result<void>& done) {
    if (!done) return failed.say(done.error());
    if (!beside && !task.cancelled()) note(command);
  });
}

Result<std::string> drive_request(const std::string& typed) {
  std::error_code fault;
  const std::string text(trimmed(typed));
  if (std::filesystem::is_regular_file(text, fault))
    return one_line(Json{{"action", "run"}, {"program", std::filesystem::absolute(text, fault).string()}});
  Json jog{{"action", "jog"}};
  bool all = true;
  for (const std::string& word : words_of(text)) all = add_coordinate(jog, word) && all;
  if (all && (jog.contains("X") || jog.contains("Y") || jog.contains("Z"))) return one_line(jog);
  const bool is_block = !text.empty() && std::string_view("GMNSTgmnst").find(text.front()) != std::string_view::npos &&
                        text.size() > 1 && std::isdigit(static_cast<unsigned char>(text[1])) != 0;
  if (is_block) return one_line(Json{{"action", "mdi"}, {"block", text}});
  return problem(ProblemKind::usage, fmt::format("{}, found \"{}\"", kHowToDrive, text));
}

void drive_machine(TaskRunner& task, const std::string& workshop, const std::string& request, Message& message) {
  if (task.running()) return;
  const auto work = [workshop, request](JobControl& control) -> Result<std::string> {
    const auto done = WorkshopClient(workshop, control.cancelled).ask(Json::parse(request));
    if (!done && control.cancelled) return std::string("The emulated machine was stopped.");
    if (!done) return tl::unexpected(done.error());
    const auto state = WorkshopClient(workshop, control.cancelled).ask({{"action", "state"}});
    return fmt::format("The emulated machine stands at {}.", state ? place_in(*state) : place_in(*done));
  };
  task.start("the emulated machine moves", work, [&message, &task, workshop, request](const Result<std::string>& done) {
    if (!done) return message.say(done.error());
    message.say(*done);
    if (task.cancelled())
      note_remark("the emulated machine was driven and stopped on its way");
    else
      note_workshop(workshop, drive_words(Json::parse(request)));
  });
}

namespace {

using Measured = Result<std::vector<std::string>>;
constexpr double kSteps = 40.0;

std::string file_of_axis(const EmulatedMeasurement& wanted, Axis axis) {
  return (std::filesystem::path(wanted.folder) / fmt::format("E{0}{0}.csv", letter_of(axis))).string();
}

/// What was measured, as the commands that measure it again.
void note_measured(const std::string& workshop, const EmulatedMeasurement& wanted) {
  if (!wanted.plan.empty())
    return static_cast<void>(note_workshop(
        workshop, {"plan", path_word(wanted.plan), "--phase", wanted.phase, "-o", path_word(wanted.folder)}));
  const auto read = params::read_machine(wanted.machine);
  if (!read) return;
  for (const Axis a : kAllAxes) {
    const auto& axis = read->machine.axes[index_of(a)];
    if (!axis) continue;
    const std::string letter(1, letter_of(a));
    note_workshop(workshop,
                  {"measure", "--axis", letter, "--sense", "E" + letter, "--from", shortest(axis->travel_mm[0]), "--to",
                   shortest(axis->travel_mm[1]), "--step", shortest((axis->travel_mm[1] - axis->travel_mm[0]) / kSteps),
                   "--moved", "-o", path_word(file_of_axis(wanted, a))});
  }
}

Measured measured_by_plan(const WorkshopClient& workshop, const EmulatedMeasurement& wanted, JobControl& control) {
  const Json request{{"action", "plan"}, {"plan", wanted.plan}, {"phase", wanted.phase}, {"folder", wanted.folder}};
  ECS_TRY(done, workshop.ask(request, [&control](double part) { control.part = part; }));
  return done.value("output", std::vector<std::string>());
}

/// Forty steps over the travel of each axis, off equal steps as ISO 230-2 asks.
Measured measured_positions(const WorkshopClient& workshop, const EmulatedMeasurement& wanted, JobControl& control) {
  ECS_TRY(read, params::read_machine(wanted.machine));
  std::vector<std::string> files;
  std::vector<Json> requests;
  for (const Axis a : kAllAxes) {
    const auto& axis = read.machine.axes[index_of(a)];
    if (!axis) continue;
    const std::string letter(1, letter_of(a));
    files.push_back(file_of_axis(wanted, a));
    requests.push_back({{"action", "measure"},
                        {"axis", letter},
                        {"sense", "E" + letter},
                        {"from", axis->travel_mm[0]},
                        {"to", axis->travel_mm[1]},
                        {"step", (axis->travel_mm[1] - axis->travel_mm[0]) / kSteps},
                        {"moved", true},
                        {"output", Json::array({files.back()})}});
  }
  ECS_DO(none_there(files, "give another folder"));
  std::error_code fault;
  std::filesystem::create_directories(wanted.folder, fault);
  for (std::size_t k = 0; k < requests.size(); ++k) {
    control.part = static_cast<double>(k) / static_cast<double>(requests.size());
    ECS_DO(workshop.ask(requests[k]));
  }
  return files;
}

}  // namespace

void measure_by_plan(TaskRunner& task, const std::string& workshop, const EmulatedMeasurement& wanted,
                     std::function<void(const Measured&)> taken) {
  if (task.running()) return;
  EmulatedMeasurement whole = wanted;
  std::error_code fault;
  whole.folder = std::filesystem::absolute(wanted.folder, fault).lexically_normal().string();
  if (!wanted.plan.empty()) whole.plan = std::filesystem::absolute(wanted.plan, fault).string();
  const auto work = [workshop, whole](JobControl& control) -> Measured {
    const WorkshopClient client(workshop, control.cancelled);
    auto done =
        whole.plan.empty() ? measured_positions(client, whole, control) : measured_by_plan(client, whole, control);
    if (!done && control.cancelled) return problem(ProblemKind::refused, "the measurement was stopped");
    return done;
  };
  task.start("the emulated laser measures", work, [workshop, whole, taken = std::move(taken)](const Measured& files) {
    if (files) note_measured(workshop, whole);
    taken(files);
  });
}

}  // namespace ecs::commissioning
