// SPDX-License-Identifier: MIT
#include "log/npy/npy_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "log/clock/choose_time.hpp"
#include "log/containers/stored_array.hpp"
#include "log/read.hpp"
#include "log/rows_in_range.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t npy_piece = std::size_t{1} << 18;

}  // namespace

NpyReader::NpyReader(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options)
    : source_(std::move(source)), hold_bad_values_(options.hold_bad_values) {
    table_.format = "npy";
    read_up_to(first_bytes, 12);
    if (first_bytes.substr(0, npy_magic.size()) != npy_magic) {
        raise<DataError>(
            "{}: read '{}...', expected a NumPy file, which begins with \\x93NUMPY; leave out --format",
            source_->name(), first_bytes.substr(0, 6));
    }
    const std::size_t header_size = npy_header_size(first_bytes);
    if (header_size <= largest_npy_header) read_up_to(first_bytes, header_size);
    header_ = parse_npy_header(first_bytes, source_->name());
    if (header_.by_columns || header_.transposed) read_whole(first_bytes);
    read_up_to(first_bytes,
               header_.data_offset + std::min(npy_sample_bytes, header_.rows * header_.record_size));
    head_ = first_bytes.substr(0, header_.data_offset);
    carry_ = first_bytes.substr(header_.data_offset);
    if (header_.rows == 0)
        raise<DataError>("{}: read an array without rows, expected rows of numbers; check what wrote it",
                         source_->name());
    decide(options);
}

void NpyReader::read_up_to(std::string& bytes, std::size_t size) {
    bytes.resize(read_on(*source_, bytes, bytes.size(), size));
}

void NpyReader::decide(const ReadOptions& options) {
    const ColumnFacts facts = column_facts();
    ReadOptions with_default = options;
    const bool by_place =
        !header_.structured && options.columns.empty() && (facts.columns == 3 || facts.columns == 4);
    if (by_place) {
        with_default.columns = {"time", "velocity", "torque"};
        with_default.every_joint = false;  // there is one
        if (facts.columns == 4) with_default.columns.emplace_back("position");
    }
    layout_ = decide_layout(source_->name(), table_.format, facts, with_default);
    layout_.outside = rows_outside(*source_);
    layout_.contents = table_.contents;
    layout_.warnings.insert(layout_.warnings.begin(), table_.warnings.begin(), table_.warnings.end());
    if (by_place) {
        layout_.warnings.insert(
            layout_.warnings.begin(),
            LogWarning{"columns by place", fmt::format("the {} names no columns: took time, velocity, "
                                                       "torque{} by place; --columns settles it",
                                                       table_.format == "npy" ? "array" : "layout",
                                                       facts.columns == 4 ? ", position" : "")});
    }
    plan_columns(facts.names);
}

void NpyReader::plan_columns(const std::vector<std::string>& names) {
    wanted_ = wanted_columns(layout_);
    // time_at() adds the fraction of a second.
    wanted_.erase(
        std::remove_if(wanted_.begin(), wanted_.end(), [](const auto& one) { return one.fraction; }),
        wanted_.end());
    factors_ = slot_factors(layout_, wanted_);
    before_.assign(factors_.size(), not_a_number);
    for (const WantedColumn& wanted : wanted_) {
        if (header_.fields[wanted.column].kind != '\0') continue;
        raise<DataError>("{}: {} holds no numbers, expected a {}; state which column with --columns",
                         source_->name(), column_label(names, wanted.column),
                         role_name(layout_.columns[wanted.column].role));
    }
}

bool NpyReader::next(RowBlock& block) {
    if (!fetch(block)) return false;
    parse(block);
    accept(block);
    if (block.failure) std::rethrow_exception(block.failure);
    return true;
}

// Moves what was read ahead, no more than `most`: how the log is written may have been looked for in 8 MiB.
std::size_t NpyReader::unload(std::string& bytes, std::size_t most) {
    const std::size_t count = std::min(carry_.size() - carried_, most);
    if (bytes.size() < count) bytes.resize(count);
    std::copy_n(carry_.data() + carried_, count, bytes.data());
    carried_ += count;
    if (carried_ < carry_.size()) return count;
    carry_ = {};
    carried_ = 0;
    return count;
}

// Whole records into block.bytes, the rest into carry_. The block's old bytes and numbers are read over: what
// is made longer is filled first.
bool NpyReader::fetch(RowBlock& block) {
    block.forget_verdict();
    block.joints.resize(1 + layout_.others.size());
    std::string& bytes = block.bytes;
    const std::size_t size = header_.record_size, left = header_.rows - fetched_;
    const std::size_t wanted = std::min(left, std::max<std::size_t>(1, npy_piece / size));
    std::size_t have = unload(bytes, std::max<std::size_t>(1, wanted * size));
    if (left == 0) {
        if (have == 0) have = read_on(*source_, bytes, have, 1);
        if (have > 0) {
            raise<DataError>(
                "{}: read more bytes after the {} rows of the array, expected the end; save one array a file",
                source_->name(), header_.rows);
        }
        block.clear();
        return false;
    }
    if (have < size) have = read_on(*source_, bytes, have, wanted * size);
    const std::size_t rows = std::min(left, have / size);
    if (rows == 0 && endless_) {
        if (have > 0) complain_of_end(have);
        block.clear();
        return false;
    }
    if (rows == 0) {
        raise<DataError>(
            "{}: read {} rows and a part of one, expected {} rows; the file is cut off, save the array again",
            source_->name(), fetched_, header_.rows);
    }
    if (have > rows * size) carry_.assign(bytes, rows * size, have - rows * size);
    bytes.resize(rows * size);
    fetched_ += rows;
    return true;
}

void NpyReader::parse(RowBlock& block) const {
    if (read_columns(block))
        block.parsed_bytes = block.bytes.size();
    else
        block.drop_rows();
}

void NpyReader::accept(RowBlock& block) {
    block.first_row = rows_;
    if (block.parsed_bytes > 0 && continues(block)) {
        count_rows(block);
        return;
    }
    block.drop_rows();
    std::size_t at = 0;
    try {
        for (; at < block.bytes.size(); at += header_.record_size) read_row(block, at);
    } catch (const Error&) {
        block.failure = std::current_exception();
        block.bytes.resize(at);
    }
}

// False where a number is not finite or time runs backward: the careful way has the place and the words.
bool NpyReader::read_columns(RowBlock& block) const {
    const std::size_t rows = block.bytes.size() / header_.record_size;
    for (const WantedColumn& wanted : wanted_) {
        std::vector<double>& numbers = numbers_of(block, wanted.slot);
        numbers.resize(rows);
        if (!read_column(block.bytes.data(), wanted, numbers)) return false;
        if (wanted.slot == time_slot && !std::is_sorted(numbers.begin(), numbers.end())) return false;
        const double factor = factors_[wanted.slot];
        if (factor != 1.0)
            for (double& number : numbers) number *= factor;
    }
    // Columns that the log has not.
    for (std::size_t slot = 0; slot < factors_.size(); ++slot) {
        const bool wanted =
            std::any_of(wanted_.begin(), wanted_.end(), [slot](const auto& one) { return one.slot == slot; });
        if (!wanted && !is_position(slot)) numbers_of(block, slot).resize(rows, not_a_number);
    }
    return true;
}

bool NpyReader::continues(const RowBlock& block) const {
    if (!layout_.chosen.time) return true;
    return !(time_at(block.bytes.data(), layout_) < before_[time_slot]);
}

void NpyReader::count_rows(RowBlock& block) {
    const std::size_t count = block.size();
    if (!layout_.chosen.time && layout_.stated_rate) {
        for (std::size_t i = 0; i < count; ++i)
            block.time_s[i] = static_cast<double>(rows_ + i) / layout_.stated_rate->value();
    }
    const char* const last = block.bytes.data() + (count - 1) * header_.record_size;
    for (const WantedColumn& wanted : wanted_) before_[wanted.slot] = value_at(last, wanted);
    rows_ += count;
}

double NpyReader::read_value(RowBlock& block, const char* record, const WantedColumn& wanted) {
    const double value = value_at(record, wanted);
    const bool time = wanted.slot == time_slot;
    if (time && value < before_[time_slot]) {
        complain(wanted.column, time_backward({before_[time_slot], value, layout_.time_origin}));
    }
    if (is_reading(value)) return value;
    if (std::isnan(value) && hold_bad_values_ && !time && rows_ > 0) {
        ++block.held_bad_values;
        return before_[wanted.slot];
    }
    complain(wanted.column,
             fmt::format("read {}, expected a {}; {}", shortest(value),
                         std::isfinite(value) ? "number from -1e30 to 1e30" : "finite number",
                         std::isnan(value) && !time && !hold_bad_values_
                             ? "remove the row, or use --hold-bad-values to repeat the value before"
                             : "remove the row"));
}

void NpyReader::read_row(RowBlock& block, std::size_t offset) {
    std::vector<double> row = before_;
    for (const WantedColumn& wanted : wanted_)
        row[wanted.slot] = read_value(block, block.bytes.data() + offset, wanted);
    before_ = row;
    for (std::size_t slot = 0; slot < row.size(); ++slot) row[slot] *= factors_[slot];
    if (!layout_.chosen.time && layout_.stated_rate)
        row[time_slot] = static_cast<double>(rows_) / layout_.stated_rate->value();
    for (std::size_t slot = 0; slot < row.size(); ++slot) {
        if (!is_position(slot) || !std::isnan(row[slot])) numbers_of(block, slot).push_back(row[slot]);
    }
    ++rows_;
}

void NpyReader::complain(std::size_t column, const std::string& sentence) const {
    std::vector<std::string> names;
    if (header_.structured) {
        for (const NpyField& field : header_.fields) names.push_back(field.name);
    }
    raise<DataError>("{}: row {}, {}: {}", source_->name(), number_in_file(*source_, rows_ + 1),
                     column_label(names, column), sentence);
}

namespace {

// Arrays that are not stored row by row, turned into such.

// The same array as a file stored row by row, one row a time: from all the bytes of a file whose `header`
// is by_columns or transposed. Throws DataError, beginning with `source`, when bytes are missing.
std::string npy_by_rows(std::string_view file, const NpyHeader& header, const std::string& source) {
    const std::size_t columns = header.fields.size(), size = header.fields.front().size;
    const std::string_view data = file.substr(header.data_offset);
    if (data.size() != header.rows * header.record_size) {
        raise<DataError>(
            "{}: read {} bytes of numbers, expected {}; the file is cut off, save the array again", source,
            data.size(), header.rows * header.record_size);
    }
    std::string rows = make_npy_header(header.descr, header.shape(), false);
    const std::size_t start = rows.size();
    rows += data;
    if (!header.by_columns) return rows;
    for (std::size_t c = 0; c < columns; ++c) {
        copy_numbers({data.data() + c * header.rows * size, size},
                     {rows.data() + start + c * size, columns * size}, size, header.rows);
    }
    return rows;
}

}  // namespace

// The numbers of an array's records: stamps in whole numbers or two fields, the opening's motion; and arrays
// that have to be turned before they have records.

// An array that is not stored row by row cannot be read a row at a time.
void NpyReader::read_whole(std::string& first_bytes) {
    read_up_to(first_bytes, std::numeric_limits<std::size_t>::max());
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

namespace {

// Records of dumps and containers, which have fields as arrays have but no head; and what the first records
// of either say.

// Links to other files, arrays of another length: what the names speak of and the records do not hold.
std::string left_out_of(const std::vector<ContentEntry>& contents) {
    constexpr std::size_t most = 4;
    std::vector<std::string> found;
    for (const ContentEntry& entry : contents) {
        const bool object = entry.type.starts_with("an object");
        if (entry.read || found.size() == most || (names_tell({entry.path}) == 0 && !object)) continue;
        found.push_back(
            fmt::format("{} ({}{}{})", entry.path, entry.shape, entry.shape.empty() ? "" : ", ", entry.type));
    }
    return found.empty() ? std::string() : fmt::format(" and not {}", fmt::join(found, ", "));
}

}  // namespace

NpyReader::NpyReader(std::unique_ptr<ByteSource> records, RecordTable table, const ReadOptions& options)
    : source_(std::move(records)), table_(std::move(table)), hold_bad_values_(options.hold_bad_values) {
    header_.fields = table_.fields;
    header_.structured = table_.named;
    header_.record_size = table_.record_size;
    endless_ = !table_.rows;
    header_.rows = table_.rows.value_or(std::numeric_limits<std::size_t>::max());
    begin_records(options);
    if (auto* const selective = dynamic_cast<RecordSource*>(source_.get());
        selective != nullptr && !options.range.given())
        keep_wanted(*selective);
}

NpyReader::NpyReader(std::unique_ptr<ByteSource> records, const NpyReader& whole, std::size_t rows,
                     const ReadOptions& options)
    : source_(std::move(records)),
      header_(whole.header_),
      table_(whole.table_),
      hold_bad_values_(options.hold_bad_values) {
    header_.rows = rows;
    if (!whole.head_.empty()) head_ = make_npy_header(header_.descr, header_.shape(), false);
    begin_records(options);
}

void NpyReader::begin_records(const ReadOptions& options) {
    // Whole records: of one that was begun, the rest would not fit any more once columns are left out.
    const std::size_t fewest = head_.empty() ? 64 : 1;
    const std::size_t sample = std::max(fewest, npy_sample_bytes / header_.record_size);
    read_up_to(carry_, std::min(header_.rows, sample) * header_.record_size);
    if (carry_.size() < header_.record_size) {
        if (!carry_.empty()) complain_of_end(carry_.size());
        raise<DataError>("{}: read no row, expected rows of numbers; check what wrote it", source_->name());
    }
    ReadOptions settled = options;
    if (!table_.columns.empty()) settled.columns = table_.columns;
    decide(settled);
}

// From here on records hold the wanted fields only, those that were read ahead included.
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
        "{}: read {} rows and {} bytes of one more, expected records of {} bytes; the file is cut off, or "
        "its records differ from its header",
        source_->name(), number_in_file(*source_, fetched_), left_over, header_.record_size);
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
