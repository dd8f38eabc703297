// SPDX-License-Identifier: MIT
#include "log/text_sample.hpp"

#include <algorithm>
#include <cmath>

#include "log/row_parser.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

class Sampling {
  public:
    Sampling(const TextDialect& dialect, const MotionPlaces& places)
        : dialect_(dialect), stamp_(stamp_rule(places.layout, dialect.rules.decimal_mark)) {
        if (places.layout.chosen.time) wanted_.push_back({*places.layout.chosen.time, time_slot});
        if (places.layout.time_fraction) wanted_.push_back({*places.layout.time_fraction, time_slot, true});
        if (places.velocity) wanted_.push_back({*places.velocity, velocity_slot});
        if (places.position) wanted_.push_back({*places.position, position_slot});
        timed_ = places.layout.chosen.time.has_value();
        std::sort(wanted_.begin(), wanted_.end(),
                  [](const WantedColumn& a, const WantedColumn& b) { return a.column < b.column; });
    }

    MotionSample take(std::string_view bytes, const MotionPlaces& places) {
        const RowParser parser(dialect_.rules, dialect_.columns, wanted_, stamp_);
        MotionSample sample;
        for (std::size_t begin = 0; begin < bytes.size();) {
            const std::size_t found = bytes.find(dialect_.line_end, begin);
            if (found == std::string_view::npos) break;
            std::string_view line = bytes.substr(begin, found - begin);
            if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
            begin = found + 1;
            ++rows_;
            if (!parser.parse(line.data(), line.data() + line.size(), row_) && !parse_carefully(line))
                continue;
            sample.time.push_back(timed_ ? row_.values[time_slot] : static_cast<double>(rows_));
            if (places.velocity) sample.velocity.push_back(row_.values[velocity_slot]);
            if (places.position) sample.position.push_back(row_.values[position_slot]);
        }
        return sample;
    }

  private:
    // Quoted cells.
    bool parse_carefully(std::string_view line) {
        split_cells(line, dialect_.rules.delimiter, split_);
        if (split_.cells.size() != dialect_.columns) return false;
        row_.values[time_slot] = 0.0;
        for (const WantedColumn& wanted : wanted_) {
            const std::string_view text = split_.cells[wanted.column].of(line);
            const bool stamp = stamp_.careful && wanted.slot == time_slot && !wanted.fraction;
            const auto number =
                stamp ? read_stamp(text, stamp_) : parse_number(text, dialect_.rules.decimal_mark);
            if (!number || !std::isfinite(*number)) return false;
            if (wanted.fraction)
                row_.values[time_slot] += seconds_per_nanosecond * *number;
            else if (wanted.slot == time_slot)
                row_.values[time_slot] += *number;
            else
                row_.values[wanted.slot] = *number;
        }
        return true;
    }

    const TextDialect& dialect_;
    StampRule stamp_;
    std::vector<WantedColumn> wanted_;
    bool timed_ = false;
    std::size_t rows_ = 0;
    ParsedRow row_;
    CellSplit split_;
};

}  // namespace

MotionSample text_motion_sample(std::string_view bytes, const TextDialect& dialect,
                                const MotionPlaces& places) {
    return Sampling(dialect, places).take(bytes, places);
}

}  // namespace ripplenotch
