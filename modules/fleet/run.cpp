#include "modules/fleet/run.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <ctime>
#include <exception>
#include <list>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "commissioning/models/work.hpp"
#include "laser/csv_table.hpp"
#include "model/diagnosis/diagnose.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostData = 8u << 20;

/// A FIFO or a device would hold up the others.
Result<std::string> regular_file(const fs::path& path) {
  if (disc::exists(path) && !disc::is_file(path))
    return problem_at(path.string(), 0, 0, "expected a file, found a folder or a device");
  return read_file(path);
}

void append_part(std::string& all, std::string_view name, std::string_view content) {
  all += fmt::format("{} {}\n", name, content.size());
  all += content;
}

MachineSet machine_set_of(const Manifest& manifest, const ManifestRow& row) {
  const auto& cells = row.cells;
  return {cells[0],
          manifest.from_folder(cells[1]),
          manifest.from_folder(cells[2]),
          manifest.from_folder(cells[3]),
          cells[4],
          cells[5]};
}

}  // namespace

const ManifestColumns& fleet_columns() {
  static const ManifestColumns columns{{"id", "model", "data"}, {"machine", "type", "batch"}};
  return columns;
}

Result<std::string> content_hash(const MachineSet& set, std::size_t noise_replicates) {
  std::error_code error;
  if (const auto bytes = fs::file_size(set.data, error); !error && bytes > kMostData)
    return problem_at(set.data, 0, 0, "expected at most {} MiB of readings, found {}: use `ecs model diagnose`",
                      kMostData >> 20, bytes >> 20);
  std::string all = fmt::format("noise replicates {}\n", noise_replicates);
  ECS_TRY(model_text, regular_file(set.model));
  append_part(all, "model", model_text);
  ECS_TRY(model, model::read_model(set.model));
  std::vector<std::pair<std::string_view, fs::path>> others{{"data", set.data}};
  if (!set.machine.empty()) others.emplace_back("machine", set.machine);
  if (!model.map_file.empty()) others.emplace_back("map", fs::path(set.model).parent_path() / model.map_file);
  for (const auto& [name, path] : others) {
    ECS_TRY(content, regular_file(path));
    append_part(all, name, content);
  }
  return sha256_hex(all);
}

Result<FleetResult> diagnosed(const MachineSet& set, const std::string& hash, std::size_t noise_replicates,
                              const std::atomic<bool>* cancelled) {
  NoMessages unread;
  ECS_TRY(work, model_work(unread, {set.model, {set.data}, set.machine, {}}));
  model::DiagnoseOptions options;
  options.noise_replicates = noise_replicates;
  options.cancelled = cancelled;
  options.p_values = true;
  const auto names = model::named_causes(work.model, work.data, options);
  if (!names) return tl::unexpected(in_file(names.error(), set.data));
  FleetResult result{set.id, hash,          std::string(name_of(names->verdict)), {}, set.type, set.batch, 0.0, {},
                     false,  names->p_value};
  for (const model::NamedCause& cause : names->causes)
    result.causes.push_back({cause.name, cause.probability, cause.e_value, cause.false_naming, cause.p_value,
                             std::string(name_of(cause.standing)), cause.rivals});
  return result;
}

namespace {

/// Between two looks of the calling thread, and between two syncs: after a power cut no more than that is done again.
constexpr std::chrono::milliseconds kLook{50};
constexpr double kSyncEvery_s = 5.0;

double thread_processor_s() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The place of a thread.
struct Worker {
  std::atomic<bool> cancelled{false};
  double begun_s = 0.0;  ///< 0: nothing under way; behind the lock of the run, as is the order to stop
  std::thread thread;
};

class FleetRun {
 public:
  FleetRun(const Manifest& manifest, ResultsFile& results, UnderWay& under_way, const FleetOptions& options,
           const FleetWatch& watch)
      : manifest_(manifest), results_(results), under_way_(under_way), options_(options), watch_(watch) {}

  Result<FleetReport> carried_out(int threads) {
    order_those_under_way_last();
    const double begun_s = steady_s();
    std::list<Worker> workers(static_cast<std::size_t>(threads));
    working_ = threads;
    int number = 0;
    for (Worker& worker : workers)
      worker.thread = std::thread([this, &worker, thread = number++] { work(worker, thread); });
    watch_over(workers);
    for (Worker& worker : workers) worker.thread.join();
    if (!failed_ && !stopping()) write_doubled_rows();
    report_errors();
    std::stable_sort(report_.errors.begin(), report_.errors.end(),
                     [](const FleetError& a, const FleetError& b) { return a.line < b.line; });
    if (auto synced = results_.sync(); !synced && !failed_) failed_ = synced.error();
    if (failed_) return tl::unexpected(*failed_);
    report_.stopped = interrupted().load();
    report_.seconds = steady_s() - begun_s;
    return std::move(report_);
  }

 private:
  [[nodiscard]] bool stopping() const { return interrupted().load() || giving_up_.load(); }

  void order_those_under_way_last() {
    for (std::size_t i = options_.part.number - 1; i < manifest_.size(); i += options_.part.of)
      order_.push_back(static_cast<std::uint32_t>(i));
    report_.machines = order_.size();
    if (under_way_.ends().empty()) return;
    std::stable_partition(order_.begin(), order_.end(), [this](std::uint32_t i) {
      const auto row = manifest_.row(i);
      return !row || !under_way_.ends().contains(row->id());
    });
  }

  void work(Worker& worker, int thread) {
    for (std::size_t next = next_++; next < order_.size() && !stopping(); next = next_++) {
      const double before_s = thread_processor_s();
      try {
        carry_out(order_[next], worker, thread);
      } catch (const std::exception& thrown) {
        const auto row = manifest_.row(order_[next]);
        add_error(order_[next], row ? row->id() : "", thrown.what());
      }
      under_way_.finish(thread);
      const std::lock_guard lock(mutex_);
      worker.begun_s = 0.0;
      report_.processor_s += thread_processor_s() - before_s;
    }
    const std::lock_guard lock(mutex_);
    --working_;
    changed_.notify_all();
  }

  void carry_out(std::size_t i, Worker& worker, int thread) {
    const double before_s = thread_processor_s();
    const auto row = manifest_.row(i);
    if (!row) return add_error(i, "", row.error().message);
    if (manifest_.doubles_line(i)) return;  // their lines are written at the end
    const auto ends = under_way_.ends().find(row->id());
    if (ends != under_way_.ends().end() && ends->second >= kMostUncleanEnds)
      return add_error(i, row->id(),
                       fmt::format("the program ended {} times while processing these files: the machine is skipped in "
                                   "this run; the next run tries it again",
                                   ends->second));
    const MachineSet set = machine_set_of(manifest_, *row);
    {
      const std::lock_guard lock(mutex_);
      worker.cancelled = false;
      worker.begun_s = steady_s();
    }
    under_way_.begin(thread, set.id);
    const auto hash = content_hash(set, options_.noise_replicates);
    if (!hash) return add_error(i, set.id, to_text(hash.error()));
    FleetResult labels{set.id, {}, {}, {}, set.type, set.batch, 0.0, {}, false};
    switch (results_.holds(labels, *hash)) {
      case ResultsFile::Held::yes:
        return count_skipped();
      case ResultsFile::Held::other_labels:
        return label_anew(labels);
      case ResultsFile::Held::no:
        break;
    }
    auto result = diagnosed(set, *hash, options_.noise_replicates, &worker.cancelled);
    if (!result)
      return add_error(
          i, set.id,
          worker.cancelled
              ? fmt::format("stopped after {:g} s: raise --limit, or use `ecs model diagnose`", options_.most_s)
              : to_text(result.error()));
    result->processor_s = thread_processor_s() - before_s;
    keep(*result);
    const std::lock_guard lock(mutex_);
    ++report_.diagnosed;
    ++report_.verdicts[result->verdict];
  }

  void count_skipped() {
    const std::lock_guard lock(mutex_);
    ++report_.skipped;
  }

  void label_anew(const FleetResult& labels) {
    auto result = results_.held(labels.id);
    if (!result) return give_up(result.error());
    result->type = labels.type;
    result->batch = labels.batch;
    keep(*result);
    count_skipped();
  }

  void keep(const FleetResult& result) {
    if (auto written = results_.append(result); !written) give_up(written.error());
  }

  void give_up(const Problem& why) {
    const std::lock_guard lock(mutex_);
    if (!failed_) failed_ = why;
    giving_up_ = true;
  }

  void add_error(std::size_t i, const std::string& id, const std::string& message, bool doubled = false) {
    if (stopping()) return;
    const auto row = manifest_.row(i);
    const int line = row ? row->line : row.error().line;
    FleetResult result;
    result.id = id;
    result.error = fmt::format("{}:{}: {}", manifest_.name(), line, message);
    result.doubled = doubled;
    keep(result);
    const std::lock_guard lock(mutex_);
    report_.errors.push_back({line, id, result.error});
  }

  void write_doubled_rows() {
    for (const std::uint32_t i : order_)
      if (const auto first = manifest_.doubles_line(i))
        if (const auto row = manifest_.row(i))
          add_error(i, row->id(),
                    fmt::format("the id {} is also used in line {}: give each machine its own id", row->id(), *first),
                    true);
  }

  /// Errors that were not yet passed on.
  void report_errors() {
    std::vector<FleetError> fresh;
    {
      const std::lock_guard lock(mutex_);
      fresh.assign(report_.errors.begin() + static_cast<std::ptrdiff_t>(reported_), report_.errors.end());
      reported_ = report_.errors.size();
    }
    if (watch_.error)
      for (const FleetError& error : fresh) watch_.error(error);
  }

  void report_progress(double now_s) {
    if (!watch_.progress) return;
    FleetProgress progress;
    {
      const std::lock_guard lock(mutex_);
      if (report_.diagnosed == 0) first_diagnosed_s_ = now_s;
      progress.done = report_.diagnosed + report_.skipped + report_.errors.size();
      progress.machines = report_.machines;
      const double each_s =
          report_.diagnosed > 1 ? (now_s - first_diagnosed_s_) / static_cast<double>(report_.diagnosed) : 0.0;
      progress.seconds_left =
          each_s * static_cast<double>(progress.machines - std::min(progress.done, progress.machines));
    }
    watch_.progress(progress);
  }

  void watch_over(std::list<Worker>& workers) {
    double synced_s = steady_s();
    for (;;) {
      {
        std::unique_lock lock(mutex_);
        if (changed_.wait_for(lock, kLook, [this] { return working_ == 0; })) return;
      }
      const double now_s = steady_s();
      {
        const std::lock_guard lock(mutex_);
        for (Worker& worker : workers)
          if (stopping() || (worker.begun_s > 0.0 && now_s - worker.begun_s > options_.most_s)) worker.cancelled = true;
      }
      if (now_s - synced_s > kSyncEvery_s) {
        if (auto synced = results_.sync(); !synced) give_up(synced.error());
        synced_s = now_s;
      }
      report_errors();
      report_progress(now_s);
    }
  }

  const Manifest& manifest_;
  ResultsFile& results_;
  UnderWay& under_way_;
  const FleetOptions& options_;
  const FleetWatch& watch_;
  std::vector<std::uint32_t> order_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> giving_up_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  int working_ = 0;
  std::size_t reported_ = 0;
  double first_diagnosed_s_ = 0.0;
  std::optional<Problem> failed_;
  FleetReport report_;
};

}  // namespace

Result<FleetPart> fleet_part(std::string_view text) {
  const auto parts = split(text, '/');
  const auto number = integer_in(parts.front()), of = integer_in(parts.back());
  if (parts.size() != 2 || !number || !of || *number < 1 || *of < *number)
    return problem(ProblemKind::usage, "--part: expected K/N with K from 1 to N, as in 3/16, got {}", text);
  return FleetPart{static_cast<std::size_t>(*number), static_cast<std::size_t>(*of)};
}

Result<FleetReport> run_fleet(const Manifest& manifest, const std::string& output, const FleetOptions& options,
                              const FleetWatch& watch) {
  const int cores = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMostThreads);
  const int wanted = options.threads > 0 ? options.threads : cores;
  const int threads = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(wanted), manifest.size()));
  ECS_TRY(under_way, UnderWay::open(output + ".work", threads));
  auto results = ResultsFile::open(output);
  if (!results) {
    under_way.remove();
    return tl::unexpected(results.error());
  }
  auto report = FleetRun(manifest, *results, under_way, options, watch).carried_out(threads);
  under_way.remove();
  return report;
}

}  // namespace ecs::commissioning
