// SPDX-License-Identifier: MIT
#include "ripplenotch/core/number.hpp"

#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("one is told in the singular, none and many in the plural") {
    CHECK(how_many(1, "gap") == "1 gap");
    CHECK(how_many(0, "gap") == "0 gaps");
    CHECK(how_many(12, "gap") == "12 gaps");
    CHECK(how_many(1, "change of filter", "changes of filter") == "1 change of filter");
    CHECK(how_many(2, "change of filter", "changes of filter") == "2 changes of filter");
}
