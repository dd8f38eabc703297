// SPDX-License-Identifier: MIT
#include "ripplenotch/filter/engine.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filter/run/block_pipeline.hpp"
#include "filter/run/stream_pass.hpp"
#include "log/account/account.hpp"
#include "log/opening.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/percent.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

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

std::string per_cent(double share) { return percent_text(100.0 * share) + " %"; }

}  // namespace

void refuse_table_rate(const TableAndLogRate& rates, const std::string& source) {
    const auto [table, log] = rates;
    const double off = std::abs(log / table - 1.0);
    if (off <= rate_refused) return;
    raise<DataError>(
        "{}: the log runs at {:.6g} Hz, the table was designed for {:.6g} Hz, and its notches would be {} "
        "off; design "
        "the table with --sample-rate {:.6g}Hz, or state the log's true rate with --sample-rate",
        source, log.value(), table.value(), per_cent(off), log.value());
}

std::optional<std::string> table_rate_warning(const TableAndLogRate& rates, const std::string& source) {
    const auto [table, log] = rates;
    const double off = std::abs(log / table - 1.0);
    if (off <= rate_worth_a_word) return std::nullopt;
    return fmt::format(
        "{}: the log runs at {:.6g} Hz, the table was designed for {:.6g} Hz: its notches are {} off; design "
        "the table "
        "with --sample-rate {:.6g}Hz to have them right",
        source, log.value(), table.value(), per_cent(off), log.value());
}

std::optional<std::string> compare_table_rate(const TableAndLogRate& rates, const std::string& source) {
    refuse_table_rate(rates, source);
    return table_rate_warning(rates, source);
}

struct LogStream::State {
    std::unique_ptr<LogReader> reader;
    Opening opening;
    Account account;
};

LogStream::LogStream(std::unique_ptr<LogReader> reader, double gap_steps) {
    Opening opening = read_opening(*reader);
    Account account(reader->layout(), opening, gap_steps);
    account.clock().require();
    state_ = std::make_unique<State>(State{std::move(reader), std::move(opening), std::move(account)});
}

LogStream::~LogStream() = default;
LogStream::LogStream(LogStream&&) noexcept = default;

const LogReader& LogStream::reader() const { return *state_->reader; }
Hertz LogStream::design_rate() const { return state_->account.clock().nominal_rate(); }

std::optional<int> LogStream::torque_decimals() const {
    std::optional<int> decimals;
    for (std::size_t b = 0; b < state_->opening.blocks.size(); ++b) {
        const RowBlock& block = state_->opening.blocks[b];
        for (const JointRows& joint : block.joints) {
            const std::size_t count = std::min(state_->opening.counts[b], joint.torque_end.size());
            for (std::size_t k = 0; k < count; ++k) {
                const std::string_view cell =
                    std::string_view(block.bytes)
                        .substr(joint.torque_begin[k], joint.torque_end[k] - joint.torque_begin[k]);
                decimals = std::max(decimals.value_or(0), decimals_of(cell));
            }
        }
    }
    return decimals;
}

StreamReport LogStream::run(CausalFilter& filter, LogWriter* writer, RippleMeter* meter,
                            std::size_t threads) {
    const JointRun joint{&filter, meter};
    return std::move(run(std::span(&joint, 1), writer, threads).front());
}

std::vector<StreamReport> LogStream::run(std::span<const JointRun> joints, LogWriter* writer,
                                         std::size_t threads) {
    LogReader& reader = *state_->reader;
    Opening& opening = state_->opening;
    StreamPass pass(state_->account, joints);
    BlockSteps steps;
    steps.fetch = [&](BlockItem& item) {
        if (opening.blocks.empty()) return reader.fetch(item.block);
        item.block = std::move(opening.blocks.front());
        opening.blocks.pop_front();
        item.accepted = true;
        return true;
    };
    steps.parse = [&](BlockItem& item) { reader.parse(item.block); };
    steps.filter = [&](BlockItem& item) {
        if (!item.accepted) reader.accept(item.block);
        pass.filter(item.block, item.torque_nm);
    };
    steps.prepare = [&](BlockItem& item) {
        if (writer != nullptr) item.bytes = writer->prepare(item.block, item.torque_nm, item.room);
    };
    steps.put = [&](BlockItem& item) {
        if (writer != nullptr) writer->put(item.block, item.torque_nm, item.bytes);
        if (item.block.failure) std::rethrow_exception(item.block.failure);
    };
    run_blocks(steps, opening.whole_log ? 1 : threads);
    if (writer != nullptr) writer->finish();
    return pass.reports(reader.layout());
}

}  // namespace ripplenotch
