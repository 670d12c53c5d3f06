// Files: a full disk, a broken one, and short writes.
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include "faults.h"

static int fail(void) {
  errno = faultError();
  return -1;
}

ssize_t write(int file, const void* bytes, size_t size) {
  ssize_t (*real)(int, const void*, size_t) = faultReal("write");
  if (faultDescriptor(file)) {
    if (faultNow("write")) return fail();
    if (faultKind("short") && size > 1) size /= 2;
  }
  return real(file, bytes, size);
}

ssize_t writev(int file, const struct iovec* pieces, int count) {  // what std::ofstream calls
  ssize_t (*real)(int, const struct iovec*, int) = faultReal("writev");
  return faultDescriptor(file) && faultNow("write") ? fail() : real(file, pieces, count);
}

static bool writes(int flags) { return (flags & O_ACCMODE) != O_RDONLY; }

int open(const char* path, int flags, ...) {
  int (*real)(const char*, int, ...) = faultReal("open");
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) ? va_arg(more, mode_t) : 0;
  va_end(more);
  if (writes(flags) && faultPath(path) && faultNow("open")) return fail();
  return real(path, flags, mode);
}

int close(int file) {
  int (*real)(int) = faultReal("close");
  const bool fails = faultDescriptor(file) && faultNow("close");
  const int result = real(file);
  return fails ? fail() : result;
}

int rename(const char* from, const char* to) {
  int (*real)(const char*, const char*) = faultReal("rename");
  return faultPath(to) && faultNow("rename") ? fail() : real(from, to);
}

int mkdir(const char* path, mode_t mode) {
  int (*real)(const char*, mode_t) = faultReal("mkdir");
  return faultPath(path) && faultNow("mkdir") ? fail() : real(path, mode);
}

char* mkdtemp(char* path) {
  char* (*real)(char*) = faultReal("mkdtemp");
  if (!faultPath(path) || !faultNow("mkdir")) return real(path);
  fail();
  return NULL;
}
