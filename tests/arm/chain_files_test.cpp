// SPDX-License-Identifier: MIT
#include "ripplenotch/arm/chain_files.hpp"

#include "support/catch.hpp"
TEST_CASE("placeholder", "[arm]") { CHECK(true); }
