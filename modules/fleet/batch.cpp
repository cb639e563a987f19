#include "modules/fleet/batch.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <numeric>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/outcome.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "base/words.hpp"
#include "commissioning/maps/map_in_unit.hpp"
#include "commissioning/unit/transfer.hpp"
#include "core/mode_word.hpp"
#include "modules/fleet/run.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;

std::string from_folder(const fs::path& folder, const std::string& path) {
  return path.empty() ? path : (folder / path).lexically_normal().string();
}

std::string link_from_folder(const fs::path& folder, const std::string& link) {
  constexpr std::string_view kEmulator = "emulator:";
  if (!link.starts_with(kEmulator) || link.size() == kEmulator.size()) return link;
  return std::string(kEmulator) + from_folder(folder, link.substr(kEmulator.size()));
}

void take_unit(TomlReader& reader, const toml::table& table, const fs::path& folder, std::vector<PlannedUnit>& units) {
  reader.only(table, {"name", "link", "serial_number", "params", "map", "arm_code"}, "unit");
  const auto link = reader.word(table, "link");
  const auto params = reader.word(table, "params");
  if (!table.contains("link")) reader.complain(table, "unit: expected `link`: a batch has no default link");
  if (!table.contains("params")) reader.complain(table, "unit: expected `params`, the parameter file");
  PlannedUnit unit{reader.word(table, "name").value_or(fmt::format("unit {}", units.size() + 1)),
                   {},
                   reader.word(table, "serial_number").value_or(""),
                   from_folder(folder, params.value_or("")),
                   from_folder(folder, reader.word(table, "map").value_or(""))};
  if (link) {
    auto parsed = parsed_link(link_from_folder(folder, *link), "plan");
    if (parsed) {
      unit.link = std::move(*parsed);
      unit.link.arm_code = reader.word(table, "arm_code").value_or("");
    } else {
      reader.complain(*table.get("link"), parsed.error().message);
    }
  }
  units.push_back(std::move(unit));
}

/// Refuses a unit named twice: its second map would replace the first. Units on one link need different serial numbers.
Result<std::vector<PlannedUnit>> each_once(std::vector<PlannedUnit> units, const std::string& name) {
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < units.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (to_text(units[i].link) == to_text(units[k].link) && units[i].serial_number == units[k].serial_number &&
          !units[i].link.is_emulator()) {
        problems.push_back(
            {ProblemKind::bad_input,
             fmt::format("{} and {} have the same link, {}, and are not distinguished by serial numbers: list each "
                         "unit once, or give them a different `serial_number`",
                         units[k].name, units[i].name, to_text(units[i].link)),
             name,
             0,
             0,
             {}});
        break;
      }
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return units;
}

Problem in_line_order(Problem all) {
  std::vector<Problem> problems = std::move(all.also);
  all.also.clear();
  problems.insert(problems.begin(), std::move(all));
  std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
  return folded(std::move(problems));
}

}  // namespace

Result<std::vector<PlannedUnit>> parse_batch_plan(std::string_view text, const std::string& name,
                                                  const fs::path& folder) {
  if (auto other = wrong_kind(FileKind::other, text, name)) return tl::unexpected(std::move(*other));
  TomlReader reader(name);
  ECS_TRY(table, reader.parsed(text));
  reader.only(table, {"unit"}, "plan");
  std::vector<PlannedUnit> units;
  for (const toml::table* unit : reader.children(table, "unit")) take_unit(reader, *unit, folder, units);
  if (units.empty() && reader.clean()) reader.complain(1, "expected at least one [[unit]]");
  if (!reader.clean()) return tl::unexpected(in_line_order(reader.all()));
  return each_once(std::move(units), name);
}

Result<std::vector<PlannedUnit>> batch_plan_of(const Manifest& manifest) {
  std::vector<PlannedUnit> units;
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < manifest.size(); ++i) {
    const auto row = manifest.row(i);
    if (!row) {
      problems.push_back(row.error());
      continue;
    }
    const auto complain = [&](std::string message) {
      problems.push_back({ProblemKind::bad_input, std::move(message), manifest.name(), row->line, 1, {}});
    };
    if (const auto first = manifest.doubles_line(i))
      complain(fmt::format("the id {} is also used in line {}: give each unit its own id", row->id(), *first));
    auto link = parsed_link(link_from_folder(manifest.from_folder("."), row->cells[1]), "plan");
    if (!link) {
      complain(link.error().message);
      continue;
    }
    link->arm_code = row->cells[5];
    units.push_back({row->id(), std::move(*link), row->cells[3], manifest.from_folder(row->cells[2]),
                     manifest.from_folder(row->cells[4])});
  }
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return each_once(std::move(units), manifest.name());
}

Result<std::vector<PlannedUnit>> read_batch_plan(const fs::path& path) {
  if (lower(path.extension().string()) == ".csv") {
    static const ManifestColumns kColumns{{"id", "link", "params"}, {"serial_number", "map", "arm_code"}};
    ECS_TRY(manifest, Manifest::read(path, kColumns));
    return batch_plan_of(manifest);
  }
  ECS_TRY(text, read_file(path));
  return parse_batch_plan(text, path.string(), path.parent_path());
}

namespace {

/// What one unit gets: an image, or parameters that go round the map it has.
struct Load {
  std::optional<PreparedMap> map;
  UnitParameters parameters;
  params::Identity identity;       ///< of the parameters
  std::vector<std::string> notes;  ///< of the image; defaults taken
};

Result<Load> prepared(const PlannedUnit& unit) {
  Load load;
  if (!unit.map.empty()) {
    ECS_TRY(map, prepared_map(unit.map, unit.params));
    load.map = std::move(map);
    load.notes = load.map->image.notes;
    load.notes.insert(load.notes.end(), load.map->remarks.begin(), load.map->remarks.end());
    return load;
  }
  ECS_TRY(file, params::read_parameters(unit.params));
  if (auto objections = objections_to(file, unit.params)) return tl::unexpected(std::move(*objections));
  load.parameters = file.parameters;
  load.identity = file.identity;
  load.notes = params::defaults_in_short(file);
  return load;
}

void fail(BatchReport& report, BatchState state, Problem why) {
  report.state = state;
  report.problem = std::move(why);
}

/// Serial number against the plan, then the map's header and [identity] of the parameters against the unit.
bool is_wrong_unit(const PlannedUnit& unit, const Load& load, BatchReport& report) {
  if (unit.serial_number.empty()) report.notes.push_back("the plan states no serial number: not checked");
  if (!unit.serial_number.empty() && report.serial_number != unit.serial_number) {
    fail(report, BatchState::wrong_unit,
         problem(ProblemKind::refused, "expected serial number \"{}\", found \"{}\": the unit is skipped and unchanged",
                 unit.serial_number, report.serial_number)
             .value());
    return true;
  }
  auto refused = load.map ? refused_map(other_unit(*load.map, report.serial_number), unit.map)
                          : refused_map(other_unit(load.identity, report.serial_number), unit.params);
  if (refused) fail(report, BatchState::wrong_unit, std::move(*refused));
  return refused.has_value();
}

void send(protocol::UnitClient& client, const Load& load, const protocol::ProgressCallback& progress,
          BatchReport& report) {
  const auto sent = load.map ? send_image(client, load.map->image.bytes, Addressee::as_stated, progress)
                             : send_parameters(client, load.parameters, load.identity, UnfitMap::refuse, progress);
  if (!sent) return fail(report, BatchState::failed, sent.error());
  report.state = sent->already_held ? BatchState::held : BatchState::sent;
  report.bytes = sent->bytes;
}

/// Whether the unit has what would be sent, so that nothing is sent in any mode.
bool holds(protocol::UnitClient& client, const protocol::Identity& identity, const Load& load) {
  if (!load.map) {
    const auto parameters = receive_parameters(client);
    return parameters && *parameters == load.parameters;
  }
  const auto image = addressed(load.map->image.bytes, identity, Addressee::as_stated);
  const auto active = client.active_map();
  return image && active && active->digest == protocol::digest_of(*image);
}

void attempt(const PlannedUnit& unit, BatchMode mode, const protocol::ProgressCallback& progress, BatchReport& report) {
  const auto load = prepared(unit);
  if (!load) return fail(report, BatchState::failed, load.error());
  report.notes = load->notes;
  auto link = open_link(unit.link);
  if (!link) return fail(report, BatchState::failed, link.error());
  const auto identity = link->client().identity();
  if (!identity) return fail(report, BatchState::failed, identity.error());
  report.serial_number = identity->serial_number;
  if (is_wrong_unit(unit, *load, report)) return;
  if (mode == BatchMode::send) return send(link->client(), *load, progress, report);
  const auto armed_s = link->client().armed_s();
  if (!armed_s) return fail(report, BatchState::failed, armed_s.error());
  if (*armed_s == 0 && !link->client().knows_code())
    report.notes.push_back("the unit is not armed and no arm_code is given: it would refuse all writes");
  const auto status = link->client().status();
  if (!status) return fail(report, BatchState::failed, status.error());
  if (status->mode != UnitMode::integration && !holds(link->client(), *identity, *load))
    return fail(report, BatchState::failed,
                problem(ProblemKind::refused,
                        "the unit is {}, and accepts data only in integration mode: run `ecs utility mode integrate`",
                        word_of(status->mode))
                    .value());
  report.state = BatchState::ready;
  report.bytes = load->map ? load->map->image.bytes.size() : 0;
}

/// What only one unit can use at a time.
std::string line_of(const LinkChoice& link) {
  const auto* address = std::get_if<protocol::LinkAddress>(&link.link);
  if (address == nullptr) return "emulator";
  if (const auto* port = std::get_if<protocol::SerialPort>(&address->endpoint))
    return std::filesystem::weakly_canonical(port->device).string();
  const auto& peer = std::get<protocol::TcpPeer>(address->endpoint);
  return fmt::format("{}:{}", peer.host, peer.port);
}

/// Places in the plan, by line.
std::vector<std::vector<std::size_t>> units_by_line(const std::vector<PlannedUnit>& plan) {
  std::vector<std::vector<std::size_t>> lines;
  std::map<std::string, std::size_t> place_of;
  for (std::size_t unit = 0; unit < plan.size(); ++unit) {
    const auto [known, is_new] = place_of.try_emplace(line_of(plan[unit].link), lines.size());
    if (is_new) lines.emplace_back();
    lines[known->second].push_back(unit);
  }
  return lines;
}

/// One run of a plan; units may be carried out from several threads.
class Run {
 public:
  Run(const std::vector<PlannedUnit>& plan, BatchMode mode, const BatchWatch& watch)
      : plan_(plan), mode_(mode), watch_(watch), reports_(plan.size()), shares_(plan.size(), 0.0) {
    for (std::size_t unit = 0; unit < plan.size(); ++unit) {
      reports_[unit].name = plan[unit].name;
      reports_[unit].link = to_text(plan[unit].link);
      reports_[unit].is_emulator = plan[unit].link.is_emulator();
    }
  }

  /// Each line is taken and its first unit told in one step: lines start in the order of the plan.
  void carry_out_lines(const std::vector<std::vector<std::size_t>>& lines) {
    for (;;) {
      std::unique_lock lock(mutex_);
      if (next_line_ == lines.size()) return;
      for (const std::size_t unit : lines[next_line_++]) {
        if (!lock.owns_lock()) lock.lock();
        if (!interrupted() && watch_.started) watch_.started(plan_[unit]);
        lock.unlock();
        carry_out(unit);
      }
    }
  }

  [[nodiscard]] const std::vector<BatchReport>& reports() const { return reports_; }

 private:
  void carry_out(std::size_t unit) {
    if (!interrupted()) {
      const auto progress = [this, unit](const protocol::Progress& now) {
        if (now.bytes_total > 0)
          tell(unit, static_cast<double>(now.bytes_done) / static_cast<double>(now.bytes_total), 0);
      };
      attempt(plan_[unit], mode_, progress, reports_[unit]);
    }
    tell(unit, 1.0, 1);
  }

  void tell(std::size_t unit, double share, std::size_t more_done) {
    const std::lock_guard lock(mutex_);
    shares_[unit] = share;
    done_ += more_done;
    if (!watch_.progress) return;
    const double of_all = std::accumulate(shares_.begin(), shares_.end(), 0.0) /
                          static_cast<double>(std::max<std::size_t>(plan_.size(), 1));
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun_at_;
    watch_.progress({done_, plan_.size(), of_all, of_all > 0.0 ? spent.count() * (1.0 - of_all) / of_all : 0.0});
  }

  const std::vector<PlannedUnit>& plan_;
  BatchMode mode_;
  const BatchWatch& watch_;
  std::vector<BatchReport> reports_;
  std::mutex mutex_;
  std::vector<double> shares_;
  std::size_t next_line_ = 0;
  std::size_t done_ = 0;
  std::chrono::steady_clock::time_point begun_at_ = std::chrono::steady_clock::now();
};

}  // namespace

std::string_view name_of(BatchState state) {
  constexpr WordTable<BatchState, 6> kWords{{"ready", "sent", "held already", "failed", "skipped", "not attempted"}};
  return kWords.of(state);
}

std::vector<BatchReport> run_batch(const std::vector<PlannedUnit>& plan, BatchMode mode, int lines,
                                   const BatchWatch& watch) {
  const auto queues = units_by_line(plan);
  Run run{plan, mode, watch};
  std::vector<std::thread> workers;
  for (std::size_t i = 0; i < std::min(queues.size(), static_cast<std::size_t>(lines)); ++i)
    workers.emplace_back([&] { run.carry_out_lines(queues); });
  for (std::thread& worker : workers) worker.join();
  return run.reports();
}

const Problem* first_problem(const std::vector<BatchReport>& reports) {
  const Problem* first = nullptr;
  for (const BatchReport& report : reports) {
    if (!report.problem) continue;
    if (report.problem->kind == ProblemKind::link) return &*report.problem;
    if (first == nullptr) first = &*report.problem;
  }
  return first;
}

int exit_code_of(const std::vector<BatchReport>& reports) {
  const auto done = [](const BatchReport& report) {
    return report.state == BatchState::ready || report.state == BatchState::sent || report.state == BatchState::held;
  };
  if (std::all_of(reports.begin(), reports.end(), done)) return kDone;
  const Problem* first = first_problem(reports);
  return first != nullptr && first->kind == ProblemKind::link ? exit_code_of(ProblemKind::link) : kDoesNotHold;
}

}  // namespace ecs::commissioning
