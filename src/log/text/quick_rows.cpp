// SPDX-License-Identifier: MIT
#include "log/text/quick_rows.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "core/text/number.hpp"
#include "core/vectors/bytes.hpp"
#include "core/vectors/lanes.hpp"
#include "log/text/row_edges.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

namespace {

bool all_careful = false;

// Reads [-]digits[.digits] with at most 15 digits: mantissa and power of ten are then both exact doubles, so
// one division rounds correctly (W. D. Clinger, How to read floating point numbers accurately, 1990). Null
// when the text is anything else.
const char* read_short_decimal(const char* at, const char* end, char decimal_mark, double& value) {
    const bool negative = at < end && *at == '-';
    if (negative) ++at;
    const char* const first = at;
    std::uint64_t mantissa = 0;
    while (at < end && static_cast<unsigned char>(*at - '0') < 10)
        mantissa = mantissa * 10 + static_cast<std::uint64_t>(*at++ - '0');
    std::ptrdiff_t digits = at - first, decimals = 0;
    if (at < end && *at == decimal_mark) {
        const char* const fraction = ++at;
        while (at < end && static_cast<unsigned char>(*at - '0') < 10)
            mantissa = mantissa * 10 + static_cast<std::uint64_t>(*at++ - '0');
        decimals = at - fraction;
        digits += decimals;
    }
    if (digits == 0 || digits > 15) return nullptr;
    const double magnitude =
        static_cast<double>(mantissa) / powers_of_ten[static_cast<std::size_t>(decimals)];
    value = negative ? -magnitude : magnitude;
    return at;
}

// A cell that nobody reads is passed on as it is, but for what no text has.
bool needs_care(char c) { return c == '"' || is_control(c); }

// A part of a time.
double part(double number, const WantedColumn& wanted) {
    return wanted.fraction ? seconds_per_nanosecond * number : number;
}

/// Writes rows behind those that the block has. They are put together in a place of their own and then
/// appended: making the block's vectors longer first would fill them for nothing.
class RowSink {
  public:
    RowSink(RowBlock& block, std::size_t begin, const RowPlan& plan)
        : block_(block), plan_(plan), numbers_(plan.factors.size()), places_(2 * plan.joints() + 1) {
        block.joints.resize(plan.joints());
        // As many rows as the first one's length lets expect, and some.
        const std::size_t left = block.bytes.size() - begin;
        const std::size_t length = std::min(block.bytes.find('\n', begin), block.bytes.size()) - begin;
        reserve(block.size() + left / (length + 1) + left / (16 * (length + 1)) + 16);
    }

    /// Until commit(), numbers() and the places may be used for so many rows.
    void make_room(std::size_t rows) {
        if (rows <= room_) return;
        room_ = rows;
        for (auto& numbers : numbers_) numbers.resize(rows, std::numeric_limits<double>::quiet_NaN());
        for (auto& places : places_) places.resize(rows);
    }
    /// The numbers of the rows in the making, as in the file.
    [[nodiscard]] double* numbers(std::size_t slot) { return numbers_[slot].data(); }
    /// Offsets from the block's first byte.
    [[nodiscard]] std::uint32_t* torque_begins(std::size_t joint) { return places_[2 * joint].data(); }
    [[nodiscard]] std::uint32_t* torque_ends(std::size_t joint) { return places_[2 * joint + 1].data(); }
    [[nodiscard]] std::uint32_t* row_ends() { return places_.back().data(); }
    /// A whole row, whose line begins at offset `begin` of the block's bytes, which begin at `text`.
    void set(std::size_t row, const ParsedRow& parsed, std::size_t begin, const char* text) {
        for (const WantedColumn& wanted : plan_.wanted)
            numbers(wanted.slot)[row] = parsed.values[wanted.slot];
        const auto offset = [&](const char* at) {
            return static_cast<std::uint32_t>(at == nullptr ? begin : static_cast<std::size_t>(at - text));
        };
        for (std::size_t joint = 0; joint < parsed.torques.size(); ++joint) {
            torque_begins(joint)[row] = offset(parsed.torques[joint].begin);
            torque_ends(joint)[row] = offset(parsed.torques[joint].end);
        }
        row_ends()[row] = offset(parsed.content_end);
    }
    /// Turns the numbers of the first `rows` into the tool's units and appends them.
    void commit(std::size_t rows) {
        for (std::size_t slot = 0; slot < plan_.factors.size(); ++slot) {
            if (!plan_.stores(slot)) continue;
            double* const first = numbers(slot);
            const double factor = plan_.factors[slot];
            if (factor != 1.0) std::for_each_n(first, rows, [factor](double& value) { value *= factor; });
            append(numbers_of(block_, slot), numbers_[slot], rows);
        }
        for (std::size_t joint = 0; joint < block_.joints.size(); ++joint) {
            append(block_.joints[joint].torque_begin, places_[2 * joint], rows);
            append(block_.joints[joint].torque_end, places_[2 * joint + 1], rows);
        }
        append(block_.row_end, places_.back(), rows);
    }

  private:
    template <typename T>
    static void append(std::vector<T>& to, const std::vector<T>& from, std::size_t rows) {
        to.insert(to.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(rows));
    }
    void reserve(std::size_t size) {
        if (block_.time_s.capacity() >= size) return;
        for (std::size_t slot = 0; slot < plan_.factors.size(); ++slot)
            if (plan_.stores(slot)) numbers_of(block_, slot).reserve(size);
        for (JointRows& joint : block_.joints) {
            joint.torque_begin.reserve(size);
            joint.torque_end.reserve(size);
        }
        block_.row_end.reserve(size);
    }

    RowBlock& block_;
    const RowPlan& plan_;
    std::vector<std::vector<double>> numbers_;        ///< by slot
    std::vector<std::vector<std::uint32_t>> places_;  ///< of the torques by joint, then of the rows' ends
    std::size_t room_ = 0;
};

#if defined(RIPPLENOTCH_BYTE_VECTORS)

// Rows by vector instructions, stretch by stretch: find the delimiters, 64 bytes at a time; see how many rows
// have them where they belong; read these rows column by column; let the parser of rows have the few that the
// vectors are not sure of.

constexpr std::size_t vector_head_bytes = 512;
constexpr std::size_t bytes_before = 33;  // of a cell's end that the vectors load

/// One stretch on its way into a block.
class Stretch {
  public:
    Stretch(RowSink& sink, const RowParser& parser)
        : sink_(sink), plan_(parser.plan()), parser_(parser), parsed_(plan_.joints()) {}

    /// Takes the rows of bytes[begin, ...) and returns where it stopped; `begin` itself when it took none.
    std::size_t read(std::string_view bytes, std::size_t begin, double& time_before) {
        begin_ = begin;
        text_ = bytes.data() + begin;
        std::size_t regular = 0;
        // A little at first: where every other row needs care, there is a stretch for each of them.
        for (; regular == 0 && reach_ <= stretch_bytes; reach_ *= 4) {
            find_edges(text_, std::min(reach_, bytes.size() - begin), plan_.rules.delimiter, edges_);
            regular = regular_rows(text_, edges_, plan_.rules.delimiter, plan_.columns);
        }
        reach_ = std::min(reach_, stretch_bytes);
        if (regular == 0) return begin;
        sink_.make_room(regular);
        std::fill_n(odd_.begin(), regular, std::uint8_t{0});
        if (edges_.returns) find_row_ends(regular);
        read_columns(regular);
        note_places(regular);
        std::size_t rows = any_odd_ ? mend(regular) : regular;
        if (plan_.column_of(time_slot)) rows = forward_rows(rows, time_before);
        sink_.commit(rows);
        return begin + static_cast<std::size_t>(edge(rows * plan_.columns) + 1);
    }

  private:
    [[nodiscard]] std::int32_t edge(std::size_t number) const { return edges_.place[number]; }
    [[nodiscard]] std::size_t row_begin(std::size_t row) const {
        return static_cast<std::size_t>(edge(row * plan_.columns) + 1);
    }
    [[nodiscard]] std::size_t row_end(std::size_t row) const {
        return static_cast<std::size_t>(edges_.returns ? row_ends_[row] : edge((row + 1) * plan_.columns));
    }
    /// Where carriage returns stand before line ends, these are apart from the edges.
    void find_row_ends(std::size_t rows) {
        for (std::size_t row = 0; row < rows; ++row) {
            const std::int32_t end = edge((row + 1) * plan_.columns);
            const bool has_return = end > static_cast<std::int32_t>(row_begin(row)) && text_[end - 1] == '\r';
            row_ends_[row] = end - (has_return ? 1 : 0);
        }
    }

    void read_columns(std::size_t rows) {
        any_odd_ = false;
        // What stands before the block must not be looked at.
        std::size_t unread = 0;
        while (unread < rows && begin_ + row_begin(unread) < bytes_before) {
            odd_[unread++] = 1;
            any_odd_ = true;
        }
        const bool lanes_hold_all =
            longest_cell(edges_.place.data(), rows * plan_.columns) <= static_cast<std::int32_t>(lane_bytes);
        if (plan_.wanted.empty() || plan_.wanted.front().column != 0) doubt_unread_openings(unread, rows);
        for (const WantedColumn& wanted : plan_.wanted) {
            const bool apart = edges_.returns && wanted.column + 1 == plan_.columns;
            const std::int32_t* const before = edges_.place.data() + unread * plan_.columns + wanted.column;
            const CellColumn cells{text_,
                                   before,
                                   apart ? row_ends_.data() + unread : before + 1,
                                   plan_.columns,
                                   apart ? 1 : plan_.columns,
                                   rows - unread,
                                   plan_.rules.decimal_mark,
                                   lanes_hold_all && !apart};
            double* const numbers = sink_.numbers(wanted.slot) + unread;
            if (read_cells(cells, numbers, odd_.data() + unread)) any_odd_ = true;
        }
    }

    /// Comments, blank lines and the end mark have as many cells as they like where the first is not read.
    void doubt_unread_openings(std::size_t from, std::size_t rows) {
        for (std::size_t row = from; row < rows; ++row) {
            const char first = text_[row_begin(row)];
            const bool sure = static_cast<unsigned char>(first - '0') < 10 || first == '-';
            odd_[row] |= sure ? 0 : 1;
            any_odd_ |= !sure;
        }
    }

    void note_places(std::size_t rows) {
        const auto shift = static_cast<std::uint32_t>(begin_);
        std::uint32_t* const ends = sink_.row_ends();
        for (std::size_t row = 0; row < rows; ++row)
            ends[row] = shift + static_cast<std::uint32_t>(row_end(row));
        for (std::size_t joint = 0; joint < plan_.joints(); ++joint) {
            const auto torque = plan_.column_of(slot_of(torque_slot, joint));
            const std::int32_t* before = edges_.place.data() + torque.value_or(0);
            const bool last = torque && *torque + 1 == plan_.columns;
            std::uint32_t *const from = sink_.torque_begins(joint), *const to = sink_.torque_ends(joint);
            for (std::size_t row = 0; row < rows; ++row, before += plan_.columns) {
                from[row] = shift + static_cast<std::uint32_t>(before[0] + 1);
                if (!last) to[row] = torque ? shift + static_cast<std::uint32_t>(before[1]) : from[row];
            }
            if (last) std::copy_n(ends, rows, to);
        }
    }

    /// Reads the odd rows again, the slow way; returns how many rows there are before the first that is not
    /// certainly right.
    std::size_t mend(std::size_t rows) {
        for (std::size_t row = 0; row < rows; ++row) {
            if (odd_[row] == 0) continue;
            if (!parser_.parse({text_ + row_begin(row), text_ + row_end(row)}, parsed_)) return row;
            sink_.set(row, parsed_, begin_ + row_begin(row), text_ - begin_);
        }
        return rows;
    }

    /// How many rows there are before one whose time is before the one above it.
    std::size_t forward_rows(std::size_t rows, double& time_before) const {
        const double* const time = sink_.numbers(time_slot);
        if (rows == 0 || time[0] < time_before) return 0;
        std::size_t row = 1;
        while (row < rows && !(time[row] < time[row - 1])) ++row;
        time_before = time[row - 1];
        return row;
    }

    RowSink& sink_;
    const RowPlan& plan_;
    const RowParser& parser_;
    ParsedRow parsed_;
    const char* text_ = nullptr;
    std::size_t begin_ = 0, reach_ = vector_head_bytes;
    bool any_odd_ = false;
    Edges edges_;
    std::array<std::int32_t, stretch_bytes> row_ends_;  ///< offsets from text_
    std::array<std::uint8_t, stretch_bytes> odd_;
};

// As RowParser::read, where there are wide vectors and for rows whose delimiter is one character. `parser`
// reads rows with cells that the vectors cannot: longer than 32 characters, with an exponent, padded with
// blanks.
std::size_t read_rows_by_vectors(RowBlock& block, std::size_t begin, double time_before,
                                 const RowParser& parser) {
    const std::string_view bytes = block.bytes;
    RowSink sink(block, begin, parser.plan());
    Stretch stretch(sink, parser);
    while (begin < bytes.size()) {
        const std::size_t from = begin;
        begin = stretch.read(bytes, begin, time_before);
        if (begin == from) break;  // an irregular row, or one longer than the stretch
    }
    return begin;
}

#else

std::size_t read_rows_by_vectors(RowBlock&, std::size_t begin, double, const RowParser&) { return begin; }

#endif

}  // namespace

std::vector<WantedColumn> time_columns(const Layout& layout) {
    std::vector<WantedColumn> wanted;
    if (layout.chosen.time) wanted.push_back({*layout.chosen.time, time_slot});
    if (layout.time_fraction) wanted.push_back({*layout.time_fraction, time_slot, true});
    return wanted;
}

std::vector<WantedColumn> wanted_columns(const Layout& layout) {
    std::vector<WantedColumn> wanted = time_columns(layout);
    const auto want = [&wanted](std::optional<std::size_t> column, std::size_t slot) {
        if (column) wanted.push_back({*column, slot});
    };
    const std::vector<JointColumns> joints = layout.all_chosen();
    for (std::size_t j = 0; j < joints.size(); ++j) {
        want(joints[j].velocity, slot_of(velocity_slot, j));
        want(joints[j].torque, slot_of(torque_slot, j));
        want(joints[j].position, slot_of(position_slot, j));
    }
    return wanted;
}

StampRule stamp_rule(const Layout& layout, char decimal_mark) {
    const bool careful = layout.time_fraction || layout.time_as_text || layout.time_origin != 0;
    return {careful, layout.time_as_text, layout.time_origin, decimal_mark, layout.stamp_form};
}

std::vector<double> slot_factors(const Layout& layout, const std::vector<WantedColumn>& wanted) {
    std::vector<double> factors(slot_count(1 + layout.others.size()), 1.0);
    for (const WantedColumn& one : wanted) {
        if (!one.fraction) factors[one.slot] = layout.columns[one.column].factor;
    }
    return factors;
}

std::optional<CellNumber> RowParser::number(std::string_view text, const WantedColumn& wanted) const {
    if (!in_parts(wanted) || wanted.fraction) return plan_.rules.number(text, wanted.column);
    const auto time = read_stamp(text, plan_.stamp);
    return time ? std::optional(CellNumber{*time, text.size(), {}}) : std::nullopt;
}

bool RowParser::parse_cells(std::string_view line, const CellSplit& split, ParsedRow& row,
                            const Other& other) const {
    row.values[time_slot] = nothing_yet;
    for (const WantedColumn& wanted : plan_.wanted) {
        const Cell& cell = split.cells[wanted.column];
        const auto read = number(cell.of(line), wanted);
        std::optional<double> value = read ? std::optional(read->value) : std::nullopt;
        if (!value || !is_reading(*value)) value = other(cell, wanted, value);
        if (!value) return false;
        if (wanted.slot == time_slot)
            row.values[time_slot] += part(*value, wanted);
        else
            row.values[wanted.slot] = *value;
        if (is_torque(wanted.slot)) {
            const char* const begin = line.data() + cell.begin;
            row.torques[joint_of(wanted.slot)] = {begin, read ? begin + read->size : line.data() + cell.end};
        }
    }
    const Cell& last = split.cells.back();
    row.content_end = line.data() + last.end + (last.quoted ? 1 : 0);
    return true;
}

bool RowParser::parse_any(std::string_view line, ParsedRow& row, CellSplit& split, const Other& other) const {
    if (parse(line, row)) return true;
    split_cells(line, plan_.rules.delimiter, split);
    return split.cells.size() == plan_.columns && parse_cells(line, split, row, other);
}

bool RowParser::parse(std::string_view line, ParsedRow& row) const {
    const bool first_is_read = !plan_.wanted.empty() && plan_.wanted.front().column == 0;
    if (careful_ || (!first_is_read && is_no_row(line))) return false;
    const char *at = line.data(), *end = at + line.size();
    const char delimiter = plan_.rules.delimiter;
    const bool runs = delimiter == ' ';
    if (runs) {
        while (at < end && is_blank(*at)) ++at;
        while (end > at && is_blank(end[-1])) --end;
    }
    std::size_t column = 0;
    if (plan_.stamp.careful) row.values[time_slot] = nothing_yet;
    const auto at_cell_end = [&](const char* p) {
        return p == end || *p == delimiter || (runs && *p == '\t');
    };
    for (auto wanted = plan_.wanted.begin();; ++column) {
        if (wanted != plan_.wanted.end() && wanted->column == column) {
            while (!runs && at < end && *at == ' ' && delimiter != '\t') ++at;
            double& value = row.values[wanted->slot];
            ParsedRow::Place place{at, nullptr};
            const bool stamp = in_parts(*wanted);
            const char* stop = stamp ? nullptr : read_short_decimal(at, end, plan_.rules.decimal_mark, value);
            if (stop == nullptr || !at_cell_end(stop)) {
                stop = at;
                while (!at_cell_end(stop)) ++stop;
                const char* content = stop;
                while (content > at && is_blank(content[-1])) --content;
                const auto read = number({at, static_cast<std::size_t>(content - at)}, *wanted);
                if (!read || !is_reading(read->value)) return false;
                value = stamp ? value + part(read->value, *wanted) : read->value;
                place.end = at + read->size;
            } else {
                place.end = stop;
            }
            if (is_torque(wanted->slot)) row.torques[joint_of(wanted->slot)] = place;
            at = stop;
            ++wanted;
        } else {
            while (!at_cell_end(at)) {
                if (needs_care(*at)) return false;
                ++at;
            }
        }
        if (at == end) break;
        ++at;
        while (runs && at < end && is_blank(*at)) ++at;
    }
    row.content_end = end;
    return column + 1 == plan_.columns;
}

CarefulRows::CarefulRows() noexcept : before_(all_careful) { all_careful = true; }

CarefulRows::~CarefulRows() { all_careful = before_; }

RowParser::RowParser(RowPlan plan)
    : plan_(std::move(plan)),
      careful_(all_careful),
      vectorised_(wide_vectors() && !plan_.stamp.careful && plan_.rules.delimiter != ' ' &&
                  plan_.columns > 0) {
    std::ranges::sort(plan_.wanted, {}, &WantedColumn::column);
}

std::size_t RowParser::read(RowBlock& block, std::size_t begin, double time_before) const {
    if (careful_) return begin;
    return vectorised_ ? read_rows_by_vectors(block, begin, time_before, *this)
                       : read_by_lines(block, begin, time_before);
}

std::size_t RowParser::read_by_lines(RowBlock& block, std::size_t begin, double time_before) const {
    const char* const text = block.bytes.data();
    const std::size_t size = block.bytes.size();
    constexpr std::size_t rows_at_once = 128;
    std::size_t rows = 0;
    RowSink sink(block, begin, plan_);
    sink.make_room(rows_at_once);
    ParsedRow row(plan_.joints());
    const bool timed = plan_.column_of(time_slot).has_value();
    while (begin < size) {
        const auto* const found = static_cast<const char*>(std::memchr(text + begin, '\n', size - begin));
        if (found == nullptr) break;
        const char* end = found;
        if (end > text + begin && end[-1] == '\r') --end;
        if (!parse({text + begin, end}, row)) break;
        if (timed && row.values[time_slot] < time_before) break;
        time_before = row.values[time_slot];
        sink.set(rows++, row, begin, text);
        if (rows == rows_at_once) {
            sink.commit(rows);
            rows = 0;
        }
        begin = static_cast<std::size_t>(found - text) + 1;
    }
    sink.commit(rows);
    return begin;
}

}  // namespace ripplenotch
