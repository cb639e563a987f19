#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/link/emulator_process.hpp"
#include "model/planning/questions.hpp"
#include "model/planning/run.hpp"
#include "modules/investigation/workshops.hpp"

namespace ecs::commissioning {
namespace {

using model::MeasurementProposal;

constexpr double kDatumWait_s = 30.0;  ///< for the unit, after the axes were referenced
constexpr model::Warming kWarming{};   ///< the axes that are moved to warm the machine
constexpr double kWarmer_degC = 0.5;   ///< less is no other temperature

std::string letter(Axis axis) { return std::string(1, letter_of(axis)); }

/// Moves the axis to and fro with the spindle running, which warms screws and spindle.
std::string warming_program(Axis axis, const params::MachineAxis& facts, double minutes) {
  const auto [low_mm, high_mm] = facts.travel_mm;
  const int times = std::max(1, static_cast<int>(minutes * kWarming.feed_mm_min / (2.0 * (high_mm - low_mm))));
  return fmt::format("> M03S{:g}\n> G90G01{}{:.3f}F{:g}\n$REP {}\n> G90G01{}{:.3f}\n> G90G01{}{:.3f}\n$END\n> M05\n",
                     kWarming.spindle_rpm, letter_of(axis), low_mm, kWarming.feed_mm_min, times, letter_of(axis),
                     high_mm, letter_of(axis), low_mm);
}

/// A sensor is asked to show more than it does now.
bool wants_warmth(const MeasurementProposal& proposal, const Json& state) {
  const auto sensors = state.find("sensors_degC");
  if (sensors == state.end()) return false;
  for (const auto& sensor : sensors->items()) {
    const auto asked = proposal.temperatures_degC.find(fmt::format("t_{}_degC", sensor.key()));
    if (asked != proposal.temperatures_degC.end() && asked->second > sensor.value().get<double>() + kWarmer_degC)
      return true;
  }
  return false;
}

bool compensates(const Json& state) {
  const auto unit = state.find("unit");
  return unit != state.end() && unit->is_object() && unit->value("mode", std::string()) == "compensating";
}

/// The square or straight edge, as it is to lie.
void add_artefact(Json& request, const MeasurementProposal& proposal) {
  if (proposal.against_square) request["instrument"] = "square";
  if (proposal.reversed) request["reversed"] = *proposal.reversed ? 1 : 0;
}

/// What the instrument is asked for, for readings without a stop and for optics that were aligned again.
Json measuring_request(const MeasurementProposal& proposal, const params::Machine& machine, double feed_mm_min) {
  std::vector<double> targets = proposal.targets_mm;
  if (proposal.approach < 0) std::reverse(targets.begin(), targets.end());
  Json parked = Json::object();
  for (const Axis a : kAllAxes)
    if (a != proposal.axis && machine.axes[index_of(a)]) parked[letter(a)] = proposal.parked_mm[index_of(a)];
  Json request =
      object_of("action"_is("measure"), "axis"_is(letter(proposal.axis)), "sense"_is(name_of(proposal.sense)),
                "targets"_is(targets), "runs"_is(proposal.runs), "unidirectional"_is(!proposal.bidirectional),
                "parked"_is(std::move(parked)), "feed"_is(feed_mm_min), "dwell"_is(proposal.dwell_s),
                "overrun"_is(proposal.overrun_mm), "on_the_fly"_is(proposal.dwell_s <= 0.0));
  add_artefact(request, proposal);
  if (proposal.set_up > 1) {
    request["misalignment"] = 0.0;
    request["dead_path"] = 0.0;
  }
  return request;
}

/// "B=-90,-45,45,90/C=90"
std::string sweep_text(const model::BallSet::Sweep& sweep) {
  const auto rotary_letter = [](std::size_t axis) { return "ABC"[axis]; };
  std::string text = fmt::format("{}={:g}", rotary_letter(index_of(sweep.axis)), fmt::join(sweep.targets_deg, ","));
  for (std::size_t a = 0; a < kAxes; ++a)
    if (a != index_of(sweep.axis) && sweep.parked_deg[a] != 0.0)
      text += fmt::format("/{}={:g}", rotary_letter(a), sweep.parked_deg[a]);
  return text;
}

Json ball_request(const MeasurementProposal& proposal) {
  const model::BallSet& ball = *proposal.ball;
  std::vector<std::string> sweeps;
  for (const auto& sweep : ball.sweeps) sweeps.push_back(sweep_text(sweep));
  return object_of("action"_is("ball"), "ball"_is(ball.place_mm), "tool_offset"_is(ball.tool_mm), "sweep"_is(sweeps),
                   "runs"_is(proposal.runs), "seconds"_is(ball.readings.front().time_s.value_or(0.0)));
}

Result<laser::MeasurementSet> set_in(const Json& answer) {
  const auto csv = answer.find("csv");
  if (csv == answer.end()) return problem(ProblemKind::link, "the workshop answered without readings");
  return laser::parse_measurement_set(csv->get<std::string>(), "the workshop's readings");
}

}  // namespace

/// What the workshop is asked to do, request by request.
class SocketWorkshop::Hands {
 public:
  Hands(const std::filesystem::path& socket, const std::atomic<bool>& cancelled) : client_(socket, cancelled) {}

  [[nodiscard]] Result<Json> state() const { return client_.ask({{"action", "state"}}); }
  [[nodiscard]] Result<Json> ask(const Json& request) const { return client_.ask(request); }
  [[nodiscard]] Result<void> wait(double minutes) const {
    if (minutes <= 0.0) return {};
    return done(client_.ask({{"action", "wait"}, {"seconds", model::kSecondsAMinute * minutes}}));
  }
  [[nodiscard]] Result<void> load(double kg) const { return done(client_.ask({{"action", "load"}, {"kg", kg}})); }
  [[nodiscard]] Result<void> reference() const { return done(client_.ask({{"action", "reference"}})); }
  [[nodiscard]] Result<Json> run(const std::filesystem::path& file, const std::string& program, Json request) const {
    ECS_DO(write_file(file, program));
    request["action"] = "run";
    request["program"] = file.string();
    return client_.ask(request);
  }

 private:
  static Result<void> done(const Result<Json>& answer) {
    if (!answer) return tl::unexpected(answer.error());
    return {};
  }
  WorkshopClient client_;
};

SocketWorkshop::SocketWorkshop(MessageSink& messages, SocketWorkshopOptions options, const std::atomic<bool>& cancelled)
    : messages_(messages),
      options_(std::move(options)),
      cancelled_(cancelled),
      hands_(std::make_unique<Hands>(options_.socket, cancelled)) {}

SocketWorkshop::~SocketWorkshop() {
  if (!folder_.empty()) disc::remove_all(folder_);
}

Result<std::unique_ptr<SocketWorkshop>> SocketWorkshop::open(MessageSink& messages, SocketWorkshopOptions options,
                                                             const std::atomic<bool>& cancelled) {
  std::unique_ptr<SocketWorkshop> workshop(new SocketWorkshop(messages, std::move(options), cancelled));
  ECS_TRY(state, workshop->hands_->state());
  if (workshop->options_.link.empty() && state.contains("link") && state["link"].is_string())
    workshop->options_.link = state["link"].get<std::string>();
  std::string name = (std::filesystem::temp_directory_path() / "ecs-investigation-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) return problem(ProblemKind::output, "cannot make a temporary folder {}", name);
  workshop->folder_ = name;
  if (!workshop->options_.map_is_modelled && compensates(state)) ECS_DO(workshop->stop_compensation());
  return workshop;
}

/// The unit of the workshop is the one whose link this program has open.
bool SocketWorkshop::has_open_link() const {
  const OpenUnit& open = options_.open_unit;
  if (!open.with_unit) return false;
  if (!open.workshop.empty() && options_.socket == open.workshop) return true;
  const auto address = protocol::link_address_of(options_.link);
  const auto* serial = address ? std::get_if<protocol::SerialPort>(&address->endpoint) : nullptr;
  return serial != nullptr && !open.port.empty() && serial->device == open.port;
}

Result<void> SocketWorkshop::with_unit(const std::function<Result<void>(protocol::UnitClient&)>& work) const {
  std::string arm_code = options_.arm_code;
  if (arm_code.empty())
    if (const auto shown = hands_->ask({{"action", "arm-code"}})) arm_code = shown->value("arm_code", "");
  if (has_open_link())
    return options_.open_unit.with_unit([&](protocol::UnitClient& client) {
      if (!arm_code.empty()) client.know_code(arm_code);
      return work(client);
    });
  if (options_.link.empty()) return problem(ProblemKind::usage, "the workshop gives no link to its unit: give --link");
  ECS_TRY(choice, chosen_link(options_.link));
  choice.arm_code = arm_code;
  ECS_TRY(unit, open_link(choice, cancelled_));
  return work(unit.client());
}

/// The errors of the machine are looked for, not what a map leaves of them.
Result<void> SocketWorkshop::stop_compensation() const {
  return with_unit([this](protocol::UnitClient& client) {
    messages_.note("the unit compensates with a map that the model does not state: switched to integration mode");
    return client.enter_integration();
  });
}

/// The poses take the time that they were planned with.
Result<RunReadings> SocketWorkshop::measured_ball(const MeasurementProposal& proposal) const {
  ECS_DO(hands_->wait(proposal.minutes));
  ECS_TRY(answer, hands_->ask(ball_request(proposal)));
  ECS_TRY(set, set_in(answer));
  return RunReadings{std::move(set), proposal.minutes};
}

Result<RunReadings> SocketWorkshop::measure(const RequestedRun& run) {
  if (run.proposal.ball) return measured_ball(run.proposal);
  ECS_TRY(before, hands_->state());
  MeasurementProposal proposal = run.proposal;
  int& set_up = set_ups_[{proposal.axis, proposal.sense}];
  set_up = std::max(set_up, proposal.set_up);  // optics that were aligned stay so
  proposal.set_up = set_up;
  ECS_DO(hands_->wait(proposal.set_up_minutes));
  const double load_kg = proposal.load_kg.value_or(load_kg_);
  if (load_kg != load_kg_) ECS_DO(hands_->load(load_kg));
  load_kg_ = load_kg;
  const auto& facts = options_.machine.axes[index_of(proposal.axis)];
  if (facts && proposal.wait_minutes > 0.0 && wants_warmth(proposal, before)) {
    const auto warmed =
        hands_->run(folder_ / "warm.nc", warming_program(proposal.axis, *facts, proposal.wait_minutes), Json::object());
    if (!warmed) return tl::unexpected(warmed.error());
  } else if (const auto waited = hands_->wait(proposal.wait_minutes); !waited) {
    return tl::unexpected(waited.error());
  }
  ECS_TRY(set, readings_of(proposal));
  complete(set, proposal);
  ECS_TRY(after, hands_->state());
  return RunReadings{std::move(set),
                     (after.value("time_s", 0.0) - before.value("time_s", 0.0)) / model::kSecondsAMinute};
}

/// A part program where the machine stops for its readings, else the instrument's own request.
Result<laser::MeasurementSet> SocketWorkshop::readings_of(const MeasurementProposal& proposal) {
  if (proposal.dwell_s > 0.0 && proposal.set_up <= 1) {
    Json request = object_of("axis"_is(letter(proposal.axis)), "sense"_is(name_of(proposal.sense)));
    add_artefact(request, proposal);
    ECS_TRY(answer, hands_->run(folder_ / "run.nc", part_program(proposal, options_.machine), std::move(request)));
    return set_in(answer);
  }
  if (proposal.short_overrun)
    return problem(ProblemKind::refused,
                   "steps back before each target need readings with a dwell, in the first set-up");
  std::vector<double> feeds{proposal.feed_mm_min};
  if (proposal.second_feed_mm_min) feeds.push_back(*proposal.second_feed_mm_min);
  std::optional<laser::MeasurementSet> all;
  for (const double feed : feeds) {
    ECS_TRY(answer, hands_->ask(measuring_request(proposal, options_.machine, feed)));
    auto set = set_in(answer);
    if (!set) return set;
    if (!all) {
      all = std::move(*set);
      continue;
    }
    for (laser::Reading& reading : set->readings) {
      reading.run += proposal.runs;
      all->readings.push_back(std::move(reading));
    }
  }
  return std::move(*all);
}

/// What the person at the machine knows beside the readings.
void SocketWorkshop::complete(laser::MeasurementSet& set, const MeasurementProposal& proposal) const {
  for (laser::Reading& reading : set.readings) {
    if (!reading.load_kg) reading.load_kg = load_kg_;
    reading.extras["set_up"] = proposal.set_up;
  }
}

Result<void> SocketWorkshop::activate(const model::Model& model) {
  ECS_TRY(files, write_map_files(messages_, model, options_.sources, folder_));
  return with_unit([&](protocol::UnitClient& client) -> Result<void> {
    ECS_DO(send_map_files(client, files));
    ECS_DO(hands_->reference());
    return wait_for_compensation(client, kDatumWait_s);
  });
}

namespace {

std::string params_of(const WorkshopChoice& choice) {
  if (!choice.params.empty()) return choice.params;
  const auto beside = std::filesystem::path(choice.machine).replace_filename("parameters.toml");
  return disc::exists(beside) ? beside.string() : std::string();
}

}  // namespace

Result<OpenedWorkshop> open_workshop(MessageSink& messages, const WorkshopChoice& choice,
                                     const params::Machine& machine, const std::atomic<bool>& cancelled) {
  const MapSources sources{choice.machine, params_of(choice)};
  if (!choice.socket.empty()) {
    ECS_TRY(opened, SocketWorkshop::open(messages,
                                         {choice.socket, choice.link, sources, machine, choice.map_is_modelled,
                                          choice.arm_code, choice.open_unit},
                                         cancelled));
    const std::string link = opened->link();
    return OpenedWorkshop{std::move(opened), link};
  }
  const auto pause = [&cancelled](std::chrono::milliseconds time) {
    std::this_thread::sleep_for(time);
    return !cancelled;
  };
  ECS_TRY(opened, WatchedFolder::open(
                      messages, {choice.folder, choice.model, choice.link, sources, machine, pause, choice.arm_code},
                      cancelled));
  return OpenedWorkshop{std::move(opened), ""};
}

}  // namespace ecs::commissioning
