#include "commissioning/utility/emulated_machine.hpp"

#include <cctype>
#include <filesystem>

#include <fmt/format.h>

#include "base/text.hpp"
#include "commissioning/link/workshop_client.hpp"

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

std::string place_in(const Json& answer) {
  std::string place;
  if (!answer.contains("position_mm")) return place;
  for (const auto& [axis, mm] : answer["position_mm"].items())
    place += fmt::format("{}{} {:.4f}", place.empty() ? "" : ", ", axis, mm.get<double>());
  return place;
}

}  // namespace

void reference_machine(TaskRunner& task, const std::string& workshop, std::vector<Axis> axes, Message& failed) {
  if (task.running()) return;
  const auto work = [workshop, axes = std::move(axes)](JobControl& control) -> Result<void> {
    Json request{{"action", "reference"}};
    for (const Axis a : axes) request["axes"].push_back(std::string(1, letter_of(a)));
    const auto done = WorkshopClient(workshop, control.cancelled).ask(request);
    if (done || control.cancelled) return {};
    return problem(ProblemKind::link, fmt::format("the emulated machine was not referenced: {}", done.error().message));
  };
  task.start("referencing", work, [&failed](const Result<void>& done) {
    if (!done) failed.say(done.error());
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
  task.start("the emulated machine moves", work, [&message](const Result<std::string>& done) {
    if (done)
      message.say(*done);
    else
      message.say(done.error());
  });
}

void measure_by_plan(TaskRunner& task, const std::string& workshop, const std::string& plan, const std::string& phase,
                     const std::string& folder, std::function<void(const Result<std::vector<std::string>>&)> taken) {
  if (task.running()) return;
  std::error_code fault;
  const Json request{{"action", "plan"},
                     {"plan", std::filesystem::absolute(plan, fault).string()},
                     {"phase", phase},
                     {"folder", std::filesystem::absolute(folder, fault).lexically_normal().string()}};
  const auto work = [workshop, request](JobControl& control) -> Result<std::vector<std::string>> {
    const auto done =
        WorkshopClient(workshop, control.cancelled).ask(request, [&control](double part) { control.part = part; });
    if (!done && control.cancelled) return problem(ProblemKind::refused, "the measurement was stopped");
    if (!done) return tl::unexpected(done.error());
    return done->value("output", std::vector<std::string>());
  };
  task.start("the emulated laser measures", work, std::move(taken));
}

}  // namespace ecs::commissioning
