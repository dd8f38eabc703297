// SPDX-License-Identifier: MIT
#pragma once
// What the tool says: the only place where words go to standard error, and texts for people to a file or to
// standard output. Nothing said can act on a terminal, and nothing that becomes of standard error changes
// what a command does.

#include <string>
#include <string_view>

#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

/// One line on standard error, made visible. Where nobody takes it (closed, full, gone), it is lost.
void talk(std::string_view line);

/// Several lines on standard error, each made visible.
void talk_lines(std::string_view lines);

/// Lines as people may see them: everything but their ends made visible.
[[nodiscard]] std::string visible_lines(std::string_view lines);

/// write_all() of visible_lines().
void write_text(const std::string& path, std::string_view lines, ByteSink::Overwrite overwrite);

/// Takes the places of standard streams that are closed, so that no file opened later becomes one of them.
/// Reading or writing them fails as before.
void hold_closed_streams();

}  // namespace ripplenotch
