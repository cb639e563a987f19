// The program `ecs`.
#include <iostream>

#include "app/interrupt.hpp"
#include "app/program.hpp"

int main(int argc, char** argv) {
  ecs::app::catch_signals();
  return ecs::app::run_program({argv + 1, argv + argc}, std::cout, std::cerr, ecs::app::options_of_stderr());
}
