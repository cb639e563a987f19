#include "tests/world/seed.hpp"

#include <sodium.h>

#include "core/memory_image.hpp"

namespace ecs::world {
namespace {

Random* chance_source = nullptr;

std::uint32_t chance_word() { return static_cast<std::uint32_t>((*chance_source)()); }
void chance_bytes(void* out, const std::size_t size) {
  auto* bytes = static_cast<std::uint8_t*>(out);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>((*chance_source)() >> 32);
}
const char* chance_name() { return "seed of a world"; }

Bytes an_image(std::uint32_t values, bool rough, std::uint32_t number) {
  const ImagePlan plan{2, values, 0};
  Bytes image(image_bytes(plan));
  UnitParameters parameters;
  parameters.loop_period_us = 20'000.0;
  begin_image(image, plan);
  write_parameters(image, parameters);
  write_entry(image, 0, {Component::EXX, Approach::unknown, false, 0, values / 2, 0.0, 10.0, 0.01});
  write_entry(image, 1, {Component::EYY, Approach::unknown, false, values / 2, values - values / 2, 0.0, 10.0, 0.01});
  std::mt19937 random(number);
  for (std::uint32_t i = 0; i < values; ++i)
    write_value(image, i, static_cast<std::int16_t>(rough ? int(random() % 4000) - 2000 : int(i * (number + 3))));
  write_identity(image, {kSerialNumber, kMachine, configuration_hash(parameters)});
  seal_image(image);
  return image;
}

}  // namespace

SeededChance::SeededChance(std::uint64_t seed) : random_(seed) {
  static randombytes_implementation seeded{chance_name, chance_word, nullptr, nullptr, chance_bytes, nullptr};
  static const int ready = ::sodium_init();  // draws numbers itself, once
  (void)ready;
  chance_source = &random_;
  randombytes_set_implementation(&seeded);
}

const std::array<Bytes, kImages>& images() {
  static const std::array<Bytes, kImages> all{an_image(40, false, 1), an_image(900, false, 2), an_image(700, true, 3),
                                              an_image(420, true, 4)};
  return all;
}

}  // namespace ecs::world
