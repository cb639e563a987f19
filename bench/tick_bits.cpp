// What the compensation core computes, every bit of it, as hashes: of map and walk of the benches and of each image
// given. Two processors agree where they print the same (tests/arm64/same_bits). Run: tick_bits [IMAGE...]
#include <cstdlib>
#include <string>
#include <type_traits>

#include <fmt/format.h>

#include "base/file.hpp"
#include "bench/tick_map.hpp"

namespace {

constexpr std::size_t kTicks = 100'000;

template <class Value>
void append(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value> && !std::is_pointer_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Compiled values and slopes of a map, and all that its ticks leave in their state.
bool say(const std::string& name, std::span<const std::uint8_t> image) {
  const auto map = std::make_unique<ecs::CompiledMap>();
  if (ecs::check_image(image).fault != ecs::ImageFault::none ||
      ecs::compile(ecs::ImageView(image), *map).fault != ecs::Fault::none) {
    fmt::print(stderr, "{}: not a map\n", name);
    return false;
  }
  std::string working, ticks;
  append(working, map->value);
  append(working, map->slope);
  const auto walk = ecs::bench::random_walk(kTicks);
  ecs::TickState state;
  ecs::start(state, walk[0], {-500.0, -500.0, -500.0},
             {ecs::Approach::forward, ecs::Approach::forward, ecs::Approach::forward});
  for (const auto& counts : walk) {
    ecs::tick(*map, state, counts);
    append(ticks, state.position_mm);
    append(ticks, state.own_motion_mm);
    append(ticks, state.compensation_um);
    append(ticks, state.output_counts);
    append(ticks, state.dac_counts);
  }
  const std::string bytes(image.begin(), image.end());
  fmt::print("{}: image {}\n  working form {}\n  {} ticks {}\n", name, ecs::sha256_hex(bytes), ecs::sha256_hex(working),
             kTicks, ecs::sha256_hex(ticks));
  return true;
}

}  // namespace

int main(int count, char** words) {
  bool good = say("map of the benches", ecs::bench::full_image(32'000));
  for (int i = 1; i < count; ++i) {
    const auto read = ecs::read_file(words[i]);
    if (!read) {
      fmt::print(stderr, "{}: cannot be read\n", words[i]);
      return EXIT_FAILURE;
    }
    good = say(words[i], {reinterpret_cast<const std::uint8_t*>(read->data()), read->size()}) && good;
  }
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
