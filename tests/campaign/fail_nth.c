// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Loaded before the C library (LD_PRELOAD), it lets one call of main and what follows from it fail: PLIANT_FAIL=KIND:N,
// the N-th of its kind (open, read, write, fsync, rename, mkdir, thread; with fail_calls.cc also malloc, decode, solve)
// in the process. PLIANT_FAIL_COUNTS names a file that gets a line KIND COUNT for each kind when the process ends. Files
// of the system and the standard streams are left alone.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

enum Kind { kOpen, kRead, kWrite, kFsync, kRename, kMkdir, kThread, kMalloc, kDecode, kSolve, kKinds };
static const char* const kNames[kKinds] = {"open",  "read",   "write",  "fsync",  "rename",
                                           "mkdir", "thread", "malloc", "decode", "solve"};
static const int kErrors[kKinds] = {EMFILE, EIO, ENOSPC, EIO, EACCES, ENOSPC, EAGAIN, ENOMEM, 0, 0};

static atomic_int armed;  // main has begun
static atomic_long counts[kKinds];
static int wanted_kind = -1;
static long wanted_number;

static int Fails(enum Kind kind) {
  if (!atomic_load(&armed)) return 0;
  const long number = atomic_fetch_add(&counts[kind], 1) + 1;
  if ((int)kind != wanted_kind || number != wanted_number) return 0;
  errno = kErrors[kind];
  return 1;
}

// For fail_calls.cc: whether this call of the kind fails.
int PliantFails(const char* name);
int PliantFails(const char* name) {
  for (int kind = 0; kind < kKinds; ++kind)
    if (strcmp(name, kNames[kind]) == 0) return Fails((enum Kind)kind);
  return 0;
}

static int IsSystems(const char* path) {
  static const char* const kFolders[] = {"/proc/", "/sys/", "/dev/", "/etc/", "/usr/", "/lib"};
  for (size_t k = 0; k < sizeof kFolders / sizeof *kFolders; ++k)
    if (strncmp(path, kFolders[k], strlen(kFolders[k])) == 0) return 1;
  return 0;
}

static void WriteCounts(void) {
  atomic_store(&armed, 0);
  const char* path = getenv("PLIANT_FAIL_COUNTS");
  if (path == NULL) return;
  const int file = (int)syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  for (int kind = 0; kind < kKinds; ++kind) {
    char line[64];
    const int size = snprintf(line, sizeof line, "%s %ld\n", kNames[kind], atomic_load(&counts[kind]));
    if (syscall(SYS_write, file, line, size) < 0) break;
  }
  syscall(SYS_close, file);
}

static int (*real_main)(int, char**, char**);

static int CountedMain(int argc, char** argv, char** environment) {
  const char* wish = getenv("PLIANT_FAIL");
  const char* colon = wish != NULL ? strchr(wish, ':') : NULL;
  for (int kind = 0; colon != NULL && kind < kKinds; ++kind)
    if (strlen(kNames[kind]) == (size_t)(colon - wish) && strncmp(wish, kNames[kind], (size_t)(colon - wish)) == 0)
      wanted_kind = kind;
  if (colon != NULL) wanted_number = strtol(colon + 1, NULL, 10);
  unsetenv("LD_PRELOAD");  // not for programs that this one starts
  atomic_store(&armed, 1);
  const int code = real_main(argc, argv, environment);
  WriteCounts();
  return code;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(void), void (*fini)(void),
                      void (*rtld_fini)(void), void* stack_end);
int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(void), void (*fini)(void),
                      void (*rtld_fini)(void), void* stack_end) {
  real_main = main;
  return REAL(__libc_start_main)(CountedMain, argc, argv, init, fini, rtld_fini, stack_end);
}

#define OPEN(name)                                                \
  int name(const char* path, int flags, ...) {                    \
    va_list arguments;                                            \
    va_start(arguments, flags);                                   \
    const mode_t mode = va_arg(arguments, mode_t);                \
    va_end(arguments);                                            \
    if (!IsSystems(path) && Fails(kOpen)) return -1;              \
    return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode); \
  }
OPEN(open)
OPEN(open64)

FILE* fopen(const char* path, const char* mode) {
  return !IsSystems(path) && Fails(kOpen) ? NULL : REAL(fopen)(path, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  return !IsSystems(path) && Fails(kOpen) ? NULL : REAL(fopen64)(path, mode);
}

ssize_t read(int file, void* data, size_t size) {
  return file > 2 && Fails(kRead) ? -1 : syscall(SYS_read, file, data, size);
}
size_t fread(void* data, size_t size, size_t count, FILE* file) {
  static size_t (*real)(void*, size_t, size_t, FILE*);
  if (real == NULL) real = REAL(fread);
  if (!Fails(kRead)) return real(data, size, count, file);
  file->_flags |= 0x20;  // _IO_ERR_SEEN: ferror says so
  return 0;
}

ssize_t write(int file, const void* data, size_t size) {
  return file > 2 && Fails(kWrite) ? -1 : syscall(SYS_write, file, data, size);
}
ssize_t writev(int file, const struct iovec* parts, int count) {
  return file > 2 && Fails(kWrite) ? -1 : syscall(SYS_writev, file, parts, count);
}
size_t fwrite(const void* data, size_t size, size_t count, FILE* file) {
  static size_t (*real)(const void*, size_t, size_t, FILE*);
  if (real == NULL) real = REAL(fwrite);
  return file != stdout && file != stderr && Fails(kWrite) ? 0 : real(data, size, count, file);
}

int fsync(int file) { return Fails(kFsync) ? -1 : (int)syscall(SYS_fsync, file); }
int rename(const char* from, const char* to) { return Fails(kRename) ? -1 : (int)syscall(SYS_rename, from, to); }
int mkdir(const char* path, mode_t mode) { return Fails(kMkdir) ? -1 : (int)syscall(SYS_mkdir, path, mode); }

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*function)(void*), void* argument) {
  return Fails(kThread) ? EAGAIN : REAL(pthread_create)(thread, attributes, function, argument);
}
