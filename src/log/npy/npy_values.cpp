// SPDX-License-Identifier: MIT
// The numbers of an array's records: stamps in whole numbers or two fields, the opening's motion; and arrays
// that have to be turned before they have records.

#include <algorithm>
#include <cmath>
#include <memory>

#include "log/npy/npy_reader.hpp"
#include "log/npy/npy_rows.hpp"
#include "ripplenotch/core/reading.hpp"

namespace ripplenotch {

// An array that is not stored row by row cannot be read a row at a time.
void NpyReader::read_whole(std::string& first_bytes) {
    constexpr std::size_t piece = std::size_t{1} << 20;
    for (std::size_t have = first_bytes.size(), got = 1; got > 0; have += got) {
        first_bytes.resize(have + piece);
        got = source_->read(first_bytes.data() + have, piece);
        first_bytes.resize(have + got);
    }
    const std::string name = source_->name();
    const auto rows = std::make_shared<const std::string>(npy_by_rows(first_bytes, header_, name));
    source_ = std::make_unique<ByteSource>(name, rows);
    first_bytes.clear();
    read_up_to(first_bytes, npy_header_size(std::string_view(*rows).substr(0, 12)));
    header_ = parse_npy_header(first_bytes, name);
}

double NpyReader::time_at(const char* record, const Layout& layout) const {
    const NpyField& field = header_.fields[*layout.chosen.time];
    double time =
        layout.time_origin == 0 ? load_field(record, field) : load_since(record, field, layout.time_origin);
    if (layout.time_fraction)
        time += seconds_per_nanosecond * load_field(record, header_.fields[*layout.time_fraction]);
    return time;
}

double NpyReader::value_at(const char* record, const WantedColumn& wanted) const {
    if (wanted.slot == time_slot) return time_at(record, layout_);
    return load_field(record, header_.fields[wanted.column]);
}

MotionSample NpyReader::motion_sample(const MotionPlaces& places) const {
    MotionSample sample;
    const std::size_t rows = std::min(header_.rows, carry_.size() / header_.record_size);
    sample.time.reserve(rows);
    if (places.velocity) sample.velocity.reserve(rows);
    if (places.position) sample.position.reserve(rows);
    for (std::size_t r = 0; r < rows; ++r) {
        const char* const record = carry_.data() + r * header_.record_size;
        sample.time.push_back(places.layout.chosen.time ? time_at(record, places.layout)
                                                        : static_cast<double>(r));
        if (places.velocity) sample.velocity.push_back(load_field(record, header_.fields[*places.velocity]));
        if (places.position) sample.position.push_back(load_field(record, header_.fields[*places.position]));
    }
    return sample;
}

bool NpyReader::read_column(const char* records, const WantedColumn& wanted,
                            std::span<double> numbers) const {
    const bool stamp = wanted.slot == time_slot && (layout_.time_origin != 0 || layout_.time_fraction);
    if (!stamp) return load_column(records, header_.record_size, header_.fields[wanted.column], numbers);
    bool finite = true;
    for (double& number : numbers) {
        number = time_at(records, layout_);
        finite &= is_reading(number);
        records += header_.record_size;
    }
    return finite;
}

}  // namespace ripplenotch
