// One entry of a logbook: what was done, when, by whom, with which files, and the hash that ties it to the entry
// before. Does not live here: the file that holds entries (store.hpp), what is written when (recorder.hpp).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ecs::commissioning {

/// A file that took part, as it was then.
struct LogFile {
  std::string role;  ///< "input", "output", or "image" for the bytes that a unit holds
  std::string name;  ///< as the verb was given it, or its absolute path
  std::string sha256;
  std::uint64_t bytes = 0;
  bool kept = false;  ///< the logbook holds its bytes

  friend bool operator==(const LogFile&, const LogFile&) = default;
};

struct LogbookEntry {
  std::int64_t number = 0;  ///< from 1, without a gap
  std::string time;         ///< "2026-05-04T09:30:00Z"
  std::string kind;         ///< "measurement", "map", "activation", …: kLogKinds
  std::string machine;      ///< empty: not stated
  std::string serial_number;
  std::string operator_name;
  std::string instrument;  ///< JSON object (instrument.hpp); empty: none took part
  std::string summary;     ///< one line
  std::string content;     ///< JSON object: program, folder, words, files, answer …
  std::string previous;    ///< hash of the entry before; of the first 64 zeros
  std::string hash;        ///< hash_of() the others

  friend bool operator==(const LogbookEntry&, const LogbookEntry&) = default;
};

/// What the kinds are, in the order in which a commissioning meets them.
inline constexpr const char* kLogKinds[] = {
    "measurement",  "processing", "map",       "parameters", "transfer",           "activation",
    "rollback",     "model",      "diagnosis", "test",       "investigation step", "investigation",
    "memory write", "export",     "report",    "certificate"};

/// SHA-256 over every other member, each as its length, a colon and its bytes: 64 hexadecimal digits.
[[nodiscard]] std::string hash_of(const LogbookEntry& entry);

/// Of the entry before the first.
[[nodiscard]] std::string no_previous();

/// The files that the content lists; none where it is no such JSON.
[[nodiscard]] std::vector<LogFile> files_of(const LogbookEntry& entry);
/// The words of the verb that wrote it, and the folder it ran in; empty where no verb did.
[[nodiscard]] std::vector<std::string> words_of(const LogbookEntry& entry);
[[nodiscard]] std::string folder_of(const LogbookEntry& entry);

/// A file with its bytes, to be logged.
struct SeenFile {
  std::string role;
  std::string name;
  std::shared_ptr<const std::string> content;
};

/// What is to be written; number, hashes and, where they are empty, time and operator are added.
struct LogRecord {
  std::string kind;
  std::string machine;
  std::string serial_number;
  std::string summary;
  std::string content = "{}";  ///< JSON object without `files`, which are added
  std::vector<SeenFile> files;
  std::string instrument;
  std::string time;
  std::string operator_name;
};

}  // namespace ecs::commissioning
