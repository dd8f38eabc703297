// SPDX-License-Identifier: MIT
#include "cli/command.hpp"

namespace ripplenotch {

namespace {
constexpr const Command* const list[] = {
#define COMMAND(name) &commands::name,
#include "cli/commands.def"
#undef COMMAND
};
}  // namespace

std::span<const Command* const> all_commands() { return list; }

}  // namespace ripplenotch
