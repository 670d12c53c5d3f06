// Distances between voxels as integers, the same in C++ and in OpenCL C.
//
// A metric is a kind (euclidean squared, chebyshev, manhattan) and an integer matrix that the difference is multiplied
// by first: the identity, or SHERD_GRAIN_ONE times a stretching for anisotropic growth.  A distance is 64 bits wide;
// shifted right by `shift` (0 for the identity) it fits 32 bits in a box of 4096 voxels.
#ifndef SHERD_VOXEL_METRIC_H
#define SHERD_VOXEL_METRIC_H

#define SHERD_EUCLIDEAN 0
#define SHERD_CHEBYSHEV 1
#define SHERD_MANHATTAN 2
#define SHERD_GRAIN_ONE 64

#ifdef __OPENCL_VERSION__
#define SHERD_LONG long
// Calls, not comparisons: a compiler makes llvm.abs and llvm.smax of those, which oclgrind does not know.
#define SHERD_ABS(a) ((long)abs(a))
#define SHERD_LARGER(a, b) max(a, b)
#else
#define SHERD_LONG long long
#define SHERD_ABS(a) ((a) < 0 ? -(a) : (a))
#define SHERD_LARGER(a, b) ((a) > (b) ? (a) : (b))
#endif

// Rows of the matrix.
struct sherd_metric {
  int kind;
  int shift;
  int row[9];
};

// One row of the matrix times a difference.
inline SHERD_LONG sherd_row(const struct sherd_metric* metric, const int i, const SHERD_LONG x,
                                           const SHERD_LONG y, const SHERD_LONG z) {
  return metric->row[3 * i] * x + metric->row[3 * i + 1] * y + metric->row[3 * i + 2] * z;
}

// The distance of a stretched difference of absolute values a, b, c: it grows with each.
inline SHERD_LONG sherd_norm(const int kind, const SHERD_LONG a, const SHERD_LONG b,
                                            const SHERD_LONG c) {
  if (kind == SHERD_EUCLIDEAN) return a * a + b * b + c * c;
  if (kind == SHERD_MANHATTAN) return a + b + c;
  const SHERD_LONG ab = SHERD_LARGER(a, b);
  return SHERD_LARGER(ab, c);
}

inline SHERD_LONG sherd_distance(const struct sherd_metric* metric, const int x, const int y,
                                                const int z) {
  const SHERD_LONG a = sherd_row(metric, 0, x, y, z), b = sherd_row(metric, 1, x, y, z),
                   c = sherd_row(metric, 2, x, y, z);
  return sherd_norm(metric->kind, SHERD_ABS(a), SHERD_ABS(b), SHERD_ABS(c));
}

#endif
