// The files that a verb reads and writes, as the logbook keeps them, and whom they say they belong to.
#pragma once

#include <filesystem>
#include <vector>

#include "base/file_watch.hpp"
#include "commissioning/logbook/instrument.hpp"
#include "commissioning/logbook/place.hpp"

namespace ecs::commissioning {

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

  /// The one of this thread; null: none.
  [[nodiscard]] static const ObservedFiles* current();

 private:
  std::vector<SeenFile> inputs_, outputs_;
  std::vector<std::filesystem::path> left_out_;
  const ObservedFiles* before_;
};

/// A measurement set in our CSV form, by its header row.
[[nodiscard]] bool is_measurement_set(std::string_view content);

/// What the files say, the first that says it; else a machine.toml or parameters.toml beside them.
[[nodiscard]] LogOwner owner_of(const std::vector<SeenFile>& files);
/// The first instrument that a measured file names, else the one in use.
[[nodiscard]] Instrument instrument_of(const std::vector<SeenFile>& files);

}  // namespace ecs::commissioning
