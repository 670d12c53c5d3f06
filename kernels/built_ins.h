// The types and built-in functions of OpenCL C 1.2 that the kernels use, for a compiler without a driver (clang -x cl
// -cl-no-stdinc).  Drivers have their own; this file is for the built-in device alone.
//
// They are compiled in one translation unit with the kernels, once per set of instructions, so that they are inlined: a
// vector that is passed between units changes its registers with the instructions.  Only the index of a work-item
// comes from outside.  Source: The OpenCL Specification 1.2, 6.1 and 6.12.  Tests: tests/kernels/built_ins_test.cpp.
#ifndef SHERD_BUILT_INS_H
#define SHERD_BUILT_INS_H

#define __OPENCL_VERSION__ 120
#define inline static __inline__ __attribute__((unused))  // C99's inline needs a definition elsewhere
#define BUILT_IN static __inline__ __attribute__((overloadable, always_inline, unused))

typedef unsigned char uchar;
typedef unsigned short ushort;
typedef unsigned int uint;
typedef unsigned long ulong;
typedef __SIZE_TYPE__ size_t;
#define LONG_MAX 0x7fffffffffffffffl

#define SHERD_VECTORS(type)                                 \
  typedef type type##2 __attribute__((ext_vector_type(2))); \
  typedef type type##4 __attribute__((ext_vector_type(4))); \
  typedef type type##8 __attribute__((ext_vector_type(8)));
SHERD_VECTORS(short)
SHERD_VECTORS(ushort)
SHERD_VECTORS(int)
SHERD_VECTORS(long)
SHERD_VECTORS(ulong)

// 6.12.1: of the work-item that the thread is at (src/cl/builtin_device.cpp).
__attribute__((const, visibility("hidden"))) size_t sherd_global_id(void);
__attribute__((const, visibility("hidden"))) size_t sherd_global_size(void);
BUILT_IN size_t get_global_id(const uint dimension) { return dimension == 0 ? sherd_global_id() : 0; }
BUILT_IN size_t get_global_size(const uint dimension) { return dimension == 0 ? sherd_global_size() : 1; }

// 6.12.3: integers.
#define SHERD_LEAST_AND_MOST(type)                                                                     \
  BUILT_IN type min(const type a, const type b) { return __builtin_elementwise_min((type)a, (type)b); } \
  BUILT_IN type max(const type a, const type b) { return __builtin_elementwise_max((type)a, (type)b); }
SHERD_LEAST_AND_MOST(int)
SHERD_LEAST_AND_MOST(uint)
SHERD_LEAST_AND_MOST(long)
SHERD_LEAST_AND_MOST(ulong)
SHERD_LEAST_AND_MOST(int4)
SHERD_LEAST_AND_MOST(ushort8)
BUILT_IN uint abs(const int a) { return a < 0 ? 0u - (uint)a : (uint)a; }
BUILT_IN ulong abs(const long a) { return a < 0 ? 0ul - (ulong)a : (ulong)a; }
BUILT_IN ulong clz(const ulong a) { return a == 0 ? 64ul : (ulong)__builtin_clzl(a); }
BUILT_IN ulong popcount(const ulong a) { return (ulong)__builtin_popcountl(a); }
BUILT_IN int mul_hi(const int a, const int b) { return (int)(((long)a * b) >> 32); }
BUILT_IN int4 mul_hi(const int4 a, const int4 b) {
  return __builtin_convertvector(__builtin_convertvector(a, long4) * __builtin_convertvector(b, long4) >> 32, int4);
}
BUILT_IN int8 mul_hi(const int8 a, const int8 b) {
  return __builtin_convertvector(__builtin_convertvector(a, long8) * __builtin_convertvector(b, long8) >> 32, int8);
}

// 6.12.6: whether the highest bit of any component is set.
BUILT_IN int any(const int4 a) { return (a.x | a.y | a.z | a.w) < 0; }

// 6.2.3: the low bits of each component.
BUILT_IN ushort8 convert_ushort8(const short8 a) { return __builtin_convertvector(a, ushort8); }

// 6.12.7: eight elements, aligned as one of them.
#define SHERD_ROWS(type, space)                                                           \
  typedef type##8 space##_##type##8 __attribute__((aligned(sizeof(type))));               \
  BUILT_IN type##8 vload8(const size_t row, const space type* from) {                     \
    return *(const space space##_##type##8*)(from + 8 * row);                             \
  }                                                                                       \
  BUILT_IN void vstore8(const type##8 value, const size_t row, space type* to) {          \
    *(space space##_##type##8*)(to + 8 * row) = value;                                    \
  }
SHERD_ROWS(ushort, global)
SHERD_ROWS(ulong, global)
SHERD_ROWS(ushort, private)
SHERD_ROWS(int, private)
SHERD_ROWS(ulong, private)

// 6.12.11: atomic functions return the value before; they order no other memory.
#define SHERD_ATOMIC BUILT_IN uint
#define SHERD_SHARED volatile global uint*
SHERD_ATOMIC atomic_add(SHERD_SHARED p, const uint value) {
  // A literal 0 makes it a load, which OpenCL C 1.2 does not have.
  if (__builtin_constant_p(value) && value == 0) return __atomic_load_n(p, __ATOMIC_RELAXED);
  return __atomic_fetch_add(p, value, __ATOMIC_RELAXED);
}
SHERD_ATOMIC atomic_inc(SHERD_SHARED p) { return __atomic_fetch_add(p, 1u, __ATOMIC_RELAXED); }
SHERD_ATOMIC atomic_min(SHERD_SHARED p, const uint value) { return __atomic_fetch_min(p, value, __ATOMIC_RELAXED); }
SHERD_ATOMIC atomic_xchg(SHERD_SHARED p, const uint value) { return __atomic_exchange_n(p, value, __ATOMIC_RELAXED); }
SHERD_ATOMIC atomic_cmpxchg(SHERD_SHARED p, uint expected, const uint value) {
  __atomic_compare_exchange_n(p, &expected, value, 0, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
  return expected;
}

// What a kernel takes, for cmake/CompileKernels.cmake: ArgumentType in src/cl/kernel_launch.h.  1 is a buffer, 2 an integer,
// 3 a floating-point number, 4 a structure, 5 a vector.  The classes are GCC's: 1 to 4 integers, 5 pointers, 8 and 12.
struct sherd_parameter {
  uint kind, bytes;
};
#define SHERD_KIND(class) ((class) == 5 ? 1 : (class) == 8 ? 3 : (class) == 12 ? 4 : (class) >= 1 && (class) <= 4 ? 2 : 5)
#define SHERD_PARAMETER(list, name) \
  {SHERD_KIND(__builtin_classify_type(((private struct list*)0)->name)), sizeof(((private struct list*)0)->name)}

#endif
