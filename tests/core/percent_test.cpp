// SPDX-License-Identifier: MIT
#include "ripplenotch/core/number.hpp"

#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("a percentage has two digits and is never an exponent or a negative nought") {
    CHECK(percent_text(99.96) == "100");
    CHECK(percent_text(100.0) == "100");
    CHECK(percent_text(1234.5) == "1234");
    CHECK(percent_text(9.97) == "10");
    CHECK(percent_text(9.94) == "9.9");
    CHECK(percent_text(0.163) == "0.16");
    CHECK(percent_text(0.00046) == "0.00046");
    CHECK(percent_text(-1e-9) == "0");
    CHECK(percent_text(-0.0) == "0");
}
