// Calls that fail on purpose: what the files here have in common.
//
// Preloaded into a program, the module lets one call of a kind fail, or kills the program there.
// Environment:
//
//   SHERD_FAULT         the kind: write, short, open, close, rename, link, mkdir, rmdir, unlink,
//                       memory, device, source (kernels that do not compile), plain (links and
//                       swaps of names), or change, which is any of rename, link, mkdir, rmdir and
//                       unlink
//   SHERD_FAULT_AT      which call of that kind fails, from 1; 0: none, they are counted only; of
//                       "short" all, each writing half of what it could, and all of "plain"
//   SHERD_FAULT_ERROR   what it fails with, an errno or an OpenCL error
//   SHERD_FAULT_KILL    set: the call is not made, the process is killed instead as by kill -9
//   SHERD_FAULT_SIGNAL  set: the call is made, and before it the process sends itself this signal
//   SHERD_FAULT_WAIT    a file: the call makes it, and never returns
//   SHERD_FAULT_BELOW   files: only those below this folder
//   SHERD_FAULT_BYTES   memory: only allocations of this size and more
//   SHERD_FAULT_COUNT   a file that gets the number of calls of that kind, at the program's end
#pragma once

#include <stdbool.h>
#include <stddef.h>

/// Whether this kind was chosen.
bool faultKind(const char* kind);

/// Whether a call of this kind is to fail.  Counts it.
bool faultNow(const char* kind);

/// What a call fails with.
int faultError(void);

/// What a variable says; `absent` where there is none.
long faultSetting(const char* name, long absent);

/// Whether a path, or the file behind a descriptor, is below SHERD_FAULT_BELOW.
bool faultPath(const char* path);
bool faultPathAt(int folder, const char* path);  ///< as openat has paths
bool faultDescriptor(int descriptor);

/// The function of this name that the program would have called without this module.
void* faultReal(const char* name);
