// Runs the benchmarks.
#include <benchmark/benchmark.h>
#include <malloc.h>

int main(int argc, char** argv) {
  // What is freed is kept, as `sherd` keeps it: otherwise large sizes, and only they, pay
  // each time for the pages of their results to be cleared.
  ::mallopt(M_MMAP_MAX, 0);
  ::mallopt(M_TRIM_THRESHOLD, -1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
