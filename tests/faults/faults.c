// Which call fails, and how many there were.
#include "faults.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static atomic_long calls;

long faultSetting(const char* name, long absent) {
  const char* text = getenv(name);
  return text ? atol(text) : absent;
}

int faultError(void) { return (int)faultSetting("SHERD_FAULT_ERROR", 5); }

bool faultKind(const char* kind) {
  const char* wanted = getenv("SHERD_FAULT");
  return wanted && strcmp(wanted, kind) == 0;
}

bool faultNow(const char* kind) {
  if (!faultKind(kind) || atomic_fetch_add(&calls, 1) + 1 != faultSetting("SHERD_FAULT_AT", 0)) return false;
  if (getenv("SHERD_FAULT_KILL")) kill(getpid(), SIGKILL);
  const long number = faultSetting("SHERD_FAULT_SIGNAL", 0);
  if (number > 0) {
    kill(getpid(), (int)number);
    return false;
  }
  const char* waiting = getenv("SHERD_FAULT_WAIT");
  if (waiting) {
    close(creat(waiting, 0600));
    for (;;) pause();
  }
  return true;
}

bool faultPath(const char* path) {
  const char* folder = getenv("SHERD_FAULT_BELOW");
  const size_t length = folder ? strlen(folder) : 0;
  return folder && strncmp(path, folder, length) == 0 &&
         (path[length] == '/' || path[length] == '\0');
}

static bool isBelow(int descriptor) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return false;
  path[length] = '\0';
  return faultPath(path);
}

bool faultPathAt(int folder, const char* path) {
  return folder == AT_FDCWD || *path == '/' ? faultPath(path) : isBelow(folder);
}

bool faultDescriptor(int descriptor) {
  const int mode = fcntl(descriptor, F_GETFL);
  return mode >= 0 && (mode & O_ACCMODE) != O_RDONLY && isBelow(descriptor);
}

void* faultReal(const char* name) { return dlsym(RTLD_NEXT, name); }

__attribute__((destructor)) static void tellCount(void) {
  const char* file = getenv("SHERD_FAULT_COUNT");
  if (!file) return;
  FILE* out = fopen(file, "w");
  if (!out) return;
  fprintf(out, "%ld\n", atomic_load(&calls));
  fclose(out);
}
