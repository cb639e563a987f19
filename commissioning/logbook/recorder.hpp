// What this program does, written into the logbook of the machine without being asked; also what went to a unit:
// images, what became active, bytes of its memory. A logbook that cannot be written never stops the work itself: it is
// said once.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "commissioning/logbook/store.hpp"
#include "commissioning/unit/transfer.hpp"

namespace ecs::commissioning {

/// From now on this process keeps logbooks, unless the setting says off. A library or a test that does not call it
/// writes none. @param keep  false: no longer
void keep_logbook(bool keep = true);
/// keep_logbook() was called and the setting is not off.
[[nodiscard]] bool logbook_is_kept();

/// Adds the entry, from any thread. Machine, instrument and files are those of the verb under way on this thread where
/// the record leaves them open. Nothing where no logbook is kept or nothing says which machine it is about.
/// @return the entry as it was written
std::optional<LogbookEntry> record(LogRecord record);

/// Several, one after the other, into the logbook of the last one: all of them or none.
std::optional<LogbookEntry> record_all(std::vector<LogRecord> records);

/// The same into this logbook.
std::optional<LogbookEntry> record_in(const std::filesystem::path& path, LogRecord record);

/// Closes the logbooks that were not written to for so long; then each is one file again. At the end of a verb, and
/// while the screens wait.
void close_logbooks(std::chrono::milliseconds idle = std::chrono::milliseconds(0));

/// The end of a logbook, as a report states it.
struct LogbookEnd {
  std::filesystem::path path;
  std::size_t entries = 0;
  std::string last_hash;
};
/// Of the machine that the files of the verb under way name; nothing: none is kept, or it has no entry yet.
[[nodiscard]] std::optional<LogbookEnd> logbook_end();

/// What is to be said of the logbook since this was last asked: that one was begun, that one cannot be written.
struct LogbookWord {
  bool warning = false;
  std::string text;
};
[[nodiscard]] std::vector<LogbookWord> logbook_words();

/// Two entries: the transfer, and the activation; `rollback` in its place where that image was active before the one
/// that it replaces. A transfer that failed, or that found the image active, is one entry.
void record_transfer(const SentImage& sent);

/// Bytes written into the unit's memory, or, with a problem, perhaps a part of them.
struct MemoryWritten {
  std::string serial_number;
  std::uint32_t address = 0;
  std::span<const std::uint8_t> bytes;
  std::string problem;  ///< why it failed; empty: it did not
};
void record_memory_write(const MemoryWritten& one);

}  // namespace ecs::commissioning
