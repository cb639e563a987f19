#include "commissioning/session/records.hpp"

#include <atomic>
#include <utility>

namespace ecs::commissioning {
namespace {

std::atomic<const RecordKeeper*> keeper_of_records{nullptr};

void add_seen(std::vector<SeenFile>& files, const char* role, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (!name.empty()) files.push_back({role, disc::absolute(name).lexically_normal().string()});
}

}  // namespace

std::vector<SeenFile> seen_files(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs) {
  std::vector<SeenFile> files;
  add_seen(files, "input", inputs);
  add_seen(files, "output", outputs);
  return files;
}

void let_keep_records(const RecordKeeper* keeper) { keeper_of_records = keeper; }

bool records_are_kept() { return keeper_of_records != nullptr; }

void record(LogRecord one) {
  if (const RecordKeeper* keeper = keeper_of_records) keeper->record(std::move(one));
}

std::unique_ptr<FileWatch> watch_for_records() {
  const RecordKeeper* keeper = keeper_of_records;
  return keeper == nullptr ? nullptr : keeper->watch();
}

void let_records_rest(std::chrono::milliseconds idle) {
  if (const RecordKeeper* keeper = keeper_of_records) keeper->rest(idle);
}

std::optional<RecordsEnd> records_end() {
  const RecordKeeper* keeper = keeper_of_records;
  return keeper == nullptr ? std::nullopt : keeper->end();
}

std::optional<std::vector<RecordedUse>> recorded_uses(const std::vector<std::string>& sha256) {
  const RecordKeeper* keeper = keeper_of_records;
  return keeper == nullptr ? std::nullopt : keeper->uses(sha256);
}

}  // namespace ecs::commissioning
