// SPDX-License-Identifier: MIT
// Preloaded into the program, makes the system fail on purpose, as the environment says:
//   FAULT_MALLOC_AT=N      the Nth request for memory fails; FAULT_MALLOC_FROM=N: it and all after it
//   FAULT_READ_AT=N        the Nth read fails with EIO; FAULT_READ_SHORT=1: every read gives a few bytes only
//   FAULT_WRITE_AT=N       the Nth write to a file fails with ENOSPC; FAULT_WRITE_SHORT=1: every write takes half
//   FAULT_SYNC_AT=N        the Nth fsync fails with EIO; FAULT_RENAME_AT=N, FAULT_LINK_AT=N alike
//   FAULT_NAMELESS=1       files without a name cannot be had
//   FAULT_THREADS=1        no thread can be had
// Counting begins with the program's own work, at its first call of signal().
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

extern void* __libc_malloc(size_t size);
extern void* __libc_calloc(size_t count, size_t size);
extern void* __libc_realloc(void* old, size_t size);
extern void* __libc_memalign(size_t alignment, size_t size);

static atomic_long memory, reads, writes, syncs, renames, links;
static long memory_at, memory_from, read_at, read_short, write_at, write_short, sync_at, rename_at, link_at, nameless,
    threads;
static atomic_int begun;

static long setting(const char* name) {
    const char* const text = getenv(name);
    return text ? atol(text) : 0;
}

__attribute__((constructor)) static void read_settings(void) {
    memory_at = setting("FAULT_MALLOC_AT");
    memory_from = setting("FAULT_MALLOC_FROM");
    read_at = setting("FAULT_READ_AT");
    read_short = setting("FAULT_READ_SHORT");
    write_at = setting("FAULT_WRITE_AT");
    write_short = setting("FAULT_WRITE_SHORT");
    sync_at = setting("FAULT_SYNC_AT");
    rename_at = setting("FAULT_RENAME_AT");
    link_at = setting("FAULT_LINK_AT");
    nameless = setting("FAULT_NAMELESS");
    threads = setting("FAULT_THREADS");
}

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

// main() sets its signals first.
__sighandler_t signal(int number, __sighandler_t handler) {
    static __typeof__(&signal) next;
    if (!next) next = NEXT(signal);
    const __sighandler_t before = next(number, handler);
    begun = 1;
    return before;
}

static int memory_fails(void) {
    if (!begun || (memory_at == 0 && memory_from == 0)) return 0;
    const long number = atomic_fetch_add(&memory, 1) + 1;
    if (number != memory_at && (memory_from == 0 || number < memory_from)) return 0;
    errno = ENOMEM;
    return 1;
}

void* malloc(size_t size) { return memory_fails() ? NULL : __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return memory_fails() ? NULL : __libc_calloc(count, size); }
void* realloc(void* old, size_t size) { return memory_fails() ? NULL : __libc_realloc(old, size); }
void* memalign(size_t alignment, size_t size) {
    return memory_fails() ? NULL : __libc_memalign(alignment, size);
}
void* aligned_alloc(size_t alignment, size_t size) { return memalign(alignment, size); }
int posix_memalign(void** to, size_t alignment, size_t size) {
    *to = memalign(alignment, size);
    return *to ? 0 : ENOMEM;
}

static int fails(atomic_long* counter, long at, int reason) {
    if (at == 0 || atomic_fetch_add(counter, 1) + 1 != at) return 0;
    errno = reason;
    return 1;
}

static size_t shortened(size_t size) {
    if (!read_short || size < 2) return size;
    const size_t few = 1 + (size_t)(atomic_fetch_add(&reads, 1) * 7919 % 4099);
    return size < few ? size : few;
}

ssize_t read(int from, void* into, size_t size) {
    static __typeof__(&read) next;
    if (!next) next = NEXT(read);
    if (fails(&reads, read_at, EIO)) return -1;
    return next(from, into, shortened(size));
}

ssize_t pread(int from, void* into, size_t size, off_t at) {
    static __typeof__(&pread) next;
    if (!next) next = NEXT(pread);
    if (fails(&reads, read_at, EIO)) return -1;
    return next(from, into, shortened(size), at);
}
ssize_t pread64(int from, void* into, size_t size, off_t at) { return pread(from, into, size, at); }

ssize_t write(int to, const void* from, size_t size) {
    static __typeof__(&write) next;
    if (!next) next = NEXT(write);
    if (to != 2 && fails(&writes, write_at, ENOSPC)) return -1;
    return next(to, from, write_short && to != 2 && size > 1 ? size / 2 : size);
}

ssize_t writev(int to, const struct iovec* parts, int count) {
    static __typeof__(&writev) next;
    if (!next) next = NEXT(writev);
    if (fails(&writes, write_at, ENOSPC)) return -1;
    if (write_short && count > 0 && parts[0].iov_len > 1) {
        const struct iovec half = {parts[0].iov_base, parts[0].iov_len / 2};
        return next(to, &half, 1);
    }
    return next(to, parts, count);
}

int fsync(int file) {
    static __typeof__(&fsync) next;
    if (!next) next = NEXT(fsync);
    return fails(&syncs, sync_at, EIO) ? -1 : next(file);
}

int rename(const char* from, const char* to) {
    static __typeof__(&rename) next;
    if (!next) next = NEXT(rename);
    return fails(&renames, rename_at, EACCES) ? -1 : next(from, to);
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) {
    static __typeof__(&linkat) next;
    if (!next) next = NEXT(linkat);
    return fails(&links, link_at, EACCES) ? -1 : next(from_folder, from, to_folder, to, flags);
}

int open(const char* path, int flags, ...) {
    static int (*next)(const char*, int, ...);
    if (!next) next = (int (*)(const char*, int, ...))dlsym(RTLD_NEXT, "open");
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    if (nameless && (flags & O_TMPFILE) == O_TMPFILE) {
        errno = EOPNOTSUPP;
        return -1;
    }
    return next(path, flags, mode);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* how, void* (*work)(void*), void* with) {
    static __typeof__(&pthread_create) next;
    if (!next) next = NEXT(pthread_create);
    return threads ? EAGAIN : next(thread, how, work, with);
}
