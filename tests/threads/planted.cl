// A kernel with a race: work-items add to one number without an atomic function.
kernel void planted(global uint* sum)
{
  for (uint i = 0; i < 1000; ++i) sum[0] += (uint)get_global_id(0);
}
