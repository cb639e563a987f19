#include "commissioning/utility/unit_view.hpp"

#include <cctype>
#include <ctime>
#include <filesystem>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/link/emulator_process.hpp"
#include "commissioning/session/commands.hpp"
#include "core/fault.hpp"
#include "core/mode_word.hpp"
#include "params/machine.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {
namespace {

using Clock = std::chrono::steady_clock;

/// Ages are shown in seconds, below one not at all.
int shown_age(double age_s) { return age_s < 1.0 ? 0 : static_cast<int>(age_s); }

}  // namespace

std::string refusal_in(UnitMode mode, std::string_view what, std::string_view how) {
  if (mode == UnitMode::integration) return {};
  if (mode == UnitMode::halted) return "The unit is halted after a fatal fault: switch it off and on.";
  return fmt::format("{} in integration mode only; the unit is {}. {}", what, word_of(mode), how);
}

bool UnitView::look(const UnitConnection& connection) {
  const int age_before = shown_age(age_s);
  const bool fresh_before = fresh;
  const std::uint64_t now = connection.changes();
  if (now != changes || !sample) {
    watched = connection.snapshot();
    const auto newest = connection.newest();
    fresh = newest.has_value();
    if (newest && watched.newest_at >= taken_at_) take(*newest, watched.newest_at);
  }
  age_s = sample ? std::chrono::duration<double>(Clock::now() - taken_at_).count() : 0.0;
  const bool changed = now != changes || fresh != fresh_before || shown_age(age_s) != age_before;
  changes = now;
  return changed;
}

void UnitView::take(const protocol::MonitorSample& seen) { take(seen, Clock::now()); }

void UnitView::take(const protocol::MonitorSample& seen, Clock::time_point at) {
  const bool was_away = watched.times_lost != times_lost_;  // a busy computer alone makes no unit late
  if (sample && began_anew(*sample, seen, was_away ? at - taken_at_ : Clock::duration::zero())) ++restarts;
  times_lost_ = watched.times_lost;
  sample = seen;
  fresh = true;
  taken_at_ = at;
  age_s = 0.0;
}

bool began_anew(const protocol::MonitorSample& before, const protocol::MonitorSample& after, Clock::duration passed) {
  const auto had_run_us = static_cast<double>(before.unit_time_us);
  const auto now_us = static_cast<double>(after.unit_time_us);
  const double passed_us = std::chrono::duration<double, std::micro>(passed).count();
  return now_us < had_run_us || had_run_us + passed_us - now_us > had_run_us / 2.0;
}

std::vector<Axis> UnitView::axes() const {
  std::vector<Axis> axes;
  for (const Axis a : kAllAxes)
    if (!watched.identity || watched.identity->axis_present[index_of(a)]) axes.push_back(a);
  return axes;
}

const protocol::AxisSample* UnitView::axis(Axis which) const {
  return sample && sample->axes[index_of(which)].present ? &sample->axes[index_of(which)] : nullptr;
}

std::string age_text(double age_s) { return age_s < 1.0 ? "" : fmt::format("seen {} s ago", shown_age(age_s)); }

void say_failed(Message& message, const Problem& problem, bool given_up) {
  const bool unit_knows = problem.message.find(protocol::kStopNotReceived) == std::string::npos;
  if (given_up && unit_knows)
    message.say("Cancelled.", Tone::warning);
  else
    message.say(problem);
}

std::string file_name_now(const std::string& stem, const std::string& extension) {
  return fmt::format("{}-{:%Y%m%d-%H%M%S}{}", stem, fmt::localtime(std::time(nullptr)), extension);
}

namespace {

constexpr const char* kHowToDrive =
    "expected axes with their machine coordinates such as X-100 Y50 F2000, a block such as G01 X-100 F2000, or the "
    "file of a part program";

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
std::vector<std::string> words_of_request(const Json& request) {
  std::vector<std::string> words;
  for (const auto& [key, value] : request.items()) {
    const bool is_file = key == "plan" || key == "program";
    if (key == "folder" || key == "output")
      words.emplace_back("-o");
    else if (key != "action" && key != "block" && !is_file)
      words.push_back("--" + lower(key));
    if (value.is_number()) words.push_back(shortest(value.get<double>()));
    if (value.is_string())
      words.push_back(is_file || key == "folder" ? path_word(value.get<std::string>()) : value.get<std::string>());
    for (const Json& one : value.is_array() ? value : Json::array())
      words.push_back(key == "output" ? path_word(one.get<std::string>()) : one.get<std::string>());
  }
  return words;
}

Json request_to_reference(const std::vector<Axis>& axes) {
  Json request{{"action", "reference"}};
  for (const Axis a : axes) request["axes"].push_back(std::string(1, letter_of(a)));
  return request;
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
  std::vector<std::string> words = words_of_request(request_to_reference(axes));
  words.insert(words.begin(), {"ecs-emulator", "workshop", workshop});
  return words;
}

void reference_machine(TaskRunner& task, const std::string& workshop, const std::vector<Axis>& axes, Message& failed,
                       bool beside) {
  if (task.running()) return;
  const Json request = request_to_reference(axes);
  const auto work = [workshop, request](JobControl& control) -> Result<void> {
    const auto done = WorkshopClient(workshop, control.cancelled).ask(request);
    if (done || control.cancelled) return {};
    return problem(ProblemKind::link, "the emulated machine was not referenced: {}", done.error().message);
  };
  task.start("referencing", work, [&failed, &task, beside, workshop, request](const Result<void>& done) {
    if (!done) return failed.say(done.error());
    if (!beside && !task.cancelled()) note_workshop(workshop, words_of_request(request));
  });
}

Result<std::string> drive_request(const std::string& typed) {
  const std::string text(trimmed(typed));
  if (disc::is_file(text)) return one_line(Json{{"action", "run"}, {"program", disc::absolute(text).string()}});
  Json jog{{"action", "jog"}};
  bool all = true;
  for (const std::string& word : words_of(text)) all = add_coordinate(jog, word) && all;
  if (all && (jog.contains("X") || jog.contains("Y") || jog.contains("Z"))) return one_line(jog);
  const bool is_block = !text.empty() && std::string_view("GMNSTgmnst").find(text.front()) != std::string_view::npos &&
                        text.size() > 1 && std::isdigit(static_cast<unsigned char>(text[1])) != 0;
  if (is_block) return one_line(Json{{"action", "mdi"}, {"block", text}});
  return problem(ProblemKind::usage, "{}, found \"{}\"", kHowToDrive, text);
}

void drive_machine(TaskRunner& task, const std::string& workshop, const std::string& request, Message& message,
                   std::function<void(const Problem&)> failed) {
  if (task.running()) return;
  const auto work = [workshop, request](JobControl& control) -> Result<std::string> {
    const auto done = WorkshopClient(workshop, control.cancelled).ask(Json::parse(request));
    if (!done && control.cancelled) return std::string("The emulated machine was stopped.");
    if (!done) return tl::unexpected(done.error());
    const auto state = WorkshopClient(workshop, control.cancelled).ask({{"action", "state"}});
    return fmt::format("The emulated machine is at {}.", state ? place_in(*state) : place_in(*done));
  };
  const auto taken = [&message, &task, workshop, request, failed = std::move(failed)](const Result<std::string>& done) {
    if (!done) return failed(done.error());
    message.say(*done);
    if (task.cancelled())
      note_remark("the emulated machine was stopped on its way");
    else
      note_workshop(workshop, words_of_request(Json::parse(request)));
  };
  task.start("the emulated machine moves", work, taken);
}

namespace {

using Measured = Result<std::vector<std::string>>;
constexpr double kSteps = 40.0;

/// Of a plan one, else forty steps over the travel of each axis, off equal steps as ISO 230-2 asks.
Result<std::vector<Json>> requests_to_measure(const EmulatedMeasurement& wanted) {
  if (!wanted.plan.empty())
    return std::vector<Json>{
        {{"action", "plan"}, {"plan", wanted.plan}, {"phase", wanted.phase}, {"folder", wanted.folder}}};
  ECS_TRY(read, params::read_machine(wanted.machine));
  std::vector<Json> requests;
  for (const Axis a : kAllAxes) {
    const auto& axis = read.machine.axes[index_of(a)];
    if (!axis) continue;
    const std::filesystem::path file = std::filesystem::path(wanted.folder) / fmt::format("E{0}{0}.csv", letter_of(a));
    requests.push_back({{"action", "measure"},
                        {"axis", std::string(1, letter_of(a))},
                        {"sense", fmt::format("E{}", letter_of(a))},
                        {"from", axis->travel_mm[0]},
                        {"to", axis->travel_mm[1]},
                        {"step", (axis->travel_mm[1] - axis->travel_mm[0]) / kSteps},
                        {"moved", true},
                        {"output", Json::array({file.string()})}});
  }
  return requests;
}

/// What was asked, and the files that came.
struct MeasuredFiles {
  std::vector<Json> requests;
  std::vector<std::string> files;
};

Result<MeasuredFiles> measured(const WorkshopClient& workshop, const EmulatedMeasurement& wanted, JobControl& control) {
  ECS_TRY(requests, requests_to_measure(wanted));
  MeasuredFiles done{requests, {}};
  if (!wanted.plan.empty()) {
    ECS_TRY(answer, workshop.ask(requests.front(), [&control](double part) { control.part = part; }));
    done.files = answer.value("output", std::vector<std::string>());
    return done;
  }
  for (const Json& request : requests) done.files.push_back(request["output"].front());
  ECS_DO(none_there(done.files, "give another folder"));
  disc::make_folders(wanted.folder);
  for (std::size_t k = 0; k < requests.size(); ++k) {
    control.part = static_cast<double>(k) / static_cast<double>(requests.size());
    ECS_DO(workshop.ask(requests[k]));
  }
  return done;
}

}  // namespace

void measure_by_plan(TaskRunner& task, const std::string& workshop, const EmulatedMeasurement& wanted,
                     std::function<void(const Measured&)> taken) {
  if (task.running()) return;
  EmulatedMeasurement whole = wanted;
  whole.folder = disc::absolute(wanted.folder).lexically_normal().string();
  if (!wanted.plan.empty()) whole.plan = disc::absolute(wanted.plan).string();
  const auto work = [workshop, whole](JobControl& control) -> Result<MeasuredFiles> {
    auto done = measured(WorkshopClient(workshop, control.cancelled), whole, control);
    if (!done && control.cancelled) return problem(ProblemKind::refused, "the measurement was stopped");
    return done;
  };
  task.start("the emulated laser measures", work,
             [workshop, taken = std::move(taken)](const Result<MeasuredFiles>& done) {
               if (!done) return taken(tl::unexpected(done.error()));
               for (const Json& request : done->requests) note_workshop(workshop, words_of_request(request));
               taken(done->files);
             });
}

}  // namespace ecs::commissioning
