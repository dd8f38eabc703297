// SPDX-License-Identifier: MIT
#include "log/npy/kept_rows.hpp"

#include <cmath>

namespace ripplenotch {

KeptRows::KeptRows(NpyReader& whole, const ReadOptions& options) : cut_(options, whole.layout()) {
    const std::size_t size = whole.header().record_size;
    const bool timed = whole.layout().chosen.time.has_value();
    RowBlock block;
    while (whole.fetch(block)) {
        const std::string_view bytes = block.bytes;
        for (std::size_t at = 0; at < bytes.size(); at += size) {
            std::optional<double> time;
            if (timed) time = whole.time_of(bytes.data() + at);
            const bool stays = cut_.keeps(time && std::isfinite(*time) ? time : std::nullopt);
            numbers_.add(stays);
            if (stays) bytes_.put(bytes.substr(at, size));
        }
    }
    cut_.require_rows();
    bytes_.rewind();
}

}  // namespace ripplenotch
