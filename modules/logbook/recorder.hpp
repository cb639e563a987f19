// The keeper of records (commissioning/session/records.hpp) that writes them into the logbook of the machine, without
// being asked; and what became active in a unit. A logbook that cannot be written never stops the work itself: it is
// said once.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/file.hpp"
#include "commissioning/session/records.hpp"

namespace ecs::commissioning {

/// From now on this process keeps logbooks, unless the setting says off. A library or a test that does not call it
/// writes none. @param keep  false: no longer
void keep_logbook(bool keep = true);

/// Adds the entries one after the other, all of them or none, from any thread. Machine, instrument and files are those
/// of the verb under way on this thread where a record leaves them open. Nothing where no logbook is kept or nothing
/// says which machine the last one is about.
/// @param into  this logbook; empty: that of the machine of the last record
void record_all(std::vector<LogRecord> records, const std::filesystem::path& into = {});

/// Closes the logbooks that were not written to for so long; then each is one file again.
void close_logbooks(std::chrono::milliseconds idle = std::chrono::milliseconds(0));

/// Sees the files of its thread; those of settings and state are nobody's measurement and stay out.
class ObservedFiles final : public FileWatch {
 public:
  ObservedFiles();
  ~ObservedFiles() override;

  void was_read(const std::filesystem::path& path, std::string_view content) override;
  void was_written(const std::filesystem::path& path, std::string_view content) override;

  /// Inputs as they were first read, outputs as they were last written, in that order.
  [[nodiscard]] std::vector<SeenFile> files() const;
  [[nodiscard]] const std::vector<SeenFile>& outputs() const { return outputs_; }

 private:
  [[nodiscard]] bool is_left_out(const std::filesystem::path& path) const;

  std::vector<SeenFile> inputs_, outputs_;
  std::vector<std::filesystem::path> left_out_;
  const ObservedFiles* before_;
};

/// A measurement file in our CSV form, by its header row.
[[nodiscard]] bool is_measurement_set(std::string_view content);

/// What is to be said of the logbook since this was last asked: that one was started, that one cannot be written.
struct LogbookWord {
  bool warning = false;
  std::string text;
};
[[nodiscard]] std::vector<LogbookWord> logbook_words();

}  // namespace ecs::commissioning
