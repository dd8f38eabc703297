// SPDX-License-Identifier: MIT
// Precompiled for the tests: src/standard_headers.hpp and Catch2.
#include "standard_headers.hpp"
#include "support/catch.hpp"
