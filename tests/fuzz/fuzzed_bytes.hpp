// The bytes of one fuzzed input, taken from the front; 0 where there are none left.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

namespace ecs::fuzz {

class FuzzedBytes {
 public:
  FuzzedBytes(const std::uint8_t* data, std::size_t size) : left_(data, size) {}
  [[nodiscard]] bool any() const { return !left_.empty(); }
  std::uint8_t byte() {
    if (left_.empty()) return 0;
    const std::uint8_t first = left_.front();
    left_ = left_.subspan(1);
    return first;
  }
  std::uint16_t word() {
    const unsigned high = byte();
    return static_cast<std::uint16_t>(high << 8 | byte());
  }
  std::uint32_t number() {
    const std::uint32_t high = word();
    return high << 16 | word();
  }
  std::vector<std::uint8_t> bytes(std::size_t count) {
    const auto taken = left_.first(std::min(count, left_.size()));
    left_ = left_.subspan(taken.size());
    return {taken.begin(), taken.end()};
  }
  std::vector<std::uint16_t> words(std::size_t count) {
    std::vector<std::uint16_t> taken(count);
    for (auto& one : taken) one = word();
    return taken;
  }

 private:
  std::span<const std::uint8_t> left_;
};

inline void check(bool holds) {
  if (!holds) std::abort();
}

}  // namespace ecs::fuzz
