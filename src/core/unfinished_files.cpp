// SPDX-License-Identifier: MIT
#include "core/unfinished_files.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>

namespace ripplenotch {
namespace {

// What a signal handler may touch: atomics without locks, and unlink().
std::array<std::atomic<const char*>, 64> unfinished;
static_assert(std::atomic<const char*>::is_always_lock_free);

std::size_t claim_slot(const char* path) {
    for (std::size_t slot = 0; slot < unfinished.size(); ++slot) {
        const char* free = nullptr;
        if (unfinished[slot].compare_exchange_strong(free, path)) return slot;
    }
    return unfinished.size();
}

void remove_and_end(int signal) {
    for (const auto& path : unfinished) {
        if (const char* const name = path.load()) ::unlink(name);
    }
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

}  // namespace

UnfinishedFile::UnfinishedFile(const std::string& path) : path_(path), slot_(claim_slot(path_.c_str())) {}

UnfinishedFile::~UnfinishedFile() {
    if (slot_ < unfinished.size()) unfinished[slot_] = nullptr;
}

void remove_unfinished_files_on_signals() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        if (std::signal(signal, remove_and_end) == SIG_IGN) std::signal(signal, SIG_IGN);
    }
}

}  // namespace ripplenotch
