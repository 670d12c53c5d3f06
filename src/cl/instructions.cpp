// Which instructions this processor has.
#include <string>
#include <string_view>

#include "cl/builtin_device.h"
#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace sherd {

#if defined(__x86_64__)
namespace {

// Registers of one leaf of the CPUID instruction; 0 where the processor has no such leaf.
struct CpuId {
  explicit CpuId(unsigned leaf) { __get_cpuid_count(leaf, 0, &eax, &ebx, &ecx, &edx); }
  unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
};

constexpr unsigned bits(std::initializer_list<int> numbers) {
  unsigned all = 0;
  for (const int number : numbers) all |= 1u << number;
  return all;
}

// Returns the register states that the system saves: without them instructions trap.
unsigned savedStates(const CpuId& features) {
  constexpr int kOsxsave = 27;
  if (((features.ecx >> kOsxsave) & 1u) == 0) return 0;
  unsigned low = 0, high = 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return low;
}

bool hasAll(unsigned found, unsigned wanted) { return (found & wanted) == wanted; }

// Returns the level 1 to 4 of x86-64 that the System V ABI (x86-64 psABI, "Micro-Architecture
// Levels") gives the processor.
int x86Level() {
  const CpuId features(1), more(7), extended(0x80000001u);
  const unsigned states = savedStates(features);
  constexpr unsigned kAvxStates = bits({1, 2}), kAvx512States = bits({1, 2, 5, 6, 7});
  // SSE3, SSSE3, CMPXCHG16B, SSE4.1, SSE4.2, POPCNT; LAHF
  const bool isV2 =
      hasAll(features.ecx, bits({0, 9, 13, 19, 20, 23})) && hasAll(extended.ecx, bits({0}));
  if (!isV2) return 1;
  // FMA, MOVBE, AVX, F16C; BMI1, AVX2, BMI2; LZCNT
  const bool isV3 = hasAll(features.ecx, bits({12, 22, 28, 29})) &&
                    hasAll(more.ebx, bits({3, 5, 8})) && hasAll(extended.ecx, bits({5})) &&
                    hasAll(states, kAvxStates);
  if (!isV3) return 2;
  // AVX-512 F, DQ, CD, BW, VL
  const bool isV4 = hasAll(more.ebx, bits({16, 17, 28, 30, 31})) && hasAll(states, kAvx512States);
  return isV4 ? 4 : 3;
}

}  // namespace

std::string instructionsFault(std::string_view instructions) {
  constexpr std::string_view kPrefix = "x86-64-v";
  if (!instructions.starts_with(kPrefix)) return {};
  static const int level = x86Level();  // a virtual machine takes tens of microseconds for CPUID
  const int wanted = instructions[kPrefix.size()] - '0';
  if (level >= wanted) return {};
  return "this processor lacks instructions of " + std::string(instructions);
}

#else

std::string instructionsFault(std::string_view) { return {}; }

#endif

}  // namespace sherd
