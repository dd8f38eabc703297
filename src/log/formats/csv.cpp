// SPDX-License-Identifier: MIT
// Text logs: comma, semicolon, tab or blanks between cells, in every dialect that docs/formats/csv.md lists.

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "log/open.hpp"
#include "log/text/csv_reader.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 5> extensions = {".csv", ".txt", ".tsv", ".dat", ".log"};

/// How numbers are written: with fixed decimals, or the fewest digits that read back.
struct CellText {
    WriteOptions::Decimals rule = WriteOptions::Decimals::shortest;
    int decimals = 6;  ///< where they are fixed
    char decimal_mark = '.';

    /// Numbers printed between two looks at the room for them, which each may need number_room bytes of.
    static constexpr std::size_t at_once = 256;

    /// There is room for number_room bytes at `into`. Returns the text's end.
    char* put(char* into, double value) const {
        char* const end = rule == WriteOptions::Decimals::fixed ? put_fixed(into, value, decimals)
                                                                : put_shortest(into, value);
        if (decimal_mark != '.') std::replace(into, end, '.', decimal_mark);
        return end;
    }
};

/// Text put together piece by piece in a string that is used again and again.
class TextRoom {
  public:
    /// Keeps what `room` holds of size: making a string longer fills it, which takes as long as the text.
    TextRoom(std::string& room, std::size_t expected) : room_(room) {
        if (room_.size() < expected) room_.resize(expected);
    }

    /// Room for so many bytes at what it returns, the end of what has been written.
    [[nodiscard]] char* ensure(std::size_t size) {
        if (used_ + size > room_.size()) room_.resize(2 * (used_ + size));
        return room_.data() + used_;
    }
    /// What has been written ends here.
    void written_until(const char* end) { used_ = static_cast<std::size_t>(end - room_.data()); }
    [[nodiscard]] std::string_view text() const { return {room_.data(), used_}; }

  private:
    std::string& room_;
    std::size_t used_ = 0;
};

/// How the rows of a log are written anew.
struct RewritePlan {
    CellRules rules;
    CellText cells;
    std::vector<std::size_t> joints;  ///< in the order in which their numbers stand in a row
    std::vector<double> factors;      ///< by joint: newton-metres in one unit of its torque column
};

/// Copies of pieces of one text, one behind the other. Most pieces are short, and copying a fixed number of
/// bytes is one instruction or two, so where it can it copies more than a piece: there must be room for
/// `over` bytes behind it.
class PieceCopier {
  public:
    static constexpr std::size_t over = 32;

    explicit PieceCopier(std::string_view text)
        : text_(text.data()), short_until_(text.size() < over ? 0 : text.size() - over + 1) {}
    /// The bytes from where it is, until `to`; returns the end of the copy.
    char* copy_until(std::size_t to, char* into) {
        const std::size_t size = to - done_;
        const char* const from = text_ + done_;
        if (size <= over && done_ < short_until_) [[likely]]
            std::memcpy(into, from, over);
        else
            std::memcpy(into, from, size);
        done_ = to;
        return into + size;
    }
    /// Goes on behind what stands before `to`.
    void skip_until(std::size_t to) { done_ = to; }
    [[nodiscard]] std::size_t done() const { return done_; }

  private:
    const char* text_;
    std::size_t short_until_;  ///< from there on a short piece would reach behind the text
    std::size_t done_ = 0;
};

/// Some rows at a time, so that there is never room for more than some of the longest numbers.
class RowRewriter {
  public:
    RowRewriter(const RewritePlan& plan, const RowBlock& block, Torques torque_nm, TextRoom& room)
        : plan_(plan), block_(block), room_(room), pieces_(block.bytes) {
        for (const std::size_t j : plan.joints) {
            const JointRows& joint = block.joints[j];
            columns_.push_back({torque_nm[j].data(), joint.torque_nm.data(), joint.torque_begin.data(),
                                joint.torque_end.data(), plan.factors[j]});
        }
    }

    /// Numbers in the places of the torques.
    void replace() {
        stretch_by_stretch([this](Stretch rows, char* into) { return replace_in(rows, into); });
    }
    /// Numbers in new cells behind the rows.
    void append() {
        stretch_by_stretch([this](Stretch rows, char* into) { return append_to(rows, into); });
    }

  private:
    struct Column {
        const double *torque_nm, *torque_before_nm;
        const std::uint32_t *begin, *end;
        double factor;
    };
    struct Stretch {
        std::size_t first, end;
    };
    static constexpr std::size_t cell_room = number_room + 3;  // with a delimiter and quotes

    template <typename Rewrite>
    void stretch_by_stretch(const Rewrite& rewrite) {
        const std::size_t rows_at_once =
            std::max<std::size_t>(CellText::at_once / std::max<std::size_t>(columns_.size(), 1), 1);
        for (std::size_t first = 0; first < block_.size(); first += rows_at_once) {
            const Stretch rows = {first, std::min(first + rows_at_once, block_.size())};
            const std::size_t between = block_.row_end[rows.end - 1] - pieces_.done();
            const std::size_t numbers = (rows.end - rows.first) * columns_.size() * cell_room;
            room_.written_until(rewrite(rows, room_.ensure(between + numbers + PieceCopier::over)));
        }
        const std::size_t size = block_.bytes.size();
        char* const into = room_.ensure(size - pieces_.done() + PieceCopier::over);
        room_.written_until(pieces_.copy_until(size, into));
    }

    char* replace_in(Stretch rows, char* into) {
        // What is written could be anything in memory, for all the compiler knows: local copies, for which it
        // does not have to fear.
        PieceCopier pieces = pieces_;
        // Cells whose bad values were replaced do not hold what the block's torque says.
        const bool keeps_unchanged =
            plan_.cells.rule == WriteOptions::Decimals::shortest && block_.held_bad_values == 0;
        const CellText cells = plan_.cells;
        const auto replace_one = [&](const Column& column, std::size_t row) {
            if (keeps_unchanged && column.torque_nm[row] == column.torque_before_nm[row]) return;
            into = pieces.copy_until(column.begin[row], into);
            into = cells.put(into, column.torque_nm[row] / column.factor);
            pieces.skip_until(column.end[row]);
        };
        if (columns_.size() == 1) {
            const Column only = columns_.front();
            for (std::size_t row = rows.first; row < rows.end; ++row) replace_one(only, row);
        } else {
            for (std::size_t row = rows.first; row < rows.end; ++row)
                for (const Column& column : columns_) replace_one(column, row);
        }
        pieces_ = pieces;
        return into;
    }

    char* append_to(Stretch rows, char* into) {
        const char delimiter = plan_.rules.delimiter;
        const bool quoted = delimiter == ',' && plan_.rules.decimal_mark == ',';
        for (std::size_t row = rows.first; row < rows.end; ++row) {
            into = pieces_.copy_until(block_.row_end[row], into);
            for (const Column& column : columns_) {
                *into++ = delimiter;
                if (quoted) *into++ = '"';
                into = plan_.cells.put(into, column.torque_nm[row] / column.factor);
                if (quoted) *into++ = '"';
            }
        }
        return into;
    }

    const RewritePlan& plan_;
    const RowBlock& block_;
    TextRoom& room_;
    PieceCopier pieces_;
    std::vector<Column> columns_;
};

/// The rows of a text log with other torque values: everything else passes byte for byte.
class CsvWriter final : public LogWriter {
  public:
    CsvWriter(std::unique_ptr<ByteSink> sink, const CsvReader& reader, const WriteOptions& options)
        : sink_(std::move(sink)), options_(options) {
        plan_.rules = reader.dialect().rules;
        plan_.cells = {options.decimals, options.fixed_decimals, plan_.rules.decimal_mark};
        std::vector<std::size_t> columns;
        for (const JointColumns& joint : reader.layout().all_chosen()) {
            if (!joint.torque)
                raise<UsageError>("{}: there is no torque column to write", reader.layout().source);
            plan_.joints.push_back(columns.size());
            columns.push_back(*joint.torque);
            plan_.factors.push_back(reader.layout().columns[*joint.torque].factor);
        }
        // Appended columns stand in the order of the joints.
        if (!options.append)
            std::ranges::sort(plan_.joints,
                              [&](std::size_t a, std::size_t b) { return columns[a] < columns[b]; });
        sink_->expect(reader.source_bytes());
        write_head(reader);
    }
    std::string_view prepare(RowBlock& block, Torques torque_nm, std::string& room) const override {
        TextRoom text(room, block.bytes.size() + 16 * block.size() * plan_.joints.size());
        RowRewriter rows(plan_, block, torque_nm, text);
        if (options_.append)
            rows.append();
        else
            rows.replace();
        return text.text();
    }
    void put(const RowBlock& /*block*/, Torques /*torque_nm*/, std::string_view bytes) override {
        sink_->write(bytes);
    }
    void finish() override { sink_->finish(); }

  private:
    void write_head(const CsvReader& reader) {
        const std::string_view head = reader.head();
        const TextDialect& dialect = reader.dialect();
        if (!options_.append || !dialect.has_header) {
            sink_->write(head);
            return;
        }
        std::string changed(head.substr(0, dialect.header_end));
        changed += names_appended(reader);
        std::size_t done = dialect.header_end;
        if (dialect.unit_row_end > 0) {
            changed.append(head, done, dialect.unit_row_end - done);
            changed += units_appended(reader);
            done = dialect.unit_row_end;
        }
        changed.append(head, done);
        sink_->write(changed);
    }
    std::string names_appended(const CsvReader& reader) const {
        std::string text;
        for (std::string& name : appended_names(reader.layout(), options_)) {
            if (reader.dialect().quoted_names || name.find(plan_.rules.delimiter) != std::string::npos)
                name = '"' + name + '"';
            text += plan_.rules.delimiter + name;
        }
        return text;
    }
    std::string units_appended(const CsvReader& reader) const {
        const TextDialect& dialect = reader.dialect();
        const std::string_view head = reader.head();
        std::string text;
        for (const JointColumns& joint : reader.layout().all_chosen()) {
            std::string unit = dialect.units[*joint.torque];
            // The unit row's own brackets are copied from the torque's cell.
            const std::size_t at = head.find(unit, dialect.header_end);
            if (at != std::string::npos && at > 0 && (head[at - 1] == '[' || head[at - 1] == '('))
                unit = head[at - 1] + unit + (head[at - 1] == '[' ? ']' : ')');
            text += plan_.rules.delimiter + unit;
        }
        return text;
    }

    std::unique_ptr<ByteSink> sink_;
    WriteOptions options_;
    RewritePlan plan_;
};

/// Some rows at a time, so that there is never room for more than some of the longest numbers.
void write_cells(TextRoom& room, std::span<const std::span<const double>> columns, const CellText& cells) {
    const std::size_t rows = columns.empty() ? 0 : columns[0].size();
    const std::size_t at_once =
        std::max<std::size_t>(CellText::at_once / std::max<std::size_t>(columns.size(), 1), 1);
    for (std::size_t first = 0; first < rows; first += at_once) {
        const std::size_t count = std::min(at_once, rows - first);
        char* into = room.ensure(count * columns.size() * (number_room + 1));
        for (std::size_t row = first; row < first + count; ++row) {
            for (const std::span<const double> column : columns) {
                into = cells.put(into, column[row]);
                *into++ = ',';
            }
            into[-1] = '\n';
        }
        room.written_until(into);
    }
}

class CsvTableWriter : public TableWriter {
  public:
    CsvTableWriter(ByteSink& sink, std::span<const std::string> names, const WriteOptions& options)
        : sink_(sink), options_(options) {
        std::string text;
        for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
        sink_.write(text + '\n');
    }
    void rows(std::span<const std::span<const double>> columns) override {
        TextRoom room(text_, 0);
        write_cells(room, columns, {options_.decimals, options_.fixed_decimals});
        sink_.write(room.text());
    }
    void end() override {}

  private:
    ByteSink& sink_;
    WriteOptions options_;
    std::string text_;
};

// Reshaped rows, and channels that were joined by time, are none of the file that could be written again.
std::unique_ptr<LogWriter> rewrite(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                   const WriteOptions& options) {
    const bool rows = dynamic_cast<const CsvReader*>(&reader.base()) != nullptr;
    return rows ? rewrite_with<CsvWriter, CsvReader>(std::move(sink), reader, options)
                : convert_rows(std::move(sink), reader, options, formats::csv);
}

}  // namespace

const LogFormat formats::csv{
    .name = "csv",
    .summary = "text: comma, semicolon, tab or blanks, with or without header",
    .extensions = extensions,
    .binary = false,
    .sniff = nullptr,  // any text may be a text log
    .open = open_text,
    .rewrite = rewrite,
    .table = table_of<CsvTableWriter>,
};

}  // namespace ripplenotch
