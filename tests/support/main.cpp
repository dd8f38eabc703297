// SPDX-License-Identifier: MIT
#if __has_include(<catch2/catch.hpp>)
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#else
#include <catch2/catch_session.hpp>
#include <catch2/catch_test_macros.hpp>
#endif

#include "support/skipped.hpp"

namespace {
bool anything_skipped = false;
}

namespace ripplenotch::test {

void skipped(const std::string& reason) {
    anything_skipped = true;
    WARN("skipped: " << reason);
}

}  // namespace ripplenotch::test

int main(int count, char** words) {
    // Catch2 of version 3 tells ctest that 4 is skipped; version 2 counts failures, which may be four.
    constexpr int exit_failed = 1, exit_skipped = 4;
    if (Catch::Session().run(count, words) != 0) return exit_failed;
    return anything_skipped ? exit_skipped : 0;
}
