// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

// The first rows of a log, by which its clock and its position are judged before anything is done with them.

struct Opening {
    std::deque<RowBlock> blocks;      ///< read ahead
    std::vector<std::size_t> counts;  ///< rows of each block that belong to the opening
    std::vector<double> time_s;       ///< of those
    bool whole_log = false;           ///< nothing is left in the reader
};

/// The first clock_rows rows; fewer of wide logs, still a second or so. Which rows these are depends on the
/// log alone, not on how its bytes arrive: a pipe and a file must give the same coefficients.
[[nodiscard]] Opening read_opening(LogReader& reader);

/// The blocks read ahead, then those of the reader; false when there are none left.
bool next_block(Opening& opening, LogReader& reader, RowBlock& block);

// Internal to the log room: which format the first bytes of a file are.

/// What detect_format() looks at.
inline constexpr std::size_t first_bytes_size = 512;

/// The one of `formats` that knows these bytes, else CSV, whose own messages say what is wrong with them.
/// Throws DataError, naming `source`, for files of other kinds that people hand over by mistake.
[[nodiscard]] const LogFormat& detect_format(std::string_view first_bytes, const std::string& source,
                                             std::span<const LogFormat* const> formats = log_formats());

/// Appends to `bytes` until there are `size` or the source ends; true when it ended before. The room grows
/// with what comes: most logs are short of what is asked for.
bool read_on(ByteSource& source, std::string& bytes, std::size_t size = static_cast<std::size_t>(-1));

}  // namespace ripplenotch
