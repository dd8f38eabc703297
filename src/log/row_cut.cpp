// SPDX-License-Identifier: MIT
#include "log/row_cut.hpp"

#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "core/process/memory.hpp"
#include "log/npy/npy_reader.hpp"
#include "log/text/csv_reader.hpp"
#include "log/text/text_dialect.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

void Unmapped::operator()(double* numbers) const { ::munmap(numbers, bytes); }

std::span<const double> KeptParts::kept(std::span<const double> numbers) {
    if (room_ == nullptr) {
        const std::size_t bytes = most_numbers_ * sizeof(double);
        void* const mapped = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (mapped == MAP_FAILED) throw std::bad_alloc();
        ask_for_large_pages(mapped, bytes);
        room_ = std::unique_ptr<double, Unmapped>(static_cast<double*>(mapped), Unmapped{bytes});
    }
    double* const to = room_.get() + used_;
    std::copy(numbers.begin(), numbers.end(), to);
    used_ += numbers.size();
    return {to, numbers.size()};
}

namespace {

constexpr std::size_t fewest_rows = 2;  // a log of one row has no rate

// Stamps in ms times 0.001 are not always the nearest numbers to what people type in seconds.
double slack(double time_s, double bound_s) {
    constexpr double some_ulps = 4.0 * std::numeric_limits<double>::epsilon();
    return some_ulps * std::max(std::abs(time_s), std::abs(bound_s));
}

}  // namespace

RowCut::RowCut(const ReadOptions& options, const Layout& whole)
    : source_(whole.source), range_(options.range) {
    if (whole.stated_rate) {
        rate_hz_ = whole.stated_rate->value();
    } else if (whole.chosen.time) {
        factor_ = whole.columns[*whole.chosen.time].factor;
        axis_.origin_s = whole.time_origin;
    } else {
        raise<DataError>("{}: {}: no column is the time; say --columns time=NAME, or --sample-rate 1kHz",
                         source_, asked());
    }
}

bool RowCut::keeps(std::optional<double> time) {
    if (rate_hz_) time = static_cast<double>(rows_) / *rate_hz_;
    ++rows_;
    if (time) {
        const double time_s = rate_hz_ ? *time : *time * factor_;
        if (!first_s_) begin(time_s);
        last_s_ = time_s;
        place_ = place_of(time_s);
        if (rate_hz_ && kept_ == 0 && inside()) outside_->zero_s = time_s;
    }
    if (inside())
        ++kept_;
    else
        ++(place_ == Place::before ? outside_->before : outside_->after);
    return inside();
}

RowCut::Place RowCut::place_of(double time_s) const {
    if (range_.from && time_s < from_s_ - slack(time_s, from_s_)) return Place::before;
    if (range_.to && time_s > to_s_ + slack(time_s, to_s_)) return Place::after;
    return Place::inside;
}

void RowCut::begin(double first_s) {
    first_s_ = first_s;
    const auto bound = [&](const std::optional<TimePoint>& point, std::string_view option, double& bound_s) {
        if (!point) return std::optional<double>();
        const std::string label = fmt::format("{}: {}", source_, option);
        bound_s = on_axis(*point, axis_, label);
        if (bound_s < 0.0 && first_s >= 0.0)
            raise<UsageError>("{} {} is below 0 s, and the log begins at {} s; write a time from there on",
                              label, point->text, shortest(first_s));
        return std::optional<double>(bound_s);
    };
    outside_->from_s = bound(range_.from, "--from", from_s_);
    outside_->to_s = bound(range_.to, "--to", to_s_);
    if (from_s_ > to_s_)
        raise<UsageError>("{}: {}: the range ends at {} s, before it begins at {} s; swap the two", source_,
                          asked(), shortest(to_s_), shortest(from_s_));
}

std::string RowCut::asked() const {
    const auto words = [](const std::optional<TimePoint>& point, std::string_view option) {
        return point ? fmt::format("{} {}", option, point->text) : std::string();
    };
    const std::string from = words(range_.from, "--from"), to = words(range_.to, "--to");
    return from + (from.empty() || to.empty() ? "" : " ") + to;
}

void RowCut::require_rows() const {
    if (kept_ >= fewest_rows) return;
    const std::string what = kept_ == 0 ? "no row" : "one row only";
    if (!first_s_)
        raise<DataError>("{}: {} keeps {}: no row has a time; check the time column", source_, asked(), what);
    raise<UsageError>("{}: {} keeps {}: the log covers {} s to {} s in {} rows; ask for two of them or more",
                      source_, asked(), what, shortest(*first_s_), shortest(last_s_), rows_);
}

ReadOptions clock_only(ReadOptions options) {
    options.joint.reset();
    options.every_joint = false;
    options.needs_torque = false;
    return options;
}

std::string range_in_words(const RowsOutside& outside) {
    std::string words = "only rows";
    if (outside.from_s) words += fmt::format(" from {} s", shortest(*outside.from_s));
    if (outside.to_s) words += fmt::format(" to {} s", shortest(*outside.to_s));
    if (outside.zero_s != 0.0) words += fmt::format("; times count from {} s", shortest(outside.zero_s));
    return words;
}

void KeptNumbers::add(bool kept) {
    ++seen_;
    if (!kept) return;
    const std::size_t left_out = seen_ - ++kept_;
    const std::size_t before = holes_.empty() ? 0 : holes_.back().left_out;
    if (left_out == before) return;
    const std::lock_guard lock(mutex_);
    holes_.push_back({kept_ - 1, left_out});
}

std::size_t KeptNumbers::in_file(std::size_t number) const {
    const std::lock_guard lock(mutex_);
    for (auto hole = holes_.rbegin(); hole != holes_.rend(); ++hole) {
        if (number > hole->kept) return number + hole->left_out;
    }
    return number;
}

KeptRows::KeptRows(NpyReader& whole, const ReadOptions& options) : cut_(options, whole.layout()) {
    const std::size_t size = whole.header().record_size;
    const bool timed = whole.layout().chosen.time.has_value();
    RowBlock block;
    while (whole.fetch(block)) {
        const std::string_view bytes = block.bytes;
        for (std::size_t at = 0; at < bytes.size(); at += size) {
            std::optional<double> time;
            if (timed) time = whole.time_of(bytes.data() + at);
            const bool stays = cut_.keeps(time && std::isfinite(*time) ? time : std::nullopt);
            numbers_.add(stays);
            if (stays) bytes_.put(bytes.substr(at, size));
        }
    }
    cut_.require_rows();
    bytes_.rewind();
}

namespace {

class NpyCut : public ByteSource {
  public:
    NpyCut(NpyReader& whole, const ReadOptions& options)
        : ByteSource(Name{whole.layout().source}), rows_(whole, options) {
        const NpyHeader& header = whole.header();
        const std::size_t kept = rows_.cut().kept();
        const std::string shape =
            header.structured ? fmt::format("{},", kept) : fmt::format("{}, {}", kept, header.fields.size());
        head_ = make_npy_header(header.descr, shape, false);
    }

    std::size_t read(char* into, std::size_t size) override {
        if (given_ == head_.size()) return rows_.read(into, size);
        const std::size_t taken = head_.copy(into, size, given_);
        given_ += taken;
        return taken;
    }
    [[nodiscard]] std::size_t number_in_file(std::size_t number) const override {
        return rows_.number_in_file(number);
    }
    [[nodiscard]] const RowCut& cut() const { return rows_.cut(); }

  private:
    KeptRows rows_;
    std::string head_;
    std::size_t given_ = 0;  ///< of head_
};

}  // namespace

LogCut cut_npy(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    NpyReader whole(std::move(source), std::move(first_bytes), clock_only(options));
    auto bytes = std::make_unique<NpyCut>(whole, options);
    auto outside = bytes->cut().outside();
    return {std::move(bytes), whole.layout(), std::move(outside)};
}

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
