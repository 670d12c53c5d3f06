// gather: copy the voxels of listed items into consecutive blocks, and back.
// One work-item takes entries i, i + all, ...; any work-group size.
// Reference: tests/kernels/gather_test.cpp, bit for bit.

kernel void gather_voxels(
    const global ushort* restrict voxel,  // [items*512]
    const global uint* restrict item,     // [count]
    const uint count,
    global ushort* restrict gathered)     // [count*512]  out
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
      gathered[i * SHERD_LEAF_SIZE + v] = voxel[(size_t)item[i] * SHERD_LEAF_SIZE + v];
    }
  }
}

kernel void scatter_voxels(
    const global ushort* restrict gathered,  // [count*512]
    const global uint* restrict item,        // [count]  distinct
    const uint count,
    global ushort* restrict voxel)           // [items*512]  out, of the listed items
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    for (int v = 0; v < SHERD_LEAF_SIZE; ++v) {
      voxel[(size_t)item[i] * SHERD_LEAF_SIZE + v] = gathered[i * SHERD_LEAF_SIZE + v];
    }
  }
}
