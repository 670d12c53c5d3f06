// gather: copy the voxels of listed items into consecutive blocks, and back; labels are written per voxel for that.
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

// Writes the labels of listed items per voxel, which makes them mixed.
kernel void expand_labels(
    const global ulong* restrict inside,  // [leafCount*8]  the voxels that have a label
    const uint leafCount,
    const global uint* restrict item,     // [count]  distinct
    const uint count,
    global ushort* restrict owner,        // see leaf_labels.h
    global uint* restrict tag,
    const global ulong* restrict second)
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint at = item[i];
    if (tag[at] == SHERD_TAG_MIXED) continue;
    write_rows(vload8(at % leafCount, inside), second_of(tag[at], at, second), tag[at],
               owner + (size_t)at * SHERD_LEAF_SIZE);
    tag[at] = SHERD_TAG_MIXED;
  }
}
