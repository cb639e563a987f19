#include "commissioning/batch/run.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <numeric>
#include <thread>

#include <fmt/format.h>

#include "base/interrupt.hpp"
#include "base/outcome.hpp"
#include "commissioning/maps/prepared_map.hpp"
#include "commissioning/unit/map_checks.hpp"
#include "commissioning/unit/transfer.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {
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
  load.notes = params::defaults_taken(file);
  return load;
}

void fail(BatchReport& report, BatchState state, Problem why) {
  report.state = state;
  report.problem = std::move(why);
}

/// Serial number against the plan, then the map's header and [identity] of the parameters against the unit.
bool is_wrong_unit(const PlannedUnit& unit, const Load& load, BatchReport& report) {
  if (unit.serial_number.empty()) report.notes.push_back("the plan gives no serial number: not checked");
  if (!unit.serial_number.empty() && report.serial_number != unit.serial_number) {
    fail(report, BatchState::wrong_unit,
         problem(ProblemKind::refused,
                 fmt::format("expected the unit with serial number {}, found {}: skipped, untouched",
                             unit.serial_number, report.serial_number))
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
    report.notes.push_back("the unit is not armed and no arm_code is given: it would refuse what is sent");
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
std::vector<std::vector<std::size_t>> lines_of(const std::vector<PlannedUnit>& plan) {
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

  void carry_out(std::size_t unit) {
    if (!interrupted()) {
      begin(unit);
      const auto progress = [this, unit](const protocol::Progress& now) {
        if (now.bytes_total > 0)
          tell(unit, static_cast<double>(now.bytes_done) / static_cast<double>(now.bytes_total), 0);
      };
      attempt(plan_[unit], mode_, progress, reports_[unit]);
    }
    tell(unit, 1.0, 1);
  }

  [[nodiscard]] const std::vector<BatchReport>& reports() const { return reports_; }

 private:
  void begin(std::size_t unit) {
    const std::lock_guard lock(mutex_);
    if (watch_.begun) watch_.begun(plan_[unit]);
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
  std::size_t done_ = 0;
  std::chrono::steady_clock::time_point begun_at_ = std::chrono::steady_clock::now();
};

}  // namespace

std::string_view name_of(BatchState state) {
  switch (state) {
    case BatchState::ready:
      return "ready";
    case BatchState::sent:
      return "sent";
    case BatchState::held:
      return "held already";
    case BatchState::failed:
      return "failed";
    case BatchState::wrong_unit:
      return "skipped";
    case BatchState::not_attempted:
      break;
  }
  return "not attempted";
}

std::vector<BatchReport> run_batch(const std::vector<PlannedUnit>& plan, BatchMode mode, int lines,
                                   const BatchWatch& watch) {
  const auto queues = lines_of(plan);
  Run run{plan, mode, watch};
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> workers;
  for (std::size_t i = 0; i < std::min(queues.size(), static_cast<std::size_t>(lines)); ++i)
    workers.emplace_back([&] {
      for (std::size_t line = next++; line < queues.size(); line = next++)
        for (const std::size_t unit : queues[line]) run.carry_out(unit);
    });
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
