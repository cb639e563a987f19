#include "modules/logbook/recorder.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "base/json.hpp"
#include "base/settings.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "commissioning/unit/transfer.hpp"
#include "core/memory_image.hpp"
#include "laser/map/image.hpp"
#include "modules/logbook/place.hpp"
#include "modules/logbook/store.hpp"

namespace ecs::commissioning {
namespace {

thread_local const ObservedFiles* observed_by_thread = nullptr;

std::filesystem::path whole(const std::filesystem::path& path) {
  std::error_code error;
  const auto absolute = std::filesystem::absolute(path, error);
  return error ? path : absolute.lexically_normal();
}

bool is_within(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return !folder.empty() && end == folder.end();
}

}  // namespace

ObservedFiles::ObservedFiles() : before_(std::exchange(observed_by_thread, this)) {
  left_out_.push_back(whole(settings_file()).parent_path());
  if (const auto state = state_folder()) left_out_.push_back(whole(*state));
}

ObservedFiles::~ObservedFiles() { observed_by_thread = before_; }

bool ObservedFiles::is_left_out(const std::filesystem::path& path) const {
  return std::any_of(left_out_.begin(), left_out_.end(),
                     [at = whole(path)](const auto& folder) { return is_within(at, folder); });
}

void ObservedFiles::was_read(const std::filesystem::path& path, std::string_view content) {
  const auto same = [&](const SeenFile& seen) { return seen.name == path.string(); };
  if (is_left_out(path) || std::any_of(inputs_.begin(), inputs_.end(), same)) return;
  if (std::any_of(outputs_.begin(), outputs_.end(), same)) return;  // its own, read again
  inputs_.push_back({"input", path.string(), std::make_shared<const std::string>(content)});
}

void ObservedFiles::was_written(const std::filesystem::path& path, std::string_view content) {
  if (is_left_out(path)) return;
  std::erase_if(outputs_, [&](const SeenFile& seen) { return seen.name == path.string(); });
  outputs_.push_back({"output", path.string(), std::make_shared<const std::string>(content)});
}

std::vector<SeenFile> ObservedFiles::files() const {
  std::vector<SeenFile> all = inputs_;
  all.insert(all.end(), outputs_.begin(), outputs_.end());
  return all;
}

bool is_measurement_set(std::string_view content) {
  std::size_t begin = 0;
  while (begin < content.size()) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    const std::string_view line = trimmed(content.substr(begin, end - begin));
    begin = end + 1;
    if (line.empty() || line.starts_with('#')) continue;
    const std::string names = fmt::format(",{},", lower(line));
    return names.find(",sense,") != std::string::npos && names.find(",reading,") != std::string::npos;
  }
  return false;
}

namespace {

/// What is to be said, and what was said before.
struct Words {
  std::mutex mutex;
  std::vector<LogbookWord> waiting;
  std::set<std::string> said;
};

Words& words() {
  static Words all;
  return all;
}

void say_once(bool warning, std::string text) {
  const std::lock_guard lock(words().mutex);
  if (words().said.insert(text).second) words().waiting.push_back({warning, std::move(text)});
}

/// Of several threads one after the other: SQLite would let them wait for each other by polling.
std::mutex& writing() {
  static std::mutex one;
  return one;
}

void take(LogOwner& owner, const LogOwner& found) {
  const bool other = !owner.machine.empty() && !found.machine.empty() && owner.machine != found.machine;
  if (other) return;
  if (owner.machine.empty()) owner.machine = found.machine;
  if (owner.serial_number.empty()) owner.serial_number = found.serial_number;
}

/// What the files say, the first that says it; else a machine.toml or parameters.toml beside them.
LogOwner owner_by(const std::vector<SeenFile>& files) {
  LogOwner owner;
  for (const SeenFile& file : files) take(owner, owner_in(*file.content));
  if (!owner.machine.empty()) return owner;
  const Unwatched not_an_input;
  for (const SeenFile& file : files)
    for (const char* beside : {"parameters.toml", "machine.toml"})
      if (const auto content = read_file(std::filesystem::path(file.name).parent_path() / beside))
        take(owner, owner_in(*content));
  return owner;
}

/// The first instrument that a measured file names, else the one in use.
Instrument instrument_by(const std::vector<SeenFile>& files) {
  for (const SeenFile& file : files)
    if (Instrument found = instrument_in_header(*file.content); is_known(found)) return found;
  const Unwatched not_an_input;
  const auto in_use = instrument_in_use();
  return in_use ? in_use->value_or(Instrument{}) : Instrument{};
}

void complete(LogRecord& record) {
  if (const ObservedFiles* seen = observed_by_thread) {
    std::vector<SeenFile> files = seen->files();
    files.insert(files.end(), std::make_move_iterator(record.files.begin()),
                 std::make_move_iterator(record.files.end()));
    record.files = std::move(files);
  }
  const Unwatched not_twice;
  for (SeenFile& file : record.files) {
    if (file.content) continue;
    if (auto content = read_file(file.name)) file.content = std::make_shared<const std::string>(std::move(*content));
  }
  std::erase_if(record.files, [](const SeenFile& file) { return !file.content; });
  if (record.machine.empty()) {
    const LogOwner owner = owner_by(record.files);
    record.machine = owner.machine;
    if (record.serial_number.empty()) record.serial_number = owner.serial_number;
  }
  if (record.time.empty()) record.time = now_utc();
  if (record.instrument.empty()) record.instrument = instrument_json(instrument_by(record.files), record.time);
  if (record.operator_name.empty()) record.operator_name = operator_name();
  Json content = json_in(record.content);
  if (!content.is_object()) content = Json::object();
  content["program"] = program_version_and_commit();
  record.content = one_line(content);
}

/// A measurement file that no entry has brought yet gets one of its own, whichever verb reads it first.
void add_new_measurements(std::vector<LogRecord>& records, const Logbook& book, const LogRecord& by) {
  if (by.kind == "measurement") return;
  std::set<std::string> brought;
  for (const SeenFile& file : by.files) {
    if (file.role != "input" || !is_measurement_set(*file.content)) continue;
    const std::string sha256 = sha256_hex(*file.content);
    if (book.holds(sha256) || !brought.insert(sha256).second) continue;
    records.push_back({.kind = "measurement",
                       .machine = by.machine,
                       .serial_number = by.serial_number,
                       .summary = std::filesystem::path(file.name).filename().string() + std::string(kInputOfNext),
                       .content = one_line(Json{{"program", program_version_and_commit()}}),
                       .files = {file},
                       .instrument = instrument_json(instrument_by({file}), by.time),
                       .time = by.time,
                       .operator_name = by.operator_name});
  }
}

/// Logbooks that this program has written to: kept open, so that the disc is waited for once an entry.
struct OpenBooks {
  struct Open {
    Logbook book;
    std::chrono::steady_clock::time_point used;
  };
  std::map<std::filesystem::path, Open> books;
  std::map<std::pair<std::string, std::string>, std::filesystem::path> places;  ///< by machine and serial number
};

/// @pre writing() is held
OpenBooks& open_books() {
  static OpenBooks all;
  return all;
}

Result<std::optional<std::filesystem::path>> place_of(const LogOwner& owner) {
  ECS_TRY(setting, logbook_setting());
  return logbook_of(setting, owner);
}

/// The same, looked for once as long as that logbook is open.
Result<std::optional<std::filesystem::path>> place_to_write(const LogRecord& record) {
  OpenBooks& open = open_books();
  const auto known = open.places.find({record.machine, record.serial_number});
  if (known != open.places.end() && open.books.contains(known->second) && disc::exists(known->second))
    return std::optional(known->second);
  auto place = place_of({record.machine, record.serial_number});
  if (place && *place) open.places[{record.machine, record.serial_number}] = **place;
  return place;
}

/// Opened again where somebody has removed or replaced the file meanwhile.
Result<Logbook*> book_at(const std::filesystem::path& path) {
  std::map<std::filesystem::path, OpenBooks::Open>& books = open_books().books;
  auto found = books.find(path);
  if (found != books.end() && !found->second.book.is_in_place()) {
    books.erase(found);
    found = books.end();
  }
  if (found == books.end()) {
    ECS_TRY(book, Logbook::open(path));
    found = books.emplace(path, OpenBooks::Open{std::move(book), {}}).first;
  }
  found->second.used = std::chrono::steady_clock::now();
  return &found->second.book;
}

/// Where a logbook begins, one of the same machine may be there that this program refuses.
void say_what_cannot_be_read() {
  const auto setting = logbook_setting();
  if (!setting) return;
  for (const std::filesystem::path& path : logbooks(*setting))
    if (const auto book = Logbook::open_to_read(path); !book)
      say_once(true, fmt::format("no entry is added to a logbook that cannot be read: {}", to_text(book.error())));
}

Result<void> write(const std::filesystem::path& path, std::vector<LogRecord> wanted) {
  ECS_TRY(book, book_at(path));
  std::vector<LogRecord> records;
  for (LogRecord& record : wanted) {
    add_new_measurements(records, *book, record);
    records.push_back(std::move(record));
  }
  if (auto entries = book->append_all(records); !entries) {
    open_books().books.erase(path);
    return tl::unexpected(entries.error());
  }
  if (book->is_new()) say_what_cannot_be_read();
  if (book->is_new())
    say_once(false, fmt::format("logbook started for {}: {} (modules/logbook/README.md; ECS_LOGBOOK=off disables it)",
                                in_words({records.back().machine, records.back().serial_number}), path.string()));
  return {};
}

}  // namespace

void record_all(std::vector<LogRecord> records, const std::filesystem::path& into) {
  if (!records_are_kept() || records.empty()) return;
  const std::lock_guard lock(writing());
  for (LogRecord& one : records) complete(one);
  const Unwatched own_files;
  const auto path = into.empty() ? place_to_write(records.back()) : std::optional(into);
  if (path && !*path) return;
  const auto done = path ? write(**path, std::move(records)) : tl::unexpected(path.error());
  if (!done) say_once(true, fmt::format("not in the logbook: {}", to_text(done.error())));
}

void close_logbooks(std::chrono::milliseconds idle) {
  std::unique_lock lock(writing(), std::defer_lock);
  if (idle.count() == 0)
    lock.lock();
  else if (!lock.try_lock())
    return;  // somebody writes: it does not rest
  const auto now = std::chrono::steady_clock::now();
  std::erase_if(open_books().books, [&](const auto& open) { return now - open.second.used >= idle; });
  if (open_books().books.empty()) open_books().places.clear();
}

std::vector<LogbookWord> logbook_words() {
  const std::lock_guard lock(words().mutex);
  return std::exchange(words().waiting, {});
}

namespace {

/// That of the machine that the files of the verb under way name; nothing: they name none.
std::optional<std::filesystem::path> observed_logbook() {
  const ObservedFiles* seen = observed_by_thread;
  if (seen == nullptr) return std::nullopt;
  const Unwatched own_files;
  return place_of(owner_by(seen->files())).value_or(std::nullopt);
}

std::optional<std::vector<RecordedUse>> logbook_uses(const std::vector<std::string>& sha256) {
  const auto path = observed_logbook();
  if (!path) return std::nullopt;
  const Unwatched own_files;
  std::error_code error;
  if (!std::filesystem::exists(*path, error)) return std::vector<RecordedUse>();
  const auto book = Logbook::open_to_read(*path);
  const auto entries = book ? book->entries() : tl::unexpected(book.error());
  if (!entries) {
    say_once(true, fmt::format("the logbook cannot be read: {}", to_text(entries.error())));
    return std::nullopt;
  }
  std::vector<RecordedUse> uses;
  for (const LogbookEntry& entry : *entries)
    for (const LogFile& file : files_of(entry))
      if (std::find(sha256.begin(), sha256.end(), file.sha256) != sha256.end())
        uses.push_back(
            {entry.number, entry.time, entry.kind, text_at(json_in(entry.content), "verb"), file.role, file.sha256});
  return uses;
}

std::optional<RecordsEnd> logbook_end() {
  const auto path = observed_logbook();
  if (!path) return std::nullopt;
  const Unwatched own_files;
  const auto book = Logbook::open_to_read(*path);
  const auto count = book ? book->count() : tl::unexpected(book.error());
  auto hash = book ? book->last_hash() : tl::unexpected(book.error());
  if (!count || !hash || *count == 0) return std::nullopt;
  return RecordsEnd{*path, *count, std::move(*hash)};
}

constexpr const char* kImage = "image_sha256";

/// Hashes of the images that were active, the oldest first.
std::vector<std::string> active_images(const LogOwner& owner) {
  const Unwatched own_files;
  std::vector<std::string> images;
  const auto setting = logbook_setting();
  const auto path = setting ? logbook_of(*setting, owner) : tl::unexpected(setting.error());
  const auto book = path && *path ? Logbook::open_to_read(**path) : problem(ProblemKind::bad_input, "");
  const auto entries = book ? book->activations() : tl::unexpected(book.error());
  if (!entries) return images;
  for (const LogbookEntry& entry : *entries) {
    const Json content = json_in(entry.content);
    if (content.is_object()) images.push_back(content.value(kImage, std::string()));
  }
  return images;
}

bool is_rollback(const LogOwner& owner, const std::string& sha256) {
  const std::vector<std::string> images = active_images(owner);
  return images.size() >= 2 && images.back() != sha256 &&
         std::find(images.begin(), images.end(), sha256) != images.end();
}

/// Two entries: the transfer, and the activation; `rollback` in its place where that image was active before the one
/// that it replaces. A transfer that failed, or that found the image active, is one entry.
void record_transfer(const SentImage& one) {
  const laser::StatedIdentity stated = laser::stated_identity(one.image);
  const LogOwner owner{stated.machine.empty() ? one.unit.machine : stated.machine, one.unit.serial_number};
  const std::string bytes(one.image.begin(), one.image.end());
  const std::string sha256 = sha256_hex(bytes);
  const std::string check = fmt::format("{:08X}", ImageView(one.image).check());
  Json content{{kImage, sha256}, {"block_check", check}, {"direction", "to the unit"}};
  const auto entry = [&](std::string kind, std::string summary) {
    return LogRecord{.kind = std::move(kind),
                     .machine = owner.machine,
                     .serial_number = owner.serial_number,
                     .summary = std::move(summary),
                     .content = one_line(content)};
  };
  if (!one.sent) {
    content["problem"] = to_text(one.sent.error());
    return record(entry("transfer", fmt::format("not done: {}", to_text(one.sent.error()))));
  }
  content["bytes"] = bytes.size();
  content["bytes_sent"] = one.sent->bytes_sent;
  content["commit_sequence"] = one.sent->commit_sequence;
  if (one.sent->already_held)
    return record(entry("transfer", fmt::format("not sent: the unit already contained image {}", check)));
  const bool rollback = is_rollback(owner, sha256);
  LogRecord active = entry(
      rollback ? "rollback" : "activation",
      fmt::format("image {} is active{}, commit no. {}", check, rollback ? " again" : "", one.sent->commit_sequence));
  active.files.push_back({"image", "image " + check, std::make_shared<const std::string>(bytes)});
  record_all({entry("transfer",
                    one.sent->bytes_sent == 0
                        ? fmt::format("nothing sent: the inactive bank already contained image {}", check)
                        : fmt::format("{} of {} bytes sent, checksum {}", one.sent->bytes_sent, bytes.size(), check)),
              std::move(active)});
}

constexpr RecordKeeper kLogbookKeeper{
    .record = [](LogRecord one) { record_all({std::move(one)}); },
    .watch = []() -> std::unique_ptr<FileWatch> { return std::make_unique<ObservedFiles>(); },
    .rest = close_logbooks,
    .end = logbook_end,
    .uses = logbook_uses,
};

}  // namespace

void keep_logbook(bool keep) {
  close_logbooks();
  const auto setting = logbook_setting();
  const bool kept = keep && (!setting || !setting->off);
  let_keep_records(kept ? &kLogbookKeeper : nullptr);
  watch_sent_images(kept ? record_transfer : std::function<void(const SentImage&)>());
}

}  // namespace ecs::commissioning
