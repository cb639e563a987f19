// What a run of a fleet leaves on the disc: the answer for one machine and the line of JSON that holds it, the results
// file that grows a line at a time and can be gone on with after any end of the program, and which machines were under
// way then: a machine whose files end the program is found by the next run, which leaves it for last and in the end
// gives it up. That last file is the lock of the results.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/result.hpp"

namespace ecs::commissioning {

/// A cause in the answer for one machine.
struct FleetCause {
  std::string name;  ///< "effect:axis:sense-or-code"
  double probability = 0.0;
  std::optional<double> e_value;  ///< divided by the number of candidates tried; absent: no split shows it
  double false_naming = 1.0;
  std::optional<double> p_value{};  ///< beside the other causes, for having been chosen; absent: older results
  std::string standing = "proved";  ///< or "likely"

  friend bool operator==(const FleetCause&, const FleetCause&) = default;
};

struct FleetResult {
  std::string id;
  std::string hash;                ///< SHA-256 of what was read; empty with an error
  std::string verdict;             ///< of model/diagnosis/diagnose.hpp
  std::vector<FleetCause> causes;  ///< proved ones, then likely ones
  std::string type, batch;
  double processor_s = 0.0;
  std::string error;                ///< not diagnosed, and why; empty: diagnosed
  bool doubled = false;             ///< the error is that another row has the id already; the answer for that one holds
  std::optional<double> p_value{};  ///< that nothing is missing; absent: older results

  friend bool operator==(const FleetResult&, const FleetResult&) = default;
};

/// {"id", "hash", "verdict", "p_value", "causes", "type", "batch", "processor_s"} or {"id", "error"} ("doubled" where
/// it is), without the end of the line.
[[nodiscard]] std::string to_line(const FleetResult& result);
/// Nothing where the line is no such object.
[[nodiscard]] std::optional<FleetResult> result_in(std::string_view line);

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

/// Ends of the program without warning while a machine was under way, after which it is given up: a power cut or a kill
/// hits the same machine three times only by great misfortune.
inline constexpr int kMostUncleanEnds = 3;

class UnderWay {
 public:
  /// Takes `path`, and reads what a run that did not end in good order left there. `refused` while another run has it.
  [[nodiscard]] static Result<UnderWay> open(const std::string& path, int threads);
  UnderWay(UnderWay&& other) noexcept;
  UnderWay& operator=(UnderWay&&) = delete;
  UnderWay(const UnderWay&) = delete;
  UnderWay& operator=(const UnderWay&) = delete;
  /// Closes the file; it stays unless remove() was called.
  ~UnderWay();

  /// Machines that were under way when the program ended, and how often.
  [[nodiscard]] const std::map<std::string, int>& ends() const { return ends_; }
  /// Each thread has a place of its own.
  void begin(int thread, const std::string& id) const;
  void finish(int thread) const;
  /// The run ends in good order.
  void remove();

 private:
  UnderWay() = default;
  void put(int place, const std::string& text) const;

  std::string path_;
  int handle_ = -1;
  std::map<std::string, int> ends_;
};

}  // namespace ecs::commissioning
