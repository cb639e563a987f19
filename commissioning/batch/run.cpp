#include "commissioning/batch/run.hpp"

#include <algorithm>

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
    auto map = prepared_map(unit.map, unit.params);
    if (!map) return tl::unexpected(map.error());
    load.map = std::move(*map);
    load.notes = load.map->image.notes;
    load.notes.insert(load.notes.end(), load.map->remarks.begin(), load.map->remarks.end());
    return load;
  }
  const auto file = params::read_parameters(unit.params);
  if (!file) return tl::unexpected(file.error());
  if (auto objections = objections_to(*file, unit.params)) return tl::unexpected(std::move(*objections));
  load.parameters = file->parameters;
  load.identity = file->identity;
  load.notes = params::defaults_taken(*file);
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
  report.state = BatchState::ready;
  report.bytes = load->map ? load->map->image.bytes.size() : 0;
}

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

std::vector<BatchReport> run_batch(const std::vector<PlannedUnit>& plan, BatchMode mode, const BatchTurn& turn) {
  std::vector<BatchReport> reports;
  for (const PlannedUnit& unit : plan) {
    BatchReport report;
    report.name = unit.name;
    report.link = to_text(unit.link);
    report.is_emulator = unit.link.is_emulator();
    if (!interrupted()) attempt(unit, mode, turn(unit), report);
    reports.push_back(std::move(report));
  }
  return reports;
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
