// SPDX-License-Identifier: MIT
// Text logs: comma, semicolon, tab or blanks between cells, in every dialect that docs/formats/csv.md lists.

#include <array>

#include "log/csv_reader.hpp"
#include "log/csv_writer.hpp"
#include "log/formats.hpp"
#include "log/table_writer.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 5> extensions = {".csv", ".txt", ".tsv", ".dat", ".log"};

// Any text may be a text log; what is not text has its own magic bytes or a zero byte near its start.
bool sniff(std::string_view first_bytes) {
    return !first_bytes.empty() && first_bytes.find('\0') == std::string_view::npos &&
           static_cast<unsigned char>(first_bytes[0]) != 0x93 &&
           static_cast<unsigned char>(first_bytes[0]) != 0x89;
}

void append_rows(std::string& text, std::span<const std::span<const double>> columns, std::size_t first,
                 std::size_t last, const WriteOptions& options) {
    for (std::size_t row = first; row < last; ++row) {
        for (std::size_t c = 0; c < columns.size(); ++c) {
            if (c > 0) text += ',';
            if (options.decimals == WriteOptions::Decimals::fixed) {
                append_fixed(text, columns[c][row], options.fixed_decimals);
            } else {
                append_shortest(text, columns[c][row]);
            }
        }
        text += '\n';
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
        text_.clear();
        append_rows(text_, columns, 0, columns.empty() ? 0 : columns[0].size(), options_);
        sink_.write(text_);
    }
    void end() override {}

  private:
    ByteSink& sink_;
    WriteOptions options_;
    std::string text_;
};

}  // namespace

const LogFormat formats::csv{
    .name = "csv",
    .summary = "text: comma, semicolon, tab or blanks, with or without header",
    .extensions = extensions,
    .binary = false,
    .sniff = sniff,
    .open = open_with<CsvReader>,
    .rewrite = rewrite_with<CsvWriter, CsvReader>,
    .convert = convert_with<CsvTableWriter>,
    .write_columns = write_columns_with<CsvTableWriter>,
};

}  // namespace ripplenotch
