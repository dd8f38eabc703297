// SPDX-License-Identifier: MIT
#include "cli/command.hpp"

#include <iterator>

namespace ripplenotch {

namespace {
constexpr const Command* const list[] = {
#define COMMAND(name) &commands::name,
#include "cli/commands.def"
#undef COMMAND
    nullptr,
};
}  // namespace

std::span<const Command* const> all_commands() { return {list, std::size(list) - 1}; }

}  // namespace ripplenotch
