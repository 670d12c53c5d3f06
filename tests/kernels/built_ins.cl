// Each built-in function that kernels use, over arrays.  Compiled by OpenCL's drivers, and with kernels/built_ins.h.

kernel void of_int(const global int* restrict a, const global int* restrict b, const uint count, global int* restrict least,
                   global int* restrict most, global int* restrict high, global uint* restrict absolute)
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    least[i] = min(a[i], b[i]);
    most[i] = max(a[i], b[i]);
    high[i] = mul_hi(a[i], b[i]);
    absolute[i] = abs(a[i]);
  }
}

kernel void of_uint(const global uint* restrict a, const global uint* restrict b, const uint count,
                    global uint* restrict least, global uint* restrict most)
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    least[i] = min(a[i], b[i]);
    most[i] = max(a[i], b[i]);
  }
}

kernel void of_long(const global long* restrict a, const global long* restrict b, const uint count,
                    global long* restrict least, global long* restrict most, global ulong* restrict absolute)
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    least[i] = min(a[i], b[i]);
    most[i] = max(a[i], b[i]);
    absolute[i] = abs(a[i]);
  }
}

kernel void of_ulong(const global ulong* restrict a, const global ulong* restrict b, const uint count,
                     global ulong* restrict least, global ulong* restrict most, global ulong* restrict zeros,
                     global ulong* restrict ones)
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    least[i] = min(a[i], b[i]);
    most[i] = max(a[i], b[i]);
    zeros[i] = clz(a[i]);
    ones[i] = popcount(a[i]);
  }
}

// `count` vectors of four, then as many of eight.
kernel void of_int_vectors(const global int4* restrict a, const global int4* restrict b, const uint count,
                           global int4* restrict least, global int4* restrict most, global int* restrict anySign,
                           global int4* restrict high4, const global int8* restrict a8, const global int8* restrict b8,
                           global int8* restrict high)
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    least[i] = min(a[i], b[i]);
    most[i] = max(a[i], b[i]);
    anySign[i] = any(a[i]);
    high4[i] = mul_hi(a[i], b[i]);
    high[i] = mul_hi(a8[i], b8[i]);
  }
}

kernel void of_ushort_vectors(const global ushort8* restrict a, const global ushort8* restrict b, const uint count,
                              global ushort8* restrict least, global ushort8* restrict most,
                              const global short8* restrict c, global ushort8* restrict converted)
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    least[i] = min(a[i], b[i]);
    most[i] = max(a[i], b[i]);
    converted[i] = convert_ushort8(c[i]);
  }
}

// Rows of eight through private memory, from one element after the start, so that no row is aligned as a vector.
kernel void of_rows(const global ushort* restrict u, const global int* restrict n, const global ulong* restrict l,
                    const uint rows, global ushort* restrict uOut, global int* restrict nOut, global ulong* restrict lOut)
{
  for (size_t row = get_global_id(0); row < rows; row += get_global_size(0)) {
    ushort uRow[17];
    int nRow[17];
    ulong lRow[17];
    for (int i = 0; i < 17; ++i) {
      uRow[i] = 0;
      nRow[i] = 0;
      lRow[i] = 0;
    }
    for (int i = 0; i < 8; ++i) nRow[1 + i] = n[1 + 8 * row + i];
    vstore8(vload8(row, u + 1), 1, uRow + 1);
    vstore8(vload8(row, l + 1), 1, lRow + 1);
    vstore8(vload8(0, nRow + 1), 1, nRow + 1);
    vstore8(vload8(1, uRow + 1), row, uOut + 1);
    vstore8(vload8(1, lRow + 1), row, lOut + 1);
    for (int i = 0; i < 8; ++i) nOut[1 + 8 * row + i] = nRow[9 + i];
  }
}

// `cells`: sum, count, least, last, and 16 for comparisons.
kernel void of_atomics(volatile global uint* cells, const uint count, global uint* restrict oldSum,
                       global uint* restrict oldCount, global uint* restrict oldLast, global uint* restrict oldCompared)
{
  for (size_t i = get_global_id(0); i < count; i += get_global_size(0)) {
    oldSum[i] = atomic_add(&cells[0], (uint)i + 1);
    oldCount[i] = atomic_inc(&cells[1]);
    atomic_min(&cells[2], (uint)(count - i));
    oldLast[i] = atomic_xchg(&cells[3], (uint)i + 1);
    oldCompared[i] = atomic_cmpxchg(&cells[4 + i % 16], 0u, (uint)i + 1);
  }
}

// A fault on purpose, for the address sanitizer: writes behind the last element.
kernel void of_fault(global uint* restrict numbers, const uint count)
{
  if (get_global_id(0) == 0) numbers[count] = 1;
}

kernel void of_items(volatile global uint* visits, global ulong* restrict sizes)
{
  atomic_inc(&visits[get_global_id(0)]);
  sizes[get_global_id(0)] = get_global_size(0) + get_global_id(1) + get_global_size(1) - 1;
}
