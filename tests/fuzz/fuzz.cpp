// SPDX-License-Identifier: MIT
#include "fuzz/fuzz.hpp"

#include <cstdio>
#include <cstdlib>

// libhdf5 1.10 forgets some objects of a damaged file behind an error of its own (H5C_protect): lost are some
// hundred bytes a damaged file, and nothing that it gave us. Linked as an archive, its own functions stand
// for it.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5\nleak:H5FL_"; }

namespace ripplenotch::fuzz {

void fail(std::string_view what, std::string_view one, std::string_view other) {
    std::fprintf(stderr, "%.*s:\n  %.*s\n  %.*s\n", static_cast<int>(what.size()), what.data(),
                 static_cast<int>(one.size()), one.data(), static_cast<int>(other.size()), other.data());
    std::abort();
}

}  // namespace ripplenotch::fuzz
