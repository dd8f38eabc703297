// SPDX-License-Identifier: MIT
// Version 2 of Catch2 is compiled here; version 3 brings its main as a library.
#if __has_include(<catch2/catch.hpp>)
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
#endif
