// SPDX-License-Identifier: MIT
// Text logs: comma, semicolon, tab or blanks between cells, in every dialect that docs/formats/csv.md lists.

#include <algorithm>
#include <array>
#include <vector>

#include "log/formats.hpp"
#include "log/table_writer.hpp"
#include "log/text/csv_reader.hpp"
#include "log/text/csv_writer.hpp"
#include "log/text/own_clocks.hpp"
#include "log/text/text_dialect.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 5> extensions = {".csv", ".txt", ".tsv", ".dat", ".log"};

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
    CsvTableWriter(ByteSink& sink, const WriteOptions& options) : sink_(sink), options_(options) {}
    void begin(std::span<const std::string> names) override {
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

std::unique_ptr<LogReader> open_text(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                     const ReadOptions& options) {
    if (options.skip_lines == 0 && may_be_long(first_bytes))
        return open_long(std::move(source), std::move(first_bytes), options);
    return open_table(std::move(source), std::move(first_bytes), options);
}

// Reshaped rows, and channels that were joined by time, are none of the file that could be written again.
std::unique_ptr<LogWriter> rewrite(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                   const WriteOptions& options) {
    const bool rows = dynamic_cast<const CsvReader*>(&reader.base()) != nullptr;
    return rows ? rewrite_with<CsvWriter, CsvReader>(std::move(sink), reader, options)
                : convert_with<CsvTableWriter>(std::move(sink), reader, options);
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
    .convert = convert_with<CsvTableWriter>,
    .write_columns = write_columns_with<CsvTableWriter>,
};

}  // namespace ripplenotch
