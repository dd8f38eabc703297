// SPDX-License-Identifier: MIT
#pragma once
// Internal: work of many independent parts, on two cores where one log is all there is.

#include <sched.h>

#include <atomic>
#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>

namespace ripplenotch {

/// That this process may run on.
inline int cores_here() {
    cpu_set_t cores;
    return ::sched_getaffinity(0, sizeof cores, &cores) == 0 ? CPU_COUNT(&cores) : 1;
}

/// Calls work(i) once for each i below `count`, in any order, on two threads where the process has two cores.
/// No call may write what another reads; so results are the same on any number. Throws what a call throws,
/// when no other call is running. `worth_it`: the work is some times the 0.05 ms that a thread costs.
template <class Work>
void on_two_cores(std::size_t count, const Work& work, bool worth_it = true) {
    std::atomic<std::size_t> next = 0;
    std::exception_ptr failed;
    const auto go = [&](std::exception_ptr& failure) {
        try {
            for (std::size_t i = next++; i < count; i = next++) work(i);
        } catch (...) {
            failure = std::current_exception();
            next = count;
        }
    };
    std::exception_ptr failed_here;
    {
        std::jthread helper;
        try {
            if (worth_it && count > 1 && cores_here() > 1) helper = std::jthread([&] { go(failed); });
        } catch (const std::system_error&) {  // no thread to be had: one will do
        }
        go(failed_here);
    }
    if (failed_here) std::rethrow_exception(failed_here);
    if (failed) std::rethrow_exception(failed);
}

}  // namespace ripplenotch
