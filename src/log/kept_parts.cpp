// SPDX-License-Identifier: MIT
#include "log/kept_parts.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <new>

namespace ripplenotch {

void Unmapped::operator()(double* numbers) const { ::munmap(numbers, bytes); }

std::span<const double> KeptParts::kept(std::span<const double> numbers) {
    if (room_ == nullptr) {
        // Memory that is touched for the first time costs a fault for each page, which in small ones takes
        // longer than the copying. Where the system has no large ones, small ones will do.
        const std::size_t bytes = most_numbers_ * sizeof(double);
        void* const mapped = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (mapped == MAP_FAILED) throw std::bad_alloc();
        ::madvise(mapped, bytes, MADV_HUGEPAGE);
        room_ = std::unique_ptr<double, Unmapped>(static_cast<double*>(mapped), Unmapped{bytes});
    }
    double* const to = room_.get() + used_;
    std::copy(numbers.begin(), numbers.end(), to);
    used_ += numbers.size();
    return {to, numbers.size()};
}

}  // namespace ripplenotch
