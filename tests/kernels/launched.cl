// Kernels that launch_test.cpp launches with other arguments than theirs.  The ways of writing them are those that
// cmake/CompileKernels.cmake has to read: a macro, a comment within, no parameters.

struct planted_values {
  ulong most;
  int least[4];  // no padding at the end, which rusticl does not count
};

#define PLANTED_BUFFERS global uint* restrict out, /* (here, too) */ const global ushort* in

kernel void planted_mixed(PLANTED_BUFFERS,
                          const uint count,                    // of `out`, not of `in`
                          const ulong first, const float scale,
                          const struct planted_values values)
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    out[i] = (uint)(first + in[i] + (ulong)values.least[2] + values.most) * (uint)scale;
  }
}

kernel void planted_vector(global int* restrict out, const int4 values)
{
  if (get_global_id(0) == 0) out[0] = values.w;
}

__kernel void
planted_empty(void)
{
}
