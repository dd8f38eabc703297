// SPDX-License-Identifier: MIT
#pragma once
// Shared by options.cpp and main.cpp only: the parsing library behind Options.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/options.hpp"

namespace ripplenotch {

struct Options::Implementation {
    CLI::App* command = nullptr;
    std::vector<std::string> words;  ///< the command line after the program's name
};

}  // namespace ripplenotch
