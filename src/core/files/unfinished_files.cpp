// SPDX-License-Identifier: MIT
#include "core/files/unfinished_files.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "core/process/sanitized.hpp"

namespace ripplenotch {

// What a signal handler may touch: atomics without locks, and unlink(). Places are made and never freed, so
// that a handler on another thread can walk along them at any time.
struct UnfinishedFile::Place {
    std::atomic<const char*> path = nullptr;
    Place* next = nullptr;
};

namespace {

using Place = UnfinishedFile::Place;
static_assert(std::atomic<const char*>::is_always_lock_free && std::atomic<Place*>::is_always_lock_free);
std::atomic<Place*> newest = nullptr;

Place* claim_place(const char* path) {
    for (Place* place = newest; place != nullptr; place = place->next) {
        const char* free = nullptr;
        if (place->path.compare_exchange_strong(free, path)) return place;
    }
    auto* const place = new Place;
    place->path = path;
    place->next = newest;
    while (!newest.compare_exchange_weak(place->next, place)) {
    }
    return place;
}

void remove_and_end(int signal) {
    remove_unfinished_files();
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

// All that end a process unless somebody says otherwise. A sanitizer wants to report the faults itself.
constexpr int ending_signals[] = {
    SIGHUP,    SIGINT,  SIGQUIT, SIGPIPE, SIGALRM, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGVTALRM, SIGPROF,
#if defined(SIGPOLL)
    SIGPOLL,
#endif
#if defined(SIGPWR)
    SIGPWR,
#endif
#if defined(SIGSTKFLT)
    SIGSTKFLT,
#endif
#if !defined(RIPPLENOTCH_SANITIZED)
    SIGILL,    SIGTRAP, SIGABRT, SIGBUS,  SIGFPE,  SIGSEGV, SIGSYS,
#endif
};

void remove_on(int signal) {
    if (std::signal(signal, remove_and_end) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

void remove_unfinished_files() noexcept {
    for (const Place* place = newest; place != nullptr; place = place->next) {
        if (const char* const name = place->path.load()) ::unlink(name);
    }
}

UnfinishedFile::UnfinishedFile(const std::string& path) : path_(path), place_(claim_place(path_.c_str())) {}

UnfinishedFile::~UnfinishedFile() { place_->path = nullptr; }

void remove_unfinished_files_on_signals() {
    for (const int signal : ending_signals) remove_on(signal);
#if defined(SIGRTMIN)
    for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) remove_on(signal);
#endif
#if defined(SIGXFSZ)
    std::signal(SIGXFSZ, SIG_IGN);
#endif
}

}  // namespace ripplenotch
