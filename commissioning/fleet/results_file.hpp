// A results file that grows a line at a time and can be gone on with after any end of the program.
// Does not live here: what a line holds (result.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/result.hpp"
#include "commissioning/fleet/result.hpp"

namespace ecs::commissioning {

/// A line is one write() at the end of the file, so that a killed program leaves whole lines and at most one that was
/// cut; it reaches the disc at sync(). Lines may be appended from several threads.
class ResultsFile {
 public:
  /// Reads what is there. Cut lines, errors and answers that a later line of the same machine replaces are left out,
  /// and the file is replaced by what remains. Refuses a file whose first line is no result (`usage`).
  [[nodiscard]] static Result<ResultsFile> open(const std::string& path);
  ResultsFile(ResultsFile&& other) noexcept;
  ResultsFile& operator=(ResultsFile&&) = delete;
  ResultsFile(const ResultsFile&) = delete;
  ResultsFile& operator=(const ResultsFile&) = delete;
  ~ResultsFile();

  enum class Held { no, other_labels, yes };
  /// Whether the file opened holds the answer for this content; or holds it under another type or batch.
  [[nodiscard]] Held holds(const FleetResult& labels, const std::string& hash) const;
  /// That answer. @pre holds() it under other labels
  [[nodiscard]] Result<FleetResult> held(const std::string& id) const;
  [[nodiscard]] std::size_t size() const { return held_.size(); }

  [[nodiscard]] Result<void> append(const FleetResult& result);
  /// All that was appended is on the disc.
  [[nodiscard]] Result<void> sync();

 private:
  /// Enough to know an answer again, and to find it.
  struct Known {
    std::array<std::uint8_t, 32> hash{};
    std::size_t labels = 0;
    std::uint64_t offset = 0;
    std::uint32_t length = 0;
  };
  ResultsFile() = default;
  [[nodiscard]] Problem failed(const char* what) const;

  std::string path_;
  int handle_ = -1;
  std::unordered_map<std::string, Known> held_;
  std::mutex mutex_;
  bool synced_ = true;
};

/// Every line of a text; those that are no result are counted. @return of an id its last line, in the order of the file
struct ResultLines {
  struct One {
    std::uint64_t offset = 0;
    std::uint32_t length = 0;
    FleetResult result;
  };
  std::vector<One> results;
  std::size_t errors = 0, unreadable = 0, replaced = 0;
  int first_unreadable = 0;  ///< line
};
/// @param keep_errors  they are results too; false: left out
[[nodiscard]] ResultLines result_lines(std::string_view text, bool keep_errors);

}  // namespace ecs::commissioning
