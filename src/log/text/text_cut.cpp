// SPDX-License-Identifier: MIT
#include "log/text/text_cut.hpp"

#include <algorithm>
#include <utility>

#include "log/row_cut.hpp"
#include "log/text/csv_reader.hpp"
#include "log/text/text_row.hpp"

namespace ripplenotch {
namespace {

/// A reader of the whole log finds out how it is written and hands on its lines unread.
class TextCut : public ByteSource {
  public:
    TextCut(std::unique_ptr<CsvReader> whole, const ReadOptions& options)
        : ByteSource(Name{whole->layout().source}),
          whole_(std::move(whole)),
          cut_(options, whole_->layout()),
          numbers_(whole_->dialect().data_line - 1),
          row_(whole_->dialect(), time_columns(whole_->layout()),
               stamp_rule(whole_->layout(), whole_->dialect().rules.decimal_mark)),
          kept_(whole_->head()) {
        while (cut_.kept() < 2 && cut_lines()) {
        }
        cut_.require_rows();
    }

    std::size_t read(char* into, std::size_t size) override {
        while (given_ == kept_.size()) {
            kept_.clear();
            given_ = 0;
            if (!cut_lines()) return 0;
        }
        const std::size_t given = kept_.copy(into, size, given_);
        given_ += given;
        return given;
    }
    [[nodiscard]] std::size_t number_in_file(std::size_t number) const override {
        return numbers_.in_file(number);
    }
    [[nodiscard]] const RowCut& rows() const { return cut_; }

  private:
    /// The next lines of the log, those that stay to kept_; false when there are none left.
    bool cut_lines() {
        if (!whole_->fetch(block_)) return false;
        const std::string_view bytes = block_.bytes;
        const char line_end = whole_->dialect().line_end;
        std::size_t staying = 0;  // from here on, up to the line looked at, nothing has been left out
        for (std::size_t begin = 0; begin < bytes.size();) {
            const std::size_t end = std::min(bytes.find(line_end, begin), bytes.size() - 1) + 1;
            // What is longer than any line comes in pieces.
            const bool was_inside = cut_.inside(),
                       whole_line = !std::exchange(unended_, bytes[end - 1] != line_end);
            const bool stays =
                whole_line ? cut_line(bytes.substr(begin, end - begin - (unended_ ? 0 : 1))) : was_inside;
            if (!stays) {
                kept_.append(bytes, staying, begin - staying);
                staying = end;
            }
            begin = end;
        }
        kept_.append(bytes, staying, bytes.size() - staying);
        return true;
    }

    bool cut_line(std::string_view line) {
        line = line_content(line);
        bool stays = cut_.inside();
        if (is_row(line)) stays = cut_.keeps(time_);
        numbers_.add(stays);
        return stays;
    }

    /// Leaves its time in time_, if it can be read.
    bool is_row(std::string_view line) {
        const Layout& layout = whole_->layout();
        time_.reset();
        if (row_.parse(line)) {
            time_ = row_.value(time_slot);
            if (layout.time_as_text && !std::exchange(stamped_, true))
                cut_.first_stamp(clock_text(row_.cell(line, *layout.chosen.time)));
            return true;
        }
        return !is_blank_line(line) && !is_comment_line(line) && line != "EOF";
    }

    std::unique_ptr<CsvReader> whole_;
    RowCut cut_;
    KeptNumbers numbers_;
    TextRow row_;
    RowBlock block_;
    std::string kept_;
    std::size_t given_ = 0;  ///< of kept_
    std::optional<double> time_;
    bool stamped_ = false;  ///< the first row has been seen
    bool unended_ = false;  ///< the bytes before ended within a line
};

}  // namespace

LogCut cut_text(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    auto whole = std::make_unique<CsvReader>(std::move(source), std::move(first_bytes), clock_only(options));
    Layout layout = whole->layout();
    auto bytes = std::make_unique<TextCut>(std::move(whole), options);
    auto outside = bytes->rows().outside();
    return {std::move(bytes), std::move(layout), std::move(outside)};
}

}  // namespace ripplenotch
