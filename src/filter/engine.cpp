// SPDX-License-Identifier: MIT
#include "ripplenotch/filter/engine.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/rows/row_facts.hpp"
#include "filter/block_pipeline.hpp"
#include "filter/method.hpp"
#include "log/account/account.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

// Internal to the filter module: blocks of rows, one after another, through the filters of their joints.

/// The state of one pass over a log.
class StreamPass {
  public:
    StreamPass(Account& account, std::span<const JointRun> joints);

    /// Filters the block's joints into `torque_nm`. Throws DataError when time runs backward.
    void filter(const RowBlock& block, std::vector<std::vector<double>>& torque_nm);

    /// By joint, after the last block; `layout` as it stands then.
    [[nodiscard]] std::vector<StreamReport> reports(const Layout& layout) const;

  private:
    struct Lane {
        JointRun run;
        StreamReport report{};
        std::size_t rows = 0, rows_left_out = 0;
        JointsPosition position{};
        std::vector<double> torque_nm{};  ///< less the ripple of other joints
    };

    /// `other_ripple_nm`: at the block's rows; empty where no map of other motors is given.
    void filter_part(const RowBlock& block, std::size_t joint, const RunPart& part,
                     std::span<const double> other_ripple_nm, std::vector<double>& torque_nm);
    /// `first`: the place of the rows in the log.
    static void keep_rows(const TraceView& rows, std::size_t first, bool begins_run,
                          std::span<const double> torque_nm, KeptRows& kept);
    static void note_switches(const RowBlock& block, Lane& lane);
    static void note_motion(const JointRows& rows, Lane& lane);

    Account& account_;
    std::vector<Lane> lanes_;
};

StreamPass::StreamPass(Account& account, std::span<const JointRun> joints) : account_(account) {
    for (const JointRun& run : joints) lanes_.push_back({run});
}

void StreamPass::filter(const RowBlock& block, std::vector<std::vector<double>>& torque_nm) {
    torque_nm.resize(lanes_.size());
    const std::span<const RunPart> parts = account_.add(block);
    for (std::size_t j = 0; j < lanes_.size(); ++j) {
        Lane& lane = lanes_[j];
        note_motion(block.joints[j], lane);
        torque_nm[j].resize(block.size());
        std::span<const double> other_ripple_nm;
        if (lane.run.other_ripple != nullptr) other_ripple_nm = lane.run.other_ripple->next(block.size());
        for (const RunPart& part : parts) filter_part(block, j, part, other_ripple_nm, torque_nm[j]);
        lane.rows += block.size();
        lane.report.held_bad_values += block.held_bad_values;
    }
}

void StreamPass::filter_part(const RowBlock& block, std::size_t joint, const RunPart& part,
                             std::span<const double> other_ripple_nm, std::vector<double>& torque_nm) {
    Lane& lane = lanes_[joint];
    TraceView rows = view_of(block, joint, part.first, part.count);
    const std::span<double> out = std::span(torque_nm).subspan(part.first, part.count);
    if (!part.usable) {
        std::copy(rows.torque_nm.begin(), rows.torque_nm.end(), out.begin());
        lane.rows_left_out += part.count;
        return;
    }
    rows.position_deg = lane.position.of(account_.angle(joint), rows);
    if (part.begins_run && lane.rows + part.first > lane.rows_left_out) lane.run.filter->restart();
    std::span<const double> torque = rows.torque_nm;
    if (!other_ripple_nm.empty()) {
        lane.torque_nm.assign(torque.begin(), torque.end());
        for (std::size_t k = 0; k < part.count; ++k) lane.torque_nm[k] -= other_ripple_nm[part.first + k];
        torque = lane.torque_nm;
    }
    lane.run.filter->process({rows.velocity_deg_s, torque, rows.position_deg}, out);
    note_switches(block, lane);
    if (lane.run.kept != nullptr)
        keep_rows(rows, lane.rows + part.first, part.begins_run, out, *lane.run.kept);
}

// Stretches 0, 1, 3, 7, 15, ...: all of a short log.
bool in_measured_stretch(std::size_t row) {
    constexpr std::size_t stretch = 8192;  // chosen, not derived: several turns of a motor at most rates
    return std::has_single_bit(row / stretch + 1);
}

void StreamPass::keep_rows(const TraceView& rows, std::size_t first, bool begins_run,
                           std::span<const double> torque_nm, KeptRows& kept) {
    Trace& trace = kept.trace;
    kept.rows += rows.size();
    kept.breaks = kept.breaks || begins_run;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (trace.size() == most_rows_kept) return;
        if (kept.sparsely && !in_measured_stretch(first + k)) {
            kept.breaks = true;
            continue;
        }
        if (kept.breaks && trace.size() > 0) trace.run_starts.push_back(trace.size());
        kept.breaks = false;
        if (rows.has_position() && trace.position_deg.size() == trace.size())
            trace.position_deg.push_back(rows.position_deg[k]);
        else
            trace.position_deg.clear();
        trace.time_s.push_back(rows.time_s[k]);
        trace.velocity_deg_s.push_back(rows.velocity_deg_s[k]);
        trace.torque_nm.push_back(rows.torque_nm[k]);
        kept.out_nm.push_back(torque_nm[k]);
    }
}

// A filter counts the rows it was given; people count those of the log.
void StreamPass::note_switches(const RowBlock& block, Lane& lane) {
    const auto switches = lane.run.filter->switches();
    std::vector<TimedSwitch>& listed = lane.report.switches;
    for (std::size_t i = listed.size(); i < switches.size(); ++i) {
        Switch change = switches[i];
        change.sample += lane.rows_left_out;
        listed.push_back({change, block.time_s[change.sample - lane.rows]});
    }
}

void StreamPass::note_motion(const JointRows& rows, Lane& lane) {
    StreamReport& report = lane.report;
    SpeedExtent range{report.slowest_deg_s, report.fastest_deg_s};
    if (lane.rows == 0 && !rows.velocity_deg_s.empty())
        range.slowest_deg_s = range.fastest_deg_s = std::abs(rows.velocity_deg_s.front());
    widen(range, rows.velocity_deg_s);
    report.slowest_deg_s = range.slowest_deg_s;
    report.fastest_deg_s = range.fastest_deg_s;
}

std::vector<StreamReport> StreamPass::reports(const Layout& layout) const {
    std::vector<StreamReport> reports;
    for (std::size_t j = 0; j < lanes_.size(); ++j) {
        StreamReport report = lanes_[j].report;
        report.recording = account_.recording(layout, j);
        report.switch_count = lanes_[j].run.filter->switch_count();
        reports.push_back(std::move(report));
    }
    return reports;
}

}  // namespace

namespace {

// Digits after the decimal mark of a number as it is written in a log.
int decimals_of(std::string_view number) {
    // Character by character: a cell is shorter than the set-up cost of a search for one of two.
    std::size_t mark = 0;
    while (mark < number.size() && number[mark] != '.' && number[mark] != ',') ++mark;
    if (mark == number.size()) return 0;
    std::size_t at = mark + 1;
    while (at < number.size() && number[at] >= '0' && number[at] <= '9') ++at;
    return static_cast<int>(std::min<std::size_t>(at - mark - 1, 17));
}

std::string per_cent(double share) { return percent_text(100.0 * share) + " %"; }

}  // namespace

std::optional<std::string> table_rate_warning(const TableAndLogRate& rates, const std::string& source) {
    const auto [table, log] = rates;
    const double off = std::abs(log / table - 1.0);
    const std::string both =
        fmt::format("{}: the log runs at {:.6g} Hz, the table was designed for {:.6g} Hz", source,
                    log.value(), table.value());
    if (off > rate_refused)
        raise<DataError>(
            "{}, and its notches would be {} off; design the table with --sample-rate {:.6g}Hz, or state the "
            "log's true rate with --sample-rate",
            both, per_cent(off), log.value());
    if (off <= rate_worth_a_word) return std::nullopt;
    return fmt::format(
        "{}: its notches are {} off; design the table with --sample-rate {:.6g}Hz to have them right", both,
        per_cent(off), log.value());
}

struct LogStream::State {
    std::unique_ptr<LogReader> reader;
    Opening opening;
    Account account;
};

LogStream::LogStream(std::unique_ptr<LogReader> reader) {
    Opening opening = read_opening(*reader);
    Account account(reader->layout(), opening);
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

StreamReport LogStream::run(CausalFilter& filter, LogWriter* writer, KeptRows* kept, std::size_t threads) {
    const JointRun joint{&filter, kept};
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
