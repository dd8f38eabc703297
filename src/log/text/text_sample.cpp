// SPDX-License-Identifier: MIT
#include "log/text/text_sample.hpp"

#include <vector>

#include "log/text/text_row.hpp"

namespace ripplenotch {
namespace {

std::vector<WantedColumn> motion_columns(const MotionPlaces& places) {
    std::vector<WantedColumn> wanted = time_columns(places.layout);
    if (places.velocity) wanted.push_back({*places.velocity, velocity_slot});
    if (places.position) wanted.push_back({*places.position, position_slot});
    return wanted;
}

}  // namespace

MotionSample text_motion_sample(std::string_view bytes, const TextDialect& dialect,
                                const MotionPlaces& places) {
    TextRow row(dialect, motion_columns(places), stamp_rule(places.layout, dialect.rules.decimal_mark));
    const bool timed = places.layout.chosen.time.has_value();
    std::size_t lines = 0;
    MotionSample sample;
    for (std::size_t begin = 0; begin < bytes.size();) {
        const std::size_t found = bytes.find(dialect.line_end, begin);
        if (found == std::string_view::npos) break;
        const std::string_view line = line_content(bytes.substr(begin, found - begin));
        begin = found + 1;
        ++lines;
        if (!row.parse(line)) continue;
        sample.time.push_back(timed ? row.value(time_slot) : static_cast<double>(lines));
        if (places.velocity) sample.velocity.push_back(row.value(velocity_slot));
        if (places.position) sample.position.push_back(row.value(position_slot));
    }
    return sample;
}

}  // namespace ripplenotch
