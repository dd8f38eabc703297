// SPDX-License-Identifier: MIT
// Records of dumps and containers, which have fields as arrays have but no head; and what the first records
// of either say.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "log/containers/stored_array.hpp"
#include "log/npy/npy_reader.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// Links to other files, arrays of another length: what the names speak of and the records do not hold.
std::string left_out_of(const std::vector<ContentEntry>& contents) {
    constexpr std::size_t most = 4;
    std::vector<std::string> found;
    for (const ContentEntry& entry : contents) {
        if (entry.read || found.size() == most || names_tell({entry.path}) == 0) continue;
        found.push_back(
            fmt::format("{} ({}{}{})", entry.path, entry.shape, entry.shape.empty() ? "" : ", ", entry.type));
    }
    return found.empty() ? std::string() : fmt::format(" and not {}", fmt::join(found, ", "));
}

}  // namespace

NpyReader::NpyReader(std::unique_ptr<ByteSource> records, RecordTable table, const ReadOptions& options,
                     bool keep_all)
    : source_(std::move(records)), table_(std::move(table)), hold_bad_values_(options.hold_bad_values) {
    header_.fields = table_.fields;
    header_.structured = table_.named;
    header_.record_size = table_.record_size;
    endless_ = !table_.rows;
    header_.rows = table_.rows.value_or(std::numeric_limits<std::size_t>::max());
    // Whole records: of one that was begun, the rest would not fit any more once columns are left out.
    const std::size_t sample = std::max<std::size_t>(64, npy_sample_bytes / header_.record_size);
    read_up_to(carry_, std::min(header_.rows, sample) * header_.record_size);
    if (carry_.size() < header_.record_size) {
        if (!carry_.empty()) complain_of_end(carry_.size());
        raise<DataError>("{}: read no row, expected rows of numbers; check what wrote it", source_->name());
    }
    ReadOptions settled = options;
    if (!table_.columns.empty()) settled.columns = table_.columns;
    decide(settled);
    if (auto* const selective = dynamic_cast<RecordSource*>(source_.get()); selective != nullptr && !keep_all)
        keep_wanted(*selective);
}

// Of what was read ahead, too: from here on records hold nothing else.
void NpyReader::keep_wanted(RecordSource& records) {
    std::vector<std::size_t> wanted;
    for (const WantedColumn& one : wanted_) wanted.push_back(one.column);
    if (layout_.time_fraction) wanted.push_back(*layout_.time_fraction);
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    if (wanted.empty()) return;
    std::string kept;
    for (std::size_t at = 0; at + header_.record_size <= carry_.size(); at += header_.record_size) {
        for (const std::size_t c : wanted)
            kept.append(carry_, at + header_.fields[c].offset, header_.fields[c].size);
    }
    std::size_t size = 0;
    for (const std::size_t c : wanted) {
        header_.fields[c].offset = size;
        size += header_.fields[c].size;
    }
    header_.record_size = size;
    carry_ = std::move(kept);
    records.keep(wanted);
}

void NpyReader::complain_of_end(std::size_t left_over) const {
    raise<DataError>(
        "{}: read {} rows and {} bytes of one more, expected records of {} bytes; the file is cut off, "
        "or its records are others than told",
        source_->name(), source_->number_in_file(fetched_), left_over, header_.record_size);
}

std::size_t NpyReader::sample_rows() const {
    return std::min(header_.rows, carry_.size() / header_.record_size);
}

ColumnFacts NpyReader::column_facts() {
    ColumnFacts facts;
    facts.columns = header_.fields.size();
    facts.sample.resize(facts.columns);
    const std::size_t rows = sample_rows();
    for (std::size_t c = 0; c < facts.columns; ++c) {
        if (header_.structured) facts.names.push_back(header_.fields[c].name);
        for (std::size_t r = 0; r < rows; ++r) {
            const bool number = header_.fields[c].kind != '\0';
            facts.sample[c].push_back(
                number ? load_field(carry_.data() + r * header_.record_size, header_.fields[c])
                       : not_a_number);
        }
        facts.first_counts.push_back(rows > 0 ? load_count(carry_.data(), header_.fields[c]) : 0);
    }
    facts.read_as = table_.read_as;
    facts.left_out = left_out_of(table_.contents);
    facts.units = table_.units;
    facts.dialect_options = table_.options;
    facts.motion_sample = [this](const MotionPlaces& places, std::size_t bytes) {
        const std::size_t all = std::min(header_.rows, bytes / header_.record_size) * header_.record_size;
        read_up_to(carry_, std::max(carry_.size(), all));
        return motion_sample(places);
    };
    return facts;
}

}  // namespace ripplenotch
