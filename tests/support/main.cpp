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
    constexpr int exit_skipped = 77;
    const int failed = Catch::Session().run(count, words);
    return failed == 0 && anything_skipped ? exit_skipped : failed;
}
