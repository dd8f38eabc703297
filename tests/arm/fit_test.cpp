// SPDX-License-Identifier: MIT
#include "ripplenotch/arm/arm_fit.hpp"

#include "arm_support.hpp"
#include "support/catch.hpp"
TEST_CASE("placeholder fit", "[arm]") { CHECK(true); }
