// SPDX-License-Identifier: MIT
#include "fuzz/fuzz.hpp"

#include <cstdio>
#include <cstdlib>

namespace ripplenotch::fuzz {

void fail(std::string_view what, std::string_view one, std::string_view other) {
    std::fprintf(stderr, "%.*s:\n  %.*s\n  %.*s\n", static_cast<int>(what.size()), what.data(),
                 static_cast<int>(one.size()), one.data(), static_cast<int>(other.size()), other.data());
    std::abort();
}

}  // namespace ripplenotch::fuzz
