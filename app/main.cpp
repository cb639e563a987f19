// The program `ecs`.
#include <iostream>

#include <malloc.h>

#include "app/screens/start.hpp"
#include "app/verbs/registry.hpp"
#include "base/process.hpp"

int main(int argc, char** argv) {
#ifdef M_MMAP_THRESHOLD  // of glibc: matrices come and go, and memory fetched again costs a sixth of a diagnosis
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
  ecs::catch_signals();
  ecs::app::begin_modules();
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words == std::vector<std::string>{"--linear"})
    return ecs::app::run_linear_program(std::cin, std::cout, std::cerr);
  if (const auto left = ecs::app::screens_started(words)) return *left;
  ecs::app::ConsoleOptions options = ecs::app::options_of_stderr();
  options.keyboard = ecs::app::keyboard_of_stdin();
  return ecs::app::run_program(words, std::cout, std::cerr, options);
}
