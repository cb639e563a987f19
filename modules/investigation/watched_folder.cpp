#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/link/unit_link.hpp"
#include "commissioning/maps/from_model.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/unit/status.hpp"
#include "commissioning/unit/utility_work.hpp"
#include "model/planning/questions.hpp"
#include "model/planning/run.hpp"
#include "modules/investigation/workshops.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::chrono::milliseconds kPoll{100};
constexpr const char* kNotInvestigated = "not part of the investigated model";

/// Components of the machine that the map of the model does not hold.
std::vector<std::string> declared_zero(const MapFromModel& built, const params::Machine& machine) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < kComponents; ++i) {
    const auto component = static_cast<Component>(i);
    const auto moving = axis_of(name_of(component).back());
    if (moving && machine.axes[index_of(*moving)] && !built.effects.contains(component))
      words.push_back(fmt::format("{}={}", name_of(component), kNotInvestigated));
  }
  return words;
}

}  // namespace

Result<ModelMapFiles> write_map_files(MessageSink& messages, const model::Model& model, const MapSources& sources,
                                      const std::filesystem::path& folder) {
  const ModelMapFiles files{folder / "model.toml", folder / "map.csv", folder / "parameters.toml"};
  ECS_DO(model::write_model(files.model, model));
  ECS_TRY(machine, machine_in(messages, sources.machine));
  FromModelArguments arguments;
  arguments.model = files.model;
  arguments.machine = sources.machine;
  arguments.params = sources.params;
  NoMessages silent;
  ECS_TRY(first, map_from_model(silent, arguments));
  arguments.zero = declared_zero(first, *machine);
  arguments.output = files.map;
  arguments.params_out = files.params;
  ECS_DO(map_from_model(messages, arguments));
  return files;
}

Result<void> send_map_files(protocol::UnitClient& client, const ModelMapFiles& files) {
  ECS_TRY(map, prepared_map(files.map, files.params));
  ECS_TRY(status, client.status());
  if (status.mode != UnitMode::integration) ECS_DO(client.enter_integration());
  ECS_DO(send_map(client, map, files.map, false));
  return begin_compensation(client);
}

Result<void> wait_for_compensation(protocol::UnitClient& client, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    ECS_TRY(status, client.status());
    if (status.mode == UnitMode::compensating) return {};
    if (status.fault != Fault::none) return problem(ProblemKind::link, fault_sentence(status));
    if (status.mode == UnitMode::integration)
      return problem(ProblemKind::link, "the unit returned to integration mode");
    if (std::chrono::steady_clock::now() >= end)
      return problem(ProblemKind::link, "the unit does not compensate: not every axis has been referenced");
    if (!client.link().pause(kPoll)) return problem(ProblemKind::link, "stopped while the axes were being referenced");
  }
}

namespace {

using model::MeasurementProposal;

constexpr std::chrono::milliseconds kLook{300};
constexpr double kReferencing_s = 3600.0;  ///< for a person to reference the axes
constexpr double kOtherLine_mm = 1.0;      ///< readings parked further away are of another line
constexpr const char* kAsked = "asked";    ///< folder of part programs and target lists
constexpr const char* kMap = "map";        ///< folder of the map
/// End of the name of an empty file beside readings: no more of them will come.
constexpr std::string_view kComplete = ".complete";
/// Files that are never readings.
constexpr std::array<std::string_view, 5> kOthers{".json", ".toml", ".nc", ".part", kComplete};

tl::unexpected<Problem> refused(std::string why) { return problem(ProblemKind::refused, std::move(why)); }

bool may_be_readings(const std::filesystem::directory_entry& entry) {
  std::error_code error;
  const std::string name = entry.path().filename().string();
  const std::string extension = entry.path().extension().string();
  return entry.is_regular_file(error) && !name.starts_with(".") &&
         std::find(kOthers.begin(), kOthers.end(), extension) == kOthers.end();
}

bool is_complete(const std::filesystem::path& readings) {
  return disc::exists(readings.string() + std::string(kComplete));
}

/// Files that do not say their line are taken for the one that was asked for.
Result<laser::MeasurementSet> read_for(const std::filesystem::path& file, const MeasurementProposal& proposal) {
  auto read = read_measurements(file.string(), {});
  if (!read && read.error().kind == ProblemKind::usage) {
    ImportArguments import;
    import.axis = std::string(1, letter_of(proposal.axis));
    import.sense = std::string(name_of(proposal.sense));
    import.parked = fmt::format("x={},y={},z={}", proposal.parked_mm[0], proposal.parked_mm[1], proposal.parked_mm[2]);
    read = read_measurements(file.string(), import);
  }
  if (!read) return tl::unexpected(read.error());
  if (proposal.reversed)  // a file that says nothing of the artefact holds what was asked for
    for (laser::Reading& reading : read->set.readings)
      reading.extras.try_emplace("reversed", *proposal.reversed ? 1.0 : 0.0);
  return std::move(read->set);
}

bool states(const laser::MeasurementSet& set, const std::string& column) {
  return std::find(set.columns.begin(), set.columns.end(), column) != set.columns.end();
}

/// "EX along X at Y -700"
std::string line_text(Axis axis, Sense sense) { return fmt::format("{} along {}", name_of(sense), letter_of(axis)); }

/// Why the readings are not those that were asked for; empty: they are.
std::string not_asked_for(const laser::MeasurementSet& set, const RequestedRun& run) {
  constexpr std::array<const char*, kAxes> kColumns{"x_mm", "y_mm", "z_mm"};
  const MeasurementProposal& asked = run.proposal;
  bool forward = false, reverse = false;
  for (const laser::Reading& reading : set.readings) {
    if (reading.axis != asked.axis || reading.sense != asked.sense)
      return fmt::format("it contains {}; {} was requested", line_text(reading.axis, reading.sense),
                         line_text(asked.axis, asked.sense));
    for (const Axis a : kAllAxes)
      if (a != asked.axis && states(set, kColumns[index_of(a)]) &&
          std::abs(reading.position_mm[index_of(a)] - asked.parked_mm[index_of(a)]) > kOtherLine_mm)
        return fmt::format("it was measured at {} {:g} mm; {} {:g} mm was requested", letter_of(a),
                           reading.position_mm[index_of(a)], letter_of(a), asked.parked_mm[index_of(a)]);
    forward = forward || reading.approach == Approach::forward;
    reverse = reverse || reading.approach == Approach::reverse;
    if (run.with_new_map && reading.compensated && !*reading.compensated)
      return "it was measured without compensation; the line with the new map active was requested";
  }
  if ((asked.bidirectional || asked.approach > 0) && !forward) return "it has no readings of forward approach";
  if ((asked.bidirectional || asked.approach < 0) && !reverse) return "it has no readings of reverse approach";
  return "";
}

Json json_of(const GivenRun& run) {
  return object_of("number"_is(run.number), "asked"_is(run.asked), "file"_is(run.file), "sha256"_is(run.sha256),
                   "minutes"_is(run.minutes));
}

std::optional<GivenRun> given_in(const Json& object) {
  if (!object.is_object() || !object.contains("file") || !object.contains("sha256")) return std::nullopt;
  return GivenRun{object.value("number", 0), object.value("asked", std::string()), object["file"].get<std::string>(),
                  object["sha256"].get<std::string>(), object.value("minutes", 0.0)};
}

}  // namespace

WatchedFolder::WatchedFolder(MessageSink& messages, WatchedFolderOptions options, const std::atomic<bool>& cancelled)
    : messages_(messages), options_(std::move(options)), cancelled_(cancelled) {}

Result<std::unique_ptr<WatchedFolder>> WatchedFolder::open(MessageSink& messages, WatchedFolderOptions options,
                                                           const std::atomic<bool>& cancelled) {
  std::unique_ptr<WatchedFolder> watched(new WatchedFolder(messages, std::move(options), cancelled));
  std::error_code error;
  std::filesystem::create_directories(watched->options_.folder / kAsked, error);
  if (error)
    return problem(ProblemKind::output, "{}: cannot make the folder: {}", watched->options_.folder.string(),
                   error.message());
  ECS_TRY(model, read_file(watched->options_.model));
  watched->model_sha256_ = sha256_hex(model);
  ECS_DO(watched->read_ledger());
  return watched;
}

Result<void> WatchedFolder::read_ledger() {
  if (!disc::exists(ledger_file())) return {};
  ECS_TRY(text, read_file(ledger_file()));
  const Json ledger = Json::parse(text, nullptr, false);
  if (!ledger.is_object() || !ledger.contains("model_sha256") || !ledger.contains("runs"))
    return problem_at(ledger_file().string(), 0, 0, "expected the ledger of an investigation");
  model_sha256_ = ledger["model_sha256"].get<std::string>();
  map_active_ = ledger.value("map_active", false);
  for (const Json& one : ledger["runs"])
    if (auto given = given_in(one)) given_.push_back(std::move(*given));
  if (!given_.empty())
    messages_.note(fmt::format("continuing with {}: {} {} already provided", ledger_file().string(), given_.size(),
                               given_.size() == 1 ? "run was" : "runs were"));
  return {};
}

Result<void> WatchedFolder::write_ledger() const {
  Json runs = Json::array(), steps = Json::array();
  for (const GivenRun& one : given_) runs.push_back(json_of(one));
  for (const std::string& one : steps_) steps.push_back(Json::parse(one));
  const Json ledger = object_of("model"_is(options_.model.string()), "model_sha256"_is(model_sha256_),
                                "map_active"_is(map_active_), "runs"_is(std::move(runs)), "steps"_is(std::move(steps)));
  constexpr int kIndent = 1;
  return write_file(ledger_file(), ledger.dump(kIndent, ' ', false, Json::error_handler_t::replace) + "\n");
}

Result<RunReadings> WatchedFolder::measure(const RequestedRun& run) {
  if (run.proposal.ball)
    return problem(ProblemKind::usage,
                   "sets of a ball are measured in a workshop only; `ecs model next` plans them for a person");
  for (GivenRun& given : given_) {
    if (given.number != run.number) continue;
    auto readings = given_before(run, given);
    if (readings) return readings;
    messages_.warn(fmt::format("{}, provided for run {}: {}", given.file, run.number, to_text(readings.error())));
    std::erase_if(given_, [&](const GivenRun& one) { return one.number == run.number; });
    break;
  }
  ECS_DO(ask_for(run));
  return wait_for(run);
}

/// A run of the ledger, if its file is still the one that was given.
Result<RunReadings> WatchedFolder::given_before(const RequestedRun& run, GivenRun& given) {
  ECS_TRY(content, read_file(options_.folder / given.file));
  if (sha256_hex(content) != given.sha256) return refused("the file was changed since");
  ECS_TRY(set, read_for(options_.folder / given.file, run.proposal));
  if (const std::string why = not_asked_for(set, run); !why.empty()) return refused(why);
  return RunReadings{std::move(set), given.minutes};
}

Result<void> WatchedFolder::ask_for(const RequestedRun& run) const {
  const std::filesystem::path asked = options_.folder / kAsked;
  const std::string program = asked / fmt::format("run_{:02}.nc", run.number);
  const std::string targets = asked / fmt::format("run_{:02}_targets.csv", run.number);
  ECS_DO(write_file(program, part_program(run.proposal, options_.machine)));
  ECS_DO(write_file(targets, target_list(run.proposal)));
  messages_.note(fmt::format("run {}{}: {}", run.number, run.with_new_map ? ", with the new map active" : "",
                             run.proposal.sentence));
  messages_.note(
      fmt::format("part program {}, targets {}; save the readings in {}", program, targets, options_.folder.string()));
  return {};
}

bool WatchedFolder::model_is_the_same() {
  const auto content = read_file(options_.model);
  const bool same = content && sha256_hex(*content) == model_sha256_;
  if (!same && !model_named_)
    messages_.warn(
        fmt::format("{} is not the model of this investigation. Restore it, or begin another investigation in another "
                    "folder. No readings are accepted until then.",
                    options_.model.string()));
  model_named_ = !same;
  return same;
}

/// Files that did not change between two looks and were not refused as they are.
std::vector<std::filesystem::path> WatchedFolder::settled_files() {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(options_.folder, error)) {
    if (!may_be_readings(entry)) continue;
    const std::string name = entry.path().filename().string();
    Seen now{entry.file_size(error), entry.last_write_time(error), is_complete(entry.path()), false};
    const auto before = seen_.find(name);
    if (before == seen_.end() || !before->second.is_as(now))
      seen_[name] = now;
    else if (!before->second.refused)
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

Result<RunReadings> WatchedFolder::wait_for(const RequestedRun& run) {
  for (;;) {
    const bool same_model = model_is_the_same();
    for (const std::filesystem::path& file : settled_files()) {
      if (!same_model) break;
      const std::string name = file.filename().string();
      const auto content = read_file(file);
      if (!content) continue;
      const std::string hash = sha256_hex(*content);
      const auto old = std::find_if(given_.begin(), given_.end(), [&](const auto& one) { return one.sha256 == hash; });
      if (old != given_.end() && old->file == name) continue;
      auto set = old == given_.end()
                     ? taken(file, *content, run)
                     : Result<laser::MeasurementSet>(refused(
                           fmt::format("the same readings were provided as {} for run {}", old->file, old->number)));
      if (!set) {
        seen_[name].refused = true;
        messages_.warn(fmt::format("{} is not accepted and not moved: {}. Run {} is still needed.", name,
                                   to_text(set.error()), run.number));
        continue;
      }
      given_.push_back({run.number, run.proposal.sentence, name, hash, run.proposal.minutes});
      ECS_DO(write_ledger());
      messages_.note(fmt::format("{} accepted for run {}: {} readings", name, run.number, set->readings.size()));
      return RunReadings{std::move(*set), run.proposal.minutes};
    }
    if (cancelled_ || !options_.pause(kLook))
      return refused(given_.empty()
                         ? std::string("stopped. No readings have been accepted; repeat the command to continue")
                         : fmt::format("stopped. The accepted readings are kept in {}; repeat the command to continue",
                                       ledger_file().string()));
  }
}

Result<laser::MeasurementSet> WatchedFolder::taken(const std::filesystem::path& file, const std::string& content,
                                                   const RequestedRun& run) const {
  if (content.empty()) return refused("the file is empty");
  if (content.back() != '\n') return refused("its last line has no end; it may be half written");
  auto set = read_for(file, run.proposal);
  if (!set) return tl::unexpected(set.error());
  if (set->readings.empty()) return refused("it contains no readings");
  if (const std::string why = not_asked_for(*set, run); !why.empty()) return refused(why);
  const std::size_t asked = model::stops_of(run.proposal).size();
  if (set->readings.size() < asked && !is_complete(file))
    return refused(
        fmt::format("it contains {} of the {} requested readings; it may be half written. If it is complete, create an "
                    "empty file {}{} in the same folder",
                    set->readings.size(), asked, file.filename().string(), kComplete));
  return set;
}

Result<void> WatchedFolder::activate(const model::Model& model) {
  if (map_active_) return {};
  ECS_DO(make_active(model));
  map_active_ = true;
  return write_ledger();
}

Result<void> WatchedFolder::make_active(const model::Model& model) {
  const std::filesystem::path folder = options_.folder / kMap;
  disc::make_folders(folder);
  ECS_TRY(files, write_map_files(messages_, model, options_.sources, folder));
  if (options_.link.empty()) {
    messages_.note(
        fmt::format("send the map with `{}`, then switch the unit to compensation with `ecs utility mode compensate` "
                    "and reference the axes; both use the stored link, or --link",
                    shell_command({"ecs", "map", "send", files.map, "--params", files.params})));
    return {};
  }
  ECS_TRY(choice, chosen_link(options_.link));
  choice.arm_code = options_.arm_code;
  ECS_TRY(unit, open_link(choice, cancelled_));
  ECS_DO(unit.client().status());
  ECS_DO(send_map_files(unit.client(), files));
  messages_.note("the map was sent. Reference every axis of the machine now; the unit is waiting");
  return wait_for_compensation(unit.client(), kReferencing_s);
}

void WatchedFolder::keep(const InvestigationStep& step) {
  steps_.push_back(one_line(step_cell(step).json));
  (void)write_ledger();  // written again with the next run; a run that cannot be kept is a problem there
}

}  // namespace ecs::commissioning
