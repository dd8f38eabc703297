// SPDX-License-Identifier: MIT
#include "ripplenotch/filter/engine.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filter/block_pipeline.hpp"
#include "filter/stream_pass.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr double nominal_tolerance = 0.001;
constexpr std::size_t most_read_ahead_bytes = std::size_t{8}
                                              << 20;  // wide logs: fewer rows, still a second or so

double two_digits(double value) {
    const double scale = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
    // Dividing by a whole power of ten is exact where multiplying by a fraction is not: 0.001 s must give
    // 1000 Hz.
    return scale < 1.0 ? std::round(value / scale) / std::round(1.0 / scale)
                       : std::round(value / scale) * scale;
}

bool near(double a, double b) { return std::abs(a - b) <= nominal_tolerance * b; }

// Digits after the decimal mark of a number as it is written in a log.
int decimals_of(std::string_view number) {
    // Character by character: a cell is shorter than what a search for one of two takes to begin.
    std::size_t mark = 0;
    while (mark < number.size() && number[mark] != '.' && number[mark] != ',') ++mark;
    if (mark == number.size()) return 0;
    std::size_t at = mark + 1;
    while (at < number.size() && number[at] >= '0' && number[at] <= '9') ++at;
    return static_cast<int>(std::min<std::size_t>(at - mark - 1, 17));
}

std::string per_cent(double share) { return fmt::format("{:.2g} %", 100.0 * share); }

}  // namespace

Hertz nominal_rate(Hertz measured) {
    const double rate = measured.value();
    if (!(rate > 0.0) || !std::isfinite(rate)) return measured;
    if (const double round_rate = two_digits(rate); near(rate, round_rate)) return Hertz(round_rate);
    if (const double period = two_digits(1.0 / rate); near(rate, 1.0 / period)) {
        const double by_period = 1.0 / period;
        // 1 / 0.008 is 125 but for rounding.
        return Hertz(std::abs(by_period - std::round(by_period)) < 1e-9 * by_period ? std::round(by_period)
                                                                                    : by_period);
    }
    return measured;
}

void refuse_table_rate(Hertz table, Hertz log, const std::string& source) {
    const double off = std::abs(log / table - 1.0);
    if (off <= rate_refused) return;
    raise<DataError>(
        "{}: the log runs at {:.6g} Hz, the table was designed for {:.6g} Hz, and its notches would be {} "
        "off; design "
        "the table with --sample-rate {:.6g}Hz, or state the log's true rate with --sample-rate",
        source, log.value(), table.value(), per_cent(off), log.value());
}

std::optional<std::string> table_rate_warning(Hertz table, Hertz log, const std::string& source) {
    const double off = std::abs(log / table - 1.0);
    if (off <= rate_worth_a_word) return std::nullopt;
    return fmt::format(
        "{}: the log runs at {:.6g} Hz, the table was designed for {:.6g} Hz: its notches are {} off; design "
        "the table "
        "with --sample-rate {:.6g}Hz to have them right",
        source, log.value(), table.value(), per_cent(off), log.value());
}

std::optional<std::string> compare_table_rate(Hertz table, Hertz log, const std::string& source) {
    refuse_table_rate(table, log, source);
    return table_rate_warning(table, log, source);
}

LogStream::LogStream(std::unique_ptr<LogReader> reader, double gap_steps) : reader_(std::move(reader)) {
    const std::vector<double> head = read_head();
    if (head.size() < 2) {
        raise<DataError>(
            "{}: read {} of data, expected at least two, which tell the sample rate; check what wrote it",
            reader_->layout().source, head.size() == 0 ? "no row" : "one row");
    }
    measure_clock(head, gap_steps);
}

// Which rows count as first depends on the log alone, not on how its bytes arrived: a pipe and a file must
// give the same coefficients.
std::vector<double> LogStream::read_head() {
    std::vector<double> head;
    std::size_t bytes = 0;
    moving_deg_s_.assign(1 + reader_->layout().others.size(), 0.0);
    while (head.size() < clock_rows && bytes < most_read_ahead_bytes) {
        RowBlock block;
        if (!reader_->next(block)) {
            read_whole_ = true;
            break;
        }
        std::size_t count = 0;
        while (count < block.size() && head.size() + count < clock_rows &&
               (count >= block.row_end.size() || bytes + block.row_end[count] < most_read_ahead_bytes)) {
            ++count;
        }
        head.insert(head.end(), block.time_s.begin(),
                    block.time_s.begin() + static_cast<std::ptrdiff_t>(count));
        note_head(block, count);
        bytes += block.bytes.size();
        read_ahead_.push_back(std::move(block));
    }
    return head;
}

void LogStream::note_head(const RowBlock& block, std::size_t count) {
    for (std::size_t j = 0; j < block.joints.size(); ++j) {
        const JointRows& joint = block.joints[j];
        for (std::size_t k = 0; k < count; ++k)
            moving_deg_s_[j] = std::max(moving_deg_s_[j], 0.02 * std::abs(joint.velocity_deg_s[k]));
        for (std::size_t k = 0; k < std::min(count, joint.torque_end.size()); ++k) {
            const std::string_view cell =
                std::string_view(block.bytes)
                    .substr(joint.torque_begin[k], joint.torque_end[k] - joint.torque_begin[k]);
            torque_decimals_ = std::max(torque_decimals_.value_or(0), decimals_of(cell));
        }
    }
}

void LogStream::measure_clock(const std::vector<double>& head_s, double gap_steps) {
    const std::string& source = reader_->layout().source;
    if (const auto stated = reader_->layout().stated_rate) {
        measured_rate_ = design_rate_ = *stated;
        gap_s_ = gap_steps / stated->value();
        return;
    }
    if (!std::all_of(head_s.begin(), head_s.end(), [](double t) { return std::isfinite(t); })) {
        raise<DataError>("{}: no column of time; state the rate of its rows, for example --sample-rate 1kHz",
                         source);
    }
    const Timebase clock = examine_steps(head_s, gap_steps);
    if (!(clock.median_step.value() > 0.0) || !(clock.sample_rate.value() > 0.0)) {
        raise<DataError>(
            "{}: time does not advance from row to row (median step {} s in the first {} rows); state the "
            "rate of "
            "its rows, for example --sample-rate 1kHz, or name the right column with --columns time=NAME",
            source, shortest(clock.median_step.value()), head_s.size());
    }
    measured_rate_ = clock.sample_rate;
    design_rate_ = nominal_rate(measured_rate_);
    gap_s_ = gap_steps * clock.median_step.value();
}

StreamReport LogStream::run(CausalFilter& filter, LogWriter* writer, RippleMeter* meter,
                            std::size_t threads) {
    const JointRun joint{&filter, meter};
    return std::move(run(std::span(&joint, 1), writer, threads).front());
}

std::vector<StreamReport> LogStream::run(std::span<const JointRun> joints, LogWriter* writer,
                                         std::size_t threads) {
    StreamPass pass(reader_->layout().source, gap_s_, joints, moving_deg_s_);
    BlockSteps steps;
    steps.fetch = [&](BlockItem& item) {
        if (read_ahead_.empty()) return reader_->fetch(item.block);
        item.block = std::move(read_ahead_.front());
        read_ahead_.pop_front();
        item.accepted = true;
        return true;
    };
    steps.parse = [&](BlockItem& item) { reader_->parse(item.block); };
    steps.filter = [&](BlockItem& item) {
        if (!item.accepted) reader_->accept(item.block);
        pass.take(item.block, item.torque_nm);
    };
    steps.prepare = [&](BlockItem& item) {
        if (writer != nullptr) item.bytes = writer->prepare(item.block, item.torque_nm, item.room);
    };
    steps.put = [&](BlockItem& item) {
        if (writer != nullptr) writer->put(item.block, item.torque_nm, item.bytes);
        if (item.block.failure) std::rethrow_exception(item.block.failure);
    };
    run_blocks(steps, read_whole_ ? 1 : threads);
    if (writer != nullptr) writer->finish();
    return pass.reports();
}

}  // namespace ripplenotch
