// Where the time of the virtual workshop goes: this many simulated seconds of three axes moving under compensation.
// Run: valgrind --tool=callgrind --instr-atstart=no machine_callgrind [seconds], then callgrind_annotate
#include <cstdio>

#include <valgrind/callgrind.h>

#include "bench/workshop_bench.hpp"

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 1.0;
  ecs::bench::Workbench bench("servo", true);
  CALLGRIND_START_INSTRUMENTATION;
  const double simulated_s = bench.run(seconds);
  CALLGRIND_STOP_INSTRUMENTATION;
  std::printf("%.3f s simulated; divide callgrind's \"Collected\" by its periods of 1 ms\n", simulated_s);
}
