// What was done, as it is told to whoever keeps records of it: verbs and screens, work that takes long, writes into a
// unit. Where nobody keeps any, all of this does nothing. Does not live here: who keeps them, and where.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/file.hpp"

namespace ecs::commissioning {

/// A file with its bytes, to be kept.
struct SeenFile {
  std::string role;  ///< "input", "output", or "image" or "memory" for the bytes that a unit holds
  std::string name;  ///< as the verb was given it, or its absolute path
  std::shared_ptr<const std::string> content{};  ///< null: as it is on the disc; if it cannot be read it stays out
};
/// Files as they are on the disc when the record is kept.
[[nodiscard]] std::vector<SeenFile> seen_files(const std::vector<std::string>& inputs,
                                               const std::vector<std::string>& outputs = {});

/// What is empty but could be found out is added: machine, serial number and instrument by the files, time, operator.
struct LogRecord {
  std::string kind{};  ///< "measurement", "map", "activation", …
  std::string machine{};
  std::string serial_number{};
  std::string summary{};       ///< one line
  std::string content = "{}";  ///< JSON object without `files`, which are added
  std::vector<SeenFile> files{};
  std::string instrument{};
  std::string time{};
  std::string operator_name{};
};

/// The end of the records of a machine, as a report states it.
struct RecordsEnd {
  std::filesystem::path path;
  std::size_t entries = 0;
  std::string last_hash;
};

/// An entry in which a file took part.
struct RecordedUse {
  std::int64_t number = 0;  ///< of the entry
  std::string time;         ///< "2026-05-04T09:30:00Z"
  std::string kind;         ///< of the entry
  std::string verb;         ///< empty: no verb wrote it
  std::string role;         ///< of the file
  std::string sha256;
};

/// Whoever keeps them; each function does what the one below says that calls it, from any thread.
struct RecordKeeper {
  void (*record)(LogRecord one);
  std::unique_ptr<FileWatch> (*watch)();
  void (*rest)(std::chrono::milliseconds idle);
  std::optional<RecordsEnd> (*end)();
  std::optional<std::vector<RecordedUse>> (*uses)(const std::vector<std::string>& sha256);
};
/// From now on this one. @param keeper  lives as long as the program; null: nobody
void let_keep_records(const RecordKeeper* keeper);
[[nodiscard]] bool records_are_kept();

/// A record that cannot be kept never stops the work itself.
void record(LogRecord one);
/// While it lives the records of this thread are also of the files that it reads and writes. Null: nobody keeps any.
[[nodiscard]] std::unique_ptr<FileWatch> watch_for_records();
/// Nothing is held open that was not written to for so long. At the end of the program, and while the screens wait.
void let_records_rest(std::chrono::milliseconds idle = std::chrono::milliseconds(0));
/// Of the machine that the files of the verb under way name; nothing: no records are kept, or there is none yet.
[[nodiscard]] std::optional<RecordsEnd> records_end();
/// Where files with these hashes took part, in the records of that machine, in their order. Nothing: none are kept of
/// it, or they cannot be read.
[[nodiscard]] std::optional<std::vector<RecordedUse>> recorded_uses(const std::vector<std::string>& sha256);

}  // namespace ecs::commissioning
