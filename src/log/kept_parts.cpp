// SPDX-License-Identifier: MIT
#include "log/kept_parts.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <new>

#include "core/process/heap.hpp"

namespace ripplenotch {

void Unmapped::operator()(double* numbers) const { ::munmap(numbers, bytes); }

std::span<const double> KeptParts::kept(std::span<const double> numbers) {
    if (room_ == nullptr) {
        const std::size_t bytes = most_numbers_ * sizeof(double);
        void* const mapped = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (mapped == MAP_FAILED) throw std::bad_alloc();
        ask_for_large_pages(mapped, bytes);
        room_ = std::unique_ptr<double, Unmapped>(static_cast<double*>(mapped), Unmapped{bytes});
    }
    double* const to = room_.get() + used_;
    std::copy(numbers.begin(), numbers.end(), to);
    used_ += numbers.size();
    return {to, numbers.size()};
}

}  // namespace ripplenotch
