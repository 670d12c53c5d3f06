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
  if (faultDescriptor(file)) {
    if (faultNow("write")) return fail();
    if (faultKind("short") && count > 1) count /= 2;
  }
  return real(file, pieces, count);
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

// Whether a call that changes a folder is to fail.
static bool changeFails(const char* kind) { return faultKind("change") ? faultNow("change") : faultNow(kind); }

int rename(const char* from, const char* to) {
  int (*real)(const char*, const char*) = faultReal("rename");
  return faultPath(to) && changeFails("rename") ? fail() : real(from, to);
}

// File systems that can neither swap names nor link files.
static bool isPlain(const char* path) { return faultKind("plain") && faultPath(path); }

int link(const char* from, const char* to) {
  int (*real)(const char*, const char*) = faultReal("link");
  if (isPlain(to)) {
    errno = EPERM;
    return -1;
  }
  return faultPath(to) && changeFails("link") ? fail() : real(from, to);
}

int renameat2(int fromFolder, const char* from, int toFolder, const char* to, unsigned flags) {
  int (*real)(int, const char*, int, const char*, unsigned) = faultReal("renameat2");
  if ((flags & RENAME_EXCHANGE) != 0 && isPlain(to)) {
    errno = EINVAL;
    return -1;
  }
  return faultPathAt(toFolder, to) && changeFails("rename") ? fail() : real(fromFolder, from, toFolder, to, flags);
}

int mkdir(const char* path, mode_t mode) {
  int (*real)(const char*, mode_t) = faultReal("mkdir");
  return faultPath(path) && changeFails("mkdir") ? fail() : real(path, mode);
}

char* mkdtemp(char* path) {
  char* (*real)(char*) = faultReal("mkdtemp");
  if (!faultPath(path) || !changeFails("mkdir")) return real(path);
  fail();
  return NULL;
}

int rmdir(const char* path) {
  int (*real)(const char*) = faultReal("rmdir");
  return faultPath(path) && changeFails("rmdir") ? fail() : real(path);
}

int unlink(const char* path) {
  int (*real)(const char*) = faultReal("unlink");
  return faultPath(path) && changeFails("unlink") ? fail() : real(path);
}

int unlinkat(int folder, const char* path, int flags) {  // what std::filesystem::remove_all calls
  int (*real)(int, const char*, int) = faultReal("unlinkat");
  const char* const kind = flags & AT_REMOVEDIR ? "rmdir" : "unlink";
  return faultPathAt(folder, path) && changeFails(kind) ? fail() : real(folder, path, flags);
}

int remove(const char* path) {  // what std::filesystem::remove calls
  int (*real)(const char*) = faultReal("remove");
  struct stat found;
  const bool isFolder = lstat(path, &found) == 0 && S_ISDIR(found.st_mode);
  return faultPath(path) && changeFails(isFolder ? "rmdir" : "unlink") ? fail() : real(path);
}
