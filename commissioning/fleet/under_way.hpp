// Which machines a run has under way, kept beside its results: a machine whose files end the program is found by the
// next run, which leaves it for last and in the end gives it up. The same file is the lock of the results.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace ecs::commissioning {

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
