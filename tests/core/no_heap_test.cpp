// The loop allocates nothing: malloc and its family are watched while compile() and tick() run.
#include <cstddef>
#include <memory>

#include "core/tick.hpp"
#include "tests/core/support/image_of.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::test;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

TEST_CASE("checking, compiling and 10,000 ticks allocate nothing") {
  SKIP_UNLESS(false, "the sanitizer brings a malloc of its own");
}

#else

namespace {
bool watching = false;
int allocations = 0;
void count() noexcept { allocations += watching ? 1 : 0; }
}  // namespace

// operator new ends in these; glibc keeps the originals under these names
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier)
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(bugprone-reserved-identifier)

void* malloc(std::size_t size) {
  count();
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  count();
  return __libc_calloc(number, size);
}
void* realloc(void* block, std::size_t size) {
  count();
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
}

namespace {

template <class Work>
int allocations_of(Work work) {
  allocations = 0;
  watching = true;
  work();
  watching = false;
  return allocations;
}

}  // namespace

TEST_CASE("checking, compiling and 10,000 ticks allocate nothing") {
  UnitParameters p;
  p.tool_offset_mm = {1.0, 2.0, 3.0};
  std::vector<PlannedTable> tables;
  for (std::size_t c = 0; c < kCurves; ++c)
    tables.push_back({static_cast<Component>(c), Approach::unknown, 0.0, 1.0, 1.0, {1, 2, 3, 4, 5}});
  const std::vector<ThermalRow> rows{{Component::EXX, ThermalLaw::growth, 0, kNoInput, -11.0, 20.0, 30.0, 0.0},
                                     {Component::EZX, ThermalLaw::bending, 1, 2, 4.0, 0.0, 60.0, 0.0},
                                     {Component::EBX, ThermalLaw::shift, kMotionOfX, kNoInput, 3.0, 900.0, 600.0, 0.0}};
  const auto image = image_of(p, tables, "header", rows);
  const auto map = std::make_unique<CompiledMap>();
  const auto state = std::make_unique<TickState>();
  const auto thermal = std::make_unique<ThermalState>();
  InputValues inputs{};
  const std::vector<std::uint8_t> values(12 * 36, 1);
  RotarySetup rotary_machine{{'T', 'X', 'Y', 'Z', 'C'}, {{{.letter = 'C'}}}, {}};
  rotary_machine.tables[0].count = 36;
  rotary_machine.tables[0].values = {values, values};
  RotaryTickState rotary;

  REQUIRE(allocations_of([] {
            int* volatile kept = new int(1);  // else an optimised build leaves both out
            delete kept;
          }) == 1);  // the watch works
  bool sound = false;
  CHECK(allocations_of([&] {
          sound = check_image(image).fault == ImageFault::none && compile(ImageView(image), *map).fault == Fault::none;
          start(*state, {}, {}, {});
          (void)begin_thermal(map->thermal, *thermal, inputs, {}, nullptr, 0.0);
          for (std::int64_t i = 0; i < 10'000; ++i) {
            inputs[static_cast<std::size_t>(i % 3)] = {20.0 + static_cast<double>(i % 5), i % 11 != 0,
                                                       static_cast<std::uint32_t>(i)};
            if (i % 10 == 0) (void)step_thermal(map->thermal, *thermal, inputs, state->position_mm, 0.1);
            tick(*map, *state, {i * 7 % 5000, -i * 3 % 5000, i % 9}, thermal->acting);
          }
        }) == 0);
  CHECK(sound);
  p.tool_range_mm = {1.0, 1.0, 1.0};
  CHECK(allocations_of([&] {
          sound = compile_rotary(rotary_machine, p, *map) == RotaryFault::none;
          start_rotary(map->rotary, rotary, {}, {}, {});
          follow_thermal(*map, *thermal, rotary);
          for (std::int64_t i = 0; i < 10'000; ++i) tick(*map, *state, {i, i, i}, thermal->acting, rotary, {i * 7, 0});
        }) == 0);
  CHECK(sound);
  CHECK(state->ticks == 20'000);
}

#endif
