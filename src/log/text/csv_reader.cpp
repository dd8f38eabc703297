// SPDX-License-Identifier: MIT
#include "log/text/csv_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "log/clock/stamp.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t csv_piece = std::size_t{1} << 17;
constexpr std::size_t sniff_size = std::size_t{1} << 16;

std::size_t line_ends(std::string_view bytes) {
    return static_cast<std::size_t>(std::ranges::count(bytes, '\n'));
}

// The careful way through a row of a text log, for what the quick ways are not sure of: quoted and empty
// cells, junk, rows that are cut off. It finds the place and the words for what is wrong.

std::string shown_cell(std::string_view text) {
    return text.size() <= 40 ? std::string(text) : std::string(text.substr(0, 37)) + "...";
}

}  // namespace

TextOpening::TextOpening(std::unique_ptr<ByteSource> from, std::string first_bytes,
                         const ReadOptions& options)
    : source(std::move(from)), bytes(std::move(first_bytes)) {
    ended = read_on(*source, bytes, sniff_size);
    // Lines may be long: a verdict on them needs a few whole ones.
    for (std::size_t size = 2 * sniff_size; !ended && line_ends(bytes) < 8 && size <= 8 * longest_line;
         size *= 2)
        ended = read_on(*source, bytes, size);
    dialect = sniff_text(bytes, ended, *source, options);
}

std::string TextOpening::whole() {
    while (!ended) ended = read_on(*source, bytes, 2 * bytes.size());
    return std::move(bytes);
}

CsvReader::CsvReader(TextOpening opening, const ReadOptions& options)
    : source_(std::move(opening.source)),
      options_(options),
      dialect_(std::move(opening.dialect)),
      source_ended_(opening.ended) {
    decide(opening.bytes);
    head_ = opening.bytes.substr(0, dialect_.data_offset);
    carry_ = std::move(opening.bytes);
    carry_.erase(0, dialect_.data_offset);
    line_ = dialect_.data_line;
    before_ = row_ = ParsedRow(1 + layout_.others.size());
    const std::vector<WantedColumn> wanted = wanted_columns(layout_);
    parser_.emplace(RowPlan{dialect_.rules, dialect_.columns, wanted, slot_factors(layout_, wanted),
                            stamp_rule(layout_, dialect_.rules.decimal_mark)});
}

// `opening` may be read on while the layout is decided.
void CsvReader::decide(std::string& opening) {
    dialect_.motion_sample = [this, &opening](const Layout& layout, const std::vector<std::size_t>& columns,
                                              std::size_t bytes) {
        if (!source_ended_ && opening.size() < bytes) source_ended_ = read_on(*source_, opening, bytes);
        MotionSample sample = text_motion_sample(std::string_view(opening).substr(dialect_.data_offset),
                                                 dialect_, layout, columns);
        sample.whole = source_ended_;
        return sample;
    };
    layout_ = decide_layout(source_->name(), "csv", dialect_, options_);
    dialect_.motion_sample = nullptr;
    dialect_.sample.clear();
    layout_.change_all([&](Layout& layout) {
        layout.outside = rows_outside(*source_);
        if (dialect_.head_lines == 0) return;
        const bool scope = !dialect_.scales.empty();
        layout.infer(
            fmt::format("the first {} lines", dialect_.head_lines),
            scope ? "the head of a TwinCAT Scope export, with its names and units"
                  : "a head, passed on and not read",
            scope ? "'Name' stands over numbers that run forward, which are times, and over each channel"
                  : "they are no rows, and the names do not stand in the first of them",
            fmt::format("--skip-lines {}", dialect_.head_lines));
    });
}

bool CsvReader::next(RowBlock& block) {
    if (!fetch(block)) {
        if (rows_ == 0) raise<DataError>("{}: read no row, expected rows of numbers", source_->name());
        return false;
    }
    parse(block);
    accept(block);
    if (block.failure) std::rethrow_exception(block.failure);
    return true;
}

// Whole lines into block.bytes, the rest into carry_. The block's own bytes, of lines long gone, are read
// over: a string that is made longer is filled first.
bool CsvReader::fetch(RowBlock& block) {
    std::string bytes = std::move(block.bytes);
    block.clear();
    block.joints.resize(1 + layout_.others.size());
    std::size_t have = carry_.size();
    if (bytes.size() < have) bytes.resize(have);
    std::copy(carry_.begin(), carry_.end(), bytes.begin());
    carry_.clear();
    const auto whole_lines = [&] {
        return std::string_view(bytes.data(), have).rfind('\n') + 1;  // npos + 1 is 0
    };
    std::size_t lines = whole_lines();
    for (; lines == 0 && !at_end_ && have <= longest_line; lines = whole_lines()) {
        if (!source_ended_ && bytes.size() < have + csv_piece) bytes.resize(have + csv_piece);
        const std::size_t got = source_ended_ ? 0 : source_->read(bytes.data() + have, csv_piece);
        at_end_ = got == 0;
        have += got;
    }
    if (lines > 0) carry_.assign(bytes, lines, have - lines);
    bytes.resize(lines > 0 ? lines : have);
    block.bytes = std::move(bytes);
    return !block.bytes.empty();  // a line that is too long is accept()'s, which has its number
}

// Rows whose times are sums are taken one by one.
void CsvReader::parse(RowBlock& block) const {
    if (!layout_.time_is_steps) block.parsed_bytes = parser_->read(block, 0, not_a_number);
}

void CsvReader::accept(RowBlock& block) {
    block.first_row = rows_;
    if (!continues(block)) block.drop_rows();
    note_quick_rows(block, 0);
    std::size_t begin = block.parsed_bytes;
    try {
        while (begin < block.bytes.size()) begin = accept_from(block, begin);
    } catch (const Error&) {
        block.failure = std::current_exception();
        block.bytes.resize(begin);
    }
}

// The line at `begin`, and what can be taken at once behind it; returns where the next line begins.
std::size_t CsvReader::accept_from(RowBlock& block, std::size_t begin) {
    const std::size_t found = block.bytes.find('\n', begin);
    last_line_complete_ = found != std::string::npos;
    const std::size_t end = last_line_complete_ ? found : block.bytes.size();
    if (end - begin > longest_line) {
        raise<DataError>(
            "{}:{}: read a line of more than 1 MiB, expected rows of {} cells; check that this is a text log",
            source_->name(), line_in_file(), dialect_.columns);
    }
    const bool row = accept_line(block, begin, end);
    bytes_without_row_ = row ? 0 : bytes_without_row_ + end - begin;
    ++line_;
    const std::size_t next = std::min(end + 1, block.bytes.size());
    if (bytes_without_row_ > longest_line) {
        raise<DataError>(
            "{}:{}: read more than 1 MiB without a row, expected rows of numbers; remove the comments",
            source_->name(), line_in_file());
    }
    // A row that needed care is seldom alone.
    if (!plain_row_ || end_mark_seen_ || layout_.time_is_steps || next == block.bytes.size()) return next;
    const std::size_t before = block.size();
    const std::size_t taken = parser_->read(block, next, before_.values[time_slot]);
    note_quick_rows(block, before);
    return taken;
}

// True when the rows that were parsed on their own may follow those before. Where not, the careful way finds
// the place and the words.
bool CsvReader::continues(const RowBlock& block) const {
    if (block.size() == 0) return true;
    if (end_mark_seen_) return false;
    if (!layout_.chosen.time) return true;
    ParsedRow first(block.joints.size());
    static_cast<void>(parser_->parse(std::string_view(block.bytes).substr(0, block.row_end[0]), first));
    return !(first.values[time_slot] < before_.values[time_slot]);
}

// What the next line, and messages about it, need to know of rows that were taken at once.
void CsvReader::note_quick_rows(RowBlock& block, std::size_t before) {
    const std::size_t count = block.size() - before;
    if (count == 0) return;
    if (!layout_.chosen.time && layout_.stated_rate) {
        for (std::size_t i = 0; i < count; ++i)
            block.time_s[before + i] = static_cast<double>(rows_ + i) / layout_.stated_rate->value();
    }
    rows_ += count;
    line_ += count;
    bytes_without_row_ = 0;
    const std::string_view bytes(block.bytes.data(), block.row_end.back());
    const std::size_t line_end = bytes.rfind('\n');
    if (parser_->parse(bytes.substr(line_end == std::string_view::npos ? 0 : line_end + 1), row_))
        std::swap(before_, row_);
}

// False for a comment, a blank line and the end mark.
bool CsvReader::accept_line(RowBlock& block, std::size_t begin, std::size_t end) {
    const char* const base = block.bytes.data();
    if (end > begin && base[end - 1] == '\r') --end;
    const std::string_view line(base + begin, end - begin);
    plain_row_ = parser_->parse(line, row_);
    if (!plain_row_) {
        if (is_no_row(line)) {
            refuse_controls(line);
            end_mark_seen_ |= line == "EOF";
            return false;
        }
        parse_carefully(line, block, row_);
    }
    if (end_mark_seen_)
        complain(1,
                 "read a row after the line EOF, expected the end; remove the line EOF or what follows it");
    append_row(block, row_);
    const auto place = [base](const char* at) { return static_cast<std::uint32_t>(at - base); };
    for (std::size_t j = 0; j < block.joints.size(); ++j) {
        const auto& [torque_begin, torque_end] = before_.torques[j];
        block.joints[j].torque_begin.push_back(place(torque_begin == nullptr ? line.data() : torque_begin));
        block.joints[j].torque_end.push_back(place(torque_begin == nullptr ? line.data() : torque_end));
    }
    block.row_end.push_back(place(before_.content_end));
    return true;
}

void CsvReader::append_row(RowBlock& block, ParsedRow& row) {
    if (layout_.time_is_steps) {
        if (row.values[time_slot] < 0.0)
            complain(1, fmt::format("read the time step {}, expected none below 0; correct or remove the "
                                    "line, or use --sample-rate",
                                    shortest(row.values[time_slot])));
        row.values[time_slot] = rows_ == 0 ? 0.0 : before_.values[time_slot] + row.values[time_slot];
    }
    const double time = row.values[time_slot], before = before_.values[time_slot];
    if (layout_.chosen.time && time < before) {
        complain(1, time_backward(before, time, layout_.time_origin));
    }
    if (layout_.chosen.time)
        block.time_s.push_back(time * parser_->plan().factors[time_slot]);
    else
        block.time_s.push_back(layout_.stated_rate ? static_cast<double>(rows_) / layout_.stated_rate->value()
                                                   : not_a_number);
    const RowPlan& plan = parser_->plan();
    for (std::size_t slot = velocity_slot; slot < plan.factors.size(); ++slot)
        if (plan.stores(slot)) numbers_of(block, slot).push_back(row.values[slot] * plan.factors[slot]);
    std::swap(before_, row);
    ++rows_;
}

void CsvReader::refuse_controls(std::string_view line) const {
    const auto* const found = std::ranges::find_if(line, is_control);
    if (found == line.end()) return;
    complain(static_cast<std::size_t>(found - line.begin()) + 1,
             fmt::format("read the byte 0x{:02x}, expected text; the file is damaged here, remove the line",
                         static_cast<unsigned>(static_cast<unsigned char>(*found))));
}

void CsvReader::parse_carefully(std::string_view line, RowBlock& block, ParsedRow& row) {
    split_cells(line, dialect_.rules.delimiter, split_);
    const auto& cells = split_.cells;
    if (split_.unclosed) {
        complain(cells.back().begin,
                 "read a quote that is not closed on its line, expected its end; correct or remove the line");
    }
    refuse_controls(line);
    if (cells.size() != dialect_.columns) {
        const bool cut = !last_line_complete_ && cells.size() < dialect_.columns;
        complain(cells.empty() ? 1 : cells.back().end + 1,
                 fmt::format("read {} cells, expected {}; {}", cells.size(), dialect_.columns,
                             cut ? "the last line is cut off: remove it, e.g. with head -n -1"
                                 : "correct or remove the line"));
    }
    static_cast<void>(parser_->parse_cells(
        line, split_, row, [&](const Cell& cell, const WantedColumn& wanted, std::optional<double> number) {
            return other_number(line, cell, wanted, number, block);
        }));
}

double CsvReader::other_number(std::string_view line, const Cell& cell, const WantedColumn& wanted,
                               std::optional<double> number, RowBlock& block) {
    const std::string_view text = cell.of(line);
    const std::size_t slot = wanted.slot;
    const std::string name = column_label(dialect_.names, wanted.column);
    // "NA", "null" and the like are texts; only what is empty or a nan of arithmetic counts as a missing
    // value.
    const bool missing = text.empty() || (number && std::isnan(*number));
    if (missing && options_.hold_bad_values && slot != time_slot && rows_ > 0) {
        ++block.held_bad_values;
        return before_.values[slot];
    }
    std::string remedy = "correct or remove the line";
    if (missing && slot != time_slot) {
        remedy = options_.hold_bad_values
                     ? "the first row has no value before it: remove the line"
                     : "correct the line, or use --hold-bad-values to repeat the value before";
    } else if (!number && dialect_.rules.delimiter != ',' &&
               text.find(dialect_.rules.decimal_mark == '.' ? ',' : '.') != std::string_view::npos) {
        remedy = fmt::format("correct the line, or use --decimal {}",
                             dialect_.rules.decimal_mark == '.' ? ',' : '.');
    }
    complain(cell.begin + 1,
             fmt::format("read {} in {}, expected a {}; {}",
                         text.empty() ? std::string("nothing") : "'" + shown_cell(text) + "'", name,
                         (slot == time_slot && !wanted.fraction && parser_->plan().stamp.text) ||
                                 (slot == time_slot && text.find(':') != std::string_view::npos)
                             ? fmt::format("time of day or a date and time such as {}", stamp_forms)
                         : number && std::isfinite(*number) ? "number from -1e30 to 1e30"
                         : number                           ? "finite number"
                                                            : "number",
                         remedy));
}

void CsvReader::complain(std::size_t column, const std::string& sentence) const {
    raise<DataError>("{}:{}:{}: {}", source_->name(), line_in_file(), column, sentence);
}

}  // namespace ripplenotch
